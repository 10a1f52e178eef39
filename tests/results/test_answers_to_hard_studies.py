"""Answers to studies made to be difficult, against raw rows: plain loops, nothing of the package."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import trackroller as tr
from trackroller.report.headlines import headline_of
from trackroller.roller.requirement import Requirement

LIFE = "pair_life_to_first_limit_hours"
QT = "1.7225-quenched-tempered"
BASE = {
    "guide_curve_radius": float("inf"),
    "roller_material": QT,
    "guide_material": QT,
    "guide_overrollings_per_hour": 60,
    "axial_force": 8,
    "motor_force": 0,
}


def solve(place, base=None, **keys):
    """Return the results of a small study with full sliding."""
    own = {key: value for key, value in BASE.items() if key not in keys["factors"]} | (base or {})
    study = {
        "name": place.name,
        "base": own,
        "contact_model": "sliding",
        "accuracy": "preview",
        "outputs": ["forces", "contact", "peak_stress", "life", "limits"],
    }
    return tr.run(study | keys, results=place, progress=False)


def rows_of(results):
    """Return one row a case from the variables of the data set, a column for each body and limit."""
    names = [name for name in results.data.variables if name in ("regime", LIFE, *results.data.coords)]
    return results.data[names].to_dataframe().reset_index()


@pytest.fixture(scope="module", params=["sure", "decide"])
def without_scatter(request, tmp_path_factory):
    """A study that asks for the life that one roller in ten does not reach, of materials without scatter."""
    factors = {"radial_force": {"uniform": [-90, -60]}, "friction_coefficient": {"uniform": [0.1, 0.3]}}
    keys = {"design": "lhs", "samples": 6}
    if request.param == "decide":
        factors = {"radial_force": {"values": [-60, -90]}, "contact_angle": {"values": [30, 40]}}
        keys = {}
    wanted = {"pair_life_hours": {"min": 100}}
    place = tmp_path_factory.mktemp(f"chance-{request.param}")
    return solve(place, factors=factors, failure_probability=0.1, requirement=wanted, **keys)


def test_the_life_of_one_in_two_does_not_take_its_place(without_scatter):
    assert without_scatter.data[LIFE].isnull().all()
    assert (without_scatter.data["pair_life_hours"] > 100).all(), "one in two lasts"
    answer = without_scatter.answer
    assert answer.kind == "cannot_tell"
    assert answer.output[0] == LIFE
    assert headline_of(answer).text == "Cannot tell: no material has a life at this failure probability."
    assert set(answer.table["state"]) <= {"open", ""}
    assert {one.code: one.count for one in answer.warnings}["not_judged"] == without_scatter.data[LIFE].size


def test_the_roller_counts_to_fatigue_as_not_checked(without_scatter):
    assert "fatigue" in without_scatter.answer.not_checked["roller"]


def test_a_life_of_one_in_two_is_named_so(tmp_path):
    """Without the limits a life is that of the S-N curve, at 50 %, whatever failure probability the study states."""
    factors = {"radial_force": {"values": [-60, -90]}, "contact_angle": {"values": [30, 40]}}
    outputs = ["forces", "contact", "peak_stress", "life"]
    answer = solve(tmp_path, factors=factors, failure_probability=0.1, outputs=outputs).answer
    low = next(column for column in answer.columns if column.name == "low")
    assert "at 50 % failure probability" in low.meaning
    assert np.isfinite(answer.headline["low"])


@pytest.fixture(scope="module")
def drawn_with_losses(tmp_path_factory):
    """Two grooves under drawn loads of which some lift every roller off, so that a share of lives is 0."""
    factors = {
        "roller_profile_radius": {"values": [-6.3, -8]},
        "radial_force": {"uniform": [-140, -40], "scatter": True},
        "axial_force": {"uniform": [0, 60], "scatter": True},
    }
    place = tmp_path_factory.mktemp("drawn")
    wanted = {"pair_life_hours": {"min": 600, "probability": 0.9}}
    return solve(place, factors=factors, design="inner_outer", samples=20, seed=9, requirement=wanted)


def rating_lives(results, end):
    """Return the shorter life of both bodies by the rating, one a case [h]."""
    hours = results.data[f"life_hours_by_limit{end}"].sel(limit="rating").min("body")
    return hours.transpose(*results.data["regime"].dims).to_numpy().ravel()


def test_a_second_model_is_judged_by_the_same_share(drawn_with_losses):
    results = drawn_with_losses
    rolls = (results.data["regime"] == 0).to_numpy().ravel()
    groove = results.table["roller_profile_radius"].to_numpy()
    least = {end: rating_lives(results, end) >= 600 for end in ("_low", "_high")}
    assert (least["_high"][rolls & (groove == -6.3)]).all(), "each condition that is held is long enough"
    for _, row in results.answer.table.iterrows():
        own = groove == row["roller_profile_radius"]
        sure, may = ((rolls & met)[own].mean() >= 0.9 for met in (least["_low"], least["_high"]))
        assert row["second_state"] == ("met" if sure else "open" if may else "missed")
    assert results.answer.kind == "none"
    assert "rating" not in headline_of(results.answer).text


def test_shares_that_are_not_judged_have_no_second_verdict(drawn_with_losses):
    results = drawn_with_losses
    study = results.config.model_copy(update={"requirement": {"pair_life_hours": Requirement(least=600.0)}})
    answer = dataclasses.replace(results, study=dataclasses.replace(results.study, config=study)).answer
    assert set(answer.table["second_state"]) == {""}
    assert "rating" not in headline_of(answer).text


def test_a_second_model_of_the_other_body_says_nothing(tmp_path):
    """The rating knows no life of a polymer: that of its rail is no second model of the roller that fails."""
    factors = {"roller_profile_radius": {"values": [-6.3, -8]}, "radial_force": {"values": [-20, -40]}}
    base = {"roller_material": "PA6", "guide_material": "EN AW-7075", "axial_force": 0}
    results = solve(tmp_path, base, factors=factors)
    hours = results.data["life_hours_by_limit"].sel(limit="rating")
    assert hours.sel(body="roller").isnull().all() and hours.sel(body="guide").notnull().all()
    assert set(results.answer.table["second"]) == {""}


def test_another_requirement_turns_no_second_verdict(tmp_path):
    """A stress that is exceeded is exceeded whichever model gives the life."""
    factors = {"roller_profile_radius": {"values": [-6.3]}, "radial_force": {"values": [-60, -150]}}
    wanted = {"pair_life_hours": {"min": 10}, "peak_stress_roller": {"max": 250}}
    results = solve(tmp_path, factors=factors, requirement=wanted)
    assert float(results.data["peak_stress"].sel(body="roller").max()) > 300
    assert (rating_lives(results, "_low") > 10).all()
    row = results.answer.table.iloc[0]
    assert row["state"] == row["second_state"] == "missed"
    assert "rating" not in headline_of(results.answer).text
