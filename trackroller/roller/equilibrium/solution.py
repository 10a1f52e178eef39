"""Equilibrium of the roller: normal forces and rolling radius shift, for any contact model.

Unknowns F_N1, F_N2 and r_Delta0; equations (7), (9) and the balance of the drive torque, (10) and (31):
-(M_R1 - M_R2) sin(alpha) - (F_A1 + F_A2) r_A = F_Motor r_A. The slip enters through w in (-1, 1),
r_Delta0 = c w / sqrt(1 - w^2), in which the torque is nearly linear. A bracketing pass with a coarse contact
law finds the root, Newton's method on all three equations polishes it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from trackroller.contact.common import Resultants
from trackroller.contact.sliding import tractions_full_slip
from trackroller.roller.equilibrium.branch import follow_friction, self_locking
from trackroller.roller.equilibrium.falling import balance_again, first_balance
from trackroller.roller.equilibrium.newton import bracketed, digits_of_forces, newton_polish, settled
from trackroller.roller.equilibrium.roller import LAST_SLIP, ContactLaw, Loads, Roller

__all__ = ["FAILED", "FULL_SLIP", "LIFT_OFF", "ROLLING", "ContactLaw", "Equilibrium", "Loads", "solve_equilibrium"]
ROLLING, FULL_SLIP, LIFT_OFF, FAILED = range(4)
# largest residual of what is called a solution; where friction falls steeply a patch has many states of stick and slip,
# its forces jump between them, and the balance may lie within such a jump
SOLVED, SOLVED_FALLING = 1e-6, 1e-2


@dataclass(frozen=True)
class Equilibrium:
    """Solution for n rollers: `regime` (n,), shift (n,) [mm], normal_force (n, 2) [N] and the resultants.

    `forces` has the fields of `Resultants`, each of shape (n, 2). `residual` is the largest relative
    imbalance: forces over the applied loads, torque over what friction and motor can give; for rollers small against
    their patches no less than the uncertainty of the transmitted force over what friction can give. `jamming` marks
    rollers whose friction alone carries the lateral load; a lifted one, if it did so without axial force. Undefined
    is NaN.
    """

    regime: np.ndarray
    converged: np.ndarray
    residual: np.ndarray
    jamming: np.ndarray
    shift: np.ndarray
    normal_force: np.ndarray
    forces: Resultants


def solve_equilibrium(loads: Loads, law: ContactLaw) -> Equilibrium:
    """Normal forces, slip and friction resultants of n rollers.

    Parameters
    ----------
    loads : applied loads, friction and geometry, arrays of shape (n,)
    law : contact model; with `fine=False` it may be cheap and rough

    Regimes: `FULL_SLIP` where even complete slip in the rolling direction (r_Delta0 = -r_A driving: the roller
    spins without travel; r_Delta0 -> inf braking: it is locked) cannot balance the motor force; `LIFT_OFF` where
    a contact would carry no more than 1e-8 of |F_rad| + |F_ax|, or pull. ASSUME: without friction the slip is that
    of the limit mu -> 0 if F_Motor = 0, and every motor force means full slip.
    """
    # friction whose forces would run out of the range of numbers is none
    loads = replace(loads, friction=np.where(loads.friction < 1e-100, 0.0, loads.friction))
    n = loads.radial_force.size
    regime = np.full(n, FAILED, dtype=np.int8)
    residual, shift, jamming = np.full(n, np.nan), np.full(n, np.nan), np.zeros(n, bool)
    normal, forces = np.full((2, n), np.nan), np.full((3, 2, n), np.nan)
    everything = np.arange(n)
    if n == 0:
        return Equilibrium(regime, jamming, residual, jamming, shift, normal.T, Resultants(*forces.transpose(0, 2, 1)))
    everything = everything[np.isfinite(loads.shape.lateral)]
    limit = np.abs(loads.motor_force) > 0
    slides = everything[(loads.friction[everything] == 0) & limit[everything]]
    rolls = np.setdiff1d(everything, slides)
    if rolls.size:
        beyond = _solve_rolling(loads, law, rolls, regime, residual, jamming, shift, normal, forces)
        slides = np.concatenate([slides, beyond])
    if slides.size:
        _solve_full_slip(loads, law, slides, regime, residual, shift, normal, forces)
    lifted = (regime == LIFT_OFF) | (regime == FAILED)
    shift[lifted] = np.nan
    residual[regime == LIFT_OFF] = np.nan
    normal[:, lifted], forces[:, :, lifted] = np.nan, np.nan
    converged = np.where(regime == LIFT_OFF, True, residual <= loads.converged)
    return Equilibrium(regime, converged, residual, jamming, shift, normal.T, Resultants(*forces.transpose(0, 2, 1)))


@dataclass
class _Found:
    """What is known of m rolling candidates: residual (m,), slip w (m,), normal (2, m) and contact forces (3, 2, m)."""

    best: np.ndarray
    w: np.ndarray
    normal: np.ndarray
    forces: np.ndarray

    def put(self, rows, found) -> None:
        self.best[rows], self.w[rows], self.normal[:, rows], self.forces[:, :, rows] = found

    def put_better(self, rows, found, converged: float) -> None:
        """Keeps what has the smaller residual; among solutions the later one."""
        best = self.best[rows]
        take = ~((found[0] > best) & (found[0] > converged))
        self.put(rows[take], [v[..., take] for v in found])


def _solve_rolling(loads, law, rows, regime, residual, jamming, shift, normal, forces) -> np.ndarray:
    """Fills the rolling rows; returns those whose torque cannot be transmitted."""
    friction = np.where(loads.friction[rows] > 0, loads.friction[rows], 1e-12)
    full = np.ones_like(loads.friction)
    full[rows] = friction
    rolled = replace(loads, friction=full)
    roller = Roller(rolled, law, rows)
    whole = roller.w_of(-roller.radius), np.full(rows.size, LAST_SLIP)
    low, high, beyond, unsure = _transmissible(rolled, law, roller, *whole)
    go = np.flatnonzero(~beyond)
    if go.size == 0:
        return rows
    k, low, high = rows[go], low[go], high[go]
    whole = whole[0][go], whole[1][go]
    found, slides = _balance(rolled, law, k, low, high, whole, unsure[go])
    beyond[go] = slides
    roller = Roller(rolled, law, k)
    lift = _settle_branch(rolled, law, roller, found, low, high, slides)
    best, w, n, f = found.best, found.w, found.normal, found.forces
    # without a solution, what holds without friction decides
    solved = best <= (SOLVED_FALLING if loads.falling else SOLVED)
    lift |= ~solved & ~slides & np.any(roller.normal_forces(np.zeros((2, go.size))) <= 0, axis=0)
    regime[k] = np.where(lift, LIFT_OFF, np.where(solved, ROLLING, FAILED))
    jamming[k] = roller.grips(n, f) & (loads.friction[k] > 0) & ~slides
    up = np.flatnonzero(lift & (loads.friction[k] > 0))
    if up.size:
        jamming[k[up]] = self_locking(rolled, law, k[up], low[up], high[up])
    residual[k] = np.fmax(best, digits_of_forces(roller, w, n, f, best))
    shift[k], normal[:, k] = roller.shift(w), n
    forces[:, :, k] = np.where(loads.friction[k] > 0, f, 0.0)
    return rows[beyond]


def _transmissible(rolled, law, roller, w_low, w_high):
    """Bounds of the slip (m,), whose torque no slip can transmit (m,), and for which the rough law cannot tell (m,)."""
    if rolled.falling:
        low, high, beyond, unsure = first_balance(roller, w_low, w_high)
        return low, high, beyond & ~unsure, unsure
    # locked, the friction along the track is complete and there is no other, as in full slip
    complete = roller.friction * np.sum(roller.normal_forces(np.zeros((2, roller.rows.size))), axis=0)
    beyond = roller.motor_force > complete
    drives = np.flatnonzero(roller.motor_force < 0)
    spins = Roller(rolled, law, roller.rows[drives])
    torque = spins.torque(_forces_at(spins, w_low[drives]))
    # a law without an answer for this patch leaves what friction can give at most
    beyond[drives] = np.where(np.isnan(torque), -spins.motor_force > complete[drives], torque < 0)
    return w_low, w_high, beyond, np.zeros(beyond.size, bool)


def _balance(loads, law, rows, low, high, whole, unsure) -> tuple[_Found, np.ndarray]:
    """Roots between `low` and `high`, and which rollers turn out to transmit too little (m,).

    Those missed at first are searched with the fine law; where friction falls, over the `whole` range, and `low` and
    `high` are put where that search ended.
    """
    roller = Roller(loads, law, rows)
    w, n = bracketed(roller, low.copy(), high.copy(), fine=False, sweeps=25, tolerance=1e-3)
    found = _Found(*newton_polish(roller, w, n, low, high, settled(roller)))
    slides = np.zeros(rows.size, bool)
    bad = np.flatnonzero(~(found.best <= loads.converged) | unsure)
    if bad.size and loads.falling:
        *again, low[bad], high[bad], none = balance_again(loads, law, rows[bad], *(v[bad] for v in whole))
        found.best[bad[unsure[bad] | none]] = np.inf
        found.put_better(bad, again, loads.converged)
        slides[bad[none]] = True
    elif bad.size:  # slow and sure
        roller = Roller(loads, law, rows[bad])
        w, n = bracketed(roller, low[bad].copy(), high[bad].copy(), fine=True, sweeps=80, tolerance=1e-15)
        found.put(bad, newton_polish(roller, w, n, low[bad], high[bad], settled(roller)))
    return found, slides


def _settle_branch(loads, law, roller, found: _Found, low, high, slides) -> np.ndarray:
    """Near self-locking puts the branch that loading reaches in place of what failed; True where it lifts off (m,)."""
    lift = roller.lifts(found.normal) & ~slides
    wedged = roller.wedged(found.normal, found.forces)
    bad = np.flatnonzero(~((found.best <= loads.converged) & wedged) & ~lift & ~slides)
    if loads.falling:
        # far from self-locking there is one branch only; and what lies within a jump of the forces lies on it
        near = roller.friction >= 0.5 * np.tan(loads.contact_angle[roller.rows])
        bad = bad[near[bad] & ~((found.best[bad] <= SOLVED_FALLING) & wedged[bad])]
    if bad.size:
        *again, lift[bad] = follow_friction(loads, law, roller.rows[bad], low[bad], high[bad])
        if loads.falling:
            best = np.where(found.best[bad] > loads.converged, found.best[bad], np.inf)
            take = ~(again[0] > best)
            found.put(bad[take], [v[..., take] for v in again])
        else:
            found.put(bad, again)
    return lift


def _forces_at(roller: Roller, w) -> np.ndarray:
    """Contact forces (3, 2, m) at a given slip, the normal forces having followed."""
    normal = roller.floored(roller.normal_forces(np.zeros((2, w.size))))
    for _ in range(3):
        f = roller.contact(roller.shift(w), normal, True)
        normal = roller.floored(roller.normal_forces(f[0] / normal))
    return roller.contact(roller.shift(w), normal, True)


def _solve_full_slip(loads, law, rows, regime, residual, shift, normal, forces) -> None:
    # ASSUME: in complete slip the speed is beyond what the friction law tells of
    loads = replace(loads, friction=loads.friction * loads.at_high_speed)
    roller = Roller(loads, law, rows)
    n = roller.normal_forces(np.zeros((2, rows.size)))
    lift = roller.lifts(n)
    regime[rows] = np.where(lift, LIFT_OFF, FULL_SLIP)
    direction = -np.sign(loads.motor_force[rows])
    for i in (0, 1):
        s = roller.shape.at(np.maximum(n[i], 0.0))
        r = tractions_full_slip(s, roller.friction, direction)
        forces[:, i, rows] = np.stack([r.lateral_force, r.driving_force, r.spin_moment])
    normal[:, rows] = n
    residual[rows] = np.max(np.abs(roller.residuals(n, forces[:, :, rows])[:2]), axis=0) / roller.load
    shift[rows] = np.nan
