"""Simulate benches with a known line, fit them, and count how often intervals hold the truth.

A bench has three load levels. 30 % of its rollers are stopped before they fail, and half of the others are inspected
only, so that their lives are known to an interval. The lives asked for, B50 and B10, lie below the tested loads.

The calibration draws the truth itself from a prior, fits with that prior, and notes the rank of the truth in its
posterior: over many benches the ranks are uniform (Cook, Gelman, Rubin 2006).
"""

from __future__ import annotations

import numpy as np
from scipy import stats

from trackroller.fit.line import Line, Tests
from trackroller.fit.posterior import Normal, posterior

SIZES = (6, 12, 24)
SLOPE, SCATTER, LEVEL = 9.0, 0.6, 13.0  # ln N at the middle load
LOADS = np.log(np.array([900.0, 1000.0, 1100.0]))
MIDDLE = float(LOADS.mean())
STOPPED = 0.742  # standard deviations by which stops lie above the median life: 30 % of the tests are stopped
BELOW = float(np.log(800.0))


def bench(rng: np.random.Generator, n: int, level: float, slope: float, scatter: float) -> Tests:
    """Return the tests of one bench."""
    stress = np.resize(LOADS, n)
    life = level - slope * (stress - MIDDLE) + scatter * rng.normal(size=n)
    low, high = life.copy(), life.copy()
    # when a test is stopped must not depend on the life that its roller would have had
    end = level - slope * (stress - MIDDLE) + scatter * (STOPPED + rng.normal(size=n))
    stopped = end < life
    low[stopped] = end[stopped]
    high[stopped] = np.inf
    seen = ~stopped & (rng.random(n) < 0.5)
    gap = rng.uniform(0.1, 0.4, n)
    start = rng.uniform(0.0, 1.0, n)
    low[seen], high[seen] = (life - start * gap)[seen], (life + (1.0 - start) * gap)[seen]
    return Tests(stress, low, high)


def usable(tests: Tests) -> bool:
    """Return whether a line with three values can be fitted: failures at two loads."""
    return len(np.unique(tests.stress[tests.failed])) > 1


def coverage(benches: int, n: int, seed: int = 1) -> dict[str, float]:
    """Return the shares of benches whose 90 % intervals hold B50 and B10, and those that lie above it."""
    rng, found = np.random.default_rng([seed, n]), []
    while len(found) < benches:
        tests = bench(rng, n, LEVEL, SLOPE, SCATTER)
        if not usable(tests):
            continue
        line, row = Line(tests), []
        for probability in (0.5, 0.1):
            truth = LEVEL - SLOPE * (BELOW - MIDDLE) + SCATTER * stats.norm.ppf(probability)
            low, high = line.interval_of_life(BELOW, probability)
            row += [low <= truth <= high, truth < low]
        found.append(row)
    share = np.mean(found, axis=0)
    names = ("b50", "b50_unsafe", "b10", "b10_unsafe")
    return {"rollers": n, "benches": benches} | dict(zip(names, share.round(4).tolist(), strict=True))


def ranks(benches: int, n: int = 12, seed: int = 2) -> np.ndarray:
    """Return the rank of the true ln B10 in the posterior of each bench [1]; truths are drawn from the prior."""
    rng, found = np.random.default_rng(seed), []
    priors = {"slope": Normal(9.0, 1.5), "log_scatter": Normal(np.log(0.6), 0.3), "log_strength": Normal(MIDDLE, 0.1)}
    at = float(np.exp(LEVEL))
    while len(found) < benches:
        # the posterior has the prior of the strength, and the density of the level that belongs to it
        slope = rng.normal(9.0, 1.5)
        scatter = float(np.exp(rng.normal(np.log(0.6), 0.3)))
        strength = rng.normal(MIDDLE, 0.1)
        if not 1.0 < slope < 60.0:
            continue
        level = LEVEL + slope * (strength - MIDDLE)
        tests = bench(rng, n, level, slope, scatter)
        if not tests.failed.any():
            continue
        line = Line(tests)
        own = posterior(line, priors, at)
        truth = level - slope * (BELOW - MIDDLE) + scatter * stats.norm.ppf(0.1)
        lives = line.log_life(own.values, BELOW, 0.1)
        found.append(float(own.weight[lives < truth].sum()))
    return np.array(found)


def measure(benches: int) -> dict[str, object]:
    """Return coverage by size, and the test of the ranks against a uniform distribution."""
    found = ranks(benches)
    return {
        "stopped": round(float(stats.norm.sf(STOPPED / np.sqrt(2.0))), 2),
        "nominal": {"held": 0.9, "below": 0.05},
        "coverage": [coverage(benches, n) for n in SIZES],
        "ranks": {
            "benches": benches,
            "p_uniform": round(float(stats.kstest(found, "uniform").pvalue), 4),
            "deciles": np.histogram(found, bins=10, range=(0.0, 1.0))[0].tolist(),
        },
    }
