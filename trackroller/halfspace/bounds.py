"""A lower bound of the peak stress of a patch at the cost of a few points."""

from __future__ import annotations

import numpy as np

from trackroller.halfspace.ellipse import NO_FIELD, stress_parts
from trackroller.halfspace.stress import von_mises

# Depths over the smaller semi-axis: the surface, and where the frictionless peak lies for nu 0 to 0.5 from the
# circle (0.38..0.55) to the line contact (0.70..0.79).
_DEPTHS = np.array([0.0, 0.38, 0.48, 0.58, 0.68, 0.78])


def lower_bounds(patches: np.ndarray, poisson_ratio: np.ndarray, fields: np.ndarray | None = None) -> np.ndarray:
    """Largest von Mises stress over p_max at a few points: the peak is not below it.

    Parameters
    ----------
    patches : rows of `ellipse.patch_rows`, shape (n, 12)
    poisson_ratio : of roller and guide, shape (n, 2)
    fields : traction over its bound at element centres, (n, 2, ny, nx), for models other than full sliding

    Returns
    -------
    Roller and guide, shape (n, 2). Points: along z in the middle, and the middle and the vertices of the ellipse at
    the surface. Where tractions change their sign in the mirror y -> -y the middle axis alone bounds the peak from
    below by that without friction; every point is one the search may meet, so the bound holds anyway.
    """
    out = np.empty((len(patches), 2))
    for i, patch in enumerate(patches):
        a, b = patch[0], patch[1]
        points = np.zeros((len(_DEPTHS) + 4, 3))
        points[: len(_DEPTHS), 2] = _DEPTHS * min(a, b)
        points[len(_DEPTHS) :, :2] = [[0.9 * a, 0.0], [-0.9 * a, 0.0], [0.0, 0.9 * b], [0.0, -0.9 * b]]
        slender = max(a, b) / min(a, b)
        order = int(24 * np.clip(np.rint(np.sqrt(slender / 2.0)), 1, 6))
        parts = stress_parts(patch, points, order, order, NO_FIELD if fields is None else fields[i])
        for body, sign in ((0, 1.0), (1, -1.0)):
            nu = poisson_ratio[i, body]
            stress = parts[:, 0] + nu * parts[:, 1] + sign * (parts[:, 2] + nu * parts[:, 3])
            out[i, body] = von_mises(stress).max()
    return out
