"""Compiled kernels of the stress below a sliding ellipse; `ellipse` sums them and explains the method.

The loops over waves and rays run in vector registers. Their angles and weights therefore stand in rows of a scratch
array. The formulas are inlined into these loops: a call for each wave or ray would cost more than its arithmetic (see
`numerics.compiled.inner`).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from trackroller.halfspace.influence import PRESSURE, PRESSURE_NU, SHEAR, SHEAR_NU
from trackroller.halfspace.rigid_slip import lateral_slip, pole_offset, rolling_slip_without_division
from trackroller.halfspace.vectors import angle, exp, log, sine_cosine
from trackroller.numerics.compiled import inner
from trackroller.numerics.lanes import bilinear

XX, YY, ZZ, XY, YZ, ZX = range(6)  # components of a stress

# One patch: semi-axes a, b [mm], friction coefficient, kinematics as in `contact.slip.Slip`, `fixed` direction of the
# friction along y in full slip (0 in rolling), and where the lateral slip vanishes, which covers all three spin models:
# at y = k0 + k1 (x + a) left of pole_x and at y = k0 + k2 (x - a) right of pole_x.
FIELDS = ("a", "b", "friction", "sine", "cosine", "radius", "shift", "fixed", "pole_x", "k0", "k1", "k2")
# A field of tractions may have finer elements around a point: those of equal size on the scale
# (asinh((x/a - mid)/width) - start) / span, and likewise along y. A width of 0 stands for elements of equal size. This
# point is the trailing tip of an adhesion area, which extends from low to high along each axis.
GRADES = tuple(f"{name}_{axis}" for axis in "xy" for name in ("mid", "width", "start", "span", "low", "high"))
PATCH = np.dtype([(name, np.float64) for name in (*FIELDS, *GRADES)])


class Place(NamedTuple):
    """Point x, y, z [mm] below a patch, and the direction d_x, d_y of the friction there over its bound."""

    x: float
    y: float
    z: float
    d_x: float
    d_y: float


# Rows of the scratch array: angle and weight of waves and chords, then the numbers of each ray.
STRIDE = 4104  # numbers in a row; rows of a power of two would compete for the same lines of the cache
ANGLE, WEIGHT, C, S, START, SPAN, BEHIND, LENGTH, FIELD_X, FIELD_Y = (row * STRIDE for row in range(10))
SCRATCH = 10 * STRIDE
MOST_POINTS = 1024  # points of a rule; a row holds four rays for each point


@inner
def slip_at(patch, x, y):
    """Return the rigid slip v/omega of the roller against the guide at (x, y) [mm], eq. (24)."""
    offset = pole_offset(x, patch.a, patch.k0, patch.k1, patch.k2)
    v_y = rolling_slip_without_division(x, patch.sine, patch.cosine, patch.radius, patch.shift)
    return lateral_slip(y, offset, patch.sine), v_y


@inner
def grades_of(patch):
    """Return mid, width, start and span of the grading of a field, along x and along y."""
    return (
        (patch.mid_x, patch.width_x, patch.start_x, patch.span_x),
        (patch.mid_y, patch.width_y, patch.start_y, patch.span_y),
    )


@inner
def grid_place(u, grade, count):
    """Return where u = x/a or y/b lies on the grid, in elements from the centre of the first one on."""
    mid, width, start, span = grade
    return count * ((math.asinh((u - mid) / width) - start) / span if width > 0.0 else 0.5 * (u + 1.0)) - 0.5


@inner
def grid_point(place, grade, count):
    """Return u = x/a or y/b of a place on the grid."""
    mid, width, start, span = grade
    share = (place + 0.5) / count
    return mid + width * math.sinh(start + span * share) if width > 0.0 else 2.0 * share - 1.0


@inner
def cell_of(place, count, real):
    """Return the element centre before a place on the grid and the share of the way to the next one, as `real`."""
    place = min(max(real(place), real(0.0)), real(count - 1))
    before = min(real(np.int32(place)), real(count - 2))
    return before, place - before


@inner
def interpolated(field, x, y):
    """Return the shares (x, y) of the traction bound at a place x, y on the grid, bilinear between element centres."""
    ny, nx, real = field.shape[1], field.shape[2], field.dtype.type
    (i, s), (j, t) = cell_of(x, nx, real), cell_of(y, ny, real)
    return bilinear(field.reshape(-1), int(j) * nx + int(i), nx, ny * nx, s, t)


@inner
def direction(patch, field, x, y):
    """Return the traction on the roller over its bound at (x, y): length 1 where it slides, (0, 0) at the pole."""
    if patch.fixed != 0.0:  # full slip along y_C
        return 0.0, patch.fixed
    if field.shape[1] > 1:
        along_x, along_y = grades_of(patch)
        i, j = grid_place(x / patch.a, along_x, field.shape[2]), grid_place(y / patch.b, along_y, field.shape[1])
        return interpolated(field, i, j)
    v_x, v_y = slip_at(patch, x, y)
    speed = math.sqrt(v_x * v_x + v_y * v_y)
    if speed == 0.0:
        return 0.0, 0.0
    return -v_x / speed, -v_y / speed


@inner
def spread_angles(work, at, start, end, turn, scale, rule):
    """Write angles and weights of [start, end] from place `at` on; return the next free place.

    The angles are dense near `turn` if it is an end; neighbouring angles there are about `scale` apart.
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
    """Add the stresses of `count` plane waves; their symmetric components are turned from the wave vector to x, y."""
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
    """Write angles and weights of the plane waves for the point (px a, py b); return their number."""
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
    for piece in range(3):
        start = first if piece == 0 else (low if piece == 1 else high)
        end = low if piece == 0 else (high if piece == 1 else first + math.pi)
        count = spread_angles(work, count, start, end, turn, min(a, b) / max(a, b), rule)
    return count
