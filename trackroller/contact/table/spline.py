"""Resultants of the exact rolling theory from a stored table, as Kalker's USETAB, for `preview`.

Without lateral creepage the dimensionless problem has five numbers: the axis ratio g = b/a, Poisson's ratio, the two
creepages over what friction can bend, and kappa = K/mu. Creepages enter as a length and an angle,

    X = xi, Y = phi L,  L = c sqrt(g + 1/g)/2,  c = sqrt(a b),  r = hypot(X, Y) G c^2 C11/(mu N),
    rho = r/(r + 4),  theta = atan2(|X|, |Y|),

so that rho = 0 is the linear theory and rho = 1 complete sliding; both are exact in the table. What is interpolated,
F_A/(mu N rho sin(theta)), F_T/(mu N rho cos(theta)) and M_R/(mu N c rho cos(theta)), is smooth and even at both ends of
theta, which makes the forces odd in the creepages as they must be. Unlike materials act in the main as one more
longitudinal creepage, r_x + kappa C11 s(g) with a polynomial s in ln g; what they do beyond that is a second, coarser
table in kappa. Both are tensor products of cubic splines; made by `trackroller.contact.table.build`.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import lru_cache
from importlib import resources as files

import numpy as np
from numba import njit

from trackroller.contact.common import Elastic, Ellipse, Resultants
from trackroller.contact.linear import creepage_coefficients
from trackroller.numerics.knots import interval
from trackroller.numerics.threads import share_rows

TABLE = "kalker_table.npz"
HALF_WAY = 4.0  # r at rho = 1/2
RATIOS = (0.05, 20.0)  # of b/a
LARGEST_COUPLING = 1.5  # of |K|/mu
FIELDS = ("lateral", "driving", "spin", "stick")


@dataclass(frozen=True)
class Spline:
    """Tensor product of cubic splines: four knot vectors and the coefficients (n1, n2, n3, n4, fields)."""

    knots: tuple[np.ndarray, ...]
    values: np.ndarray


@dataclass(frozen=True)
class TableSolution:
    """What the table gives for n patches; NaN where `known` is False, that is outside its range.

    resultants : on the roller [N, N, N mm]
    stick_fraction : share of the ellipse that sticks [-]
    friction_energy_per_distance : dissipation [N], the work of the creepages -(xi F_A + phi M_R)
    """

    resultants: Resultants
    stick_fraction: np.ndarray
    friction_energy_per_distance: np.ndarray
    known: np.ndarray


@njit(cache=True, nogil=True)
def _basis(knots, x, out):
    """The four cubic B-splines that do not vanish at x, in `out`; returns the index of the first (de Boor)."""
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
    """Rows first..last of the tensor product at points (n, 4) into out (n, fields)."""
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
    """Values (n, fields) of `spline` at `points` (n, 4), which must lie between the outer knots."""
    points = np.ascontiguousarray(points, dtype=float)
    out = np.empty((len(points), spline.values.shape[4]))
    share_rows(lambda a, b: _evaluate(a, b, spline.knots, spline.values, points, out), len(points), 512)
    return out


@dataclass(frozen=True)
class Tables:
    """`like` over (rho, theta, ln g, nu), `unlike` over (rho, theta from -90 to 90 deg, ln g, kappa), `shift` s(ln g).

    `errors` against the exact solver on a fresh random sample, as `table.build` measured them.
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
    """The tables that come with the package."""
    place = files.files("trackroller.contact.table").joinpath(TABLE)
    with files.as_file(place) as path, np.load(path, allow_pickle=False) as f:
        like, unlike = (_read_spline(f, name) for name in ("like", "unlike"))
        names, values = f["error_names"], f["error_values"]
        return Tables(like, unlike, f["shift"], {str(n): float(v) for n, v in zip(names, values, strict=True)})


@dataclass(frozen=True)
class Dimensionless:
    """Normalised patches, arrays (n,): g, Poisson's ratio, r_x and r_y = components of r, kappa, C11.

    Where friction can bend nothing (mu N = 0), r is huge instead of infinite.
    """

    g: np.ndarray
    poisson: np.ndarray
    along: np.ndarray
    across: np.ndarray
    kappa: np.ndarray
    c11: np.ndarray


def normalise(ellipse: Ellipse, longitudinal, spin, friction, elastic: Elastic) -> Dimensionless:
    """The five numbers of patches with creepages xi [-] and phi [1/mm], arrays (n,)."""
    a, b = ellipse.semi_axis_lateral, ellipse.semi_axis_rolling
    g, square = b / a, a * b
    ratio = np.clip(np.where(np.isfinite(g), g, 1.0), *RATIOS)
    c11 = creepage_coefficients(ratio, elastic.poisson_ratio).c11
    arm = np.sqrt(square * (ratio + 1.0 / ratio)) / 2.0
    with np.errstate(divide="ignore", invalid="ignore"):
        bend = np.maximum(friction * ellipse.normal_force / (elastic.shear_modulus * square * c11), 1e-250)
        kappa = np.where((elastic.coupling == 0.0) | (friction == 0.0), 0.0, elastic.coupling / friction)
        return Dimensionless(g, elastic.poisson_ratio, longitudinal / bend, spin * arm / bend, kappa, c11)


def solve_patch(ellipse: Ellipse, longitudinal, spin, friction, elastic: Elastic) -> TableSolution:
    """Steady rolling with rigid slip w = (-phi y, xi + phi x) by the table.

    Parameters
    ----------
    ellipse : Hertzian patches, arrays (n,); b/a from 0.05 to 20
    longitudinal, spin : xi [-] and phi [1/mm], (n,)
    friction : coefficient mu [1], (n,); 0 gives no traction
    elastic : combined constants, arrays (n,); |K|/mu up to 1.5

    Error against the exact solver: `stored().errors`. Patches outside the range are NaN, never extrapolated.
    """
    xi, phi, mu = (np.asarray(v, float) for v in (longitudinal, spin, friction))
    d = normalise(ellipse, xi, phi, mu, elastic)
    edge = 1.0 + 1e-9
    known = (d.g >= RATIOS[0] / edge) & (d.g <= RATIOS[1] * edge) & (np.abs(d.kappa) <= LARGEST_COUPLING)
    known |= ~np.isfinite(d.g * d.kappa)  # no patch: NaN stays NaN
    rows = np.flatnonzero(known)
    unit = np.full((len(FIELDS), known.size), np.nan)
    inside = Dimensionless(*(np.broadcast_to(getattr(d, f.name), known.shape)[rows] for f in fields(d)))
    unit[:, rows] = unit_forces(inside)
    capacity = mu * ellipse.normal_force
    c = np.sqrt(ellipse.semi_axis_lateral * ellipse.semi_axis_rolling)
    forces = Resultants(capacity * unit[0], capacity * unit[1], capacity * c * unit[2])
    work = -(xi * forces.driving_force + phi * forces.spin_moment)
    return TableSolution(forces, np.clip(unit[3], 0.0, 1.0), work, known)


def unit_forces(d: Dimensionless) -> np.ndarray:
    """F_T/(mu N), F_A/(mu N), M_R/(mu N c) and the share of stick, shape (4, n)."""
    tables = stored()
    log_g = np.log(np.clip(d.g, *RATIOS))
    out = like_forces(tables.like, d, d.along + d.kappa * d.c11 * np.polyval(tables.shift, log_g))
    rows = np.flatnonzero(d.kappa != 0.0)
    if rows.size:
        # turning both creepages and K round turns the tractions round; mirroring x turns the spin round
        turned, side = np.sign(d.kappa[rows]), np.sign(d.across[rows])
        rho, angle = _polar(d.along[rows] * turned, d.across[rows])
        more = evaluate(tables.unlike, np.stack([rho, angle, log_g[rows], np.abs(d.kappa[rows])], axis=1)).T
        # mirrored, the spin changes sign and with it F_T and M_R, while F_A stays
        side *= np.cos(angle)
        out[:, rows] += np.stack([side * more[0], turned * more[1], side * more[2], more[3]])
    return out


def _polar(along: np.ndarray, across: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    length = np.hypot(along, across)
    return length / (length + HALF_WAY), np.arctan2(along, np.abs(across))


def like_forces(like: Spline, d: Dimensionless, along: np.ndarray) -> np.ndarray:
    """Bodies of one kind with the longitudinal part `along` of r, else as `unit_forces`."""
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
