"""How an output changes with each factor of a study: one curve a factor, by like cases, by a fit,
by the changes between like cases, or by classes of drawn cases.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd
from scipy import stats

from trackroller.methods.interactions import MAX_ROWS, ROWS_PER_TERM, best_fit
from trackroller.methods.intervals import constant
from trackroller.parameters.carriage_fields import long_name_of, parameter_of
from trackroller.results.answer import Curve
from trackroller.results.case_columns import codes
from trackroller.results.case_ranges import CaseRanges
from trackroller.results.factor_levels import BINS, MOST_LEVELS, groups, spaced_by_ratio
from trackroller.results.like_changes import effect_of_changes
from trackroller.results.solved_cases import SolvedCases
from trackroller.results.subgroups import plain
from trackroller.study.design.factor_names import OPTION_FACTORS

FEWEST_ROWS = 30  # smallest number of cases that are fitted
TOLD = 0.9  # share of the variance that a fit must predict before its effects are told
# of a factor alone, none with another one; the best one wins
DEGREES = ((8, 0), (5, 0), (3, 0), (2, 0), (1, 0))
# a number that spans so many times its smallest size is fitted by its logarithm
SPANNED = 2.0, 20.0
PLACES = 24  # points of a fitted curve
FLAT = 1.02  # height of a curve below which it counts as flat
TURNS = 1.1  # change in the other direction from which on a curve is a hump or a dip
# of the height of a curve, above which a smaller change in the other direction makes it one
HALF = 0.5
CLIFF = 0.7  # share of the whole change that lies in one of at least three steps
BAND = (0.1, 0.9)  # quantiles of the cases between which the band of a curve lies
SPLIT = 1.25  # ratio between two groups of pairs from which on they are told apart
# like cases at all levels, or cases of a class, from which on a curve is drawn by them
FEWEST_PAIRS = 3


@dataclass(frozen=True, eq=False)
class Effects:
    """The output of a study whose effects are wanted, and the cases that count.

    Attributes
    ----------
    results : the solved study
    ranges : the output
    rows : cases that count, shape (n,) bool
    """

    results: SolvedCases
    ranges: CaseRanges
    rows: np.ndarray

    @classmethod
    def of(cls, ranges: CaseRanges) -> Effects:
        """Return the effects on an output over the cases that are held and have a finite value."""
        results = ranges.results
        rows = results.of_one_model(ranges.holds) & np.isfinite(ranges.value)
        return cls(results, ranges, np.asarray(rows))

    @cached_property
    def by_ratio(self) -> bool:
        """Return whether effects are ratios: all values that count are above 0."""
        values = self.ranges.value[self.rows]
        return bool(values.size and (values > 0).all())

    @cached_property
    def y(self) -> np.ndarray:
        """Return the output on the scale on which effects add up, shape (n,): its logarithm if
        effects are ratios.
        """
        values: np.ndarray = self.ranges.value
        if self.by_ratio:
            with np.errstate(divide="ignore", invalid="ignore"):
                values = np.log(values)
        return values

    def back(self, values: np.ndarray) -> np.ndarray:
        """Return values of `y` as values of the output."""
        if self.by_ratio:
            values = np.exp(values)
        return values

    def curves(self) -> tuple[Curve, ...]:
        """Return the curve of each factor with two levels that count, the highest one first."""
        curves = []
        for name in self.results.factors:
            if name in OPTION_FACTORS or name in self.results.labels:
                continue
            curve = (
                self._by_pairs(name)
                or self._by_fit(name)
                or self._by_changes(name)
                or self._by_classes(name)
            )
            if curve is not None:
                curves.append(curve)
        return tuple(sorted(curves, key=lambda curve: -_size(curve.height, self.by_ratio)))

    def _by_pairs(self, name: str) -> Curve | None:
        """Return the median of like cases at each level; None without enough of them.

        Only combinations of the other factors count that are valid at all levels.
        """
        levels = self.results.levels(name)
        if len(levels) > MOST_LEVELS and not self.results.grid:
            return None
        rows = np.flatnonzero(self.rows)
        table = self.results.table.iloc[rows]
        key = codes(table, self._others(name))
        place = pd.Index(levels).get_indexer(table[name])
        matrix = np.full((int(key.max(initial=-1)) + 1, len(levels)), np.nan)
        matrix[key, place] = self.y[rows]
        known = ~np.isnan(matrix).all(axis=0)
        whole = ~np.isnan(matrix[:, known]).any(axis=1)
        if (
            known.sum() < 2
            or whole.sum() < min(FEWEST_PAIRS, max(len(matrix), 1))
            or whole.sum() * known.sum() < 2
        ):
            return None
        if len(rows) > 3 * known.sum() and whole.sum() < 0.05 * len(matrix):
            return None
        full = matrix[whole][:, known]
        counted = [level for level, here in zip(levels, known, strict=True) if here]
        ends = np.quantile(full, BAND, axis=0)
        shape = self._shape(name, np.median(full, axis=0), full)
        left = len(rows) - int(whole.sum() * known.sum())
        middle = np.median(full, axis=0)
        return self._curve(name, counted, middle, ends, shape, full.size, left, "like cases")

    def _others(self, name: str) -> list[str]:
        """Return the factors in which like cases agree; a label of a table changes no case."""
        labels = self.results.labels
        return [one for one in self.results.factors if one != name and one not in labels]

    def _by_fit(self, name: str) -> Curve | None:
        """Return the curve of a factor by the fit of the sample; None where the fit predicts too
        little.
        """
        if self.fit is None or name not in self.fit.parts:
            return None
        part = self.fit.parts[name]
        own = self.fit.values[name]
        others = self.fit.whole - part
        middle, ends = np.median(others), np.quantile(others, BAND)
        if self.results.ordered(name):
            first = np.unique(own, return_index=True)[1]
            step = np.unique(np.linspace(0, len(first) - 1, PLACES).astype(int))
            at = first[step]
        else:
            at = np.array(
                [int(np.flatnonzero(own == level)[0]) for level in dict.fromkeys(own.tolist())]
            )
        levels = [own[i] for i in at]
        curve = part[at] + middle
        band = np.stack([part[at] + end for end in ends])
        shape = self._shape(name, curve, None)
        return self._curve(name, levels, curve, band, shape, len(own), 0, "fit")

    def _by_changes(self, name: str) -> Curve | None:
        """Return the curve by the changes between cases that differ in this factor alone; None
        where too few do.
        """
        rows = np.flatnonzero(self.rows)
        table = self.results.table.iloc[rows]
        levels = [level for level in self.results.levels(name) if (table[name] == level).any()]
        if len(levels) < 2 or len(levels) > MOST_LEVELS:
            return None
        place = pd.Index(levels).get_indexer(table[name])
        group = np.unique(codes(table, self._others(name)), return_inverse=True)[1]
        values = None
        if self.results.numeric(name):
            values = np.array(levels, dtype=float)
        known = effect_of_changes(self.y[rows], place, group, values)
        if known is None:
            return None
        effect, beside = known
        middle = effect + np.median(beside)
        ends = effect + np.quantile(beside, BAND)[:, None]
        shape = self._shape(name, middle, None)
        return self._curve(name, levels, middle, ends, shape, len(rows), 0, "changes")

    def _by_classes(self, name: str) -> Curve | None:
        """Return the median of drawn cases in each level, or in classes of equally many cases; None
        of single cases, and where the other factors are not drawn independently of this one.
        """
        method = self.results.config.method
        drawn = method.sampled and not method.effects and not method.proposes
        if self.rows.sum() < 2 or not drawn:
            return None
        parts = groups(self.results.table, name, self.rows, BINS)
        inside = [self.y[self.rows][parts.index == k] for k in range(len(parts))]
        counted = [k for k, own in enumerate(inside) if len(own)]
        if len(counted) < 2 or np.median([len(inside[k]) for k in counted]) < FEWEST_PAIRS:
            return None
        middle = np.array([np.median(inside[k]) for k in counted])
        ends = np.array([np.quantile(inside[k], BAND) for k in counted]).T
        levels = [
            parts.low[k] if parts.low[k] == parts.high[k] else float(parts.at[k]) for k in counted
        ]
        shape = self._shape(name, middle, None)
        rows = int(self.rows.sum())
        return self._curve(name, levels, middle, ends, shape, rows, 0, "drawn cases")

    def _curve(
        self,
        name: str,
        levels: list[Any],
        middle: np.ndarray,
        ends: np.ndarray,
        shape: str,
        rows: int,
        left: int,
        by: str,
    ) -> Curve:
        known = parameter_of(name)
        numbers = self.results.numeric(name)
        if numbers:
            own = np.array(levels, dtype=float)
        else:
            own = np.zeros(0)
        height = middle.max() - middle.min()
        if self.by_ratio:
            height = np.exp(height)
        units = ""
        if known is not None and known.unit != "-":
            units = known.units
        return Curve(
            factor=name,
            title=long_name_of(name),
            units=units,
            role=self.results.roles.get(name, ""),
            levels=tuple(plain(level) for level in levels),
            middle=self.back(middle),
            low=self.back(ends[0]),
            high=self.back(ends[1]),
            logarithmic=bool(numbers and spaced_by_ratio(own, 5.0)),
            ordered=self.results.ordered(name),
            height=float(height),
            shape=shape,
            rows=rows,
            left_out=max(left, 0),
            by_ratio=self.by_ratio,
            by=by,
        )

    def _shape(self, name: str, middle: np.ndarray, pairs: np.ndarray | None) -> str:
        """Return the shape of a curve in one word."""
        span = float(middle.max() - middle.min())
        if self.by_ratio:
            least = np.log(FLAT)
            split = np.log(SPLIT)
            turn = min(np.log(TURNS), HALF * span)
        else:
            least = 0.01 * max(float(np.abs(middle).max()), 1e-300)
            split = 0.25 * max(span, 1e-300)
            turn = 0.1 * span
        turn = max(turn, 0.05 * span)
        if pairs is not None and _two_groups(pairs, split):
            return "groups"
        if span <= least:
            return "flat"
        if not self.results.ordered(name):
            return "levels"
        top, bottom = int(middle.argmax()), int(middle.argmin())
        inner = len(middle) - 1
        if 0 < top < inner and min(middle[top] - middle[0], middle[top] - middle[-1]) > turn:
            return "hump"
        if (
            0 < bottom < inner
            and min(middle[0] - middle[bottom], middle[-1] - middle[bottom]) > turn
        ):
            return "dip"
        steps = np.abs(np.diff(middle))
        if len(steps) >= 3 and steps.max() > CLIFF * steps.sum():
            return "cliff"
        if middle[-1] > middle[0]:
            return "rise"
        return "fall"

    @cached_property
    def fit(self) -> _Fitted | None:
        """Return the fit of one function of each factor; None where it predicts less than `TOLD` of
        the variance.
        """
        good = np.flatnonzero(self.rows)
        if len(good) > MAX_ROWS:
            good = good[np.linspace(0, len(good) - 1, MAX_ROWS).astype(int)]
        table = self.results.table.iloc[good]
        y = self.y[good]
        names = [
            n for n in self.results.factors if n not in OPTION_FACTORS and table[n].nunique() > 1
        ]
        if len(y) < FEWEST_ROWS or not names or constant(y):
            return None
        ordered = np.array([self.results.ordered(name) for name in names])
        pairs = zip(names, ordered, strict=True)
        columns = [
            _scaled(table[name]) if rises else codes(table, (name,)) for name, rises in pairs
        ]
        drawn = [
            name
            for name, own in zip(names, columns, strict=True)
            if len(np.unique(own)) > MOST_LEVELS
        ]
        most = np.inf
        if drawn:
            most = (codes(table, drawn).max() + 1) / ROWS_PER_TERM / len(drawn)
        degrees = tuple(one for one in DEGREES if one[0] <= most) or DEGREES[-1:]
        fit = best_fit(y, np.stack(columns, axis=1), ordered, degrees, ranked=False)
        if fit is None or fit.share < TOLD:
            return None
        weights = np.linalg.lstsq(fit.table, y, rcond=None)[0]
        parts = {
            name: np.where(fit.term == j, fit.table, 0.0) @ weights for j, name in enumerate(names)
        }
        values = {name: table[name].to_numpy() for name in names}
        return _Fitted(fit.share, fit.table @ weights, parts, values)


@dataclass(frozen=True, eq=False)
class _Fitted:
    """A fit of one function of each factor.

    Attributes
    ----------
    share : share of the variance that it predicts for cases held out [1]
    whole : its values, shape (m,)
    parts : the function of each factor at these cases, shape (m,)
    values : the factors at these cases, shape (m,)
    """

    share: float
    whole: np.ndarray
    parts: dict[str, np.ndarray]
    values: dict[str, np.ndarray]


def _scaled(values: pd.Series) -> np.ndarray:
    """Return a number, or its logarithm: of a number that spans its smallest size several times, or
    is spread so.
    """
    own = values.to_numpy(dtype=float)
    sizes = np.abs(own)
    one_sign = (own > 0).all() or (own < 0).all()
    if not one_sign or sizes.max() <= SPANNED[0] * sizes.min():
        return own
    logs = np.sign(own) * np.log(sizes / sizes.max())
    places = stats.rankdata(own)  # a sample that is even in its logarithm was drawn so
    even = np.corrcoef(places, logs)[0, 1] > np.corrcoef(places, own)[0, 1]
    if even or sizes.max() < SPANNED[1] * sizes.min():
        own = logs
    return own


def _size(height: float, by_ratio: bool) -> float:
    if by_ratio and height > 0:
        height = np.log(height)
    return abs(height)


def _two_groups(pairs: np.ndarray, apart: float) -> bool:
    """Return whether the changes between the ends of like cases fall into two groups with a gap
    between them.

    Parameters
    ----------
    pairs : like cases by level, shape (m, levels)
    apart : smallest gap

    Notes
    -----
    Each group holds at least three pairs and a fifth of them, and the gap is wider than the widest
    group.
    """
    change = np.sort(pairs[:, -1] - pairs[:, 0])
    least = max(3, int(np.ceil(0.2 * len(change))))
    if len(change) < 2 * least:
        return False
    gaps = np.diff(change)
    inner = gaps[least - 1 : len(gaps) - least + 1]
    if not inner.size:
        return False
    place = int(inner.argmax()) + least
    widths = change[place - 1] - change[0], change[-1] - change[place]
    return bool(gaps[place - 1] > apart and gaps[place - 1] > max(widths))
