"""Measure how much shear changes the pressures of unlike materials, and the forces with them.

    python -m validation.benchmarks.unlike_coupling [--roller NAME] [--guide NAME] [--elements N]

Pressures on unlike materials make the surfaces creep, which `kalker` always counts; the tractions in turn move them
along the normal by w = K/(pi G) int (x - x').tau/|x - x'|^2, which it counts with `normal="halfspace"` and leaves out
with Hertz's pressures. Here the patch of a roller under 146 N (the paper's radii) is solved with both, normal and
tangential problem in turn until neither changes, and compared with the first round.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from trackroller.contact.common import Elastic
from trackroller.contact.grid_patch import GridPatch
from trackroller.contact.hertz import contact_modulus, shape
from trackroller.contact.kalker import Creepage, KalkerSettings, PatchSolution, solve_patch
from trackroller.contact.normal import lift, solve_normal
from trackroller.materials import load_database
from validation.benchmarks.command import run

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
        """Return w of tractions (2, ny, nx) [MPa] at the element centres [mm]."""
        return lift(*traction, *self.sides, float(self.elastic.coupling[0] / self.elastic.shear_modulus[0]))


def rounds(patch: Patch, friction: float, creep: float, spin: float) -> list[dict[str, float]]:
    """Return forces over mu F_N, the moment over mu F_N mm and p_max [MPa] of the first and of the last round."""
    apart, told = np.zeros_like(patch.gap), []
    for k in range(ROUNDS):
        pressure = patch.modulus * solve_normal(patch.gap + apart, *patch.sides, LOAD / patch.modulus).pressure
        found = patch.tangential(pressure, friction, creep, spin)
        apart = patch.lifted(found.traction[0] * friction * pressure.max())
        if k in (0, ROUNDS - 1):
            names = ("lateral_force", "driving_force", "spin_moment")
            forces = {name: getattr(found.resultants, name)[0] / (friction * LOAD) for name in names}
            told.append({**forces, "max_pressure": pressure.max()})
    return told


def measure(elements: int = 60, roller: str = "PA6", guide: str = "1.7225-normalised") -> dict[str, Any]:
    """Return the results of one-way and of two-way coupling and the change between them, for three creepages.

    Forces are over mu F_N; changes of pressure are relative.
    """
    patch = Patch(elements, roller, guide)
    found = {}
    for name, slips in SLIPS.items():
        one_way, both_ways = rounds(patch, *slips)
        change = {key: abs(both_ways[key] - one_way[key]) for key in one_way}
        change["max_pressure"] /= one_way["max_pressure"]
        found[name] = {"one_way": one_way, "both_ways": both_ways, "change": change}
    return {"coupling": patch.elastic.coupling[0], "creepages": found}


if __name__ == "__main__":
    run(measure, __doc__)
