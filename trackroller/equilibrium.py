"""Equilibrium of the roller: normal forces and rolling radius shift, for any contact model.

Unknowns F_N1, F_N2 and r_Delta0; equations (7), (9) and the balance of the drive torque, (10) and (31):
-(M_R1 - M_R2) sin(alpha) - (F_A1 + F_A2) r_A = F_Motor r_A. The slip enters through w in (-1, 1),
r_Delta0 = c w / sqrt(1 - w^2), in which the torque is nearly linear. A bracketing pass with a coarse contact
law finds the root, Newton's method on all three equations polishes it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from trackroller.contact.common import Ellipse, Resultants, Slip
from trackroller.contact.hertz import HertzShape
from trackroller.contact.sliding import tractions_full_slip
from trackroller.equilibrium_falling import first_balance

ROLLING, FULL_SLIP, LIFT_OFF, FAILED = range(4)
LAST_SLIP = 1.0 - 2.0**-53  # largest |w|; beyond, the friction is that of complete slip to the last digit
TOLERANCE = 0.01  # aimed at, over the residual that counts as converged

# ellipse, slip, friction, rows -> resultants; `fine` chooses the discretisation
ContactLaw = Callable[[Ellipse, Slip, np.ndarray, np.ndarray, bool], Resultants]


@dataclass(frozen=True)
class Loads:
    """Loads and kinematics of n rollers; N, mm, rad; all arrays of shape (n,)."""

    radial_force: np.ndarray
    axial_force: np.ndarray
    motor_force: np.ndarray
    friction: np.ndarray
    contact_angle: np.ndarray
    guide_profile_radius: np.ndarray
    rolling_radius: np.ndarray
    shape: HertzShape
    difference_step: float = 1e-5  # for derivatives of the contact law; above the noise of iterative laws
    converged: float = 1e-10  # largest relative residual of a solution
    falling: bool = False  # friction depends on the slip speed
    at_high_speed: float = 1.0  # friction in complete slip over the coefficient `friction`


@dataclass(frozen=True)
class Equilibrium:
    """Solution for n rollers: `regime` (n,), shift (n,) [mm], normal_force (n, 2) [N] and the resultants.

    `forces` has the fields of `Resultants`, each of shape (n, 2). `residual` is the largest relative
    imbalance: forces over the applied loads, torque over what friction and motor can give. Undefined is NaN.
    """

    regime: np.ndarray
    converged: np.ndarray
    residual: np.ndarray
    shift: np.ndarray
    normal_force: np.ndarray
    forces: Resultants


class _Roller:
    """The equations of a set of rollers; holds nothing but arrays, so that rows can be taken."""

    def __init__(self, loads: Loads, law: ContactLaw, rows: np.ndarray) -> None:
        self.rows, self.law, self.step = rows, law, loads.difference_step
        self.goal = TOLERANCE * loads.converged
        for name in ("radial_force", "axial_force", "motor_force", "friction", "guide_profile_radius"):
            setattr(self, name, getattr(loads, name)[rows])
        self.radius = loads.rolling_radius[rows]
        self.sin, self.cos = np.sin(loads.contact_angle[rows]), np.cos(loads.contact_angle[rows])
        s = loads.shape
        self.shape = HertzShape(s.lateral[rows], s.rolling[rows], s.pressure[rows])
        self.load = np.abs(self.radial_force) + np.abs(self.axial_force)
        self.largest = self.load * np.maximum(1e3, 10.0 / np.minimum(self.sin, self.cos))
        # how far the slip varies over the patch, by the spin and by the curved guide, which ends at its equator;
        # the drilling friction of a patch above the roller's size decays slowly
        root, flat = np.cbrt(self.load * np.maximum(1.0, 0.5 / self.cos)), self.guide_profile_radius * self.cos
        bend = np.minimum((s.lateral[rows] * root * self.cos) ** 2 / flat, flat)
        varies = 0.5 * (self.sin * np.hypot(s.lateral[rows], s.rolling[rows]) * root + bend)
        self.slip_scale = varies * (1.0 + varies / self.radius)
        # the torque is measured against what friction can give, so that little friction does not hide its imbalance
        pressing = np.abs(self.radial_force) / self.cos + np.abs(self.axial_force)
        self.torque_scale = self.friction * pressing * (1.0 + varies / self.radius) + np.abs(self.motor_force)

    radial_force: np.ndarray
    axial_force: np.ndarray
    motor_force: np.ndarray
    friction: np.ndarray
    guide_profile_radius: np.ndarray

    def contact(self, shift: np.ndarray, normal: np.ndarray, fine: bool, pick=slice(None)) -> np.ndarray:
        """F_T, F_A, M_R of both contacts, shape (3, 2, m), at shift (m,) and normal forces (2, m)."""
        m = shift.size
        two = lambda v: np.concatenate([v[pick], v[pick]])  # noqa: E731
        shape = HertzShape(two(self.shape.lateral), two(self.shape.rolling), two(self.shape.pressure))
        sine = np.concatenate([self.sin[pick], -self.sin[pick]])
        slip = Slip(sine, two(self.cos), two(self.guide_profile_radius), two(self.radius), np.tile(shift, 2))
        ellipse = shape.at(normal.reshape(-1))
        r = self.law(ellipse, slip, two(self.friction), np.tile(self.rows[pick], 2), fine)
        return np.stack([r.lateral_force, r.driving_force, r.spin_moment]).reshape(3, 2, m)

    def normal_forces(self, ratio: np.ndarray, pick=slice(None)) -> np.ndarray:
        """F_N (2, m) from eqs (7), (9) when F_T,i = ratio_i F_N,i; ratio (2, m)."""
        s, c = self.sin[pick], self.cos[pick]
        a11, a12 = s + c * ratio[0], -s + c * ratio[1]
        a21, a22 = c - s * ratio[0], c + s * ratio[1]
        b1, b2 = -self.axial_force[pick], -self.radial_force[pick]
        with np.errstate(divide="ignore", invalid="ignore"):
            det = a11 * a22 - a12 * a21
            return np.stack([(b1 * a22 - a12 * b2) / det, (a11 * b2 - a21 * b1) / det])

    def torque(self, f: np.ndarray, pick=slice(None)) -> np.ndarray:
        """Drive-torque balance over r_A [N], shape (m,); > 0 when the friction drives more than asked."""
        drilling = (f[2, 0] - f[2, 1]) * self.sin[pick] / self.radius[pick]
        return drilling + f[1, 0] + f[1, 1] + self.motor_force[pick]

    def wedged(self, normal: np.ndarray, f: np.ndarray) -> np.ndarray:
        """Do more axial force and more lateral difference of the normal forces go together? Shape (m,).

        The determinant of eqs (7), (9) vanishes nowhere on the branch of solutions that grows out of the frictionless
        wedge; beyond self-locking, mu f = tan(alpha), stands another one on which the lateral load rests on the wrong
        contact. Without axial load both are the same.
        """
        one, two = f[0] / normal
        double = 2.0 * self.sin * self.cos
        det = double * (1.0 + one * two) + (one - two) * (self.cos - self.sin) * (self.cos + self.sin)
        return (det > 0) | (self.axial_force == 0)

    def residuals(self, normal: np.ndarray, f: np.ndarray, pick=slice(None)) -> np.ndarray:
        """The three balances [N], shape (3, m)."""
        s, c = self.sin[pick], self.cos[pick]
        lateral = c * (f[0, 0] + f[0, 1]) + s * (normal[0] - normal[1]) + self.axial_force[pick]
        radial = s * (f[0, 1] - f[0, 0]) + c * (normal[0] + normal[1]) + self.radial_force[pick]
        return np.stack([lateral, radial, self.torque(f, pick)])

    def shift(self, w: np.ndarray, pick=slice(None)) -> np.ndarray:
        with np.errstate(divide="ignore"):
            return self.slip_scale[pick] * w / np.sqrt((1 - w) * (1 + w))

    def w_of(self, shift: np.ndarray) -> np.ndarray:
        return np.clip(shift / np.hypot(self.slip_scale, shift), -LAST_SLIP, LAST_SLIP)

    def floored(self, normal: np.ndarray, pick=slice(None)) -> np.ndarray:
        """Normal forces kept positive, for a contact about to lift still needs an ellipse, and finite."""
        load = self.load[pick]
        return np.clip(np.where(np.isnan(normal), load, normal), 1e-9 * load, self.largest[pick])


def _bracketed(roller: _Roller, w_low, w_high, fine: bool, sweeps: int, tolerance: float):
    """Root of the torque balance in w by the Illinois rule, the normal forces following along.

    The torque falls with w. Returns w (m,) and normal forces (2, m).
    """
    m = roller.rows.size
    normal = roller.floored(roller.normal_forces(np.zeros((2, m))))
    t_low, t_high = np.full(m, np.nan), np.full(m, np.nan)
    w, side = np.clip(np.zeros(m), w_low, w_high), np.zeros(m)
    active = np.arange(m)
    for _ in range(sweeps):
        # the normal forces follow the slip; twice when the answer counts
        for _ in range(3 if fine else 1):
            f = roller.contact(roller.shift(w[active], active), normal[:, active], fine, active)
            normal[:, active] = roller.floored(roller.normal_forces(f[0] / normal[:, active], active), active)
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
        active = active[(moved > tolerance) & (hi - lo > tolerance)]
        if active.size == 0:
            break
    return w, normal


def _jacobian(roller: _Roller, w, normal, pick) -> np.ndarray:
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


def _newton(roller: _Roller, w, normal, w_low, w_high, steps: int = 14):
    """Newton-Broyden polish of all three unknowns with the fine law; returns residual (m,) with w, normal, forces."""
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
        go = (size > 1e-15) & np.isfinite(size) & ~stalled & ~((best[active] < roller.goal) & ~better)
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
        cross = np.stack([np.cross(a[:, :, 1], a[:, :, 2]), np.cross(a[:, :, 2], a[:, :, 0]),
                          np.cross(a[:, :, 0], a[:, :, 1])], axis=1)  # fmt: skip
        x = np.einsum("mij,mj->mi", cross, b) / np.sum(a[:, :, 0] * cross[:, 0], axis=1)[:, None] / columns
    return np.where(np.isfinite(x), x, np.nan)


def solve_equilibrium(loads: Loads, law: ContactLaw) -> Equilibrium:
    """Normal forces, slip and friction resultants of n rollers.

    Parameters
    ----------
    loads : applied loads, friction and geometry, arrays of shape (n,)
    law : contact model; with `fine=False` it may be cheap and rough

    Regimes: `FULL_SLIP` where even complete slip in the rolling direction (r_Delta0 = -r_A driving: the roller
    spins without travel; r_Delta0 -> inf braking: it is locked) cannot balance the motor force; `LIFT_OFF` where
    a normal force would be <= 0. ASSUME: without friction the slip is that of the limit mu -> 0 if F_Motor = 0,
    and every motor force means full slip.
    """
    # friction whose forces would run out of the range of numbers is none
    loads = replace(loads, friction=np.where(loads.friction < 1e-100, 0.0, loads.friction))
    n = loads.radial_force.size
    regime = np.full(n, FAILED, dtype=np.int8)
    residual, shift = np.full(n, np.nan), np.full(n, np.nan)
    normal, forces = np.full((2, n), np.nan), np.full((3, 2, n), np.nan)
    everything = np.arange(n)
    if n == 0:
        return Equilibrium(regime, regime == 1, residual, shift, normal.T, Resultants(*forces.transpose(0, 2, 1)))
    everything = everything[np.isfinite(loads.shape.lateral)]
    limit = np.abs(loads.motor_force) > 0
    slides = everything[(loads.friction[everything] == 0) & limit[everything]]
    rolls = np.setdiff1d(everything, slides)
    if rolls.size:
        beyond = _solve_rolling(loads, law, rolls, regime, residual, shift, normal, forces)
        slides = np.concatenate([slides, beyond])
    if slides.size:
        _solve_full_slip(loads, law, slides, regime, residual, shift, normal, forces)
    lifted = (regime == LIFT_OFF) | (regime == FAILED)
    shift[lifted] = np.nan
    residual[regime == LIFT_OFF] = np.nan
    normal[:, lifted], forces[:, :, lifted] = np.nan, np.nan
    converged = np.where(regime == LIFT_OFF, True, residual <= loads.converged)
    return Equilibrium(regime, converged, residual, shift, normal.T, Resultants(*forces.transpose(0, 2, 1)))


def _solve_rolling(loads, law, rows, regime, residual, shift, normal, forces) -> np.ndarray:
    """Fills the rolling rows; returns those whose torque cannot be transmitted."""
    friction = np.where(loads.friction[rows] > 0, loads.friction[rows], 1e-12)
    full = np.ones_like(loads.friction)
    full[rows] = friction
    rolled = replace(loads, friction=full)
    roller = _Roller(rolled, law, rows)
    w_low, w_high = roller.w_of(-roller.radius), np.full(rows.size, LAST_SLIP)
    # locked, the friction along the track is complete and there is no other, as in full slip
    complete = friction * np.sum(roller.normal_forces(np.zeros((2, rows.size))), axis=0)
    beyond = roller.motor_force > complete
    drives = np.flatnonzero(roller.motor_force < 0)
    spins = _Roller(rolled, law, rows[drives])
    if loads.falling:
        w_low, w_high, beyond = first_balance(roller, w_low, w_high)
    else:
        torque = spins.torque(_forces_at(spins, w_low[drives]))
        # a law without an answer for this patch leaves what friction can give at most
        beyond[drives] = np.where(np.isnan(torque), -spins.motor_force > complete[drives], torque < 0)
    go = np.flatnonzero(~beyond)
    if go.size == 0:
        return rows
    roller = _Roller(rolled, law, rows[go])
    low, high = w_low[go], w_high[go]
    w, n = _bracketed(roller, low.copy(), high.copy(), fine=False, sweeps=25, tolerance=1e-3)
    best, w, n, f = _newton(roller, w, n, low, high)
    bad = np.flatnonzero(~(best <= loads.converged))
    if bad.size:  # slow and sure
        again = _Roller(rolled, law, rows[go][bad])
        w2, n2 = _bracketed(again, low[bad].copy(), high[bad].copy(), fine=True, sweeps=80, tolerance=1e-15)
        b2, w2, n2, f2 = _newton(again, w2, n2, low[bad], high[bad])
        best[bad], w[bad], n[:, bad], f[:, :, bad] = b2, w2, n2, f2
    lift = np.any(n <= 1e-8 * roller.load, axis=0)
    bad = np.flatnonzero(~((best <= loads.converged) & roller.wedged(n, f)) & ~lift)
    if bad.size:
        b3, w3, n3, f3, lift[bad] = _follow_friction(rolled, law, rows[go][bad], low[bad], high[bad])
        best[bad], w[bad], n[:, bad], f[:, :, bad] = b3, w3, n3, f3
    # without a solution, what holds without friction decides
    lift |= ~(best <= 1e-6) & np.any(roller.normal_forces(np.zeros((2, go.size))) <= 0, axis=0)
    k = rows[go]
    regime[k] = np.where(lift, LIFT_OFF, np.where(best <= 1e-6, ROLLING, FAILED))
    residual[k], shift[k], normal[:, k] = best, roller.shift(w), n
    forces[:, :, k] = np.where(loads.friction[k] > 0, f, 0.0)
    return rows[beyond]


def _follow_friction(loads, law, rows, low, high):
    """Solutions followed from little friction to the given; a contact that lifts off on the way stays off.

    Near self-locking, mu f = tan(alpha), the equations have several solutions or none; the one that grows out of the
    frictionless wedge is the one that loading reaches. Returns what `_newton` does, and the rows that lift off.
    """
    m = rows.size
    lifted, w = np.zeros(m, bool), np.zeros(m)
    normal = np.full((2, m), np.nan)
    best, f = np.full(m, np.inf), np.full((3, 2, m), np.nan)
    lost, found, grip = np.zeros(m, bool), np.zeros(m, bool), np.zeros(m)
    scale = np.ones_like(loads.friction)
    tangent = np.tan(loads.contact_angle[rows])
    start = np.clip(0.2 * tangent / loads.friction[rows], 1e-8, 0.05)  # well before the wedge may lock
    for k in range(21):
        scale[rows] = np.maximum(start ** (1 - k / 20), k / 20)
        eased = replace(loads, friction=loads.friction * scale, motor_force=loads.motor_force * scale)
        roller = _Roller(eased, law, rows)
        if k == 0:
            w, normal = _bracketed(roller, low.copy(), high.copy(), fine=True, sweeps=60, tolerance=1e-12)
        best, w_new, n_new, f = _newton(roller, w.copy(), normal.copy(), low, high)
        fine = best <= 1e-8
        lost, found = lost | ~fine, found | np.isfinite(best)
        shrunk = np.any(normal < 0.15 * roller.load, axis=0)
        lifted |= np.where(fine, np.any(n_new < 1e-7 * roller.load, axis=0), shrunk)
        w, normal = np.where(fine, w_new, w), np.where(fine, n_new, normal)
        with np.errstate(invalid="ignore"):
            grip = np.where(fine, np.max(np.abs(f[0] / n_new), axis=0) / tangent, grip)
    best = np.where(lost, np.inf, best)
    # a branch that ends where friction nearly carries the lateral load has shed a contact
    light = np.any(normal < 0.2 * roller.load, axis=0)
    lifted |= np.where(lost, ((grip > 0.5) | light) & (loads.axial_force[rows] != 0), ~roller.wedged(normal, f))
    return best, w, normal, f, lifted & found  # a law that has no answer at all tells nothing


def _forces_at(roller: _Roller, w) -> np.ndarray:
    """Contact forces (3, 2, m) at a given slip, the normal forces having followed."""
    normal = roller.floored(roller.normal_forces(np.zeros((2, w.size))))
    for _ in range(3):
        f = roller.contact(roller.shift(w), normal, True)
        normal = roller.floored(roller.normal_forces(f[0] / normal))
    return roller.contact(roller.shift(w), normal, True)


def _solve_full_slip(loads, law, rows, regime, residual, shift, normal, forces) -> None:
    # ASSUME: in complete slip the speed is beyond what the friction law tells of
    loads = replace(loads, friction=loads.friction * loads.at_high_speed)
    roller = _Roller(loads, law, rows)
    n = roller.normal_forces(np.zeros((2, rows.size)))
    lift = np.any(n <= 0, axis=0)
    regime[rows] = np.where(lift, LIFT_OFF, FULL_SLIP)
    direction = -np.sign(loads.motor_force[rows])
    for i in (0, 1):
        s = roller.shape.at(np.maximum(n[i], 0.0))
        r = tractions_full_slip(s, roller.friction, direction)
        forces[:, i, rows] = np.stack([r.lateral_force, r.driving_force, r.spin_moment])
    normal[:, rows] = n
    residual[rows] = np.max(np.abs(roller.residuals(n, forces[:, :, rows])[:2]), axis=0) / roller.load
    shift[rows] = np.nan
