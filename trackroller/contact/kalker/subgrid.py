"""Tractions between the centres of elements.

Neither the traction nor its direction is smooth where slip turns into stick or about the spin pole. Smooth is
z = tau/(mu p) - k s, k > 0, of which the law of dry friction makes the traction: tau = mu p P(z), where P shortens a
vector to at most length 1. So z is interpolated by cubic splines and the law is applied at each point. With k from the
slip that an element's own traction causes, a stick area smaller than an element has about its true size.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numba import njit
from scipy.interpolate import make_interp_spline
from scipy.ndimage import distance_transform_edt

PARTS = 3  # points along each side of an element
RIM = 0.2  # of the largest bound: the least that slips are divided by


@lru_cache(maxsize=16)
def _spline(n: int, parts: int) -> np.ndarray:
    """Return the matrix (parts n, n) of the cubic spline through the centres, constant beyond the outer ones."""
    points = np.clip((np.arange(parts * n) + 0.5) / parts - 0.5, 0.0, n - 1.0)
    matrix = np.ascontiguousarray(make_interp_spline(np.arange(n), np.eye(n), k=3)(points))
    matrix.setflags(write=False)
    return matrix


def _filled(z: np.ndarray, height: np.ndarray) -> np.ndarray:
    """Return fields z (n, 2, m, m) with the values of the nearest loaded element outside the patches."""
    if height.ndim == 2:
        row, column = distance_transform_edt(height <= 0.0, return_distances=False, return_indices=True)
        return z[:, :, row, column]
    out = np.empty_like(z)
    for i in range(len(z)):
        out[i : i + 1] = _filled(z[i : i + 1], height[i])
    return out


@njit(cache=True, nogil=True)
def _shorten(z):
    """Shorten the vectors of a field (2, ny, nx) to at most length 1, in place."""
    for i in range(z.shape[1]):
        for j in range(z.shape[2]):
            square = z[0, i, j] ** 2 + z[1, i, j] ** 2
            if square > 1.0:
                factor = 1.0 / np.sqrt(square)
                z[0, i, j] *= factor
                z[1, i, j] *= factor


def shares(
    height: np.ndarray, traction: np.ndarray, slip: np.ndarray, own_slip: np.ndarray, parts: int = PARTS
) -> np.ndarray:
    """Return the traction over its bound on `parts` times the elements.

    Parameters
    ----------
    height : (m, m) or (n, m, m)
        Mean pressure of each element over the largest of the patch.
    traction, slip : (n, 2, m, m)
        Tractions over mu p_max and slips of elements under constant friction.
    own_slip : (n,)
        Slip that the traction mu p_max of an element causes at itself.

    Returns
    -------
    Array (n, 2, parts m, parts m), of length 1 where the surfaces slide.
    """
    return _between(_before_law(height, traction, slip, own_slip), parts)


def both_shares(height: np.ndarray, traction: np.ndarray, slip: np.ndarray, own_slip: np.ndarray):
    """Return `shares`, and those of elements of twice the size whose z is the mean of four, (n, 2, ., .) each."""
    z = _before_law(height, traction, slip, own_slip)
    n, _, m, _ = z.shape
    return _between(z, PARTS), _between(z.reshape(n, 2, m // 2, 2, m // 2, 2).mean(axis=(3, 5)), PARTS)


def _before_law(height: np.ndarray, traction: np.ndarray, slip: np.ndarray, own_slip: np.ndarray) -> np.ndarray:
    """Return z = tau/(mu p) - k s of the elements, outside the patches that of the nearest one inside."""
    each = height if height.ndim == 2 else height[:, None]
    bound = np.where(each > 0.0, each, 1.0)
    z = traction / bound - slip / (own_slip[:, None, None, None] * np.maximum(each, RIM))
    return _filled(z, height)


def _between(z: np.ndarray, parts: int) -> np.ndarray:
    """Interpolate z (n, 2, m, m) to `parts` times the elements and apply the law of friction."""
    matrix = _spline(z.shape[-1], parts)
    fine = np.matmul(np.matmul(matrix, z), matrix.T)
    for field in fine:
        _shorten(field)
    return fine


@njit(cache=True, nogil=True)
def _sum(share, height, a, b, out):
    """Add up F_T, F_A and M_R of one patch over mu p_max."""
    ny, nx = height.shape
    for i in range(ny):
        y = b * ((2.0 * i + 1.0) / ny - 1.0)
        for j in range(nx):
            x = a * ((2.0 * j + 1.0) / nx - 1.0)
            tx, ty = share[0, i, j] * height[i, j], share[1, i, j] * height[i, j]
            out[0] += tx
            out[1] += ty
            out[2] += x * ty - y * tx
    for k in range(3):
        out[k] *= 4.0 * a * b / (nx * ny)


def forces(share: np.ndarray, height: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return F_T, F_A and M_R over mu p_max, (n, 3), of `shares` in patches with half sides a, b (n,) [mm].

    `height` (m, m) or (n, m, m) is the mean pressure over the largest on the grid of the shares.
    """
    out = np.zeros((len(share), 3))
    for i, field in enumerate(share):
        _sum(field, height if height.ndim == 2 else height[i], a[i], b[i], out[i])
    return out
