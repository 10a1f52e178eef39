"""Measure how much CPU time the shortcuts save, scene by scene: time without shortcuts over time with them.

`python -m validation.benchmarks.shortcuts [--cases 400]` prints a table. Both runs alternate in one process, and the
smallest of three times counts. The table also shows the largest relative difference of the numbers.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

import trackroller as tr

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
        "nothing to spare (all cases differ)": (plain, {}),
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
    """CPU time of a solution and its data set."""
    start = time.process_time()
    found = tr.solve(cases, contact_model="sliding", **told)
    return time.process_time() - start, found


def difference(one, other) -> float:
    """Largest relative difference of forces and peaks where both have them."""
    worst = 0.0
    for name in ("normal_force", "spin_moment", "peak_stress", "life_cycles"):
        if name in one and name in other:
            a, b = one[name].values, other[name].values
            both = np.isfinite(a) & np.isfinite(b)
            if both.any() and np.any(b[both]):
                worst = max(worst, float(np.max(np.abs(a[both] - b[both])) / np.max(np.abs(b[both]))))
    return worst


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=int, default=400)
    n = parser.parse_args().cases
    tr.solve([{}, {"friction_coefficient": 0.0}], outputs=OUTPUTS, contact_model="sliding")
    print(f"{'scene':45} {'on [ms]':>9} {'off [ms]':>9} {'saving':>7} {'difference':>11}   (CPU time a case)")
    for name, (cases, told) in scenes(n).items():
        whole = {"outputs": OUTPUTS, "shortcuts": False}
        spared = {"outputs": OUTPUTS} | told
        on, off = [], []
        for _ in range(3):
            t, found = seconds(cases, **spared)
            on.append(t)
            t, full = seconds(cases, **whole)
            off.append(t)
        a, b = min(on) / n * 1e3, min(off) / n * 1e3
        print(f"{name:45} {a:9.3f} {b:9.3f} {b / a:6.1f}x {difference(found, full):11.1e}")


if __name__ == "__main__":
    main()
