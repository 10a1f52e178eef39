"""Contact models on solved patches: sliding and Kalker's exact theory for any cross-sections.

The equilibrium passes Hertz's ellipses to these models, which use only their normal forces. The models solve the
normal problem for each normal force and work on the `GridPatch` that results.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from trackroller.contact import kalker
from trackroller.contact.grid_patch import GridPatch
from trackroller.contact.kalker.law import KalkerLaw
from trackroller.contact.normal import patch_sliding as normal_sliding
from trackroller.contact.normal.measure import roughness
from trackroller.contact.normal.patches import NormalSolver, Pressing
from trackroller.contact.normal.pressure import TOLERANCE
from trackroller.contact.protocol import ContactModel
from trackroller.contact.quantities import Patch, Resultants, SurfaceTractions, Works
from trackroller.contact.rollers import Rollers
from trackroller.contact.slip import Slip
from trackroller.parameters.contact_models import DECLARED

# Error of the friction forces over mu F_N per `roughness` of the pressure. With the error of the elements it covers the
# measured error of 79 of 80 contacts with flats beside small blends.
RIDGE_ERROR = 0.01
ROUNDS = 3  # solutions of the normal and of the tangential problem in turn, on unlike materials


def _known(resultants: Resultants, patch: GridPatch) -> Resultants:
    """Replace the resultants of patches that do not exist by NaN."""
    missing = np.flatnonzero(~np.isfinite(patch.normal_force))
    return resultants.replaced(missing, Resultants.unknown(missing.size))


class GridModel(ContactModel):
    """Common part of the contact models on solved patches.

    Parameters
    ----------
    given : Rollers
        Elastic constants, friction law and travel speed of the rollers.
    patches : NormalSolver
        Solver of the normal problem of the rollers.
    """

    refines = True

    def __init__(self, given: Rollers, patches: NormalSolver) -> None:
        self.given, self.patches = given, patches
        # of the normal problem at the last fine call, by roller and contact
        self._residual = np.zeros((len(given.travel_speed), 2))
        self._roughness = np.full((len(given.travel_speed), 2), np.nan)

    @property
    def elements(self) -> int:  # type: ignore[override]
        """Return the number of elements along each axis of a patch."""
        return self.patches.elements

    def patch(self, patch: Patch, slip: Slip, rows: np.ndarray, fine: bool = True) -> GridPatch:
        """Return the solved patches under the normal forces of `patch`; solved ones are returned as they are."""
        return self.patches.at(patch.normal_force, slip.sine, rows, fine) if patch.is_hertzian else patch  # type: ignore[return-value]

    def settled(self, patch: Patch, slip: Slip, friction: np.ndarray, rows: np.ndarray) -> GridPatch:
        """Return the solved patches; shear changes their pressures in `GridKalkerModel` only."""
        return self.patch(patch, slip, rows)

    def _solved(self, patch: GridPatch, slip: Slip, friction: np.ndarray, rows: np.ndarray) -> Any:
        """Return the solution on the patches, an object with `resultants` and `works`."""
        raise NotImplementedError

    def law(self, patch, slip, friction, rows, fine) -> Resultants:
        """Return the resultants on the roller, arrays (m,)."""
        grid = self.patch(patch, slip, rows, fine)
        if fine:
            self._remember(grid, slip, rows)
        return _known(self._solved(grid, slip, friction, rows).resultants, grid)

    def power(self, patch, slip, friction, rows) -> Works:
        """Return the dissipation per distance travelled and the part that the pressures supply, (m,)."""
        return self._solved(self.patch(patch, slip, rows), slip, friction, rows).works

    def _drawn(self, slip: Slip, rows: np.ndarray) -> Slip:
        """Return the slip on the drawn contour of the guide if the profile counts in the slip."""
        if not self.given.profile_slip:
            return slip
        contour = np.full(len(rows), None)
        contour[:] = [self.patches.contour(row, sine) for row, sine in zip(rows.tolist(), slip.sine, strict=True)]
        return replace(slip, contour=contour)

    def _remember(self, patch: GridPatch, slip: Slip, rows: np.ndarray) -> None:
        side = (slip.sine < 0).astype(int)
        self._residual[rows, side] = patch.residual
        self._roughness[rows, side] = [roughness(pressure) for pressure in patch.pressure]

    def state(self, n: int) -> tuple[np.ndarray, np.ndarray]:
        """Return the residual of the patches of n rollers at the last fine call, and whether it is met, both (n,)."""
        return self._residual.max(axis=1), np.all(self._residual <= TOLERANCE, axis=1)


class GridSlidingModel(GridModel):
    """Full sliding on solved patches."""

    declaration = DECLARED["sliding"]
    elastic = False
    residual = 1e-9  # the normal problem gives the same patch for the same load, so that smaller residuals are reached

    def _solved(self, patch, slip, friction, rows) -> normal_sliding.SlidingPatches:
        g = self.given
        return normal_sliding.solve_sliding(patch, slip, friction, g.spin_model, g.law, g.travel_speed[rows])

    def surface(self, patch, slip, friction, rows) -> SurfaceTractions:
        """Return the tractions on the grid of elements."""
        grid, g = self.patch(patch, slip, rows), self.given
        return normal_sliding.tractions(grid, slip, friction, g.spin_model, g.law, g.travel_speed[rows])


class GridKalkerModel(GridModel):
    """Kalker's exact theory of rolling contact with the traction bound of solved pressures."""

    declaration = DECLARED["kalker"]
    refines = False
    peak_error = 0.01  # of the elements that the tractions are solved on; measured on the same contacts

    def __init__(self, given: Rollers, patches: NormalSolver) -> None:
        super().__init__(given, patches)
        settings = kalker.KalkerSettings(patches.elements, 1e-8, law=given.law, profile_slip=given.profile_slip)
        self._law = KalkerLaw(given.elastic, settings, given.travel_speed)
        self._per_stress = given.elastic.coupling / given.elastic.shear_modulus

    def law(self, patch, slip, friction, rows, fine) -> Resultants:
        """Return the resultants on the roller, arrays (m,)."""
        if not fine:
            grid = self.patch(patch, slip, rows, False)
            return _known(self._law(grid, self._drawn(slip, rows), friction, rows, False), grid)
        grid = self.settled(patch, slip, friction, rows)
        self._remember(grid, slip, rows)
        return _known(self._solved(grid, slip, friction, rows).resultants, grid)

    def _solved(self, patch, slip, friction, rows):
        return self._law.kept(patch, self._drawn(slip, rows), friction, rows)

    def settled(self, patch: Patch, slip: Slip, friction: np.ndarray, rows: np.ndarray) -> GridPatch:
        """Return the patches with the pressures that shear has changed on unlike materials (Panagiotopoulos 1975).

        The normal and the tangential problem are solved in turn, ROUNDS times; after that both change by less than
        1e-4.
        """
        load, unlike = patch.normal_force, np.abs(self._per_stress[rows]) > 0.0
        pressed = unlike & np.isfinite(load) & np.isfinite(slip.shift) & (friction > 0.0)
        if not patch.is_hertzian or not pressed.any():
            return self.patch(patch, slip, rows)
        own, place = np.flatnonzero(pressed), np.full(len(rows), -1)
        place[own] = np.arange(own.size)
        pressing = Pressing(place, self._per_stress[rows[own]])
        grid = self.patches.at(load, slip.sine, rows, True, pressing)
        for _ in range(ROUNDS):  # of the patches `own` only, so that the results of other rollers do not depend on them
            t = self.surface(grid.take(own), slip.take(own), friction[own], rows[own])
            pressing = replace(pressing, shear=t)
            grid = self.patches.at(load, slip.sine, rows, True, pressing)
        return grid

    def surface(self, patch, slip, friction, rows) -> SurfaceTractions:
        """Return the tractions on the grid of elements."""
        grid = self.patch(patch, slip, rows)
        return kalker.to_tractions(grid, friction, self._solved(grid, slip, friction, rows))

    def stick(self, patch, slip, friction, rows) -> np.ndarray:
        """Return the share of the adhesion area in each rolling patch, (m,) [1]."""
        return self._solved(self.patch(patch, slip, rows), slip, friction, rows).stick_fraction

    def force_error(self, n):
        """Return the estimated error of the friction forces over mu F_N, (n, 2): of the elements and of ridges."""
        return self._law.error(n) + RIDGE_ERROR * self._roughness

    def state(self, n):
        """Return the larger residual of both problems, and whether both are met, each (n,)."""
        normal, tangential = super().state(n), self._law.state(n)
        return np.maximum(normal[0], tangential[0]), normal[1] & tangential[1]
