"""Stresses below Hertzian ellipses."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property, lru_cache
from itertools import islice
from typing import Any

import numpy as np

from trackroller.contact import sliding
from trackroller.contact.slip import Slip
from trackroller.halfspace.bounds import lower_bounds
from trackroller.halfspace.ellipse import FIELD, NO_FIELD, patch_rows, stress_parts
from trackroller.halfspace.peak import Peak, find_peaks
from trackroller.halfspace.peak_climb import LITTLE_FRICTION
from trackroller.halfspace.peak_settings import PeakSettings
from trackroller.halfspace.stress import body_stress
from trackroller.roller.requirements import distinct_rows, normalised_patches
from trackroller.roller.stages.patch_stresses import PatchStresses
from trackroller.roller.stages.scene import surface_tractions

SECTION_ORDER = 24  # quadrature points of sections: they meet the rim exactly, where the quadrature is hardest
SEEDS, FINALISTS = 5, 2  # least effort of the search under tractions with adhesion
QUICK_SEEDS = 3  # seeds of a quick search
PIECE = 256  # patches whose tractions on grids are held at once
# Estimated relative error of a peak above which the patch is solved again on twice the elements, and the number of
# elements for which it holds; it falls with the area of an element. Stresses have narrow ridges where sliding begins,
# which carry the peaks of such patches. Their search therefore takes finer rules and steps.
REFINED_ERROR, REFINED_AT = 1.5e-2, 28
CHANGE_WEIGHT = 1.6  # weight of the change by elements where it alone decides
REFINED_SHARE = 0.5  # share of the error that the contact model adds to a peak, below which finer elements gain little
FINER_SEARCH: dict[str, Any] = {"scan": 8, "polish": 24, "step": 0.004}
# Finer elements around adhesion areas: elements in the area with which its peak is resolved, levels at most, estimated
# error over the last change of a peak with so many elements and with fewer, over the error of the search, and from the
# tractions outside.
ENOUGH, LEVELS, CHANGED, UNRESOLVED, SEARCHED, OUTSIDE = 250, 6, 1.0, 4.0, 0.25, 2e-3
# Fewer elements in the area suffice if the peak then changes by less than this share of the tolerance. Of 260 random
# designs, finer elements moved 23 peaks by more than 1 %. Twenty of these contacts were steeper than 49 degrees; the
# others had large adhesion areas. So flat contacts get finer elements only for a strict tolerance, or if in doubt.
FEW, STEADY, STEEP, STRICT = 40, 0.1, np.sin(np.radians(45.0)), 5e-3
FINER_PIECE = 16  # refined patches whose tractions on grids are held at once


def refined_above(elements: int) -> float:
    """Return the estimated relative error of a peak above which a patch of `elements` along an axis is solved again."""
    return REFINED_ERROR * (REFINED_AT / elements) ** 2


def _finer_search(settings: PeakSettings) -> PeakSettings:
    """Return the settings of a search under the tractions of many elements, which have narrow ridges."""
    return replace(settings, **FINER_SEARCH) if settings.step > FINER_SEARCH["step"] else settings


def _pieces(count: int, size: int = PIECE) -> list[slice]:
    """Return pieces of at most `size` of `count` patches."""
    return [slice(i, min(i + size, count)) for i in range(0, count, size)]


def _mirrored(fields: np.ndarray | None, rows: np.ndarray) -> np.ndarray | None:
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
        return *(_mirrored(part.astype(FIELD, copy=False), own != flat) for part in shares[:2]), *shares[2:]

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

    def bounds(self, wanted: np.ndarray) -> np.ndarray:
        """Return the largest of a few points of each patch, (m, 2) [MPa]."""
        patches, parts = self.rows()[wanted[self.results.good]], []
        numbers = np.flatnonzero(wanted)
        for rows in _pieces(numbers.size):
            flat = numbers[rows]
            parts.append(lower_bounds(patches[rows], self.poisson_ratio[flat], self.fields(flat)[0]))
        return np.concatenate(parts) * self.results.patch.max_pressure[wanted][:, None]

    def peaks(self, asked: np.ndarray) -> Peak:
        """Return the peak stresses; contact 2 is searched as its mirror image, so that mirrored cases agree."""
        results = self.results
        second = np.repeat([False, True], results.scene.n)
        patches = self.rows(replace(results.slip, sine=np.abs(results.slip.sine)))[asked[results.good]]
        ratios = self.poisson_ratio[asked]
        if self._gridded:
            peak = self._search_grids(patches, ratios, np.flatnonzero(asked), second[asked])
        else:
            peak = self._search(patches, ratios)
        second = second[asked]
        pressure = results.patch.max_pressure[asked][:, None]
        return replace(peak, stress=peak.stress * pressure, x=np.where(second, -1.0, 1.0)[:, None] * peak.x)

    def _search_grids(self, patches: np.ndarray, ratios: np.ndarray, flat: np.ndarray, second: np.ndarray) -> Peak:
        """Search patches under tractions on grids, and again on twice the elements where the error is large.

        `flat` are the numbers of the patches; the `second` are searched as their mirror images.
        """
        results, settings, peak = self.results, self.options.settings.peak, Peak.empty(len(patches))
        # adhesion and the spin pole make several summits of nearly the same height
        own = results.scene.model.peak_error
        seeds = QUICK_SEEDS if own else max(settings.seeds, SEEDS)
        settings = replace(settings, seeds=seeds, finalists=max(settings.finalists, FINALISTS))
        if not self.options.settings.refines and self.options.settings.elements > REFINED_AT:
            settings = _finer_search(settings)
        again = self.options.settings.refines and self.options.settings.elements <= REFINED_AT
        for piece in _pieces(flat.size):
            fields, coarse = (_mirrored(part, second[piece]) for part in self.fields(flat[piece]))
            # doubtful peaks of the exact theory are searched again; a third climb finds no higher peaks of the others
            few = again and coarse is not None
            effort = replace(settings, finalists=FINALISTS) if few else settings
            peak.put(piece, find_peaks(patches[piece], ratios[piece], effort, fields, coarse, bool(own)))
        worth = REFINED_SHARE * own * results.friction[flat]
        limit = np.maximum(refined_above(self.options.settings.elements), worth)
        # a model with an error of its own gains nothing from elements where the search alone is rough
        doubt = CHANGE_WEIGHT * peak.change if own else peak.error
        rough = np.flatnonzero(
            (doubt.max(axis=1) > limit) & (results.slides_along[flat] == 0) & self.options.settings.refines
        )
        if not own:
            settings = _finer_search(settings)
        for piece in _pieces(rough.size, PIECE if own else FINER_PIECE):
            rows = rough[piece]
            shares = self._shares(flat[rows], results.scene.model.finer_shares)
            if shares is None:
                break
            (fields, coarse), converged = (_mirrored(part, second[rows]) for part in shares[:2]), shares[2]
            finer = find_peaks(patches[rows], ratios[rows], settings, fields, coarse, bool(own))
            # the change between two grids may be small by chance, and is no estimate then
            finer.error[:] = np.maximum(finer.error, limit[rows, None])
            peak.put(rows[converged], finer.take(converged))
            results.refined[flat[rows[converged]]] = True
        if self.options.settings.elements >= REFINED_AT and np.isfinite(self.options.settings.peak_goal):
            self._search_windows(patches, ratios, flat, second, settings, peak)
        return peak

    def _search_windows(self, patches, ratios, flat, second, settings: PeakSettings, peak: Peak) -> None:
        """Search patches again with finer elements around their adhesion areas, until the peaks change little.

        The arguments are those of `_search_grids`; `peak` is overwritten. An adhesion area of few elements shows
        neither its peak nor that the peak is missing.
        """
        results, goal = self.results, self.options.settings.peak_goal
        patch, slip, friction, rows = results.of(flat)
        sticks: Any = results.scene.model.stick(patch, slip, friction, rows)
        elements = 0.25 * np.pi * self.options.settings.elements**2 * sticks
        pole = np.abs(results.slip.pole_lateral[flat]) < patch.semi_axis_lateral
        few = (elements < ENOUGH) & pole & (friction > LITTLE_FRICTION)
        doubt = (peak.error.max(axis=1) > goal) | (few & ((np.abs(slip.sine) > STEEP) | (goal <= STRICT)))
        for i in np.flatnonzero(doubt & (results.slides_along[flat] == 0) & (friction > 0.0)).tolist():
            one = slice(i, i + 1)
            of = patch.take([i]), slip.take([i]), friction[[i]], rows[[i]]
            for *shares, resolved in islice(results.scene.model.windows(*of), LEVELS):
                fine, coarse = (_mirrored(part.astype(FIELD), second[one]) for part in shares)
                finer, before = (
                    find_peaks(patches[one], ratios[one], settings, fine, coarse, close=True),
                    peak.stress[one].copy(),
                )
                factor = CHANGED if resolved >= ENOUGH else UNRESOLVED
                changed = factor * np.abs(finer.stress / before - 1.0)
                finer.error[:] = changed + SEARCHED * (finer.error - finer.change) + OUTSIDE
                peak.put(one, finer)
                results.resolved[flat[i]] = True
                steady = resolved >= FEW and changed.max() <= STEADY * factor * goal
                if (steady or resolved >= ENOUGH) and finer.error.max() <= goal:
                    break

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
        results, number = self.results, np.array([flat])
        refined = results.refined[results.scene.mirror.source(number)].all()
        fields, *_ = self._shares(number, results.scene.model.finer_shares) if refined else self.fields(number)
        return NO_FIELD if fields is None else fields[0]

    def at(self, flat: int, points: np.ndarray, body: int, sign: float) -> np.ndarray:
        """Return the stress components at points below one patch, (m, 6) [MPa]."""
        results = self.results
        row = int(np.count_nonzero(results.good[:flat]))
        order = max(self.options.settings.peak.polish, SECTION_ORDER)
        parts = stress_parts(self._every_row[row], points, order, order, self._field(flat))
        stress = body_stress(parts, self.poisson_ratio[flat, body], sign)
        return results.patch.max_pressure[flat] * stress
