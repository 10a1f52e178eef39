"""The normal problem of two elastic half-spaces on a grid: pressure and patch for any gap.

Elements with constant pressure, collocation at their centres: u = A p, with the displacement of a uniformly loaded
rectangle (Love 1929; Johnson 1985, eq. 3.25) and products by FFT. In the patch p > 0 and u + g = delta, outside p = 0
and u + g >= delta. Conjugate gradients with the load as side condition: Polonsky & Keer (1999), Wear 231, 206-219.

The normal displacement by shear tractions, zero for like materials, may be given as part of the gap; see `lift`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from trackroller.contact.influence import displacements, pressure_displacements

TOLERANCE = 1e-7  # of the gap in the patch, over the approach
ITERATIONS = 400


@dataclass(frozen=True)
class NormalSolution:
    """Pressure (ny, nx) per contact modulus [-], approach [mm], iterations and largest residual gap over the approach.

    The residual is the stopping rule: no element of the patch is further from the common surface, and none outside it
    lies deeper.
    """

    pressure: np.ndarray
    approach: float
    iterations: int
    residual: float


@lru_cache(maxsize=64)
def _multiplier(hx: float, hy: float, ny: int, nx: int) -> tuple[np.ndarray, tuple[int, int]]:
    """Spectrum of the displacements for E* = 1, and the padded lengths."""
    from scipy import fft

    kernel = displacements(hx, hy, 0.0, ny, nx, 0, 0)[0]  # 1/pi int 1/r
    lengths = (fft.next_fast_len(2 * ny - 1), fft.next_fast_len(2 * nx - 1, real=True))
    wrapped = np.zeros(lengths)
    rows, columns = np.arange(-(ny - 1), ny), np.arange(-(nx - 1), nx)
    wrapped[np.ix_(rows, columns)] = kernel
    return fft.rfft2(wrapped), lengths


class _Surface:
    """Products with the influence functions of one grid; lengths over the element's, so that grids share spectra."""

    def __init__(self, hx: float, hy: float, ny: int, nx: int) -> None:
        self.shape = ny, nx
        self.unit = hx
        # a ratio of few digits would be shared more often, but the product must be that of this grid
        self.spectrum, self.lengths = _multiplier(1.0, hy / hx, ny, nx)

    def displacement(self, pressure: np.ndarray) -> np.ndarray:
        """u (ny, nx) [mm] of pressures over the contact modulus."""
        from scipy import fft

        field = fft.irfft2(fft.rfft2(pressure, self.lengths) * self.spectrum, self.lengths)
        return self.unit * field[: self.shape[0], : self.shape[1]]


def displacement(pressure: np.ndarray, hx: float, hy: float) -> np.ndarray:
    """Normal displacement [mm] at the element centres of pressures over the contact modulus, both (ny, nx)."""
    return _Surface(hx, hy, *pressure.shape).displacement(pressure)


def lift(shear_lateral: np.ndarray, shear_rolling: np.ndarray, hx: float, hy: float, per_stress: float) -> np.ndarray:
    """How far shear tractions (ny, nx) [MPa] on the roller move unlike surfaces apart (ny, nx) [mm].

    w = K/(pi G) int (x - x').tau/|x - x'|^2, the counterpart of the creep by pressures (Kalker 1990, section 1.5);
    per_stress = K/G [1/MPa], hx, hy element sides [mm].
    """
    from scipy.signal import fftconvolve

    ny, nx = shear_lateral.shape
    along_x, along_y = pressure_displacements(hx, hy, ny, nx, 0, 0)
    whole = fftconvolve(shear_lateral, along_x) + fftconvolve(shear_rolling, along_y)
    return -per_stress * whole[ny - 1 : 2 * ny - 1, nx - 1 : 2 * nx - 1]


def solve_normal(
    gap: np.ndarray,
    hx: float,
    hy: float,
    load: float,
    material: np.ndarray | None = None,
    start: np.ndarray | None = None,
    tolerance: float = TOLERANCE,
) -> NormalSolution:
    """Pressure, patch and approach under a load.

    Parameters
    ----------
    gap : of the undeformed bodies at the element centres, (ny, nx) [mm]
    hx, hy : element sides [mm]
    load : normal force over the contact modulus E* [mm^2], > 0
    material : where both bodies have material, (ny, nx); everywhere if not given
    start : pressures to start from, (ny, nx)
    tolerance : stopping rule, see `NormalSolution`

    The sum of the pressures is the load to rounding. Error against Hertz with 40 elements across: 0.1 % in the largest
    pressure, 0.2 % in the approach, falling with the element size to the power 1.5 to 2 (tests/test_normal.py).
    """
    ny, nx = gap.shape
    allowed = np.ones(gap.shape, bool) if material is None else material
    surface, area = _Surface(hx, hy, ny, nx), hx * hy
    if start is None:
        reach = np.where(allowed, gap, np.inf)
        depth = np.quantile(reach[allowed], 0.5) - reach
        start = np.sqrt(np.maximum(depth, 0.0))
    p = np.where(allowed, np.maximum(start, 0.0), 0.0)
    if not p.any():
        p = allowed.astype(float)
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
        outside = allowed & ~inside
        deepest = -float(deviation[outside].min()) if outside.any() else 0.0
        residual = max(float(np.abs(deviation[inside]).max()), deepest) / depth_scale
        if residual <= tolerance or step > ITERATIONS:
            break
        size = float(np.sum(deviation[inside] ** 2))
        if conjugate:
            direction = np.where(inside, deviation + (size / size_old) * direction, 0.0)
        else:
            direction = np.where(inside, deviation, 0.0)
        size_old = size
        answer = surface.displacement(direction)
        answer -= answer[inside].mean()
        length = float(np.sum(deviation[inside] * direction[inside]) / np.sum(answer[inside] * direction[inside]))
        p = np.where(inside, np.maximum(p - length * direction, 0.0), 0.0)
        again = allowed & (p == 0.0) & (deviation < 0.0)
        conjugate = not again.any()
        p[again] -= length * deviation[again]
        p *= load / (p.sum() * area)
    return NormalSolution(p, approach, step, residual)
