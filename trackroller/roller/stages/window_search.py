"""Search for peaks below ellipses again, with finer elements in windows around adhesion areas of few elements."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import islice
from typing import Any, NamedTuple

import numpy as np

from trackroller.halfspace.ellipse import FIELD
from trackroller.halfspace.ellipse_kernels import GRADES
from trackroller.halfspace.peak import Peak, find_peaks
from trackroller.halfspace.peak_settings import PeakSettings
from trackroller.roller.stages.scene import Results

# Finer elements around adhesion areas: elements in the area with which its peak is resolved, levels at most, estimated
# error over the last change of a peak with so many elements and with fewer, over the error of the search, and from the
# tractions outside.
ENOUGH, LEVELS, CHANGED, UNRESOLVED, SEARCHED, OUTSIDE = 250, 6, 0.5, 2.0, 0.15, 1e-3
# Fewer elements in the area suffice if the peak then changes by less than this share of the tolerance, or if the stress
# that they miss, at most MISSED over the root of their number, is below the tolerance. Less than FEW are not searched.
FEW, STEADY, MISSED = 40, 0.1, 0.1
# Where a peak falls by more than this share of the tolerance, another summit may be higher: all places are searched.
FALLS = 0.5
DOUBLED_BELOW = 0.03  # below this tolerance, windows start from a solution on twice the elements
# Quadrature points of two steps of the search. With fewer, stresses in small adhesion areas err by up to 1.6 %.
IN_WINDOWS = {"climb": 12, "summit": 64}


def mirrored(fields: np.ndarray | None, rows: np.ndarray) -> np.ndarray | None:
    """Replace the fields (m, 2, ny, nx) of `rows` by their mirror images in x, in place, and return the fields."""
    if fields is not None and rows.any():
        image = fields[rows][..., ::-1]
        np.negative(image[:, 0], out=image[:, 0])
        fields[rows] = image
    return fields


def _graded(patches: np.ndarray, grades: np.ndarray, image: bool) -> np.ndarray:
    """Return records of patches whose fields have the grading `grades` (8,), or its mirror image in x."""
    mid, width, start, span, *along = grades
    if image:
        mid, start = -mid, -start - span
    out = patches.copy()
    for name, value in zip(GRADES, (mid, width, start, span, *along), strict=True):
        out[name] = value
    return out


class Search(NamedTuple):
    """Records, Poisson's ratios and numbers of m patches, whether they are mirrored, and how to search them."""

    patches: np.ndarray
    ratios: np.ndarray
    flat: np.ndarray
    second: np.ndarray
    settings: PeakSettings


def search_windows(results: Results, search: Search, peak: Peak, goal, hidden, spike) -> None:
    """Search the patches `hidden` again with finer elements around their adhesion areas, until the peaks settle.

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
    hidden, spike : numpy.ndarray of bool, shape (m,)
        Patches to search, and those whose stress at the spin pole may exceed the peak: an adhesion area of few elements
        shows neither its peak nor that it is missing, so that enough elements are asked for.
    """
    patches, ratios, flat, second, settings = search
    settings = replace(settings, **IN_WINDOWS)
    patch, slip, friction, rows = results.of(flat)
    enough = np.clip((MISSED / goal) ** 2, FEW, ENOUGH)
    for i in np.flatnonzero(hidden & (results.slides_along[flat] == 0)).tolist():
        one, skipped = slice(i, i + 1), None

        def found(shares: Callable[[], Any], i: int = i, one: slice = one) -> Peak:
            field, grades = shares()
            field = mirrored(field.astype(FIELD), second[one])
            given = _graded(patches[one], grades, bool(second[i])), ratios[one], settings, field, field
            finer = find_peaks(*given, near=peak.take(one))
            if np.any(finer.stress < (1.0 - FALLS * goal[i]) * peak.stress[one]):
                finer = finer.higher(find_peaks(*given))
            return finer

        given = patch.take([i]), slip.take([i]), friction[[i]], rows[[i]]
        windows = results.scene.model.windows(*given, doubled=bool(goal[i] < DOUBLED_BELOW))
        for shares, resolved in islice(windows, LEVELS):
            if resolved < FEW:
                skipped = shares
                continue
            finer, factor = found(shares), CHANGED if resolved >= ENOUGH else UNRESOLVED
            changed = np.abs(finer.stress / peak.stress[one] - 1.0)
            if skipped is not None and changed.max() > STEADY * goal[i]:
                changed = np.abs(finer.stress / found(skipped).stress - 1.0)
            skipped = None
            finer.error[:] = factor * changed + SEARCHED * finer.error + OUTSIDE
            peak.put(one, finer)
            steady = changed.max() <= STEADY * goal[i] and not spike[i]
            if (steady or resolved >= enough[i]) and finer.error.max() <= goal[i]:
                break
        if skipped is not None:  # no window resolves the area
            finer = found(skipped)
            finer.error[:] = np.fmax(UNRESOLVED * np.abs(finer.stress / peak.stress[one] - 1.0), peak.error[one])
            peak.put(one, finer)
