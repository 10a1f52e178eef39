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

from trackroller.halfspace.ellipse import FIELD, fields_of, refinement, unit_rule
from trackroller.halfspace.peak_climb import PROPORTIONS, Climbs, Patches, lengths
from trackroller.halfspace.peak_seeds import along_turn, best_seeds, ridge_points, scan_points, spike
from trackroller.halfspace.peak_settings import PeakSettings
from trackroller.numerics.rows import Rows

APART = (0.5, 0.2)  # distance of seeds in ordinary and in slender patches
ROUGH = 48  # most elements along an axis for the first climbs, which search below merged elements
RIDGE_WORTH, LITTLE_FRICTION = 0.75, 0.15  # stress at the surface over the largest, and friction, that ridges need
GAPS = (0.045, 0.017, 0.008)  # relative distance to the highest, per finalist, below which a climb is given up


class Rules(NamedTuple):
    """Quadrature rules of the steps of a search; `waves` is that of the plane waves in the polish."""

    scan: np.ndarray
    climb: np.ndarray
    polish: np.ndarray
    summit: np.ndarray
    waves: np.ndarray


@dataclass(frozen=True)
class Peak(Rows):
    """Peak von Mises stress and its place; arrays (n, 2), second axis roller and guide.

    `stress` per unit p_max (in MPa below solved patches), `x`, `y`, `z` [mm], `error` the estimated relative error.
    """

    stress: np.ndarray
    x: np.ndarray
    y: np.ndarray
    z: np.ndarray
    error: np.ndarray

    @classmethod
    def empty(cls, n: int) -> Peak:
        """Return n peaks that are NaN."""
        return cls(*(np.full((n, 2), np.nan) for _ in dataclasses.fields(cls)))

    def put(self, rows, peak: Peak) -> None:
        """Overwrite the rows by other peaks."""
        for field in dataclasses.fields(self):
            getattr(self, field.name)[rows] = getattr(peak, field.name)


def _search(patches: Patches, rules: Rules, settings: PeakSettings, smallest: float) -> Peak:
    """Return the peaks of both bodies of each patch, in normalised coordinates."""
    n, slender = len(patches.rows), patches.slender
    climbs = _seeded(patches, rules, settings)
    # Tractions on a grid are less smooth than sliding ones, so that a finer rule gains little in the first sweep.
    # the scan is rough: climbs that fall behind with better quadrature are given up, and sooner with every sweep
    finalists = settings.finalists + 2 * slender
    most = max(finalists, 2)
    for k, gap in enumerate(GAPS):
        if k == 1:
            climbs.step[:] = 0.08 * PROPORTIONS
        rows = climbs.standing(max(1.0 - gap * most, 1e-9), 0.15 if k > 0 else 0.0, most)
        rule = rules.scan if k == 0 and patches.gridded else rules.climb
        climbs.sweep(rows, rule, rule, 0.06, k > 1)
    climbs.patches = patches
    rows = climbs.standing(0.97, 0.1, finalists)
    climbs.f[rows] = climbs.values(rows, climbs.u[rows], rules.waves, rules.polish)
    climbs.step[:] = max(3.0 * smallest, 0.01) * PROPORTIONS
    for k in range(12 + 12 * slender):
        if rows.size > 0:
            rows = climbs.sweep(rows, rules.waves, rules.polish, smallest, k > 0)
    count = len(climbs.f) // (2 * n)
    best = np.arange(2 * n) * count + climbs.f.reshape(2 * n, count).argmax(axis=1)
    summit = climbs.values(best, climbs.u[best], rules.summit, rules.summit)
    error = 4.0 * (np.abs(summit - climbs.f[best]) + climbs.gained[best]) / summit
    return Peak(*(v.reshape(n, 2) for v in (summit, *climbs.u[best].T, error)))


def _seeded(fine: Patches, rules: Rules, settings: PeakSettings) -> Climbs:
    """Scan the patches and return climbs from the highest places, below few elements at first."""
    patches = dataclasses.replace(fine, fields=_rough(fine.fields))
    n, count = len(patches.rows), settings.seeds + 5 * patches.slender
    points = scan_points(patches.rows, patches.slender, patches.adhesion)
    values = patches.scan(points, rules.scan)
    if patches.adhesion:
        points, values = _with_ridges(fine, points, values, rules.scan)
    apart = APART[patches.slender]
    chosen = np.stack([best_seeds(points, values[:, :, body], count, apart) for body in (0, 1)], axis=1).ravel()
    of, body, _ = (index.ravel() for index in np.indices((n, 2, count)))
    m, u = of.size, points[of, chosen]
    steps, along = 0.12 * PROPORTIONS * np.ones((m, 3)), along_turn(patches.rows[of], u)
    climbs = Climbs(patches, of, body, u, np.full(m, -1.0), np.zeros(m), steps, along)
    rows = np.flatnonzero(chosen >= 0)
    if patches.gridded:  # the first sweep takes the rule of the scan, see `_search`
        climbs.f[rows] = values[of, chosen, body][rows]
    else:
        climbs.f[rows] = climbs.values(rows, u[rows], rules.climb, rules.climb)
    return climbs


def _with_ridges(patches: Patches, points: np.ndarray, values: np.ndarray, rule: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return scan points (n, m, 3) and their stresses (n, m, 2) with points where sliding begins.

    These are scanned in patches with a stress at the surface that is not far below the largest.
    """
    surface = np.where(points[..., 2:] == 0.0, values, 0.0).max(axis=1)
    worth = (surface > RIDGE_WORTH * values.max(axis=1)).any(axis=1) & (patches.rows["friction"] > LITTLE_FRICTION)
    line = ridge_points(patches.fields[worth])
    more = np.full((len(points), *line.shape[1:]), np.nan)
    more[worth] = line
    at_ridges = patches.scan(more, rule)
    return np.concatenate([points, np.nan_to_num(more)], axis=1), np.concatenate([values, at_ridges], axis=1)


def _rough(fields: np.ndarray) -> np.ndarray:
    """Return fields with at most ROUGH elements along each axis for the first climbs: these stay in the fast caches."""
    while min(fields.shape[-2:]) > 4 * ROUGH:  # neighbours of so fine a grid hardly differ
        fields = fields[..., ::2, ::2]
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


def _change_by_elements(patches: Patches, peak: Peak, rule: np.ndarray, fields: np.ndarray) -> np.ndarray:
    """Return the relative change of the peaks (n, 2) with the tractions `fields` of a coarser grid."""
    n = len(patches.rows)
    coarse = dataclasses.replace(patches, fields=np.ascontiguousarray(fields, dtype=FIELD))
    of, body = (index.ravel() for index in np.indices((n, 2)))
    places = np.stack([peak.x, peak.y, peak.z], axis=2).reshape(2 * n, 3)
    return np.abs(coarse.stress(of, body, places, rule, rule).reshape(n, 2) / peak.stress - 1.0)


def find_peaks(
    patches: np.ndarray,
    poisson_ratio: np.ndarray,
    settings: PeakSettings,
    fields: np.ndarray | None = None,
    coarse: np.ndarray | None = None,
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
    finer = refinement(patches)
    for factor in np.unique(finer):
        group = np.flatnonzero(finer == factor)
        orders = (settings.scan, settings.climb, settings.polish, settings.summit, max(settings.polish, 12))
        rules = Rules(*(unit_rule(int(order * factor)) for order in orders))
        chosen = fields_of(fields, group)
        ratios = np.ascontiguousarray(poisson_ratio[group], dtype=float)
        some = Patches(patches[group], chosen, ratios, bool(factor > 1), coarse is not None)
        peak = _search(some, rules, settings, settings.step / factor)
        if fields is not None:
            other = _merged(chosen) if coarse is None else coarse[group]
            peak.error[:] += _change_by_elements(some, peak, rules.summit, other)
        out.put(group, peak)
    out.error[:] += _hidden_error(patches, settings, out.stress, fields is None)
    for place, length in zip((out.x, out.y, out.z), lengths(patches).T, strict=True):
        place *= length[:, None]
    return out


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
