"""Full sliding with an empirical spin pole: the model of Wenzel et al. 2022, eqs (21)-(30).

The friction traction opposes the rigid slip everywhere, tau = -mu p v/|v|. The integrals over the patch are
taken column by column: across the rolling direction with x split where the slip field has a kink or a zero,
along it with the substitution y = y_0 + eps sinh(u), which makes the kernel (y - y_0)/sqrt((y - y_0)^2 + eps^2)
smooth whatever eps. Both use Gauss-Legendre points clustered at the ends, where the pressure has a root.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit

from trackroller.contact.common import Elastic, Ellipse, Resultants, Slip, SurfaceTractions
from trackroller.contact.friction_laws import FrictionLaw
from trackroller.errors import unknown_name
from trackroller.halfspace.vectors import exp, inner
from trackroller.numerics.quadrature import clustered_rule
from trackroller.numerics.threads import share_rows
from trackroller.parameters import SPIN_MODELS

_TINY = 1e-13  # keeps logarithms finite on the column through the pole; its weight there is of order eps^2


def spin_model_index(name: str) -> int:
    """0, 1, 2 for the paper's assumptions `concentric`, `edge`, `skewed`."""
    if name not in SPIN_MODELS:
        raise unknown_name("spin_model", name, SPIN_MODELS)
    return SPIN_MODELS.index(name)


@njit(cache=True)
def rolling_slip(x, sine, cosine, radius, shift):
    """v_y / omega [mm] at lateral position x, eq. (21) with its misprint mended."""
    rest = radius * radius * cosine * cosine - x * cosine * (2.0 * radius * sine + x * cosine)
    root = math.sqrt(max(rest, 0.0))
    if rest < 0.0:  # beyond the equator of the guide contour: ASSUME the slip stays that of the equator
        return shift - radius * cosine
    return shift - x * cosine * (2.0 * radius * sine + x * cosine) / (root + radius * cosine)


@inner
def pole_offset(x, pole_x, pole_y, a, model):
    """y_C where v_x vanishes at lateral position x [mm], eqs (22) and (25)."""
    if model == 0 or abs(pole_x) >= a:
        return 0.0
    if model == 1:
        return pole_y
    if x < pole_x:
        return pole_y * (x + a) / (pole_x + a)
    return pole_y * (x - a) / (pole_x - a)


@inner
def _breakpoints(a, sine, cosine, radius, shift, model, out):
    """Sorted ends of the smooth pieces of the slip field along x_C, in `out`; returns their number."""
    out[0], count = -a, 1
    pole_x = shift / sine
    if model == 2 and abs(pole_x) < a:
        out[count] = pole_x
        count += 1
    product = 2.0 * radius * cosine * shift - shift * shift
    square = radius * radius * sine * sine + product
    if square >= 0.0 and radius * cosine >= shift:
        root = math.sqrt(square)
        sign = 1.0 if sine > 0 else -1.0
        near = sign * product / (root + radius * abs(sine)) / cosine
        far = -sign * (root + radius * abs(sine)) / cosine
        for zero in (near, far):
            if abs(zero) < a:
                out[count] = zero
                count += 1
    equator = radius * (1.0 - abs(sine)) / cosine  # there the slip has a root, beyond it is constant
    if equator < a:
        out[count] = equator if sine > 0 else -equator
        count += 1
    for i in range(2, count):  # by insertion: at most four, and cheaper to compile than a library sort
        j = i
        while j > 1 and out[j - 1] > out[j]:
            out[j - 1], out[j] = out[j], out[j - 1]
            j -= 1
    out[count] = a
    return count + 1


@inner
def _column(d, eps, nodes, weights):
    """Integrals over t in (-1, 1) of sqrt(1-t^2) times (t-d)/rho, t (t-d)/rho, eps/rho and rho.

    rho^2 = (t - d)^2 + eps^2.
    """
    eps = max(eps, _TINY)
    middle = d if abs(d) < 1.0 else 0.0
    phi = phi_t = psi = work = 0.0
    if eps > 30.0:  # far from the pole the substitution would cancel, and the kernel is smooth as it stands
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


@inner
def _one_patch(a, b, sine, cosine, radius, shift, model, nodes, weights):
    """F_T, F_A, M_R and power over mu p_max [mm^2, mm^2, mm^3, mm^3 times omega] of one patch."""
    ends = np.empty(7)
    count = _breakpoints(a, sine, cosine, radius, shift, model, ends)
    pole_x = shift / sine
    inside = abs(pole_x) < a
    pole_y = -b * math.sqrt(1.0 - (pole_x / a) ** 2) if inside else 0.0
    sign = 1.0 if sine > 0 else -1.0
    f_t = f_a = m_r = power = 0.0
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
            phi, phi_t, psi, work = _column(d, abs(g / sine) / half_width, nodes, weights)
            w = weights[i] * span * b * square
            sign_g = 1.0 if g > 0 else -1.0
            f_t -= w * sign * phi
            f_a -= w * sign_g * psi
            m_r -= w * (x * sign_g * psi - sign * half_width * phi_t)
            power += w * abs(sine) * half_width * work
    return f_t, f_a, m_r, power


@njit(cache=True, nogil=True)
def _all_patches(first, last, a, b, scale, sine, cosine, radius, shift, model, nodes, weights, out):
    for i in range(first, last):
        f_t, f_a, m_r, power = _one_patch(a[i], b[i], sine[i], cosine[i], radius[i], shift[i], model, nodes, weights)
        out[0, i] = scale[i] * f_t
        out[1, i] = scale[i] * f_a
        out[2, i] = scale[i] * m_r
        out[3, i] = scale[i] * power


def _integrals(ellipse: Ellipse, slip: Slip, friction: np.ndarray, spin_model: str, nodes: int) -> np.ndarray:
    n = np.size(friction)
    out = np.empty((4, n))
    given = (
        ellipse.semi_axis_lateral,
        ellipse.semi_axis_rolling,
        friction * ellipse.max_pressure,
        slip.sine,
        slip.cosine,
        slip.guide_profile_radius,
        slip.shift,
    )
    columns = [np.ascontiguousarray(np.broadcast_to(c, (n,)), dtype=float) for c in given]
    arguments: Any = (*columns, spin_model_index(spin_model), *clustered_rule(nodes), out)
    share_rows(lambda first, last: _all_patches(first, last, *arguments), n, 64)
    return out


def resultants(
    ellipse: Ellipse,
    slip: Slip,
    friction: np.ndarray,
    elastic: Elastic | None = None,
    *,
    spin_model: str = "skewed",
    nodes: int = 16,
) -> Resultants:
    """Friction forces and spin moment on the roller in full sliding, eq. (30) integrated.

    Parameters
    ----------
    ellipse, slip : patches, arrays of shape (n,)
    friction : coefficient mu [1], shape (n,)
    elastic : not used; full sliding does not feel the elasticity
    spin_model : 'concentric' | 'edge' | 'skewed' (the paper's assumptions 0, 1, 2)
    nodes : Gauss points per smooth piece

    Returns
    -------
    F_T = int tau_x, F_A = int tau_y [N], M_R = int (x tau_y - y tau_x) [N mm], shape (n,)

    Relative error against adaptive quadrature: about 1e-4 at 6 nodes, 1e-8 at 16 (tests/test_sliding.py).
    """
    return Resultants(*_integrals(ellipse, slip, friction, spin_model, nodes)[:3])


def friction_power(ellipse: Ellipse, slip: Slip, friction: np.ndarray, *, spin_model: str = "skewed", nodes: int = 16):
    """Dissipation int |tau| |v| over the patch per angular speed omega [N mm per rad], shape (n,).

    The local product of the published model; with its empirical spin pole it need not equal the work done by the
    drive and tilting forces.
    """
    return _integrals(ellipse, slip, friction, spin_model, nodes)[3]


@njit(cache=True)
def shear_directions(a, b, sine, cosine, radius, shift, model, x, y, slip_x, slip_y):
    """Rigid slip v/omega [mm] at points (x, y) [mm] of each patch; arrays (n,), (n, m) -> slip_x, slip_y."""
    for i in range(a.size):
        pole_x = shift[i] / sine[i]
        inside = abs(pole_x) < a[i]
        pole_y = -b[i] * math.sqrt(1.0 - (pole_x / a[i]) ** 2) if inside else 0.0
        for j in range(x.shape[1]):
            offset = pole_offset(x[i, j], pole_x, pole_y, a[i], model)
            slip_x[i, j] = sine[i] * (y[i, j] - offset)
            slip_y[i, j] = rolling_slip(x[i, j], sine[i], cosine[i], radius[i], shift[i])


def slip_field(ellipse: Ellipse, slip: Slip, x: np.ndarray, y: np.ndarray, spin_model: str = "skewed"):
    """Slip of the roller against the guide per travel speed omega r_A [1] at points x, y (n, m) [mm]."""
    slip_x, slip_y = np.empty(x.shape), np.empty(x.shape)
    shear_directions(
        ellipse.semi_axis_lateral,
        ellipse.semi_axis_rolling,
        slip.sine,
        slip.cosine,
        slip.guide_profile_radius,
        slip.shift,
        spin_model_index(spin_model),
        np.ascontiguousarray(x),
        np.ascontiguousarray(y),
        slip_x,
        slip_y,
    )
    r_a = slip.rolling_radius[:, None]
    return slip_x / r_a, slip_y / r_a


def tractions(
    ellipse: Ellipse,
    slip: Slip,
    friction: np.ndarray,
    elastic: Elastic | None = None,
    *,
    spin_model: str = "skewed",
    points: int = 41,
    law: FrictionLaw | None = None,
    travel_speed=1.0,
) -> SurfaceTractions:
    """Pressure, shear and slip on a grid of `points` x `points` over each patch; 0 outside the ellipse.

    Under a `law` that depends on the slip speed, at `travel_speed` [mm/s], (n,) or scalar, the points are the centres
    of as many elements.
    """
    unit = np.linspace(-1.0, 1.0, points)
    if law is not None:
        unit = (2.0 * np.arange(points) + 1.0) / points - 1.0
    x = ellipse.semi_axis_lateral[:, None] * unit
    y = ellipse.semi_axis_rolling[:, None] * unit
    n = len(x)
    root = np.sqrt(np.maximum(1.0 - unit[None, :] ** 2 - unit[:, None] ** 2, 0.0))
    pressure = ellipse.max_pressure[:, None, None] * root
    x_all = np.broadcast_to(x[:, None, :], pressure.shape).reshape(n, points * points)
    y_all = np.broadcast_to(y[:, :, None], pressure.shape).reshape(n, points * points)
    slip_x, slip_y = (v.reshape(pressure.shape) for v in slip_field(ellipse, slip, x_all, y_all, spin_model))
    speed = np.hypot(slip_x, slip_y)
    bound = friction[:, None, None] * pressure / np.where(speed > 0, speed, np.inf)
    if law is not None:
        bound = bound * law(speed * np.broadcast_to(travel_speed, (n,))[:, None, None])
    inside = root > 0
    return SurfaceTractions(
        x,
        y,
        pressure,
        -bound * slip_x,
        -bound * slip_y,
        np.where(inside, slip_x, 0.0),
        np.where(inside, slip_y, 0.0),
        np.zeros(pressure.shape, bool),
    )


def tractions_full_slip(ellipse: Ellipse, friction: np.ndarray, direction: np.ndarray) -> Resultants:
    """Resultants of tau_y = direction mu p everywhere (direction = -sign(F_Motor)), shape (n,)."""
    zero = np.zeros_like(friction)
    return Resultants(zero, direction * friction * ellipse.normal_force, zero)
