"""A lower bound of the peak stress of a patch at the cost of a few points."""

from __future__ import annotations

import numpy as np

from trackroller.halfspace.ellipse import fields_of, refinement, unit_rule
from trackroller.halfspace.peak_climb import Patches

# Depths over the smaller semi-axis: the surface, and the depths of the frictionless peak for nu from 0 to 0.5, between
# the circle (0.38 to 0.55) and the line contact (0.70 to 0.79).
_DEPTHS = (0.0, 0.38, 0.48, 0.58, 0.68, 0.78)
_VERTICES = ((0.9, 0.0), (-0.9, 0.0), (0.0, 0.9), (0.0, -0.9))  # points near the vertices
_POINTS = np.array([(0.0, 0.0, z) for z in _DEPTHS] + [(x, y, 0.0) for x, y in _VERTICES])
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
    finer, ratios = refinement(patches), np.ascontiguousarray(poisson_ratio, dtype=float)
    out = np.empty((len(patches), 2))
    for factor in np.unique(finer):
        group = np.flatnonzero(finer == factor)
        some = Patches(np.ascontiguousarray(patches[group]), fields_of(fields, group), ratios[group], slender=False)
        points = np.broadcast_to(_POINTS, (group.size, *_POINTS.shape))
        out[group] = some.scan(points, unit_rule(int(_ORDER * factor))).max(axis=1)
    return out
