"""Find roots of the balances of a roller: bracket the slip with a coarse law, then refine all unknowns by Newton."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from trackroller.numerics.compiled import assign, compiled
from trackroller.roller.equilibrium.roller import Roller

SMALL = 0.01  # the error of the forces is estimated where rolling radius / size of the patch is below this ratio
EPS = 2.0**-53
# The iteration of a roller ends when a step changes its forces by less than SETTLED times the goal. Models in closed
# form (goal up to CLOSED) are cheap and iterate until rounding ends them, which rollers at the ends of the parameter
# ranges need.
SETTLED, CLOSED = 0.1, 1e-11


class Bounds(NamedTuple):
    """Lowest and highest slip w of a search, each (m,)."""

    low: np.ndarray
    high: np.ndarray

    def take(self, rows: np.ndarray) -> Bounds:
        """Return the bounds of `rows`, as new arrays."""
        return Bounds(self.low[rows], self.high[rows])

    def copy(self) -> Bounds:
        """Return new arrays, which a search may narrow."""
        return Bounds(self.low.copy(), self.high.copy())


@dataclass
class Solution:
    """Solutions of m rollers: residual (m,), slip w (m,), normal forces (2, m) [N], contact forces (3, 2, m)."""

    residual: np.ndarray
    w: np.ndarray
    normal: np.ndarray
    forces: np.ndarray

    def take(self, rows: np.ndarray) -> Solution:
        """Return the solutions `rows`."""
        return Solution(self.residual[rows], self.w[rows], self.normal[:, rows], self.forces[:, :, rows])

    def put(self, rows: np.ndarray, other: Solution) -> None:
        """Overwrite the solutions `rows`."""
        self.residual[rows], self.w[rows] = other.residual, other.w
        self.normal[:, rows], self.forces[:, :, rows] = other.normal, other.forces

    def put_better(self, rows: np.ndarray, other: Solution, converged: float) -> None:
        """Overwrite solutions by those with a smaller residual or with a residual up to `converged`."""
        take = ~((other.residual > self.residual[rows]) & (other.residual > converged))
        self.put(rows[take], other.take(take))


def bracketed(
    roller: Roller, bounds: Bounds, fine: bool, sweeps: int, tolerance: float
) -> tuple[np.ndarray, np.ndarray]:
    """Find the root of the torque balance in w by the Illinois rule, with normal forces that follow.

    The torque falls with w. The search narrows the arrays of `bounds`.

    Parameters
    ----------
    roller : Roller
        The m rollers.
    bounds : Bounds
        Lowest and highest w.
    fine : bool
        True for the fine contact law.
    sweeps : int
        Largest number of steps.
    tolerance : float
        Change of w and width of the bounds at which the search ends.

    Returns
    -------
    w : numpy.ndarray, shape (m,)
        Slip.
    normal : numpy.ndarray, shape (2, m)
        Normal forces [N].
    """
    m = roller.rows.size
    w_low, w_high = bounds
    t_low, t_high = np.full(m, np.nan), np.full(m, np.nan)  # the torque at the bounds
    normal = roller.floored(roller.without_friction())
    w = np.clip(np.zeros(m), w_low, w_high)
    side = np.zeros(m)  # on which side of the root the last slip was
    active = np.arange(m)
    unmet_above = 0.0
    if fine:
        unmet_above = settled(roller)
    for _ in range(sweeps):
        f = _following(roller, w, normal, fine, active)
        t = roller.torque(f, active)
        up = t > 0
        at = w[active]
        sign = np.where(up, 1.0, -1.0)
        # a bound that stays twice counts with half its torque, so that the next slip comes closer to it
        share = np.where(sign == side[active], 0.5, 1.0)
        lo, hi = np.where(up, at, w_low[active]), np.where(up, w_high[active], at)
        tl, th = np.where(up, t, share * t_low[active]), np.where(up, share * t_high[active], t)
        w_low[active], w_high[active] = lo, hi
        t_low[active], t_high[active] = tl, th
        side[active] = sign
        with np.errstate(divide="ignore", invalid="ignore"):
            new = (lo * th - hi * tl) / (th - tl)
        new = np.where(np.isfinite(new) & (new > lo) & (new < hi), new, (lo + hi) / 2)
        new = np.where(t == 0.0, at, new)  # a root, beside which a steep law would lead Newton's method away
        moved = np.abs(new - at)
        w[active] = new
        # Newton's method refines rollers whose torque is balanced already
        unmet = np.abs(t) > unmet_above * roller.torque_scale[active]
        active = active[(moved > tolerance) & (hi - lo > tolerance) & unmet]
        if active.size == 0:
            break
    return w, normal


def settled(roller: Roller) -> float:
    """Return the relative change of forces at which the iteration of a roller ends."""
    return SETTLED * roller.goal if roller.goal > CLOSED else 0.0


def _following(roller: Roller, w, normal, fine: bool, rows: np.ndarray) -> np.ndarray:
    """Return the contact forces (3, 2, m) of `rows` at slip w; the normal forces follow, in three steps if `fine`."""
    f = np.empty((3, 2, rows.size))
    go = np.arange(rows.size)
    steps = 1
    if fine:
        steps = 3
    for _ in range(steps):
        k = rows[go]
        f[:, :, go] = roller.contact(roller.shift(w[k], k), normal[:, k], fine, k)
        new = roller.floored(roller.normal_forces(f[0][:, go] / normal[:, k], k), k)
        moved = np.max(np.abs(new - normal[:, k]), axis=0)
        normal[:, k] = new
        go = go[~(moved < settled(roller) * roller.load[k])]
        if go.size == 0:
            break
    return f


def _jacobian(roller: Roller, w, normal, pick) -> np.ndarray:
    """Return the derivatives of the balances by (F_N1, F_N2, w), (m, 3, 3), as differences of the coarse law."""
    h, m = roller.step, w.size
    step = h * (1 - np.abs(w)) * np.where(w > 0, -1.0, 1.0)
    slips, normals = np.concatenate((w, w, w + step)), np.concatenate((normal, normal * (1 + h), normal), axis=1)
    picks, f = np.concatenate((pick, pick, pick)), np.empty((3, 2, 3 * m))
    # an iterative law starts from the state before; the others take the three states at once
    count = 3
    if roller.goal <= CLOSED:
        count = 1
    for part in np.split(np.arange(3 * m), count):
        f[:, :, part] = roller.contact(roller.shift(slips[part], picks[part]), normals[:, part], False, picks[part])
    base, grown, moved = f[:, :, :m], f[:, :, m : 2 * m], f[:, :, 2 * m :]
    r0 = roller.residuals(normal, base, pick)
    jac = np.empty((m, 3, 3))
    for i in (0, 1):
        f, n = base.copy(), normal.copy()
        f[:, i], n[i] = grown[:, i], normal[i] * (1 + h)
        jac[:, :, i] = ((roller.residuals(n, f, pick) - r0) / (h * normal[i])).T
    jac[:, :, 2] = ((roller.residuals(normal, moved, pick) - r0) / step).T
    return jac


def newton_polish(
    roller: Roller, w: np.ndarray, normal: np.ndarray, bounds: Bounds, enough: float = 0.0, steps: int = 14
) -> Solution:
    """Refine all three unknowns by Newton's method with Broyden's updates and the fine law.

    Parameters
    ----------
    roller : Roller
        The m rollers.
    w, normal : numpy.ndarray, shape (m,) and (2, m)
        Slip and normal forces [N] at the start.
    bounds : Bounds
        Limits of w.
    enough : float
        Residual at which the iteration of a roller ends; with 0 only rounding or the noise of the law ends it.
    steps : int
        Largest number of steps.

    Returns
    -------
    Solution
        State of each roller with the smallest residual.
    """
    m = w.size
    best = Solution(np.full(m, np.inf), w.copy(), normal.copy(), np.full((3, 2, m), np.nan))
    active = np.arange(m)
    jac = np.empty((m, 3, 3))
    step_old, r_old = np.zeros((m, 3)), np.zeros((m, 3))
    scale = np.stack([roller.load, roller.load, roller.torque_scale], axis=1)
    for k in range(steps):
        n_a, w_a = normal[:, active], w[active]
        f = roller.contact(roller.shift(w_a, active), n_a, True, active)
        r = roller.residuals(n_a, f, active).T
        size = np.max(np.abs(r) / scale[active], axis=1)
        better = size < best.residual[active]
        best.put(active[better], Solution(size, w_a, n_a, f).take(better))
        leading = best.residual[active]
        stalled = (size > 0.3 * leading) & ~better if k > 8 else np.zeros(active.size, bool)
        worth = (size > max(1e-15, enough)) & np.isfinite(size)
        go = worth & ~stalled & ~((leading < roller.goal) & ~better)
        active, r = active[go], r[go]
        if active.size == 0:
            break
        if k in (0, 6):
            jac[active] = _jacobian(roller, w[active], normal[:, active], active)
        else:
            jac[active] += _broyden(jac[active], step_old[active], r - r_old[active])
        step, sound = _damped(_solve3(jac[active], -r), normal[:, active], w[active], bounds.take(active))
        step_old[active], r_old[active] = step, r
        normal[:, active] += step[:, :2].T
        w[active] += step[:, 2]
        active = active[sound]
        if active.size == 0:
            break
    return best


def _broyden(jac: np.ndarray, step: np.ndarray, change: np.ndarray) -> np.ndarray:
    """Return Broyden's update (m, 3, 3) after a step (m, 3) that changed the residuals by `change` (m, 3).

    Broyden's update needs a nonzero step. After a zero step it is NaN, and the roller is reported as singular.
    """
    miss = change - np.einsum("mij,mj->mi", jac, step)
    with np.errstate(divide="ignore", invalid="ignore"):
        return miss[:, :, None] * step[:, None, :] / np.sum(step * step, axis=1)[:, None, None]


def _damped(step: np.ndarray, normal: np.ndarray, w: np.ndarray, bounds: Bounds) -> tuple[np.ndarray, np.ndarray]:
    """Shorten steps (m, 3) so that normal forces stay positive and w within its bounds; mark finite steps (m,).

    Steps of singular systems become zero.
    """
    room = 0.9 * normal.T
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        damp = np.min(np.where(step[:, :2] < 0, room / -step[:, :2], np.inf), axis=1)
        gap = np.where(step[:, 2] > 0, bounds.high - w, w - bounds.low)
        damp = np.minimum(np.minimum(damp, 0.9 * gap / np.abs(step[:, 2])), 1.0)
    sound = np.all(np.isfinite(step), axis=1) & np.isfinite(damp)
    return np.where(sound[:, None], step * damp[:, None], 0.0), sound


@compiled
def _solve3(a, b):
    """Solve m systems of three equations by Cramer's rule on scaled rows and columns; singular systems give NaN."""
    x, s, c = np.empty_like(b), np.empty((3, 3)), np.empty(3)
    for m in range(len(b)):
        for i in range(3):
            largest = max(abs(a[m, i, 0]), abs(a[m, i, 1]), abs(a[m, i, 2]))
            assign(s[i], a[m, i] / largest)
            c[i] = b[m, i] / largest
        column = [max(abs(s[0, j]), abs(s[1, j]), abs(s[2, j])) for j in range(3)]
        determinant = np.nan
        for j in range(3):
            for i in range(3):
                s[i, j] /= column[j]
        for j in range(3):
            u, v = s[:, (j + 1) % 3], s[:, (j + 2) % 3]
            k0, k1, k2 = u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]
            if j == 0:
                determinant = s[0, 0] * k0 + s[1, 0] * k1 + s[2, 0] * k2
            x[m, j] = (k0 * c[0] + k2 * c[2] + k1 * c[1]) / determinant / column[j]
            if not math.isfinite(x[m, j]):
                x[m, j] = np.nan
    return x


def digits_of_forces(roller: Roller, solution: Solution) -> np.ndarray:
    """Return the uncertainty of the transmitted force over the largest friction force, (m,).

    It is computed for rollers smaller than `SMALL` of their patch and is 0 for the others. On such small rollers the
    drilling torque exceeds the torque of the force a thousandfold and more, so that a small imbalance of the torque
    does not bound the error of the force. The error is dF_A/dtorque times the imbalance or its rounding error; the
    derivative is taken over two steps of the slip, a short one and the shortest one.
    """
    w, normal, f = solution.w, solution.normal, solution.forces
    size = np.hypot(roller.shape.lateral, roller.shape.rolling) * np.cbrt(np.max(normal, axis=0))
    small = np.flatnonzero((roller.radius < SMALL * size) & np.isfinite(solution.residual))
    unsure = np.zeros(w.size)
    if small.size == 0:
        return unsure
    force, torque = f[1].sum(axis=0)[small], roller.torque(f)[small]
    inward = np.where(w[small] > 0, -1.0, 1.0)
    moved = [
        roller.contact(roller.shift(w[small] + inward * step, small), normal[:, small], True, small)
        for step in (roller.step * (1 - np.abs(w[small])), EPS)
    ]
    given = roller.friction[small] * normal[:, small].sum(axis=0)
    noise = 4.0 * EPS * roller.torque_scale[small]
    share = np.zeros(small.size)
    for g in moved:  # changes within rounding do not count
        change = np.maximum(np.abs(g[1].sum(axis=0) - force) - 16.0 * EPS * given, 0.0)
        share = np.fmax(share, change / np.maximum(np.abs(roller.torque(g, small) - torque), noise))
    unsure[small] = share * np.maximum(np.abs(torque), noise) / given
    return unsure
