"""The largest von Mises stress over the closed half-space below a sliding Hertzian ellipse.

A coarse scan over surface and depth finds seeds, both bodies sharing its stress evaluations; from each seed a
pattern search with quadratic models climbs, the surface and the edge of the patch being admissible; the summit
is evaluated again with finer quadrature. Stresses per unit p_max, depth in units of the smaller semi-axis.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np
from numba import njit

from trackroller.contact.sliding import clustered_rule
from trackroller.halfspace.ellipse import FRICTION, K0, K1, K2, POLE_X, A, B, stress_at
from trackroller.threads import share_rows


@dataclass(frozen=True)
class PeakSettings:
    """Quadrature points of scan, climb, polish and summit, number of seeds climbed and of finalists polished,
    the smallest step of the polish, and the scale of the relative error that no other sign shows."""

    scan: int
    climb: int
    polish: int
    summit: int
    seeds: int
    finalists: int
    step: float
    floor: float


@dataclass(frozen=True)
class Peak:
    """Peak von Mises stress and its place; arrays (n, 2), second axis roller and guide.

    `stress` per unit p_max, `x`, `y`, `z` [mm], `error` the estimated relative error.
    """

    stress: np.ndarray
    x: np.ndarray
    y: np.ndarray
    z: np.ndarray
    error: np.ndarray


def _scan_points() -> np.ndarray:
    """Points (rho cos, rho sin, depth) in normalised coordinates."""
    rows = [(0.0, 0.0, 0.0)]
    for rho, count in ((0.3, 6), (0.53, 10), (0.75, 12), (0.92, 12), (1.0, 12)):
        angles = 2 * np.pi * (np.arange(count) + 0.5 * (count == 12)) / count
        rows += [(rho * math.cos(t), rho * math.sin(t), 0.0) for t in angles]
    for depth, rings in ((0.12, ((0.4, 6), (0.8, 6))), (0.3, ((0.4, 6), (0.8, 6))), (0.5, ((0.45, 6),)),
                         (0.75, ((0.45, 4),))):  # fmt: skip
        rows.append((0.0, 0.0, depth))
        for rho, count in rings:
            angles = 2 * np.pi * (np.arange(count) + 0.5 * (rho == 0.4)) / count
            rows += [(rho * math.cos(t), rho * math.sin(t), depth) for t in angles]
    return np.array(rows)


SCAN = _scan_points()


@njit(cache=True)
def _von_mises(parts, nu, sign):
    """von Mises stress, eq. (6), from stress parts (4, 6)."""
    s0 = parts[0, 0] + nu * parts[1, 0] + sign * (parts[2, 0] + nu * parts[3, 0])
    s1 = parts[0, 1] + nu * parts[1, 1] + sign * (parts[2, 1] + nu * parts[3, 1])
    s2 = parts[0, 2] + nu * parts[1, 2] + sign * (parts[2, 2] + nu * parts[3, 2])
    t0 = parts[0, 3] + nu * parts[1, 3] + sign * (parts[2, 3] + nu * parts[3, 3])
    t1 = parts[0, 4] + nu * parts[1, 4] + sign * (parts[2, 4] + nu * parts[3, 4])
    t2 = parts[0, 5] + nu * parts[1, 5] + sign * (parts[2, 5] + nu * parts[3, 5])
    return math.sqrt(0.5 * ((s0 - s1) ** 2 + (s2 - s0) ** 2 + (s1 - s2) ** 2)
                     + 3.0 * (t0 * t0 + t1 * t1 + t2 * t2))  # fmt: skip


@njit(cache=True)
def _value(patch, field, nu, sign, u, rule, rule_w, waves, waves_w, parts):
    c = min(patch[A], patch[B])
    stress_at(patch, field, u[0] * patch[A], u[1] * patch[B], u[2] * c, waves, waves_w, rule, rule_w, parts)
    return _von_mises(parts, nu, sign)


@njit(cache=True)
def _copy(source, target):
    target[0], target[1], target[2] = source[0], source[1], source[2]


@njit(cache=True)
def _distance2(u, v):
    return (u[0] - v[0]) ** 2 + (u[1] - v[1]) ** 2 + (u[2] - v[2]) ** 2


@njit(cache=True)
def _project(u):
    r = math.hypot(u[0], u[1])
    if r > 1.0:
        u[0] /= r
        u[1] /= r
    u[2] = max(u[2], 0.0)


@njit(cache=True)
def _climb(patch, field, nu, sign, u, f, rule, rule_w, waves, waves_w, parts, first, smallest, sweeps):
    """Pattern search from u with value f: a parabola along radius, circumference and depth in turn."""
    h, trial, axis, f_side, start = np.empty(3), np.empty(3), np.empty(3), np.empty(2), np.empty(3)
    h[0], h[1], h[2] = first, 1.6 * first, first
    gained = 0.0
    for _sweep in range(sweeps):
        before = f
        _copy(u, start)
        r = math.hypot(u[0], u[1])
        cx, cy = (u[0] / r, u[1] / r) if r > 1e-9 else (1.0, 0.0)
        moved = 0.0
        for k in range(3):
            axis[0] = cx if k == 0 else (-cy if k == 1 else 0.0)
            axis[1] = cy if k == 0 else (cx if k == 1 else 0.0)
            axis[2] = 1.0 if k == 2 else 0.0
            u0, v0, w0, f0 = u[0], u[1], u[2], f
            for side in range(2):
                step = h[k] if side == 0 else -h[k]
                trial[0], trial[1], trial[2] = u0 + step * axis[0], v0 + step * axis[1], w0 + step * axis[2]
                _project(trial)
                same = abs(trial[0] - u0) + abs(trial[1] - v0) + abs(trial[2] - w0) < 1e-12
                f_side[side] = (
                    f0 if same else _value(patch, field, nu, sign, trial, rule, rule_w, waves, waves_w, parts)
                )
                if f_side[side] > f:
                    f = f_side[side]
                    _copy(trial, u)
            curve = f_side[0] - 2.0 * f0 + f_side[1]
            if curve < 0.0:
                step = 0.5 * h[k] * (f_side[1] - f_side[0]) / curve
                step = min(max(step, -2.0 * h[k]), 2.0 * h[k])
                if abs(step) > 0.05 * h[k] and abs(abs(step) - h[k]) > 0.05 * h[k]:
                    trial[0], trial[1], trial[2] = u0 + step * axis[0], v0 + step * axis[1], w0 + step * axis[2]
                    _project(trial)
                    value = _value(patch, field, nu, sign, trial, rule, rule_w, waves, waves_w, parts)
                    if value > f:
                        f = value
                        _copy(trial, u)
            distance = abs(u[0] - u0) + abs(u[1] - v0) + abs(u[2] - w0)
            moved = max(moved, distance / h[k])
            if distance < 0.5 * h[k]:
                h[k] *= 0.35
        if _sweep > 0 and _distance2(u, start) > 1e-8:  # along a ridge that lies askew to the axes
            for k in range(3):
                trial[k] = 2.0 * u[k] - start[k]
            _project(trial)
            value = _value(patch, field, nu, sign, trial, rule, rule_w, waves, waves_w, parts)
            if value > f:
                f = value
                _copy(trial, u)
        gained = f - before
        widest = max(h[0], h[1], h[2])
        if widest < smallest or (gained < 1e-6 * f and moved < 1e-9 and widest < 4 * smallest):
            break
    return f, gained


def _scans(patches: np.ndarray) -> np.ndarray:
    """Points (n, m, 3) of the scans: the common ones and some on the line where the lateral slip turns.

    The sharp fold of the slip carries ridges of stress in slender patches.
    """
    pole = np.clip(patches[:, POLE_X] / patches[:, A], -1.0, 1.0)[:, None]
    share = np.array([0.15, 0.4, 0.6, 0.85])
    left, right = pole - share * (1.0 + pole), pole + share * (1.0 - pole)
    a, b = patches[:, A, None], patches[:, B, None]
    fold = np.concatenate([patches[:, K1, None] * (left + 1.0), patches[:, K2, None] * (right - 1.0)], axis=1)
    u = np.stack([np.concatenate([left, right], axis=1), (patches[:, K0, None] + fold * a) / b], axis=2)
    u /= np.maximum(np.hypot(u[..., 0], u[..., 1]), 1.0)[..., None]
    turning = np.concatenate([u, np.zeros((*u.shape[:2], 1))], axis=2)
    return np.concatenate([np.broadcast_to(SCAN, (len(patches), *SCAN.shape)), turning], axis=1)


@njit(cache=True)
def _seeds(scan, values, count, chosen):
    """Indices of the best scan points that lie apart from each other; returns how many."""
    found = 0
    best = 0.0
    for i in range(values.size):
        best = max(best, values[i])
    taken = np.zeros(values.size)
    while found < count:
        k, top = -1, 0.85 * best
        for i in range(values.size):
            if taken[i] == 0.0 and values[i] > top:
                k, top = i, values[i]
        if k < 0:
            break
        chosen[found] = k
        found += 1
        for i in range(values.size):
            d = (SCAN[i, 0] - SCAN[k, 0]) ** 2 + (SCAN[i, 1] - SCAN[k, 1]) ** 2 + (SCAN[i, 2] - SCAN[k, 2]) ** 2
            if d < 0.25:
                taken[i] = 1.0
    return found


@njit(cache=True)
def _one_peak(patch, field, points, nu, rules, seeds, finalists, smallest, floor, out):
    s_rule, s_w, c_rule, c_w, p_rule, p_w, f_rule, f_w, waves, waves_w = rules
    count = points.shape[0]
    parts = np.empty((4, 6))
    scan = np.empty((2, count))
    slender = max(patch[A], patch[B]) / min(patch[A], patch[B])
    # a missed or not quite climbed ridge shows nowhere: measured, it grows so with friction and slenderness
    risk = floor * (1.0 + 10.0 * patch[FRICTION] ** 2 * math.sqrt(slender))
    c = min(patch[A], patch[B])
    for i in range(count):
        u = points[i]
        stress_at(patch, field, u[0] * patch[A], u[1] * patch[B], u[2] * c, s_rule, s_w, s_rule, s_w, parts)
        scan[0, i], scan[1, i] = _von_mises(parts, nu[0], 1.0), _von_mises(parts, nu[1], -1.0)
    chosen = np.empty(seeds, np.int64)
    tops, values = np.empty((seeds, 3)), np.empty(seeds)
    for body in range(2):
        sign = 1.0 if body == 0 else -1.0
        found = _seeds(points, scan[body], seeds, chosen)
        high = 0.0
        for s in range(found):
            _copy(points[chosen[s]], tops[s])
            values[s] = _value(patch, field, nu[body], sign, tops[s], c_rule, c_w, c_rule, c_w, parts)
            high = max(high, values[s])
        for s in range(found):  # the scan is rough: seeds that fall behind with better quadrature are given up
            if values[s] > 0.9 * high:
                values[s], _ = _climb(
                    patch, field, nu[body], sign, tops[s], values[s], c_rule, c_w, c_rule, c_w, parts, 0.12, 0.06, 1
                )
        best_seed = 0
        for k in range(1, found):
            if values[k] > values[best_seed]:
                best_seed = k
        top = values[best_seed]
        for k in range(found):  # only those that may still win climb on
            if values[k] > 0.965 * top:
                values[k], _ = _climb(
                    patch, field, nu[body], sign, tops[k], values[k], c_rule, c_w, c_rule, c_w, parts, 0.08, 0.06, 3
                )
                if values[k] > values[best_seed]:
                    best_seed = k
        top = values[best_seed]
        best = gained_best = -1.0
        for k in range(min(found, finalists)):
            s, high = best_seed, -1.0  # the highest not yet polished
            for j in range(found):
                if values[j] > high:
                    s, high = j, values[j]
            values[s] = -1.0
            u = tops[s]
            if high < 0.95 * top:
                break
            if k > 0 and _distance2(u, tops[best_seed]) < 0.0025:
                continue  # the same summit
            f = _value(patch, field, nu[body], sign, u, p_rule, p_w, waves, waves_w, parts)
            f, gained = _climb(
                patch,
                field,
                nu[body],
                sign,
                u,
                f,
                p_rule,
                p_w,
                waves,
                waves_w,
                parts,
                max(3.0 * smallest, 0.01),
                smallest,
                12,
            )
            if f > best:
                best, gained_best = f, gained
                out[body, 1], out[body, 2], out[body, 3] = u[0] * patch[A], u[1] * patch[B], u[2] * c
        stress_at(patch, field, out[body, 1], out[body, 2], out[body, 3], f_rule, f_w, f_rule, f_w, parts)
        f = _von_mises(parts, nu[body], sign)
        out[body, 0] = f
        out[body, 4] = 4.0 * (abs(f - best) + gained_best) / f + risk


@njit(cache=True, nogil=True)
def _all_peaks(first, last, patches, fields, scans, nu, rules, seeds, finalists, smallest, floor, out):
    for i in range(first, last):
        _one_peak(patches[i], fields[i], scans[i], nu[i], rules, seeds, finalists, smallest, floor, out[i])


def _search_rows(rest: tuple, first: int, last: int) -> None:
    _all_peaks(first, last, *rest)


def find_peaks(
    patches: np.ndarray, poisson_ratio: np.ndarray, settings: PeakSettings, fields: np.ndarray | None = None
) -> Peak:
    """Peak von Mises stress of roller and guide under n patches.

    Parameters
    ----------
    patches : rows of `ellipse.patch_rows`, shape (n, 12)
    poisson_ratio : of roller and guide, shape (n, 2)
    settings : quadrature and search effort
    fields : traction over its bound at element centres, (n, 2, ny, nx), for models other than full sliding

    Valid for any ellipticity and 0 <= nu <= 0.5. The estimated error holds the change from the climb's quadrature
    to the summit's and the last gain of the climb.
    """
    patches = np.ascontiguousarray(patches)
    out = np.empty((len(patches), 2, 5))
    slender = np.maximum(patches[:, A], patches[:, B]) / np.minimum(patches[:, A], patches[:, B])
    # a slender patch turns its slip within a small part of its length
    finer = np.clip(np.rint(np.sqrt(slender / 2.0)), 1, 6).astype(int)
    for factor in np.unique(finer):
        group = np.flatnonzero(finer == factor)
        found = np.empty((group.size, 2, 5))
        orders = (settings.scan, settings.climb, settings.polish, settings.summit, max(settings.polish, 12))
        rules = tuple(array for order in orders for array in clustered_rule(int(order * factor)))
        chosen = np.zeros((group.size, 2, 1, 1)) if fields is None else np.ascontiguousarray(fields[group])
        ratios = np.ascontiguousarray(poisson_ratio[group], dtype=float)
        effort = (settings.seeds, settings.finalists, settings.step / factor, settings.floor)
        rest = (patches[group], chosen, _scans(patches[group]), ratios, rules, *effort, found)
        share_rows(functools.partial(_search_rows, rest), group.size, 1)
        out[group] = found
    return Peak(*np.moveaxis(out, 2, 0))
