"""How an output changes with a factor: between pairs of cases that differ in this factor, or by a fit of a sample."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from scipy import stats

from trackroller.methods.interactions import MAX_ROWS, ROWS_PER_TERM, best_fit
from trackroller.methods.intervals import constant
from trackroller.parameters import PARAMETERS
from trackroller.results.columns import codes
from trackroller.results.groups import MOST_LEVELS
from trackroller.results.results import Results

FEWEST_PAIRS = 3  # fewer pairs of designs state no effect
FEWEST_ROWS = 30  # smallest number of cases that are fitted
TOLD = 0.9  # share of the variance that a fit must predict before its effects are told
DEGREES = ((8, 0), (5, 0), (3, 0), (2, 0), (1, 0))  # of a factor alone, none with another one; the best one wins
SPANNED = 2.0, 20.0  # a number that spans so many times its smallest size is fitted by its logarithm
INFLATED = 3.0  # times the variance of a weight in a sample of independent factors: above it they are not told apart
UNCHANGED = 0.02  # a ratio between 0.98 and 1.02 counts as no change
MOST = 0.9  # share of the pairs that must change in the same direction


@dataclass(frozen=True)
class Effect:
    """How an output changes between two levels of a factor.

    Attributes
    ----------
    low, high : the two levels
    ratio : median of the ratios of pairs, or the fitted ratio [1]
    interval : 95 % interval of a fitted ratio; of pairs the smallest and the largest ratio
    size : number of pairs, or of fitted cases
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
    values, others = _values(results, column), [f for f in results.factors if f != factor]
    used = rows & (values > 0)
    table = results.table[used]
    levels = results.levels(factor)
    if not len(table) or len(levels) > MOST_LEVELS:
        return np.empty((0, len(levels))), levels
    key = codes(table, others)
    place = {level: i for i, level in enumerate(levels)}
    matrix = np.full((int(key.max()) + 1, len(levels)), np.nan)
    matrix[key, [place[v] for v in table[factor]]] = np.log10(values[used])
    return matrix[(~np.isnan(matrix)).sum(axis=1) > 1], levels


def _values(results: Results, column: str) -> np.ndarray:
    """Return a column of the cases, or an output with one number a case, shape (n,)."""
    own = results.table[column] if column in results.table else results.quantity(column)[0]
    return np.asarray(own, dtype=float)


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
    ends = (float(10 ** steps.min()), float(10 ** steps.max()))
    return Effect(factor, low, high, float(10 ** np.median(steps)), ends, steps.size, rising, falling)


def fitted_effects(results: Results, column: str, rows: np.ndarray) -> tuple[float, list[Effect]]:
    """Return the effect of each factor at equal other factors, by a fit that multiplies one function of each factor.

    Parameters
    ----------
    column : column of an output; its positive values count
    rows : cases to use, shape (n,) bool

    Returns
    -------
    Share of the variance of the logarithm that the fit predicts for cases held out of it, and the effects: of a number
    between the values that a tenth of the cases lie below and above, of a category between its most different levels.
    There is none where the fit predicts less than `TOLD`, because the effect of a factor then depends on others, nor of
    a factor that goes with others.
    """
    values = _values(results, column)
    good = np.flatnonzero(rows & np.isfinite(values) & (values > 0))
    if len(good) > MAX_ROWS:
        good = good[np.linspace(0, len(good) - 1, MAX_ROWS).astype(int)]
    table, y = results.table.iloc[good], np.log10(values[good])
    names = [name for name in results.factors if table[name].nunique() > 1]
    if len(y) < FEWEST_ROWS or not names or constant(y):
        return np.nan, []
    ordered = np.array([results.ordered(name) for name in names])
    columns = [_scaled(table[n]) if o else codes(table, (n,)) for n, o in zip(names, ordered, strict=True)]
    drawn = [name for name, own in zip(names, columns, strict=True) if len(np.unique(own)) > MOST_LEVELS]
    most = (codes(table, drawn).max() + 1) / ROWS_PER_TERM / len(drawn) if drawn else np.inf  # designs may repeat draws
    degrees = tuple(one for one in DEGREES if one[0] <= most) or DEGREES[-1:]
    fit = best_fit(y, np.stack(columns, axis=1), ordered, degrees, ranked=False)
    if fit is None or fit.share < TOLD:
        return np.nan, []
    weights = np.linalg.lstsq(fit.table, y, rcond=None)[0]
    rest, free = y - fit.table @ weights, len(y) - len(weights)
    inverse = np.linalg.inv(fit.table.T @ fit.table)
    spread = inverse * (rest @ rest / free)
    wide, found = float(stats.t.ppf(0.975, free)), []
    for j, name in enumerate(names):
        if (np.diag(inverse)[fit.term == j] * len(y)).max(initial=0.0) > INFLATED:
            continue
        own = np.where(fit.term == j, fit.table, 0.0)
        at = _ends(columns[j], ordered[j], own @ weights)
        change = own[at[1]] - own[at[0]]
        step, half = change @ weights, wide * np.sqrt(max(0.0, change @ spread @ change))
        low, high = table[name].iloc[at[0]], table[name].iloc[at[1]]
        interval = (float(10 ** (step - half)), float(10 ** (step + half)))
        found.append(Effect(name, low, high, float(10**step), interval, len(y)))
    return fit.share, found


def _scaled(values: pd.Series) -> np.ndarray:
    """Return a number, or its logarithm: of a number that spans its smallest size several times, or is spread so."""
    own = values.to_numpy(dtype=float)
    sizes = np.abs(own)
    one_sign = (own > 0).all() or (own < 0).all()
    if not one_sign or sizes.max() <= SPANNED[0] * sizes.min():
        return own
    logs = np.sign(own) * np.log(sizes / sizes.max())
    places = stats.rankdata(own)  # a sample that is even in its logarithm was drawn so
    even = np.corrcoef(places, logs)[0, 1] > np.corrcoef(places, own)[0, 1]
    return logs if even or sizes.max() < SPANNED[1] * sizes.min() else own


def _ends(own: np.ndarray, ordered: bool, part: np.ndarray) -> tuple[int, int]:
    """Return a row at the low and one at the high end of a factor; of a category those of the lowest and highest."""
    tenth = len(own) // 10 if ordered else 0
    order = np.argsort(own if ordered else part, kind="stable")
    return int(order[tenth]), int(order[len(own) - 1 - tenth])


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


def _repeated(results: Results, column: str, effect: Effect, rows: np.ndarray) -> Effect | None:
    """Return the effect between the same levels for other rows."""
    matrix, levels = pair_matrix(results, column, effect.factor, rows)
    if not len(matrix):
        return None
    steps = _steps(matrix, levels.index(effect.low), levels.index(effect.high))
    if not steps.size or not np.isfinite(np.median(steps)):
        return None
    return _of_steps(effect.factor, effect.low, effect.high, steps)
