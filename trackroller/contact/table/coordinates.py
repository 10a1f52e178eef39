"""Dimensionless coordinates of a patch in steady rolling without lateral creepage.

The problem has the axis ratio g = b/a, Poisson's ratio nu, two creepages and K/mu. Over the
creepage mu N/(G c^2 C11), with c = sqrt(a b), they are

    X = xi + Z,  Y = phi L with L^2 = (a^2 + b^2/4)/3,  Z = C11 (K/mu)/(2 (1 + g)).

Z is nearly the longitudinal creepage with the same effect as K, so that X is nearly the whole
longitudinal creepage. The coordinates are those of a sphere,

    r = |(X, Y, Z)|,  rho = r/(r + 3),  chi = asin(|Z|/r),  theta = atan2(X sign(Z), |Y|).

rho = 0 is the linear theory and rho = 1 is full sliding for every K/mu and every friction
coefficient, so that no coordinate but g has a limit.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from trackroller.contact.linear import logarithm
from trackroller.contact.quantities import Elastic, Patch
from trackroller.numerics.compiled import compiled, formula

HALF_WAY = 3.0  # r at rho = 1/2
RATIOS = (0.05, 20.0)  # of b/a
LARGEST_SLIP = 1e100  # creepages are cut off here; far below, the patch already slides completely
# creepages are divided by mu F_N/(G a b C11), or by this number if there is less friction
LEAST_BEND = 1e-250


@formula
def spin_arm(g):
    """Return the lever arm L of spin over c = sqrt(a b); the pole leaves a slender patch (b << a)
    at theta = 60 deg.
    """
    return np.sqrt((1.0 / g + g / 4.0) / 3.0)


@formula
def coupling_creepage(g):
    """Return Z over C11 K/mu."""
    return 0.5 / (1.0 + g)


class Rolling(NamedTuple):
    """Patches in steady rolling, arrays (n,): a, b [mm], xi [1], phi [1/mm], mu, mu F_N [N], and
    elastic constants.
    """

    lateral: np.ndarray
    rolling: np.ndarray
    longitudinal: np.ndarray
    spin: np.ndarray
    friction: np.ndarray
    capacity: np.ndarray
    shear_modulus: np.ndarray
    poisson_ratio: np.ndarray
    coupling: np.ndarray

    @classmethod
    def of(cls, ellipse: Patch, longitudinal, spin, friction, elastic: Elastic) -> Rolling:
        """Return patches as kernels take them; see `table.solve_patch`."""
        a, b, capacity = (
            ellipse.semi_axis_lateral,
            ellipse.semi_axis_rolling,
            friction * ellipse.normal_force,
        )
        constants = elastic.shear_modulus, elastic.poisson_ratio, elastic.coupling
        return cls(*np.array((a, b, longitudinal, spin, friction, capacity, *constants)))

    @property
    def size(self) -> np.ndarray:
        """Return c = sqrt(a b), (n,) [mm]."""
        return np.sqrt(self.lateral * self.rolling)


@compiled
def _limited(value, low, high):
    """Return `value` between its limits; NaN stays NaN."""
    if value < low:
        return low
    if value > high:
        return high
    return value


@compiled
def in_range(ratio):
    """Return whether the table holds patches of the axis ratio b/a; True for NaN, where there is no
    patch.
    """
    edge = 1.0 + 1e-9
    return not (ratio < RATIOS[0] / edge or ratio > RATIOS[1] * edge) or not math.isfinite(ratio)


@compiled
def coordinates(patches, i, linear):
    """Return axis ratio, X, Y and Z of patch i; `linear` are the coefficients of
    `linear.chebyshev`.

    The ratio is that of the nearest patch in the table's range. X, Y or Z is not finite where there
    is no patch.
    """
    square = patches.lateral[i] * patches.rolling[i]
    ratio = patches.rolling[i] / patches.lateral[i]
    g = _limited(ratio if math.isfinite(ratio) else 1.0, RATIOS[0], RATIOS[1])
    c11 = math.exp(logarithm(g, patches.poisson_ratio[i], linear[0]))
    bend = patches.capacity[i] / (patches.shear_modulus[i] * square * c11)
    bend = LEAST_BEND if bend < LEAST_BEND else bend
    friction, coupling = patches.friction[i], patches.coupling[i]
    coupled = 0.0 if coupling == 0.0 or friction == 0.0 else coupling / friction
    z = c11 * coupled * coupling_creepage(g)
    x = patches.longitudinal[i] / bend + z
    y = patches.spin[i] * math.sqrt(square) * spin_arm(g) / bend
    if not math.isfinite(ratio):
        x = np.nan
    limit = LARGEST_SLIP
    return g, _limited(x, -limit, limit), _limited(y, -limit, limit), _limited(z, -limit, limit)
