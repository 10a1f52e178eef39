"""Levels of a factor, and groups of cases along it: one group a level, or groups of equal size of
many levels.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import permutations
from typing import Any

import numpy as np
import pandas as pd

from trackroller.study.design.levels import NAMED

MOST_LEVELS = 12  # a factor with more levels is divided into classes
BINS = 8  # groups of a factor with more than `MOST_LEVELS` levels
DRIVE = "motor_force"


def levels(values: pd.Series) -> list[Any]:
    """List the values of a factor: numbers in rising order, categories in order of appearance."""
    known = values.dropna().unique()
    if numeric(values):
        return sorted(known.tolist())
    return list(known)


def numeric(values: pd.Series) -> bool:
    """Return whether a factor is a number."""
    return bool(np.issubdtype(np.asarray(values).dtype, np.number))


def ordered(values: pd.Series) -> bool:
    """Return whether the levels of a factor have an order; materials, few drives and few curves
    have none.
    """
    spoken = values.name in NAMED and len(levels(values)) <= MOST_LEVELS
    return numeric(values) and not spoken and bool(np.isfinite(values).all())


@dataclass(frozen=True)
class Groups:
    """Cases in groups along a factor.

    Attributes
    ----------
    name : name of the factor
    index : group of each case, shape (n,)
    low, high : ends of each group; both are the level where a group is a level
    at : place of each group on an axis: its median, or its number where the factor has no order
    ordered : whether the groups have an order
    """

    name: str
    index: np.ndarray
    low: tuple[Any, ...]
    high: tuple[Any, ...]
    at: np.ndarray
    ordered: bool

    def __len__(self) -> int:
        return len(self.low)


def spaced_by_ratio(values: np.ndarray, least: float) -> bool:
    """Return whether positive numbers spread by a factor above `least`, closer to evenly by ratio
    than by difference.

    The median of such numbers lies nearer to the geometric than to the arithmetic mean of their
    ends, as on a logarithmic axis. Uniform numbers belong on a linear axis.
    """
    finite = values[np.isfinite(values)]
    if not finite.size or finite.min() <= 0 or finite.max() <= least * finite.min():
        return False
    low, middle, high = (float(v) for v in np.quantile(finite, (0.0, 0.5, 1.0)))
    return bool(middle < 0.5 * ((low * high) ** 0.5 + 0.5 * (low + high)))


def classes(
    table: pd.DataFrame, name: str, rows: np.ndarray, most: int | None
) -> tuple[np.ndarray, list[Any]]:
    """Sort rows into the factor's own levels, or into `most` classes of equally many rows where it
    has many levels.

    Returns
    -------
    Index of the class of each of the chosen rows, shape (rows.sum(),), and per class its level or
    its ends (low, high).
    """
    values = table[name].to_numpy()[rows]
    known = levels(table[name])
    if most is None or not numeric(table[name]) or len(known) <= MOST_LEVELS:
        place = {v: i for i, v in enumerate(known)}
        return np.array([place.get(v, 0) for v in values], dtype=int), known
    edges = np.unique(np.quantile(values, np.linspace(0, 1, most + 1), method="nearest"))
    index = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, max(len(edges) - 2, 0))
    kinds, index = np.unique(index, return_inverse=True)
    return index, [
        (float(values[index == k].min()), float(values[index == k].max()))
        for k in range(len(kinds))
    ]


def groups(
    table: pd.DataFrame, name: str, rows: np.ndarray | None = None, most: int = BINS
) -> Groups:
    """Sort the chosen cases (all if `rows` is not given) into groups along a factor."""
    if rows is None:
        rows = np.ones(len(table), dtype=bool)
    index, ends = classes(table, name, rows, most)
    intervals = [end if isinstance(end, tuple) else (end, end) for end in ends]
    low, high = zip(*intervals, strict=True)
    in_order = ordered(table[name])
    if not in_order:
        return Groups(name, index, low, high, np.arange(len(ends), dtype=float), in_order)
    own = table[name].to_numpy()[rows]
    medians = np.full(len(ends), np.nan)
    for k in range(len(ends)):
        members = own[index == k]
        if members.size:
            medians[k] = np.median(members)
    return Groups(name, index, low, high, medians, in_order)


def drives(table: pd.DataFrame) -> Groups:
    """Sort the cases into free rolling, driven and braked ones; each level is a group where there
    are up to three.
    """
    if len(levels(table[DRIVE])) <= 3:
        return groups(table, DRIVE)
    force = table[DRIVE].to_numpy(dtype=float)
    signs, index = np.unique(np.sign(force), return_inverse=True)
    own = [force[index == k] for k in range(len(signs))]
    low, high = (tuple(float(end(forces)) for forces in own) for end in (np.min, np.max))
    return Groups(DRIVE, index, low, high, np.arange(len(signs), dtype=float), False)


@dataclass(frozen=True)
class Product:
    """Every level of a factor combined with every level of another one.

    Attributes
    ----------
    levels : levels by factor
    count, of : cases in which an event occurs, and all cases at these levels
    """

    levels: Mapping[str, tuple[Any, ...]]
    count: int
    of: int


def confined(
    table: pd.DataFrame,
    names: Sequence[str],
    hit: np.ndarray,
    among: np.ndarray,
    most: int,
    whole: bool = False,
) -> list[Product]:
    """Return at most `most` products of levels of two factors that together hold every case of an
    event.

    Parameters
    ----------
    table : one row a case
    names : factors with few levels; of equal descriptions that by the first ones counts
    hit, among : the cases of the event, and all cases that count, shape (n,) bool
    most : number of products
    whole : whether the event must occur in all cases of the products, otherwise in at least half of
        them

    Returns
    -------
    The products with as few other cases as possible, those with the event in all cases first;
    nothing if no two factors confine the event better than one of them.
    """
    coded = {name: pd.factorize(table[name][among]) for name in names}
    best: list[Product] = []
    own = hit[among]
    rank = (np.inf, np.inf)
    for one, other in permutations(names, 2):
        (a, firsts), (b, others) = coded[one], coded[other]
        shape = len(firsts), len(others)
        cell = a * shape[1] + b
        of, hits = (
            np.bincount(cell, w, shape[0] * shape[1]).reshape(shape) for w in (np.ones(len(a)), own)
        )
        there = hits > 0
        full = (hits > 0) & (hits == of)
        inside = of[there].sum()
        alone = min(of[there.any(axis=1)].sum(), of[:, there.any(axis=0)].sum())
        if inside >= alone or 2 * hits.sum() < inside or (whole and (there & ~full).any()):
            continue
        merged: dict[tuple[int, ...], list[int]] = {}
        for i in np.flatnonzero(full.any(axis=1)).tolist():
            merged.setdefault(tuple(np.flatnonzero(full[i]).tolist()), []).append(i)
        blocks = [*((rows, list(columns)) for columns, rows in merged.items())]
        blocks += [([i], [j]) for i, j in np.argwhere(there & ~full).tolist()]
        if len(blocks) <= most and (inside, len(blocks)) < rank:
            best = []
            rank = (inside, len(blocks))
            for rows, columns in blocks:
                at = np.ix_(rows, columns)
                levels_of_pair = {one: _in_order(firsts[rows]), other: _in_order(others[columns])}
                best.append(Product(levels_of_pair, int(hits[at].sum()), int(of[at].sum())))
    return sorted(best, key=lambda product: -product.count / product.of)


def _in_order(values: Any) -> tuple[Any, ...]:
    """Return levels as plain values, numbers in rising order."""
    return tuple(levels(pd.Series(values)))
