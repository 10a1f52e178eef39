"""Stress in the half-space under a sliding Hertzian ellipse, exact up to the surface.

The traction on the body is p = p_max sqrt(1 - rho^2) along z and q = mu p d(x, y) with a unit direction d. At a
point the direction is split into its value d_0 there and the difference d - d_0:

- p and mu p d_0 are Hertzian, so that their stresses are a single integral over plane waves,
  sigma = 1/(2 pi^2) Re int_0^pi [A G(zeta) - i lambda z B G'(zeta)] dphi, zeta = X cos(phi) + Y sin(phi) + i lambda z,
  G = pi (2 + zeta ln((zeta - 1)/(zeta + 1))), lambda^2 = (cos(phi)/a)^2 + (sin(phi)/b)^2, where A + B k z are the
  transforms of the Boussinesq-Cerruti potentials (eqs (1)-(5); `validation/derivations/plane_waves.py`);
- mu p (d - d_0) vanishes at the point: its Cerruti integral in polar coordinates about the point has no
  singularity at any depth, including z = 0 and the edge of the patch.

Far from the patch point loads are summed over the patch instead.

Frame: x lateral, y in the rolling direction (Kalker and CONTACT: x), z into the body. Stresses are returned as parts
(4, 6) for pressure and friction, without and with the factor nu, so that one evaluation serves both bodies
(`stress.body_stress`). Components: xx, yy, zz, xy, yz, zx. x, y, z, a, b in mm; stresses per unit p_max.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from trackroller.errors import InputError
from trackroller.halfspace.ellipse_kernels import (
    FIELDS,
    MOST_POINTS,
    PATCH,
    SCRATCH,
    STRIDE,
    Place,
    direction,
    sum_waves,
    wave_angles,
)
from trackroller.halfspace.ellipse_rays import chord_angles, rays_of_chords, rounded_rays, sum_rays
from trackroller.halfspace.influence import add_load
from trackroller.halfspace.kernels import point_kernel
from trackroller.halfspace.rigid_slip import pole_lateral, pole_line, pole_rolling
from trackroller.numerics.compiled import compiled, fast, inner
from trackroller.numerics.quadrature import clustered_rule
from trackroller.numerics.threads import share_rows

FIELD = np.float32  # of traction fields: gathering their values takes most of the time of a point
NO_FIELD = np.zeros((2, 1, 1), FIELD)  # stands for a traction field in full sliding


class Room(NamedTuple):
    """Work space of one thread: rays in double and in single precision, and numbers of elements."""

    rays: np.ndarray
    single: np.ndarray
    places: np.ndarray

    @classmethod
    def empty(cls) -> Room:
        """Return work space for one thread."""
        return cls(np.empty(SCRATCH), np.empty(SCRATCH, FIELD), np.empty(STRIDE, np.int32))


@inner
def _far_field(patch, field, x, y, z, rule, out):
    """Sum point loads over the patch: exponentially exact at distances above the size of the patch."""
    count = 4 * rule.shape[1]
    for i in range(rule.shape[1]):
        rho = math.sqrt(rule[0, i] * (2.0 - rule[0, i]))  # 1 - rho^2 = (1 - v)^2 makes the pressure a polynomial
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
    """Add the pressure, and the friction in its direction at the point, which is stored in `directions`."""
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
    """Add the friction less that in its direction at the point; under traction fields in their precision."""
    if not (patch.friction > 0.0 and patch.fixed == 0.0):
        return
    for i in range(len(points)):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        px, py = x / patch.a, y / patch.b
        count = rays_of_chords(patch, px, py, chord_angles(patch, px, py, rule, room.rays), room.rays)
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
    room : Room
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
    """Return nodes and weights (2, order) of `clustered_rule`; raise InputError above the size of the scratch array."""
    if not 1 <= order <= MOST_POINTS:
        raise InputError("order of quadrature", order, f"1 to {MOST_POINTS}", "Ask for fewer quadrature points.")
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
    """Return the traction fields (m, 2, ny, nx) of the patches `group` as kernels take them; `NO_FIELD` for None."""
    if fields is None:
        return np.zeros((group.size, *NO_FIELD.shape), FIELD)
    return np.ascontiguousarray(fields[group], dtype=FIELD)


def stress_parts(
    patch: np.ndarray, points: np.ndarray, waves: int = 24, nodes: int = 24, field: np.ndarray = NO_FIELD
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
        out[some] = near_parts(record, field, points[some], (waves_rule, rule), Room.empty())

    share_rows(work, near.size, 32)
    if far.any():  # the far field is compiled at its first use only
        stresses = np.zeros((int(far.sum()), 4, 6))
        _add_far_field(record, field, points[far], rule, stresses)
        out[far] = stresses
    return out


def patch_rows(ellipse, slip, friction, spin_model: int, fixed_direction=0.0) -> np.ndarray:
    """Return the records (`ellipse_kernels.PATCH`) that describe n sliding patches to the kernels.

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
