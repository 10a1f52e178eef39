"""Resultants of the exact rolling theory from a stored table, as in Kalker's program USETAB.

Over the coordinates of `trackroller.contact.table.coordinates` the table interpolates F_A/(mu N
rho), F_T/(mu N rho cos(chi) cos(theta)) and M_R/(mu N c rho cos(chi) cos(theta)), and the share of
the adhesion area. These functions are smooth and have the symmetries of the problem, so the forces
change their signs with those of the creepages and of K. One tensor product of cubic splines holds
them at nu = 0.3; a second, coarser one holds their first and second coefficient in nu - 0.3.
`validation.kalker_table` builds them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources as files
from typing import NamedTuple

import numpy as np

from trackroller.contact.linear import chebyshev
from trackroller.contact.quantities import Elastic, Patch, Resultants
from trackroller.contact.table.coordinates import HALF_WAY, Rolling, coordinates, in_range
from trackroller.numerics.compiled import compiled, fast
from trackroller.numerics.knots import interval
from trackroller.numerics.threads import share_rows

TABLE = "kalker_table.npz"
POISSON = 0.3  # Poisson's ratio of the finer of both splines
FIELDS = ("lateral", "driving", "spin", "stick")


class TensorSpline(NamedTuple):
    """Tensor product of cubic splines: four knot vectors, and coefficients (n1, n2, n3, n4,
    fields).
    """

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
    """Write the four nonzero cubic B-splines at x into `out`; return the index of the first one (de
    Boor).
    """
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


@fast
def evaluate(spline, place, basis, line, out):
    """Write the values of a `TensorSpline` at a place (4,) between its outer knots into `out`
    (fields,).

    basis (4, 4) and line (4 fields,) are work space.
    """
    (k0, k1, k2, k3), values = spline
    h, i, j = (
        _basis(k0, place[0], basis[0]),
        _basis(k1, place[1], basis[1]),
        _basis(k2, place[2], basis[2]),
    )
    fields = values.shape[4]
    first = _basis(k3, place[3], basis[3]) * fields
    rows = values.reshape(*values.shape[:3], values.shape[3] * fields)
    line[:] = 0.0
    for p in range(4):
        for q in range(4):
            w = basis[0, p] * basis[1, q]
            w0, w1, w2, w3 = w * basis[2, 0], w * basis[2, 1], w * basis[2, 2], w * basis[2, 3]
            block = rows[h + p, i + q, j : j + 4, first : first + line.size]
            for k in range(line.size):
                line[k] += w0 * block[0, k] + w1 * block[1, k] + w2 * block[2, k] + w3 * block[3, k]
    for f in range(fields):
        out[f] = 0.0
        for k in range(4):
            out[f] += basis[3, k] * line[k * fields + f]


@dataclass(frozen=True)
class Tables:
    """The table and its errors.

    Attributes
    ----------
    forces : TensorSpline
        The four fields at nu = 0.3, over (rho, chi, theta, ln g).
    poisson : TensorSpline
        First and second coefficient of the fields in nu - 0.3, eight in all, over the same
        coordinates.
    errors : dict of str to float
        Differences from the exact solver, measured by `validation.kalker_table`.
    """

    forces: TensorSpline
    poisson: TensorSpline
    errors: dict[str, float]

    def force_error(self, level: str) -> float:
        """Return the measured error of the forces over mu F_N of like and unlike bodies: 'median',
        'p99' or 'max'.
        """
        return max(self.errors[f"{kind}_force_{level}"] for kind in ("like", "unlike"))


def read(path) -> Tables:
    """Return the tables of an npz file."""
    with np.load(path, allow_pickle=False) as f:
        forces, poisson = (_read_spline(f, name) for name in ("forces", "poisson"))
        errors = zip(f["error_names"], f["error_values"], strict=True)
        return Tables(forces, poisson, {str(name): float(value) for name, value in errors})


def _read_spline(arrays, name: str) -> TensorSpline:
    knots = (np.ascontiguousarray(arrays[f"{name}_knots_{i}"], float) for i in range(4))
    return TensorSpline(tuple(knots), np.ascontiguousarray(arrays[f"{name}_values"], float))


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
    patches = Rolling.of(ellipse, longitudinal, spin, friction, elastic)
    unit, _, known = _looked_up(patches)
    capacity = patches.capacity
    unit[~known] = np.nan
    forces = Resultants(
        capacity * unit[:, 0], capacity * unit[:, 1], capacity * patches.size * unit[:, 2]
    )
    work = -(patches.longitudinal * forces.driving_force + patches.spin * forces.spin_moment)
    return TableSolution(forces, np.clip(unit[:, 3], 0.0, 1.0), work, known)


def nearest_forces(
    ellipse: Patch, longitudinal, spin, friction, elastic: Elastic
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the forces of the nearest patch that the table holds, and the place of the slip.

    Parameters are those of `solve_patch`. A patch outside the range takes the forces at the end of
    the range.

    Returns
    -------
    forces : numpy.ndarray, shape (n, 3)
        F_T/(mu N), F_A/(mu N) and M_R/(mu N c); NaN where there is no patch.
    place : numpy.ndarray, shape (n,)
        X/(3 + r) in (-1, 1).
    held : numpy.ndarray of bool, shape (n,)
        True for patches in the table's range.
    """
    patches = Rolling.of(ellipse, longitudinal, spin, friction, elastic)
    unit, place, held = _looked_up(patches)
    return unit[:, :3], place, held


def _looked_up(patches: Rolling) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Look n patches up in the stored table.

    Returns
    -------
    unit : numpy.ndarray, shape (n, 4)
        F_T/(mu N), F_A/(mu N), M_R/(mu N c) and the share of the adhesion area.
    place, held : numpy.ndarray, shape (n,)
        Place of the slip, and whether the table holds the patch; see `nearest_forces`.
    """
    n, tables, linear = patches.lateral.size, stored(), chebyshev()
    out = np.empty((n, 4)), np.empty(n), np.empty(n, bool)
    share_rows(
        lambda first, last: _look_up(
            first, last, patches, linear, tables.forces, tables.poisson, out
        ),
        n,
        512,
    )
    return out


@compiled
def _look_up(first, last, patches, linear, forces, poisson, out):
    """Write F_T/(mu N), F_A/(mu N), M_R/(mu N c) and the share of the adhesion area of patches into
    `unit` (n, 4).

    A patch outside the range takes the values at the end of the range. NaN where there is no patch.
    `place` (n,) takes X/(3 + r), and `held` (n,) whether the patch is in the range. `out` are these
    three arrays.
    """
    unit, place, held = out
    at = np.empty(4)  # coordinates of the table
    basis = np.empty((4, 4))
    # first and second change of each field with Poisson's ratio
    by_poisson = np.empty(2 * len(FIELDS))
    line = np.empty(4 * len(FIELDS))
    wide = np.empty(8 * len(FIELDS))
    for i in range(first, last):
        held[i] = in_range(patches.rolling[i] / patches.lateral[i])
        g, x, y, z = coordinates(patches, i, linear)
        r = math.sqrt(x * x + y * y + z * z)
        place[i] = x / (HALF_WAY + r)
        if not math.isfinite(r):
            unit[i] = np.nan
            continue
        # If both creepages and K change their signs, the tractions do so as well.
        sign = 1.0
        if z < 0.0 or (z == 0.0 and x < 0.0):
            sign = -1.0
        rho = r / (r + HALF_WAY)
        at[0] = rho
        at[1] = math.atan2(abs(z), math.sqrt(x * x + y * y))
        at[2] = math.atan2(sign * x, abs(y))
        at[3] = math.log(g)
        evaluate(forces, at, basis, line, unit[i])
        evaluate(poisson, at, basis, wide, by_poisson)
        change = patches.poisson_ratio[i] - POISSON
        for k in range(4):
            unit[i, k] += change * (by_poisson[k] + change * by_poisson[4 + k])
        # A reflection of x changes the signs of the spin, of F_T and of M_R, and keeps F_A.
        across = 0.0
        if r > 0.0:
            across = rho * (y / r)
        unit[i, 0] *= across
        unit[i, 1] *= rho * sign
        unit[i, 2] *= across
