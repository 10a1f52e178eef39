"""Compare `force_error_estimate` with the true error of friction forces in the exact theory.

    python -m validation.benchmarks.force_errors [--cases N] [--seed S] [--finer ELEMENTS] [--accuracy PRESET]

The true error is the change of F_T or F_A, whichever is larger, to `--finer` elements, over mu F_N. Wanted: the
estimate is exceeded in less than 1 % of the contacts, and in the median it is at most five times the true error.
"""

from __future__ import annotations

import dataclasses

import numpy as np

import trackroller as tr
from trackroller.roller.accuracy import PRESETS
from validation.benchmarks.command import run
from validation.benchmarks.samples import random_designs


def estimates(cases: list[tr.Case], finer: int, accuracy: str = "standard") -> tuple[np.ndarray, np.ndarray]:
    """Return the estimated and the true errors of the contacts that roll, (m,)."""
    settings = dataclasses.replace(PRESETS["reference"], elements=finer)
    found, best = (
        tr.solve(cases, outputs=("forces",), contact_model="kalker", accuracy=a) for a in (accuracy, settings)
    )
    capacity = best.normal_force.values * np.array([c.friction_coefficient for c in cases])[:, None]
    true = np.maximum(*(np.abs(found[q] - best[q]).values / capacity for q in ("lateral_force", "driving_force")))
    rolls = ((found.regime == 0) & (best.regime == 0)).values[:, None] & np.isfinite(true)
    return found.force_error_estimate.values[rolls], true[rolls]


def summary(told: np.ndarray, true: np.ndarray) -> dict[str, float]:
    """Return how often the estimate is exceeded, how far it lies above the truth, and percentiles of the errors."""
    return {
        "contacts": int(true.size),
        "exceeded": float(np.mean(true > told)),
        "median_told": float(np.median(told)),
        "median_told_over_median_true": float(np.median(told) / np.median(true)),
        "median_of_told_over_true": float(np.median(told / np.maximum(true, 1e-9))),
        **{f"true_{p}_percent": float(np.percentile(true, p)) for p in (50, 95, 99)},
    }


def measure(cases: int = 500, seed: int = 17, finer: int = 80, accuracy: str = "standard") -> dict[str, float]:
    """Return the summary for random designs; the solution with `finer` elements is taken as exact."""
    return summary(*estimates(random_designs(cases, seed), finer, accuracy))


if __name__ == "__main__":
    run(measure, __doc__)
