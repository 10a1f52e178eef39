"""A sample of a large study that keeps every state, every extreme and the Pareto set of the study's own goals."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

RARE = 1_000  # all cases of a state are kept if it has at most so many cases


def sample_rows(state: np.ndarray, keep: np.ndarray, most: int, seed: int = 1) -> np.ndarray:
    """Choose the cases to show.

    Parameters
    ----------
    state : stratum of each case, such as its regime and validity, shape (n,) int
    keep : cases that are always shown, shape (n,) bool
    most : number of cases to choose
    seed : seed of the random choice

    Returns
    -------
    Rising row numbers: all rows if there are at most `most`. Otherwise the cases of `keep`, all cases of rare states,
    and a random part of each other state in proportion to its number of cases.
    """
    if len(state) <= most:
        return np.arange(len(state))
    rng = np.random.default_rng(seed)
    chosen = keep.copy()
    strata, counts = np.unique(state[~keep], return_counts=True)
    rare = strata[counts <= RARE]
    chosen |= np.isin(state, rare)
    left = max(0, most - int(chosen.sum()))
    rest = int(counts[counts > RARE].sum())
    for stratum, cases in zip(strata, counts, strict=True):
        if cases > RARE:
            rows = np.flatnonzero((state == stratum) & ~keep)
            share = min(cases, max(RARE, left * cases // rest))
            chosen[rng.choice(rows, int(share), replace=False)] = True
    return np.flatnonzero(chosen)


def extreme_rows(state: np.ndarray, columns: Iterable[np.ndarray]) -> np.ndarray:
    """Mark the cases with the smallest and the largest value of each column in each state.

    Parameters
    ----------
    state : state of each case, shape (n,)
    columns : numbers, shape (n,) each; values that are not finite do not count

    Returns
    -------
    Shape (n,) bool.
    """
    marked = np.zeros(len(state), dtype=bool)
    groups = [np.flatnonzero(state == one) for one in np.unique(state)]
    for values in columns:
        for rows in groups:
            known = rows[np.isfinite(values[rows])]
            if known.size:
                marked[[known[np.argmin(values[known])], known[np.argmax(values[known])]]] = True
    return marked
