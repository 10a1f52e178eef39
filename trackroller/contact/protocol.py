"""Interfaces of the contact room: the attributes and methods of every contact patch and every contact model.

The solver uses these two interfaces only and never asks for the class of a patch or of a model. Arrays, units and the
contact frame are those of `trackroller.contact.common`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, Protocol

import numpy as np

from trackroller.contact.common import Resultants, SurfaceTractions, Works
from trackroller.contact.slip import Slip
from trackroller.parameters.contact_models import ModelDeclaration

if TYPE_CHECKING:
    from trackroller.contact.rollers import Rollers


class Patch(Protocol):
    """Interface of n contact patches, elliptical (`common.Ellipse`) or not (`grid_patch.GridPatch`).

    Arrays of shape (n,).
    """

    @property
    def is_hertzian(self) -> bool:
        """Return True for the ellipses of Hertz's theory, whose pressure follows from a, b and p_max.

        False if the pressure was solved element by element.
        """

    @property
    def semi_axis_lateral(self) -> np.ndarray:
        """Return the semi-axis a along x_C, or half the width of the box around the patch [mm]."""

    @property
    def semi_axis_rolling(self) -> np.ndarray:
        """Return the semi-axis b along y_C, or half the length of the box around the patch [mm]."""

    @property
    def max_pressure(self) -> np.ndarray:
        """Return the largest pressure p_max [MPa]."""

    @property
    def normal_force(self) -> np.ndarray:
        """Return the normal force F_N [N]."""

    @property
    def centre(self) -> np.ndarray:
        """Return x_C of the middle of the ellipse or box [mm]."""

    @property
    def pressure_centre(self) -> np.ndarray:
        """Return x_C of the resultant of the pressure [mm]."""

    @property
    def area(self) -> np.ndarray:
        """Return the area of the patch [mm^2]."""

    @property
    def half_extents(self) -> tuple[np.ndarray, np.ndarray]:
        """Return half the width and half the length of the loaded region [mm]."""

    @property
    def reaches_edge(self) -> np.ndarray:
        """Return True where the patch ends at an edge of the material."""

    def take(self, index) -> Any:
        """Return the patches `index` (integer or boolean array)."""


class ContactModel:
    """Interface of a contact model, with the capabilities that a model declares.

    In all methods `patch` and `slip` are arrays over m patches, `friction` is the coefficient mu (m,) and `rows` (m,)
    are the numbers of the rollers to which the patches belong. Contact 2 of a roller has a negative `slip.sine`.
    """

    declaration: ModelDeclaration  # name, options, cost and promised accuracy
    on_solved_patches: ClassVar[type[ContactModel] | None] = None  # the model on solved patches, made with `Patches`
    elastic = True  # the surfaces move elastically along the patch, so that parts of it can adhere
    full_sliding = False  # the shear follows from an ellipse and a slip field in closed form; it needs no grid
    knows_tractions = True  # forces and `surface` come from one solution
    refines = False  # `surface` is exact for any number of elements of a refined patch
    difference_step = 1e-3  # relative step of derivatives, above the noise of the model
    residual = 1e-7  # relative residual of the equilibrium that the model can reach
    correction: Any = None  # a `kalker.correction.Correction` with which the equilibrium is found, if there is one
    peak_error = 0.0  # relative error of the peak stress that the model adds, per unit friction coefficient

    def __init__(self, given: Rollers, settings: Any) -> None:
        """Keep what is known of n rollers, and the `Accuracy`, or the `Patches` of a model on solved patches."""
        self.given, self.settings = given, settings

    @property
    def name(self) -> str:
        """Return the word of the option `contact_model`."""
        return self.declaration.name

    @classmethod
    def errors(cls) -> dict[str, tuple[float, float, float, float]]:
        """Return the constant errors of the forces by quantity: median, 95 and 99 %, bound; empty for other models.

        Quantities are `friction_force`, over mu F_N, and `spin_moment`, over mu F_N sqrt(a b).
        """
        return {}

    def law(self, patch: Patch, slip: Slip, friction: np.ndarray, rows: np.ndarray, fine: bool) -> Resultants:
        """Return the resultants on the roller, arrays (m,); a cheaper estimate if `fine` is False."""
        raise NotImplementedError

    def surface(self, patch: Patch, slip: Slip, friction: np.ndarray, rows: np.ndarray) -> SurfaceTractions:
        """Return the tractions on a grid over each patch."""
        raise NotImplementedError

    def shares(self, patch: Patch, slip: Slip, friction: np.ndarray, rows: np.ndarray) -> Any:
        """Return tractions over their bound, (m, 2, ., .), on a grid and a coarser one; their difference is an error.

        None if the model has tractions at the points of `surface` only.
        """
        return None

    def finer_shares(self, patch: Patch, slip: Slip, friction: np.ndarray, rows: np.ndarray) -> Any:
        """Return `shares` from twice the elements of the patches, and whether these have converged, (m,).

        None if the model does not refine patches.
        """
        return None

    def pole_stress(self, patch: Patch, slip: Slip, friction: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """Return the stress near the spin pole over p_max that the elements may miss, (m,); 0 if unknown or resolved.

        Such a stress is expected only beside a small adhesion area.
        """
        return np.zeros(len(rows))

    def power(self, patch: Patch, slip: Slip, friction: np.ndarray, rows: np.ndarray) -> Works:
        """Return the dissipation per distance travelled and the part of it that the pressures supply, (m,)."""
        raise NotImplementedError

    def settled(self, patch: Patch, slip: Slip, friction: np.ndarray, rows: np.ndarray) -> Any:
        """Return the patches that carry the normal forces of `patch`, with their final pressures."""
        return patch

    def stick(self, patch: Patch, slip: Slip, friction: np.ndarray, rows: np.ndarray) -> np.ndarray | None:
        """Return the share of the adhesion area in each rolling patch, (m,) [1]; None if `surface` returns it."""
        return None

    def state(self, n: int) -> tuple[np.ndarray, np.ndarray]:
        """Return the residual of the patches of n rollers at the last fine call, and whether it is met, both (n,)."""
        return np.zeros(n), np.ones(n, bool)

    def force_error(self, n: int) -> np.ndarray:
        """Return the estimated error of the friction forces of n rollers over mu F_N, (n, 2); NaN if unknown."""
        return np.full((n, 2), np.nan)

    def used(self, n: int) -> np.ndarray:
        """Return the name of the contact model that gave the forces of each of n rollers, object array (n,)."""
        return np.full(n, self.name, dtype=object)
