"""Stick and slip on a patch: a semi-smooth Newton method with Krylov steps.

For each element with traction bound g the law of dry friction is the fixed point tau = P_g(tau - rho s), where
P_g shortens a vector to at most g and s = w + B tau is the slip (Alart & Curnier 1991). Newton's method is the
active-set method of stick and slip elements; its linear systems are solved by GMRES with fast products B tau.
Friction that depends on the slip makes g a function of s, whose derivative belongs to Newton's matrix.

Fields are complex, x + iy, (ny, nx); compiled loops run over their real numbers, (ny, nx, 2).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit

from trackroller.contact.kalker_columns import apply_inverse, column_ranges, column_slips, factorise
from trackroller.contact.kalker_influence import FAST, Influence, differences, leading_rows
from trackroller.contact.knots import interval


@dataclass(frozen=True)
class Problem:
    """A patch: influence functions, rigid slip (ny, nx), traction bounds at rest `height` and the friction law.

    scale : slip speed [mm/s] per scaled slip; knots, factors : friction over its value at rest by slip speed
    rolling : B = -d/dy of the displacements; else the displacements themselves, for a shift from rest
    """

    influence: Influence
    rigid: np.ndarray
    height: np.ndarray
    scale: float
    knots: np.ndarray
    factors: np.ndarray
    rolling: bool = True


def reals(field: np.ndarray) -> np.ndarray:
    """View of a complex field (ny, nx) as (ny, nx, 2)."""
    return field.view(float).reshape(*field.shape, 2)


@njit(cache=True, nogil=True)
def law_of_slip(slip, height, scale, knots, factors, bound, slope):
    """Traction bound height f(scale |s|) and its derivative with respect to |s|; f linear between its knots."""
    last = knots.size - 1
    for i in range(height.shape[0]):
        for j in range(height.shape[1]):
            speed = scale * math.hypot(slip[i, j, 0], slip[i, j, 1])
            slope[i, j] = 0.0
            if last == 0 or speed <= knots[0]:
                bound[i, j] = height[i, j] * factors[0]
            elif speed >= knots[last]:
                bound[i, j] = height[i, j] * factors[last]
            else:
                low = interval(speed, knots, 0, last)
                steep = (factors[low + 1] - factors[low]) / (knots[low + 1] - knots[low])
                bound[i, j] = height[i, j] * (factors[low] + steep * (speed - knots[low]))
                slope[i, j] = height[i, j] * steep * scale


@njit(cache=True, fastmath=FAST, nogil=True)
def residual(traction, slip, bound, rho, out):
    """F = tau - P_g(tau - rho s) into `out`; returns its largest component [scaled as tau] and its norm."""
    largest, square = 0.0, 0.0
    for i in range(bound.shape[0]):
        for j in range(bound.shape[1]):
            g = bound[i, j]
            zx = traction[i, j, 0] - rho * slip[i, j, 0]
            zy = traction[i, j, 1] - rho * slip[i, j, 1]
            z = math.sqrt(zx * zx + zy * zy)
            if z > g:
                factor = g / z
                zx *= factor
                zy *= factor
            fx, fy = traction[i, j, 0] - zx, traction[i, j, 1] - zy
            out[i, j, 0], out[i, j, 1] = fx, fy
            largest = max(largest, abs(fx), abs(fy))
            square += fx * fx + fy * fy
    return largest, math.sqrt(square)


@njit(cache=True, fastmath=FAST, nogil=True)
def jacobian(traction, slip, bound, slope, rho, derivative, turn):
    """Derivative of P_g at z = tau - rho s: xx, xy, yy into `derivative` (3, ny, nx).

    And n (dg/d|s|) s/|s| of sliding elements, n the direction of z, into `turn` (4, ny, nx: xx, xy, yx, yy).
    """
    for i in range(bound.shape[0]):
        for j in range(bound.shape[1]):
            g = bound[i, j]
            sx, sy = slip[i, j, 0], slip[i, j, 1]
            zx, zy = traction[i, j, 0] - rho * sx, traction[i, j, 1] - rho * sy
            square = zx * zx + zy * zy
            steep = 0.0
            if square <= g * g:
                inside = 1.0 if g > 0.0 else 0.0
                derivative[0, i, j], derivative[1, i, j], derivative[2, i, j] = inside, 0.0, inside
            else:
                z = math.sqrt(square)
                factor = g / (z * square)
                derivative[0, i, j] = factor * zy * zy
                derivative[1, i, j] = -factor * zx * zy
                derivative[2, i, j] = factor * zx * zx
                speed = math.hypot(sx, sy)
                steep = slope[i, j] / (z * speed) if speed > 0.0 else 0.0
            turn[0, i, j], turn[1, i, j] = steep * zx * sx, steep * zx * sy
            turn[2, i, j], turn[3, i, j] = steep * zy * sx, steep * zy * sy


@njit(cache=True, fastmath=FAST)
def _dot(a, b):
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
def arnoldi(direction, product, derivative, turn, rho, basis, k, hessenberg, givens, rhs):
    """Newton's matrix times `direction`, d - P'(d - rho B d) - turn B d, made orthogonal to basis[: k + 1].

    `product` is B d. Returns the norm of the residual with this much of the Krylov space.
    """
    ny, nx = derivative.shape[1], derivative.shape[2]
    v = basis[k + 1]
    for i in range(ny):
        for j in range(nx):
            bx, by = product[i, j, 0], product[i, j, 1]
            dx, dy = direction[i, j, 0], direction[i, j, 1]
            x, y = dx - rho * bx, dy - rho * by
            pxx, pxy, pyy = derivative[0, i, j], derivative[1, i, j], derivative[2, i, j]
            place = 2 * (i * nx + j)
            v[place] = dx - pxx * x - pxy * y - turn[0, i, j] * bx - turn[1, i, j] * by
            v[place + 1] = dy - pxy * x - pyy * y - turn[2, i, j] * bx - turn[3, i, j] * by
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


class _Newton:
    """Work space and steps of Newton's method for one patch."""

    def __init__(self, problem: Problem, krylov: int) -> None:
        ny, nx = problem.height.shape
        functions = problem.influence
        self.problem, self.rho = problem, 1.0 / (functions.own if problem.rolling else functions.own_displacement)
        self.leading = leading_rows(problem.height)
        self.first, self.count = column_ranges(problem.height)
        if problem.rolling:
            self.slips = column_slips(functions.column, functions.hy)
        else:
            self.slips = np.ascontiguousarray(np.repeat(functions.column[:, None, 1:-2], 2, axis=1))
        self.factors = np.empty((nx, 2, ny, ny))
        self.basis = np.empty((krylov + 1, 2 * ny * nx))
        self.derivative, self.turn = np.empty((3, ny, nx)), np.empty((4, ny, nx))
        self.bound, self.slope = np.empty((ny, nx)), np.zeros((ny, nx))
        self.value, self.field, self.product = (np.empty((ny, nx), complex) for _ in range(3))

    def multiply(self, field: np.ndarray) -> np.ndarray:
        """B `field` into the kept array."""
        halo = self.problem.influence.displacements(field)
        if self.problem.rolling:
            differences(halo, self.leading, self.problem.influence.hy, self.product)
        else:
            self.product[:] = halo[1 : 1 + field.shape[0]]
        return self.product

    def residual(self, traction: np.ndarray, slip: np.ndarray) -> tuple[float, float]:
        """Largest component and norm of the friction law's residual, which is kept."""
        p = self.problem
        law_of_slip(reals(slip), p.height, p.scale, p.knots, p.factors, self.bound, self.slope)
        return residual(reals(traction), reals(slip), self.bound, self.rho, reals(self.value))

    def step(self, traction: np.ndarray, slip: np.ndarray, tolerance: float) -> tuple[np.ndarray, int]:
        """Newton's step against the kept residual by preconditioned GMRES, and the products it took."""
        jacobian(reals(traction), reals(slip), self.bound, self.slope, self.rho, self.derivative, self.turn)
        factorise(self.slips, self.derivative, self.rho, self.first, self.count, self.factors)
        steps = self.basis.shape[0] - 1
        hessenberg, givens, rhs = np.zeros((steps + 1, steps)), np.zeros((2, steps)), np.zeros(steps + 1)
        flat = self.value.reshape(-1).view(float)
        norm = math.sqrt(_dot(flat, flat))
        np.divide(flat, norm, out=self.basis[0])
        rhs[0] = norm
        done = 0
        for k in range(steps):
            apply_inverse(self.factors, self.first, self.count, self.basis[k].reshape(*self.value.shape, 2),
                          reals(self.field))  # fmt: skip
            product = self.multiply(self.field)
            rest = arnoldi(reals(self.field), reals(product), self.derivative, self.turn, self.rho, self.basis, k,
                           hessenberg, givens, rhs)  # fmt: skip
            done = k + 1
            if rest <= tolerance * norm:
                break
        combination(self.basis, hessenberg, rhs, done, flat)
        out = np.empty_like(self.field)
        apply_inverse(self.factors, self.first, self.count, reals(self.value), reals(out))
        return out, done


def newton(problem: Problem, traction: np.ndarray, tolerance: float, limit: int, krylov: int):
    """Tractions (ny, nx) of the friction law, from the start `traction`.

    Returns tractions, slips, traction bounds at these slips, the residual (largest component of the law's residual),
    Newton steps and products. Steps are halved until the residual's norm falls (at most four times).
    """
    work = _Newton(problem, krylov)
    slip = problem.rigid + work.multiply(traction)
    largest, norm = work.residual(traction, slip)
    products, iteration = 1, 0
    while largest > tolerance and iteration < limit:
        iteration += 1
        # far from the solution the step is rough anyway; near it the last ones converge quadratically
        inner = max(0.3 * tolerance / largest, min(0.03, 0.1 * largest))
        step, used = work.step(traction, slip, inner)
        change = work.multiply(step)
        products += used + 1
        length = 1.0
        while True:
            new_traction, new_slip = traction - length * step, slip - length * change
            largest, new_norm = work.residual(new_traction, new_slip)
            if new_norm < (1.0 - 0.1 * length) * norm or length < 0.05 or math.isnan(new_norm):
                break
            length *= 0.5
        traction, slip, norm = new_traction, new_slip, new_norm
    return traction, slip, work.bound, largest, iteration, products
