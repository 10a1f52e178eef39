"""Preconditioner of the tangential problem: solve each column of elements along the rolling direction on its own.

Each element has two directions: `along` the traction and `across` it. A sliding element moves across only, a sticking
one in both directions. Each direction of a column is a small banded system with the exact influence of the column on
itself, up to a distance of `BAND` elements. The influence of elements further away, of other columns, and of one
direction on the other, is left out. GMRES then needs about 10 products instead of 60 to 100, with a band as with whole
columns. The preconditioner has single precision, which costs GMRES no product: the products
themselves have double precision, so that the solution depends on the rounding of the preconditioner by 1e-10 at most.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from trackroller.contact.kalker.loops import ACROSS, ALONG, NORMAL_X, NORMAL_Y
from trackroller.numerics.compiled import assign, compiled, fast
from trackroller.numerics.lanes import LANES, multiply, subtract_multiple

COLUMN, DIRECTION, FIRST, ROWS = range(4)  # of a system
# Elements on each side that a system holds. 12 need 1 % more products than whole columns, 8 need 2 % more.
BAND = 12
WIDTH = 2 * BAND + 1


class Systems(NamedTuple):
    """Systems of one patch: `which` (2 nx, 4) are column, direction, first row and number of rows of each.

    `x`, `y` (groups, ny LANES) are the directions of their elements, `factors` (groups, ny, WIDTH, LANES) the factors
    L U of the matrices by their columns, each from `BAND` rows above the diagonal to `BAND` rows below it; the systems
    of a group stand side by side. `line` (6, 2 ny LANES) is work space.
    """

    which: np.ndarray
    x: np.ndarray
    y: np.ndarray
    factors: np.ndarray
    line: np.ndarray


@compiled
def systems_for(ny, nx):
    """Return empty arrays that `factorise` fills with the systems of ny x nx elements."""
    groups = -(-2 * nx // LANES)
    return Systems(
        np.zeros((groups * LANES, 4), np.int64),
        np.zeros((groups, ny * LANES), np.float32),
        np.zeros((groups, ny * LANES), np.float32),
        np.empty((groups, ny, WIDTH, LANES), np.float32),
        np.zeros((6, 2 * ny * LANES), np.float32),
    )


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
def _list_systems(derivative, first, count, which):
    """Write the systems of the loaded columns into `which` and return their number; columns of like length meet.

    A system along the traction reaches from the first to the last sticking element; sliding ones have nothing to solve.
    """
    nx, number = count.size, 0
    which[:, ROWS] = 0
    for direction in (ACROSS, ALONG):
        for k in range(nx):
            j = k // 2 if k % 2 == 0 else nx - 1 - k // 2
            low, high = first[j], first[j] + count[j]
            while low < high and derivative[direction, low, j] == 0.0:
                low += 1
            while high > low and derivative[direction, high - 1, j] == 0.0:
                high -= 1
            if high > low:
                which[number, COLUMN], which[number, DIRECTION] = j, direction
                which[number, FIRST], which[number, ROWS] = low, high - low
                number += 1
    return number


@fast
def _factorise(columns, n):
    """Factorise matrices (., WIDTH, LANES) into L U in place; `columns` holds the matrices by their columns.

    Rows are not exchanged: the differences lean towards the leading edge, which keeps the pivots away from 0. Zero
    pivots are left out.
    """
    flat, one = columns.reshape(-1), np.float32(1.0)
    for k in range(n):
        diagonal, rows = (k * WIDTH + BAND) * LANES, min(BAND, n - k - 1)
        below = diagonal + LANES
        for lane in range(LANES):
            pivot = flat[diagonal + lane]
            flat[diagonal + lane] = one / pivot if pivot != 0.0 else 0.0
        multiply(flat, below, flat, diagonal, rows)
        for m in range(k + 1, k + rows + 1):
            row = (m * WIDTH + BAND + k - m) * LANES
            subtract_multiple(flat, row + LANES, flat, below, flat, row, rows)


@fast
def _spread(slips, rho, lines):
    """Write rho times the slips (2, 2 ny - 1) into two `lines`, each number once for every lane."""
    for c in range(2):
        for i in range(slips.shape[1]):
            for lane in range(LANES):
                lines[c, i * LANES + lane] = rho * slips[c, i]


@fast
def _fill(systems, group, derivative, n):
    """Write the matrices 1 - w + w rho d B d of a group; w is the derivative in the direction d of each element."""
    which, x, y = systems.which[group * LANES : (group + 1) * LANES], systems.x[group], systems.y[group]
    line = systems.line
    own_x, own_y, along_x, along_y, minus_y, other = line[0], line[1], line[2], line[3], line[4], line[5]
    ny, size = derivative.shape[1], n * LANES
    weight = other[size:]
    x[:], y[:], weight[:] = 0.0, 0.0, 0.0
    for lane in range(LANES):
        j, along, first = which[lane, COLUMN], which[lane, DIRECTION] == ALONG, which[lane, FIRST]
        for i in range(which[lane, ROWS]):
            at = i * LANES + lane
            c, s = derivative[NORMAL_X, first + i, j], derivative[NORMAL_Y, first + i, j]
            x[at], y[at] = (c, s) if along else (-s, c)
            weight[at] = derivative[which[lane, DIRECTION], first + i, j]
    for t in range(size):
        along_x[t], along_y[t], minus_y[t] = weight[t] * x[t], weight[t] * y[t], -y[t]
    for m in range(n):
        low, high = max(m - BAND, 0), min(m + BAND + 1, n)
        column, to, start = systems.factors[group, m].reshape(-1), (BAND - m) * LANES, (ny - 1 - m) * LANES
        for t in range(low * LANES, high * LANES):
            column[to + t] = along_x[t] * own_x[start + t]
            other[t] = along_y[t] * own_y[start + t]
        multiply(column, to + low * LANES, x, m * LANES, high - low)
        subtract_multiple(column, to + low * LANES, other, low * LANES, minus_y, m * LANES, high - low)
        for t in range(m * LANES, (m + 1) * LANES):
            column[to + t] += np.float32(1.0) - weight[t]


@fast
def factorise(slips, derivative, rho, first, count, systems):
    """Factorise the systems of all columns in `systems` and return the number of their groups.

    Rows beyond those of a system are rows of the identity. `derivative` (4, ny, nx) is that of `loops.jacobian`.
    """
    _spread(slips, rho, systems.line)
    groups = -(-_list_systems(derivative, first, count, systems.which) // LANES)
    for group in range(groups):
        n = systems.which[group * LANES : (group + 1) * LANES, ROWS].max()
        _fill(systems, group, derivative, n)
        _factorise(systems.factors[group], n)
    return groups


@fast
def apply_inverse(systems, groups, field, out):
    """Apply the preconditioner to `field` and write `out`, both (ny, nx, 2); elements without system stay unchanged."""
    line, before = systems.line[2], systems.line[3]
    assign(out, field)
    for group in range(groups):
        which, flat = systems.which[group * LANES : (group + 1) * LANES], systems.factors[group].reshape(-1)
        n, x, y = which[:, ROWS].max(), systems.x[group], systems.y[group]
        line[: n * LANES] = 0.0
        for lane in range(LANES):
            j, first = which[lane, COLUMN], which[lane, FIRST]
            for i in range(which[lane, ROWS]):
                at = i * LANES + lane
                line[at] = x[at] * field[first + i, j, 0] + y[at] * field[first + i, j, 1]
        assign(before[: n * LANES], line[: n * LANES])
        for m in range(n):
            below = (m * WIDTH + BAND + 1) * LANES
            subtract_multiple(line, (m + 1) * LANES, flat, below, line, m * LANES, min(BAND, n - m - 1))
        for m in range(n - 1, -1, -1):
            diagonal, rows = (m * WIDTH + BAND) * LANES, min(BAND, m)
            multiply(line, m * LANES, flat, diagonal, 1)
            subtract_multiple(line, (m - rows) * LANES, flat, diagonal - rows * LANES, line, m * LANES, rows)
        for lane in range(LANES):
            j, first = which[lane, COLUMN], which[lane, FIRST]
            for i in range(which[lane, ROWS]):
                at = i * LANES + lane
                change = line[at] - before[at]
                out[first + i, j, 0] += change * x[at]
                out[first + i, j, 1] += change * y[at]
