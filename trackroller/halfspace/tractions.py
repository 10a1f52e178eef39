"""Tractions on a body over grids of patches, and the slip of its surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


def lengths(across: np.ndarray, along: np.ndarray) -> np.ndarray:
    """Return the lengths of vectors with two parts; their squares must be numbers.

    `numpy.hypot` also serves vectors whose squares overflow, and takes eight times as long.
    """
    return np.asarray(np.sqrt(across**2 + along**2))


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

    @property
    def shear(self) -> np.ndarray:
        """Return the shear |tau|, (..., ny, nx) [MPa]."""
        return lengths(self.shear_lateral, self.shear_rolling)

    @property
    def slip(self) -> np.ndarray:
        """Return the slip |s| per distance travelled, (..., ny, nx) [1]."""
        return lengths(self.slip_lateral, self.slip_rolling)
