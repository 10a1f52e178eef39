"""Climb from peaks at hand and from the line where sliding begins, which may be far smaller than the patch.

Coordinates and stresses are those of `peak_climb`.
"""

from __future__ import annotations

import numpy as np

from trackroller.halfspace.peak_climb import PROPORTIONS, no_climbs, polish, scan, standing, stress_at, sweep
from trackroller.halfspace.peak_seeds import along_turn, best_seeds
from trackroller.numerics.compiled import compiled

NEAR_STEP = 0.04  # first step of climbs from peaks at hand
# Climbs from the line where sliding begins: their number in each body, and the largest number of points of the line;
# over the size of the line, the distance of their starts, the first step and the last.
LINE_SEEDS, LINE_POINTS, LINE_APART, LINE_STEP, LINE_SMALLEST = 4, 100, 0.1, 0.08, 0.004
LINE_FROM = 0.93  # least stress at their starts, over that at the peak at hand
# After LINE_SWEEPS sweeps, a climb is given up whose stress is below LINE_WORTH of the highest, or which is closer to a
# higher climb than LINE_GAP times the size of the line.
LINE_SWEEPS, LINE_WORTH, LINE_GAP = 3, 0.99, 0.03
OUTSIDE = 0.03, 0.08  # distances of more points outside the line, over its size: a cusp may lie beside it
LEAST_LINE = 0.01  # size of a line of few points


@compiled
def _size(line):
    """Return the size of a line of points on the surface (m, 3)."""
    size = LEAST_LINE
    for d in range(2):
        size = max(size, line[:, d].max() - line[:, d].min())
    return size


@compiled
def _seed_line(target, climbs, line, size, first):
    """Start climbs of both bodies on and beside the points `line` (m, 3); the first climb of each body stays."""
    if len(line) > LINE_POINTS:
        line = line[:: len(line) // LINE_POINTS + 1].copy()
    centre = np.zeros(3)
    for d in range(2):
        centre[d] = line[:, d].mean()
    out_of = line - centre
    line = np.concatenate((line, line + OUTSIDE[0] * out_of, line + OUTSIDE[1] * out_of))
    values = scan(target, line, first)
    for body in range(2):
        k = body * (1 + LINE_SEEDS)
        enough = LINE_FROM * climbs.f[k]
        for best in best_seeds(line, values[body], LINE_SEEDS, LINE_APART * size):
            k += 1
            if values[body, best] > enough:
                climbs.u[k], climbs.f[k] = line[best], values[body, best]


@compiled
def climb_near(target, near, line, first, rules, smallest):
    """Climb from the peaks at hand and from the points where sliding begins, and return the climbs.

    The steps of climbs from the line follow from its size, so that an adhesion area far smaller than the patch is
    searched as closely as a large one.

    Parameters
    ----------
    target : Target
        The patch.
    near : numpy.ndarray, shape (2, 3)
        Normalised places of the peaks at hand.
    line : numpy.ndarray, shape (m, 3)
        Normalised points where sliding begins, on the surface.
    first, rules : tuple of numpy.ndarray
        Quadrature rules of the first sweeps and of the others.
    smallest : float
        Last step of the climbs from the peaks at hand.
    """
    count = 1 + LINE_SEEDS
    size = _size(line) if len(line) else LEAST_LINE
    climbs = no_climbs(count, LINE_STEP * size)
    for body in range(2):
        k = body * count
        climbs.u[k], climbs.step[k] = near[body], NEAR_STEP * PROPORTIONS
        along_turn(target.patch, near[body], climbs.along[k])
        climbs.f[k] = stress_at(target, body, near[body], first)
    if len(line):
        _seed_line(target, climbs, line, size, first)
    left = climbs.f > 0.0
    for k in range(24):
        if k == LINE_SWEEPS:
            left = standing(climbs, LINE_WORTH, LINE_GAP * size, 2)
            for climb in np.flatnonzero(left):
                climbs.f[climb] = stress_at(target, climb // count, climbs.u[climb], rules)
        for climb in np.flatnonzero(left):
            least = LINE_SMALLEST * size if climb % count else smallest
            left[climb] = sweep(target, climbs, climb, first if k < LINE_SWEEPS else rules, least, k > 0)
    _exchange(target, climbs, rules, LINE_SMALLEST * size)
    return climbs


@compiled
def _exchange(target, climbs, rules, smallest):
    """Move the highest climb of a body to that of the other body if the stress is higher there, and let it rise."""
    count = climbs.f.size // 2
    best = climbs.f[:count].argmax(), count + climbs.f[count:].argmax()
    places = climbs.u[best[0]].copy(), climbs.u[best[1]].copy()
    for body in range(2):
        own, place = best[body], places[1 - body]
        value = stress_at(target, body, place, rules)
        if value > climbs.f[own]:
            climbs.u[own], climbs.f[own], climbs.step[own] = place, value, 5.0 * smallest * PROPORTIONS
            polish(target, climbs, own, rules, smallest, 12)
