"""Tractions on a body over grids of patches, and the slip of its surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Tractions:
    """Tractions on the roller over a grid of each patch, and the slip of its surface.

    Attributes
    ----------
    x, y : numpy.ndarray
        Coordinates of the grids, (..., nx) and (..., ny) [mm]; the axes before them count patches.
    pressure, shear_lateral, shear_rolling : numpy.ndarray
        Tractions, (..., ny, nx) [MPa].
    slip_lateral, slip_rolling : numpy.ndarray
        Slip velocity of the roller relative to the guide over travel speed, (..., ny, nx) [1].
    """

    x: np.ndarray
    y: np.ndarray
    pressure: np.ndarray
    shear_lateral: np.ndarray
    shear_rolling: np.ndarray
    slip_lateral: np.ndarray
    slip_rolling: np.ndarray
