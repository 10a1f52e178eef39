"""Full sliding with friction that depends on the local slip speed: tau = -mu f(|v|) p v/|v|.

The same columns and substitution as `contact.sliding`; along a column the integral is also split where the slip speed
passes a knot of the law, if these are few.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit

from trackroller.contact.common import Ellipse, Resultants, Slip
from trackroller.contact.friction_laws import FrictionLaw
from trackroller.contact.sliding import (
    _TINY,
    _breakpoints,
    pole_offset,
    rolling_slip,
    spin_model_index,
)
from trackroller.numerics.knots import interval
from trackroller.numerics.quadrature import clustered_rule
from trackroller.numerics.threads import share_rows

FEW_KNOTS = 8  # laws with more are smooth enough for one rule


@njit(cache=True)
def factor_at(speed, knots, factors):
    """Law of friction at a slip speed, linear between its knots and constant beyond them."""
    last = knots.size - 1
    if speed <= knots[0]:
        return factors[0]
    if speed >= knots[last]:
        return factors[last]
    low = interval(speed, knots, 0, last)
    t = (speed - knots[low]) / (knots[low + 1] - knots[low])
    return (1.0 - t) * factors[low] + t * factors[low + 1]


@njit(cache=True)
def _insert(value, ends, count):
    """`value` into the sorted first `count` of `ends`, between its first and last; returns the new number."""
    if not ends[0] < value < ends[count - 1]:
        return count
    j = count
    while ends[j - 1] > value:
        ends[j] = ends[j - 1]
        j -= 1
    ends[j] = value
    return count + 1


@njit(cache=True)
def _ends_along(low, high, eps, unit, knots, ends):
    """Sorted ends of the pieces of (low, high) in u between which eps cosh(u) unit passes no knot."""
    ends[0], ends[1], count = low, high, 2
    if knots.size <= FEW_KNOTS:
        for k in range(knots.size):
            ratio = knots[k] / (unit * eps)
            if ratio > 1.0:
                u = math.acosh(ratio)
                count = _insert(u, ends, _insert(-u, ends, count))
    return count


@njit(cache=True)
def _column(d, eps, unit, knots, factors, nodes, weights, ends, out):
    """Integrals over t in (-1, 1) of sqrt(1-t^2) f times (t-d)/rho, t (t-d)/rho, eps/rho and rho into `out`.

    rho^2 = (t - d)^2 + eps^2; the law f is taken at the slip speed unit * rho.
    """
    eps = max(eps, _TINY)
    middle = d if abs(d) < 1.0 else 0.0
    out[:] = 0.0
    for side in range(2):
        low = math.asinh(((-1.0 if side == 0 else middle) - d) / eps)
        high = math.asinh(((middle if side == 0 else 1.0) - d) / eps)
        if high <= low:
            continue
        count = _ends_along(low, high, eps, unit, knots, ends)
        for piece in range(count - 1):
            span = ends[piece + 1] - ends[piece]
            for j in range(nodes.size):
                u = ends[piece] + span * nodes[j]
                offset, rho = math.sinh(u), math.cosh(u)
                t = d + eps * offset
                w = weights[j] * span * eps * math.sqrt(max((1.0 - t) * (1.0 + t), 0.0))
                w *= factor_at(unit * eps * rho, knots, factors)
                out[0] += w * offset
                out[1] += w * offset * t
                out[2] += w
                out[3] += w * rho * rho * eps


@njit(cache=True)
def _ends_across(a, sine, cosine, radius, shift, speed, model, knots, ends):
    """Sorted ends along x_C of the pieces between which the slip field and the law at |v_y| are smooth."""
    count = _breakpoints(a, sine, cosine, radius, shift, model, ends)
    if knots.size > FEW_KNOTS:
        return count
    work = np.empty(7)
    for k in range(knots.size):
        for level in (-knots[k] / speed, knots[k] / speed):
            found = _breakpoints(a, sine, cosine, radius, shift - level, 0, work)
            for i in range(1, found - 1):
                count = _insert(work[i], ends, count)
    return count


@njit(cache=True)
def _one_patch(a, b, sine, cosine, radius, shift, speed, model, knots, factors, nodes, weights, total):
    """F_T, F_A, M_R and power over mu p_max into `total`; `speed` is the angular speed omega [1/s]."""
    ends, along, sums = np.empty(6 * FEW_KNOTS + 7), np.empty(2 * FEW_KNOTS + 2), np.empty(4)
    count = _ends_across(a, sine, cosine, radius, shift, speed, model, knots, ends)
    pole_x = shift / sine
    pole_y = -b * math.sqrt(1.0 - (pole_x / a) ** 2) if abs(pole_x) < a else 0.0
    sign = 1.0 if sine > 0 else -1.0
    total[:] = 0.0
    for piece in range(count - 1):
        span = ends[piece + 1] - ends[piece]
        if span <= 0.0:
            continue
        for i in range(nodes.size):
            x = ends[piece] + span * nodes[i]
            square = (1.0 - x / a) * (1.0 + x / a)
            if square <= 0.0:
                continue
            half_width = b * math.sqrt(square)
            g = rolling_slip(x, sine, cosine, radius, shift)
            d = pole_offset(x, pole_x, pole_y, a, model) / half_width
            unit = speed * abs(sine) * half_width
            _column(d, abs(g / sine) / half_width, unit, knots, factors, nodes, weights, along, sums)
            w = weights[i] * span * b * square
            sign_g = 1.0 if g > 0 else -1.0
            total[0] -= w * sign * sums[0]
            total[1] -= w * sign_g * sums[2]
            total[2] -= w * (x * sign_g * sums[2] - sign * half_width * sums[1])
            total[3] += w * abs(sine) * half_width * sums[3]


@njit(cache=True, nogil=True)
def _all_patches(
    first, last, a, b, scale, sine, cosine, radius, shift, speed, model, knots, factors, nodes, weights, out
):
    for i in range(first, last):
        _one_patch(
            a[i], b[i], sine[i], cosine[i], radius[i], shift[i], speed[i], model, knots, factors, nodes, weights, out[i]
        )
        for k in range(4):
            out[i, k] *= scale[i]


def integrals(
    ellipse: Ellipse,
    slip: Slip,
    friction: np.ndarray,
    law: FrictionLaw,
    travel_speed,
    *,
    spin_model: str = "skewed",
    nodes: int = 16,
) -> tuple[Resultants, np.ndarray]:
    """Resultants on the roller [N, N, N mm] and dissipation per angular speed omega [N mm per rad], shape (n,).

    Parameters
    ----------
    ellipse, slip, friction : patches and friction coefficient at rest [1], arrays (n,)
    law : friction over its value at rest as a function of the slip speed [mm/s]
    travel_speed : omega r_A [mm/s], (n,) or scalar; turns the rigid slip into a speed
    spin_model, nodes : as in `sliding.resultants`

    Relative error at 12 nodes: about 1e-5 for smooth laws and those of few knots (tests/test_friction_laws.py).
    """
    n = np.size(friction)
    out = np.empty((n, 4))
    given = (
        ellipse.semi_axis_lateral,
        ellipse.semi_axis_rolling,
        friction * ellipse.max_pressure,
        slip.sine,
        slip.cosine,
        slip.guide_profile_radius,
        slip.shift,
        travel_speed / slip.rolling_radius,
    )
    columns = [np.array(np.broadcast_to(c, (n,)), dtype=float, order="C") for c in given]
    arguments: Any = (*columns, spin_model_index(spin_model), law.speed, law.factor, *clustered_rule(nodes), out)
    share_rows(lambda first, last: _all_patches(first, last, *arguments), n, 32)
    return Resultants(out[:, 0], out[:, 1], out[:, 2]), out[:, 3]
