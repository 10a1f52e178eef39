"""Contact models on patches and pressures solved on a grid: sliding, FASTSIM and Kalker's, for any cross-sections.

The equilibrium hands over Hertz's ellipse, which stands here for its normal force only.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from trackroller.contact import normal_sliding
from trackroller.contact.common import DetailedSlip, Elastic, Ellipse, Resultants, Slip, SurfaceTractions, Works
from trackroller.contact.cross_sections import Gap
from trackroller.contact.friction_laws import FrictionLaw
from trackroller.contact.normal import TOLERANCE, lift
from trackroller.contact.normal_family import Family, Node
from trackroller.contact.normal_patch import GridPatch, rim_means
from trackroller.contact.slip import contour_over_tangent
from trackroller.errors import InputError, ShapeError

ROUNDS = 3  # of the normal and the tangential problem, where these change each other
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

    def at(self, load: np.ndarray, sine: np.ndarray, rows: np.ndarray, fine: bool = True,
           pressing: Pressing | None = None) -> GridPatch:  # fmt: skip
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

    def _drawn(self, slip: Slip, rows: np.ndarray) -> Slip:
        """The slip on the contour of the guide as it is drawn, where the profile counts in the slip."""
        if not self._profile_slip:
            return slip
        contour = np.full(len(rows), None)
        contour[:] = [self.patches.contour(row, sine) for row, sine in zip(rows.tolist(), slip.sine, strict=True)]
        turning = slip.turning if isinstance(slip, DetailedSlip) else np.zeros(len(rows))
        return DetailedSlip(slip.sine, slip.cosine, slip.guide_profile_radius, slip.rolling_radius, slip.shift, turning,
                            contour)  # fmt: skip

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
        return normal_sliding.solve_sliding(patch, slip, friction, self.spin_model, self.friction_law,
                                            self.travel[rows])  # fmt: skip

    def law(self, ellipse, slip, friction, rows, fine) -> Resultants:
        """Resultants on the roller, shape (n,)."""
        patch = self.patch(ellipse, slip, rows, fine)
        if fine:
            self._remember(patch, slip, rows)
        return _known(self._solved(patch, slip, friction, rows).resultants, patch)

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

    def __init__(self, patches: Patches, elastic: Elastic, law: FrictionLaw, travel_speed: np.ndarray,
                 profile_slip: bool = False) -> None:  # fmt: skip
        from trackroller.contact import fastsim_grid
        from trackroller.contact.fastsim import FastsimSettings

        super().__init__(patches, profile_slip)
        self.elastic, self.travel, self._grid = elastic, travel_speed, fastsim_grid
        self.settings = FastsimSettings(steps=6 * patches.elements // 5, law=law, profile_slip=profile_slip)

    def _solved(self, patch, slip, friction, rows):
        return self._grid.solve_grid(patch, self._drawn(slip, rows), friction, self.elastic.take(rows), self.settings,
                                     self.travel[rows])  # fmt: skip

    def law(self, ellipse, slip, friction, rows, fine) -> Resultants:
        """Resultants on the roller, shape (n,)."""
        patch = self.patch(ellipse, slip, rows, fine)
        if fine:
            self._remember(patch, slip, rows)
        return _known(self._solved(patch, slip, friction, rows).resultants, patch)

    def surface(self, ellipse, slip, friction, rows) -> SurfaceTractions:
        """Tractions on the grid of elements."""
        patch = self.patch(ellipse, slip, rows)
        return self._grid.tractions(patch, self._drawn(slip, rows), friction, self.elastic.take(rows), self.settings,
                                    self.travel[rows])  # fmt: skip

    def power(self, ellipse, slip, friction, rows) -> Works:
        """Dissipation per distance travelled."""
        patch = self.patch(ellipse, slip, rows)
        return Works.of_friction(self._solved(patch, slip, friction, rows).friction_energy_per_distance)


class GridKalkerModel(_OnGrid):
    """Kalker's theory of rolling with the traction bound of solved pressures."""

    refines = False

    def __init__(self, patches: Patches, elastic: Elastic, law: FrictionLaw, travel_speed: np.ndarray,
                 profile_slip: bool = False) -> None:  # fmt: skip
        from trackroller.contact.kalker import KalkerSettings
        from trackroller.contact.kalker_law import KalkerLaw

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
    name: str, patches: Patches, elastic: Elastic, spin_model: str, law: FrictionLaw, travel_speed: np.ndarray,
    profile_slip: bool = False,
) -> GridModel:  # fmt: skip
    """The contact model `name` on solved patches."""
    if name == "sliding":
        return GridSlidingModel(patches, spin_model, law, travel_speed)
    if name == "fastsim":
        return GridFastsimModel(patches, elastic, law, travel_speed, profile_slip)
    if name == "kalker":
        return GridKalkerModel(patches, elastic, law, travel_speed, profile_slip)
    raise InputError("contact_model", name, "sliding, fastsim or kalker")
