"""Search for peaks below ellipses again, with finer elements in windows around adhesion areas of few elements."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import chain, islice
from typing import Any, NamedTuple

import numpy as np

from trackroller.contact.common import slenderness
from trackroller.halfspace.ellipse import FIELD
from trackroller.halfspace.ellipse_kernels import GRADES
from trackroller.halfspace.peak import Peak, find_peaks
from trackroller.halfspace.peak_settings import PeakSettings
from trackroller.roller.stages.scene import Results

# A search uses at most LEVELS windows, each with finer elements than the last. In 99 of 100 adhesion areas, the error
# of the peak at the trailing tip is at most BOUND over the square root of the number of elements in the area. BOUND
# has one value for fewer than MANY[0] elements, one for MANY[0] to MANY[1], and one for more. The search starts in the
# first window whose bound meets the tolerance; this window needs at least FEW elements in the area, and at most ENOUGH.
LEVELS, BOUND, MANY, FEW, ENOUGH = 8, (0.25, 0.115, 0.08), (150, 1200), 50, 160
# In patches with an axis ratio above SLENDER_FROM, the bound is 1 + SLENDER (axis ratio - SLENDER_FROM) times as large.
SLENDER, SLENDER_FROM = 0.12, 3.0
# With at least MANY[0] elements in the area, the peak is compared with that of the window before. Its error is then the
# larger of CHANGED[0] times the last change and CHANGED[1] times the change before it, but at most the bound. Where the
# last change is larger than BEYOND times the bound, this change is the error. SEARCHED times the error of the search is
# added.
CHANGED, BEYOND, SEARCHED = (2.0, 1.0), 3.0, 0.15
# Relative error of a peak from the tractions outside the windows: OUTSIDE, or, if this is larger, OUTSIDE_SLENDER times
# the square of the axis ratio, on OUTSIDE_AT elements along an axis. In patches with an axis ratio above DOUBLED_ABOVE,
# the search may miss the tip; NEEDLE (axis ratio - DOUBLED_ABOVE) is added.
OUTSIDE, OUTSIDE_SLENDER, OUTSIDE_AT, NEEDLE = 1e-3, 2e-5, 48, 5e-4
# In windows, the residual of the friction law over mu p_max is at most RESIDUAL times the tolerance. If a window lowers
# the peak by more than FALLS times the tolerance, all places are searched, because another summit may be higher.
RESIDUAL, FALLS = 0.1, 0.2
# Before the windows, the elements of the patch double once for tolerances below DOUBLED_BELOW, and once more for
# tolerances up to STRICT or axis ratios above DOUBLED_ABOVE.
DOUBLED_BELOW, STRICT, DOUBLED_ABOVE = 0.03, 5e-3, 8.0
# POINTS: number of points along each side of an element at which the traction is given near the trailing tip, where it
# turns within a few elements. In an area of 200 elements, 2 points make the peak 1 % too low, and 4 points 0.1 %.
# POLISH: number of quadrature points for the stresses in the last climbs of a search. With 16, a climb may end where
# the stress is 1 % below the highest, and with 24 where it is 0.2 % below. Both have three values: for tolerances below
# FINER_BELOW[0], for those from FINER_BELOW[0] to below FINER_BELOW[1], and for larger ones.
POINTS, POLISH, FINER_BELOW = (8, 8, 3), (48, 24, 16), (0.012, 0.05)
# Quadrature points of the other steps of a search. With 16 at the summit, stresses in small areas err by up to 1.6 %.
IN_WINDOWS = {"climb": 12, "summit": 64}


def mirrored(fields: np.ndarray | None, rows: np.ndarray) -> np.ndarray | None:
    """Replace the fields (m, 2, ny, nx) of `rows` by their mirror images in x, in place, and return the fields."""
    if fields is not None and rows.any():
        image = fields[rows][..., ::-1]
        np.negative(image[:, 0], out=image[:, 0])
        fields[rows] = image
    return fields


def _graded(patches: np.ndarray, grades: np.ndarray, image: bool) -> np.ndarray:
    """Return copies of the records of patches with the grading `grades` (12,) of their fields.

    With `image`, they get the grading of the fields' mirror images in x.
    """
    mid, width, start, span, low, high, *along = grades
    if image:
        mid, start, low, high = -mid, -start - span, -high, -low
    out = patches.copy()
    for name, value in zip(GRADES, (mid, width, start, span, low, high, *along), strict=True):
        out[name] = value
    return out


class Search(NamedTuple):
    """Records, Poisson's ratios and numbers of m patches, whether they are mirrored, and how to search them.

    `doublings` is how often their elements may double.
    """

    patches: np.ndarray
    ratios: np.ndarray
    flat: np.ndarray
    second: np.ndarray
    settings: PeakSettings
    doublings: int


def _bound(resolved: float) -> float:
    """Return the bound of the error of a peak with `resolved` elements in the adhesion area."""
    return BOUND[np.searchsorted(MANY, resolved, "right")] / np.sqrt(max(resolved, 1.0))


def search_windows(results: Results, search: Search, peak: Peak, goal, share) -> None:
    """Search patches again with finer elements around their adhesion areas, until the peaks settle.

    Parameters
    ----------
    results : Results
        Forces and slips of the block.
    search : Search
        The m patches.
    peak : Peak
        Their peaks so far, overwritten.
    goal : numpy.ndarray, shape (m,)
        Tolerances of the peaks [1].
    share : numpy.ndarray, shape (m,)
        Share of the windows in each peak, from 0 (no search) to 1, so that peaks have no step where windows begin.
    """
    model = results.scene.model
    patch, slip, friction, rows = results.of(search.flat)
    ratio = slenderness(patch)
    again = (ratio > DOUBLED_ABOVE) | (goal <= STRICT)
    doublings = np.minimum((goal < DOUBLED_BELOW).astype(int) + again, max(search.doublings, 1))
    outside = np.fmax(OUTSIDE, OUTSIDE_SLENDER * (ratio * OUTSIDE_AT / (model.elements * 2**doublings)) ** 2)
    outside += NEEDLE * np.maximum(ratio - DOUBLED_ABOVE, 0.0)
    longer = 1.0 + SLENDER * np.maximum(ratio - SLENDER_FROM, 0.0)
    for i in np.flatnonzero((share > 0.0) & (results.slides_along[search.flat] == 0)).tolist():
        given = patch.take([i]), slip.take([i]), friction[[i]], rows[[i]], RESIDUAL * goal[i]
        windows: Iterator[Any] = islice(model.windows(*given, doublings=int(doublings[i])), LEVELS)
        if doublings[i] > 1:
            # A large area may have only one window: the next would have too many elements. Its peak is compared with
            # that of a window in twice as large elements.
            windows = chain(islice(model.windows(*given, doublings=int(doublings[i]) - 1), 1), windows)
        one, old = slice(i, i + 1), peak.take([i])
        _search_one(windows, search, i, peak, goal[i], outside[i], longer[i])
        # with a share below 1, a part of the change stays in the peak as an error
        old.error[:] = np.fmax(old.error, np.abs(peak.stress[one] / old.stress - 1.0))
        for value, plain in ((peak.stress, old.stress), (peak.error, old.error)):
            value[one] = plain + share[i] * (value[one] - plain)


def _search_one(windows: Iterator[Any], search: Search, i: int, peak: Peak, goal, outside, longer) -> None:
    """Search the patch number i of a search in one window after the other.

    `goal` is the tolerance, `outside` the error from the tractions outside the windows, and `longer` the factor by
    which the bound of the error is larger in slender patches.
    """
    skipped, before, resolved, one = None, None, 0.0, slice(i, i + 1)
    last = np.full((1, 2), np.inf)  # the first change alone does not show that a peak has settled
    for shares, resolved in windows:
        if resolved < np.clip((BOUND[0] / goal) ** 2, FEW, ENOUGH):
            skipped = shares
            continue
        finer = _found(shares, search, i, peak, goal)
        other, error = SEARCHED * finer.error + outside, np.full((1, 2), longer * _bound(resolved))
        if resolved >= MANY[0] and (before or (skipped and (error + other).max() > goal)):
            change = np.abs(finer.stress / (before or _found(skipped, search, i, peak, goal)).stress - 1.0)
            settled = np.fmax(CHANGED[0] * change, CHANGED[1] * last)
            error, last = np.where(change > BEYOND * error, change, np.fmin(error, settled)), change
        finer.error[:], before, skipped = error + other, finer, None
        peak.put(one, finer)
        if finer.error.max() <= goal:
            break
    if skipped is not None:  # every window had too few elements in the area
        finer = _found(skipped, search, i, peak, goal)
        finer.error[:] = np.fmax(longer * _bound(resolved), peak.error[one])
        peak.put(one, finer)


def _found(shares: Any, search: Search, i: int, peak: Peak, goal: float) -> Peak:
    """Return the peak of the patch number i of a search under the tractions that `shares` returns."""
    one, loose = slice(i, i + 1), np.searchsorted(FINER_BELOW, goal, "right")
    field, grades = shares(POINTS[loose])
    field = mirrored(field.astype(FIELD), search.second[one])
    patch = _graded(search.patches[one], grades, bool(search.second[i]))
    settings = replace(search.settings, polish=POLISH[loose], **IN_WINDOWS)
    given = patch, search.ratios[one], settings, field, field
    finer = find_peaks(*given, near=peak.take(one))
    if np.any(finer.stress < (1.0 - FALLS * goal) * peak.stress[one]):
        finer = finer.higher(find_peaks(*given))
    return finer
