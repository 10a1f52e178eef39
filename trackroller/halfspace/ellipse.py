"""Stress in the half-space under a sliding Hertzian ellipse, exact up to the surface.

The traction on the body is p = p_max sqrt(1 - rho^2) along z and q = mu p d(x, y) with a unit
direction d. At a point the direction is split into its value d_0 there and the difference d - d_0:

- p and mu p d_0 are Hertzian, so that their stresses are a single integral over plane waves, sigma
  = 1/(2 pi^2) Re int_0^pi [A G(zeta) - i lambda z B G'(zeta)] dphi, zeta = X cos(phi) + Y sin(phi)
  + i lambda z, G = pi (2 + zeta ln((zeta - 1)/(zeta + 1))), lambda^2 = (cos(phi)/a)^2 +
  (sin(phi)/b)^2, where A + B k z are the transforms of the Boussinesq-Cerruti potentials (eqs
  (1)-(5); `validation/derivations/plane_waves.py`);
- mu p (d - d_0) vanishes at the point: its Cerruti integral in polar coordinates about the point
  has no singularity at any depth, including z = 0 and the edge of the patch.

Far from the patch point loads are summed over the patch instead.

Frame: x lateral, y in the rolling direction (Kalker and CONTACT: x), z into the body. Stresses are
returned as parts (4, 6) for pressure and friction, without and with the factor nu, so that one
evaluation serves both bodies (`stress.body_stress`). Components: xx, yy, zz, xy, yz, zx. x, y, z,
a, b in mm; stresses per unit p_max.

The loops over waves and rays run in vector registers. Their angles and weights therefore stand in
rows of a scratch array, and the formulas are inlined: a call for each wave or ray would cost more
than its arithmetic (see `numerics.compiled.inner`). In full sliding the rays have double precision.
Tractions on a grid are known in single precision only, and so are the sums over their rays; twice
as many numbers then fit into a vector register.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from trackroller.errors import InputError
from trackroller.halfspace.influence import PRESSURE, PRESSURE_NU, SHEAR, SHEAR_NU, add_load
from trackroller.halfspace.kernels import point_kernel
from trackroller.halfspace.rigid_slip import (
    lateral_slip,
    pole_lateral,
    pole_line,
    pole_offset,
    pole_rolling,
    rolling_slip_without_division,
)
from trackroller.halfspace.vectors import angle, exp, log, sine_cosine
from trackroller.numerics.compiled import compiled, fast, inner
from trackroller.numerics.lanes import bilinear
from trackroller.numerics.quadrature import clustered_rule
from trackroller.numerics.threads import share_rows

XX, YY, ZZ, XY, YZ, ZX = range(6)  # components of a stress

# One patch: semi-axes a, b [mm], friction coefficient, kinematics as in `contact.slip.Slip`,
# `fixed` direction of the friction along y in full slip (0 in rolling), and where the lateral slip
# vanishes, which covers all three spin models: at y = k0 + k1 (x + a) left of pole_x and at y = k0
# + k2 (x - a) right of pole_x.
FIELDS = (
    "a",
    "b",
    "friction",
    "sine",
    "cosine",
    "radius",
    "shift",
    "fixed",
    "pole_x",
    "k0",
    "k1",
    "k2",
)
PATCH = np.dtype([(name, np.float64) for name in FIELDS])


class Place(NamedTuple):
    """Point x, y, z [mm] below a patch, and the direction d_x, d_y of the friction there over its
    bound.
    """

    x: float
    y: float
    z: float
    d_x: float
    d_y: float


# Rows of the scratch array: angle and weight of waves and chords, then the numbers of each ray.
# numbers in a row; rows of a power of two would compete for the same lines of the cache
STRIDE = 4104
ANGLE, WEIGHT, C, S, START, SPAN, BEHIND, LENGTH, FIELD_X, FIELD_Y = (
    row * STRIDE for row in range(10)
)
SCRATCH = 10 * STRIDE
MOST_POINTS = 1024  # points of a rule; a row holds four rays for each point


@inner
def slip_at(patch, x, y):
    """Return the rigid slip v/omega of the roller against the guide at (x, y) [mm], eq. (24)."""
    offset = pole_offset(x, patch.a, patch.k0, patch.k1, patch.k2)
    v_y = rolling_slip_without_division(x, patch.sine, patch.cosine, patch.radius, patch.shift)
    return lateral_slip(y, offset, patch.sine), v_y


@inner
def grid_place(u, count):
    """Return where u = x/a or y/b lies on the grid, in elements from the centre of the first one
    on.
    """
    return count * (0.5 * (u + 1.0)) - 0.5


@inner
def cell_of(place, count, real):
    """Return the element centre before a place on the grid and the share of the way to the next
    one, as `real`.
    """
    place = min(max(real(place), real(0.0)), real(count - 1))
    before = min(real(np.int32(place)), real(count - 2))
    return before, place - before


@inner
def interpolated(field, x, y):
    """Return the shares (x, y) of the traction bound at a place x, y on the grid, bilinear between
    element centres.
    """
    ny, nx, real = field.shape[1], field.shape[2], field.dtype.type
    (i, s), (j, t) = cell_of(x, nx, real), cell_of(y, ny, real)
    return bilinear(field.reshape(-1), int(j) * nx + int(i), nx, ny * nx, s, t)


@inner
def direction(patch, field, x, y):
    """Return the traction on the roller over its bound at (x, y): length 1 where it slides, (0, 0)
    at the pole.
    """
    if patch.fixed != 0.0:  # full slip along y_C
        return 0.0, patch.fixed
    if field.shape[1] > 1:
        return interpolated(
            field, grid_place(x / patch.a, field.shape[2]), grid_place(y / patch.b, field.shape[1])
        )
    v_x, v_y = slip_at(patch, x, y)
    speed = math.sqrt(v_x * v_x + v_y * v_y)
    if speed == 0.0:
        return 0.0, 0.0
    return -v_x / speed, -v_y / speed


@inner
def spread_angles(work, at, start, end, turn, scale, rule):
    """Write angles and weights of [start, end] from place `at` on; return the next free place.

    The angles are dense near `turn` if it is an end; neighbouring angles there are about `scale`
    apart.
    """
    span = end - start
    if span < 1e-15:
        return at
    count = rule.shape[1]
    if start == turn or end == turn:
        sign = 0.5 * scale if start == turn else -0.5 * scale
        u = math.asinh(span / scale)
        for j in range(count):
            grown = exp(u * rule[0, j])
            shrunk = 1.0 / grown
            work[ANGLE + at + j] = turn + sign * (grown - shrunk)
            work[WEIGHT + at + j] = rule[1, j] * 0.5 * scale * u * (grown + shrunk)
    else:
        for j in range(count):
            work[ANGLE + at + j] = start + span * rule[0, j]
            work[WEIGHT + at + j] = rule[1, j] * span
    return at + count


@inner
def add_stress(out, row, xx, yy, zz, xy, yz, zx):
    """Add six components to one row of the stress parts `out` (4, 6)."""
    out[row, XX] += xx
    out[row, YY] += yy
    out[row, ZZ] += zz
    out[row, XY] += xy
    out[row, YZ] += yz
    out[row, ZX] += zx


@inner
def _hertz_transform(p, q):
    """Return real and imaginary part of G/pi and G'/pi at zeta = p + i q; see `ellipse`."""
    p2, q2 = p * p, q * q
    plus, minus, square = (p + 1.0) * (p + 1.0) + q2, (p - 1.0) * (p - 1.0) + q2, p2 + q2
    inv = 1.0 / (plus * minus)
    log_r, log_i = 0.5 * log(minus * minus * inv), angle(2.0 * q, square - 1.0)
    real, twice = p2 - q2, 2.0 * p * q
    g_r, g_i = 2.0 + p * log_r - q * log_i, p * log_i + q * log_r
    d_r = log_r + 2.0 * (p * (real - 1.0) + q * twice) * inv
    d_i = log_i + 2.0 * (q * (real - 1.0) - p * twice) * inv
    # far away the closed form cancels: -(2/3 + 2/5 h) h and (4/3 + 8/5 h) h/zeta with h = 1/zeta^2
    inv = 1.0 / square
    h_r, h_i = real * inv * inv, -twice * inv * inv
    t_r, t_i = 4.0 / 3.0 + 1.6 * h_r, 1.6 * h_i
    u_r, u_i = (p * h_r + q * h_i) * inv, (p * h_i - q * h_r) * inv
    far = square > 1e4
    g_r = -((2.0 / 3.0 + 0.4 * h_r) * h_r - 0.4 * h_i * h_i) if far else g_r
    g_i = -((2.0 / 3.0 + 0.4 * h_r) * h_i + 0.4 * h_i * h_r) if far else g_i
    d_r = t_r * u_r - t_i * u_i if far else d_r
    d_i = t_r * u_i + t_i * u_r if far else d_i
    return g_r, g_i, d_r, d_i


@inner
def sum_waves(patch, place, count, work, out):
    """Add the stresses of `count` plane waves; their symmetric components are turned from the wave
    vector to x, y.
    """
    inv_a, inv_b, mu, d_x, d_y = 1.0 / patch.a, 1.0 / patch.b, patch.friction, place.d_x, place.d_y
    px, py = place.x / patch.a, place.y / patch.b
    p_xx = p_yy = p_zz = p_xy = p_yz = p_zx = n_xx = n_yy = n_xy = 0.0
    s_xx = s_yy = s_zz = s_xy = s_yz = s_zx = m_xx = m_yy = m_xy = 0.0
    for k in range(count):
        ky, kx = sine_cosine(work[ANGLE + k])
        weight = work[WEIGHT + k] * (0.5 / math.pi)
        p = px * kx + py * ky
        kx, ky = kx * inv_a, ky * inv_b
        lam = math.sqrt(kx * kx + ky * ky)
        c, s = kx / lam, ky / lam
        g_r, g_i, d_r, d_i = _hertz_transform(p, max(lam * place.z, 1e-14))
        deep = lam * place.z * weight
        g_r, g_i, d_r, d_i = g_r * weight, g_i * weight, d_i * deep, -d_r * deep
        cc, ss, cs = c * c, s * s, c * s
        e = d_r - g_r
        p_xx += cc * e
        p_yy += ss * e
        p_xy += cs * e
        p_zz -= g_r + d_r
        p_yz -= s * d_i
        p_zx -= c * d_i
        n_xx += ss * g_r
        n_yy += cc * g_r
        n_xy -= cs * g_r
        along, across = d_x * c + d_y * s, d_y * c - d_x * s
        e, t, f = along * (d_i - 2.0 * g_i), across * g_i, along * g_i
        s_xx += cc * e + 2.0 * cs * t
        s_yy += ss * e - 2.0 * cs * t
        s_xy += cs * e - (cc - ss) * t
        s_zz -= along * d_i
        e, t = along * (d_r - g_r), across * g_r
        s_yz += s * e - c * t
        s_zx += c * e + s * t
        m_xx += ss * f
        m_yy += cc * f
        m_xy -= cs * f
    add_stress(out, PRESSURE, p_xx, p_yy, p_zz, p_xy, p_yz, p_zx)
    add_stress(out, PRESSURE_NU, -2.0 * n_xx, -2.0 * n_yy, 0.0, -2.0 * n_xy, 0.0, 0.0)
    add_stress(out, SHEAR, mu * s_xx, mu * s_yy, mu * s_zz, mu * s_xy, mu * s_yz, mu * s_zx)
    add_stress(out, SHEAR_NU, -2.0 * mu * m_xx, -2.0 * mu * m_yy, 0.0, -2.0 * mu * m_xy, 0.0, 0.0)


@inner
def wave_angles(patch, px, py, rule, work):
    """Write angles and weights of the plane waves for the point (px a, py b); return their
    number.
    """
    a, b = patch.a, patch.b
    r = math.sqrt(px * px + py * py)
    beta = math.acos(1.0 / r) if r > 1.0 else 0.0
    center = 0.0 if a >= b else 0.5 * math.pi  # angle near which the wave vector turns fast
    first = math.atan2(py, px) - beta
    turn = center + math.pi * math.ceil((first - center) / math.pi)
    low, high = turn, turn
    if beta > 0.0:
        low, high = min(turn, first + 2.0 * beta), max(turn, first + 2.0 * beta)
    count = np.int64(0)  # a literal would compile `spread_angles` twice
    ratio = min(a, b) / max(a, b)
    for start, end in ((first, low), (low, high), (high, first + math.pi)):
        count = spread_angles(work, count, start, end, turn, ratio, rule)
    return count


# Least length of a ray over the semi-axis. A ray from a point on the edge to its own side has none
# and would divide by zero; in single precision the square of the shortest distance on it must stay
# above 1e-38.
SHORTEST = 1e-9


@inner
def chord_angles(patch, px, py, rule, work):
    """Write angles and weights of chords through the point (px a, py b); return the number of
    chords.
    """
    a, b = patch.a, patch.b
    r2 = px * px + py * py
    # outside: the cone that meets the patch
    half = math.asin(1.0 / math.sqrt(r2)) if r2 > 1.0 else 0.5 * math.pi
    first = math.atan2(py, px) + math.pi - half
    last = first + 2.0 * half
    center = 0.5 * math.pi if a >= b else 0.0  # angle near which the ray turns fast
    turn = center + math.pi * math.ceil((first - center) / math.pi)
    middle = min(turn, last)
    count = np.int64(0)  # a literal would compile `spread_angles` twice
    for piece in range(2):
        start, end = (first if piece == 0 else middle), (middle if piece == 0 else last)
        count = spread_angles(work, count, start, end, turn, min(a, b) / max(a, b), rule)
    return count


@inner
def rays_of_chords(patch, px, py, count, work):
    """Turn `count` chords through the point into rays from it and return the number of rays.

    A point inside the patch has rays to both sides; from a point outside only one side meets the
    patch.
    """
    a, b = patch.a, patch.b
    outside = px * px + py * py > 1.0
    scale = patch.friction * a * b / (2.0 * math.pi)
    second = 0 if outside else count
    for k in range(count):
        sine, cosine = sine_cosine(work[ANGLE + k])
        along = px * cosine + py * sine
        root = math.sqrt(max(along * along + 1.0 - px * px - py * py, 0.0))
        start = -along - root if outside else 0.0
        far = root - along if outside else max(root - along, SHORTEST)
        near = -along - root if outside else min(-along - root, -SHORTEST)
        ex, ey = a * cosine, b * sine
        length = math.sqrt(ex * ex + ey * ey)
        c, s = ex / length, ey / length
        weight = work[WEIGHT + k] * scale
        work[LENGTH + second + k], work[LENGTH + k] = length, length
        work[C + second + k], work[C + k] = -c, c
        work[S + second + k], work[S + k] = -s, s
        work[START + second + k], work[START + k] = 0.0, start
        work[SPAN + second + k], work[SPAN + k] = -near, far - start
        work[BEHIND + second + k], work[BEHIND + k] = far, start - near
        work[WEIGHT + second + k], work[WEIGHT + k] = -near * weight, (far - start) * weight
    return count + second


@inner
def rounded_rays(patch, count, work, single):
    """Write the rays in single precision into the scratch array `single`; the unit is the smaller
    semi-axis.
    """
    unit = min(patch.a, patch.b)
    for k in range(count):
        single[WEIGHT + k] = work[WEIGHT + k] / (unit * unit)
        single[LENGTH + k] = work[LENGTH + k] / unit
    for row in (C, S, START, SPAN, BEHIND):
        for k in range(count):
            single[row + k] = work[row + k]


@inner
def _interpolate_rays(field, at, per, node, count, work, places):
    """Interpolate the traction over its bound at a node of each ray, and write it into the scratch
    array.

    `at` is the place of the point on the grid (x, y), and `per` the number of elements per length;
    `places` (m,) serves the numbers of the elements.
    """
    real, (_, ny, nx) = work.dtype.type, field.shape
    wide = real(nx)
    for k in range(count):
        r = (work[START + k] + work[SPAN + k] * node) * work[LENGTH + k]
        x, y = at[0] + work[C + k] * r * per[0], at[1] + work[S + k] * r * per[1]
        (i, s), (j, t) = cell_of(x, nx, real), cell_of(y, ny, real)
        work[FIELD_X + k], work[FIELD_Y + k], places[k] = s, t, np.int32(j * wide + i)
    flat = field.reshape(-1)
    for k in range(count):
        shares = work[FIELD_X + k], work[FIELD_Y + k]
        work[FIELD_X + k], work[FIELD_Y + k] = bilinear(flat, places[k], nx, ny * nx, *shares)


@inner
def _stresses_of_ray(c, s, q_e, q_t, share, deep, turn):
    """Return the stresses of the friction q_e along a ray (c, s) and q_t across it, then the parts
    with factor nu.

    With the distance rho of the point: share = r/rho, deep = z/rho, turn = rho/(rho + z).
    """
    swing = share * turn * turn
    ratio = share * share * swing
    axial = (q_e + q_e + q_e) * share
    e, slant = axial * share * share, axial * share * deep
    e_nu = q_e * (swing + swing + swing - share - ratio - (ratio + ratio) * turn)
    t_nu, et = q_e * (swing - share), q_t * swing
    cc, ss, cs = c * c, s * s, c * s
    across = (cs + cs) * et
    stress = cc * e, ss * e, axial * deep * deep, cs * e, -s * slant, -c * slant
    return stress, (
        cc * e_nu + ss * t_nu - across,
        ss * e_nu + cc * t_nu + across,
        cs * (e_nu - t_nu) + (cc - ss) * et,
    )


@inner
def sum_rays(patch, field, place, count, rule, work, places, out):
    """Add the stresses of the friction along `count` rays less those of friction in the direction
    at the point.

    Without a `field` (None) the slip gives the direction. Under a field the rays are those of
    `rounded_rays`, and `places` (m,) serves the interpolation. The scratch array sets the precision
    of the sums.
    """
    real, unit = work.dtype.type, 1.0
    if field is not None:
        unit, ny, nx = min(patch.a, patch.b), field.shape[1], field.shape[2]
        at = real(grid_place(place.x / patch.a, nx)), real(grid_place(place.y / patch.b, ny))
        per = real(0.5 * nx * unit / patch.a), real(0.5 * ny * unit / patch.b)
    x, y, z, d_x, d_y = (
        real(place.x),
        real(place.y),
        real(place.z / unit),
        real(place.d_x),
        real(place.d_y),
    )
    one = real(1.0)
    xx = yy = xy = zz = yz = zx = n_xx = n_yy = n_xy = real(0.0)
    for i in range(rule.shape[1]):
        node, rest, share = real(rule[0, i]), real(1.0 - rule[0, i]), real(rule[1, i])
        if field is not None:
            _interpolate_rays(field, at, per, node, count, work, places)
        for k in range(count):
            c, s, gone = work[C + k], work[S + k], work[SPAN + k] * node
            tau = work[START + k] + gone
            r = tau * work[LENGTH + k]
            rho = math.sqrt(r * r + z * z)
            if field is not None:
                f_x, f_y = work[FIELD_X + k], work[FIELD_Y + k]
                inv = one / (rho * (rho + z))
            else:
                v_x, v_y = slip_at(patch, x + c * r, y + s * r)
                speed = math.sqrt(v_x * v_x + v_y * v_y + 1e-300)
                inv_all = one / (speed * rho * (rho + z))  # one division for three
                inv = speed * inv_all
                inv_all *= -rho * (rho + z)
                f_x, f_y = v_x * inv_all, v_y * inv_all
            f_x, f_y = f_x - d_x, f_y - d_y
            inv_rho = inv * (rho + z)
            inside = work[SPAN + k] * rest * (work[BEHIND + k] + gone)
            weight = share * work[WEIGHT + k] * tau * math.sqrt(inside) * inv_rho * inv_rho
            along, across = weight * (f_x * c + f_y * s), weight * (f_y * c - f_x * s)
            stress, by_nu = _stresses_of_ray(
                c, s, along, across, r * inv_rho, z * inv_rho, rho * rho * inv
            )
            xx, yy, zz = xx + stress[0], yy + stress[1], zz + stress[2]
            xy, yz, zx = xy + stress[3], yz + stress[4], zx + stress[5]
            n_xx, n_yy, n_xy = n_xx + by_nu[0], n_yy + by_nu[1], n_xy + by_nu[2]
    add_stress(out, SHEAR, xx + n_xx, yy + n_yy, zz, xy + n_xy, yz, zx)
    add_stress(out, SHEAR_NU, -2.0 * n_xx, -2.0 * n_yy, 0.0, -2.0 * n_xy, 0.0, 0.0)


FIELD = np.float32  # of traction fields: gathering their values takes most of the time of a point
NO_FIELD = np.zeros((2, 1, 1), FIELD)  # stands for a traction field in full sliding


class RayRoom(NamedTuple):
    """Work space of one thread: rays in double and in single precision, and numbers of elements."""

    rays: np.ndarray
    single: np.ndarray
    places: np.ndarray

    @classmethod
    def empty(cls) -> RayRoom:
        """Return work space for one thread."""
        return cls(np.empty(SCRATCH), np.empty(SCRATCH, FIELD), np.empty(STRIDE, np.int32))


@inner
def _far_field(patch, field, x, y, z, rule, out):
    """Sum point loads over the patch: exponentially exact at distances above the size of the
    patch.
    """
    count = 4 * rule.shape[1]
    for i in range(rule.shape[1]):
        # 1 - rho^2 = (1 - v)^2 makes the pressure a polynomial
        rho = math.sqrt(rule[0, i] * (2.0 - rule[0, i]))
        shrink = 1.0 - rule[0, i]
        weight = rule[1, i] * shrink * shrink * patch.a * patch.b * 2.0 * math.pi / count
        for j in range(count):
            angle = 2.0 * math.pi * (j + 0.5) / count
            px, py = patch.a * rho * math.cos(angle), patch.b * rho * math.sin(angle)
            d_x, d_y = direction(patch, field, px, py)
            k = point_kernel(x - px, y - py, z)
            add_load(k, patch.friction * d_x * weight, patch.friction * d_y * weight, weight, out)


@fast
def _add_hertzian(patch, field, points, rule, room, directions, out):
    """Add the pressure, and the friction in its direction at the point, which is stored in
    `directions`.
    """
    for i in range(len(points)):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        px, py = x / patch.a, y / patch.b
        d_x = d_y = 0.0
        if patch.friction > 0.0:
            shrink = 1.0 / math.sqrt(max(px * px + py * py, 1.0))
            d_x, d_y = direction(patch, field, x * shrink, y * shrink)
        directions[i, 0], directions[i, 1] = d_x, d_y
        count = wave_angles(patch, px, py, rule, room.rays)
        sum_waves(patch, Place(x, y, z, d_x, d_y), count, room.rays, out[i])


@fast
def _add_other_directions(patch, field, points, rule, room, directions, out):
    """Add the friction less that in its direction at the point; under traction fields in their
    precision.
    """
    if not (patch.friction > 0.0 and patch.fixed == 0.0):
        return
    for i in range(len(points)):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        px, py = x / patch.a, y / patch.b
        count = rays_of_chords(
            patch, px, py, chord_angles(patch, px, py, rule, room.rays), room.rays
        )
        place = Place(x, y, z, directions[i, 0], directions[i, 1])
        if field.shape[1] > 1:
            rounded_rays(patch, count, room.rays, room.single)
            sum_rays(patch, field, place, count, rule, room.single, room.places, out[i])
        else:
            sum_rays(patch, None, place, count, rule, room.rays, room.places, out[i])


@compiled
def near_parts(patch, field, points, rules, room):
    """Compute stress parts at points in or near their patch, on the calling thread.

    Parameters
    ----------
    patch, field : record and numpy.ndarray, shape (2, ny, nx)
        Record of `patch_rows`, and traction field as in `stress_parts`.
    points : numpy.ndarray, shape (m, 3)
        x_C, y_C and depth [mm].
    rules : tuple of numpy.ndarray
        `unit_rule` of the plane waves, and of both directions of the friction integral.
    room : RayRoom
        Work space of the thread.

    Returns
    -------
    numpy.ndarray, shape (m, 4, 6)
        Stress parts per unit p_max.
    """
    out, directions = np.zeros((len(points), 4, 6)), np.empty((len(points), 2))
    _add_hertzian(patch, field, points, rules[0], room, directions, out)
    _add_other_directions(patch, field, points, rules[1], room, directions, out)
    return out


@fast
def _add_far_field(patch, field, points, rule, out):
    """Add the stresses at points far from their patch."""
    for i in range(len(points)):
        _far_field(patch, field, points[i, 0], points[i, 1], points[i, 2], rule, out[i])


@lru_cache(maxsize=128)
def unit_rule(order: int) -> np.ndarray:
    """Return nodes and weights (2, order) of `clustered_rule`; raise InputError above the size of
    the scratch array.
    """
    if not 1 <= order <= MOST_POINTS:
        raise InputError(
            "order of quadrature", order, f"1 to {MOST_POINTS}", "Ask for fewer quadrature points."
        )
    return np.stack(clustered_rule(order))


def refinement(patches: np.ndarray) -> np.ndarray:
    """Return how many times finer the rules of each patch are, 1 to 6, (n,).

    In slender patches the slip turns within a short length and needs more points.

    Parameters
    ----------
    patches : numpy.ndarray, shape (n,)
        Records of `patch_rows`.
    """
    long, short = np.maximum(patches["a"], patches["b"]), np.minimum(patches["a"], patches["b"])
    return np.clip(np.rint(np.sqrt(long / short / 2.0)), 1, 6).astype(int)


def fields_of(fields: np.ndarray | None, group: np.ndarray) -> np.ndarray:
    """Return the traction fields (m, 2, ny, nx) of the patches `group` as kernels take them;
    `NO_FIELD` for None.
    """
    if fields is None:
        return np.zeros((group.size, *NO_FIELD.shape), FIELD)
    return np.ascontiguousarray(fields[group], dtype=FIELD)


def stress_parts(
    patch: np.ndarray,
    points: np.ndarray,
    waves: int = 24,
    nodes: int = 24,
    field: np.ndarray = NO_FIELD,
) -> np.ndarray:
    """Compute stress parts per unit p_max at any points below one patch; see `stress.body_stress`.

    Parameters
    ----------
    patch : numpy.ndarray, shape ()
        Record of `patch_rows`.
    points : numpy.ndarray, shape (m, 3)
        x_C, y_C and depth z >= 0 [mm].
    waves, nodes : int
        Quadrature points; the error falls exponentially, except close to the spin pole.
    field : numpy.ndarray, shape (2, ny, nx), optional
        Traction over its bound mu p at element centres; full sliding if not given.

    Returns
    -------
    numpy.ndarray, shape (m, 4, 6)
        Stress parts [1].

    Raises
    ------
    InputError
        For more quadrature points than the kernels hold.
    """
    points = np.ascontiguousarray(points, dtype=float)
    record, field = np.atleast_1d(patch)[0], np.ascontiguousarray(field, dtype=FIELD)
    waves_rule, rule = unit_rule(waves), unit_rule(nodes)
    out = np.zeros((len(points), 4, 6))
    far = np.sum(points * points, axis=1) > 9.0 * max(patch["a"], patch["b"]) ** 2
    near = np.flatnonzero(~far)

    def work(first: int, last: int) -> None:
        some = near[first:last]
        out[some] = near_parts(record, field, points[some], (waves_rule, rule), RayRoom.empty())

    share_rows(work, near.size, 32)
    if far.any():  # the far field is compiled at its first use only
        stresses = np.zeros((int(far.sum()), 4, 6))
        _add_far_field(record, field, points[far], rule, stresses)
        out[far] = stresses
    return out


def patch_rows(ellipse, slip, friction, spin_model: int, fixed_direction=0.0) -> np.ndarray:
    """Return the records (`PATCH`) that describe n sliding patches to the kernels.

    Parameters
    ----------
    ellipse, slip : Ellipse, Slip
        Patches and their kinematics, arrays (n,).
    friction : array_like, shape (n,)
        Coefficient mu [1].
    spin_model : int
        Number of the paper's assumption, 0, 1 or 2.
    fixed_direction : array_like, shape (n,) or ()
        +-1 for a traction along +-y_C (full slip), 0 where the slip gives the direction.
    """
    a, b = ellipse.semi_axis_lateral, ellipse.semi_axis_rolling
    fixed = np.broadcast_to(np.asarray(fixed_direction, dtype=float), a.shape)
    shift = np.where(fixed == 0.0, slip.shift, 0.0)  # full slip has no spin pole
    pole_x = pole_lateral(shift, slip.sine)
    k0, k1, k2 = pole_line(a, pole_x, pole_rolling(pole_x, a, b), spin_model)
    radius = slip.guide_profile_radius
    columns = (a, b, friction, slip.sine, slip.cosine, radius, shift, fixed, pole_x, k0, k1, k2)
    rows = np.zeros(np.size(friction), PATCH)
    for name, column in zip(FIELDS, columns, strict=True):
        rows[name] = column
    return rows
