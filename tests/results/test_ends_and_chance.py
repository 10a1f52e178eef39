"""Ends of Pareto sets by loops over designs, and effects of classes that chance may give one of several factors."""

import dataclasses

import numpy as np
import pandas as pd

import trackroller as tr
from trackroller.report.numbers import quantity
from trackroller.report.words.optimum import optimum_sentences
from trackroller.report.words.pareto import pareto_sentence
from trackroller.report.words.verdict import verdict_sentences
from trackroller.results.effects import Effect
from trackroller.results.findings import _beyond_chance

LIFE = "pair_life_to_first_limit_hours"
STEEL = dict.fromkeys(("roller_material", "guide_material"), "1.7225-quenched-tempered")
BASE = {"motor_force": 0, "axial_force": 9, "guide_overrollings_per_hour": 180, "guide_curve_radius": np.inf, **STEEL}


def test_an_end_that_ties_is_the_best_of_the_others():
    """Several designs have the smallest axis distance: the one with the longest life among them is named."""
    factors = {
        "axis_distance": {"values": [16, 28]},
        "roller_profile_radius": {"values": [-6.4, -7]},
        "radial_force": {"values": [-80, -140]},
    }
    goals = {LIFE: "max", "friction_power": "min", "axis_distance": "min"}
    study = {"name": "ends", "base": BASE, "factors": factors, "pareto": goals, "contact_model": "sliding"}
    outputs = ["forces", "contact", "friction_work", "peak_stress", "life", "limits"]
    results = tr.run(study | {"outputs": outputs, "accuracy": "preview"}, progress=False)
    frame = pd.DataFrame({n: results.table[n].to_numpy() for n in factors}).assign(life=results.column(LIFE))
    frame["power"] = results.data["friction_power"].sum("contact").values.ravel()
    both = frame.groupby(list(factors)[:2], as_index=False).agg(life=("life", "min"), power=("power", "max"))
    small = both[both["axis_distance"] == 16].sort_values("life").iloc[-1]
    said = {one.kind: one.text for one in verdict_sentences(results)}["tradeoff"]
    power = both.sort_values("power").iloc[0]
    assert f"at {quantity(small['power'], 'W')} at 16 mm" in said and quantity(small["life"], "h") in said
    assert f"{quantity(power['power'], 'W')} at {quantity(power['axis_distance'], 'mm')}" in said
    assert "beyond the S-N data" in said
    assert sum(len(one.text.split()) for one in verdict_sentences(results)) <= 120
    decided = pareto_sentence(results.pareto(), results).text
    assert quantity(small["life"], "h") in decided and quantity(power["life"], "h") in decided


def test_an_effect_has_to_be_larger_than_the_largest_of_chance():
    """Of forty factors without an effect, one or two have a 95 % interval without 1."""
    effect = Effect("axial_force", 5.0, 10.0, 1.88, (1.03, 2.5), 86, 0, 0)
    assert _beyond_chance(effect, 1) and not _beyond_chance(effect, 4)
    assert _beyond_chance(dataclasses.replace(effect, ratio=1 / 1.88, interval=(1 / 2.5, 1 / 1.03)), 1)
    rng, told = np.random.default_rng(3), 0
    for _ in range(60):
        found = []
        for _ in range(8):
            one, other = rng.standard_normal((2, 40))
            draws = [np.median(rng.choice(other, 40)) - np.median(rng.choice(one, 40)) for _ in range(200)]
            ends = 10 ** np.quantile(draws, [0.025, 0.975])
            ratio = float(10 ** (np.median(other) - np.median(one)))
            found.append(_beyond_chance(Effect("x", 0, 1, ratio, (float(ends[0]), float(ends[1])), 40, 0, 0), 8))
        told += any(found)
    assert told <= 0.15 * 60


def test_a_probability_that_is_a_goal_is_no_requirement():
    factors = {"axis_distance": {"values": [16, 22, 28]}, "radial_force": {"uniform": [-140, -60]}}
    study = {"name": "chance", "base": BASE, "factors": factors, "design": "optimise", "samples": 16}
    study |= {"goals": {f"probability({LIFE})": "max", "axis_distance": "min"}, "budget": {"designs": 3}}
    first = tr.run(study | {"analysis": {"target": {LIFE: {"min": 1.0}}}, "accuracy": "preview"}, progress=False)
    middle = float(np.median(first.column(LIFE)))
    results = tr.run(study | {"analysis": {"target": {LIFE: {"min": middle}}}, "accuracy": "preview"}, progress=False)
    said = optimum_sentences(results)[0].text
    assert said.startswith("Give a requirement.") and " %" in said and "target of" not in said
    assert "1 1" not in pareto_sentence(results.pareto(), results).text
