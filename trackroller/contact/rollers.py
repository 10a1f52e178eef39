"""The data of the rollers that a contact model gets, and when a row counts as converged."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from trackroller.parameters.contact_models import DECLARED

if TYPE_CHECKING:  # these modules load numba, which a plan does not need
    from trackroller.contact.friction_laws import FrictionLaw
    from trackroller.contact.quantities import Elastic

CONVERGED_PRESSURE = 1e-7  # largest residual of the normal problem of patches that are no ellipses


def converged_up_to(contact_model: str, normal: str) -> float:
    """Return the largest residual with which a row of a contact model and a normal problem counts
    as converged.
    """
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
        True if the rigid slip follows the profile of the guide instead of its tangent; sliding
        always does so.
    """

    elastic: Elastic
    law: FrictionLaw
    travel_speed: np.ndarray
    spin_model: str = "skewed"
    profile_slip: bool = False
