"""Choose the starting points of the search for the peak stress: scan the patch and take the best points as seeds.

Coordinates are normalised: x over a, y over b, depth over the smaller semi-axis.
"""

from __future__ import annotations

import math

import numpy as np

from trackroller.halfspace.ellipse_kernels import grades_of, grid_point
from trackroller.halfspace.rigid_slip import pole_offset, slip_zeros
from trackroller.numerics.compiled import assign, compiled

Rings = tuple[tuple[float, int], ...]


def _scan_points(surface: Rings, below: tuple[tuple[float, Rings], ...]) -> np.ndarray:
    """Return points (rho cos, rho sin, depth) in normalised coordinates, (m, 3); rings are radii and counts."""
    rows = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, -1.0, 0.0)]
    for rho, count in surface:
        angles = 2 * np.pi * (np.arange(count) + 0.5 * (count == 12)) / count
        rows += [(rho * math.cos(t), rho * math.sin(t), 0.0) for t in angles]
    for depth, rings in below:
        rows.append((0.0, 0.0, depth))
        for rho, count in rings:
            angles = 2 * np.pi * (np.arange(count) + 0.5 * (rho == 0.4)) / count
            rows += [(rho * math.cos(t), rho * math.sin(t), depth) for t in angles]
    return np.array(rows)


_DEEP = ((0.5, ((0.45, 6),)), (0.75, ((0.45, 4),)))
SCAN = _scan_points(
    ((0.3, 6), (0.53, 10), (0.75, 12), (0.92, 12), (1.0, 12)),
    ((0.12, ((0.4, 6), (0.8, 6))), (0.2, ((0.95, 8),)), (0.3, ((0.4, 6), (0.8, 6))), *_DEEP),
)
# For tractions with adhesion: in random designs the peaks lie below the centre, or on the surface far from the rim.
SCAN_ADHESION = _scan_points(((0.3, 6), (0.53, 10), (0.78, 8), (1.0, 8)), ((0.3, ((0.6, 5),)), *_DEEP))

MOST_ON_RIDGE, OF_GRID = 128, 84  # points on the line where sliding begins, for each OF_GRID points of the grid
STICKS = 1.0 - 1e-4  # square of the traction over its bound below which an element sticks
NEAR_RIM = 0.98  # distance from the centre up to which the ridge is followed
SEED_WORTH = 0.85  # least stress of a seed over the largest

SPLIT = (0.02, 0.06)  # distances from the pole over the semi-axis at which a spike begins to count, and counts in full


def scan_points(patches: np.ndarray, slender: bool, adhesion: bool) -> np.ndarray:
    """Return the points of the scans, (n, m, 3): common points and points on the line where the lateral slip vanishes.

    The slip changes direction sharply on this line, which carries ridges of stress. In `slender` patches the slip turns
    within a fraction of the long axis; lines on both sides of this line and across the pole are added.

    Parameters
    ----------
    patches : numpy.ndarray, shape (n,)
        Records of `ellipse.patch_rows`.
    slender : bool
        True for slender patches.
    adhesion : bool
        True for tractions with adhesion, which turn smoothly: fewer points are enough, unless they are slender.
    """
    if adhesion and not slender:
        return np.broadcast_to(SCAN_ADHESION, (len(patches), *SCAN_ADHESION.shape))
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


@compiled
def ridge_points(patch, field):
    """Return surface points on the line where sliding begins, (m, 3); at most MOST_ON_RIDGE for each OF_GRID elements.

    Where a patch begins to slide, the traction changes with the root of the distance. Stresses at the surface have a
    cusp there. Nearly all peaks that a coarse scan misses lie on this line.

    Parameters
    ----------
    patch : record
        Record of `ellipse.patch_rows`.
    field : numpy.ndarray, shape (2, ny, nx)
        Traction over its bound on a grid.
    """
    _, ny, nx = field.shape
    along_x, along_y = grades_of(patch)
    slides = np.empty((ny, nx), np.bool_)
    for j in range(ny):
        for i in range(nx):
            slides[j, i] = field[0, j, i] ** 2 + field[1, j, i] ** 2 >= STICKS
    line, count = np.empty((ny * nx, 3)), 0
    for j in range(ny):
        for i in range(nx):
            if slides[j, i]:
                continue
            x, y = grid_point(i, along_x, nx), grid_point(j, along_y, ny)
            if x * x + y * y >= NEAR_RIM**2:
                continue
            beside = (j > 0 and slides[j - 1, i]) or (j + 1 < ny and slides[j + 1, i])
            if beside or (i > 0 and slides[j, i - 1]) or (i + 1 < nx and slides[j, i + 1]):
                line[count, 0], line[count, 1], line[count, 2] = x, y, 0.0
                count += 1
    most = MOST_ON_RIDGE * max(1, nx // OF_GRID)
    if count > most:
        for k in range(most):
            assign(line[k], line[int(k * ((count - 1) / (most - 1)))])
        count = most
    return line[:count]


def _fold(patches: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Return the y at which the lateral slip vanishes at x, both (n, m), normalised."""
    a, *line = (patches[name][:, None] for name in ("a", "k0", "k1", "k2"))
    return pole_offset(x * a, a, *line) / patches["b"][:, None]


def spike(patches: np.ndarray) -> np.ndarray:
    """Return the friction over p_max at points where the slip vanishes apart from the spin pole, (n,); 0 if none.

    The rolling slip, eq. (21), vanishes at two x. The pole of eq. (22) is the first of them up to terms of second
    order. Where both slips vanish under pressure, the stress of the model grows as a logarithm of the distance from
    this point, times this friction.
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
    """Return points (n, m, 2) beside the line `fold`, and on and beside the chord x = pole."""
    width = np.minimum(a, b) / np.maximum(a, b)
    shifts = [np.stack([np.zeros_like(width), k * np.minimum(a / b, 1.0)], axis=2) for k in (-1.0, 1.0)]
    chord = np.array([-0.95, -0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75, 0.95])
    lines = []
    for k in (-3.0, -1.0, 0.0, 1.0, 3.0):
        x = np.clip(pole + k * width, -1.0, 1.0)
        y = np.sqrt(1.0 - x * x) * chord
        lines.append(np.stack([np.broadcast_to(x, y.shape), y], axis=2))
    return [fold + shift for shift in shifts] + lines


@compiled
def along_turn(patch, u, out):
    """Write the unit vector along which the slip changes its direction least at a point u (3,) into `out` (2,).

    In a patch long in x this is the direction of y; in a patch long in y it is the line without lateral slip.
    """
    out[0], out[1] = 0.0, 1.0
    if patch.a <= patch.b:
        slope = (patch.k1 if u[0] * patch.a < patch.pole_x else patch.k2) * patch.a / patch.b
        length = math.sqrt(1.0 + slope * slope)
        out[0], out[1] = 1.0 / length, slope / length


@compiled
def best_seeds(points, values, count, apart):
    """Return the indices of up to `count` scan points (m, 3) with the largest `values` (m,).

    The points are `apart` from each other; they have at least the share SEED_WORTH of the largest value.
    """
    left, chosen, number = values.copy(), np.empty(count, np.int64), 0
    enough = SEED_WORTH * values.max()
    while number < count:
        best = left.argmax()
        if not left[best] > enough:
            break
        chosen[number] = best
        number += 1
        for k in range(left.size):
            if ((points[k] - points[best]) ** 2).sum() < apart * apart:
                left[k] = 0.0
    return chosen[:number]
