"""Stresses of the planes below a patch, which a point of a body passes while it is overrolled.

A point moves through the stress field along y at fixed x and z, so a line of a plane along y is its
stress history.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from trackroller.halfspace.tractions import Tractions

PADDING = 0.18  # nodes beyond the patch along y over those of the patch, on each side
# over the smaller half side of the patch; the stresses that decide lie at 0.3 to 0.8, or under high
# friction higher
DEPTHS = np.array([0.05, 0.1, 0.17, 0.26, 0.37, 0.5, 0.66, 0.9])
RUNG = 0.07  # step of the logarithm of the ratio of sides


@dataclass(frozen=True)
class RollerTractions(Tractions):
    """Tractions on the rollers of n cases, (n, contact, ...); NaN where there is no patch, slips in
    full slip as well.

    Attributes
    ----------
    mirrored : numpy.ndarray of bool
        Cases whose contact 2 is the mirror image of contact 1, (n,).
    """

    mirrored: np.ndarray

    def by_patch(self, values: Callable[[int, int], Any], *shape: int) -> np.ndarray:
        """Return values of the case and contact of each patch, (n, contact, *shape); NaN where
        there is no patch.

        Contact 2 of a mirrored case repeats the values of contact 1.
        """
        own = [values(case, contact) for case, contact in zip(*self.solved_patches, strict=True)]
        return self.of_all_patches(np.array(own, dtype=float).reshape(-1, *shape))

    @property
    def solved_patches(self) -> tuple[np.ndarray, np.ndarray]:
        """Return case and contact of each patch that is no mirror image of another, (m,) each."""
        has_patch = np.isfinite(self.x[:, :, 0])
        has_patch[:, 1] &= ~self.mirrored
        case, contact = np.nonzero(has_patch)
        return case, contact

    def of_all_patches(self, values: np.ndarray) -> np.ndarray:
        """Return values of the `solved_patches`, (m, ...), for each case and contact, (n, contact,
        ...), as `by_patch`.
        """
        out = np.full((*self.x.shape[:2], *values.shape[1:]), np.nan)
        out[self.solved_patches] = values
        out[self.mirrored, 1] = out[self.mirrored, 0]
        return out

    @property
    def steps(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the spacings of the nodes along x and y, (n, contact) each [mm]."""
        step_x, step_y = (
            (axis[..., -1] - axis[..., 0]) / (axis.shape[-1] - 1) for axis in (self.x, self.y)
        )
        return step_x, step_y

    def loads(self, case: int, contact: int) -> PatchLoads:
        """Return the loads of one patch."""
        at = case, contact
        step_x, step_y = (float(step[at]) for step in self.steps)
        return PatchLoads(
            np.stack([self.shear_lateral[at], self.shear_rolling[at], self.pressure[at]]),
            step_x,
            step_y,
        )


@dataclass(frozen=True)
class PatchLoads:
    """Loads q_x, q_y, p of one patch as hats around nodes, (3, ny, nx) [MPa], and the spacings of
    the nodes [mm].
    """

    tractions: np.ndarray
    step_x: float
    step_y: float

    @property
    def half_sides(self) -> tuple[float, float]:
        """Return half the sides of the grid along x and y [mm]."""
        _, ny, nx = self.tractions.shape
        return 0.5 * nx * self.step_x, 0.5 * ny * self.step_y

    def on_ladder(self) -> PatchLoads:
        """Return loads on half as many nodes, in a larger box whose sides have a ratio of the
        ladder.

        Quadratic B-splines carry each load to three nodes along each axis. The resultants and first
        moments stay, and the second moments grow by a quarter of the squared spacing, which the
        kernels take back. The outermost nodes lie outside the box.
        """
        _, ny, nx = self.tractions.shape
        wide, long = self.half_sides
        ratio = math.exp(RUNG * round(math.log(wide / long) / RUNG))
        nodes = (nx + 1) // 2, (ny + 1) // 2
        step_x, step_y = (
            2.0 * max(wide, ratio * long) / nodes[0],
            2.0 * max(long, wide / ratio) / nodes[1],
        )
        across, along = (
            _spread(nx, self.step_x, nodes[0], step_x),
            _spread(ny, self.step_y, nodes[1], step_y),
        )
        return PatchLoads(along @ self.tractions @ across.T, step_x, step_y)


def _spread(points: int, spacing: float, nodes: int, step: float) -> np.ndarray:
    """Return the shares (nodes + 2, points) of loads at points that quadratic B-splines carry to
    nodes.
    """
    places, at = (np.arange(n) - 0.5 * (n - 1) for n in (nodes + 2, points))
    u = np.abs(spacing / step * at - places[:, None])
    return spacing / step * np.where(u < 0.5, 0.75 - u**2, 0.5 * np.maximum(1.5 - u, 0.0) ** 2)


def _lengths(nodes: tuple[int, int]) -> tuple[int, int]:
    """Return lengths along y and x of a circular convolution whose wrapped parts fall on no wanted
    place.
    """
    # heavy, as is the compiled room below: planning reads only the declarations of the limits
    from scipy import fft

    (nx, ny), beside = nodes, 2  # nodes that the correction of B-splines reaches
    return fft.next_fast_len(2 * (ny + beside) - 1), fft.next_fast_len(
        2 * (nx + beside) - 1, real=True
    )


@lru_cache(maxsize=64)
def _smooth_kernels(ratio: float, nodes: tuple[int, int], inner: tuple[int, int]) -> np.ndarray:
    """Return the kernels of loads on the ladder at `DEPTHS`, without the spread by B-splines and
    hats.

    Patches whose sides have nearly the same ratio share the kernels, which take most of the time of
    a plane.
    """
    from scipy import fft  # heavy, see _lengths

    from trackroller.halfspace.hats import hat_kernels

    sides = (min(ratio, 1.0), min(1.0 / ratio, 1.0))
    lengths = _lengths(nodes)
    small = 0.5 * min(side * n for side, n in zip(sides, inner, strict=True))
    kernels = fft.rfft2(
        hat_kernels(sides, nodes, small * DEPTHS, lengths, np.float32(0.0)), overwrite_x=True
    )
    # The transform of B-spline and hat is sinc^5; its inverse up to the sixth power of the wave
    # number.
    for axis, length, shape in zip((3, 4), lengths, ((-1, 1), (-1,)), strict=True):
        wave = 2.0 - 2.0 * np.cos(2.0 * np.pi * np.arange(kernels.shape[axis]) / length)
        inverse = 1.0 + 5.0 / 24.0 * wave + 47.0 / 1152.0 * wave**2
        kernels *= inverse.reshape(shape).astype(np.float32)
    return np.asarray(kernels)


def planes(loads: PatchLoads, depths: np.ndarray, poisson_ratio: np.ndarray) -> np.ndarray:
    """Return the stresses of both bodies on planes at any depth below one patch.

    Parameters
    ----------
    loads : PatchLoads
        The loads on the roller, bilinear between the nodes; (-q_x, -q_y, p) act on the guide.
    depths : numpy.ndarray
        z >= 0 of the planes, (depth,) [mm].
    poisson_ratio : numpy.ndarray
        nu of roller and guide, (2,) [1].

    Returns
    -------
    numpy.ndarray
        Stresses (body, depth, component, y, x) in the order of `halfspace.stress.COMPONENTS` [MPa].
        Along y the planes have `PADDING` times the nodes more on each side.
    """
    from trackroller.halfspace.hats import planes_below
    from trackroller.halfspace.stress import FRICTION_SIGNS

    rows = math.ceil(PADDING * loads.tractions.shape[1])
    padded = np.pad(loads.tractions, ((0, 0), (rows, rows), (0, 0))).astype(np.float32)
    return planes_below(padded, (loads.step_x, loads.step_y), depths, poisson_ratio, FRICTION_SIGNS)


def deep_planes(loads: PatchLoads, poisson_ratio: np.ndarray) -> np.ndarray:
    """Return the stresses of both bodies on the planes `DEPTHS` below one patch, on half as many
    nodes.

    Parameters
    ----------
    loads : PatchLoads
        The loads on the roller.
    poisson_ratio : numpy.ndarray
        nu of roller and guide, (2,) [1].

    Returns
    -------
    numpy.ndarray
        Stresses (body, depth, component, y, x) as of `planes` [MPa].

    Notes
    -----
    Stresses at a depth are smooth: half the nodes give them with errors of the fourth order of the
    spacing, 1000 times larger than the rounding of single precision.
    """
    from scipy import fft  # heavy, see _lengths

    from trackroller.halfspace.hats import body_spectra
    from trackroller.halfspace.stress import FRICTION_SIGNS

    ladder = loads.on_ladder()
    _, ny, nx = ladder.tractions.shape
    rows = math.ceil(PADDING * ny)
    ratio = math.exp(
        RUNG * round(math.log(ladder.step_x / ladder.step_y * (nx - 2) / (ny - 2)) / RUNG)
    )
    kernels = _smooth_kernels(ratio * (ny - 2) / (nx - 2), (nx, ny + rows), (nx - 2, ny - 2))
    lengths = _lengths((nx, ny + rows))
    spectra = fft.rfft2(
        np.pad(ladder.tractions, ((0, 0), (rows, 0), (0, 0))).astype(np.float32), lengths
    )
    bodies = body_spectra(
        spectra, kernels, poisson_ratio.astype(np.float32), np.array(FRICTION_SIGNS, np.float32)
    )
    return np.asarray(
        fft.irfft2(bodies, lengths, overwrite_x=True)[..., : ny + 2 * rows, 1 : nx - 1]
    )
