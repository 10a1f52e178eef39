"""The contact models by name, each a value behind `protocol.ContactModel`.

A model gives the contact law of the equilibrium, and the tractions of given patches on a grid.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Collection, Mapping

import numpy as np

from trackroller.contact import fastsim, kalker, sliding
from trackroller.contact.common import Elastic, Resultants, SurfaceTractions, Works
from trackroller.contact.friction_laws import FrictionLaw, constant
from trackroller.contact.kalker.correction import Correction
from trackroller.contact.kalker.law import KalkerLaw
from trackroller.contact.linear import LARGEST_RATIO
from trackroller.contact.normal.models import GridFastsimModel, GridKalkerModel, GridSlidingModel
from trackroller.contact.normal.patches import Patches
from trackroller.contact.protocol import ContactModel
from trackroller.contact.settings import CONVERGED, Accuracy, Rolling
from trackroller.contact.table.model import TableModel
from trackroller.errors import check_names

LEAST_UNDER_LAW = 20  # elements across a patch that resolve steeply falling friction
FINER_PARTS = 6  # points of the traction along each side of an element of a refined patch
FINER = 2  # points of sliding tractions on a grid, over the elements of the rolling contact models
MOST_SLENDER = 0.99 * LARGEST_RATIO  # axis ratio up to which FASTSIM has flexibilities


class SlidingModel(ContactModel):
    """Full sliding with an empirical spin pole (Wenzel et al. 2022), under any friction law."""

    name = "sliding"
    difference_step = 1e-5
    residual = CONVERGED["sliding"]

    def __init__(self, given: Rolling, settings: Accuracy) -> None:
        self.given, self.settings = given, settings
        self.full_sliding = given.law.is_constant

    def _integrals(self, ellipse, slip, friction, rows, nodes: int) -> sliding.Integrals:
        g, travel = self.given, self.given.travel_speed[rows]
        return sliding.integrals(
            ellipse, slip, friction, spin_model=g.spin_model, nodes=nodes, law=g.law, travel_speed=travel
        )

    def law(self, ellipse, slip, friction, rows, fine):
        nodes = self.settings.force_nodes if fine else self.settings.coarse_nodes
        return self._integrals(ellipse, slip, friction, rows, nodes).resultants

    def surface(self, ellipse, slip, friction, rows):
        g, travel, points = self.given, self.given.travel_speed[rows], self.settings.traction_points
        if self.full_sliding:
            return sliding.tractions(ellipse, slip, friction, spin_model=g.spin_model, points=points)
        points = FINER * self.settings.on_grids
        return sliding.tractions(
            ellipse, slip, friction, spin_model=g.spin_model, points=points, law=g.law, travel_speed=travel
        )

    def power(self, ellipse, slip, friction, rows):
        found = self._integrals(ellipse, slip, friction, rows, self.settings.force_nodes)
        return Works.of_friction(found.power / slip.rolling_radius)


class KalkerModel(ContactModel):
    """Steady rolling on the elastic half-space with adhesion and slip areas (Kalker 1990)."""

    name = "kalker"

    def __init__(self, given: Rolling, settings: Accuracy, trusts_table: bool = False) -> None:
        self.given, law, elastic = given, given.law, given.elastic
        elements = settings.elements if law.is_constant else max(settings.elements, LEAST_UNDER_LAW)
        chosen = kalker.KalkerSettings(elements=elements, tolerance=1e-8, law=law, profile_slip=given.profile_slip)
        self._law = KalkerLaw(elastic, chosen, given.travel_speed)
        if law.is_constant:  # the table behind the corrections holds constant friction only
            self.correction = Correction(elastic, chosen, trusts_table)

    def law(self, ellipse, slip, friction, rows, fine):
        return self._law(ellipse, slip, friction, rows, fine)

    def _solution(self, ellipse, slip, friction, rows):
        found = self._law.kept if self.correction is None else self.correction.solution
        return found(ellipse, slip, friction, rows)

    def surface(self, ellipse, slip, friction, rows):
        return kalker.to_tractions(ellipse, friction, self._solution(ellipse, slip, friction, rows))

    def stick(self, ellipse, slip, friction, rows):
        return self._solution(ellipse, slip, friction, rows).stick_fraction

    def shares(self, ellipse, slip, friction, rows):
        return kalker.shares(ellipse, self._solution(ellipse, slip, friction, rows))

    def finer_shares(self, ellipse, slip, friction, rows):
        if self.correction is None:
            return None
        coarse = self._solution(ellipse, slip, friction, rows)
        found = self.correction.on_finer(ellipse, slip, friction, rows, coarse)
        return (*kalker.shares(ellipse, found, FINER_PARTS), found.converged)

    def power(self, ellipse, slip, friction, rows):
        if self.correction is not None:
            return self.correction.works(ellipse, slip, friction, rows)
        return self._solution(ellipse, slip, friction, rows).works

    def force_error(self, n):
        if self.correction is None:
            return self._law.error(n)
        # rollers that the corrected law has not balanced
        return np.where(np.isnan(self.correction.error), self._law.error(n), self.correction.error)

    def state(self, n):
        return self._law.state(n) if self.correction is None else self.correction.state(n)


class FastsimModel(ContactModel):
    """Kalker's simplified theory; NaN where the ellipse is more slender than its coefficients reach."""

    name = "fastsim"
    residual = CONVERGED["fastsim"]

    def __init__(self, given: Rolling, settings: Accuracy) -> None:
        self.given, n = given, settings.on_grids  # strips and steps in the proportion of the default settings
        self.settings = fastsim.FastsimSettings(4 * n // 5, 6 * n // 5, n, given.law, given.profile_slip)

    def _solution(self, ellipse, slip, friction, rows) -> tuple[fastsim.FastsimSolution, np.ndarray]:
        """Return the solution of the patches that are not too slender, and their numbers."""
        a, b = ellipse.semi_axis_lateral, ellipse.semi_axis_rolling
        known = np.flatnonzero(np.maximum(a, b) <= MOST_SLENDER * np.minimum(a, b))
        creep = kalker.Creepage.of_slip(slip.take(known), self.settings.profile_slip)
        elastic, travel = self.given.elastic.take(rows[known]), self.given.travel_speed[rows[known]]
        return fastsim.solve_patch(ellipse.take(known), creep, friction[known], elastic, self.settings, travel), known

    def law(self, ellipse, slip, friction, rows, fine):
        solution, known = self._solution(ellipse, slip, friction, rows)
        return Resultants.unknown(len(rows)).replaced(known, solution.resultants)

    def surface(self, ellipse, slip, friction, rows):
        # Patches that are too slender for the theory occur in full slip only, which needs just their grid and pressure.
        a, b = ellipse.semi_axis_lateral, ellipse.semi_axis_rolling
        known = np.maximum(a, b) <= MOST_SLENDER * np.minimum(a, b)
        near = np.where(known, a, np.clip(a, b / MOST_SLENDER, b * MOST_SLENDER))
        rounder = dataclasses.replace(ellipse, semi_axis_lateral=near)
        elastic, travel = self.given.elastic.take(rows), self.given.travel_speed[rows]
        t = fastsim.tractions(rounder, slip, friction, elastic, self.settings, travel)
        wrong = ~known[:, None, None]
        fields = {
            name: np.where(wrong, np.nan, getattr(t, name))
            for name in ("shear_lateral", "shear_rolling", "slip_lateral", "slip_rolling")
        }
        widened = t.x * (a / rounder.semi_axis_lateral)[:, None]
        return dataclasses.replace(t, x=widened, stick=t.stick & ~wrong, **fields)

    def power(self, ellipse, slip, friction, rows):
        solution, known = self._solution(ellipse, slip, friction, rows)
        work = np.full(len(rows), np.nan)
        work[known] = solution.friction_energy_per_distance
        return Works.of_friction(work)


ON_ELLIPSES: dict[str, Callable[..., ContactModel]] = {
    "sliding": SlidingModel,
    "fastsim": FastsimModel,
    "kalker": KalkerModel,
    "kalker_table": lambda given, settings: TableModel(given.elastic, KalkerModel(given, settings, True)),
}
ON_SOLVED_PATCHES = {"sliding": GridSlidingModel, "fastsim": GridFastsimModel, "kalker": GridKalkerModel}


def contact_model(
    name: str,
    settings: Accuracy,
    elastic: Elastic,
    spin_model: str = "skewed",
    law: FrictionLaw | None = None,
    travel_speed: np.ndarray | float = 1000.0,
    slip_terms: Collection[str] = (),
    patches: Patches | None = None,
) -> ContactModel:
    """Return the contact model `name` for n rollers.

    Parameters
    ----------
    name : str
        'sliding', 'fastsim', 'kalker' or 'kalker_table'. The table serves constant friction, the guide's tangent and
        elliptical patches only.
    settings : Accuracy
        Discretisation.
    elastic : Elastic
        Combined constants of the rollers, arrays (n,).
    spin_model : str
        Assumption on the spin pole, for 'sliding' only.
    law : FrictionLaw, optional
        Friction over its value at rest by slip speed; constant if not given.
    travel_speed : ndarray, shape (n,), or float
        Travel speed of the rollers [mm/s].
    slip_terms : collection of str
        With 'profile' the rigid slip follows the guide's profile instead of its tangent; 'sliding' always does.
        'curve' changes the slip that a model is given, see `slip.Slip`.
    patches : Patches, optional
        Solver of the normal problem of the rollers; Hertz's ellipses if not given.

    Returns
    -------
    ContactModel
        The model.

    Raises
    ------
    InputError
        For an unknown name.
    """
    models: Mapping[str, Callable[..., ContactModel]] = ON_ELLIPSES if patches is None else ON_SOLVED_PATCHES
    check_names("contact_model", [name], list(models))
    travel = np.array(np.broadcast_to(np.asarray(travel_speed, float), np.shape(elastic.shear_modulus)))
    given = Rolling(elastic, law or constant(), travel, spin_model, "profile" in slip_terms)
    return models[name](given, settings if patches is None else patches)


def traction_share(surface: SurfaceTractions, friction: np.ndarray) -> np.ndarray:
    """Return the traction over its bound mu p at element centres; outside the ellipse that of the nearest element.

    Parameters
    ----------
    surface : SurfaceTractions
        Tractions of n ellipses on alike grids.
    friction : ndarray, shape (n,)
        Friction coefficient mu.

    Returns
    -------
    ndarray, shape (n, 2, ny, nx)
        x_C and y_C part of the share.
    """
    from scipy.ndimage import distance_transform_edt  # heavy, and only stresses under tractions on a grid need it

    bound = friction[:, None, None] * surface.pressure
    inside = surface.pressure > 0
    safe = np.where(bound > 0, bound, 1.0)
    share = np.stack([surface.shear_lateral / safe, surface.shear_rolling / safe], axis=1)
    if len(share):
        # the ellipse fills the grid in the same way for every patch
        _, (j, i) = distance_transform_edt(~inside[0], return_indices=True)
        share = share[:, :, j, i]
    return np.ascontiguousarray(share)
