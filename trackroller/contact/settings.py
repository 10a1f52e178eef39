"""Settings of each stage of a solution at one accuracy, and the data of the rollers that a contact model gets."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trackroller.halfspace.peak_settings import PeakSettings
from trackroller.parameters.contact_models import DECLARED

if TYPE_CHECKING:  # these modules load numba, which a plan does not need
    from trackroller.contact.common import Elastic
    from trackroller.contact.friction_laws import FrictionLaw

# Estimated error over its goal, from which and to which results fade from one number of elements to twice as many.
FADES = 0.8, 1.0
CONVERGED_PRESSURE = 1e-7  # largest residual of the normal problem of patches that are no ellipses


def converged_up_to(contact_model: str, normal: str) -> float:
    """Return the largest residual with which a row of a contact model and a normal problem counts as converged."""
    own = DECLARED[contact_model].converged_up_to
    return own if normal == "hertz" else max(own, CONVERGED_PRESSURE)


@dataclass(frozen=True)
class Rollers:
    """Elastic constants, friction law and speed of n rollers, which their contact model keeps.

    Parameters
    ----------
    elastic : Elastic
        Combined constants, arrays (n,).
    law : FrictionLaw
        Friction as a function of the slip speed.
    travel_speed : numpy.ndarray, shape (n,)
        Travel speed [mm/s].
    spin_model : str
        'concentric', 'edge' or 'skewed', for sliding only.
    profile_slip : bool
        True if the rigid slip follows the profile of the guide instead of its tangent; sliding always does so.
    """

    elastic: Elastic
    law: FrictionLaw
    travel_speed: np.ndarray
    spin_model: str = "skewed"
    profile_slip: bool = False


@dataclass(frozen=True)
class Accuracy:
    """Settings of one accuracy.

    Parameters
    ----------
    name : str
        Name of the accuracy.
    tolerance : float
        Promised relative error of the peak stress [1].
    force_nodes, coarse_nodes : int
        Gauss points in each smooth piece of the slip integrals, finally and in the first pass.
    peak : PeakSettings
        Search of the peak stress.
    traction_points, section_points : int
        Points along each axis of the stored tractions and stress sections.
    elements : int
        Elements along each axis of the patch for the rolling contact models.
    grid_elements : int
        Elements of patches whose pressure is solved; 0: as many as `elements`.
    peak_elements : int
        Elements of the tractions from which a model finds the peak stress; 0: as many as `elements`.
    doublings : int
        How often the elements of a patch with a large estimated error may double.
    force_goal, peak_goal, life_goal : float
        Errors that a patch may have by its estimates: of the friction forces over mu F_N, of peak and life over
        themselves. The elements double where they are larger, and a small adhesion area gets finer elements. 0: the
        limits of a preset.
    """

    name: str
    tolerance: float
    force_nodes: int
    coarse_nodes: int
    peak: PeakSettings
    traction_points: int
    section_points: int
    elements: int
    grid_elements: int = 0
    peak_elements: int = 0
    doublings: int = 1
    force_goal: float = 0.0
    peak_goal: float = 0.0
    life_goal: float = np.inf

    @property
    def on_grids(self) -> int:
        """Return the elements of models that do not interpolate between their elements."""
        return self.grid_elements or self.elements
