"""The largest von Mises stress over the closed half-space below a sliding Hertzian ellipse.

A coarse scan over surface and depth finds seeds, both bodies sharing its stress evaluations; from each seed a
pattern search with quadratic models climbs, the surface and the edge of the patch being admissible; the summit
is evaluated again with finer quadrature. Stresses per unit p_max, depth in units of the smaller semi-axis.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trackroller.halfspace.ellipse import near_parts, refinement, unit_rule
from trackroller.halfspace.ellipse_kernels import FRICTION, A, B
from trackroller.halfspace.peak_seeds import along_turn, best_seeds, scan_points, spike
from trackroller.numerics.threads import share_rows


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


PROPORTIONS = np.array([1.0, 1.6, 1.0])  # of first steps along radius, circumference and depth
APART = (0.5, 0.2)  # of seeds in ordinary and in slender patches
GAPS = (0.045, 0.017, 0.008)  # to the highest, times the number of finalists: seeds further down are given up


@dataclass(frozen=True)
class _Patches:
    """What the search needs of n patches; `climbs` have a patch and a body each."""

    rows: np.ndarray
    fields: np.ndarray
    poisson_ratio: np.ndarray
    slender: bool

    def parts(self, of: np.ndarray, u: np.ndarray, waves: np.ndarray, rule: np.ndarray) -> np.ndarray:
        """Stress parts (4, 6, m) of patches `of` at normalised points u (m, 3)."""
        patch = self.rows[of]
        points = np.empty((len(u), 3))
        points[:, 0], points[:, 1] = u[:, 0] * patch[:, A], u[:, 1] * patch[:, B]
        points[:, 2] = u[:, 2] * np.minimum(patch[:, A], patch[:, B])
        return np.moveaxis(near_parts(self.rows, self.fields, of, points, waves, rule), 0, 2)

    def stress(self, of: np.ndarray, body: np.ndarray, u: np.ndarray, waves: np.ndarray, rule: np.ndarray):
        """von Mises stress (m,) in bodies `body` of patches `of` at normalised points u (m, 3), on all threads."""
        out = np.empty(len(u))

        def work(first: int, last: int) -> None:
            some = slice(first, last)
            parts = self.parts(of[some], u[some], waves, rule)
            out[some] = _von_mises(parts, self.poisson_ratio[of[some], body[some]], 1.0 - 2.0 * body[some])

        share_rows(work, len(u), 64, 1024)
        return out

    def scan(self, u: np.ndarray, rule: np.ndarray) -> np.ndarray:
        """von Mises stress (n, m, 2) in both bodies at normalised points u (n, m, 3), on all threads."""
        n, m = u.shape[:2]
        out = np.empty((n * m, 2))
        of, flat = np.repeat(np.arange(n), m), u.reshape(n * m, 3)

        def work(first: int, last: int) -> None:
            some = slice(first, last)
            parts = self.parts(of[some], flat[some], rule, rule)
            for body, sign in ((0, 1.0), (1, -1.0)):
                out[some, body] = _von_mises(parts, self.poisson_ratio[of[some], body], sign)

        share_rows(work, n * m, 64, 1024)
        return out.reshape(n, m, 2)


def _von_mises(parts: np.ndarray, nu: np.ndarray, sign) -> np.ndarray:
    """von Mises stress (m,), eq. (6), from stress parts (4, 6, m)."""
    s = parts[0] + nu * parts[1] + sign * (parts[2] + nu * parts[3])
    one, two, three = s[0] - s[1], s[2] - s[0], s[1] - s[2]
    shear = s[3] * s[3] + s[4] * s[4] + s[5] * s[5]
    return np.sqrt(0.5 * (one * one + two * two + three * three) + 3.0 * shear)


def _project(u: np.ndarray) -> np.ndarray:
    """The nearest points of the closed half-space below the patch."""
    r = np.sqrt(u[:, 0] ** 2 + u[:, 1] ** 2)
    u[:, :2] /= np.maximum(r, 1.0)[:, None]
    u[:, 2] = np.maximum(u[:, 2], 0.0)
    return u


@dataclass
class _Climbs:
    """Points u (m, 3) with stress f (m,) on their way up, each in a body of a patch; `gained` by the last sweep,
    `step` (m, 3) of the search along radius, circumference and depth, `along` (m, 2) the first axis."""

    patches: _Patches
    of: np.ndarray
    body: np.ndarray
    u: np.ndarray
    f: np.ndarray
    gained: np.ndarray
    step: np.ndarray
    along: np.ndarray

    def values(self, i: np.ndarray, u: np.ndarray, waves: np.ndarray, rule: np.ndarray) -> np.ndarray:
        return self.patches.stress(self.of[i], self.body[i], u, waves, rule)

    def try_points(self, i: np.ndarray, u: np.ndarray, waves: np.ndarray, rule: np.ndarray) -> np.ndarray:
        """Moves climbs `i` to u (len(i), 3) where that is higher; returns the values there."""
        value = self.values(i, u, waves, rule)
        better = value > self.f[i]
        self.u[i[better]], self.f[i[better]] = u[better], value[better]
        return value

    def sweep(self, rows: np.ndarray, waves, rule, smallest: float, ridge: bool) -> np.ndarray:
        """A parabola along radius, circumference and depth in turn from `rows`; returns those not yet at rest."""
        before, start = self.f[rows], self.u[rows]
        r = np.sqrt(start[:, 0] ** 2 + start[:, 1] ** 2)
        off = r > 1e-9
        c, s = np.where(off, start[:, 0], 1.0), np.where(off, start[:, 1], 0.0)
        r = np.where(off, r, 1.0)
        c, s, zero = c / r, s / r, np.zeros_like(r)
        if self.patches.slender:  # ridges are narrow there: inside of the rim an axis lies along them
            inner = self.u[rows, 0] ** 2 + self.u[rows, 1] ** 2 < 0.998
            c, s = np.where(inner, self.along[rows, 0], c), np.where(inner, self.along[rows, 1], s)
        axes = np.stack([np.stack([c, s, zero], 1), np.stack([-s, c, zero], 1), np.stack([zero, zero, zero + 1.0], 1)])
        moved = zero
        for k in range(3):
            moved = np.maximum(moved, self._along(rows, axes[k], self.step[:, k], waves, rule))
        if ridge:  # one that lies askew to the axes
            far = ((self.u[rows] - start) ** 2).sum(axis=1) > 1e-8
            self.try_points(rows[far], _project(2.0 * self.u[rows[far]] - start[far]), waves, rule)
        if self.patches.slender:
            self._turn(rows, start)
        self.gained[rows] = self.f[rows] - before
        widest = self.step[rows].max(axis=1)
        still = (self.gained[rows] < 1e-6 * self.f[rows]) & (moved < 1e-9) & (widest < 4.0 * smallest)
        return rows[~((widest < smallest) | still)]

    def _turn(self, rows: np.ndarray, start: np.ndarray) -> None:
        """Turns the first axis of climbs `rows` into the direction they have gone from `start` (Rosenbrock)."""
        gone = self.u[rows, :2] - start[:, :2]
        length = np.sqrt(gone[:, 0] ** 2 + gone[:, 1] ** 2)
        far = length > 1e-5
        self.along[rows[far]] = gone[far] / length[far, None]

    def standing(self, share: float, gap: float, most: int) -> np.ndarray:
        """Up to `most` climbs of each body: the highest, and those above its `share` that are not the same summit.

        The others are given up. Points closer than `gap` to a higher one are taken for the same summit.
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
        """One axis (m, 3) of the pattern: both sides, then the summit of the parabola; returns moves over steps h."""
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


def _search(patches: _Patches, rules: tuple, settings: PeakSettings, smallest: float, out: np.ndarray) -> None:
    """Fills out (n, 2, 5): stress, place in normalised coordinates and error of both bodies of each patch."""
    scan_rule, climb_rule, polish_rule, summit_rule, waves = rules
    slender = patches.slender
    n, count = len(patches.rows), settings.seeds + 5 * slender
    points = scan_points(patches.rows, slender)
    values = patches.scan(points, scan_rule)
    chosen = np.stack([best_seeds(points, values[:, :, body], count, APART[slender]) for body in (0, 1)], axis=1)
    of, body, _ = (index.ravel() for index in np.indices((n, 2, count)))
    climbs = _Climbs(
        patches,
        of,
        body,
        points[of, chosen.ravel()],
        np.full(of.size, -1.0),
        np.zeros(of.size),
        0.12 * PROPORTIONS * np.ones((of.size, 3)),
        np.zeros((of.size, 2)),
    )
    climbs.along[:] = along_turn(patches.rows[of], climbs.u)
    rows = np.flatnonzero(chosen.ravel() >= 0)
    climbs.f[rows] = climbs.values(rows, climbs.u[rows], climb_rule, climb_rule)
    # the scan is rough: seeds that fall behind with better quadrature are given up, and sooner with every sweep
    finalists = settings.finalists + 2 * slender
    most = max(finalists, 2)
    for k, gap in enumerate(GAPS):
        if k == 1:
            climbs.step[:] = 0.08 * PROPORTIONS
        rows = climbs.standing(max(1.0 - gap * most, 1e-9), 0.15 if k > 0 else 0.0, most)
        climbs.sweep(rows, climb_rule, climb_rule, 0.06, k > 1)
    rows = climbs.standing(0.97, 0.1, finalists)
    found = climbs.values(rows, climbs.u[rows], waves, polish_rule)
    climbs.f[rows] = found
    climbs.step[:] = max(3.0 * smallest, 0.01) * PROPORTIONS
    for k in range(12 + 12 * slender):
        if rows.size > 0:
            rows = climbs.sweep(rows, waves, polish_rule, smallest, k > 0)
    best = np.arange(2 * n) * count + climbs.f.reshape(2 * n, count).argmax(axis=1)
    summit = climbs.values(best, climbs.u[best], summit_rule, summit_rule)
    error = 4.0 * (np.abs(summit - climbs.f[best]) + climbs.gained[best]) / summit
    out[:, :, 0], out[:, :, 4] = summit.reshape(n, 2), error.reshape(n, 2)
    out[:, :, 1:4] = climbs.u[best].reshape(n, 2, 3)


def _change_by_elements(patches: _Patches, found: np.ndarray, rule: np.ndarray) -> np.ndarray:
    """Relative change of the peaks (n, 2, 5) of `_search` where elements of twice the size have the mean tractions."""
    n, _, ny, nx = patches.fields.shape
    if ny % 2 or nx % 2:
        return np.zeros((n, 2))
    blocks = patches.fields.reshape(n, 2, ny // 2, 2, nx // 2, 2)
    inside = np.any(blocks != 0.0, axis=1, keepdims=True).sum(axis=(3, 5))
    means = blocks.sum(axis=(3, 5)) / np.maximum(inside, 1)
    coarse = _Patches(patches.rows, np.ascontiguousarray(means), patches.poisson_ratio, patches.slender)
    of, body = (index.ravel() for index in np.indices((n, 2)))
    other = coarse.stress(of, body, np.ascontiguousarray(found[:, :, 1:4]).reshape(2 * n, 3), rule, rule)
    return np.abs(other.reshape(n, 2) / found[:, :, 0] - 1.0)


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
    to the summit's, the last gain of the climb, and with `fields` the change on elements of twice the size.
    """
    patches = np.ascontiguousarray(patches)
    out = np.empty((len(patches), 2, 5))
    long, short = np.maximum(patches[:, A], patches[:, B]), np.minimum(patches[:, A], patches[:, B])
    finer = refinement(patches)
    for factor in np.unique(finer):
        group = np.flatnonzero(finer == factor)
        orders = (settings.scan, settings.climb, settings.polish, settings.summit, max(settings.polish, 12))
        rules = tuple(unit_rule(int(order * factor)) for order in orders)
        chosen = np.zeros((group.size, 2, 1, 1)) if fields is None else np.ascontiguousarray(fields[group])
        some = _Patches(
            patches[group], chosen, np.ascontiguousarray(poisson_ratio[group], dtype=float), bool(factor > 1)
        )
        found = np.empty((group.size, 2, 5))
        _search(some, rules, settings, settings.step / factor, found)
        if fields is not None:
            found[:, :, 4] += _change_by_elements(some, found, rules[3])
        out[group] = found
    # a missed or not quite climbed ridge shows nowhere: measured, it grows so with friction and slenderness
    out[:, :, 4] += (settings.floor * (1.0 + 10.0 * patches[:, FRICTION] ** 2 * np.sqrt(long / short)))[:, None]
    if fields is None:  # whether the search meets the spike of a logarithm is chance, and how far it follows it
        out[:, :, 4] += 4.0 * spike(patches)[:, None] / out[:, :, 0]
    # very slender patches under friction hide ridges from a rough search: 5 % seen at `standard`
    hidden = (long / short > 50.0) & (patches[:, FRICTION] > 0)
    out[:, :, 4] += np.where(hidden, 160.0 * settings.floor, 0.0)[:, None]
    out[:, :, 1:4] *= np.stack([patches[:, A], patches[:, B], short], axis=1)[:, None, :]
    return Peak(*np.moveaxis(out, 2, 0))
