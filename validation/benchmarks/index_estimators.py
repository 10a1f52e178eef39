"""Compare the sensitivity estimators with SALib, and the designs with pyDOE, where the truth is known.

    python -m validation.benchmarks.index_estimators [--seeds N] [--only sobol first delta pairs]

Each estimator runs on samples of many seeds. For each function and estimator it states the largest bias and root mean
square error over the factors, the smallest and mean coverage of the 95 % intervals, the mean half width and the time of
one analysis.
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np
import pydoe
from SALib.analyze import delta as salib_delta
from SALib.analyze import hdmr, rbd_fast
from SALib.analyze import sobol as salib_sobol

from trackroller.methods import arrays, given_data
from trackroller.methods.delta import delta
from trackroller.methods.interactions import pairs
from trackroller.methods.saltelli import sobol
from validation.benchmarks.command import run
from validation.benchmarks.known_indices import (
    Data,
    category_rows,
    exact_delta,
    functions,
    normal_pair,
    problem,
    random_rows,
    rows_of_factor,
    saltelli_rows,
)

RESAMPLES = 300
DELTA_RESAMPLES = 10  # SALib's 100 would take ten times longer and change the mean little
Estimate = tuple[np.ndarray, np.ndarray, np.ndarray]  # values, lower and upper bounds
Estimator = Callable[[np.ndarray, np.ndarray, int], Estimate]  # quantiles, output, seed


def summary(found: list[Estimate], truth: np.ndarray, seconds: float) -> dict[str, float]:
    """Summarise estimates of many seeds, each of shape (k,), against the truth (k,)."""
    value, low, high = (
        np.array([np.broadcast_to(one[i], truth.shape) for one in found], dtype=float) for i in range(3)
    )
    inside = ((low <= truth + 1e-9) & (truth - 1e-9 <= high)).mean(axis=0)
    return {
        "bias": float(np.abs(value.mean(axis=0) - truth).max()),
        "rmse": float(np.sqrt(((value - truth) ** 2).mean(axis=0)).max()),
        "least_coverage": float(inside.min()),
        "coverage": float(inside.mean()),
        "half_width": float(((high - low) / 2).mean()),
        "ms": 1e3 * seconds / len(found),
    }


def numbers(estimator: Estimator, data: Callable[[int], Data], truth: np.ndarray, seeds: int) -> dict[str, float]:
    """Run an estimator on the data of the seeds 0 to `seeds` - 1."""
    rows = [data(seed) for seed in range(seeds)]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of SALib, on bins and resamples
        estimator(*rows[0], 0)  # imports and caches
        start = time.process_time()
        found = [estimator(*rows[seed], seed) for seed in range(seeds)]
    return summary(found, truth, time.process_time() - start)


def our_sobol(unit: np.ndarray, y: np.ndarray, seed: int) -> Estimate:
    """Return first-order and total indices of a Saltelli design."""
    found = sobol(y, unit.shape[1], True, seed, RESAMPLES)
    value, low, high = (np.append(found["S1" + end], found["ST" + end]) for end in ("", "_low", "_high"))
    return value, low, high


def their_sobol(unit: np.ndarray, y: np.ndarray, seed: int) -> Estimate:
    """Return first-order and total indices by SALib, whose intervals do not repeat with seed 0."""
    found = salib_sobol.analyze(problem(unit.shape[1]), y, num_resamples=RESAMPLES, seed=seed + 1)
    return _symmetric(np.append(found["S1"], found["ST"]), np.append(found["S1_conf"], found["ST_conf"]))


def our_first(unit: np.ndarray, y: np.ndarray, seed: int) -> Estimate:
    """Return first-order indices from given data; whole numbers are categories."""
    found = given_data.firsts(y, unit, (unit % 1 != 0).any(axis=0), seed)
    return found["first"], found["first_low"], found["first_high"]


def their_first(unit: np.ndarray, y: np.ndarray, seed: int) -> Estimate:
    """Return first-order indices by SALib's RBD-FAST without our treatment of categories."""
    found = rbd_fast.analyze(problem(unit.shape[1]), unit, y, num_resamples=given_data.FAST_RESAMPLES, seed=seed)
    return _symmetric(np.array(found["S1"], float), np.array(found["S1_conf"], float))


def our_delta(unit: np.ndarray, y: np.ndarray, seed: int) -> Estimate:
    """Return delta of one factor."""
    value, low, high = (np.array([v]) for v in delta(y, unit[:, 0], seed=seed)[:3])
    return value, low, high


def their_delta(unit: np.ndarray, y: np.ndarray, seed: int) -> Estimate:
    """Return SALib's bias-reduced delta of the plain rows; its `analyze` also computes two further kinds."""
    size = len(y)
    classes = int(np.round(min(np.ceil(size ** (2 / (7 + np.tanh((1500 - size) / 500)))), 48)))
    edges, grid = np.linspace(0, size, classes + 1), np.linspace(y.min(), y.max(), 100)
    np.random.seed(seed + 1)  # noqa: NPY002 - SALib draws from NumPy's global generator
    args = (y, grid, unit[:, 0], edges, DELTA_RESAMPLES, 0.95, size, "raw", None, "x", 10)
    value, half, _ = salib_delta.bias_reduced_delta(*args)
    return _symmetric(np.array([value]), np.array([half]))


def our_pairs(unit: np.ndarray, y: np.ndarray, seed: int) -> Estimate:
    """Return the shares of the interactions of three factors."""
    found = pairs(y, unit, np.ones(3, bool), seed)
    value, low, high = (found["interaction_share" + end][np.triu_indices(3, 1)] for end in ("", "_low", "_high"))
    return value, low, high


def their_pairs(unit: np.ndarray, y: np.ndarray, seed: int) -> Estimate:
    """Return the interaction indices by SALib's RS-HDMR."""
    found = hdmr.analyze(problem(3), unit, y, maxorder=2, K=10, R=max(300, len(y) // 2), seed=seed + 1)
    return _symmetric(found["S"][3:6], found["S_conf"][3:6])


ESTIMATORS: dict[str, dict[str, Estimator]] = {
    "sobol": {"ours": our_sobol, "SALib sobol": their_sobol},
    "first": {"ours": our_first, "SALib rbd_fast": their_first},
    "delta": {"ours": our_delta, "SALib delta": their_delta},
    "pairs": {"ours": our_pairs, "SALib hdmr": their_pairs},
}


def cases() -> Iterator[tuple[str, str, Callable[[int], Data], np.ndarray]]:
    """Yield the kind of index, the name, the data (from a seed) and the exact values of each comparison."""
    for name, f in functions().items():
        rows = partial(saltelli_rows, f, 128)
        yield "sobol", f"Sobol indices, {name}, 128 blocks", rows, np.append(f.first, f.total)
        for size in (256, 1024):
            yield "first", f"first-order index, {name}, {size} rows", partial(random_rows, f, size), f.first
    v = np.array([1 / 12, 2.0])
    yield "first", "first-order index, number and category, 400 rows", partial(category_rows, 400), v / v.sum()
    for size in (400, 2000):
        for r, factor in ((0.0, 0), (0.1, 0), (0.3, 0), (0.7, 0), (0.7, 3), (0.95, 0), (0.99, 0)):
            name = f"delta, normal pair r = {r}{', exponential' if factor else ''}, {size} rows"
            yield "delta", name, partial(normal_pair, size, r, factor), np.array([exact_delta(r)])
    f = functions()["Ishigami"]
    for i, known in enumerate((0.260, 0.425, 0.209)):  # by quadrature: densities of 800,000 rows at 60 values of x
        yield "delta", f"delta, Ishigami, x{i + 1}, 400 rows", partial(rows_of_factor, f, 400, i), np.array([known])
    for size in (400, 1024):
        truth = np.array([0.0, f.total[2], 0.0])
        yield "pairs", f"interactions, Ishigami, {size} rows", partial(random_rows, f, size), truth


def designs() -> dict[str, dict[str, list[int]]]:
    """Compare the classical designs with pyDOE's, row for row: the numbers of factors by finding."""
    theirs: dict[str, tuple[Callable[[int], np.ndarray], range]] = {
        "central_composite": (lambda k: pydoe.ccdesign(k, center=(0, 1), face="ccf"), range(1, 9)),
        "box_behnken": (lambda k: pydoe.bbdesign(k, center=1), range(3, 8)),
        "plackett_burman": (lambda k: np.concatenate([half := pydoe.pbdesign(k), -half]), range(1, 48)),
    }
    out: dict[str, dict[str, list[int]]] = {}
    for name, (design, counts) in theirs.items():
        kinds = out.setdefault(name, {})
        for count in counts:
            ours = getattr(arrays, name)(count)
            try:
                found = design(count)
            except (ValueError, AssertionError, IndexError):
                kinds.setdefault("pyDOE fails", []).append(count)
                continue
            if found.shape != ours.shape:
                kind = "pyDOE has more rows" if len(found) > len(ours) else "pyDOE has fewer rows"
            else:
                kind = "the same rows" if np.array_equal(found, ours) else "as many rows, others or in another order"
            kinds.setdefault(kind, []).append(count)
    return out


def _symmetric(value: np.ndarray, half: np.ndarray) -> Estimate:
    return value, value - half, value + half


def measure(seeds: int = 200, only: tuple[str, ...] = tuple(ESTIMATORS)) -> dict[str, Any]:
    """Return the numbers of each comparison and estimator, and the comparison of the designs."""
    found = {}
    for kind, name, data, truth in cases():
        if kind in only:
            count = seeds if kind in ("sobol", "first") else max(2, seeds // 2)  # the others are slow
            found[name] = {who: numbers(one, data, truth, count) for who, one in ESTIMATORS[kind].items()}
    return {"estimators": found, "designs": designs()}


if __name__ == "__main__":
    run(measure, __doc__)
