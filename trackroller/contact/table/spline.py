"""Resultants of the exact rolling theory from a stored table, as in Kalker's program USETAB.

Over the coordinates of `trackroller.contact.table.coordinates` the table interpolates F_A/(mu N rho),
F_T/(mu N rho cos(chi) cos(theta)) and M_R/(mu N c rho cos(chi) cos(theta)), and the share of the adhesion area. These
functions are smooth and have the symmetries of the problem, so the forces change their signs with those of the
creepages and of K. One tensor product of cubic splines holds them at nu = 0.3; a second, coarser one holds their first
and second coefficient in nu - 0.3. `validation.kalker_table` builds them.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import lru_cache
from importlib import resources as files

import numpy as np

from trackroller.contact.common import Elastic, Resultants
from trackroller.contact.protocol import Patch
from trackroller.contact.table.coordinates import HALF_WAY, RATIOS, Dimensionless, normalise
from trackroller.numerics.compiled import compiled
from trackroller.numerics.knots import interval
from trackroller.numerics.threads import share_rows

TABLE = "kalker_table.npz"
POISSON = 0.3  # Poisson's ratio of the finer of both splines
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


@compiled
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


@compiled
def _evaluate(first, last, knots, values, points, out):
    """Add rows first to last - 1 of the tensor product at points (n, 4) to `out` (n, fields)."""
    k0, k1, k2, k3 = knots
    basis, start = np.empty((4, 4)), np.empty(4, np.int64)
    for row in range(first, last):
        start[0], start[1] = _basis(k0, points[row, 0], basis[0]), _basis(k1, points[row, 1], basis[1])
        start[2], start[3] = _basis(k2, points[row, 2], basis[2]), _basis(k3, points[row, 3], basis[3])
        for h in range(4):
            for i in range(4):
                for j in range(4):
                    w = basis[0, h] * basis[1, i] * basis[2, j]
                    line = values[start[0] + h, start[1] + i, start[2] + j]
                    for k in range(4):
                        for f in range(values.shape[4]):
                            out[row, f] += w * basis[3, k] * line[start[3] + k, f]


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
    out = np.zeros((len(points), spline.values.shape[4]))
    share_rows(lambda a, b: _evaluate(a, b, spline.knots, spline.values, points, out), len(points), 512)
    return out


@dataclass(frozen=True)
class Tables:
    """The table and its errors.

    Attributes
    ----------
    forces : Spline
        The four fields at nu = 0.3, over (rho, chi, theta, ln g).
    poisson : Spline
        First and second coefficient of the fields in nu - 0.3, eight in all, over the same coordinates.
    errors : dict of str to float
        Differences from the exact solver, measured by `validation.kalker_table`.
    """

    forces: Spline
    poisson: Spline
    errors: dict[str, float]


def read(path) -> Tables:
    """Return the tables of an npz file."""
    with np.load(path, allow_pickle=False) as f:
        forces, poisson = (_read_spline(f, name) for name in ("forces", "poisson"))
        errors = zip(f["error_names"], f["error_values"], strict=True)
        return Tables(forces, poisson, {str(name): float(value) for name, value in errors})


def _read_spline(arrays, name: str) -> Spline:
    knots = (np.ascontiguousarray(arrays[f"{name}_knots_{i}"], float) for i in range(4))
    return Spline(tuple(knots), np.ascontiguousarray(arrays[f"{name}_values"], float))


@lru_cache(maxsize=1)
def stored() -> Tables:
    """Return the tables that the package contains."""
    place = files.files("trackroller.contact.table").joinpath(TABLE)
    with files.as_file(place) as path:
        return read(path)


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
        Combined constants, arrays (n,).

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
    unit[:, rows] = unit_forces(Dimensionless(*(getattr(d, f.name)[rows] for f in fields(d))))
    capacity = mu * ellipse.normal_force
    c = np.sqrt(ellipse.semi_axis_lateral * ellipse.semi_axis_rolling)
    forces = Resultants(capacity * unit[0], capacity * unit[1], capacity * c * unit[2])
    work = -(xi * forces.driving_force + phi * forces.spin_moment)
    return TableSolution(forces, np.clip(unit[3], 0.0, 1.0), work, known)


def _held(d: Dimensionless) -> np.ndarray:
    """Return which patches lie in the table's range, (n,); where there is no patch NaN stays NaN."""
    edge = 1.0 + 1e-9
    return ((d.g >= RATIOS[0] / edge) & (d.g <= RATIOS[1] * edge)) | ~np.isfinite(d.g)


def nearest_forces(
    ellipse: Patch, longitudinal, spin, friction, elastic: Elastic
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the forces of the nearest patch that the table holds, and the place of the slip.

    Parameters are those of `solve_patch`. A patch outside the range takes the forces at the end of the range.

    Returns
    -------
    forces : numpy.ndarray, shape (3, n)
        F_T/(mu N), F_A/(mu N) and M_R/(mu N c); NaN where there is no patch.
    place : numpy.ndarray, shape (n,)
        X/(3 + r) in (-1, 1).
    held : numpy.ndarray of bool, shape (n,)
        True for patches in the table's range.
    """
    xi, phi, mu = (np.asarray(v, float) for v in (longitudinal, spin, friction))
    d = normalise(ellipse, xi, phi, mu, elastic)
    return unit_forces(d)[:3], d.along / (HALF_WAY + d.radius), _held(d)


def unit_forces(d: Dimensionless) -> np.ndarray:
    """Return F_T/(mu N), F_A/(mu N), M_R/(mu N c) and the share of the adhesion area, (4, n).

    A patch outside the range takes the values at the end of the range. NaN where there is no patch.
    """
    there = np.isfinite(d.g * d.along * d.across)
    # If both creepages and K change their signs, the tractions do so as well.
    turned = np.where(d.coupling == 0.0, np.where(d.along < 0.0, -1.0, 1.0), np.sign(d.coupling))
    z, y, r = np.abs(d.coupling), np.abs(d.across), np.where(there, d.radius, 0.0)
    rho, plane = r / (r + HALF_WAY), np.hypot(d.along, y)
    points = np.stack([rho, np.arctan2(z, plane), np.arctan2(turned * d.along, y), d.log_ratio], axis=1)
    points = np.where(there[:, None], points, 0.0)
    tables, change = stored(), np.where(there, d.poisson - POISSON, 0.0)
    forces, more = evaluate(tables.forces, points).T, evaluate(tables.poisson, points).T
    forces += change * (more[:4] + change * more[4:])
    # A reflection of x changes the signs of the spin, of F_T and of M_R, and keeps F_A.
    share = np.where(r > 0.0, d.across / np.where(r > 0.0, r, 1.0), 0.0)
    forces[:3] *= np.stack([rho * share, rho * turned, rho * share])
    return np.where(there, forces, np.nan)
