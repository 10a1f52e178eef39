"""How an output changes with a factor: between pairs of designs that differ in this factor, or between classes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy import stats

from trackroller.methods.intervals import difference_of_medians
from trackroller.parameters import PARAMETERS
from trackroller.results.columns import codes
from trackroller.results.groups import MOST_LEVELS
from trackroller.results.results import Results

FEWEST_PAIRS = 3  # fewer pairs of designs state no effect
FEWEST_ROWS = 20  # smallest number of rows of a class whose median is compared
FEWEST_STRATUM = 8  # the same within one level of a category
COVERED = 0.8  # share of a class that must lie in levels with enough rows; otherwise pooling cannot be checked
UNCHANGED = 0.02  # a ratio of medians between 0.98 and 1.02 counts as no change
MOST = 0.9  # share of the pairs that must change in the same direction


@dataclass(frozen=True)
class Effect:
    """How an output changes between two levels or classes of a factor.

    Attributes
    ----------
    low, high : the two levels of pairs; of classes the last value of the low and the first value of the high class
    ratio : median of the ratios of pairs, or ratio of the medians of the classes, see `of_strata` [1]
    interval : 95 % interval of that ratio of medians (of classes), NaN for pairs
    size : number of pairs, or of rows in the smaller class
    rising, falling : pairs in which the output rises and falls (of pairs)
    """

    factor: str
    low: Any
    high: Any
    ratio: float
    interval: tuple[float, float]
    size: int
    rising: int = 0
    falling: int = 0


def pair_matrix(results: Results, column: str, factor: str, rows: np.ndarray) -> tuple[np.ndarray, list[Any]]:
    """Return the logarithm of an output for every pair of designs.

    Rows are combinations of all other factors, columns levels of the factor; NaN where a design is missing.

    Parameters
    ----------
    rows : cases to use, shape (n,) bool

    Returns
    -------
    Matrix of shape (m, levels) and the levels. Only combinations with two levels or more are kept.
    """
    table, others = results.table[rows & (results.column(column) > 0)], [f for f in results.factors if f != factor]
    levels = results.levels(factor)
    if not len(table) or len(levels) > MOST_LEVELS:
        return np.empty((0, len(levels))), levels
    key = codes(table, others)
    place = {level: i for i, level in enumerate(levels)}
    matrix = np.full((int(key.max()) + 1, len(levels)), np.nan)
    matrix[key, [place[v] for v in table[factor]]] = np.log10(table[column].to_numpy(dtype=float))
    return matrix[(~np.isnan(matrix)).sum(axis=1) > 1], levels


def also_changed(results: Results, factor: str, rows: np.ndarray) -> list[str]:
    """Name the parameters that change with a factor where all other factors are the same.

    Such a parameter is computed from the factor, or taken from the database, as the friction of a pair of materials.
    """
    others = [f for f in results.factors if f != factor]
    given = [p for p in (*PARAMETERS, "friction_coefficient_value") if p in results.table and p not in results.factors]
    table = results.table[rows]
    groups = table.groupby(codes(table, others))
    changed = [p.removesuffix("_value") for p in given if (groups[p].nunique(dropna=False) > 1).any()]
    return [name for name in changed if name != factor]


def paired_effect(results: Results, column: str, factor: str, rows: np.ndarray) -> Effect | None:
    """Compare designs that differ in one factor only; return None if there are too few pairs of designs.

    Numbers are compared between their ends, categories between their most different levels. Of a pair with an unlimited
    value only the direction counts.
    """
    matrix, levels = pair_matrix(results, column, factor, rows)
    if len(matrix) < FEWEST_PAIRS or len(matrix) < 0.2 * rows.sum() / max(len(levels), 1):
        return None
    compared = []
    for j in range(len(levels)):
        for i in range(j):
            steps = _steps(matrix, i, j)
            if steps.size >= FEWEST_PAIRS and np.isfinite(np.median(steps)):
                compared.append((abs(float(np.median(steps))), i, j, steps))
    if not compared:
        return None
    if results.ordered(factor):
        _, i, j, steps = max(compared, key=lambda item: (item[2] - item[1], item[3].size))
    else:
        _, i, j, steps = max(compared, key=lambda item: item[0])
        if np.median(steps) < 0:
            i, j, steps = j, i, -steps
    return _of_steps(factor, levels[i], levels[j], steps)


def _steps(matrix: np.ndarray, i: int, j: int) -> np.ndarray:
    """Return the change of the logarithm from level i to level j in every pair that has both."""
    with np.errstate(invalid="ignore"):
        steps = matrix[:, j] - matrix[:, i]
    return np.asarray(steps[~np.isnan(steps)])


def _of_steps(factor: str, low: Any, high: Any, steps: np.ndarray) -> Effect:
    rising, falling = int((steps > 0).sum()), int((steps < 0).sum())
    return Effect(factor, low, high, float(10 ** np.median(steps)), (np.nan, np.nan), steps.size, rising, falling)


def class_effect(results: Results, column: str, factor: str, rows: np.ndarray) -> Effect | None:
    """Compare the lowest third of the designs along a factor to the highest third.

    Designs with the same value of the factor stay in one class. None if a class has fewer than 20 rows, or if the other
    factors, which differ between the classes by chance, make more of the difference than its interval allows for.
    """
    if not results.ordered(factor):
        return None
    x = _logarithms(results, column, factor, rows)[0]
    if len(x) < 3 * FEWEST_ROWS:
        return None
    ends = np.sort(x)[[len(x) // 3, len(x) - 1 - len(x) // 3]]
    return _alone(results, column, factor, rows, (float(ends[0]), float(ends[1])), FEWEST_ROWS)


def _alone(
    results: Results, column: str, factor: str, rows: np.ndarray, ends: tuple[float, float], fewest: int
) -> Effect | None:
    """Compare the classes of a factor; None if the other factors make more of it than its interval allows for."""
    x, logs = _logarithms(results, column, factor, rows)
    found = _between(factor, x, logs, ends, fewest)
    if found is None:
        return None
    alone = _between(factor, x, logs - _of_others(results, column, factor, rows), ends, fewest)
    return found if alone is not None and found.interval[0] <= alone.ratio <= found.interval[1] else None


def _of_others(results: Results, column: str, factor: str, rows: np.ndarray) -> np.ndarray:
    """Return what the other numbers among the factors make of the logarithm of an output, shape (m,).

    By least squares with the rank of each factor and its square, as far as there are three rows for each term.
    """
    values = results.table[column].to_numpy(dtype=float)
    good = rows & np.isfinite(values) & (values > 0)
    logs = np.log10(values[good])

    def terms(name: str) -> list[np.ndarray]:
        place = stats.rankdata(results.table[name].to_numpy(dtype=float)[good]) / len(logs) - 0.5
        return [place, place**2] if np.ptp(place) else []

    names = [name for name in results.factors if name != factor and results.ordered(name)]
    others = [term for name in names for term in terms(name)][: max(0, len(logs) // 3 - 3)]
    if not others:
        return np.zeros(len(logs))
    matrix = np.stack([*others, np.ones(len(logs)), *terms(factor)], axis=1)
    weights = np.linalg.lstsq(matrix, logs, rcond=None)[0]
    return np.asarray(matrix[:, : len(others)] @ weights[: len(others)])


def comparable(results: Results, effect: Effect, column: str, rows: np.ndarray) -> bool:
    """Say whether pooling over the categories can be checked.

    It can where both classes of the factor have enough rows at most levels of each category.
    """
    x, values = (results.table[c].to_numpy(dtype=float) for c in (effect.factor, column))
    good = rows & np.isfinite(values) & (values > 0)
    ends = good & (x <= effect.low), good & (x >= effect.high)
    for category in (c for c in results.categories if c != effect.factor):
        own = results.table[category].to_numpy()
        cells = np.array([[int((end & (own == level)).sum()) for level in results.levels(category)] for end in ends])
        enough = (cells >= FEWEST_STRATUM).all(axis=0)
        if (cells[:, enough].sum(axis=1) < COVERED * cells.sum(axis=1)).any():
            return False
    return True


def _logarithms(results: Results, column: str, factor: str, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return a factor and the logarithm of an output for the rows whose output is finite and positive, (m,) each."""
    x, values = (results.table[name].to_numpy(dtype=float)[rows] for name in (factor, column))
    good = np.isfinite(values) & (values > 0)
    return x[good], np.log10(values[good])


def _between(factor: str, x: np.ndarray, logs: np.ndarray, ends: tuple[float, float], fewest: int) -> Effect | None:
    """Compare the medians below the first and above the second of two ends; None for fewer rows than `fewest`."""
    end, start = ends
    low, high = logs[x <= end], logs[x >= start]
    if end >= start or min(low.size, high.size) < fewest:
        return None
    step, least, most = difference_of_medians(low, high)
    interval = (float(10**least), float(10**most))
    return Effect(factor, end, start, float(10**step), interval, min(low.size, high.size))


def strata(results: Results, column: str, effect: Effect, rows: np.ndarray) -> list[tuple[str, Any, Effect]]:
    """Return the same effect within each level of each category.

    Levels with too few rows are left out.
    """
    effects = []
    for category in results.categories:
        if category == effect.factor:
            continue
        own = results.table[category].to_numpy()
        for level in results.levels(category):
            inside = rows & (own == level)
            part = _repeated(results, column, effect, inside)
            if part is not None:
                effects.append((category, level, part))
    return effects


def of_strata(pooled: Effect, parts: list[tuple[str, Any, Effect]]) -> tuple[Effect, list[tuple[str, Any, Effect]]]:
    """Return the mean effect of classes within the levels of a category, and the effects within these.

    Pooled classes hold unequal shares of the levels, whose outputs may lie far apart. Of several categories the one
    counts within which the effect differs most from the pooled one. Without a category it is the pooled effect.
    """
    own: list[tuple[str, Any, Effect]] = []
    mean, lower, upper = np.log([pooled.ratio, *pooled.interval])
    for category in dict.fromkeys(name for name, _, _ in parts):
        inside = [part for part in parts if part[0] == category]
        logs = np.log([[e.ratio, *e.interval] for _, _, e in inside]).T
        middle = logs[0].mean()
        if not own or abs(middle - np.log(pooled.ratio)) > abs(mean - np.log(pooled.ratio)):
            errors = np.sqrt(((logs - logs[0]) ** 2).sum(axis=1)) / len(inside)
            own, mean, lower, upper = inside, middle, middle - errors[1], middle + errors[2]
    interval, size = (float(np.exp(lower)), float(np.exp(upper))), min([e.size for _, _, e in own] or [pooled.size])
    return replace(pooled, ratio=float(np.exp(mean)), interval=interval, size=size), own


def stands_alone(results: Results, column: str, effect: Effect, rows: np.ndarray) -> bool:
    """Say whether the other factors leave an effect of classes within its interval, for some of the rows."""
    ends = effect.low, effect.high
    return _alone(results, column, effect.factor, rows, ends, FEWEST_STRATUM) is not None


def _repeated(results: Results, column: str, effect: Effect, rows: np.ndarray) -> Effect | None:
    """Return the effect between the same levels or classes for other rows."""
    if np.isfinite(effect.interval[0]):
        x, logs = _logarithms(results, column, effect.factor, rows)
        return _between(effect.factor, x, logs, (effect.low, effect.high), FEWEST_STRATUM)
    matrix, levels = pair_matrix(results, column, effect.factor, rows)
    if not len(matrix):
        return None
    steps = _steps(matrix, levels.index(effect.low), levels.index(effect.high))
    if not steps.size or not np.isfinite(np.median(steps)):
        return None
    return _of_steps(effect.factor, effect.low, effect.high, steps)
