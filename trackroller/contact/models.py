"""The ladder of contact models behind one face, so that the stages need not know which one works.

A model gives the contact law of the equilibrium, and the tractions of given patches on a grid.
"""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Protocol

import numpy as np

from trackroller.contact import sliding
from trackroller.contact.common import Elastic, Ellipse, Resultants, Slip, SurfaceTractions
from trackroller.errors import InputError

if TYPE_CHECKING:
    from trackroller.accuracy import Accuracy


class ContactModel(Protocol):
    """What the solver asks of a contact model; `rows` are the rollers that the patches belong to."""

    full_sliding: bool
    difference_step: float  # relative step of derivatives, above the noise of the model
    residual: float  # relative residual of the equilibrium that the model can reach

    def law(self, ellipse: Ellipse, slip: Slip, friction: np.ndarray, rows: np.ndarray, fine: bool) -> Resultants:
        """Resultants on the roller, shape (n,); rough if not `fine`."""

    def surface(self, ellipse: Ellipse, slip: Slip, friction: np.ndarray, rows: np.ndarray) -> SurfaceTractions:
        """Tractions on a grid over each patch."""

    def power(self, ellipse: Ellipse, slip: Slip, friction: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """Dissipation per distance travelled [N], shape (n,)."""


@dataclasses.dataclass
class SlidingModel:
    """Full sliding with an empirical spin pole (Wenzel et al. 2022)."""

    settings: Accuracy
    spin_model: str
    full_sliding: bool = True
    difference_step: float = 1e-5
    residual: float = 1e-10

    def law(self, ellipse, slip, friction, rows, fine):
        nodes = self.settings.force_nodes if fine else self.settings.coarse_nodes
        return sliding.resultants(ellipse, slip, friction, spin_model=self.spin_model, nodes=nodes)

    def surface(self, ellipse, slip, friction, rows):
        return sliding.tractions(
            ellipse, slip, friction, spin_model=self.spin_model, points=self.settings.traction_points
        )

    def power(self, ellipse, slip, friction, rows):
        per_omega = sliding.friction_power(
            ellipse, slip, friction, spin_model=self.spin_model, nodes=self.settings.force_nodes
        )
        return per_omega / slip.rolling_radius


class KalkerModel:
    """Steady rolling on the elastic half-space with stick and slip (Kalker 1990)."""

    full_sliding = False
    difference_step = 1e-3
    residual = 1e-7

    def __init__(self, settings: Accuracy, elastic: Elastic) -> None:
        from trackroller.contact.kalker import KalkerLaw, KalkerSettings

        self.settings, self.elastic = KalkerSettings(elements=settings.elements, tolerance=1e-8), elastic
        self._law = KalkerLaw(elastic, self.settings)

    def law(self, ellipse, slip, friction, rows, fine):
        return self._law(ellipse, slip, friction, rows, fine)

    def surface(self, ellipse, slip, friction, rows):
        from trackroller.contact import kalker

        return kalker.tractions(ellipse, slip, friction, self.elastic.take(rows), self.settings)

    def power(self, ellipse, slip, friction, rows):
        from trackroller.contact import kalker

        solution = kalker.solve_patch(
            ellipse, kalker.Creepage.of_slip(slip), friction, self.elastic.take(rows), self.settings
        )
        # summed over the elements: the work of the rigid slip and its relative difference from that sum
        return solution.friction_energy_per_distance * (1.0 + solution.energy_residual)


class FastsimModel(KalkerModel):
    """Kalker's simplified theory; NaN where the ellipse is more slender than its coefficients reach."""

    def __init__(self, settings: Accuracy, elastic: Elastic) -> None:
        from trackroller.contact import fastsim

        self.elastic = elastic
        self._fastsim = fastsim

    def _solution(self, ellipse, slip, friction, rows):
        from trackroller.contact.linear import LARGEST_RATIO

        ratio = ellipse.semi_axis_rolling / ellipse.semi_axis_lateral
        known = np.flatnonzero((ratio > 1 / LARGEST_RATIO) & (ratio < LARGEST_RATIO))
        part = slip.take(known)
        solution = self._fastsim.solve_patch(
            ellipse.take(known), part.longitudinal, 0.0, part.spin, friction[known], self.elastic.take(rows[known])
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
        return self._fastsim.tractions(ellipse, slip, friction, self.elastic.take(rows), None)

    def power(self, ellipse, slip, friction, rows):
        solution, spread = self._solution(ellipse, slip, friction, rows)
        return spread(solution.friction_energy_per_distance)


def contact_model(name: str, settings: Accuracy, elastic: Elastic, spin_model: str) -> ContactModel:
    """The model `name` for rollers with combined constants `elastic`, arrays (n,)."""
    if name == "sliding":
        return SlidingModel(settings, spin_model)
    if name == "kalker":
        return KalkerModel(settings, elastic)
    if name == "fastsim":
        return FastsimModel(settings, elastic)
    raise InputError("contact_model", name, "sliding, fastsim or kalker")


def traction_share(surface: SurfaceTractions, friction: np.ndarray) -> np.ndarray:
    """Traction over its bound mu p at element centres, (n, 2, ny, nx); outside the ellipse as at the nearest inside."""
    from scipy.ndimage import distance_transform_edt

    bound = friction[:, None, None] * surface.pressure
    inside = bound > 0
    safe = np.where(inside, bound, 1.0)
    share = np.stack([surface.shear_lateral / safe, surface.shear_rolling / safe], axis=1)
    if len(share):
        # the ellipse fills the grid in the same way for every patch
        _, (j, i) = distance_transform_edt(~inside[0], return_indices=True)
        share = share[:, :, j, i]
    return np.ascontiguousarray(share)
