"""Influence functions of steady rolling on the elastic half-space, and their fast products.

Displacement differences of rectangular elements with constant traction: closed forms of Cerruti's and
Boussinesq's solutions (Kalker 1990, Three-Dimensional Elastic Bodies in Rolling Contact, chapter 3); the slip
needs their derivative in the rolling direction.

Lengths are scaled by c = sqrt(a b), tractions by the largest traction bound, slips by that over G.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from trackroller.contact.kalker_fft import FAST, backward, forward, good_length, workspace

# The derivative of the displacements in the rolling direction is a difference of second order towards the leading
# edge, where the material comes from. A central one would leave the shortest waves undetermined in the stick
# area; one of first order turns the slip by half an element of spin.
# Beyond the leading edge the displacement has a kink of power 3/2, so the first element of a column leans on the
# central difference by this share. ASSUME: the share at which Carter's problem loses its first-order error.
LEADING_SHARE = 0.45
HALO = 3  # rows of displacements beside those of the elements: one behind, two ahead


@njit(cache=True, fastmath=FAST)
def _log_part(x, y):
    """x asinh(y / |x|), 0 at x = 0."""
    return 0.0 if x == 0.0 else x * math.asinh(y / abs(x))


@njit(cache=True)
def displacements(hx, hy, poisson, ny, nx, below, above):
    """Displacement differences at distances (j hy, i hx) of a unit traction on an element hx x hy, G = 1.

    Kalker (1990) chapter 3: u_x = 1/(pi G) int [(1-nu)/r + nu x^2/r^3] tau_x + nu x y/r^3 tau_y.
    Returns (3, ny + below + above + ..., ...): xx, yy, xy for j = -(ny-1)-below .. ny-1+above and
    i = -(nx-1) .. nx-1.
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


@njit(cache=True)
def _over_element(corner, factor):
    """Corner values (m, rows + 1, columns + 1) of a double antiderivative to integrals over elements."""
    out = np.empty((corner.shape[0], corner.shape[1] - 1, corner.shape[2] - 1))
    for c in range(out.shape[0]):
        for j in range(out.shape[1]):
            for i in range(out.shape[2]):
                ahead = corner[c, j + 1, i + 1] - corner[c, j + 1, i]
                out[c, j, i] = factor * (ahead - corner[c, j, i + 1] + corner[c, j, i])
    return out


@njit(cache=True)
def pressure_displacements(hx, hy, ny, nx, below, above):
    """Tangential displacement differences of a unit pressure on an element for G = 1, K = 1: x, y, shape (2, ., .).

    u = -K/(pi G) int p r/|r|^2: both bodies' surfaces move towards the load (Kalker 1990, section 1.5).
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


@njit(cache=True)
def spectra(kernel, ny, nx, ly, lx):
    """Multipliers (4, lx * ly: Re P, Im P, Re Q, Im Q) for W = P Z + Q conj(Z(-k)), Z the spectrum of x + iy.

    `kernel` (4, 2 ny - 1 + HALO, 2 nx - 1) holds P and Q over the distances; the scale 1/(lx ly) is included.
    """
    fields = np.zeros((2, ly, lx))
    result = np.zeros((4, lx * ly))
    work = workspace(ly, lx)
    scale = 1.0 / (lx * ly)
    for part in (0, 2):
        for j in range(2 * ny - 1 + HALO):
            for i in range(2 * nx - 1):
                row, column = (j - ny + 1) % ly, (i - nx + 1) % lx
                fields[0, row, column] = kernel[part, j, i] * scale
                fields[1, row, column] = kernel[part + 1, j, i] * scale
        here = forward(fields, ly, lx, work)
        for k in range(lx * ly):
            result[part, k] = work[here, k]
            result[part + 1, k] = work[here + 1, k]
    return result


@njit(cache=True)
def padded_lengths(ny, nx):
    """Lengths of the transforms along y and x that keep products free of wrap-around."""
    return good_length(2 * ny - 1 + HALO), good_length(2 * nx - 1)


@njit(cache=True)
def prepare(hx, hy, poisson, ny, nx):
    """Spectral multipliers of the tractions and the mean slip that an element's unit traction causes at itself."""
    ly, lx = padded_lengths(ny, nx)
    u = displacements(hx, hy, poisson, ny, nx, 1, 2)
    kernel = np.zeros((4, u.shape[1], u.shape[2]))
    for j in range(u.shape[1]):
        for i in range(u.shape[2]):
            kernel[0, j, i] = 0.5 * (u[0, j, i] + u[1, j, i])
            kernel[2, j, i] = 0.5 * (u[0, j, i] - u[1, j, i])
            kernel[3, j, i] = u[2, j, i]
    own = (1.5 * kernel[0, ny, nx - 1] - 2.0 * kernel[0, ny + 1, nx - 1] + 0.5 * kernel[0, ny + 2, nx - 1]) / hy
    return spectra(kernel, ny, nx, ly, lx), own


@njit(cache=True)
def coupling_slip(pressure, hx, hy):
    """Slip -du/dy (2, ny, nx) of a pressure field (ny, nx) for K = G = 1, by central differences."""
    ny, nx = pressure.shape
    ly, lx = padded_lengths(ny, nx)
    u = pressure_displacements(hx, hy, ny, nx, 1, 2)
    kernel, field = np.zeros((4, u.shape[1], u.shape[2])), np.zeros((2, ny, nx))
    for j in range(u.shape[1]):
        for i in range(u.shape[2]):
            kernel[0, j, i], kernel[1, j, i] = u[0, j, i], u[1, j, i]
    halo, slip = np.empty((2, ny + HALO, nx)), np.empty((2, ny, nx))
    for j in range(ny):
        for i in range(nx):
            field[0, j, i] = pressure[j, i]
    displace(spectra(kernel, ny, nx, ly, lx), field, ly, lx, workspace(ly, lx), halo)
    for c in range(2):
        for j in range(ny):
            for i in range(nx):
                slip[c, j, i] = (halo[c, j, i] - halo[c, j + 2, i]) / (2.0 * hy)
    return slip


@njit(cache=True)
def leading_rows(bound):
    """Row of the leading element (largest y with a traction bound > 0) of each column, -1 for none."""
    ny, nx = bound.shape
    rows = np.empty(nx, np.int64)
    for j in range(nx):
        rows[j] = -1
    for i in range(ny):
        for j in range(nx):
            if bound[i, j] > 0.0:
                rows[j] = i
    return rows


@njit(cache=True, fastmath=FAST)
def displace(multipliers, field, ly, lx, work, halo):
    """Displacements `halo` (2, ny + 3, nx), one row behind to two rows ahead, of the tractions `field`."""
    here = forward(field, ly, lx, work)
    there = 2 - here
    zr, zi, wr, wi = work[here], work[here + 1], work[there], work[there + 1]
    for i in range(lx):
        mirror_row = ((lx - i) % lx) * ly
        for j in range(ly):
            k = i * ly + j
            o = mirror_row + (ly - j if j > 0 else 0)
            pr, pi, qr, qi = multipliers[0, k], multipliers[1, k], multipliers[2, k], multipliers[3, k]
            wr[k] = pr * zr[k] - pi * zi[k] + qr * zr[o] + qi * zi[o]
            wi[k] = pr * zi[k] + pi * zr[k] + qi * zr[o] - qr * zi[o]
    backward(work, there, ly, lx, halo)


@njit(cache=True, fastmath=FAST)
def multiply(multipliers, field, ly, lx, hy, leading, work, halo, result):
    """Slip -du/dy caused by the tractions `field` (2, ny, nx) into `result` (2, ny, nx); `halo` is work space.

    Upwind difference of second order, blended with the central one in the `leading` element of each column.
    """
    displace(multipliers, field, ly, lx, work, halo)
    ny, nx = result.shape[1], result.shape[2]
    for c in range(2):
        for i in range(ny):
            for j in range(nx):
                ahead = halo[c, i + 2, j]
                result[c, i, j] = (1.5 * halo[c, i + 1, j] - 2.0 * ahead + 0.5 * halo[c, i + 3, j]) / hy
        for j in range(nx):
            i = leading[j]
            if i >= 0:
                central = 0.5 * (halo[c, i, j] - halo[c, i + 2, j]) / hy
                result[c, i, j] += LEADING_SHARE * (central - result[c, i, j])
