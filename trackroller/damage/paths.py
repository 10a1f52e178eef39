"""Compiled search for the stress paths that govern the multiaxial criteria.

A path is the stress history of one point, (t, 6) in the order of `halfspace.stress.COMPONENTS`.
Each search holds an upper bound for every path and sharpens the largest one until it belongs to a
path whose value is known. Paths that cannot govern are left with a cheap bound, so the search never
changes the result.
"""

from __future__ import annotations

import math

import numpy as np

from trackroller.damage.ball import FINE, smallest_ball, squared
from trackroller.numerics.compiled import compiled

# planes searched first, those refined, and how often the step is halved
COARSE, KEPT, ROUNDS = 95, 3, 7


@compiled
def deviator(s, u):  # pragma: no cover (compiled)
    """Write coordinates u (5,) of the deviator with |u|^2 = J2 of a stress s (6,), and return the
    mean stress.
    """
    u[0], u[1] = (s[0] - s[1]) / 2.0, (2.0 * s[2] - s[0] - s[1]) / math.sqrt(12.0)
    u[2], u[3], u[4] = s[3], s[4], s[5]
    return (s[0] + s[1] + s[2]) / 3.0


@compiled
def principal_deviators(u):  # pragma: no cover (compiled)
    """Return the largest and the smallest principal stress of a deviator, from its coordinates u
    (5,).
    """
    square = squared(u)
    if square == 0.0:
        return 0.0, 0.0
    third, size = u[1] / math.sqrt(3.0), math.sqrt(square / 3.0)
    x, y, z = u[0] - third, -u[0] - third, 2.0 * third
    determinant = (
        x * (y * z - u[3] ** 2) - u[2] * (u[2] * z - u[3] * u[4]) + u[4] * (u[2] * u[3] - y * u[4])
    )
    turn = math.acos(min(1.0, max(-1.0, 0.5 * determinant / size**3))) / 3.0
    return 2.0 * size * math.cos(turn), 2.0 * size * math.cos(turn + 2.0 * math.pi / 3.0)


@compiled
def chords(u):  # pragma: no cover (compiled)
    """Return the longest distance of two points u (t, 5), and the largest shear of a difference of
    two.
    """
    longest, shear, between = 0.0, 0.0, np.empty(5)
    for i in range(len(u)):
        for k in range(i):
            square = 0.0
            for j in range(5):
                between[j] = u[i, j] - u[k, j]
                square += between[j] ** 2
            longest = max(longest, square)
            if square > shear * shear:  # the largest shear is at most the distance
                high, low = principal_deviators(between)
                shear = max(shear, 0.5 * (high - low))
    return math.sqrt(longest), shear


@compiled
def goodman(u, strength):  # pragma: no cover (compiled)
    """Return the largest fully reversed von Mises stress [MPa] to which Goodman's line turns two
    states of a path.

    Parameters
    ----------
    u : numpy.ndarray
        Coordinates of the deviator, (t, 5) [MPa].
    strength : float
        R_m > 0 [MPa], at which a mean stress leaves no strength: the stress is then infinite.
    """
    largest = 0.0
    for i in range(len(u)):
        for k in range(i):
            apart, middle = 0.0, 0.0
            for j in range(5):
                apart, middle = apart + (u[i, j] - u[k, j]) ** 2, middle + (u[i, j] + u[k, j]) ** 2
            left = 1.0 - math.sqrt(0.75 * middle) / strength
            if apart > 0.0:
                largest = max(largest, math.sqrt(0.75 * apart) / left if left > 0.0 else np.inf)
    return largest


@compiled
def goodman_bound(amplitude, peak, strength):  # pragma: no cover (compiled)
    """Return a stress that `goodman` does not exceed for a path with an amplitude and a largest von
    Mises stress.

    Two states p and q keep |p - q|^2 + |p + q|^2 = 2 |p|^2 + 2 |q|^2, so that amplitude and mean
    lie within a circle whose radius is the largest stress.
    """
    if peak >= strength:
        return np.inf
    steep = math.sqrt(1.0 - (peak / strength) ** 2)
    if peak * steep <= amplitude:
        return peak / steep
    return amplitude / (1.0 - math.sqrt(peak**2 - amplitude**2) / strength)


@compiled
def on_plane(path, normal, k, step):  # pragma: no cover (compiled)
    """Return tau_a + k sigma_n,max on a plane with its normal (3,), from every `step`-th stress of
    a path.
    """
    x, y, z = normal[0], normal[1], normal[2]
    if abs(x) < 0.6:
        size = math.sqrt(y * y + z * z)
        a0, a1, a2 = 0.0, z / size, -y / size
    else:
        size = math.sqrt(x * x + z * z)
        a0, a1, a2 = -z / size, 0.0, x / size
    b0, b1, b2 = y * a2 - z * a1, z * a0 - x * a2, x * a1 - y * a0
    n = (len(path) + step - 1) // step
    first, second, highest = np.empty(n), np.empty(n), -np.inf
    for i in range(n):
        s = path[i * step]
        tx, ty, tz = (
            s[0] * x + s[3] * y + s[5] * z,
            s[3] * x + s[1] * y + s[4] * z,
            s[5] * x + s[4] * y + s[2] * z,
        )
        first[i], second[i] = tx * a0 + ty * a1 + tz * a2, tx * b0 + ty * b1 + tz * b2
        highest = max(highest, tx * x + ty * y + tz * z)
    chord = 0.0
    for i in range(n):
        for j in range(i):
            chord = max(chord, (first[i] - first[j]) ** 2 + (second[i] - second[j]) ** 2)
    return 0.5 * math.sqrt(chord) + k * highest


@compiled
def findley(path, k):  # pragma: no cover (compiled)
    """Return the largest tau_a + k sigma_n,max over all planes [MPa], tau_a as half the longest
    chord of the shear.

    Parameters
    ----------
    path : numpy.ndarray
        Stresses, (t, 6) [MPa].
    k : float
        k_F >= 0 [1].
    """
    normals, values = np.empty((COARSE, 3)), np.empty(COARSE)
    even = COARSE - 3
    for i in range(COARSE):
        z, turn = (i + 0.5) / even, math.pi * (3.0 - math.sqrt(5.0)) * i
        if i < even:
            normals[i, 0], normals[i, 1] = (
                math.sqrt(1.0 - z * z) * math.cos(turn),
                math.sqrt(1.0 - z * z) * math.sin(turn),
            )
            normals[i, 2] = z
        else:
            normals[i] = 0.0
            normals[i, i - even] = 1.0
        values[i] = on_plane(path, normals[i], k, 2)
    best = 0.0
    for start in np.argsort(values)[COARSE - KEPT :]:
        normal, step = normals[start].copy(), math.sqrt(2.0 * math.pi / even)
        value = on_plane(path, normal, k, 1)
        for _ in range(ROUNDS):
            helper = np.zeros(3)
            helper[np.argmin(np.abs(normal))] = 1.0
            first = np.cross(normal, helper)
            first /= np.linalg.norm(first)
            second, at = np.cross(normal, first), normal.copy()
            for i in range(6):
                tried = at + step * (
                    math.cos(i * math.pi / 3) * first + math.sin(i * math.pi / 3) * second
                )
                tried /= np.linalg.norm(tried)
                turned = on_plane(path, tried, k, 1)
                if turned > value:
                    value, normal = turned, tried
            step *= 0.5
        best = max(best, value)
    return best


@compiled
def dang_van(path, a):  # pragma: no cover (compiled)
    """Return the largest tau(t) + a sigma_h(t) of a path (t, 6) with and without credit of pressure
    [MPa].

    tau is the largest shear of the deviator around the centre of the smallest ball that holds the
    path. Without credit a negative sigma_h counts as 0.
    """
    u, mean = np.empty((len(path), 5)), np.empty(len(path))
    for i in range(len(path)):
        mean[i] = deviator(path[i], u[i])
    _, centre, _, _ = smallest_ball(u, np.zeros(len(path)), FINE)
    with_credit, without = -np.inf, -np.inf
    for i in range(len(path)):
        high, low = principal_deviators(u[i] - centre)
        shear = 0.5 * (high - low)
        with_credit = max(with_credit, shear + a * mean[i])
        without = max(without, shear + a * max(mean[i], 0.0))
    return with_credit, without


@compiled
def _bounds(paths, k, a, strength):  # pragma: no cover (compiled)
    """Return upper bounds (m, 5) of the stresses of `governing`."""
    out, u = np.empty((len(paths), 5)), np.empty((paths.shape[1], 5))
    for i in range(len(paths)):
        low, high = np.full(5, np.inf), np.full(5, -np.inf)
        normal, pressed, mean, longest = -np.inf, -np.inf, 0.0, 0.0
        for t in range(len(u)):
            mean = deviator(paths[i, t], u[t])
            square = 0.0
            for j in range(5):
                low[j], high[j], square = (
                    min(low[j], u[t, j]),
                    max(high[j], u[t, j]),
                    square + u[t, j] ** 2,
                )
            normal, pressed = max(normal, mean + 2.0 * math.sqrt(square / 3.0)), max(pressed, mean)
            longest = max(longest, square)
        # of a ball around the middle, which holds the path: no smaller than the smallest one
        radius = 0.0
        for t in range(len(u)):
            square = 0.0
            for j in range(5):
                square += (u[t, j] - 0.5 * (low[j] + high[j])) ** 2
            radius = max(radius, square)
        radius = math.sqrt(radius)
        out[i, 0], out[i, 1] = radius, radius + k * normal
        out[i, 2], out[i, 3] = radius + a * pressed, radius + a * max(pressed, 0.0)
        peak = math.sqrt(3.0 * longest)
        out[i, 4] = goodman_bound(min(math.sqrt(3.0) * radius, peak), peak, strength)
    return out


@compiled
def _governing_goodman(paths, own, strength):  # pragma: no cover (compiled)
    """Return Goodman's largest stress over paths with upper bounds `own` (m,), which it overwrites
    [MPa].
    """
    best, u = -np.inf, np.empty((paths.shape[1], 5))
    while True:
        i = np.argmax(own)
        if own[i] <= best:
            return best
        for t in range(len(u)):
            deviator(paths[i, t], u[t])
        best, own[i] = max(best, goodman(u, strength)), -np.inf


@compiled
def governing(paths, k, a, strength):  # pragma: no cover (compiled)
    """Return the largest half chord, Findley's and Dang Van's stress with and without credit, and
    Goodman's over paths.

    Parameters
    ----------
    paths : numpy.ndarray
        Paths, (m, t, 6) [MPa].
    k, a : float
        k_F and a_D [1]; NaN leaves out both criteria.
    strength : float
        R_m > 0 [MPa].

    Returns
    -------
    numpy.ndarray
        (5,) [MPa]; the half chord in the coordinates of `deviator`.
    """
    bounds, out = _bounds(paths, k, a, strength), np.full(5, np.nan)
    sharp, known = np.zeros(len(paths), dtype=np.bool_), np.full((len(paths), 2), np.nan)
    u = np.empty((paths.shape[1], 5))
    for kind in range(1 if np.isnan(k + a) else 4):
        best, own = -np.inf, bounds[:, kind].copy()
        while True:
            i = np.argmax(own)
            if own[i] <= best:
                break
            if kind >= 2:
                if np.isnan(known[i, 0]):
                    known[i, 0], known[i, 1] = dang_van(paths[i], a)
                best, own[i] = max(best, known[i, kind - 2]), -np.inf
            elif kind == 1 and sharp[i]:
                best, own[i] = max(best, findley(paths[i], k)), -np.inf
            else:
                highest = -np.inf
                for t in range(len(u)):
                    mean = deviator(paths[i, t], u[t])
                    highest = max(highest, mean + principal_deviators(u[t])[0])
                chord, shear = chords(u)
                if kind == 0:
                    best, own[i] = max(best, 0.5 * chord), -np.inf
                else:
                    own[i], sharp[i] = min(own[i], 0.5 * shear + k * highest), True
        out[kind] = best
    out[4] = _governing_goodman(paths, bounds[:, 4].copy(), strength)
    return out
