"""The answer of a search against its raw rows: which designs meet, the front, its corners and its knee."""

import json

import numpy as np
import pandas as pd
import pytest

import trackroller as tr
from trackroller.errors import InputError
from trackroller.report.headlines import headline_of
from trackroller.report.numbers import percent
from trackroller.results.best import answer_of_search
from trackroller.results.search_fitness import optimum_of, spread

LIFE = "pair_life_to_first_limit_hours"
STEEL = dict.fromkeys(("roller_material", "guide_material"), "1.7225-quenched-tempered")
BASE = {"motor_force": 0, "axial_force": 5, "guide_overrollings_per_hour": 150, "guide_curve_radius": "inf", **STEEL}
STUDY = {
    "name": "best",
    "base": BASE,
    "factors": {"axis_distance": {"uniform": [12, 30]}, "radial_force": {"values": [-200, -320]}},
    "method": "optimise",
    "goals": {"axis_distance": "min"},
    "budget": {"designs": 24, "population": 8},
    "outputs": ["forces", "contact", "friction_work", "peak_stress", "life", "limits"],
    "contact_model": "sliding",
    "accuracy": "preview",
}
DRAWN = {"axis_distance": {"uniform": [12, 30]}, "radial_force": {"normal": [-250, 30]}}


def searched(**keys):
    """Return a solved search, its raw rows by design and its answer."""
    results = tr.run({key: value for key, value in {**STUDY, **keys}.items() if value is not None}, progress=False)
    frame = results.to_table()
    frame["design"] = np.arange(len(frame)) // results.design.meta["inner_samples"]
    return results, frame, answer_of_search(results)


def leading(answer):
    return {key: answer.table[key].iloc[0] for key in answer.table}


@pytest.mark.slow
def test_the_smallest_design_that_meets_a_share_of_the_drawn_conditions_is_built():
    """All designs that meet the share by their rows are as large or larger, but for one step and the told error."""
    wanted = {LIFE: {"min": 20, "probability": 0.9}}
    _, frame, answer = searched(factors=DRAWN, samples=20, requirement=wanted)
    by = frame.groupby("design").agg(size=("axis_distance", "first"), share=(LIFE, lambda own: (own >= 20).mean()))
    first = leading(answer)
    assert answer.kind == "one" and first["verdict"] == "met"
    assert by["share"][first["design"]] >= 0.9 and first["share"] == pytest.approx(by["share"][first["design"]])
    meets = frame.groupby("design")[LIFE].apply(lambda own: (own >= 20 * 1.2).mean() >= 0.9)  # also with an error
    assert first["goal_1"] <= by["size"][meets].min()
    assert first["goal_1"] - by["size"][by["share"] >= 0.9].min() <= 0.2
    assert by["size"].max() > 1.8 * first["goal_1"]  # and it is not the one that lasts longest
    assert answer.headline["binds"] == "the required life to the first limit"
    z, n, share = 1.959964, 20, first["share"]
    ends = np.roots([1 + z**2 / n, -(2 * share + z**2 / n), share**2])  # (p - share)^2 = z^2 p (1 - p) / n
    assert sorted([first["share_low"], first["share_high"]]) == pytest.approx(sorted(ends), rel=1e-5)


def test_listed_sizes_give_the_smallest_that_meets():
    sizes = [12, 14, 16, 18, 20, 22]
    factors = {**DRAWN, "axis_distance": {"values": sizes}}
    wanted = {LIFE: {"min": 25, "probability": 0.95}}
    _, frame, answer = searched(factors=factors, samples=32, requirement=wanted)
    shares = frame.groupby("axis_distance")[LIFE].apply(lambda own: (own >= 25).mean())
    assert answer.headline["designs"][0]["name"] == {"axis_distance": float(shares.index[shares >= 0.95][0])}
    assert shares.index[shares >= 0.95][0] < sizes[-1]
    head = answer.headline
    assert head["share"] == shares[shares >= 0.95].iloc[0] and (head["n"], head["wanted"]) == (32, 0.95)
    assert f"of 32 drawn conditions reach 25 h; {percent(0.95)} are wanted" in headline_of(answer).text


@pytest.mark.slow
def test_corners_of_a_front_are_the_ends_of_the_ranges():
    """The life grows with the size, and with the contact angle: its largest value is that of both largest ends."""
    factors = {**STUDY["factors"], "contact_angle": {"uniform": [25, 40]}}
    budget = {"designs": 8, "population": 8}
    _, frame, answer = searched(goals={"axis_distance": "min", LIFE: "max"}, factors=factors, budget=budget)
    grid = {key: value for key, value in STUDY.items() if key not in ("goals", "budget", "method")}
    levels = {"axis_distance": {"values": [12, 21, 30]}, "contact_angle": {"values": [25, 32.5, 40]}}
    whole = tr.run({**grid, "name": "grid", "factors": {**factors, **levels}}, progress=False).to_table()
    lives = whole.groupby(["axis_distance", "contact_angle"])[LIFE].min()
    longest = answer.table[answer.table["corner"] != ""].sort_values("goal_2").iloc[-1]
    assert (longest["axis_distance"], longest["contact_angle"]) == lives.idxmax() == (30, 40)
    assert longest["goal_2"] == pytest.approx(lives.max()) and longest["corner"] == "solved"
    assert answer.kind == "front" and [one["at"] for one in answer.headline["designs"]] == ["corner", "knee", "corner"]
    assert not any(one["stopped"] for one in answer.headline["designs"])
    worst = frame.groupby("design").agg(size=("axis_distance", "first"), life=(LIFE, "min"))
    beaten = [
        ((worst["size"] <= own["size"]) & (worst["life"] >= own["life"]))[
            (worst["size"] < own["size"]) | (worst["life"] > own["life"])
        ].any()
        for _, own in worst.iterrows()
    ]
    assert answer.picture["front"].tolist() == np.logical_not(beaten).tolist()
    front = worst[~np.array(beaten)]
    places = pd.DataFrame({"size": front["size"], "life": -np.log(front["life"])})
    places = (places - places.min()) / (places.max() - places.min())
    knee = front.loc[(places**2).sum(axis=1).idxmin()]
    assert answer.headline["designs"][1]["name"]["axis_distance"] == pytest.approx(knee["size"])


@pytest.mark.slow
def test_a_requirement_bounds_the_front_and_one_design_is_named():
    keys = {"goals": {"axis_distance": "min", LIFE: "max"}, "requirement": {LIFE: {"min": 100}}}
    _, frame, answer = searched(**keys)
    worst = frame.groupby("design")[LIFE].min()
    assert answer.kind == "front_required" and len(answer.headline["designs"]) == 1
    assert (worst[answer.table["design"]] >= 100).all() and (answer.table["verdict"] == "met").all()
    assert worst[answer.picture["met"]].min() >= 100 and (worst < 100).any()


@pytest.mark.slow
def test_where_no_design_meets_the_nearest_one_is_named_and_none_is_built():
    _, frame, answer = searched(requirement={LIFE: {"min": 1e7}})
    near = answer.headline["nearest"]
    worst = frame.groupby("design")[LIFE].min()
    assert (answer.kind, answer.headline["designs"], near["verdict"]) == ("none", [], "missed")
    assert near["low"] == pytest.approx(worst.max()) and (near["meets"], near["of"], near["holds"]) == (0, 2, 2)
    assert near["name"] == {"axis_distance": 30.0}


@pytest.mark.slow
def test_a_smallest_design_says_what_it_lasts_at_reference():
    """The required life of the headline is that of the design solved alone at `reference`, at its worst load."""
    _, _, answer = searched(goals={"axis_distance": "min"}, requirement={LIFE: {"min": 100}})
    design = answer.headline["designs"][0]
    cases = [BASE | {"axis_distance": design["name"]["axis_distance"], "radial_force": load} for load in (-200, -320)]
    lives = tr.solve(cases, outputs=STUDY["outputs"], contact_model="sliding", accuracy="reference")[LIFE]
    assert design["required"][0]["value"] == pytest.approx(float(lives.min()), rel=1e-9)
    assert answer.table["required_1"].iloc[0] == design["required"][0]["value"]
    assert "goal_1" not in {column.name for column in answer.columns}  # the size stands in the column of the choice


@pytest.mark.slow
def test_a_requirement_within_the_error_of_the_solution_is_solved_finer():
    _, _, answer = searched(goals={LIFE: "max"})
    longest = answer.headline["designs"][0]["goals"][0]["value"]
    _, _, close = searched(goals={LIFE: "max"}, requirement={LIFE: {"min": longest * (1 - 1e-6)}})
    assert answer.kind == "one" and close.kind == "solve_finer" and close.headline["designs"] == []
    assert close.headline["nearest"]["verdict"] == "open"


@pytest.mark.parametrize(
    ("keys", "kind", "rows"),
    [
        ({"goals": {"guide_life_hours": "max", "axis_distance": "min"}}, "none", 0),  # no value of a goal
        ({"goals": {"velocity": "min"}}, "one", 6),  # all designs tie
        ({"goals": {"velocity": "min", "ambient_temperature": "max"}}, "front", 6),
        ({"base": {**BASE, "friction_coefficient": 1e-4, "motor_force": -200}}, "none", 0),  # all skid
    ],
)
def test_searches_without_an_order_have_an_answer(keys, kind, rows):
    factors = {"axis_distance": {"values": [12, 20, 30]}, "contact_angle": {"values": [30, 35]}}
    base = {key: value for key, value in BASE.items() if key != "guide_overrollings_per_hour"} | {"radial_force": -250}
    keys = {**keys, "base": keys.get("base", base)}
    _, _, answer = searched(factors=factors, **keys)
    assert answer.kind == kind and len(answer.table) == rows
    assert json.dumps(answer.to_dict())
    if kind == "none":
        assert [one.code for one in answer.warnings] == ["not_held"] and answer.headline["designs"] == []


@pytest.mark.slow
def test_a_search_whose_last_designs_share_a_material_has_an_answer():
    factors = {
        "roller_material": {"values": ["1.7225-quenched-tempered", "PA6"]},
        "axis_distance": {"uniform": [12, 30]},
    }
    base = {key: value for key, value in BASE.items() if key != "roller_material"} | {"radial_force": -250}
    _, frame, answer = searched(factors=factors, base=base, goals={LIFE: "max"})
    best = frame.loc[frame[LIFE].idxmax()]
    assert answer.headline["designs"][0]["name"]["roller_material"] == best["roller_material"]
    assert answer.headline["designs"][0]["name"]["axis_distance"] == best["axis_distance"] == 30


@pytest.mark.slow
def test_what_a_tolerance_does_is_the_worse_of_both_sides():
    results, _, answer = searched(goals={LIFE: "max"}, factors={**DRAWN, "radial_force": {"values": [-250]}})
    beside = [one["values"][0] for one in optimum_of(results)["neighbours"]]
    first = leading(answer)
    assert first["step"] == pytest.approx(min(beside) / first["goal_1"]) and first["step"] < 1
    assert first["step_of"] == "axis distance -0.05"


def test_another_study_has_no_answer_of_a_search():
    grid = {key: value for key, value in STUDY.items() if key not in ("goals", "budget", "method")}
    factors = {**STUDY["factors"], "axis_distance": {"values": [12, 30]}}
    results = tr.run({**grid, "factors": factors}, progress=False)
    with pytest.raises(InputError, match="method: optimise"):
        answer_of_search(results)


def test_a_spread_keeps_the_ends_of_a_front():
    costs = np.column_stack([np.linspace(0, 1, 40), np.linspace(1, 0, 40)])
    assert {0, 39} <= set(spread(costs, 5).tolist())
