"""Pareto sets: right against a brute-force check, with directions and constraints."""

import numpy as np
import pytest
from synthetic_results import results_of

from trackroller.errors import InputError
from trackroller.results.pareto import pareto, pareto_mask
from trackroller.study.file.load import parse_study

LHS = {
    "name": "p",
    "method": "lhs",
    "samples": 400,
    "factors": {"velocity": {"uniform": [1.0, 2.0]}, "axial_force": {"uniform": [0.0, 1.0]}},
}


def brute(costs):
    """Return which rows no other row beats, by comparing each row with each."""
    worse = (costs[None] <= costs[:, None]).all(axis=2) & (costs[None] < costs[:, None]).any(axis=2)
    return ~worse.any(axis=1)


@pytest.mark.parametrize("count", [2, 3, 4])
def test_set_equals_the_brute_force_set(count):
    """Random points, with ties, in two to four objectives."""
    rng = np.random.default_rng(count)
    points = rng.integers(0, 12, (300, count)).astype(float)
    directions = ["min", "max", "min", "max"][:count]
    costs = points * np.array([1.0, -1.0, 1.0, -1.0])[:count]
    np.testing.assert_array_equal(pareto_mask(points, directions), brute(costs))


def test_rows_without_a_value_are_no_candidates():
    """NaN keeps a row out; infinite lives win."""
    points = np.array([[1.0, 1.0], [0.5, np.nan], [2.0, 0.0], [3.0, np.inf], [np.nan, 9.0]])
    mask = pareto_mask(points, ["min", "max"])
    np.testing.assert_array_equal(mask, [True, False, False, True, False])


def trade(x, y, slip=None):
    study = parse_study(LHS)
    ds = study.design()
    a, b = ds["velocity"].values, ds["axial_force"].values
    ds["roller_life_hours"] = ("case", x(a, b), {"units": "h"})
    ds["friction_power"] = ("case", y(a, b), {"units": "W"})
    ds["regime"] = ("case", np.zeros(a.size, dtype=np.int8) if slip is None else slip(a, b).astype(np.int8))
    return ds


def test_study_set_respects_regimes_and_constraints():
    """Life grows with velocity, so does power: without limits all on the line; slip and the limit cut it."""
    ds = trade(lambda a, b: 100 * a, lambda a, b: 10 * a, lambda a, b: a > 1.9)
    goals = {"roller_life_hours": "max", "friction_power": "min"}
    free = pareto(results_of(ds), goals)
    assert free.sizes["row"] == int((ds["velocity"] <= 1.9).sum()) and bool((free["optimal"] == 1).all())
    tight = pareto(results_of(ds), goals, ["friction_power < 15", "velocity >= 1.2"])
    assert float(tight["friction_power"].max()) < 15 and float(tight["velocity"].min()) >= 1.2
    assert "friction_power < 15" in tight.attrs["excluded"] and "regime" in tight.attrs["excluded"]
    np.testing.assert_allclose(tight["roller_life_hours"], 100 * ds["velocity"].values[tight["row"].values])


@pytest.mark.parametrize(
    ("objectives", "constraints", "says"),
    [
        ({"friction_power": "min"}, [], "at least two"),
        ({"friction_power": "min", "roller_life_hours": "up"}, [], "min or max"),
        ({"friction_powr": "min", "roller_life_hours": "max"}, [], "Did you mean 'friction_power'"),
        ({"friction_power": "min", "roller_life_hours": "max"}, ["friction_power 15"], "syntax error"),
        ({"friction_power": "min", "roller_life_hours": "max"}, ["friction_power < 1e"], "syntax error"),
        ({"friction_power": "min", "roller_life_hours": "max"}, ["friction_power + 15"], "a comparison such as"),
        ({"friction_power": "min", "roller_life_hours": "max"}, ["regime != 2"], "with a number"),
        ({"friction_power": "min", "roller_life_hours": "max"}, ["regime != full_slp"], "full_slip"),
        ({"friction_power": "min", "roller_life_hours": "max"}, ["friction_power.real < 1"], "not allowed"),
    ],
)
def test_wrong_goals_are_refused(objectives, constraints, says):
    """Names, directions and limits are checked, with what is allowed."""
    with pytest.raises(InputError, match=says):
        pareto(results_of(trade(lambda a, b: a, lambda a, b: b + 1)), objectives, constraints)


def test_figures_of_the_set_are_drawn_in_words():
    from trackroller.report.figures import style
    from trackroller.report.figures.pareto_front import pareto_front

    ds = trade(lambda a, b: 100 * a * (1.01 - b), lambda a, b: 10 * a * (1 + b))
    front = pareto(results_of(ds), {"roller_life_hours": "max", "friction_power": "min"})
    with style.look():
        _, first = pareto_front(front)
    assert first.caption.startswith("Pareto set for life of the roller up and friction power of both contacts down")
    assert pareto_front(front.assign_attrs(objectives="roller_life_hours max")) is None  # a search with one goal


@pytest.mark.parametrize(
    ("design", "name", "says"),
    [
        ("inner_outer", "roller_life_hours", "compares design points"),
        ("inner_outer", "axial_force", "compares design points"),
        ("inner_outer", "b10(max_pressure)", "mean.max_pressure"),
        ("inner_outer", "mean(max_presure)", "max_pressure"),
        ("inner_outer", "probability(roller_life_hours)", "requirement"),
        ("lhs", "b10(roller_life_hours)", "inner_outer"),
    ],
)
def test_wrong_statistics_are_refused(design, name, says):
    data = LHS | {"method": design, "pareto": {name: "max", "velocity": "min"}}
    data["factors"] = LHS["factors"] | {"velocity": {"values": [1.0, 2.0]}}
    with pytest.raises(InputError, match=says):
        parse_study(data)
