"""Measure the errors of the exact theory at `standard`, and how often `force_error_estimate` covers them.

    python -m validation.benchmarks.kalker_errors [--cases N] [--seed S] [--finer ELEMENTS]

Random designs at `standard` against `--finer` elements and the finest search for peaks. The true error of the friction
forces is the change of F_T or F_A, whichever is larger. Wanted: the estimate is exceeded in less than 1 % of the
contacts, and in the median it is at most five times the true error.
"""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

import trackroller as tr
from trackroller.parameters.accuracy import PRESETS
from validation.benchmarks.command import run
from validation.benchmarks.samples import random_designs

OUTPUTS = ("forces", "contact", "peak_stress", "friction_work")
PERCENTILES = (50, 95, 99)


def levels(error: np.ndarray) -> dict[str, float]:
    """Return percentiles of the known errors."""
    return {f"{p}_percent": float(np.nanpercentile(error, p)) for p in PERCENTILES}


def measure(cases: int = 500, seed: int = 17, finer: int = 80) -> dict[str, Any]:
    """Return percentiles of the errors, and of the estimate; the solution with `finer` elements is taken as exact.

    Forces over mu F_N, moments over mu F_N sqrt(a b), the others relative to themselves.
    """
    designs = random_designs(cases, seed)
    finest = dataclasses.replace(PRESETS["reference"], elements=finer)
    ds, best = (
        tr.solve(designs, outputs=OUTPUTS, contact_model="kalker", accuracy=accuracy)
        for accuracy in ("standard", finest)
    )
    limit = best.normal_force * np.array([c.friction_coefficient for c in designs])[:, None]
    scales = {
        "lateral_force": limit,
        "driving_force": limit,
        "spin_moment": limit * np.sqrt(best.semi_axis_lateral * best.semi_axis_rolling),
        **{name: best[name] for name in ("normal_force", "friction_energy_per_distance", "peak_stress")},
    }
    rolls = (best.regime.values == 0) & (ds.regime.values == 0)
    off = {name: np.abs((ds[name] - best[name]) / scale).values[rolls] for name, scale in scales.items()}
    true, estimate = np.maximum(off["lateral_force"], off["driving_force"]), ds.force_error_estimate.values[rolls]
    return {
        "errors": {name: levels(error) for name, error in off.items()}
        | {"energy_residual": levels(np.abs(ds.energy_residual.values[rolls]))},
        "contacts": true.size,
        "exceeded": np.mean(true > estimate),
        "median_estimate_over_median_true": np.median(estimate) / np.median(true),
    }


if __name__ == "__main__":
    run(measure, __doc__)
