"""Stress in the half-space under a sliding Hertzian ellipse, exact up to the surface.

The traction on the body is p = p_max sqrt(1 - rho^2) along z and q = mu p d(x, y) with a unit direction d. At a
point the direction is split into its value d_0 there and the rest:

- the parts p and mu p d_0 are Hertzian, so their stresses are a single integral over plane waves,
  sigma = 1/(2 pi^2) Re int_0^pi [A G(zeta) - i lambda z B G'(zeta)] dphi, zeta = X cos(phi) + Y sin(phi) + i lambda z,
  G = pi (2 + zeta ln((zeta - 1)/(zeta + 1))), lambda^2 = (cos(phi)/a)^2 + (sin(phi)/b)^2, where A + B k z are the
  transforms of the Boussinesq-Cerruti potentials (eqs (1)-(5); `plane_waves.plane_wave_stress`);
- the rest, mu p (d - d_0), vanishes at the point: its Cerruti integral in polar coordinates about the point has no
  singularity at any depth, z = 0 and the edge of the patch included.

Far from the patch the point-load kernels are summed over it instead.

Stresses come as value + nu * slope, for pressure and friction apart, so one evaluation serves both bodies.
Order of components: xx, yy, zz, xy, yz, zx. x, y, z, a, b in mm; stresses per unit p_max.
"""

from __future__ import annotations

import cmath
import math

import numpy as np
from numba import njit

from trackroller.contact.sliding import clustered_rule
from trackroller.halfspace.kernels import point_kernel
from trackroller.threads import share_rows

PRESSURE, PRESSURE_NU, SHEAR, SHEAR_NU = range(4)  # rows of the result
COMPONENTS = ("xx", "yy", "zz", "xy", "yz", "zx")

# columns of the array that describes a patch; the slip v_x vanishes at y = K0 + K1 (x + a) left of POLE_X and at
# y = K0 + K2 (x - a) right of it, which holds all three spin models
A, B, FRICTION, SINE, COSINE, RADIUS, SHIFT, FIXED, POLE_X, K0, K1, K2 = range(12)

_FAST = {"reassoc", "contract", "arcp", "nsz"}  # lets the inner loop run in vectors; keeps NaN and inf


@njit(cache=True, fastmath=_FAST, error_model="numpy")
def _slip(patch, x, y):
    """Rigid slip v/omega of the roller against the guide at (x, y) [mm], eqs (21), (24), without branches."""
    left = patch[K1] * (x + patch[A])
    right = patch[K2] * (x - patch[A])
    v_x = patch[SINE] * (y - patch[K0] - (left if x < patch[POLE_X] else right))
    flat = patch[RADIUS] * patch[COSINE]
    product = min(x * patch[COSINE] * (2.0 * patch[RADIUS] * patch[SINE] + x * patch[COSINE]), flat * flat)
    return v_x, patch[SHIFT] - product / (math.sqrt(flat * flat - product) + flat)


@njit(cache=True, error_model="numpy")
def _interpolated(field, u, v):
    """Shares (x, y) of the traction bound at (u, v) in [-1, 1]^2, bilinear between element centres."""
    ny, nx = field.shape[1], field.shape[2]
    s = min(max(0.5 * (u + 1.0) * nx - 0.5, 0.0), nx - 1.000001)
    t = min(max(0.5 * (v + 1.0) * ny - 0.5, 0.0), ny - 1.000001)
    i, j = int(s), int(t)
    s, t = s - i, t - j
    w00, w01, w10, w11 = (1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t
    f_x = w00 * field[0, j, i] + w01 * field[0, j, i + 1] + w10 * field[0, j + 1, i] + w11 * field[0, j + 1, i + 1]
    f_y = w00 * field[1, j, i] + w01 * field[1, j, i + 1] + w10 * field[1, j + 1, i] + w11 * field[1, j + 1, i + 1]
    return f_x, f_y


@njit(cache=True)
def _direction(patch, field, x, y):
    """Share of the traction bound on the roller at (x, y): of length 1 where it slides; (0, 0) at the pole."""
    if patch[FIXED] != 0.0:  # full slip along y_C
        return 0.0, patch[FIXED]
    if field.shape[1] > 1:
        return _interpolated(field, x / patch[A], y / patch[B])
    v_x, v_y = _slip(patch, x, y)
    speed = math.sqrt(v_x * v_x + v_y * v_y)
    if speed == 0.0:
        return 0.0, 0.0
    return -v_x / speed, -v_y / speed


@njit(cache=True)
def _rotate(out, row, c, s, ee, tt, zz, et, ez, tz):
    """Adds a tensor given along e = (c, s), t = (-s, c), z."""
    out[row, 0] += c * c * ee + s * s * tt - 2.0 * c * s * et
    out[row, 1] += s * s * ee + c * c * tt + 2.0 * c * s * et
    out[row, 2] += zz
    out[row, 3] += c * s * (ee - tt) + (c * c - s * s) * et
    out[row, 4] += s * ez + c * tz
    out[row, 5] += c * ez - s * tz


@njit(cache=True)
def _spread(start, end, center, scale, u, v, w):
    """Point and weight of a piece [start, end] one end of which is `center`, dense there on `scale`.

    `u` = asinh(|end - start| / scale).
    """
    sign = 1.0
    if abs(start - center) > abs(end - center):
        start, v, sign = end, 1.0 - v, -1.0
    grown = math.exp(u * v)
    shrunk = 1.0 / grown
    return start + sign * 0.5 * scale * (grown - shrunk), w * 0.5 * scale * u * (grown + shrunk)


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
        u = math.asinh((end - start) / scale)
        for j in range(nodes.size):
            if start == turn or end == turn:
                phi, w = _spread(start, end, turn, scale, u, nodes[j], weights[j])
            else:
                phi, w = start + (end - start) * nodes[j], weights[j] * (end - start)
            _one_wave(a, b, px, py, z, phi, w, patch[FRICTION], d_x, d_y, out)


@njit(cache=True)
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
def _rest_of_friction(patch, field, x, y, z, d_x, d_y, nodes, weights, out):
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
        u = math.asinh((end - start) / scale)
        for j in range(nodes.size):
            if turn < last:
                psi, w = _spread(start, end, turn, scale, u, nodes[j], weights[j])
            else:
                psi, w = start + (end - start) * nodes[j], weights[j] * (end - start)
            _one_chord(patch, field, x, y, z, px, py, r2, psi, w, d_x, d_y, nodes, weights, out)


@njit(cache=True, fastmath=_FAST, error_model="numpy")
def _half_chord(patch, field, x, y, z, ex, ey, near, far, start, span, d_x, d_y, nodes, weights, sums):
    """Adds the radial integrals over one side of a chord to `sums`: ee, its nu part, tt, zz, et and ez."""
    length = math.sqrt(ex * ex + ey * ey)
    c, s = ex / length, ey / length
    gridded = field.shape[1] > 1
    ee = ee_nu = tt_nu = zz = et_nu = ez = 0.0
    for i in range(nodes.size):
        tau = start + span * nodes[i]
        if gridded:
            f_x, f_y = _interpolated(field, (x + ex * tau) / patch[A], (y + ey * tau) / patch[B])
        else:
            v_x, v_y = _slip(patch, x + ex * tau, y + ey * tau)
            inv_speed = 1.0 / math.sqrt(v_x * v_x + v_y * v_y + 1e-300)
            f_x, f_y = -v_x * inv_speed, -v_y * inv_speed
        f_x, f_y = f_x - d_x, f_y - d_y
        weight = weights[i] * abs(span * tau) * math.sqrt(abs((far - tau) * (tau - near)))
        q_e, q_t = weight * (f_x * c + f_y * s), weight * (f_y * c - f_x * s)
        r = abs(tau) * length
        rho_2 = r * r + z * z
        inv = 1.0 / math.sqrt(rho_2)
        wz = 1.0 / (rho_2 * inv + z)
        inv_2 = inv * inv
        swing = r * wz * wz * inv
        axial = 3.0 * r * inv_2 * inv_2 * inv
        ratio = r * r * swing * inv_2
        ee += q_e * axial * r * r
        ee_nu -= q_e * (r * inv_2 * inv - 3.0 * swing + ratio + 2.0 * ratio * wz * rho_2 * inv)
        tt_nu -= q_e * (r * inv_2 * inv - swing)
        zz += q_e * axial * z * z
        et_nu += q_t * swing
        ez -= q_e * axial * r * z
    sign = 1.0 if span > 0 else -1.0
    sums[0] += sign * ee
    sums[1] += sign * ee_nu
    sums[2] += sign * tt_nu
    sums[3] += sign * zz
    sums[4] += sign * et_nu
    sums[5] += ez


@njit(cache=True)
def _one_chord(patch, field, x, y, z, px, py, r2, psi, w, d_x, d_y, nodes, weights, out):
    a, b = patch[A], patch[B]
    cx, cy = math.cos(psi), math.sin(psi)
    along = px * cx + py * cy
    root = math.sqrt(max(along * along + 1.0 - r2, 0.0))
    near, far = -along - root, -along + root
    ex, ey = a * cx, b * cy
    sums = np.zeros(6)  # its allocation keeps LLVM from inlining the loop, which then runs in vectors: 1.5-2 x faster
    if r2 > 1.0:
        _half_chord(patch, field, x, y, z, ex, ey, near, far, near, far - near, d_x, d_y, nodes, weights, sums)
    else:
        # a side of no length (point on the edge) would divide by zero
        if far > 1e-13:
            _half_chord(patch, field, x, y, z, ex, ey, near, far, 0.0, far, d_x, d_y, nodes, weights, sums)
        if near < -1e-13:
            _half_chord(patch, field, x, y, z, ex, ey, near, far, 0.0, near, d_x, d_y, nodes, weights, sums)
    ee, ee_nu, tt_nu, zz, et_nu, ez = sums[0], sums[1], sums[2], sums[3], sums[4], sums[5]
    length = math.sqrt(ex * ex + ey * ey)
    c, s = ex / length, ey / length
    w *= patch[FRICTION] * a * b / (2.0 * math.pi)
    _rotate(out, SHEAR, c, s, w * (ee + ee_nu), w * tt_nu, w * zz, w * et_nu, w * ez, 0.0)
    _rotate(out, SHEAR_NU, c, s, -2 * w * ee_nu, -2 * w * tt_nu, 0.0, -2 * w * et_nu, 0.0, 0.0)


@njit(cache=True)
def _far_field(patch, field, x, y, z, nodes, weights, out):
    """Sum of point loads over the patch: exponentially exact at distances above its size."""
    count = 4 * nodes.size
    for i in range(nodes.size):
        rho = math.sqrt(nodes[i] * (2.0 - nodes[i]))  # 1 - rho^2 = (1 - v)^2 makes the pressure a polynomial
        weight = weights[i] * (1.0 - nodes[i]) ** 2 * patch[A] * patch[B] * 2.0 * math.pi / count
        for j in range(count):
            angle = 2.0 * math.pi * (j + 0.5) / count
            px, py = patch[A] * rho * math.cos(angle), patch[B] * rho * math.sin(angle)
            d_x, d_y = _direction(patch, field, px, py)
            q_x, q_y = patch[FRICTION] * d_x * weight, patch[FRICTION] * d_y * weight
            k = point_kernel(x - px, y - py, z)
            for c in range(6):
                out[PRESSURE, c] += weight * k[12 + c]
                out[PRESSURE_NU, c] += weight * k[30 + c]
                out[SHEAR, c] += q_x * k[c] + q_y * k[6 + c]
                out[SHEAR_NU, c] += q_x * k[18 + c] + q_y * k[24 + c]


@njit(cache=True)
def stress_at(patch, field, x, y, z, waves, wave_weights, nodes, weights, out):
    """Stress parts (4, 6) at one point per unit p_max, into `out`.

    `patch` holds a, b, mu and the slip field; `field` (2, ny, nx) the traction over its bound at element centres, or
    has one element where the slip decides; `waves` and `nodes` are rules of `clustered_rule` for the plane waves
    and, in both directions, for the rest of the friction.
    """
    out[:, :] = 0.0
    if x * x + y * y + z * z > 9.0 * max(patch[A], patch[B]) ** 2:
        _far_field(patch, field, x, y, z, nodes, weights, out)
        return
    d_x = d_y = 0.0
    if patch[FRICTION] > 0.0:
        r = math.hypot(x / patch[A], y / patch[B])
        shrink = 1.0 / r if r > 1.0 else 1.0
        d_x, d_y = _direction(patch, field, x * shrink, y * shrink)
    _plane_waves(patch, x, y, z, d_x, d_y, waves, wave_weights, out)
    if patch[FRICTION] > 0.0 and patch[FIXED] == 0.0:
        _rest_of_friction(patch, field, x, y, z, d_x, d_y, nodes, weights, out)


@njit(cache=True, nogil=True)
def _stress_many(first, last, patch, field, points, waves, wave_weights, nodes, weights, out):
    for i in range(first, last):
        stress_at(patch, field, points[i, 0], points[i, 1], points[i, 2], waves, wave_weights, nodes, weights, out[i])


NO_FIELD = np.zeros((2, 1, 1))


def stress_parts(
    patch: np.ndarray, points: np.ndarray, waves: int = 24, nodes: int = 24, field: np.ndarray = NO_FIELD
) -> np.ndarray:
    """Stress parts per unit p_max at points (m, 3) [mm], z >= 0, shape (m, 4, 6).

    The stress of a body with ratio nu is parts[0] + nu parts[1] +- (parts[2] + nu parts[3]): + for the roller,
    - for the guide, on which the friction acts the other way.

    Parameters
    ----------
    patch : row of `patch_rows`
    points : x_C, y_C and depth [mm]
    waves, nodes : quadrature points; the error falls exponentially but for the neighbourhood of the spin pole
    field : traction over its bound mu p at element centres (2, ny, nx); not given: full sliding
    """
    points = np.ascontiguousarray(points, dtype=float)
    out = np.empty((len(points), 4, 6))
    patch, field = np.ascontiguousarray(patch, dtype=float), np.ascontiguousarray(field, dtype=float)
    rest = (patch, field, points, *clustered_rule(waves), *clustered_rule(nodes), out)
    share_rows(lambda first, last: _stress_many(first, last, *rest), len(points), 32)
    return out


def patch_rows(ellipse, slip, friction, spin_model: int, fixed_direction=0.0) -> np.ndarray:
    """Array (n, 12) that describes sliding patches to the kernels.

    `spin_model` is the number of the paper's assumption; `fixed_direction` is +-1 for a traction along y_C (full
    slip), 0 where the slip decides.
    """
    rows = np.zeros((np.size(friction), 12))
    a, b = ellipse.semi_axis_lateral, ellipse.semi_axis_rolling
    fixed = np.broadcast_to(np.asarray(fixed_direction, dtype=float), a.shape)
    shift = np.where(fixed == 0.0, slip.shift, 0.0)  # full slip has no spin pole
    pole_x = shift / slip.sine
    with np.errstate(invalid="ignore", divide="ignore"):
        inside = np.abs(pole_x) < a
        pole_y = np.where(inside, -b * np.sqrt(np.where(inside, 1.0 - (pole_x / a) ** 2, 0.0)), 0.0)
        k1, k2 = pole_y / (pole_x + a), pole_y / (pole_x - a)
    zero = np.zeros_like(a)
    k0, k1, k2 = (
        (zero, zero, zero), (pole_y, zero, zero), (zero, np.where(inside, k1, 0.0), np.where(inside, k2, 0.0))
    )[spin_model]  # fmt: skip
    columns = (a, b, friction, slip.sine, slip.cosine, slip.guide_profile_radius, shift, fixed,
               pole_x, k0, k1, k2)  # fmt: skip
    for j, column in enumerate(columns):
        rows[:, j] = column
    return rows
