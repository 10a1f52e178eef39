"""Find how far a roller is from lift-off, full slip and self-locking."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from trackroller.contact.friction_laws import law_of
from trackroller.numerics.brackets import narrowed
from trackroller.parameters import PARAMETERS
from trackroller.roller.case import Case
from trackroller.roller.dataset import validity_bit
from trackroller.roller.equilibrium import FULL_SLIP, ROLLING
from trackroller.roller.solver import solve

if TYPE_CHECKING:
    import xarray as xr

    from trackroller.materials import MaterialDatabase

# Parts into which the first round, and each further one, cuts the range of each search. Cases near lift-off are dear,
# and many rounds of few cases need the least of them.
FIRST = 8
ROUNDS = (4,) * 8
_LOCKED = validity_bit("jamming")
_FRICTION = PARAMETERS["friction_coefficient"].upper
_FIELD = {"locking": "friction_coefficient", "lifting": "friction_coefficient"}  # limits of one field


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
    lift_off_friction : float
        Friction coefficient [1], above that of the case, from which a contact lifts off; inf beyond 2; NaN if a contact
        has lifted.
    """

    axial_force: tuple[float, float]
    motor_force: tuple[float, float]
    self_locking_friction: float
    lift_off_friction: float = math.nan


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
        Each bound is exact to 2e-6 of the range searched: four times |F_rad| + |F_ax| for forces.

    Notes
    -----
    Equilibria are solved with `accuracy="preview"`, in batches, about 150 in all.
    ASSUME: drawn and worn profiles are replaced by their nominal circles, for the equilibrium hardly depends on the
    shape of the patch. ASSUME: friction that falls with the slip speed is searched with full sliding, which is a
    thousand times cheaper and has the same complete friction. ASSUME: a film between the bodies is left out.

    Examples
    --------
    >>> low, high = limits(Case(friction_coefficient=0, motor_force=0, axial_force=0)).axial_force
    >>> round(high, 2)  # F_rad tan(alpha)
    115.47
    """
    bare = {"guide_profile": None, "roller_profile": None, "travel": 0.0, "layer_flexibility": 0.0}
    nominal = replace(case, **bare)
    model = "sliding"
    if law_of(case.friction_law).is_constant:
        model = contact_model
    span = 4.0 * (abs(case.radial_force) + abs(case.axial_force))

    def holds(cases: list[Case]) -> dict[str, np.ndarray]:
        return _conditions(solve(cases, "forces", contact_model=model, accuracy="preview", database=database))

    now = holds([nominal])
    free = holds([replace(nominal, **{"motor_force": 0.0})])
    lifted = not now["axial_force"][0]
    rolls = free["motor_force"][0]
    start = case.axial_force
    if lifted:
        start = 0.0
    friction = 0.0
    if isinstance(nominal.friction_coefficient, (int, float)):
        friction = float(nominal.friction_coefficient)
    searches = [("axial_force", start, -span), ("axial_force", start, span), ("locking", 0.0, _FRICTION)]
    searches.append(("lifting", friction, _FRICTION))
    if rolls and not lifted:
        searches += [("motor_force", 0.0, -span), ("motor_force", 0.0, span)]
    lowest, highest, locking, lifting, *motor = _edges(holds, nominal, searches)
    if not motor:
        motor = [math.nan, math.nan]
    return Limits((lowest, highest), (motor[0], motor[1]), locking, lifting)


def _conditions(ds: xr.Dataset) -> dict[str, np.ndarray]:
    """Return for each searched limit which cases lie on the near side of its limit."""
    regime = ds.regime.values
    return {
        "axial_force": np.isin(regime, (ROLLING, FULL_SLIP)),
        "motor_force": regime == ROLLING,
        "locking": (ds.validity.values & _LOCKED) == 0,
        "lifting": np.isin(regime, (ROLLING, FULL_SLIP)),
    }


def _edges(
    holds: Callable[[list[Case]], dict[str, np.ndarray]], case: Case, searches: Sequence[tuple[str, float, float]]
) -> list[float]:
    """Return for each search (limit, start, end) the last value from the start at which the condition holds.

    NaN if it does not hold at the start, and infinity with the sign of the direction if it holds as far as the end. A
    round solves the cases of all searches in one batch.
    """
    names = [name for name, _, _ in searches]

    def near(places: Sequence[int], values: Sequence[float]) -> list[bool]:
        """Return whether the condition of each search `places` holds at a value."""
        fields = [_FIELD.get(names[place], names[place]) for place in places]
        truths = holds([replace(case, **{field: value}) for field, value in zip(fields, values, strict=True)])
        return [bool(truths[names[place]][row]) for row, place in enumerate(places)]

    edges = [math.nan] * len(searches)
    going = {}
    lines = [np.linspace(start, end, FIRST + 1).tolist() for _, start, end in searches]
    answers = iter(near([i for i, line in enumerate(lines) for _ in line], [v for line in lines for v in line]))
    for i, line in enumerate(lines):
        truths = [next(answers) for _ in line]
        if all(truths):
            edges[i] = math.copysign(math.inf, line[-1] - line[0])
        elif truths[0]:
            going[i] = line[truths.index(False) - 1], line[truths.index(False)]
    places = list(going)
    ends = narrowed(list(going.values()), ROUNDS, lambda numbers, v: near([places[n] for n in numbers], v))
    for i, (edge, _) in zip(places, ends, strict=True):
        edges[i] = edge
    return edges
