"""Two-dimensional fast Fourier transforms inside compiled code, for products with influence functions.

A Stockham transform of mixed radix (2, 3, 4, 5) along the first axis of split real and imaginary arrays,
vectorised over the second. Compiled loops over patches cannot call SciPy's transforms; this one keeps a whole
patch solution in one compiled function, and thus one patch per core.
Sources: Van Loan, Computational frameworks for the fast Fourier transform (1992), section 1.7 (Stockham).
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

FAST = {"contract", "reassoc", "arcp", "nsz"}


@njit(cache=True)
def good_length(n):
    """Smallest 2^i 3^j 5^k that is not below n [-]."""
    best = 1
    while best < n:
        best *= 2
    five = 1
    while five < best:
        three = five
        while three < best:
            length = three
            while length < n:
                length *= 2
            best = min(best, length)
            three *= 3
        five *= 5
    return best


@njit(cache=True, inline="always")
def _radix(n):
    if n % 4 == 0:
        return 4
    if n % 2 == 0:
        return 2
    return 3 if n % 3 == 0 else 5


@njit(cache=True, fastmath=FAST)
def _pass2(xr, xi, yr, yi, width, count, turn):
    """One radix-2 pass: rows of `width` numbers, `count` twiddles, exp(turn i p)."""
    for p in range(count):
        cr, ci = math.cos(turn * p), math.sin(turn * p)
        a, b = width * p, width * (p + count)
        out = width * 2 * p
        for q in range(width):
            ar, ai, br, bi = xr[a + q], xi[a + q], xr[b + q], xi[b + q]
            yr[out + q], yi[out + q] = ar + br, ai + bi
            dr, di = ar - br, ai - bi
            yr[out + width + q] = dr * cr - di * ci
            yi[out + width + q] = dr * ci + di * cr


@njit(cache=True, fastmath=FAST)
def _pass4(xr, xi, yr, yi, width, count, turn, sign):
    """One radix-4 pass."""
    for p in range(count):
        c1, s1 = math.cos(turn * p), math.sin(turn * p)
        c2, s2 = math.cos(2 * turn * p), math.sin(2 * turn * p)
        c3, s3 = math.cos(3 * turn * p), math.sin(3 * turn * p)
        i0, i1 = width * p, width * (p + count)
        i2, i3 = width * (p + 2 * count), width * (p + 3 * count)
        o0 = width * 4 * p
        o1, o2, o3 = o0 + width, o0 + 2 * width, o0 + 3 * width
        for q in range(width):
            ar, ai = xr[i0 + q] + xr[i2 + q], xi[i0 + q] + xi[i2 + q]
            br, bi = xr[i0 + q] - xr[i2 + q], xi[i0 + q] - xi[i2 + q]
            cr, ci = xr[i1 + q] + xr[i3 + q], xi[i1 + q] + xi[i3 + q]
            dr, di = -sign * (xi[i1 + q] - xi[i3 + q]), sign * (xr[i1 + q] - xr[i3 + q])
            yr[o0 + q], yi[o0 + q] = ar + cr, ai + ci
            er, ei = br + dr, bi + di
            yr[o1 + q], yi[o1 + q] = er * c1 - ei * s1, er * s1 + ei * c1
            er, ei = ar - cr, ai - ci
            yr[o2 + q], yi[o2 + q] = er * c2 - ei * s2, er * s2 + ei * c2
            er, ei = br - dr, bi - di
            yr[o3 + q], yi[o3 + q] = er * c3 - ei * s3, er * s3 + ei * c3


@njit(cache=True, fastmath=FAST)
def _pass_any(xr, xi, yr, yi, width, count, turn, sign, radix):
    """One pass of any (odd) radix by the definition of the transform."""
    for p in range(count):
        for j in range(radix):
            out = width * (radix * p + j)
            for q in range(width):
                yr[out + q] = 0.0
                yi[out + q] = 0.0
            for k in range(radix):
                angle = sign * 2.0 * math.pi * ((j * k) % radix) / radix + j * turn * p
                c, s = math.cos(angle), math.sin(angle)
                a = width * (p + count * k)
                for q in range(width):
                    yr[out + q] += xr[a + q] * c - xi[a + q] * s
                    yi[out + q] += xr[a + q] * s + xi[a + q] * c


@njit(cache=True)
def transform(xr, xi, yr, yi, n, m, sign):
    """Discrete Fourier transform along the first axis of n x m numbers (flat, row by row).

    sign -1 forward, +1 backward (no scaling). `x` is overwritten, `y` is work space; returns True where the
    result lies in `y`, False where in `x`.
    """
    left = n
    width = m
    swapped = False
    while left > 1:
        radix = _radix(left)
        count = left // radix
        turn = sign * 2.0 * math.pi / left
        if swapped:
            ar, ai, br, bi = yr, yi, xr, xi
        else:
            ar, ai, br, bi = xr, xi, yr, yi
        if radix == 2:
            _pass2(ar, ai, br, bi, width, count, turn)
        elif radix == 4:
            _pass4(ar, ai, br, bi, width, count, turn, sign)
        else:
            _pass_any(ar, ai, br, bi, width, count, turn, sign, radix)
        swapped = not swapped
        left = count
        width *= radix
    return swapped


@njit(cache=True)
def workspace(ly, lx):
    """Work space of the transforms: (4, ly * lx)."""
    return np.empty((4, ly * lx))


@njit(cache=True)
def _transpose(ar, ai, br, bi, rows, columns, keep):
    """b (columns, keep) = a (rows, columns) transposed, filled with zeros beyond `rows`."""
    for j in range(columns):
        for i in range(min(rows, keep)):
            br[j * keep + i] = ar[i * columns + j]
            bi[j * keep + i] = ai[i * columns + j]
        for i in range(rows, keep):
            br[j * keep + i] = 0.0
            bi[j * keep + i] = 0.0


@njit(cache=True)
def forward(field, ly, lx, work):
    """Spectrum of field[0] + i field[1] (2, ny, nx), padded to (ly, lx); transposed (lx, ly), in a pair of rows.

    Returns the index (0 or 2) of the rows of `work` that hold the real and imaginary part.
    """
    ny, nx = field.shape[1], field.shape[2]
    for i in range(ny):
        for j in range(nx):
            work[0, i * nx + j] = field[0, i, j]
            work[1, i * nx + j] = field[1, i, j]
    for k in range(ny * nx, ly * nx):
        work[0, k] = 0.0
        work[1, k] = 0.0
    here = 2 if transform(work[0], work[1], work[2], work[3], ly, nx, -1.0) else 0
    there = 2 - here
    _transpose(work[here], work[here + 1], work[there], work[there + 1], ly, nx, ly)
    for k in range(nx * ly, lx * ly):
        work[there, k] = 0.0
        work[there + 1, k] = 0.0
    swapped = transform(work[there], work[there + 1], work[here], work[here + 1], lx, ly, -1.0)
    return here if swapped else there


@njit(cache=True)
def backward(work, here, ly, lx, field):
    """Inverse of `forward` without scaling: the first (ny, nx) numbers into `field` (2, ny, nx)."""
    ny, nx = field.shape[1], field.shape[2]
    there = 2 - here
    if transform(work[here], work[here + 1], work[there], work[there + 1], lx, ly, 1.0):
        here, there = there, here
    _transpose(work[here], work[here + 1], work[there], work[there + 1], nx, ly, nx)
    if transform(work[there], work[there + 1], work[here], work[here + 1], ly, nx, 1.0):
        there = here
    for i in range(ny):
        for j in range(nx):
            field[0, i, j] = work[there, i * nx + j]
            field[1, i, j] = work[there + 1, i * nx + j]
