"""Extent, area and largest pressure of a patch from its element pressures, to a part of an
element.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Box:
    """Rectangle around a patch: `low` to `high` across, -`half` to `half` along the rolling
    direction [mm].
    """

    low: float
    high: float
    half: float

    def grid(self, rows: int, columns: int) -> tuple[np.ndarray, np.ndarray, float, float]:
        """Return element centres x (columns,), y (rows,) and the sides hx, hy of an element
        [mm].
        """
        x, y = (np.arange(columns) + 0.5) / columns, (np.arange(rows) + 0.5) / rows
        wide = self.high - self.low
        return self.low + wide * x, self.half * (2 * y - 1), wide / columns, 2 * self.half / rows

    def cell(self, elements: int) -> float:
        """Return the area of one of `elements` equal elements [mm^2]."""
        return 2.0 * self.half * (self.high - self.low) / elements


def _vanishing(sums: np.ndarray) -> float:
    """Return where sums over lines of elements vanish at the far end, in elements from the centre
    of the first line.

    For a Hertzian patch these sums are a parabola. The outermost line is covered in part only and
    is left out.
    """
    last = int(np.flatnonzero(sums > 0)[-1])
    if last < 4:
        return last + 0.5
    a, b, c = sums[last - 3], sums[last - 2], sums[last - 1]
    # of the parabola, at its last point
    curve, slope = 0.5 * (a - 2 * b + c), 0.5 * (3 * c - 4 * b + a)
    root = slope * slope - 4 * curve * c
    if slope >= 0 or root < 0:
        return last + 0.5
    step = 2 * c / (-slope + math.sqrt(root))
    return last - 1 + min(max(step, 0.5), 2.5)


def patch_box(pressure: np.ndarray, box: Box) -> Box:
    """Return the box that the patch fills.

    Parameters
    ----------
    pressure : numpy.ndarray, shape (ny, nx)
        Element pressures on `box`.
    box : Box
        Box of the elements.
    """
    across, along = pressure.sum(axis=0), pressure.sum(axis=1)
    hx, hy = (box.high - box.low) / across.size, 2 * box.half / along.size
    right, left = _vanishing(across) + 0.5, _vanishing(across[::-1]) + 0.5
    half = (_vanishing(along) + 0.5) * hy - box.half
    return Box(box.high - left * hx, box.low + right * hx, half)


def patch_area(pressure: np.ndarray, hx: float, hy: float) -> float:
    """Return the area of a patch [mm^2]; along each column p^2 follows a parabola to zero as in
    Hertz's theory.

    Parameters
    ----------
    pressure : numpy.ndarray, shape (ny, nx)
        Element pressures.
    hx, hy : float
        Element sides [mm].
    """
    total = 0.0
    for column in (pressure**2).T:
        if column.any():
            first, last = np.flatnonzero(column > 0)[[0, -1]]
            if last - first < 7:
                total += last - first + 1
                continue
            total += _vanishing(column) + _vanishing(column[::-1]) + 1 - column.size
    return total * hx * hy


def largest_pressure(pressure: np.ndarray) -> float:
    """Return the maximum of the parabolas that p^2 describes around its largest element (ny, nx).

    At an edge of the grid there is no parabola, and the largest element itself counts.
    """
    i, j = np.unravel_index(int(np.argmax(pressure)), pressure.shape)
    top = pressure[i, j] ** 2
    gain = 0.0
    for line, k in ((pressure[:, j] ** 2, i), (pressure[i, :] ** 2, j)):
        if 0 < k < line.size - 1 and line[k - 1] > 0 and line[k + 1] > 0:
            slope, curve = (
                0.5 * (line[k + 1] - line[k - 1]),
                line[k + 1] - 2 * line[k] + line[k - 1],
            )
            gain += -0.5 * slope * slope / curve if curve < 0 else 0.0
    return math.sqrt(top + gain)


def roughness(pressure: np.ndarray) -> float:
    """Return the largest second difference of p^2 in the lateral direction, over the largest p^2
    [1].

    It is small where the elements resolve the pressure. In Hertz's theory p^2 is a parabola, and
    the result is 8 over the square of the number of elements.

    Parameters
    ----------
    pressure : numpy.ndarray, shape (ny, nx)
        Element pressures; only elements between loaded ones count.
    """
    square = pressure**2
    bend = np.abs(square[:, 2:] - 2.0 * square[:, 1:-1] + square[:, :-2])
    inside = (pressure[:, 2:] > 0.0) & (pressure[:, :-2] > 0.0)
    return float(np.max(bend, where=inside, initial=0.0) / square.max())
