"""Simulate campaigns of tests: those that `fit next` chooses against as many random ones of the same candidates.

A campaign has a line of its own and a first bench, see `validation.fits.coverage`. Three further tests are chosen, and
run until they fail. Both choices draw the same random numbers, so that they differ by what is tested alone.
"""

from __future__ import annotations

import numpy as np
from scipy import stats

from trackroller.fit.line import Line, Tests
from trackroller.fit.material_fit import Group
from trackroller.fit.next_tests import ranked
from validation.fits.coverage import LEVEL, MIDDLE, bench, usable

ROLLERS, TESTS = 8, 3  # of the first bench, and further ones
LOADS = np.log(np.array([850.0, 900.0, 950.0, 1000.0, 1050.0, 1100.0, 1150.0]))  # candidates
DESIGN = float(np.log(800.0))
PROBABILITY = 0.1


def _with(tests: Tests, stress: np.ndarray, normal: np.ndarray, level: float, slope: float, scatter: float) -> Line:
    """Return the line of all tests, the further ones at these stresses included."""
    life = level - slope * (stress - MIDDLE) + scatter * normal
    both = ((tests.stress, stress), (tests.low, life), (tests.high, life))
    return Line(Tests(*(np.concatenate(pair) for pair in both)))


def campaign(rng: np.random.Generator) -> list[tuple[float, float, bool, float]]:
    """Return width of the interval, error of ln B10, whether it holds, and ln cycles, of chosen and random tests."""
    while True:
        slope, scatter = rng.normal(9.0, 1.5), float(np.exp(rng.normal(np.log(0.6), 0.3)))
        tests = bench(rng, ROLLERS, LEVEL, slope, scatter)
        if usable(tests):
            break
    one = np.ones(len(LOADS) + 1)
    own = Group("fatigue", Line(tests), at=float(np.exp(LEVEL)))
    plan = ranked(own, (np.append(LOADS, DESIGN), one, one), TESTS, PROBABILITY, np.inf, 1)
    normal = rng.normal(size=TESTS)
    truth = LEVEL - slope * (DESIGN - MIDDLE) + scatter * stats.norm.ppf(PROBABILITY)
    out = []
    for places in (plan["chosen"].values, rng.integers(0, len(LOADS), TESTS)):
        line = _with(tests, LOADS[places], normal, LEVEL, slope, scatter)
        low, high = line.interval_of_life(DESIGN, PROBABILITY)
        best = float(line.log_life(line.best, DESIGN, PROBABILITY))
        cost = float(np.log(np.exp(line.tests.middle[-TESTS:]).sum()))
        out.append((high - low, best - truth, bool(low <= truth <= high), cost))
    return out


def campaigns(number: int, seed: int = 3) -> dict[str, float]:
    """Return how chosen and random tests narrow B10, over so many campaigns."""
    rng = np.random.default_rng(seed)
    found = np.array([campaign(rng) for _ in range(number)], float)  # (campaigns, choice, 4)
    width, error, held, cost = np.moveaxis(found, 2, 0)
    root = np.sqrt(np.mean(error**2, axis=0))
    return {
        "campaigns": number,
        "rollers": ROLLERS,
        "tests": TESTS,
        "factor_chosen": round(float(np.exp(np.median(width[:, 0]))), 2),
        "factor_random": round(float(np.exp(np.median(width[:, 1]))), 2),
        "narrower": round(float(np.mean(width[:, 0] < width[:, 1])), 3),
        "error_chosen": round(float(root[0]), 3),
        "error_random": round(float(root[1]), 3),
        "cycles_chosen": round(float(np.exp(np.median(cost[:, 0])))),
        "cycles_random": round(float(np.exp(np.median(cost[:, 1])))),
        "held_chosen": round(float(held[:, 0].mean()), 3),
        "held_random": round(float(held[:, 1].mean()), 3),
    }
