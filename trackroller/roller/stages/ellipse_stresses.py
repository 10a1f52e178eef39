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
SEEDS, FINALISTS = 5, 2  # least effort of the search under tractions with adhesion
PIECE = 256  # patches whose tractions on grids are held at once


def _pieces(wanted: np.ndarray) -> list[tuple[slice, np.ndarray]]:
    """Return the `wanted` patches (2 n,) in pieces: their places among the wanted ones, and their numbers (m,)."""
    flat = np.flatnonzero(wanted)
    return [(slice(i, i + PIECE), flat[i : i + PIECE]) for i in range(0, max(flat.size, 1), PIECE)]


def _mirror(fields: np.ndarray, rows: np.ndarray) -> None:
    """Replace the fields (m, 2, ny, nx) of `rows` by their mirror images in x, in place."""
    fields[rows] = fields[rows][..., ::-1] * np.array([-1.0, 1.0])[:, None, None]


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

    @property
    def _gridded(self) -> bool:
        """Do the tractions need a grid?"""
        return not (self.results.scene.model.full_sliding or self.results.scene.frictionless)

    def fields(self, flat: np.ndarray) -> tuple[np.ndarray | None, np.ndarray | None]:
        """Return the traction over its bound on grids over the existing patches `flat` (m,), and on coarser grids.

        The first is None where full sliding needs no grid, the second where the model knows no coarser grid.
        """
        results = self.results
        if not self._gridded:
            return None, None
        own = results.scene.mirror.source(flat)
        slides = results.slides_along[own] != 0
        patch, slip, friction, rows = results.of(own)
        slip = replace(slip, shift=np.where(slides, 0.0, slip.shift))
        found = results.scene.model.shares(patch, slip, np.where(slides, 0.0, friction), rows)
        if found is None:
            if results.share is None:
                results.share = traction_share(surface_tractions(results), results.friction[results.good])
            return results.share[np.cumsum(results.good)[flat] - 1], None
        for part in found:
            _mirror(part, own != flat)
        return found

    def bounds(self, wanted: np.ndarray) -> np.ndarray:
        """Return the largest of a few points of each patch, (m, 2) [MPa]."""
        patches, parts = self.rows()[wanted[self.results.good]], []
        for rows, flat in _pieces(wanted):
            parts.append(lower_bounds(patches[rows], self.poisson_ratio[flat], self.fields(flat)[0]))
        return np.concatenate(parts) * self.results.patch.max_pressure[wanted][:, None]

    def peaks(self, asked: np.ndarray) -> Peak:
        """Return the peak stresses; contact 2 is searched as its mirror image, so that mirrored cases agree."""
        results = self.results
        second = np.repeat([False, True], results.scene.n)
        patches = self.rows(replace(results.slip, sine=np.abs(results.slip.sine)))[asked[results.good]]
        ratios = self.poisson_ratio[asked]
        if not self._gridded:
            peak = self._search(patches, ratios)
        else:
            settings = self.options.settings.peak
            # adhesion and the spin pole make several summits of nearly the same height
            settings = replace(settings, seeds=max(settings.seeds, SEEDS), finalists=max(settings.finalists, FINALISTS))
            peak = Peak.empty(len(patches))
            for rows, flat in _pieces(asked):
                fields, coarse = self.fields(flat)
                for part in (fields, coarse):
                    if part is not None:
                        _mirror(part, second[flat])
                found = find_peaks(patches[rows], ratios[rows], settings, fields, coarse)
                peak.put(np.arange(rows.start, rows.start + flat.size), found)
        second = second[asked]
        pressure = results.patch.max_pressure[asked][:, None]
        return replace(peak, stress=peak.stress * pressure, x=np.where(second, -1.0, 1.0)[:, None] * peak.x)

    def _search(self, patches: np.ndarray, ratios: np.ndarray) -> Peak:
        """Search patches in full sliding; those without a slip field are searched once for each ellipticity."""
        settings = self.options.settings.peak
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
        fields, _ = self.fields(np.array([flat]))
        field = NO_FIELD if fields is None else fields[0]
        parts = stress_parts(self._every_row[row], points, order, order, field)
        stress = body_stress(parts, self.poisson_ratio[flat, body], sign)
        return results.patch.max_pressure[flat] * stress
