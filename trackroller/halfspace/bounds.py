"""A lower bound of the peak stress of a patch at the cost of a few points."""

from __future__ import annotations

import numpy as np

from trackroller.halfspace.ellipse import NO_FIELD, near_parts, refinement, unit_rule
from trackroller.halfspace.stress import von_mises

# Depths over the smaller semi-axis: the surface, and where the frictionless peak lies for nu 0 to 0.5 from the
# circle (0.38..0.55) to the line contact (0.70..0.79).
_DEPTHS = np.array([0.0, 0.38, 0.48, 0.58, 0.68, 0.78])
_VERTICES = 0.9 * np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])  # near those of the ellipse
_ORDER = 16  # of the quadrature, for ellipses that are not slender


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
    semi = patches[:, :2]
    count = len(_DEPTHS)
    points = np.zeros((len(patches), count + 4, 3))
    points[:, :count, 2] = _DEPTHS * semi.min(axis=1)[:, None]
    points[:, count:, :2] = semi[:, None, :] * _VERTICES
    finer = refinement(patches)
    out = np.empty((len(patches), 2))
    for factor in np.unique(finer):
        group = np.flatnonzero(finer == factor)
        chosen = np.zeros((group.size, *NO_FIELD.shape)) if fields is None else np.ascontiguousarray(fields[group])
        rows = np.repeat(np.arange(group.size), count + 4)
        rule = unit_rule(int(_ORDER * factor))
        parts = near_parts(np.ascontiguousarray(patches[group]), chosen, rows, points[group].reshape(-1, 3), rule, rule)
        for body, sign in ((0, 1.0), (1, -1.0)):
            nu = np.repeat(poisson_ratio[group, body], count + 4)[:, None]
            stress = parts[:, 0] + nu * parts[:, 1] + sign * (parts[:, 2] + nu * parts[:, 3])
            out[group, body] = von_mises(stress).reshape(group.size, -1).max(axis=1)
    return out
