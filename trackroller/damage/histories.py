"""Stresses of the planes below a patch, which a point of a body passes while it is overrolled.

A point moves through the stress field along y at fixed x and z, so a line of a plane along y is its stress history.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

PADDING = 0.25  # nodes beyond the patch along y over those of the patch, on each side
# over the smaller semi-axis; the stresses that decide lie at 0.3 to 0.8, or under high friction at the surface
DEPTHS = np.array([0.0, 0.05, 0.1, 0.2, 0.3, 0.38, 0.45, 0.52, 0.6, 0.7, 0.85, 1.05, 1.3])

# Parities of the stresses of loads q_x, q_y, p along x and y, in the order of `halfspace.stress.COMPONENTS`.
_ODD_X = np.array([[-1, -1, -1, 1, -1, 1], [1, 1, 1, -1, 1, -1], [1, 1, 1, -1, 1, -1]])[:, :, None, None]
_ODD_Y = np.array([[1, 1, 1, -1, -1, 1], [-1, -1, -1, 1, 1, -1], [1, 1, 1, -1, -1, 1]])[:, :, None, None]


@dataclass(frozen=True)
class Tractions:
    """Tractions on the roller over the patches of n cases, and the slip; NaN where a patch does not exist.

    Parameters
    ----------
    x, y : numpy.ndarray
        Coordinates of the grids, (n, contact, nx) and (n, contact, ny) [mm].
    pressure, shear_lateral, shear_rolling : numpy.ndarray
        Tractions, (n, contact, ny, nx) [MPa].
    slip_lateral, slip_rolling : numpy.ndarray
        Slip velocity over travel speed, (n, contact, ny, nx) [1]; NaN in full slip.
    mirrored : numpy.ndarray of bool
        Cases whose contact 2 is the mirror image of contact 1, (n,).
    """

    x: np.ndarray
    y: np.ndarray
    pressure: np.ndarray
    shear_lateral: np.ndarray
    shear_rolling: np.ndarray
    slip_lateral: np.ndarray
    slip_rolling: np.ndarray
    mirrored: np.ndarray

    def patches(self) -> Iterator[tuple[int, int]]:
        """Yield case and contact of each patch that exists and is not the mirror image of another one."""
        there = np.isfinite(self.x[:, :, 0])
        there[:, 1] &= ~self.mirrored
        yield from map(tuple, np.argwhere(there))

    def spread(self, values: np.ndarray) -> np.ndarray:
        """Return values (n, contact, ...) with those of contact 1 copied to mirror images."""
        values[self.mirrored, 1] = values[self.mirrored, 0]
        return values


def _grown(quarter: np.ndarray) -> np.ndarray:
    """Return kernels at all offsets from those at offsets >= 0, (load, component, y, x), by their parities."""
    left = np.concatenate([(_ODD_X * quarter)[..., :0:-1], quarter], axis=-1)
    return np.concatenate([(_ODD_Y * left)[..., :0:-1, :], left], axis=-2)


@lru_cache(maxsize=4)
def _spectra(sides: tuple[float, float], nodes: tuple[int, int], poisson_ratio: float) -> np.ndarray:
    """Return the Fourier transforms of the stresses of hat loads on the planes `DEPTHS`.

    Patches of equal shape share them: they depend on ratios of lengths alone.

    Parameters
    ----------
    sides : tuple of float
        Grid spacings along x and y over the larger of the two [1].
    nodes : tuple of int
        Loaded nodes along x and y.
    poisson_ratio : float
        nu [1].

    Returns
    -------
    numpy.ndarray
        (depth, load, component, y, x), complex in single precision.
    """
    from scipy import fft  # heavy, as is the compiled room below: planning reads only the declarations of the limits

    from trackroller.halfspace import influence

    (gx, gy), (nx, ny) = sides, nodes
    size = nx, ny + int(PADDING * ny)
    small = 0.5 * min(nx * gx, ny * gy)
    at_x, at_y = (side * np.arange(-1, n + 1) for side, n in zip(sides, size, strict=True))
    out = []
    for depth in DEPTHS * small:
        table = influence.corner_table(at_x, at_y, depth, poisson_ratio).reshape(3, 6, at_y.size, at_x.size)
        kernels = _grown(np.diff(np.diff(table, n=2, axis=2), n=2, axis=3) / (gx * gy))
        # single precision: its rounding lies 1000 times below the error of the planes, and it takes half the time
        out.append(fft.rfft2(kernels.astype(np.float32), _lengths(nodes)))
    return np.array(out)


def _lengths(nodes: tuple[int, int]) -> tuple[int, int]:
    """Return lengths along y and x for a convolution whose wrapped ends are cut off."""
    from scipy import fft  # heavy, see _spectra

    nx, ny = nodes
    return fft.next_fast_len(2 * (ny + int(PADDING * ny)) - 1, real=True), fft.next_fast_len(2 * nx - 1, real=True)


def planes(tractions: Tractions, case: int, contact: int, poisson_ratio: np.ndarray) -> np.ndarray:
    """Return the stresses of both bodies on the planes `DEPTHS` below one patch.

    Parameters
    ----------
    tractions : Tractions
        The tractions, bilinear between the nodes.
    case, contact : int
        Place of the patch.
    poisson_ratio : numpy.ndarray
        nu of roller and guide, (2,) [1].

    Returns
    -------
    numpy.ndarray
        Stresses (body, depth, component, y, x) in the order of `halfspace.stress.COMPONENTS` [MPa]. Along y the planes
        have `PADDING` times the nodes of the patch more on each side.

    Notes
    -----
    The stresses are those of `halfspace.stress.stress_on_grid`. Patches of equal shape share the kernels, bodies of
    equal nu the stresses of pressure and shear.
    """
    from scipy import fft  # heavy, as is the compiled room below, see _spectra

    from trackroller.halfspace.stress import FRICTION_SIGNS

    t, at = tractions, (case, contact)
    nodes = t.x.shape[-1], t.y.shape[-1]
    steps = [(axis[-1] - axis[0]) / (axis.size - 1) for axis in (t.x[at], t.y[at])]
    sides = tuple(float(round(step / max(steps), 12)) for step in steps)
    lengths, more = _lengths(nodes), int(PADDING * nodes[1])
    fields = np.stack([t.shear_lateral[at], t.shear_rolling[at], t.pressure[at]])
    loads = fft.rfft2(fields.astype(np.float32), lengths)
    rows, columns = slice(nodes[1] - 1, 2 * (nodes[1] + more) - 1), slice(nodes[0] - 1, 2 * nodes[0] - 1)
    bodies: list[np.ndarray] = []
    known: dict[float, tuple[np.ndarray, ...]] = {}
    for sign, nu in zip(FRICTION_SIGNS, map(float, poisson_ratio), strict=True):
        if nu not in known:
            spectra = _spectra((sides[0], sides[1]), nodes, nu)
            sheared = np.einsum("lyx,dlcyx->dcyx", loads[:2], spectra[:, :2])
            pressed = loads[2] * spectra[:, 2]
            known[nu] = tuple(fft.irfft2(part, lengths)[..., rows, columns] for part in (sheared, pressed))
        bodies.append(known[nu][1] + sign * known[nu][0])
    return np.stack(bodies).astype(float)
