"""A study of a carriage: its fields as factors, the lives of its worst roller, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest
import yaml

import trackroller as tr
from tests.carriage.carts import ROLLER, shuttle
from trackroller.carriage.fields import changed, fields_of
from trackroller.carriage.file import carriage_of
from trackroller.errors import InputError
from trackroller.parameters.carriage_fields import field_of, long_name_of

LIFE = "pair_life_to_first_limit_hours"
OVERROLLED = ROLLER | {"guide_overrollings_per_hour": 60}


def rolled(**more):
    """Return the shuttle with rollers whose guide has a known number of overrollings."""
    made = shuttle(**more)
    for roller in made["rollers"].values():
        roller["roller"] = OVERROLLED
    return made


def study(carriage, **keys):
    values = {"name": "shuttle", "carriage": carriage, "contact_model": "sliding", "accuracy": "preview"}
    return values | keys


def test_a_field_moves_what_its_name_says():
    whole = carriage_of(shuttle())
    assert {"carriage_wheelbase", "carriage_payload", "carriage_speed_in_curve", "carriage_x_of_FL"} <= set(
        fields_of(whole)
    )
    wide = changed(whole, {"carriage_wheelbase": 400.0, "carriage_gauge": 100.0})
    np.testing.assert_allclose(
        [roller.at[:2] for roller in wide.rollers], [(200, 50), (200, -50), (-200, 50), (-200, -50)]
    )
    loaded = changed(whole, {"carriage_payload": 20.0, "carriage_payload_x": -10.0, "carriage_mass": 30.0})
    assert (loaded.payloads[0].value, loaded.payloads[0].at.tolist(), loaded.mass.value) == (
        20.0,
        [-10.0, 0.0, 150.0],
        30.0,
    )
    fast = changed(
        whole, {"carriage_speed": 2.0, "carriage_curve_radius_in_run": 5000.0, "carriage_gradient_in_run": 10.0}
    )
    assert [case.speed for case in fast.cases] == [None, 2.0, 2.0]
    assert [case.curve_radius for case in fast.cases] == [np.inf, 1500.0, 5000.0]
    assert fast.cases[2].gradient == pytest.approx(np.deg2rad(10))
    assert [pair.force for pair in changed(whole, {"carriage_preload": 50.0}).preloads] == [50.0, 50.0]
    assert changed(whole, {"carriage_z_of_RR": 7.0}).rollers[3].at.tolist() == [-150.0, -40.0, 7.0]
    assert whole.rollers[3].at.tolist() == [-150.0, -40.0, 0.0], "the carriage itself stays"


def test_several_payloads_keep_their_proportions():
    whole = carriage_of(shuttle(payloads=[{"value": 10, "at": [0, 0, 0]}, {"value": 30, "at": [80, 0, 0]}]))
    new = changed(whole, {"carriage_payload": 80.0, "carriage_payload_x": 0.0})
    assert [one.value for one in new.payloads] == [20.0, 60.0]
    assert [one.at[0] for one in new.payloads] == [-60.0, 20.0]  # their centre was at 60 mm


def test_names_of_fields():
    assert field_of("carriage_speed_in_curve").unit == "m/s"
    assert field_of("carriage_x_of_FL_in").unit == "mm"
    assert field_of("carriage_wheelbase_in_curve") is None and field_of("payload") is None
    assert long_name_of("carriage_speed_in_curve") == "speed, curve"


@pytest.mark.slow
def test_the_life_of_each_row_is_that_of_the_worst_roller():
    """Each carriage is solved by `trackroller.carriage`, and the damage of the cases is summed here once more."""
    levels = {
        "carriage_wheelbase": [240.0, 400.0],
        "carriage_payload": [20.0, 60.0],
        "carriage_speed_in_curve": [0.5, 1.2],
    }
    factors = {name: {"values": values} for name, values in levels.items()}
    checked = tr.load_study(study(rolled(), factors=factors))
    results = tr.run(checked, progress=False)
    ds, cases = results.data, checked.design()
    assert ds[LIFE].dims == tuple(factors) and len(cases["case"]) == 8 * 12
    for place in np.ndindex(2, 2, 2):
        given = {name: values[i] for (name, values), i in zip(levels.items(), place, strict=True)}
        alone = tr.carriage(_with(given))
        found = ds.isel(dict(zip(levels, place, strict=True)))
        worst = str(alone.attrs["worst_roller"])
        assert str(found["worst_roller"].values) == worst
        row = cases.isel(case=int(found["case"]))
        assert (str(row["carriage_roller"].values), str(row["load_case"].values)) == (
            worst,
            str(found["worst_load_case"].values),
        )
        assert float(row["axial_force"]) == float(found["axial_force"])
        assert float(found[LIFE]) == pytest.approx(
            float(alone.life_hours.sel(roller=worst)), rel=2e-3
        )  # `standard` there
    # once more from the solved rows, by own sums
    solved = tr.solve(cases, accuracy="preview", contact_model="sliding")
    hours, share = solved[LIFE].values, cases["share"].values
    row, roller, kmh = cases["design_row"].values, cases["carriage_roller"].values, 0.06 * cases["velocity"].values
    for r in range(8):
        lives = []
        for name in ("FL", "FR", "RL", "RR"):
            own = (row == r) & (roller == name)
            lives.append(np.sum(share[own] / kmh[own]) / np.sum(share[own] / kmh[own] / hours[own]))
        assert ds[LIFE].values.ravel()[r] == pytest.approx(min(lives), rel=1e-9)


def _with(given):
    """Return the shuttle with other values, written by hand."""
    made = rolled()
    for name, roller in made["rollers"].items():
        roller["at"][0] = given["carriage_wheelbase"] / 2 * (1 if name[0] == "F" else -1)
    made["payloads"][0]["value"] = given["carriage_payload"]
    made["cases"][1]["speed"] = given["carriage_speed_in_curve"]
    return made


def test_the_verdict_speaks_of_the_carriage():
    results = tr.run(study(rolled(), factors={"carriage_wheelbase": {"values": [200, 400]}}), progress=False)
    found = results.answer
    assert found.kind == "build"
    assert found.headline["names"] == [{"carriage_wheelbase": 400.0}]
    roles = {"carriage_payload": {"values": [20, 60]}, "carriage_wheelbase": {"values": [200, 400]}}
    judged = tr.run(study(rolled(), name="roles", factors=roles), progress=False)
    assert judged.candidates().conditions == ("carriage_payload",)
    from trackroller.report.build import report_text

    text = report_text(judged)
    assert "wheelbase 400" in text


def test_a_study_of_a_carriage_needs_no_other_file_when_it_is_read_again(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    made = rolled()
    for roller in made["rollers"].values():
        roller["roller"] = "roller.yaml"
    (tmp_path / "roller.yaml").write_text(yaml.safe_dump(OVERROLLED), encoding="utf-8")
    (tmp_path / "shuttle.yaml").write_text(yaml.safe_dump(made), encoding="utf-8")
    keys = study("shuttle.yaml", factors={"carriage_payload": {"values": [20, 60]}})
    (tmp_path / "study.yaml").write_text(yaml.safe_dump(keys), encoding="utf-8")
    first = tr.load_study("study.yaml")
    (tmp_path / "roller.yaml").unlink()
    (tmp_path / "shuttle.yaml").unlink()
    again = tr.load_study(yaml.safe_load(first.merged()))
    assert again.merged() == first.merged()
    assert first.design().equals(again.design())
    assert first.not_given == ("ambient_temperature", "travel") or "axial_force" not in first.not_given


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"factors": {"speed": {"values": [1, 2]}}}, "carriage_speed"),
        ({"factors": {"carriage_sped": {"values": [1, 2]}}}, "carriage_speed"),
        ({"factors": {"carriage_speed_in_bend": {"values": [1, 2]}}}, "carriage_speed_in_"),
        ({"factors": {"carriage_play": {"values": [0.1, 0.2]}}}, "carriage_pla"),
        ({"factors": {"carriage_payload": {"values": [-1, 2]}}}, ">= 0 kg"),
        ({"factors": {"carriage_payload": {"values": ["2 N", 2]}}}, "kg"),
        ({"factors": {"radial_force": {"values": [-100, -200]}}}, "statics gives it"),
        ({"base": {"velocity": 60}, "factors": {"carriage_mass": {"values": [1, 2]}}}, "statics gives it"),
        ({"outputs": ["forces"], "factors": {"carriage_mass": {"values": [1, 2]}}}, "Add life"),
        ({"contact_model": "kalker", "factors": {"carriage_mass": {"values": [1, 2]}}}, "contact_model: sliding"),
        ({"carriage": {"mass": 3}, "factors": {"carriage_mass": {"values": [1, 2]}}}, "rollers"),
    ],
)
def test_what_does_not_fit_is_refused(keys, words):
    with pytest.raises(InputError, match="(?s)" + words.replace("(", r"\(")):
        tr.load_study(study(rolled()) | keys)


def test_a_roller_that_does_not_roll_is_the_worst_one():
    """With little preload one contact of a roller lifts off: the row is not judged by its other rollers."""
    checked = tr.load_study(study(rolled(), factors={"carriage_preload": {"values": [250, 500, 1000]}}))
    ds, cases = tr.run(checked, progress=False).data, checked.design()
    solved = tr.solve(cases, accuracy="preview", contact_model="sliding")
    regime, row = solved["regime"].values, cases["design_row"].values
    lifted = [regime[row == r].max() for r in range(3)]
    assert ds["regime"].values.tolist() == lifted and lifted[0] == 2 and lifted[2] == 0
    some = solved[LIFE].values[(row == 0) & (regime == 0)]
    assert len(some) and np.isfinite(some).all() and np.isnan(ds[LIFE].values[0])


def test_a_load_case_without_a_speed_has_the_velocity_of_the_roller():
    """It counts in the hours of the carriage, also where the first load case states another speed."""
    cases = [{"name": "run", "share": 0.4, "speed": 2.0}, {"name": "creep", "share": 0.6}]
    made = rolled(cases=cases)
    for roller in made["rollers"].values():
        roller["roller"] = OVERROLLED | {"velocity": 12}
    found = tr.run(study(made, factors={"carriage_payload": {"values": [20, 60]}}), progress=False).data
    alone = tr.carriage(made)
    own = float(alone.life_hours.sel(roller=alone.attrs["worst_roller"]))
    assert float(found[LIFE].sel(carriage_payload=60)) == pytest.approx(own, rel=2e-3)  # `standard` there
    assert float(alone.life_hours[0] / alone.life_km[0]) == pytest.approx(0.4 / 7.2 + 0.6 / 0.72)
