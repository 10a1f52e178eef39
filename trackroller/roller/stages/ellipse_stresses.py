"""Stresses below Hertzian ellipses."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property, lru_cache, partial
from typing import Any

import numpy as np

from trackroller.contact import sliding
from trackroller.contact.common import slenderness
from trackroller.contact.settings import FADES
from trackroller.contact.slip import Slip
from trackroller.halfspace.bounds import lower_bounds
from trackroller.halfspace.ellipse import FIELD, NO_FIELD, patch_rows, stress_parts
from trackroller.halfspace.peak import Peak, find_peaks
from trackroller.halfspace.peak_climb import LITTLE_FRICTION
from trackroller.halfspace.peak_settings import PeakSettings
from trackroller.halfspace.stress import body_stress
from trackroller.numerics.knots import rise
from trackroller.roller.requirements import distinct_rows, normalised_patches
from trackroller.roller.stages.case import peak_goal
from trackroller.roller.stages.patch_stresses import PatchStresses
from trackroller.roller.stages.scene import surface_tractions
from trackroller.roller.stages.window_search import STRICT, Search, mirrored, search_windows

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
# An adhesion area is searched in windows if it has fewer than SMALL elements, or if its share of the patch is below
# SMALL_SHARE[0] for tolerances above STRICT, and below SMALL_SHARE[1] for smaller tolerances. If the area is larger,
# the whole patch is solved on elements of half the size instead. This would not do for small areas: with a share below
# SMALL_SHARE[0], peaks at the tip were up to 4 % too low on 160 x 160 elements.
SMALL, SMALL_SHARE = 30, (0.05, 0.1)
# The highest stress may lie at the spin pole, where the elements do not resolve a small adhesion area. A formula gives
# the stress at the pole and the part of it that the elements miss. The peak at hand is then too low by at most the
# smaller of two numbers: this part, and the stress by the formula less the peak. If this error reaches the tolerance,
# the area is searched in windows. For tolerances up to STRICT, windows are used for every small area. They are used
# even if the search tells a small error: its peak may lie below the surface, and say nothing of the stress at the pole.
# Two kinds of patches are solved on elements of half the size instead of in windows, if the error that these elements
# leave is smaller than the tolerance even after multiplication by DOUBTED. The first kind has bodies with similar
# moduli, K/mu of at most UNLIKE[0]; the adhesion areas of other bodies have sharper tips. The second kind has K/mu
# above UNLIKE[1] and K below UNLIKE[2], and counts for tolerances of at least RESOLVED only. The formula often
# overestimates the stress of the second kind.
RESOLVED, UNLIKE, DOUBTED = 0.05, (0.05, 0.6, 0.3), 1.4
# In slender patches the formula underestimates the stress, mostly by less than LOW, at worst by 17 %. Its stress is
# therefore raised by a share that grows from 0 at the axis ratio LOW_FROM[0] to LOW at LOW_FROM[1].
LOW, LOW_FROM = 0.1, (3.0, 8.0)
# If the friction coefficient is at most LITTLE_FRICTION, the peak is rarely at the adhesion area, and windows are not
# used. One exception: if K/mu is above SHARP[0] and the friction coefficient above SHARP[1], the peak may be there. For
# tolerances below RESOLVED, windows are then used where the formula or the estimated error of the peak asks for them.
SHARP = 0.25, 0.1
# Where this formula says that the peak of a small area is too low by less than LEVEL, the peak errs by at most KNOWN in
# 99 of 100 cases, even if it changes by more when the elements double. In patches with an axis ratio above LONGEST,
# such peaks have larger errors.
KNOWN, LEVEL, LONGEST = 0.04, 0.055, 4.6
# Factor on the estimated error of a peak where it has to keep a tolerance; the error of 1 in 100 designs is larger.
SAFETY = 2.0
# On twice the elements, the estimated error of a peak is the larger of two numbers: the change of the peak with the
# elements times DOUBLED[0], and the error of the search times DOUBLED[1]. DOUBLED[0] follows from the order of
# convergence of 1.3; for small adhesion areas it is DOUBLED_SMALL.
DOUBLED, DOUBLED_SMALL = (1.4, 0.4), 2.5
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
        many = self.options.settings.elements > REFINED_AT
        settings = _finer_search(settings) if many and self.options.settings.peak_goal else settings
        for piece in _pieces(flat.size):
            fields, coarse = (mirrored(part, second[piece]) for part in self.fields(flat[piece]))
            # doubtful peaks of the exact theory are searched again; a third climb finds no higher peaks of the others
            few = not many and coarse is not None
            effort = replace(settings, finalists=FINALISTS) if few else settings
            peak.put(piece, find_peaks(patches[piece], ratios[piece], effort, fields, coarse, bool(own)))
        if not own:
            settings = _finer_search(settings)
        search = Search(patches, ratios, flat, second, settings, self.options.settings.doublings)
        if not self.options.settings.peak_goal:
            # a model with an error of its own gains nothing from elements where the search alone is rough
            doubt = (CHANGE_WEIGHT * peak.change if own else peak.error).max(axis=1)
            limit = refined_above(self.options.settings.elements)
            goal = np.maximum(limit, REFINED_SHARE * own * results.friction[flat])
            self._search_doubled(search, peak, goal, doubt > goal, goal < 0.0)
            return peak
        peak.error[:] *= SAFETY
        goal = peak_goal(results.scene.table, self.options)[results.rows[flat]]
        small = self._small(flat, goal)
        share, least, most = self._hidden(peak, flat, goal, small)
        peak.error[:] = np.fmax(np.fmin(peak.error, most[:, None]), least[:, None])
        doubt = (share < 1.0) & (peak.error.max(axis=1) > FADES[0] * goal)
        self._search_doubled(search, peak, goal, doubt, small > 0.0)
        share = np.fmax(share, small * rise(peak.error.max(axis=1) / goal, FADES))
        search_windows(results, search, peak, goal, share)
        return peak

    def _hidden(self, peak: Peak, flat: np.ndarray, goal: np.ndarray, small: np.ndarray) -> tuple[np.ndarray, ...]:
        """Return the share of windows in the peaks of patches `flat`, and their least and largest errors, (m,) each.

        See `UNLIKE` and `KNOWN`. `small` (m,) is that of `_small`; least errors are at most the tolerance `goal` (m,).
        """
        (patch, slip, friction, rows), model = self.results.of(flat), self.results.scene.model
        least, excess, higher = peak.stress.min(axis=1), [], 1.0 + LOW * rise(slenderness(patch), LOW_FROM)
        for doublings in (0, 1):
            stress, missed = model.pole_stress(patch, slip, friction, rows, doublings)
            excess.append(np.minimum(higher * stress - least, missed) / least)
        coupling = np.abs(model.given.elastic.coupling[rows])
        strong = (coupling > UNLIKE[1] * friction) & (coupling < UNLIKE[2]) & (goal >= RESOLVED)
        doubles = strong | (coupling <= UNLIKE[0] * friction)
        share = rise(np.where(doubles, DOUBTED * excess[1], excess[0]) / goal, FADES)
        known = small * (1.0 - rise(excess[0] / LEVEL, FADES)) * (1.0 - rise(slenderness(patch) / LONGEST, FADES))
        most = KNOWN / np.maximum(known, 1e-9)  # no limit where the error is not known
        every = (goal <= STRICT) & (friction > LITTLE_FRICTION)
        return small * np.where(every, 1.0, share), small * np.clip(excess[0], 0.0, goal), most

    def _small(self, flat: np.ndarray, goal: np.ndarray) -> np.ndarray:
        """Return 1 where the adhesion area at the spin pole is small, for the patches `flat`, (m,).

        It falls to 0 where the area is no longer small. `goal` (m,) are the tolerances of the peaks.
        """
        (patch, slip, friction, rows), model = self.results.of(flat), self.results.scene.model
        sticks: Any = model.stick(patch, slip, friction, rows)
        sharp = (np.abs(model.given.elastic.coupling[rows]) > SHARP[0] * friction) & (goal < RESOLVED)
        pole = np.abs(self.results.slip.pole_lateral[flat]) < patch.semi_axis_lateral
        share = np.where(goal > STRICT, *SMALL_SHARE)
        few = np.maximum(SMALL / (0.25 * np.pi * self.options.settings.elements**2), share)
        return (1.0 - rise(sticks / few, FADES)) * pole * (friction > np.where(sharp, SHARP[1], LITTLE_FRICTION))

    def _search_doubled(self, search: Search, peak: Peak, goal, doubt, small) -> None:
        """Search patches again under tractions on twice the elements, and again while their error is above `goal` (m,).

        `doubt` marks the patches that need it, (m,). A tolerance is met with peaks that fade from one number of
        elements to the next, so that they have no step; patches marked as `small` (m,) double once, because windows
        serve them better. `peak` is overwritten.
        """
        (patches, ratios, flat, second, settings, _), results, wanted = search, self.results, self.options.settings
        own = bool(results.scene.model.peak_error)
        old, share = peak.take(slice(None)), np.ones((len(peak.stress), 1))
        old = replace(old, stress=old.stress.copy(), error=old.error.copy())
        rough = np.flatnonzero(doubt & (results.slides_along[flat] == 0))
        weight = np.where(small, DOUBLED_SMALL, DOUBLED[0])
        for doublings in range(1, wanted.doublings + 1):
            done = []
            for piece in _pieces(rough.size, PIECE if own else FINER_PIECE):
                rows = rough[piece]
                shares = self._shares(flat[rows], partial(results.scene.model.finer_shares, doublings=doublings))
                if shares is None:
                    return
                (fields, coarse), converged = (mirrored(part, second[rows]) for part in shares[:2]), shares[2]
                finer = find_peaks(patches[rows], ratios[rows], settings, fields, coarse, own).take(converged)
                rows = rows[converged]
                if wanted.peak_goal:
                    changed = weight[rows, None] * np.abs(finer.stress / old.stress[rows] - 1.0)
                    finer.error[:] = np.fmax(changed, DOUBLED[1] * finer.error)
                    share[rows, 0] *= rise(old.error[rows].max(axis=1) / goal[rows], FADES)
                else:  # the change between two grids may be small by chance, and is no estimate then
                    finer.error[:] = np.maximum(finer.error, goal[rows, None])
                stress, error = (
                    new + (now[rows] - before[rows]) + (share[rows] - 1.0) * (new - before[rows])
                    for new, now, before in (
                        (finer.stress, peak.stress, old.stress),
                        (finer.error, peak.error, old.error),
                    )
                )
                old.put(rows, finer)
                peak.put(rows, replace(finer, stress=stress, error=error))
                results.refined[flat[rows]] = doublings
                done.append(rows[(finer.error.max(axis=1) > FADES[0] * goal[rows]) & ~small[rows]])
            rough = np.concatenate(done) if done else rough[:0]

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
        finer = results.scene.model.finer_shares
        doublings = int(results.refined[results.scene.mirror.source(number)][0])
        fields, *_ = self._shares(number, partial(finer, doublings=doublings)) if doublings else self.fields(number)
        return NO_FIELD if fields is None else fields[0]

    def at(self, flat: int, points: np.ndarray, body: int, sign: float) -> np.ndarray:
        """Return the stress components at points below one patch, (m, 6) [MPa]."""
        results = self.results
        row = int(np.count_nonzero(results.good[:flat]))
        order = max(self.options.settings.peak.polish, SECTION_ORDER)
        parts = stress_parts(self._every_row[row], points, order, order, self._field(flat))
        stress = body_stress(parts, self.poisson_ratio[flat, body], sign)
        return results.patch.max_pressure[flat] * stress
