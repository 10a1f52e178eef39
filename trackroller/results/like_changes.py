"""The effect of a factor by the changes between like cases, which differ in this factor alone."""

from __future__ import annotations

import numpy as np
from scipy.sparse.csgraph import connected_components

FEWEST_CHANGES = 3  # from which on they give a curve


def effect_of_changes(
    y: np.ndarray, place: np.ndarray, group: np.ndarray, values: np.ndarray | None
) -> tuple[np.ndarray, np.ndarray] | None:
    """Return how an output changes with the levels of a factor, by changes inside groups of cases.

    Parameters
    ----------
    y : output on the scale on which effects add up, shape (n,)
    place : number of the level of each case, shape (n,); each level has a case
    group : number of the group of each case, shape (n,); the cases of a group are alike but for the
        factor
    values : levels of a number, shape (levels,); None of names, which have no scale

    Returns
    -------
    The effect at each level, shape (levels,), and what each group with a change has beside it,
    shape (groups,); None where less than three changes are known, or they leave levels apart.

    Notes
    -----
    y = a_group + effect(level), by least squares. The changes of a screening design skip levels, so
    that they may leave two sets of levels apart. The effect of a number is a parabola then, or a
    line.

    Examples
    --------
    >>> effect, beside = effect_of_changes(
    ...     np.array([1.0, 3.0, 5.0, 7.0, 2.0, 4.0]),
    ...     np.array([0, 1, 0, 1, 0, 1]),
    ...     np.array([0, 0, 1, 1, 2, 2]),
    ...     None,
    ... )
    >>> round(float(effect[1] - effect[0]), 9)
    2.0
    """
    count = int(place.max(initial=-1)) + 1
    several = _levels_of_groups(place, group)[group] > 1
    changes = several.sum() - len(np.unique(group[several]))
    if count < 2 or changes < FEWEST_CHANGES:
        return None
    own = np.unique(group[several], return_inverse=True)[1]
    for basis in _bases(count, values, _connected(place, group, count)):
        columns = basis[place[several]]
        inside = columns - _means(columns, own)[own]
        if np.linalg.matrix_rank(inside) < basis.shape[1]:
            continue
        target = y[several][:, None]
        weights = np.linalg.lstsq(inside, (target - _means(target, own)[own])[:, 0], rcond=None)[0]
        effect = basis @ weights
        beside = _means((y[several] - effect[place[several]])[:, None], own)[:, 0]
        return effect, beside
    return None


def _levels_of_groups(place: np.ndarray, group: np.ndarray) -> np.ndarray:
    """Return the number of different levels in each group, shape (groups,)."""
    pairs = np.unique(np.stack([group, place]), axis=1)
    return np.bincount(pairs[0], minlength=int(group.max(initial=-1)) + 1)


def _connected(place: np.ndarray, group: np.ndarray, count: int) -> bool:
    """Return whether steps that at least three groups have lead from one level to all others."""
    there = np.zeros((int(group.max()) + 1, count))
    there[group, place] = 1.0
    often = (there.T @ there) >= FEWEST_CHANGES
    return bool(connected_components(often, directed=False)[0] == 1)


def _bases(count: int, values: np.ndarray | None, connected: bool) -> list[np.ndarray]:
    """Return functions of the levels to be tried, shape (levels, functions) each: an effect of its
    own at each level; of a number whose levels few changes connect a parabola, then a line.
    """
    free = np.eye(count)[:, 1:]
    if connected or values is None or not np.isfinite(values).all():
        return [free]
    share = (values - values.min()) / np.ptp(values)
    return [np.stack([share, share**2], axis=1), share[:, None]]


def _means(columns: np.ndarray, group: np.ndarray) -> np.ndarray:
    """Return the mean of columns over each group, shape (groups, columns)."""
    number = np.bincount(group)
    sums = [np.bincount(group, weights=column) for column in columns.T]
    return np.stack(sums, axis=1) / number[:, None]
