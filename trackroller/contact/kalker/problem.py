"""What a rolling problem is given and what its solution tells, for patches in a batch."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from trackroller.contact.common import Resultants, Works
from trackroller.contact.friction_laws import FrictionLaw


@dataclass(frozen=True)
class KalkerSettings:
    """Discretisation and stopping rule.

    elements : number along each axis of the ellipse (even if `extrapolate`)
    tolerance : largest residual of the friction law in any element, over mu p_max; the stopping rule
    steps, krylov : limits of Newton steps and of the Krylov space of one step
    extrapolate : resultants from grids with `elements` and half of them
    profile_slip : rigid slip of the circular guide profile, eq. (20), instead of its tangent xi + phi x
    law : friction as a function of the slip speed; constant if not given
    travel_speed : of the roller [mm/s], which turns slips into speeds, where a call does not give its own
    """

    elements: int = 40
    tolerance: float = 1e-6
    steps: int = 60
    krylov: int = 80
    extrapolate: bool = True
    profile_slip: bool = False
    law: FrictionLaw | None = None
    travel_speed: float = 1.0


@dataclass(frozen=True)
class PatchSolution:
    """Solution of n patches.

    resultants : on the roller, extrapolated if asked for
    traction, slip : (n, 2, ny, nx), x_C and y_C part, over mu p_max and per travel speed
    stick : (n, ny, nx) where the surfaces stick
    stick_fraction : share of the ellipse that sticks [-]
    friction_energy_per_distance : dissipation per travelled distance [N], from the works of the rigid slip and of
        the pressures
    pressure_work : what the pressures add where the tractions move unlike surfaces along the normal [N]
    energy_residual : relative difference of the dissipation summed over the elements and that work, extrapolated
    error_estimate : (n, 3) |F_h - F_2h| of the resultants [N, N, N mm]; NaN without extrapolation
    residual, steps, products : largest residual of the friction law over mu p_max, Newton steps, products
    converged : residual within its tolerance
    """

    resultants: Resultants
    traction: np.ndarray
    slip: np.ndarray
    stick: np.ndarray
    stick_fraction: np.ndarray
    friction_energy_per_distance: np.ndarray
    pressure_work: np.ndarray
    energy_residual: np.ndarray
    error_estimate: np.ndarray
    residual: np.ndarray
    steps: np.ndarray
    products: np.ndarray
    converged: np.ndarray

    @property
    def works(self) -> Works:
        """Dissipation summed over the elements, and what the pressures put in."""
        return Works(self.friction_energy_per_distance * (1.0 + self.energy_residual), self.pressure_work)

    def take(self, index) -> PatchSolution:
        """The patches `index`."""
        return PatchSolution(self.resultants.take(index), *(getattr(self, f.name)[index] for f in fields(self)[1:]))


def joined(parts: list[PatchSolution], order) -> PatchSolution:
    """Solutions one after the other, then taken in an order."""
    rest = [np.concatenate([getattr(p, f.name) for p in parts])[order] for f in fields(PatchSolution)[1:]]
    forces = [np.concatenate([getattr(p.resultants, f.name) for p in parts])[order] for f in fields(Resultants)]
    return PatchSolution(Resultants(*forces), *rest)
