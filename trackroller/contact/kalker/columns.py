"""Preconditioner of the tangential problem: each column of elements along the rolling direction by itself.

A column's own influence is exact, that of the other columns and the turning of the traction are left out, so both
components of every column are a small dense system. With it GMRES needs about 10 products instead of 60 to 100.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from trackroller.contact.influence import FAST, LEADING_SHARE


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


@njit(cache=True, fastmath=FAST, nogil=True)
def _factorise(columns, n):
    """L U in place of a matrix given by its columns, without exchange of rows: their own influence is the largest.

    Two columns at a time, for half the traffic; zero pivots are left out.
    """
    for k in range(0, n, 2):
        first = columns[k]
        first[k] = 1.0 / first[k] if first[k] != 0.0 else 0.0
        for i in range(k + 1, n):
            first[i] *= first[k]
        if k + 1 == n:
            break
        second = columns[k + 1]
        share = second[k]
        for i in range(k + 1, n):
            second[i] -= share * first[i]
        second[k + 1] = 1.0 / second[k + 1] if second[k + 1] != 0.0 else 0.0
        for i in range(k + 2, n):
            second[i] *= second[k + 1]
        for m in range(k + 2, n):
            other = columns[m]
            share = other[k]
            other[k + 1] -= share * first[k + 1]
            rest = other[k + 1]
            for i in range(k + 2, n):
                other[i] -= share * first[i] + rest * second[i]


@njit(cache=True, nogil=True)
def factorise(slips, derivative, rho, first, count, factors):
    """Factors (nx, 2, ny, ny), columns first, of 1 - P' + rho P' B for each column and component, P' without its xy."""
    ny = derivative.shape[1]
    for j in range(count.size):
        n, top = count[j], first[j] + count[j] - 1
        for c in range(2):
            columns = factors[j, c]
            for i in range(n):
                p = derivative[2 * c, first[j] + i, j]
                leading = 1 if first[j] + i == top else 0
                for m in range(n):
                    columns[m, i] = rho * p * slips[c, leading, i - m + ny - 1]
                columns[i, i] += 1.0 - p
            _factorise(columns, n)


@njit(cache=True, fastmath=FAST, nogil=True)
def apply_inverse(factors, first, count, field, out):
    """`out` = the preconditioner applied to `field`, both (ny, nx, 2); elements without bound pass unchanged."""
    line = np.empty(field.shape[0])
    for j in range(count.size):
        n, start = count[j], first[j]
        for c in range(2):
            for i in range(field.shape[0]):
                out[i, j, c] = field[i, j, c]
            columns = factors[j, c]
            for i in range(n):
                line[i] = field[start + i, j, c]
            for m in range(n):
                column, value = columns[m], line[m]
                for i in range(m + 1, n):
                    line[i] -= column[i] * value
            for m in range(n - 1, -1, -1):
                column = columns[m]
                value = line[m] * column[m]
                line[m] = value
                for i in range(m):
                    line[i] -= column[i] * value
            for i in range(n):
                out[start + i, j, c] = line[i]
