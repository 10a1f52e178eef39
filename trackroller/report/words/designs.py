"""Sentences and tables on designs: which one to build, what fails first, and which of them meet a target."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from pandas.api.types import is_numeric_dtype

from trackroller.damage import LIMITS
from trackroller.parameters import BODIES, FIRST_TO_FAIL, expressions
from trackroller.report.numbers import (
    BEYOND,
    Life,
    capital,
    count,
    head_unit,
    lasting,
    listing,
    long_name,
    part_of,
    percent,
    plain,
    quantity,
    rounded,
    setting,
)
from trackroller.report.tables.table import Table, factor_cell, heading
from trackroller.report.words.sentence import Sentence, phrase, say
from trackroller.results.candidates import FEWEST, Candidates, mixed
from trackroller.results.columns import codes
from trackroller.results.first_limits import UNSURE
from trackroller.results.intervals import Cases
from trackroller.results.results import SAME_ENDS as SAME
from trackroller.results.results import Results
from trackroller.results.verdict import Candidate
from trackroller.roller.limit_notes import placeholders_of
from trackroller.study.design.entries import FACTOR_NAMES

MOST_ROWS = 40  # of a table of own cases that are listed one by one
BEST = 5  # designs that stand side by side


def design_words(candidates: Candidates, row: Mapping[Any, Any] | pd.Series) -> str:
    """Name a design by its choices, materials first, such as 'PA6 on itself, contact angle 30°'."""
    names = sorted(candidates.choices, key=lambda name: candidates.results.numeric(name))
    return ", ".join(setting(name, row[name]) for name in names)


def condition_words(candidates: Candidates, case: int) -> str:
    """Name the conditions of a case, without those that do not change the goal of its design there."""
    table, goal = candidates.results.table, candidates.results.column(candidates.goal[0])
    own = candidates.usable & (candidates.place == candidates.place[case])
    alike = own & (goal == goal[case])
    names = [n for n in candidates.conditions if n not in UNSURE]
    varied = [n for n in names if table[n][alike].nunique() < max(table[n][own].nunique(), 2)]
    return ", ".join(setting(name, table[name].iloc[case]) for name in varied or names)


def worst_words(candidates: Candidates, one: Candidate) -> str:
    """Name the condition in which a candidate lasts shortest; of a range that of each end, where they differ."""
    low, high = (condition_words(candidates, case) for case in (one.case, one.case_high))
    return low if low == high else f"{low} at the low end, {high} at the high end"


def within_words(results: Results) -> str:
    """Say where in the ranges of lives a number within them stands."""
    parts = []
    if not set(UNSURE) & set(results.factors) and any(p.low < p.high for p in placeholders_of(results.data)):
        parts.append("placeholders at their values")
    if "wear" not in (results.verdict.not_checked if results.verdict is not None else ()):
        parts.append("the wear life at the mean of its bounds")
    return " and ".join(parts)


def alone(candidates: Candidates) -> bool:
    """Return whether the roller stands for the pair in every case, because the guide's hours are unknown."""
    return candidates.rising and not candidates.results.knows("guide_life_hours")


def lasting_one(candidates: Candidates) -> str:
    """Return the word for what lasts: in a study of carriages the carriage, otherwise the pair or the roller alone."""
    if candidates.results.study.carriage is not None:
        return "carriage"
    return "roller" if alone(candidates) else "pair"


def size_words(results: Results) -> str:
    """State the size of a study: '162 cases: 9 designs in 18 conditions each'."""
    cases, candidates = len(results.table), results.candidates()
    text = f"{count(cases)} case{'s' * (cases > 1)}"
    if candidates is None or not (candidates.matched and candidates.choices and candidates.conditions):
        return text
    many, size = len(candidates.size), int(candidates.size[0])
    each = f": {count(many)} design{'s' * (many > 1)} in {count(size)} conditions{' each' * (many > 1)}"
    return text + each * (many * size == cases)


def unanswered(candidates: Candidates) -> Sentence:
    """Say why a study cannot compare designs, and which design of experiments can."""
    roles = candidates.results.roles
    named = {f"{role}s": [long_name(n) for n in roles if roles[n] == role] for role in ("choice", "condition")}
    values = {"designs": len(candidates.size), "least": int(candidates.size.min()), "most": int(candidates.size.max())}
    method, factors = plain(candidates.results.config.design), candidates.results.study.parsed
    values["listed"] = any(r == "condition" and n in factors and factors[n].discrete for n, r in roles.items())
    values |= {"weighted": candidates.weighted} | _sharing(candidates)
    values["observed"] = candidates.results.config.method.observed and values["most"] > 1
    values |= {"cases": len(candidates.results.table), "independent": int((~mixed(candidates.results)).sum())}
    return say("designs", "unanswered", method=method, fewest=FEWEST, **values, **named)


def _sharing(candidates: Candidates) -> dict[str, int]:
    """Return how many designs at most have the same conditions, and how many conditions these are."""
    use, place = codes(candidates.results.table, candidates.conditions), candidates.place
    own = [frozenset(use[place == i].tolist()) for i in range(len(candidates.size))]
    same, alike = max(Counter(own).items(), key=lambda found: (found[1], len(found[0])))
    return {"alike": alike, "common": len(same)}


def best_table(results: Results) -> Table | None:
    """List the best valid designs as columns, each over all its conditions.

    Where a design differs from the best one, the cell stands out.
    """
    candidates = results.candidates()
    if candidates is None or not candidates.comparable:
        return None
    best = [row for _, row in candidates.table.head(BEST).iterrows() if row["valid"]]
    rows: list[list[Any]] = [[heading(n), *(factor_cell(n, row[n]) for row in best)] for n in candidates.choices]
    rows += _judged(candidates, best)
    for name, words in (("slip_margin", "Least margin to slip"), ("lift_off_margin", "Least margin to lift-off")):
        if any(row[name] < 1 for row in best):  # without a drive nothing slips
            margins = [("none" if row[name] <= 0 else percent(row[name])) for row in best]
            rows.append([words, *(m if np.isfinite(row[name]) else "–" for m, row in zip(margins, best, strict=True))])
    several, met = bool(candidates.conditions), candidates.targets_met()
    if several:
        rows.append(["Valid in", *(part_of(row["valid"], row["cases"]) for row in best)])
    if met is not None:
        places = candidates.table.index[: len(best)]
        ranged = results.ranged and bool(results.judged_targets)
        cells = [part_of(met[i], candidates.size[i]) for i in places]
        # what meets the target at the high end only, or within its error, is neither met nor missed
        known = _of_verdict(candidates, best) or [None] * len(best)
        cells = [c + " (open)" * (o is not None and o.status == "open") for c, o in zip(cells, known, strict=True)]
        rows.append([f"Meets the targets{' for certain' * ranged} in", *cells])
    ranks = [int(row["rank"]) for row in best]
    heads = [f"Candidate {rank}{' (tie)' if ranks.count(rank) > 1 else ''}" for rank in ranks]
    title = "Candidates" if candidates.choices else "Life of the design"
    model = results.held_level("contact_model") if "contact_model" in results.factors else ""
    facts = {"several": several, "drawn": candidates.drawn, "rising": candidates.rising, "goal": candidates.goal[1]}
    facts |= {
        "within": within_words(results) if results.ranged else "",
        "shown": {row[0] for row in rows},
        "many": len(best),
    }
    facts["mixed"] = bool(candidates.conditions) and bool(mixed(results).any())
    facts["scattered"] = candidates.drawn and Cases(candidates).scatter is not None
    found = results.verdict
    facts["hopeless"] = bool(found is not None and found.out_of_reach is not None and not candidates.drawn)
    facts["open"] = any("(open)" in str(cell) for cell in rows[-1])
    note = phrase("designs", "note", model=model, **facts)
    return compared("candidates", title, heads if candidates.choices else ["All conditions"], rows, note)


def rows_table(results: Results) -> Table | None:
    """List the life of each row of a table of own cases, such as measured loads; None for a long table."""
    goal = results.life
    if not results.config.method.observed or goal is None or not 1 < len(results.table) <= MOST_ROWS:
        return None
    cases = Cases(Candidates.grouped(results, goal))
    (low, high), (names, guide), fatigue = cases.ends, cases.low_end, cases.beyond | cases.beyond_at_high
    rows = []
    for i, case in results.table.iterrows():
        at = int(str(i))
        row: dict[str, Any] = {heading(name): factor_cell(name, case[name]) for name in results.factors}
        ends = (float(low[at]), float(high[at]), BEYOND * bool(fatigue[at]))
        row[capital(goal[1])] = plain_reason(cases.reason[at]) or ends_text(*ends, goal[2])
        row["Ends it"] = "–" if cases.reason[at] else f"{ended_by(str(names[at]))}, {BODIES[int(guide[at])]}"
        rows.append(row)
    return Table.of("rows", "Life of each row of the table", rows, phrase("designs", "rows", idle=_idle(results)))


def _idle(results: Results) -> list[str]:
    """Return the columns of numbers of a table that change no case, such as shares of the time."""
    own = [name for name in results.factors if name not in FACTOR_NAMES and is_numeric_dtype(results.table[name])]
    texts = [factor["expression"] for factor in results.config.factors.values() if "expression" in factor]
    return [heading(name) for name in own if not any(name in expressions.names(text) for text in texts)]


def plain_reason(reason: str) -> str:
    """Write why a case is not met or not judged; '' where it is met."""
    return f"exceeds the limit of {ended_by(reason.removeprefix('limit '))}" if reason.startswith("limit ") else reason


def compared(name: str, title: str, heads: list[str], rows: list[list[Any]], note: str) -> Table:
    """Return a table of designs as columns, in which the cells that differ from those of the first design stand out."""
    marks = {(i, j) for i, row in enumerate(rows) for j in range(2, len(row)) if row[j] != row[1]}
    return Table(name, title, ["", *heads], rows, note, frozenset(marks))


def _judged(candidates: Candidates, best: list[pd.Series]) -> list[list[Any]]:
    """Return the rows on the goal of the designs, on the worst condition, and on what ends the life there."""
    unit, rising = head_unit(candidates.goal[2]), candidates.rising

    def row_of(key: str, head: str, place: str = "") -> list[Any]:
        cells = (Life(row[key], row[f"{key}_beyond"]) if rising else float(row[key]) for row in best)
        return [f"{head}{', ' * bool(place)}{place} [{unit}]", *cells]

    rows = []
    if rising and candidates.drawn:
        known = _of_verdict(candidates, best)
        tested = any(one is not None and one.tested for one in known)
        ranged = not tested and any(one is not None and one.high > one.low * (1 + SAME) for one in known)
        if ranged:
            cells = ("–" if one is None else span_words(one, candidates.goal[2]) for one in known)
            rows.append(["Nine of ten reach", *cells])
        else:
            rows.append(row_of("b10", f"Nine of ten reach{', low end by the tests' * tested}"))
        intervals = (f"{rounded(row['b10_low'])} to {rounded(row['b10_high'])}" for row in best)
        rows.append([f"95 % interval{' of the low end' * ranged}", *intervals])
        if tested:
            cells = ("–" if one is None else span_words(one, candidates.goal[2]) for one in known)
            rows.append(["Nine of ten reach, 90 % by the tests", *cells])
    at_worst = f"worst {'shared ' * bool(candidates.untried.any())}condition"
    places = {"worst": at_worst if rising else "largest", "median": "median"}
    places = places if candidates.conditions else {"worst": ""}
    known = _of_verdict(candidates, best) if rising else []
    spans = _spans(candidates, known)
    if spans:  # the ends of the range say more than a value within it
        rows.append([f"{capital(candidates.goal[1])}, {at_worst}", *spans])
        places.pop("worst")
    if candidates.results.ranged:
        places = {key: f"{place}, within the ranges" if place else place for key, place in places.items()}
    rows += [row_of(key, capital(candidates.goal[1]), place) for key, place in places.items()]
    if known:
        rows.append(["Ends it", *(_end_cell(candidates, one) for one in known)])
    if candidates.conditions:
        worst = ["–" if np.isinf(row["worst"]) else condition_words(candidates, int(row["worst_case"])) for row in best]
        if spans:
            worst = [
                text if one is None else worst_words(candidates, one) for text, one in zip(worst, known, strict=True)
            ]
        rows.append(["Worst condition", *worst])
    return rows


def roller_words(results: Results, row: int) -> str:
    """Name the worst roller of a case of a study of carriages and its load case; '' without one."""
    if results.study.carriage is None:
        return ""
    roller, load_case = (str(results.quantity(name)[0][row]) for name in ("worst_roller", "worst_load_case"))
    return f"roller {roller} in load case {load_case}" if roller else ""  # a carriage that tips has none


def body_words(candidates: Candidates, one: Candidate) -> str:
    """Name the body that ends a candidate; of a carriage that of its worst roller, with its load case."""
    roller, _, load_case = roller_words(candidates.results, one.case).partition(" in ")
    place = f"rail at {roller}" if one.body == "guide" else roller
    return f"{place} (most of it in {load_case})" if roller else one.body


def _end_cell(candidates: Candidates, one: Candidate | None) -> str:
    """Say what ends a candidate and which body, or where it is not met or not judged."""
    if one is None or not one.ends:
        return "–"
    if one.ends in LIMITS:
        return f"{ends_words(one)}, {body_words(candidates, one)}"
    names = [name for name in candidates.conditions if name not in UNSURE]
    where = ", ".join(setting(name, candidates.results.table[name].iloc[one.case]) for name in names)
    text = f"{one.ends} at {where}" if where else one.ends
    return ", ".join(filter(None, (text, roller_words(candidates.results, one.case))))


def _of_verdict(candidates: Candidates, best: list[pd.Series]) -> list[Candidate | None]:
    """Return these designs as the verdict judges them; nothing if the verdict is on other designs."""
    found = candidates.results.verdict
    if found is None or found.goal != candidates.goal or found.choices != candidates.choices:
        return []
    known = {one.number: one for one in found.ranked.candidates}
    return [known.get(int(str(row.name))) for row in best]


def _spans(candidates: Candidates, known: list[Candidate | None]) -> list[str]:
    """Write both ends of the life of each design at its worst condition; nothing where none rests on a placeholder."""
    if candidates.drawn or not any(one is not None and one.high > one.low * (1 + SAME) for one in known):
        return []
    return ["–" if one is None else span_words(one, candidates.goal[2]) for one in known]


def span_words(one: Candidate, unit: str) -> str:
    """Write both ends of a life by unmeasured values and by tests, or the one life where it rests on neither."""
    beyond = f"beyond the tests of {listing(one.tested)}" if one.beyond_tests and one.tested else BEYOND * one.beyond
    if math.isinf(one.low) or one.high <= one.low * (1 + SAME):
        return lasting(one.low, unit, one.beyond)
    return ends_text(one.low, one.high, beyond, unit)


def ends_text(low: float, high: float, beyond: str, unit: str) -> str:
    """Write a life as its two ends, or as one number where they are the same; `beyond` says what it lies beyond."""
    if math.isinf(low) or high <= low * (1 + SAME):
        return lasting(low, unit, bool(beyond))
    ends = quantity(low, unit), quantity(high, unit)
    text = f"{ends[0] if '(' in ends[1] else rounded(low)} to {ends[1]}"  # years stand behind both ends or none
    text = text if math.isfinite(high) else f"at least {quantity(low, unit)}"
    return text + f" ({beyond})" * bool(beyond)


def ends_words(one: Candidate) -> str:
    """Return the words of what ends a candidate: of two limits if the range of its placeholders decides which."""
    words = list(dict.fromkeys(ended_by(name) for name in (one.ends, one.ends_high) if name))
    return " or ".join(words)


def ended_by(name: str) -> str:
    """Return the words of what ends a life: a limit without the remark in brackets, fatigue in short, or a reason."""
    return name if name == "fatigue" or name not in LIMITS else limit_title(name)


def limit_title(name: str) -> str:
    """Return the words of a limit without the remark in brackets."""
    return LIMITS[name].title.partition(" (")[0]


def first_words(row: pd.Series) -> str:
    """Say which body fails first, and in how many cases if it is not always the same."""
    counts = {word: n for word in FIRST_TO_FAIL if (n := int(row[f"first_{word}"]))}
    return next(iter(counts)) if len(counts) == 1 else ", ".join(f"{word} in {count(n)}" for word, n in counts.items())
