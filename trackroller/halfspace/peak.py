"""The largest von Mises stress in the closed half-space below a sliding Hertzian ellipse.

A coarse scan over surface and depth finds seeds; both bodies share its stress evaluations. From each seed a pattern
search climbs (`peak_climb`); points on the surface and on the edge of the patch are allowed. The highest point is
evaluated again with finer quadrature.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from trackroller.halfspace.ellipse import FIELD, Room, fields_of, refinement
from trackroller.halfspace.peak_climb import (
    Rules,
    Target,
    has_ridges,
    lengths,
    no_climbs,
    polish,
    scan,
    set_steps,
    standing,
    stress_at,
    sweep,
)
from trackroller.halfspace.peak_near import climb_near
from trackroller.halfspace.peak_seeds import along_turn, best_seeds, ridge_points, scan_points, spike
from trackroller.halfspace.peak_settings import PeakSettings
from trackroller.numerics.compiled import assign, compiled, woven
from trackroller.numerics.rows import Rows
from trackroller.numerics.threads import share_rows

APART = (0.5, 0.2)  # distance of seeds in ordinary and in slender patches
ROUGH = 48  # most elements along an axis for the first climbs, which search below merged elements
GAPS = (0.045, 0.017, 0.008)  # relative distance to the highest, per finalist, below which a climb is given up


class Patches(NamedTuple):
    """The n patches of a search.

    Attributes
    ----------
    rows : numpy.ndarray, shape (n,)
        Records of `ellipse.patch_rows`.
    fields, rough, coarse : numpy.ndarray, shape (n, 2, ny, nx)
        Traction fields; those of few elements for the first climbs; those of a coarser grid for the estimated error.
    poisson_ratio : numpy.ndarray, shape (n, 2)
        Poisson's ratios of roller and guide [1].
    units : numpy.ndarray, shape (n, 3)
        See `lengths`.
    points : numpy.ndarray, shape (n, m, 3)
        Points of the scans.
    near : numpy.ndarray, shape (n, 2, 3)
        Peaks at hand.
    """

    rows: np.ndarray
    fields: np.ndarray
    rough: np.ndarray
    coarse: np.ndarray
    poisson_ratio: np.ndarray
    units: np.ndarray
    points: np.ndarray
    near: np.ndarray


class Effort(NamedTuple):
    """Effort of a search: seeds and finalists of each body, distance of seeds, smallest step, kind of the patches."""

    seeds: int
    finalists: int
    apart: float
    smallest: float
    slender: bool
    gridded: bool
    adhesion: bool
    quick: bool
    close: bool


@dataclass(frozen=True)
class Peak(Rows):
    """Peak von Mises stress and its place; arrays (n, 2), second axis roller and guide.

    `stress` per unit p_max (in MPa below solved patches), `x`, `y`, `z` [mm], `error` the estimated relative error, and
    `change` its part by the elements: the relative change of the stress with tractions on a coarser grid.
    """

    stress: np.ndarray
    x: np.ndarray
    y: np.ndarray
    z: np.ndarray
    error: np.ndarray
    change: np.ndarray

    @classmethod
    def empty(cls, n: int) -> Peak:
        """Return n peaks that are NaN."""
        return cls(*(np.full((n, 2), np.nan) for _ in dataclasses.fields(cls)))

    def put(self, rows, peak: Peak) -> None:
        """Overwrite the rows by other peaks."""
        for field in dataclasses.fields(self):
            getattr(self, field.name)[rows] = getattr(peak, field.name)

    def higher(self, other: Peak) -> Peak:
        """Return the higher peak of each body."""
        above = other.stress > self.stress
        return Peak(*(np.where(above, getattr(other, f.name), getattr(self, f.name)) for f in dataclasses.fields(self)))


@compiled
def _search_rows(first, last, patches, rules, effort, room, out):
    """Write stress, place and relative error of the peaks of patches `first` to `last` into `out` (n, 2, 6)."""
    for i in range(first, last):
        row, nu, unit = patches.rows[i], patches.poisson_ratio[i], patches.units[i]
        fine = Target(row, patches.fields[i], nu, unit, effort.slender or effort.close, room)
        if effort.close:
            line = ridge_points(row, patches.fields[i])
            climbs = climb_near(fine, patches.near[i], line, rules.scan, rules.climb, rules.ridge, effort.smallest)
        else:
            rough = Target(row, patches.rough[i], nu, unit, effort.slender, room)
            climbs = _climbed(fine, rough, patches.points[i], rules, effort)
        _write_highest(fine, climbs, rules.summit, out[i])
        if effort.gridded and not effort.close:
            coarse = Target(row, patches.coarse[i], nu, unit, effort.slender, room)
            for body in range(2):
                other = stress_at(coarse, body, out[i, body, 1:4], rules.summit)
                out[i, body, 5] = abs(other / out[i, body, 0] - 1.0)
                out[i, body, 4] += out[i, body, 5]


@woven
def _climbed(fine, rough, points, rules, effort):
    """Return climbs from the highest points of a scan, below few elements at first; the best are polished."""
    climbs = _seeded(fine, rough, points, rules, effort)
    # Tractions on a grid are less smooth than sliding ones, so that a finer rule gains little in the first sweep.
    # the scan is rough: climbs that fall behind with better quadrature are given up, and sooner with every sweep
    most = max(effort.finalists, 2)
    for k in range(0 if effort.quick else len(GAPS)):
        if k == 1:
            set_steps(climbs, 0.08)
        rule = rules.scan if k == 0 and effort.gridded else rules.climb
        stand = standing(climbs, max(1.0 - GAPS[k] * most, 1e-9), 0.15 if k > 0 else 0.0, most)
        for climb in np.flatnonzero(stand):
            sweep(rough, climbs, climb, rule, 0.06, int(k > 1))
    set_steps(climbs, max(3.0 * effort.smallest, 0.01))
    for climb in np.flatnonzero(standing(climbs, 0.97, 0.1, effort.finalists)):
        rule = rules.ridge if climbs.u[climb, 2] == 0.0 else rules.polish
        climbs.f[climb] = stress_at(fine, climb // effort.seeds, climbs.u[climb], rule)
        polish(fine, climbs, climb, rule, effort.smallest, 24 if effort.slender else 12)
    return climbs


@woven
def _write_highest(fine, climbs, rule, out):
    """Write the highest climb of each body, in normalised coordinates, into `out` (2, 6)."""
    count = climbs.f.size // 2
    for body in range(2):
        best = body * count + climbs.f[body * count : (body + 1) * count].argmax()
        summit = stress_at(fine, body, climbs.u[best], rule)
        out[body, 0] = summit
        assign(out[body, 1:4], climbs.u[best])
        out[body, 4] = 4.0 * (abs(summit - climbs.f[best]) + climbs.gained[best]) / summit


@woven
def _seeded(fine, rough, points, rules, effort):
    """Scan the patch and return climbs from the highest places, below few elements at first."""
    count, values = effort.seeds, scan(rough, points, rules.scan)
    if effort.adhesion and has_ridges(fine, points, values):
        line = ridge_points(fine.patch, fine.field)
        points, values = np.concatenate((points, line)), np.concatenate((values, scan(fine, line, rules.scan)), axis=1)
    climbs = no_climbs(count, 0.12)
    u, f = climbs.u, climbs.f
    for body in range(2):
        k = body * count
        for best in best_seeds(points, values[body], count, effort.apart):
            assign(u[k], points[best])
            f[k] = values[body, best]
            if not effort.gridded:  # the first sweep of the others takes the rule of the scan, see `_climbed`
                f[k] = stress_at(rough, body, u[k], rules.climb)
            along_turn(fine.patch, u[k], climbs.along[k])
            k += 1
    return climbs


def _rough(fields: np.ndarray) -> np.ndarray:
    """Return fields with at most ROUGH elements along each axis for the first climbs: these stay in the fast caches."""
    while min(fields.shape[-2:]) > 4 * ROUGH:  # neighbours of so fine a grid hardly differ
        fields = np.ascontiguousarray(fields[..., ::2, ::2])
    while min(fields.shape[-2:]) > ROUGH and not (fields.shape[-1] % 2 or fields.shape[-2] % 2):
        fields = np.ascontiguousarray(_merged(fields), FIELD)
    return fields


def _merged(fields: np.ndarray) -> np.ndarray:
    """Return the mean tractions of elements of twice the size; the fields themselves for odd numbers of elements."""
    if fields.shape[-1] % 2 or fields.shape[-2] % 2:
        return fields
    blocks = [fields[..., j::2, i::2] for j in (0, 1) for i in (0, 1)]
    inside = sum(np.any(block, axis=1, keepdims=True).astype(FIELD) for block in blocks)
    return sum(blocks) / np.maximum(inside, 1)


def find_peaks(
    patches: np.ndarray,
    poisson_ratio: np.ndarray,
    settings: PeakSettings,
    fields: np.ndarray | None = None,
    coarse: np.ndarray | None = None,
    quick: bool = False,
    near: Peak | None = None,
) -> Peak:
    """Find the peak von Mises stress of roller and guide below n ellipses.

    Parameters
    ----------
    patches : numpy.ndarray, shape (n,)
        Records of `ellipse.patch_rows`.
    poisson_ratio : numpy.ndarray, shape (n, 2)
        Poisson's ratios of roller and guide [1].
    settings : PeakSettings
        Quadrature and search effort.
    fields : numpy.ndarray, shape (n, 2, ny, nx), optional
        Traction over its bound at element centres; full sliding if not given.
    coarse : numpy.ndarray, optional
        The same on a coarser grid, for the estimated error; only tractions of the exact theory, which have adhesion,
        come with it. Means over 2 x 2 elements if not given.
    quick : bool
        Polish the best seeds at once, without climbs below few elements. On 12 elements across, whose own error is
        larger, the peaks err as much as after climbs.
    near : Peak, optional
        Peaks at hand, for graded fields. The search climbs from their places, and from the boundary of the adhesion
        area around which the field is dense; it looks nowhere else.

    Returns
    -------
    Peak
        Stresses per unit p_max and places [mm], arrays (n, 2).

    Notes
    -----
    Valid for any ellipticity and 0 <= nu <= 0.5. The estimated error contains the change from the quadrature of the
    climb to that of the summit, the last gain of the climb, and with `fields` the change on elements of twice the size.
    """
    patches = np.ascontiguousarray(patches)
    out = Peak.empty(len(patches))
    finer, units = refinement(patches), lengths(patches)
    places = np.zeros((len(patches), 2, 3)) if near is None else np.stack([near.x, near.y, near.z], 2) / units[:, None]
    for factor in np.unique(finer):
        group = np.flatnonzero(finer == factor)
        chosen = fields_of(fields, group)
        other = _merged(chosen) if coarse is None else coarse[group]
        slender, adhesion = bool(factor > 1), coarse is not None
        some = Patches(
            patches[group],
            chosen,
            _rough(chosen) if near is None else chosen,
            np.ascontiguousarray(other, dtype=FIELD),
            np.ascontiguousarray(poisson_ratio[group], dtype=float),
            units[group],
            np.ascontiguousarray(scan_points(patches[group], slender, adhesion)),
            places[group],
        )
        # tractions on grids need no finer rules: at the same order, stresses err as little as in round patches
        rules = Rules.of(settings, int(factor) if fields is None else 1, quick)
        effort = Effort(
            settings.seeds + 5 * slender,
            settings.finalists + 2 * slender,
            APART[slender],
            settings.step / factor,
            slender,
            fields is not None,
            adhesion,
            quick,
            near is not None,
        )
        out.put(group, _found(some, rules, effort))
    out.error[:] += _hidden_error(patches, settings, out.stress, fields is None)
    for place, length in zip((out.x, out.y, out.z), units.T, strict=True):
        place *= length[:, None]
    return out


def _found(patches: Patches, rules: Rules, effort: Effort) -> Peak:
    """Return the peaks of patches with the same rules, in normalised coordinates."""
    peaks = np.zeros((len(patches.rows), 2, 6))

    def work(first: int, last: int) -> None:
        _search_rows(first, last, patches, rules, effort, Room.empty(), peaks)

    share_rows(work, len(peaks), 2, 64)
    return Peak(*np.moveaxis(peaks, 2, 0))


def _hidden_error(patches: np.ndarray, settings: PeakSettings, stress: np.ndarray, slides: bool) -> np.ndarray:
    """Return the part of the relative error (n, 2) that the changes between the steps do not show."""
    a, b, friction = patches["a"], patches["b"], patches["friction"]
    slenderness = np.maximum(a, b) / np.minimum(a, b)
    # a ridge that the search misses shows nowhere; this error was measured to grow with friction and slenderness
    error = np.repeat((settings.floor * (1.0 + 10.0 * friction**2 * np.sqrt(slenderness)))[:, None], 2, axis=1)
    if slides:  # chance decides whether the search meets the spike of a logarithm, and how far it follows the spike
        error += 4.0 * spike(patches)[:, None] / stress
    # very slender patches under friction hide ridges from a rough search: 5 % were measured at `standard`
    hidden = (slenderness > 50.0) & (friction > 0)
    return error + np.where(hidden, 160.0 * settings.floor, 0.0)[:, None]
