"""Compiled integrals of the friction traction in full sliding, eq. (30), over elliptical patches.

The integrals are taken column by column. Across the rolling direction, x is split where the slip
field has a kink or a zero. Along it, the substitution y = y_delta + eps sinh(u) makes the kernel (y
- y_delta)/sqrt((y - y_delta)^2 + eps^2) smooth for every eps. Both directions use Gauss-Legendre
points clustered at the ends, where the pressure has a root. Under a friction law with few knots the
integrals are also split where the slip speed passes a knot.
"""

from __future__ import annotations

import math
from typing import Generic, NamedTuple, TypeVar

import numpy as np

from trackroller.contact.slip import (
    pole_lateral,
    pole_line,
    pole_offset,
    pole_rolling,
    rolling_slip,
    slip_zeros,
)
from trackroller.halfspace.vectors import exp
from trackroller.numerics.compiled import compiled, inner
from trackroller.numerics.knots import polyline

T = TypeVar("T", float, np.ndarray)  # one patch, or arrays over the patches
# keeps logarithms finite on the column through the pole; its weight there is of order eps^2
_TINY = 1e-13
FEW_KNOTS = 8  # laws with more knots are smooth enough for one rule


class SlidingEllipses(NamedTuple):
    """Sliding patches, arrays (n,), or one of them.

    a, b : semi-axes [mm]; sine, cosine : of the signed contact angle; radius : r_C,G [mm]; shift :
        r_Delta0 [mm];
    speed : angular speed omega [1/s].
    """

    a: np.ndarray
    b: np.ndarray
    sine: np.ndarray
    cosine: np.ndarray
    radius: np.ndarray
    shift: np.ndarray
    speed: np.ndarray


class Rule(NamedTuple):
    """Nodes and weights of a quadrature on (0, 1)."""

    nodes: np.ndarray
    weights: np.ndarray


class Sums(NamedTuple, Generic[T]):
    """F_T, F_A [mm^2], M_R [mm^3] and power [mm^3 times omega] over mu p_max, of one patch or
    arrays (n,).
    """

    lateral: T
    driving: T
    moment: T
    power: T


@compiled
def _insert(value, ends, count):
    """Insert `value` into the sorted first `count` of `ends`, if it lies between them; return the
    new number.
    """
    if not ends[0] < value < ends[count - 1]:
        return count
    j = count
    while ends[j - 1] > value:
        ends[j] = ends[j - 1]
        j -= 1
    ends[j] = value
    return count + 1


@compiled
def _slip_breaks(patch, shift, ends, count):
    """Insert the zeros of the rolling slip at another `shift` and its kink at the equator; return
    the new number.
    """
    for zero in slip_zeros(patch.sine, patch.cosine, patch.radius, shift):
        count = _insert(zero, ends, count)
    # beyond it the slip is constant
    equator = patch.radius * (1.0 - abs(patch.sine)) / patch.cosine
    return _insert(equator if patch.sine > 0 else -equator, ends, count)


@compiled
def _ends_across(patch, model, law, ends):
    """Write the sorted ends along x_C of the pieces with smooth slip and friction; return their
    number.
    """
    ends[0], ends[1], count = -patch.a, patch.a, 2
    if model == 2:
        count = _insert(pole_lateral(patch.shift, patch.sine), ends, count)
    count = _slip_breaks(patch, patch.shift, ends, count)
    if 1 < law.speed.size <= FEW_KNOTS:
        for k in range(law.speed.size):
            level = law.speed[k] / patch.speed
            count = _slip_breaks(patch, patch.shift + level, ends, count)
            count = _slip_breaks(patch, patch.shift - level, ends, count)
    return count


@compiled
def _ends_along(low, high, eps, unit, knots, ends):
    """Write the sorted ends of the pieces of (low, high) in u between which eps cosh(u) unit passes
    no knot.
    """
    ends[0], ends[1], count = low, high, 2
    if knots.size <= FEW_KNOTS:
        for k in range(knots.size):
            ratio = knots[k] / (unit * eps)
            if ratio > 1.0:
                u = math.acosh(ratio)
                count = _insert(u, ends, _insert(-u, ends, count))
    return count


@inner
def _column(d, eps, rule):
    """Integrate sqrt(1-t^2) times (t-d)/rho, t (t-d)/rho, eps/rho and rho over t in (-1, 1).

    rho^2 = (t - d)^2 + eps^2.
    """
    nodes, weights = rule.nodes, rule.weights
    eps = max(eps, _TINY)
    middle = d if abs(d) < 1.0 else 0.0
    phi = phi_t = psi = work = 0.0
    # far from the pole the substitution would cancel, and the kernel is smooth without it
    if eps > 30.0:
        for j in range(nodes.size):
            t = 2.0 * nodes[j] - 1.0
            rho = math.sqrt((t - d) * (t - d) + eps * eps)
            w = 2.0 * weights[j] * math.sqrt((1.0 - t) * (1.0 + t))
            phi += w * (t - d) / rho
            phi_t += w * (t - d) / rho * t
            psi += w * eps / rho
            work += w * rho
        return phi, phi_t, psi, work
    for side in range(2):
        low = math.asinh(((-1.0 if side == 0 else middle) - d) / eps)
        high = math.asinh(((middle if side == 0 else 1.0) - d) / eps)
        span = high - low
        if span <= 0.0:
            continue
        for j in range(nodes.size):
            q = exp(low + span * nodes[j])
            q_inverse = 1.0 / q
            half_rho = 0.5 * (q + q_inverse)
            offset = 0.5 * (q - q_inverse)
            t = d + eps * offset
            w = weights[j] * span * eps * math.sqrt(max((1.0 - t) * (1.0 + t), 0.0))
            phi += w * offset
            phi_t += w * offset * t
            psi += w  # eps/rho dt = eps du
            work += w * half_rho * half_rho * eps
    return phi, phi_t, psi, work


@compiled
def _law_column(d, eps, unit, law, rule, ends):
    """Integrate as `_column` with the law as a further factor, at the slip speed unit * rho."""
    eps = max(eps, _TINY)
    middle = d if abs(d) < 1.0 else 0.0
    phi = phi_t = psi = work = 0.0
    for side in range(2):
        low = math.asinh(((-1.0 if side == 0 else middle) - d) / eps)
        high = math.asinh(((middle if side == 0 else 1.0) - d) / eps)
        if high <= low:
            continue
        count = _ends_along(low, high, eps, unit, law.speed, ends)
        for piece in range(count - 1):
            span = ends[piece + 1] - ends[piece]
            for j in range(rule.nodes.size):
                u = ends[piece] + span * rule.nodes[j]
                offset, rho = math.sinh(u), math.cosh(u)
                t = d + eps * offset
                w = rule.weights[j] * span * eps * math.sqrt(max((1.0 - t) * (1.0 + t), 0.0))
                w *= polyline(unit * eps * rho, law.speed, law.factor)[0]
                phi += w * offset
                phi_t += w * offset * t
                psi += w
                work += w * rho * rho * eps
    return phi, phi_t, psi, work


@inner
def _one_patch(patch, model, law, rule):
    """Integrate eq. (30) over one patch."""
    a, sine = patch.a, patch.sine
    falls = law.speed.size > 1
    ends, along = np.empty(6 * FEW_KNOTS + 7), np.empty(2 * FEW_KNOTS + 2)
    count = _ends_across(patch, model, law, ends)
    x_spin = pole_lateral(patch.shift, sine)
    y_spin = pole_rolling(x_spin, a, patch.b)
    k0, k1, k2 = pole_line(a, x_spin, y_spin, model)
    sign = 1.0 if sine > 0 else -1.0
    f_t = f_a = m_r = power = 0.0
    for piece in range(count - 1):
        span = ends[piece + 1] - ends[piece]
        if span <= 0.0:
            continue
        for i in range(rule.nodes.size):
            x = ends[piece] + span * rule.nodes[i]
            square = (1.0 - x / a) * (1.0 + x / a)
            if square <= 0.0:
                continue
            half_width = patch.b * math.sqrt(square)
            g = rolling_slip(x, sine, patch.cosine, patch.radius, patch.shift)
            d, eps = pole_offset(x, a, k0, k1, k2) / half_width, abs(g / sine) / half_width
            if falls:
                unit = patch.speed * abs(sine) * half_width
                phi, phi_t, psi, work = _law_column(d, eps, unit, law, rule, along)
            else:
                phi, phi_t, psi, work = _column(d, eps, rule)
            w = rule.weights[i] * span * patch.b * square
            sign_g = 1.0 if g > 0 else -1.0
            f_t -= w * sign * phi
            f_a -= w * sign_g * psi
            m_r -= w * (x * sign_g * psi - sign * half_width * phi_t)
            power += w * abs(sine) * half_width * work
    return Sums(f_t, f_a, m_r, power)


@compiled
def integrate(first, last, patches, model, law, rule, out):
    """Write the integrals of the patches first..last into the arrays of `out`."""
    a, b, sine, cosine, radius, shift, speed = patches
    for i in range(first, last):
        one = SlidingEllipses(a[i], b[i], sine[i], cosine[i], radius[i], shift[i], speed[i])
        sums = _one_patch(one, model, law, rule)
        out.lateral[i], out.driving[i] = sums.lateral, sums.driving
        out.moment[i], out.power[i] = sums.moment, sums.power
