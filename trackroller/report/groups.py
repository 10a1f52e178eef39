"""Groups of cases along a factor: one group a level, or groups of equal size where the levels are many."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from trackroller.report.numbers import level_text, long_name, number, rounded, setting, short_levels
from trackroller.report.view import MOST_LEVELS, StudyView

BINS = 8  # groups of a factor with more than `MOST_LEVELS` levels
COLOURS = 5  # most groups that get a colour each
DRIVE = "motor_force"


@dataclass(frozen=True)
class Groups:
    """Cases in groups along a factor.

    Attributes
    ----------
    name : name of the factor
    index : group of each case, shape (n,)
    low, high : ends of each group; both are the level where a group is a level
    at : place of each group on an axis: its median, or its number where the factor has no order
    texts : level or range of each group in words
    ordered : whether the groups have an order
    """

    name: str
    index: np.ndarray
    low: tuple[Any, ...]
    high: tuple[Any, ...]
    at: np.ndarray
    texts: tuple[str, ...]
    ordered: bool

    def __len__(self) -> int:
        return len(self.texts)


def classes(view: StudyView, name: str, rows: np.ndarray, most: int | None) -> tuple[np.ndarray, list[Any]]:
    """Sort rows into the factor's own levels, or into `most` classes of equally many rows where it has many levels.

    Returns
    -------
    Index of the class of each of the chosen rows, shape (rows.sum(),), and per class its level or its ends (low, high).
    """
    values, levels = view.table[name].to_numpy()[rows], view.levels(name)
    if most is None or not view.numeric(name) or len(levels) <= MOST_LEVELS:
        place = {v: i for i, v in enumerate(levels)}
        return np.array([place.get(v, 0) for v in values], dtype=int), list(levels)
    edges = np.unique(np.quantile(values, np.linspace(0, 1, most + 1), method="nearest"))
    index = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, max(len(edges) - 2, 0))
    kinds, index = np.unique(index, return_inverse=True)
    return index, [(float(values[index == k].min()), float(values[index == k].max())) for k in range(len(kinds))]


def groups(view: StudyView, name: str, rows: np.ndarray | None = None, most: int = BINS) -> Groups:
    """Sort the chosen cases (all if `rows` is not given) into groups along a factor."""
    rows = np.ones(len(view.table), dtype=bool) if rows is None else rows
    index, ends = classes(view, name, rows, most)
    low, high = zip(*(end if isinstance(end, tuple) else (end, end) for end in ends), strict=True)
    at, own = np.arange(len(ends), dtype=float), view.table[name].to_numpy()[rows]
    if ordered := view.ordered(name):
        at = np.array([np.median(own[index == k]) if (index == k).any() else np.nan for k in range(len(ends))])
    texts = short_levels([span(name, *pair) for pair in zip(low, high, strict=True)])
    return Groups(name, index, low, high, at, tuple(texts), ordered)


def span(name: str, low: Any, high: Any) -> str:
    """Return a level, or a range in three figures, in words."""
    if isinstance(low, str) or low == high:
        return level_text(name, low)
    return f"{number(float(f'{low:.3g}'))} to {level_text(name, float(f'{high:.3g}'), words=False)}"


def class_words(name: str, end: Any) -> str:
    """Write a level of a factor, or the ends (low, high) of a class, with the name of a factor that needs it."""
    if isinstance(end, tuple):
        return f"{long_name(name)} {span(name, *end)}"
    return level_text(name, end) if isinstance(end, str) else setting(name, end)


def coloured(view: StudyView, lead: str, rows: np.ndarray) -> list[tuple[str, np.ndarray]]:
    """Return each level (or third) of the deciding factor in words, and which of the chosen rows have it.

    Parameters
    ----------
    rows : the chosen cases, shape (n,) bool
    """
    index, ends = classes(view, lead, rows, 3)
    present = [k for k in range(len(ends)) if (index == k).any()]
    if len(present) > COLOURS:  # of many levels show the lowest, the highest and some between
        chosen = np.unique(np.linspace(0, len(present) - 1, COLOURS).round().astype(int))
        present = [present[k] for k in chosen]
    return [(class_words(lead, ends[k]), index == k) for k in present]


def drives(view: StudyView) -> Groups:
    """Sort the cases into free rolling, driven and braked ones; each level is a group where there are up to three."""
    if len(view.levels(DRIVE)) <= 3:
        return groups(view, DRIVE)
    force = view.column(DRIVE)
    signs, index = np.unique(np.sign(force), return_inverse=True)
    texts = []
    for sign in signs:
        own = np.abs(force[np.sign(force) == sign])
        way = {-1.0: "driven", 0.0: "free rolling", 1.0: "braked"}[sign]
        low, high = (rounded(float(v), 2) for v in (own.min(), own.max()))
        texts.append(way if sign == 0 else f"{way}, {low} N" if low == high else f"{way}, {low} to {high} N")
    ends = tuple(signs.tolist())
    return Groups(DRIVE, index, ends, ends, np.arange(len(signs), dtype=float), tuple(texts), False)
