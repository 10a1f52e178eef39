"""Hertzian point contact: exact by complete elliptic integrals, or the published table.

Source: Johnson 1985, *Contact Mechanics*, ch. 4.2; the table is the one of Wenzel et al. 2022.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import elliprd

from trackroller.contact.quantities import Ellipse
from trackroller.errors import InputError
from trackroller.numerics.rows import Rows

# Table of the published program: xi and eta over cos tau = |k_x - k_y|/(k_x + k_y).
PUBLISHED_COS_TAU = np.array(
    [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99, 0.995, 0.9995]
)
PUBLISHED_XI = np.array(
    [1.07, 1.15, 1.24, 1.35, 1.48, 1.66, 1.91, 2.3, 3.09, 4.12, 7.76, 10.15, 23.95]
)
PUBLISHED_ETA = np.array(
    [0.938, 0.879, 0.824, 0.771, 0.718, 0.664, 0.607, 0.544, 0.461, 0.396, 0.287, 0.251, 0.163]
)


@dataclass(frozen=True)
class HertzShape(Rows):
    """Semi-axes a, b and largest pressure p_max for a unit normal force; all three scale with
    F_N^(1/3).

    They follow from geometry and material. Arrays of shape (n,): `lateral` and `rolling` [mm
    N^(-1/3)], `pressure` [MPa N^(-1/3)].
    """

    lateral: np.ndarray
    rolling: np.ndarray
    pressure: np.ndarray

    def at(self, normal_force: np.ndarray) -> Ellipse:
        """Return the ellipses under `normal_force` (n,) [N]."""
        root = np.cbrt(normal_force)
        return Ellipse(self.lateral * root, self.rolling * root, self.pressure * root)


def contact_modulus(e_1, nu_1, e_2, nu_2) -> np.ndarray:
    """Return the contact modulus E*, 1/E* = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2.

    Parameters
    ----------
    e_1 : array_like
        Young's modulus of body 1 [MPa].
    nu_1 : array_like
        Poisson's ratio of body 1 [1].
    e_2 : array_like
        Young's modulus of body 2 [MPa].
    nu_2 : array_like
        Poisson's ratio of body 2 [1].

    Returns
    -------
    numpy.ndarray
        Contact modulus [MPa], in the shape to which the parameters broadcast.

    Examples
    --------
    >>> round(float(contact_modulus(210e3, 0.3, 210e3, 0.3)))
    115385
    """
    return np.asarray(1.0 / ((1 - nu_1**2) / e_1 + (1 - nu_2**2) / e_2))


def _elliptic(m_1: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return B = (E - (1-m) K)/m and D = (K - E)/m by Carlson's integrals, without cancellation for
    m -> 0.

    The argument is the complement m_1 = 1 - m = (b/a)^2, which keeps digits for very slender
    ellipses.
    """
    zero, one = np.zeros_like(m_1), np.ones_like(m_1)
    return elliprd(zero, one, m_1) / 3.0 * m_1, elliprd(zero, m_1, one) / 3.0


def axis_ratio(curvature_ratio: np.ndarray) -> np.ndarray:
    """Return the ratio of minor to major axis of the contact ellipse, (n,).

    Solves A/B = (b/a)^2 D / B~ with D = (K - E)/m, B~ = (E - (1-m) K)/m, m = 1 - (b/a)^2: Johnson
    (4.26).

    Parameters
    ----------
    curvature_ratio : numpy.ndarray, shape (n,)
        Smaller over larger relative curvature, in (0, 1].

    Notes
    -----
    Newton's method on the logarithm, kept within bounds; relative error below 1e-14 for ratios down
    to 1e-12.
    """
    target = np.log(np.asarray(curvature_ratio, dtype=float))
    x = target * (2.0 / 3.0)  # log(b/a); (A/B) ~ (b/a)^1.5 near the circle
    low, high = 2.0 * target - 1.0, np.zeros_like(target)

    def mismatch(x: np.ndarray) -> np.ndarray:
        b, d = _elliptic(np.exp(2 * x))
        return 2 * x + np.log(d) - np.log(b) - target

    step = 1e-5
    done = np.zeros(target.shape, dtype=bool)
    for _ in range(60):
        f, ahead, behind = mismatch(np.stack((x, x + step, x - step)))
        high = np.where(f > 0, np.minimum(high, x), high)
        low = np.where(f <= 0, np.maximum(low, x), low)
        new = x - f / ((ahead - behind) / (2 * step))
        new = np.where((new > low) & (new < high), new, np.where(f == 0, x, (low + high) / 2))
        # the last digit of a solved ratio must not depend on the other rows
        new = np.where(done, x, new)
        done |= np.abs(new - x) <= 2e-15 * np.maximum(1.0, np.abs(x))
        x = new
        if done.all():
            break
    return np.exp(np.minimum(x, 0.0))


def _unique_axis_ratio(ratio: np.ndarray) -> np.ndarray:
    # a parameter grid has few different curvature ratios: solve each of them once
    unique, inverse = np.unique(ratio, return_inverse=True)
    return axis_ratio(unique)[inverse]


def exact_shape(k_x: np.ndarray, k_y: np.ndarray, modulus: np.ndarray) -> HertzShape:
    """Return the exact Hertz shape.

    The longer axis lies in the plane of the smaller curvature; k_x = k_y gives a circle.

    Parameters
    ----------
    k_x, k_y : numpy.ndarray, shape (n,)
        Relative curvatures in the lateral and the rolling plane, > 0 [1/mm].
    modulus : numpy.ndarray, shape (n,)
        Contact modulus E* [MPa].

    Returns
    -------
    HertzShape
        Semi-axes and largest pressure for a unit normal force.

    Examples
    --------
    >>> one = np.ones(1)
    >>> circle = exact_shape(0.1 * one, 0.1 * one, 115e3 * one)
    >>> bool(np.isclose(circle.lateral[0], (0.75 / (115e3 * 0.1)) ** (1 / 3)))
    True
    """
    k_x, k_y, modulus = np.broadcast_arrays(
        *(np.asarray(v, dtype=float) for v in (k_x, k_y, modulus))
    )
    small, large = np.minimum(k_x, k_y), np.maximum(k_x, k_y)
    kappa = _unique_axis_ratio(small / large)
    _, d = _elliptic(kappa**2)
    # Johnson (4.25): small/2 = (p0/E*) (b/a^2) D with p0 = 3F/(2 pi a b)
    major = np.cbrt(3.0 * d / (np.pi * modulus * small))
    return _laid(major, kappa * major, k_x <= k_y)


def unit_approach(k_x: np.ndarray, k_y: np.ndarray, modulus: np.ndarray) -> np.ndarray:
    """Return the approach of two bodies under a unit normal force; it scales with F_N^(2/3).

    Parameters
    ----------
    k_x, k_y, modulus : numpy.ndarray, shape (n,)
        See `exact_shape`.

    Returns
    -------
    numpy.ndarray
        Approach [mm N^(-2/3)], shape (n,): 3 K(e)/(2 pi a E*) with the semi-major axis a, Johnson
        (4.26c).

    Examples
    --------
    >>> one = np.ones(1)
    >>> sphere = unit_approach(0.1 * one, 0.1 * one, 115e3 * one)  # a^2/R
    >>> bool(np.isclose(sphere[0], 0.1 * (0.75 / (115e3 * 0.1)) ** (2 / 3)))
    True
    """
    shape = exact_shape(k_x, k_y, modulus)
    major, minor = (
        np.maximum(shape.lateral, shape.rolling),
        np.minimum(shape.lateral, shape.rolling),
    )
    b, d = _elliptic((minor / major) ** 2)
    return np.asarray(1.5 * (b + d) / (np.pi * major * modulus))  # K = B + D


def _laid(major: np.ndarray, minor: np.ndarray, wide: np.ndarray) -> HertzShape:
    """Return the shape with the major axis in the lateral direction where `wide`, else in the
    rolling direction.
    """
    pressure = 3.0 / (2.0 * np.pi * major * minor)
    return HertzShape(np.where(wide, major, minor), np.where(wide, minor, major), pressure)


def published_shape(k_x: np.ndarray, k_y: np.ndarray, modulus: np.ndarray) -> HertzShape:
    """Return the Hertz shape by linear interpolation in the table of the published program.

    The published program puts the long axis on x_C even for k_x > k_y; this function puts it on y_C
    there.

    Parameters
    ----------
    k_x, k_y, modulus : numpy.ndarray, shape (n,)
        See `exact_shape`.

    Returns
    -------
    HertzShape
        Semi-axes and largest pressure for a unit normal force.

    Notes
    -----
    Valid for 0.1 <= cos tau <= 0.9995; rows outside this range are NaN.
    """
    k_x, k_y, modulus = np.broadcast_arrays(
        *(np.asarray(v, dtype=float) for v in (k_x, k_y, modulus))
    )
    k_sum = k_x + k_y
    cos_tau = np.abs(k_x - k_y) / k_sum
    xi = np.interp(cos_tau, PUBLISHED_COS_TAU, PUBLISHED_XI, left=np.nan, right=np.nan)
    eta = np.interp(cos_tau, PUBLISHED_COS_TAU, PUBLISHED_ETA, left=np.nan, right=np.nan)
    size = np.cbrt(3.0 * (0.5 / modulus) / k_sum)
    return _laid(xi * size, eta * size, k_x <= k_y)


def shape(k_x, k_y, modulus, hertz: str = "exact") -> HertzShape:
    """Return the shape of Hertz's ellipses by the exact or by the published method.

    Parameters
    ----------
    k_x : array_like, shape (n,)
        Relative curvature in the lateral plane, > 0 [1/mm].
    k_y : array_like, shape (n,)
        Relative curvature in the rolling plane, > 0 [1/mm].
    modulus : array_like, shape (n,)
        Contact modulus E* [MPa].
    hertz : str
        'exact' for `exact_shape`, 'published' for `published_shape`.

    Returns
    -------
    HertzShape
        Semi-axes and largest pressure for a unit normal force, arrays (n,).

    Raises
    ------
    InputError
        If `hertz` is neither 'exact' nor 'published'.
    """
    if hertz == "exact":
        return exact_shape(k_x, k_y, modulus)
    if hertz == "published":
        return published_shape(k_x, k_y, modulus)
    raise InputError("hertz", hertz, "'exact' or 'published'", "Choose one of these two.")
