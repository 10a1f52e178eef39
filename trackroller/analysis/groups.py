"""Groups of cases along a factor: one group a level, or groups of equal size where the levels are many."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from trackroller.analysis.table import MOST_LEVELS, StudyView

BINS = 8  # groups of a factor with more than `MOST_LEVELS` levels
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
    """Return whether positive numbers spread by a factor above `least`, closer to evenly by ratio than by difference.

    The median of such numbers lies nearer to the geometric than to the arithmetic mean of their ends, as on a
    logarithmic axis. Uniform numbers belong on a linear axis.
    """
    finite = values[np.isfinite(values)]
    if not finite.size or finite.min() <= 0 or finite.max() <= least * finite.min():
        return False
    low, middle, high = (float(v) for v in np.quantile(finite, (0.0, 0.5, 1.0)))
    return bool(middle < 0.5 * ((low * high) ** 0.5 + 0.5 * (low + high)))


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
    return Groups(name, index, low, high, at, ordered)


def drives(view: StudyView) -> Groups:
    """Sort the cases into free rolling, driven and braked ones; each level is a group where there are up to three."""
    if len(view.levels(DRIVE)) <= 3:
        return groups(view, DRIVE)
    force = view.column(DRIVE)
    signs, index = np.unique(np.sign(force), return_inverse=True)
    own = [force[index == k] for k in range(len(signs))]
    low, high = (tuple(float(end(forces)) for forces in own) for end in (np.min, np.max))
    return Groups(DRIVE, index, low, high, np.arange(len(signs), dtype=float), False)
