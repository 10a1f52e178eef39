"""Stresses below Hertzian ellipses."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.lib.recfunctions import structured_to_unstructured

from trackroller.contact import sliding
from trackroller.contact.common import Slip
from trackroller.contact.models import traction_share
from trackroller.halfspace.bounds import lower_bounds
from trackroller.halfspace.ellipse import NO_FIELD, patch_rows, stress_parts
from trackroller.halfspace.peak import Peak, find_peaks
from trackroller.halfspace.stress import body_stress
from trackroller.roller.requirements import distinct_rows, normalised_patches
from trackroller.roller.stages.patch_stresses import PatchStresses
from trackroller.roller.stages.scene import surface_tractions

SECTION_ORDER = 24  # quadrature points of sections: they meet the rim exactly, where the quadrature is hardest


class EllipseStresses(PatchStresses):
    """Stresses below the ellipses of a block, by plane waves and rays (`halfspace.ellipse`)."""

    def rows(self, slip: Slip | None = None) -> np.ndarray:
        """Return the records of the existing patches that the half-space kernels take, see `patch_rows`."""
        results = self.results
        good = results.good
        return patch_rows(
            results.patch.take(good),
            (results.slip if slip is None else slip).take(good),
            results.friction[good],
            sliding.spin_model_index(self.options.spin_model),
            results.slides_along[good],
        )

    @cached_property
    def fields(self) -> np.ndarray | None:
        """Traction over its bound on the grid of each existing patch; None where full sliding needs no grid."""
        results = self.results
        if results.scene.model.full_sliding or results.scene.frictionless:
            return None
        if results.share is None:
            results.share = traction_share(surface_tractions(results), results.friction[results.good])
        return results.share

    def bounds(self, wanted: np.ndarray) -> np.ndarray:
        """Return the largest of a few points of each patch, (m, 2) [MPa]."""
        among = wanted[self.results.good]
        fields = None if self.fields is None else self.fields[among]
        bound = lower_bounds(self.rows()[among], self.poisson_ratio[wanted], fields)
        return bound * self.results.patch.max_pressure[wanted][:, None]

    def peaks(self, asked: np.ndarray) -> Peak:
        """Return the peak stresses; contact 2 is searched as its mirror image, so that mirrored cases agree."""
        results = self.results
        among = asked[results.good]
        second = np.repeat([False, True], results.scene.n)[asked]
        seen = replace(results.slip, sine=np.abs(results.slip.sine))
        fields = self.fields
        if fields is not None:
            fields = fields[among]
            fields[second] = fields[second][..., ::-1] * np.array([-1.0, 1.0])[:, None, None]
        peak = self._search(self.rows(seen)[among], self.poisson_ratio[asked], fields)
        pressure = results.patch.max_pressure[asked][:, None]
        return replace(peak, stress=peak.stress * pressure, x=np.where(second, -1.0, 1.0)[:, None] * peak.x)

    def _search(self, patches: np.ndarray, ratios: np.ndarray, fields: np.ndarray | None) -> Peak:
        """Search patches; those without a slip field of their own are searched once for each ellipticity."""
        settings = self.options.settings.peak
        if fields is not None:
            return find_peaks(patches, ratios, settings, fields)
        patches, length = normalised_patches(patches)
        first = number = np.arange(len(patches))
        if self.options.shortcuts:
            first, number = distinct_rows(np.hstack([structured_to_unstructured(patches), ratios]))
        peak = find_peaks(patches[first], ratios[first], settings).take(number)
        scale = length[:, None]
        return replace(peak, x=peak.x * scale, y=peak.y * scale, z=peak.z * scale)

    @cached_property
    def _every_row(self) -> np.ndarray:
        return self.rows()

    def at(self, flat: int, points: np.ndarray, body: int, sign: float) -> np.ndarray:
        """Return the stress components at points below one patch, (m, 6) [MPa]."""
        results = self.results
        row = int(np.count_nonzero(results.good[:flat]))
        order = max(self.options.settings.peak.polish, SECTION_ORDER)
        field = NO_FIELD if self.fields is None else self.fields[row]
        parts = stress_parts(self._every_row[row], points, order, order, field)
        stress = body_stress(parts, self.poisson_ratio[flat, body], sign)
        return results.patch.max_pressure[flat] * stress
