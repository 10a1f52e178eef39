"""Measure how much processor time the shortcuts save, scene by scene.

    python -m validation.benchmarks.shortcuts [--cases N]

Each scene is solved with and without shortcuts in turn in one process; the smallest of three times counts.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from validation.benchmarks.command import run
from validation.benchmarks.speed import costs


def scenes(n: int) -> dict[str, tuple[list[dict], dict]]:
    """Return the n cases and the options of each scene."""
    rng = np.random.default_rng(1)
    friction = rng.uniform(0.05, 0.4, n)
    plain = [
        {"friction_coefficient": float(f), "axial_force": float(a)}
        for f, a in zip(friction, rng.uniform(-40, 40, n), strict=True)
    ]
    heavy = [dict(case, radial_force=-float(r)) for case, r in zip(plain, np.geomspace(100, 9000, n), strict=True)]
    return {
        "nothing is skipped (all cases differ)": (plain, {}),
        "no axial force: one contact": ([dict(case, axial_force=0.0) for case in plain], {}),
        "travel speed in 10 levels: mechanics once": (
            [dict(plain[i // 10], velocity=10.0 + i % 10) for i in range(n)],
            {},
        ),
        "no friction, loads: one search": (
            [
                {"friction_coefficient": 0.0, "motor_force": 0.0, "axial_force": 0.0, "radial_force": -float(r)}
                for r in np.geomspace(50, 2000, n)
            ],
            {},
        ),
        "forces only: no stress": (plain, {"outputs": ("forces",)}),
        "stop_if peak_stress > R_m (loads to 9 kN)": (heavy, {"stop_if": "peak_stress > R_m"}),
    }


def measure(cases: int = 400) -> dict[str, Any]:
    """Return the speed-up scene by scene."""
    found = {}
    for name, (drawn, options) in scenes(cases).items():
        model = {"contact_model": "sliding"}
        spent = costs(drawn, {"with": model | options, "without": model | {"shortcuts": False}}, repeats=3)
        found[name] = {"faster": spent["without"] / spent["with"]}
    return {"scenes": found}


if __name__ == "__main__":
    run(measure, __doc__)
