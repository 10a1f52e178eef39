"""Sensitivity from whatever rows there are: valid where cases failed, for any sample of independent factors.

First-order shares by binning, delta and PAWN with the level that chance alone reaches, partial rank correlations.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from trackroller.analysis.delta import delta
from trackroller.analysis.indices import Estimates, Z, constant

MIN_ROWS = 30
PAWN_BINS = 10
GROUPS = 20  # of the grouped jackknife
MEASURES = {
    "first": ("first", "first_low", "first_high"),
    "delta": ("delta", "delta_low", "delta_high", "delta_noise"),
    "pawn": ("pawn", "pawn_low", "pawn_high", "pawn_noise"),
    "prcc": ("prcc", "prcc_low", "prcc_high"),
}


def bins(values: np.ndarray, count: int, ordered: bool = True) -> np.ndarray:
    """Bin of each row, shape (n,): each different value if there are few or no order, else of equal count."""
    different, index = np.unique(values, return_inverse=True)
    if len(different) <= count or not ordered:
        return index
    order = np.argsort(values, kind="stable")
    out = np.empty(len(values), dtype=int)
    out[order] = np.arange(len(values)) * count // len(values)
    return out


def given_data(
    y: np.ndarray,
    unit: np.ndarray,
    ordered: np.ndarray,
    seed: int = 0,
    measures: Iterable[str] = tuple(MEASURES),
    resamples: int = 300,
) -> Estimates:
    """Given-data measures of one output.

    Parameters
    ----------
    y : output, shape (n,), NaN where unusable: such rows are left out
    unit : quantiles or list indices of the factors, shape (n, k)
    ordered : for which factors more and less mean something, shape (k,); others have no rank correlation
    measures : of `MEASURES`
    resamples : bootstrap resamples of PAWN

    Returns
    -------
    first (share of variance Var(E[y|x]) / V), first_low, first_high; delta and pawn with _low, _high and _noise,
    which an inert factor stays below in 95 % of cases; prcc, prcc_low, prcc_high; each shape (k,); rows_used.
    All NaN with fewer than 30 usable rows.

    Notes
    -----
    first: equal-count bins, corrected for the bins' own scatter (epsilon squared, Kelley 1935), interval by a
    grouped jackknife. Leaving rows out conditions every measure on the usable region.
    """
    good = np.isfinite(y)
    y, unit = y[good], unit[good]
    count, measures = unit.shape[1], tuple(measures)
    out: Estimates = {name: np.full(count, np.nan) for measure in measures for name in MEASURES[measure]}
    out["rows_used"] = np.array(len(y))
    if len(y) < MIN_ROWS or constant(y):
        return out
    if "first" in measures:
        out |= firsts(y, unit, ordered, seed)
    for j in range(count):
        if np.ptp(unit[:, j]) == 0:
            continue
        if "delta" in measures:
            found = delta(y, unit[:, j], bool(ordered[j]), seed)
            for name, value in zip(MEASURES["delta"], found, strict=True):
                out[name][j] = value
        if "pawn" in measures:
            group = bins(unit[:, j], PAWN_BINS, bool(ordered[j]))
            out["pawn"][j], out["pawn_noise"][j] = pawn(y, group, seed)
            out["pawn_low"][j], out["pawn_high"][j] = pawn_interval(y, group, out["pawn"][j], seed, resamples)
    if "prcc" in measures:
        out["prcc"], out["prcc_low"], out["prcc_high"] = prcc(y, unit, ordered)
    return out


def firsts(y: np.ndarray, unit: np.ndarray, ordered: np.ndarray, seed: int = 0) -> Estimates:
    """Only `first`, first_low and first_high of `given_data`, each shape (k,)."""
    good = np.isfinite(y)
    y, unit = y[good], unit[good]
    count = unit.shape[1]
    out = {name: np.full(count, np.nan) for name in ("first", "first_low", "first_high")}
    if len(y) < MIN_ROWS or constant(y):
        return out
    fine = int(np.clip(round(np.sqrt(len(y)) / 2), 4, 40))
    for j in range(count):
        if np.ptp(unit[:, j]) > 0:
            value, error = first_order(y, bins(unit[:, j], fine, bool(ordered[j])), seed)
            out["first"][j] = value
            out["first_low"][j], out["first_high"][j] = value - Z * error, value + Z * error
    return out


def first_order(y: np.ndarray, group: np.ndarray, seed: int = 0) -> tuple[float, float]:
    """Share of variance between groups, freed of its bias, and its standard error (grouped jackknife)."""
    count = int(group.max()) + 1
    part = np.random.default_rng(seed).permutation(len(y)) % GROUPS
    y = (y - y.mean()) / y.std()
    cell = part * count + group
    sums = np.stack([np.bincount(cell, w, GROUPS * count).reshape(GROUPS, count) for w in (np.ones_like(y), y)])
    square = np.bincount(part, y**2, GROUPS)
    total, total_square = sums.sum(axis=1), square.sum()
    value = _epsilon(total, np.asarray(total_square))
    left = _epsilon(total[:, None, :] - sums, total_square - square)
    error = np.sqrt((GROUPS - 1) / GROUPS * ((left - left.mean()) ** 2).sum())
    return float(value), float(error)


def _epsilon(sums: np.ndarray, square: np.ndarray) -> np.ndarray:
    """Epsilon squared from counts and sums per group, shape (2, ..., groups), and sums of squares (...)."""
    number, total = sums
    rows, filled = number.sum(axis=-1), (number > 0).sum(axis=-1)
    mean = total.sum(axis=-1) / rows
    whole = square - rows * mean**2
    between = (total**2 / np.maximum(number, 1)).sum(axis=-1) - rows * mean**2
    return 1 - (whole - between) / (rows - filled) * (rows - 1) / whole


def pawn(y: np.ndarray, group: np.ndarray, seed: int = 0, noise: bool = True) -> tuple[float, float]:
    """PAWN index (median over bins) and the level that an inert factor stays below in 95 % of cases.

    The Kolmogorov-Smirnov distance between the output's distribution in a bin and in all rows.

    References
    ----------
    Pianosi & Wagener (2018), Environ. Model. Softw. 108, 197-207.
    """
    order = np.argsort(y, kind="stable")
    last = np.append(np.diff(y[order]) != 0, True)  # equal outputs: compare after the last of them
    value = _distance(group[order], last)
    if not noise:
        return value, np.nan
    rng = np.random.default_rng(seed)
    group, last = (group, last) if len(group) <= 4096 else (group[:: len(group) // 4096], np.array([True]))
    shrink = np.sqrt(len(group) / len(y))  # the noise of a distance falls as one over the root of the rows
    if len(last) == 1:
        last = np.ones(len(group), dtype=bool)
    drawn = [_distance(rng.permutation(group), last) for _ in range(60)]
    return value, float(np.percentile(drawn, 95) * shrink)


def pawn_interval(
    y: np.ndarray, group: np.ndarray, value: float, seed: int = 0, resamples: int = 300, rows: int = 2048
) -> tuple[float, float]:
    """95 % interval of a PAWN index: the bootstrap's own spread about it.

    Long samples are thinned to `rows` and the spread, which falls as one over the root of the rows, is scaled.
    """
    shrink = max(1.0, len(y) / rows) ** 0.5
    every = np.linspace(0, len(y) - 1, min(len(y), rows)).astype(int)
    y, group = y[every], group[every]
    order = np.argsort(y, kind="stable")
    last, group = np.append(np.diff(y[order]) != 0, True), group[order]
    number = np.arange(group.max() + 1)
    rng = np.random.default_rng(seed)
    member = (group == number[:, None]).astype(float)
    drawn = np.empty(resamples)
    for i in range(resamples):
        weight = np.bincount(rng.integers(0, len(group), len(group)), minlength=len(group)).astype(float)
        inside = np.cumsum(member * weight, axis=1)
        whole = np.cumsum(weight) / len(group)
        filled = inside[:, -1] > 0
        apart = np.abs(inside[filled] / inside[filled, -1:] - whole)[:, last].max(axis=1)
        drawn[i] = np.median(apart)
    half = Z * float(drawn.std(ddof=1)) / shrink
    return max(0.0, value - half), min(1.0, value + half)


def _distance(group: np.ndarray, last: np.ndarray) -> float:
    number = np.bincount(group).astype(float)
    whole = np.arange(1, len(group) + 1)[last] / len(group)
    distances = [np.abs(np.cumsum(group == g)[last] / number[g] - whole).max() for g in np.flatnonzero(number)]
    return float(np.median(distances))


def prcc(y: np.ndarray, unit: np.ndarray, ordered: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Partial rank correlation coefficients with Fisher intervals, each shape (k,).

    A factor without an order has none (NaN), but its influence is taken out of the others by its values.
    Valid for monotonic influence.
    """
    from scipy.stats import rankdata

    count = unit.shape[1]
    columns, owner = [], []
    for j in range(count):
        if np.ptp(unit[:, j]) == 0:
            continue
        if ordered[j]:
            columns.append(rankdata(unit[:, j]))
            owner.append(j)
        else:
            for level in np.unique(unit[:, j])[1:]:
                columns.append((unit[:, j] == level).astype(float))
                owner.append(-1)
    table = np.stack([*columns, rankdata(y)], axis=1)
    table = (table - table.mean(axis=0)) / table.std(axis=0)
    precision = np.linalg.pinv(table.T @ table / len(y))
    value, low, high = (np.full(count, np.nan) for _ in range(3))
    for p, j in enumerate(owner):
        if j < 0:
            continue
        root = np.sqrt(abs(precision[p, p] * precision[-1, -1]))
        value[j] = np.clip(-precision[p, -1] / root, -1, 1) if root > 0 else np.nan
        wide = Z / np.sqrt(max(1, len(y) - len(columns) - 2))
        middle = np.arctanh(np.clip(value[j], -1 + 1e-12, 1 - 1e-12))
        low[j], high[j] = np.tanh(middle - wide), np.tanh(middle + wide)
    return value, low, high
