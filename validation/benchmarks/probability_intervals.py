"""Measure the coverage of the intervals of probabilities from stratified samples, where the truth is known.

    python -m validation.benchmarks.probability_intervals [--seeds N]

Each entry is an event over four uniform factors and a design. `ours` is the interval of
`trackroller.methods.probability`; `Wilson` takes the samples as independent, for the mean of four design points all
four times as many. Found are the coverage and the mean half width of both, and the standard deviation of the
estimate from seed to seed. An interval of a random sample would need a half width of about twice that deviation.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy import stats
from scipy.stats import qmc

from trackroller.methods.probability import probabilities
from validation.benchmarks.command import run

COUNT = 4  # factors
NORMAL = np.array([1.0, 0.5, 0.3, 0.1])  # weights of the normal scores of the factors


def _load(unit: np.ndarray) -> np.ndarray:
    return np.asarray(stats.norm.ppf(unit) @ NORMAL)


EVENTS: dict[str, tuple[Callable[[np.ndarray], np.ndarray], int]] = {  # event and number of design points
    "one factor, 50 %": (lambda u: u[:, 0] < 0.5037, 1),
    "one factor, 95 %": (lambda u: u[:, 0] < 0.953, 1),
    "sum of factors": (lambda u: _load(u) < 1.0, 1),
    "sum of factors, rare": (lambda u: _load(u) < 2.4, 1),
    "largest of factors": (lambda u: u.max(axis=1) < 0.95, 1),
    "product of two": (lambda u: (u[:, 0] - 0.5) * (u[:, 1] - 0.5) > 0.01, 1),
    "corner of two": (lambda u: ~((u[:, 0] > 0.8) & (u[:, 1] > 0.8)), 1),
    "scatter of the material": (lambda u: stats.norm.cdf((_load(u) + 1) / 0.5), 1),
    "rare half chance": (lambda u: 0.5 * (u[:, :2].min(axis=1) > 0.9), 1),
    "mean of four points, sum": (lambda u: np.mean([_load(u) < t for t in (0.0, 0.5, 1.0, 1.5)], axis=0), 4),
    "mean of four points, product": (
        lambda u: np.mean([(u[:, 0] - 0.5) * (u[:, 1] - 0.5) > t for t in (0.0, 0.01, 0.02, 0.03)], axis=0),
        4,
    ),
}
DESIGNS: dict[str, Callable[[int, int], np.ndarray]] = {
    "lhs": lambda n, seed: qmc.LatinHypercube(d=COUNT, rng=np.random.default_rng(seed)).random(n),
    "sobol": lambda n, seed: qmc.Sobol(d=COUNT, rng=np.random.default_rng(seed)).random(n),
}


def wilson(share: np.ndarray, count: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return Wilson's 95 % bounds of shares of `count` independent samples, shape of `share`."""
    z = stats.norm.ppf(0.975)
    middle = (share + z**2 / (2 * count)) / (1 + z**2 / count)
    half = z * np.sqrt(share * (1 - share) / count + z**2 / (4 * count**2)) / (1 + z**2 / count)
    return middle - half, middle + half


def _hits(unit: np.ndarray) -> np.ndarray:
    return np.stack([np.asarray(event(unit), dtype=float) for event, _ in EVENTS.values()], axis=1)


def truth() -> np.ndarray:
    """Return the probability of each event from 2^20 points of scrambled Sobol sequences, shape (events,)."""
    return np.mean([_hits(DESIGNS["sobol"](1 << 18, seed)).mean(axis=0) for seed in range(1000, 1004)], axis=0)


def coverage(design: str, size: int, seeds: int, exact: np.ndarray) -> dict[str, np.ndarray]:
    """Return coverage and mean half width of both intervals and the deviation of the estimate, shape (events,)."""
    points = np.array([points for _, points in EVENTS.values()])
    found: dict[str, list[np.ndarray]] = {key: [] for key in ("ours", "ours half", "wilson", "wilson half", "share")}
    for seed in range(seeds):
        unit = DESIGNS[design](size, seed)
        share, low, high = probabilities(_hits(unit), unit, np.ones(COUNT, dtype=bool))
        for name, (a, b) in (("ours", (low, high)), ("wilson", wilson(share, size * points))):
            found[name].append((a <= exact + 1e-9) & (exact - 1e-9 <= b))
            found[f"{name} half"].append((b - a) / 2)
        found["share"].append(share)
    out = {key: np.mean(values, axis=0) for key, values in found.items() if key != "share"}
    return out | {"deviation": np.std(found["share"], axis=0)}


def measure(seeds: int = 400) -> dict[str, Any]:
    """Return the numbers of each design, size and event, and the least coverage of our intervals."""
    warnings.simplefilter("ignore")  # of Sobol sequences whose size is no power of two
    exact, found = truth(), {}
    for design in DESIGNS:
        for size in (25, 100, 400):
            by_kind = coverage(design, size, seeds, exact)
            for i, name in enumerate(EVENTS):
                found[f"{design}, {size}, {name}"] = {"truth": exact[i], **{k: v[i] for k, v in by_kind.items()}}
    return {"least_coverage": min(one["ours"] for one in found.values()), "events": found}


if __name__ == "__main__":
    run(measure, __doc__)
