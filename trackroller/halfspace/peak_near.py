"""Climb from peaks at hand and from the line where sliding begins, which may be far smaller than the patch.

Coordinates and stresses are those of `peak_climb`.
"""

from __future__ import annotations

import numpy as np

from trackroller.halfspace.peak_climb import PROPORTIONS, no_climbs, polish, scan, standing, stress_at, sweep, try_place
from trackroller.halfspace.peak_seeds import along_turn, best_seeds
from trackroller.numerics.compiled import assign, compiled, woven

NEAR_STEP = 0.04  # first step of climbs from peaks at hand
# Climbs from the line where sliding begins: their number in each body, and the largest number of points of the line;
# over the extent of the line, the distance of their starts, the first step and the last.
LINE_SEEDS, LINE_POINTS, LINE_APART, LINE_STEP, LINE_SMALLEST = 4, 60, 0.1, 0.08, 0.01
LINE_FROM = 0.93  # least stress at their starts, over that at the peak at hand
# After LINE_SWEEPS sweeps, at most LINE_STAND climbs in each body go on, the highest ones. A climb ends there if its
# stress is below LINE_WORTH of the highest, or if a higher climb is closer than LINE_GAP times the smaller extent of
# the line. If LINE_STAND was 3, some peaks were 0.2 to 0.7 % too low.
LINE_SWEEPS, LINE_STAND, LINE_WORTH, LINE_GAP = 2, 4, 0.96, 0.1
RIDGE = 3  # a sweep repeats its whole move up to this many times, see `sweep`
# After the first number of sweeps, a climb ends when a sweep raises its stress by less than the second number, a share.
SETTLED = 4, 2e-4
OUTSIDE = 0.03, 0.08  # distances of more points outside the line, over its extent: a cusp may lie beside it
AROUND = 0.15  # distance from the ends of the adhesion area up to which points count as at it, over its extent
LEAST_LINE = 1e-3  # extent of a line of few points
# The traction turns about the trailing tip of an adhesion area: points around the tip, over the extent of the line.
TIP_ACROSS, TIP_ALONG = (-0.12, -0.04, 0.04, 0.12), (-0.06, -0.03, -0.01, 0.02, 0.06, 0.12)
# More points around the tip, on the ridges beside the adhesion area and far from it, over the extent of the line: the
# highest stress may lie there, above all in slender patches.
AWAY_ACROSS, AWAY_ALONG = (-1.8, -1.1, -0.5, 0.0, 0.5, 1.1, 1.8), (-2.4, -1.2, -0.6, 0.7, 1.2, 2.4)


@compiled
def _at_area(patch, points):
    """Return those of the points (m, 3) in the rectangle around the adhesion area, widened by AROUND on each side."""
    more_x, more_y = AROUND * (patch.high_x - patch.low_x), AROUND * (patch.high_y - patch.low_y)
    x, y = points[:, 0], points[:, 1]
    near_x = (x >= patch.low_x - more_x) & (x <= patch.high_x + more_x)
    return points[near_x & (y >= patch.low_y - more_y) & (y <= patch.high_y + more_y)]


@woven
def _extent(line):
    """Return the extents of a line of points on the surface (m, 3) along x and y, and the smaller one, (3,)."""
    size = np.full(3, LEAST_LINE)
    if len(line):
        for d in range(2):
            size[d] = max(LEAST_LINE, line[:, d].max() - line[:, d].min())
    size[2] = min(size[0], size[1])
    return size


@woven
def _around_tip(patch, size, across, along):
    """Return a grid of points on the surface around the trailing tip of the adhesion area, (m, 3).

    `across` and `along` are the distances of its columns and rows from the tip along x and y, in units of `size`, the
    extents of the line where sliding begins (`_extent`). The tip is where the points of the field are densest.
    """
    out = np.zeros((len(across) * len(along), 3))
    for k in range(len(out)):
        out[k, 0] = patch.mid_x + across[k % len(across)] * size[0]
        out[k, 1] = patch.mid_y + along[k // len(across)] * size[1]
    return out


@woven
def _seed_line(target, climbs, line, size, rough, first):
    """Start climbs of both bodies on, beside and far from the points `line` (m, 3); the first climb of each body stays.

    The second climb of each body starts at the trailing tip.
    """
    around = _around_tip(target.patch, size, TIP_ACROSS, TIP_ALONG)
    away = _around_tip(target.patch, size, AWAY_ACROSS, AWAY_ALONG)
    if len(line) > LINE_POINTS:
        line = line[:: len(line) // LINE_POINTS + 1].copy()
    out_of = line - line.sum(0) / len(line)
    line = np.concatenate((around, line, line + OUTSIDE[0] * out_of, line + OUTSIDE[1] * out_of, away))
    values = scan(target, line, rough)
    for body in range(2):
        k = body * (2 + LINE_SEEDS)
        enough = LINE_FROM * climbs.f[k]
        tip = values[body, : len(around)].argmax()
        k += 1
        assign(climbs.u[k], line[tip])
        climbs.f[k] = stress_at(target, body, line[tip], first)
        for best in best_seeds(line / size, values[body], LINE_SEEDS, LINE_APART):
            k += 1
            if values[body, best] > enough:
                assign(climbs.u[k], line[best])
                climbs.f[k] = stress_at(target, body, line[best], first)


@woven
def climb_near(target, near, line, rough, first, rules, smallest):
    """Climb from the peaks at hand and from the points where sliding begins, and return the climbs.

    The steps of climbs from the line follow from its extents, so that an adhesion area far smaller than the patch is
    searched as closely as a large one, and a narrow one across as closely as along.

    Parameters
    ----------
    target : Target
        The patch.
    near : numpy.ndarray, shape (2, 3)
        Normalised places of the peaks at hand.
    line : numpy.ndarray, shape (m, 3)
        Normalised points where sliding begins, on the surface.
    rough, first, rules : tuple of numpy.ndarray
        Quadrature rules: to choose the starts, for the first sweeps, and for the later ones.
    smallest : float
        Last step of the climbs from the peaks at hand.
    """
    count = 2 + LINE_SEEDS
    line = _at_area(target.patch, line)
    size = _extent(line)
    climbs = no_climbs(count, 1.0)
    for d, axis in enumerate((1, 0, 2)):  # the first axis is that of y, see `no_climbs`
        climbs.step[:, d] = LINE_STEP * size[axis]
    least = np.full(2 * count, LINE_SMALLEST * size[2])
    for body in range(2):
        k = body * count
        assign(climbs.u[k], near[body])
        if not len(line) or not len(_at_area(target.patch, near[body : body + 1])):
            assign(climbs.step[k], NEAR_STEP * PROPORTIONS)
            least[k] = smallest
            along_turn(target.patch, near[body], climbs.along[k])
        climbs.f[k] = stress_at(target, body, near[body], first)
    if len(line):
        _seed_line(target, climbs, line, size, rough, first)
    left, start = climbs.f > 0.0, climbs.u.copy()
    for k in range(24):
        if k == LINE_SWEEPS:
            left = standing(climbs, LINE_WORTH, LINE_GAP * size[2], LINE_STAND)
            # The rule of the first sweeps has few points. By the finer rule, a climb may be lower than its start, and
            # the peak at hand or the tip, if given up, may be higher than the climbs that were kept.
            lost = ~left & (np.arange(2 * count) % count < 2)
            for climb in np.concatenate((np.flatnonzero(left), np.flatnonzero(lost))):
                body = climb // count
                best = climbs.f[body * count : (body + 1) * count].max()
                climbs.f[climb] = stress_at(target, body, climbs.u[climb], rules)
                try_place(target, climbs, climb, start[climb], rules)
                left[climb] = left[climb] or climbs.f[climb] > best
        for climb in np.flatnonzero(left):
            moves = sweep(target, climbs, climb, first if k < LINE_SWEEPS else rules, least[climb], RIDGE * (k > 0))
            left[climb] = moves and (k < SETTLED[0] or climbs.gained[climb] > SETTLED[1] * climbs.f[climb])
    _exchange(target, climbs, rules, LINE_SMALLEST * size[2])
    return climbs


@woven
def _exchange(target, climbs, rules, smallest):
    """Climb in each body from the place of the other body's highest stress, which its own climbs may have missed."""
    count = climbs.f.size // 2
    best = climbs.f[:count].argmax(), count + climbs.f[count:].argmax()
    places = climbs.u[best[0]].copy(), climbs.u[best[1]].copy()
    if ((places[1] - places[0]) ** 2).sum() < smallest * smallest:
        return
    for body in range(2):
        k, place = body * count + (best[body] == body * count), places[1 - body]
        value = stress_at(target, body, place, rules)
        if value > LINE_WORTH * climbs.f[best[body]]:
            assign(climbs.u[k], place)
            assign(climbs.step[k], 5.0 * smallest * PROPORTIONS)
            climbs.f[k] = value
            polish(target, climbs, k, rules, smallest, 12)
