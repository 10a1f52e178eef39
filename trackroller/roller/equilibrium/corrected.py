"""Equilibrium under an expensive contact law, found with a cheap law that is corrected at the
balance.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, replace

import numpy as np

from trackroller.contact.quantities import Resultants
from trackroller.roller.equilibrium.newton import Bounds, digits_of_forces, newton_polish, settled
from trackroller.roller.equilibrium.roller import LAST_SLIP, ContactLaw, Roller, RollerLoads
from trackroller.roller.equilibrium.solution import FAILED, ROLLING, Equilibrium, solve_equilibrium

ROUNDS = 6  # of correction at most
# The balance is final after a correction that changes no force by more than this, over mu F_N: the
# next correction would change the forces much less.
SETTLED = 2e-3

_ARRAYS = tuple(f.name for f in fields(RollerLoads) if f.type == "np.ndarray")
# rollers (m,) and their equilibrium -> largest change of the law there (m,)
Correct = Callable[[np.ndarray, Equilibrium], np.ndarray]


def solve_corrected(
    loads: RollerLoads, law: ContactLaw, correct: Correct
) -> tuple[Equilibrium, np.ndarray]:
    """Find the equilibrium of n rollers under a law that is corrected after each solution.

    Parameters
    ----------
    loads : RollerLoads
        Applied loads, friction and geometry, arrays (n,).
    law : ContactLaw
        The cheap law with its corrections.
    correct : callable
        Corrects the law at the balance of given rollers and returns the largest change of a force
        there over mu F_N.

    Returns
    -------
    balance : Equilibrium
        The equilibrium.
    rows : numpy.ndarray of int, shape (m,)
        Rollers whose last correction was larger than `SETTLED`, which is their residual then;
        rollers that a correction has stopped rolling; and rollers for which the cheap law has no
        balance.
    """
    balance = solve_equilibrium(loads, law)
    rows = _rolling(balance, loads, np.arange(loads.friction.size))
    rolled = (balance.regime == ROLLING) | (balance.regime == FAILED)
    for _ in range(ROUNDS):
        if not rows.size:
            break
        change = correct(rows, balance)
        moved = rows[~(change == 0.0)]
        if moved.size:
            balance = balance_again(loads, law, moved, balance)
        open_ = ~(change <= SETTLED)
        balance.residual[rows[open_]], balance.converged[rows[open_]] = change[open_], False
        rows = _rolling(balance, loads, rows[open_])
    # the corrections hold near the slip where they were made, so that they do not show a change of
    # regime
    lost = np.flatnonzero(rolled & (balance.regime != ROLLING) & (loads.friction > 0.0))
    return balance, np.union1d(rows, lost)


def _rolling(balance: Equilibrium, loads: RollerLoads, rows: np.ndarray) -> np.ndarray:
    return rows[(balance.regime[rows] == ROLLING) & (loads.friction[rows] > 0.0)]


def balance_again(
    loads: RollerLoads, law: ContactLaw, rows: np.ndarray, balance: Equilibrium
) -> Equilibrium:
    """Return `balance` with the rollers `rows` balanced again; the search starts from their last
    balance.
    """
    roller = Roller(loads, law, rows)
    bounds = Bounds(roller.w_of(-roller.radius), np.full(rows.size, LAST_SLIP))
    start = roller.w_of(balance.shift[rows]), balance.normal_force[rows].T.copy()
    near = newton_polish(roller, *start, bounds, settled(roller))
    with np.errstate(invalid="ignore"):
        good = (near.residual <= loads.converged) & ~roller.lifts(near.normal)
        good &= roller.wedged(near.normal, near.forces)
    again = Equilibrium(
        regime=np.full(rows.size, ROLLING, np.int8),
        converged=near.residual <= loads.converged,
        residual=np.fmax(near.residual, digits_of_forces(roller, near)),
        jamming=roller.grips(near.normal, near.forces),
        shift=roller.shift(near.w),
        normal_force=near.normal.T,
        forces=Resultants(*near.forces.transpose(0, 2, 1)),
    )
    merged_balance = merged(balance, rows[good], again, np.flatnonzero(good))
    lost = rows[~good]
    if lost.size:
        return merged(merged_balance, lost, solve_some(loads, law, lost), np.arange(lost.size))
    return merged_balance


def solve_some(loads: RollerLoads, law: ContactLaw, rows: np.ndarray) -> Equilibrium:
    """Return the equilibrium of the rollers `rows`, searched without a start; arrays (m,)."""

    def numbered(ellipse, slip, friction, places, fine):
        return law(ellipse, slip, friction, rows[places], fine)

    arrays = {name: getattr(loads, name)[rows] for name in _ARRAYS}
    return solve_equilibrium(replace(loads, shape=loads.shape.take(rows), **arrays), numbered)


def merged(
    balance: Equilibrium, rows: np.ndarray, other: Equilibrium, places: np.ndarray
) -> Equilibrium:
    """Return `balance` with the rollers `rows` replaced by the rollers `places` of `other`."""

    def put(old: np.ndarray, new: np.ndarray) -> np.ndarray:
        out = old.copy()
        out[rows] = new[places]
        return out

    names = [f.name for f in fields(Equilibrium) if f.name != "forces"]
    values = {name: put(getattr(balance, name), getattr(other, name)) for name in names}
    parts = (
        put(getattr(balance.forces, f.name), getattr(other.forces, f.name))
        for f in fields(Resultants)
    )
    return Equilibrium(**values, forces=Resultants(*parts))
