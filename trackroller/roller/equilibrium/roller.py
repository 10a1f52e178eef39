"""The balances of a roller, eqs (7), (9) and of the drive torque (10), (31), for any contact law.

Arrays over m rollers; forces of both contacts have shape (3, 2, m): F_T, F_A, M_R by contact.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from trackroller.contact.hertz import HertzShape
from trackroller.contact.quantities import Ellipse, Resultants
from trackroller.contact.slip import Slip
from trackroller.contact.wedge import determinant

LAST_SLIP = 1.0 - 2.0**-53  # largest |w|; beyond it the friction is that of complete slip to the last digit
TOLERANCE = 0.01  # residual that the solution aims at, over the residual that counts as converged
LIFTED = 1e-8  # share of the load; a contact that carries no more has lifted off

# (ellipse, slip, friction, rows, fine) -> resultants; `fine` chooses the discretisation
ContactLaw = Callable[[Ellipse, Slip, np.ndarray, np.ndarray, bool], Resultants]


@dataclass(frozen=True)
class RollerLoads:
    """Loads and kinematics of n rollers, arrays (n,) in N, mm and rad.

    Attributes
    ----------
    radial_force, axial_force, motor_force, friction, contact_angle, guide_profile_radius : numpy.ndarray, shape (n,)
        See `trackroller.parameters`.
    rolling_radius : numpy.ndarray, shape (n,)
        r_A.
    shape : HertzShape
        Hertz shape of the contacts.
    difference_step : float
        Relative step for derivatives of the contact law, above the noise of iterative laws.
    converged : float
        Largest relative residual of a solution.
    falling : bool
        True if friction depends on the slip speed.
    at_high_speed : float
        Friction in complete slip over the coefficient `friction`.
    """

    radial_force: np.ndarray
    axial_force: np.ndarray
    motor_force: np.ndarray
    friction: np.ndarray
    contact_angle: np.ndarray
    guide_profile_radius: np.ndarray
    rolling_radius: np.ndarray
    shape: HertzShape
    difference_step: float = 1e-5
    converged: float = 1e-10
    falling: bool = False
    at_high_speed: float = 1.0

    @cached_property
    def sine(self) -> np.ndarray:
        """Return sin(alpha), (n,)."""
        return np.sin(self.contact_angle)

    @cached_property
    def cosine(self) -> np.ndarray:
        """Return cos(alpha), (n,)."""
        return np.cos(self.contact_angle)

    def contacts(self, normal: np.ndarray, shift: np.ndarray, rows: np.ndarray) -> tuple[Ellipse, Slip]:
        """Return the ellipses and the kinematics of both contacts.

        Parameters
        ----------
        normal, shift : numpy.ndarray, shape (2 m,)
            Normal force [N] and r_Delta0 [mm] of contact 1 of all rollers, then of contact 2.
        rows : numpy.ndarray of int, shape (2 m,)
            Number of the roller of each contact.
        """
        sine = self.sine[rows]
        second = slice(len(rows) // 2, None)
        sine[second] = -sine[second]
        slip = Slip(sine, self.cosine[rows], self.guide_profile_radius[rows], self.rolling_radius[rows], shift)
        return self.shape.take(rows).at(normal), slip


class Roller:
    """The equations of m rollers, the rows `rows` of the loads."""

    def __init__(self, loads: RollerLoads, law: ContactLaw, rows: np.ndarray) -> None:
        self.loads = loads
        self.rows = rows
        self.law = law
        self.step = loads.difference_step
        self.goal = TOLERANCE * loads.converged
        self.radial_force = loads.radial_force[rows]
        self.axial_force = loads.axial_force[rows]
        self.motor_force = loads.motor_force[rows]
        self.friction = loads.friction[rows]
        self.radius = loads.rolling_radius[rows]
        self.shape = loads.shape.take(rows)
        self.sin, self.cos = loads.sine[rows], loads.cosine[rows]
        self.load = np.abs(self.radial_force) + np.abs(self.axial_force)
        self.largest = self.load * np.maximum(1e3, 10.0 / np.minimum(self.sin, self.cos))
        # The slip varies over the patch by the spin and by the curved profile of the guide, which ends at its equator.
        # On a roller smaller than its patch, the spin moment decays slowly with the slip; the last factor counts this.
        root = np.cbrt(self.load * np.maximum(1.0, 0.5 / self.cos))
        flat = loads.guide_profile_radius[rows] * self.cos
        wide, long = self.shape.lateral, self.shape.rolling
        bend = np.minimum((wide * root * self.cos) ** 2 / flat, flat)
        varies = 0.5 * (self.sin * np.hypot(wide, long) * root + bend)
        self.slip_scale = varies * (1.0 + varies / self.radius)
        # the residual of the torque is relative to the largest torque of friction, so that it shows under low friction
        pressing = np.abs(self.radial_force) / self.cos + np.abs(self.axial_force)
        self.torque_scale = self.friction * pressing * (1.0 + varies / self.radius) + np.abs(self.motor_force)

    def contact(self, shift: np.ndarray, normal: np.ndarray, fine: bool, pick=slice(None)) -> np.ndarray:
        """Return F_T, F_A, M_R of both contacts, (3, 2, m), at shift (m,) [mm] and normal forces (2, m) [N]."""
        own = self.rows[pick]
        rows = np.concatenate((own, own))
        ellipse, slip = self.loads.contacts(normal.reshape(-1), np.concatenate((shift, shift)), rows)
        r = self.law(ellipse, slip, self.loads.friction[rows], rows, fine)
        return np.array((r.lateral_force, r.driving_force, r.spin_moment)).reshape(3, 2, shift.size)

    def normal_forces(self, ratio: np.ndarray, pick=slice(None)) -> np.ndarray:
        """Return F_N (2, m) [N] from eqs (7), (9) for given ratios F_T,i / F_N,i, (2, m) [1]."""
        s, c = self.sin[pick], self.cos[pick]
        a11, a12 = s + c * ratio[0], -s + c * ratio[1]
        a21, a22 = c - s * ratio[0], c + s * ratio[1]
        b1, b2 = -self.axial_force[pick], -self.radial_force[pick]
        with np.errstate(divide="ignore", invalid="ignore"):
            det = a11 * a22 - a12 * a21
            return np.array(((b1 * a22 - a12 * b2) / det, (a11 * b2 - a21 * b1) / det))

    def without_friction(self) -> np.ndarray:
        """Return F_N (2, m) [N] from eqs (7), (9) without friction."""
        return self.normal_forces(np.zeros((2, self.rows.size)))

    def torque(self, f: np.ndarray, pick=slice(None)) -> np.ndarray:
        """Return the residual of the drive torque over r_A, (m,) [N]; > 0 if friction drives more than required."""
        drilling = (f[2, 0] - f[2, 1]) * self.sin[pick] / self.radius[pick]
        return drilling + f[1, 0] + f[1, 1] + self.motor_force[pick]

    def wedged(self, normal: np.ndarray, f: np.ndarray) -> np.ndarray:
        """Return True where the solution lies on the branch that grows out of the frictionless wedge, (m,).

        On this branch the determinant of eqs (7), (9) is positive: more axial force means a larger difference of the
        normal forces. Beyond self-locking, mu f = tan(alpha), there is another branch, on which the wrong contact
        carries the lateral load. Without axial force both branches are the same.
        """
        return (determinant(self.sin, self.cos, *(f[0] / normal)) > 0) | (self.axial_force == 0)

    def residuals(self, normal: np.ndarray, f: np.ndarray, pick=slice(None)) -> np.ndarray:
        """Return the residuals of the lateral, radial and torque balance, (3, m) [N]."""
        s, c = self.sin[pick], self.cos[pick]
        lateral = c * (f[0, 0] + f[0, 1]) + s * (normal[0] - normal[1]) + self.axial_force[pick]
        radial = s * (f[0, 1] - f[0, 0]) + c * (normal[0] + normal[1]) + self.radial_force[pick]
        return np.array((lateral, radial, self.torque(f, pick)))

    def shift(self, w: np.ndarray, pick=slice(None)) -> np.ndarray:
        """Return r_Delta0 = c w / sqrt(1 - w^2) [mm] for w in (-1, 1)."""
        with np.errstate(divide="ignore"):
            return self.slip_scale[pick] * w / np.sqrt((1 - w) * (1 + w))

    def w_of(self, shift: np.ndarray) -> np.ndarray:
        """Return w for r_Delta0 [mm]; the inverse of `shift`."""
        return np.clip(shift / np.hypot(self.slip_scale, shift), -LAST_SLIP, LAST_SLIP)

    def lifts(self, normal: np.ndarray) -> np.ndarray:
        """Return True where a contact carries no more than `LIFTED` of the load, (m,)."""
        return np.any(normal <= LIFTED * self.load, axis=0)

    def grips(self, normal: np.ndarray, f: np.ndarray) -> np.ndarray:
        """Return True where friction alone carries the lateral load of a contact, |F_T| >= F_N tan(alpha), (m,)."""
        return np.any(np.abs(f[0]) * self.cos >= normal * self.sin, axis=0)

    def floored(self, normal: np.ndarray, pick=slice(None)) -> np.ndarray:
        """Return normal forces that are finite and positive: a contact about to lift off still needs an ellipse."""
        load = self.load[pick]
        known = np.where(np.isnan(normal), load, normal)
        return np.minimum(np.maximum(known, 1e-9 * load), self.largest[pick])
