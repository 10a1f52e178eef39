"""How an output changes with a factor, in words."""

from __future__ import annotations

from typing import Any

import numpy as np

from trackroller.report.numbers import BEYOND, capital, count, level_text, listing, long_name, rounded, setting, times
from trackroller.report.words.sentence import Sentence, say
from trackroller.results.effects import Effect
from trackroller.results.findings import Finding
from trackroller.results.results import Results
from trackroller.roller.output_names import is_life
from trackroller.study.design.levels import NAMED

SPREAD = 2.0  # ratio of the largest to the smallest effect of pairs from which on both are told
WIDE = 1.1  # an end of an interval so many times as large as the fitted ratio is told
Strata = list[tuple[str, Any, Effect]]  # category, its level, and the effect within this level


def effect_words(results: Results, finding: Finding) -> Sentence:
    """Say how an output changes with a factor."""
    effect, column = finding.values["effect"], finding.values["column"]
    output = _words(results, column)
    values = {**vars(effect), "words": output, "fold": times(effect.ratio), "verb": _change(column, effect.ratio)[0]}
    values["beyond"] = _beyond(finding)
    values["span"] = _span(results, effect)
    values |= _of_fit(effect) if finding.kind == "fitted" else _of_pairs(results, finding)
    return say("factors", finding.kind, **{**finding.values, **values})


def _words(results: Results, column: str) -> str:
    """Name a column of the cases in running text."""
    lives = {name: words for name, words, _ in (results.life or ("", "", ""), *results.fatigue_lives)}
    if column in lives:
        return lives[column]
    return results.quantity(column)[2]


def _beyond(finding: Finding) -> str:
    """Say how many of the lives lie beyond the S-N data; an empty text if none does."""
    cases = finding.values["beyond"]
    return f"{count(cases)} of the {count(finding.values['of'])} lives lie {BEYOND}" if cases else ""


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


def _change(column: str, ratio: float) -> tuple[str, str]:
    """Return the verb and the adjective of a change: 'lengthens', 'longer' for a life."""
    if is_life(column):
        return ("lengthens", "longer") if ratio > 1 else ("shortens", "shorter")
    return ("raises", "higher") if ratio > 1 else ("lowers", "lower")


def _within(parts: Strata, column: str) -> list[str]:
    """Return the words on the change within each level: '2.1-fold longer with PA6 on itself'."""
    said = [(setting(c, v), e.ratio) for c, v, e in parts]
    return [f"{times(r)} {_change(column, r)[1]} with {at}" if r != 1 else f"unchanged with {at}" for at, r in said]


def _of_fit(effect: Effect) -> dict[str, Any]:
    """Return the words of a fitted effect: two digits, and its interval where this is wide."""
    fold, *ends = (max(r, 1 / r) for r in (effect.ratio, *effect.interval))
    wide = [rounded(end, 2) for end in sorted(ends)] if max(ends) > WIDE * fold else []
    return {"fold": f"{rounded(fold, 2)}-fold", "wide": wide}


def _of_pairs(results: Results, finding: Finding) -> dict[str, Any]:
    """Return the words of the median change of cases that differ in one factor only."""
    values = finding.values
    changed = [long_name(name) for name in values["changed"]]
    follow = "follows" if len(changed) == 1 else "follow"
    if results.study.carriage is not None and changed:
        changed, follow = ["loads of the rollers"], "follow"  # a row holds those of one roller in one load case
    pairs = f"{count(values['effect'].size)} pairs of valid cases that differ in nothing else"
    pairs += f" than the {listing(changed)} that {follow} from it" if changed else ""
    medians = _within(values["apart"], values["column"])
    ends = sorted(max(r, 1 / r) for r in values["effect"].interval if 0 < r < np.inf)
    told = len(ends) == 2 and not medians and ends[1] > SPREAD * ends[0]
    wide = [times(end) for end in ends] if told else []
    return {"pairs": pairs, "medians": medians, "wide": wide}
