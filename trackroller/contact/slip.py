"""Parts of the rigid slip: the turning of a curved guide, a drawn contour, and the poles of the sliding model."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from trackroller.contact.cross_sections import CrossSection

STEPS = 60  # most of Newton's method; four or five are usual
FLATTEST = 0.05  # of the guide's contour against the radial direction, as its sine is followed


def turning_of(curve_radius: np.ndarray, profile_radius: np.ndarray, cosine: np.ndarray) -> np.ndarray:
    """How far a roller that follows the guide's curve turns per distance travelled [1/mm], shape (n,).

    1/(r_Curve + r_C,G cos(alpha)): the points of contact travel on a circle of that radius about the axis of the
    curve, the carrier of the roller turns with them, and the roller turns against the guide by both rotations.
    0 on a straight guide, < 0 on a concave one; NaN where the contact lies beyond the axis of a concave guide.

    Parameters
    ----------
    curve_radius : r_Curve [mm], signed, inf if straight; profile_radius : r_C,G [mm]; cosine : of alpha [1]
    """
    radius = curve_radius + profile_radius * cosine
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(radius * np.sign(curve_radius) > 0.0, 1.0 / radius, np.nan)


def contour_over_tangent(guide: CrossSection, alpha: float) -> Callable[[np.ndarray], np.ndarray]:
    """The guide's own shape in eq. (20): radial height over its tangent at lateral positions x (m,), outward [mm].

    The position of a point (u, h) of the contour across the roller is u cos(alpha) + h sin(alpha), which eq. (20) has
    as x cos(alpha), and its radial one h cos(alpha) - u sin(alpha). For the circle this is eq. (20) itself.

    Parameters
    ----------
    guide : cross-section over the tangent plane; alpha : contact angle [rad]
    """
    tangent, sine, cosine = np.tan(alpha), np.sin(alpha), np.cos(alpha)
    low, high = guide.limits

    def height(x: np.ndarray) -> np.ndarray:
        u = np.clip(x, low, high)
        for _ in range(STEPS):
            rise = np.maximum(1.0 + tangent * guide.slope(u), FLATTEST)
            change = (u + tangent * guide.full_height(u) - x) / rise
            u = np.clip(u - change, low, high)
            if np.max(np.abs(change), initial=0.0) <= 1e-14 * (1.0 + np.max(np.abs(x), initial=0.0)):
                break
        return guide.full_height(u) * cosine - u * sine + x * sine

    return height


def pole_split(
    a: np.ndarray, sine: np.ndarray, cosine: np.ndarray, radius: np.ndarray, shift: np.ndarray
) -> np.ndarray:
    """Distance between the model's spin pole and where its slip vanishes, over a; shape (n,).

    The pole of eq. (22) lies where the tangent to the guide's profile has no slip, the slip of eq. (21) vanishes where
    the circle has none. Between them the empirical rule lets the shear turn askew, and the stress where the slip
    vanishes grows as a logarithm without bound. 0 where the pole lies outside the patch; inf for a second zero in it.

    Parameters
    ----------
    a : lateral semi-axis [mm]; sine, cosine : of the signed contact angle [1]; radius : r_C,G [mm]; shift : [mm]
    """
    with np.errstate(invalid="ignore"):
        pole = shift / sine
        product = 2.0 * radius * cosine * shift - shift * shift
        root = np.sqrt(radius * radius * sine * sine + product)
        reach = root + radius * np.abs(sine)
        zero, other = np.sign(sine) * product / reach / cosine, reach / cosine
        split = np.where((np.abs(pole) < a) & (np.abs(zero) < a), np.abs(zero - pole) / a, 0.0)
        return np.where(other < a, np.inf, split)
