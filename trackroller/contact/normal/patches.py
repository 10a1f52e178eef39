"""Patches of many rollers under the loads that an equilibrium asks for, from families of solved ones."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from trackroller.contact.common import SurfaceTractions
from trackroller.contact.cross_sections import Gap
from trackroller.contact.grid_patch import GridPatch, rim_means
from trackroller.contact.normal.family import Family, Node
from trackroller.contact.normal.pressure import lift
from trackroller.contact.slip import contour_over_tangent
from trackroller.errors import ShapeError

GapOf = Callable[[int, int], tuple[tuple, Callable[[], Gap]]]


@dataclass(frozen=True)
class Pressing:
    """Patches whose pressures shear changes.

    place : number of each patch among these, -1 for others (n,); per_stress : their K/G [1/MPa]; shear : the tractions
    on them, once known
    """

    place: np.ndarray
    per_stress: np.ndarray
    shear: SurfaceTractions | None = None

    def node(self, family: Family, load: float, i: int, side: int) -> Node:
        """Patch `i` of `family` under load/E* [mm^2]."""
        k = self.place[i]
        if k < 0:
            return family.at(load)
        if self.shear is None:
            return family.pressed(load)
        t, flip = self.shear, slice(None, None, 1 if side == 1 else -1)  # x counts outward in the family
        sides = t.x[k, 1] - t.x[k, 0], t.y[k, 1] - t.y[k, 0]
        apart = lift(t.shear_lateral[k], t.shear_rolling[k], *sides, self.per_stress[k])
        return family.pressed(load, apart[:, flip], t.pressure[k][:, flip])


class Patches:
    """Patches of n rollers under any load.

    Parameters
    ----------
    gaps : for roller `row` and contact `side` (1 or 2), a key that equal gaps share, and what makes the gap
    modulus : contact modulus E* of the rollers [MPa], (n,)
    elements : along the rolling direction of the box around a patch

    A roller one of whose gaps cannot be made (`ShapeError`) has patches of NaN; if there is no other, the error is
    raised.
    """

    def __init__(self, gaps: GapOf, modulus: np.ndarray, elements: int) -> None:
        self.modulus, self.elements = modulus, elements
        families: dict[tuple, Family | None] = {}
        self._places: dict[tuple[int, int], Family | None] = {}
        problem: ShapeError | None = None
        for row in range(len(modulus)):
            for side in (1, 2):
                key, make = gaps(row, side)
                if key not in families:
                    try:
                        families[key] = Family(make(), elements)
                    except ShapeError as error:
                        families[key], problem = None, error
                self._places[row, side] = families[key]
        if problem is not None and not any(self._places[i, 1] and self._places[i, 2] for i in range(len(modulus))):
            raise problem

    def at(
        self, load: np.ndarray, sine: np.ndarray, rows: np.ndarray, fine: bool = True, pressing: Pressing | None = None
    ) -> GridPatch:
        """Patches under `load` [N] beside contact 1 (sine > 0) or 2 of the rollers `rows`; rough if not `fine`."""
        n = len(load)
        found: dict[int, np.ndarray] = {}
        numbers = np.full((n, 9), np.nan)
        for i in np.flatnonzero(np.isfinite(load) & (load > 0)).tolist():
            side, modulus = (1 if sine[i] > 0 else 2), self.modulus[rows[i]]
            family = self._places[int(rows[i]), side]
            if family is None:
                continue
            if fine:
                scaled = load[i] / modulus
                node = family.at(scaled) if pressing is None else pressing.node(family, scaled, i, side)
                box, shares, rest = node.box, rim_means(node.shares), (*node.scalars, node.reaches, node.residual)
            else:
                box, shares = family.between(load[i] / modulus)
                rest = (math.nan, shares.max() / _cell(box, shares) * load[i] / modulus, math.nan, False, math.nan)
            outward = 1.0 if side == 1 else -1.0  # x counts outward in the family, along x_R here
            wide, middle = 0.5 * (box.high - box.low), 0.5 * (box.high + box.low)
            numbers[i] = (wide, box.half, rest[1] * modulus, load[i], outward * middle, rest[0], rest[2], *rest[3:])
            found[i] = (shares if side == 1 else shares[:, ::-1]) * (load[i] / _cell(box, shares))
        shape = next((p.shape for p in found.values()), (self.elements, self.elements))
        pressure = np.full((n, *shape), np.nan)
        for i, mean in found.items():
            pressure[i] = mean
        a, b, p, force, centre, approach, area, reaches, residual = np.ascontiguousarray(numbers.T)
        return GridPatch(a, b, p, force, centre, pressure, approach, area, reaches == 1.0, residual)

    def contour(self, row: int, sine: float) -> Callable[[np.ndarray], np.ndarray] | None:
        """`slip.contour_over_tangent` of the guide beside contact 1 (sine > 0) or 2 of a roller; None without a gap."""
        family = self._places[row, 1 if sine > 0 else 2]
        return None if family is None else contour_over_tangent(family.gap.guide, family.gap.alpha)


def _cell(box, shares: np.ndarray) -> float:
    return 2.0 * box.half * (box.high - box.low) / shares.size
