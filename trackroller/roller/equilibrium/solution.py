"""Equilibrium of the roller: normal forces and rolling radius shift, for any contact model.

Unknowns F_N1, F_N2 and r_Delta0; equations (7), (9) and the balance of the drive torque, (10) and
(31): -(M_R1 - M_R2) sin(alpha) - (F_A1 + F_A2) r_A = F_Motor r_A. The slip enters through w in (-1,
1), r_Delta0 = c w / sqrt(1 - w^2), in which the torque is nearly linear. A search with a coarse
contact law brackets the root; Newton's method on all three equations refines it with the fine law.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from trackroller.contact.quantities import Resultants
from trackroller.contact.sliding import tractions_full_slip
from trackroller.parameters import REGIMES
from trackroller.roller.equilibrium.branch import follow_friction, self_locking
from trackroller.roller.equilibrium.falling import balance_again, first_balance
from trackroller.roller.equilibrium.newton import (
    Bounds,
    Solution,
    bracketed,
    digits_of_forces,
    newton_polish,
    settled,
)
from trackroller.roller.equilibrium.roller import LAST_SLIP, ContactLaw, Roller, RollerLoads

ROLLING, FULL_SLIP, LIFT_OFF, FAILED = (
    REGIMES.index(name) for name in ("rolling", "full_slip", "lift_off", "failed")
)
# Largest residual of a solution. Where friction falls steeply, a patch has many states of adhesion
# and slip; its forces jump between these states, and the balance may lie within such a jump.
SOLVED = 1e-6
SOLVED_FALLING = 1e-2
LEAST_FRICTION = 1e-100  # smaller friction coefficients count as zero; their forces would underflow
# Share of the complete friction from which braking counts as full slip: loads in round numbers may
# need exactly the complete friction, and rounding must not choose the regime then.
COMPLETE = 1.0 - 1e-9
# share of the complete friction above which braking is compared with the contact law
NEARLY = 0.999
# Share of the complete friction up to which friction drives a roller whose slip varies over its
# patches by less than the second number times the rolling radius. All contact laws gave 0.98 of it
# or more on 9000 random rollers.
SURELY = 0.9
SMALL_PATCH = 0.1
LIMIT_FRICTION = 1e-12  # friction coefficient that stands for the limit mu -> 0


@dataclass(frozen=True)
class Equilibrium:
    """Solution for n rollers; undefined values are NaN.

    Attributes
    ----------
    regime : numpy.ndarray of int, shape (n,)
        Number in `parameters.REGIMES`.
    converged : numpy.ndarray of bool, shape (n,)
        True where the residual is below the limit of the contact model.
    residual : numpy.ndarray, shape (n,)
        Largest relative imbalance: forces over the applied loads, torque over the largest torque of
        friction and motor. On rollers much smaller than their patches, it is at least the
        uncertainty of the transmitted force over the largest friction force.
    jamming : numpy.ndarray of bool, shape (n,)
        True where friction alone carries the lateral load. For a roller that has lifted off, True
        if friction would carry the lateral load without axial force.
    shift : numpy.ndarray, shape (n,)
        Rolling radius shift r_Delta0 [mm].
    normal_force : numpy.ndarray, shape (n, 2)
        Normal forces [N].
    forces : Resultants
        Resultants of both contacts, arrays (n, 2).
    """

    regime: np.ndarray
    converged: np.ndarray
    residual: np.ndarray
    jamming: np.ndarray
    shift: np.ndarray
    normal_force: np.ndarray
    forces: Resultants


@dataclass
class _Progress:
    """Solution in progress: regime, residual, jamming, shift (n,), normal forces (2, n), contact
    forces (3, 2, n).
    """

    regime: np.ndarray
    residual: np.ndarray
    jamming: np.ndarray
    shift: np.ndarray
    normal: np.ndarray
    forces: np.ndarray

    @classmethod
    def of(cls, n: int) -> _Progress:
        """Return n rollers without a solution."""
        nan = np.full((7, n), np.nan)
        regime = np.full(n, FAILED, dtype=np.int8)
        return cls(
            regime,
            nan[0].copy(),
            np.zeros(n, bool),
            nan[1].copy(),
            nan[:2].copy(),
            nan[:6].reshape(3, 2, n),
        )

    def equilibrium(self, limit: float) -> Equilibrium:
        """Return the equilibrium; residuals up to `limit` count as converged."""
        lifted = (self.regime == LIFT_OFF) | (self.regime == FAILED)
        self.shift[lifted] = np.nan
        self.residual[self.regime == LIFT_OFF] = np.nan
        self.normal[:, lifted], self.forces[:, :, lifted] = np.nan, np.nan
        converged = np.where(self.regime == LIFT_OFF, True, self.residual <= limit)
        forces = Resultants(*self.forces.transpose(0, 2, 1))
        return Equilibrium(
            self.regime, converged, self.residual, self.jamming, self.shift, self.normal.T, forces
        )


def solve_equilibrium(loads: RollerLoads, law: ContactLaw) -> Equilibrium:
    """Solve for the normal forces, the slip and the friction resultants of n rollers.

    Parameters
    ----------
    loads : RollerLoads
        Applied loads, friction and geometry, arrays (n,).
    law : ContactLaw
        Contact law; with `fine=False` it may be cheap and rough.

    Returns
    -------
    Equilibrium
        Solution of the n rollers.

    Notes
    -----
    `FULL_SLIP`: even complete slip in the rolling direction cannot balance the motor force.
    Complete slip is r_Delta0 = -r_A when driving (the roller spins without travel) and r_Delta0 ->
    inf when braking (the roller is locked). `LIFT_OFF`: a contact would carry no more than 1e-8 of
    |F_rad| + |F_ax|, or pull. ASSUME: without friction the slip is that of the limit mu -> 0 if
    F_Motor = 0, and every motor force causes full slip.
    """
    loads = replace(loads, friction=np.where(loads.friction < LEAST_FRICTION, 0.0, loads.friction))
    answer = _Progress.of(loads.radial_force.size)
    rows = np.flatnonzero(np.isfinite(loads.shape.lateral))
    slides = rows[(loads.friction[rows] == 0) & (loads.motor_force[rows] != 0)]
    rolls = np.setdiff1d(rows, slides)
    if rolls.size:
        slides = np.concatenate([slides, _solve_rolling(loads, law, rolls, answer)])
    if slides.size:
        _solve_full_slip(loads, law, slides, answer)
    return answer.equilibrium(loads.converged)


def _solve_rolling(
    loads: RollerLoads, law: ContactLaw, rows: np.ndarray, answer: _Progress
) -> np.ndarray:
    """Fill the rolling rows of `answer`; return the rows whose friction cannot transmit the drive
    torque.
    """
    friction = np.ones_like(loads.friction)
    friction[rows] = np.where(loads.friction[rows] > 0, loads.friction[rows], LIMIT_FRICTION)
    eased = replace(loads, friction=friction)
    roller = Roller(eased, law, rows)
    whole = Bounds(roller.w_of(-roller.radius), np.full(rows.size, LAST_SLIP))
    bounds, beyond, unsure = _transmissible(roller, whole)
    go = np.flatnonzero(~beyond)
    if go.size == 0:
        return rows
    roller = Roller(eased, law, rows[go])
    bounds = bounds.take(go)
    solution, slides = _balance(roller, bounds, whole.take(go), unsure[go])
    beyond[go] = slides
    lift = _settle_branch(roller, solution, bounds, slides)
    _record(
        answer,
        roller,
        solution,
        bounds,
        lift=lift,
        slides=slides,
        rubs=loads.friction[rows[go]] > 0,
    )
    return rows[beyond]


def _record(
    answer: _Progress, roller: Roller, solution: Solution, bounds: Bounds, *, lift, slides, rubs
) -> None:
    """Write regime, forces and residual of rolling candidates; `rubs` marks rollers with friction,
    (m,).
    """
    rows = roller.rows
    solved = solution.residual <= (SOLVED_FALLING if roller.loads.falling else SOLVED)
    # a roller without a solution has lifted off if it does so without friction
    lifted = lift | (~solved & ~slides & np.any(roller.without_friction() <= 0, axis=0))
    answer.regime[rows] = np.where(lifted, LIFT_OFF, np.where(solved, ROLLING, FAILED))
    answer.jamming[rows] = roller.grips(solution.normal, solution.forces) & rubs & ~slides
    up = np.flatnonzero(lifted & rubs)
    if up.size:
        answer.jamming[rows[up]] = self_locking(
            Roller(roller.loads, roller.law, rows[up]), bounds.take(up)
        )
    answer.residual[rows] = np.fmax(solution.residual, digits_of_forces(roller, solution))
    answer.shift[rows], answer.normal[:, rows] = roller.shift(solution.w), solution.normal
    answer.forces[:, :, rows] = np.where(rubs, solution.forces, 0.0)


def _transmissible(roller: Roller, whole: Bounds) -> tuple[Bounds, np.ndarray, np.ndarray]:
    """Return bounds of the slip, where no slip transmits the torque (m,), and where the coarse law
    cannot decide (m,).

    `whole` is the range of w from complete slip when driving to complete slip when braking.
    """
    if roller.loads.falling:
        bounds, beyond, unsure = first_balance(roller, whole)
        return bounds, beyond & ~unsure, unsure
    # a locked roller has the complete friction along the track and no other, as in full slip
    complete = roller.friction * np.sum(roller.without_friction(), axis=0)
    beyond = np.abs(roller.motor_force) > COMPLETE * complete
    # a law by interpolation or by elements reaches the complete friction within its error only
    locks = np.flatnonzero(~beyond & (roller.motor_force > NEARLY * complete))
    if locks.size:
        brakes = Roller(roller.loads, roller.law, roller.rows[locks])
        beyond[locks] = brakes.torque(_forces_at(brakes, whole.high[locks])) > 0
    # a roller that spins without travel has nearly the complete friction along the track, unless
    # its patch is large
    sure = (-roller.motor_force < SURELY * complete) & (
        roller.slip_scale < SMALL_PATCH * roller.radius
    )
    drives = np.flatnonzero((roller.motor_force < 0) & ~sure & ~beyond)
    if drives.size:
        spins = Roller(roller.loads, roller.law, roller.rows[drives])
        torque = spins.torque(_forces_at(spins, whole.low[drives]))
        # where the law gives no forces for this patch, the complete friction decides
        beyond[drives] = np.where(
            np.isnan(torque), -spins.motor_force > complete[drives], torque < 0
        )
    return whole, beyond, np.zeros(beyond.size, bool)


def _balance(
    roller: Roller, bounds: Bounds, whole: Bounds, unsure: np.ndarray
) -> tuple[Solution, np.ndarray]:
    """Find the roots within `bounds`; return them, and which rollers turn out to transmit too
    little, (m,).

    Roots that the coarse law misses are searched again with the fine law. Where friction falls with
    the slip speed, this search covers the `whole` range, and `bounds` are overwritten by the bounds
    that it ends with.
    """
    loads = roller.loads
    law = roller.law
    rows = roller.rows
    w, n = bracketed(roller, bounds.copy(), fine=False, sweeps=25, tolerance=1e-3)
    solution = newton_polish(roller, w, n, bounds, settled(roller))
    slides = np.zeros(rows.size, bool)
    bad = np.flatnonzero(~(solution.residual <= loads.converged) | unsure)
    if bad.size and loads.falling:
        again, ends, none = balance_again(Roller(loads, law, rows[bad]), whole.take(bad))
        bounds.low[bad], bounds.high[bad] = ends
        solution.residual[bad[unsure[bad] | none]] = np.inf
        solution.put_better(bad, again, loads.converged)
        slides[bad[none]] = True
    elif bad.size:  # slow, but it finds every root
        part = Roller(loads, law, rows[bad])
        ends = bounds.take(bad)
        w, n = bracketed(part, ends.copy(), fine=True, sweeps=80, tolerance=1e-15)
        solution.put(bad, newton_polish(part, w, n, ends, settled(part)))
    return solution, slides


def _settle_branch(
    roller: Roller, solution: Solution, bounds: Bounds, slides: np.ndarray
) -> np.ndarray:
    """Replace failed solutions near self-locking by the branch that loading reaches; return True
    for lift-off, (m,).
    """
    loads = roller.loads
    lift = roller.lifts(solution.normal) & ~slides
    wedged = roller.wedged(solution.normal, solution.forces)
    bad = np.flatnonzero(~((solution.residual <= loads.converged) & wedged) & ~lift & ~slides)
    if loads.falling:
        # Far from self-locking there is one branch only. A residual inside the jump of a falling
        # friction law counts as solved.
        near = roller.friction >= 0.5 * np.tan(loads.contact_angle[roller.rows])
        bad = bad[near[bad] & ~((solution.residual[bad] <= SOLVED_FALLING) & wedged[bad])]
    if bad.size:
        again, lift[bad] = follow_friction(
            Roller(loads, roller.law, roller.rows[bad]), bounds.take(bad)
        )
        take = np.ones(bad.size, bool)
        if loads.falling:
            best = solution.residual[bad]
            take = ~(again.residual > np.where(best > loads.converged, best, np.inf))
        solution.put(bad[take], again.take(take))
    return lift


def _forces_at(roller: Roller, w: np.ndarray) -> np.ndarray:
    """Return the contact forces (3, 2, m) at a given slip; the normal forces follow the friction in
    three steps.
    """
    normal = roller.floored(roller.without_friction())
    for _ in range(3):
        f = roller.contact(roller.shift(w), normal, True)
        normal = roller.floored(roller.normal_forces(f[0] / normal))
    return roller.contact(roller.shift(w), normal, True)


def _solve_full_slip(
    loads: RollerLoads, law: ContactLaw, rows: np.ndarray, answer: _Progress
) -> None:
    """Fill the rows of `answer` that slip completely along the track.

    ASSUME: the slip speed is beyond the range of the friction law, so that friction has its value
    at high speed.
    """
    roller = Roller(replace(loads, friction=loads.friction * loads.at_high_speed), law, rows)
    n = roller.without_friction()
    answer.regime[rows] = np.where(roller.lifts(n), LIFT_OFF, FULL_SLIP)
    direction = -np.sign(roller.motor_force)
    for i in (0, 1):
        ellipse = roller.shape.at(np.maximum(n[i], 0.0))
        r = tractions_full_slip(ellipse, roller.friction, direction)
        answer.forces[:, i, rows] = np.stack([r.lateral_force, r.driving_force, r.spin_moment])
    answer.normal[:, rows] = n
    unbalanced = roller.residuals(n, answer.forces[:, :, rows])[:2]
    answer.residual[rows] = np.max(np.abs(unbalanced), axis=0) / roller.load
    answer.shift[rows] = np.nan
