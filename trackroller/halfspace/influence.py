"""Compiled sums of the half-space kernels over a loaded grid.

A traction field that is bilinear between the nodes of a grid (or uniform in cells around them) is a sum of corner
loads: with S the corner function of `kernels.py`, the stress at a point is the sum over the corners of S times the
second (first) differences of the nodal tractions, exactly. Nothing is integrated numerically and nothing is singular
at z = 0. Far away, where those differences would cancel digits, the same load is a set of point forces with the
right second moments.

The kernels are compiled on first use and cached on disk; the sums release the interpreter lock, so that
`stress.py` runs them in threads.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numba
import numpy as np
from numpy.typing import NDArray

from trackroller.halfspace.kernels import bilinear_corner, point_kernel, uniform_corner

Array = NDArray[np.float64]
FAR = 100.0  # grid spacings from the load where corner sums and point forces agree best (1e-8 of the local stress)


@dataclass(frozen=True)
class CornerLoads:
    """Loads at the corners (near) and nodes (far) of a grid, in units of `length` [mm].

    corners, nodes : (m, 2) coordinates / length;  near, far : (m, 3) weights of q_x, q_y, q_z [MPa];
    box : x_min, x_max, y_min, y_max of the loaded rectangle / length;  bilinear : False for uniform cells.
    """

    length: float
    corners: Array
    near: Array
    nodes: Array
    far: Array
    box: Array
    reach: float
    bilinear: bool


def _difference(q: Array, axis: int, order: int) -> Array:
    pad = [(0, 0)] * q.ndim
    pad[axis] = (order, order)
    return np.diff(np.pad(q, pad), n=order, axis=axis)


def _moment_corrected(q: Array, axis: int, second_moment: float) -> Array:
    """Nodal forces with the total, centre and second moment of the loads around the nodes (one node more each end)."""
    pad = [(0, 0)] * q.ndim
    pad[axis] = (1, 1)
    return np.pad(q, pad) + 0.5 * second_moment * _difference(q, axis, 2)


def _kept(x: Array, y: Array, weights: Array) -> tuple[Array, Array]:
    used = np.any(weights != 0.0, axis=-1)
    yy, xx = np.meshgrid(y, x, indexing="ij")
    return np.stack([xx[used], yy[used]], axis=-1), np.ascontiguousarray(weights[used])


def corner_loads(x: Array, y: Array, tractions: Array, bilinear: bool = True) -> CornerLoads:
    """Corner and far-field loads of tractions (ny, nx, 3) [MPa] on the regular grid x (nx,), y (ny,) [mm]."""
    hx, hy = (x[-1] - x[0]) / (x.size - 1), (y[-1] - y[0]) / (y.size - 1)
    length = max(hx, hy)
    gx, gy = hx / length, hy / length
    order = 2 if bilinear else 1
    near = _difference(_difference(tractions, 0, order), 1, order)
    if bilinear:
        near = near / (gx * gy)
    # second moment of a hat of unit area is h^2/6, of a uniform cell h^2/12
    moment = 1.0 / 6.0 if bilinear else 1.0 / 12.0
    far = _moment_corrected(_moment_corrected(tractions, 0, moment), 1, moment) * gx * gy
    half = 1.0 if bilinear else 0.5
    at = [g * (np.arange(n + order) - half) for g, n in ((gx, x.size), (gy, y.size))]
    outer = [g * (np.arange(n + 2) - 1.0) for g, n in ((gx, x.size), (gy, y.size))]
    x0, y0 = x[0] / length, y[0] / length
    corners, near = _kept(x0 + at[0], y0 + at[1], near)
    nodes, far = _kept(x0 + outer[0], y0 + outer[1], far)
    low, high = (corners.min(0), corners.max(0)) if corners.size else (np.zeros(2), np.zeros(2))
    box = np.array([low[0], high[0], low[1], high[1]])
    return CornerLoads(length, corners, near, nodes, far, box, FAR, bilinear)


@numba.njit(cache=True, error_model="numpy", nogil=True)
def _sum(kind, x, y, z, places, weights, out):  # pragma: no cover (compiled)
    """Adds A (6) and B (6) of the loads at one point; kind 0 point forces, 1 uniform, 2 bilinear corners."""
    for j in range(places.shape[0]):
        dx, dy = x - places[j, 0], y - places[j, 1]
        if kind == 2:
            k = bilinear_corner(dx, dy, z)
        elif kind == 1:
            k = uniform_corner(dx, dy, z)
        else:
            k = point_kernel(dx, dy, z)
        qx, qy, qz = weights[j, 0], weights[j, 1], weights[j, 2]
        for c in range(12):
            o = c if c < 6 else c + 12
            out[c] += qx * k[o] + qy * k[o + 6] + qz * k[o + 12]


@numba.njit(cache=True, error_model="numpy", nogil=True)
def sum_points(points, corners, near, nodes, far, box, reach, kind, out):  # pragma: no cover (compiled)
    """Stress parts at points (n, 3) (in the loads' unit of length) into out (n, 12): A then B of six components."""
    for i in range(points.shape[0]):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        dx = max(box[0] - x, 0.0, x - box[1])
        dy = max(box[2] - y, 0.0, y - box[3])
        if dx * dx + dy * dy + z * z > reach * reach:
            _sum(0, x, y, z, nodes, far, out[i])
        else:
            _sum(kind, x, y, z, corners, near, out[i])


@numba.njit(cache=True, error_model="numpy", nogil=True)
def corner_table(x, y, z, poisson_ratio):  # pragma: no cover (compiled)
    """`bilinear_corner` as A + nu B at every pair of y (ny,) and x (nx,), depth z: (18, ny, nx), in grid units."""
    table = np.empty((18, y.size, x.size))
    for j in range(y.size):
        for i in range(x.size):
            k = bilinear_corner(x[i], y[j], z)
            for c in range(18):
                table[c, j, i] = k[c] + poisson_ratio * k[c + 18]
    return table


def stress_parts(loads: CornerLoads, points: Array) -> Array:
    """Stress of `loads` at points (n, 3) [mm] as (n, 2, 6): sigma = [:, 0] + nu [:, 1] [MPa]."""
    out = np.zeros((points.shape[0], 12))
    kind = 2 if loads.bilinear else 1
    sum_points(
        points / loads.length, loads.corners, loads.near, loads.nodes, loads.far, loads.box, loads.reach, kind, out
    )
    return out.reshape(-1, 2, 6)


def hat_influence(hx: float, hy: float, nx: int, ny: int, depth: float, poisson_ratio: float) -> Iterator[Array]:
    """Stress of unit hat loads (bilinear, one node) at node offsets -(n-1)..n-1 and `depth` [mm].

    Yields (6, 2 ny - 1, 2 nx - 1) for the loads q_x, q_y, q_z in turn [MPa per MPa]; one at a time saves memory.
    """
    length = max(hx, hy)
    gx, gy = hx / length, hy / length
    table = corner_table(gx * np.arange(-nx, nx + 1), gy * np.arange(-ny, ny + 1), depth / length, poisson_ratio)
    for load in range(3):
        corners = table[6 * load : 6 * load + 6]
        yield np.diff(np.diff(corners, n=2, axis=1), n=2, axis=2) / (gx * gy)
