"""Interface of a contact model: the methods of every model, and the capabilities that it declares.

The solver uses this interface and that of a `Patch` only, and never asks for the class of a model or of a patch.
Arrays, units and the contact frame are those of `trackroller.contact.quantities`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from trackroller.contact.quantities import Patch, Resultants, SurfaceTractions, Works
from trackroller.contact.slip import Slip
from trackroller.parameters.contact_models import ModelDeclaration

if TYPE_CHECKING:
    from trackroller.contact.rollers import Rollers


class ContactModel:
    """Interface of a contact model, with the capabilities that a model declares.

    In all methods `patch` and `slip` are arrays over m patches, `friction` is the coefficient mu (m,) and `rows` (m,)
    are the numbers of the rollers to which the patches belong. Contact 2 of a roller has a negative `slip.sine`.
    """

    declaration: ModelDeclaration  # name, options, cost and promised accuracy
    on_solved_patches: ClassVar[type[ContactModel] | None] = None  # the model on solved patches
    elements = 0  # along each axis of a patch; 0 if the model has none
    elastic = True  # the surfaces move elastically along the patch, so that parts of it can adhere
    full_sliding = False  # the shear follows from an ellipse and a slip field in closed form; it needs no grid
    knows_tractions = True  # forces and `surface` come from one solution
    refines = False  # `surface` is exact for any number of elements of a refined patch
    difference_step = 1e-3  # relative step of derivatives, above the noise of the model
    residual = 1e-7  # relative residual of the equilibrium that the model can reach
    correction: Any = None  # a `kalker.correction.Correction` with which the equilibrium is found, if there is one
    peak_error = 0.0  # relative error of the peak stress that the model adds, per unit friction coefficient

    def __init__(self, given: Rollers, settings: Any) -> None:
        """Keep what is known of n rollers, and the `Accuracy`, or the `NormalSolver` of a model on solved patches."""
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

    def shares(
        self, patch: Patch, slip: Slip, friction: np.ndarray, rows: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray] | None:
        """Return tractions over their bound, (m, 2, ., .), on a grid and a coarser one; their difference is an error.

        None if the model has tractions at the points of `surface` only.
        """
        return None

    def finer_shares(
        self, patch: Patch, slip: Slip, friction: np.ndarray, rows: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
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

    def settled(self, patch: Patch, slip: Slip, friction: np.ndarray, rows: np.ndarray) -> Patch:
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
