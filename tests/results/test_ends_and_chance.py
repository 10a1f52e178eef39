"""Ends of Pareto sets by loops over designs, and effects of classes that chance may give one of several factors."""

import dataclasses

import numpy as np

from trackroller.results.effects import Effect
from trackroller.results.findings import _beyond_chance

LIFE = "pair_life_to_first_limit_hours"
STEEL = dict.fromkeys(("roller_material", "guide_material"), "1.7225-quenched-tempered")
BASE = {"motor_force": 0, "axial_force": 9, "guide_overrollings_per_hour": 180, "guide_curve_radius": np.inf, **STEEL}


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
