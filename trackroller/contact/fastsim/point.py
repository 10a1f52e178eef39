"""The simplified theory along one strip, step by step against the rolling direction; compiled."""

from __future__ import annotations

import math
from typing import Generic, NamedTuple, TypeVar

import numpy as np

from trackroller.numerics.compiled import compiled
from trackroller.numerics.knots import polyline

T = TypeVar("T", float, np.ndarray)  # one patch, or arrays over the patches
NEWTON = 30  # limit of Newton's method for the root of one point; three or four steps are usual


class Strips(NamedTuple):
    """Strips of n patches along the rolling direction, or one strip of one patch.

    x (n, m) : place of the strips [mm]; lateral (n,), spin (n,) [1/mm], along (n, m) : rigid slip
    (lateral - spin y, along); flexible_x, flexible_y (n, m) : flexibilities [mm/MPa]; speed (n,) : travel speed [mm/s].
    """

    x: np.ndarray
    lateral: np.ndarray
    spin: np.ndarray
    along: np.ndarray
    flexible_x: np.ndarray
    flexible_y: np.ndarray
    speed: np.ndarray


class State(NamedTuple):
    """Traction [MPa] and slip [1] at a point, and friction over its value at rest."""

    shear_x: float
    shear_y: float
    slip_x: float
    slip_y: float
    friction: float


class Totals(NamedTuple, Generic[T]):
    """F_T, F_A [N], M_R [N mm], dissipation per distance [N] and adhesion area [mm^2].

    Numbers of one patch, or arrays (n,).
    """

    lateral: T
    driving: T
    moment: T
    dissipation: T
    adhesion: T


@compiled
def one_strip(strips, i, j):
    """Return strip j of patch i."""
    x, lateral, spin, along, flexible_x, flexible_y, speed = strips
    return Strips(x[i, j], lateral[i], spin[i], along[i, j], flexible_x[i, j], flexible_y[i, j], speed[i])


@compiled
def _shortened(zx, zy, l_x, l_y, g):
    """Return the traction (x, y) of length g at a slipping point with the trial traction z, |z| > g.

    The springs move by L (z - x), which is parallel to x. So x = L z/(L + k) with the root k >= 0 of |x| = g, found by
    Newton's method from the mean of L.
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


@compiled
def _relaxed(friction, speed, h, stiffness, law):
    """Return the friction one step further towards that of its slip speed.

    Friction that falls at once with the slip of an elastic spring is unstable. It therefore follows over a length of
    the order of the elastic displacement times the slope of the law (Vollebregt & Schuttelaars 2012);
    `stiffness` = L g.
    """
    target, slope = polyline(speed, law.speed, law.factor)
    return friction + (target - friction) / (1.0 + 2.0 * stiffness * abs(slope) / h)


@compiled
def _step(strip, middle, h, bound, law, old):
    """Return the state after a step h about the place `middle` [mm]; `bound` is mu p at the end of the step [MPa]."""
    l_x, l_y = strip.flexible_x, strip.flexible_y
    zx, zy = old.shear_x - h * (strip.lateral - strip.spin * middle) / l_x, old.shear_y - h * strip.along / l_y
    g = bound * old.friction
    if zx * zx + zy * zy <= g * g:
        tx, ty, sx, sy = zx, zy, 0.0, 0.0
    elif g <= 0.0:
        tx, ty, sx, sy = 0.0, 0.0, -l_x * zx / h, -l_y * zy / h
    else:
        tx, ty = _shortened(zx, zy, l_x, l_y, g)
        sx, sy = l_x * (tx - zx) / h, l_y * (ty - zy) / h
    friction = old.friction
    if law.speed.size > 1:
        friction = _relaxed(friction, math.hypot(sx, sy), h, max(l_x, l_y) * bound, law)
    return State(tx, ty, sx, sy, friction)


@compiled
def enter(strip, y, law):
    """Return the state at the leading edge y [mm]: no traction, and the friction of the rigid slip."""
    speed = math.hypot(strip.lateral - strip.spin * y, strip.along)
    return State(0.0, 0.0, 0.0, 0.0, polyline(speed, law.speed, law.factor)[0])


@compiled
def advance(strip, h, middles, bounds, law, state):
    """Return the state after steps h about the places `middles` [mm], with mu p at the end of each step [MPa]."""
    for j in range(bounds.size):
        state = _step(strip, middles[j], h, bounds[j], law, state)
    return state


@compiled
def march(total, strip, edge, h, area, middles, bounds, law):
    """Add a strip, marched from its leading edge [mm], to the totals; `area` is the area of a step [mm^2]."""
    old = enter(strip, edge, law)
    for j in range(bounds.size):
        middle = middles[j]
        new = _step(strip, middle, h, bounds[j], law, old)
        mean_x, mean_y = 0.5 * (old.shear_x + new.shear_x), 0.5 * (old.shear_y + new.shear_y)
        sticks = new.slip_x == 0.0 and new.slip_y == 0.0
        total = Totals(
            total.lateral + area * mean_x,
            total.driving + area * mean_y,
            total.moment + area * (strip.x * mean_y - middle * mean_x),
            total.dissipation - area * (mean_x * new.slip_x + mean_y * new.slip_y),
            total.adhesion + (area if sticks else 0.0),
        )
        old = new
    return total


@compiled
def write(totals, i, total):
    """Store the totals of patch i in arrays."""
    totals.lateral[i], totals.driving[i], totals.moment[i] = total.lateral, total.driving, total.moment
    totals.dissipation[i], totals.adhesion[i] = total.dissipation, total.adhesion
