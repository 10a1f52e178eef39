"""Where a value stands among rising knots; compiled."""

from __future__ import annotations

from numba import njit


@njit(cache=True, nogil=True)
def interval(value, knots, low, high):
    """Index i, low <= i < high, of the interval knots[i] <= value < knots[i + 1]; the outer ones reach beyond."""
    while high - low > 1:
        middle = (low + high) // 2
        if knots[middle] <= value:
            low = middle
        else:
            high = middle
    return low
