"""Examine the points of a cross-section: their order, points off the curve, and scatter that would
count as shape.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np

# factor on the noise found in points: too little smoothing does more harm than too much
SAFETY = 1.05

# A cubic spline through points that scatter by s at distances h raises the largest pressure of a
# steel circle by about 200 s/h: 2 % from TOLD on, 5 to 30 % from MISLEADING on (guide 6 mm, groove
# -7 mm, h from 0.01 to 0.2 mm).
TOLD, MISLEADING = 2e-4, 1e-3

# White noise of the deviation s at distances h, smoothed, changes the largest pressure of steel
# bodies by about 10 % (s^2 h / LOUD)^0.2: 3 to 6 % at 1e-9 mm3, 17 to 43 % at 5e-6 (guide 6 mm,
# groove -7 mm, s from 0.1 to 5 um, h from 0.01 to 0.2 mm). Waves whose curvature changes by WAVY of
# the median one change the pressure by 6 % and more.
LOUD = 5e-8  # mm3
# of the median curvature; 1/mm, smallest change of the curvature that counts
WAVY, FLAT = 0.3, 5e-3
MOST_TURNS = 5  # of the curvature of a drawn section
# step over the median step, and over twice each step beside it, from which on it is a gap
GAP = 8.0

SAME = 1e-9  # mm; heights of one point that was written twice differ by no more
LONGEST_RUN = 5  # points off the curve in a row that are found
STEEP = 2.75  # tangent of 70 degrees; an instrument does not follow such a wall
LONGEST_MARK = 12  # points of the height 0 in a row that are lost ones
LARGE = 2.5  # smallest step to lost points of the height 0 over the three steps beside it
FEWEST = 9  # points from which on points off the curve are sought
# points from which on a speck is sought at an end; its largest height [mm]
FEWEST_AT_END, HIGHEST_AT_END = 30, 0.05
FARTHEST = 1e7  # mm; a longer length is a mark of lost points

# Degree and number of points of the polynomials beside a run; few points see details, many points
# average noise.
_FITS = ((1, 3), (2, 4), (3, 5), (4, 6), (2, 7), (3, 9), (5, 9))
# smallest distance from both curves beside a run, in standard deviations of their prediction
_CERTAIN = 4.0
_NOISE = 6.0  # smallest distance of a run in standard deviations of the noise
# largest distance of the two curves beside a run from each other, over that of the run
_AGREE = 0.5
_ALIKE = 0.3  # largest range of the distances of a step, over the smallest of them
# share of differences of opposite sign in a row; 0.5 without relation, 0.8 for noise, 0 for a curve
_RANDOM = 0.6
_UNEVEN = 2e-3  # smallest step over half the width of a window whose polynomial is trusted
_TINY = 1e-12  # mm; smallest standard deviation of a prediction
_COARSEST = 0.2  # mm; largest step to which heights are rounded


class Run(NamedTuple):
    """Points first to last (indices) that lie off the curve through their neighbours by `off`
    [mm].
    """

    first: int
    last: int
    off: float


class PointFaults(NamedTuple):
    """What is wrong with points in increasing order of x.

    Attributes
    ----------
    runs : tuple of Run
        Points off the curve.
    jumps : tuple of int
        Points behind which the height jumps, or behind which x has a gap wider than all other
        points.
    scatter : float
        Standard deviation of random scatter and of rounding [mm]; 0 where neighbours follow one
        curve.
    spacing : float
        Median distance of neighbours [mm].
    at_ends : tuple of Run
        Outermost points that may be off the curve, or shape: no points beyond them confirm the
        curve.
    """

    runs: tuple[Run, ...]
    jumps: tuple[int, ...]
    scatter: float
    spacing: float
    at_ends: tuple[Run, ...] = ()

    @property
    def roughness(self) -> float:
        """Return the scatter over the distance of the points, which decides how far the pressure is
        wrong.
        """
        return self.scatter / self.spacing

    @property
    def error_if_smoothed(self) -> float:
        """Return about how far the largest pressure of steel bodies is wrong if the scatter is
        smoothed, as a share.
        """
        return float(0.1 * (self.scatter**2 * self.spacing / LOUD) ** 0.2)

    @property
    def pressure_rise(self) -> str:
        """Return about how far the scatter can raise the largest pressure of steel bodies, in
        words.
        """
        rise = 200.0 * self.roughness
        return f"{float(f'{100 * rise:.1g}'):g} %" if rise < 1.0 else "a multiple"


class Waves(NamedTuple):
    """Waves on a section: number of turns of its curvature, length of a wave [mm], half its height
    [mm].
    """

    turns: int
    length: float
    height: float


def waves(x: np.ndarray, z: np.ndarray, scatter: float) -> Waves | None:
    """Return the waves on a section whose curvature goes to and fro, None if there are none.

    The curvature is that of circles through three points. Arcs and lines have no waves, however
    their points lie.

    Parameters
    ----------
    x, z : numpy.ndarray, shape (n,)
        Points, x strictly increasing [mm].
    scatter : float
        Standard deviation of the scatter of z [mm]; the circles are so wide that it does not count.
    """
    usual = float(np.median(np.abs(_curvatures(x, z, max(1, x.size // 20)))))
    least = max(WAVY * usual, FLAT)
    wide = np.sqrt(2.5 * scatter / (0.1 * least))
    apart = max(1, int(np.ceil(wide / float(np.median(np.diff(x))))))
    if x.size < 4 * apart + FEWEST:
        return None
    changes = _changes(_curvatures(x, z, apart), least)
    if len(changes) <= MOST_TURNS:
        return None
    length = 2.0 * float(x[-1] - x[0]) / len(changes)
    return Waves(
        len(changes), length, 0.5 * float(np.median(changes)) * (length / (2.0 * np.pi)) ** 2
    )


def _curvatures(x: np.ndarray, z: np.ndarray, apart: int) -> np.ndarray:
    """Return the curvatures of the circles through points k, k + apart and k + 2 apart [1/mm], > 0
    hollow.
    """
    x0, x1, x2 = x[: -2 * apart], x[apart:-apart], x[2 * apart :]
    z0, z1, z2 = z[: -2 * apart], z[apart:-apart], z[2 * apart :]
    area = (x1 - x0) * (z2 - z0) - (x2 - x0) * (z1 - z0)
    sides = np.hypot(x1 - x0, z1 - z0) * np.hypot(x2 - x1, z2 - z1) * np.hypot(x2 - x0, z2 - z0)
    return np.asarray(2.0 * area / sides)


def _changes(values: np.ndarray, least: float) -> list[float]:
    """Return the heights between neighbouring extremes of a course; a turn back by less than
    `least` is no extreme.
    """
    changes: list[float] = []
    last_extreme = float(values[0])
    extreme = last_extreme
    direction = 0.0  # 1 while the course rises, -1 while it falls, 0 before it has moved by `least`
    for value in values.tolist():
        if direction * (value - extreme) > 0.0:
            extreme = value
        elif abs(value - extreme) >= least:
            if direction != 0.0:
                changes.append(abs(extreme - last_extreme))
            last_extreme = extreme
            direction = float(np.sign(value - extreme))
            extreme = value
    return changes


def gap(x: np.ndarray) -> int | None:
    """Return the point behind which no points lie over a length that all others cover densely, None
    for none.
    """
    steps = np.diff(x)
    if steps.size < FEWEST:
        return None
    beside = np.maximum(steps[:-2], steps[2:])
    wide = (steps[1:-1] > GAP * float(np.median(steps))) & (steps[1:-1] > 0.5 * GAP * beside)
    places = np.flatnonzero(wide) + 1
    return int(places[np.argmax(steps[places])]) if places.size else None


def in_order(points: np.ndarray) -> np.ndarray:
    """Return the indices (m,) that sort points (n, 2) by x and leave out points that stand
    twice.
    """
    order = np.lexsort((points[:, 1], points[:, 0]))
    ordered = points[order]
    steps = np.abs(np.diff(ordered, axis=0))
    again = (steps[:, 0] == 0.0) & (steps[:, 1] <= SAME)
    return order[np.concatenate([[True], ~again])]


def examined(x: np.ndarray, z: np.ndarray) -> PointFaults:
    """Return what is wrong with points.

    Parameters
    ----------
    x, z : numpy.ndarray, shape (n,)
        At least 5 points, x strictly increasing [mm].

    Notes
    -----
    A run of points lies off the curve if polynomials through the points before and behind it
    predict each other but not the run. A kink, a chamfer or a rounding does not pass this test:
    there the two sides do not predict each other.
    """
    return _examined(
        np.ascontiguousarray(x, dtype=float).tobytes(),
        np.ascontiguousarray(z, dtype=float).tobytes(),
    )


@lru_cache(maxsize=64)  # a case is checked, asked about and solved with the same points
def _examined(x_bytes: bytes, z_bytes: bytes) -> PointFaults:
    """Examine points whose coordinates are given as bytes, by which the results are kept; see
    `examined`.
    """
    x, z = np.frombuffer(x_bytes), np.frombuffer(z_bytes)
    spacing = float(np.median(np.diff(x)))
    if x.size < FEWEST:
        return PointFaults((), (), 0.0, spacing)
    grain = rounding_of(x, z)
    noise = max(_deviation(_differences(x, z, 4)), grain)
    fits = [_Fits(x, z, degree, count) for degree, count in _FITS if x.size >= 2 * count]
    runs = _runs(x, z, noise, fits)
    runs += tuple(
        mark
        for mark in _marks(x, z)
        if all(mark.last < run.first or mark.first > run.last for run in runs)
    )
    inside = {place for run in runs for place in range(run.first - 1, run.last + 1)}
    jumps = {
        *_jumps(x, z, noise),
        *(place for place in _steps(x, z, noise, fits) if place not in inside),
    }
    scatter = max(_random_scatter(x, z), grain)
    return PointFaults(
        tuple(sorted(runs)), tuple(sorted(jumps)), scatter, spacing, _runs_at_ends(x, z, noise)
    )


def noise_of(u: np.ndarray, height: np.ndarray) -> float:
    """Return the standard deviation of the noise of heights [mm], of their rounding at least.

    It comes from divided differences of five neighbours. These differences vanish for cubics and
    nearly vanish for arcs and parabolas. Kinks and steps give few large values, which the median
    leaves out. Noise that neighbours share is not detected.

    Parameters
    ----------
    u, height : numpy.ndarray, shape (n,)
        Points [mm].
    """
    return max(SAFETY * _deviation(_differences(u, height, 4)), rounding_of(u, height))


def rounding_of(x: np.ndarray, z: np.ndarray) -> float:
    """Return the standard deviation of heights that were rounded [mm], or 0 if the rounding is not
    seen.

    All differences of rounded heights are multiples of one step. Heights that a designer chose on a
    grid are so as well, but rounded ones also bend to and fro by about one step from point to
    point.

    Parameters
    ----------
    x, z : numpy.ndarray, shape (n,)
        Points, x increasing [mm].
    """
    across = _rounding_across(x, z)
    levels = np.diff(np.unique(z))
    levels = levels[levels > 1e-11 * float(np.abs(z).max())]
    if x.size < FEWEST or not levels.size or levels.min() > _COARSEST:
        return across
    widths = np.diff(x)
    bends = np.diff(np.diff(z) / widths) * np.minimum(widths[1:], widths[:-1])
    for part in (1, 2, 3):
        step = float(levels.min()) / part
        multiples = levels / step
        if np.abs(multiples - np.round(multiples)).max() < 0.02:
            small = (np.abs(bends) > 0.1 * step) & (np.abs(bends) < 2.5 * step)
            fro = small[1:] & small[:-1] & (bends[1:] * bends[:-1] < 0.0)
            return max(across, step / np.sqrt(12.0) if np.count_nonzero(fro) >= 3 else 0.0)
    return across


def _rounding_across(x: np.ndarray, z: np.ndarray) -> float:
    """Return the standard deviation of heights whose x were rounded [mm], or 0 if the rounding is
    not seen.

    Even steps become steps of two widths, while the heights rise evenly.
    """
    widths = np.diff(x)
    step = float(np.ptp(widths))
    multiples = widths / step if step > 1e-9 * widths.max() else np.full(1, 0.5)
    if np.abs(multiples - np.round(multiples)).max() > 0.02:
        return 0.0
    rare = np.round(multiples) != np.round(np.median(multiples))
    inner = np.flatnonzero(rare[1:-1] & ~rare[:-2] & ~rare[2:]) + 1
    slopes = np.diff(z) / widths
    beside = 0.5 * (slopes[inner - 1] + slopes[inner + 1])
    expected = beside * (widths[inner - 1] / widths[inner] - 1.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        alike = np.abs((slopes[inner] - beside) / expected - 1.0) < 0.5
    seen = np.count_nonzero(alike) >= max(2.0, 0.7 * inner.size)
    return step / np.sqrt(12.0) * float(np.median(np.abs(slopes))) if seen else 0.0


def _differences(x: np.ndarray, z: np.ndarray, order: int) -> np.ndarray:
    """Return divided differences whose standard deviation is that of the noise of z, (n -
    order,).
    """
    count = x.size - order
    near = np.stack([x[k : k + count] for k in range(order + 1)])
    near = near / (near[-1] - near[0])
    apart = near[:, None] - near[None] + np.eye(order + 1)[:, :, None]
    weights = 1.0 / apart.prod(axis=1)
    weights /= np.sqrt((weights**2).sum(axis=0))
    return np.sum([weights[k] * z[k : k + count] for k in range(order + 1)], axis=0)


def _deviation(differences: np.ndarray) -> float:
    """Return the standard deviation of differences (n,), from which few large ones are left out."""
    sizes = np.abs(differences)
    deviation = 1.4826 * float(np.median(sizes))
    for _ in range(3):
        kept = sizes[sizes <= 3.0 * deviation]
        deviation = float(np.sqrt(np.mean(kept**2))) / 0.9866 if kept.size else deviation
    return deviation


def _random_scatter(x: np.ndarray, z: np.ndarray) -> float:
    """Return the standard deviation of the scatter of z [mm], 0 if its differences do not change
    their sign at random.

    Differences of higher order vanish for more curves, but few points leave few of them; the
    smallest deviation counts.
    """
    found = []
    for order in (4, 6, 8):
        if x.size >= order + FEWEST:
            differences = _differences(x, z, order)
            found.append((_deviation(differences), _is_random(differences)))
    deviation, is_random = min(found, default=(0.0, False))
    return deviation if is_random else 0.0


def _is_random(differences: np.ndarray) -> bool:
    """Return whether the signs of neighbouring differences change as often as those of random
    scatter, or oftener.

    Few differences change their signs often by chance: 0.6 over the root of their number is 1.2
    standard deviations of the share of changes of independent signs.
    """
    signs = np.sign(differences)
    both = (signs[1:] != 0) & (signs[:-1] != 0)
    if np.count_nonzero(both) < FEWEST - 5:
        return False
    changes = float(np.mean(signs[1:][both] != signs[:-1][both]))
    return changes >= max(_RANDOM, 0.5 + 0.6 / np.sqrt(differences.size - 1))


def _marks(x: np.ndarray, z: np.ndarray) -> list[Run]:
    """Return runs of the height 0 between two steps that are larger than the steps beside them, as
    lost points have.
    """
    steps = np.abs(np.diff(z))
    zero = np.concatenate([[False], z == 0.0, [False]])
    starts, ends = np.flatnonzero(zero[1:] & ~zero[:-1]), np.flatnonzero(zero[:-1] & ~zero[1:]) - 1
    found = []
    for first, last in zip(starts.tolist(), ends.tolist(), strict=True):
        before, behind = steps[max(first - 4, 0) : max(first - 1, 0)], steps[last + 1 : last + 4]
        if last - first < LONGEST_MARK and before.size and behind.size:
            large = steps[first - 1] > LARGE * before.max() and steps[last] > LARGE * behind.max()
            ends_of = [first - 1, last + 1]
            off = float(np.abs(np.interp(x[first : last + 1], x[ends_of], z[ends_of])).min())
            found += [Run(first, last, off)] if large and z[first - 1] * z[last + 1] > 0.0 else []
    return found


def _jumps(x: np.ndarray, z: np.ndarray, noise: float) -> tuple[int, ...]:
    """Return the points behind which a single step is a wall, or behind which lies a gap in x at
    one end.
    """
    steps, rises = np.diff(x), np.diff(z)
    slopes = rises / steps
    steep = (np.abs(slopes) > STEEP) & (np.abs(rises) > 2.0 * _NOISE * noise)
    with np.errstate(divide="ignore", invalid="ignore"):
        before = np.concatenate([[-np.inf], slopes[:-1] / slopes[1:]])
        behind = np.concatenate([slopes[1:] / slopes[:-1], [-np.inf]])
    # the last slope of a half circle is 2.4 times the one before it
    single = steep & (np.fmax(before, behind) < 0.25)
    place = np.arange(steps.size)
    others = np.maximum(x[-1] - x[1:], x[:-1] - x[0])  # width of the longer part beside each step
    at_end = np.minimum(place + 1, steps.size - place) <= LONGEST_RUN
    return tuple(np.flatnonzero(single | (at_end & (steps > others))).tolist())


class _Fits:
    """Polynomials through each window of `count` neighbours, and how far their predictions can be
    trusted.
    """

    def __init__(self, x: np.ndarray, z: np.ndarray, degree: int, count: int) -> None:
        self.count = count
        window = np.arange(x.size - count + 1)[:, None] + np.arange(count)
        near, heights = x[window], z[window]
        self.middle, self.base = near.mean(axis=1), heights.mean(axis=1)
        self.half = 0.5 * (near[:, -1] - near[:, 0])
        self.powers = np.arange(degree + 1)
        places = (near - self.middle[:, None]) / self.half[:, None]
        uneven = np.diff(places, axis=1).min(axis=1) < _UNEVEN
        places[uneven] = np.linspace(-1.0, 1.0, count)
        matrix = places[:, :, None] ** self.powers
        turned = matrix.transpose(0, 2, 1)
        self.inverse = np.linalg.inv(turned @ matrix)
        offsets = heights - self.base[:, None]
        self.factors = (self.inverse @ (turned @ offsets[:, :, None]))[:, :, 0]
        left = offsets - (matrix @ self.factors[:, :, None])[:, :, 0]
        self.deviation = np.sqrt((left**2).sum(axis=1) / (count - degree - 1))
        self.deviation[uneven] = np.inf

    def height(self, windows: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Return the predicted heights at x [mm], (m,)."""
        return self.base[windows] + (self._row(windows, x) * self.factors[windows]).sum(axis=1)

    def error(self, windows: np.ndarray, x: np.ndarray, noise: float) -> np.ndarray:
        """Return the standard deviations of the heights that are predicted at x [mm], (m,)."""
        row = self._row(windows, x)
        spread = (np.matmul(self.inverse[windows], row[:, :, None])[:, :, 0] * row).sum(axis=1)
        return np.maximum(np.maximum(self.deviation[windows], noise) * np.sqrt(1.0 + spread), _TINY)

    def _row(self, windows: np.ndarray, x: np.ndarray) -> np.ndarray:
        return np.asarray(((x - self.middle[windows]) / self.half[windows])[:, None] ** self.powers)


def _runs(x: np.ndarray, z: np.ndarray, noise: float, polynomials: list[_Fits]) -> tuple[Run, ...]:
    """Return the runs of points off the curve; of runs that overlap, the one that is most
    certain.
    """
    found: list[tuple[float, Run]] = []
    for fits in polynomials:
        count = fits.count
        for length in range(1, min(LONGEST_RUN, x.size - 2 * count) + 1):
            first = np.arange(count, x.size - count - length + 1)
            last = first + length - 1
            before, behind = first - count, last + 1  # windows
            from_left = np.abs(z[first] - fits.height(before, x[first]))
            from_right = np.abs(z[last] - fits.height(behind, x[last]))
            off = np.minimum(from_left, from_right)
            spacing = (x[last + 1] - x[first - 1]) / (length + 1)
            large = np.flatnonzero(off > np.maximum(_NOISE * noise, MISLEADING * spacing))
            first, last, before, behind, off = (
                values[large] for values in (first, last, before, behind, off)
            )
            from_left = from_left[large] / fits.error(before, x[first], noise)
            from_right = from_right[large] / fits.error(behind, x[last], noise)
            certainty = np.minimum(from_left, from_right)
            apart = [
                np.abs(z[at] - fits.height(windows, x[at]))
                for windows, at in ((before, last + 1), (behind, first - 1))
            ]
            for k in np.flatnonzero((certainty > _CERTAIN) & (np.maximum(*apart) < _AGREE * off)):
                found.append((float(certainty[k]), Run(int(first[k]), int(last[k]), float(off[k]))))
    kept: list[Run] = []
    for _, run in sorted(found, reverse=True):
        if all(run.last < other.first or run.first > other.last for other in kept):
            kept.append(run)
    return tuple(sorted(kept))


def _runs_at_ends(x: np.ndarray, z: np.ndarray, noise: float) -> tuple[Run, ...]:
    """Return the runs of 2 to `LONGEST_RUN` outermost points that leave the curve and turn back to
    its direction.

    Nothing beyond the end confirms the curve there. A chamfer, a rounding or another curvature
    leaves the curve ever faster, so that only points whose distance from the curve grows more
    slowly again are taken for a speck.
    """
    if x.size < FEWEST_AT_END:
        return ()
    last = x.size - 1
    found = [(_run_at_end(x, z, noise), False), (_run_at_end(-x[::-1], z[::-1], noise), True)]
    return tuple(
        Run(0, last - run.first, run.off) if is_first else run
        for run, is_first in found
        if run is not None
    )


def _run_at_end(x: np.ndarray, z: np.ndarray, noise: float) -> Run | None:
    """Return the run of the last points that is a speck, see `_runs_at_ends`."""
    for length in range(LONGEST_RUN, 1, -1):
        first, sizes = x.size - length, []
        widths = np.diff(x[first - 1 :])
        least = max(_NOISE * noise, MISLEADING * float(np.median(widths)))
        for degree, count in _FITS:
            near = slice(first - count, first)
            fits, windows = _Fits(x[near], z[near], degree, count), np.zeros(length, dtype=int)
            off = z[first:] - fits.height(windows, x[first:])
            off *= np.sign(off[np.abs(off).argmax()])
            error = fits.error(windows, x[first:], noise)
            slopes = np.diff(off, prepend=0.0) / widths
            back = (slopes[:-1] - slopes[1:]) * np.minimum(widths[1:], widths[:-1])
            turn = int(back.argmax())
            is_off = least < off.max() < HIGHEST_AT_END and np.all(off > _CERTAIN * error)
            if is_off and back[turn] > max(least, _CERTAIN * error[turn + 1]):
                sizes.append(float(off.max()))
        sizes.sort()
        # a single polynomial may miss by chance
        if any(larger - size < _ALIKE * size for size, larger in pairwise(sizes)):
            return Run(first, x.size - 1, float(np.median(sizes)))
    return None


def _steps(x: np.ndarray, z: np.ndarray, noise: float, polynomials: list[_Fits]) -> tuple[int, ...]:
    """Return the points behind which the curve goes on at another height: both sides miss each
    other by one distance.

    Where slope or curvature change, the distance grows from the first to the second point of the
    other side.
    """
    found: dict[int, list[float]] = {}
    for fits in polynomials:
        count = fits.count
        last = np.arange(count - 1, x.size - count)
        before, behind = last - count + 1, last + 1  # windows
        ahead, further = (z[last + k] - fits.height(before, x[last + k]) for k in (1, 2))
        back, earlier = (fits.height(behind, x[last - k]) - z[last - k] for k in (0, 1))
        misses = np.stack([ahead, further, back, earlier])
        height = np.abs(misses).min(axis=0)
        error = np.maximum(
            fits.error(before, x[last + 2], noise), fits.error(behind, x[last - 1], noise)
        )
        least = np.maximum(_NOISE * noise, MISLEADING * (x[last + 1] - x[last]))
        alike = (np.ptp(misses, axis=0) < _ALIKE * height) & (
            np.abs(misses.sum(axis=0)) > 3.0 * height
        )
        for k in np.flatnonzero(alike & (height > least) & (height > _CERTAIN * error)):
            found.setdefault(int(last[k]), []).append(float(misses[:, k].mean()))
    # a single polynomial may miss by chance
    return tuple(
        k
        for k, by in found.items()
        if len(by) > 1 and max(by) - min(by) < _ALIKE * min(map(abs, by))
    )
