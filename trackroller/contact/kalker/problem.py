"""Settings and solution of the rolling contact problem for a batch of patches."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from trackroller.contact.friction_laws import FrictionLaw, constant
from trackroller.contact.quantities import Resultants, Works


@dataclass(frozen=True)
class KalkerSettings:
    """Discretisation and stopping rule of the exact theory.

    Parameters
    ----------
    elements : int
        Number along each axis of the patch; even if `extrapolate` is True.
    tolerance : float
        Largest residual of the friction law in any element over mu p_max [1], at which the
        iteration stops.
    steps, krylov : int
        Limits of Newton steps and of the Krylov space of one step.
    extrapolate : bool
        Extrapolate the resultants from two grids, with `elements` and with half of them.
    between : bool
        Integrate resultants and adhesion area between the elements too. False, where only the
        tractions are wanted, adds up the elements.
    profile_slip : bool
        Use the rigid slip of the circular guide profile, eq. (20), instead of its tangent xi + phi
        x.
    law : FrictionLaw, optional
        Friction as a function of the slip speed; default: constant friction.
    travel_speed : float
        Travel speed of the roller [mm/s], which turns slips into speeds; used where a call gives no
        travel speed.
    """

    elements: int = 40
    tolerance: float = 1e-6
    steps: int = 60
    krylov: int = 80
    extrapolate: bool = True
    between: bool = True
    profile_slip: bool = False
    law: FrictionLaw | None = None
    travel_speed: float = 1.0

    @property
    def law_in_use(self) -> FrictionLaw:
        """Return the friction law; one whose factor is 1 at every speed is the constant law."""
        return constant() if self.law is None or self.law.is_constant else self.law


@dataclass(frozen=True)
class PatchSolution:
    """Solution of n patches by the exact theory.

    Attributes
    ----------
    resultants : Resultants
        Forces on the roller [N] and spin moment [N mm], (n,); extrapolated if the settings say so.
    traction, slip : ndarray, shape (n, 2, ny, nx)
        Lateral and rolling component: traction over mu p_max [1], slip per travel speed [1].
    stick : ndarray of bool, shape (n, ny, nx)
        True where the surfaces stick.
    factor : ndarray, shape (n, ny, nx), or (n, 1, 1) under constant friction
        Friction over its value at rest [1].
    stick_fraction : ndarray, shape (n,)
        Share of the adhesion area in the patch [1]; its boundary may cross elements. Extrapolated
        as the resultants.
    friction_energy_per_distance : ndarray, shape (n,)
        Dissipation per travelled distance [N], from the work of the rigid slip and of the
        pressures.
    pressure_work : ndarray, shape (n,)
        Part of the dissipation that the pressures supply [N]. Tractions on unlike materials move
        the surfaces along the normal, and the pressures do work on this motion.
    energy_residual : ndarray, shape (n,)
        Dissipation summed over the elements, over `friction_energy_per_distance`, less 1 [1];
        extrapolated.
    limit : ndarray, shape (n, 6)
        Change of the resultants, of the adhesion area, of the pressures' work and of the energy
        residual by the extrapolation [N, N, N mm, 1, N, 1]; 0 without it.
    error_estimate : ndarray, shape (n, 3)
        |F_h - F_2h| of the resultants [N, N, N mm]; NaN without extrapolation.
    force_error : ndarray, shape (n,)
        Estimated error of the friction forces [N], see `extrapolation.force_error`; NaN without
        extrapolation.
    own_slip : ndarray, shape (n,)
        Slip per travel speed that the traction mu p_max of an element causes at itself [1], see
        `subgrid`.
    residual : ndarray, shape (n,)
        Largest residual of the friction law over mu p_max [1].
    steps, products : ndarray of int, shape (n,)
        Newton steps, and products with the influence matrix.
    converged : ndarray of bool, shape (n,)
        True where the residual is within its tolerance.
    """

    resultants: Resultants
    traction: np.ndarray
    slip: np.ndarray
    stick: np.ndarray
    factor: np.ndarray
    stick_fraction: np.ndarray
    friction_energy_per_distance: np.ndarray
    pressure_work: np.ndarray
    energy_residual: np.ndarray
    limit: np.ndarray
    error_estimate: np.ndarray
    force_error: np.ndarray
    own_slip: np.ndarray
    residual: np.ndarray
    steps: np.ndarray
    products: np.ndarray
    converged: np.ndarray

    @property
    def works(self) -> Works:
        """Return the dissipation summed over the elements and the part that the pressures supply,
        (n,) [N].
        """
        return Works(
            self.friction_energy_per_distance * (1.0 + self.energy_residual), self.pressure_work
        )

    def extrapolated_as(self, before: PatchSolution) -> PatchSolution:
        """Return the solution with energy residual and adhesion area extrapolated as in the similar
        one `before`.
        """
        stick = np.clip(self.stick_fraction + before.limit[:, 3], 0.0, 1.0)
        return replace(
            self, stick_fraction=stick, limit=before.limit, energy_residual=before.energy_residual
        )

    def take(self, index) -> PatchSolution:
        """Return the solution of the patches `index` (integer or boolean array)."""
        return PatchSolution(
            self.resultants.take(index), *(getattr(self, f.name)[index] for f in fields(self)[1:])
        )


def joined(parts: list[PatchSolution], order) -> PatchSolution:
    """Join solutions one after the other and return their patches in the order `order`
    (indices).
    """
    rest = [
        np.concatenate([getattr(p, f.name) for p in parts])[order]
        for f in fields(PatchSolution)[1:]
    ]
    forces = [
        np.concatenate([getattr(p.resultants, f.name) for p in parts])[order]
        for f in fields(Resultants)
    ]
    return PatchSolution(Resultants(*forces), *rest)


class Store:
    """Last solutions of patches in numbered slots, tractions and slips in single precision."""

    def __init__(self, slots: int) -> None:
        self.known = np.zeros(slots, bool)
        self._rows = np.zeros(slots, int)  # of the solution, by slot
        self._solution: PatchSolution | None = None

    def put(self, slot: np.ndarray, solution: PatchSolution) -> None:
        """Keep a solution of m patches in the slots (m,)."""
        kept = {name: getattr(solution, name).astype(np.float32) for name in ("traction", "slip")}
        solution = replace(solution, **kept)
        fresh = ~self.known[slot]
        if fresh.any():
            parts = [part for part in (self._solution, solution.take(fresh)) if part is not None]
            count = 0 if self._solution is None else len(self._solution.residual)
            self._rows[slot[fresh]] = count + np.arange(int(fresh.sum()))
            self._solution = joined(parts, slice(None))
            self.known[slot[fresh]] = True
        if self._solution is not None and not fresh.all():
            for kept_values, values in zip(_arrays(self._solution), _arrays(solution), strict=True):
                kept_values[self._rows[slot[~fresh]]] = values[~fresh]

    def get(self, slot: np.ndarray) -> PatchSolution:
        """Return the solutions in the slots (m,)."""
        if self._solution is None:
            raise LookupError("no patch has been solved")
        return self._solution.take(self._rows[slot])

    def state(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the residual in each slot and whether it has converged; 0 and True where nothing
        was solved.
        """
        residual, converged = np.zeros(self.known.size), np.ones(self.known.size, bool)
        if self._solution is not None:
            rows = self._rows[self.known]
            residual[self.known], converged[self.known] = (
                self._solution.residual[rows],
                self._solution.converged[rows],
            )
        return residual, converged


def _arrays(solution: PatchSolution) -> list[np.ndarray]:
    r = solution.resultants
    return [
        r.lateral_force,
        r.driving_force,
        r.spin_moment,
        *(getattr(solution, f.name) for f in fields(solution)[1:]),
    ]
