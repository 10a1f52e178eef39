"""Compiled sums of the half-space kernels over a loaded grid.

A traction field that is bilinear between the nodes of a grid, or uniform in cells around them, is a
sum of corner loads. With the corner function S of `kernels.py`, which follows from the potentials
of eqs (1)-(5), the stress at a point is the sum over the corners of S times the second (first)
differences of the nodal tractions. This sum is exact: it needs no numerical integration, and no
term is singular at z = 0. Far away the differences would cancel digits; there the load is a set of
point forces with the same second moments.

The kernels are compiled at the first call and cached on disk. The sums release the interpreter
lock, so that `stress.py` runs them in threads.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from trackroller.halfspace.kernels import bilinear_corner, point_kernel
from trackroller.numerics.compiled import compiled, woven

Array = NDArray[np.float64]
# grid spacings from the load where corner sums and point forces agree best (1e-8 of the local
# stress)
FAR = 100.0
# Rows of stress parts (4, 6): the stress is PRESSURE + nu PRESSURE_NU + sign (SHEAR + nu SHEAR_NU).
PRESSURE, PRESSURE_NU, SHEAR, SHEAR_NU = range(4)
# Places in the 36 numbers of a kernel: six components for each load, first without and then with
# the factor nu.
LOAD_X, LOAD_Y, LOAD_Z, NU = 0, 6, 12, 18
POINT_FORCES, BILINEAR = range(2)


class GridLoads(NamedTuple):
    """Places (m, 2) in grid spacings and their weights of q_x, q_y, p (m, 3) [MPa]; `kind` names
    the kernel.
    """

    places: Array
    weights: Array
    kind: int


class LoadedBox(NamedTuple):
    """Loaded rectangle in grid spacings."""

    x_min: float
    x_max: float
    y_min: float
    y_max: float


class CornerLoads(NamedTuple):
    """Loads of a grid at its corners (`near`) and at its nodes (`far`), in units of `length` [mm].

    At points further than `reach` grid spacings from `box` the point forces `far` are used.
    """

    length: float
    near: GridLoads
    far: GridLoads
    box: LoadedBox
    reach: float


def _second_difference(q: Array, axis: int) -> Array:
    pad = [(0, 0)] * q.ndim
    pad[axis] = (2, 2)
    return np.diff(np.pad(q, pad), n=2, axis=axis)


def _moment_corrected(q: Array, axis: int, second_moment: float) -> Array:
    """Return nodal forces with the total, centre and second moment of the loads; one node more at
    each end.
    """
    pad = [(0, 0)] * q.ndim
    pad[axis] = (1, 1)
    return np.pad(q, pad) + 0.5 * second_moment * _second_difference(q, axis)


def _kept(x: Array, y: Array, weights: Array, kind: int) -> GridLoads:
    """Return the loads whose weights are not all zero."""
    used = np.any(weights != 0.0, axis=-1)
    yy, xx = np.meshgrid(y, x, indexing="ij")
    return GridLoads(
        np.stack([xx[used], yy[used]], axis=-1), np.ascontiguousarray(weights[used]), kind
    )


def corner_loads(x: Array, y: Array, tractions: Array) -> CornerLoads:
    """Return the corner loads and point forces of tractions on a regular grid.

    Parameters
    ----------
    x, y : numpy.ndarray, shape (nx,) and (ny,)
        Node coordinates [mm].
    tractions : numpy.ndarray, shape (ny, nx, 3)
        q_x, q_y, p at the nodes [MPa], bilinear between them.
    """
    hx, hy = (x[-1] - x[0]) / (x.size - 1), (y[-1] - y[0]) / (y.size - 1)
    length = float(max(hx, hy))
    gx, gy = hx / length, hy / length
    near = _second_difference(_second_difference(tractions, 0), 1) / (gx * gy)
    moment = 1.0 / 6.0  # second moment of a hat of unit area over h^2
    far = _moment_corrected(_moment_corrected(tractions, 0, moment), 1, moment) * gx * gy
    across, along = (
        v[0] / length + g * (np.arange(v.size + 2) - 1.0) for g, v in ((gx, x), (gy, y))
    )
    corners = _kept(across, along, near, BILINEAR)
    low, high = (
        (corners.places.min(0), corners.places.max(0))
        if corners.places.size
        else (np.zeros(2), np.zeros(2))
    )
    box = LoadedBox(*(float(v) for v in (low[0], high[0], low[1], high[1])))
    return CornerLoads(length, corners, _kept(across, along, far, POINT_FORCES), box, FAR)


@woven
def add_load(k, q_x, q_y, p, out):  # pragma: no cover (compiled)
    """Add the stresses of tractions q_x, q_y, p with the kernel values `k` (36,) to the stress
    parts `out` (4, 6).
    """
    for c in range(6):
        out[PRESSURE, c] += p * k[LOAD_Z + c]
        out[PRESSURE_NU, c] += p * k[NU + LOAD_Z + c]
        out[SHEAR, c] += q_x * k[LOAD_X + c] + q_y * k[LOAD_Y + c]
        out[SHEAR_NU, c] += q_x * k[NU + LOAD_X + c] + q_y * k[NU + LOAD_Y + c]


@compiled
def _sum(loads, x, y, z, out):  # pragma: no cover (compiled)
    """Add the stress parts of loads at one point (in grid spacings) to `out` (4, 6)."""
    for j in range(loads.places.shape[0]):
        dx, dy = x - loads.places[j, 0], y - loads.places[j, 1]
        if loads.kind == BILINEAR:
            k = bilinear_corner(dx, dy, z)
        else:
            k = point_kernel(dx, dy, z)
        add_load(k, loads.weights[j, 0], loads.weights[j, 1], loads.weights[j, 2], out)


@compiled
def _sum_points(loads, points, out):  # pragma: no cover (compiled)
    """Add the stress parts of corner loads at points (n, 3) [mm] to `out` (n, 4, 6)."""
    box = loads.box
    for i in range(points.shape[0]):
        x, y, z = (
            points[i, 0] / loads.length,
            points[i, 1] / loads.length,
            points[i, 2] / loads.length,
        )
        dx = max(box.x_min - x, 0.0, x - box.x_max)
        dy = max(box.y_min - y, 0.0, y - box.y_max)
        if dx * dx + dy * dy + z * z > loads.reach * loads.reach:
            _sum(loads.far, x, y, z, out[i])
        else:
            _sum(loads.near, x, y, z, out[i])


def stress_parts(loads: CornerLoads, points: Array) -> Array:
    """Return the stress parts at points below a grid, as `stress.body_stress` takes them.

    Parameters
    ----------
    loads : CornerLoads
        See `corner_loads`.
    points : numpy.ndarray, shape (n, 3)
        Coordinates, z >= 0 [mm].

    Returns
    -------
    numpy.ndarray, shape (n, 4, 6)
        Stress parts [MPa].
    """
    out = np.zeros((len(points), 4, 6))
    _sum_points(loads, np.ascontiguousarray(points), out)
    return out
