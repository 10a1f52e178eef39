"""Patches whose pressure was solved on a grid, in place of Hertz's ellipse."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from trackroller.contact.common import Ellipse


@dataclass(frozen=True)
class GridPatch(Ellipse):
    """n patches on grids of N x M elements over the boxes that they fill, M a multiple of N.

    The inherited `semi_axis_lateral` and `semi_axis_rolling` are half the sides of the box, `max_pressure` the largest
    pressure. load : normal force [N]; centre : x_C of the middle of the box [mm]; pressure : mean of each element
    (n, N, M) [MPa]; approach [mm]; area [mm^2]; reaches_edge : the patch ends where the material does;
    residual : of the normal problem. Arrays (n,).
    """

    load: np.ndarray
    centre: np.ndarray
    pressure: np.ndarray
    approach: np.ndarray
    area: np.ndarray
    reaches_edge: np.ndarray
    residual: np.ndarray

    @property
    def normal_force(self) -> np.ndarray:
        """F_N [N], shape (n,)."""
        return self.load

    @property
    def shape(self) -> tuple[int, int]:
        """Elements N along the rolling direction and M across."""
        return self.pressure.shape[-2], self.pressure.shape[-1]

    @property
    def x(self) -> np.ndarray:
        """Lateral element centres (n, M) [mm]."""
        unit = _centres(self.shape[1])
        return self.centre[:, None] + self.semi_axis_lateral[:, None] * unit

    @property
    def y(self) -> np.ndarray:
        """Element centres along the rolling direction (n, N) [mm]."""
        return self.semi_axis_rolling[:, None] * _centres(self.shape[0])

    @property
    def pressure_centre(self) -> np.ndarray:
        """x_C of the resultant of the pressure [mm], shape (n,)."""
        across = self.pressure.sum(axis=1)
        return (across * self.x).sum(axis=1) / across.sum(axis=1)

    def heights(self, elements: int) -> np.ndarray:
        """Mean pressure over the largest in each of `elements` x `elements` cells, a divisor of N; (n, ., .)."""
        rows, columns = self.shape
        if rows % elements or columns % elements:
            raise ValueError(f"{elements} does not divide the {rows} x {columns} elements of the patch")
        parts = len(self.load), elements, rows // elements, elements, columns // elements
        mean = self.pressure.reshape(parts).mean(axis=(2, 4))
        return np.ascontiguousarray(mean / self.max_pressure[:, None, None])

    def refined(self, along: int, across: int) -> GridPatch:
        """The same patches with so many times the elements; the load of each element stays its own.

        Within an element p^2, which is a parabola in Hertz's theory, follows the parabola through its neighbours.
        """
        fine = self.pressure
        for axis, times in ((1, along), (2, across)):
            if times > 1:
                fine = np.moveaxis(_divided(np.moveaxis(fine, axis, 0), times), 0, axis)
        return dataclasses.replace(self, pressure=np.ascontiguousarray(fine))


def _divided(pressure: np.ndarray, times: int) -> np.ndarray:
    """Pressures (N, ...) of elements divided into `times` each, (N times, ...); see `GridPatch.refined`."""
    square = np.pad(pressure**2, [(1, 1)] + [(0, 0)] * (pressure.ndim - 1))
    before, here, after = square[:-2], square[1:-1], square[2:]
    pieces = [
        np.sqrt(np.maximum(here + 0.5 * t * (after - before) + 0.5 * t * t * (after - 2 * here + before), 0.0))
        for t in 0.5 * _centres(times)
    ]
    parts = np.stack(pieces, axis=1)
    mean = parts.mean(axis=1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        parts = np.where(mean > 0, parts * (pressure[:, None] / mean), pressure[:, None])
    return parts.reshape(-1, *pressure.shape[1:])


def _centres(elements: int) -> np.ndarray:
    return (2.0 * np.arange(elements) + 1.0) / elements - 1.0


PARTS = 4  # of an element's side, over which the pressure near the rim is averaged
CUT_OFF, KEPT = 0.85, 0.93  # shares of the largest pressure that means keep: none of them counts, all of them do


def _moved(values: np.ndarray, step: int, axis: int) -> np.ndarray:
    """Values moved along an axis; nothing comes in from the other end."""
    moved = np.roll(values, step, axis)
    np.moveaxis(moved, axis, 0)[slice(None, step) if step > 0 else slice(step, None)] = 0
    return moved


def _spread(values: np.ndarray, known: np.ndarray, onward: bool) -> np.ndarray:
    """Values (ny, nx) continued by one ring: the line through the two nearest `known`, or just their mean."""
    total, count = np.zeros_like(values), np.zeros_like(values)
    for axis in (0, 1):
        for step in (1, -1):
            near, next_one = _moved(values, step, axis), _moved(values, 2 * step, axis)
            ring = ~known & _moved(known, step, axis)
            total[ring] += (2.0 * near - next_one if onward else near)[ring]
            count[ring] += 1.0
    return np.where(count > 0, total / np.maximum(count, 1.0), values)


def rim_means(pressure: np.ndarray) -> np.ndarray:
    """Element means (ny, nx) of a solved pressure whose rim runs through elements; the sum stays.

    Collocation loads an element or does not. Near the rim p^2 is linear, and in Hertz's theory quadratic, so it
    is continued outward and interpolated, and its root averaged. Tractions in stick feel the difference: the rolling
    resultants converge as those on an ellipse only with it. Ridges a few elements wide are all rim: where the means
    would cut the summit off, the pressure stays as it was solved.
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
