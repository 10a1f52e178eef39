"""Where the search for the peak stress begins: points of the scan and the best of them as seeds.

Coordinates are normalised: x over a, y over b, depth over the smaller semi-axis.
"""

from __future__ import annotations

import math

import numpy as np

from trackroller.halfspace.rigid_slip import pole_offset, slip_zeros


def _scan_points() -> np.ndarray:
    """Points (rho cos, rho sin, depth) in normalised coordinates."""
    rows = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, -1.0, 0.0)]
    for rho, count in ((0.3, 6), (0.53, 10), (0.75, 12), (0.92, 12), (1.0, 12)):
        angles = 2 * np.pi * (np.arange(count) + 0.5 * (count == 12)) / count
        rows += [(rho * math.cos(t), rho * math.sin(t), 0.0) for t in angles]
    for depth, rings in (
        (0.12, ((0.4, 6), (0.8, 6))),
        (0.2, ((0.95, 8),)),
        (0.3, ((0.4, 6), (0.8, 6))),
        (0.5, ((0.45, 6),)),
        (0.75, ((0.45, 4),)),
    ):
        rows.append((0.0, 0.0, depth))
        for rho, count in rings:
            angles = 2 * np.pi * (np.arange(count) + 0.5 * (rho == 0.4)) / count
            rows += [(rho * math.cos(t), rho * math.sin(t), depth) for t in angles]
    return np.array(rows)


SCAN = _scan_points()


SPLIT = (0.02, 0.06)  # distances from the pole over the semi-axis: from where on a spike counts, and in full


def scan_points(patches: np.ndarray, slender: bool) -> np.ndarray:
    """Points (n, m, 3) of the scans: the common ones and some on the line where the lateral slip turns.

    The sharp fold of the slip carries ridges of stress. In `slender` patches the slip turns within a fraction of the
    long axis, so lines on both sides of the fold and across the pole are looked at as well.
    """
    pole = np.clip(patches["pole_x"] / patches["a"], -1.0, 1.0)[:, None]
    share = np.array([0.15, 0.4, 0.6, 0.85])
    x = np.concatenate([pole - share * (1.0 + pole), pole + share * (1.0 - pole)], axis=1)
    u = np.stack([x, _fold(patches, x)], axis=2)
    if slender:
        u = np.concatenate(
            [u, *_beside_turn(u[:, : 2 * share.size], pole, patches["a"][:, None], patches["b"][:, None])], axis=1
        )
    u /= np.maximum(np.hypot(u[..., 0], u[..., 1]), 1.0)[..., None]
    turning = np.concatenate([u, np.zeros((*u.shape[:2], 1))], axis=2)
    return np.concatenate([np.broadcast_to(SCAN, (len(patches), *SCAN.shape)), turning], axis=1)


def _fold(patches: np.ndarray, x: np.ndarray) -> np.ndarray:
    """y where the lateral slip vanishes at x (n, m)."""
    a, *line = (patches[name][:, None] for name in ("a", "k0", "k1", "k2"))
    return pole_offset(x * a, a, *line) / patches["b"][:, None]


def spike(patches: np.ndarray) -> np.ndarray:
    """Friction over p_max (n,) where the slip vanishes apart from its pole, or a second time; 0 where it does not.

    The rolling slip, eq. (24), vanishes at two x, of which the pole of eq. (22) is the first but for terms of second
    order. Where both slips vanish under pressure the stress of the model grows about that point as a logarithm of
    the distance, times this friction.
    """
    sine, cosine, radius, shift = (patches[name] for name in ("sine", "cosine", "radius", "shift"))
    with np.errstate(invalid="ignore"):
        x = np.stack(slip_zeros(sine, cosine, radius, shift), axis=1) / patches["a"][:, None]
    x = np.nan_to_num(x, nan=2.0)  # no zero: a point outside the patch
    apart = np.abs(x - (patches["pole_x"] / patches["a"])[:, None])
    inside = np.maximum(1.0 - x * x - _fold(patches, x) ** 2, 0.0)
    share = np.clip((apart - SPLIT[0]) / (SPLIT[1] - SPLIT[0]), 0.0, 1.0)
    return np.where(patches["fixed"] == 0.0, patches["friction"] * (share * np.sqrt(inside)).max(axis=1), 0.0)


def _beside_turn(fold: np.ndarray, pole: np.ndarray, a: np.ndarray, b: np.ndarray) -> list[np.ndarray]:
    """Points (n, m, 2) beside the fold of the slip, and on and beside the chord x = pole."""
    width = np.minimum(a, b) / np.maximum(a, b)
    shifts = [np.stack([np.zeros_like(width), k * np.minimum(a / b, 1.0)], axis=2) for k in (-1.0, 1.0)]
    chord = np.array([-0.95, -0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75, 0.95])
    lines = []
    for k in (-3.0, -1.0, 0.0, 1.0, 3.0):
        x = np.clip(pole + k * width, -1.0, 1.0)
        y = np.sqrt(1.0 - x * x) * chord
        lines.append(np.stack([np.broadcast_to(x, y.shape), y], axis=2))
    return [fold + shift for shift in shifts] + lines


def along_turn(patch: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Unit vectors (m, 2) along which the slip turns slowest at points u (m, 3) of patches (m, 12).

    In a patch long in x that is the direction of y, in one long in y that of the fold.
    """
    slope = np.where(u[:, 0] * patch["a"] < patch["pole_x"], patch["k1"], patch["k2"]) * patch["a"] / patch["b"]
    wide = patch["a"] > patch["b"]
    length = np.sqrt(1.0 + slope * slope)
    return np.stack([np.where(wide, 0.0, 1.0 / length), np.where(wide, 1.0, slope / length)], axis=1)


def best_seeds(points: np.ndarray, values: np.ndarray, count: int, apart: float) -> np.ndarray:
    """Scan points (n, m, 3) of largest value, `apart` from each other: indices (n, count), -1 where no more are."""
    left, every = values.copy(), np.arange(len(values))
    enough = 0.85 * values.max(axis=1)
    chosen = np.full((len(values), count), -1)
    for k in range(count):
        best = left.argmax(axis=1)
        good = left[every, best] > enough
        chosen[good, k] = best[good]
        gap = ((points - points[every, best][:, None, :]) ** 2).sum(axis=2)
        left = np.where(gap < apart * apart, 0.0, left)
    return chosen
