"""Preconditioner of the tangential problem: each column of elements along the rolling direction by itself.

A column's own influence is exact, that of the other columns and the turning of the traction are left out, so both
components of every column are a small dense system. With it GMRES needs about 10 products instead of 60 to 100.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from trackroller.contact.kalker_influence import FAST, LEADING_SHARE


@njit(cache=True)
def column_slips(own_column, hy):
    """Slip at distance j (rows ahead, from -(ny-1)) of an element's unit traction in its own column.

    `own_column` (2, 2 ny - 1 + 3): displacements xx and yy over the distances -(ny-1)-1 .. ny-1+2.
    Returns (2, 2, 2 ny - 1): component, upwind or blended difference of the leading element, distance.
    """
    count = own_column.shape[1] - 3
    out = np.empty((2, 2, count))
    for c in range(2):
        for j in range(count):
            behind, here = own_column[c, j], own_column[c, j + 1]
            ahead, far = own_column[c, j + 2], own_column[c, j + 3]
            upwind = (1.5 * here - 2.0 * ahead + 0.5 * far) / hy
            central = 0.5 * (behind - ahead) / hy
            out[c, 0, j] = upwind
            out[c, 1, j] = upwind + LEADING_SHARE * (central - upwind)
    return out


@njit(cache=True)
def column_ranges(bound):
    """First row and number of rows with a bound > 0 in each column."""
    ny, nx = bound.shape
    first, count = np.zeros(nx, np.int64), np.zeros(nx, np.int64)
    for j in range(nx):
        for i in range(ny):
            if bound[i, j] > 0.0:
                if count[j] == 0:
                    first[j] = i
                count[j] = i - first[j] + 1
    return first, count


@njit(cache=True, fastmath=FAST)
def _factorise(matrix, n):
    """L U in place, without exchange of rows: their own influence is the largest; zero pivots are left out."""
    for k in range(n):
        pivot = matrix[k, k]
        inverse = 1.0 / pivot if pivot != 0.0 else 0.0
        matrix[k, k] = inverse
        for i in range(k + 1, n):
            share = matrix[i, k] * inverse
            matrix[i, k] = share
            if share != 0.0:
                for m in range(k + 1, n):
                    matrix[i, m] -= share * matrix[k, m]


@njit(cache=True, nogil=True)
def factorise(slips, derivative, rho, first, count, factors):
    """Factors (nx, 2, ny, ny) of 1 - P' + rho P' B for each column and component, P' without its xy part."""
    ny = derivative.shape[1]
    for j in range(count.size):
        n, top = count[j], first[j] + count[j] - 1
        for c in range(2):
            matrix = factors[j, c]
            for i in range(n):
                p = derivative[2 * c, first[j] + i, j]
                leading = 1 if first[j] + i == top else 0
                for m in range(n):
                    matrix[i, m] = rho * p * slips[c, leading, i - m + ny - 1]
                matrix[i, i] += 1.0 - p
            _factorise(matrix, n)


@njit(cache=True, fastmath=FAST, nogil=True)
def apply_inverse(factors, first, count, field, out):
    """`out` = the preconditioner applied to `field`, both (ny, nx, 2); elements without bound pass unchanged."""
    line = np.empty(field.shape[0])
    for j in range(count.size):
        n, start = count[j], first[j]
        for c in range(2):
            for i in range(field.shape[0]):
                out[i, j, c] = field[i, j, c]
            matrix = factors[j, c]
            for i in range(n):
                value = field[start + i, j, c]
                row = matrix[i]
                for m in range(i):
                    value -= row[m] * line[m]
                line[i] = value
            for i in range(n - 1, -1, -1):
                value = line[i]
                row = matrix[i]
                for m in range(i + 1, n):
                    value -= row[m] * line[m]
                line[i] = value * row[i]
            for i in range(n):
                out[start + i, j, c] = line[i]
