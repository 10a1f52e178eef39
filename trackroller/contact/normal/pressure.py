"""The normal problem of two elastic half-spaces on a grid: pressure and patch for any gap.

The pressure is constant in each element, and the gap is evaluated at the element centres: u = A p,
with the displacement of a uniformly loaded rectangle (Love 1929; Johnson 1985, eq. 3.25) and
products by FFT. In the patch p > 0 and u + g = delta; outside p = 0 and u + g >= delta. The
conjugate-gradient method keeps the load as a side condition (Polonsky & Keer 1999, Wear 231,
206-219).

Shear tractions displace the surfaces along the normal on unlike materials; `lift` gives this
displacement, which is added to the gap.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy import fft

from trackroller.contact.influence import displacements, pressure_displacements
from trackroller.contact.rollers import CONVERGED_PRESSURE

# the iteration ends when the largest gap in the patch, divided by the approach, is below
TOLERANCE = CONVERGED_PRESSURE
ITERATIONS = 400
MARGIN = 1e-6  # of the gap from which the iteration starts, over the range of the gap


@dataclass(frozen=True)
class NormalSolution:
    """Solution of the normal problem.

    Attributes
    ----------
    pressure : numpy.ndarray, shape (ny, nx)
        Pressure over the contact modulus [1].
    approach : float
        Approach of the bodies [mm].
    iterations : int
        Number of iterations.
    residual : float
        Largest remaining gap of an element of the patch, or largest overlap of an element outside
        it, over the approach [1].
    """

    pressure: np.ndarray
    approach: float
    iterations: int
    residual: float


@lru_cache(maxsize=64)
def _multiplier(hx: float, hy: float, ny: int, nx: int) -> tuple[np.ndarray, tuple[int, int]]:
    """Return the spectrum of the displacements for E* = 1, and the padded lengths."""
    kernel = displacements(hx, hy, 0.0, ny, nx, 0, 0)[0]  # 1/pi int 1/r
    lengths = (fft.next_fast_len(2 * ny - 1), fft.next_fast_len(2 * nx - 1, real=True))
    wrapped = np.zeros(lengths)
    rows, columns = np.arange(-(ny - 1), ny), np.arange(-(nx - 1), nx)
    wrapped[np.ix_(rows, columns)] = kernel
    return fft.rfft2(wrapped), lengths


class _Surface:
    """Products with the influence functions of one grid; lengths over the element width let grids
    share spectra.
    """

    def __init__(self, hx: float, hy: float, ny: int, nx: int) -> None:
        self.shape = ny, nx
        self.unit = hx
        # a rounded ratio would be shared more often, but the product would not be that of this grid
        self.spectrum, self.lengths = _multiplier(1.0, hy / hx, ny, nx)

    def displacement(self, pressure: np.ndarray) -> np.ndarray:
        """Return the displacement u (ny, nx) [mm] under pressures over the contact modulus (ny, nx)
        [1].
        """
        field = fft.irfft2(fft.rfft2(pressure, self.lengths) * self.spectrum, self.lengths)
        return self.unit * field[: self.shape[0], : self.shape[1]]


def displacement(pressure: np.ndarray, hx: float, hy: float) -> np.ndarray:
    """Return the normal displacement (ny, nx) [mm] under pressures over the contact modulus (ny,
    nx) [1].

    hx, hy are the element sides [mm].
    """
    return _Surface(hx, hy, *pressure.shape).displacement(pressure)


def lift(
    shear_lateral: np.ndarray, shear_rolling: np.ndarray, hx: float, hy: float, per_stress: float
) -> np.ndarray:
    """Return the distance by which shear on the roller moves unlike surfaces apart, (ny, nx) [mm].

    w = K/(pi G) int (x - x').tau/|x - x'|^2, the counterpart of the creep by pressures (Kalker
    1990, section 1.5).

    Parameters
    ----------
    shear_lateral, shear_rolling : numpy.ndarray, shape (ny, nx)
        Shear tractions on the roller [MPa].
    hx, hy : float
        Element sides [mm].
    per_stress : float
        K/G [1/MPa].
    """
    ny, nx = shear_lateral.shape
    along_x, along_y = pressure_displacements(hx, hy, ny, nx, 0, 0)
    lengths = fft.next_fast_len(3 * ny - 2, real=True), fft.next_fast_len(3 * nx - 2, real=True)
    pairs = (shear_lateral, along_x), (shear_rolling, along_y)
    whole = fft.irfft2(
        sum(fft.rfft2(load, lengths) * fft.rfft2(move, lengths) for load, move in pairs), lengths
    )
    return -per_stress * whole[ny - 1 : 2 * ny - 1, nx - 1 : 2 * nx - 1]


def solve_normal(
    gap: np.ndarray,
    hx: float,
    hy: float,
    load: float,
    start: np.ndarray | None = None,
) -> NormalSolution:
    """Solve for pressure, patch and approach under a load.

    Parameters
    ----------
    gap : numpy.ndarray, shape (ny, nx)
        Gap of the undeformed bodies at the element centres [mm].
    hx : float
        Side of an element in the lateral direction [mm].
    hy : float
        Side of an element in the rolling direction [mm].
    load : float
        Normal force over the contact modulus E*, > 0 [mm^2].
    start : numpy.ndarray, shape (ny, nx), optional
        Pressures over the contact modulus from which the iteration starts [1].

    Returns
    -------
    NormalSolution
        Pressure, approach, number of iterations and residual.

    Notes
    -----
    The sum of the pressures equals the load to rounding. The error against Hertz falls with the
    element size to the power 1.5 to 2.

    References
    ----------
    Polonsky, I. A. & Keer, L. M. (1999). A numerical method for solving rough contact problems.
    Wear 231, 206-219.
    """
    ny, nx = gap.shape
    surface, area = _Surface(hx, hy, ny, nx), hx * hy
    if start is None:
        # on a flat many elements have the median of the gap: a margin takes all of them, whatever
        # their last digits are
        start = np.sqrt(np.maximum(np.quantile(gap, 0.5) + MARGIN * np.ptp(gap) - gap, 0.0))
    p = np.maximum(start, 0.0)
    if not p.any():
        p = np.ones(gap.shape)
    p *= load / (p.sum() * area)
    residual, approach, step = np.inf, 0.0, 0
    direction, size_old, conjugate = np.zeros_like(p), 1.0, False
    while True:
        step += 1
        total = surface.displacement(p) + gap
        inside = p > 0.0
        approach = float(total[inside].mean())
        deviation = total - approach
        depth_scale = max(abs(approach - float(gap[inside].min())), 1e-300)
        deepest = -float(deviation[~inside].min(initial=0.0))
        residual = max(float(np.abs(deviation[inside]).max()), deepest) / depth_scale
        if residual <= TOLERANCE or step > ITERATIONS:
            break
        size = float(np.sum(deviation[inside] ** 2))
        if conjugate:
            direction = np.where(inside, deviation + (size / size_old) * direction, 0.0)
        else:
            direction = np.where(inside, deviation, 0.0)
        size_old = size
        answer = surface.displacement(direction)
        answer -= answer[inside].mean()
        length = float(
            np.sum(deviation[inside] * direction[inside])
            / np.sum(answer[inside] * direction[inside])
        )
        p = np.where(inside, np.maximum(p - length * direction, 0.0), 0.0)
        again = (p == 0.0) & (deviation < 0.0)
        conjugate = not again.any()
        p[again] -= length * deviation[again]
        p *= load / (p.sum() * area)
    return NormalSolution(p, approach, step, residual)
