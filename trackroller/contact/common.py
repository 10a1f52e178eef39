"""What goes into a contact model and what comes out: small frozen dataclasses of arrays.

Every array has one entry per contact patch, shape (n,), unless stated. N, mm, MPa, rad.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np


class _Rows:
    """Row selection for dataclasses of arrays along one axis."""

    def take(self, index):
        """The patches `index` (integer or boolean array)."""
        values = (getattr(self, field.name)[index] for field in dataclasses.fields(self))  # type: ignore[arg-type]
        return type(self)(*values)


@dataclass(frozen=True)
class Ellipse(_Rows):
    """Contact ellipse: a along x_C (lateral), b along y_C (rolling) [mm], p_max [MPa]."""

    semi_axis_lateral: np.ndarray
    semi_axis_rolling: np.ndarray
    max_pressure: np.ndarray

    @property
    def normal_force(self) -> np.ndarray:
        """F_N = 2/3 pi a b p_max [N]."""
        return 2.0 / 3.0 * np.pi * self.semi_axis_lateral * self.semi_axis_rolling * self.max_pressure


@dataclass(frozen=True)
class Slip(_Rows):
    """Kinematics of a patch.

    `sine` and `cosine` belong to the signed contact angle (+alpha in contact 1, -alpha in contact 2);
    r_C,G, r_A and the rolling radius shift r_Delta0 in mm.
    """

    sine: np.ndarray
    cosine: np.ndarray
    guide_profile_radius: np.ndarray
    rolling_radius: np.ndarray
    shift: np.ndarray

    @property
    def longitudinal(self) -> np.ndarray:
        """Longitudinal creepage r_Delta0 / r_A (> 0 is braking)."""
        return self.shift / self.rolling_radius

    @property
    def spin(self) -> np.ndarray:
        """Spin creepage -sin(alpha) / r_A [1/mm], of opposite sign in the two contacts."""
        return -self.sine / self.rolling_radius

    @property
    def pole_lateral(self) -> np.ndarray:
        """x_spin = r_Delta0 / sin(alpha) [mm], eq. (23)."""
        return self.shift / self.sine

    def beyond_tangent(self, x: np.ndarray) -> np.ndarray:
        """Rolling slip of the circular guide profile, eq. (20), less that of its tangent, xi + spin x [1].

        x, result : (n, m) lateral positions [mm]. Beyond the equator of the contour ASSUME the slip stays that of it.
        """
        s, c, r = self.sine[:, None], self.cosine[:, None], self.guide_profile_radius[:, None]
        deep = x * c * (2.0 * r * s + x * c)
        root = np.sqrt(np.maximum(r * r * c * c - deep, 0.0))
        drop = np.where(root > 0.0, deep / (root + r * c), r * c)
        return (x * s - drop) / self.rolling_radius[:, None]


@dataclass(frozen=True)
class DetailedSlip(Slip):
    """Kinematics with what the rigid slip leaves out by default, see docs/theory.md ("Slip field").

    turning : 1/(r_Curve + r_C,G cos(alpha)) [1/mm], how far the roller turns with the guide's curve per distance
        travelled, which adds to its spin; 0 if that is left out
    contour : of the guide's own shape, callables from lateral positions (m,) [mm], outward, to the height over the
        tangent along the radial direction [mm]; None for the circle
    """

    turning: np.ndarray
    contour: np.ndarray

    @property
    def spin(self) -> np.ndarray:
        """Spin creepage -sin(alpha) (1/r_A + turning) [1/mm]."""
        return -self.sine * (1.0 / self.rolling_radius + self.turning)

    def beyond_tangent(self, x: np.ndarray) -> np.ndarray:
        """As for the circle, or of the guide's own contour."""
        out = super().beyond_tangent(x)
        for i, height in enumerate(self.contour):
            if height is not None:
                outward = 1.0 if self.sine[i] > 0 else -1.0
                out[i] = height(outward * x[i]) / self.rolling_radius[i]
        return out


@dataclass(frozen=True)
class Resultants(_Rows):
    """Friction forces on the roller [N] and spin moment about z_C [N mm]."""

    lateral_force: np.ndarray
    driving_force: np.ndarray
    spin_moment: np.ndarray


@dataclass(frozen=True)
class Works(_Rows):
    """Per distance travelled [N]: what friction dissipates, and what of it the pressures put in.

    On unlike materials shear moves the surfaces along the normal, and the pressures do work on that.
    """

    dissipated: np.ndarray
    by_pressure: np.ndarray

    @classmethod
    def of_friction(cls, dissipated: np.ndarray) -> Works:
        """Where the pressures put in nothing."""
        return cls(dissipated, np.zeros_like(dissipated))


@dataclass(frozen=True)
class Elastic(_Rows):
    """Combined elastic constants of a pair of bodies (Kalker 1990, eq. 1.44).

    1/G = (1/G1 + 1/G2)/2, nu/G = (nu1/G1 + nu2/G2)/2, K/G = ((1-2 nu1)/G1 - (1-2 nu2)/G2)/4,
    body 1 the roller. G [MPa].
    """

    shear_modulus: np.ndarray
    poisson_ratio: np.ndarray
    coupling: np.ndarray

    @classmethod
    def of_pair(cls, e_1, nu_1, e_2, nu_2) -> Elastic:
        """Combined constants from Young's moduli [MPa] and Poisson's ratios of roller and guide."""
        g_1, g_2 = e_1 / (2 * (1 + nu_1)), e_2 / (2 * (1 + nu_2))
        g = 2.0 / (1 / g_1 + 1 / g_2)
        nu = g * (nu_1 / g_1 + nu_2 / g_2) / 2
        coupling = g * ((1 - 2 * nu_1) / g_1 - (1 - 2 * nu_2) / g_2) / 4
        return cls(g, nu, coupling)


@dataclass(frozen=True)
class SurfaceTractions:
    """Tractions on the roller over a grid of each patch.

    `x` (n, nx) and `y` (n, ny) [mm]; the fields (n, ny, nx): pressure and shear [MPa], slip velocity of the
    roller relative to the guide per travel speed [1], and where the surfaces stick.
    """

    x: np.ndarray
    y: np.ndarray
    pressure: np.ndarray
    shear_lateral: np.ndarray
    shear_rolling: np.ndarray
    slip_lateral: np.ndarray
    slip_rolling: np.ndarray
    stick: np.ndarray
