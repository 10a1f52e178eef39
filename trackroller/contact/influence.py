"""Influence functions of steady rolling on the elastic half-space, and their fast products.

The displacement differences of rectangular elements with constant traction are closed forms of Cerruti's and
Boussinesq's solutions (Kalker 1990, Three-Dimensional Elastic Bodies in Rolling Contact, chapter 3). The slip needs
their derivative in the rolling direction, which is y here and x in Kalker and CONTACT.

Lengths are scaled by c = sqrt(a b), tractions by the largest traction bound, slips by this bound over G.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numba import njit
from rocket_fft import c2c
from scipy.fft import next_fast_len

FAST = {"contract", "reassoc", "arcp", "nsz"}

# The derivative of the displacements in the rolling direction is a difference of second order towards the leading edge,
# where the material enters. A central difference would leave the shortest waves undetermined in the adhesion area; a
# difference of first order changes the slip by half an element times the spin.
# Beyond the leading edge the displacement has a kink of power 3/2. The first element of a column therefore takes this
# share of the central difference. ASSUME: the share at which the first-order error of Carter's problem vanishes.
LEADING_SHARE = 0.45
HALO = 3  # rows of displacements beside those of the elements: one behind, two ahead
DIGITS = 13  # digits of element sizes and Poisson's ratio; patches that differ by rounding share influence functions


@njit(cache=True, fastmath=FAST, nogil=True)
def _log_part(x, y):
    """Return x asinh(y / |x|), 0 at x = 0."""
    return 0.0 if x == 0.0 else x * math.asinh(y / abs(x))


@njit(cache=True, nogil=True)
def displacements(hx, hy, poisson, ny, nx, below, above):
    """Return the displacement differences at distances (j hy, i hx) of a unit traction on an element, for G = 1.

    Kalker (1990) chapter 3: u_x = 1/(pi G) int [(1-nu)/r + nu x^2/r^3] tau_x + nu x y/r^3 tau_y.

    Parameters
    ----------
    hx, hy : float
        Element sides.
    poisson : float
        Combined Poisson's ratio [1].
    ny, nx : int
        Numbers of elements.
    below, above : int
        Additional rows at both ends.

    Returns
    -------
    numpy.ndarray, shape (3, 2 ny - 1 + below + above, 2 nx - 1)
        Components xx, yy, xy for j from -(ny-1)-below to ny-1+above and i from -(nx-1) to nx-1.
    """
    rows, columns = 2 * ny - 1 + below + above, 2 * nx - 1
    corner = np.empty((3, rows + 1, columns + 1))
    for j in range(rows + 1):
        y = (j - (ny - 1) - below - 0.5) * hy
        for i in range(columns + 1):
            x = (i - (nx - 1) - 0.5) * hx
            along_y, along_x = _log_part(x, y), _log_part(y, x)  # int int y^2/r^3, int int x^2/r^3
            corner[0, j, i] = along_y * (1.0 - poisson) + along_x
            corner[1, j, i] = along_x * (1.0 - poisson) + along_y
            corner[2, j, i] = -poisson * math.sqrt(x * x + y * y)
    return _over_element(corner, 1.0 / math.pi)


@njit(cache=True, nogil=True)
def _over_element(corner, factor):
    """Turn corner values (m, rows + 1, columns + 1) of a double antiderivative into integrals over elements."""
    out = np.empty((corner.shape[0], corner.shape[1] - 1, corner.shape[2] - 1))
    for c in range(out.shape[0]):
        for j in range(out.shape[1]):
            for i in range(out.shape[2]):
                ahead = corner[c, j + 1, i + 1] - corner[c, j + 1, i]
                out[c, j, i] = factor * (ahead - corner[c, j, i + 1] + corner[c, j, i])
    return out


@njit(cache=True, nogil=True)
def pressure_displacements(hx, hy, ny, nx, below, above):
    """Return the tangential displacement differences x, y of a unit pressure on an element for G = K = 1, (2, ., .).

    u = -K/(pi G) int p r/|r|^2: the surfaces of both bodies move towards the load (Kalker 1990, section 1.5).
    Parameters as in `displacements`.
    """
    rows, columns = 2 * ny - 1 + below + above, 2 * nx - 1
    corner = np.empty((2, rows + 1, columns + 1))
    for j in range(rows + 1):
        y = (j - (ny - 1) - below - 0.5) * hy
        for i in range(columns + 1):
            x = (i - (nx - 1) - 0.5) * hx
            log = 0.5 * math.log(x * x + y * y)
            corner[0, j, i] = y * log + x * math.atan(y / x)
            corner[1, j, i] = x * log + y * math.atan(x / y)
    return _over_element(corner, -1.0 / math.pi)


@njit(cache=True, nogil=True)
def _multipliers(kernel, ny, nx, ly, lx):
    """Return the spectrum (ly, lx) of a complex influence function (2 ny - 1 + HALO, 2 nx - 1) of the distances."""
    field = np.zeros((ly, lx), np.complex128)
    for j in range(2 * ny - 1 + HALO):
        for i in range(2 * nx - 1):
            field[(j - ny + 1) % ly, (i - nx + 1) % lx] = kernel[j, i]
    c2c(field, field, np.array([0, 1]), True, 1.0, 1)
    return field


@njit(cache=True, fastmath=FAST, nogil=True)
def _combined(p, q, z, out):
    """Write P Z + Q conj(Z(-k)) into `out`."""
    ly, lx = z.shape
    for i in range(ly):
        mirror = ly - i if i > 0 else 0
        out[i, 0] = p[i, 0] * z[i, 0] + q[i, 0] * z[mirror, 0].conjugate()
        for j in range(1, lx):
            out[i, j] = p[i, j] * z[i, j] + q[i, j] * z[mirror, lx - j].conjugate()


@njit(cache=True, nogil=True)
def convolve(field, p, q, work):
    """Write the displacements of tractions `field` (ny, nx) into the first ny + HALO rows and nx columns of work[1].

    `p` and `q` are the spectra of `Influence`; `work` (2, ly, lx) also serves the transforms.
    """
    ny = field.shape[0]
    ly, lx = p.shape
    c2c(field, work[0, :ny], np.array([1]), True, 1.0, 1)
    c2c(work[0, :ny], work[1], np.array([0]), True, 1.0, 1)
    _combined(p, q, work[1], work[0])
    c2c(work[0], work[1], np.array([0]), False, 1.0 / ly, 1)
    c2c(work[1, : ny + HALO], work[1, : ny + HALO], np.array([1]), False, 1.0 / lx, 1)


@dataclass(frozen=True)
class Influence:
    """Influence functions of ny x nx elements for products by fast Fourier transforms; a field is x + iy.

    Attributes
    ----------
    hy : float
        Element size in the rolling direction.
    p, q : numpy.ndarray, shape (ly, lx)
        Spectra in W = P Z + Q conj(Z(-k)) of displacements W and tractions Z.
    own : float
        Mean slip that an element's unit traction causes at itself.
    column : numpy.ndarray, shape (2, 2 ny - 1 + HALO)
        Displacements xx and yy that an element's unit traction causes in its own column.
    """

    hy: float
    p: np.ndarray
    q: np.ndarray
    own: float
    column: np.ndarray

    @property
    def own_displacement(self) -> float:
        """Return the mean displacement that an element's unit traction causes at itself."""
        return float(self.column[:, (self.column.shape[1] - HALO + 1) // 2].mean())

    def displacements(self, field: np.ndarray) -> np.ndarray:
        """Return the displacements (ny + HALO, nx), one row behind to two rows ahead, of tractions `field` (ny, nx)."""
        ny, nx = field.shape
        work = np.empty((2, *self.p.shape), complex)
        convolve(field, self.p, self.q, work)
        return work[1, : ny + HALO, :nx]


@lru_cache(maxsize=64)
def _influence(hx: float, hy: float, poisson: float, ny: int, nx: int) -> Influence:
    ly, lx = next_fast_len(2 * ny - 1 + HALO), next_fast_len(2 * nx - 1)
    u = displacements(hx, hy, poisson, ny, nx, 1, 2)
    p = 0.5 * (u[0] + u[1]) + 0j
    own = (1.5 * p[ny, nx - 1] - 2.0 * p[ny + 1, nx - 1] + 0.5 * p[ny + 2, nx - 1]).real / hy
    q = 0.5 * (u[0] - u[1]) + 1j * u[2]
    spectrum_p, spectrum_q = (_multipliers(kernel, ny, nx, ly, lx) for kernel in (p, q))
    return Influence(hy, spectrum_p, spectrum_q, float(own), np.ascontiguousarray(u[:2, :, nx - 1]))


def influence(hx: float, hy: float, poisson: float, ny: int, nx: int) -> Influence:
    """Return the influence functions of ny x nx elements of size hy x hx for G = 1; the last ones used are kept."""
    return _influence(*(float(f"{v:.{DIGITS}g}") for v in (hx, hy, poisson)), ny, nx)


def coupling_slip(pressure: np.ndarray, hx: float, hy: float) -> np.ndarray:
    """Return the slip -du/dy (ny, nx), x + iy, of a pressure field (ny, nx) for K = G = 1, by central differences."""
    ny, nx = pressure.shape
    ly, lx = next_fast_len(2 * ny - 1 + HALO), next_fast_len(2 * nx - 1)
    u = pressure_displacements(hx, hy, ny, nx, 1, 2)
    p = _multipliers(u[0] + 1j * u[1], ny, nx, ly, lx)
    halo = Influence(hy, p, np.zeros_like(p), 1.0, np.zeros((2, 1))).displacements(pressure.astype(complex))
    return 0.5 * (halo[:ny] - halo[2 : ny + 2]) / hy


@njit(cache=True, nogil=True)
def leading_rows(bound):
    """Return the row of the leading element (largest y with a traction bound > 0) of each column, -1 if none."""
    ny, nx = bound.shape
    rows = np.empty(nx, np.int64)
    for j in range(nx):
        rows[j] = -1
    for i in range(ny):
        for j in range(nx):
            if bound[i, j] > 0.0:
                rows[j] = i
    return rows


@njit(cache=True, fastmath=FAST, nogil=True)
def differences(halo, leading, hy, result):
    """Write the slip -du/dy into `result` (ny, nx) from displacements `halo` (ny + HALO, nx).

    The difference is upwind and of second order; the `leading` element of each column takes a share of the central
    difference.
    """
    ny, nx = result.shape
    for i in range(ny):
        for j in range(nx):
            result[i, j] = (1.5 * halo[i + 1, j] - 2.0 * halo[i + 2, j] + 0.5 * halo[i + 3, j]) / hy
    for j in range(nx):
        i = leading[j]
        if i >= 0:
            central = 0.5 * (halo[i, j] - halo[i + 2, j]) / hy
            result[i, j] += LEADING_SHARE * (central - result[i, j])
