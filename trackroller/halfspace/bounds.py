"""A lower bound of the peak stress of a patch at the cost of a few points."""

from __future__ import annotations

import numpy as np

from trackroller.halfspace.ellipse import RayRoom, fields_of, refinement, unit_rule
from trackroller.halfspace.peak import Target, lengths, scan
from trackroller.numerics.compiled import compiled
from trackroller.numerics.threads import share_rows

# Depths over the smaller semi-axis: the surface, and the depths of the frictionless peak for nu
# from 0 to 0.5, between the circle (0.38 to 0.55) and the line contact (0.70 to 0.79).
_DEPTHS = (0.0, 0.38, 0.48, 0.58, 0.68, 0.78)
_VERTICES = ((0.9, 0.0), (-0.9, 0.0), (0.0, 0.9), (0.0, -0.9))  # points near the vertices
_POINTS = np.array([(0.0, 0.0, z) for z in _DEPTHS] + [(x, y, 0.0) for x, y in _VERTICES])
_ORDER = 16  # quadrature points, for ellipses that are not slender


def lower_bounds(
    patches: np.ndarray, poisson_ratio: np.ndarray, fields: np.ndarray | None = None
) -> np.ndarray:
    """Return the largest von Mises stress over p_max at a few points, a lower bound of the peak.

    The points lie along z below the centre, and on the surface in the centre and near the vertices
    of the ellipse. The peak is the largest stress at any point, so it is not lower than the stress
    at these points.

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
    patches, ratios = (
        np.ascontiguousarray(patches),
        np.ascontiguousarray(poisson_ratio, dtype=float),
    )
    finer = refinement(patches)
    out = np.empty((len(patches), 2))
    for factor in np.unique(finer):
        group = np.flatnonzero(finer == factor)
        some = patches[group], fields_of(fields, group), ratios[group], lengths(patches[group])
        rule, largest = unit_rule(int(_ORDER * factor)), np.empty((group.size, 2))

        def work(first: int, last: int, some=some, rule=rule, largest=largest) -> None:
            _largest(first, last, some, rule, RayRoom.empty(), largest)

        share_rows(work, group.size, 2, 64)
        out[group] = largest
    return out


@compiled
def _largest(first, last, patches, rule, room, out):
    """Write the largest stresses at the points of patches `first` to `last` into `out` (n, 2)."""
    rows, fields, ratios, units = patches
    for i in range(first, last):
        values = scan(
            Target(rows[i], fields[i], ratios[i], units[i], False, room), _POINTS, (rule, rule)
        )
        for body in range(2):
            out[i, body] = values[body].max()
