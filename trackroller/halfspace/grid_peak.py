"""The largest von Mises stress in the closed half-space below tractions on a grid.

The tractions are bilinear between the element centres; for such tractions the stresses are exact
everywhere (`influence`). A scan of whole planes by FFT finds seeds for both bodies. From each seed
a pattern search with parabolas climbs; it may use points on the surface and points outside the
patch.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trackroller.halfspace.hats import planes_below
from trackroller.halfspace.influence import CornerLoads, corner_loads, stress_parts
from trackroller.halfspace.peak import Peak
from trackroller.halfspace.stress import FRICTION_SIGNS, body_stress, von_mises
from trackroller.numerics.threads import share_rows

# of the scanned planes / smaller half side of the patch [1]
DEPTHS = (0.0, 0.06, 0.15, 0.3, 0.48, 0.7, 1.0)
# points below a sharp edge; depth / width of an element [1]
EDGE_ROWS, EDGE_DEPTHS = 9, (0.0, 0.25, 0.5, 1.0)
APART = 0.25  # smallest distance between seeds / half sides of the patch [1]
SMALLEST = 0.1  # last step of a climb over its first [1]
WORTH = 0.9  # share of the highest seed that a seed needs for a climb
# For smooth pressures the error falls nearly with the square of the element size. A third of the
# change from a grid with elements of twice the size is therefore added. A relative change above
# SMOOTH shows a singular pressure, to which nothing is added.
SMOOTH = 0.05
# share of this change that is the estimated error; above SMOOTH it is the whole change
ERROR_SHARE = 0.3
# Of places with the same stress, as mirror images have, the one farther outward and ahead counts as
# the higher one. The lean is the relative difference of stress for a half side; rounding differs
# far less, and the error far more.
LEAN = 1e-6
SHARP = 0.98  # share of the sharpest edge's step that another edge needs for seeds of its own
# an edge has a larger step of pressure between neighbours, divided by the largest pressure
STEEP = 0.35
ERROR_FLOOR = 2e-3  # relative error of the solved pressure itself


@dataclass(frozen=True)
class GridLoad:
    """Tractions of one patch on the roller: x (nx,), y (ny,) [mm], tractions q_x, q_y, p (ny, nx,
    3) [MPa].
    """

    x: np.ndarray
    y: np.ndarray
    tractions: np.ndarray

    @functools.cached_property
    def corners(self) -> CornerLoads:
        """Return the loads in the form that the sums of stresses take."""
        return corner_loads(self.x, self.y, self.tractions)

    def stress_parts(self, points: np.ndarray) -> np.ndarray:
        """Return the stress parts (n, 4, 6) [MPa] at points (n, 3) [mm], see
        `stress.body_stress`.
        """
        return stress_parts(self.corners, points)

    @property
    def pressure(self) -> np.ndarray:
        """Return the pressure (ny, nx) [MPa]."""
        return self.tractions[..., -1]

    @functools.cached_property
    def coarse(self) -> GridLoad:
        """Return the mean tractions of 2 x 2 elements."""
        ny, nx, _ = self.tractions.shape
        mean = self.tractions.reshape(ny // 2, 2, nx // 2, 2, 3).mean(axis=(1, 3))
        return GridLoad(
            self.x.reshape(-1, 2).mean(axis=1), self.y.reshape(-1, 2).mean(axis=1), mean
        )

    @property
    def sides(self) -> tuple[float, float]:
        """Return the sides of an element [mm]."""
        return (self.x[-1] - self.x[0]) / (self.x.size - 1), (self.y[-1] - self.y[0]) / (
            self.y.size - 1
        )

    @property
    def size(self) -> tuple[float, float]:
        """Return the half sides of the grid [mm]."""
        n, m = self.x.size, self.y.size
        return (
            0.5 * (self.x[-1] - self.x[0]) * n / (n - 1),
            0.5 * (self.y[-1] - self.y[0]) * m / (m - 1),
        )


def _planes(load: GridLoad, depths: np.ndarray, poisson_ratio: np.ndarray) -> np.ndarray:
    """Return the von Mises stress (2, nz, ny, nx) of roller and guide below the nodes at `depths`
    [mm].
    """
    tractions = np.moveaxis(load.tractions, -1, 0)
    return von_mises(
        np.moveaxis(
            planes_below(tractions, load.sides, depths, poisson_ratio, FRICTION_SIGNS), 2, -1
        )
    )


def _lean(load: GridLoad, x, y, outward: float):
    """Return the factor on the stress at places x, y [mm] that decides between mirror images, see
    LEAN.
    """
    wide, long = load.size
    return 1.0 + LEAN * (outward * (x - load.x.mean()) / wide + 0.5 * (y - load.y.mean()) / long)


def _seeds(
    values: np.ndarray, load: GridLoad, depths: np.ndarray, count: int, outward: float
) -> list[np.ndarray]:
    """Return the highest places of a scan (nz, ny, nx) that lie apart, down to the share WORTH of
    the highest.
    """
    half = np.array([*load.size, min(load.size)])
    values = values * _lean(load, load.x, load.y[:, None], outward)
    order = np.argsort(values, axis=None)[::-1]
    places: list[np.ndarray] = []
    best = values.reshape(-1)[order[0]]
    for flat in order:
        if len(places) == count or values.reshape(-1)[flat] < WORTH * best:
            break
        k, j, i = np.unravel_index(flat, values.shape)
        place = np.array([load.x[i], load.y[j], depths[k]])
        if all(np.max(np.abs(place - other) / half) > APART for other in places):
            places.append(place)
    return places


def _edge_seeds(value, load: GridLoad) -> list[np.ndarray]:
    """Return the highest place below each of the sharpest edges of the pressure, which lie between
    the nodes.
    """
    pressure = np.pad(load.pressure, ((0, 0), (1, 1)))
    step = np.abs(np.diff(pressure, axis=1))
    sharpest = step.max(axis=0)
    if not sharpest.max() > STEEP * pressure.max():
        return []
    h, seeds = load.x[1] - load.x[0], []
    # both ends of a flat are alike
    for edge in np.flatnonzero(sharpest > SHARP * sharpest.max()).tolist():
        rows = np.flatnonzero(step[:, edge] > 0.5 * sharpest[edge])
        rows = rows[np.linspace(0, rows.size - 1, min(rows.size, EDGE_ROWS)).astype(int)]
        x = load.x[0] + (edge - 0.5) * h
        places = np.array([(x, load.y[j], h * z) for j in rows for z in EDGE_DEPTHS])
        seeds.append(places[int(np.argmax(value(places)))])
    return seeds


def _climb(value, start: np.ndarray, steps: np.ndarray) -> tuple[np.ndarray, float]:
    """Return place and value of the maximum of `value` near `start`.

    Each step evaluates six neighbours and the maximum of the parabolas along the three axes; if
    none of them is clearly better, the steps shrink.
    """
    place, first = start.copy(), steps.copy()
    top = float(value(place[None])[0])
    for _ in range(40):
        star = place + np.concatenate([np.diag(steps), -np.diag(steps)])
        star[:, 2] = np.maximum(star[:, 2], 0.0)
        heights = value(star)
        ahead, behind = heights[:3], heights[3:]
        curve = ahead - 2 * top + behind
        with np.errstate(divide="ignore", invalid="ignore"):
            shift = np.where(
                curve < 0, 0.5 * steps * (behind - ahead) / curve, steps * np.sign(ahead - behind)
            )
        shift = np.clip(np.nan_to_num(shift), -1.5 * steps, 1.5 * steps)
        # at the surface there is no neighbour above, hence no parabola
        if place[2] == 0.0 and ahead[2] <= top:
            shift[2] = 0.0
        jump = place + shift
        jump[2] = max(jump[2], 0.0)
        candidates = np.concatenate([star, jump[None]])
        heights = np.concatenate([heights, value(jump[None])])
        best = int(np.argmax(heights))
        if heights[best] > top * (1 + 1e-9):
            moved = np.abs(candidates[best] - place) / steps
            place, top = candidates[best], float(heights[best])
            if np.max(moved) > 0.5:
                continue
        if np.all(steps <= SMALLEST * first):
            break
        steps = 0.4 * steps
    return place, top


def _one_peak(load: GridLoad, poisson_ratio: np.ndarray, seeds: int, outward: float) -> Peak:
    """Return the peaks of roller and guide below one patch, arrays (2,)."""
    coarse = load.coarse
    depths = min(load.size) * np.array(DEPTHS)
    # ridges of stress on the surface are narrow, so that the surface is scanned on the full grid
    surface, below = (
        _planes(load, depths[:1], poisson_ratio),
        _planes(coarse, depths[1:], poisson_ratio),
    )
    steps = np.array([coarse.x[1] - coarse.x[0], coarse.y[1] - coarse.y[0], 0.1 * min(load.size)])
    summits = []
    for body, sign in enumerate(FRICTION_SIGNS):

        def value(points, grid=load, nu=poisson_ratio[body], sign=sign):
            return von_mises(body_stress(grid.stress_parts(points), nu, sign))

        starts = _seeds(surface[body], load, depths[:1], seeds, outward)
        starts += _seeds(below[body], coarse, depths[1:], seeds, outward)
        scanned = len(starts)
        starts += _edge_seeds(value, load)
        heights = [float(value(seed[None])[0]) for seed in starts]
        climbs = [
            k
            for k in np.argsort(heights)[::-1]
            if k >= scanned or heights[k] >= WORTH * max(heights)
        ]
        summits.append(
            _highest(
                value, [_climb(value, starts[k], 0.5 * steps) for k in climbs], coarse, outward
            )
        )
    return Peak(*np.array(summits).T)


def _highest(
    value, summits: list[tuple[np.ndarray, float]], coarse: GridLoad, outward: float
) -> tuple[float, ...]:
    """Return stress, x, y, z, relative error and change of the highest summit, extrapolated from
    the coarse grid.
    """
    best, height, possible = (math.nan,) * 6, -math.inf, -math.inf
    for place, top in summits:
        change = (top - float(value(place[None], grid=coarse)[0])) / top
        smooth = abs(change) < SMOOTH
        extrapolated = top * (1.0 + change / 3.0) if smooth else top
        error = (ERROR_SHARE if smooth else 1.0) * abs(change)
        possible = max(possible, extrapolated * (1.0 + error))
        leaning = extrapolated * float(_lean(coarse, place[0], place[1], outward))
        if leaning > height:
            best, height = (extrapolated, *place, error, abs(change)), leaning
    *peak, error, change = best
    return *peak, max(error, possible / best[0] - 1.0) + ERROR_FLOOR, change


def find_grid_peaks(
    loads: Sequence[GridLoad],
    poisson_ratio: np.ndarray,
    seeds: int = 2,
    outward: np.ndarray | None = None,
) -> Peak:
    """Find the peak von Mises stress of roller and guide below n patches with tractions on grids.

    Parameters
    ----------
    loads : sequence of GridLoad
        Tractions of n patches on the roller, with even numbers of elements; (-q_x, -q_y, p) act on
        the guide.
    poisson_ratio : numpy.ndarray, shape (n, 2)
        Poisson's ratios of roller and guide [1].
    seeds : int
        Number of places on the surface, and below it, from which the search climbs.
    outward : numpy.ndarray, shape (n,), optional
        Sign of x on the outer side of each contact; 1 if not given. Of two peaks that are alike,
        the outer one counts, so that the peaks of mirrored contacts are mirror images.

    Returns
    -------
    Peak
        Stresses [MPa] and places [mm], arrays (n, 2).

    Notes
    -----
    The estimated relative error is a share of the change on elements of twice the size. At a sharp
    edge the pressure is singular and so is the stress; the estimated error is then large.
    """
    out = Peak.empty(len(loads))
    signs = np.ones(len(loads)) if outward is None else outward

    def work(first: int, last: int) -> None:
        for i in range(first, last):
            if np.all(np.isfinite(loads[i].tractions)):
                out.put(i, _one_peak(loads[i], poisson_ratio[i], seeds, float(signs[i])))

    share_rows(work, len(loads), 1)
    return out
