"""Stresses below Hertzian ellipses."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from trackroller.contact import sliding
from trackroller.contact.slip import Slip
from trackroller.halfspace.bounds import lower_bounds
from trackroller.halfspace.ellipse import FIELD, NO_FIELD, patch_rows, stress_parts
from trackroller.halfspace.peak import LITTLE_FRICTION, Peak, find_peaks
from trackroller.halfspace.peak_settings import PeakSettings
from trackroller.halfspace.stress import body_stress
from trackroller.roller.distinct_contacts import distinct_rows, normalised_patches
from trackroller.roller.stages.patch_stresses import PatchStresses
from trackroller.roller.stages.scene import surface_tractions

SECTION_ORDER = 24  # quadrature points of sections: they meet the rim exactly, where the quadrature is hardest
SEEDS = 5  # least effort of the search under tractions with adhesion
FINALISTS = 2
QUICK_SEEDS = 3  # seeds of a quick search
PIECE = 256  # patches whose tractions on grids are held at once
FINER_PIECE = 16  # the same on twice the elements
# Estimated relative error of a peak above which the patch is solved again on twice the elements, and the number of
# elements for which it holds; it falls with the area of an element. Stresses have narrow ridges where sliding begins,
# which carry the peaks of such patches. Their search therefore takes finer rules and steps.
REFINED_ERROR = 1.5e-2
REFINED_AT = 28
CHANGE_WEIGHT = 1.6  # weight of the change by elements where it alone decides
REFINED_SHARE = 0.5  # share of the error that the contact model adds to a peak, below which finer elements gain little
FINER_SEARCH: dict[str, Any] = {"scan": 8, "polish": 24, "step": 0.004}
# The highest stress may lie at the spin pole, where the elements do not resolve a small adhesion area, and the change
# with the elements does not show it. A formula gives this stress (`kalker.extrapolation.pole_stress`). If it exceeds
# the peak found by more than POLE_SPREAD, which is the error of the formula, the peak is too low by up to POLE_WEIGHT
# times the rest. This holds for adhesion areas below SMALL_SHARE of the patch. Measured on 443 rolling designs, see
# tests/roller/test_tolerance.py.
POLE_SPREAD = 0.04
POLE_WEIGHT = 1.6
SMALL_SHARE = 0.01
UNSEEN_ERROR = 3e-4  # relative error of peaks under tractions on elements that no estimate shows


def refined_above(elements: int) -> float:
    """Return the estimated relative error of a peak above which a patch of `elements` along an axis is solved again."""
    return REFINED_ERROR * (REFINED_AT / elements) ** 2


def _pieces(count: int, size: int = PIECE) -> list[slice]:
    """Return pieces of at most `size` of `count` patches."""
    return [slice(i, min(i + size, count)) for i in range(0, count, size)]


def mirrored(fields: np.ndarray | None, rows: np.ndarray) -> np.ndarray | None:
    """Replace the fields (m, 2, ny, nx) of `rows` by their mirror images in x, in place, and return the fields."""
    if fields is not None and rows.any():
        image = fields[rows][..., ::-1]
        np.negative(image[:, 0], out=image[:, 0])
        fields[rows] = image
    return fields


class EllipseStresses(PatchStresses):
    """Stresses below the ellipses of a block, by plane waves and rays (`halfspace.ellipse`)."""

    def rows(self, slip: Slip | None = None) -> np.ndarray:
        """Return the records of the existing patches that the half-space kernels take, see `patch_rows`."""
        results = self.results
        good = results.good
        if slip is None:
            slip = results.slip
        return patch_rows(
            results.patch.take(good),
            slip.take(good),
            results.friction[good],
            sliding.spin_model_index(self.options.spin_model),
            results.slides_along[good],
        )

    @property
    def _gridded(self) -> bool:
        """Do the tractions need a grid?"""
        return not (self.results.scene.model.full_sliding or self.results.scene.frictionless)

    def _shares(self, flat: np.ndarray, ask: Callable[..., Any]) -> Any:
        """Return the tractions of the existing patches `flat` by `ask`, a method of the contact model."""
        results = self.results
        own = results.scene.mirror.source(flat)
        slides = results.slides_along[own] != 0
        patch, slip, friction, rows = results.of(own)
        slip = replace(slip, shift=np.where(slides, 0.0, slip.shift))
        shares = ask(patch, slip, np.where(slides, 0.0, friction), rows)
        if shares is None:
            return None
        return *(mirrored(part.astype(FIELD, copy=False), own != flat) for part in shares[:2]), *shares[2:]

    def fields(self, flat: np.ndarray) -> tuple[np.ndarray | None, np.ndarray | None]:
        """Return the traction over its bound on grids over the existing patches `flat` (m,), and on coarser grids.

        The first is None where full sliding needs no grid, the second where the model has no coarser grid.
        """
        results = self.results
        if not self._gridded:
            return None, None
        shares = self._shares(flat, results.scene.model.shares)
        if shares is None:
            if results.share is None:
                results.share = surface_tractions(results).shares(results.friction[results.good])
            return results.share[np.cumsum(results.good)[flat] - 1], None
        return shares

    def bounds(self, searched: np.ndarray) -> np.ndarray:
        """Return the largest of a few points of each patch, (m, 2) [MPa]."""
        patches = self.rows()[searched[self.results.good]]
        parts = []
        numbers = np.flatnonzero(searched)
        for rows in _pieces(numbers.size):
            flat = numbers[rows]
            parts.append(lower_bounds(patches[rows], self.poisson_ratio[flat], self.fields(flat)[0]))
        return np.concatenate(parts) * self.results.patch.max_pressure[searched][:, None]

    def peaks(self, searched: np.ndarray) -> Peak:
        """Return the peak stresses; contact 2 is searched as its mirror image, so that mirrored cases agree."""
        results = self.results
        second = np.repeat([False, True], results.scene.n)
        patches = self.rows(replace(results.slip, sine=np.abs(results.slip.sine)))[searched[results.good]]
        ratios = self.poisson_ratio[searched]
        if self._gridded:
            peak = self._search_grids(patches, ratios, np.flatnonzero(searched), second[searched])
        else:
            peak = self._search(patches, ratios)
        second = second[searched]
        pressure = results.patch.max_pressure[searched][:, None]
        return replace(peak, stress=peak.stress * pressure, x=np.where(second, -1.0, 1.0)[:, None] * peak.x)

    def _search_grids(self, patches: np.ndarray, ratios: np.ndarray, flat: np.ndarray, second: np.ndarray) -> Peak:
        """Search patches under tractions on grids, and again on twice the elements where the error is large.

        `flat` are the numbers of the patches; the `second` are searched as their mirror images.
        """
        results = self.results
        settings = self.options.settings.peak
        elements = self.options.settings.elements
        own = results.scene.model.peak_error
        peak = Peak.empty(len(patches))
        # adhesion and the spin pole make several summits of nearly the same height
        if own:
            seeds = QUICK_SEEDS
        else:
            seeds = max(settings.seeds, SEEDS)
        settings = replace(settings, seeds=seeds, finalists=max(settings.finalists, FINALISTS))
        for piece in _pieces(flat.size):
            fields, coarse = (mirrored(part, second[piece]) for part in self.fields(flat[piece]))
            # doubtful peaks of the exact theory are searched again; a third climb finds no higher peaks of the others
            few = elements <= REFINED_AT and coarse is not None
            effort = settings
            if few:
                effort = replace(settings, finalists=FINALISTS)
            peak.put(piece, find_peaks(patches[piece], ratios[piece], effort, fields, coarse, bool(own)))
        # a model with an error of its own gains nothing from elements where the search alone is rough
        if own:
            doubt = (CHANGE_WEIGHT * peak.change).max(axis=1)
            size = PIECE
        else:
            # the change at the place of a peak, larger than that of its height, shows a narrow ridge
            doubt = np.fmax(peak.error, peak.change).max(axis=1)
            size = FINER_PIECE
        goal = np.maximum(refined_above(elements), REFINED_SHARE * own * results.friction[flat])
        rough = np.flatnonzero((doubt > goal) & (results.slides_along[flat] == 0))
        if not own and settings.step > FINER_SEARCH["step"]:
            settings = replace(settings, **FINER_SEARCH)
        for piece in _pieces(rough.size, size):
            rows = rough[piece]
            given = patches[rows], ratios[rows], flat[rows], second[rows], settings
            finer, converged = self._on_twice_the_elements(*given)
            # the change between two grids may be small by chance, and is no estimate then
            finer.error[:] = np.maximum(finer.error, goal[rows, None])
            peak.put(rows[converged], finer.take(converged))
            results.refined[flat[rows[converged]]] = True
        peak.error[:] = np.fmax(peak.error, self._missed_at_pole(peak, flat)[:, None]) + UNSEEN_ERROR
        return peak

    def _on_twice_the_elements(
        self, patches: np.ndarray, ratios: np.ndarray, flat: np.ndarray, second: np.ndarray, settings: PeakSettings
    ) -> tuple[Peak, np.ndarray]:
        """Return the peaks under tractions on twice the elements, and whether these converged, (m,)."""
        model = self.results.scene.model
        none = np.zeros(len(flat), bool)
        shares = self._shares(flat, model.finer_shares)
        if shares is None:  # the model does not refine patches
            return Peak.empty(len(flat)), none
        fields, coarse = (mirrored(part, second) for part in shares[:2])
        converged = shares[2]
        return find_peaks(patches, ratios, settings, fields, coarse, bool(model.peak_error)), converged

    def _missed_at_pole(self, peak: Peak, flat: np.ndarray) -> np.ndarray:
        """Return by how much the peaks of patches `flat` may be too low at the spin pole, (m,), see `POLE_SPREAD`."""
        patch, slip, friction, rows = self.results.of(flat)
        model = self.results.scene.model
        stress = model.pole_stress(patch, slip, friction, rows)
        higher = stress / peak.stress.min(axis=1) - 1.0 - POLE_SPREAD
        missed = np.flatnonzero((higher > 0.0) & (friction > LITTLE_FRICTION) & (self.results.slides_along[flat] == 0))
        out = np.zeros(len(flat))
        if missed.size:
            out[missed] = POLE_WEIGHT * higher[missed]
            stick = model.stick(*self.results.of(flat[missed]))
            if stick is not None:  # an unknown adhesion area may be small
                out[missed] *= stick < SMALL_SHARE
        return out

    def _search(self, patches: np.ndarray, ratios: np.ndarray) -> Peak:
        """Search patches in full sliding; those without a slip field are searched once for each ellipticity."""
        settings = self.options.settings.peak
        patches, length = normalised_patches(patches)
        first = number = np.arange(len(patches))
        if self.options.shortcuts:
            first, number = distinct_rows(np.hstack([patches.view((float, patches.itemsize // 8)), ratios]))
        peak = find_peaks(patches[first], ratios[first], settings).take(number)
        scale = length[:, None]
        return replace(peak, x=peak.x * scale, y=peak.y * scale, z=peak.z * scale)

    @cached_property
    def _every_row(self) -> np.ndarray:
        return self.rows()

    @cached_property
    def _field(self) -> Callable[[int], np.ndarray]:
        """Return `_field_of` with a memory for one patch: the sections ask for each patch four times."""
        return lru_cache(maxsize=1)(self._field_of)

    def _field_of(self, flat: int) -> np.ndarray:
        """Return the traction over its bound on the grid on which the peak was found, (2, ny, nx)."""
        results = self.results
        number = np.array([flat])
        refined = results.refined[results.scene.mirror.source(number)][0]
        if refined:
            fields, *_ = self._shares(number, results.scene.model.finer_shares)
        else:
            fields, *_ = self.fields(number)
        return NO_FIELD if fields is None else fields[0]

    def at(self, flat: int, points: np.ndarray, body: int, sign: float) -> np.ndarray:
        """Return the stress components at points below one patch, (m, 6) [MPa]."""
        results = self.results
        row = int(np.count_nonzero(results.good[:flat]))
        order = max(self.options.settings.peak.polish, SECTION_ORDER)
        parts = stress_parts(self._every_row[row], points, order, order, self._field(flat))
        stress = body_stress(parts, self.poisson_ratio[flat, body], sign)
        return results.patch.max_pressure[flat] * stress
