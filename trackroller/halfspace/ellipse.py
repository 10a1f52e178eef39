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

import math

import numpy as np
from numba import njit

from trackroller.errors import InputError
from trackroller.halfspace.ellipse_kernels import (
    FIXED,
    FRICTION,
    MOST_POINTS,
    PRESSURE,
    PRESSURE_NU,
    SCRATCH,
    SHEAR,
    SHEAR_NU,
    A,
    B,
    chord_angles,
    direction,
    rays_of_chords,
    sum_rays,
    sum_waves,
    wave_angles,
)
from trackroller.halfspace.kernels import point_kernel
from trackroller.halfspace.vectors import FAST, inner
from trackroller.numerics.quadrature import clustered_rule
from trackroller.numerics.threads import share_rows

COMPONENTS = ("xx", "yy", "zz", "xy", "yz", "zx")


@inner
def _far_field(patch, field, x, y, z, rule, out):
    """Sum of point loads over the patch: exponentially exact at distances above its size."""
    count = 4 * rule.shape[1]
    for i in range(rule.shape[1]):
        rho = math.sqrt(rule[0, i] * (2.0 - rule[0, i]))  # 1 - rho^2 = (1 - v)^2 makes the pressure a polynomial
        weight = rule[1, i] * (1.0 - rule[0, i]) ** 2 * patch[A] * patch[B] * 2.0 * math.pi / count
        for j in range(count):
            angle = 2.0 * math.pi * (j + 0.5) / count
            px, py = patch[A] * rho * math.cos(angle), patch[B] * rho * math.sin(angle)
            d_x, d_y = direction(patch, field, px, py)
            q_x, q_y = patch[FRICTION] * d_x * weight, patch[FRICTION] * d_y * weight
            k = point_kernel(x - px, y - py, z)
            for c in range(6):
                out[PRESSURE, c] += weight * k[12 + c]
                out[PRESSURE_NU, c] += weight * k[30 + c]
                out[SHEAR, c] += q_x * k[c] + q_y * k[6 + c]
                out[SHEAR_NU, c] += q_x * k[18 + c] + q_y * k[24 + c]


@njit(cache=True, nogil=True, fastmath=FAST, error_model="numpy")
def _add_hertzian(first, last, patches, fields, rows, points, rule, directions, out):
    """Pressure, and friction along its direction at the point, which goes into `directions`."""
    work = np.empty(SCRATCH)
    for i in range(first, last):
        patch, x, y = patches[rows[i]], points[i, 0], points[i, 1]
        px, py = x / patch[A], y / patch[B]
        d_x = d_y = 0.0
        if patch[FRICTION] > 0.0:
            shrink = 1.0 / math.sqrt(max(px * px + py * py, 1.0))
            d_x, d_y = direction(patch, fields[rows[i]], x * shrink, y * shrink)
        directions[i, 0], directions[i, 1] = d_x, d_y
        count = wave_angles(patch, px, py, rule, work)
        sum_waves(patch, px, py, points[i, 2], d_x, d_y, count, work, out[i])


@njit(cache=True, nogil=True, fastmath=FAST, error_model="numpy")
def _add_rest_of_friction(first, last, patches, fields, rows, points, rule, directions, out):
    work = np.empty(SCRATCH)
    for i in range(first, last):
        patch, x, y, z = patches[rows[i]], points[i, 0], points[i, 1], points[i, 2]
        if patch[FRICTION] > 0.0 and patch[FIXED] == 0.0:
            px, py = x / patch[A], y / patch[B]
            count = rays_of_chords(patch, px, py, chord_angles(patch, px, py, rule, work), work)
            d_x, d_y = directions[i, 0], directions[i, 1]
            sum_rays(patch, fields[rows[i]], x, y, z, d_x, d_y, count, rule, work, out[i])


@njit(cache=True, nogil=True, fastmath=FAST, error_model="numpy")
def _add_far_field(patch, field, points, rule, out):
    for i in range(len(points)):
        _far_field(patch, field, points[i, 0], points[i, 1], points[i, 2], rule, out[i])


def unit_rule(order: int) -> np.ndarray:
    """Nodes and weights (2, order) of `clustered_rule`."""
    if not 1 <= order <= MOST_POINTS:
        raise InputError("order of quadrature", order, f"1 to {MOST_POINTS}")
    return np.stack(clustered_rule(order))


def refinement(patches: np.ndarray) -> np.ndarray:
    """How many times finer the rules of each patch are, 1 to 6: slender ones turn their slip within a short length.

    `patches` are rows of `patch_rows`, shape (n, 12).
    """
    long, short = patches[:, :2].max(axis=1), patches[:, :2].min(axis=1)
    return np.clip(np.rint(np.sqrt(long / short / 2.0)), 1, 6).astype(int)


NO_FIELD = np.zeros((2, 1, 1))


def near_parts(patches, fields, rows, points, waves: np.ndarray, rule: np.ndarray) -> np.ndarray:
    """Stress parts (m, 4, 6) per unit p_max at points (m, 3) of patches `rows` (m,), on the calling thread.

    `patches` (n, 12) and `fields` (n, 2, ny, nx) as in `stress_parts`; `waves` and `rule` are `unit_rule`s for the
    plane waves and, in both directions, for the rest of the friction. The points lie in or near their patches.
    """
    m = len(points)
    out, directions = np.zeros((m, 4, 6)), np.empty((m, 2))
    _add_hertzian(0, m, patches, fields, rows, points, waves, directions, out)
    _add_rest_of_friction(0, m, patches, fields, rows, points, rule, directions, out)
    return out


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
    patches = np.ascontiguousarray(patch, dtype=float)[None]
    fields = np.ascontiguousarray(field, dtype=float)[None]
    waves_rule, rule = unit_rule(waves), unit_rule(nodes)
    out = np.zeros((len(points), 4, 6))
    far = np.sum(points * points, axis=1) > 9.0 * max(patch[A], patch[B]) ** 2
    near = np.flatnonzero(~far)

    def work(first: int, last: int) -> None:
        some = near[first:last]
        out[some] = near_parts(patches, fields, np.zeros(some.size, np.int64), points[some], waves_rule, rule)

    share_rows(work, near.size, 32)
    if far.any():  # compiled only where somebody asks
        stresses = np.zeros((int(far.sum()), 4, 6))
        _add_far_field(patches[0], fields[0], points[far], rule, stresses)
        out[far] = stresses
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
        (zero, zero, zero),
        (pole_y, zero, zero),
        (zero, np.where(inside, k1, 0.0), np.where(inside, k2, 0.0)),
    )[spin_model]
    columns = (a, b, friction, slip.sine, slip.cosine, slip.guide_profile_radius, shift, fixed, pole_x, k0, k1, k2)
    for j, column in enumerate(columns):
        rows[:, j] = column
    return rows
