"""Compiled temperature rises of a surface under heat sources that move over it.

Each patch is computed by itself, so that its digits do not depend on the patches beside it.
"""

from __future__ import annotations

import math

import numpy as np
from rocket_fft import c2r, r2c
from scipy.fft import next_fast_len

from trackroller.numerics.compiled import compiled
from trackroller.numerics.threads import share_rows

# step of the logarithm of the diffusion length, and its end over the sides of the grid
STEP, REACH = 0.3, 1e4
SPREAD = 5.0  # diffusion lengths beyond which no heat arrives
ONE = 6.0  # from here on the error function is 1 to the last digit
PIECE = 4  # least number of patches for a thread


@compiled
def _lengths(steps, nodes, decay):  # pragma: no cover (compiled)
    """Return the first diffusion length, the step of its logarithm, and the number of steps.

    Below the first length all heat is still in its cell. Above the last one it has spread or moved
    beyond the grid.
    """
    (hx, hy), (nx, ny) = steps, nodes
    small, long = min(hx, hy), ny * hy
    low, high = small / 8.0, REACH * max(nx * hx, long)
    if decay > 0.0:
        low = min(low, math.sqrt(0.1 * small / decay))
        reach = SPREAD + math.sqrt(SPREAD**2 + 4.0 * decay * (long + hy))
        high = min(high, reach / (2.0 * decay))
    # heat that moves fast passes a cell in a short part of the logarithm
    step = STEP / max(1.0, math.sqrt(decay * long))
    count = math.ceil(math.log(max(high, 2.0 * low) / low) / step) + 1
    return low, step, count


@compiled
def _write_half_kernel(steps, nodes, decay, half):  # pragma: no cover (compiled)
    """Write the part of `cell_temperature` with offsets x >= 0 into `half` (2 ny - 1, nx)."""
    (hx, hy), (nx, ny) = steps, nodes
    low, step, count = _lengths(steps, nodes, decay)
    across = np.empty(nx)
    half[:] = 0.0
    for k in range(count):
        w = low * math.exp(k * step)
        moved = decay * w * w
        # beyond these cells both error functions are 1, and their difference is 0
        wide = min(nx, int(ONE * w / hx + 0.5) + 1)
        first = max(1 - ny, math.ceil((-ONE * w - moved) / hy - 0.5))
        last = min(ny - 1, math.floor((ONE * w - moved) / hy + 0.5))
        before = math.erf(-0.5 * hx / w)
        for i in range(wide):
            beyond = math.erf(hx * (i + 0.5) / w)
            across[i] = beyond - before
            before = beyond
        before = math.erf((hy * (first - 0.5) + moved) / w)
        for j in range(first, last + 1):
            beyond = math.erf((hy * (j + 0.5) + moved) / w)
            along = (beyond - before) * w
            before = beyond
            row = half[ny - 1 + j]
            for i in range(wide):
                row[i] += along * across[i]
    half[ny - 1, 0] += 4.0 * low / math.expm1(step)  # the sum over all smaller lengths
    half *= 0.25 * step / math.sqrt(math.pi)


@compiled
def cell_temperature(steps, nodes, decay):  # pragma: no cover (compiled)
    """Return the surface temperature beside a cell that is heated uniformly while the surface moves
    towards -y.

    Parameters
    ----------
    steps : tuple of float
        Sides of the cell along x and y [mm].
    nodes : tuple of int
        Numbers of nodes along x and y.
    decay : float
        V/(4 kappa), travel speed over four times the diffusivity [1/mm].

    Returns
    -------
    numpy.ndarray
        Temperature times conductivity over heat density, at node offsets from -(n - 1) to n - 1,
        (2 ny - 1, 2 nx - 1) [mm].

    Notes
    -----
    The mean over the cell of exp(-V (r + y)/(2 kappa))/(2 pi r), written as an integral over the
    diffusion length w = sqrt(4 kappa t) of the time t since the heat was released; it holds for V =
    0 and under the cell itself.
    """
    nx, ny = nodes
    half = np.empty((2 * ny - 1, nx))
    _write_half_kernel(steps, nodes, decay, half)
    out = np.empty((2 * ny - 1, 2 * nx - 1))
    for i in range(nx):
        out[:, nx - 1 + i] = half[:, i]
        out[:, nx - 1 - i] = half[:, i]
    return out


@compiled
def _write_wrapped(half, out):  # pragma: no cover (compiled)
    """Write a half kernel and its mirror image in x into `out`, with offset 0 at index 0."""
    ny = (half.shape[0] + 1) // 2
    out[:] = 0.0
    for j in range(1 - ny, ny):
        for i in range(half.shape[1]):
            out[j, i] = half[ny - 1 + j, i]
            out[j, -i] = half[ny - 1 + j, i]


@compiled
def _write_rises(patches, steps, heat, decays, lengths, out):  # pragma: no cover (compiled)
    """Write the rises of `largest_rises` of the patches with these numbers."""
    _, ny, nx = heat.shape
    long, wide = lengths
    half = np.empty((2 * ny - 1, nx))
    field = np.empty((long, wide))
    loads = np.empty((long, wide // 2 + 1), np.complex128)
    kernel = np.empty((long, wide // 2 + 1), np.complex128)
    axes = np.array([0, 1])
    for m in patches:
        field[:] = 0.0
        field[:ny, :nx] = heat[m]
        # input, output, axes, forward, factor, threads
        r2c(field, loads, axes, True, 1.0, 1)
        for d in range(decays.shape[1]):
            equal = 0
            while decays[m, equal] != decays[m, d]:
                equal += 1
            if equal < d:
                out[m, d] = out[m, equal]
                continue
            _write_half_kernel((steps[m, 0], steps[m, 1]), (nx, ny), decays[m, d], half)
            _write_wrapped(half, field)
            r2c(field, kernel, axes, True, 1.0, 1)
            for j in range(long):
                for i in range(wide // 2 + 1):
                    kernel[j, i] *= loads[j, i]
            c2r(kernel, field, axes, False, 1.0 / (long * wide), 1)
            out[m, d] = max(0.0, np.max(field[:ny, :nx]))


def largest_rises(steps: np.ndarray, heat: np.ndarray, decays: np.ndarray) -> np.ndarray:
    """Return the largest temperature rise of each patch under its heat, times the conductivity.

    Parameters
    ----------
    steps : numpy.ndarray
        Sides of the elements along x and y, (m, 2) [mm].
    heat : numpy.ndarray
        Heat densities of the elements, (m, ny, nx) [W/mm2].
    decays : numpy.ndarray
        V/(4 kappa) of each body that is asked for, (m, d) [1/mm]; equal ones are computed once.

    Returns
    -------
    numpy.ndarray
        Rises times the conductivity, (m, d) [W/mm]; NaN where a patch has no step, a heat is not
        finite or a decay is not known.
    """
    out = np.full(decays.shape, np.nan)
    known = np.isfinite(heat).all(axis=(1, 2)) & np.isfinite(steps).all(axis=1)
    patches = np.flatnonzero(known & np.isfinite(decays).all(axis=1))
    # nothing that wraps around falls onto the patch
    lengths = tuple(next_fast_len(2 * n - 1, real=True) for n in heat.shape[1:])

    def work(first: int, last: int) -> None:
        _write_rises(patches[first:last], steps, heat, decays, lengths, out)

    share_rows(work, patches.size, PIECE)
    return out
