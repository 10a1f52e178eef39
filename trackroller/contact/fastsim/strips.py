"""The simplified theory along the strips of solved patches, compiled: loaded intervals, their edges, their traction.

A strip is a column of elements. Places along it are counted in elements from the centre of element 0.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from trackroller.contact.fastsim.point import Totals, advance, enter, march, one_strip, write
from trackroller.contact.friction_laws import Knots
from trackroller.numerics.compiled import compiled

LONG = 8  # loaded elements from which the ends of an interval are extrapolated
SUBSTEPS = 8  # steps between the centres of elements, for tractions


class Loaded(NamedTuple):
    """Pressures of n solved patches with N x M elements, arrays (n,) unless stated otherwise.

    pressure (n, N, M) [MPa]; hx, hy : sides of an element [mm]; half : half the length of the grid [mm]; friction :
    coefficient mu [1].
    """

    pressure: np.ndarray
    hx: np.ndarray
    hy: np.ndarray
    half: np.ndarray
    friction: np.ndarray


class Interval(NamedTuple):
    """Loaded interval of a strip: first and last element, and the places `low` and `high` of its edges."""

    first: int
    last: int
    low: float
    high: float


@compiled
def _zero(far, middle, near):
    """Return how far beyond the last of three equidistant places their parabola vanishes, from 0.5 to 3 distances."""
    curve, slope = 0.5 * (far - 2.0 * middle + near), 0.5 * (3.0 * near - 4.0 * middle + far)
    root = slope * slope - 4.0 * curve * near
    if slope >= 0.0 or root < 0.0:
        return 2.5
    return min(max(2.0 * near / (-slope + math.sqrt(root)), 0.5), 3.0)


@compiled
def _interval(p, last):
    """Return the loaded interval of the pressures p (N,) that ends with the element `last`.

    Along a strip p^2 is nearly a parabola, which gives the edges. The two outermost elements are covered in part only
    and do not count. In a short interval, the edges are those of an ellipse with the second moment of the elements.
    """
    first = last
    while first > 0 and p[first - 1] > 0.0:
        first -= 1
    if last - first + 1 >= LONG:
        high = last - 2 + _zero(p[last - 4] ** 2, p[last - 3] ** 2, p[last - 2] ** 2)
        low = first + 2 - _zero(p[first + 4] ** 2, p[first + 3] ** 2, p[first + 2] ** 2)
        return Interval(first, last, low, high)
    load = moment = square = 0.0
    for k in range(first, last + 1):
        load += p[k]
        moment += k * p[k]
        square += (k * k + 1.0 / 12.0) * p[k]
    middle = moment / load
    reach = 2.0 * math.sqrt(max(square / load - middle * middle, 1.0 / 12.0))
    return Interval(first, last, middle - reach, middle + reach)


@compiled
def _before(p, k):
    """Return the last loaded interval of the pressures p (N,) up to the element k; it ends at -1 if there is none."""
    while k >= 0 and p[k] <= 0.0:
        k -= 1
    return _interval(p, k) if k >= 0 else Interval(-1, -1, 0.0, 0.0)


@compiled
def _pressure(p, interval, t):
    """Return the pressure at the place t of an interval, up to a factor that is the same for the whole interval."""
    first, last, low, high = interval
    if t <= low or t >= high:
        return 0.0
    if last - first + 1 < LONG:
        return math.sqrt(max((t - low) * (high - t), 0.0))
    if t > last - 2:  # a parabola that vanishes at the edge
        near, far = p[last - 2] ** 2 / (high - last + 2), p[last - 3] ** 2 / (high - last + 3)
        return math.sqrt(max((high - t) * (near + (near - far) * (t - last + 2)), 0.0))
    if t < first + 2:
        near, far = p[first + 2] ** 2 / (first + 2 - low), p[first + 3] ** 2 / (first + 3 - low)
        return math.sqrt(max((t - low) * (near + (near - far) * (first + 2 - t)), 0.0))
    k = min(int(t), last - 3)
    part = t - k
    return math.sqrt((1.0 - part) * p[k] ** 2 + part * p[k + 1] ** 2)


@compiled
def _scale(p, interval, steps):
    """Return the factor on `_pressure` with which its trapezoidal sum over the steps has the load of the elements."""
    load = total = 0.0
    for k in range(interval.first, interval.last + 1):
        load += p[k]
    length = (interval.high - interval.low) / steps
    for j in range(1, steps):
        total += _pressure(p, interval, interval.high - j * length)
    return load / (total * length) if total > 0.0 else 0.0


@compiled
def _sum(total, p, loaded, i, strip, middles, bounds, law):
    """Add one strip of patch i with pressures p (N,) to the totals and return them.

    `middles` and `bounds` have one entry for each step; they are overwritten.
    """
    steps, interval = bounds.size, _before(p, p.size - 1)
    while interval.last >= 0:
        scale, length = loaded.friction[i] * _scale(p, interval, steps), (interval.high - interval.low) / steps
        edge, h = (interval.high + 0.5) * loaded.hy[i] - loaded.half[i], length * loaded.hy[i]
        for j in range(steps):
            middles[j] = edge - (j + 0.5) * h
            bounds[j] = scale * _pressure(p, interval, interval.high - (j + 1) * length) if j < steps - 1 else 0.0
        total = march(total, strip, edge, h, loaded.hx[i] * h, middles, bounds, law)
        interval = _before(p, interval.first - 1)
    return total


@compiled
def _field(p, loaded, i, strip, law, shear, slip):
    """Write traction over its bound and slip (2, N) at the centres of the loaded elements of one strip of patch i."""
    hy, half, middles, bounds = loaded.hy[i], loaded.half[i], np.empty(SUBSTEPS), np.empty(SUBSTEPS)
    interval = _before(p, p.size - 1)
    while interval.last >= 0:
        scale, t = loaded.friction[i] * _scale(p, interval, 8 * p.size), interval.high
        state = enter(strip, (t + 0.5) * hy - half, law)
        for j in range(interval.last, interval.first - 1, -1):
            # an element whose centre lies beyond an edge takes the traction of the nearest place inside
            inside = min(max(float(j), interval.low + 0.25), interval.high - 0.25)
            h, g = (t - inside) / SUBSTEPS, scale * _pressure(p, interval, inside)
            if h > 0.0:
                for m in range(SUBSTEPS):
                    t -= h
                    middles[m], bounds[m] = (t + 0.5 * h + 0.5) * hy - half, scale * _pressure(p, interval, t)
                state, g = advance(strip, h * hy, middles, bounds, law, state), bounds[SUBSTEPS - 1]
            shear[0, j] = state.shear_x / g if g > 0.0 else 0.0
            shear[1, j] = state.shear_y / g if g > 0.0 else 0.0
            slip[0, j], slip[1, j] = state.slip_x, state.slip_y
        interval = _before(p, interval.first - 1)


@compiled
def strip_sums(loaded, strips, law, steps, totals, first, last):
    """Write the totals of the patches first..last into arrays (n,)."""
    middles, bounds = np.empty(steps), np.empty(steps)
    for i in range(first, last):
        knots = Knots(law.speed / strips.speed[i], law.factor)
        total = Totals(0.0, 0.0, 0.0, 0.0, 0.0)
        for j in range(strips.x.shape[1]):
            p, strip = loaded.pressure[i, :, j].copy(), one_strip(strips, i, j)
            total = _sum(total, p, loaded, i, strip, middles, bounds, knots)
        write(totals, i, total)


@compiled
def strip_fields(loaded, strips, law, shear, slip, first, last):
    """Write traction over its bound and slip of the patches first..last, (n, 2, N, M)."""
    for i in range(first, last):
        knots = Knots(law.speed / strips.speed[i], law.factor)
        for j in range(strips.x.shape[1]):
            p = loaded.pressure[i, :, j].copy()
            _field(p, loaded, i, one_strip(strips, i, j), knots, shear[i, :, :, j], slip[i, :, :, j])


@compiled
def strip_chords(pressure, chords):
    """Write the loaded length of each strip into `chords` (n, M), in elements."""
    for i in range(pressure.shape[0]):
        for j in range(pressure.shape[2]):
            p = pressure[i, :, j].copy()
            interval = _before(p, p.size - 1)
            while interval.last >= 0:
                chords[i, j] += interval.high - interval.low
                interval = _before(p, interval.first - 1)
