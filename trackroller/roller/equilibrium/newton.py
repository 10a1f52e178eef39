"""Roots of the balances of a roller: bracketing in the slip with a coarse contact law, then Newton on all unknowns."""

from __future__ import annotations

import numpy as np

from trackroller.roller.equilibrium.roller import Roller

SMALL = 0.01  # rolling radius over patch
EPS = 2.0**-53
# Models that iterate are not asked again for what lies below this share of what they reach. Those in closed form cost
# little, and rollers at the ends of the parameters need their last digits.
SETTLED, CLOSED = 0.1, 1e-11


def bracketed(roller: Roller, w_low, w_high, fine: bool, sweeps: int, tolerance: float):
    """Root of the torque balance in w by the Illinois rule, the normal forces following along.

    The torque falls with w. Returns w (m,) and normal forces (2, m).
    """
    m = roller.rows.size
    normal = roller.floored(roller.normal_forces(np.zeros((2, m))))
    t_low, t_high = np.full(m, np.nan), np.full(m, np.nan)
    w, side = np.clip(np.zeros(m), w_low, w_high), np.zeros(m)
    active = np.arange(m)
    for _ in range(sweeps):
        f = _following(roller, w, normal, fine, active)
        t = roller.torque(f, active)
        up = t > 0
        w_low[active] = np.where(up, w[active], w_low[active])
        w_high[active] = np.where(up, w_high[active], w[active])
        same = np.where(up, 1.0, -1.0) == side[active]
        t_high[active] = np.where(up, np.where(same, t_high[active] / 2, t_high[active]), t)
        t_low[active] = np.where(up, t, np.where(same, t_low[active] / 2, t_low[active]))
        side[active] = np.where(up, 1.0, -1.0)
        lo, hi, tl, th = w_low[active], w_high[active], t_low[active], t_high[active]
        with np.errstate(divide="ignore", invalid="ignore"):
            new = (lo * th - hi * tl) / (th - tl)
        new = np.where(np.isfinite(new) & (new > lo) & (new < hi), new, (lo + hi) / 2)
        moved = np.abs(new - w[active])
        w[active] = new
        # where the balance holds, what is left is for Newton's method
        unmet = np.abs(t) > (settled(roller) if fine else 0.0) * roller.torque_scale[active]
        active = active[(moved > tolerance) & (hi - lo > tolerance) & unmet]
        if active.size == 0:
            break
    return w, normal


def settled(roller: Roller) -> float:
    """Relative change of forces that is not followed further."""
    return SETTLED * roller.goal if roller.goal > CLOSED else 0.0


def _following(roller: Roller, w, normal, fine: bool, rows: np.ndarray) -> np.ndarray:
    """Contact forces (3, 2, m) of `rows` at the slip w, to which their normal forces follow, thrice if `fine`."""
    f = np.empty((3, 2, rows.size))
    go = np.arange(rows.size)
    for _ in range(3 if fine else 1):
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
    """Derivatives of the balances with respect to (F_N1, F_N2, w), shape (m, 3, 3), coarse law, differences."""
    h = roller.step
    shift = roller.shift(w, pick)
    base = roller.contact(shift, normal, False, pick)
    grown = roller.contact(shift, normal * (1 + h), False, pick)
    room = 1 - np.abs(w)
    step = h * room * np.where(w > 0, -1.0, 1.0)
    moved = roller.contact(roller.shift(w + step, pick), normal, False, pick)
    r0 = roller.residuals(normal, base, pick)
    jac = np.empty((w.size, 3, 3))
    for i in (0, 1):
        f, n = base.copy(), normal.copy()
        f[:, i], n[i] = grown[:, i], normal[i] * (1 + h)
        jac[:, :, i] = ((roller.residuals(n, f, pick) - r0) / (h * normal[i])).T
    jac[:, :, 2] = ((roller.residuals(normal, moved, pick) - r0) / step).T
    return jac


def newton_polish(roller: Roller, w, normal, w_low, w_high, enough: float = 0.0, steps: int = 14):
    """Newton-Broyden polish of all three unknowns with the fine law; returns residual (m,) with w, normal, forces.

    It ends at a residual of `enough`; without, where rounding and the noise of the law end it.
    """
    m = w.size
    best = np.full(m, np.inf)
    w_best, n_best, f_best = w.copy(), normal.copy(), np.full((3, 2, m), np.nan)
    active = np.arange(m)
    jac = np.empty((m, 3, 3))
    step_old, r_old = np.zeros((m, 3)), np.zeros((m, 3))
    scale = np.stack([roller.load, roller.load, roller.torque_scale], axis=1)
    for k in range(steps):
        n_a, w_a = normal[:, active], w[active]
        f = roller.contact(roller.shift(w_a, active), n_a, True, active)
        r = roller.residuals(n_a, f, active).T
        size = np.max(np.abs(r) / scale[active], axis=1)
        better = size < best[active]
        hit = active[better]
        best[hit], w_best[hit] = size[better], w_a[better]
        n_best[:, hit], f_best[:, :, hit] = n_a[:, better], f[:, :, better]
        stalled = (size > 0.3 * best[active]) & ~better if k > 8 else np.zeros(active.size, bool)
        worth = (size > max(1e-15, enough)) & np.isfinite(size)
        go = worth & ~stalled & ~((best[active] < roller.goal) & ~better)
        active, r = active[go], r[go]
        if active.size == 0:
            break
        if k in (0, 6):
            jac[active] = _jacobian(roller, w[active], normal[:, active], active)
        else:  # Broyden's update: the old step made this residual
            s = step_old[active]
            y = r - r_old[active]
            miss = y - np.einsum("mij,mj->mi", jac[active], s)
            with np.errstate(divide="ignore", invalid="ignore"):  # no step, no news: the row ends as singular
                jac[active] += miss[:, :, None] * s[:, None, :] / np.sum(s * s, axis=1)[:, None, None]
        step = _solve3(jac[active], -r)
        room = np.stack([0.9 * normal[0, active], 0.9 * normal[1, active]], axis=1)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            damp = np.min(np.where(step[:, :2] < 0, room / -step[:, :2], np.inf), axis=1)
            gap = np.where(step[:, 2] > 0, w_high[active] - w[active], w[active] - w_low[active])
            damp = np.minimum(np.minimum(damp, 0.9 * gap / np.abs(step[:, 2])), 1.0)
        sound = np.all(np.isfinite(step), axis=1) & np.isfinite(damp)  # a singular system ends the row
        step = np.where(sound[:, None], step * damp[:, None], 0.0)
        step_old[active], r_old[active] = step, r
        normal[:, active] += step[:, :2].T
        w[active] += step[:, 2]
        active = active[sound]
        if active.size == 0:
            break
    return best, w_best, n_best, f_best


def _solve3(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Batch of 3x3 systems by Cramer's rule on scaled rows and columns; a singular one gives NaN, no exception."""
    with np.errstate(all="ignore"):
        a, b = a / (rows := np.max(np.abs(a), axis=2))[:, :, None], b / rows
        columns = np.max(np.abs(a), axis=1)
        a = a / columns[:, None, :]
        cross = np.stack(
            [np.cross(a[:, :, 1], a[:, :, 2]), np.cross(a[:, :, 2], a[:, :, 0]), np.cross(a[:, :, 0], a[:, :, 1])],
            axis=1,
        )
        x = np.einsum("mij,mj->mi", cross, b) / np.sum(a[:, :, 0] * cross[:, 0], axis=1)[:, None] / columns
    return np.where(np.isfinite(x), x, np.nan)


def digits_of_forces(roller: Roller, w, normal, f, residual) -> np.ndarray:
    """Uncertainty of the transmitted force over what friction can give, of rollers small against their patches; (m,).

    There the drilling torque outweighs the force a thousandfold and more, and a small imbalance of the torque no
    longer tells that the force is known: it moves it by dF_A/dtorque, taken over a short and the shortest step of the
    slip, times the imbalance or its rounding. 0 for rollers larger than `SMALL` of their patch.
    """
    size = np.hypot(roller.shape.lateral, roller.shape.rolling) * np.cbrt(np.max(normal, axis=0))
    small = np.flatnonzero((roller.radius < SMALL * size) & np.isfinite(residual))
    unsure = np.zeros(w.size)
    if small.size == 0:
        return unsure
    taken, turned = f[1].sum(axis=0)[small], roller.torque(f)[small]
    inward = np.where(w[small] > 0, -1.0, 1.0)
    moved = [
        roller.contact(roller.shift(w[small] + inward * step, small), normal[:, small], True, small)
        for step in (roller.step * (1 - np.abs(w[small])), EPS)
    ]
    given = roller.friction[small] * normal[:, small].sum(axis=0)
    noise = 4.0 * EPS * roller.torque_scale[small]
    share = np.zeros(small.size)
    for g in moved:  # what changes by rounding alone tells nothing
        change = np.maximum(np.abs(g[1].sum(axis=0) - taken) - 16.0 * EPS * given, 0.0)
        share = np.fmax(share, change / np.maximum(np.abs(roller.torque(g, small) - turned), noise))
    unsure[small] = share * np.maximum(np.abs(turned), noise) / given
    return unsure
