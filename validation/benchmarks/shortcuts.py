"""Measure how much processor time the shortcuts save, scene by scene.

    python -m validation.benchmarks.shortcuts [--cases N]

Each scene is solved with and without shortcuts in turn in one process; the smallest of three times counts. The
program returns the ratio of both times and the largest relative difference of the numbers.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np

import trackroller as tr
from validation.benchmarks.command import run

OUTPUTS = ("forces", "contact", "peak_stress", "life")


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


def seconds(cases, **told) -> tuple[float, object]:
    """Return the CPU time of a solution and its data set."""
    start = time.process_time()
    found = tr.solve(cases, contact_model="sliding", **told)
    return time.process_time() - start, found


def difference(one, other) -> float:
    """Return the largest relative difference of forces and peaks where both have them."""
    worst = 0.0
    for name in ("normal_force", "spin_moment", "peak_stress", "life_cycles"):
        if name in one and name in other:
            a, b = one[name].values, other[name].values
            both = np.isfinite(a) & np.isfinite(b)
            if both.any() and np.any(b[both]):
                worst = max(worst, float(np.max(np.abs(a[both] - b[both])) / np.max(np.abs(b[both]))))
    return worst


def measure(cases: int = 400) -> dict[str, Any]:
    """Return speed-up and largest difference of the results, scene by scene."""
    tr.solve([{}, {"friction_coefficient": 0.0}], outputs=OUTPUTS, contact_model="sliding")
    found = {}
    for name, (drawn, told) in scenes(cases).items():
        whole = {"outputs": OUTPUTS, "shortcuts": False}
        pairs = [(seconds(drawn, **{"outputs": OUTPUTS} | told), seconds(drawn, **whole)) for _ in range(3)]
        on, off = (min(run[k][0] for run in pairs) for k in range(2))
        found[name] = {"faster": off / on, "difference": difference(pairs[-1][0][1], pairs[-1][1][1])}
    return {"scenes": found}


if __name__ == "__main__":
    run(measure, __doc__)
