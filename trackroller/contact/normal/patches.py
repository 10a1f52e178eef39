"""Solved patches of many rollers under the loads of an equilibrium, from families of solutions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields

import numpy as np

from trackroller.contact.cross_sections import Gap
from trackroller.contact.grid_patch import GridPatch, rim_means
from trackroller.contact.normal.family import Family, Node
from trackroller.contact.normal.measure import Box
from trackroller.contact.normal.pressure import lift
from trackroller.contact.quantities import SurfaceTractions
from trackroller.contact.slip import contour_over_tangent
from trackroller.errors import ShapeError

GapOf = Callable[[int, int], tuple[tuple, Callable[[], Gap]]]
Boxes = Sequence[Box]
SCALARS = tuple(
    field.name for field in fields(GridPatch) if field.name not in ("normal_force", "pressure")
)


@dataclass(frozen=True)
class Pressing:
    """The m patches, of n, in which shear changes the pressure because the materials differ.

    Attributes
    ----------
    place : numpy.ndarray of int, shape (n,)
        Number of each patch among the m patches, -1 for the other patches.
    per_stress : numpy.ndarray, shape (m,)
        K/G of the m patches [1/MPa].
    shear : SurfaceTractions, optional
        Tractions on the m patches; None before they are solved.
    """

    place: np.ndarray
    per_stress: np.ndarray
    shear: SurfaceTractions | None = None

    def node(self, family: Family, load: float, i: int, side: int) -> Node:
        """Return the solution of patch `i`, of contact 1 or 2 (`side`), under load/E* [mm^2]."""
        k = self.place[i]
        if k < 0:
            return family.at(load)
        if self.shear is None:
            return family.pressed(load)
        # x counts outward in a family
        t, flip = self.shear, slice(None, None, 1 if side == 1 else -1)
        sides = t.x[k, 1] - t.x[k, 0], t.y[k, 1] - t.y[k, 0]
        apart = lift(t.shear_lateral[k], t.shear_rolling[k], *sides, self.per_stress[k])
        return family.pressed(load, apart[:, flip], t.pressure[k][:, flip])


class NormalSolver:
    """Solver of the normal problem of n rollers under any load.

    Parameters
    ----------
    gaps : callable
        Function of roller `row` and contact `side` (1 or 2). It returns a key, which equal gaps
        share, and a function that makes the gap.
    modulus : numpy.ndarray, shape (n,)
        Contact modulus E* of the rollers [MPa].
    elements : int
        Number of elements along the rolling direction of the box around a patch.
    across : int
        Factor on this number for the elements across.
    near : sequence of Box, optional
        Boxes of similar patches of contacts 1 and 2, from which the search for the boxes starts.

    Raises
    ------
    ShapeError
        If no roller has both gaps. If some rollers have both gaps, the patches of the other rollers
        are NaN.
    """

    def __init__(
        self,
        gaps: GapOf,
        modulus: np.ndarray,
        elements: int,
        across: int = 1,
        near: Boxes | None = None,
    ) -> None:
        self.modulus, self.elements = modulus, elements
        families: dict[tuple, Family | None] = {}
        self._places: dict[tuple[int, int], Family | None] = {}
        problem: ShapeError | None = None
        for row in range(len(modulus)):
            for side in (1, 2):
                key, make = gaps(row, side)
                if key not in families:
                    try:
                        families[key] = Family(
                            make(), elements, across, None if near is None else near[side - 1]
                        )
                    except ShapeError as error:
                        families[key], problem = None, error
                self._places[row, side] = families[key]
        if problem is not None and not any(
            self._places[i, 1] and self._places[i, 2] for i in range(len(modulus))
        ):
            raise problem

    def at(
        self,
        load: np.ndarray,
        sine: np.ndarray,
        rows: np.ndarray,
        fine: bool = True,
        pressing: Pressing | None = None,
    ) -> GridPatch:
        """Return the patches of m contacts under given loads.

        Parameters
        ----------
        load : numpy.ndarray, shape (m,)
            Normal forces [N]; NaN and values <= 0 give patches of NaN.
        sine : numpy.ndarray, shape (m,)
            Values > 0 for contact 1, < 0 for contact 2.
        rows : numpy.ndarray of int, shape (m,)
            Numbers of the rollers.
        fine : bool
            False interpolates between solved loads.
        pressing : Pressing, optional
            Patches whose pressures shear changes.

        Returns
        -------
        GridPatch
            The m patches.
        """
        n = len(load)
        pressures: dict[int, np.ndarray] = {}
        scalars = {name: np.full(n, np.nan) for name in SCALARS}
        for i in np.flatnonzero(np.isfinite(load) & (load > 0)).tolist():
            side, modulus = (1 if sine[i] > 0 else 2), self.modulus[rows[i]]
            family = self._places[int(rows[i]), side]
            if family is None:
                continue
            scaled = load[i] / modulus
            if not fine:
                node = family.between(scaled)
            else:
                node = (
                    family.at(scaled)
                    if pressing is None
                    else pressing.node(family, scaled, i, side)
                )
            box, shares = node.box, rim_means(node.shares) if fine else node.shares
            outward = 1.0 if side == 1 else -1.0  # x counts outward in a family, along x_R here
            wide, middle = 0.5 * (box.high - box.low), 0.5 * (box.high + box.low)
            values = (
                wide,
                box.half,
                node.largest * modulus,
                outward * middle,
                node.approach,
                node.area,
            )
            for name, value in zip(SCALARS, (*values, node.reaches, node.residual), strict=True):
                scalars[name][i] = value
            pressures[i] = (shares if side == 1 else shares[:, ::-1]) * (
                load[i] / box.cell(shares.size)
            )
        shape = next((p.shape for p in pressures.values()), (self.elements, self.elements))
        pressure = np.full((n, *shape), np.nan)
        for i, mean in pressures.items():
            pressure[i] = mean
        scalars["normal_force"] = np.where(np.isnan(scalars["semi_axis_lateral"]), np.nan, load)
        scalars["reaches_edge"] = scalars["reaches_edge"] == 1.0
        return GridPatch(pressure=pressure, **scalars)

    def contour(self, row: int, sine: float) -> Callable[[np.ndarray], np.ndarray] | None:
        """Return `slip.contour_over_tangent` of the guide at contact 1 (sine > 0) or 2; None
        without a gap.
        """
        family = self._places[row, 1 if sine > 0 else 2]
        return None if family is None else contour_over_tangent(family.gap.guide, family.gap.alpha)
