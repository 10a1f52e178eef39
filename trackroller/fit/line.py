"""Likelihood of a Basquin line with log-normal scatter, its estimate, and profile intervals.

A specimen under the stress S lives N cycles, with a standard normal number z::

    ln N = level - slope (ln S - ln S_0) + scatter z

S_0 is the geometric mean of the tested stresses. With a knee, a specimen fails only if S exceeds
its own fatigue limit, whose logarithm is normal, too: the limit scatters from specimen to specimen
(a random knee). A test that ended without a failure is a suspension; a failure that was found at an
inspection lies in an interval.

The interval of a value holds each number whose profile likelihood lies within t^2(n - p)/2 of the
maximum: n counts the specimens, p the fitted values, and t is Student's quantile. On small samples
this cut-off covers what it states, and that of chi^2 does not. Where n - p is 1 or 2, the smaller
n/2 ln(1 + t^2/(n - p)) is taken, which is exact for the mean of complete data.

ASSUME: specimens are independent of each other, and the scatter of ln N is the same at all
stresses.

References
----------
Meeker, W. Q., Escobar, L. A. (1998). Statistical Methods for Reliability Data. Wiley. Pascual, F.
G., Meeker, W. Q. (1999). Estimating fatigue curves with the random fatigue-limit model.
Technometrics 41.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.special import log_ndtr, ndtr, ndtri, stdtrit

# bounds of the values; an estimate at a bound says that the tests do not identify the value
BOUNDS = {
    "level": (-200.0, 200.0),
    "slope": (1.0, 60.0),
    "log_scatter": (math.log(0.01), math.log(6.0)),
    "log_limit": (0.0, 20.0),
    "log_limit_scatter": (math.log(0.003), math.log(0.7)),
}
NAMES = tuple(BOUNDS)
AT_BOUND = 1e-3  # share of the range of a value within which an estimate counts as lying at its end
FARTHEST = 60.0  # in ln N, how far an end of an interval is sought
LEAST = 1e-300  # keeps a quotient finite
LARGE = 1e10  # -ln L of values that the tests exclude
STEP = 1e-4  # of central differences of ln L
TOLERANCE = 1e-9  # fall of ln L by a step below which a maximum counts as found
MOST_STEPS = 60
AT_ONCE = 2_000_000  # elements of an array of points and tests, which bounds the memory
Solved = Callable[[float, np.ndarray], np.ndarray]
Profile = Callable[[float, np.ndarray], tuple[float, np.ndarray]]
NEAR = 0.02  # in ln S, how far below a stress a fatigue limit is tried first
SAME_MAXIMUM = 1e-6  # difference of ln L within which two maxima count as one
# at which the likelihood is looked at for starts
MOST_LIMITS = 40
LIMIT_SCATTERS = (0.01, 0.04, 0.15, 0.5)
MOST_STARTS = 6  # limits from which Newton's method starts
MOST_FURTHER = 2  # starts for a value of a profile that is less likely than an interval allows
# of ln N, at which finite lives are tried below a fatigue limit
STEPS = np.arange(-2.0, 6.1, 0.5).tolist()


class Values(NamedTuple):
    """Values of a line: ln N at S_0, slope, ln of the scatter of ln N, and median and ln scatter of
    the ln limit.
    """

    level: np.ndarray | float
    slope: np.ndarray | float
    log_scatter: np.ndarray | float
    log_limit: np.ndarray | float
    log_limit_scatter: np.ndarray | float


class Interval(NamedTuple):
    """Ends of an interval; an end that the tests do not bound is infinite, or a bound of the
    value.
    """

    low: float
    high: float


@dataclass(frozen=True)
class Tests:
    """What was tested, in logarithms, arrays of shape (n,).

    Attributes
    ----------
    stress : numpy.ndarray
        ln S [ln MPa].
    low, high : numpy.ndarray
        ln N between which the specimen failed: equal for a life that was observed, `high` inf for a
        suspension, and `low` -inf for a failure before the first inspection.
    """

    stress: np.ndarray
    low: np.ndarray
    high: np.ndarray

    __test__ = False  # pytest takes the name for that of a test

    @property
    def failed(self) -> np.ndarray:
        """Return which specimens failed, (n,) bool."""
        return np.isfinite(self.high)

    @property
    def middle(self) -> np.ndarray:
        """Return ln N of each test: the life, the middle of its interval, or the end of a
        suspension, (n,).
        """
        # an end that came before the first look has no lower bound: half its life stands for it
        low = np.where(np.isfinite(self.low), self.low, self.high - math.log(2.0))
        high = np.where(self.failed, self.high, low)
        return 0.5 * (low + high)


@dataclass(frozen=True)
class Line:
    """A Basquin line with its tests.

    Parameters
    ----------
    tests : Tests
        What was tested.
    slope, scatter : float, optional
        Values that are held, the scatter as the standard deviation of ln N [1]; None fits them.
    knee : bool
        Whether a fatigue limit with its own scatter is fitted as well.
    sloped : bool
        False for lives that do not depend on a stress, such as a travel over the travel that a
        model gives.
    specimens : int, optional
        Number of specimens, if some of them have several tests: a roller with two contacts is one
        specimen.
    """

    tests: Tests
    slope: float | None = None
    scatter: float | None = None
    knee: bool = False
    sloped: bool = True
    specimens: int | None = None

    @cached_property
    def free(self) -> tuple[str, ...]:
        """Return the names of the values that are fitted."""
        constant = set()
        if self.slope is not None or not self.sloped:
            constant.add("slope")
        if self.scatter is not None:
            constant.add("log_scatter")
        if not self.knee:
            constant |= {"log_limit", "log_limit_scatter"}
        return tuple(name for name in NAMES if name not in constant)

    @cached_property
    def bounds(self) -> dict[str, tuple[float, float]]:
        """Return the bounds of each value; a fatigue limit lies within a factor of two of the
        tested stresses.
        """
        own = self.tests.stress
        return BOUNDS | {
            "log_limit": (float(own.min()) - math.log(2.0), float(own.max()) + math.log(2.0))
        }

    @property
    def size(self) -> int:
        """Return the number of specimens."""
        if self.specimens is None:
            return len(self.tests.stress)
        return self.specimens

    @cached_property
    def reference(self) -> float:
        """Return ln S_0: the mean of ln S over the failures, over all tests if none failed."""
        if self.tests.failed.any():
            own = self.tests.stress[self.tests.failed]
        else:
            own = self.tests.stress
        return float(own.mean())

    @cached_property
    def _constants(self) -> np.ndarray:
        """Return the values that are held, NaN for free ones, as `Values` orders them."""
        slope = math.nan
        log_scatter = math.nan
        if not self.sloped:
            slope = 0.0
        elif self.slope is not None:
            slope = self.slope
        if self.scatter is not None:
            log_scatter = math.log(self.scatter)
        return np.array([math.nan, slope, log_scatter, 0.0, 0.0])

    @cached_property
    def _places(self) -> list[int]:
        return [NAMES.index(name) for name in self.free]

    @cached_property
    def limits(self) -> np.ndarray:
        """Return the bounds of the free values, (p, 2)."""
        return np.array([self.bounds[name] for name in self.free])

    def values(self, points: np.ndarray) -> Values:
        """Return the values at points (..., p) of the free ones, each of shape (...)."""
        every = np.broadcast_to(self._constants, (*np.shape(points)[:-1], len(NAMES))).copy()
        every[..., self._places] = points
        return Values(*np.moveaxis(every, -1, 0))

    def log_likelihood(self, points: np.ndarray) -> np.ndarray:
        """Return the logarithm of the likelihood at points of the free values.

        Parameters
        ----------
        points : numpy.ndarray
            Values by `free`, (..., p).

        Returns
        -------
        numpy.ndarray
            ln L, (...).
        """
        points = np.asarray(points, float)
        flat = points.reshape(-1, points.shape[-1])
        rows = max(AT_ONCE // max(len(self.tests.stress), 1), 1)
        parts = [self._of_points(flat[i : i + rows]) for i in range(0, len(flat), rows)]
        return np.concatenate(parts).reshape(points.shape[:-1])

    def _of_points(self, points: np.ndarray) -> np.ndarray:
        """Return ln L at a list of points, (m,)."""
        v = Values(*(np.asarray(value)[:, None] for value in self.values(points)))
        total = np.zeros(len(points))
        scatter = np.exp(v.log_scatter)
        for kind, (x, low, high, times) in self._distinct.items():
            mean = v.level - v.slope * (x - self.reference)
            above = (low - mean) / scatter
            if kind == "observed":
                part = -0.5 * above**2 - v.log_scatter
            else:
                if kind == "suspended":
                    part = log_ndtr(-above)
                else:
                    part = _between(above, (high - mean) / scatter)
            if self.knee:
                excess = (x - v.log_limit) / np.exp(v.log_limit_scatter)
                part = part + log_ndtr(excess)
                if kind == "suspended":
                    part = np.logaddexp(log_ndtr(-excess), part)
            total += part @ times
        return total

    @cached_property
    def _distinct(self) -> dict[str, tuple[np.ndarray, ...]]:
        """Return stress, ends and number of equal tests, by the kind of their end."""
        rows = np.stack([self.tests.stress, self.tests.low, self.tests.high], axis=1)
        different, times = np.unique(rows, axis=0, return_counts=True)
        _, low, high = different.T
        kinds = {
            "observed": low == high,
            "inspected": (low < high) & np.isfinite(high),
            "suspended": np.isposinf(high),
        }
        return {
            kind: (*different[of_kind].T, times[of_kind])
            for kind, of_kind in kinds.items()
            if of_kind.any()
        }

    @cached_property
    def estimate(self) -> np.ndarray:
        """Return the values of the largest likelihood, (p,)."""
        return self.maxima[0]

    @cached_property
    def maxima(self) -> list[np.ndarray]:
        """Return the places (p,) of the maxima of the likelihood that were found, the highest
        first.

        With a fatigue limit the likelihood may have several: one with the limit between two
        stresses and one without a limit, on which run-outs are long lives. Newton's method starts
        from limits on both sides of each stress.
        """

        def loss(points: np.ndarray) -> np.ndarray:
            return -self.log_likelihood(points)

        minima = sorted((least(loss, start, self.limits) for start in self._starts()), key=_value)
        if self.knee and self.tests.failed.any():
            minima += [least(loss, start, self.limits) for start in self._starts_by_limit()]
        lowest = min(map(_value, minima))
        # of places that are equally likely the first one stays, so that further starts change no
        # last digit
        minima.sort(key=lambda one: max(_value(one) - lowest, SAME_MAXIMUM))
        different = minima[:1]
        for one in minima[1:]:
            if all(abs(_value(one) - _value(other)) > SAME_MAXIMUM for other in different):
                different.append(one)
        return [place for place, _ in different]

    @cached_property
    def largest(self) -> float:
        """Return the largest ln L."""
        return float(self.log_likelihood(self.estimate))

    @property
    def limit_matters(self) -> bool:
        """Return whether a fatigue limit makes the tests likelier than the line alone does."""
        straight = replace(self, knee=False)
        return self.knee and self.largest > straight.largest + SAME_MAXIMUM

    @property
    def at_bound(self) -> tuple[str, ...]:
        """Return the names of values whose estimate lies at a bound, so that the tests do not
        identify them.
        """
        reach = AT_BOUND * np.ptp(self.limits, axis=1)
        ends = np.abs(self.estimate[:, None] - self.limits).min(axis=1) < reach
        return tuple(name for name, end in zip(self.free, ends, strict=True) if end)

    @property
    def best(self) -> Values:
        """Return all values at the estimate, the held ones included."""
        return Values(*map(float, self.values(self.estimate)))

    def _starts(self) -> list[np.ndarray]:
        """Return places to start from: the regression of the failures, with steeper slopes beside
        it.
        """
        lowest = self.tests.stress.min()
        failed = self.tests.failed
        if failed.all():
            limit = lowest - 0.05
        else:
            limit = float(np.median(self.tests.stress[~failed]))
        return [
            self._point(own._replace(log_limit=limit))
            for own in self._lines_of_failures((5.0, 12.0))
        ]

    def _lines_of_failures(self, slopes: Sequence[float]) -> list[Values]:
        """Return lines through the middle of the failures: that of the regression, and those of
        given slopes.
        """
        x = self.tests.stress - self.reference
        y = self.tests.middle
        failed = self.tests.failed
        if failed.any():
            x, y = x[failed], y[failed]
        spread = float(((x - x.mean()) ** 2).sum())
        fitted = 8.0
        if spread > 1e-12:
            fitted = -float((x * (y - y.mean())).sum()) / spread
        if not self.sloped:
            starts = [0.0]
        elif self.slope is not None:
            starts = [float(np.clip(self.slope, *BOUNDS["slope"]))]
        else:
            starts = [float(np.clip(slope, *BOUNDS["slope"])) for slope in (fitted, *slopes)]
        lines = []
        for slope in starts:
            along = y + slope * x
            scatter = max(float(np.std(along)), 0.1)
            lines.append(Values(float(along.mean()), slope, math.log(scatter), 0.0, math.log(0.05)))
        return lines

    def _starts_by_limit(self) -> list[np.ndarray]:
        """Return the likeliest values with some fatigue limits, and those without a limit."""
        every = self._points_by_limit
        likely = self.log_likelihood(every)
        best = every[np.arange(len(every)), likely.argmax(axis=1)]
        order = np.argsort(-likely.max(axis=1), kind="stable")[:MOST_STARTS]
        without_limit = best[:1]
        return [*best[order], *without_limit]

    @cached_property
    def _points_by_limit(self) -> np.ndarray:
        """Return values (limits, lines, p) with fatigue limits below all tests, at their stresses
        and between them.
        """
        levels = np.unique(self.tests.stress)
        limits = np.concatenate(
            [[self.bounds["log_limit"][0]], levels, 0.5 * (levels[1:] + levels[:-1])]
        )
        if len(limits) > MOST_LIMITS:  # stresses that scatter have no levels
            limits = np.append(
                limits[0], np.quantile(self.tests.stress, np.linspace(0.0, 1.0, MOST_LIMITS - 1))
            )
        lines = self._lines_of_failures((5.0, 12.0, 25.0))
        lines.append(replace(self, knee=False).best)  # on it a run-out is a long life
        points = [
            [
                self._point(own._replace(log_limit=limit, log_limit_scatter=math.log(scatter)))
                for own in lines
                for scatter in LIMIT_SCATTERS
            ]
            for limit in limits.tolist()
        ]
        return np.clip(np.array(points), *self.limits.T)

    def _point(self, values: Values) -> np.ndarray:
        """Return the free ones of values, (p,)."""
        return np.array([values[place] for place in self._places])

    def cut_off(self, confidence: float) -> float:
        """Return how far ln L may lie below its maximum within an interval, t^2(n - p)/2.

        Parameters
        ----------
        confidence : float
            Share of intervals that hold the true value, such as 0.9.
        """
        freedom = max(self.size - len(self.free), 1)
        square = float(stdtrit(freedom, 0.5 + 0.5 * confidence)) ** 2
        # with one or two tests more than values, t^2/2 would be far too wide: the mean of complete
        # data has this form
        return min(0.5 * square, 0.5 * self.size * math.log1p(square / freedom))

    def log_life(self, values: Values, log_stress: float, probability: float) -> np.ndarray:
        """Return ln N at which a share of specimens has failed; inf below a fatigue limit that more
        survive.

        Parameters
        ----------
        values : Values
            Values of the line.
        log_stress : float
            ln S [ln MPa].
        probability : float
            The share.
        """
        deviate = np.asarray(self._deviate(values, log_stress, probability))
        straight = values.level - values.slope * (log_stress - self.reference)
        return np.asarray(straight + np.exp(values.log_scatter) * deviate)

    def _deviate(self, values: Values, log_stress: float, probability: float) -> np.ndarray | float:
        if not self.knee:
            return float(ndtri(probability))
        fails = ndtr((log_stress - values.log_limit) / np.exp(values.log_limit_scatter))
        with np.errstate(divide="ignore"):
            return np.where(
                fails > probability,
                ndtri(np.minimum(probability / np.maximum(fails, LEAST), 1.0)),
                np.inf,
            )

    def _life_at_level_0(
        self, others: np.ndarray, log_stress: float, probability: float
    ) -> np.ndarray:
        """Return ln N as `log_life` does for a line whose level is 0; `others` are its further
        fitted values.
        """
        own = self.values(np.concatenate([np.zeros((*others.shape[:-1], 1)), others], axis=-1))
        return self.log_life(own, log_stress, probability)

    def interval_of_life(
        self, log_stress: float, probability: float, confidence: float = 0.9
    ) -> Interval:
        """Return the interval of ln N at which a share of specimens has failed under a stress.

        Parameters
        ----------
        log_stress : float
            ln S [ln MPa].
        probability : float
            The share.
        confidence : float
            Share of intervals that hold the true value.
        """

        def level(value: float, others: np.ndarray) -> np.ndarray:
            """Return the levels that give the life `value`, with the other values as they are."""
            return value - self._life_at_level_0(others, log_stress, probability)

        def life(point: np.ndarray) -> float:
            return float(self.log_life(self.values(point), log_stress, probability))

        if not (self.knee and self.tests.failed.any()):
            return self._ends([(life(self.estimate), self.estimate)], 0, level, confidence)
        likely = self._likely(confidence)
        begins = [(life(point), point) for point in likely if math.isfinite(life(point))]
        if not math.isfinite(life(self.estimate)):
            begins = [*self._finite_lives(log_stress, probability, confidence, level), *begins]
        if not begins:
            return Interval(math.inf, math.inf)
        low, high = self._ends(begins, 0, level, confidence)
        endless = any(math.isinf(life(point)) for point in likely)
        if not endless:
            endless = self._endless(log_stress, probability) >= self._goal(confidence)
        if endless:
            return Interval(low, math.inf)
        return Interval(low, high)

    def _finite_lives(
        self, log_stress: float, probability: float, confidence: float, level: Solved
    ) -> list[tuple[float, np.ndarray]]:
        """Return a finite life that is likely enough, with its place, where the likeliest life is
        endless.
        """
        straight = float(self.best.level - self.best.slope * (log_stress - self.reference))
        start = self.estimate.copy()
        start[self.free.index("log_limit")] = (
            log_stress - math.exp(start[-1]) * float(ndtri(probability)) - NEAR
        )
        goal = self._goal(confidence)
        profile = self._profile(0, level, goal)
        likely, step = max((profile(straight + step, start[1:])[0], step) for step in STEPS)
        if likely >= goal:
            return [(straight + step, start)]
        return []

    def _endless(self, log_stress: float, probability: float) -> float:
        """Return the largest ln L of lines whose fatigue limit at a failure probability is a
        stress.
        """
        index = self.free.index("log_limit")

        def loss(others: np.ndarray) -> np.ndarray:
            limit = log_stress - np.exp(others[..., -1]) * float(ndtri(probability))
            inside = (limit >= self.limits[index, 0]) & (limit <= self.limits[index, 1])
            return np.where(
                inside, -self.log_likelihood(np.insert(others, index, limit, axis=-1)), LARGE
            )

        limits = np.delete(self.limits, index, axis=0)
        return max(-least(loss, np.delete(start, index), limits)[1] for start in self.maxima)

    def _goal(self, confidence: float) -> float:
        """Return the least ln L within an interval."""
        return self.largest - self.cut_off(confidence)

    def _likely(self, confidence: float) -> list[np.ndarray]:
        """Return the maxima of the likelihood that lie within an interval, the highest first."""
        goal = self._goal(confidence)
        return [point for point in self.maxima if float(self.log_likelihood(point)) >= goal]

    def interval_of_strength(
        self, log_cycles: float, probability: float, confidence: float = 0.9
    ) -> Interval:
        """Return the interval of ln S at which a share of specimens has failed after so many
        cycles.

        Parameters
        ----------
        log_cycles : float
            ln N.
        probability : float
            The share.
        confidence : float
            Share of intervals that hold the true value.
        """

        def level(value: float, others: np.ndarray) -> np.ndarray:
            """Return the levels that give `log_cycles` under the stress `value`, with the other
            values as they are.
            """
            return log_cycles - self._life_at_level_0(others, value, probability)

        def strength(point: np.ndarray) -> float:
            """Return ln S at which the line itself, without its limit, has the cycles."""
            own = self.values(point)
            deviate = math.exp(float(own.log_scatter)) * float(ndtri(probability))
            return self.reference + (float(own.level) + deviate - log_cycles) / float(own.slope)

        return self._ends(
            [(strength(point), point) for point in self._likely(confidence)], 0, level, confidence
        )

    def interval(self, name: str, confidence: float = 0.9) -> Interval:
        """Return the profile interval of one of the free values, by its name."""
        index = self.free.index(name)
        low, high = self.bounds[name]
        begins = [(float(point[index]), point) for point in self._likely(confidence)]
        ends = self._ends(begins, index, _itself, confidence)
        return Interval(max(ends.low, low), min(ends.high, high))

    def _ends(
        self,
        begins: Sequence[tuple[float, np.ndarray]],
        index: int,
        solved: Solved,
        confidence: float,
    ) -> Interval:
        """Return where the profile of a value falls to the cut-off on both sides of its likely
        values.

        `begins` holds likely values with the points (p,) that have them, that of the estimate
        first: between two maxima of the likelihood the profile may lie below the cut-off, and the
        interval holds both. `solved` returns the free value at `index` from the value in question
        and the other free values.
        """
        if not self.tests.failed.any():
            return self._without_failures(index, solved, confidence)
        goal = self._goal(confidence)
        bounds = -math.inf, math.inf
        if index:
            bounds = self.limits[index]
        profile = self._profile(index, solved, goal)
        low, high = math.inf, -math.inf
        for value, point in begins:
            others = np.delete(point, index)
            if value < low:
                low = _end(profile, value, others, goal, -1.0, bounds)
            if value > high:
                high = _end(profile, value, others, goal, 1.0, bounds)
        return Interval(low, high)

    def _profile(self, index: int, solved: Solved, goal: float) -> Profile:
        """Return the function of a value and a start that gives the largest ln L with that value,
        and its place.

        Where ln L stays below `goal`, Newton's method starts from other likely values as well.
        """
        limits = np.delete(self.limits, index, axis=0)
        points = [np.array(self.maxima)]
        if self.knee:
            points.append(self._points_by_limit.reshape(-1, len(self.free)))
        further = np.clip(np.delete(np.concatenate(points), index, axis=1), *limits.T)

        def profile(value: float, start: np.ndarray) -> tuple[float, np.ndarray]:
            def loss(others: np.ndarray) -> np.ndarray:
                own = solved(value, others)
                points = np.insert(others, index, np.where(np.isfinite(own), own, 0.0), axis=-1)
                return np.where(np.isfinite(own), -self.log_likelihood(points), LARGE)

            if not len(start):
                return -float(loss(start)), start
            minimum = least(loss, start, limits)
            if -minimum[1] < goal and len(further):
                for other in further[np.argsort(loss(further), kind="stable")[:MOST_FURTHER]]:
                    minimum = min(minimum, least(loss, other, limits), key=_value)
            return -minimum[1], minimum[0]

        return profile

    def _without_failures(self, index: int, solved: Solved, confidence: float) -> Interval:
        """Return the one-sided bound of a level that no failure has bounded from above."""
        if len(self.free) > 1 or index:
            return Interval(-math.inf, math.inf)
        goal = math.log(0.5 - 0.5 * confidence)
        none = np.empty(0)

        def excess(value: float) -> float:
            return float(self.log_likelihood(np.atleast_1d(solved(value, none)))) - goal

        from scipy.optimize import brentq  # heavy, and a single roller imports this file

        return Interval(float(brentq(excess, -FARTHEST, 2.0 * FARTHEST)), math.inf)


def least(
    loss: Callable[[np.ndarray], np.ndarray], start: np.ndarray, limits: np.ndarray
) -> tuple[np.ndarray, float]:
    """Return where a function of points (..., p) is least within limits (p, 2), and its value
    there.

    Newton's method from a start (p,), damped where a step does not lower the value.
    """

    point = np.clip(start, *limits.T)
    value, gradient, curvature = expanded(loss, point)
    damping = 0.0
    for _ in range(MOST_STEPS):
        # values at a bound that the loss pushes outward stay there
        stuck = ((point <= limits[:, 0]) & (gradient > 0)) | (
            (point >= limits[:, 1]) & (gradient < 0)
        )
        step = np.zeros(len(point))
        if not stuck.all():
            own = np.ix_(~stuck, ~stuck)
            roots, axes = np.linalg.eigh(curvature[own])
            roots = np.maximum(np.abs(roots), 1e-6) + damping
            step[~stuck] = -axes @ ((axes.T @ gradient[~stuck]) / roots)
        new = np.clip(point + step, *limits.T)
        if -(new - point) @ gradient < TOLERANCE:
            break
        expansion = expanded(loss, new)
        if expansion[0] < value:
            point = new
            value, gradient, curvature = expansion
            damping = 0.1 * damping
        else:
            damping = max(10.0 * damping, 1e-2 * float(np.abs(np.diag(curvature)).max()), 1e-3)
    return point, value


def expanded(
    loss: Callable[[np.ndarray], np.ndarray], point: np.ndarray
) -> tuple[float, np.ndarray, np.ndarray]:
    """Return value, gradient and second derivatives of a function at a point, by central
    differences.
    """
    n = len(point)
    unit = STEP * np.eye(len(point))
    first, second = np.triu_indices(n, 1)
    both = unit[first] + unit[second]
    apart = unit[first] - unit[second]
    places = np.concatenate([np.zeros((1, n)), unit, -unit, both, -both, apart, -apart])
    values = np.nan_to_num(loss(point + places), nan=LARGE, posinf=LARGE)
    m = len(first)
    up = values[1 : n + 1]
    down = values[n + 1 : 2 * n + 1]
    crossed = values[2 * n + 1 :]
    curvature = np.diag((up + down - 2.0 * values[0]) / STEP**2)
    mixed = (crossed[:m] + crossed[m : 2 * m] - crossed[2 * m : 3 * m] - crossed[3 * m :]) / (
        4.0 * STEP**2
    )
    curvature[first, second] = curvature[second, first] = mixed
    return float(values[0]), (up - down) / (2.0 * STEP), curvature


def log_or_end(value: float) -> float:
    """Return ln of a number >= 0: -inf for 0, inf for inf."""
    if value == 0:
        return -math.inf
    return math.log(value)


def _value(minimum: tuple[np.ndarray, float]) -> float:
    """Return the value at a minimum that `least` returned."""
    return minimum[1]


def _itself(value: float, others: np.ndarray) -> np.ndarray:
    """Return the value for each point of the others."""
    return np.full(others.shape[:-1], value)


def _between(low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Return ln(Phi(high) - Phi(low)), accurate in both tails."""
    flip = low > 0
    low, high = np.where(flip, -high, low), np.where(flip, -low, high)
    upper = log_ndtr(high)
    lower = log_ndtr(low)
    return np.asarray(upper + np.log1p(-np.minimum(np.exp(lower - upper), 1.0 - 1e-15)))


def _end(
    profile: Profile,
    best: float,
    others: np.ndarray,
    goal: float,
    side: float,
    bounds: tuple[float, float] | np.ndarray,
) -> float:
    """Return one end of an interval: step outward until the profile lies below its goal, then close
    in.
    """
    step = 0.1
    inner = best
    start = others
    while True:
        outer = inner + side * step
        if not bounds[0] < outer < bounds[1]:
            outer = float(bounds[1])
            if side < 0:
                outer = float(bounds[0])
            if profile(outer, start)[0] >= goal:
                return outer
        value, point = profile(outer, start)
        if value < goal:
            break
        inner = outer
        start = point
        step = 2.0 * step
        if abs(inner - best) > FARTHEST:
            return side * math.inf
    for _ in range(40):
        middle = 0.5 * (inner + outer)
        if abs(outer - inner) < 1e-4 * max(1.0, abs(inner - best)):
            break
        value, point = profile(middle, start)
        if value >= goal:
            inner = middle
            start = point
        else:
            outer = middle
    return 0.5 * (inner + outer)
