"""The largest von Mises stress in the closed half-space below a sliding Hertzian ellipse.

A coarse scan over surface and depth finds seeds; both bodies share its stress evaluations. From
each seed a pattern search with parabolas climbs; points on the surface and on the edge of the patch
are allowed. The highest point is evaluated again with finer quadrature.

Coordinates are normalised: x over a, y over b, depth over the smaller semi-axis. Stresses are per
unit p_max. The compiled functions treat one patch; with NumPy the arrays of a few points cost more
than their stresses.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from trackroller.halfspace.ellipse import (
    FIELD,
    RayRoom,
    fields_of,
    near_parts,
    refinement,
    unit_rule,
)
from trackroller.halfspace.peak_settings import PeakSettings
from trackroller.halfspace.rigid_slip import pole_offset, slip_zeros
from trackroller.halfspace.stress import FRICTION_SIGNS, von_mises_of_parts
from trackroller.numerics.compiled import assign, compiled, woven
from trackroller.numerics.rows import Rows
from trackroller.numerics.threads import share_rows

Rings = tuple[tuple[float, int], ...]


def _scan_points(surface: Rings, below: tuple[tuple[float, Rings], ...]) -> np.ndarray:
    """Return points (rho cos, rho sin, depth) in normalised coordinates, (m, 3); rings are radii
    and counts.
    """
    rows = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, -1.0, 0.0)]
    for rho, count in surface:
        angles = 2 * np.pi * (np.arange(count) + 0.5 * (count == 12)) / count
        rows += [(rho * math.cos(t), rho * math.sin(t), 0.0) for t in angles]
    for depth, rings in below:
        rows.append((0.0, 0.0, depth))
        for rho, count in rings:
            angles = 2 * np.pi * (np.arange(count) + 0.5 * (rho == 0.4)) / count
            rows += [(rho * math.cos(t), rho * math.sin(t), depth) for t in angles]
    return np.array(rows)


_DEEP = ((0.5, ((0.45, 6),)), (0.75, ((0.45, 4),)))
SCAN = _scan_points(
    ((0.3, 6), (0.53, 10), (0.75, 12), (0.92, 12), (1.0, 12)),
    ((0.12, ((0.4, 6), (0.8, 6))), (0.2, ((0.95, 8),)), (0.3, ((0.4, 6), (0.8, 6))), *_DEEP),
)
# For tractions with adhesion: in random designs the peaks lie below the centre, or on the surface
# far from the rim.
SCAN_ADHESION = _scan_points(
    ((0.3, 6), (0.53, 10), (0.78, 8), (1.0, 8)), ((0.3, ((0.6, 5),)), *_DEEP)
)

# points on the line where sliding begins, for each OF_GRID points of the grid
MOST_ON_RIDGE, OF_GRID = 128, 84
STICKS = 1.0 - 1e-4  # square of the traction over its bound below which an element sticks
NEAR_RIM = 0.98  # distance from the centre up to which the ridge is followed
SEED_WORTH = 0.85  # least stress of a seed over the largest
# The highest stress of the other kind, at the surface or below it, may lie this many times as far
# behind. Coarse rules and few elements lower a ridge at the surface by some per cent, and hardly a
# summit below it.
RIVAL_LAG = 1.5
# The rule of the summit decides between both kinds, because the rule of the polish errs otherwise
# at the surface than below it. A climb below this share of the highest one is too low for that
# error.
CLOSE_RIVAL = 0.97

# Relative change on coarser elements at the place of a peak above which the top of its hill is
# sought there, in sweeps.
FALLEN, TOP_SWEEPS = 0.03, 3

# distances from the pole over the semi-axis at which a spike begins to count, and counts in full
SPLIT = (0.02, 0.06)


def scan_points(patches: np.ndarray, slender: bool, adhesion: bool) -> np.ndarray:
    """Return the points of the scans, (n, m, 3): common points and points on the line where the
    lateral slip vanishes.

    The slip changes direction sharply on this line, which carries ridges of stress. In `slender`
    patches the slip turns within a fraction of the long axis; lines on both sides of this line and
    across the pole are added.

    Parameters
    ----------
    patches : numpy.ndarray, shape (n,)
        Records of `ellipse.patch_rows`.
    slender : bool
        True for slender patches.
    adhesion : bool
        True for tractions with adhesion, which turn smoothly: fewer points are enough, unless they
        are slender.
    """
    if adhesion and not slender:
        return np.broadcast_to(SCAN_ADHESION, (len(patches), *SCAN_ADHESION.shape))
    pole = np.clip(patches["pole_x"] / patches["a"], -1.0, 1.0)[:, None]
    share = np.array([0.15, 0.4, 0.6, 0.85])
    x = np.concatenate([pole - share * (1.0 + pole), pole + share * (1.0 - pole)], axis=1)
    u = np.stack([x, _fold(patches, x)], axis=2)
    if slender:
        u = np.concatenate(
            [
                u,
                *_beside_turn(
                    u[:, : 2 * share.size], pole, patches["a"][:, None], patches["b"][:, None]
                ),
            ],
            axis=1,
        )
    u /= np.maximum(np.hypot(u[..., 0], u[..., 1]), 1.0)[..., None]
    turning = np.concatenate([u, np.zeros((*u.shape[:2], 1))], axis=2)
    return np.concatenate([np.broadcast_to(SCAN, (len(patches), *SCAN.shape)), turning], axis=1)


@compiled
def ridge_points(patch, field):
    """Return surface points on the line where sliding begins, (m, 3); at most MOST_ON_RIDGE for
    each OF_GRID elements.

    Where a patch begins to slide, the traction changes with the root of the distance. Stresses at
    the surface have a cusp there. Nearly all peaks that a coarse scan misses lie on this line.

    Parameters
    ----------
    patch : record
        Record of `ellipse.patch_rows`.
    field : numpy.ndarray, shape (2, ny, nx)
        Traction over its bound on a grid.
    """
    _, ny, nx = field.shape
    slides = np.empty((ny, nx), np.bool_)
    for j in range(ny):
        for i in range(nx):
            slides[j, i] = field[0, j, i] ** 2 + field[1, j, i] ** 2 >= STICKS
    line, count = np.empty((ny * nx, 3)), 0
    for j in range(ny):
        for i in range(nx):
            if slides[j, i]:
                continue
            x, y = 2.0 * ((i + 0.5) / nx) - 1.0, 2.0 * ((j + 0.5) / ny) - 1.0
            if x * x + y * y >= NEAR_RIM**2:
                continue
            beside = (j > 0 and slides[j - 1, i]) or (j + 1 < ny and slides[j + 1, i])
            if beside or (i > 0 and slides[j, i - 1]) or (i + 1 < nx and slides[j, i + 1]):
                line[count, 0], line[count, 1], line[count, 2] = x, y, 0.0
                count += 1
    most = MOST_ON_RIDGE * max(1, nx // OF_GRID)
    if count > most:
        for k in range(most):
            assign(line[k], line[int(k * ((count - 1) / (most - 1)))])
        count = most
    return line[:count]


def _fold(patches: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Return the y at which the lateral slip vanishes at x, both (n, m), normalised."""
    a, *line = (patches[name][:, None] for name in ("a", "k0", "k1", "k2"))
    return pole_offset(x * a, a, *line) / patches["b"][:, None]


def spike(patches: np.ndarray) -> np.ndarray:
    """Return the friction over p_max at points where the slip vanishes apart from the spin pole,
    (n,); 0 if none.

    The rolling slip, eq. (21), vanishes at two x. The pole of eq. (22) is the first of them up to
    terms of second order. Where both slips vanish under pressure, the stress of the model grows as
    a logarithm of the distance from this point, times this friction.
    """
    sine, cosine, radius, shift = (patches[name] for name in ("sine", "cosine", "radius", "shift"))
    with np.errstate(invalid="ignore"):
        x = np.stack(slip_zeros(sine, cosine, radius, shift), axis=1) / patches["a"][:, None]
    x = np.nan_to_num(x, nan=2.0)  # no zero: a point outside the patch
    apart = np.abs(x - (patches["pole_x"] / patches["a"])[:, None])
    inside = np.maximum(1.0 - x * x - _fold(patches, x) ** 2, 0.0)
    share = np.clip((apart - SPLIT[0]) / (SPLIT[1] - SPLIT[0]), 0.0, 1.0)
    return np.where(
        patches["fixed"] == 0.0, patches["friction"] * (share * np.sqrt(inside)).max(axis=1), 0.0
    )


def _beside_turn(
    fold: np.ndarray, pole: np.ndarray, a: np.ndarray, b: np.ndarray
) -> list[np.ndarray]:
    """Return points (n, m, 2) beside the line `fold`, and on and beside the chord x = pole."""
    width = np.minimum(a, b) / np.maximum(a, b)
    shifts = [
        np.stack([np.zeros_like(width), k * np.minimum(a / b, 1.0)], axis=2) for k in (-1.0, 1.0)
    ]
    chord = np.array([-0.95, -0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75, 0.95])
    lines = []
    for k in (-3.0, -1.0, 0.0, 1.0, 3.0):
        x = np.clip(pole + k * width, -1.0, 1.0)
        y = np.sqrt(1.0 - x * x) * chord
        lines.append(np.stack([np.broadcast_to(x, y.shape), y], axis=2))
    return [fold + shift for shift in shifts] + lines


@compiled
def along_turn(patch, u, out):
    """Write the unit vector along which the slip changes its direction least at a point u (3,) into
    `out` (2,).

    In a patch long in x this is the direction of y; in a patch long in y it is the line without
    lateral slip.
    """
    out[0], out[1] = 0.0, 1.0
    if patch.a <= patch.b:
        slope = (patch.k1 if u[0] * patch.a < patch.pole_x else patch.k2) * patch.a / patch.b
        length = math.sqrt(1.0 + slope * slope)
        out[0], out[1] = 1.0 / length, slope / length


@compiled
def best_rival(depth, values, leader):
    """Return the index of the largest of `values` (m,) among the points of another kind than the
    leader; -1 if none.

    The kinds are points at the surface, with `depth` (m,) zero, and points below it. The highest
    stress at the surface and the highest below it are separate hills. `leader` is the index of a
    point.
    """
    shallow, best = depth[leader] == 0.0, -1
    for k in range(values.size):
        if (depth[k] == 0.0) != shallow and (best < 0 or values[k] > values[best]):
            best = k
    return best


@compiled
def best_seeds(points, values, count, apart):
    """Return the indices of up to `count` scan points (m, 3) with the largest `values` (m,).

    The points are `apart` from each other; they have at least the share SEED_WORTH of the largest
    value.
    """
    left, chosen, number = values.copy(), np.empty(count, np.int64), 0
    enough = SEED_WORTH * values.max()
    while number < count:
        best = left.argmax()
        if not left[best] > enough:
            break
        chosen[number] = best
        number += 1
        for k in range(left.size):
            if ((points[k] - points[best]) ** 2).sum() < apart * apart:
                left[k] = 0.0
    return chosen[:number]


PROPORTIONS = np.array([1.0, 1.6, 1.0])  # of the first steps along radius, circumference and depth
# stress at the surface over the largest, and friction, that ridges need
RIDGE_WORTH, LITTLE_FRICTION = 0.75, 0.15
# The plane waves of a scan: 24 of them, a multiple of the lanes of vector registers, cost less than
# 18.
LEAST_WAVES = 8
# points of the polish on the surface of a patch with adhesion beyond those below the surface
MORE_RAYS = 2


class Rules(NamedTuple):
    """Quadrature rules for the steps of a search: pairs of one for the plane waves and one for the
    rays.

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
        scan, climb, polish, summit = (
            settings.scan,
            settings.climb,
            settings.polish,
            settings.summit,
        )
        orders = (
            (max(scan, LEAST_WAVES * quick), scan),
            (climb, climb),
            (max(polish, 12), polish),
            (max(polish, 12), polish + MORE_RAYS * quick),
            (summit, summit),
        )
        return cls(
            *((unit_rule(waves * factor), unit_rule(rays * factor)) for waves, rays in orders)
        )


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
    room : RayRoom
        Work space of the thread.
    """

    patch: np.void
    field: np.ndarray
    poisson_ratio: np.ndarray
    unit: np.ndarray
    slender: bool
    room: RayRoom


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
    spared : numpy.ndarray of bool, shape (m,)
        Climbs that stand as the best of their kind only. They make no other climb be given up, see
        `standing`.
    """

    u: np.ndarray
    f: np.ndarray
    gained: np.ndarray
    step: np.ndarray
    along: np.ndarray
    spared: np.ndarray


def lengths(rows: np.ndarray) -> np.ndarray:
    """Return the units of normalised points, (n, 3) [mm]: a, b, and the smaller semi-axis for the
    depth.
    """
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
            out[body, k] = von_mises_of_parts(
                parts[k], target.poisson_ratio[body], FRICTION_SIGNS[body]
            )
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
    """Search along axis d (3,): both sides, then the top of the parabola; return the move over the
    step.
    """
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
    """Make the direction of the last move of climb k its first axis (Rosenbrock). The move began at
    `start` (3,).

    With `keep`, both axes exchange their steps if the new first axis is closer to the old second
    one.
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

    The whole move of the sweep is then repeated up to `ridge` times while the stress rises, each
    time over twice the last length. This follows ridges oblique to the axes. If `ridge` is above 1,
    the axes also keep their steps, see `_turn`.
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
    spared = np.zeros(2 * count, np.bool_)
    return Climbs(
        np.zeros((2 * count, 3)),
        np.full(2 * count, -1.0),
        np.zeros(2 * count),
        steps,
        along,
        spared,
    )


@compiled
def polish(target, climbs, k, rules, smallest, sweeps):
    """Let climb k rise, up to `sweeps` times, until it no longer moves; `smallest` is the last
    step.
    """
    for number in range(sweeps):
        if not sweep(target, climbs, k, rules, smallest, int(number > 0)):
            break


@woven
def _give_up(climbs, stand):
    """Give up the climbs that do not stand, (m,)."""
    for k in range(climbs.f.size):
        if not stand[k]:
            climbs.f[k] = -1.0
            climbs.spared[k] = False


@compiled
def standing(climbs, share, gap, most):
    """Return which climbs stand, (m,): up to `most` of each body and a spared one; the others are
    given up.

    The highest climb and those above its `share` stand. Of points closer than `gap` only the
    highest stands. If all of them are of one kind, the best of the other kind is spared, see
    `best_rival`: it may lie RIVAL_LAG times as far behind. A spared climb makes no other climb be
    given up, because rough rules may raise a point at the surface beside the spin pole far above
    its stress.
    """
    count = climbs.f.size // 2
    stand = np.zeros(climbs.f.size, np.bool_)
    for body in range(2):
        first = body * count
        heights = climbs.f[first : first + count]
        depth = climbs.u[first : first + count, 2]
        left = heights.copy()
        for k in range(count):
            if climbs.spared[first + k]:
                left[k] = -1.0
        leader, alone = left.argmax(), True
        highest = left[leader]
        for _ in range(min(most, count)):
            best = left.argmax()
            if not left[best] >= share * highest:
                break
            stand[first + best] = True
            left[best] = -1.0
            alone = alone and (depth[best] == 0.0) == (depth[leader] == 0.0)
            for other in range(count):
                if ((climbs.u[first + other] - climbs.u[first + best]) ** 2).sum() < gap * gap:
                    left[other] = -1.0
        rival = best_rival(depth, heights, leader)
        lowest = max((1.0 - RIVAL_LAG * (1.0 - share)) * highest, 0.0)
        if alone and rival >= 0 and heights[rival] > lowest:
            stand[first + rival] = True
            climbs.spared[first + rival] = True
    _give_up(climbs, stand)
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


APART = (0.5, 0.2)  # distance of seeds in ordinary and in slender patches
ROUGH = 48  # most elements along an axis for the first climbs, which search below merged elements
# relative distance to the highest, per finalist, below which a climb is given up
GAPS = (0.045, 0.017, 0.008)


class SearchedPatches(NamedTuple):
    """The n patches of a search.

    Attributes
    ----------
    rows : numpy.ndarray, shape (n,)
        Records of `ellipse.patch_rows`.
    fields, rough, coarse : numpy.ndarray, shape (n, 2, ny, nx)
        Traction fields; those of few elements for the first climbs; those of a coarser grid for the
        estimated error.
    poisson_ratio : numpy.ndarray, shape (n, 2)
        Poisson's ratios of roller and guide [1].
    units : numpy.ndarray, shape (n, 3)
        See `lengths`.
    points : numpy.ndarray, shape (n, m, 3)
        Points of the scans.
    """

    rows: np.ndarray
    fields: np.ndarray
    rough: np.ndarray
    coarse: np.ndarray
    poisson_ratio: np.ndarray
    units: np.ndarray
    points: np.ndarray


class Effort(NamedTuple):
    """Effort of a search: seeds and finalists of each body, distance of seeds, smallest step, kind
    of the patches.
    """

    seeds: int
    finalists: int
    apart: float
    smallest: float
    slender: bool
    gridded: bool
    adhesion: bool
    quick: bool


@dataclass(frozen=True)
class Peak(Rows):
    """Peak von Mises stress and its place; arrays (n, 2), second axis roller and guide.

    `stress` per unit p_max (in MPa below solved patches), `x`, `y`, `z` [mm], `error` the estimated
    relative error, and `change` the relative change of the stress at this place with tractions on a
    coarser grid.
    """

    stress: np.ndarray
    x: np.ndarray
    y: np.ndarray
    z: np.ndarray
    error: np.ndarray
    change: np.ndarray

    @classmethod
    def empty(cls, n: int) -> Peak:
        """Return n peaks that are NaN."""
        return cls(*(np.full((n, 2), np.nan) for _ in dataclasses.fields(cls)))

    def put(self, rows, peak: Peak) -> None:
        """Overwrite the rows by other peaks."""
        for field in dataclasses.fields(self):
            getattr(self, field.name)[rows] = getattr(peak, field.name)


@compiled
def _search_rows(first, last, patches, rules, effort, room, out):
    """Write stress, place and relative error of the peaks of patches `first` to `last` into `out`
    (n, 2, 6).
    """
    for i in range(first, last):
        row, nu, unit = patches.rows[i], patches.poisson_ratio[i], patches.units[i]
        fine = Target(row, patches.fields[i], nu, unit, effort.slender, room)
        rough = Target(row, patches.rough[i], nu, unit, effort.slender, room)
        climbs = _climbed(fine, rough, patches.points[i], rules, effort)
        _write_highest(fine, climbs, rules.summit, out[i])
        if effort.gridded:
            coarse = Target(row, patches.coarse[i], nu, unit, effort.slender, room)
            for body in range(2):
                other = stress_at(coarse, body, out[i, body, 1:4], rules.summit)
                out[i, body, 5] = abs(other / out[i, body, 0] - 1.0)
                if out[i, body, 5] > FALLEN:
                    other = _top_beside(coarse, body, out[i, body, 1:4], other, rules)
                out[i, body, 4] += abs(other / out[i, body, 0] - 1.0)


@woven
def _top_beside(coarse, body, u, height, rules):
    """Return the stress at the top of the hill of a coarse grid beside a point u (3,), where the
    stress is `height`.

    A narrow hill lies elsewhere on coarse elements, and the stress at its place on finer ones says
    little of its top.
    """
    climbs = no_climbs(1, 0.1)
    assign(climbs.u[body], u)
    climbs.f[body] = height
    along_turn(coarse.patch, u, climbs.along[body])
    rule = rules.ridge if u[2] == 0.0 else rules.polish
    for number in range(TOP_SWEEPS):
        sweep(coarse, climbs, body, rule, 0.01, int(number > 0))
    return climbs.f[body]


@woven
def _climbed(fine, rough, points, rules, effort):
    """Return climbs from the highest points of a scan, below few elements at first; the best are
    polished.
    """
    climbs = _seeded(fine, rough, points, rules, effort)
    # Tractions on a grid are less smooth than sliding ones, so that a finer rule gains little in
    # the first sweep. the scan is rough: climbs that fall behind with better quadrature are given
    # up, and sooner with every sweep
    most = max(effort.finalists, 2)
    for k in range(0 if effort.quick else len(GAPS)):
        if k == 1:
            set_steps(climbs, 0.08)
        rule = rules.scan if k == 0 and effort.gridded else rules.climb
        stand = standing(climbs, max(1.0 - GAPS[k] * most, 1e-9), 0.15 if k > 0 else 0.0, most)
        for climb in np.flatnonzero(stand):
            sweep(rough, climbs, climb, rule, 0.06, int(k > 1))
    set_steps(climbs, max(3.0 * effort.smallest, 0.01))
    for climb in np.flatnonzero(standing(climbs, 0.97, 0.1, effort.finalists)):
        rule = rules.ridge if climbs.u[climb, 2] == 0.0 else rules.polish
        climbs.f[climb] = stress_at(fine, 2 * climb // climbs.f.size, climbs.u[climb], rule)
        polish(fine, climbs, climb, rule, effort.smallest, 24 if effort.slender else 12)
    return climbs


@woven
def _write_highest(fine, climbs, rule, out):
    """Write the highest climb of each body, in normalised coordinates, into `out` (2, 6)."""
    count = climbs.f.size // 2
    for body in range(2):
        first = body * count
        heights = climbs.f[first : first + count].copy()
        rival = -1
        for k in range(count):
            if climbs.spared[first + k]:
                rival = k
                heights[k] = -1.0
        leader = heights.argmax()
        if rival < 0:
            rival = best_rival(climbs.u[first : first + count, 2], heights, leader)
        best = first + leader
        summit = stress_at(fine, body, climbs.u[best], rule)
        if rival >= 0 and climbs.f[first + rival] > CLOSE_RIVAL * climbs.f[best]:
            height = stress_at(fine, body, climbs.u[first + rival], rule)
            if height > summit:
                best = first + rival
                summit = height
        out[body, 0] = summit
        assign(out[body, 1:4], climbs.u[best])
        out[body, 4] = 4.0 * (abs(summit - climbs.f[best]) + climbs.gained[best]) / summit


@woven
def _seeded(fine, rough, points, rules, effort):
    """Scan the patch and return climbs from the highest places, below few elements at first."""
    count, values = effort.seeds, scan(rough, points, rules.scan)
    if effort.adhesion and has_ridges(fine, points, values):
        line = ridge_points(fine.patch, fine.field)
        points, values = (
            np.concatenate((points, line)),
            np.concatenate((values, scan(fine, line, rules.scan)), axis=1),
        )
    climbs = no_climbs(count + 1, 0.12)
    for body in range(2):
        k = body * (count + 1)
        seeds = best_seeds(points, values[body], count, effort.apart)
        for best in seeds:
            _start(fine, rough, climbs, k, points[best], values[body, best], rules, effort)
            k += 1
        rival = best_rival(points[:, 2], values[body], seeds[0])
        if rival < 0 or not values[body, rival] > SEED_WORTH * values[body].max():
            continue
        alone = True
        for best in seeds:
            alone = alone and (points[best, 2] == 0.0) == (points[seeds[0], 2] == 0.0)
        if alone:
            _start(fine, rough, climbs, k, points[rival], values[body, rival], rules, effort)
            climbs.spared[k] = True
    return climbs


@woven
def _start(fine, rough, climbs, k, u, height, rules, effort):
    """Let climb k start at a point u (3,) of a scan, where the stress is `height`."""
    assign(climbs.u[k], u)
    climbs.f[k] = height
    # the first sweep of the others takes the rule of the scan, see `_climbed`
    if not effort.gridded:
        climbs.f[k] = stress_at(rough, 2 * k // climbs.f.size, climbs.u[k], rules.climb)
    along_turn(fine.patch, climbs.u[k], climbs.along[k])


def _rough(fields: np.ndarray) -> np.ndarray:
    """Return fields with at most ROUGH elements along each axis for the first climbs: these stay in
    the fast caches.
    """
    while min(fields.shape[-2:]) > 4 * ROUGH:  # neighbours of so fine a grid hardly differ
        fields = np.ascontiguousarray(fields[..., ::2, ::2])
    while min(fields.shape[-2:]) > ROUGH and not (fields.shape[-1] % 2 or fields.shape[-2] % 2):
        fields = np.ascontiguousarray(_merged(fields), FIELD)
    return fields


def _merged(fields: np.ndarray) -> np.ndarray:
    """Return the mean tractions of elements of twice the size; the fields themselves for odd
    numbers of elements.
    """
    if fields.shape[-1] % 2 or fields.shape[-2] % 2:
        return fields
    blocks = [fields[..., j::2, i::2] for j in (0, 1) for i in (0, 1)]
    inside = sum(np.any(block, axis=1, keepdims=True).astype(FIELD) for block in blocks)
    return sum(blocks) / np.maximum(inside, 1)


def find_peaks(
    patches: np.ndarray,
    poisson_ratio: np.ndarray,
    settings: PeakSettings,
    fields: np.ndarray | None = None,
    coarse: np.ndarray | None = None,
    quick: bool = False,
) -> Peak:
    """Find the peak von Mises stress of roller and guide below n ellipses.

    Parameters
    ----------
    patches : numpy.ndarray, shape (n,)
        Records of `ellipse.patch_rows`.
    poisson_ratio : numpy.ndarray, shape (n, 2)
        Poisson's ratios of roller and guide [1].
    settings : PeakSettings
        Quadrature and search effort.
    fields : numpy.ndarray, shape (n, 2, ny, nx), optional
        Traction over its bound at element centres; full sliding if not given.
    coarse : numpy.ndarray, optional
        The same on a coarser grid, for the estimated error; only tractions of the exact theory,
        which have adhesion, come with it. Means over 2 x 2 elements if not given.
    quick : bool
        Polish the best seeds at once, without climbs below few elements. On 12 elements across,
        whose own error is larger, the peaks err as much as after climbs.

    Returns
    -------
    Peak
        Stresses per unit p_max and places [mm], arrays (n, 2).

    Notes
    -----
    Valid for any ellipticity and 0 <= nu <= 0.5. The estimated error contains the change from the
    quadrature of the climb to that of the summit, the last gain of the climb, and with `fields` the
    change on elements of twice the size: at the place of the peak, or from top to top of the hill
    where the stress at this place changes much.
    """
    patches = np.ascontiguousarray(patches)
    out = Peak.empty(len(patches))
    finer, units = refinement(patches), lengths(patches)
    for factor in np.unique(finer):
        group = np.flatnonzero(finer == factor)
        chosen = fields_of(fields, group)
        other = _merged(chosen) if coarse is None else coarse[group]
        slender, adhesion = bool(factor > 1), coarse is not None
        some = SearchedPatches(
            patches[group],
            chosen,
            _rough(chosen),
            np.ascontiguousarray(other, dtype=FIELD),
            np.ascontiguousarray(poisson_ratio[group], dtype=float),
            units[group],
            np.ascontiguousarray(scan_points(patches[group], slender, adhesion)),
        )
        # tractions on grids need no finer rules: at the same order, stresses err as little as in
        # round patches
        rules = Rules.of(settings, int(factor) if fields is None else 1, quick)
        effort = Effort(
            settings.seeds + 5 * slender,
            settings.finalists + 2 * slender,
            APART[slender],
            settings.step / factor,
            slender,
            fields is not None,
            adhesion,
            quick,
        )
        out.put(group, _found(some, rules, effort))
    out.error[:] += _hidden_error(patches, settings, out.stress, fields is None)
    for place, length in zip((out.x, out.y, out.z), units.T, strict=True):
        place *= length[:, None]
    return out


def _found(patches: SearchedPatches, rules: Rules, effort: Effort) -> Peak:
    """Return the peaks of patches with the same rules, in normalised coordinates."""
    peaks = np.zeros((len(patches.rows), 2, 6))

    def work(first: int, last: int) -> None:
        _search_rows(first, last, patches, rules, effort, RayRoom.empty(), peaks)

    share_rows(work, len(peaks), 2, 64)
    return Peak(*np.moveaxis(peaks, 2, 0))


def _hidden_error(
    patches: np.ndarray, settings: PeakSettings, stress: np.ndarray, slides: bool
) -> np.ndarray:
    """Return the part of the relative error (n, 2) that the changes between the steps do not
    show.
    """
    a, b, friction = patches["a"], patches["b"], patches["friction"]
    slenderness = np.maximum(a, b) / np.minimum(a, b)
    # a ridge that the search misses shows nowhere; this error was measured to grow with friction
    # and slenderness
    error = np.repeat(
        (settings.floor * (1.0 + 10.0 * friction**2 * np.sqrt(slenderness)))[:, None], 2, axis=1
    )
    # chance decides whether the search meets the spike of a logarithm, and how far it follows the
    # spike
    if slides:
        error += 4.0 * spike(patches)[:, None] / stress
    # very slender patches under friction hide ridges from a rough search: 5 % were measured at
    # `standard`
    hidden = (slenderness > 50.0) & (friction > 0)
    return error + np.where(hidden, 160.0 * settings.floor, 0.0)[:, None]
