"""Sentences on how an output changes with a factor, true within each category."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from trackroller.analysis.effects import (
    FEWEST_PAIRS,
    MOST,
    UNCHANGED,
    Effect,
    class_effect,
    comparable,
    paired_effect,
    strata,
)
from trackroller.analysis.table import StudyView
from trackroller.report.numbers import capital, count, level_text, listing, long_name, rounded, setting, times
from trackroller.report.words.sentence import Sentence
from trackroller.study.design.levels import NAMED

Strata = list[tuple[str, Any, Effect]]  # category, its level, and the effect within this level


def effect_of(view: StudyView, column: str, words: str, factor: str, rows: np.ndarray) -> Sentence | None:
    """Say how an output changes with a factor.

    Between paired designs if there are any, else between classes.

    Parameters
    ----------
    column, words : column of the output and its name in running text
    factor : name of the factor
    rows : cases that count, shape (n,) bool

    Returns
    -------
    The sentence, or None where too few designs can be compared.
    """
    effect = paired_effect(view, column, factor, rows)
    paired = effect is not None
    effect = effect or class_effect(view, column, factor, rows)
    if effect is None or (not paired and not comparable(view, effect, column, rows)):
        return None
    parts = strata(view, column, effect, rows)
    values = {"column": column, **vars(effect)}
    said = (_of_pairs if paired else _of_classes)(view, effect, parts, words, values, rows)
    if paired:
        return said
    pairs = [pair for pair in view.study.get("rank_correlations", ()) if factor in pair[:2] and pair[2]]
    tied = [one if other == factor else other for one, other, _ in pairs]
    if not tied:
        return said
    text = f"{said.text} {capital(listing([long_name(n) for n in tied]))} changes with it: the factors are correlated."
    return replace(said, text=text, values={**said.values, "correlated": tied})


def _span(view: StudyView, effect: Effect) -> str:
    """Return 'Friction coefficient 0 → 0.4', or the two levels of a list."""
    if view.ordered(effect.factor):
        low = level_text(effect.factor, effect.low, unit=False)
        high = level_text(effect.factor, effect.high, words=False)
        return f"{capital(long_name(effect.factor))} {low} → {high}"
    low, high = level_text(effect.factor, effect.low), level_text(effect.factor, effect.high)
    if effect.factor in NAMED:
        return f"{capital(high)} instead of {low}"
    return f"{capital(long_name(effect.factor))} {high} instead of {low}"


def _fold(effect: Effect) -> str:
    return times(max(effect.ratio, 1 / effect.ratio))


def _verb(words: str, up: bool) -> str:
    return ("lengthens" if up else "shortens") if "life" in words else ("raises" if up else "lowers")


def _of_pairs(
    view: StudyView, effect: Effect, parts: Strata, words: str, values: dict[str, Any], rows: np.ndarray
) -> Sentence:
    """State the median change of designs that differ in one factor only."""
    pairs = f"{count(effect.size)} pairs of valid designs that differ in nothing else"
    parts = [p for p in parts if p[2].size >= FEWEST_PAIRS]
    up = effect.ratio > 1
    against = [p for p in parts if (p[2].ratio - 1) * (effect.ratio - 1) < 0]
    same = effect.rising if up else effect.falling
    if max(effect.ratio, 1 / effect.ratio) <= 1 + UNCHANGED and not against:
        text = f"{_span(view, effect)} changes the {words} by less than 2 % in the median of {pairs}."
        return Sentence("pairs_same", text, values, rows)
    if against or same < MOST * effect.size:
        text = (
            f"{_span(view, effect)} acts in both directions: of {pairs} the {words} rises in {count(effect.rising)} "
            f"and falls in {count(effect.falling)}"
        )
        told = _by_category(parts, words) if against else []
        values["strata"] = [(c, v, e.ratio) for c, v, e in parts] if told else []
        return Sentence("pairs_both", f"{text}{'; median ' if told else ''}{', '.join(told)}.", values, rows)
    text = (
        f"{_span(view, effect)} {_verb(words, up)} the {words} {_fold(effect)} in the "
        f"median of {pairs}, and in {'all' if same == effect.size else count(same)} of them."
    )
    return Sentence("pairs", text.replace(", and in all of them", ", in all of them"), values, rows)


def _by_category(parts: Strata, words: str) -> list[str]:
    """Return the words on the median change within each level of the category whose levels disagree most."""
    spread: dict[str, list[float]] = {}
    for category, _, effect in parts:
        spread.setdefault(category, []).append(np.log(effect.ratio))
    category = max(spread, key=lambda c: max(spread[c]) - min(spread[c]))
    ways = ("longer", "shorter") if "life" in words else ("higher", "lower")
    return [
        f"{_fold(e)} {ways[0] if e.ratio > 1 else ways[1]} with {setting(c, v)}"
        if e.ratio != 1
        else f"unchanged with {setting(c, v)}"
        for c, v, e in parts
        if c == category
    ]


def _of_classes(
    view: StudyView, effect: Effect, parts: Strata, words: str, values: dict[str, Any], rows: np.ndarray
) -> Sentence:
    """State the change of the median between the lowest and the highest third of a factor, with its interval."""
    name = long_name(effect.factor)
    start, end = (level_text(effect.factor, v, words=False) for v in (effect.low, effect.high))
    low, high = effect.interval
    against = [p for p in parts if (p[2].ratio - 1) * (effect.ratio - 1) < 0]
    opposed = [p for p in parts if p[2].interval[0] > 1 or p[2].interval[1] < 1]
    ways = {e.ratio > 1 for _, _, e in opposed}
    values["strata"] = [(c, v, e.ratio, e.interval) for c, v, e in parts]
    ends = f"{start} and from {end}"
    if len(ways) == 2:
        told = [f"{_fold(e)} {'up' if e.ratio > 1 else 'down'} with {setting(c, v)}" for c, v, e in opposed]
        text = f"Between the thirds of the valid designs with {name} up to {ends} the median {words} goes "
        return Sentence("classes_both", f"{text}{listing(told)}.", values, rows)
    if low <= 1 <= high or against:
        kinds = f" common to every {listing(sorted({long_name(c) for c, _, _ in against}), 'and')}" if against else ""
        text = (
            f"No effect of {name} on the {words}{kinds} is found: between the thirds with {name} up to {ends} the "
            f"median changes by a factor of {rounded(effect.ratio)} (95 % interval {rounded(low)} to {rounded(high)})."
        )
        return Sentence("classes_none", text, values, rows)
    up = effect.ratio > 1
    bounds = (low, high) if up else (1 / high, 1 / low)
    text = (
        f"A {name} from {end} up, instead of one up to {start}, {_verb(words, up)} the median {words} "
        f"{_fold(effect)} (95 % interval {rounded(bounds[0])} to {rounded(bounds[1])}; "
        f"the outer thirds of the valid designs, {count(effect.size)} or more in each)."
    ).replace("A a", "An a")
    return Sentence("classes", text, values, rows)
