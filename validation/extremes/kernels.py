"""Compare kernels at places of cancellation with the same quantities in 50 digits (mpmath)."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import mpmath
import numpy as np

from trackroller.contact.hertz import axis_ratio
from trackroller.contact.influence import displacements, pressure_displacements
from trackroller.contact.quantities import Ellipse
from trackroller.contact.sliding import integrals
from trackroller.contact.slip import Slip
from trackroller.halfspace.ellipse import patch_rows, stress_parts
from trackroller.halfspace.stress import von_mises

DIGITS = 50


@dataclass(frozen=True)
class KernelError:
    """Relative errors of a kernel along a quantity."""

    name: str
    quantity: str
    values: tuple[float, ...]
    errors: tuple[float, ...]
    tolerance: float
    against: str = f"{DIGITS} digits"

    @property
    def holds(self) -> bool:
        """Return whether all errors are tolerated."""
        return max(self.errors) <= self.tolerance


def _digits(function: Callable[[], KernelError]) -> Callable[[], KernelError]:
    @functools.wraps(function)
    def inner() -> KernelError:

        with mpmath.workdps(DIGITS):
            return function()

    return inner


def _curvature_ratio(kappa):
    """Return the smaller over the larger curvature of an ellipse of axis ratio kappa, by Johnson (4.26) and mpmath."""
    m = 1 - kappa**2
    if m == 0:
        return mpmath.mpf(1)
    k, e = mpmath.ellipk(m), mpmath.ellipe(m)
    return kappa**2 * (k - e) / (e - (1 - m) * k)


@_digits
def axis_ratios() -> KernelError:
    """Compare axis ratios from 1e-6 to 1 - 1e-12 with the ratios from which the curvatures were made."""

    values = (1e-6, 1e-4, 1e-3, 1e-2, 0.1, 0.5, 0.9, 1 - 1e-3, 1 - 1e-6, 1 - 1e-9, 1 - 1e-12)
    found = axis_ratio(np.array([float(_curvature_ratio(mpmath.mpf(v))) for v in values]))
    errors = tuple(float(abs(f / v - 1)) for f, v in zip(found, values, strict=True))
    return KernelError("axis ratio of the ellipse", "b/a", values, errors, 1e-12)


def _on_axis(z):
    """Return sigma_z and sigma_r (nu = 0.3) below a circular Hertz pressure, Johnson (3.45), at z over the radius."""

    tail = 1 / (2 * (1 + z * z))
    angle = z * mpmath.atan(1 / z) if z else mpmath.mpf(0)
    return -2 * tail, -(mpmath.mpf(13) / 10) * (1 - angle) + tail


@_digits
def depth() -> KernelError:
    """Return the errors of stresses under the centre of a circle, from the surface to a million radii."""

    values = (0.0, 1e-12, 1e-8, 1e-4, 1e-2, 0.5, 1.0, 2.9, 3.1, 30.0, 1e3, 1e6)
    one = np.ones(1)
    patch = patch_rows(Ellipse(one, one, one), Slip(one / 2, one * 0.75**0.5, one * 6, one * 16, one), 0 * one, 2)[0]
    parts = stress_parts(patch, np.array([[0.0, 0.0, v] for v in values]), 48, 48)
    stress = parts[:, 0] + 0.3 * parts[:, 1]
    errors = []
    for v, s in zip(values, stress, strict=True):
        exact_z, exact_r = (float(e) for e in _on_axis(mpmath.mpf(v)))
        errors.append(max(abs(s[2] - exact_z), abs(s[0] - exact_r)) / max(abs(exact_z), abs(exact_r)))
    return KernelError("plane waves and far field on the axis", "z/a", values, tuple(map(float, errors)), 1e-9)


@_digits
def surface_centre() -> KernelError:
    """Return the error of stresses at the surface centre of slender ellipses, Johnson (4.47).

    There sigma_x = -(2 nu + (1 - 2 nu) b/(a + b)) p_0.
    """
    values = (1e-3, 1e-2, 0.1, 0.5, 1.0, 2.0, 10.0, 1e2, 1e3)
    errors = []
    for ratio in values:  # b/a
        a, b, one = np.ones(1), np.full(1, ratio), np.ones(1)
        slip = Slip(one / 2, one * 0.75**0.5, one * 6, one * 16, one)
        parts = stress_parts(patch_rows(Ellipse(a, b, one), slip, 0 * one, 2)[0], np.zeros((1, 3)), 144, 144)
        s = parts[0, 0] + 0.3 * parts[0, 1]
        exact = -np.array([0.6 + 0.4 * ratio / (1 + ratio), 0.6 + 0.4 / (1 + ratio)])
        errors.append(float(np.max(np.abs(s[:2] - exact) / np.abs(exact))))
    return KernelError("plane waves at the surface of slender ellipses", "b/a", values, tuple(errors), 1e-8)


def pole_positions() -> KernelError:
    """Compare the sliding forces of 12 points with those of 600; poles at the centre, on the edge and far outside."""
    values = (0.0, 1e-12, 1e-6, 0.3, 0.999999, 1.0, 1.000001, 3.0, 1e3, 1e6, 1e12)
    n, sine = np.ones(len(values)), 0.5
    ellipse = Ellipse(n, 0.5 * n, n)
    # a nearly flat guide: the pole of the spin is then that of the slip
    slip = Slip(sine * n, 0.75**0.5 * n, 1e9 * n, 16.0 * n, np.array(values) * sine)
    coarse, fine = (integrals(ellipse, slip, 0.3 * n, nodes=k).resultants for k in (12, 600))
    scale = 0.3 * ellipse.normal_force
    gaps = [
        np.abs(getattr(coarse, f) - getattr(fine, f)) / scale for f in ("lateral_force", "driving_force", "spin_moment")
    ]
    worst = tuple(map(float, np.max(gaps, axis=0)))
    return KernelError("sliding integrals, 12 points", "x_spin/a", values, worst, 1e-5, "600 points")


def far_pole() -> KernelError:
    """Compare the driving force for poles far outside with the series of F_A in powers of b over the distance."""
    values = (1e3, 1e6, 1e9, 1e12)
    n = np.ones(len(values))
    ellipse = Ellipse(n, 0.5 * n, n)
    slip = Slip(0.5 * n, 0.75**0.5 * n, 1e15 * n, 16.0 * n, np.array(values) * 0.5)
    r = integrals(ellipse, slip, 0.3 * n, nodes=16).resultants
    bound = 0.3 * ellipse.normal_force
    # int tau_y = -mu F_N (1 - <y^2>/(2 x_p^2)) with <y^2> = b^2/5 of the Hertzian pressure
    exact = -bound * (1 - 0.25 / 5 / (2 * np.array(values) ** 2))
    errors = np.abs(r.driving_force / exact - 1)
    return KernelError("sliding integrals, far pole", "x_spin/a", values, tuple(map(float, errors)), 1e-9, "its series")


def _corners(x: Any, y: Any, nu: Any) -> list[Any]:
    """Return antiderivatives of Kalker's influence functions at a corner."""
    along_y = x * mpmath.asinh(y / abs(x))
    along_x = y * mpmath.asinh(x / abs(y))
    r = mpmath.hypot(x, y)
    log = mpmath.log(r)
    return [
        along_y * (1 - nu) + along_x,
        along_x * (1 - nu) + along_y,
        -nu * r,
        y * log + x * mpmath.atan(y / x),
        x * log + y * mpmath.atan(x / y),
    ]


def _over_element(hx: Any, hy: Any, nu: Any, place: tuple[int, int]) -> list[float]:
    """Return the displacements xx, yy, xy by shear and x, y by pressure of uniform loads on the element `place`."""
    (x0, x1), (y0, y1) = (((k - 0.5) * h, (k + 0.5) * h) for k, h in zip(place, (hx, hy), strict=True))
    four = [_corners(x, y, nu) for x, y in ((x1, y1), (x0, y1), (x1, y0), (x0, y0))]
    total = [(a - b - c + d) / mpmath.pi for a, b, c, d in zip(*four, strict=True)]
    return [float(t) for t in (*total[:3], -total[3], -total[4])]


def _influence_error(hx: float, hy: float, place: tuple[int, int]) -> float:
    """Return the error at a place, relative to the largest displacement of its kind: by tractions, or by pressure."""
    i, j = place
    n = max(i, j) + 1
    found = [
        *displacements(hx, hy, 0.3, n, n, 0, 0)[:, j + n - 1, i + n - 1],
        *pressure_displacements(hx, hy, n, n, 0, 0)[:, j + n - 1, i + n - 1],
    ]
    exact = _over_element(mpmath.mpf(hx), mpmath.mpf(hy), mpmath.mpf(0.3), place)
    gap = [abs(float(v) - e) for v, e in zip(found, exact, strict=True)]
    sizes = max(map(abs, exact[:3])), max(map(abs, exact[3:])) or np.inf
    return max(max(gap[:3]) / sizes[0], max(gap[3:]) / sizes[1])


@_digits
def kalker_distance() -> KernelError:
    """Check Kalker's influence functions of square elements from the element itself to 400 elements away."""
    values = (0, 1, 2, 5, 10, 30, 100, 400)
    errors = tuple(_influence_error(0.05, 0.05, (v, v)) for v in values)
    return KernelError("Kalker's influence functions", "distance in elements", values, errors, 1e-9)


@_digits
def kalker_edges() -> KernelError:
    """Check Kalker's influence functions of slender elements, beside the element and along its edges."""
    values = (1e-3, 1e-2, 0.1, 1.0, 10.0, 1e2, 1e3)
    places = ((1, 0), (0, 1), (3, 2), (40, 0), (0, 40))
    errors = tuple(max(_influence_error(0.05, 0.05 * v, place) for place in places) for v in values)
    return KernelError("Kalker's influence functions, slender elements", "h_y/h_x", values, errors, 1e-9)


@_digits
def von_mises_near_hydrostatic() -> KernelError:
    """Return the error of the von Mises stress of a nearly hydrostatic state, over its largest stress.

    Only the digits of the input are lost.
    """
    values = (1e-1, 1e-3, 1e-5, 1e-7, 1e-9)
    state = np.array([[-1.0, -1.0 + v, -1.0 - v, v, 0.0, 0.0] for v in values])
    exact = np.array(values) * 6**0.5
    errors = np.abs(von_mises(state) - exact)
    errors = tuple(map(float, errors))
    name = "von Mises stress near a hydrostatic state"
    return KernelError(name, "difference of stresses", values, errors, 1e-14, "closed form")


KERNELS = (
    axis_ratios,
    depth,
    surface_centre,
    pole_positions,
    far_pole,
    kalker_distance,
    kalker_edges,
    von_mises_near_hydrostatic,
)
