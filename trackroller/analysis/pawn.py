"""PAWN from given data: how far knowing a factor moves the distribution function of an output.

SALib's PAWN was measured beside this one by ``validation/benchmarks/index_estimators.py``. Both agree for continuous
factors. SALib's has no interval and no noise, drops the row with the largest value, and is wrong for lists (0.50 for
three categories whose index is 0.36).

References
----------
Pianosi & Wagener (2018), Environ. Model. Softw. 108, 197-207
"""

from __future__ import annotations

from functools import lru_cache
from typing import Literal

import numpy as np

from trackroller.analysis.indices import Z

BINS = 10  # of an ordered factor
PAWN_ROWS, NOISE_ROWS = 2048, 4096  # behind the interval and behind the noise


def bins(values: np.ndarray, ordered: bool = True) -> np.ndarray:
    """Return the bin of each row.

    Parameters
    ----------
    values : factor, shape (n,)
    ordered : whether more and less mean something

    Returns
    -------
    Bin numbers, shape (n,): `BINS` bins of equal count, or one bin a value if there are few values or no order.
    """
    different, index = np.unique(values, return_inverse=True)
    if len(different) <= BINS or not ordered:
        return index
    order = np.argsort(values, kind="stable")
    out = np.empty(len(values), dtype=int)
    out[order] = np.arange(len(values)) * BINS // len(values)
    return out


def pawn(y: np.ndarray, group: np.ndarray, seed: int = 0, noise: bool = True) -> tuple[float, float]:
    """Estimate the PAWN index of one factor.

    Parameters
    ----------
    y : output, shape (n,), finite
    group : bin of each row, shape (n,)
    seed : of the permutations
    noise : whether to estimate the noise

    Returns
    -------
    Median over the bins of the Kolmogorov-Smirnov distance between the output in the bin and in all rows, and the
    value below which an inert factor stays in 95 % of cases (60 permutations).
    """
    order = np.argsort(y, kind="stable")
    value = float(_distances(y[order], group[order][None], np.ones((1, len(y))))[0])
    if not noise:
        return value, np.nan
    if len(group) <= NOISE_ROWS:
        return value, _noise(y[order], group, seed)
    share = np.bincount(group) * (NOISE_ROWS / len(group))
    shrink = np.sqrt(NOISE_ROWS / len(y))  # the noise of a distance falls as one over the root of the rows
    return value, _noise_of_sizes(tuple(np.diff(np.round(np.cumsum(share)), prepend=0).astype(int)), seed) * shrink


def _noise(ranked: np.ndarray, group: np.ndarray, seed: int) -> float:
    """Return the value of PAWN that 95 % of 60 permutations of the groups stay below; `ranked`: sorted outputs."""
    rng = np.random.default_rng(seed)
    drawn = np.stack([rng.permutation(group) for _ in range(60)])
    return float(np.percentile(_distances(ranked, drawn, np.ones((1, len(group)))), 95))


@lru_cache(maxsize=64)
def _noise_of_sizes(sizes: tuple[int, ...], seed: int) -> float:
    """Return the noise of groups of these sizes where no outputs are equal; it is the same for every output."""
    return _noise(np.arange(sum(sizes)), np.repeat(np.arange(len(sizes)), sizes), seed)


def pawn_interval(
    y: np.ndarray, group: np.ndarray, value: float, seed: int = 0, resamples: int = 300
) -> tuple[float, float]:
    """Estimate the 95 % interval of a PAWN index by the bootstrap.

    Parameters
    ----------
    y, group, seed : as in `pawn`
    value : the index
    resamples : number of resamples

    Returns
    -------
    Low and high. A long sample is thinned, and its spread is scaled by one over the root of the rows.
    """
    some = thinned(len(y), PAWN_ROWS)
    some = some[np.argsort(y[some], kind="stable")]
    picks = np.random.default_rng(seed).integers(0, len(some), (resamples, len(some)))
    weight = np.stack([np.bincount(pick, minlength=len(some)) for pick in picks])
    half = Z * float(np.std(_distances(y[some], group[some][None], weight), ddof=1)) * (len(some) / len(y)) ** 0.5
    return max(0.0, value - half), min(1.0, value + half)


def _distances(y: np.ndarray, group: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Return the median Kolmogorov-Smirnov distance of the groups from all rows, for each set of groups and weights.

    `y`, the sorted outputs, has the shape (n,). `group`, always the same groups in another order, and `weight` have
    the shape (sets, n) or (1, n), and the result has the shape (sets,).

    A group's distribution jumps only at its own rows. Its largest distance from that of all rows therefore lies
    directly before or after the jump at one of its rows, equal outputs taken together.
    """
    small = np.uint16 if group.max() < 2**16 else int  # sorted in linear time
    by_group = np.argsort(group.astype(small), axis=1, kind="stable")
    value, kind = y[by_group], np.sort(group[0])
    other = np.append(True, np.diff(kind) != 0)
    new = np.concatenate([np.full((len(value), 1), True), other[1:] | (np.diff(value, axis=1) != 0)], axis=1)
    last = np.append(new[:, 1:], np.full((len(value), 1), True), axis=1)
    first = np.flatnonzero(other)
    of = np.cumsum(other) - 1
    zero = np.zeros((len(weight), 1))
    every = np.concatenate([zero, np.cumsum(weight, axis=1)], axis=1) / len(y)
    own = np.cumsum(np.take_along_axis(weight, by_group, axis=1), axis=1)
    own = np.concatenate([np.zeros((len(own), 1)), own], axis=1)
    size = np.diff(own[:, np.append(first, len(y))], axis=1)

    def apart(shift: int, side: Literal["left", "right"], where: np.ndarray) -> np.ndarray:
        share = (own[:, shift : len(y) + shift] - own[:, first[of]]) / np.maximum(size, 1)[:, of]
        whole = np.take_along_axis(every, np.searchsorted(y, y, side)[by_group], axis=1)
        return np.where(where, np.abs(share - whole), 0.0)

    jumps = np.maximum(apart(0, "left", new), apart(1, "right", last))
    largest = np.maximum.reduceat(jumps, first, axis=1)
    return np.asarray(np.nanmedian(np.where(size > 0, largest, np.nan), axis=1))


def thinned(rows: int, most: int) -> np.ndarray:
    """Return the rows of a bootstrap.

    Parameters
    ----------
    rows : number of rows of the sample
    most : largest number of rows of the bootstrap

    Returns
    -------
    All rows, or `most` evenly spaced ones.
    """
    return np.linspace(0, rows - 1, min(rows, most)).astype(int)
