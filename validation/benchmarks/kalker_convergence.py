"""Resultants of rolling patches against the element size: observed order, extrapolated limit, time.

Run: python -m validation.benchmarks.kalker_convergence [--most 160]
"""

from __future__ import annotations

import argparse
import time

import numpy as np

from trackroller.contact.common import Elastic, Ellipse
from trackroller.contact.kalker import Creepage, KalkerSettings, solve_patch

STEEL = Elastic.of_pair(210e3, 0.33, 210e3, 0.33)
# semi-axes [mm], longitudinal creepage, spin [1/mm], friction
PATCHES = {
    "driven, slides": (0.3, 0.18, -3.5e-3, 0.03, 0.3),
    "free, slides about its middle": (0.3, 0.18, 4e-5, 0.03, 0.1),
    "half sticks": (0.3, 0.18, 1e-3, 3e-3, 0.3),
    "sticks": (0.3, 0.18, 1e-6, 0.0, 0.3),
    "long": (0.1, 0.5, 5e-4, 3e-3, 0.3),
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--most", type=int, default=160, help="elements along each axis of the finest grid")
    most = parser.parse_args().most
    grids = [n for n in (10, 20, 40, 80, 160, 320) if n <= most]
    print("Forces over mu F_N and moment over mu F_N sqrt(ab); order from each three grids; CPU time of one patch.")
    for name, (a, b, xi, phi, mu) in PATCHES.items():
        ellipse = Ellipse(*(np.array([v]) for v in (a, b, 700.0)))
        creep = Creepage(*(np.array([v]) for v in (xi, 0.0, phi)))
        scale = mu * ellipse.normal_force[0] * np.array([1.0, 1.0, np.sqrt(a * b)])
        rows = []
        print(f"\n{name}: a {a}, b {b} mm, xi {xi:g}, phi {phi:g}/mm, mu {mu}")
        for n in grids:
            start = time.process_time()
            s = solve_patch(ellipse, creep, mu, STEEL, KalkerSettings(elements=n, extrapolate=False, tolerance=1e-8))
            spent = time.process_time() - start
            r = s.resultants
            rows.append(np.array([r.lateral_force[0], r.driving_force[0], r.spin_moment[0]]) / scale)
            text = f"{n:4d}  " + " ".join(f"{v:10.6f}" for v in rows[-1])
            if len(rows) > 2:
                with np.errstate(divide="ignore", invalid="ignore"):
                    order = np.log2(np.abs((rows[-2] - rows[-3]) / (rows[-1] - rows[-2])))
                text += "   order " + " ".join(f"{v:5.2f}" for v in order)
            print(text + f"   stick {s.stick_fraction[0]:.3f}   {spent * 1e3:.0f} ms")


if __name__ == "__main__":
    main()
