"""Resultants of the exact rolling theory from a stored table, as in Kalker's program USETAB.

Without lateral creepage, the dimensionless problem has five numbers: the axis ratio g = b/a, Poisson's ratio, two
normalised creepages, and kappa = K/mu. The creepages enter as a length and an angle,

    X = xi, Y = phi L,  L = c sqrt(g + 1/g)/2,  c = sqrt(a b),  r = hypot(X, Y) G c^2 C11/(mu N),
    rho = r/(r + 4),  theta = atan2(|X|, |Y|),

so that rho = 0 is the linear theory and rho = 1 is full sliding. The table is exact in both limits. It interpolates
F_A/(mu N rho sin(theta)), F_T/(mu N rho cos(theta)) and M_R/(mu N c rho cos(theta)). These functions are smooth and
even at both ends of theta, so the forces are odd functions of the creepages, as symmetry demands. Unlike materials act
mainly as an additional longitudinal creepage, r_x + kappa C11 s(g), with a polynomial s in ln g. A second, coarser
table in kappa holds the remaining effect of unlike materials. Both tables are tensor products of cubic splines.
`trackroller.contact.table.build` makes them.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import lru_cache
from importlib import resources as files

import numpy as np
from numba import njit

from trackroller.contact.common import Elastic, Resultants
from trackroller.contact.linear import creepage_coefficients
from trackroller.contact.protocol import Patch
from trackroller.numerics.knots import interval
from trackroller.numerics.threads import share_rows

TABLE = "kalker_table.npz"
HALF_WAY = 4.0  # r at rho = 1/2
RATIOS = (0.05, 20.0)  # of b/a
LARGEST_COUPLING = 1.5  # of |K|/mu
LARGEST_SLIP = 1e100  # r where friction can bend nothing
FIELDS = ("lateral", "driving", "spin", "stick")


@dataclass(frozen=True)
class Spline:
    """Tensor product of cubic splines: four knot vectors, and coefficients (n1, n2, n3, n4, fields)."""

    knots: tuple[np.ndarray, ...]
    values: np.ndarray


@dataclass(frozen=True)
class TableSolution:
    """Solution of n patches from the table.

    Attributes
    ----------
    resultants : Resultants
        Forces [N] and spin moment [N mm] on the roller, (n,).
    stick_fraction : numpy.ndarray, shape (n,)
        Share of the adhesion area in the ellipse [1].
    friction_energy_per_distance : numpy.ndarray, shape (n,)
        Dissipation [N], the work of the creepages -(xi F_A + phi M_R).
    known : numpy.ndarray of bool, shape (n,)
        False outside the range of the table, where the other values are NaN.
    """

    resultants: Resultants
    stick_fraction: np.ndarray
    friction_energy_per_distance: np.ndarray
    known: np.ndarray


@njit(cache=True, nogil=True)
def _basis(knots, x, out):
    """Write the four nonzero cubic B-splines at x into `out`; return the index of the first one (de Boor)."""
    low = interval(x, knots, 3, knots.size - 4)
    out[0] = 1.0
    for degree in range(1, 4):
        saved = 0.0
        for k in range(degree):
            right, left = knots[low + k + 1], knots[low + 1 - degree + k]
            part = out[k] / (right - left)
            out[k] = saved + (right - x) * part
            saved = (x - left) * part
        out[degree] = saved
    return low - 3


@njit(cache=True, nogil=True)
def _evaluate(first, last, knots, values, points, out):
    """Write rows first to last - 1 of the tensor product at points (n, 4) into `out` (n, fields)."""
    k0, k1, k2, k3 = knots
    basis, start = np.empty((4, 4)), np.empty(4, np.int64)
    for row in range(first, last):
        start[0], start[1] = _basis(k0, points[row, 0], basis[0]), _basis(k1, points[row, 1], basis[1])
        start[2], start[3] = _basis(k2, points[row, 2], basis[2]), _basis(k3, points[row, 3], basis[3])
        for f in range(values.shape[4]):
            total = 0.0
            for h in range(4):
                for i in range(4):
                    for j in range(4):
                        w = basis[0, h] * basis[1, i] * basis[2, j]
                        for k in range(4):
                            total += w * basis[3, k] * values[start[0] + h, start[1] + i, start[2] + j, start[3] + k, f]
            out[row, f] = total


def evaluate(spline: Spline, points: np.ndarray) -> np.ndarray:
    """Return the values of a tensor-product spline.

    Parameters
    ----------
    spline : Spline
        The spline.
    points : numpy.ndarray, shape (n, 4)
        Points between the outer knots.

    Returns
    -------
    numpy.ndarray, shape (n, fields)
        Values.
    """
    points = np.ascontiguousarray(points, dtype=float)
    out = np.empty((len(points), spline.values.shape[4]))
    share_rows(lambda a, b: _evaluate(a, b, spline.knots, spline.values, points, out), len(points), 512)
    return out


@dataclass(frozen=True)
class Tables:
    """The two tables and their errors.

    Attributes
    ----------
    like : Spline
        Bodies with K = 0, over (rho, theta, ln g, nu).
    unlike : Spline
        Additional effect of unlike materials, over (rho, theta from -90 to 90 deg, ln g, kappa).
    shift : numpy.ndarray
        Coefficients of the polynomial s(ln g).
    errors : dict of str to float
        Differences from the exact solver on a random sample, measured by `table.build`.
    """

    like: Spline
    unlike: Spline
    shift: np.ndarray
    errors: dict[str, float]


def _read_spline(stored_arrays, name: str) -> Spline:
    arrays = [
        np.ascontiguousarray(stored_arrays[f"{name}_{part}"], float)
        for part in ("knots_0", "knots_1", "knots_2", "knots_3", "values")
    ]
    return Spline(tuple(arrays[:4]), arrays[4])


@lru_cache(maxsize=1)
def stored() -> Tables:
    """Return the tables that the package contains."""
    place = files.files("trackroller.contact.table").joinpath(TABLE)
    with files.as_file(place) as path, np.load(path, allow_pickle=False) as f:
        like, unlike = (_read_spline(f, name) for name in ("like", "unlike"))
        names, values = f["error_names"], f["error_values"]
        return Tables(like, unlike, f["shift"], {str(n): float(v) for n, v in zip(names, values, strict=True)})


@dataclass(frozen=True)
class Dimensionless:
    """Normalised patches, arrays (n,): g, Poisson's ratio, components r_x and r_y of r, kappa, C11.

    Without friction force (mu N = 0), r is a very large number instead of infinity.
    """

    g: np.ndarray
    poisson: np.ndarray
    along: np.ndarray
    across: np.ndarray
    kappa: np.ndarray
    c11: np.ndarray


def normalise(ellipse: Patch, longitudinal, spin, friction, elastic: Elastic) -> Dimensionless:
    """Return the dimensionless numbers of patches with creepages xi [1] and phi [1/mm]; see `solve_patch`."""
    a, b = ellipse.semi_axis_lateral, ellipse.semi_axis_rolling
    g, square = b / a, a * b
    ratio = np.clip(np.where(np.isfinite(g), g, 1.0), *RATIOS)
    c11 = creepage_coefficients(ratio, elastic.poisson_ratio).c11
    arm = np.sqrt(square * (ratio + 1.0 / ratio)) / 2.0
    with np.errstate(divide="ignore", invalid="ignore"):
        bend = np.maximum(friction * ellipse.normal_force / (elastic.shear_modulus * square * c11), 1e-250)
        kappa = np.where((elastic.coupling == 0.0) | (friction == 0.0), 0.0, elastic.coupling / friction)
        return Dimensionless(g, elastic.poisson_ratio, longitudinal / bend, spin * arm / bend, kappa, c11)


def solve_patch(ellipse: Patch, longitudinal, spin, friction, elastic: Elastic) -> TableSolution:
    """Solve steady rolling with the rigid slip w = (-phi y, xi + phi x) by the table.

    Parameters
    ----------
    ellipse : Ellipse
        Hertzian patches, arrays (n,); b/a from 0.05 to 20.
    longitudinal, spin : array_like, shape (n,)
        xi [1] and phi [1/mm].
    friction : array_like, shape (n,)
        Friction coefficient mu [1]; 0 gives no traction.
    elastic : Elastic
        Combined constants, arrays (n,); |K|/mu up to 1.5.

    Returns
    -------
    TableSolution
        Values of the n patches. Patches outside the range are NaN; the table never extrapolates.

    Notes
    -----
    `stored().errors` has the differences from the exact solver.
    """
    xi, phi, mu = (np.asarray(v, float) for v in (longitudinal, spin, friction))
    d = normalise(ellipse, xi, phi, mu, elastic)
    known = _held(d)
    rows = np.flatnonzero(known)
    unit = np.full((len(FIELDS), known.size), np.nan)
    inside = Dimensionless(*(np.broadcast_to(getattr(d, f.name), known.shape)[rows] for f in fields(d)))
    unit[:, rows] = unit_forces(inside)
    capacity = mu * ellipse.normal_force
    c = np.sqrt(ellipse.semi_axis_lateral * ellipse.semi_axis_rolling)
    forces = Resultants(capacity * unit[0], capacity * unit[1], capacity * c * unit[2])
    work = -(xi * forces.driving_force + phi * forces.spin_moment)
    return TableSolution(forces, np.clip(unit[3], 0.0, 1.0), work, known)


def _held(d: Dimensionless) -> np.ndarray:
    """Return which patches lie in the table's range, (n,); where there is no patch NaN stays NaN."""
    edge = 1.0 + 1e-9
    held = (d.g >= RATIOS[0] / edge) & (d.g <= RATIOS[1] * edge) & (np.abs(d.kappa) <= LARGEST_COUPLING)
    return held | ~np.isfinite(d.g * d.kappa)


def nearest_forces(
    ellipse: Patch, longitudinal, spin, friction, elastic: Elastic
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the forces of the nearest patch that the table holds, and the place of the slip.

    Parameters are those of `solve_patch`. A patch outside the range takes the forces at the end of the range.

    Returns
    -------
    F_T/(mu N), F_A/(mu N) and M_R/(mu N c), (3, n); r_x/(4 + r) in (-1, 1), (n,); which patches the table holds, (n,).
    NaN where there is no patch.
    """
    xi, phi, mu = (np.asarray(v, float) for v in (longitudinal, spin, friction))
    d = normalise(ellipse, xi, phi, mu, elastic)
    d = Dimensionless(*np.broadcast_arrays(*(getattr(d, f.name) for f in fields(d))))
    along, across = (np.clip(v, -LARGEST_SLIP, LARGEST_SLIP) for v in (d.along, d.across))
    place = along / (HALF_WAY + np.hypot(along, across))
    there = np.isfinite(d.g * place)
    near = Dimensionless(
        np.where(there, np.clip(d.g, *RATIOS), 1.0),
        d.poisson,
        np.where(there, along, 0.0),
        np.where(there, across, 0.0),
        np.clip(np.where(there, d.kappa, 0.0), -LARGEST_COUPLING, LARGEST_COUPLING),
        d.c11,
    )
    return np.where(there, unit_forces(near)[:3], np.nan), place, _held(d)


def unit_forces(d: Dimensionless) -> np.ndarray:
    """Return F_T/(mu N), F_A/(mu N), M_R/(mu N c) and the share of the adhesion area, (4, n)."""
    tables = stored()
    log_g = np.log(np.clip(d.g, *RATIOS))
    out = like_forces(tables.like, d, d.along + d.kappa * d.c11 * np.polyval(tables.shift, log_g))
    rows = np.flatnonzero(d.kappa != 0.0)
    if rows.size:
        # If both creepages and K change their signs, the tractions do so as well. A reflection of x reverses the spin.
        turned, side = np.sign(d.kappa[rows]), np.sign(d.across[rows])
        rho, angle = _polar(d.along[rows] * turned, d.across[rows])
        more = evaluate(tables.unlike, np.stack([rho, angle, log_g[rows], np.abs(d.kappa[rows])], axis=1)).T
        # A reflection of x changes the signs of the spin, of F_T and of M_R, and keeps F_A.
        side *= np.cos(angle)
        out[:, rows] += np.stack([side * more[0], turned * more[1], side * more[2], more[3]])
    return out


def _polar(along: np.ndarray, across: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    length = np.hypot(along, across)
    return length / (length + HALF_WAY), np.arctan2(along, np.abs(across))


def like_forces(like: Spline, d: Dimensionless, along: np.ndarray) -> np.ndarray:
    """Return the values of `unit_forces` for K = 0 and the longitudinal component `along` of r, (4, n)."""
    rho, angle = _polar(along, d.across)
    side, theta = np.sign(d.across), np.abs(angle)
    v = evaluate(like, np.stack([rho, theta, np.log(np.clip(d.g, *RATIOS)), d.poisson], axis=1)).T
    return np.stack(
        [
            side * rho * np.cos(theta) * v[0],
            np.sign(along) * rho * np.sin(theta) * v[1],
            side * rho * np.cos(theta) * v[2],
            v[3],
        ]
    )
