"""Answers to studies made to be difficult, against raw rows: plain loops, nothing of the package."""

from __future__ import annotations

import dataclasses

import numpy as np
import pandas as pd
import pytest
import yaml

import trackroller as tr
from trackroller.report.headlines import headline_of
from trackroller.results.subgroups import places_of
from trackroller.roller.requirement import Requirement

LIFE = "pair_life_to_first_limit_hours"
LIFTED = 2  # number of this regime
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
    given = {**BASE, **(base or {})}
    own = {key: value for key, value in given.items() if key not in keys["factors"] and value is not None}
    study = {
        "name": place.name,
        "base": own,
        "contact_model": "sliding",
        "accuracy": "preview",
        "outputs": ["forces", "contact", "peak_stress", "life", "limits"],
    }
    return tr.run(study | keys, results=place, progress=False)


def rows_of(results):
    """Return one row a case: its regime, its life and its inputs, from the variables of the data set."""
    data = results.data
    dims = set(data["regime"].dims)
    inputs = [name for name in data.coords if data[name].dims and set(data[name].dims) <= dims]
    return data[["regime", LIFE, *inputs]].to_dataframe().reset_index()


@pytest.fixture(scope="module", params=["sure", "decide"])
def without_scatter(request, tmp_path_factory):
    """A study that asks for the life that one roller in ten does not reach, of materials without scatter."""
    factors = {"radial_force": {"uniform": [-90, -60]}, "friction_coefficient": {"uniform": [0.1, 0.3]}}
    keys = {"method": "lhs", "samples": 6}
    if request.param == "decide":
        factors = {"radial_force": {"values": [-60, -90]}, "contact_angle": {"values": [30, 40]}}
        keys = {}
    wanted = {"pair_life_hours": {"min": 100}}
    place = tmp_path_factory.mktemp(f"chance-{request.param}")
    keys |= {"not_checked": ["pressure_line"]}  # the range is that of the scatter alone
    return solve(place, factors=factors, failure_probability=0.1, requirement=wanted, **keys)


def test_the_life_of_one_in_ten_is_a_range_by_the_typical_scatter(without_scatter):
    median = without_scatter.data["pair_life_hours"]
    for end, scatter in (("_low", 16.1), ("", 10.0), ("_high", 5.2)):
        assert without_scatter.data[LIFE + end].values == pytest.approx((median / scatter**0.5).values, rel=1e-9)
    answer = without_scatter.answer
    assert answer.kind != "cannot_tell"
    assert answer.output[0] == LIFE
    assert "not_judged" not in {one.code for one in answer.warnings}
    low = answer.table["low"].min()
    assert low == pytest.approx(float(median.min()) / 16.1**0.5, rel=1e-6)


def test_the_roller_counts_to_fatigue_as_checked(without_scatter):
    assert "fatigue" not in without_scatter.answer.not_checked["roller"]


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


def lifting(results):
    """Return by hand which conditions, levels of the radial force, lift every roller off."""
    frame = rows_of(results)
    return frame.groupby("radial_force")["regime"].apply(lambda own: (own == LIFTED).all())


def test_the_load_of_the_example_that_lifts_every_roller_off_is_asked_for(tmp_path):
    factors = {"roller_profile_radius": {"values": [-6.3, -7, -8]}, "radial_force": {"values": [-10, -20]}}
    results = solve(tmp_path, {"axial_force": None}, factors=factors)
    assert lifting(results).all()
    answer = results.answer
    text = "Give axial force: without it 2 of 2 conditions (lifts off) are lost."
    assert headline_of(answer).text == text
    assert "at_end" not in {one.code for one in answer.warnings}, "no design is named"


def test_a_load_is_asked_for_where_the_other_drawn_conditions_meet_the_requirement(tmp_path):
    factors = {
        "roller_profile_radius": {"values": [-6.3, -7]},
        "radial_force": {"uniform": [-105, -20], "scatter": True},
    }
    keys = {"factors": factors, "method": "inner_outer", "samples": 12}
    wanted = {"pair_life_hours": {"min": 200, "probability": 0.9}}
    results = solve(tmp_path, {"axial_force": None}, requirement=wanted, **keys)
    lost = lifting(results)
    assert 0.5 < lost.mean() < 1, "some conditions are held, and meet the requirement"
    assert (rows_of(results)[LIFE].dropna() > 400).all()
    answer = results.answer
    assert answer.kind == "give"
    assert answer.headline["not_held"]["count"] == lost.sum()
    assert headline_of(answer).text.startswith(f"Give axial force: without it {lost.sum()} of 12 conditions")


def test_the_worst_of_a_nearest_design_is_not_said_where_it_lifts_off(tmp_path):
    factors = {
        "roller_profile_radius": {"values": [-6.3, -7]},
        "radial_force": {"values": [-60, -150]},
        "axial_force": {"values": [8, 50]},
    }
    wanted = {"pair_life_hours": {"min": 1e6}}
    results = solve(tmp_path, factors=factors, requirement=wanted, not_checked=["pressure_line"])
    frame = rows_of(results)
    held = frame[frame["roller_profile_radius"] == -6.3]["regime"] == 0
    answer = results.answer
    assert answer.kind == "none"
    assert answer.headline["nearest"]["holds"] == held.sum() == 3
    assert answer.headline["nearest"]["low"] > 0, "of the conditions that some design holds"
    assert "at the worst" not in headline_of(answer).text


def test_a_curve_with_equal_ends_is_a_dip(tmp_path):
    """The stress by -15 N is that by 15 N: the curve neither rises nor falls, however small its height."""
    factors = {"axial_force": {"values": [-12, 0, 12]}, "radial_force": {"values": [-100, -150, -200]}}
    wanted = {"peak_stress_roller": {"max": 1000}}
    results = solve(tmp_path, factors=factors, requirement=wanted)
    stress = results.data["peak_stress"].sel(body="roller").max("contact").transpose("axial_force", ...)
    by_hand = np.median(stress.to_numpy(), axis=1)
    assert by_hand[0] == pytest.approx(by_hand[2], rel=1e-6) and 1.02 < by_hand[0] / by_hand[1] < 1.1
    curve = next(one for one in results.answer.curves if one.factor == "axial_force")
    assert curve.shape == "dip"
    assert curve.height == pytest.approx(by_hand.max() / by_hand.min(), rel=1e-6)


def test_an_error_that_is_not_stated_is_not_said(tmp_path, drawn_with_losses):
    """A contact pressure states none, and a roller that lifts off has none."""
    factors = {"roller_profile_radius": {"values": [-6.3, -7]}, "radial_force": {"values": [-60, -150]}}
    results = solve(tmp_path, factors=factors, requirement={"max_pressure": {"max": 900}})
    assert results.answer.table["error"].isna().all()
    assert "error" not in [column.name for column in results.answer.columns]
    table = drawn_with_losses.answer.table
    assert table["error"][table["ends"] == "lifts off"].isna().all() and (table["ends"] == "lifts off").any()


def test_a_place_does_not_list_every_level_of_a_factor():
    pairs = pd.DataFrame([(force, friction) for force in (-60, -120) for friction in (0.1, 0.3)], columns=["F", "mu"])
    hit = ((pairs["F"] == -60) | (pairs["mu"] == 0.3)).to_numpy()
    found = places_of(pairs, ["F", "mu"], hit, np.ones(4, dtype=bool))
    assert found == ({"F": (-60,)}, {"F": (-120,), "mu": (0.3,)})
    inside = [np.all([pairs[name].isin(own) for name, own in place.items()], axis=0) for place in found]
    assert (np.any(inside, axis=0) == hit).all()


def test_single_unlike_cases_make_no_curve(tmp_path):
    """Of loads that differ in everything no curve says what one of their factors does."""
    loads = pd.DataFrame(
        {
            "radial_force": [-60.0, -75.0, -90.0, -105.0, -120.0],
            "axial_force": [8.0, 2.0, 14.0, 5.0, 11.0],
            "friction_coefficient": [0.2, 0.1, 0.3, 0.15, 0.25],
        }
    )
    loads.to_csv(tmp_path / "loads.csv", index=False)
    file = tmp_path / "study.yaml"
    base = {key: value for key, value in BASE.items() if key not in loads} | {"guide_curve_radius": "inf"}
    study = {"name": "loads", "method": "table", "table": "loads.csv", "base": base, "contact_model": "sliding"}
    study |= {"accuracy": "preview", "requirement": {"pair_life_hours": {"min": 100}}}
    file.write_text(yaml.safe_dump(study))
    answer = tr.run(file, results=tmp_path / "results", progress=False).answer
    assert (answer.question, answer.kind) == ("how sure", "count")
    assert answer.curves == ()


def test_a_required_travel_is_a_required_life(tmp_path):
    """2,000 km at 60 m/min, 3.6 km/h, take 556 h; wear is known within a range."""
    factors = {"roller_profile_radius": {"values": [-6.3, -7]}, "radial_force": {"values": [-15, -40]}}
    base = {"axial_force": 1, "permissible_wear_depth": 0.1, "required_travel": 2_000, "velocity": 60}
    outputs = ["forces", "contact", "friction_work", "peak_stress", "life", "wear", "limits"]
    results = solve(tmp_path, base, factors=factors, outputs=outputs)
    hours = 2_000 / 3.6
    ends = [results.data[f"{LIFE}{end}"].min("radial_force").to_series() for end in ("_low", "_high")]
    answer = results.answer
    assert [(one.output, one.least) for one in answer.required] == [(LIFE, pytest.approx(hours))]
    assert (ends[0] < hours).all() and (ends[1] > hours).all(), "the range of the wear leaves it open"
    for _, row in answer.table.iterrows():
        low, high = (end[row["roller_profile_radius"]] for end in ends)
        assert (row["low"], row["high"]) == (pytest.approx(low), pytest.approx(high))
        assert row["state"] == "open"
    assert answer.kind == "measure"
    asked = answer.headline["measure"]
    assert asked["what"].startswith("wear_coefficient") and asked["low"] < asked["high"]
    shorter = ends[0].max() * asked["high"] / asked["low"]  # by the smallest coefficient in one form of the groove
    assert shorter < hours and np.isnan(asked["turn"]), "the longer one of two forms alone lasts"


def test_a_response_surface_takes_a_requirement(tmp_path):
    """The output that is required is the one that the factors are ranked by."""
    factors = {"radial_force": {"uniform": [-160, -60]}, "contact_angle": {"uniform": [30, 45]}}
    wanted = {"peak_stress_roller": {"max": 330}}
    results = solve(tmp_path, factors=factors, design="central_composite", requirement=wanted)
    answer = results.answer
    stress = results.data["peak_stress"].sel(body="roller").max("contact").to_numpy()
    assert answer.question == "what matters" and answer.output[0] == "peak_stress_roller"
    assert [one.most for one in answer.required] == [330]
    assert stress.min() < 330 < stress.max()
    effect = {name: abs(own) for name, own in zip(answer.table["name"], answer.table["index"], strict=True)}
    at = {name: results.table[name].to_numpy() for name in factors}
    ends = {name: [stress[own == end].mean() for end in (own.min(), own.max())] for name, own in at.items()}
    by_hand = {name: abs(high - low) for name, (low, high) in ends.items()}
    assert max(effect, key=effect.get) == max(by_hand, key=by_hand.get) == answer.table["name"].iloc[0]


def test_a_candidate_fails_where_it_surely_misses_and_not_where_it_is_open(tmp_path):
    """A plastic roller of which the wear is known within a range: one load is open, the other one is missed."""
    results = solve(
        tmp_path,
        {"roller_material": "PA66-dry", "axial_force": 4, "permissible_wear_depth": 0.15, "velocity": 80},
        factors={"radial_force": {"values": [-12, -60]}, "roller_profile_radius": {"values": [-6.3, -7]}},
        outputs=["forces", "contact", "friction_work", "peak_stress", "life", "wear", "limits"],
        requirement={LIFE: {"min": 6000}},
    )
    data = results.data.sel(roller_profile_radius=-6.3)
    low, high = (data[f"{LIFE}_{end}"].to_series() for end in ("low", "high"))
    assert (low < 6000).all() and (high >= 6000).tolist() == [True, False]
    near = results.answer.headline["nearest"]
    assert near["name"] == {"roller_profile_radius": -6.3}
    assert (near["meets"], near["perhaps"], near["of"]) == (0, 1, 2)
    assert "radial force" in near["fails"] and "−60 N" in near["fails"] and "−12 N" not in near["fails"]
    assert "meets 0 to 1 of 2 conditions" in headline_of(results.answer).text
