"""Elements of a patch: mean pressure and covered area. Every ellipse is the unit circle after
scaling.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from trackroller.contact.grid_patch import GridPatch
from trackroller.contact.quantities import Ellipse


def _column_integrals(x: np.ndarray, edges: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the integrals over y of sqrt(1 - x^2 - y^2) and of 1 inside the circle, up to `edges`.

    Each has the shape (edges, x...).
    """
    square = np.maximum(1.0 - x**2, 1e-300)
    root = np.sqrt(square)
    y = np.clip(edges.reshape(-1, *(1,) * x.ndim), -root, root)
    height = np.sqrt(np.maximum(square - y * y, 0.0))
    return 0.5 * (y * height + square * np.arcsin(np.clip(y / root, -1.0, 1.0))), y


@lru_cache(maxsize=32)
def unit_cells(ny: int, nx: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the mean of sqrt(1 - x^2 - y^2) over ny x nx elements of [-1, 1]^2, and the share
    inside the circle.

    Both (ny, nx). Exact along y, 12 Gauss points along x; scaled so that the total is the circle's
    2 pi/3 and pi. The mean over the whole element keeps the friction of a patch independent of the
    grid.
    """
    nodes, weights = np.polynomial.legendre.leggauss(12)
    x = (np.arange(nx)[:, None] + 0.5 + nodes / 2) * 2.0 / nx - 1.0
    integrals = _column_integrals(x, np.linspace(-1.0, 1.0, ny + 1))
    height, share = ((np.diff(v, axis=0) * weights).sum(-1) * ny / 4.0 for v in integrals)
    height *= (2.0 * np.pi / 3.0) / (height.sum() * 4.0 / (nx * ny))
    share *= np.pi / (share.sum() * 4.0 / (nx * ny))
    height.setflags(write=False)
    share.setflags(write=False)
    return height, share


def cells(patch: Ellipse | GridPatch, elements: int) -> tuple[np.ndarray, np.ndarray]:
    """Return pressure and covered share of the elements of n patches.

    Parameters
    ----------
    patch : Ellipse or GridPatch
        Patches.
    elements : int
        Elements along each axis; on a solved patch a divisor of its own numbers.

    Returns
    -------
    tuple of ndarray
        Mean pressure over p_max, and share inside the patch: `unit_cells` (ny, nx) for ellipses,
        which are alike, or (n, ny, nx) for solved patches.
    """
    if patch.is_hertzian:
        return unit_cells(elements, elements)
    height = patch.heights(elements)
    share = (height > 0).astype(float)
    height.setflags(write=False)
    share.setflags(write=False)
    return height, share
