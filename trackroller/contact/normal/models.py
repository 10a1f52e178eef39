"""Contact models on patches and pressures solved on a grid: sliding, FASTSIM and Kalker's, for any cross-sections.

The equilibrium hands over Hertz's ellipse, which stands here for its normal force only.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from trackroller.contact.common import DetailedSlip, Elastic, Ellipse, Resultants, Slip, SurfaceTractions, Works
from trackroller.contact.friction_laws import FrictionLaw
from trackroller.contact.grid_patch import GridPatch
from trackroller.contact.normal import sliding as normal_sliding
from trackroller.contact.normal.patches import Patches, Pressing
from trackroller.contact.normal.pressure import TOLERANCE
from trackroller.errors import InputError

ROUNDS = 3  # of the normal and the tangential problem, where these change each other


def _known(resultants: Resultants, patch: GridPatch) -> Resultants:
    """NaN where there is no patch."""
    parts = (resultants.lateral_force, resultants.driving_force, resultants.spin_moment)
    return Resultants(*(np.where(np.isfinite(patch.load), part, np.nan) for part in parts))


class _OnGrid:
    """What both models share."""

    full_sliding = False  # in the sense that an ellipse and a slip field tell the tractions
    refines = True  # tractions are known on finer elements than those of the pressure
    difference_step = 1e-3
    residual = 1e-7

    def __init__(self, patches: Patches, profile_slip: bool = False) -> None:
        self.patches, self._profile_slip = patches, profile_slip
        self._found: dict[int, tuple[float, bool]] = {}

    def patch(self, ellipse: Ellipse, slip: Slip, rows: np.ndarray, fine: bool = True) -> GridPatch:
        """The patches that carry the normal forces of the ellipses."""
        if isinstance(ellipse, GridPatch):
            return ellipse
        return self.patches.at(ellipse.normal_force, slip.sine, rows, fine)

    def settled(self, ellipse: Ellipse, slip: Slip, friction: np.ndarray, rows: np.ndarray) -> GridPatch:
        """The patches with what friction changes of their pressures: nothing here."""
        return self.patch(ellipse, slip, rows)

    def _solved(self, patch: GridPatch, slip: Slip, friction: np.ndarray, rows: np.ndarray) -> Any:
        """The model's solution on the patches, with their `resultants`."""
        raise NotImplementedError

    def law(self, ellipse, slip, friction, rows, fine) -> Resultants:
        """Resultants on the roller, shape (n,)."""
        patch = self.patch(ellipse, slip, rows, fine)
        if fine:
            self._remember(patch, slip, rows)
        return _known(self._solved(patch, slip, friction, rows).resultants, patch)

    def _drawn(self, slip: Slip, rows: np.ndarray) -> Slip:
        """The slip on the contour of the guide as it is drawn, where the profile counts in the slip."""
        if not self._profile_slip:
            return slip
        contour = np.full(len(rows), None)
        contour[:] = [self.patches.contour(row, sine) for row, sine in zip(rows.tolist(), slip.sine, strict=True)]
        turning = slip.turning if isinstance(slip, DetailedSlip) else np.zeros(len(rows))
        return DetailedSlip(
            slip.sine, slip.cosine, slip.guide_profile_radius, slip.rolling_radius, slip.shift, turning, contour
        )

    def _remember(self, patch: GridPatch, slip: Slip, rows: np.ndarray) -> None:
        for row, sine, residual in zip(rows, slip.sine, patch.residual, strict=True):
            self._found[2 * int(row) + (sine < 0)] = (float(residual), bool(residual <= TOLERANCE))

    def state(self, n: int) -> tuple[np.ndarray, np.ndarray]:
        """Residual of the patches of n rollers at the last fine call, and if it is met, (n,)."""
        both = [[self._found.get(2 * i + k, (0.0, True)) for k in (0, 1)] for i in range(n)]
        values = np.array(both, float).reshape(n, 2, 2)
        return values[:, :, 0].max(axis=1), values[:, :, 1].min(axis=1) > 0


class GridSlidingModel(_OnGrid):
    """Full sliding on solved patches."""

    residual = 1e-9  # the same patch always comes out for the same load

    def __init__(self, patches: Patches, spin_model: str, law: FrictionLaw, travel_speed: np.ndarray) -> None:
        super().__init__(patches)
        self.spin_model, self.friction_law, self.travel = spin_model, law, travel_speed

    def _solved(self, patch, slip, friction, rows) -> normal_sliding.SlidingPatches:
        return normal_sliding.solve_sliding(
            patch, slip, friction, self.spin_model, self.friction_law, self.travel[rows]
        )

    def surface(self, ellipse, slip, friction, rows) -> SurfaceTractions:
        """Tractions on the grid of elements."""
        patch = self.patch(ellipse, slip, rows)
        return normal_sliding.tractions(patch, slip, friction, self.spin_model, self.friction_law, self.travel[rows])

    def power(self, ellipse, slip, friction, rows) -> Works:
        """Dissipation per distance travelled."""
        patch = self.patch(ellipse, slip, rows)
        return Works.of_friction(self._solved(patch, slip, friction, rows).power / slip.rolling_radius)


class GridFastsimModel(_OnGrid):
    """Kalker's simplified theory, strip by strip over solved patches."""

    def __init__(
        self, patches: Patches, elastic: Elastic, law: FrictionLaw, travel_speed: np.ndarray, profile_slip: bool = False
    ) -> None:
        from trackroller.contact.fastsim import FastsimSettings
        from trackroller.contact.fastsim import grid as fastsim_grid

        super().__init__(patches, profile_slip)
        self.elastic, self.travel, self._grid = elastic, travel_speed, fastsim_grid
        self.settings = FastsimSettings(steps=6 * patches.elements // 5, law=law, profile_slip=profile_slip)

    def _solved(self, patch, slip, friction, rows):
        return self._grid.solve_grid(
            patch, self._drawn(slip, rows), friction, self.elastic.take(rows), self.settings, self.travel[rows]
        )

    def surface(self, ellipse, slip, friction, rows) -> SurfaceTractions:
        """Tractions on the grid of elements."""
        patch = self.patch(ellipse, slip, rows)
        return self._grid.tractions(
            patch, self._drawn(slip, rows), friction, self.elastic.take(rows), self.settings, self.travel[rows]
        )

    def power(self, ellipse, slip, friction, rows) -> Works:
        """Dissipation per distance travelled."""
        patch = self.patch(ellipse, slip, rows)
        return Works.of_friction(self._solved(patch, slip, friction, rows).friction_energy_per_distance)


class GridKalkerModel(_OnGrid):
    """Kalker's theory of rolling with the traction bound of solved pressures."""

    refines = False

    def __init__(
        self, patches: Patches, elastic: Elastic, law: FrictionLaw, travel_speed: np.ndarray, profile_slip: bool = False
    ) -> None:
        from trackroller.contact.kalker import KalkerSettings
        from trackroller.contact.kalker.law import KalkerLaw

        super().__init__(patches, profile_slip)
        settings = KalkerSettings(elements=patches.elements, tolerance=1e-8, law=law, profile_slip=profile_slip)
        self._law = KalkerLaw(elastic, settings, travel_speed)
        self._per_stress = elastic.coupling / elastic.shear_modulus

    def law(self, ellipse, slip, friction, rows, fine) -> Resultants:
        """Resultants on the roller, shape (n,)."""
        if not fine:
            patch = self.patch(ellipse, slip, rows, False)
            return _known(self._law(patch, self._drawn(slip, rows), friction, rows, False), patch)
        patch = self.settled(ellipse, slip, friction, rows)
        self._remember(patch, slip, rows)
        return _known(self._law.kept(patch, self._drawn(slip, rows), friction, rows).resultants, patch)

    def settled(self, ellipse: Ellipse, slip: Slip, friction: np.ndarray, rows: np.ndarray) -> GridPatch:
        """The patches with pressures that the tractions on unlike materials have changed (Panagiotopoulos 1975).

        Normal and tangential problem are solved in turn, ROUNDS times: then both change by less than 1e-4.
        """
        load, unlike = ellipse.normal_force, np.abs(self._per_stress[rows]) > 0.0
        pressed = unlike & np.isfinite(load) & np.isfinite(slip.shift) & (friction > 0.0)
        if isinstance(ellipse, GridPatch) or not pressed.any():
            return self.patch(ellipse, slip, rows)
        own, place = np.flatnonzero(pressed), np.full(len(rows), -1)
        place[own] = np.arange(own.size)
        pressing = Pressing(place, self._per_stress[rows[own]])
        patch = self.patches.at(load, slip.sine, rows, True, pressing)
        for _ in range(ROUNDS):  # the others are left alone: their digits shall not depend on these
            t = self.surface(patch.take(own), slip.take(own), friction[own], rows[own])
            pressing = replace(pressing, shear=t)
            patch = self.patches.at(load, slip.sine, rows, True, pressing)
        return patch

    def surface(self, ellipse, slip, friction, rows) -> SurfaceTractions:
        """Tractions on the grid of elements."""
        from trackroller.contact import kalker

        patch = self.patch(ellipse, slip, rows)
        return kalker.to_tractions(patch, friction, self._law.kept(patch, self._drawn(slip, rows), friction, rows))

    def power(self, ellipse, slip, friction, rows) -> Works:
        """Dissipation per distance travelled."""
        patch = self.patch(ellipse, slip, rows)
        return self._law.kept(patch, self._drawn(slip, rows), friction, rows).works

    def state(self, n):
        normal, tangential = super().state(n), self._law.state(n)
        return np.maximum(normal[0], tangential[0]), normal[1] & tangential[1]


GridModel = GridSlidingModel | GridFastsimModel | GridKalkerModel


def grid_model(
    name: str,
    patches: Patches,
    elastic: Elastic,
    spin_model: str,
    law: FrictionLaw,
    travel_speed: np.ndarray,
    profile_slip: bool = False,
) -> GridModel:
    """The contact model `name` on solved patches."""
    if name == "sliding":
        return GridSlidingModel(patches, spin_model, law, travel_speed)
    if name == "fastsim":
        return GridFastsimModel(patches, elastic, law, travel_speed, profile_slip)
    if name == "kalker":
        return GridKalkerModel(patches, elastic, law, travel_speed, profile_slip)
    raise InputError("contact_model", name, "sliding, fastsim or kalker")
