"""Measure the coverage of the intervals with which a study that grows (`until`) stops, where the truth is known.

    python -m validation.benchmarks.until_sure [--runs N] [--half-width W] [--only sobol lhs morris]

Each run draws the replicates of a design, doubles them until the widest interval of all indices is narrow, and stops.
Found are the coverage at stopping of each index with its standard error, and the mean half width over the one that the
scatter of the estimates demands: 1.96 times their root mean square deviation at the size of the stop. A share of a
design point has one interval, so each probability stops by itself.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from scipy import stats

from trackroller.methods import METHODS, Design
from trackroller.methods.b10 import log_b10, share
from trackroller.methods.factor import parse
from trackroller.study.design.sampling import sample
from validation.benchmarks.command import run
from validation.benchmarks.known_indices import Function, functions

COPIES = 16
STEPS = 9
LEVELS = np.array([0.0, 1.0, 4.0])  # of the categorical function
SHARES = (0.002, 0.015, 0.03, 0.05, 0.5)
RARE = 0.03  # an event below this share has too few cases for a scatter to compare widths with
WEIGHTS = np.array([1.0, 0.5, 0.25])  # of three normal factors, whose sum is log life
Estimator = Callable[[Design], tuple[np.ndarray, np.ndarray, float]]  # values, half widths, scale of these


def categorical(unit: np.ndarray) -> np.ndarray:
    """Return w (1 + 2 (x - 1/2)) + z for the weight w of a category (its index), and two numbers x and z."""
    return np.asarray(LEVELS[unit[:, 0].astype(int)] * 2 * unit[:, 1] + unit[:, 2])


def known() -> dict[str, Function]:
    """Return the functions with their exact first-order and total indices."""
    kind, square = LEVELS.var(), (LEVELS**2).mean()
    parts = np.array([kind, LEVELS.mean() ** 2 / 3, 1 / 12, kind / 3])  # category, x, z, category with x
    first, both = parts[:3] / parts.sum(), parts[3] / parts.sum()
    assert np.isclose(parts.sum(), kind + 1 / 12 + square / 3)
    chosen = {name: functions()[name] for name in ("Ishigami", "g-function")}
    return chosen | {"category": Function(categorical, first, first + np.array([both, both, 0.0]))}


def draw(name: str, method: str, count: int, seed: int, step: int) -> Design:
    """Draw the sample of a look; it begins with those of the looks before."""
    factors: dict[str, Any] = {f"x{i}": {"uniform": [0, 1]} for i in range(count)}
    if name == "category":
        factors["x0"] = {"values": ["a", "b", "c"]}
    size = COPIES * METHODS[method].first_look << step
    if method == "morris":
        return trajectories(factors, size, seed)
    more: dict[str, Any] = {"saltelli": {"second_order": False}}.get(method, {})
    return sample(factors, method, size, seed, replicates=COPIES, **more)


def trajectories(factors: dict[str, Any], size: int, seed: int) -> Design:
    """Draw Morris trajectories of four levels with the law of `sample`, which needs 0.13 ms for each of them."""
    parsed, path = {name: parse(name, spec) for name, spec in factors.items()}, []
    for block in range(max(1, size // COPIES).bit_length()):  # so that a larger sample begins with a smaller one
        rng = np.random.default_rng([seed, block])
        many = COPIES << max(0, block - 1)
        base = rng.integers(0, 2, (many, len(parsed))) / 3
        ends = np.stack([base, base + 2 / 3], axis=1)
        for j, factor in enumerate(parsed.values()):
            if factor.discrete:
                ends[:, :, j] = rng.permuted(np.tile(np.arange(len(factor.levels)), (many, 1)), axis=1)[:, :2]
        ends = np.take_along_axis(ends, rng.permuted(np.tile([[[0], [1]]], (many, 1, len(parsed))), axis=1), axis=1)
        moves = rng.permuted(np.tile(np.arange(len(parsed)), (many, 1)), axis=1)
        moved = moves[:, None, :] < np.arange(len(parsed) + 1)[:, None]
        path.append(np.where(moved, ends[:, 1:], ends[:, :1]))
    unit = np.concatenate(path)[:size].reshape(-1, len(parsed))
    return Design({"x0": unit[:, 0]}, parsed, METHODS["morris"], unit, {"trajectories": size, "replicates": COPIES})


def of_indices(function: Function) -> Estimator:
    """Return an estimator of the headline indices of a function."""

    def estimate(design: Design) -> tuple[np.ndarray, np.ndarray, float]:
        y = function.evaluate(design.places)
        found = design.method.replicated(y, design, design.samples)
        names = design.method.narrowed
        value, high = (np.concatenate([found[name + end] for name in names]) for end in ("", "_high"))
        return value, high - value, float(np.ptp(y)) if design.method.effects else 1.0

    return estimate


def of_b10(design: Design) -> tuple[np.ndarray, np.ndarray, float]:
    """Estimate log10 B10 of a life exp(z1 + z2 / 2 + z3 / 4) with normal z."""
    life = np.exp(stats.norm.ppf(design.places) @ WEIGHTS)
    value, half = log_b10(life, np.zeros(len(life)), np.arange(len(life)) % COPIES, COPIES)
    return np.array([value]), np.array([half]), 1.0


def of_share(truth: float, design: Design) -> tuple[np.ndarray, np.ndarray, float]:
    """Estimate the probability of a life below the one that a share of all lives reaches."""
    low = stats.norm.ppf(design.places) @ WEIGHTS < stats.norm.ppf(truth) * np.sqrt((WEIGHTS**2).sum())
    value, half = share(low.astype(float), np.arange(len(low)) % COPIES, COPIES)
    return np.array([value]), np.array([half]), 1.0


def mean_effects(function: Function, count: int, listed: np.ndarray) -> np.ndarray:
    """Return mu* of a function, the mean over all steps of four levels (and all pairs of listed values)."""
    grid = np.stack(np.meshgrid(*[np.arange(3.0) if one else np.arange(4) / 3 for one in listed]), axis=-1)
    unit = grid.reshape(-1, count)
    found = np.empty(count)
    for j, one in enumerate(listed):
        effects = []
        for low, high in itertools.combinations(range(3), 2) if one else ((0.0, 2 / 3), (1 / 3, 1.0)):
            ends = [unit.copy(), unit.copy()]
            ends[0][:, j], ends[1][:, j] = low, high
            effects.append(np.abs(function.evaluate(ends[1]) - function.evaluate(ends[0])) / (1 if one else 2 / 3))
        found[j] = np.mean(effects)
    return found


def stopped(estimate: Estimator, design: Callable[[int], Design], wanted: float) -> list[tuple[np.ndarray, ...]]:
    """Return values and half widths at each look until all intervals are narrow."""
    looks: list[tuple[np.ndarray, ...]] = []
    for step in range(STEPS):
        *found, scale = estimate(design(step))
        looks.append(tuple(found))
        if np.all(looks[-1][1] <= wanted * scale):
            break
    return looks


def measured(
    estimate: Estimator, draws: Callable[[int, int], Design], truth: np.ndarray, wanted: float, runs: int
) -> dict[str, Any]:
    """Return coverage at stopping and relative width of each index, and the number of stops by look."""
    every = [stopped(estimate, partial(draws, seed), wanted) for seed in range(runs)]
    at = np.array([len(looks) - 1 for looks in every])
    value, half = (np.array([looks[-1][i] for looks in every]) for i in (0, 1))
    # all looks of a run count for the scatter at their size, so that early stops do not bias it
    scatter = np.array(
        [
            np.mean([(looks[step][0] - truth) ** 2 for looks in every if len(looks) > step], axis=0)
            for step in range(at.max() + 1)
        ]
    )
    demanded = 1.96 * np.sqrt(scatter[at].mean(axis=0))
    coverage = (np.abs(value - truth) <= half + 1e-12).mean(axis=0)
    return {
        "coverage": coverage,
        "coverage_error": np.sqrt(coverage * (1 - coverage) / runs),
        "width_over_demanded": half.mean(axis=0) / demanded,
        "bias_over_demanded": (value - truth).mean(axis=0) / demanded,
        "stops": np.bincount(at, minlength=STEPS),
    }


def measure(
    runs: int = 1000,
    half_width: float = 0.03,
    only: tuple[str, ...] = ("sobol", "saltelli", "morris", "inner_outer"),
    of: tuple[str, ...] = ("Ishigami", "g-function", "category"),
) -> dict[str, Any]:
    """Return the numbers of each design and function, the least coverage and the largest relative width."""
    found = {}
    for method in only:
        if method == "inner_outer":
            draws = partial(draw, "", "sobol", 3)
            truth = np.array([np.log10(np.exp(stats.norm.ppf(0.1) * np.sqrt((WEIGHTS**2).sum())))])
            found["inner_outer, log10 B10"] = measured(of_b10, draws, truth, half_width, runs)
            for one, wanted in itertools.product(SHARES, (half_width, half_width / 3)):
                own = measured(partial(of_share, one), draws, np.array([one]), wanted, runs)
                found[f"inner_outer, probability {one:g} within {wanted:.2g}"] = own
            continue
        for name in of:
            function = known()[name]
            count = len(function.first)
            truth = np.append(function.first, function.total) if method == "saltelli" else function.first
            if method == "morris":
                truth = mean_effects(function, count, np.arange(count) < (name == "category"))
            draws = partial(draw, name, method, count)
            found[f"{method}, {name}"] = measured(of_indices(function), draws, truth, half_width, runs)
    rare = [name for name in found if any(f"probability {one:g} " in name for one in SHARES if one < RARE)]
    return {
        "least_coverage": min(float(one["coverage"].min()) for one in found.values()),
        "largest_width": max(
            float(one["width_over_demanded"].max()) for name, one in found.items() if name not in rare
        ),
        "found": found,
    }


if __name__ == "__main__":
    run(measure, __doc__)
