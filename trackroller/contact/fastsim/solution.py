"""Settings and solution of the simplified theory, for elliptical and for solved patches."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from trackroller.contact.common import Resultants, SurfaceTractions, Works
from trackroller.contact.fastsim.point import Totals
from trackroller.contact.friction_laws import FrictionLaw, constant
from trackroller.numerics.threads import share_rows

# number of steps along a strip, arrays for the totals, first and last patch
Kernel = Callable[[int, Totals[np.ndarray], int, int], None]


@dataclass(frozen=True)
class FastsimSettings:
    """Discretisation of the simplified theory.

    Parameters
    ----------
    strips : int
        Number of strips across an ellipse; a solved patch has one strip for each column of elements.
    steps : int
        Number of steps along a strip. A second pass with twice as many steps serves to extrapolate.
    points : int
        Points along each axis of the tractions of an ellipse.
    law : FrictionLaw
        Friction as a function of the slip speed.
    profile_slip : bool
        Use the rigid slip of the guide's profile, eq. (20), instead of its tangent xi + phi x.
    """

    strips: int = 32
    steps: int = 48
    points: int = 40
    law: FrictionLaw = field(default_factory=constant)
    profile_slip: bool = False


@dataclass(frozen=True)
class FastsimSolution:
    """Solution of n patches by the simplified theory.

    Attributes
    ----------
    resultants : Resultants
        Forces [N] and spin moment [N mm] on the roller, (n,).
    friction_energy_per_distance : ndarray, shape (n,)
        Dissipation per distance travelled [N].
    stick_fraction : ndarray, shape (n,)
        Share of the adhesion area in the patch [1].
    """

    resultants: Resultants
    friction_energy_per_distance: np.ndarray
    stick_fraction: np.ndarray

    @property
    def works(self) -> Works:
        """Return the dissipation per distance travelled."""
        return Works.of_friction(self.friction_energy_per_distance)


def extrapolated(kernel: Kernel, steps: int, area: np.ndarray, known: np.ndarray) -> FastsimSolution:
    """Solve n patches with `steps` and twice as many steps along each strip, and extrapolate to infinitely many.

    Parameters
    ----------
    kernel : callable
        Writes the totals of some patches. Its error is of first order in the length of a step.
    steps : int
        Number of steps of the first pass.
    area : ndarray, shape (n,)
        Area of the patches [mm^2].
    known : ndarray of bool, shape (n,)
        False where there is no patch.

    Returns
    -------
    FastsimSolution
        Solution, NaN where there is no patch.
    """
    n = len(area)
    coarse, fine = (Totals(*(np.zeros(n) for _ in Totals._fields)) for _ in range(2))
    for totals, count in ((coarse, steps), (fine, 2 * steps)):
        share_rows(partial(kernel, count, totals), n, 4)
    best = Totals(*(np.where(known, 2.0 * f - c, np.nan) for c, f in zip(coarse, fine, strict=True)))
    with np.errstate(divide="ignore", invalid="ignore"):
        stick = fine.adhesion / area
    return FastsimSolution(Resultants(best.lateral, best.driving, best.moment), best.dissipation, stick)


def surface(
    x: np.ndarray, y: np.ndarray, pressure: np.ndarray, shear: np.ndarray, slip: np.ndarray
) -> SurfaceTractions:
    """Return the tractions from fields (n, 2, ny, nx) of shear [MPa] and slip [1]; points stick where the slip is 0."""
    stick = (pressure > 0) & (slip == 0.0).all(axis=1)
    return SurfaceTractions(x, y, pressure, shear[:, 0], shear[:, 1], slip[:, 0], slip[:, 1], stick)
