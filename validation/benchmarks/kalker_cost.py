"""Measure the cost of the exact theory relative to full sliding, and its error.

    python -m validation.benchmarks.kalker_cost [--cases N] [--seed S] [--finer ELEMENTS] [--skip-accuracy]

All ratios come from one run on the same cases, in processor time of one thread. The yardstick is a complete case
(forces, contact, four peaks, life) in full sliding at accuracy `standard`. Errors are those of the exact theory at
`standard` against itself with `--finer` elements and the finest search for peaks.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import math
import os
import time
from typing import Any
from unittest import mock

import numpy as np

os.environ["NUMBA_NUM_THREADS"] = "1"

import trackroller as tr
from trackroller.contact.kalker import batch
from trackroller.materials import load_database
from trackroller.roller.accuracy import PRESETS
from validation.benchmarks.speed import geometry_study, load_study

OUTPUTS = ("forces", "contact", "peak_stress", "life")
PERCENTILES = (50, 95, 99)


def random_designs(n: int, seed: int) -> list[tr.Case]:
    """Return n random rollers: all shapes, tracks, frictions and shipped material pairs that rollers come in."""
    rng = np.random.default_rng(seed)
    names = sorted(load_database().materials)
    found = []
    for _ in range(n):
        angle, contour = rng.uniform(10.0, 75.0), 10.0 ** rng.uniform(0.3, 1.3)
        radius = contour * 10.0 ** rng.uniform(-0.1, 1.0)
        outer = 10.0 ** rng.uniform(math.log10(20.0), 3.5)
        inner = -radius * 10.0 ** rng.uniform(math.log10(1.2), 2.0)
        friction, radial = 10.0 ** rng.uniform(-2.0, 0.0), -contour * rng.uniform(5.0, 60.0)
        found.append(
            tr.Case(
                axis_distance=radius + contour * math.cos(math.radians(angle)),
                guide_profile_radius=contour,
                roller_profile_radius=-contour * 1.02 * (2.0 / 1.02) ** rng.uniform(),
                guide_curve_radius=float(rng.choice([math.inf, outer, inner])),
                contact_angle=angle,
                radial_force=radial,
                axial_force=radial * rng.uniform(-0.5, 0.5) * math.tan(math.radians(angle)),
                motor_force=rng.choice([0.0, rng.uniform(-0.8, 0.8) * friction * radial]),
                friction_coefficient=friction,
                roller_material=str(rng.choice(names)),
                guide_material=str(rng.choice(names)),
            )
        )
    return found


def cost(cases: list[tr.Case], repeats: int = 3, **options: Any) -> float:
    """Return the processor time of a complete case [s], the least of `repeats`."""
    tr.solve(cases[:2], outputs=OUTPUTS, **options)
    times = []
    for _ in range(repeats):
        start = time.process_time()
        tr.solve(cases, outputs=OUTPUTS, **options)
        times.append(time.process_time() - start)
    return min(times) / len(cases)


def solved_patches(cases: list[tr.Case]) -> float:
    """Return how many patches a case the elements solve at `standard`, coarser grids of extrapolation not counted."""
    count = 0
    plain = batch.solve_batch

    def counted(patches, law, control, found):
        nonlocal count
        count += patches.ratio.size if found.traction.shape[-1] == PRESETS["standard"].elements else 0
        plain(patches, law, control, found)

    with mock.patch.object(batch, "solve_batch", counted):
        tr.solve(cases, outputs=OUTPUTS, contact_model="kalker")
    return count / len(cases)


def ratios(cases: list[tr.Case]) -> dict[str, float]:
    """Return the costs of the exact theory over that of full sliding."""
    sliding = cost(cases, contact_model="sliding")
    return {
        "sliding_ms": 1e3 * sliding,
        "kalker_standard_over_sliding": cost(cases, contact_model="kalker") / sliding,
        "kalker_preview_over_sliding": cost(cases, contact_model="kalker", accuracy="preview") / sliding,
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
    out = {}
    for name, scale in scales.items():
        off = np.abs((found[name] - best[name]) / scale).values
        out[name] = {f"{p}_percent": float(np.nanpercentile(off, p)) for p in PERCENTILES}
    return out


def main() -> None:
    """Print the report as JSON."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--finer", type=int, default=96, help="elements of the solution that errors are taken against")
    parser.add_argument("--skip-accuracy", action="store_true")
    args = parser.parse_args()
    studies = {
        "loads": load_study(args.cases, args.seed),
        "geometries": geometry_study(args.cases, args.seed),
        "random": random_designs(args.cases, args.seed),
    }
    result: dict[str, Any] = {name: ratios(cases) for name, cases in studies.items()}
    if not args.skip_accuracy:
        result["errors_of_random"] = errors(studies["random"], args.finer)
    print(json.dumps(result, indent=2))


if __name__ == "__main__":
    main()
