"""Kernels where cancellation lurks against the same quantities in 50 digits (mpmath)."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from trackroller.contact.common import Ellipse, Slip
from trackroller.contact.hertz import axis_ratio
from trackroller.contact.sliding import resultants
from trackroller.halfspace.ellipse import patch_rows, stress_parts

DIGITS = 50


@dataclass(frozen=True)
class KernelError:
    """Relative errors of a kernel along a quantity."""

    name: str
    quantity: str
    values: tuple[float, ...]
    errors: tuple[float, ...]
    tolerance: float

    @property
    def holds(self) -> bool:
        """Are all errors tolerated?"""
        return max(self.errors) <= self.tolerance


def _digits(function: Callable[[], KernelError]) -> Callable[[], KernelError]:
    @functools.wraps(function)
    def inner() -> KernelError:
        import mpmath

        with mpmath.workdps(DIGITS):
            return function()

    return inner


def _curvature_ratio(kappa):
    """Smaller over larger curvature of a Hertzian ellipse of axis ratio kappa, Johnson (4.26), in many digits."""
    import mpmath

    m = 1 - kappa**2
    if m == 0:
        return mpmath.mpf(1)
    k, e = mpmath.ellipk(m), mpmath.ellipe(m)
    return kappa**2 * (k - e) / (e - (1 - m) * k)


@_digits
def axis_ratios() -> KernelError:
    """Axis ratio of the ellipse from 1e-6 to 1 - 1e-12: the ratio put in must come out."""
    import mpmath

    values = (1e-6, 1e-4, 1e-3, 1e-2, 0.1, 0.5, 0.9, 1 - 1e-3, 1 - 1e-6, 1 - 1e-9, 1 - 1e-12)
    found = axis_ratio(np.array([float(_curvature_ratio(mpmath.mpf(v))) for v in values]))
    errors = tuple(float(abs(f / v - 1)) for f, v in zip(found, values, strict=True))
    return KernelError("axis ratio of the ellipse", "b/a", values, errors, 1e-12)


def _on_axis(z):
    """Stresses sigma_z and sigma_r (nu = 0.3) below a circular Hertz pressure, Johnson (3.45), z over radius."""
    import mpmath

    tail = 1 / (2 * (1 + z * z))
    angle = z * mpmath.atan(1 / z) if z else mpmath.mpf(0)
    return -2 * tail, -(mpmath.mpf(13) / 10) * (1 - angle) + tail


@_digits
def depth() -> KernelError:
    """Stresses under the centre of a circle from the surface to a million radii."""
    import mpmath

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
    """Stresses at the centre of slender ellipses, Johnson (4.47): sigma_x from -(2 nu + (1 - 2 nu) b/(a + b)) p_0."""
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


@_digits
def pole_positions() -> KernelError:
    """Sliding forces with the pole at the centre, on the edge and far outside, 12 points against 600."""
    values = (0.0, 1e-12, 1e-6, 0.3, 0.999999, 1.0, 1.000001, 3.0, 1e3, 1e6, 1e12)
    n, sine = np.ones(len(values)), 0.5
    ellipse = Ellipse(n, 0.5 * n, n)
    # a nearly flat guide: the pole of the spin is then that of the slip
    slip = Slip(sine * n, 0.75**0.5 * n, 1e9 * n, 16.0 * n, np.array(values) * sine)
    coarse, fine = (resultants(ellipse, slip, 0.3 * n, nodes=k) for k in (12, 600))
    scale = 0.3 * ellipse.normal_force
    gaps = [np.abs(getattr(coarse, f) - getattr(fine, f)) / scale
            for f in ("lateral_force", "driving_force", "spin_moment")]  # fmt: skip
    worst = tuple(map(float, np.max(gaps, axis=0)))
    return KernelError("sliding integrals, 12 points", "x_spin/a", values, worst, 1e-5)


@_digits
def far_pole() -> KernelError:
    """Driving force with the pole far outside against the series of F_A in powers of b over its distance."""
    values = (1e3, 1e6, 1e9, 1e12)
    n = np.ones(len(values))
    ellipse = Ellipse(n, 0.5 * n, n)
    slip = Slip(0.5 * n, 0.75**0.5 * n, 1e15 * n, 16.0 * n, np.array(values) * 0.5)
    r = resultants(ellipse, slip, 0.3 * n, nodes=16)
    bound = 0.3 * ellipse.normal_force
    # int tau_y = -mu F_N (1 - <y^2>/(2 x_p^2)) with <y^2> = b^2/5 of the Hertzian pressure
    exact = -bound * (1 - 0.25 / 5 / (2 * np.array(values) ** 2))
    errors = np.abs(r.driving_force / exact - 1)
    return KernelError("sliding integrals, far pole", "x_spin/a", values, tuple(map(float, errors)), 1e-9)


KERNELS = (axis_ratios, depth, surface_centre, pole_positions, far_pole)
