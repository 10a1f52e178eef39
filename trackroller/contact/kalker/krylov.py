"""GMRES for one Newton step on stick and slip; see `contact.kalker.newton`.

The whole iteration is compiled, transforms included. With short compiled calls the threads would wait for the
interpreter most of the time.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from trackroller.contact.influence import convolve
from trackroller.contact.kalker.columns import Systems, apply_inverse, factorise
from trackroller.contact.kalker.loops import ACROSS, ALONG, NORMAL_X, NORMAL_Y, XX, XY, YX, YY, reals, row_means
from trackroller.numerics.compiled import compiled, fast


class Operator(NamedTuple):
    """Spectra p, q of the product B, which maps tractions to slips; see `Influence`."""

    p: np.ndarray
    q: np.ndarray


class Columns(NamedTuple):
    """Loaded columns: own influence `slips` (see `Influence.column`), first loaded row and number of loaded rows."""

    slips: np.ndarray
    first: np.ndarray
    loaded: np.ndarray


class Derivative(NamedTuple):
    """Derivative of the friction law in each element; see `loops.jacobian`.

    projection : P' (4, ny, nx); turn : (4, ny, nx), used only where friction `falls`; rho : scale of the slips.
    """

    projection: np.ndarray
    turn: np.ndarray
    falls: bool
    rho: float


class Space(NamedTuple):
    """Work space of a Newton step.

    systems : of the preconditioner; basis : Krylov basis (m + 1, 2 ny nx); moves : of each vector of the basis the
    traction and the slip that it stands for, complex (m, 2, ny, nx); transforms : see `convolve`.
    """

    systems: Systems
    basis: np.ndarray
    moves: np.ndarray
    transforms: np.ndarray


class Triangle(NamedTuple):
    """Hessenberg matrix (m + 1, m) on its way to a triangle, Givens rotations (2, m) and right-hand side (m + 1,)."""

    hessenberg: np.ndarray
    givens: np.ndarray
    rhs: np.ndarray


@fast
def dot(a, b):
    """Return the scalar product of two vectors."""
    total = 0.0
    for i in range(a.size):
        total += a[i] * b[i]
    return total


@compiled
def _rotate(triangle, k):
    """Apply Givens rotations to column k; the last entry of the right-hand side becomes the residual's norm."""
    hessenberg, givens, rhs = triangle
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


@fast
def arnoldi(direction, product, mean, derivative, basis, k, triangle):
    """Extend the Krylov space by Newton's matrix times `direction` and return the norm of the residual.

    The matrix times a direction d is d - P'(d - rho B d) - turn M B d, made orthogonal to basis[: k + 1];
    `product` is B d and `mean` its `row_means` M B d.
    """
    projection, turn, rho = derivative.projection, derivative.turn, derivative.rho
    hessenberg = triangle.hessenberg
    ny, nx = projection.shape[1], projection.shape[2]
    v = basis[k + 1]
    for i in range(ny):
        for j in range(nx):
            bx, by = product[i, j, 0], product[i, j, 1]
            dx, dy = direction[i, j, 0], direction[i, j, 1]
            x, y = dx - rho * bx, dy - rho * by
            c, s = projection[NORMAL_X, i, j], projection[NORMAL_Y, i, j]
            along = projection[ALONG, i, j] * (c * x + s * y)
            across = projection[ACROSS, i, j] * (c * y - s * x)
            mx, my = mean[i, j, 0], mean[i, j, 1]
            place = 2 * (i * nx + j)
            v[place] = dx - c * along + s * across - turn[XX, i, j] * mx - turn[XY, i, j] * my
            v[place + 1] = dy - s * along - c * across - turn[YX, i, j] * mx - turn[YY, i, j] * my
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
    _rotate(triangle, k)
    return abs(triangle.rhs[k + 1])


@compiled
def combination(vectors, triangle, done, out):
    """Write the least-squares combination of vectors[: done] (m, n) into `out` (n,)."""
    hessenberg, rhs = triangle.hessenberg, triangle.rhs
    out[:] = 0.0
    for i in range(done - 1, -1, -1):
        for j in range(i + 1, done):
            rhs[i] -= hessenberg[i, j] * rhs[j]
        rhs[i] = rhs[i] / hessenberg[i, i] if hessenberg[i, i] != 0.0 else 0.0
        for j in range(out.size):
            out[j] += rhs[i] * vectors[i, j]


@compiled
def solve(value, derivative, columns, operator, tolerance, space, move):
    """Solve Newton's matrix against the residual `value` (ny, nx) by preconditioned GMRES; return the products.

    The solution and the slip that it causes go into `move` (2, ny, nx). `tolerance` limits the linear residual over
    the norm of `value`.
    """
    ny, nx = value.shape
    slips, first, count = columns
    groups = factorise(slips, derivative.projection, derivative.rho, first, count, space.systems)
    limit = space.moves.shape[0]
    triangle = Triangle(np.zeros((limit + 1, limit)), np.zeros((2, limit)), np.zeros(limit + 1))
    mean = np.zeros((ny, nx, 2))
    flat = reals(value).reshape(-1)
    norm = math.sqrt(dot(flat, flat))
    for j in range(flat.size):
        space.basis[0, j] = flat[j] / norm
    triangle.rhs[0] = norm
    done = 0
    for k in range(limit):
        traction, slip = space.moves[k, 0], space.moves[k, 1]
        apply_inverse(space.systems, groups, space.basis[k].reshape(ny, nx, 2), reals(traction))
        convolve(traction, operator.p, operator.q, space.transforms, slip)
        if derivative.falls:
            row_means(reals(slip), first, count, mean)
        rest = arnoldi(reals(traction), reals(slip), mean, derivative, space.basis, k, triangle)
        done = k + 1
        if rest <= tolerance * norm:
            break
    vectors = space.moves.reshape(limit, -1).view(np.float64)
    combination(vectors, triangle, done, move.reshape(-1).view(np.float64))
    return done
