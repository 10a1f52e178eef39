"""Measure the coverage of the intervals with which a study that grows (`until`) stops, where the truth is known.

    python -m validation.benchmarks.until_sure [--runs N] [--half-width W] [--only sobol lhs morris]

Each run draws the replicates of a design, doubles them until the widest interval of all indices is narrow, and stops.
Found are the coverage at stopping of each index, and the mean half width over the one that the scatter of the estimates
demands: 1.96 times their root mean square deviation at the size of the stop.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from scipy import stats

from trackroller.analysis.replicates import HEADLINES, log_b10, replicated
from trackroller.study.design.sampling import SampledDesign, sample
from validation.benchmarks.command import run
from validation.benchmarks.known_indices import Function, functions

COPIES = 16
STEPS = 9
FIRST = {"morris": 2}  # samples of a replicate at the first look, as in `trackroller.study.file.until`
LEVELS = np.array([0.0, 1.0, 4.0])  # of the categorical function
Estimator = Callable[[SampledDesign], tuple[np.ndarray, np.ndarray]]  # values and half widths


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


def draw(name: str, method: str, count: int, seed: int, step: int) -> SampledDesign:
    """Draw the sample of a look; it begins with those of the looks before."""
    factors: dict[str, Any] = {f"x{i}": {"uniform": [0, 1]} for i in range(count)}
    if name == "category":
        factors["x0"] = {"values": ["a", "b", "c"]}
    size = COPIES * FIRST.get(method, 8) << step
    more: dict[str, Any] = {"saltelli": {"second_order": False}}.get(method, {})
    if method == "lhs":
        more = {"grown_from": tuple(size >> back for back in range(step, 0, -1))}
    return sample(factors, method, size, seed, replicates=COPIES, **more)


def of_indices(function: Function) -> Estimator:
    """Return an estimator of the headline indices of a function."""

    def estimate(design: SampledDesign) -> tuple[np.ndarray, np.ndarray]:
        samples = int(design.meta.get("base_samples") or design.meta.get("trajectories") or design.size)
        found = replicated(function.evaluate(design.places), design, samples)
        names = HEADLINES[design.method]
        value, high = (np.concatenate([found[name + end] for name in names]) for end in ("", "_high"))
        return value, high - value

    return estimate


def of_b10(design: SampledDesign) -> tuple[np.ndarray, np.ndarray]:
    """Estimate log10 B10 of a life exp(z1 + z2 / 2 + z3 / 4) with normal z."""
    life = np.exp(stats.norm.ppf(design.places) @ [1.0, 0.5, 0.25])
    value, half = log_b10(life, np.zeros(len(life)), np.arange(len(life)) % COPIES, COPIES)
    return np.array([value]), np.array([half])


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


def stopped(estimate: Estimator, design: Callable[[int], SampledDesign], wanted: float) -> list[tuple[np.ndarray, ...]]:
    """Return values and half widths at each look until all intervals are narrow."""
    looks = []
    for step in range(STEPS):
        looks.append(estimate(design(step)))
        if np.all(looks[-1][1] <= wanted):
            break
    return looks


def measured(
    estimate: Estimator, draws: Callable[[int, int], SampledDesign], truth: np.ndarray, wanted: float, runs: int
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
    return {
        "coverage": (np.abs(value - truth) <= half + 1e-12).mean(axis=0),
        "width_over_demanded": half.mean(axis=0) / demanded,
        "bias_over_demanded": (value - truth).mean(axis=0) / demanded,
        "stops": np.bincount(at, minlength=STEPS),
    }


def measure(
    runs: int = 1000,
    half_width: float = 0.03,
    only: tuple[str, ...] = ("sobol", "lhs", "saltelli", "morris", "inner_outer"),
    of: tuple[str, ...] = ("Ishigami", "g-function", "category"),
) -> dict[str, Any]:
    """Return the numbers of each design and function, the least coverage and the largest relative width."""
    found = {}
    for method in only:
        if method == "inner_outer":
            truth = np.array([np.log10(np.exp(stats.norm.ppf(0.1) * np.sqrt(1 + 0.25 + 0.0625)))])
            found["inner_outer, log10 B10"] = measured(of_b10, partial(draw, "", "lhs", 3), truth, half_width, runs)
            continue
        for name in of:
            function = known()[name]
            count = len(function.first)
            truth, wanted = function.first, half_width
            if method == "saltelli":
                truth = np.append(function.first, function.total)
            elif method == "morris":
                truth = mean_effects(function, count, np.arange(count) < (name == "category"))
                wanted = half_width * truth.max()
            draws = partial(draw, name, method, count)
            found[f"{method}, {name}"] = measured(of_indices(function), draws, truth, wanted, runs)
    return {
        "least_coverage": min(float(one["coverage"].min()) for one in found.values()),
        "largest_width": max(float(one["width_over_demanded"].max()) for one in found.values()),
        "found": found,
    }


if __name__ == "__main__":
    run(measure, __doc__)
