"""The rigid slip, eqs (20)-(25): formulas, creepages, and the terms of a curved guide or a drawn
contour.

The formulas stand in `trackroller.halfspace.rigid_slip`, because the stress kernels of the room
below need them too. Kernels and models of this room import them from this module.

Frame: x_C lateral, y_C in the rolling direction (Kalker and CONTACT use x for rolling).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from trackroller.contact.cross_sections import CrossSection
from trackroller.errors import unknown_name
from trackroller.halfspace.rigid_slip import (
    lateral_slip,
    pole_lateral,
    pole_line,
    pole_offset,
    pole_rolling,
    profile_slip,
    rolling_slip,
    slip_zeros,
)
from trackroller.numerics.rows import Rows
from trackroller.parameters import SPIN_MODELS

__all__ = [
    "Creepage",
    "Slip",
    "contour_over_tangent",
    "lateral_slip",
    "pole_lateral",
    "pole_line",
    "pole_offset",
    "pole_rolling",
    "pole_split",
    "profile_slip",
    "rolling_slip",
    "slip_zeros",
    "spin_model_index",
    "turning_of",
]

STEPS = 60  # limit of Newton's method; four or five steps are usual
# smallest slope of the guide's contour, as a sine, at which the contour is followed
FLATTEST = 0.05


def spin_model_index(name: str) -> int:
    """Return 0, 1, 2 for the paper's assumptions 'concentric', 'edge', 'skewed' on the spin pole.

    Parameters
    ----------
    name : str
        Name of the assumption.

    Raises
    ------
    InputError
        If there is no such assumption.
    """
    if name not in SPIN_MODELS:
        raise unknown_name("spin_model", name, SPIN_MODELS)
    return SPIN_MODELS.index(name)


@dataclass(frozen=True)
class Slip(Rows):
    """Kinematics of n patches, from which the rigid slip follows.

    Parameters
    ----------
    sine, cosine : ndarray, shape (n,)
        Of the signed contact angle, +alpha in contact 1 and -alpha in contact 2 [1].
    guide_profile_radius : ndarray, shape (n,)
        r_C,G [mm].
    rolling_radius : ndarray, shape (n,)
        r_A [mm].
    shift : ndarray, shape (n,)
        Rolling radius shift r_Delta0 [mm].
    turning : ndarray, shape (n,), optional
        Angle by which the roller turns with the guide's curve per distance travelled [1/mm], see
        `turning_of`. It adds to the spin creepage.
    contour : ndarray of callables, shape (n,), optional
        Shape of a drawn guide, see `contour_over_tangent`; None stands for the circle.
    """

    sine: np.ndarray
    cosine: np.ndarray
    guide_profile_radius: np.ndarray
    rolling_radius: np.ndarray
    shift: np.ndarray
    turning: np.ndarray | None = None
    contour: np.ndarray | None = None

    @property
    def longitudinal(self) -> np.ndarray:
        """Return the longitudinal creepage xi = r_Delta0 / r_A [1]; xi > 0 brakes."""
        return self.shift / self.rolling_radius

    @property
    def spin(self) -> np.ndarray:
        """Return the spin creepage phi = -sin(alpha) (1/r_A + turning) [1/mm], of opposite sign in
        the two contacts.
        """
        if self.turning is None:
            return -self.sine / self.rolling_radius
        return -self.sine * (1.0 / self.rolling_radius + self.turning)

    @property
    def pole_lateral(self) -> np.ndarray:
        """Return x_spin = r_Delta0 / sin(alpha) [mm], eq. (23)."""
        return pole_lateral(self.shift, self.sine)

    def beyond_tangent(self, x: np.ndarray) -> np.ndarray:
        """Return the rolling slip of the guide's circle, eq. (20), or contour, less that of its
        tangent.

        The rolling slip of the tangent is xi + phi x. ASSUME: beyond the equator of the guide's
        circle the slip keeps the value that it has at the equator.

        Parameters
        ----------
        x : ndarray, shape (n, m)
            Lateral positions [mm].

        Returns
        -------
        ndarray, shape (n, m)
            Slip per travel speed [1].
        """
        sine, cosine, radius = (
            self.sine[:, None],
            self.cosine[:, None],
            self.guide_profile_radius[:, None],
        )
        out = (x * sine + profile_slip(x, sine, cosine, radius)) / self.rolling_radius[:, None]
        for i, height in enumerate(() if self.contour is None else self.contour):
            if height is not None:
                # x counts outward in a contour
                out[i] = height(np.sign(self.sine[i]) * x[i]) / self.rolling_radius[i]
        return out


@dataclass(frozen=True)
class Creepage(Rows):
    """Rigid slip of the roller against the guide per travel speed in n patches.

    w_x = eta - phi y and w_y = xi + phi x, plus the profile's part if `profile` is given.

    Attributes
    ----------
    longitudinal : numpy.ndarray, shape (n,)
        xi, creepage along y_C [1].
    lateral : numpy.ndarray, shape (n,)
        eta, creepage along x_C [1].
    spin : numpy.ndarray, shape (n,)
        phi, spin creepage about z_C [1/mm].
    profile : Slip, optional
        Kinematics whose `beyond_tangent` is added to w_y.
    """

    longitudinal: np.ndarray
    lateral: np.ndarray
    spin: np.ndarray
    profile: Slip | None = None

    @classmethod
    def of_slip(cls, slip: Slip, profile: bool = False) -> Creepage:
        """Return the creepages of a roller.

        Parameters
        ----------
        slip : Slip
            Kinematics of n patches.
        profile : bool
            Follow the guide's profile, eq. (20), instead of its tangent xi + phi x.
        """
        longitudinal, spin = np.asarray(slip.longitudinal, float), np.asarray(slip.spin, float)
        return cls(longitudinal, np.zeros_like(longitudinal), spin, slip if profile else None)

    def along(self, x: np.ndarray) -> np.ndarray:
        """Return w_y at lateral positions x (n, m) [mm], shape (n, m)."""
        tangent = self.longitudinal[:, None] + self.spin[:, None] * x
        return tangent if self.profile is None else tangent + self.profile.beyond_tangent(x)


def turning_of(
    curve_radius: np.ndarray, profile_radius: np.ndarray, cosine: np.ndarray
) -> np.ndarray:
    """Return the angle by which a roller turns with the guide's curve per distance travelled
    [1/mm].

    The angle is 1/(r_Curve + r_C,G cos(alpha)). The points of contact travel on a circle of this
    radius about the axis of the curve, and the carrier of the roller turns with them.

    Parameters
    ----------
    curve_radius : ndarray, shape (n,)
        r_Curve [mm], signed, inf if straight.
    profile_radius : ndarray, shape (n,)
        r_C,G [mm].
    cosine : ndarray, shape (n,)
        Of the contact angle.

    Returns
    -------
    ndarray, shape (n,)
        0 on a straight guide, < 0 on a concave one, NaN where the contact lies beyond the axis of a
        concave guide.
    """
    radius = curve_radius + profile_radius * cosine
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(radius * np.sign(curve_radius) > 0.0, 1.0 / radius, np.nan)


def contour_over_tangent(guide: CrossSection, alpha: float) -> Callable[[np.ndarray], np.ndarray]:
    """Return the radial height of the guide's own contour over its tangent, the circle's part of
    eq. (20).

    A point (u, h) of the contour lies at u cos(alpha) + h sin(alpha) across the roller, which is x
    cos(alpha) in eq. (20), and at h cos(alpha) - u sin(alpha) in the radial direction. Newton's
    method finds u.

    Parameters
    ----------
    guide : CrossSection
        Cross-section over the tangent plane.
    alpha : float
        Contact angle [rad].

    Returns
    -------
    callable
        Maps lateral positions x (m,) [mm], counted outward, to heights (m,) [mm].
    """
    tangent, sine, cosine = np.tan(alpha), np.sin(alpha), np.cos(alpha)
    low, high = guide.limits

    def height(x: np.ndarray) -> np.ndarray:
        u = np.clip(x, low, high)
        for _ in range(STEPS):
            rise = np.maximum(1.0 + tangent * guide.slope(u), FLATTEST)
            change = (u + tangent * guide.full_height(u) - x) / rise
            u = np.clip(u - change, low, high)
            if np.max(np.abs(change), initial=0.0) <= 1e-14 * (
                1.0 + np.max(np.abs(x), initial=0.0)
            ):
                break
        return guide.full_height(u) * cosine - u * sine + x * sine

    return height


def pole_split(
    a: np.ndarray, sine: np.ndarray, cosine: np.ndarray, radius: np.ndarray, shift: np.ndarray
) -> np.ndarray:
    """Return the distance between the model's spin pole and the point where its slip vanishes, over
    a.

    The pole of eq. (22) lies where the tangent to the guide's profile has no slip; the slip of eq.
    (21) vanishes where the circle has none. Between both points eq. (25) turns the shear obliquely,
    and the stress at the point without slip grows as a logarithm without bound.

    Parameters
    ----------
    a : ndarray, shape (n,)
        Lateral semi-axis [mm].
    sine, cosine : ndarray, shape (n,)
        Of the signed contact angle.
    radius, shift : ndarray, shape (n,)
        r_C,G and r_Delta0 [mm].

    Returns
    -------
    ndarray, shape (n,)
        0 where the pole lies outside the patch, inf where a second zero lies inside.
    """
    with np.errstate(invalid="ignore"):
        pole = pole_lateral(shift, sine)
        zero, other = slip_zeros(sine, cosine, radius, shift)
        split = np.where((np.abs(pole) < a) & (np.abs(zero) < a), np.abs(zero - pole) / a, 0.0)
        return np.where(np.abs(other) < a, np.inf, split)
