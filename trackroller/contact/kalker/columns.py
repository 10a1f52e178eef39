"""Preconditioner of the tangential problem: solve each column of elements along the rolling direction on its own.

The influence of a column on itself is exact. The influence of other columns and the change of the traction's direction
are left out, so each component of each column is a small dense system. GMRES then needs about 10 products instead of
60 to 100.
"""

from __future__ import annotations

import numpy as np

from trackroller.numerics.compiled import compiled, fast
from trackroller.numerics.lanes import LANES, multiply, subtract_multiple

PAIR = LANES // 2  # columns whose systems are solved side by side


@compiled
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


@compiled
def factors_of(ny, nx):
    """Return room for the factors of all systems, (groups, ny, ny, LANES); lanes are x and y of PAIR columns."""
    return np.empty((-(-nx // PAIR), ny, ny, LANES))


@compiled
def _most_rows(count, group):
    """Return the largest number of loaded rows in the columns of a group."""
    return count[group * PAIR : (group + 1) * PAIR].max()


@fast
def _factorise(columns, n):
    """Factorise matrices (., ., LANES) into L U in place; `columns` holds the matrices by their columns.

    Rows are not exchanged: the differences lean towards the leading edge, which keeps the pivots away from 0. Zero
    pivots are left out.
    """
    flat, stride = columns.reshape(-1), columns.shape[1] * LANES
    for k in range(n):
        diagonal, below = k * stride + k * LANES, k * stride + (k + 1) * LANES
        for lane in range(LANES):
            pivot = flat[diagonal + lane]
            flat[diagonal + lane] = 1.0 / pivot if pivot != 0.0 else 0.0
        multiply(flat, below, flat, diagonal, n - k - 1)
        for m in range(k + 1, n):
            row = m * stride + k * LANES
            subtract_multiple(flat, row + LANES, flat, below, flat, row, n - k - 1)


@fast
def factorise(slips, derivative, rho, first, count, factors):
    """Factorise 1 - P' + rho P' B for each column and component into `factors`; P' without xy.

    Rows beyond those of a column are rows of the identity.
    """
    ny = derivative.shape[1]
    projected, own = np.empty(ny * LANES), np.empty((2 * ny - 1) * LANES)
    for lane in range(LANES):
        own[lane::LANES] = slips[lane % 2]
    for group in range(factors.shape[0]):
        n, columns = _most_rows(count, group), factors[group]
        projected[:] = 0.0
        for lane in range(LANES):
            j = group * PAIR + lane // 2
            if j < count.size:
                for i in range(count[j]):
                    projected[i * LANES + lane] = derivative[2 * (lane % 2), first[j] + i, j]
        for m in range(n):
            column, start = columns[m].reshape(-1), (ny - 1 - m) * LANES
            for t in range(n * LANES):
                column[t] = rho * projected[t] * own[start + t]
            for lane in range(LANES):
                columns[m, m, lane] += 1.0 - projected[m * LANES + lane]
        _factorise(columns, n)


@fast
def apply_inverse(factors, first, count, field, out):
    """Apply the preconditioner to `field` and write `out`, both (ny, nx, 2); elements with bound 0 stay unchanged."""
    stride = field.shape[0] * LANES
    line = np.empty(stride)
    out[:] = field
    for group in range(factors.shape[0]):
        n, flat = _most_rows(count, group), factors[group].reshape(-1)
        line[:] = 0.0
        for lane in range(LANES):
            j = group * PAIR + lane // 2
            if j < count.size:
                for i in range(count[j]):
                    line[i * LANES + lane] = field[first[j] + i, j, lane % 2]
        for m in range(n):
            below = (m + 1) * LANES
            subtract_multiple(line, below, flat, m * stride + below, line, m * LANES, n - m - 1)
        for m in range(n - 1, -1, -1):
            multiply(line, m * LANES, flat, m * stride + m * LANES, 1)
            subtract_multiple(line, 0, flat, m * stride, line, m * LANES, m)
        for lane in range(LANES):
            j = group * PAIR + lane // 2
            if j < count.size:
                for i in range(count[j]):
                    out[first[j] + i, j, lane % 2] = line[i * LANES + lane]
