"""Finer elements around the adhesion area of a patch, in windows that lie in one another.

Around the spin pole the adhesion area may be smaller than an element, and it may end in a needle. The peak stress on
the surface depends on the shape of this area. The tractions of a patch are known outside a window around it. Inside
the window they are solved again on elements of half the size, and so on in a window of the window. The known tractions
fade out from the edge of a window, so that no step of the tractions there acts on the adhesion area.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple

import numpy as np
from scipy.fft import next_fast_len
from scipy.ndimage import label

from trackroller.contact.common import Ellipse
from trackroller.contact.influence import Influence, influence
from trackroller.contact.kalker import subgrid
from trackroller.contact.kalker.newton import Problem, newton, room_for
from trackroller.contact.kalker.problem import KalkerSettings, PatchSolution
from trackroller.numerics.splines import interpolated

# Between the adhesion area and the edge of a window lie MARGIN elements, in the first window FIRST_MARGIN, and WIDER
# times the size of the area. With 6 elements in the first window, one more element changed a peak by 0.3 %.
MARGIN, FIRST_MARGIN, WIDER = 6, 7, 0.25
CLOSE = 4  # elements between the area and the edge below which a window is made larger: half of MARGIN, and one
UNSEEN = 1.25  # where no element sticks, the area may lie at all elements with |z| below this times the smallest
# Far behind the spin pole, a spot under little pressure may stick too. Parts of the adhesion area do not count whose
# sum of squared pressures is below SPECK times the largest.
SPECK = 0.1
FADE, EDGE = 4.0, (1.0, 2.0)  # elements over which the known slip fades; where the solved tractions begin to count
MOST = 60_000  # elements of a window
# At the edge of the adhesion area, the mean traction of an element is not the traction at its centre. BETWEEN points
# along each side of the element give the difference. If the largest allowed residual is at most PRECISE, a window is
# solved twice: to a residual of ROUGH with the differences of the coarser elements, then with those of this solution.
# The error of a peak then falls with the square of the element size. Otherwise a window is solved once, without them.
BETWEEN, ROUGH, PRECISE = 4, 0.03, 4e-3
# A traction is given at points that are densest at the trailing tip of the adhesion area. The caller chooses how many
# of them an element has along each side there. Far from the tip, the step from point to point is SPACING over this
# number, times the distance from the tip. Along each axis, the number of points is a multiple of MULTIPLE.
SPACING, MULTIPLE = 0.16, 16

Spans = tuple[tuple[int, int], tuple[int, int]]  # first and last element, plus 1, along x and y


class Grid(NamedTuple):
    """Solution on the elements of a window, or of the whole patch.

    Attributes
    ----------
    traction, slip : numpy.ndarray of complex, shape (ny, nx)
        Traction over mu p_max, and slip times the shear modulus over mu p_max, x + iy.
    z : numpy.ndarray, shape (1, 2, ny, nx)
        See `subgrid`.
    first, of : tuple of int
        Number of the first element along x and y, and numbers over the patch.
    sharpened : bool
        Whether its influence functions were sharpened, see `influence`.
    """

    traction: np.ndarray
    slip: np.ndarray
    z: np.ndarray
    first: tuple[int, int]
    of: tuple[int, int]
    sharpened: bool = False


def _ramp(place: np.ndarray, span: tuple[int, int], of: int, first: float, width: float) -> np.ndarray:
    """Return weights that rise from 0 at the edges of a window to 1; an edge of the grid has none.

    `place` are places along one axis in elements from the start of the window `span`; the grid has `of` elements.
    """
    (start, end), out = span, np.ones(place.size)
    for inside, distance in ((start > 0, place), (end < of, end - start - place)):
        t = np.clip((distance - first) / width, 0.0, 1.0) if inside else 1.0
        out *= t * t * t * (10.0 - 15.0 * t + 6.0 * t * t)
    return out


def _weights(spans: Spans, grid: Grid, parts: tuple[int, int]) -> np.ndarray:
    """Return the weights of a window of `grid` at `parts` points along x and y of each element."""
    across, along = (
        _ramp((np.arange((span[1] - span[0]) * k) + 0.5) / k, span, of, 0.0, FADE)
        for span, of, k in zip(spans, grid.z.shape[:1:-1], parts, strict=True)
    )
    return along[:, None] * across


def _heights(first: tuple[int, int], shape: tuple[int, ...], of: tuple[int, int]) -> np.ndarray:
    """Return the pressure over p_max at the centres of elements, (ny, nx)."""
    x, y = (
        (2.0 * (start + np.arange(n)) + 1.0) / total - 1.0
        for start, n, total in zip(first, shape[::-1], of, strict=True)
    )
    return np.sqrt(np.maximum(1.0 - x * x - (y * y)[:, None], 0.0))


def _area(grid: Grid) -> Spans:
    """Return the box around the large parts that stick or, if no element sticks, around those closest to sticking."""
    height = _heights(grid.first, grid.traction.shape, grid.of)
    loaded = height > 0.0
    for axis, (start, of) in enumerate(zip(grid.first[::-1], grid.of[::-1], strict=True)):  # not at the window's edge
        places = np.arange(loaded.shape[axis])
        near = ((start > 0) & (places < MARGIN)) | ((start + places.size < of) & (places >= places.size - MARGIN))
        loaded &= ~(near[:, None] if axis == 0 else near)
    length = np.where(loaded, np.hypot(grid.z[0, 0], grid.z[0, 1]), np.inf)
    numbers, _ = label(length <= max(1.0, UNSEEN * length.min()), np.ones((3, 3)))
    weights = np.bincount(numbers.ravel(), ((numbers > 0) * height * height).ravel())
    rows, columns = np.nonzero(weights[numbers] >= SPECK * weights.max())
    return (int(columns.min()), int(columns.max()) + 1), (int(rows.min()), int(rows.max()) + 1)


def _limits(grid: Grid) -> Spans:
    """Return the elements of a grid away from its edges where known tractions fade out."""
    spans = [
        (int(FADE) * (first > 0), count - int(FADE) * (first + count < of))
        for first, of, count in zip(grid.first, grid.of, grid.z.shape[:1:-1], strict=True)
    ]
    return spans[0], spans[1]


def _around(grid: Grid, area: Spans) -> Spans:
    """Return the window around an area, within the limits of `grid`."""
    spans = []
    for (start, end), (low, high) in zip(area, _limits(grid), strict=True):
        margin = (MARGIN if grid.sharpened else FIRST_MARGIN) + int(WIDER * (end - start))
        first, last = max(start - margin, low), min(end + margin, high)
        count = next_fast_len(last - first)  # large prime factors make transforms up to 1.5 times slower
        last = min(first + count, high)
        spans.append((max(last - count, low), last))
    return spans[0], spans[1]


def _edges(parent: Grid, spans: Spans, grid: Grid, found: Spans) -> tuple[Spans, list[tuple[bool, bool]]]:
    """Return the adhesion area in elements of `parent`, and whether it is close to each edge of the window `spans`.

    `found` is the area on the finer `grid` that covers this window. It may reach beyond the area that `parent` shows,
    because elements wider than the area show a part of it only.
    """
    area, close = [], []
    for k, (start, end) in enumerate(found):
        parts, (low, high) = grid.of[k] // parent.of[k], spans[k]
        own = (grid.first[k] + start) // parts - parent.first[k], -(-(grid.first[k] + end) // parts) - parent.first[k]
        area.append(own)
        inner = low + parent.first[k] > 0, high + parent.first[k] < parent.of[k]
        close.append((inner[0] and own[0] - CLOSE <= low, inner[1] and own[1] + CLOSE >= high))
    return (area[0], area[1]), close


def _larger(grids: list[Grid], windows: list[Spans], spans: Spans, grid: Grid, found: Spans) -> Spans:
    """Return a window larger than `spans` of the last of `grids` if the area `found` is close to an edge, or `spans`.

    Where the last grid ends there, it is dropped with its own window, and this window is returned larger.
    """
    area, close = _edges(grids[-1], spans, grid, found)
    if not any(map(any, close)):
        return spans
    wider = _around(grids[-1], area)
    union = [(min(old[0], new[0]), max(old[1], new[1])) for old, new in zip(spans, wider, strict=True)]
    while tuple(union) == spans and windows:
        grids.pop()
        spans = windows.pop()
        union = [
            (max(low - MARGIN * near[0], least), min(high + MARGIN * near[1], most))
            for (low, high), near, (least, most) in zip(spans, close, _limits(grids[-1]), strict=True)
        ]
    return union[0], union[1]


def _solved(
    grid: Grid, spans: Spans, parts: tuple[int, int], patch: Ellipse, poisson_ratio: float, settings
) -> tuple[Grid, bool]:
    """Solve the window `spans` of a grid with `parts` elements for each along x and y; say if this has converged."""
    (i0, i1), (j0, j1) = spans
    (kx, ky), inside = parts, (slice(j0, j1), slice(i0, i1))
    length = math.sqrt(patch.semi_axis_lateral[0] * patch.semi_axis_rolling[0])
    hx, hy = (
        2.0 * half[0] / (length * n)
        for half, n in zip((patch.semi_axis_lateral, patch.semi_axis_rolling), grid.of, strict=True)
    )
    coarse = influence(hx, hy, poisson_ratio, j1 - j0, i1 - i0, sharpened=grid.sharpened)
    known = grid.slip[inside] - coarse.product(grid.traction[inside] * _weights(spans, grid, (1, 1)))
    first, of = ((grid.first[0] + i0) * kx, (grid.first[1] + j0) * ky), (grid.of[0] * kx, grid.of[1] * ky)
    z = interpolated(grid.z, kx, ky)[:, :, j0 * ky : j1 * ky, i0 * kx : i1 * kx]
    height, weights = _heights(first, z.shape[2:], of), _weights(spans, grid, parts)
    finer = influence(hx / kx, hy / ky, poisson_ratio, height.shape[0], height.shape[1], sharpened=True)
    slip, share = interpolated(np.stack([known.real, known.imag]), kx, ky), subgrid.bounded(z.copy())[0]
    traction = (share[0] + 1j * share[1]) * height
    rigid = slip[0] + 1j * slip[1] - finer.product(traction * (1.0 - weights))
    traction, slip, z, converged = _by_means(finer, rigid, height, weights, traction, z, settings)
    return Grid(traction, slip, z, first, of, True), converged


def _by_means(finer: Influence, rigid: np.ndarray, height, weights, traction, z: np.ndarray, settings):
    """Solve a window for the mean tractions of its elements, or for those at the centres, see `PRECISE`.

    `traction` (ny, nx) and `z` (1, 2, ny, nx) are those of the coarser elements. Returns traction, slip, z, converged.
    """
    room, own, missed, driver = room_for(*height.shape, settings.krylov), finer.own, np.zeros(height.shape), rigid
    precise = settings.tolerance <= PRECISE
    for limit in (ROUGH, settings.tolerance) if precise else (settings.tolerance,):
        if precise:  # Newton's method finds the mean traction minus `missed`, and the slip minus own * missed
            missed = subgrid.missed_by_centres(z[0], interpolated(z[0], BETWEEN, BETWEEN)) * height * weights
            driver = rigid + finer.product(missed) - own * missed
        law = Problem(finer, driver, height, 1.0, np.zeros(1), np.ones(1))
        at, residual, *_ = newton(law, room, traction - missed, limit, settings.steps)
        traction, slip = at[0] + missed, at[1] + own * missed
        smooth = subgrid.smooth(traction, slip, height, height, own)
        z = np.stack([smooth.real, smooth.imag])[None]
    return traction, slip, z, bool(residual <= settings.tolerance)


def _grade(place: float, of: int, points: int) -> tuple[np.ndarray, tuple[float, ...]]:
    """Return points (m,) along one axis that are densest at `place`, and mid, width, start and span of their grading.

    The points and `place` are in half sides of the patch; `of` finest elements would fill the whole patch. At `place`
    each element has `points` of them. For the grading see `halfspace.ellipse_kernels.GRADES`.
    """
    width = min(2.0 / (of * SPACING), 1.0)
    start, end = (math.asinh((side - place) / width) for side in (-1.0, 1.0))
    count = MULTIPLE * math.ceil((end - start) * points / (MULTIPLE * SPACING))
    scale = start + (end - start) * (np.arange(count) + 0.5) / count
    return place + width * np.sinh(scale), (place, width, start, end - start)


def _in_half_sides(grid: Grid, place: tuple[float, float]) -> list[float]:
    """Convert a place, in elements from the first corner of a grid, to x and y in half sides of the patch."""
    return [2.0 * (first + at) / of - 1.0 for first, at, of in zip(grid.first, place, grid.of, strict=True)]


def _tip(grid: Grid, area: Spans) -> list[float]:
    """Return the trailing tip of the adhesion area: x over half the width of the patch, y over half its length."""
    (start, end), (row, _) = area
    column = start + int(np.argmin(np.hypot(*grid.z[0, :, row, start:end])))
    return _in_half_sides(grid, (column + 0.5, row + 0.5))


def _field(grids: list[Grid], windows: list[Spans], area: Spans, points: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the traction over mu p of the whole patch, (1, 2, ny, nx), and the grading of its points, (12,).

    At the trailing tip of the adhesion area, an element has `points` along each side. `area` are the elements of this
    area in the finest window. The grading is that along x, followed by that along y.
    """
    finest = grids[-1]
    axes = [_grade(place, of, points) for place, of in zip(_tip(finest, area), finest.of, strict=True)]
    ends = zip(*(_in_half_sides(finest, corner) for corner in zip(*area, strict=True)), strict=True)
    (x, _), (y, _) = axes
    (nx, ny), whole = grids[0].of, grids[0].z
    out = subgrid.shares_at(whole, 0.5 * nx * (x + 1.0) - 0.5, 0.5 * ny * (y + 1.0) - 0.5)
    for parent, spans, grid in zip(grids, windows, grids[1:], strict=False):
        inside, places, weights = [], [], []
        for k, (along, _) in enumerate(axes):
            place = 0.5 * grid.of[k] * (along + 1.0) - grid.first[k]
            start, end = np.searchsorted(place, (0.0, grid.z.shape[3 - k]))
            inside.append(slice(start, end))
            places.append(place[start:end])
            weights.append(_ramp(places[k] * parent.of[k] / grid.of[k], spans[k], parent.z.shape[3 - k], *EDGE))
        part = out[0, :, inside[1], inside[0]]
        part += weights[1][:, None] * weights[0] * (subgrid.shares_at(grid.z, *(p - 0.5 for p in places))[0] - part)
    return out, np.array([number for (_, grade), end in zip(axes, ends, strict=True) for number in (*grade, *end)])


def fields(
    patch: Ellipse, solution: PatchSolution, poisson_ratio: float, bound: float, settings: KalkerSettings
) -> Iterator[tuple[Callable[[int], tuple[np.ndarray, np.ndarray]], float]]:
    """Yield the traction of one patch over mu p with one, two, ... windows.

    A window that turns out too small for the next one is made larger, so that a number of windows may come twice. The
    iteration ends with a window that has too many elements or does not converge.

    Parameters
    ----------
    patch : Ellipse
        The patch, arrays (1,).
    solution : PatchSolution
        Its solution under constant friction.
    poisson_ratio, bound : float
        Combined Poisson's ratio, and mu p_max over the combined shear modulus [1].
    settings : KalkerSettings
        Stopping rule.

    Yields
    ------
    tuple
        A function, and the number of elements in the adhesion area. The function takes how many points an element has
        along each side at the trailing tip of this area. It returns the traction over mu p at all points,
        (1, 2, ny, nx), and their grading along x and y, (12,), see `halfspace.ellipse_kernels.GRADES`.
    """
    own = subgrid.fields_of(patch, solution)
    z, count = own.before_law(), own.traction.shape[-1]
    traction, slip = (v[0, 0] + 1j * v[0, 1] for v in (solution.traction, solution.slip / bound))
    grids, windows = [Grid(traction, slip, z, (0, 0), (count, count))], list[Spans]()
    spans = _around(grids[0], _area(grids[0]))
    lean = 0.5 * math.log2(patch.semi_axis_lateral[0] / patch.semi_axis_rolling[0])
    while True:
        # the first window makes long elements shorter
        longer = 2 ** round(abs(lean)) if not windows else 1
        parts = (2 * longer, 2) if lean > 0.0 else (2, 2 * longer)
        elements = math.prod((end - start) * k for (start, end), k in zip(spans, parts, strict=True))
        if elements > MOST:
            return
        grid, converged = _solved(grids[-1], spans, parts, patch, poisson_ratio, settings)
        if not converged:
            return
        found, solved = _area(grid), (spans, len(grids))
        spans = _larger(grids, windows, spans, grid, found)
        if (spans, len(grids)) != solved:
            continue
        grids.append(grid)
        windows.append(spans)
        yield (
            partial(_field, grids.copy(), windows.copy(), found),
            float((np.hypot(grid.z[0, 0], grid.z[0, 1]) < 1.0).sum()),
        )
        spans = _around(grid, found)
