"""What a record calls by its name: medians, models that are the same, conditions apart, and a life of nothing."""

from __future__ import annotations

import numpy as np
import pytest

import trackroller as tr
from trackroller.report.headlines import headline_of

BASE = {"guide_curve_radius": float("inf"), "friction_coefficient": 0.15, "guide_overrollings_per_hour": 60}
QUICK = {"contact_model": "sliding", "accuracy": "preview"}


def solved(place, **keys):
    return tr.run({"name": place.name, "base": BASE} | QUICK | keys, results=place, progress=False)


def test_a_median_of_an_even_number_lies_between_the_middle_ones(tmp_path):
    results = solved(tmp_path, factors={"axial_force": {"values": [0, 4, 8, 20]}, "motor_force": {"values": [-4, 4]}})
    answer = results.answer
    assert answer.question == "how it behaves"
    for _, row in answer.table.iterrows():
        values, *_ = results.quantity(row["name"])
        held = values[(results.table["regime"] == 0).to_numpy()]
        assert len(held) == 8
        ranked = np.sort(held)
        assert row["median"] == pytest.approx(0.5 * (ranked[3] + ranked[4]), rel=1e-12)


def test_a_model_that_its_table_solved_is_no_judge_of_the_table(tmp_path):
    """At preview kalker takes its table: both models have the same numbers."""
    results = solved(
        tmp_path,
        contact_model=["kalker", "kalker_table", "sliding"],
        factors={"radial_force": {"values": [-80, -160]}, "motor_force": {"values": [0, -5]}},
    )
    answer = results.answer
    assert answer.question == "which model"
    life = results.data["pair_life_hours"]
    same = life.sel(contact_model="kalker") == life.sel(contact_model="kalker_table")
    assert bool(same.all())
    rows = answer.table.set_index("model")
    assert rows["solved_by"].to_dict() == {
        "kalker": "kalker_table",
        "kalker_table": "kalker_table",
        "sliding": "sliding",
    }
    caution = next(one for one in answer.warnings if one.code == "unlike")
    assert (caution.count, caution.of) == (2, 3) and "kalker and kalker_table" in caution.where
    assert "times that of kalker (solved by kalker_table)" in headline_of(answer).text


def test_conditions_that_candidates_do_not_share_are_named(tmp_path):
    lines = ["drawing,load case,axis_distance,radial_force"]
    for drawing, size, factor in (("small", 18, 1.0), ("large", 30, 1.3)):
        lines += [f"{drawing},{case},{size},{-load * factor}" for case, load in (("run", 100), ("stop", 160))]
    (tmp_path / "loads.csv").write_text("\n".join(lines), encoding="utf-8")
    base = BASE | {"motor_force": 0, "axial_force": 5}
    answer = solved(tmp_path, base=base, method="table", table=str(tmp_path / "loads.csv")).answer
    caution = next(one for one in answer.warnings if one.code == "unlike")
    assert caution.where == "candidates have other conditions: radial force (−208 N to −100 N)"


def test_a_condition_without_life_is_not_extrapolated(tmp_path):
    hard = dict.fromkeys(("roller_material", "guide_material"), "1.7225-quenched-tempered")
    results = solved(
        tmp_path,
        base=BASE | hard | {"axial_force": 2, "roller_profile_radius": -6.3},
        factors={"motor_force": {"triangular": [-16, 0, 0]}, "radial_force": {"uniform": [-120, -60]}},
        method="lhs",
        samples=24,
        requirement={"pair_life_hours": {"min": 50}},
    )
    assert (results.table["regime"] == 1).any() and results.answer.headline["extrapolated"]
    text = headline_of(results.answer).text
    assert "0 h" in text and "extrapolated" not in text


def test_a_headline_counts_causes_as_such(tmp_path):
    """Seven of eight conditions are too short, in no place of their own."""
    factors = {
        "roller_profile_radius": {"values": [-6.5, -7]},
        "radial_force": {"values": [-60, -90]},
        "axial_force": {"values": [0, 6]},
        "friction_coefficient": {"values": [0.05, 0.2]},
    }
    base = BASE | {"motor_force": 0}
    study = {"base": {k: v for k, v in base.items() if k != "friction_coefficient"}, "factors": factors}
    study["not_checked"] = ["pressure_line"]  # one line, so that the life is no range
    plain = solved(tmp_path, **study)
    life = plain.data["pair_life_to_first_limit_hours"].max("roller_profile_radius").values.ravel()
    least = 0.5 * (np.sort(life)[-1] + np.sort(life)[-2])  # one condition reaches it
    answer = solved(tmp_path, **study, requirement={"pair_life_to_first_limit_hours": {"min": float(least)}}).answer
    near = answer.headline["nearest"]
    assert near["meets"] == 1 and near["perhaps"] == 1
    text = headline_of(answer).text
    assert near["fails_counted"] == near["fails"].startswith("too short in 7")
    assert ("fails at" in text) == (not near["fails_counted"]), text
