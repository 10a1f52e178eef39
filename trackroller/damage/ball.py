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
MOST_MOVES, RIDGE = 200, 1e-13  # of the search, whose radius is an upper bound even if it gives up


@compiled
def squared(u):  # pragma: no cover (compiled)
    total = 0.0
    for value in u:
        total += value * value
    return total


@compiled
def _slope(point, base, centre):  # pragma: no cover (compiled)
    """Return |u - c|^2 + h - |c|^2 of a point u (d,) with its base |u|^2 + h."""
    slope = base
    for j in range(len(centre)):
        slope -= 2.0 * centre[j] * point[j]
    return slope


@compiled
def _even_weights(points, base, centre):  # pragma: no cover (compiled)
    """Return weights of sum 1, of any sign, of the points from whose mean all these points are
    equally far.

    Gaussian elimination of 2 (u_i - c)(u_k - c) w_k + lambda = |u_i - c|^2 + h_i. A small ridge
    serves points that depend on each other.
    """
    n = len(points)
    rows = np.ones((n + 1, n + 2))
    for i in range(n):
        for k in range(n):
            total = 0.0
            for j in range(len(centre)):
                total += (points[i, j] - centre[j]) * (points[k, j] - centre[j])
            rows[i, k] = 2.0 * total
        rows[i, n + 1] = _slope(points[i], base[i], centre)
    for i in range(n):
        rows[i, i] *= 1.0 + RIDGE
    rows[n, n] = 0.0
    for column in range(n + 1):
        pivot = column + np.argmax(np.abs(rows[column:, column]))
        if rows[pivot, column] == 0.0:
            continue
        swap = rows[column].copy()
        rows[column], rows[pivot] = rows[pivot], swap
        rows[column] /= rows[column, column]
        for i in range(n + 1):
            if i != column and rows[i, column] != 0.0:
                rows[i] -= rows[i, column] * rows[column]
    return rows[:n, n + 1]


@compiled
def _held(points, base, few, weight, centre):  # pragma: no cover (compiled)
    """Return the points among `few` that hold their smallest ball, and their weights.

    The weights go straight to those of equal distances; a point whose weight vanishes on the way
    leaves.
    """
    while True:
        even, share = _even_weights(points[few], base[few], centre), 1.0
        for k in range(len(few)):
            if even[k] < 0.0:
                share = min(share, weight[k] / (weight[k] - even[k]))
        weight = weight + share * (even - weight)
        if share == 1.0:
            return few, weight
        kept = weight > 1e-12
        few, weight = few[kept], weight[kept]


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
    base = height.copy()
    for i in range(len(points)):
        base[i] += squared(points[i])
    few, weight = np.array([np.argmax(base)]), np.ones(1)
    centre = points[few[0]].copy()
    for move in range(MOST_MOVES):
        far, high, reached = 0, -np.inf, 0.0
        for i in range(len(points)):
            slope = _slope(points[i], base[i], centre)
            far, high = (i, slope) if slope > high else (far, high)
        for k in range(len(few)):
            reached += weight[k] * _slope(points[few[k]], base[few[k]], centre)
        own = squared(centre)
        if high - reached <= gap * (reached + own) or move == MOST_MOVES - 1:
            break
        few, weight = np.append(few, far), np.append(weight, 0.0)
        few, weight = _held(points, base, few, weight, centre)
        weight /= np.sum(weight)
        centre[:] = 0.0
        for k in range(len(few)):
            centre += weight[k] * points[few[k]]
    return high + own, centre, few, weight


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
