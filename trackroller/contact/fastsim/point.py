"""One point of the simplified theory: what a step along a strip does to its traction, compiled.

Shared by the strips of ellipses (`fastsim`) and of solved patches (`fastsim_grid`).
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from trackroller.numerics.knots import interval

NEWTON = 30  # most steps of the root of one point; three or four are usual


@njit(cache=True)
def _shortened(zx, zy, l_x, l_y, g):
    """(x, y) of length g with (x - z) L along it: the traction that slides under the trial traction z, |z| > g.

    x = L z/(L + k), k the root of |x| = g by Newton's method from the mean of L; k >= 0.
    """
    mean = 0.5 * (l_x + l_y)
    k = mean * (math.hypot(zx, zy) / g - 1.0)
    for _ in range(NEWTON):
        px, py = l_x * zx / (l_x + k), l_y * zy / (l_y + k)
        size = math.sqrt(px * px + py * py)
        slope = -(px * px / (l_x + k) + py * py / (l_y + k)) / size
        # of 1/|x| - 1/g, which is nearly linear in k
        change = size * (size - g) / (g * slope)
        k = max(k - change, 0.0)
        if abs(change) <= 1e-13 * (k + mean):
            break
    px, py = l_x * zx / (l_x + k), l_y * zy / (l_y + k)
    share = g / math.sqrt(px * px + py * py)
    return share * px, share * py


@njit(cache=True)
def _relaxed(friction, speed, h, stiffness, knots, factors):
    """Friction one step further towards that of its slip speed; and how far it was from it.

    Friction that falls at once with the slip of an elastic spring is unstable, so it follows over a length of the
    order of the elastic displacement times the slope of the law (Vollebregt & Schuttelaars 2012); `stiffness` = L g.
    """
    last = knots.size - 1
    if speed >= knots[last]:
        target, slope = factors[last], 0.0
    else:
        low = interval(speed, knots, 0, last)
        slope = (factors[low + 1] - factors[low]) / (knots[low + 1] - knots[low])
        target = factors[low] + slope * (speed - knots[low])
    return friction + (target - friction) / (1.0 + 2.0 * stiffness * abs(slope) / h), abs(target - friction)


@njit(cache=True)
def step(wx, wy, h, flexibility, bound, knots, factors, state):
    """One step h against the rolling direction with rigid slip (wx, wy).

    state = tau_x, tau_y, s_x, s_y, friction over its value at rest, and what it lacked: the old, then the new.
    """
    l_x, l_y = flexibility[0], flexibility[1]
    zx, zy = state[0] - h * wx / l_x, state[1] - h * wy / l_y
    g = bound * state[4]
    if zx * zx + zy * zy <= g * g:
        state[0], state[1], state[2], state[3] = zx, zy, 0.0, 0.0
    elif g <= 0.0:
        state[2], state[3] = -l_x * zx / h, -l_y * zy / h
        state[0] = state[1] = 0.0
    else:
        tx, ty = _shortened(zx, zy, l_x, l_y, g)
        state[0], state[1] = tx, ty
        state[2], state[3] = l_x * (tx - zx) / h, l_y * (ty - zy) / h
    state[5] = 0.0
    if knots.size > 1:
        speed = math.hypot(state[2], state[3])
        state[4], state[5] = _relaxed(state[4], speed, h, max(l_x, l_y) * bound, knots, factors)


@njit(cache=True)
def enter(wx, wy, knots, factors, state):
    """The state at the leading edge: no traction, friction of the rigid slip."""
    state[:] = 0.0
    state[4] = np.interp(math.hypot(wx, wy), knots, factors)
