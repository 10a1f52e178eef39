"""Patches whose pressure was solved on a grid, in place of Hertz's ellipse."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trackroller.contact.common import Ellipse


@dataclass(frozen=True)
class GridPatch(Ellipse):
    """n patches on grids of N x N elements over the boxes that they fill.

    The inherited `semi_axis_lateral` and `semi_axis_rolling` are half the sides of the box, `max_pressure` the largest
    pressure. load : normal force [N]; centre : x_C of the middle of the box [mm]; pressure : mean of each element
    (n, N, N) [MPa]; approach [mm]; area [mm^2]; reaches_edge : the patch ends where the material does;
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
    def elements(self) -> int:
        """Number along each axis."""
        return self.pressure.shape[-1]

    @property
    def x(self) -> np.ndarray:
        """Lateral element centres (n, N) [mm]."""
        unit = (2.0 * np.arange(self.elements) + 1.0) / self.elements - 1.0
        return self.centre[:, None] + self.semi_axis_lateral[:, None] * unit

    @property
    def y(self) -> np.ndarray:
        """Element centres along the rolling direction (n, N) [mm]."""
        unit = (2.0 * np.arange(self.elements) + 1.0) / self.elements - 1.0
        return self.semi_axis_rolling[:, None] * unit

    @property
    def pressure_centre(self) -> np.ndarray:
        """x_C of the resultant of the pressure [mm], shape (n,)."""
        across = self.pressure.sum(axis=1)
        return (across * self.x).sum(axis=1) / across.sum(axis=1)

    def heights(self, elements: int) -> np.ndarray:
        """Mean pressure over the largest in each of `elements` x `elements` cells, a divisor of N; (n, ., .)."""
        n, full = len(self.load), self.elements
        ratio = full // elements
        if ratio * elements != full:
            raise ValueError(f"{elements} does not divide the {full} elements of the patch")
        mean = self.pressure.reshape(n, elements, ratio, elements, ratio).mean(axis=(2, 4))
        return np.ascontiguousarray(mean / self.max_pressure[:, None, None])
