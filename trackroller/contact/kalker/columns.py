"""Preconditioner of the tangential problem: solve each column of elements along the rolling direction on its own.

The influence of a column on itself is exact. The influence of other columns and the change of the traction's direction
are left out, so each component of each column is a small dense system. GMRES then needs about 10 products instead of
60 to 100.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from trackroller.contact.influence import FAST


@njit(cache=True)
def column_ranges(bound):
    """Return the first row with a bound > 0 in each column, and the number of rows up to the last one."""
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
    """Factorise a matrix into L U in place; `columns` holds the matrix by its columns.

    Rows are not exchanged: the differences lean towards the leading edge, which keeps the pivots away from 0. The loop
    treats two columns at a time, which halves the memory traffic. Zero pivots are left out.
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
    """Factorise 1 - P' + rho P' B for each column and component into `factors` (nx, 2, ny, ny); P' without xy."""
    ny = derivative.shape[1]
    for j in range(count.size):
        n = count[j]
        for c in range(2):
            columns = factors[j, c]
            for i in range(n):
                p = derivative[2 * c, first[j] + i, j]
                for m in range(n):
                    columns[m, i] = rho * p * slips[c, i - m + ny - 1]
                columns[i, i] += 1.0 - p
            _factorise(columns, n)


@njit(cache=True, fastmath=FAST, nogil=True)
def apply_inverse(factors, first, count, field, out):
    """Apply the preconditioner to `field` and write `out`, both (ny, nx, 2); elements with bound 0 stay unchanged."""
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
