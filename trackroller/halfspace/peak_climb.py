"""Climb from seeds to the highest von Mises stress below an ellipse by a pattern search with parabolas.

Coordinates are normalised: x over a, y over b, depth over the smaller semi-axis. Stresses are per unit p_max. All
functions are compiled and treat one patch; with NumPy the arrays of a few points cost more than their stresses.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from trackroller.halfspace.ellipse import Room, near_parts, unit_rule
from trackroller.halfspace.peak_settings import PeakSettings
from trackroller.halfspace.stress import FRICTION_SIGNS, von_mises_of_parts
from trackroller.numerics.compiled import assign, compiled, woven

PROPORTIONS = np.array([1.0, 1.6, 1.0])  # of the first steps along radius, circumference and depth
RIDGE_WORTH, LITTLE_FRICTION = 0.75, 0.15  # stress at the surface over the largest, and friction, that ridges need
# The plane waves of a scan: 24 of them, a multiple of the lanes of vector registers, cost less than 18.
LEAST_WAVES = 8
MORE_RAYS = 2  # points of the polish on the surface of a patch with adhesion beyond those below the surface


class Rules(NamedTuple):
    """Quadrature rules for the steps of a search: pairs of one for the plane waves and one for the rays.

    `ridge` serves the polish on the surface, where tractions with adhesion cause ridges of stress.
    """

    scan: tuple[np.ndarray, np.ndarray]
    climb: tuple[np.ndarray, np.ndarray]
    polish: tuple[np.ndarray, np.ndarray]
    ridge: tuple[np.ndarray, np.ndarray]
    summit: tuple[np.ndarray, np.ndarray]

    @classmethod
    def of(cls, settings: PeakSettings, factor: int, quick: bool) -> Rules:
        """Return the rules of patches whose rules are refined by a factor."""
        scan, climb, polish, summit = settings.scan, settings.climb, settings.polish, settings.summit
        orders = (
            (max(scan, LEAST_WAVES * quick), scan),
            (climb, climb),
            (max(polish, 12), polish),
            (max(polish, 12), polish + MORE_RAYS * quick),
            (summit, summit),
        )
        return cls(*((unit_rule(waves * factor), unit_rule(rays * factor)) for waves, rays in orders))


class Target(NamedTuple):
    """The patch of a search.

    Attributes
    ----------
    patch : record
        Record of `ellipse.patch_rows`.
    field : numpy.ndarray, shape (2, ny, nx)
        Traction field.
    poisson_ratio : numpy.ndarray, shape (2,)
        Poisson's ratios of roller and guide [1].
    unit : numpy.ndarray, shape (3,)
        Units of normalised points [mm], see `lengths`.
    slender : bool
        True if the quadrature rules of the patch are refined.
    room : Room
        Work space of the thread.
    """

    patch: np.void
    field: np.ndarray
    poisson_ratio: np.ndarray
    unit: np.ndarray
    slender: bool
    room: Room


class Climbs(NamedTuple):
    """Points that climb towards the highest stress in one patch; those of the roller come first.

    Attributes
    ----------
    u, f : numpy.ndarray, shape (m, 3) and (m,)
        Normalised points and their stress; -1 for a climb that was given up.
    gained : numpy.ndarray, shape (m,)
        Increase of the stress in the last sweep.
    step : numpy.ndarray, shape (m, 3)
        Steps along radius, circumference and depth.
    along : numpy.ndarray, shape (m, 2)
        Direction of the first axis.
    """

    u: np.ndarray
    f: np.ndarray
    gained: np.ndarray
    step: np.ndarray
    along: np.ndarray


def lengths(rows: np.ndarray) -> np.ndarray:
    """Return the units of normalised points, (n, 3) [mm]: a, b, and the smaller semi-axis for the depth."""
    a, b = rows["a"], rows["b"]
    return np.stack([a, b, np.minimum(a, b)], axis=1)


@compiled
def stresses_at(target, body, u, rules):
    """Return the von Mises stresses (m,) in `body` (0 or 1) at normalised points u (m, 3)."""
    parts = near_parts(target.patch, target.field, u * target.unit, rules, target.room)
    out = np.empty(len(u))
    for k in range(len(u)):
        out[k] = von_mises_of_parts(parts[k], target.poisson_ratio[body], FRICTION_SIGNS[body])
    return out


@compiled
def stress_at(target, body, u, rules):
    """Return the von Mises stress in `body` (0 or 1) at a normalised point u (3,)."""
    return stresses_at(target, body, u.reshape(1, 3), rules)[0]


@compiled
def scan(target, points, rules):
    """Return the von Mises stresses of both bodies at normalised points (m, 3), as (2, m)."""
    parts = near_parts(target.patch, target.field, points * target.unit, rules, target.room)
    out = np.empty((2, len(points)))
    for body in range(2):
        for k in range(len(points)):
            out[body, k] = von_mises_of_parts(parts[k], target.poisson_ratio[body], FRICTION_SIGNS[body])
    return out


@woven
def set_steps(climbs, size):
    """Set the steps of all climbs to `size`."""
    for k in range(climbs.f.size):
        assign(climbs.step[k], size * PROPORTIONS)


@compiled
def _project(u):
    """Move a point u (3,) to the nearest point of the closed half-space below the patch."""
    r = math.sqrt(u[0] * u[0] + u[1] * u[1])
    if r > 1.0:
        u[0] /= r
        u[1] /= r
    u[2] = max(u[2], 0.0)


@compiled
def try_place(target, climbs, k, u, rules):
    """Move climb k to the point nearest to u (3,) if the stress is higher there."""
    _project(u)
    value = stress_at(target, 2 * k // climbs.f.size, u, rules)
    if value > climbs.f[k]:
        assign(climbs.u[k], u)
        climbs.f[k] = value


@woven
def _axes(target, climbs, k, axes):
    """Write the axes (3, 3) of the pattern of climb k: radius, circumference and depth.

    Slender patches have narrow ridges; inside the rim the first axis lies along the ridge.
    """
    x, y = climbs.u[k, 0], climbs.u[k, 1]
    r = math.sqrt(x * x + y * y)
    c, s = (x / r, y / r) if r > 1e-9 else (1.0, 0.0)
    if target.slender and x * x + y * y < 0.998:
        c, s = climbs.along[k, 0], climbs.along[k, 1]
    axes[:] = 0.0
    axes[0, 0], axes[0, 1], axes[1, 0], axes[1, 1], axes[2, 2] = c, s, -s, c, 1.0


@woven
def _along(target, climbs, k, axis, d, rules):
    """Search along axis d (3,): both sides, then the top of the parabola; return the move over the step."""
    u_0, f_0, step = climbs.u[k].copy(), climbs.f[k], climbs.step[k, d]
    sides, heights = np.empty((2, 3)), np.full(2, f_0)
    assign(sides[0], u_0 + step * axis)
    assign(sides[1], u_0 - step * axis)
    fresh = np.empty(2, np.bool_)
    for side in range(2):
        _project(sides[side])
        fresh[side] = np.abs(sides[side] - u_0).sum() >= 1e-12
    found, count = stresses_at(target, 2 * k // climbs.f.size, sides[fresh], rules), 0
    for side in range(2):
        if fresh[side]:
            heights[side] = found[count]
            count += 1
        if heights[side] > climbs.f[k]:
            assign(climbs.u[k], sides[side])
            climbs.f[k] = heights[side]
    curve = heights[0] - 2.0 * f_0 + heights[1]
    if curve < 0.0:
        jump = min(max(0.5 * step * (heights[1] - heights[0]) / curve, -2.0 * step), 2.0 * step)
        if abs(jump) > 0.05 * step and abs(abs(jump) - step) > 0.05 * step:
            try_place(target, climbs, k, u_0 + jump * axis, rules)
    distance = np.abs(climbs.u[k] - u_0).sum()
    if distance < 0.5 * step:
        climbs.step[k, d] = 0.35 * step
    elif target.slender and distance > 1.5 * step:
        climbs.step[k, d] = 1.5 * step
    return distance / step


@woven
def _turn(climbs, k, start, keep):
    """Make the direction of the last move of climb k its first axis (Rosenbrock). The move began at `start` (3,).

    With `keep`, both axes exchange their steps if the new first axis is closer to the old second one.
    """
    x, y = climbs.u[k, 0] - start[0], climbs.u[k, 1] - start[1]
    length = math.sqrt(x * x + y * y)
    if length > 1e-5:
        x, y = x / length, y / length
        if keep and abs(x * climbs.along[k, 0] + y * climbs.along[k, 1]) < 0.7:
            climbs.step[k, 0], climbs.step[k, 1] = climbs.step[k, 1], climbs.step[k, 0]
        climbs.along[k, 0], climbs.along[k, 1] = x, y


@compiled
def sweep(target, climbs, k, rules, smallest, ridge):
    """Search along radius, circumference and depth in turn; return whether climb k still moves.

    The whole move of the sweep is then repeated up to `ridge` times while the stress rises, each time over twice the
    last length. This follows ridges oblique to the axes. If `ridge` is above 1, the axes also keep their steps, see
    `_turn`.
    """
    before, start, axes = climbs.f[k], climbs.u[k].copy(), np.empty((3, 3))
    _axes(target, climbs, k, axes)
    moved = 0.0
    for d in range(3):
        moved = max(moved, _along(target, climbs, k, axes[d], d, rules))
    move = climbs.u[k] - start
    if (move**2).sum() > 1e-8:
        for _ in range(ridge):
            height = climbs.f[k]
            try_place(target, climbs, k, climbs.u[k] + move, rules)
            if not climbs.f[k] > height:
                break
            move *= 2.0
    if target.slender:
        _turn(climbs, k, start, ridge > 1)
    climbs.gained[k] = climbs.f[k] - before
    widest = climbs.step[k].max()
    still = climbs.gained[k] < 1e-6 * climbs.f[k] and moved < 1e-9 and widest < 4.0 * smallest
    return not (widest < smallest or still)


@compiled
def no_climbs(count, step):
    """Return climbs that are still given up, `count` in each body, with a first step."""
    steps, along = step * PROPORTIONS * np.ones((2 * count, 3)), np.zeros((2 * count, 2))
    along[:, 1] = 1.0
    return Climbs(np.zeros((2 * count, 3)), np.full(2 * count, -1.0), np.zeros(2 * count), steps, along)


@compiled
def polish(target, climbs, k, rules, smallest, sweeps):
    """Let climb k rise, up to `sweeps` times, until it no longer moves; `smallest` is the last step."""
    for number in range(sweeps):
        if not sweep(target, climbs, k, rules, smallest, int(number > 0)):
            break


@compiled
def standing(climbs, share, gap, most):
    """Return which climbs stand, (m,): up to `most` of each body; the others are given up.

    The highest climb and those above its `share` stand. Of points closer than `gap` only the highest stands.
    """
    count = climbs.f.size // 2
    stand = np.zeros(climbs.f.size, np.bool_)
    for body in range(2):
        first = body * count
        left = climbs.f[first : first + count].copy()
        enough = share * left.max()
        for _ in range(min(most, count)):
            best = left.argmax()
            if not left[best] >= enough:
                break
            stand[first + best] = True
            left[best] = -1.0
            for other in range(count):
                if ((climbs.u[first + other] - climbs.u[first + best]) ** 2).sum() < gap * gap:
                    left[other] = -1.0
    for k in range(climbs.f.size):
        if not stand[k]:
            climbs.f[k] = -1.0
    return stand


@woven
def has_ridges(target, points, values):
    """Return whether a stress at the surface is not far below the largest in one of the bodies."""
    if target.patch.friction <= LITTLE_FRICTION:
        return False
    for body in range(2):
        surface = 0.0
        for k in range(len(points)):
            if points[k, 2] == 0.0:
                surface = max(surface, values[body, k])
        if surface > RIDGE_WORTH * values[body].max():
            return True
    return False
