"""GMRES for a step of Newton's method on stick and slip; see `kalker_newton`.

Compiled whole, transforms included: between short calls threads would spend their time waiting for the interpreter.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from trackroller.contact.influence import FAST, HALO, convolve, differences
from trackroller.contact.kalker.columns import apply_inverse, factorise
from trackroller.contact.kalker.loops import reals, row_means


@njit(cache=True, fastmath=FAST, nogil=True)
def dot(a, b):
    total = 0.0
    for i in range(a.size):
        total += a[i] * b[i]
    return total


@njit(cache=True)
def _rotate(hessenberg, givens, rhs, k):
    """Givens rotations of column k; the rest of the right-hand side is the residual's norm."""
    for i in range(k):
        c, s = givens[0, i], givens[1, i]
        a, b = hessenberg[i, k], hessenberg[i + 1, k]
        hessenberg[i, k], hessenberg[i + 1, k] = c * a + s * b, c * b - s * a
    a, b = hessenberg[k, k], hessenberg[k + 1, k]
    length = math.sqrt(a * a + b * b)
    c, s = (1.0, 0.0) if length == 0.0 else (a / length, b / length)
    givens[0, k], givens[1, k] = c, s
    hessenberg[k, k], hessenberg[k + 1, k] = length, 0.0
    rhs[k + 1] = -s * rhs[k]
    rhs[k] = c * rhs[k]


@njit(cache=True, fastmath=FAST, nogil=True)
def arnoldi(direction, product, mean, derivative, turn, rho, basis, k, hessenberg, givens, rhs):
    """Newton's matrix times `direction`, d - P'(d - rho B d) - turn M B d, made orthogonal to basis[: k + 1].

    `product` is B d, `mean` its `row_means` M B d. Returns the norm of the residual with this much of the Krylov space.
    """
    ny, nx = derivative.shape[1], derivative.shape[2]
    v = basis[k + 1]
    for i in range(ny):
        for j in range(nx):
            bx, by = product[i, j, 0], product[i, j, 1]
            dx, dy = direction[i, j, 0], direction[i, j, 1]
            x, y = dx - rho * bx, dy - rho * by
            pxx, pxy, pyy = derivative[0, i, j], derivative[1, i, j], derivative[2, i, j]
            mx, my = mean[i, j, 0], mean[i, j, 1]
            place = 2 * (i * nx + j)
            v[place] = dx - pxx * x - pxy * y - turn[0, i, j] * mx - turn[1, i, j] * my
            v[place + 1] = dy - pxy * x - pyy * y - turn[2, i, j] * mx - turn[3, i, j] * my
    for i in range(k + 1):
        h = dot(basis[i], v)
        hessenberg[i, k] = h
        row = basis[i]
        for j in range(v.size):
            v[j] -= h * row[j]
    h = math.sqrt(dot(v, v))
    hessenberg[k + 1, k] = h
    if h > 0.0:
        for j in range(v.size):
            v[j] /= h
    _rotate(hessenberg, givens, rhs, k)
    return abs(rhs[k + 1])


@njit(cache=True, nogil=True)
def combination(basis, hessenberg, rhs, done, out):
    """Least-squares combination of basis[: done] into `out` (2 ny nx,)."""
    for j in range(out.size):
        out[j] = 0.0
    for i in range(done - 1, -1, -1):
        for j in range(i + 1, done):
            rhs[i] -= hessenberg[i, j] * rhs[j]
        rhs[i] = rhs[i] / hessenberg[i, i] if hessenberg[i, i] != 0.0 else 0.0
        for j in range(out.size):
            out[j] += rhs[i] * basis[i, j]


@njit(cache=True, nogil=True)
def multiply(field, p, q, leading, hy, rolling, work, product):
    """B `field` into `product`, fields (ny, nx): slips in rolling, else displacements; see `convolve`."""
    ny, nx = field.shape
    convolve(field, p, q, work)
    halo = work[1, : ny + HALO, :nx]
    if rolling:
        differences(halo, leading, hy, product)
    else:
        for i in range(ny):
            for j in range(nx):
                product[i, j] = halo[i + 1, j]


@njit(cache=True, nogil=True)
def solve(
    value,
    slips,
    derivative,
    turn,
    falls,
    rho,
    first,
    count,
    p,
    q,
    leading,
    hy,
    rolling,
    tolerance,
    factors,
    basis,
    work,
    step,
):
    """Newton's matrix against the residual `value` (ny, nx) by preconditioned GMRES into `step`; how many products.

    slips, first, count : `column_slips` and `column_ranges`; derivative, turn : of `jacobian`, turn if friction
    `falls`; p, q : of `Influence`
    tolerance : of the linear residual, over that of `value`, which is lost
    factors (nx, 2, ny, ny), basis (Krylov space + 1, 2 ny nx), work : see `convolve`; space to work in
    """
    ny, nx = value.shape
    factorise(slips, derivative, rho, first, count, factors)
    limit = basis.shape[0] - 1
    hessenberg, givens, rhs = np.zeros((limit + 1, limit)), np.zeros((2, limit)), np.zeros(limit + 1)
    product = np.empty_like(value)
    mean = np.zeros((ny, nx, 2))
    value_reals, step_reals, product_reals = reals(value), reals(step), reals(product)
    flat = value_reals.reshape(-1)
    norm = math.sqrt(dot(flat, flat))
    for j in range(flat.size):
        basis[0, j] = flat[j] / norm
    rhs[0] = norm
    done = 0
    for k in range(limit):
        apply_inverse(factors, first, count, basis[k].reshape(ny, nx, 2), step_reals)
        multiply(step, p, q, leading, hy, rolling, work, product)
        if falls:
            row_means(product_reals, first, count, mean)
        rest = arnoldi(step_reals, product_reals, mean, derivative, turn, rho, basis, k, hessenberg, givens, rhs)
        done = k + 1
        if rest <= tolerance * norm:
            break
    combination(basis, hessenberg, rhs, done, flat)
    apply_inverse(factors, first, count, value_reals, step_reals)
    return done
