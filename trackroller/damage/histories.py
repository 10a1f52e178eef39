"""Stresses of the planes below a patch, which a point of a body passes while it is overrolled.

A point moves through the stress field along y at fixed x and z, so a line of a plane along y is its stress history.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy import fft

from trackroller.halfspace import influence
from trackroller.halfspace.stress import FRICTION_SIGNS

PADDING = 0.5  # nodes beyond the patch along y over those of the patch, on each side
# over the smaller semi-axis; the stresses that decide lie at 0.3 to 0.8, or under high friction at the surface
DEPTHS = np.array([0.0, 0.05, 0.1, 0.2, 0.3, 0.38, 0.45, 0.52, 0.6, 0.7, 0.85, 1.05, 1.3])


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


def _padded(axis: np.ndarray, field: np.ndarray, more: int) -> tuple[np.ndarray, np.ndarray]:
    """Return an axis of y with `more` nodes on both sides, and the tractions (3, ny, nx) with zeros there."""
    step = (axis[-1] - axis[0]) / (axis.size - 1)
    longer = axis[0] + step * np.arange(-more, axis.size + more)
    return longer, np.pad(field, [(0, 0), (more, more), (0, 0)])


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
        Stresses (body, depth, y, x, component) in the order of `halfspace.stress.COMPONENTS` [MPa].

    Notes
    -----
    As `halfspace.stress.stress_on_grid`, but pressure and shear share the kernels, and bodies of equal nu, too.
    """
    t, at = tractions, (case, contact)
    x, y = t.x[at], t.y[at]
    field = np.stack([t.shear_lateral[at], t.shear_rolling[at], t.pressure[at]])
    y, field = _padded(y, field, int(PADDING * y.size))
    shape = (fft.next_fast_len(3 * y.size - 2, real=True), fft.next_fast_len(3 * x.size - 2, real=True))
    loads = fft.rfft2(field, shape)
    steps = (x[-1] - x[0]) / (x.size - 1), (y[-1] - y[0]) / (y.size - 1)
    small = min(0.5 * (x.size * steps[0]), 0.5 * (t.y.shape[-1] * steps[1]))
    out = np.empty((2, DEPTHS.size, y.size, x.size, 6))
    known: dict[float, tuple[np.ndarray, ...]] = {}
    for i, depth in enumerate(DEPTHS * small):
        known.clear()
        for body, sign in enumerate(FRICTION_SIGNS):
            nu = float(poisson_ratio[body])
            if nu not in known:
                kernels = influence.hat_influence(*steps, x.size, y.size, float(depth), nu)
                spectra = [load * fft.rfft2(kernel, shape) for load, kernel in zip(loads, kernels, strict=True)]
                sides = (slice(None), slice(y.size - 1, 2 * y.size - 1), slice(x.size - 1, 2 * x.size - 1))
                both = (spectra[0] + spectra[1], spectra[2])
                known[nu] = tuple(fft.irfft2(part, shape)[sides] for part in both)
            sheared, pressed = known[nu]
            out[body, i] = np.moveaxis(pressed + sign * sheared, 0, -1)
    return out
