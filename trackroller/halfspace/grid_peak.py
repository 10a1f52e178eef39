"""The largest von Mises stress over the closed half-space below tractions on a grid.

The tractions are bilinear between the element centres, for which the stresses are exact everywhere (`influence`). A
scan of whole planes by FFT finds seeds for both bodies; from each a pattern search with parabolas climbs, surface and
surroundings of the patch being admissible.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit

from trackroller.halfspace.influence import CornerLoads, corner_loads, corner_table
from trackroller.halfspace.kernels import bilinear_corner
from trackroller.halfspace.peak import Peak
from trackroller.numerics.threads import share_rows

DEPTHS = (0.0, 0.06, 0.15, 0.3, 0.48, 0.7, 1.0)  # of the scanned planes, over the smaller half side of the patch
EDGE_ROWS, EDGE_DEPTHS = 9, (0.0, 0.25, 0.5, 1.0)  # looked at below an edge; depths over the width of an element
APART = 0.25  # half sides between seeds
WORTH = 0.9  # of the highest seed, from which others climb too
# The error falls nearly with the square of the element size for smooth pressures, so a third of the change from a grid
# of twice the size is added; changes above SMOOTH tell of a singular pressure, where nothing is.
SMOOTH = 0.05
ERROR_SHARE = 0.3  # of that change, left as the estimated error; all of it above SMOOTH
STEEP = 0.35  # step of the pressure between neighbours, over the largest, that tells of an edge
ERROR_FLOOR = 2e-3  # what the solved pressure itself may be off by


@dataclass(frozen=True)
class GridLoad:
    """Tractions of one patch on the roller: x (nx,), y (ny,) [mm], fields (ny, nx, 3) of q_x, q_y, p [MPa]."""

    x: np.ndarray
    y: np.ndarray
    tractions: np.ndarray

    @functools.cached_property
    def corners(self) -> CornerLoads:
        """The loads as the sums of stresses take them."""
        return corner_loads(self.x, self.y, self.tractions)

    @functools.cached_property
    def coarse(self) -> GridLoad:
        """Means over 2 x 2 elements."""
        ny, nx, _ = self.tractions.shape
        mean = self.tractions.reshape(ny // 2, 2, nx // 2, 2, 3).mean(axis=(1, 3))
        return GridLoad(self.x.reshape(-1, 2).mean(axis=1), self.y.reshape(-1, 2).mean(axis=1), mean)

    @property
    def size(self) -> tuple[float, float]:
        """Half sides of the grid [mm]."""
        n, m = self.x.size, self.y.size
        return (0.5 * (self.x[-1] - self.x[0]) * n / (n - 1), 0.5 * (self.y[-1] - self.y[0]) * m / (m - 1))


@njit(cache=True, error_model="numpy", nogil=True)
def _parts(points, corners, weights, out):  # pragma: no cover (compiled)
    """Stress parts at points (n, 3) into out (n, 4, 6): pressure A, B; shear A, B (sigma = A + nu B)."""
    for i in range(points.shape[0]):
        for j in range(corners.shape[0]):
            k = bilinear_corner(points[i, 0] - corners[j, 0], points[i, 1] - corners[j, 1], points[i, 2])
            qx, qy, p = weights[j, 0], weights[j, 1], weights[j, 2]
            for c in range(6):
                out[i, 0, c] += p * k[12 + c]
                out[i, 1, c] += p * k[30 + c]
                out[i, 2, c] += qx * k[c] + qy * k[6 + c]
                out[i, 3, c] += qx * k[18 + c] + qy * k[24 + c]


def stress_parts(load: GridLoad, points: np.ndarray) -> np.ndarray:
    """Stress (n, 4, 6) [MPa] at points (n, 3) [mm]: of the pressure A and B, of the shear A and B.

    sigma = A_p + nu B_p + sign (A_t + nu B_t), sign +1 for the roller, -1 for the guide.
    """
    loads = load.corners
    out = np.zeros((len(points), 4, 6))
    _parts(np.ascontiguousarray(points) / loads.length, loads.corners, loads.near, out)
    return out


def body_stress(parts: np.ndarray, poisson_ratio: float, sign: float) -> np.ndarray:
    """Stress (n, 6) of one body from `stress_parts`."""
    return parts[:, 0] + poisson_ratio * parts[:, 1] + sign * (parts[:, 2] + poisson_ratio * parts[:, 3])


def _von_mises(s: np.ndarray) -> np.ndarray:
    normal = (s[..., 0] - s[..., 1]) ** 2 + (s[..., 2] - s[..., 0]) ** 2 + (s[..., 1] - s[..., 2]) ** 2
    return np.sqrt(0.5 * normal + 3.0 * (s[..., 3] ** 2 + s[..., 4] ** 2 + s[..., 5] ** 2))


def _planes(load: GridLoad, depths: np.ndarray, poisson_ratio: np.ndarray) -> np.ndarray:
    """von Mises stress (2, nz, ny, nx) of roller and guide below the nodes at `depths` [mm]."""
    from scipy import fft

    ny, nx, _ = load.tractions.shape
    hx, hy = (load.x[-1] - load.x[0]) / (nx - 1), (load.y[-1] - load.y[0]) / (ny - 1)
    length = max(hx, hy)
    gx, gy = hx / length, hy / length
    shape = (fft.next_fast_len(3 * ny - 2), fft.next_fast_len(3 * nx - 2, real=True))
    spectra = fft.rfft2(np.moveaxis(load.tractions, -1, 0), shape)
    out = np.empty((2, depths.size, ny, nx))
    across, along = gx * np.arange(-nx, nx + 1), gy * np.arange(-ny, ny + 1)
    for k, depth in enumerate(depths):
        for nu in dict.fromkeys(poisson_ratio.tolist()):
            table = corner_table(across, along, depth / length, nu)
            kernel = fft.rfft2(np.diff(np.diff(table, n=2, axis=1), n=2, axis=2) / (gx * gy), shape)
            pressed = spectra[2] * kernel[12:]
            sheared = spectra[0] * kernel[:6] + spectra[1] * kernel[6:12]
            fields = fft.irfft2(np.stack([pressed, sheared]), shape)[..., ny - 1 : 2 * ny - 1, nx - 1 : 2 * nx - 1]
            for body in np.flatnonzero(poisson_ratio == nu):
                stress = fields[0] + (1.0 if body == 0 else -1.0) * fields[1]
                out[body, k] = _von_mises(np.moveaxis(stress, 0, -1))
    return out


def _seeds(values: np.ndarray, load: GridLoad, depths: np.ndarray, count: int) -> list[np.ndarray]:
    """The highest places of a scan (nz, ny, nx) that lie apart, down to 0.9 of the highest."""
    half = np.array([*load.size, min(load.size)])
    order = np.argsort(values, axis=None)[::-1]
    found: list[np.ndarray] = []
    best = values.reshape(-1)[order[0]]
    for flat in order:
        if len(found) == count or values.reshape(-1)[flat] < 0.9 * best:
            break
        k, j, i = np.unravel_index(flat, values.shape)
        place = np.array([load.x[i], load.y[j], depths[k]])
        if all(np.max(np.abs(place - other) / half) > APART for other in found):
            found.append(place)
    return found


def _edge_seeds(value, load: GridLoad) -> list[np.ndarray]:
    """The highest place below the sharpest edge of the pressure, if there is one: it lies between the nodes."""
    pressure = np.pad(load.tractions[:, :, 2], ((0, 0), (1, 1)))
    step = np.abs(np.diff(pressure, axis=1))
    sharpest = int(np.argmax(step.max(axis=0)))
    if not step[:, sharpest].max() > STEEP * pressure.max():
        return []
    h = load.x[1] - load.x[0]
    rows = np.flatnonzero(step[:, sharpest] > 0.5 * step[:, sharpest].max())
    rows = rows[np.linspace(0, rows.size - 1, min(rows.size, EDGE_ROWS)).astype(int)]
    x = load.x[0] + (sharpest - 0.5) * h
    places = np.array([(x, load.y[j], h * z) for j in rows for z in EDGE_DEPTHS])
    return [places[int(np.argmax(value(places)))]]


def _climb(value, start: np.ndarray, steps: np.ndarray, smallest: float) -> tuple[np.ndarray, float]:
    """Maximum of `value` (of points (n, 3)) near `start`: six neighbours, a parabola along each axis, then closer."""
    place, first = start.copy(), steps.copy()
    top = float(value(place[None])[0])
    for _ in range(40):
        star = place + np.concatenate([np.diag(steps), -np.diag(steps)])
        star[:, 2] = np.maximum(star[:, 2], 0.0)
        heights = value(star)
        ahead, behind = heights[:3], heights[3:]
        curve = ahead - 2 * top + behind
        with np.errstate(divide="ignore", invalid="ignore"):
            shift = np.where(curve < 0, 0.5 * steps * (behind - ahead) / curve, steps * np.sign(ahead - behind))
        shift = np.clip(np.nan_to_num(shift), -1.5 * steps, 1.5 * steps)
        if place[2] == 0.0 and ahead[2] <= top:  # on the surface both neighbours in depth are not on a parabola
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
        if np.all(steps <= smallest * first):
            break
        steps = 0.4 * steps
    return place, top


def _one_peak(load: GridLoad, poisson_ratio: np.ndarray, seeds: int, smallest: float) -> np.ndarray:
    """Stress, x, y, z and relative error of roller and guide, (2, 5)."""
    coarse = load.coarse
    depths = min(load.size) * np.array(DEPTHS)
    # ridges of stress on the surface are narrow: there the full grid is scanned
    surface, below = _planes(load, depths[:1], poisson_ratio), _planes(coarse, depths[1:], poisson_ratio)
    steps = np.array([coarse.x[1] - coarse.x[0], coarse.y[1] - coarse.y[0], 0.1 * min(load.size)])
    out = np.full((2, 5), np.nan)
    for body, sign in ((0, 1.0), (1, -1.0)):

        def value(points, grid=load, nu=poisson_ratio[body], sign=sign):
            return _von_mises(body_stress(stress_parts(grid, points), nu, sign))

        starts = _seeds(surface[body], load, depths[:1], seeds) + _seeds(below[body], coarse, depths[1:], seeds)
        inner = len(starts)
        starts += _edge_seeds(value, load)
        heights = [float(value(seed[None])[0]) for seed in starts]
        best, possible = -math.inf, -math.inf
        for k in np.argsort(heights)[::-1]:
            if k < inner and heights[k] < WORTH * max(heights):
                continue
            place, top = _climb(value, starts[k], 0.5 * steps, smallest)
            change = (top - float(value(place[None], grid=coarse)[0])) / top
            smooth = abs(change) < SMOOTH
            told = top * (1.0 + change / 3.0) if smooth else top
            possible = max(possible, told * (1.0 + (ERROR_SHARE if smooth else 1.0) * abs(change)))
            if told > best:
                best = told
                out[body] = told, *place, (ERROR_SHARE if smooth else 1.0) * abs(change)
        out[body, 4] = max(out[body, 4], possible / best - 1.0) + ERROR_FLOOR
    return out


def find_grid_peaks(
    loads: Sequence[GridLoad], poisson_ratio: np.ndarray, seeds: int = 2, smallest: float = 0.1
) -> Peak:
    """Peak von Mises stress of roller and guide under n patches with tractions on grids.

    Parameters
    ----------
    loads : tractions of n patches on the roller, with even numbers of elements; the guide feels (-q_x, -q_y, p)
    poisson_ratio : of roller and guide, (n, 2)
    seeds : number of places on the surface, and below, from which the search climbs; smallest : last step, over half
        an element of twice the size

    Returns stresses in MPa (not over p_max). The estimated relative error is a share of the change on elements of twice
    the size. Where the pressure is singular (a sharp edge), so is the stress, and the estimate says so.
    """
    out = np.full((len(loads), 2, 5), np.nan)

    def work(first: int, last: int) -> None:
        for i in range(first, last):
            if np.all(np.isfinite(loads[i].tractions)):
                out[i] = _one_peak(loads[i], poisson_ratio[i], seeds, smallest)

    share_rows(work, len(loads), 1)
    return Peak(*np.moveaxis(out, 2, 0))
