"""Climb from seeds to the highest von Mises stress below ellipses by a pattern search with parabolas.

Coordinates are normalised: x over a, y over b, depth over the smaller semi-axis. Stresses are per unit p_max.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from trackroller.halfspace.ellipse import near_parts
from trackroller.halfspace.stress import FRICTION_SIGNS, von_mises_of_parts
from trackroller.numerics.threads import share_rows

PROPORTIONS = np.array([1.0, 1.6, 1.0])  # of the first steps along radius, circumference and depth


@dataclass(frozen=True)
class Patches:
    """The n patches of a search.

    Attributes
    ----------
    rows : numpy.ndarray, shape (n,)
        Records of `ellipse.patch_rows`.
    fields : numpy.ndarray, shape (n, 2, ny, nx)
        Traction fields.
    poisson_ratio : numpy.ndarray, shape (n, 2)
        Poisson's ratios of roller and guide [1].
    slender : bool
        True if the quadrature rules of these patches are refined.
    adhesion : bool
        True if the fields are known to have areas of adhesion.
    """

    rows: np.ndarray
    fields: np.ndarray
    poisson_ratio: np.ndarray
    slender: bool
    adhesion: bool = False

    @property
    def gridded(self) -> bool:
        """Return whether there are traction fields."""
        return self.fields.shape[-1] > 1

    @functools.cached_property
    def sizes(self) -> np.ndarray:
        """Return the `lengths` of the patches."""
        return lengths(self.rows)

    def parts(self, of: np.ndarray, u: np.ndarray, waves: np.ndarray, rule: np.ndarray) -> np.ndarray:
        """Return stress parts (m, 4, 6) of patches `of` at normalised points u (m, 3)."""
        points = u * self.sizes[of]
        return near_parts(self.rows, self.fields, of, points, waves, rule)

    def stress(self, of: np.ndarray, body: np.ndarray, u: np.ndarray, waves: np.ndarray, rule: np.ndarray):
        """Return the von Mises stress (m,) in `body` of patches `of` at normalised points u (m, 3), on all threads."""
        out, nu, signs = np.empty(len(u)), self.poisson_ratio[of, body], np.take(FRICTION_SIGNS, body)

        def work(first: int, last: int) -> None:
            some = slice(first, last)
            von_mises_of_parts(self.parts(of[some], u[some], waves, rule), nu[some], signs[some], out[some])

        share_rows(work, len(u), 64, 1024)
        return out

    def scan(self, u: np.ndarray, rule: np.ndarray) -> np.ndarray:
        """Return the von Mises stress (n, m, 2) in both bodies at normalised points u (n, m, 3); 0 at points of NaN."""
        of, place = np.nonzero(np.isfinite(u[..., 0]))
        points, stress = u[of, place], np.empty((2, of.size))
        nu, signs = np.ascontiguousarray(self.poisson_ratio[of].T), np.repeat(FRICTION_SIGNS, of.size).reshape(2, -1)

        def work(first: int, last: int) -> None:
            some = slice(first, last)
            parts = self.parts(of[some], points[some], rule, rule)
            for body in (0, 1):
                von_mises_of_parts(parts, nu[body, some], signs[body, some], stress[body, some])

        share_rows(work, of.size, 64, 1024)
        out = np.zeros((*u.shape[:2], 2))
        out[of, place] = stress.T
        return out


def lengths(rows: np.ndarray) -> np.ndarray:
    """Return the units of normalised points, (n, 3) [mm]: a, b, and the smaller semi-axis for the depth."""
    a, b = rows["a"], rows["b"]
    return np.stack([a, b, np.minimum(a, b)], axis=1)


def _project(u: np.ndarray) -> np.ndarray:
    """Move points u (m, 3) to the nearest points of the closed half-space below the patch."""
    r = np.sqrt(u[:, 0] ** 2 + u[:, 1] ** 2)
    u[:, :2] /= np.maximum(r, 1.0)[:, None]
    u[:, 2] = np.maximum(u[:, 2], 0.0)
    return u


@dataclass
class Climbs:
    """Points that climb towards the highest stress.

    Attributes
    ----------
    patches : Patches
        The patches.
    of, body : numpy.ndarray of int, shape (m,)
        Patch and body of each climb.
    u, f : numpy.ndarray, shape (m, 3) and (m,)
        Normalised points and their stress.
    gained : numpy.ndarray, shape (m,)
        Increase of the stress in the last sweep.
    step : numpy.ndarray, shape (m, 3)
        Steps along radius, circumference and depth.
    along : numpy.ndarray, shape (m, 2)
        Direction of the first axis.
    """

    patches: Patches
    of: np.ndarray
    body: np.ndarray
    u: np.ndarray
    f: np.ndarray
    gained: np.ndarray
    step: np.ndarray
    along: np.ndarray

    def values(self, i: np.ndarray, u: np.ndarray, waves: np.ndarray, rule: np.ndarray) -> np.ndarray:
        """Return the stress of climbs `i` at the points u (len(i), 3)."""
        return self.patches.stress(self.of[i], self.body[i], u, waves, rule)

    def try_points(self, i: np.ndarray, u: np.ndarray, waves: np.ndarray, rule: np.ndarray) -> np.ndarray:
        """Move climbs `i` to u (len(i), 3) where the stress is higher; return the stress there."""
        value = self.values(i, u, waves, rule)
        better = value > self.f[i]
        self.u[i[better]], self.f[i[better]] = u[better], value[better]
        return value

    def sweep(self, rows: np.ndarray, waves, rule, smallest: float, ridge: bool) -> np.ndarray:
        """Search along radius, circumference and depth in turn; return the climbs of `rows` that still move.

        With `ridge` a further step repeats the whole move of this sweep, which follows ridges oblique to the axes.
        """
        before, start = self.f[rows], self.u[rows]
        axes = self._axes(rows)
        moved = np.zeros(rows.size)
        for k in range(3):
            moved = np.maximum(moved, self._along(rows, axes[k], self.step[:, k], waves, rule))
        if ridge:
            far = ((self.u[rows] - start) ** 2).sum(axis=1) > 1e-8
            self.try_points(rows[far], _project(2.0 * self.u[rows[far]] - start[far]), waves, rule)
        if self.patches.slender:
            self._turn(rows, start)
        self.gained[rows] = self.f[rows] - before
        widest = self.step[rows].max(axis=1)
        still = (self.gained[rows] < 1e-6 * self.f[rows]) & (moved < 1e-9) & (widest < 4.0 * smallest)
        return rows[~((widest < smallest) | still)]

    def _axes(self, rows: np.ndarray) -> np.ndarray:
        """Return the axes (3, m, 3) of the pattern: radius, circumference and depth.

        Slender patches have narrow ridges; inside the rim the first axis lies along the ridge.
        """
        x, y, _ = self.u[rows].T
        r = np.sqrt(x**2 + y**2)
        off = r > 1e-9
        c, s = np.where(off, x, 1.0), np.where(off, y, 0.0)
        r = np.where(off, r, 1.0)
        c, s, zero = c / r, s / r, np.zeros_like(r)
        if self.patches.slender:
            inner = x**2 + y**2 < 0.998
            ridge_x, ridge_y = self.along[rows].T
            c, s = np.where(inner, ridge_x, c), np.where(inner, ridge_y, s)
        return np.stack([np.stack([c, s, zero], 1), np.stack([-s, c, zero], 1), np.stack([zero, zero, zero + 1.0], 1)])

    def _turn(self, rows: np.ndarray, start: np.ndarray) -> None:
        """Turn the first axis of climbs `rows` into the direction of their move from `start` (Rosenbrock)."""
        gone = self.u[rows, :2] - start[:, :2]
        length = np.sqrt(gone[:, 0] ** 2 + gone[:, 1] ** 2)
        far = length > 1e-5
        self.along[rows[far]] = gone[far] / length[far, None]

    def standing(self, share: float, gap: float, most: int) -> np.ndarray:
        """Return up to `most` climbs of each body and give up the others.

        The highest climb and those above its `share` remain. Of points closer than `gap` only the highest remains.
        """
        of_a_body = len(self.f) // (2 * len(self.patches.rows))
        f, u = self.f.reshape(-1, of_a_body), self.u.reshape(-1, of_a_body, 3)
        every = np.arange(len(f))
        left, enough = f.copy(), share * f.max(axis=1)
        rows = []
        for _ in range(min(most, of_a_body)):
            best = left.argmax(axis=1)
            good = left[every, best] >= enough
            rows.append((every * of_a_body + best)[good])
            left[every, best] = -1.0
            left = np.where(((u - u[every, best][:, None, :]) ** 2).sum(axis=2) < gap * gap, -1.0, left)
        standing = np.sort(np.concatenate(rows))
        fallen = np.ones(len(self.f), bool)
        fallen[standing] = False
        self.f[fallen] = -1.0
        return standing

    def _along(self, rows: np.ndarray, axis: np.ndarray, h: np.ndarray, waves, rule) -> np.ndarray:
        """Search along one axis (m, 3): both sides, then the top of the parabola; return the moves over the steps h."""
        u_0, f_0, step = self.u[rows], self.f[rows], h[rows]
        side = np.stack([_project(u_0 + step[:, None] * axis), _project(u_0 - step[:, None] * axis)])
        fresh = np.abs(side - u_0).sum(axis=2) >= 1e-12
        f_side = np.stack([f_0, f_0])
        f_side[fresh] = self.values(np.concatenate([rows[fresh[0]], rows[fresh[1]]]), side[fresh], waves, rule)
        for k in (0, 1):
            better = f_side[k] > self.f[rows]
            self.u[rows[better]], self.f[rows[better]] = side[k][better], f_side[k][better]
        curve = f_side[0] - 2.0 * f_0 + f_side[1]
        round_top = curve < 0.0
        jump = 0.5 * step * (f_side[1] - f_side[0]) / np.where(round_top, curve, -1.0)
        jump = np.minimum(np.maximum(jump, -2.0 * step), 2.0 * step)
        worth = round_top & (np.abs(jump) > 0.05 * step) & (np.abs(np.abs(jump) - step) > 0.05 * step)
        self.try_points(rows[worth], _project(u_0[worth] + jump[worth, None] * axis[worth]), waves, rule)
        distance = np.abs(self.u[rows] - u_0).sum(axis=1)
        longer = np.where(distance > 1.5 * step, 1.5 * step, step) if self.patches.slender else step
        h[rows] = np.where(distance < 0.5 * step, 0.35 * step, longer)
        return distance / step
