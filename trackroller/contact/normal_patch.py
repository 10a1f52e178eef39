"""Patches whose pressure was solved on a grid, in place of Hertz's ellipse."""

from __future__ import annotations

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


def _centres(elements: int) -> np.ndarray:
    return (2.0 * np.arange(elements) + 1.0) / elements - 1.0
