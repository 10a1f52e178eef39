"""Contact patches whose pressure was solved element by element, in place of Hertz's ellipse."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from trackroller.contact.normal.measure import Box, patch_box
from trackroller.numerics.rows import Rows

SLIGHT = 5e-3  # share of the largest pressure below which an element does not count as loaded


@dataclass(frozen=True)
class GridPatch(Rows):
    """n patches with the interface `protocol.Patch`, on grids of N x M elements over their boxes; M
    is a multiple of N.

    Attributes
    ----------
    semi_axis_lateral, semi_axis_rolling : numpy.ndarray, shape (n,)
        Half the sides of the box along x_C and y_C [mm].
    max_pressure : numpy.ndarray, shape (n,)
        Largest pressure [MPa].
    normal_force : numpy.ndarray, shape (n,)
        F_N [N].
    centre : numpy.ndarray, shape (n,)
        x_C of the middle of the box [mm].
    pressure : numpy.ndarray, shape (n, N, M)
        Mean pressure of each element [MPa].
    approach : numpy.ndarray, shape (n,)
        Approach of the two bodies [mm].
    area : numpy.ndarray, shape (n,)
        Area of the patch [mm^2].
    reaches_edge : numpy.ndarray of bool, shape (n,)
        True where the patch ends at an edge of the material.
    residual : numpy.ndarray, shape (n,)
        Residual of the normal problem, see `normal.pressure.NormalSolution`.
    """

    semi_axis_lateral: np.ndarray
    semi_axis_rolling: np.ndarray
    max_pressure: np.ndarray
    normal_force: np.ndarray
    centre: np.ndarray
    pressure: np.ndarray
    approach: np.ndarray
    area: np.ndarray
    reaches_edge: np.ndarray
    residual: np.ndarray

    is_hertzian: ClassVar[Literal[False]] = False

    @property
    def shape(self) -> tuple[int, int]:
        """Return the numbers of elements N along the rolling direction and M across it."""
        return self.pressure.shape[-2], self.pressure.shape[-1]

    @property
    def x(self) -> np.ndarray:
        """Return the lateral element centres, (n, M) [mm]."""
        return self.centre[:, None] + self.semi_axis_lateral[:, None] * _centres(self.shape[1])

    @property
    def y(self) -> np.ndarray:
        """Return the element centres along the rolling direction, (n, N) [mm]."""
        return self.semi_axis_rolling[:, None] * _centres(self.shape[0])

    @property
    def pressure_centre(self) -> np.ndarray:
        """Return x_C of the resultant of the pressure, (n,) [mm]."""
        across = self.pressure.sum(axis=1)
        with np.errstate(invalid="ignore"):
            return (across * self.x).sum(axis=1) / across.sum(axis=1)

    @property
    def half_extents(self) -> tuple[np.ndarray, np.ndarray]:
        """Return half the width and half the length of the loaded region, (n,) [mm].

        They are the sides of the box, except where the box has a margin around the loaded elements.
        """
        wide, long = self.semi_axis_lateral.copy(), self.semi_axis_rolling.copy()
        for i, pressure in enumerate(self.pressure):
            loaded = np.where(pressure > SLIGHT * np.max(pressure), pressure, 0.0)
            if loaded.any() and not loaded[[0, -1]].any():
                tight = patch_box(loaded, Box(-wide[i], wide[i], long[i]))
                wide[i], long[i] = 0.5 * (tight.high - tight.low), tight.half
        return wide, long

    def heights(self, elements: int) -> np.ndarray:
        """Return the mean pressure of larger cells over the largest pressure.

        Parameters
        ----------
        elements : int
            Number of cells along each axis, a divisor of N.

        Returns
        -------
        numpy.ndarray, shape (n, elements, elements)
            Relative pressures [1].

        Raises
        ------
        ValueError
            If `elements` does not divide the numbers of elements.
        """
        rows, columns = self.shape
        if rows % elements or columns % elements:
            raise ValueError(
                f"{elements} does not divide the {rows} x {columns} elements of the patch"
            )
        parts = len(self.normal_force), elements, rows // elements, elements, columns // elements
        mean = self.pressure.reshape(parts).mean(axis=(2, 4))
        return np.ascontiguousarray(mean / self.max_pressure[:, None, None])

    def refined(self, along: int, across: int) -> GridPatch:
        """Return the same patches with finer elements; the load of each original element stays the
        same.

        Within an element p^2, which is a parabola in Hertz's theory, follows the parabola through
        its neighbours.

        Parameters
        ----------
        along, across : int
            Number of new elements per element along the rolling direction and across it.
        """
        fine = self.pressure
        for axis, times in ((1, along), (2, across)):
            if times > 1:
                fine = np.moveaxis(_divided(np.moveaxis(fine, axis, 0), times), 0, axis)
        return dataclasses.replace(self, pressure=np.ascontiguousarray(fine))


def _divided(pressure: np.ndarray, times: int) -> np.ndarray:
    """Divide the elements of pressures (N, ...) along the first axis, (N times, ...); see
    `GridPatch.refined`.
    """
    square = np.pad(pressure**2, [(1, 1)] + [(0, 0)] * (pressure.ndim - 1))
    before, here, after = square[:-2], square[1:-1], square[2:]
    pieces = [
        np.sqrt(
            np.maximum(
                here + 0.5 * t * (after - before) + 0.5 * t * t * (after - 2 * here + before), 0.0
            )
        )
        for t in 0.5 * _centres(times)
    ]
    parts = np.stack(pieces, axis=1)
    mean = parts.mean(axis=1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        parts = np.where(mean > 0, parts * (pressure[:, None] / mean), pressure[:, None])
    return parts.reshape(-1, *pressure.shape[1:])


def _centres(elements: int) -> np.ndarray:
    """Return the centres of equal elements of [-1, 1], (elements,)."""
    return (2.0 * np.arange(elements) + 1.0) / elements - 1.0


PARTS = 4  # points along each side of an element at which the pressure near the rim is averaged
# The means replace the solved pressure if they keep at least KEPT of its maximum, and leave it
# unchanged if they keep no more than CUT_OFF.
CUT_OFF, KEPT = 0.85, 0.93


def _moved(values: np.ndarray, step: int, axis: int) -> np.ndarray:
    """Move values along an axis and fill the free end with zeros."""
    moved = np.roll(values, step, axis)
    np.moveaxis(moved, axis, 0)[slice(None, step) if step > 0 else slice(step, None)] = 0
    return moved


def _spread(values: np.ndarray, known: np.ndarray, onward: bool) -> np.ndarray:
    """Continue values (ny, nx) by one ring of elements around the `known` ones.

    With `onward` a new value lies on the line through the two nearest known values, otherwise it
    repeats the nearest one. Where several directions give a value, the ring has their mean. Onward
    it is not above 0, because the rim lies before it: without this limit an element that becomes
    loaded would change its neighbours in a jump.
    """
    total, count = np.zeros_like(values), np.zeros_like(values)
    for axis in (0, 1):
        for step in (1, -1):
            near, next_one = _moved(values, step, axis), _moved(values, 2 * step, axis)
            ring = ~known & _moved(known, step, axis)
            total[ring] += (2.0 * near - next_one if onward else near)[ring]
            count[ring] += 1.0
    new = total / np.maximum(count, 1.0)
    return np.where(count > 0, np.minimum(new, 0.0) if onward else new, values)


def rim_means(pressure: np.ndarray) -> np.ndarray:
    """Replace collocated pressures by element means; the rim of the patch runs through elements.

    Collocation treats an element as loaded or unloaded. Near the rim p^2 is linear, and it is
    quadratic in Hertz's theory. This function therefore continues p^2 outward, interpolates it, and
    averages its root over each element. Tractions in the adhesion area need these means: only with
    them do the rolling resultants converge as fast as on an ellipse. A ridge of pressure that is
    only a few elements wide would lose its maximum; its pressure stays as solved.

    Parameters
    ----------
    pressure : numpy.ndarray, shape (ny, nx)
        Solved pressures.

    Returns
    -------
    numpy.ndarray, shape (ny, nx)
        Pressures with the same sum.
    """
    ny, nx = pressure.shape
    known = np.pad(pressure > 0, 1)
    square = _spread(np.pad(pressure**2, 1), known, onward=True)
    ring = _spread(known.astype(float), known, onward=False) > 0
    square = _spread(square, ring, onward=False)
    t = (np.arange(PARTS) + 0.5) / PARTS - 0.5
    for axis in (0, 1):
        v = np.moveaxis(square, axis, 0)
        pieces = [v[1:-1] * (1 - abs(x)) + (v[2:] if x > 0 else v[:-2]) * abs(x) for x in t]
        square = np.moveaxis(np.stack(pieces, axis=1).reshape(-1, v.shape[1]), 0, axis)
    means = np.sqrt(np.maximum(square, 0.0)).reshape(ny, PARTS, nx, PARTS).mean(axis=(1, 3))
    means *= pressure.sum() / means.sum()
    kept, least = means.max() / pressure.max(), CUT_OFF
    share = min(max((kept - least) / (KEPT - least), 0.0), 1.0)
    return means if share == 1.0 else share * means + (1.0 - share) * pressure
