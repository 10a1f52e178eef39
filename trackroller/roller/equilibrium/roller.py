"""The balances of a roller, eqs (7), (9) and of the drive torque (10), (31), for any contact law."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from trackroller.contact.common import Ellipse, Resultants, Slip
from trackroller.contact.hertz import HertzShape

LAST_SLIP = 1.0 - 2.0**-53  # largest |w|; beyond, the friction is that of complete slip to the last digit
TOLERANCE = 0.01  # aimed at, over the residual that counts as converged
LIFTED = 1e-8  # a contact that carries no more than this share of the load has lifted off

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


class Roller:
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

    def lifts(self, normal: np.ndarray) -> np.ndarray:
        """Does a contact carry no more than `LIFTED` of the load? Shape (m,)."""
        return np.any(normal <= LIFTED * self.load, axis=0)

    def grips(self, normal: np.ndarray, f: np.ndarray) -> np.ndarray:
        """Does friction alone carry the lateral load of a contact, |F_T| >= F_N tan(alpha)? Shape (m,)."""
        return np.any(np.abs(f[0]) * self.cos >= normal * self.sin, axis=0)

    def floored(self, normal: np.ndarray, pick=slice(None)) -> np.ndarray:
        """Normal forces kept positive, for a contact about to lift still needs an ellipse, and finite."""
        load = self.load[pick]
        return np.clip(np.where(np.isnan(normal), load, normal), 1e-9 * load, self.largest[pick])
