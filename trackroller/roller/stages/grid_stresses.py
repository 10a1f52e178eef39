"""Stresses below patches whose pressure was solved on a grid (`normal="halfspace"`)."""

from __future__ import annotations

from typing import cast

import numpy as np

from trackroller.contact.grid_patch import GridPatch
from trackroller.contact.normal.measure import roughness
from trackroller.halfspace.grid_peak import GridLoad, find_grid_peaks
from trackroller.halfspace.peak import Peak
from trackroller.halfspace.stress import FRICTION_SIGNS, body_stress, von_mises
from trackroller.numerics.threads import share_rows
from trackroller.roller.stages.patch_stresses import PatchStresses
from trackroller.roller.stages.scene import surface_tractions

# A peak is refined if its estimated error exceeds both REFINED_ERROR times the tolerance and FINEST_ERROR.
REFINED_ERROR = 4.0
FINEST_ERROR = 5e-3
REFINEMENTS = 2, 4  # times the elements of the solved pressure
LARGEST_GRID = 160  # largest number of elements across after a refinement
RIDGE_ERROR = 0.02  # error of the solved pressure's stress per `roughness`, which no other tractions on it show
RESOLVED = 0.95  # share of the largest pressure that means over 2 x 2 elements keep where the elements resolve it
NEAR = 4.0  # elements of depth down to which subsurface stresses need the full grid
# Points of the lower bound over the half sides and the smaller half side of the patch.
BOUND_POINTS = np.array([(0, 0, 0.45), (0.4, 0, 0), (-0.4, 0, 0), (0, 0.9, 0), (0, -0.9, 0), (0, 0, 0.3)])


def _load(t, i: int) -> GridLoad:
    """Return the load number `i` of the surface tractions `t`."""
    return GridLoad(t.x[i], t.y[i], np.stack([t.shear_lateral[i], t.shear_rolling[i], t.pressure[i]], axis=-1))


class GridStresses(PatchStresses):
    """Stresses below the solved patches of a block, by corner sums (`halfspace.influence`)."""

    def load(self, flat: int) -> GridLoad:
        """Return the tractions of the existing patch number `flat` of 2 n."""
        return _load(surface_tractions(self.results), int(np.count_nonzero(self.results.good[:flat])))

    def bounds(self, searched: np.ndarray) -> np.ndarray:
        """Return the largest stress at a few points below each patch, (m, 2) [MPa]."""
        out = []
        for flat in np.flatnonzero(searched).tolist():
            load = self.load(flat)
            a, b = load.size
            centre = np.array([load.x.mean(), load.y.mean(), 0.0])
            parts = load.coarse.stress_parts(centre + BOUND_POINTS * np.array([a, b, min(a, b)]))
            ratios = self.poisson_ratio[flat]
            stresses = [body_stress(parts, nu, sign) for nu, sign in zip(ratios, FRICTION_SIGNS, strict=True)]
            out.append([von_mises(stress).max() for stress in stresses])
        return np.array(out).reshape(-1, 2)

    def peaks(self, searched: np.ndarray) -> Peak:
        """Return the peak stresses.

        Where the slip turns within an element (its pole in a slender patch), the element size limits the accuracy. If
        the model computes the tractions on finer elements, the patch is searched again with more elements, until the
        estimated error is as small as that of other patches.
        """
        results = self.results
        options = self.options
        flat = np.flatnonzero(searched)
        ratios = self.poisson_ratio[searched]
        loads = [self.load(place) for place in flat.tolist()]
        seeds = max(2, options.settings.peak.finalists)
        outward = np.where(flat < results.scene.n, 1.0, -1.0)
        peak = find_grid_peaks(loads, ratios, seeds, outward)
        ridges = RIDGE_ERROR * np.array([[roughness(load.pressure)] for load in loads]).reshape(-1, 1)
        patch = cast(GridPatch, results.patch)
        if not results.scene.model.refines:
            peak.error[:] += ridges
            return peak
        # finer tractions do not help where the pressure is singular or its ridges are narrower than its elements
        allowed = (results.slides_along[flat] == 0) & ~patch.reaches_edge[flat] & (results.friction[flat] > 0)
        allowed &= np.array([load.coarse.pressure.max() > RESOLVED * load.pressure.max() for load in loads], bool)
        goal = max(REFINED_ERROR * options.settings.peak_error, FINEST_ERROR)
        for times in REFINEMENTS:
            rows = np.flatnonzero(allowed & (peak.error.max(axis=1) > goal))
            if times * patch.shape[1] > LARGEST_GRID or not rows.size:
                break
            refined = [self._refined(int(flat[i]), times) for i in rows]
            finer = find_grid_peaks(refined, ratios[rows], seeds, outward[rows])
            peak.put(rows, finer)
        peak.error[:] += ridges
        return peak

    def _refined(self, flat: int, times: int) -> GridLoad:
        """Return the tractions of one patch on finer elements across, and along too if that is the longer side."""
        solved, slip, friction, rows = self.results.of(np.array([flat]))
        patch = cast(GridPatch, solved)  # the stage chooses this class for solved patches only
        along = 1
        if patch.semi_axis_rolling[0] * patch.shape[1] > patch.semi_axis_lateral[0] * patch.shape[0]:
            along = times
        finer = patch.refined(along, times)
        return _load(self.results.scene.model.surface(finer, slip, friction, rows), 0)

    def at(self, flat: int, points: np.ndarray, body: int, sign: float) -> np.ndarray:
        """Return the stress components at points below one patch, (m, 6) [MPa]; deep points use the coarse grid."""
        load = self.load(flat)
        deep = points[:, 2] > NEAR * max(load.sides)
        out = np.empty((len(points), 6))
        for rows, grid in ((np.flatnonzero(deep), load.coarse), (np.flatnonzero(~deep), load)):

            def work(first: int, last: int, rows=rows, grid=grid) -> None:
                part = rows[first:last]
                out[part] = body_stress(grid.stress_parts(points[part]), self.poisson_ratio[flat, body], sign)

            share_rows(work, rows.size, 32)
        return out
