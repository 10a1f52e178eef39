"""Compiled kernels of the friction integral along rays from a point below an ellipse; see `ellipse`.

In full sliding the rays have double precision. Tractions on a grid are known in single precision only, and so are the
sums over their rays; twice as many numbers then fit into a vector register.
"""

from __future__ import annotations

import math

import numpy as np

from trackroller.halfspace.ellipse_kernels import (
    ANGLE,
    BEHIND,
    FIELD_X,
    FIELD_Y,
    LENGTH,
    SPAN,
    START,
    WEIGHT,
    C,
    S,
    add_stress,
    cell_of,
    grades_of,
    grid_place,
    slip_at,
    spread_angles,
)
from trackroller.halfspace.influence import SHEAR, SHEAR_NU
from trackroller.halfspace.vectors import log, sine_cosine
from trackroller.numerics.compiled import inner
from trackroller.numerics.lanes import bilinear

# Least length of a ray over the semi-axis. A ray from a point on the edge to its own side has none and would divide by
# zero; in single precision the square of the shortest distance on it must stay above 1e-38.
SHORTEST = 1e-9


@inner
def chord_angles(patch, px, py, rule, work):
    """Write angles and weights of chords through the point (px a, py b); return the number of chords."""
    a, b = patch.a, patch.b
    r2 = px * px + py * py
    half = math.asin(1.0 / math.sqrt(r2)) if r2 > 1.0 else 0.5 * math.pi  # outside: the cone that meets the patch
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

    A point inside the patch has rays to both sides; from a point outside only one side meets the patch.
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
    """Write the rays in single precision into the scratch array `single`; the unit is the smaller semi-axis."""
    unit = min(patch.a, patch.b)
    for k in range(count):
        single[WEIGHT + k] = work[WEIGHT + k] / (unit * unit)
        single[LENGTH + k] = work[LENGTH + k] / unit
    for row in (C, S, START, SPAN, BEHIND):
        for k in range(count):
            single[row + k] = work[row + k]


@inner
def _on_axis(x, half, unit, grade, count):
    """Return where x lies on a grid over [-half, half], and the number of elements per length `unit`.

    On a graded grid, they are (x/half - mid)/width and its change per `unit`, see `_place_on_grade`.
    """
    mid, width, _, _ = grade
    if width > 0.0:
        return (x / half - mid) / width, unit / (half * width)
    return grid_place(x / half, grade, count), 0.5 * count * unit / half


@inner
def _place_on_grade(v, grade, count):
    """Return `grid_place` for v = (u - mid)/width, in vector registers."""
    size = abs(v)
    swept = log(size + math.sqrt(size * size + 1.0))
    return count * ((-swept if v < 0.0 else swept) - grade[2]) / grade[3] - 0.5


@inner
def _interpolate_rays(field, grades, at, per, node, count, work, places):
    """Interpolate the traction over its bound at a node of each ray, and write it into the scratch array.

    `at` is the place of the point on the grid (x, y), and `per` the number of elements per length; `places` (m,)
    serves the numbers of the elements. `grades` are those of `grades_of`, or None for elements of equal size.
    """
    real, (_, ny, nx) = work.dtype.type, field.shape
    wide = real(nx)
    for k in range(count):
        r = (work[START + k] + work[SPAN + k] * node) * work[LENGTH + k]
        x, y = at[0] + work[C + k] * r * per[0], at[1] + work[S + k] * r * per[1]
        if grades is not None:
            x, y = real(_place_on_grade(x, grades[0], nx)), real(_place_on_grade(y, grades[1], ny))
        (i, s), (j, t) = cell_of(x, nx, real), cell_of(y, ny, real)
        work[FIELD_X + k], work[FIELD_Y + k], places[k] = s, t, np.int32(j * wide + i)
    flat = field.reshape(-1)
    for k in range(count):
        shares = work[FIELD_X + k], work[FIELD_Y + k]
        work[FIELD_X + k], work[FIELD_Y + k] = bilinear(flat, places[k], nx, ny * nx, *shares)


@inner
def _stresses_of_ray(c, s, q_e, q_t, share, deep, turn):
    """Return the stresses of the friction q_e along a ray (c, s) and q_t across it, then the parts with factor nu.

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
    return stress, (cc * e_nu + ss * t_nu - across, ss * e_nu + cc * t_nu + across, cs * (e_nu - t_nu) + (cc - ss) * et)


@inner
def sum_rays(patch, field, place, count, rule, work, places, out):
    """Add the stresses of the friction along `count` rays less those of friction in the direction at the point.

    Without a `field` (None) the slip gives the direction. Under a field the rays are those of `rounded_rays`, and
    `places` (m,) serves the interpolation. The scratch array sets the precision of the sums.
    """
    real, unit = work.dtype.type, 1.0
    if field is not None:
        unit, ny, nx = min(patch.a, patch.b), field.shape[1], field.shape[2]
        grades = grades_of(patch)
        at_x, per_x = _on_axis(place.x, patch.a, unit, grades[0], nx)
        at_y, per_y = _on_axis(place.y, patch.b, unit, grades[1], ny)
        at, per = (real(at_x), real(at_y)), (real(per_x), real(per_y))
    x, y, z, d_x, d_y = real(place.x), real(place.y), real(place.z / unit), real(place.d_x), real(place.d_y)
    one = real(1.0)
    xx = yy = xy = zz = yz = zx = n_xx = n_yy = n_xy = real(0.0)
    for i in range(rule.shape[1]):
        node, rest, share = real(rule[0, i]), real(1.0 - rule[0, i]), real(rule[1, i])
        if field is not None:
            if grades[0][1] > 0.0:
                _interpolate_rays(field, grades, at, per, node, count, work, places)
            else:
                _interpolate_rays(field, None, at, per, node, count, work, places)
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
            stress, by_nu = _stresses_of_ray(c, s, along, across, r * inv_rho, z * inv_rho, rho * rho * inv)
            xx, yy, zz = xx + stress[0], yy + stress[1], zz + stress[2]
            xy, yz, zx = xy + stress[3], yz + stress[4], zx + stress[5]
            n_xx, n_yy, n_xy = n_xx + by_nu[0], n_yy + by_nu[1], n_xy + by_nu[2]
    add_stress(out, SHEAR, xx + n_xx, yy + n_yy, zz, xy + n_xy, yz, zx)
    add_stress(out, SHEAR_NU, -2.0 * n_xx, -2.0 * n_yy, 0.0, -2.0 * n_xy, 0.0, 0.0)
