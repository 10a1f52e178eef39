"""Sentences on how an output changes with a factor, true within each category."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from trackroller.report.numbers import BEYOND, capital, count, level_text, listing, long_name, setting, times
from trackroller.report.words.levels import at_least, at_most
from trackroller.report.words.sentence import Sentence, say
from trackroller.results import effects
from trackroller.results.effects import Effect
from trackroller.results.results import Results
from trackroller.study.design.levels import NAMED

Strata = list[tuple[str, Any, Effect]]  # category, its level, and the effect within this level


def effect_of(results: Results, column: str, words: str, factor: str, rows: np.ndarray) -> Sentence | None:
    """Say how an output changes with a factor.

    Between paired cases if there are any, else between classes.

    Parameters
    ----------
    column, words : column of the output and its name in running text
    factor : name of the factor
    rows : cases that count, shape (n,) bool

    Returns
    -------
    The sentence, or None where too few cases can be compared.
    """
    effect = effects.paired_effect(results, column, factor, rows)
    paired = effect is not None
    effect = effect or effects.class_effect(results, column, factor, rows)
    if effect is None or (not paired and not effects.comparable(results, effect, column, rows)):
        return None
    parts = effects.strata(results, column, effect, rows)
    beyond = int((rows & results.beyond_data(column)).sum())
    values = {"column": column, "words": words, **vars(effect), "beyond": beyond}
    values |= {"fold": times(effect.ratio), "verb": _change(words, effect.ratio)[0]}
    said = (_of_pairs if paired else _of_classes)(results, effect, parts, values, rows)
    if beyond:
        own = f"{count(beyond)} of the {count(int(rows.sum()))} lives lie {BEYOND}"
        said = replace(said, text=f"{said.text.removesuffix('.')}; {own}.")
    if paired:
        return said
    pairs = [pair for pair in results.config.rank_correlations if factor in pair[:2] and pair[2]]
    tied = [one if other == factor else other for one, other, _ in pairs]
    if not tied:
        return said
    text = f"{said.text} {capital(listing([long_name(n) for n in tied]))} changes with it: the factors are correlated."
    return replace(said, text=text, values={**said.values, "correlated": tied})


def _span(results: Results, effect: Effect) -> str:
    """Return 'Friction coefficient 0 → 0.4', or the two levels of a list."""
    if results.ordered(effect.factor):
        low = level_text(effect.factor, effect.low, unit=False)
        high = level_text(effect.factor, effect.high, words=False)
        return f"{capital(long_name(effect.factor))} {low} → {high}"
    low, high = level_text(effect.factor, effect.low), level_text(effect.factor, effect.high)
    if effect.factor in NAMED:
        return f"{capital(high)} instead of {low}"
    return f"{capital(long_name(effect.factor))} {high} instead of {low}"


def _change(words: str, ratio: float) -> tuple[str, str]:
    """Return the verb and the adjective of a change: 'lengthens', 'longer' for a life."""
    if "life" in words:
        return ("lengthens", "longer") if ratio > 1 else ("shortens", "shorter")
    return ("raises", "higher") if ratio > 1 else ("lowers", "lower")


def _within(parts: Strata, words: str) -> list[str]:
    """Return the words on the change within each level: '2.1-fold longer with PA6 on itself'."""
    said = [(setting(c, v), e.ratio) for c, v, e in parts]
    return [f"{times(r)} {_change(words, r)[1]} with {at}" if r != 1 else f"unchanged with {at}" for at, r in said]


def _of_pairs(results: Results, effect: Effect, parts: Strata, values: dict[str, Any], rows: np.ndarray) -> Sentence:
    """State the median change of cases that differ in one factor only."""
    changed = [long_name(name) for name in effects.also_changed(results, effect.factor, rows)]
    pairs = f"{count(effect.size)} pairs of valid cases that differ in nothing else"
    pairs += f" than the {listing(changed)} that follows from it" if changed else ""
    values |= {"span": _span(results, effect), "pairs": pairs}
    parts = [p for p in parts if p[2].size >= effects.FEWEST_PAIRS]
    against = [p for p in parts if (p[2].ratio - 1) * (effect.ratio - 1) < 0]
    same = effect.rising if effect.ratio > 1 else effect.falling
    if max(effect.ratio, 1 / effect.ratio) <= 1 + effects.UNCHANGED and not against:
        return say("factors", "pairs_same", **values)
    if against or same < effects.MOST * effect.size:
        medians = _within(_most_spread(parts), values["words"]) if against else []
        return say("factors", "pairs_both", **values, medians=medians)
    return say("factors", "pairs", **values, same=same)


def _most_spread(parts: Strata) -> Strata:
    """Return the effects within the levels of the category whose levels disagree most."""
    spread: dict[str, list[float]] = {}
    for category, _, effect in parts:
        spread.setdefault(category, []).append(np.log(effect.ratio))
    category = max(spread, key=lambda c: max(spread[c]) - min(spread[c]))
    return [part for part in parts if part[0] == category]


def _of_classes(results: Results, effect: Effect, parts: Strata, values: dict[str, Any], rows: np.ndarray) -> Sentence:
    """State the change of the median between the lowest and the highest third of a factor, with its interval."""
    own = results.table[effect.factor].to_numpy(dtype=float)[rows]
    values |= {"low_class": at_most(effect.factor, effect.low, own.min()), "name": long_name(effect.factor)}
    values |= {"high_class": at_least(effect.factor, effect.high, own.max())}
    against = [p for p in parts if (p[2].ratio - 1) * (effect.ratio - 1) < 0]
    opposed = [p for p in parts if p[2].interval[0] > 1 or p[2].interval[1] < 1]
    if len({e.ratio > 1 for _, _, e in opposed}) == 2:
        turns = _within(opposed, values["words"])
        return say("factors", "classes_both", **values, turns=turns)
    if effect.interval[0] <= 1 <= effect.interval[1] or against:
        kinds = sorted({long_name(c) for c, _, _ in against})
        return say("factors", "classes_none", **values, kinds=kinds)
    return say("factors", "classes", **values)
