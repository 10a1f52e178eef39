"""Stress in the half-space under a sliding Hertzian ellipse, exact up to the surface.

The traction on the body is p = p_max sqrt(1 - rho^2) along z and q = mu p d(x, y) with a unit direction d. At a
point the direction is split into its value d_0 there and the rest:

- the parts p and mu p d_0 are Hertzian, so their stresses are a single integral over plane waves,
  sigma = 1/(2 pi^2) Re int_0^pi [A G(zeta) - i lambda z B G'(zeta)] dphi, zeta = X cos(phi) + Y sin(phi) + i lambda z,
  G = pi (2 + zeta ln((zeta - 1)/(zeta + 1))), lambda^2 = (cos(phi)/a)^2 + (sin(phi)/b)^2, where A + B k z are the
  transforms of the Boussinesq-Cerruti potentials (eqs (1)-(5); `potentials.plane_wave_stress`);
- the rest, mu p (d - d_0), vanishes at the point: its Cerruti integral in polar coordinates about the point has no
  singularity at any depth, z = 0 and the edge of the patch included.

Stresses come as value + nu * slope, for pressure and friction apart, so one evaluation serves both bodies.
Order of components: xx, yy, zz, xy, yz, zx. x, y, z, a, b in mm; stresses per unit p_max.
"""

from __future__ import annotations

import cmath
import math

import numpy as np
from numba import njit, prange

from trackroller.contact.sliding import clustered_rule, pole_offset, rolling_slip

PRESSURE, PRESSURE_NU, SHEAR, SHEAR_NU = range(4)  # rows of the result
COMPONENTS = ("xx", "yy", "zz", "xy", "yz", "zx")

# columns of the array that describes a patch
A, B, FRICTION, SINE, COSINE, RADIUS, SHIFT, MODEL, FIXED = range(9)


@njit(cache=True, inline="always")
def _direction(patch, x, y):
    """Unit direction of the friction traction on the roller at (x, y); (0, 0) at the pole."""
    if patch[FIXED] != 0.0:  # full slip along y_C
        return 0.0, patch[FIXED]
    a, b = patch[A], patch[B]
    pole_x = patch[SHIFT] / patch[SINE]
    pole_y = -b * math.sqrt(1.0 - (pole_x / a) ** 2) if abs(pole_x) < a else 0.0
    v_x = patch[SINE] * (y - pole_offset(x, pole_x, pole_y, a, patch[MODEL]))
    v_y = rolling_slip(x, patch[SINE], patch[COSINE], patch[RADIUS], patch[SHIFT])
    speed = math.sqrt(v_x * v_x + v_y * v_y)
    if speed == 0.0:
        return 0.0, 0.0
    return -v_x / speed, -v_y / speed


@njit(cache=True, inline="always")
def _rotate(out, row, c, s, ee, tt, zz, et, ez, tz):
    """Adds a tensor given along e = (c, s), t = (-s, c), z."""
    out[row, 0] += c * c * ee + s * s * tt - 2.0 * c * s * et
    out[row, 1] += s * s * ee + c * c * tt + 2.0 * c * s * et
    out[row, 2] += zz
    out[row, 3] += c * s * (ee - tt) + (c * c - s * s) * et
    out[row, 4] += s * ez + c * tz
    out[row, 5] += c * ez - s * tz


@njit(cache=True, inline="always")
def _spread(start, end, center, scale, v, w):
    """Point and weight of a piece [start, end] one end of which is `center`, dense there on `scale`."""
    span = end - start
    u = math.asinh(abs(span) / scale)
    if abs(start - center) > abs(end - center):
        v = 1.0 - v
        start, span = end, -span
    sign = 1.0 if span > 0 else -1.0
    return start + sign * scale * math.sinh(u * v), w * scale * u * math.cosh(u * v)


@njit(cache=True)
def _plane_waves(patch, x, y, z, d_x, d_y, nodes, weights, out):
    a, b = patch[A], patch[B]
    px, py = x / a, y / b
    r = math.hypot(px, py)
    phi_0 = math.atan2(py, px)
    beta = math.acos(1.0 / r) if r > 1.0 else 0.0
    center = 0.0 if a >= b else 0.5 * math.pi  # where the wave vector turns fast
    scale = min(a, b) / max(a, b)
    first = phi_0 - beta
    ends = np.empty(4)
    ends[0], ends[3] = first, first + math.pi
    turn = center + math.pi * math.ceil((first - center) / math.pi)
    ends[1] = min(turn, first + 2.0 * beta)
    ends[2] = max(turn, first + 2.0 * beta)
    if beta == 0.0:
        ends[1] = ends[2] = turn
    for piece in range(3):
        start, end = ends[piece], ends[piece + 1]
        if end - start < 1e-15:
            continue
        for j in range(nodes.size):
            if start == turn or end == turn:
                phi, w = _spread(start, end, turn, scale, nodes[j], weights[j])
            else:
                phi, w = start + (end - start) * nodes[j], weights[j] * (end - start)
            _one_wave(a, b, px, py, z, phi, w, patch[FRICTION], d_x, d_y, out)


@njit(cache=True, inline="always")
def _one_wave(a, b, px, py, z, phi, w, friction, d_x, d_y, out):
    kx, ky = math.cos(phi), math.sin(phi)
    across = px * kx + py * ky
    kx, ky = kx / a, ky / b
    lam = math.sqrt(kx * kx + ky * ky)
    c, s = kx / lam, ky / lam
    zeta = complex(across, max(lam * z, 1e-14))
    log = cmath.log((zeta - 1.0) / (zeta + 1.0))
    square = zeta * zeta
    if abs(square) > 1e4:  # far away the closed form cancels
        g = -math.pi * (2.0 / 3.0 + 0.4 / square) / square
        g_prime = math.pi * (4.0 / 3.0 + 1.6 / square) / (square * zeta)
    else:
        g = math.pi * (2.0 + zeta * log)
        g_prime = math.pi * (log + 2.0 * zeta / (square - 1.0))
    g = g * (w / (2.0 * math.pi**2))
    deep = g_prime * complex(0.0, -lam * z * w / (2.0 * math.pi**2))
    gr, gi, dr, di = g.real, g.imag, deep.real, deep.imag
    _rotate(out, PRESSURE, c, s, dr - gr, 0.0, -gr - dr, 0.0, -di, 0.0)
    _rotate(out, PRESSURE_NU, c, s, 0.0, -2.0 * gr, 0.0, 0.0, 0.0, 0.0)
    q_e, q_t = friction * (d_x * c + d_y * s), friction * (d_y * c - d_x * s)
    _rotate(out, SHEAR, c, s, q_e * (di - 2.0 * gi), 0.0, -q_e * di, -q_t * gi, q_e * (dr - gr), -q_t * gr)
    _rotate(out, SHEAR_NU, c, s, 0.0, -2.0 * q_e * gi, 0.0, 0.0, 0.0, 0.0)


@njit(cache=True)
def _rest_of_friction(patch, x, y, z, d_x, d_y, nodes, weights, out):
    a, b = patch[A], patch[B]
    px, py = x / a, y / b
    r2 = px * px + py * py
    phi_0 = math.atan2(py, px)
    if r2 > 1.0:  # only the cone that sees the patch
        half = math.asin(1.0 / math.sqrt(r2))
        first, last = phi_0 + math.pi - half, phi_0 + math.pi + half
    else:
        first, last = phi_0 + 0.5 * math.pi, phi_0 + 1.5 * math.pi
    center = 0.5 * math.pi if a >= b else 0.0  # where the ray turns fast
    turn = center + math.pi * math.ceil((first - center) / math.pi)
    scale = min(a, b) / max(a, b)
    middle = turn if turn < last else last
    for piece in range(2):
        start, end = (first, middle) if piece == 0 else (middle, last)
        if end - start < 1e-15:
            continue
        for j in range(nodes.size):
            if turn < last:
                psi, w = _spread(start, end, turn, scale, nodes[j], weights[j])
            else:
                psi, w = start + (end - start) * nodes[j], weights[j] * (end - start)
            _one_chord(patch, x, y, z, px, py, r2, psi, w, d_x, d_y, nodes, weights, out)


@njit(cache=True, inline="always")
def _one_chord(patch, x, y, z, px, py, r2, psi, w, d_x, d_y, nodes, weights, out):
    a, b = patch[A], patch[B]
    cx, cy = math.cos(psi), math.sin(psi)
    along = px * cx + py * cy
    root = math.sqrt(max(along * along + 1.0 - r2, 0.0))
    near, far = -along - root, -along + root
    ex, ey = a * cx, b * cy
    length = math.sqrt(ex * ex + ey * ey)
    c, s = ex / length, ey / length
    ee = ee_nu = tt_nu = zz = et_nu = ez = 0.0
    for side in range(2):
        if r2 > 1.0:
            if side == 1:
                break
            start, span = near, far - near
        elif side == 0:
            start, span = 0.0, far
        else:
            start, span = 0.0, near
        sign = 1.0 if span > 0 else -1.0
        for i in range(nodes.size):
            tau = start + span * nodes[i]
            p = (far - tau) * (tau - near)
            if p <= 0.0:
                continue
            f_x, f_y = _direction(patch, x + ex * tau, y + ey * tau)
            f_x -= d_x
            f_y -= d_y
            weight = weights[i] * abs(span * tau) * math.sqrt(p)
            q_e, q_t = weight * (f_x * c + f_y * s), weight * (f_y * c - f_x * s)
            r = abs(tau) * length
            rho_2 = r * r + z * z
            inv = 1.0 / math.sqrt(rho_2)
            inv_3 = inv * inv * inv
            wz = 1.0 / (rho_2 * inv + z)
            swing = r * wz * wz * inv
            axial = 3.0 * r * inv_3 * inv * inv
            g_rr = r * inv_3 - 3.0 * swing + r * r * swing * inv * inv + 2.0 * r * r * swing * wz * inv
            ee += sign * q_e * axial * r * r
            ee_nu -= sign * q_e * g_rr  # times (1 - 2 nu)
            tt_nu -= sign * q_e * (r * inv_3 - swing)
            zz += sign * q_e * axial * z * z
            et_nu += sign * q_t * swing
            ez -= q_e * axial * r * z
    w *= patch[FRICTION] * a * b / (2.0 * math.pi)
    _rotate(out, SHEAR, c, s, w * (ee + ee_nu), w * tt_nu, w * zz, w * et_nu, w * ez, 0.0)
    _rotate(out, SHEAR_NU, c, s, -2 * w * ee_nu, -2 * w * tt_nu, 0.0, -2 * w * et_nu, 0.0, 0.0)


@njit(cache=True)
def stress_at(patch, x, y, z, waves, wave_weights, nodes, weights, out):
    """Stress parts (4, 6) at one point per unit p_max, into `out`.

    `patch` holds a, b, mu, the slip field; `waves` and `nodes` are rules of `clustered_rule` for the plane waves
    and, in both directions, for the rest of the friction.
    """
    out[:, :] = 0.0
    d_x = d_y = 0.0
    if patch[FRICTION] > 0.0:
        r = math.hypot(x / patch[A], y / patch[B])
        shrink = 1.0 / r if r > 1.0 else 1.0
        d_x, d_y = _direction(patch, x * shrink, y * shrink)
    _plane_waves(patch, x, y, z, d_x, d_y, waves, wave_weights, out)
    if patch[FRICTION] > 0.0 and patch[FIXED] == 0.0:
        _rest_of_friction(patch, x, y, z, d_x, d_y, nodes, weights, out)


@njit(cache=True, parallel=True)
def _stress_many(patch, points, waves, wave_weights, nodes, weights, out):
    for i in prange(points.shape[0]):
        stress_at(patch, points[i, 0], points[i, 1], points[i, 2], waves, wave_weights, nodes, weights, out[i])


def stress_parts(patch: np.ndarray, points: np.ndarray, waves: int = 24, nodes: int = 24) -> np.ndarray:
    """Stress parts per unit p_max at points (m, 3) [mm], z >= 0, shape (m, 4, 6).

    The stress of a body with ratio nu is parts[0] + nu parts[1] +- (parts[2] + nu parts[3]): + for the roller,
    - for the guide, on which the friction acts the other way.

    Parameters
    ----------
    patch : row of `patch_rows`
    points : x_C, y_C and depth [mm]
    waves, nodes : quadrature points; the error falls exponentially but for the neighbourhood of the spin pole
    """
    points = np.ascontiguousarray(points, dtype=float)
    out = np.empty((len(points), 4, 6))
    _stress_many(np.ascontiguousarray(patch, dtype=float), points, *clustered_rule(waves), *clustered_rule(nodes), out)
    return out


def patch_rows(ellipse, slip, friction, spin_model: int, fixed_direction=None) -> np.ndarray:
    """Array (n, 9) that describes sliding patches to the kernels; `fixed_direction` +-1 along y_C, 0 by slip."""
    n = np.size(friction)
    rows = np.zeros((n, 9))
    columns = (ellipse.semi_axis_lateral, ellipse.semi_axis_rolling, friction, slip.sine, slip.cosine,
               slip.guide_profile_radius, slip.shift, spin_model, 0.0 if fixed_direction is None else fixed_direction)  # fmt: skip
    for j, column in enumerate(columns):
        rows[:, j] = column
    return rows
