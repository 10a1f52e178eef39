"""What a contact model receives and returns: patches, elastic constants, forces, tractions and works.

Every array has one entry for each contact patch, shape (n,), unless stated otherwise. Units: N, mm, MPa, rad.
The contact frame has x_C in the lateral direction, y_C in the rolling direction and z_C along the common normal, into
the body considered. Kalker and CONTACT use x for the rolling direction instead.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, ClassVar, Literal, Protocol, Self

import numpy as np

from trackroller.halfspace.tractions import Tractions
from trackroller.numerics.rows import Rows

if TYPE_CHECKING:
    from trackroller.contact.slip import Slip

# Share of the largest possible error of the friction work, see `error_of_work`. The error exceeded this share in 1 of
# 100 designs.
WORK_SHARE = 0.7


class Patch(Protocol):
    """Interface of n contact patches, elliptical (`Ellipse`) or not (`grid_patch.GridPatch`).

    Arrays of shape (n,).
    """

    @property
    def is_hertzian(self) -> bool:
        """Return True for the ellipses of Hertz's theory, whose pressure follows from a, b and p_max.

        False if the pressure was solved element by element.
        """

    @property
    def semi_axis_lateral(self) -> np.ndarray:
        """Return the semi-axis a along x_C, or half the width of the box around the patch [mm]."""

    @property
    def semi_axis_rolling(self) -> np.ndarray:
        """Return the semi-axis b along y_C, or half the length of the box around the patch [mm]."""

    @property
    def max_pressure(self) -> np.ndarray:
        """Return the largest pressure p_max [MPa]."""

    @property
    def normal_force(self) -> np.ndarray:
        """Return the normal force F_N [N]."""

    @property
    def centre(self) -> np.ndarray:
        """Return x_C of the middle of the ellipse or box [mm]."""

    @property
    def pressure_centre(self) -> np.ndarray:
        """Return x_C of the resultant of the pressure [mm]."""

    @property
    def area(self) -> np.ndarray:
        """Return the area of the patch [mm^2]."""

    @property
    def half_extents(self) -> tuple[np.ndarray, np.ndarray]:
        """Return half the width and half the length of the loaded region [mm]."""

    @property
    def reaches_edge(self) -> np.ndarray:
        """Return True where the patch ends at an edge of the material."""

    def take(self, index: np.ndarray) -> Self:
        """Return the patches `index` (integer or boolean array)."""


@dataclass(frozen=True)
class Ellipse(Rows):
    """Contact ellipses of Hertz's theory: a along x_C (lateral), b along y_C (rolling) [mm], p_max [MPa]; (n,)."""

    semi_axis_lateral: np.ndarray
    semi_axis_rolling: np.ndarray
    max_pressure: np.ndarray

    is_hertzian: ClassVar[Literal[True]] = True

    @property
    def normal_force(self) -> np.ndarray:
        """Return F_N = 2/3 pi a b p_max [N]."""
        return 2.0 / 3.0 * np.pi * self.semi_axis_lateral * self.semi_axis_rolling * self.max_pressure

    @property
    def centre(self) -> np.ndarray:
        """Return 0: an ellipse lies around the nominal point of contact."""
        return np.zeros(len(self.semi_axis_lateral))

    @property
    def pressure_centre(self) -> np.ndarray:
        """Return 0, and NaN where there is no patch."""
        return 0.0 * self.semi_axis_lateral

    @property
    def area(self) -> np.ndarray:
        """Return pi a b [mm^2]."""
        return np.pi * self.semi_axis_lateral * self.semi_axis_rolling

    @property
    def half_extents(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the semi-axes (a, b) [mm]."""
        return self.semi_axis_lateral, self.semi_axis_rolling

    @property
    def reaches_edge(self) -> np.ndarray:
        """Return False: Hertz's theory has no edges."""
        return np.zeros(len(self.semi_axis_lateral), bool)

    def grid(self, elements: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return x and y of element centres, (n, elements) [mm], and the pressure there, (n, y, x) [MPa]."""
        return self.pressures((2.0 * np.arange(elements) + 1.0) / elements - 1.0)

    def pressures(self, unit: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return x and y over the places `unit` (m,) in the unit circle [mm], and Hertz's pressure, eq. (26)."""
        root = np.sqrt(np.maximum(1.0 - unit[None, :] ** 2 - unit[:, None] ** 2, 0.0))
        pressure = self.max_pressure[:, None, None] * root
        return self.semi_axis_lateral[:, None] * unit, self.semi_axis_rolling[:, None] * unit, pressure


@dataclass(frozen=True)
class Resultants(Rows):
    """Lateral and driving friction force on the roller [N] and spin moment about z_C [N mm], arrays (n,)."""

    lateral_force: np.ndarray
    driving_force: np.ndarray
    spin_moment: np.ndarray

    @classmethod
    def unknown(cls, n: int) -> Resultants:
        """Return the resultants of n patches as NaN."""
        return cls(*(np.full(n, np.nan) for _ in dataclasses.fields(cls)))

    @property
    def columns(self) -> np.ndarray:
        """Return F_T, F_A and M_R as columns, (n, 3)."""
        return np.stack([self.lateral_force, self.driving_force, self.spin_moment], axis=1)

    def replaced(self, rows: np.ndarray, other: Resultants) -> Resultants:
        """Return a copy in which the patches `rows` have the resultants of `other`."""
        parts = [np.array(getattr(self, field.name)) for field in dataclasses.fields(self)]
        for part, field in zip(parts, dataclasses.fields(other), strict=True):
            part[rows] = getattr(other, field.name)
        return Resultants(*parts)


@dataclass(frozen=True)
class Works(Rows):
    """Work per distance travelled [N], arrays (n,).

    Attributes
    ----------
    dissipated : numpy.ndarray, shape (n,)
        Energy that friction dissipates.
    by_pressure : numpy.ndarray, shape (n,)
        Part of this energy that the pressures supply. On unlike materials shear moves the surfaces along the normal,
        and the pressures do work on this motion.
    """

    dissipated: np.ndarray
    by_pressure: np.ndarray

    @classmethod
    def of_friction(cls, dissipated: np.ndarray) -> Works:
        """Return the works of a model in which the pressures supply no energy."""
        return cls(dissipated, np.zeros_like(dissipated))


@dataclass(frozen=True)
class Elastic(Rows):
    """Combined elastic constants of pairs of bodies (Kalker 1990, eq. 1.44), arrays (n,).

    1/G = (1/G1 + 1/G2)/2, nu/G = (nu1/G1 + nu2/G2)/2, K/G = ((1-2 nu1)/G1 - (1-2 nu2)/G2)/4,
    body 1 is the roller. `shear_modulus` G [MPa], `poisson_ratio` nu [1], `coupling` K [1]. `layer_flexibility`
    h/G3 [mm^3/N] is that of a film of thickness h and shear modulus G3 between the bodies; None stands for no film.
    """

    shear_modulus: np.ndarray
    poisson_ratio: np.ndarray
    coupling: np.ndarray
    layer_flexibility: np.ndarray | None = None

    @property
    def film(self) -> np.ndarray:
        """Return the flexibility of the film, (n,) [mm^3/N]; 0 stands for no film."""
        if self.layer_flexibility is None:
            return np.zeros(np.shape(self.shear_modulus))
        return np.asarray(self.layer_flexibility, float)

    @classmethod
    def of_pair(cls, e_1, nu_1, e_2, nu_2) -> Elastic:
        """Return the combined constants from Young's moduli [MPa] and Poisson's ratios of roller and guide."""
        g_1, g_2 = e_1 / (2 * (1 + nu_1)), e_2 / (2 * (1 + nu_2))
        g = 2.0 / (1 / g_1 + 1 / g_2)
        nu = g * (nu_1 / g_1 + nu_2 / g_2) / 2
        coupling = g * ((1 - 2 * nu_1) / g_1 - (1 - 2 * nu_2) / g_2) / 4
        return cls(g, nu, coupling)


@dataclass(frozen=True)
class SurfaceTractions(Tractions):
    """Tractions on the roller over a grid of each of n patches, and where the surfaces stick.

    Attributes
    ----------
    stick : numpy.ndarray of bool, shape (n, ny, nx)
        True where the surfaces stick.
    """

    stick: np.ndarray

    @classmethod
    def of_sliding(cls, x, y, pressure, shear, slip) -> SurfaceTractions:
        """Return the tractions of patches that stick nowhere; `shear` and `slip` are pairs of fields."""
        moved = [np.where(pressure > 0, part, 0.0) for part in slip]
        return cls(x, y, pressure, shear[0], shear[1], moved[0], moved[1], np.zeros(pressure.shape, bool))

    @property
    def stick_share(self) -> np.ndarray:
        """Return the share of the loaded grid points that stick, shape (n,) [1]."""
        return self.stick.sum(axis=(1, 2)) / (self.pressure > 0).sum(axis=(1, 2))

    def shares(self, friction: np.ndarray) -> np.ndarray:
        """Return the traction over its bound mu p; outside the ellipse that of the nearest element.

        Parameters
        ----------
        friction : ndarray, shape (n,)
            Friction coefficient mu of ellipses on alike grids.

        Returns
        -------
        ndarray, shape (n, 2, ny, nx)
            x_C and y_C part of the share.
        """
        bound = friction[:, None, None] * self.pressure
        safe = np.where(bound > 0, bound, 1.0)
        share = np.stack([self.shear_lateral / safe, self.shear_rolling / safe], axis=1)
        return np.ascontiguousarray(filled(share, self.pressure[0]) if len(share) else share)


@lru_cache(maxsize=16)
def _nearest(empty: bytes, columns: int) -> np.ndarray:
    """Return row and column of the nearest loaded element, (2, ny, nx), from a mask of the others."""
    # a heavy package, and only stresses under tractions on a grid need it
    from scipy.ndimage import distance_transform_edt  # noqa: PLC0415

    mask = np.frombuffer(empty, bool).reshape(-1, columns)
    return np.asarray(distance_transform_edt(mask, return_distances=False, return_indices=True))


def filled(fields: np.ndarray, pressure: np.ndarray) -> np.ndarray:
    """Return fields (n, 2, ny, nx) with the values of the nearest loaded element where `pressure` (ny, nx) is 0."""
    row, column = _nearest((pressure <= 0.0).tobytes(), pressure.shape[1])
    return fields[:, :, row, column]


def error_of_work(
    patch: Patch, slip: Slip, friction: np.ndarray, driving: np.ndarray, moment: np.ndarray
) -> np.ndarray:
    """Return the error of the friction work over that of the friction forces over mu F_N, at least 1, (m,) [1].

    Errors of F_A by mu F_N and of M_R by mu F_N c change the work by at most mu F_N (|xi| + |phi| c).
    These errors partly cancel, so that WORK_SHARE of this bound is the estimate. The work itself may be small, because
    the works of F_A and M_R cancel too.

    Parameters
    ----------
    patch, slip : patches and their slip, arrays (m,)
    friction : mu, (m,)
    driving, moment : F_A [N] and M_R [N mm], (m,)
    """
    arm = np.sqrt(patch.semi_axis_lateral * patch.semi_axis_rolling)
    speed, work = np.abs(slip.longitudinal) + np.abs(slip.spin) * arm, slip.longitudinal * driving + slip.spin * moment
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.fmax(WORK_SHARE * friction * patch.normal_force * speed / np.abs(work), 1.0))


def slenderness(patch: Patch) -> np.ndarray:
    """Return the larger semi-axis of each patch over the smaller one, (n,) [1]."""
    ratio = patch.semi_axis_rolling / patch.semi_axis_lateral
    return np.maximum(ratio, 1.0 / ratio)


def force_scales(patch: Patch, friction: np.ndarray) -> np.ndarray:
    """Return the scales of F_T, F_A and M_R: mu F_N, mu F_N and mu F_N c, (m, 3); 1e-300 where there is no friction."""
    scale = np.empty((len(friction), 3))
    scale[:] = np.maximum(friction * patch.normal_force, 1e-300)[:, None]
    scale[:, 2] *= np.sqrt(patch.semi_axis_lateral * patch.semi_axis_rolling)
    return scale
