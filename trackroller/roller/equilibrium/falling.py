"""Balance of the drive torque under friction that depends on the slip speed.

Such friction may transmit its largest torque at a moderate slip. If several slips balance the torque, the smallest one
is taken: a gentle start reaches it, and it is stable.

The search uses the coarse contact law. Near the largest transmissible torque, the coarse and the fine law may disagree
on the slip of the balance or on whether a balance exists. There the search uses the fine law.
"""

from __future__ import annotations

import numpy as np

from trackroller.roller.equilibrium.newton import Bounds, Solution, bracketed, newton_polish
from trackroller.roller.equilibrium.roller import Roller

POINTS = 24  # slips of the search
FIRST, LAST = -1.5, 3.5  # decades of slip over its scale between which the search looks
GOLDEN = 0.381966011250105
REFINEMENTS = 12
SWEEPS = 16  # largest number of steps with the fine law; where its forces jump, more steps do not help
NEAR = 0.1  # torque over its scale by which the coarse law may fall short where the fine law has a balance


def first_balance(roller: Roller, whole: Bounds, fine: bool = False) -> tuple[Bounds, np.ndarray, np.ndarray]:
    """Bound the balance with the smallest slip, for rollers that are driven or braked.

    Parameters
    ----------
    roller : Roller
        The m rollers.
    whole : Bounds
        Whole range of w.
    fine : bool
        True for the fine contact law.

    Returns
    -------
    bounds : Bounds
        Bounds of the balance.
    beyond : numpy.ndarray of bool, shape (m,)
        True where there is no balance.
    unsure : numpy.ndarray of bool, shape (m,)
        True where the coarse law misses a balance by so little that the fine law may have one.
    """
    w_low, w_high = whole
    way = np.sign(roller.motor_force)  # driving needs a slip < 0
    normal = roller.floored(roller.without_friction())

    steps = 1
    if fine:
        steps = 2

    def excess(w, pick):
        """Return the torque beyond the required one, > 0 where friction suffices; the normal forces follow."""
        for _ in range(steps):
            f = roller.contact(roller.shift(w, pick), normal[:, pick], fine, pick)
            normal[:, pick] = roller.floored(roller.normal_forces(f[0] / normal[:, pick], pick), pick)
        return -way[pick] * roller.torque(f, pick)

    low, high = w_low.copy(), w_high.copy()
    slips = np.concatenate([[0.0, 0.0], np.logspace(FIRST, LAST, POINTS)])  # 0 twice, for the normal forces
    points = np.clip(way * (slips / np.hypot(1.0, slips))[:, None], w_low, w_high)  # (points, m)
    open_ = np.flatnonzero(way != 0)
    beyond = np.zeros(way.size, bool)
    best = np.full(way.size, -np.inf)
    place = np.zeros(way.size, int)
    for k, w in enumerate(points):
        t = excess(w[open_], open_)
        higher = t > best[open_]
        best[open_[higher]], place[open_[higher]] = t[higher], k
        balanced = open_[(t >= 0) & (k > 0)]
        _narrow(low, high, way, balanced, points[k - 1, balanced], w[balanced], at_rest=k == 1)
        open_ = np.setdiff1d(open_, balanced)
        if open_.size == 0:
            return Bounds(low, high), beyond, beyond.copy()
    summit = np.stack([points[np.clip(place[open_] + step, 1, POINTS + 1), open_] for step in (-1, 0, 1)])
    beyond[open_] = ~_climb(excess, open_, summit, way, low, high)
    return Bounds(low, high), beyond, beyond & (best > -NEAR * roller.torque_scale)


def balance_again(roller: Roller, whole: Bounds) -> tuple[Solution, Bounds, np.ndarray]:
    """Find balances by the fine law alone, for rollers whose coarse law has its balance elsewhere or none.

    Parameters
    ----------
    roller : Roller
        The m rollers.
    whole : Bounds
        Whole range of w.

    Returns
    -------
    solution : Solution
        The balances.
    bounds : Bounds
        Bounds from zero slip to beyond the balance.
    beyond : numpy.ndarray of bool, shape (m,)
        True where there is no balance.
    """
    (low, high), beyond, _ = first_balance(roller, whole, fine=True)
    w, normal = bracketed(roller, Bounds(low.copy(), high.copy()), fine=True, sweeps=SWEEPS, tolerance=1e-6)
    # the search used the normal forces of the step before, so the balance may lie slightly outside its bounds
    room = 0.5 * (high - low)
    wider = Bounds(np.maximum(low - room, whole.low), np.minimum(high + room, whole.high))
    solution = newton_polish(roller, w, normal, wider)
    return solution, Bounds(np.minimum(wider.low, 0.0), np.maximum(wider.high, 0.0)), beyond


def _narrow(low, high, way, rows, before, after, at_rest: bool) -> None:
    """Narrow the bounds of `rows` to the slips `before` and `after`, or to the opposite slip if `at_rest`."""
    drives = way[rows] < 0
    if at_rest:
        low[rows] = np.where(drives, 0.0, low[rows])
        high[rows] = np.where(drives, high[rows], 0.0)
    else:
        low[rows] = np.minimum(before, after)
        high[rows] = np.maximum(before, after)


def _climb(excess, rows, summit, way, low, high) -> np.ndarray:
    """Search the largest torque by golden sections; return True where it reaches the required torque, (m,)."""
    left, right = summit[0].copy(), summit[2].copy()
    inner = [left + GOLDEN * (right - left), right - GOLDEN * (right - left)]
    value = [excess(w, rows) for w in inner]
    done = np.zeros(rows.size, bool)
    for _ in range(REFINEMENTS):
        for w, t in zip(inner, value, strict=True):
            hit = (t >= 0) & ~done
            _narrow(low, high, way, rows[hit], summit[0, hit], w[hit], at_rest=False)
            done |= hit
        if done.all():
            break
        up = value[0] < value[1]
        left, right = np.where(up, inner[0], left), np.where(up, right, inner[1])
        new = np.where(up, right - GOLDEN * (right - left), left + GOLDEN * (right - left))
        t = excess(new, rows)
        inner = [np.where(up, inner[1], new), np.where(up, new, inner[0])]
        value = [np.where(up, value[1], t), np.where(up, t, value[0])]
    return done
