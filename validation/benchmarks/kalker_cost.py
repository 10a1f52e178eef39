"""Measure the cost of the exact theory over that of full sliding, and its errors.

    python -m validation.benchmarks.kalker_cost [--cases N] [--seed S] [--finer ELEMENTS] [--skip-accuracy]

All ratios come from one run on the same cases, in processor time of one thread. The yardstick is a complete case
(forces, contact, four peaks, life) in full sliding at accuracy `standard`. Errors are those of the exact theory at
`standard` against itself with `--finer` elements and the finest search for peaks.
"""

from __future__ import annotations

import dataclasses
import os
import time
from typing import Any
from unittest import mock

import numpy as np

os.environ["NUMBA_NUM_THREADS"] = "1"

import trackroller as tr
from trackroller.contact.kalker import batch
from trackroller.roller.accuracy import PRESETS
from validation.benchmarks.command import run
from validation.benchmarks.samples import geometry_study, load_study, random_designs

OUTPUTS = ("forces", "contact", "peak_stress", "life")
PERCENTILES = (50, 95, 99)
SETTINGS: dict[str, dict[str, Any]] = {
    "sliding": {"contact_model": "sliding"},
    "standard": {"contact_model": "kalker"},
    "preview": {"contact_model": "kalker", "accuracy": "preview"},
}


def costs(cases: list[tr.Case], settings: dict[str, dict[str, Any]], repeats: int = 5) -> dict[str, float]:
    """Return the processor time of a complete case [s] with each of the settings, the least of `repeats`.

    The settings take turns, so that other work on the machine delays all of them alike.
    """
    times: dict[str, list[float]] = {name: [] for name in settings}
    given = {name: {"outputs": OUTPUTS} | options for name, options in settings.items()}
    for options in given.values():
        tr.solve(cases[:2], **options)
    for _ in range(repeats):
        for name, options in given.items():
            start = time.process_time()
            tr.solve(cases, **options)
            times[name].append(time.process_time() - start)
    return {name: min(spent) / len(cases) for name, spent in times.items()}


def solved_patches(cases: list[tr.Case]) -> float:
    """Return how many patches a case the elements solve at `standard`, coarser grids of extrapolation not counted."""
    count = 0
    plain = batch.solve_batch

    def counted(patches, law, control, found):
        nonlocal count
        count += patches.ratio.size if found.traction.shape[-1] >= PRESETS["standard"].elements else 0
        plain(patches, law, control, found)

    with mock.patch.object(batch, "solve_batch", counted):
        tr.solve(cases, outputs=OUTPUTS, contact_model="kalker")
    return count / len(cases)


def ratios(cases: list[tr.Case]) -> dict[str, float]:
    """Return the costs of the exact theory over that of full sliding."""
    found = costs(cases, SETTINGS)
    return {
        "sliding_ms": 1e3 * found["sliding"],
        "kalker_standard_over_sliding": found["standard"] / found["sliding"],
        "kalker_preview_over_sliding": found["preview"] / found["sliding"],
        "solved_patches_a_case": solved_patches(cases),
    }


def errors(cases: list[tr.Case], finer: int) -> dict[str, dict[str, float]]:
    """Return percentiles of the errors of `standard` against `finer` elements.

    Forces over mu F_N, moments over mu F_N sqrt(a b), the others relative to themselves.
    """
    finest = dataclasses.replace(PRESETS["reference"], elements=finer)
    outputs = (*OUTPUTS, "friction_work")
    found, best = (
        tr.solve(cases, outputs=outputs, contact_model="kalker", accuracy=accuracy) for accuracy in ("standard", finest)
    )
    limit = best.normal_force * np.array([c.friction_coefficient for c in cases])[:, None]
    size = np.sqrt(best.semi_axis_lateral * best.semi_axis_rolling)
    scales = {
        "lateral_force": limit,
        "driving_force": limit,
        "spin_moment": limit * size,
        **{name: best[name] for name in ("normal_force", "friction_energy_per_distance", "peak_stress")},
    }
    rolls = (best.regime.values == 0) & (found.regime.values == 0)
    balance = np.abs(found.energy_residual.values[rolls])
    out = {"energy_residual": {f"{p}_percent": float(np.percentile(balance, p)) for p in PERCENTILES}}
    for name, scale in scales.items():
        off = np.abs((found[name] - best[name]) / scale).values
        out[name] = {f"{p}_percent": float(np.nanpercentile(off, p)) for p in PERCENTILES}
    return out


def measure(cases: int = 100, seed: int = 1, finer: int = 96, skip_accuracy: bool = False) -> dict[str, Any]:
    """Return the ratios on three samples and the errors on the random one; `finer` elements are taken as exact."""
    studies = {
        "loads": load_study(cases, seed),
        "geometries": geometry_study(cases, seed),
        "random": random_designs(cases, seed),
    }
    found: dict[str, Any] = {name: ratios(sample) for name, sample in studies.items()}
    return found if skip_accuracy else found | {"errors_of_random": errors(studies["random"], finer)}


if __name__ == "__main__":
    run(measure, __doc__)
