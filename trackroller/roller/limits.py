"""Find how far a roller is from lift-off, full slip and self-locking."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from trackroller.contact.friction_laws import law_of
from trackroller.parameters import PARAMETERS, REGIMES
from trackroller.roller.case import Case
from trackroller.roller.dataset import validity_bit
from trackroller.roller.solver import solve

if TYPE_CHECKING:
    import xarray as xr

    from trackroller.materials import MaterialDatabase

POINTS, ROUNDS = 17, 7  # cases a round on each search, and rounds: the range shrinks by 16 each time
_ROLLING, _FULL_SLIP, _LIFT_OFF, _FAILED = (REGIMES.index(name) for name in REGIMES)
_LOCKED = validity_bit("jamming")
_LARGEST_FRICTION = PARAMETERS["friction_coefficient"].upper


@dataclass(frozen=True)
class Limits:
    """Ranges in which a roller rolls with both contacts loaded.

    Attributes
    ----------
    axial_force : tuple of float
        Lowest and highest axial force [N] at which both contacts carry load; NaN if none was found.
    motor_force : tuple of float
        Motor forces [N] between which the roller does not skid, driving (< 0) and braking (> 0); NaN if it has lifted.
    self_locking_friction : float
        Friction coefficient [1] from which friction alone carries the lateral load of a contact; inf beyond 2, the
        largest coefficient; NaN if the roller has lifted without being locked.
    """

    axial_force: tuple[float, float]
    motor_force: tuple[float, float]
    self_locking_friction: float


def limits(case: Case, contact_model: str = "kalker", database: MaterialDatabase | None = None) -> Limits:
    """Search the axial forces, motor forces and friction at which the regime of a roller ends.

    Parameters
    ----------
    case : Case
        The roller with its loads.
    contact_model : str
        Contact model of the searched equilibria.
    database : MaterialDatabase, optional
        Materials; the built-in ones and the user's own if not given.

    Returns
    -------
    Limits
        Each bound is exact to 1e-7 of the range searched: four times |F_rad| + |F_ax| for forces.

    Notes
    -----
    Equilibria are solved with `accuracy="preview"`, in batches, about 450 in all.
    ASSUME: drawn profiles are replaced by their nominal circles, for the equilibrium hardly depends on the shape of the
    patch. ASSUME: friction that falls with the slip speed is searched with full sliding, which is a thousand times
    cheaper and has the same complete friction.

    Examples
    --------
    >>> low, high = limits(Case(friction_coefficient=0, motor_force=0, axial_force=0)).axial_force
    >>> round(high, 2)  # F_rad tan(alpha)
    115.47
    """
    nominal = replace(case, guide_profile=None, roller_profile=None)
    model = contact_model if law_of(case.friction_law).is_constant else "sliding"
    span = 4.0 * (abs(case.radial_force) + abs(case.axial_force))

    def states(cases: list[Case]) -> xr.Dataset:
        return solve(cases, outputs="forces", contact_model=model, accuracy="preview", stop_if=None, database=database)

    def axial(values: np.ndarray) -> np.ndarray:
        found = states([replace(nominal, axial_force=float(v)) for v in values])
        return np.isin(found.regime.values, (_ROLLING, _FULL_SLIP))

    def motor(values: np.ndarray) -> np.ndarray:
        return states([replace(nominal, motor_force=float(v)) for v in values]).regime.values == _ROLLING

    def loose(values: np.ndarray) -> np.ndarray:
        found = states([replace(nominal, friction_coefficient=float(v)) for v in values])
        return (found.validity.values & _LOCKED) == 0

    start = 0.0 if not axial(np.array([case.axial_force]))[0] else case.axial_force
    lifted = start != case.axial_force
    slipping = lifted or not motor(np.array([0.0]))[0]
    return Limits(
        (_edge(axial, start, -span), _edge(axial, start, span)),
        (math.nan, math.nan) if slipping else (_edge(motor, 0.0, -span), _edge(motor, 0.0, span)),
        _edge(loose, 0.0, _LARGEST_FRICTION),
    )


def _edge(holds: Callable[[np.ndarray], np.ndarray], start: float, end: float) -> float:
    """Return the last value from `start` towards `end` at which a condition holds.

    NaN if it does not hold at `start`, and infinity with the sign of the direction if it holds as far as `end`.
    """
    for _ in range(ROUNDS):
        values = np.linspace(start, end, POINTS)
        ends = np.flatnonzero(~holds(values))
        if ends.size == 0:
            return math.copysign(math.inf, end - start)
        if ends[0] == 0:
            return math.nan
        start, end = float(values[ends[0] - 1]), float(values[ends[0]])
    return start
