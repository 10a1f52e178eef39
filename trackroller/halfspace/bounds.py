"""A lower bound of the peak stress of a patch at the cost of a few points."""

from __future__ import annotations

import numpy as np

from trackroller.halfspace.ellipse import fields_of, near_parts, refinement, unit_rule
from trackroller.halfspace.peak_climb import lengths
from trackroller.halfspace.stress import FRICTION_SIGNS, body_stress, von_mises

# Depths over the smaller semi-axis: the surface, and the depths of the frictionless peak for nu from 0 to 0.5, between
# the circle (0.38 to 0.55) and the line contact (0.70 to 0.79).
_DEPTHS = np.array([0.0, 0.38, 0.48, 0.58, 0.68, 0.78])
_VERTICES = 0.9 * np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])  # points near the vertices
_ORDER = 16  # quadrature points, for ellipses that are not slender


def lower_bounds(patches: np.ndarray, poisson_ratio: np.ndarray, fields: np.ndarray | None = None) -> np.ndarray:
    """Return the largest von Mises stress over p_max at a few points, a lower bound of the peak.

    The points lie along z below the centre, and on the surface in the centre and near the vertices of the ellipse. The
    peak is the largest stress at any point, so it is not lower than the stress at these points.

    Parameters
    ----------
    patches : numpy.ndarray, shape (n,)
        Records of `ellipse.patch_rows`.
    poisson_ratio : numpy.ndarray, shape (n, 2)
        Poisson's ratios of roller and guide [1].
    fields : numpy.ndarray, shape (n, 2, ny, nx), optional
        Traction over its bound at element centres; full sliding if not given.

    Returns
    -------
    numpy.ndarray, shape (n, 2)
        Lower bounds for roller and guide [1].
    """
    size, count = lengths(patches), len(_DEPTHS)
    points = np.zeros((len(patches), count + len(_VERTICES), 3))
    points[:, :count, 2] = _DEPTHS * size[:, 2:]
    points[:, count:, :2] = size[:, None, :2] * _VERTICES
    finer = refinement(patches)
    out = np.empty((len(patches), 2))
    for factor in np.unique(finer):
        group = np.flatnonzero(finer == factor)
        chosen = fields_of(fields, group)
        rows = np.repeat(np.arange(group.size), points.shape[1])
        rule = unit_rule(int(_ORDER * factor))
        parts = near_parts(np.ascontiguousarray(patches[group]), chosen, rows, points[group].reshape(-1, 3), rule, rule)
        for body, sign in enumerate(FRICTION_SIGNS):
            stress = von_mises(body_stress(parts, poisson_ratio[group[rows], body], sign))
            out[group, body] = stress.reshape(group.size, -1).max(axis=1)
    return out
