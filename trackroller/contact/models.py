"""The ladder of contact models behind one face, so that the stages need not know which one works.

A model gives the contact law of the equilibrium, and the tractions of given patches on a grid.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Collection
from typing import TYPE_CHECKING

import numpy as np

from trackroller.contact import sliding
from trackroller.contact.common import ContactModel, Elastic, Resultants, SurfaceTractions, Works
from trackroller.contact.friction_laws import FrictionLaw, constant
from trackroller.errors import InputError

if TYPE_CHECKING:
    from trackroller.contact.settings import Accuracy


FINER = 2  # points of sliding tractions on a grid, over the elements of the rolling contact models


class SlidingModel(ContactModel):
    """Full sliding with an empirical spin pole (Wenzel et al. 2022), under any friction law."""

    difference_step = 1e-5
    residual = 1e-10

    def __init__(self, settings: Accuracy, spin_model: str, law: FrictionLaw, travel_speed: np.ndarray) -> None:
        self.settings, self.spin_model = settings, spin_model
        self.friction_law, self.travel = law, travel_speed
        self.full_sliding = law.is_constant

    def _falling(self, ellipse, slip, friction, rows, nodes):
        from trackroller.contact import sliding_law

        travel = self.travel[rows]
        return sliding_law.integrals(
            ellipse, slip, friction, self.friction_law, travel, spin_model=self.spin_model, nodes=nodes
        )

    def law(self, ellipse, slip, friction, rows, fine):
        nodes = self.settings.force_nodes if fine else self.settings.coarse_nodes
        if not self.friction_law.is_constant:
            return self._falling(ellipse, slip, friction, rows, nodes)[0]
        return sliding.resultants(ellipse, slip, friction, spin_model=self.spin_model, nodes=nodes)

    def surface(self, ellipse, slip, friction, rows):
        points, falling = self.settings.traction_points, None
        if not self.friction_law.is_constant:
            points, falling = FINER * self.settings.elements, self.friction_law
        return sliding.tractions(
            ellipse,
            slip,
            friction,
            spin_model=self.spin_model,
            points=points,
            law=falling,
            travel_speed=self.travel[rows],
        )

    def power(self, ellipse, slip, friction, rows):
        nodes = self.settings.force_nodes
        if self.friction_law.is_constant:
            per_omega = sliding.friction_power(ellipse, slip, friction, spin_model=self.spin_model, nodes=nodes)
        else:
            per_omega = self._falling(ellipse, slip, friction, rows, nodes)[1]
        return Works.of_friction(per_omega / slip.rolling_radius)


class KalkerModel(ContactModel):
    """Steady rolling on the elastic half-space with stick and slip (Kalker 1990)."""

    def __init__(
        self,
        settings: Accuracy,
        elastic: Elastic,
        law: FrictionLaw,
        travel_speed: np.ndarray,
        profile_slip: bool = False,
    ) -> None:
        from trackroller.contact.kalker import KalkerSettings
        from trackroller.contact.kalker.law import KalkerLaw

        chosen = KalkerSettings(elements=settings.elements, tolerance=1e-8, law=law, profile_slip=profile_slip)
        self._law = KalkerLaw(elastic, chosen, travel_speed)

    def law(self, ellipse, slip, friction, rows, fine):
        return self._law(ellipse, slip, friction, rows, fine)

    def surface(self, ellipse, slip, friction, rows):
        from trackroller.contact import kalker

        return kalker.to_tractions(ellipse, friction, self._law.kept(ellipse, slip, friction, rows))

    def power(self, ellipse, slip, friction, rows):
        return self._law.kept(ellipse, slip, friction, rows).works

    def state(self, n):
        return self._law.state(n)


class FastsimModel(ContactModel):
    """Kalker's simplified theory; NaN where the ellipse is more slender than its coefficients reach."""

    def __init__(
        self,
        settings: Accuracy,
        elastic: Elastic,
        law: FrictionLaw,
        travel_speed: np.ndarray,
        profile_slip: bool = False,
    ) -> None:
        from trackroller.contact import fastsim

        self.elastic, self.travel = elastic, travel_speed
        n = settings.elements  # strips and steps in the proportion of the default settings
        self._fastsim = fastsim
        self.settings = fastsim.FastsimSettings(
            strips=4 * n // 5, steps=6 * n // 5, points=n, law=law, profile_slip=profile_slip
        )

    def _solution(self, ellipse, slip, friction, rows):
        from trackroller.contact.linear import LARGEST_RATIO

        a, b, most = ellipse.semi_axis_lateral, ellipse.semi_axis_rolling, 0.99 * LARGEST_RATIO
        known = np.flatnonzero(np.maximum(a, b) <= most * np.minimum(a, b))
        part = slip.take(known)
        solution = self._fastsim.solve_patch(
            ellipse.take(known),
            part.longitudinal,
            0.0,
            part.spin,
            friction[known],
            self.elastic.take(rows[known]),
            self.settings,
            self.travel[rows[known]],
            part if self.settings.profile_slip else None,
        )

        def spread(values):
            full = np.full(len(rows), np.nan)
            full[known] = values
            return full

        return solution, spread

    def law(self, ellipse, slip, friction, rows, fine):
        solution, spread = self._solution(ellipse, slip, friction, rows)
        r = solution.resultants
        return Resultants(*(spread(v) for v in (r.lateral_force, r.driving_force, r.spin_moment)))

    def surface(self, ellipse, slip, friction, rows):
        from trackroller.contact.linear import LARGEST_RATIO

        # patches too slender for the theory exist in full slip only, which needs no more of it than grid and pressure
        a, b = ellipse.semi_axis_lateral, ellipse.semi_axis_rolling
        most = 0.99 * LARGEST_RATIO
        known = np.maximum(a, b) <= most * np.minimum(a, b)
        rounder = dataclasses.replace(ellipse, semi_axis_lateral=np.where(known, a, np.clip(a, b / most, b * most)))
        t = self._fastsim.tractions(rounder, slip, friction, self.elastic.take(rows), self.settings, self.travel[rows])
        wrong = ~known[:, None, None]
        fields = {
            name: np.where(wrong, np.nan, getattr(t, name))
            for name in ("shear_lateral", "shear_rolling", "slip_lateral", "slip_rolling")
        }
        widened = t.x * (a / rounder.semi_axis_lateral)[:, None]
        return dataclasses.replace(t, x=widened, stick=t.stick & ~wrong, **fields)

    def power(self, ellipse, slip, friction, rows):
        solution, spread = self._solution(ellipse, slip, friction, rows)
        return Works.of_friction(spread(solution.friction_energy_per_distance))


def contact_model(
    name: str,
    settings: Accuracy,
    elastic: Elastic,
    spin_model: str = "skewed",
    law: FrictionLaw | None = None,
    travel_speed: np.ndarray | float = 1000.0,
    slip_terms: Collection[str] = (),
) -> ContactModel:
    """The model `name` for n rollers.

    Parameters
    ----------
    settings : of the accuracy asked for
    elastic : combined constants of the rollers, arrays (n,)
    spin_model : for sliding only
    law : friction over its value at rest by slip speed; constant if not given
    travel_speed : of the rollers [mm/s], (n,) or scalar
    slip_terms : with 'profile', slip of the guide's profile instead of its tangent; sliding has it anyway, and 'curve'
        is a matter of the slip that a model is given (`common.DetailedSlip`)
    """
    law, profile = law or constant(), "profile" in slip_terms
    travel = np.array(np.broadcast_to(np.asarray(travel_speed, float), np.shape(elastic.shear_modulus)))
    if name == "sliding":
        return SlidingModel(settings, spin_model, law, travel)
    if name == "kalker":
        return KalkerModel(settings, elastic, law, travel, profile)
    if name == "kalker_table":
        from trackroller.contact.table.model import TableModel

        return TableModel(elastic, lambda: KalkerModel(settings, elastic, law, travel))
    if name == "fastsim":
        return FastsimModel(settings, elastic, law, travel, profile)
    raise InputError("contact_model", name, "sliding, fastsim, kalker or kalker_table")


def traction_share(surface: SurfaceTractions, friction: np.ndarray) -> np.ndarray:
    """Traction over its bound mu p at element centres, (n, 2, ny, nx); outside the ellipse as at the nearest inside."""
    from scipy.ndimage import distance_transform_edt

    bound = friction[:, None, None] * surface.pressure
    inside = surface.pressure > 0
    safe = np.where(bound > 0, bound, 1.0)
    share = np.stack([surface.shear_lateral / safe, surface.shear_rolling / safe], axis=1)
    if len(share):
        # the ellipse fills the grid in the same way for every patch
        _, (j, i) = distance_transform_edt(~inside[0], return_indices=True)
        share = share[:, :, j, i]
    return np.ascontiguousarray(share)
