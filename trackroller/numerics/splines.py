"""Cubic splines through fields of values at the centres of elements, and between any of their
points.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from trackroller.numerics.compiled import assign, fast


class Spline(NamedTuple):
    """Cubic spline through values at the centres of n elements, evaluated at m points.

    `bands` (n, 5) are the factors L U of the matrix that turns coefficients of B-splines into
    values, from two places before the diagonal to two behind it; the diagonal is inverted. At a
    point four B-splines are not 0: `first` (m,) is the number of the first one, and `weights` (m,
    4) are their values.
    """

    bands: np.ndarray
    first: np.ndarray
    weights: np.ndarray


@lru_cache(maxsize=64)
def _through(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the powers of the four B-splines between knots, (4, n - 3, 4), highest first, and the
    `bands` of a spline.

    The knots are the centres but the second and the last but one (not-a-knot).
    """
    knots = np.concatenate([np.zeros(4), np.arange(2.0, n - 2.0), np.full(4, n - 1.0)])
    intervals = np.arange(3, n)  # begin at their knots, where the powers have their origin
    powers = np.stack(
        [_derivatives(knots, intervals, order) / math.factorial(order) for order in (3, 2, 1, 0)]
    )
    first, weights = _weights(powers, np.arange(n))
    matrix, bands = np.zeros((n, n)), np.zeros((n, 5))
    np.put_along_axis(matrix, first[:, None] + np.arange(4), weights, axis=1)
    for k in range(n):  # without exchange of rows: the matrix is totally positive
        for i in range(k + 1, min(k + 3, n)):
            matrix[i, k] /= matrix[k, k]
            matrix[i, k + 1 : k + 3] -= matrix[i, k] * matrix[k, k + 1 : k + 3]
    for d in range(-2, 3):
        bands[max(-d, 0) : n - max(d, 0), d + 2] = matrix.diagonal(d)
    bands[:, 2] = 1.0 / bands[:, 2]
    return powers, bands


def _derivatives(knots: np.ndarray, intervals: np.ndarray, order: int) -> np.ndarray:
    """Return a derivative of the four cubic B-splines that are not 0 at the beginnings of
    intervals, (m, 4).

    The recursion is that of `scipy.interpolate.BSpline`, with the same bits. SciPy's package takes
    a tenth of the start-up of a command.

    Parameters
    ----------
    knots : numpy.ndarray
        Knots, rising, with the outer ones four times.
    intervals : numpy.ndarray
        Places among the knots, (m,), each lower than the knot behind it.
    order : int
        0 for the values, 1 to 3 for a derivative.

    References
    ----------
    de Boor (1978): A Practical Guide to Splines, chapter X.
    """
    point = knots[intervals]
    splines = [np.ones(len(intervals))]
    for degree in (1, 2, 3):
        raised = [np.zeros(len(intervals)) for _ in range(degree + 1)]
        for k, spline in enumerate(splines, start=1):
            right = knots[intervals + k]
            left = knots[intervals + k - degree]
            if degree <= 3 - order:
                share = spline / (right - left)
                raised[k - 1] += share * (right - point)
                raised[k] = share * (point - left)
            else:
                slope = degree * spline / (right - left)
                raised[k - 1] -= slope
                raised[k] = slope
        splines = raised
    return np.stack(splines, axis=1)


def _weights(powers: np.ndarray, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the number of the first B-spline that is not 0 at points (m,), and the values of four,
    (m, 4).
    """
    first = np.clip(np.floor(points).astype(np.int64) - 1, 0, powers.shape[1] - 1)
    past = (points - np.where(first > 0, first + 1, 0))[:, None]  # the last knot before the point
    cubic, square, linear, constant = powers[:, first]
    return first, ((cubic * past + square) * past + linear) * past + constant


def spline_at(n: int, points: np.ndarray) -> Spline:
    """Return the spline at `points` (m,), counted from the first centre on; it is constant beyond
    the outer centres.
    """
    powers, bands = _through(n)
    return Spline(bands, *_weights(powers, np.clip(points, 0.0, n - 1.0)))


@lru_cache(maxsize=32)
def _spline(n: int, parts: float) -> Spline:
    """Return the spline with `parts` points a side of each element."""
    return spline_at(n, (np.arange(parts * n) + 0.5) / parts - 0.5)


def interpolated(field: np.ndarray, across: float, along: float) -> np.ndarray:
    """Interpolate a field (..., ny, nx) by cubic splines, with `across` and `along` points a side
    of each element.
    """
    ny, nx = field.shape[-2:]
    return by_splines(field, _spline(ny, along), _spline(nx, across))


def by_splines(field: np.ndarray, y: Spline, x: Spline) -> np.ndarray:
    """Interpolate a field (..., ny, nx) at the points of splines along both axes."""
    out = np.empty((*field.shape[:-2], y.first.size, x.first.size))
    _interpolate(
        np.ascontiguousarray(field).reshape(-1, *field.shape[-2:]),
        y,
        x,
        out.reshape(-1, *out.shape[-2:]),
    )
    return out


@fast
def _interpolate(fields, y, x, out):
    """Write the splines through fields (m, ny, nx) into `out`."""
    ny, nx = fields.shape[1:]
    spline, wide = np.empty((ny, nx)), np.empty((ny, out.shape[2]))
    for k in range(len(fields)):
        assign(spline, fields[k])
        _to_coefficients(spline, y.bands)
        _to_coefficients(spline.T, x.bands)
        for i in range(ny):
            for j in range(out.shape[2]):
                t, w = x.first[j], x.weights[j]
                near, far = w[0] * spline[i, t] + w[1] * spline[i, t + 1], w[2] * spline[i, t + 2]
                wide[i, j] = near + far + w[3] * spline[i, t + 3]
        for i in range(out.shape[1]):
            t, w = y.first[i], y.weights[i]
            for j in range(out.shape[2]):
                near, far = (
                    w[0] * wide[t, j] + w[1] * wide[t + 1, j],
                    w[2] * wide[t + 2, j] + w[3] * wide[t + 3, j],
                )
                out[k, i, j] = near + far


@fast
def _to_coefficients(values, bands):
    """Turn the values (n, m) of m splines into coefficients of B-splines, in place; `bands` are
    those of `Spline`.
    """
    n, m = values.shape
    for i in range(n):
        for d in range(max(i - 2, 0), i):
            for j in range(m):
                values[i, j] -= bands[i, d - i + 2] * values[d, j]
    for i in range(n - 1, -1, -1):
        for d in range(i + 1, min(i + 3, n)):
            for j in range(m):
                values[i, j] -= bands[i, d - i + 2] * values[d, j]
        for j in range(m):
            values[i, j] *= bands[i, 2]
