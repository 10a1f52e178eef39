"""Borgonovo's delta from given data: how far knowing a factor moves the whole distribution of an output.

delta = E[ integral |f(y) - f(y | x)| dy ] / 2, between 0 (no influence) and 1. It is the total variation distance of
the pair (x, y) from a pair without a link, so that no transformation of x or y changes it: here both are ranks, or
the values of a list. That distance is also how far the best rule tells linked pairs from unlinked ones:
max over s = -1, 1 of (E_linked[s] - E_unlinked[s]) / 2. The rule is the sign of a smoothed difference of densities,
its width the one that tells best.

A rule tried on rows it was not made from gives too little (its sign is wrong here and there), one tried on its own
rows too much. The estimate is the first plus half the gap times sqrt(first / second): the middle of the two for a
clear influence, the first alone, which errs to neither side, for an inert factor.

References: Borgonovo (2007), Reliab. Eng. Syst. Saf. 92, 771-784 (the measure, its invariance); Plischke, Borgonovo &
Smith (2013), Eur. J. Oper. Res. 226, 536-550 (from given data); Sriperumbudur et al. (2012), Electron. J. Stat. 6,
1550-1599 (total variation as the risk of a classifier).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from trackroller.analysis.indices import Z

FEW = 10  # different values up to which a column is a list: nothing is smoothed along it
CELLS_X, CELLS_Y = 64, 96  # of ranks
WIDTHS = (0.01, 0.03, 0.08, 0.2)  # of the smoothing, in ranks from 0 to 1
FOLDS, ROUNDS = 10, 2  # parts of which one is tried and the others make the rule; how often they are dealt
CHANCE = 1.15  # times root(1 / rows): what the estimate of an inert factor stays below in 95 of 100 samples


def delta(y: np.ndarray, x: np.ndarray, ordered: bool = True, seed: int = 0) -> tuple[float, float, float, float]:
    """Delta with its 95 % interval, and the value that an inert factor stays below in 95 % of cases.

    Parameters
    ----------
    y : output, shape (n,), finite
    x : factor, shape (n,): numbers, or codes of categories
    ordered : do more and less of `x` mean something? Else nothing is smoothed along it
    seed : of the dealing into parts

    Returns
    -------
    delta, low, high, noise [1]. The interval holds the scatter from sample to sample and the gap between what the rule
    tells of others' rows and of its own, which is what smoothing leaves open.
    """
    place_x, count_x, smooth_x = _cells(x, CELLS_X, ordered)
    place_y, count_y, smooth_y = _cells(y, CELLS_Y, True)
    shape, rows = (count_x, count_y), len(y)
    kernels = _kernels(count_x, smooth_x), _kernels(count_y, smooth_y)
    rng = np.random.default_rng(seed)
    tried, own = np.zeros(1), np.zeros(1)
    for _ in range(ROUNDS):
        part = rng.permutation(rows) % FOLDS
        counts = np.bincount((part * count_x + place_x) * count_y + place_y, minlength=FOLDS * count_x * count_y)
        some, own = _told(counts.reshape(FOLDS, *shape).astype(float), *kernels)
        tried = tried + some / ROUNDS
    best = int(np.argmax(tried))
    least, most = float(tried[best]), float(own[best])
    link = min(1.0, max(0.0, least) / max(most, 1e-300)) ** 0.5
    gap = 0.5 * link * max(0.0, most - least)
    middle = min(1.0, max(0.0, least + gap))
    free = min(1.0, 2 * _different(place_x), 2 * _different(place_y)) ** 0.5
    error = 0.5 * free * max(0.0, 1 - middle**2) ** 0.5 / rows**0.5
    half = float(np.hypot(Z * error, 2 * gap))
    return middle, max(0.0, middle - half), min(1.0, middle + half), CHANCE * free / rows**0.5


def _cells(values: np.ndarray, count: int, ordered: bool) -> tuple[np.ndarray, int, bool]:
    """Cell of each row, number of cells, and whether neighbouring cells may be smoothed into each other."""
    different, index = np.unique(values, return_inverse=True)
    if len(different) <= FEW or not ordered:
        return index, len(different), False
    place = np.empty(len(values), dtype=int)
    place[np.argsort(values, kind="stable")] = np.arange(len(values)) * count // len(values)
    first = np.full(len(different), count)
    np.minimum.at(first, index, place)  # equal values stay together
    return first[index], count, True


@lru_cache(maxsize=8)
def _kernels(count: int, smooth: bool) -> tuple[np.ndarray, ...]:
    """Smoothing matrices, one a width; the one that changes nothing for a list."""
    if not smooth:
        return (np.eye(count),)
    at = (np.arange(count) + 0.5) / count
    return tuple(np.exp(-0.5 * ((at[:, None] - at) / width) ** 2) for width in WIDTHS)


def _told(
    counts: np.ndarray, along_x: tuple[np.ndarray, ...], along_y: tuple[np.ndarray, ...]
) -> tuple[np.ndarray, np.ndarray]:
    """What rules of each width tell of rows they were not made from, and of their own; counts (parts, x, y)."""
    whole, size = counts.sum(axis=0), counts.sum(axis=(1, 2))[:, None, None]
    rows = whole.sum()
    unlinked = whole.sum(axis=1)[:, None] * whole.sum(axis=0) / rows**2
    made, new, all_in = (whole - counts) / (rows - size) - unlinked, counts - size * unlinked, whole / rows - unlinked
    tried, own = [], []
    for kernel in along_x:
        rule, full = kernel @ made, kernel @ all_in
        for other in along_y:
            tried.append(float((np.sign(rule @ other) * new).sum() / (2 * rows)))
            own.append(float((np.sign(full @ other) * all_in).sum() / 2))
    return np.array(tried), np.array(own)


def _different(place: np.ndarray) -> float:
    """Chance that two rows lie in different cells."""
    return float(1 - ((np.bincount(place) / len(place)) ** 2).sum())
