"""Compiled loops of Newton's method for adhesion and slip over fields (ny, nx, 2); see
`kalker.newton`.
"""

from __future__ import annotations

import math

import numpy as np

from trackroller.numerics.compiled import assign, compiled, fast
from trackroller.numerics.knots import polyline

ALONG, ACROSS, NORMAL_X, NORMAL_Y = range(4)  # of the derivative that `jacobian` writes
XX, XY, YX, YY = range(4)  # of the `turn` that `jacobian` writes


@compiled
def reals(field):
    """Return a view of a complex field (ny, nx) as real numbers (ny, nx, 2)."""
    return field.view(np.float64).reshape(field.shape[0], field.shape[1], 2)


@compiled
def row_means(field, first, count, out):
    """Average each element (weight 1/2) with its neighbours in the rolling direction (1/4) within
    the patch.
    """
    assign(out, field)
    for j in range(count.size):
        low, high = first[j], first[j] + count[j] - 1
        for i in range(low, high + 1):
            behind, ahead = max(i - 1, low), min(i + 1, high)
            for c in range(2):
                out[i, j, c] = 0.5 * field[i, j, c] + 0.25 * (
                    field[behind, j, c] + field[ahead, j, c]
                )


@compiled
def law_of_slip(slip, height, scale, knots, factors, bound, slope):
    """Compute the traction bound, height f(scale |s|), and its derivative with respect to |s|.

    The friction law f is linear between its knots. `slip` is the result of `row_means`. If friction
    fell with the slip of each single element, the slips of neighbouring elements would oscillate
    against each other, because differences of displacements react most strongly to such
    oscillations. The average keeps the second order in the element size.
    """
    for i in range(height.shape[0]):
        for j in range(height.shape[1]):
            factor, steep = polyline(
                scale * math.hypot(slip[i, j, 0], slip[i, j, 1]), knots, factors
            )
            bound[i, j] = height[i, j] * factor
            slope[i, j] = height[i, j] * steep * scale


@fast
def residual(traction, slip, bound, rho, out):
    """Write F = tau - P_g(tau - rho s) into `out`; return its largest component (scaled as tau) and
    its norm.
    """
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


@fast
def jacobian(traction, slip, mean, bound, slope, rho, derivative, turn):
    """Write the derivative of P_g at z = tau - rho s into `derivative` (4, ny, nx).

    `ALONG` and `ACROSS` hold the derivatives along z and across z: 1 and 1 where an element sticks,
    0 and g/|z| where it slides, 0 and 0 without load. `NORMAL_X` and `NORMAL_Y` hold the direction
    n of z. Write n (dg/d|m|) m/|m| of the sliding elements into `turn` (4, ny, nx). Here m is the
    `row_means` of the slip.
    """
    for i in range(bound.shape[0]):
        for j in range(bound.shape[1]):
            g = bound[i, j]
            sx, sy = slip[i, j, 0], slip[i, j, 1]
            zx, zy = traction[i, j, 0] - rho * sx, traction[i, j, 1] - rho * sy
            square = zx * zx + zy * zy
            steep = 0.0
            z = math.sqrt(square)
            c, s = (zx / z, zy / z) if z > 0.0 else (1.0, 0.0)
            derivative[NORMAL_X, i, j], derivative[NORMAL_Y, i, j] = c, s
            if square <= g * g:
                derivative[ALONG, i, j] = derivative[ACROSS, i, j] = 1.0 if g > 0.0 else 0.0
            else:
                derivative[ALONG, i, j], derivative[ACROSS, i, j] = 0.0, g / z
                sx, sy = mean[i, j, 0], mean[i, j, 1]
                speed = math.sqrt(sx * sx + sy * sy)
                steep = slope[i, j] / (z * speed) if speed > 0.0 else 0.0
            turn[XX, i, j], turn[XY, i, j] = steep * zx * sx, steep * zx * sy
            turn[YX, i, j], turn[YY, i, j] = steep * zy * sx, steep * zy * sy


@compiled
def find_slits(traction, slip, bound, rho, held):
    """Mark sliding elements in lateral gaps of one or two between sticking ones in `held`; return
    their number.
    """
    ny, nx = bound.shape
    sticks = np.zeros(nx + 4, np.bool_)  # element j at j + 2
    count = 0
    for i in range(ny):
        for j in range(nx):
            zx, zy = (
                traction[i, j, 0] - rho * slip[i, j, 0],
                traction[i, j, 1] - rho * slip[i, j, 1],
            )
            sticks[j + 2] = bound[i, j] > 0.0 and zx * zx + zy * zy <= bound[i, j] ** 2
        for j in range(nx):
            left, far_left, right, far_right = (
                sticks[j + 1],
                sticks[j],
                sticks[j + 3],
                sticks[j + 4],
            )
            between = (left and (right or far_right)) or (far_left and right)
            held[i, j] = between and bound[i, j] > 0.0 and not sticks[j + 2]
            count += held[i, j]
    return count


@compiled
def hold(held, slip, rho, value, derivative, turn):
    """Set the residual and the derivative of the `held` elements as if they stuck."""
    for i in range(held.shape[0]):
        for j in range(held.shape[1]):
            if held[i, j]:
                value[i, j, 0], value[i, j, 1] = rho * slip[i, j, 0], rho * slip[i, j, 1]
                derivative[ALONG, i, j] = derivative[ACROSS, i, j] = 1.0
                for k in range(4):
                    turn[k, i, j] = 0.0
