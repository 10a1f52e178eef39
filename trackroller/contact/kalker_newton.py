"""Stick and slip on a patch: a semi-smooth Newton method with Krylov steps, compiled.

For each element with traction bound g the law of dry friction is the fixed point tau = P_g(tau - rho s), where
P_g shortens a vector to at most g and s = w + B tau is the slip (Alart & Curnier 1991). Newton's method is the
active-set method of stick and slip elements; its linear systems are solved by GMRES with fast products B tau.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from trackroller.contact.kalker_fft import FAST
from trackroller.contact.kalker_influence import HALO, leading_rows, multiply, padded_lengths


@njit(cache=True, fastmath=FAST)
def residual(traction, slip, bound, rho, out):
    """F = tau - P_g(tau - rho s) into `out`; returns its largest component [scaled as tau] and its norm."""
    ny, nx = bound.shape
    largest, square = 0.0, 0.0
    for i in range(ny):
        for j in range(nx):
            g = bound[i, j]
            zx = traction[0, i, j] - rho * slip[0, i, j]
            zy = traction[1, i, j] - rho * slip[1, i, j]
            z = math.sqrt(zx * zx + zy * zy)
            if z > g:
                factor = g / z
                zx *= factor
                zy *= factor
            fx, fy = traction[0, i, j] - zx, traction[1, i, j] - zy
            out[0, i, j], out[1, i, j] = fx, fy
            largest = max(largest, abs(fx), abs(fy))
            square += fx * fx + fy * fy
    return largest, math.sqrt(square)


@njit(cache=True, fastmath=FAST)
def jacobian(traction, slip, bound, rho, out):
    """Derivative of P_g at tau - rho s: xx, xy, yy into `out` (3, ny, nx)."""
    ny, nx = bound.shape
    for i in range(ny):
        for j in range(nx):
            g = bound[i, j]
            zx = traction[0, i, j] - rho * slip[0, i, j]
            zy = traction[1, i, j] - rho * slip[1, i, j]
            square = zx * zx + zy * zy
            if square <= g * g:
                inside = 1.0 if g > 0.0 else 0.0
                out[0, i, j], out[1, i, j], out[2, i, j] = inside, 0.0, inside
            else:
                factor = g / math.sqrt(square)
                out[0, i, j] = factor * zy * zy / square
                out[1, i, j] = -factor * zx * zy / square
                out[2, i, j] = factor * zx * zx / square


@njit(cache=True, fastmath=FAST)
def _apply(direction, product, derivative, rho, out):
    """out = d - P'(d - rho B d)."""
    ny, nx = derivative.shape[1], derivative.shape[2]
    for i in range(ny):
        for j in range(nx):
            x = direction[0, i, j] - rho * product[0, i, j]
            y = direction[1, i, j] - rho * product[1, i, j]
            pxx, pxy, pyy = derivative[0, i, j], derivative[1, i, j], derivative[2, i, j]
            out[0, i, j] = direction[0, i, j] - pxx * x - pxy * y
            out[1, i, j] = direction[1, i, j] - pxy * x - pyy * y


@njit(cache=True, fastmath=FAST)
def _dot(a, b):
    total = 0.0
    for i in range(a.size):
        total += a[i] * b[i]
    return total


@njit(cache=True, fastmath=FAST)
def _orthogonalise(basis, k, hessenberg):
    """One Arnoldi step: basis[k + 1] against basis[: k + 1] (modified Gram-Schmidt)."""
    v = basis[k + 1]
    for i in range(k + 1):
        h = _dot(basis[i], v)
        hessenberg[i, k] = h
        row = basis[i]
        for j in range(v.size):
            v[j] -= h * row[j]
    h = math.sqrt(_dot(v, v))
    hessenberg[k + 1, k] = h
    if h > 0.0:
        for j in range(v.size):
            v[j] /= h


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


@njit(cache=True)
def gmres(multipliers, derivative, rho, right, ly, lx, hy, leading, work, halo, tolerance, basis, product):
    """Solve d - P'(d - rho B d) = right (2, ny, nx). Returns d and the number of products."""
    steps = basis.shape[0] - 1
    shape = right.shape
    hessenberg = np.zeros((steps + 1, steps))
    givens = np.zeros((2, steps))
    rhs = np.zeros(steps + 1)
    flat = right.reshape(-1)
    norm = math.sqrt(_dot(flat, flat))
    solution = np.zeros(flat.size)
    if norm == 0.0:
        return solution.reshape(shape), 0
    for j in range(flat.size):
        basis[0, j] = flat[j] / norm
    rhs[0] = norm
    done = 0
    for k in range(steps):
        direction = basis[k].reshape(shape)
        multiply(multipliers, direction, ly, lx, hy, leading, work, halo, product)
        _apply(direction, product, derivative, rho, basis[k + 1].reshape(shape))
        _orthogonalise(basis, k, hessenberg)
        _rotate(hessenberg, givens, rhs, k)
        done = k + 1
        if abs(rhs[k + 1]) <= tolerance * norm:
            break
    for i in range(done - 1, -1, -1):
        for j in range(i + 1, done):
            rhs[i] -= hessenberg[i, j] * rhs[j]
        rhs[i] = rhs[i] / hessenberg[i, i] if hessenberg[i, i] != 0.0 else 0.0
        for j in range(flat.size):
            solution[j] += rhs[i] * basis[i, j]
    return solution.reshape(shape), done


@njit(cache=True, fastmath=FAST)
def _move(start, step, length, out):
    """out = start + length step, all (2, ny, nx)."""
    for c in range(2):
        for i in range(start.shape[1]):
            for j in range(start.shape[2]):
                out[c, i, j] = start[c, i, j] + length * step[c, i, j]


@njit(cache=True)
def newton(multipliers, own, hy, rigid, bound, traction, slip, tolerance, limit, krylov):
    """Tractions (2, ny, nx) of the friction law for the rigid slip `rigid` and the bounds `bound`.

    `traction` is the start and is overwritten, as is `slip`. Returns the residual (largest component of the law's
    residual), Newton steps, products. Steps are halved until the residual's norm falls (at most four times).
    """
    ny, nx = bound.shape
    ly, lx = padded_lengths(ny, nx)
    work, halo = np.empty((4, lx * ly)), np.empty((2, ny + HALO, nx))
    leading = leading_rows(bound)
    rho = 1.0 / own
    basis = np.empty((krylov + 1, 2 * ny * nx))
    product, change = np.empty((2, ny, nx)), np.empty((2, ny, nx))
    value, derivative = np.empty((2, ny, nx)), np.empty((3, ny, nx))
    new_traction, new_slip = np.empty((2, ny, nx)), np.empty((2, ny, nx))
    multiply(multipliers, traction, ly, lx, hy, leading, work, halo, product)
    _move(rigid, product, 1.0, slip)
    largest, norm = residual(traction, slip, bound, rho, value)
    products, iteration = 1, 0
    while largest > tolerance and iteration < limit:
        iteration += 1
        jacobian(traction, slip, bound, rho, derivative)
        inner = min(0.1, max(1e-4, 0.3 * tolerance / largest))
        step, used = gmres(multipliers, derivative, rho, value, ly, lx, hy, leading, work, halo, inner, basis, product)
        multiply(multipliers, step, ly, lx, hy, leading, work, halo, change)
        products += used + 1
        length = -1.0
        while True:
            _move(traction, step, length, new_traction)
            _move(slip, change, length, new_slip)
            largest, new_norm = residual(new_traction, new_slip, bound, rho, value)
            if new_norm < (1.0 + 0.1 * length) * norm or length > -0.05:
                break
            length *= 0.5
        norm = new_norm
        _move(new_traction, step, 0.0, traction)
        _move(new_slip, step, 0.0, slip)
    return largest, iteration, products
