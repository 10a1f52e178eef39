"""Dimensionless coordinates of a patch in steady rolling without lateral creepage.

The problem has the axis ratio g = b/a, Poisson's ratio nu, two creepages and K/mu. Over the creepage mu N/(G c^2 C11),
with c = sqrt(a b), they are

    X = xi + Z,  Y = phi L with L^2 = (a^2 + b^2/4)/3,  Z = C11 (K/mu)/(2 (1 + g)).

Z is nearly the longitudinal creepage with the same effect as K, so that X is nearly the whole longitudinal creepage.
The coordinates are those of a sphere,

    r = |(X, Y, Z)|,  rho = r/(r + 3),  chi = asin(|Z|/r),  theta = atan2(X sign(Z), |Y|).

rho = 0 is the linear theory and rho = 1 is full sliding for every K/mu and every friction coefficient, so that no
coordinate but g has a limit.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trackroller.contact.common import Elastic
from trackroller.contact.linear import creepage_coefficients
from trackroller.contact.protocol import Patch

HALF_WAY = 3.0  # r at rho = 1/2
RATIOS = (0.05, 20.0)  # of b/a
LARGEST_SLIP = 1e100  # creepages are cut off here; far below, the patch already slides completely


def spin_arm(g):
    """Return the lever arm L of spin over c = sqrt(a b); the pole leaves a slender patch (b << a) at theta = 60 deg."""
    return np.sqrt((1.0 / g + g / 4.0) / 3.0)


def coupling_creepage(g):
    """Return Z over C11 K/mu."""
    return 0.5 / (1.0 + g)


@dataclass(frozen=True)
class Dimensionless:
    """Normalised patches, arrays (n,): axis ratio g, Poisson's ratio, and X, Y, Z of the coordinates."""

    g: np.ndarray
    poisson: np.ndarray
    along: np.ndarray
    across: np.ndarray
    coupling: np.ndarray

    @property
    def radius(self) -> np.ndarray:
        """Return r, (n,)."""
        return np.sqrt(self.along**2 + self.across**2 + self.coupling**2)

    @property
    def log_ratio(self) -> np.ndarray:
        """Return ln g of the nearest axis ratio in the table's range, (n,)."""
        return np.log(np.clip(self.g, *RATIOS))


def normalise(ellipse: Patch, longitudinal, spin, friction, elastic: Elastic) -> Dimensionless:
    """Return the coordinates of patches with creepages xi [1] and phi [1/mm]; see `table.solve_patch`."""
    a, b = ellipse.semi_axis_lateral, ellipse.semi_axis_rolling
    g, square = b / a, a * b
    near = np.clip(np.where(np.isfinite(g), g, 1.0), *RATIOS)
    c11 = creepage_coefficients(near, elastic.poisson_ratio).c11
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        bend = np.maximum(friction * ellipse.normal_force / (elastic.shear_modulus * square * c11), 1e-250)
        coupled = np.where((elastic.coupling == 0.0) | (friction == 0.0), 0.0, elastic.coupling / friction)
        z = c11 * coupled * coupling_creepage(near)
        values = longitudinal / bend + z, spin * np.sqrt(square) * spin_arm(near) / bend, z
    x, y, z = (np.clip(v, -LARGEST_SLIP, LARGEST_SLIP) for v in values)
    return Dimensionless(*np.broadcast_arrays(g, elastic.poisson_ratio, x, y, z))
