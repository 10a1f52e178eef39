"""The simplified theory along the strips of solved patches, compiled: loaded intervals, their edges, their traction."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from trackroller.contact.fastsim.point import Totals, add, enter, step, write
from trackroller.contact.friction_laws import Knots


class Strips(NamedTuple):
    """Solved patches of N x M elements, arrays (n,) unless stated, or one of their strips.

    pressure (n, N, M) [MPa]; x (n, M) : place of the strips [mm]; hx, hy : sides of an element [mm]; half : half the
    length of the grid [mm]; along (n, M), spin : rigid slip (-spin y, along); flexible_x, flexible_y (n, M) [mm/MPa];
    friction : coefficient mu; speed : travel speed [mm/s].
    """

    pressure: np.ndarray
    x: np.ndarray
    hx: np.ndarray
    hy: np.ndarray
    half: np.ndarray
    along: np.ndarray
    spin: np.ndarray
    flexible_x: np.ndarray
    flexible_y: np.ndarray
    friction: np.ndarray
    speed: np.ndarray


LONG = 8  # loaded elements from which the ends of an interval are extrapolated
SUBSTEPS = 8  # between the centres of elements, for tractions


@njit(cache=True)
def _zero(far, middle, near):
    """How far beyond the last of three equidistant places their parabola vanishes; 0.5 to 3 distances."""
    curve, slope = 0.5 * (far - 2.0 * middle + near), 0.5 * (3.0 * near - 4.0 * middle + far)
    root = slope * slope - 4.0 * curve * near
    if slope >= 0.0 or root < 0.0:
        return 2.5
    return min(max(2.0 * near / (-slope + math.sqrt(root)), 0.5), 3.0)


@njit(cache=True)
def _interval(p, last, shape):
    """The loaded interval of a strip p (N,) that ends with the element `last`; the first element of it.

    shape = first, last, low, high: elements, and the places of the edges in elements from the centre of element 0.
    p^2 is nearly a parabola along a strip; the two outermost elements, partly covered, do not count. In short
    intervals pressure is taken for an ellipse with the second moment of the elements.
    """
    first = last
    while first > 0 and p[first - 1] > 0.0:
        first -= 1
    shape[0], shape[1] = first, last
    if last - first + 1 >= LONG:
        shape[3] = last - 2 + _zero(p[last - 4] ** 2, p[last - 3] ** 2, p[last - 2] ** 2)
        shape[2] = first + 2 - _zero(p[first + 4] ** 2, p[first + 3] ** 2, p[first + 2] ** 2)
        return first
    load = moment = square = 0.0
    for k in range(first, last + 1):
        load += p[k]
        moment += k * p[k]
        square += (k * k + 1.0 / 12.0) * p[k]
    middle = moment / load
    reach = 2.0 * math.sqrt(max(square / load - middle * middle, 1.0 / 12.0))
    shape[2], shape[3] = middle - reach, middle + reach
    return first


@njit(cache=True)
def _pressure(p, shape, t):
    """Pressure (of any scale) at the place t of an interval, elements from the centre of element 0."""
    first, last, low, high = int(shape[0]), int(shape[1]), shape[2], shape[3]
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


@njit(cache=True)
def _scale(p, shape, steps):
    """What makes the trapezoidal sum of `_pressure` over the steps that of the elements."""
    load = total = 0.0
    for k in range(int(shape[0]), int(shape[1]) + 1):
        load += p[k]
    length = (shape[3] - shape[2]) / steps
    for j in range(1, steps):
        total += _pressure(p, shape, shape[3] - j * length)
    return load / (total * length) if total > 0.0 else 0.0


@njit(cache=True)
def _sum(total, p, strip, steps, law):
    """Return the totals with those of one strip with element pressures p (N,)."""
    shape = np.zeros(4)
    k = p.size - 1
    while k >= 0:
        if p[k] <= 0.0:
            k -= 1
            continue
        k = _interval(p, k, shape) - 1
        scale, length = strip.friction * _scale(p, shape, steps), (shape[3] - shape[2]) / steps
        y, h = (shape[3] + 0.5) * strip.hy - strip.half, length * strip.hy
        state = enter(-strip.spin * y, strip.along, law)
        for j in range(1, steps + 1):
            middle = y - (j - 0.5) * h
            g = scale * _pressure(p, shape, shape[3] - j * length) if j < steps else 0.0
            wx = -strip.spin * middle
            new = step(wx, strip.along, h, strip.flexible_x, strip.flexible_y, g, law, state)
            total = add(total, state, new, strip.x, middle, strip.hx * h, g)
            state = new
    return total


@njit(cache=True)
def _field(p, strip, law, shear, slip):
    """Write traction over its bound and slip (2, N) at the centres of the loaded elements of one strip."""
    shape = np.zeros(4)
    hy, half, spin = strip.hy, strip.half, strip.spin
    k = p.size - 1
    while k >= 0:
        if p[k] <= 0.0:
            k -= 1
            continue
        last = k
        first = _interval(p, last, shape)
        k = first - 1
        scale, t = strip.friction * _scale(p, shape, 8 * p.size), shape[3]
        state = enter(-spin * ((t + 0.5) * hy - half), strip.along, law)
        for j in range(last, first - 1, -1):
            # an element whose centre lies beyond an edge takes the traction of the nearest place inside
            inside = min(max(float(j), shape[2] + 0.25), shape[3] - 0.25)
            h = (t - inside) / SUBSTEPS
            g = scale * _pressure(p, shape, inside)
            for _ in range(SUBSTEPS):
                if h <= 0.0:
                    break
                t -= h
                g = scale * _pressure(p, shape, t)
                wx = -spin * ((t + 0.5 * h + 0.5) * hy - half)
                state = step(wx, strip.along, h * hy, strip.flexible_x, strip.flexible_y, g, law, state)
            shear[0, j] = state.shear_x / g if g > 0.0 else 0.0
            shear[1, j] = state.shear_y / g if g > 0.0 else 0.0
            slip[0, j], slip[1, j] = state.slip_x, state.slip_y


@njit(cache=True)
def _one(strips, i, j):
    """Return strip j of patch i."""
    pressure, x, hx, hy, half, along, spin, flexible_x, flexible_y, friction, speed = strips
    return Strips(
        pressure[i],
        x[i, j],
        hx[i],
        hy[i],
        half[i],
        along[i, j],
        spin[i],
        flexible_x[i, j],
        flexible_y[i, j],
        friction[i],
        speed[i],
    )


@njit(cache=True, nogil=True)
def strip_sums(first, last, strips, steps, law, totals):
    """Write the totals of the patches first..last into arrays (n,)."""
    for i in range(first, last):
        knots = Knots(law.speed / strips.speed[i], law.factor)
        total = Totals(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        for j in range(strips.x.shape[1]):
            total = _sum(total, strips.pressure[i, :, j].copy(), _one(strips, i, j), steps, knots)
        write(totals, i, total)


@njit(cache=True, nogil=True)
def strip_fields(first, last, strips, law, shear, slip):
    """Write traction over its bound and slip of the patches first..last, (n, 2, N, M)."""
    for i in range(first, last):
        knots = Knots(law.speed / strips.speed[i], law.factor)
        for j in range(strips.x.shape[1]):
            p = strips.pressure[i, :, j].copy()
            _field(p, _one(strips, i, j), knots, shear[i, :, :, j], slip[i, :, :, j])


@njit(cache=True)
def strip_chords(pressure, chords):
    """Loaded length (n, M) of each strip, in elements."""
    shape = np.zeros(4)
    for i in range(pressure.shape[0]):
        for j in range(pressure.shape[2]):
            p = pressure[i, :, j].copy()
            k = p.size - 1
            while k >= 0:
                if p[k] > 0.0:
                    k = _interval(p, k, shape)
                    chords[i, j] += shape[3] - shape[2]
                k -= 1
