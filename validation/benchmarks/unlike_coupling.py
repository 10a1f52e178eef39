"""How much shear changes the pressures of unlike materials, and forces with them.

    python -m validation.benchmarks.unlike_coupling [--roller PA6] [--guide 1.7225-normalised] [--elements 60]

Pressures on unlike materials make the surfaces creep, which `kalker` always counts; the tractions in turn move them
along the normal by w = K/(pi G) int (x - x').tau/|x - x'|^2, which it counts with `normal="halfspace"` and leaves out
with Hertz's pressures. Here the patch of a roller under 146 N (the paper's radii) is solved with both, normal and
tangential problem in turn until neither changes, and compared with the first round.
"""

from __future__ import annotations

import argparse

import numpy as np

from trackroller.contact.common import Elastic
from trackroller.contact.grid_patch import GridPatch
from trackroller.contact.hertz import contact_modulus, shape
from trackroller.contact.kalker import Creepage, KalkerSettings, PatchSolution, solve_patch
from trackroller.contact.normal import lift, solve_normal
from trackroller.materials import load_database

LOAD, WIDER, ROUNDS = 146.0, 1.2, 6
# friction, longitudinal creepage, spin [1/mm]
SLIPS = {"driven": (0.3, -3e-3, 0.03), "free": (0.3, 4e-5, 0.03), "much friction, driven": (0.5, -1e-2, 0.03)}


class Patch:
    """A box around Hertz's ellipse with `n` by `n` elements, on which both problems are solved in turn."""

    def __init__(self, n: int, roller: str, guide: str) -> None:
        one, known = np.ones(1), load_database()
        pair = known.material(roller), known.material(guide)
        bodies = [v for m in pair for v in (m.youngs_modulus, m.poisson_ratio)]
        curvatures = 1 / 6 - 1 / 7, 1 / 16.55 + 1 / 220
        self.modulus = contact_modulus(*bodies)
        hertz = shape(*(k * one for k in curvatures), self.modulus * one).at(LOAD * one)
        both = Elastic.of_pair(*bodies)
        self.elastic = Elastic(*(np.full(1, float(v)) for v in (both.shear_modulus, both.poisson_ratio, both.coupling)))
        self.half = WIDER * hertz.semi_axis_lateral[0], WIDER * hertz.semi_axis_rolling[0]
        self.sides = 2 * self.half[0] / n, 2 * self.half[1] / n
        x, y = ((np.arange(n) + 0.5 - n / 2) * h for h in self.sides)
        self.gap = 0.5 * (curvatures[0] * x[None, :] ** 2 + curvatures[1] * y[:, None] ** 2)

    def tangential(self, pressure: np.ndarray, friction: float, creep: float, spin: float) -> PatchSolution:
        one, none = np.ones(1), np.zeros(1)
        sides = (self.half[0] * one, self.half[1] * one)
        patch = GridPatch(*sides, pressure.max() * one, LOAD * one, none, pressure[None], none, none, none > 0, none)
        settings = KalkerSettings(elements=len(self.gap), tolerance=1e-8, extrapolate=False)
        return solve_patch(patch, Creepage(creep * one, none, spin * one), friction, self.elastic, settings)

    def lifted(self, traction: np.ndarray) -> np.ndarray:
        """w of tractions (2, ny, nx) [MPa] at the element centres [mm]."""
        return lift(*traction, *self.sides, float(self.elastic.coupling[0] / self.elastic.shear_modulus[0]))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--elements", type=int, default=60)
    parser.add_argument("--roller", default="PA6")
    parser.add_argument("--guide", default="1.7225-normalised")
    given = parser.parse_args()
    patch = Patch(given.elements, given.roller, given.guide)
    print(f"{given.roller} on {given.guide}, K = {patch.elastic.coupling[0]:.3f}")
    print("forces over mu F_N, moment over mu F_N mm, p_max [MPa], offset of the pressures' centre over a and b")
    for name, (friction, creep, spin) in SLIPS.items():
        apart = np.zeros_like(patch.gap)
        for k in range(ROUNDS):
            pressure = patch.modulus * solve_normal(patch.gap + apart, *patch.sides, LOAD / patch.modulus).pressure
            found = patch.tangential(pressure, friction, creep, spin)
            apart = patch.lifted(found.traction[0] * friction * pressure.max())
            if k in (0, ROUNDS - 1):
                r, limit = found.resultants, friction * LOAD
                n, share = len(pressure), pressure / pressure.sum()
                line = WIDER * ((2 * np.arange(n) + 1) / n - 1)
                print(
                    f"{name:22s} {'both ways' if k else 'one way':10s} F_T {r.lateral_force[0] / limit:8.4f}  "
                    f"F_A {r.driving_force[0] / limit:8.4f}  M_R {r.spin_moment[0] / limit:8.4f}  "
                    f"p {pressure.max():6.2f}  "
                    f"centre {share.sum(axis=0) @ line:7.4f} {share.sum(axis=1) @ line:7.4f}"
                )


if __name__ == "__main__":
    main()
