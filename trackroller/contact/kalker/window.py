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

from trackroller.contact.common import Ellipse
from trackroller.contact.influence import influence
from trackroller.contact.kalker import subgrid
from trackroller.contact.kalker.newton import Problem, newton, room_for
from trackroller.contact.kalker.problem import KalkerSettings, PatchSolution

MARGIN, WIDER = 6, 0.25  # elements between the adhesion area and the edge of a window, and more over the area's size
FADE, EDGE = 4.0, (1.0, 2.0)  # elements over which the known slip fades; where the solved tractions begin to count
MOST, LARGEST = 30_000, 4_000_000  # elements of a window, and points of a traction field
PARTS = 2  # points of the traction along each side of an element

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
    """

    traction: np.ndarray
    slip: np.ndarray
    z: np.ndarray
    first: tuple[int, int]
    of: tuple[int, int]


def _ramp(span: tuple[int, int], of: int, parts: int, first: float, width: float) -> np.ndarray:
    """Return weights along one axis that rise from 0 at the edges of a window to 1; an edge of the grid has none."""
    start, end = span
    place = (np.arange((end - start) * parts) + 0.5) / parts
    out = np.ones(place.size)
    for inside, distance in ((start > 0, place), (end < of, end - start - place)):
        t = np.clip((distance - first) / width, 0.0, 1.0) if inside else 1.0
        out *= t * t * t * (10.0 - 15.0 * t + 6.0 * t * t)
    return out


def _weights(spans: Spans, grid: Grid, parts: tuple[int, int], first: float = 0.0, width: float = FADE) -> np.ndarray:
    """Return the weights of a window of `grid` at `parts` points along x and y of each element."""
    across, along = (
        _ramp(span, of, k, first, width) for span, of, k in zip(spans, grid.z.shape[:1:-1], parts, strict=True)
    )
    return along[:, None] * across


def _heights(first: tuple[int, int], shape: tuple[int, ...], of: tuple[int, int]) -> np.ndarray:
    """Return the pressure over p_max at the centres of elements, (ny, nx)."""
    x, y = (
        (2.0 * (start + np.arange(n)) + 1.0) / total - 1.0
        for start, n, total in zip(first, shape[::-1], of, strict=True)
    )
    return np.sqrt(np.maximum(1.0 - x * x - (y * y)[:, None], 0.0))


def _window(grid: Grid) -> Spans:
    """Return the window around the adhesion area, or around the element next to adhesion."""
    loaded = _heights(grid.first, grid.traction.shape, grid.of) > 0.0
    for axis, (start, of) in enumerate(zip(grid.first[::-1], grid.of[::-1], strict=True)):  # not at the window's edge
        places = np.arange(loaded.shape[axis])
        near = ((start > 0) & (places < MARGIN)) | ((start + places.size < of) & (places >= places.size - MARGIN))
        loaded &= ~(near[:, None] if axis == 0 else near)
    length = np.where(loaded, np.hypot(grid.z[0, 0], grid.z[0, 1]), np.inf)
    rows, columns = np.nonzero(length <= max(1.0, length.min()))
    spans = []
    for places, most in zip((columns, rows), length.shape[::-1], strict=True):
        start, end = int(places.min()), int(places.max()) + 1
        margin = MARGIN + int(WIDER * (end - start))
        spans.append((max(start - margin, 0), min(end + margin, most)))
    return spans[0], spans[1]


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
    coarse = influence(hx, hy, poisson_ratio, j1 - j0, i1 - i0)
    known = grid.slip[inside] - coarse.product(grid.traction[inside] * _weights(spans, grid, (1, 1)))
    first, of = ((grid.first[0] + i0) * kx, (grid.first[1] + j0) * ky), (grid.of[0] * kx, grid.of[1] * ky)
    start = subgrid.shares_of(grid.z, kx, ky)[0][:, j0 * ky : j1 * ky, i0 * kx : i1 * kx]
    height = _heights(first, start.shape[1:], of)
    start = (start[0] + 1j * start[1]) * height
    finer = influence(hx / kx, hy / ky, poisson_ratio, *height.shape)
    rigid = subgrid.interpolated(known, kx, ky) - finer.product(start * (1.0 - _weights(spans, grid, parts)))
    problem = Problem(finer, rigid, height, 1.0, np.zeros(1), np.ones(1))
    at, residual, *_ = newton(
        problem, room_for(*height.shape, settings.krylov), start, settings.tolerance, settings.steps
    )
    z = at[0] / np.where(height > 0.0, height, 1.0) - at[1] / (finer.own * np.maximum(height, subgrid.RIM))
    return Grid(at[0], at[1], np.stack([z.real, z.imag])[None], first, of), bool(residual <= settings.tolerance)


def _field(grids: list[Grid], windows: list[Spans]) -> np.ndarray:
    """Return the traction over mu p of the whole patch at the points of the finest window, (1, 2, ., .)."""
    nx, ny = (PARTS * n for n in grids[-1].of)
    out = subgrid.shares_of(grids[0].z, nx // grids[0].of[0], ny // grids[0].of[1])
    for parent, spans, grid in zip(grids, windows, grids[1:], strict=False):
        kx, ky = nx // grid.of[0], ny // grid.of[1]
        i, j, (_, _, rows, columns) = grid.first[0] * kx, grid.first[1] * ky, grid.z.shape
        part = out[0, :, j : j + rows * ky, i : i + columns * kx]
        weight = _weights(spans, parent, (nx // parent.of[0], ny // parent.of[1]), *EDGE)
        part += weight * (subgrid.shares_of(grid.z, kx, ky)[0] - part)
    return out


def fields(
    patch: Ellipse, solution: PatchSolution, poisson_ratio: float, bound: float, settings: KalkerSettings
) -> Iterator[tuple[Callable[[], tuple[np.ndarray, np.ndarray]], float]]:
    """Yield the traction of one patch over mu p with one, two, ... windows.

    The iteration ends with a window that has too many elements or does not converge.

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
        Function that returns the traction over mu p with the windows and on the elements of the patch, (1, 2, ., .)
        each; and the number of elements in the adhesion area.
    """
    own = subgrid.fields_of(patch, solution)
    z, count = own.before_law(), own.traction.shape[-1]
    traction, slip = (v[0, 0] + 1j * v[0, 1] for v in (solution.traction, solution.slip / bound))
    grids, windows = [Grid(traction, slip, z, (0, 0), (count, count))], list[Spans]()
    plain = subgrid.shares_of(z, 1, 1)
    lean = 0.5 * math.log2(patch.semi_axis_lateral[0] / patch.semi_axis_rolling[0])
    while True:
        # the first window makes long elements shorter
        longer = 2 ** round(abs(lean)) if not windows else 1
        parts = (2 * longer, 2) if lean > 0.0 else (2, 2 * longer)
        spans = _window(grids[-1])
        elements = math.prod((end - start) * k for (start, end), k in zip(spans, parts, strict=True))
        if elements > MOST or PARTS**2 * math.prod(grids[-1].of) * math.prod(parts) > LARGEST:
            return
        grid, converged = _solved(grids[-1], spans, parts, patch, poisson_ratio, settings)
        if not converged:
            return
        grids.append(grid)
        windows.append(spans)
        yield (
            partial(lambda *found: (_field(*found), plain), grids.copy(), windows.copy()),
            float((np.hypot(grid.z[0, 0], grid.z[0, 1]) < 1.0).sum()),
        )
