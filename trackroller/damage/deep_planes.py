"""Compiled stresses of planes below patches, and the shear stresses at which patches shake down.

Stresses at a depth are smooth: half the nodes give them with errors of the fourth order of the
spacing, 1000 times larger than the rounding of single precision. Loads are carried to these nodes,
which lie on a ladder of shapes, so that patches of nearly the same shape share their kernels. Each
patch is computed by itself, so that its digits do not depend on the patches beside it.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from rocket_fft import c2c, c2r, r2c
from scipy import fft

from trackroller.damage.ball import ball_of_plane, top_of_depths
from trackroller.damage.histories import DEPTHS, PADDING, PatchLoads
from trackroller.halfspace.hats import body_spectra, hat_kernels
from trackroller.halfspace.stress import FRICTION_SIGNS
from trackroller.numerics.compiled import compiled
from trackroller.numerics.threads import share_rows

RUNG = 0.07  # step of the logarithm of the ratio of sides
BESIDE = 1  # nodes of the ladder outside its box, on each side
REACH = 2  # nodes that the correction of B-splines reaches
PIECE = 8  # patches of nearly the same shape that a thread computes in one call
# Below an ellipse the shear has one summit below the surface, and a second one at the surface under
# high friction. On 10,468 bodies of random designs the shear of a depth that `_is_wanted` leaves
# out was at most 0.96 of the largest, and the largest between 0.17 and 0.5 of the half side.
ORDER = np.array([4, 3, 5, 0, 2, 6, 1, 7])  # of `DEPTHS` in the search for the largest shear
FIRST = 4  # depths at the beginning of this order that are always computed
SHALLOW = 0.8  # share of the largest shear from which on that of the first depth may be a summit
SIGNS = np.array(FRICTION_SIGNS, np.float32)


class Ladder(NamedTuple):
    """Nodes along x and y within the boxes of all patches on a ladder, nodes beyond them along y on
    each side, and lengths along y and x of the convolution.
    """

    nodes: tuple[int, int]
    rows: int
    lengths: tuple[int, int]


def ladder_of(points: tuple[int, int]) -> Ladder:
    """Return the ladder of patches with these numbers of loads along x and y."""
    nx, ny = ((n + 1) // 2 for n in points)
    rows = math.ceil(PADDING * (ny + 2 * BESIDE))
    # the wrapped parts of the convolution fall on no wanted place
    wide, long = nx + 2 * BESIDE + REACH, ny + 2 * BESIDE + rows + REACH
    lengths = fft.next_fast_len(2 * long - 1), fft.next_fast_len(2 * wide - 1, real=True)
    return Ladder((nx, ny), rows, lengths)


@compiled
def rung_of(sides):  # pragma: no cover (compiled)
    """Return the number of the ratio of the sides of a patch on the ladder."""
    return round(math.log(sides[0] / sides[1]) / RUNG)


@compiled
def steps_on_ladder(sides, nodes):  # pragma: no cover (compiled)
    """Return the spacings of nodes in a box around a patch whose sides have a ratio of the
    ladder.

    Parameters
    ----------
    sides : tuple of float
        Sides of the patch along x and y [mm].
    nodes : tuple of int
        Nodes within the box along x and y.
    """
    ratio = math.exp(RUNG * rung_of(sides))
    return max(sides[0], ratio * sides[1]) / nodes[0], max(sides[1], sides[0] / ratio) / nodes[1]


@compiled
def _spread(loads, scale, out):  # pragma: no cover (compiled)
    """Carry the columns of `loads` (points, m) to nodes (nodes, m) by quadratic B-splines.

    `scale` is the spacing of the loads over that of the nodes; both lie evenly around the middle.
    """
    points, nodes = len(loads), len(out)
    out[:] = 0.0
    for k in range(points):
        place = scale * (k - 0.5 * (points - 1)) + 0.5 * (nodes - 1)
        middle = math.floor(place + 0.5)
        for node in range(max(middle - 1, 0), min(middle + 2, nodes)):
            u = abs(place - node)
            weight = 0.75 - u * u if u < 0.5 else 0.5 * max(1.5 - u, 0.0) ** 2
            for i in range(loads.shape[1]):
                out[node, i] += scale * weight * loads[k, i]


@compiled
def loads_on_ladder(tractions, scales, nodes):  # pragma: no cover (compiled)
    """Return loads on the nodes of a ladder.

    Parameters
    ----------
    tractions : numpy.ndarray
        q_x, q_y, p of one patch, (3, ny, nx) [MPa].
    scales : tuple of float
        Spacings of the loads over those of the nodes along x and y [1].
    nodes : tuple of int
        Nodes within the box along x and y; one more lies outside on each side.

    Returns
    -------
    numpy.ndarray
        Loads, (3, nodes along y, nodes along x) [MPa]. The resultants and first moments stay, and
        the second moments grow by a quarter of the squared spacing, which the kernels take back.
    """
    nx = tractions.shape[2]
    wide, long = nodes[0] + 2 * BESIDE, nodes[1] + 2 * BESIDE
    out = np.empty((3, long, wide))
    half, turned = np.empty((long, nx)), np.empty((wide, long))
    for load in range(3):
        _spread(tractions[load], scales[1], half)
        _spread(half.T, scales[0], turned)
        out[load] = turned.T
    return out


@compiled
def _spectra(loads, ladder):  # pragma: no cover (compiled)
    """Return the transforms of loads on a ladder, (3, y, x)."""
    _, ny, nx = loads.shape
    long, wide = ladder.lengths
    field = np.zeros((3, long, wide), np.float32)
    for load in range(3):
        for j in range(ny):
            for i in range(nx):
                field[load, ladder.rows + j, i] = loads[load, j, i]
    out = np.empty((3, long, wide // 2 + 1), np.complex64)
    # input, output, axes, forward, factor, threads
    r2c(field, out, np.array([1, 2]), True, 1.0, 1)
    return out


@compiled
def _plane(spectra, kernels, poisson_ratio, body, ladder):  # pragma: no cover (compiled)
    """Return the stresses of one body on the plane whose kernels are given, (6, y, x) [MPa]."""
    (nx, ny), (long, wide) = ladder.nodes, ladder.lengths
    own = slice(body, body + 1)
    stress = body_spectra(spectra, kernels, poisson_ratio[own], SIGNS[own])[0, 0]
    half = np.empty(stress.shape, np.complex64)
    c2c(stress, half, np.array([1]), False, 1.0, 1)
    # the rows beyond are not wanted, and need no transform along x
    rows = half[:, : ny + 2 * BESIDE + 2 * ladder.rows].copy()
    field = np.empty((6, rows.shape[1], wide), np.float32)
    c2r(rows, field, np.array([2]), False, 1.0 / (long * wide), 1)
    return field[:, :, BESIDE : nx + BESIDE]


@compiled
def planes_of_patch(loads, kernels, poisson_ratio, ladder):  # pragma: no cover (compiled)
    """Return the stresses of both bodies on the planes `DEPTHS` below one patch, (body, depth, 6,
    y, x) [MPa].
    """
    spectra = _spectra(loads, ladder)
    shape = ladder.nodes[1] + 2 * BESIDE + 2 * ladder.rows, ladder.nodes[0]
    out = np.empty((2, len(kernels), 6, *shape), np.float32)
    for depth in range(len(kernels)):
        for body in range(2):
            own = _plane(spectra, kernels[depth : depth + 1], poisson_ratio, body, ladder)
            out[body, depth] = own
    return out


@lru_cache(maxsize=64)
def kernels_of(rung: int, ladder: Ladder) -> np.ndarray:
    """Return the transformed kernels of loads on a ladder at `DEPTHS`, without the spread by
    B-splines and hats.

    They take most of the time of a plane. Patches on the same rung share them.
    """
    (nx, ny), lengths = ladder.nodes, ladder.lengths
    ratio = math.exp(RUNG * rung) * ny / nx
    sides = (min(ratio, 1.0), min(1.0 / ratio, 1.0))
    small = 0.5 * min(sides[0] * nx, sides[1] * ny)
    size = nx + 2 * BESIDE, ny + 2 * BESIDE + ladder.rows
    hats = hat_kernels(sides, size, small * DEPTHS, lengths, np.float32(0.0))
    kernels = fft.rfft2(hats, overwrite_x=True)
    # The transform of B-spline and hat is sinc^5; its inverse up to the sixth power of the wave
    # number.
    for axis, length, shape in zip((3, 4), lengths, ((-1, 1), (-1,)), strict=True):
        wave = 2.0 - 2.0 * np.cos(2.0 * np.pi * np.arange(kernels.shape[axis]) / length)
        inverse = 1.0 + 5.0 / 24.0 * wave + 47.0 / 1152.0 * wave**2
        kernels *= inverse.reshape(shape).astype(np.float32)
    return np.asarray(kernels)


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
        Stresses (body, depth, component, y, x) as of `histories.planes` [MPa].
    """
    _, ny, nx = loads.tractions.shape
    ladder = ladder_of((nx, ny))
    sides = nx * loads.step_x, ny * loads.step_y
    step_x, step_y = steps_on_ladder(sides, ladder.nodes)
    scales = loads.step_x / step_x, loads.step_y / step_y
    own = loads_on_ladder(loads.tractions, scales, ladder.nodes)
    kernels = kernels_of(rung_of(sides), ladder)
    ratio = poisson_ratio.astype(np.float32)
    return np.asarray(planes_of_patch(own, kernels, ratio, ladder))


class LoadedPatches(NamedTuple):
    """Loads of m patches, q_x, q_y, p (m, ny, nx) each [MPa]; spacings (m, 2) [mm]; nu (m, body)
    [1]; bodies that are asked for (m, body).
    """

    lateral: np.ndarray
    rolling: np.ndarray
    pressure: np.ndarray
    steps: np.ndarray
    poisson_ratio: np.ndarray
    wanted: np.ndarray

    @property
    def sides(self) -> np.ndarray:
        """Return the sides of the patches along x and y, (m, 2) [mm]."""
        return self.steps * self.pressure.shape[:0:-1]


@compiled
def _is_wanted(shear, step):  # pragma: no cover (compiled)
    """Return whether the depth at a step of `ORDER` can have the largest shear, or stands beside
    it.

    `shear` (depth,) holds the depths before this step, and 0 elsewhere.
    """
    depth = ORDER[step]
    if step < FIRST or shear[0] >= SHALLOW * np.max(shear):
        return True
    before = depth + 1 if depth < ORDER[0] else depth - 1
    towards_top = before + 1 if depth < ORDER[0] else before - 1
    return shear[before] >= shear[towards_top] and shear[before] > 0.0


@compiled
def _write_shears(
    patches, loads, kernels, ladder, log_depth, all_depths, out
):  # pragma: no cover (compiled)
    """Write the shear stresses of `shakedown_shears` of patches on one rung into `out` (m,
    body).
    """
    _, ny, nx = loads.pressure.shape
    long, wide = ladder.lengths
    spectra = np.empty((len(patches), 3, long, wide // 2 + 1), np.complex64)
    for k, m in enumerate(patches):
        tractions = np.empty((3, ny, nx))
        tractions[0] = loads.lateral[m]
        tractions[1] = loads.rolling[m]
        tractions[2] = loads.pressure[m]
        steps = loads.steps[m, 0], loads.steps[m, 1]
        at = steps_on_ladder((steps[0] * nx, steps[1] * ny), ladder.nodes)
        scales = steps[0] / at[0], steps[1] / at[1]
        spectra[k] = _spectra(loads_on_ladder(tractions, scales, ladder.nodes), ladder)
    shear = np.zeros((len(patches), 2, len(kernels)))
    # the kernels of one depth stay in the cache while all patches use them
    for step, depth in enumerate(ORDER):
        for k, m in enumerate(patches):
            ratio = loads.poisson_ratio[m].astype(np.float32)
            for body in range(2):
                if loads.wanted[m, body] and (all_depths or _is_wanted(shear[k, body], step)):
                    own = kernels[depth : depth + 1]
                    stress = _plane(spectra[k], own, ratio, body, ladder)
                    shear[k, body, depth] = math.sqrt(ball_of_plane(stress))
    for k, m in enumerate(patches):
        for body in range(2):
            if loads.wanted[m, body]:
                out[m, body] = top_of_depths(shear[k, body], log_depth)


def shakedown_shears(loads: LoadedPatches, below_ellipses: bool = False) -> np.ndarray:
    """Return the shear yield stress at which the stresses below patches just shake down.

    Parameters
    ----------
    loads : LoadedPatches
        The patches and the bodies that are asked for.
    below_ellipses : bool
        Whether the patches are ellipses, so that the depths around the largest shear suffice.

    Returns
    -------
    numpy.ndarray
        k, (m, body) [MPa]; NaN where it is not asked for.
    """
    out = np.full(loads.wanted.shape, np.nan)
    _, ny, nx = loads.pressure.shape
    ladder = ladder_of((nx, ny))
    by_rung: dict[int, list[int]] = {}
    sides = loads.sides
    for m in np.flatnonzero(loads.wanted.any(axis=1)).tolist():
        by_rung.setdefault(rung_of((sides[m, 0], sides[m, 1])), []).append(m)
    pieces = [
        (rung, np.array(own[k : k + PIECE]))
        for rung, own in by_rung.items()
        for k in range(0, len(own), PIECE)
    ]
    log_depth = np.log(DEPTHS)
    all_depths = not below_ellipses

    def work(first: int, last: int) -> None:
        for rung, patches in pieces[first:last]:
            kernels = kernels_of(rung, ladder)
            _write_shears(patches, loads, kernels, ladder, log_depth, all_depths, out)

    share_rows(work, len(pieces), 1, 1)
    return out
