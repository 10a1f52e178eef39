"""What matters: signed outputs, groups of factors, requirements and lost rows, against raw rows by plain loops."""

from __future__ import annotations

import numpy as np
import pytest

import trackroller as tr
from trackroller.report.headlines import headline_of
from trackroller.report.pictures.curves import height_words

STEEL = "1.7225-quenched-tempered"
BASE = {"guide_curve_radius": float("inf"), "roller_material": STEEL, "guide_material": STEEL}


def solved(place, **keys):
    study = {"name": place.name, "base": BASE, "contact_model": "sliding", "accuracy": "preview"}
    return tr.run(study | keys, results=place, progress=False)


@pytest.fixture(scope="module")
def skidding(tmp_path_factory):
    """A driven roller whose drive is lost at low friction; the creepage is below 0 where it drives."""
    factors = {
        "motor_force": {"values": [-30, -12, 0]},
        "friction_coefficient": {"values": [0.05, 0.2, 0.3]},
        "axial_force": {"values": [0, 10]},
    }
    return solved(
        tmp_path_factory.mktemp("skid"),
        factors=factors,
        question="what matters",
        analysis={"outputs": ["slip"]},
        outputs=["forces", "contact"],
    )


def test_a_difference_is_not_said_as_a_factor(skidding):
    answer = skidding.answer
    assert answer.output[0] == "slip"
    rolls = skidding.table[skidding.table["regime"] == 0]
    assert rolls["slip"].min() < 0 < rolls["slip"].max(), "the output has both signs"
    text = headline_of(answer).text
    assert "×" not in text
    assert not any(factor["by_ratio"] for factor in answer.headline["factors"])
    height = next(column for column in answer.columns if column.name == "height")
    assert height.kind != "ratio"
    for curve in answer.curves:
        assert curve.height == pytest.approx(np.max(curve.middle) - np.min(curve.middle))
        assert height_words(curve).startswith("Δ")


def test_lost_rows_are_counted_by_level(skidding):
    table = skidding.table
    lost = table[table["regime"] != 0]
    assert len(lost) > 0
    for _, row in skidding.answer.table.iterrows():
        counts = [int((lost[row["name"]] == level).sum()) for level in table[row["name"]].unique()]
        assert row["lost"] == max(counts) - min(counts)


@pytest.fixture(scope="module")
def grouped(tmp_path_factory):
    """Sobol' indices of two groups and a factor of its own."""
    factors = {
        "radial_force": {"uniform": [-300, -80]},
        "axial_force": {"uniform": [-10, 10]},
        "friction_coefficient": {"uniform": [0.1, 0.3]},
        "roller_profile_radius": {"uniform": [-8, -6.3]},
        "contact_angle": {"uniform": [40, 50]},
    }
    groups = {"load": ["radial_force", "axial_force"], "geometry": ["roller_profile_radius", "contact_angle"]}
    return solved(
        tmp_path_factory.mktemp("groups"),
        base=BASE | {"motor_force": 0},
        factors=factors,
        method="saltelli",
        samples=32,
        outputs=["forces", "contact", "friction_work"],
        analysis={"outputs": ["friction_power"], "groups": groups},
        requirement={"friction_power": {"max": 0.6}},
    )


def test_groups_take_the_place_of_single_factors(grouped):
    answer = grouped.answer
    sens = grouped.indices().sel(output="friction_power")
    total = dict(zip(sens["group_name"].values.tolist(), sens["group_ST"].values.tolist(), strict=True))
    assert set(answer.table["factor"]) == {"load", "geometry", "friction coefficient"} == set(total)
    for _, row in answer.table.iterrows():
        assert row["index"] == pytest.approx(np.clip(total[row["factor"]], 0, 1))
    assert answer.table["index"].is_monotonic_decreasing
    load = answer.table.set_index("factor").loc["load"]
    assert load["members"] == "radial force, axial force"
    assert load["largest"] == "radial force"
    first = answer.table["factor"].iloc[0]
    assert headline_of(answer).lead.lower().startswith(first)


def test_index_of_a_group_by_other_code(grouped):
    """Jansen's estimator of the total index from the blocks A, A with the columns of a group of B, B."""
    power = grouped.data["friction_power"].sum("contact").values
    groups = grouped.design.meta["groups"]
    block = power.reshape(32, -1)
    assert block.shape[1] == 2 * len(groups) + 2
    radial = grouped.table["radial_force"].to_numpy().reshape(block.shape)
    angle = grouped.table["contact_angle"].to_numpy().reshape(block.shape)
    exchanged = [k for k in range(1, block.shape[1] - 1) if (radial[:, k] != radial[:, 0]).all()]
    friction = grouped.table["friction_coefficient"].to_numpy().reshape(block.shape)
    same = [(own[:, k] == own[:, 0]).all() for own in (angle, friction) for k in exchanged]
    of_load = [k for k, here in zip(exchanged, np.reshape(same, (2, -1)).all(axis=0), strict=True) if here]
    assert len(of_load) == 1
    variance = np.var(np.concatenate([block[:, 0], block[:, -1]]))
    jansen = np.mean((block[:, 0] - block[:, of_load[0]]) ** 2) / (2 * variance)
    own = answer_row(grouped, "load")
    assert own["index_low"] - 0.1 <= jansen <= own["index_high"] + 0.1


def answer_row(results, name):
    return results.answer.table.set_index("factor").loc[name]


def test_cases_that_meet_the_requirement_are_counted(grouped):
    power = grouped.data["friction_power"].sum("contact").values
    head = grouped.answer.headline
    assert 0 < head["meets"] == int((power <= 0.6).sum()) == head["perhaps"] < head["of"] == power.size
    assert f"{head['meets']} of {power.size} stay within 0.6 W" in headline_of(grouped.answer).text
    assert len(headline_of(grouped.answer).text.split()) <= 40


def test_a_value_of_an_output_is_not_given_for_nothing(tmp_path):
    """The bulk temperature rises with the cooled area that is given, though no limit is asked for."""
    results = solved(
        tmp_path,
        base=BASE
        | {"motor_force": 0, "axial_force": 5, "heat_transfer_coefficient": 20, "cooled_area": 5000}
        | dict.fromkeys(("roller_material", "guide_material"), "42CrMo4+QT-40"),
        factors={"radial_force": {"values": [-80, -160]}},
        outputs=["forces", "contact", "heat"],
        analysis={"outputs": ["bulk_temperature_rise_roller"]},
    )
    assert np.isfinite(results.data["bulk_temperature_rise"]).all()
    assert (results.data["bulk_temperature_rise"].sel(body="roller") > 0).any()
    assert "cooled_area" not in results.answer.not_used
    assert "heat_transfer_coefficient" not in results.answer.not_used


def test_few_base_samples_rank_factors_without_their_total_index(tmp_path):
    """16 base samples of five factors: the load is the largest, as its power law in closed form says."""
    factors = {
        "motor_force": {"uniform": [-18, 18]},
        "radial_force": {"uniform": [-420, -180]},
        "friction_coefficient": {"uniform": [0.12, 0.3]},
        "roller_profile_radius": {"uniform": [-10, -8.3]},
        "contact_angle": {"uniform": [44, 46]},
    }
    rail = {"guide_profile_radius": 8, "axis_distance": 28, "axial_force": 0}
    outputs = ["forces", "contact", "friction_work"]
    analysis = {"outputs": ["friction_power"]}
    few = solved(
        tmp_path,
        base=BASE | rail,
        factors=factors,
        method="saltelli",
        samples=16,
        outputs=outputs,
        analysis=analysis,
    )
    table = few.table
    power = few.data["friction_power"].sum("contact").to_numpy()
    columns = [np.log(np.abs(table[name])) for name in ("radial_force", "friction_coefficient")]
    rows = np.column_stack([*columns, table["roller_profile_radius"], np.ones(len(table))])
    exponents = np.linalg.lstsq(rows, np.log(power), rcond=None)[0]
    shares = [abs(exponents[i]) * np.std(rows[:, i]) for i in range(3)]
    assert shares[0] > shares[1] > shares[2]
    answer = few.answer
    named = [factor["name"] for factor in answer.headline["factors"]]
    assert named == ["radial_force", "friction_coefficient"]
    first = answer.headline["factors"][0]
    assert first["index_low"] <= 0.64 <= first["index_high"], "the index of 512 base samples"
