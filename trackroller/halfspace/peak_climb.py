"""Climb from seeds to the highest von Mises stress below an ellipse by a pattern search with parabolas.

Coordinates are normalised: x over a, y over b, depth over the smaller semi-axis. Stresses are per unit p_max. All
functions are compiled and treat one patch; with NumPy the arrays of a few points cost more than their stresses.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from trackroller.halfspace.ellipse import Room, near_parts
from trackroller.halfspace.peak_seeds import best_seeds
from trackroller.halfspace.stress import FRICTION_SIGNS, von_mises_of_parts
from trackroller.numerics.compiled import compiled

PROPORTIONS = np.array([1.0, 1.6, 1.0])  # of the first steps along radius, circumference and depth
RIDGE_WORTH, LITTLE_FRICTION = 0.75, 0.15  # stress at the surface over the largest, and friction, that ridges need
# Climbs from the line where sliding begins: seeds of each body, most points of the line, and over the size of the line
# the distance of the seeds, the first step, and the last.
LINE_SEEDS, LINE_POINTS, LINE_APART, LINE_STEP, LINE_SMALLEST = 3, 200, 0.2, 0.08, 0.004
LINE_SWEEPS, LINE_WORTH = 3, 0.998  # after so many sweeps, a climb below this share of the highest stress is given up
OUTSIDE = 0.02, 0.05, 0.1  # distances of more points outside the line, over its size: a cusp may lie beside it
LEAST_LINE = 0.01  # size of a line of few points


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


@compiled
def _project(u):
    """Move a point u (3,) to the nearest point of the closed half-space below the patch."""
    r = math.sqrt(u[0] * u[0] + u[1] * u[1])
    if r > 1.0:
        u[0] /= r
        u[1] /= r
    u[2] = max(u[2], 0.0)


@compiled
def _try(target, climbs, k, u, rules):
    """Move climb k to the point nearest to u (3,) if the stress is higher there."""
    _project(u)
    value = stress_at(target, 2 * k // climbs.f.size, u, rules)
    if value > climbs.f[k]:
        climbs.u[k], climbs.f[k] = u, value


@compiled
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


@compiled
def _along(target, climbs, k, axis, d, rules):
    """Search along axis d (3,): both sides, then the top of the parabola; return the move over the step."""
    u_0, f_0, step = climbs.u[k].copy(), climbs.f[k], climbs.step[k, d]
    sides, heights = np.empty((2, 3)), np.full(2, f_0)
    sides[0], sides[1] = u_0 + step * axis, u_0 - step * axis
    fresh = np.empty(2, np.bool_)
    for side in range(2):
        _project(sides[side])
        fresh[side] = np.abs(sides[side] - u_0).sum() >= 1e-12
    heights[fresh] = stresses_at(target, 2 * k // climbs.f.size, sides[fresh], rules)
    for side in range(2):
        if heights[side] > climbs.f[k]:
            climbs.u[k], climbs.f[k] = sides[side], heights[side]
    curve = heights[0] - 2.0 * f_0 + heights[1]
    if curve < 0.0:
        jump = min(max(0.5 * step * (heights[1] - heights[0]) / curve, -2.0 * step), 2.0 * step)
        if abs(jump) > 0.05 * step and abs(abs(jump) - step) > 0.05 * step:
            _try(target, climbs, k, u_0 + jump * axis, rules)
    distance = np.abs(climbs.u[k] - u_0).sum()
    if distance < 0.5 * step:
        climbs.step[k, d] = 0.35 * step
    elif target.slender and distance > 1.5 * step:
        climbs.step[k, d] = 1.5 * step
    return distance / step


@compiled
def _turn(climbs, k, start):
    """Turn the first axis of climb k into the direction of its move from `start` (3,) (Rosenbrock)."""
    x, y = climbs.u[k, 0] - start[0], climbs.u[k, 1] - start[1]
    length = math.sqrt(x * x + y * y)
    if length > 1e-5:
        climbs.along[k, 0], climbs.along[k, 1] = x / length, y / length


@compiled
def sweep(target, climbs, k, rules, smallest, ridge):
    """Search along radius, circumference and depth in turn; return whether climb k still moves.

    With `ridge` a further step repeats the whole move of this sweep, which follows ridges oblique to the axes.
    """
    before, start, axes = climbs.f[k], climbs.u[k].copy(), np.empty((3, 3))
    _axes(target, climbs, k, axes)
    moved = 0.0
    for d in range(3):
        moved = max(moved, _along(target, climbs, k, axes[d], d, rules))
    if ridge and ((climbs.u[k] - start) ** 2).sum() > 1e-8:
        _try(target, climbs, k, 2.0 * climbs.u[k] - start, rules)
    if target.slender:
        _turn(climbs, k, start)
    climbs.gained[k] = climbs.f[k] - before
    widest = climbs.step[k].max()
    still = climbs.gained[k] < 1e-6 * climbs.f[k] and moved < 1e-9 and widest < 4.0 * smallest
    return not (widest < smallest or still)


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


@compiled
def _climb(target, climbs, rules, smallest):
    """Let all climbs rise, up to 24 sweeps each, without those that fall behind; `smallest` is the last step."""
    left = climbs.f > 0.0
    for k in range(24):
        if k == LINE_SWEEPS:
            left &= standing(climbs, LINE_WORTH, 0.0, LINE_SEEDS)
        for climb in np.flatnonzero(left):
            left[climb] = sweep(target, climbs, climb, rules, smallest, k > 0)


@compiled
def climb_from_line(target, line, first, rules, summit, out):
    """Replace the peaks of both bodies in `out` (2, 6) by higher ones near the points `line` (m, 3) on the surface.

    The steps of the climbs follow from the size of the line, so that an adhesion area far smaller than the patch is
    searched as closely as a large one. `first`, `rules` and `summit` are quadrature rules.
    """
    if len(line) > LINE_POINTS:
        line = line[:: len(line) // LINE_POINTS + 1].copy()
    if len(line) == 0:
        return
    size, centre = LEAST_LINE, np.zeros(3)
    for d in range(2):
        size, centre[d] = max(size, line[:, d].max() - line[:, d].min()), line[:, d].mean()
    out_of = line - centre
    line = np.concatenate((line, line + OUTSIDE[0] * out_of, line + OUTSIDE[1] * out_of, line + OUTSIDE[2] * out_of))
    values = scan(target, line, first)
    count = LINE_SEEDS
    steps = LINE_STEP * size * PROPORTIONS * np.ones((2 * count, 3))
    places, heights, gained, along = (
        np.zeros((2 * count, 3)),
        np.full(2 * count, -1.0),
        np.zeros(2 * count),
        np.zeros((2 * count, 2)),
    )
    climbs = Climbs(places, heights, gained, steps, along)
    climbs.along[:, 1] = 1.0
    for body in range(2):
        k = body * count
        for best in best_seeds(line, values[body], count, LINE_APART * size):
            climbs.u[k] = line[best]
            climbs.f[k] = stress_at(target, body, line[best], rules)
            k += 1
    _climb(target, climbs, rules, LINE_SMALLEST * size)
    for body in range(2):
        best = body * count + climbs.f[body * count : (body + 1) * count].argmax()
        top = stress_at(target, body, climbs.u[best], summit)
        if top > out[body, 0]:
            out[body, 0], out[body, 1:4] = top, climbs.u[best]
            out[body, 4] = 4.0 * (abs(top - climbs.f[best]) + climbs.gained[best]) / top


@compiled
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
