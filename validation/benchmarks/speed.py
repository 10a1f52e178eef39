"""How fast the solver is, and how much faster than a plain NumPy transcription of the published equations.

    python -m validation.benchmarks.speed [--cases N] [--skip-transcription]

Everything is timed in one run, compilation excluded and stated apart. Run it on a quiet machine; where others compute,
the processor times (`cpu`) still tell, with all cores at work per second: threads / (cpu seconds a case).
"""

from __future__ import annotations

import argparse
import json
import os
import time
from typing import Any

import numpy as np

import trackroller as tr
from trackroller.numerics.threads import thread_count
from validation.benchmarks.published_transcription import STYLES, time_transcription


def load_study(n: int, seed: int = 1) -> list[tr.Case]:
    """Load, friction and material vary; the curvatures are fixed."""
    rng = np.random.default_rng(seed)
    steel = "1.7225-normalised"
    materials = (steel, "PA6", "POM", "EN AW-7075")
    return [
        tr.Case(
            friction_coefficient=rng.uniform(0.02, 0.4),
            axial_force=rng.uniform(-30, 30),
            motor_force=rng.uniform(-20, 20),
            radial_force=-rng.uniform(100, 300),
            roller_material=str(rng.choice(materials)),
            guide_material=steel,
        )
        for _ in range(n)
    ]


def geometry_study(n: int, seed: int = 2) -> list[tr.Case]:
    """Return cases in which every curvature differs."""
    rng = np.random.default_rng(seed)
    return [
        tr.Case(
            friction_coefficient=rng.uniform(0.02, 0.4),
            axial_force=rng.uniform(-30, 30),
            motor_force=rng.uniform(-20, 20),
            contact_angle=rng.uniform(20, 60),
            axis_distance=rng.uniform(15, 40),
            roller_profile_radius=-rng.uniform(6.2, 12),
            guide_curve_radius=float(rng.choice([np.inf, 220, 60, -300])),
        )
        for _ in range(n)
    ]


def rate(
    cases: list[tr.Case], outputs: tuple[str, ...], accuracy: str = "standard", repeats: int = 3
) -> dict[str, float]:
    """Return cases per second and processor time of a case over all threads [ms], the best of `repeats`."""
    times, cpu = [], []
    for _ in range(repeats):
        start, start_cpu = time.perf_counter(), time.process_time()
        tr.solve(cases, outputs=outputs, accuracy=accuracy)
        times.append(time.perf_counter() - start)
        cpu.append(time.process_time() - start_cpu)
    return {"per_second": len(cases) / min(times), "cpu_ms_a_case": 1e3 * min(cpu) / len(cases)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=1000)
    parser.add_argument("--skip-transcription", action="store_true")
    args = parser.parse_args()
    complete = ("forces", "contact", "peak_stress", "life")
    start, start_cpu = time.perf_counter(), time.process_time()
    tr.solve(tr.Case(), outputs=complete)
    first, first_cpu = time.perf_counter() - start, time.process_time() - start_cpu
    start = time.perf_counter()
    tr.solve(tr.Case(), outputs=complete)
    threads = thread_count()
    result: dict[str, Any] = {
        "cores": os.cpu_count(),
        "threads": threads,
        "first_call_seconds": first,
        "first_call_cpu_seconds": first_cpu,
        "one_case_seconds": time.perf_counter() - start,
        "complete_load_study": rate(load_study(args.cases), complete),
        "complete_geometry_study": rate(geometry_study(args.cases), complete),
        "forces_and_contact": rate(load_study(10 * args.cases), ("forces", "contact")),
        "preview": rate(load_study(args.cases), complete, "preview"),
        "reference": rate(load_study(max(args.cases // 10, 20)), complete, "reference"),
    }
    if not args.skip_transcription:
        study = result["complete_load_study"]
        for style in STYLES:
            published = time_transcription(tr.Case(motor_force=0), style=style)
            result[f"transcription_{style}"] = published | {
                "times_faster": published["seconds_per_case"] * study["per_second"],
                "times_faster_by_cpu": published["cpu_seconds_per_case"] / (1e-3 * study["cpu_ms_a_case"]) * threads,
            }
    print(json.dumps(result, indent=2, default=float))


if __name__ == "__main__":
    main()
