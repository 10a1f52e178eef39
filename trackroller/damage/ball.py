"""Compiled search for smallest balls, around the stress path of a point and around the stresses of
a plane.
"""

from __future__ import annotations

import math

import numpy as np

from trackroller.numerics.compiled import compiled

GAP, FINE = (
    1e-5,
    1e-10,
)  # relative gaps of a squared radius: for the radius, and for the centre, whose error is its root
# of the search, whose radius is an upper bound even if it gives up
MOST_MOVES, MOST_HELD, RIDGE = 200, 16, 1e-13


@compiled
def squared(u):  # pragma: no cover (compiled)
    total = 0.0
    for value in u:
        total += value * value
    return total


@compiled
def _write_slopes(columns, base, centre, out):  # pragma: no cover (compiled)
    """Write |u - c|^2 + h - |c|^2 of the points u, columns (d, p), with their base |u|^2 + h, (p,).

    The points stand in rows of their coordinates, so that the loop runs in vector registers.
    """
    for i in range(len(base)):
        out[i] = base[i]
    for j in range(len(centre)):
        twice, column = 2.0 * centre[j], columns[j]
        for i in range(len(base)):
            out[i] -= twice * column[i]


@compiled
def _solve(rows, n):  # pragma: no cover (compiled)
    """Solve n equations in place by Gaussian elimination: rows (n, n + 1) end with the solution."""
    for column in range(n):
        pivot = column
        for i in range(column + 1, n):
            if abs(rows[i, column]) > abs(rows[pivot, column]):
                pivot = i
        top = rows[pivot, column]
        if top == 0.0:
            continue
        for k in range(n + 1):
            swap = rows[column, k]
            rows[column, k] = rows[pivot, k] / top
            if pivot != column:
                rows[pivot, k] = swap
        for i in range(n):
            factor = rows[i, column]
            if i != column and factor != 0.0:
                for k in range(n + 1):
                    rows[i, k] -= factor * rows[column, k]


@compiled
def _write_even_weights(columns, slopes, centre, few, count, rows):  # pragma: no cover (compiled)
    """Write weights of sum 1, of any sign, of the first `count` points among `few` from whose mean
    all these points are equally far, into the last column of `rows`.

    Equations 2 (u_i - c)(u_k - c) w_k + lambda = |u_i - c|^2 + h_i. A small ridge serves points
    that depend on each other.
    """
    for i in range(count):
        for k in range(count):
            total = 0.0
            for j in range(len(centre)):
                total += (columns[j, few[i]] - centre[j]) * (columns[j, few[k]] - centre[j])
            rows[i, k] = 2.0 * total
        rows[i, i] *= 1.0 + RIDGE
        rows[i, count] = rows[count, i] = 1.0
        rows[i, count + 1] = slopes[few[i]]
    rows[count, count] = 0.0
    rows[count, count + 1] = 1.0
    _solve(rows, count + 1)


@compiled
def _hold(columns, slopes, centre, few, weight, count, rows):  # pragma: no cover (compiled)
    """Keep the points among `few` that hold their smallest ball, and their weights; return their
    number.

    The weights go straight to those of equal distances; a point whose weight vanishes on the way
    leaves.
    """
    while True:
        _write_even_weights(columns, slopes, centre, few, count, rows)
        share = 1.0
        for k in range(count):
            even = rows[k, count + 1]
            if even < 0.0:
                share = min(share, weight[k] / (weight[k] - even))
        kept = 0
        for k in range(count):
            own = weight[k] + share * (rows[k, count + 1] - weight[k])
            if share == 1.0 or own > 1e-12:
                few[kept], weight[kept] = few[k], own
                kept += 1
        count = kept
        if share == 1.0:
            return count


@compiled
def _farthest(slopes):  # pragma: no cover (compiled)
    """Return the number of the first largest value, and the value."""
    far, high = 0, -np.inf
    for i in range(len(slopes)):
        if slopes[i] > high:
            far, high = i, slopes[i]
    return far, high


@compiled
def _write_centre(columns, few, weight, centre):  # pragma: no cover (compiled)
    """Make the sum of weights 1, and write the mean of the points `few` into `centre`."""
    total = 0.0
    for own in weight:
        total += own
    centre[:] = 0.0
    for k in range(len(few)):
        weight[k] /= total
        for j in range(len(centre)):
            centre[j] += weight[k] * columns[j, few[k]]


@compiled
def smallest_ball(points, height, gap):  # pragma: no cover (compiled)
    """Return the smallest possible largest |u - c|^2 + h over the centres c.

    Parameters
    ----------
    points : numpy.ndarray
        u, (p, d).
    height : numpy.ndarray
        h >= 0, (p,).
    gap : float
        Relative gap at which the search ends [1].

    Returns
    -------
    value : float
        The smallest maximum, at most `gap` above the exact one.
    centre : numpy.ndarray
        c, (d,).
    few : numpy.ndarray
        Numbers of the points that hold the ball, (s,).
    weight : numpy.ndarray
        Their weights in the centre, (s,) [1]; the value changes by these shares of changes of |u -
        c|^2 + h.

    Notes
    -----
    The centre is a weighted mean of a few points (active set of the dual problem). The farthest of
    all points joins them until the ball holds all points; points whose weight vanishes leave.
    """
    p, d = points.shape
    columns = np.empty((d, p))
    base, slopes = np.empty(p), np.empty(p)
    for i in range(p):
        base[i] = height[i] + squared(points[i])
        for j in range(d):
            columns[j, i] = points[i, j]
    few, weight = np.empty(MOST_HELD, np.int64), np.empty(MOST_HELD)
    rows = np.empty((MOST_HELD + 1, MOST_HELD + 2))
    first, _ = _farthest(base)
    few[0], weight[0] = first, 1.0
    count = 1
    centre = points[first].copy()
    for move in range(MOST_MOVES):
        _write_slopes(columns, base, centre, slopes)
        far, high = _farthest(slopes)
        reached = 0.0
        for k in range(count):
            reached += weight[k] * slopes[few[k]]
        own = squared(centre)
        last = move == MOST_MOVES - 1 or count == MOST_HELD
        if high - reached <= gap * (reached + own) or last:
            break
        few[count], weight[count] = far, 0.0
        count = _hold(columns, slopes, centre, few, weight, count + 1, rows)
        _write_centre(columns, few[:count], weight[:count], centre)
    return high + own, centre, few[:count], weight[:count]


@compiled
def _gain(before, here, after):  # pragma: no cover (compiled)
    """Return how far the vertex of the parabola through three values lies above the middle one, the
    largest.
    """
    curve = before - 2.0 * here + after
    return (
        -((after - before) ** 2) / (8.0 * curve) if curve < 0.0 and before <= here >= after else 0.0
    )


@compiled
def ball_of_plane(stress):  # pragma: no cover (compiled)
    """Return the smallest largest J2 of a plane that a constant residual stress in xx, yy and xy
    allows.

    Parameters
    ----------
    stress : numpy.ndarray
        Stresses of the plane in the order of `halfspace.stress.COMPONENTS`, (6, y, x) [MPa].

    Returns
    -------
    float
        Largest |u|^2 + h [MPa2] with J2 = |u|^2 + h; a residual stress shifts u by any vector. The
        unloaded state counts as a point of the plane. Parabolas give the largest values between the
        places of the grid.
    """
    _, ny, nx = stress.shape
    u, h = np.zeros((ny * nx + 1, 3)), np.zeros(ny * nx + 1)
    for j in range(ny):
        for i in range(nx):
            x, y, z, at = stress[0, j, i], stress[1, j, i], stress[2, j, i], j * nx + i
            u[at, 0], u[at, 1], u[at, 2] = (
                (x - y) / 2.0,
                (2.0 * z - x - y) / math.sqrt(12.0),
                stress[3, j, i],
            )
            h[at] = stress[4, j, i] ** 2 + stress[5, j, i] ** 2
    value, centre, few, weight = smallest_ball(u, h, GAP)
    for k in range(len(few)):
        row, column = few[k] // nx, few[k] % nx
        for inside, step in ((0 < row < ny - 1, nx), (0 < column < nx - 1 and row < ny, 1)):
            if inside:
                ends = [
                    squared(u[at] - centre) + h[at] for at in (few[k] - step, few[k], few[k] + step)
                ]
                value += weight[k] * _gain(ends[0], ends[1], ends[2])
    return value


@compiled
def top_of_depths(shear, log_depth):  # pragma: no cover (compiled)
    """Return the largest of the values of planes, (depth,), and between the planes by the parabola
    through the largest value and its neighbours.

    Parameters
    ----------
    shear : numpy.ndarray
        Values on planes, (depth,) [MPa].
    log_depth : numpy.ndarray
        Logarithms of the depths, (depth,) [1].
    """
    top = np.argmax(shear)
    out = shear[top]
    if 0 < top < len(shear) - 1:
        left, right = log_depth[top] - log_depth[top - 1], log_depth[top + 1] - log_depth[top]
        fall, rise = (shear[top] - shear[top - 1]) / left, (shear[top + 1] - shear[top]) / right
        curve, slope = (
            (rise - fall) / (left + right),
            (fall * right + rise * left) / (left + right),
        )
        if curve < 0.0:
            out -= 0.25 * slope**2 / curve
    return out
