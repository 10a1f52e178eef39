"""Closed forms for stresses in a half-space and one independent quadrature, as references for tests.

Conventions as in `trackroller/halfspace/stress.py`: z into the body, tractions on the body, components in the order
(sigma_x, sigma_y, sigma_z, tau_xy, tau_yz, tau_xz). Lengths in mm, stresses in MPa; arrays broadcast.
Sources: Love 1929 (Phil. Trans. A 228, 377); Johnson 1985 (Contact Mechanics, ch. 3 and 4); Hamilton 1983 (Proc. IMechE
197C, 53); Sackfield & Hills 1983 (J. Strain Anal. 18, 101 and 107).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ellipeinc, ellipkinc

from trackroller.halfspace.kernels import point_kernel

Array = NDArray[np.float64]


def _six(shape: tuple[int, ...], **parts: Array | float) -> Array:
    names = ("xx", "yy", "zz", "xy", "yz", "xz")
    out = np.zeros((*shape, 6))
    for name, value in parts.items():
        out[..., names.index(name)] = value
    return out


def hertz_circle_axis(z: ArrayLike, radius: float, max_pressure: float, poisson_ratio: float) -> Array:
    """Return the stress (..., 6) at depths z (...) below a circular Hertz pressure (Johnson 1985, eq. 3.45)."""
    s = np.asarray(z, dtype=float) / radius
    angle = np.arctan2(1.0, s)
    axial = -max_pressure / (1.0 + s * s)
    radial = -max_pressure * ((1.0 + poisson_ratio) * (1.0 - s * angle) - 0.5 / (1.0 + s * s))
    return _six(s.shape, xx=radial, yy=radial, zz=axial)


def hertz_circle_surface(x: ArrayLike, y: ArrayLike, radius: float, max_pressure: float, poisson_ratio: float) -> Array:
    """Return the stress (..., 6) on the surface of a circular Hertz pressure (Johnson 1985, eqs. 3.42-3.43)."""
    xa, ya = np.broadcast_arrays(np.asarray(x, dtype=float) / radius, np.asarray(y, dtype=float) / radius)
    r2 = xa**2 + ya**2
    p = np.sqrt(np.clip(1.0 - r2, 0.0, None))
    # (1 - p^3)/r^2 written with p, so that r = 0 is regular: 1 - p^2 = r^2 inside
    shape = np.where(r2 <= 1.0, (1.0 + p + p * p) / (1.0 + p), 1.0 / np.maximum(r2, 1.0))
    spread = (1.0 - 2.0 * poisson_ratio) / 3.0 * shape
    radial, hoop = spread - p, -spread - 2.0 * poisson_ratio * p
    r = np.sqrt(r2)
    c, s = np.where(r > 0, xa / np.where(r > 0, r, 1.0), 1.0), np.where(r > 0, ya / np.where(r > 0, r, 1.0), 0.0)
    return max_pressure * _six(
        r2.shape, xx=radial * c * c + hoop * s * s, yy=radial * s * s + hoop * c * c, zz=-p, xy=(radial - hoop) * c * s
    )


def sliding_circle_surface(x: ArrayLike, y: ArrayLike, radius: float, max_shear: float, poisson_ratio: float) -> Array:
    """Return the surface stress (..., 6) inside a circle under q_x = max_shear sqrt(1 - r^2/a^2) (Hamilton 1983).

    This is the tangential part only: add `hertz_circle_surface` for the pressure. NaN outside the circle.
    """
    xa, ya = np.broadcast_arrays(np.asarray(x, dtype=float) / radius, np.asarray(y, dtype=float) / radius)
    r2 = xa**2 + ya**2
    inside = np.where(r2 <= 1.0, max_shear, np.nan)
    return _six(
        r2.shape,
        xx=-inside * np.pi / 2.0 * (1.0 + poisson_ratio / 4.0) * xa,
        yy=-inside * 3.0 * np.pi / 8.0 * poisson_ratio * xa,
        xy=-inside * np.pi / 8.0 * (2.0 - poisson_ratio) * ya,
        xz=-inside * np.sqrt(np.clip(1.0 - r2, 0.0, None)),
    )


def sliding_circle_axis(z: ArrayLike, radius: float, max_shear: float) -> Array:
    """Return the stress (..., 6), tau_xz alone, below the centre of q_x = max_shear sqrt(1 - r^2/a^2) (Hamilton)."""
    s = np.asarray(z, dtype=float) / radius
    return _six(s.shape, xz=-max_shear * (1.0 - 1.5 * s * np.arctan2(1.0, s) + 0.5 * s * s / (1.0 + s * s)))


def hertz_ellipse_centre(semi_axis_x: float, semi_axis_y: float, max_pressure: float, poisson_ratio: float) -> Array:
    """Return the stress (6,) at the surface centre of an elliptical Hertz pressure (Johnson 1985, eq. 4.47)."""
    a, b, nu = semi_axis_x, semi_axis_y, poisson_ratio
    xx = -(2.0 * nu + (1.0 - 2.0 * nu) * b / (a + b))
    yy = -(2.0 * nu + (1.0 - 2.0 * nu) * a / (a + b))
    return max_pressure * _six((), xx=xx, yy=yy, zz=-1.0)


def hertz_ellipse_axis(
    z: ArrayLike, semi_axis_x: float, semi_axis_y: float, max_pressure: float, poisson_ratio: float
) -> Array:
    """Return the stress (..., 6) below the centre of an elliptical Hertz pressure (Johnson 1985, eq. 4.46).

    See also Sackfield & Hills 1983. The semi-axes may have either order; semi-axes equal within 1e-3 raise ValueError,
    because the form is 0/0 there: use `hertz_circle_axis`.
    """
    if abs(semi_axis_x - semi_axis_y) < 1e-3 * semi_axis_x:
        raise ValueError("semi-axes (nearly) equal: use hertz_circle_axis")
    a, b = max(semi_axis_x, semi_axis_y), min(semi_axis_x, semi_axis_y)
    s = np.asarray(z, dtype=float) / a
    e2, ratio2 = 1.0 - (b / a) ** 2, (a / b) ** 2
    t = np.sqrt(((b / a) ** 2 + s * s) / (1.0 + s * s))
    phi = np.arctan2(1.0, s)
    first, second = ellipkinc(phi, e2), ellipeinc(phi, e2)
    long_a = -0.5 * (1.0 - t) + s * (first - second)
    long_b = 1.0 - ratio2 * t + s * (ratio2 * second - first)
    short_a = 0.5 * (1.0 + 1.0 / t) - ratio2 * t + s * (ratio2 * second - first)
    short_b = -1.0 + t + s * (first - second)
    scale = 2.0 * b / (e2 * a) * max_pressure
    along, across = scale * (long_a + poisson_ratio * long_b), scale * (short_a + poisson_ratio * short_b)
    zz = -0.5 * scale * (1.0 - t * t) / t
    xx, yy = (along, across) if semi_axis_x > semi_axis_y else (across, along)
    return _six(s.shape, xx=xx, yy=yy, zz=zz)


def rectangle_corner_sigma_z(z: ArrayLike, side_x: float, side_y: float, pressure: float) -> Array:
    """Return sigma_z (...) at depths z (...) below a corner of a rectangle under uniform pressure (Love 1929)."""
    z = np.asarray(z, dtype=float)
    a, b = side_x, side_y
    r = np.sqrt(a * a + b * b + z * z)
    return (
        -pressure
        / (2.0 * np.pi)
        * (np.arctan2(a * b, z * r) + a * b * z / r * (1.0 / (a * a + z * z) + 1.0 / (b * b + z * z)))
    )


def rectangle_centre(side_x: float, side_y: float, pressure: float, poisson_ratio: float) -> Array:
    """Return the stress (6,) at the surface centre of a rectangle under uniform pressure (Johnson 1985, eq. 3.25)."""
    nu = poisson_ratio
    xx = -(2.0 * nu + 2.0 / np.pi * (1.0 - 2.0 * nu) * np.arctan2(side_y, side_x))
    yy = -(2.0 * nu + 2.0 / np.pi * (1.0 - 2.0 * nu) * np.arctan2(side_x, side_y))
    return pressure * _six((), xx=xx, yy=yy, zz=-1.0)


_point_kernel = np.vectorize(point_kernel, otypes=[float] * 36)


def quadrature_on_ellipse(
    tractions: Callable[[Array, Array], tuple[Array, Array, Array]],
    semi_axis_x: float,
    semi_axis_y: float,
    point: tuple[float, float, float],
    poisson_ratio: float,
    nodes: int = 64,
) -> Array:
    """Return the stress (6,) at one point by Gauss quadrature of the point-force kernels over an ellipse.

    The quadrature is slow and independent of the other methods. It uses polar coordinates about (x, y), with
    r = z sinh(u), which widens the peak of the kernel, and u = u_max (1 - (1 - t)^2) for the square-root edge of
    Hertzian tractions. The error falls exponentially with `nodes`.

    Parameters
    ----------
    tractions : function of x, y [mm] that returns q_x, q_y, q_z [MPa], smooth inside the ellipse
    semi_axis_x, semi_axis_y : of the ellipse [mm]
    point : x, y inside the ellipse and z > 0 [mm]
    poisson_ratio : of the body [1]
    nodes : Gauss points

    Raises
    ------
    ValueError : a point at the surface or outside the ellipse
    """
    x, y, z = point
    a, b = semi_axis_x, semi_axis_y
    if z <= 0.0 or (x / a) ** 2 + (y / b) ** 2 >= 1.0:
        raise ValueError("the point must lie below the inside of the ellipse, z > 0")
    g, w = np.polynomial.legendre.leggauss(nodes)
    t, wt = 0.5 * (g + 1.0), 0.5 * w
    n_angle = 4 * nodes
    scaled = 2.0 * np.pi * (np.arange(n_angle) + 0.5) / n_angle  # equal steps on the circle the ellipse is made of
    c, s = np.cos(scaled) * a, np.sin(scaled) * b
    stretch = c * c + s * s
    d_angle = a * b / stretch * 2.0 * np.pi / n_angle
    c, s = c / np.sqrt(stretch), s / np.sqrt(stretch)
    k2, k1, k0 = (c / a) ** 2 + (s / b) ** 2, x * c / a**2 + y * s / b**2, (x / a) ** 2 + (y / b) ** 2 - 1.0
    u_max = np.arcsinh((-k1 + np.sqrt(k1 * k1 - k2 * k0)) / k2 / z)
    u = u_max[:, None] * (1.0 - (1.0 - t) ** 2)
    du = u_max[:, None] * 2.0 * (1.0 - t) * wt
    r = z * np.sinh(u)
    weight = r * z * np.cosh(u) * du * d_angle[:, None]
    xi, eta = x + r * c[:, None], y + r * s[:, None]
    kernels = np.array(_point_kernel(x - xi, y - eta, z)).reshape(2, 3, 6, *r.shape)
    q = np.array(np.broadcast_arrays(*tractions(xi, eta), r)[:3]) * weight
    return np.einsum("lij,lcij->c", q, kernels[0] + poisson_ratio * kernels[1])
