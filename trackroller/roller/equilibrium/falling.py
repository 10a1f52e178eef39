"""Where a roller balances its drive torque under friction that depends on the slip speed.

Such friction may transmit most at a moderate slip and less beyond. Of several slips that balance the torque the one
nearest to none is taken: it is the one that starting gently reaches, and the one that is stable.

The search runs with the coarse contact law. Near the most that friction transmits, the coarse and the fine law may
differ in where the balance lies and even in whether there is one; then the fine law is searched itself.
"""

from __future__ import annotations

import numpy as np

from trackroller.roller.equilibrium.newton import bracketed, newton_polish
from trackroller.roller.equilibrium.roller import Roller

POINTS = 24  # of the search away from no slip
FIRST, LAST = -1.5, 3.5  # decades of slip over its scale between which it looks
GOLDEN, REFINEMENTS = 0.381966011250105, 12
SWEEPS = 16  # of the fine law; where its forces jump, more lead nowhere
NEAR = 0.1  # of the torque scale by which the coarse law may miss a balance that the fine one has


def first_balance(roller: Roller, w_low: np.ndarray, w_high: np.ndarray, fine: bool = False):
    """Bounds in w of the balance nearest to no slip, for rollers that are driven or braked.

    w_low, w_high : the whole range, (m,); fine : by the fine contact law

    Returns w_low and w_high narrowed to that balance, where there is none (m,), and whether it was missed by so
    little there that the fine law may have one (m,).
    """
    way = np.sign(roller.motor_force)  # driving needs slip < 0
    normal = roller.floored(roller.normal_forces(np.zeros((2, way.size))))

    def excess(w, pick):
        """Torque beyond the one asked for, > 0 once friction suffices; the normal forces follow."""
        for _ in range(2 if fine else 1):
            f = roller.contact(roller.shift(w, pick), normal[:, pick], fine, pick)
            normal[:, pick] = roller.floored(roller.normal_forces(f[0] / normal[:, pick], pick), pick)
        return -way[pick] * roller.torque(f, pick)

    low, high = w_low.copy(), w_high.copy()
    slips = np.concatenate([[0.0, 0.0], np.logspace(FIRST, LAST, POINTS)])  # twice 0 for the normal forces
    points = np.clip(way * (slips / np.hypot(1.0, slips))[:, None], w_low, w_high)  # (points, m)
    open_, beyond = np.flatnonzero(way != 0), np.zeros(way.size, bool)
    best, place = np.full(way.size, -np.inf), np.zeros(way.size, int)
    for k, w in enumerate(points):
        t = excess(w[open_], open_)
        higher = t > best[open_]
        best[open_[higher]], place[open_[higher]] = t[higher], k
        found = open_[(t >= 0) & (k > 0)]
        _narrow(low, high, way, found, points[k - 1, found], w[found], at_rest=k == 1)
        open_ = np.setdiff1d(open_, found)
        if open_.size == 0:
            return low, high, beyond, beyond.copy()
    summit = np.stack([points[np.clip(place[open_] + step, 1, POINTS + 1), open_] for step in (-1, 0, 1)])
    beyond[open_] = ~_climb(excess, open_, summit, way, low, high)
    return low, high, beyond, beyond & (best > -NEAR * roller.torque_scale)


def balance_again(loads, law, rows: np.ndarray, w_low: np.ndarray, w_high: np.ndarray):
    """Balances found by the fine law alone, for rollers where the coarse one misleads.

    w_low, w_high : the whole range, (m,)

    Returns what `newton_polish` does, bounds of w that reach from no slip to beyond the balance, and where there is
    none (m,).
    """
    roller = Roller(loads, law, rows)
    low, high, beyond, _ = first_balance(roller, w_low, w_high, fine=True)
    w, normal = bracketed(roller, low.copy(), high.copy(), fine=True, sweeps=SWEEPS, tolerance=1e-6)
    # the normal forces lagged behind the search, so that the balance may lie a little beside its bounds
    room = 0.5 * (high - low)
    low, high = np.maximum(low - room, w_low), np.minimum(high + room, w_high)
    found = newton_polish(roller, w, normal, low, high)
    return *found, np.minimum(low, 0.0), np.maximum(high, 0.0), beyond


def _narrow(low, high, way, rows, before, after, at_rest: bool) -> None:
    """The balance of `rows` lies between the slips `before` and `after`; at rest it lies on the other side of none."""
    drives = way[rows] < 0
    if at_rest:
        low[rows] = np.where(drives, 0.0, low[rows])
        high[rows] = np.where(drives, high[rows], 0.0)
    else:
        low[rows] = np.minimum(before, after)
        high[rows] = np.maximum(before, after)


def _climb(excess, rows, summit, way, low, high) -> np.ndarray:
    """Golden-section search for a slip that suffices, about the highest point seen; True where there is one."""
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
