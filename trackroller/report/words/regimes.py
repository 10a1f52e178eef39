"""Sentences on regimes and other events: how often they occur, and at which levels of the factors."""

from __future__ import annotations

from typing import Any

import numpy as np

from trackroller.analysis.table import MOST_LEVELS, StudyView
from trackroller.report.numbers import count, level_text, listing, long_name, number, setting, share
from trackroller.report.words.levels import at_least, at_most
from trackroller.report.words.sentence import Sentence

FEW = 20  # fewer events without a common level or range are named one by one, without a cause


def occurrence(view: StudyView, hit: np.ndarray, what: str, among: np.ndarray | None = None) -> Sentence | None:
    """Say how often an event occurs and at which levels of the factors.

    None if it never does.

    Parameters
    ----------
    hit : whether the event occurs, shape (n,) bool
    what : the event as the subject of the sentence, 'Full slip'
    among : the cases that are looked at, shape (n,) bool; all if not given
    """
    among = np.ones(len(hit), dtype=bool) if among is None else among
    hit, whole, cases = hit & among, int(among.sum()), int((hit & among).sum())
    if not cases:
        return None
    values: dict[str, Any] = {"count": cases, "of": whole}
    if cases == whole:
        return Sentence("everywhere", f"{what} occurs in all {count(whole)} cases.", values, among)
    head = f"{what} occurs in {count(cases)} of {count(whole)} cases ({share(cases, whole)})"
    only = _confined(view, hit, among)
    inside = among.copy()
    for name, levels in only:
        inside &= meets(view, name, levels)
    met = int(inside.sum())
    # few events may share levels by chance, unless all cases at these levels have the event
    common = met == cases and all(isinstance(levels, list) for _, levels in only)
    if only and (cases >= FEW or common):
        there = "all" if met == cases else f"{count(cases)} of the {count(met)}"
        text = f"{head}, only {_places(view, only)}: in {there} cases there."
        return Sentence("only", text, values | {"conditions": only, "inside": met}, among)
    if cases < FEW:
        named = [int(i) for i in np.flatnonzero(hit)]
        text = f"{what} occurs in {cases} of {count(whole)} cases ({listing([str(i) for i in named])})"
        shared = [(n, own) for n, own in only if isinstance(own, list) and len(own) == 1] if cases > 1 else []
        where = f", only {_places(view, shared)}" if shared else ""
        return Sentence("cases", f"{text}{where}.", values | {"cases": named, "conditions": shared}, among)
    most = _most_frequent(view, hit, among)
    if most is None:
        return Sentence("share", f"{head}.", values, among)
    name, high, low = most
    levels_said = [f"{setting(name, level)} ({count(k)} of {count(n)} cases)" for level, k, n in (high, low)]
    text = f"{head}, most often at {levels_said[0]} and least at {levels_said[1]}."
    return Sentence("frequent", text, values | {"factor": name, "most": high, "least": low}, among)


def meets(view: StudyView, name: str, levels: Any) -> np.ndarray:
    """Mark the cases at one of the levels (a list), or within the bounds (a pair), shape (n,) bool."""
    column = view.table[name]
    if isinstance(levels, tuple):
        return ((column >= levels[0]) & (column <= levels[1])).to_numpy()
    return column.isin(levels).to_numpy()


def _confined(view: StudyView, hit: np.ndarray, among: np.ndarray) -> list[tuple[str, Any]]:
    """Return at most three factors whose levels confine an event, sorted by the cases that they leave out."""
    confining = []
    for name in view.factors:
        own = view.table[name].to_numpy()
        if view.ordered(name) and len(view.levels(name)) > MOST_LEVELS:
            low, high = float(own[hit].min()), float(own[hit].max())
            levels: Any = (_outwards(low, -1), _outwards(high, 1))
        else:
            there = set(own[hit].tolist())
            levels = [v for v in view.levels(name) if v in there]
        outside = among & ~meets(view, name, levels)
        if outside.sum() >= 0.1 * among.sum():
            confining.append((int(outside.sum()), name, levels))
    return [(name, levels) for _, name, levels in sorted(confining, key=lambda item: -item[0])[:3]]


def _outwards(value: float, way: int) -> float:
    """Round to three figures so that the value stays inside the bound."""
    if value == 0:
        return 0.0
    step = 10.0 ** (np.floor(np.log10(abs(value))) - 2)
    turned = (np.floor if way < 0 else np.ceil)(value / step + way * 1e-9) * step
    return float(f"{turned:.3g}")


def _places(view: StudyView, conditions: list[tuple[str, Any]]) -> str:
    return listing([f"at {_levels_words(view, name, levels)}" for name, levels in conditions])


def _levels_words(view: StudyView, name: str, levels: Any) -> str:
    if isinstance(levels, tuple):
        own = view.table[name]
        low, high = levels
        if low <= own.min():
            return at_most(name, high, own.min())
        if high >= own.max():
            return at_least(name, low, own.max())
        return f"{long_name(name)} {number(low)} to {level_text(name, high, words=False)}"
    first = setting(name, levels[0])
    return listing([first, *(level_text(name, v) for v in levels[1:])], "or")


def _most_frequent(
    view: StudyView, hit: np.ndarray, among: np.ndarray
) -> tuple[str, tuple[Any, int, int], tuple[Any, int, int]] | None:
    """Return the factor whose levels differ most in the share of hits, and the levels of its largest and least share.

    Each level comes with its number of hits and its number of rows among `among`. The order of the two levels must be
    the same within every category.
    """
    best = None
    for name in view.factors:
        levels = view.levels(name)
        if len(levels) > MOST_LEVELS:
            continue
        own = view.table[name].to_numpy()
        cells = [(v, int((hit & (own == v)).sum()), int((among & (own == v)).sum())) for v in levels]
        cells = [cell for cell in cells if cell[2] >= FEW]
        if len(cells) < 2:
            continue
        high, low = max(cells, key=lambda c: c[1] / c[2]), min(cells, key=lambda c: c[1] / c[2])
        gap = high[1] / high[2] - low[1] / low[2]
        noise = 3 * np.sqrt(sum(k * (n - k) / n**3 for _, k, n in (high, low)))
        if gap > max(noise, 0.1) and (best is None or gap > best[0]) and _shared(view, name, hit, among, (high, low)):
            best = gap, name, high, low
    return None if best is None else best[1:]


def _shared(view: StudyView, name: str, hit: np.ndarray, among: np.ndarray, ends: tuple) -> bool:
    """Return whether the order of two levels is the same within every category (otherwise: Simpson's paradox)."""
    own = view.table[name].to_numpy()
    for category in (c for c in view.categories if c != name):
        values = view.table[category].to_numpy()
        for level in view.levels(category):
            inside = among & (values == level)
            cells = [inside & (own == end[0]) for end in ends]
            if all(c.any() for c in cells) and hit[cells[0]].mean() < hit[cells[1]].mean():
                return False
    return True


def lift_off(view: StudyView) -> Sentence | None:
    """Say how many cases lift off and from which axial force on."""
    lifted = view.regime == 2
    axial = np.abs(view.column("axial_force"))
    if not lifted.any() or np.isnan(axial[lifted]).any():
        return None
    cases, least = int(lifted.sum()), float(axial[lifted].min())
    text = f"The smallest axial force at which a case lifts off is {number(least)} N."
    return Sentence("lift_off", text, {"count": cases, "least": least}, np.ones(len(lifted), dtype=bool))
