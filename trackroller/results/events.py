"""Factors whose levels confine an event of a study, or at whose levels it is most and least frequent."""

from __future__ import annotations

from typing import Any

import numpy as np

from trackroller.results.groups import MOST_LEVELS
from trackroller.results.results import Results

FEW = 20  # with fewer cases, the share of an event at a level is not looked at


def meets(results: Results, name: str, levels: Any) -> np.ndarray:
    """Mark the cases at one of the levels (a list), or within the bounds (a pair), shape (n,) bool."""
    column = results.table[name]
    if isinstance(levels, tuple):
        return column.between(*levels).to_numpy(bool)
    return column.isin(levels).to_numpy(bool)


def confining(results: Results, hit: np.ndarray, among: np.ndarray) -> list[tuple[str, Any]]:
    """Return at most three factors whose levels confine an event, sorted by the cases that they leave out."""
    by_loss = []
    for name in results.factors:
        own = results.table[name].to_numpy()
        if results.ordered(name) and len(results.levels(name)) > MOST_LEVELS:
            low, high = float(own[hit].min()), float(own[hit].max())
            levels: Any = (_outwards(low, -1), _outwards(high, 1))
        else:
            there = set(own[hit].tolist())
            levels = [v for v in results.levels(name) if v in there]
        outside = among & ~meets(results, name, levels)
        if outside.sum() >= 0.1 * among.sum():
            by_loss.append((int(outside.sum()), name, levels))
    return [(name, levels) for _, name, levels in sorted(by_loss, key=lambda item: -item[0])[:3]]


def _outwards(value: float, way: int) -> float:
    """Round to three figures so that the value stays inside the bound."""
    if value == 0:
        return 0.0
    step = 10.0 ** (np.floor(np.log10(abs(value))) - 2)
    turned = (np.floor if way < 0 else np.ceil)(value / step + way * 1e-9) * step
    return float(f"{turned:.3g}")


def most_frequent(
    results: Results, hit: np.ndarray, among: np.ndarray
) -> tuple[str, tuple[Any, int, int], tuple[Any, int, int]] | None:
    """Return the factor whose levels differ most in the share of hits, and the levels of its largest and least share.

    Each level comes with its number of hits and its number of rows among `among`. The order of the two levels must be
    the same within every category.
    """
    best = None
    for name in results.factors:
        levels = results.levels(name)
        if len(levels) > MOST_LEVELS:
            continue
        own = results.table[name].to_numpy()
        cells = [(v, int((hit & (own == v)).sum()), int((among & (own == v)).sum())) for v in levels]
        cells = [cell for cell in cells if cell[2] >= FEW]
        if len(cells) < 2:
            continue
        high, low = max(cells, key=lambda c: c[1] / c[2]), min(cells, key=lambda c: c[1] / c[2])
        gap = high[1] / high[2] - low[1] / low[2]
        noise = 3 * np.sqrt(sum(k * (n - k) / n**3 for _, k, n in (high, low)))
        if (
            gap > max(noise, 0.1)
            and (best is None or gap > best[0])
            and _shared(results, name, hit, among, (high, low))
        ):
            best = gap, name, high, low
    return None if best is None else best[1:]


def _shared(results: Results, name: str, hit: np.ndarray, among: np.ndarray, ends: tuple[Any, ...]) -> bool:
    """Return whether the order of two levels is the same within every category (otherwise: Simpson's paradox)."""
    own = results.table[name].to_numpy()
    for category in (c for c in results.categories if c != name):
        values = results.table[category].to_numpy()
        for level in results.levels(category):
            inside = among & (values == level)
            cells = [inside & (own == end[0]) for end in ends]
            if all(c.any() for c in cells) and hit[cells[0]].mean() < hit[cells[1]].mean():
                return False
    return True
