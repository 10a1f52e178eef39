"""Compare the search for designs with the dense grid of all designs, and with as many random designs.

    python -m validation.benchmarks.optimum [--seeds N]

Each task has a grid of real, integer and categorical choices that is solved completely. A search over its levels may
solve a tenth of them. Found is the share of the hypervolume of the grid's front, with goals normalised over this front,
lives and powers by their logarithm, and the reference point at 1.1.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

import trackroller as tr
from trackroller.methods.optimise import Gene, first_generation, next_generation
from trackroller.results.pareto import pareto_mask
from trackroller.study.file.search import Budget
from validation.benchmarks.command import run

ENOUGH, SHARE = 0.99, 10
TASKS = {"life, power": (0, 1), "life, pressure": (0, 2), "life, power, pressure": (0, 1, 2)}
MATERIALS = (
    ("1.7225-normalised",) * 2,
    ("EN AW-7075",) * 2,
    ("POM", "1.7225-normalised"),
    ("PA6", "1.7225-normalised"),
)
STUDY = {
    "name": "dense",
    "base": {"guide_curve_radius": "inf", "motor_force": -10, "guide_overrollings_per_hour": 600},
    "factors": {
        "profile_ratio": {"linspace": [1.05, 1.6, 24]},
        "guide_profile_radius": {"linspace": [4, 9, 12]},
        "contact_angle": {"linspace": [25, 45, 11]},
        "material_pair": {"values": [list(pair) for pair in MATERIALS]},
        "roller_profile_radius": {"expression": "-profile_ratio * guide_profile_radius"},
        "friction_coefficient": {"values": [0.2]},
    },
    "outputs": ["forces", "contact", "friction_work", "peak_stress", "life"],
    "contact_model": "kalker_table",
    "accuracy": "preview",
}


def hypervolume(costs: np.ndarray, reference: Sequence[float] | np.ndarray) -> float:
    """Return the volume between a front and a reference point, by slices along the last goal.

    Parameters
    ----------
    costs : smaller is better, shape (n, goals)
    reference : worst value that counts of each goal

    Examples
    --------
    >>> hypervolume(np.array([[0.0, 0.5], [0.5, 0.0]]), [1.0, 1.0])
    0.75
    """
    point = np.asarray(reference, dtype=float)
    inside = costs[(costs < point).all(axis=1)]
    if not len(inside):
        return 0.0
    if len(point) == 1:
        return float(point[0] - inside.min())
    inside = inside[np.argsort(inside[:, -1], kind="stable")]
    ends = np.append(inside[1:, -1], point[-1])
    total = 0.0
    for i, (low, high) in enumerate(zip(inside[:, -1], ends, strict=True)):
        if high > low:
            total += (high - low) * hypervolume(inside[: i + 1, :-1], point[:-1])
    return float(total)


def dense() -> tuple[np.ndarray, np.ndarray, tuple[int, ...]]:
    """Return costs (n, goals) and violations (n,) of all designs of the grid, and its shape."""
    results = tr.run(STUDY, progress=False)
    power = results.column("friction_power_1") + results.column("friction_power_2")
    pressure = np.fmax(results.column("max_pressure_1"), results.column("max_pressure_2"))
    costs = np.stack([-np.log10(results.column("pair_life_hours")), np.log10(power), pressure], axis=1)
    usable = results.valid & np.isfinite(costs).all(axis=1)
    return costs, 1.0 - usable, results.design.meta["shape"]


def searched(costs: np.ndarray, violation: np.ndarray, shape: tuple[int, ...], designs: int, seed: int) -> np.ndarray:
    """Return the numbers of the designs that a search solves."""
    genes = [Gene(levels, ordered=number < len(shape) - 1) for number, levels in enumerate(shape)]
    many = Budget(designs=designs).generation
    known, number = first_generation(genes, many, seed), 1
    while True:
        rows = np.ravel_multi_index(tuple(known.astype(int).T), shape)
        if len(rows) >= designs:
            return rows
        some = min(many, designs - len(rows))
        drawn = next_generation(genes, known, costs[rows], violation[rows], some, (seed, number))
        known, number = np.concatenate([known, drawn]), number + 1


def front(costs: np.ndarray, violation: np.ndarray) -> np.ndarray:
    """Return the costs of the designs that are valid and that no other one beats."""
    valid = costs[violation == 0]
    return valid[pareto_mask(valid, ["min"] * costs.shape[1])]


def measure(seeds: int = 20) -> dict[str, Any]:
    """Return for each task: designs, and shares of the hypervolume by searches and by random designs."""
    every, violation, shape = dense()
    told = {}
    for name, goals in TASKS.items():
        costs, designs = every[:, list(goals)], len(every) // SHARE
        best = front(costs, violation)
        low, scale, worst = best.min(axis=0), np.ptp(best, axis=0), [1.1] * len(goals)

        def volume(
            own: np.ndarray, low: np.ndarray = low, scale: np.ndarray = scale, worst: list[float] = worst
        ) -> float:
            return hypervolume((own - low) / scale, worst)

        whole = volume(best)
        chosen = [searched(costs, violation, shape, designs, seed) for seed in range(seeds)]
        drawn = [np.random.default_rng(seed).choice(len(costs), designs, replace=False) for seed in range(seeds)]
        shares, random = ([volume(front(costs[r], violation[r])) / whole for r in each] for each in (chosen, drawn))
        told[name] = {
            "grid": len(costs),
            "designs": designs,
            "front": len(best),
            "search_least": min(shares),
            "search_median": float(np.median(shares)),
            "seeds_with_enough": int(sum(share >= ENOUGH for share in shares)),
            "random_median": float(np.median(random)),
            "random_best": max(random),
        }
    return told


if __name__ == "__main__":
    run(measure, __doc__)
