"""Levels of a factor, groups of cases and held factors in words, for figures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from trackroller.report.numbers import level_text, long_name, number, rounded, setting
from trackroller.results.factor_levels import DRIVE, classes
from trackroller.results.results import Results

COLOURS = 5  # most groups that get a colour each


def short_levels(names: Sequence[str]) -> list[str]:
    """Drop the part of names of pairs that all pairs share, because it does not distinguish
    them.
    """
    parts = [_parts(name) for name in names]
    if len(set(names)) > 1 and all(len(p) == 2 for p in parts):
        for keep in (0, 1):
            if len({p[1 - keep] for p in parts}) == 1:
                return [p[keep] for p in parts]
    return list(names)


def material_of_level(text: str) -> str:
    """Return the material that a level names, of a pair that of the roller."""
    return _parts(text)[0]


def _parts(name: str) -> list[str]:
    if name.endswith(" on itself"):
        return [name.removesuffix(" on itself")] * 2
    if " / " in name:
        return name.split(" / ")
    return name.split(" on ")


def _drive(low: float, high: float) -> str:
    """Return 'driven −30 N' for one motor force, 'driven, 10 to 30 N' for several of one sign."""
    if low == high:
        return level_text(DRIVE, low)
    least, most = sorted((abs(low), abs(high)))
    way = "braked"
    if low < 0:
        way = "driven"
    return f"{way}, {rounded(least, 2)} to {rounded(most, 2)} N"


def held_words(levels: Mapping[str, Any]) -> str:
    """State the levels at which factors are held; an empty text if no factor is held."""
    if levels:
        return f"Held: {'; '.join(setting(name, level) for name, level in levels.items())}."
    return ""


def span(name: str, low: Any, high: Any) -> str:
    """Return a level, or a range in three figures, in words."""
    if isinstance(low, str) or low == high:
        return level_text(name, low)
    return f"{number(float(f'{low:.3g}'))} to {level_text(name, float(f'{high:.3g}'), words=False)}"


def class_words(name: str, end: Any) -> str:
    """Write a level of a factor, or the ends (low, high) of a class, with the name of a factor that
    needs it.
    """
    if isinstance(end, tuple):
        return f"{long_name(name)} {span(name, *end)}"
    if isinstance(end, str):
        return level_text(name, end)
    return setting(name, end)


def coloured(results: Results, lead: str, rows: np.ndarray) -> list[tuple[str, np.ndarray]]:
    """Return each level (or third) of the deciding factor in words, and which of the chosen rows
    have it.

    Parameters
    ----------
    rows : the chosen cases, shape (n,) bool
    """
    index, ends = classes(results.table, lead, rows, 3)
    present = [k for k in range(len(ends)) if (index == k).any()]
    if len(present) > COLOURS:  # of many levels show the lowest, the highest and some between
        chosen = np.unique(np.linspace(0, len(present) - 1, COLOURS).round().astype(int))
        present = [present[k] for k in chosen]
    return [(class_words(lead, ends[k]), index == k) for k in present]
