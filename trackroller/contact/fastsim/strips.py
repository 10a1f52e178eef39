"""The simplified theory along the strips of solved patches, compiled: loaded intervals, their edges, their traction."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from trackroller.contact.fastsim.point import enter, step

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
def _strip(p, place, along, spin, flexibility, friction, steps, knots, factors, total):
    """Adds F_T, F_A, M_R, dissipation per distance, sticking area and lack of friction of one strip to `total` (6,).

    place = x of the strip, element sides across and along, half the length of the grid; rigid slip (-spin y, along).
    """
    state, shape = np.zeros(6), np.zeros(4)
    x, hx, hy, half = place[0], place[1], place[2], place[3]
    k = p.size - 1
    while k >= 0:
        if p[k] <= 0.0:
            k -= 1
            continue
        k = _interval(p, k, shape) - 1
        scale, length = friction * _scale(p, shape, steps), (shape[3] - shape[2]) / steps
        y, h = (shape[3] + 0.5) * hy - half, length * hy
        enter(-spin * y, along, knots, factors, state)
        for j in range(1, steps + 1):
            before_x, before_y, middle = state[0], state[1], y - (j - 0.5) * h
            g = scale * _pressure(p, shape, shape[3] - j * length) if j < steps else 0.0
            step(-spin * middle, along, h, flexibility, g, knots, factors, state)
            mean_x, mean_y, area = 0.5 * (before_x + state[0]), 0.5 * (before_y + state[1]), hx * h
            total[0] += area * mean_x
            total[1] += area * mean_y
            total[2] += area * (x * mean_y - middle * mean_x)
            total[3] -= area * (mean_x * state[2] + mean_y * state[3])
            if state[2] == 0.0 and state[3] == 0.0:
                total[4] += area
            total[5] += area * g * state[5]


@njit(cache=True)
def _field(p, place, along, spin, flexibility, friction, knots, factors, shear, slip):
    """Traction over its bound and slip (2, N) at the centres of the loaded elements of one strip."""
    state, shape = np.zeros(6), np.zeros(4)
    hy, half = place[2], place[3]
    k = p.size - 1
    while k >= 0:
        if p[k] <= 0.0:
            k -= 1
            continue
        last = k
        first = _interval(p, last, shape)
        k = first - 1
        scale, t = friction * _scale(p, shape, 8 * p.size), shape[3]
        enter(-spin * ((t + 0.5) * hy - half), along, knots, factors, state)
        for j in range(last, first - 1, -1):
            # elements whose centre lies beyond an edge take what is nearest to them
            inside = min(max(float(j), shape[2] + 0.25), shape[3] - 0.25)
            h = (t - inside) / SUBSTEPS
            g = scale * _pressure(p, shape, inside)
            for _ in range(SUBSTEPS):
                if h <= 0.0:
                    break
                t -= h
                g = scale * _pressure(p, shape, t)
                wx = -spin * ((t + 0.5 * h + 0.5) * hy - half)
                step(wx, along, h * hy, flexibility, g, knots, factors, state)
            for c in range(2):
                shear[c, j] = state[c] / g if g > 0.0 else 0.0
                slip[c, j] = state[2 + c]


@njit(cache=True, nogil=True)
def strip_sums(
    rows, pressure, x, sides, half, along, spin, flexibility, friction, travel, steps, knots, factors, totals
):
    for i in range(rows[0], rows[1]):
        for j in range(x.shape[1]):
            place = (x[i, j], sides[i, 0], sides[i, 1], half[i])
            _strip(
                pressure[i, :, j].copy(),
                place,
                along[i, j],
                spin[i],
                flexibility[i, j],
                friction[i],
                steps,
                knots / travel[i],
                factors,
                totals[i],
            )


@njit(cache=True, nogil=True)
def strip_fields(
    rows, pressure, x, sides, half, along, spin, flexibility, friction, travel, knots, factors, shear, slip
):
    for i in range(rows[0], rows[1]):
        for j in range(x.shape[1]):
            place = (x[i, j], sides[i, 0], sides[i, 1], half[i])
            _field(
                pressure[i, :, j].copy(),
                place,
                along[i, j],
                spin[i],
                flexibility[i, j],
                friction[i],
                knots / travel[i],
                factors,
                shear[i, :, :, j],
                slip[i, :, :, j],
            )


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
