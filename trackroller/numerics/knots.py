"""Find intervals between rising knots and interpolate there, compiled; and a smooth step."""

from __future__ import annotations

import numpy as np

from trackroller.numerics.compiled import compiled


@compiled
def interval(value, knots, low, high):
    """Return the index i, low <= i < high, of the interval knots[i] <= value < knots[i + 1].

    Parameters
    ----------
    value : float
        Place to look up.
    knots : ndarray, shape (m,)
        Rising knots.
    low, high : int
        First and last knot to consider. The outer intervals extend to infinity.

    Returns
    -------
    int
        Index of the knot at the lower end of the interval.
    """
    while high - low > 1:
        middle = (low + high) // 2
        if knots[middle] <= value:
            low = middle
        else:
            high = middle
    return low


@compiled
def polyline(value, knots, values):
    """Return height and slope at `value` of the polyline through (knots, values).

    Parameters
    ----------
    value : float
        Place to look up.
    knots, values : ndarray, shape (m,)
        Rising knots and the heights there.

    Returns
    -------
    tuple of float
        Height and slope. Beyond the outer knots the height is constant and the slope is 0.
    """
    last = knots.size - 1
    if value < knots[0]:
        return values[0], 0.0
    if value >= knots[last]:
        return values[last], 0.0
    low = interval(value, knots, 0, last)
    slope = (values[low + 1] - values[low]) / (knots[low + 1] - knots[low])
    return values[low] + slope * (value - knots[low]), slope


def rise(value: np.ndarray, limits: tuple[float, float]) -> np.ndarray:
    """Return a smooth step of `value` from 0 at the first limit to 1 at the second."""
    t = np.clip((value - limits[0]) / (limits[1] - limits[0]), 0.0, 1.0)
    return t**2 * (3.0 - 2.0 * t)
