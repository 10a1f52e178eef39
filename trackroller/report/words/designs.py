"""Sentences and tables on designs: which one to build, what fails first, and which of them meet a target."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from pandas.api.types import is_numeric_dtype

from trackroller.damage import LIMITS
from trackroller.parameters import BODIES, FIRST_TO_FAIL
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
    quantity,
    rounded,
    setting,
    with_unit,
)
from trackroller.report.tables.table import Table, factor_cell, heading
from trackroller.report.words.sentence import Sentence, phrase, say
from trackroller.results.candidates import FEWEST, UNRANKED, Candidates, mixed
from trackroller.results.columns import codes
from trackroller.results.first_limits import UNSURE
from trackroller.results.intervals import Cases
from trackroller.results.results import SAME_ENDS as SAME
from trackroller.results.results import Results
from trackroller.results.verdict import Candidate, not_checked
from trackroller.roller.limit_notes import placeholders_of
from trackroller.roller.output_names import is_life

LARGE_ERROR = 0.1  # of the life in the verdict, from which on it is stated
MOST_ROWS = 40  # of a table of own cases that are listed one by one
BEST = 5  # designs that stand side by side
UNHELD, UNJUDGED = "does not hold", "not judged"  # of a candidate at its worst condition


def design_words(candidates: Candidates, row: Mapping[Any, Any] | pd.Series) -> str:
    """Name a design by its choices, materials first, such as 'PA6 on itself, contact angle 30°'."""
    names = sorted(candidates.choices, key=lambda name: candidates.results.numeric(name))
    return ", ".join(setting(name, row[name]) for name in names)


def condition_words(candidates: Candidates, case: int) -> str:
    """Name the conditions of a case, without those that do not change what its design does there.

    Its design has the same goal there, or does not hold for the same reason.
    """
    table, names = candidates.results.table, [n for n in candidates.conditions if n not in UNSURE]
    own, alike = _same(candidates, case)
    kept = list(names)
    for name in names:
        there = own & np.all([own, *(_at(table, n, case) for n in kept if n != name)], axis=0)
        everywhere = table[name][there].nunique() == max(table[name][own].nunique(), 2)
        if everywhere and alike[there].all():
            kept.remove(name)
    return ", ".join(setting(name, table[name].iloc[case]) for name in kept or names)


def _at(table: pd.DataFrame, name: str, case: int) -> np.ndarray:
    """Mark the rows that have the level of a case."""
    return np.asarray(table[name] == table[name].iloc[case])


def _same(candidates: Candidates, case: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the cases of the design of a case at the same values within ranges, and those that do the same."""
    table, goal = candidates.results.table, candidates.results.column(candidates.goal[0])
    own = candidates.place == candidates.place[case]
    for name in (n for n in UNSURE if n in candidates.conditions):
        own &= _at(table, name, case)
    if candidates.usable[case]:
        own &= candidates.usable
        return own, own & (goal == goal[case])
    reason = Cases(candidates).reason
    return own, own & (reason == reason[case])


def worst_words(candidates: Candidates, one: Candidate) -> str:
    """Name the condition in which a candidate lasts shortest; of a range that of each end, where they differ."""
    low, high = (condition_words(candidates, case) for case in (one.case, one.case_high))
    return low if low == high else f"{low} at the low end, {high} at the high end"


def within_words(results: Results) -> str:
    """Say where in the ranges of lives a number within them stands."""
    parts = []
    if not set(UNSURE) & set(results.factors) and any(p.low < p.high for p in placeholders_of(results.data)):
        parts.append("placeholders at their values")
    if "wear" not in not_checked(results):
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
    """Say why the designs of a study cannot be compared, and which design of experiments can compare them."""
    labels = candidates.results.labels  # which no distribution can draw
    roles = {name: role for name, role in candidates.results.roles.items() if name not in labels}
    named = {f"{role}s": [long_name(n) for n in roles if roles[n] == role] for role in ("choice", "condition")}
    use = codes(candidates.results.table, candidates.conditions)
    many = [len(np.unique(use[candidates.place == i])) for i in range(len(candidates.size))]  # a row may be repeated
    values: dict[str, Any] = {"designs": len(many), "least": min(many), "most": max(many)}
    factors = candidates.results.study.parsed
    values["listed"] = any(r == "condition" and n in factors and factors[n].discrete for n, r in roles.items())
    values |= {"weighted": candidates.weighted, "matched": candidates.matched}
    values["observed"] = candidates.results.config.method.observed and values["most"] > 1
    values |= {"cases": len(candidates.results.table), "independent": int((~mixed(candidates.results)).sum())}
    return say("designs", "unanswered", fewest=FEWEST, **values, **named)


def best_table(results: Results) -> Table | None:
    """List the best valid designs as columns, each over all its conditions.

    Where a design differs from the best one, the cell stands out.
    """
    candidates = results.candidates()
    if candidates is None or not candidates.comparable:
        return None
    best = [row for _, row in candidates.table.head(BEST).iterrows() if row["valid"]]
    rows: list[list[Any]] = [[heading(n), *(factor_cell(n, row[n]) for row in best)] for n in candidates.choices]
    numbers = [n for n in results.labels if n not in results.roles] if candidates.size.max() == 1 else []  # of drawings
    own = {n: results.table[n].iloc[[int(row["worst_case"]) for row in best]] for n in numbers}
    rows = [[heading(n), *(factor_cell(n, value) for value in values)] for n, values in own.items()] + rows
    rows += _judged(candidates, best) if candidates.goal != UNRANKED else []
    rows += _on_targets(candidates, best)
    margins_of = (("slip_margin", "Least margin to slip"), ("lift_off_margin", "Least margin to lift-off"))
    for name, words in margins_of if results.study.carriage is None else ():  # a row of a carriage has one load case
        if any(row[name] < 1 for row in best):  # without a drive nothing slips
            margins = [("none" if row[name] <= 0 else percent(row[name])) for row in best]
            rows.append([words, *(m if np.isfinite(row[name]) else "–" for m, row in zip(margins, best, strict=True))])
    several, met = bool(candidates.conditions), candidates.targets_met()
    if several:
        rows.append(["Holds in", *(part_of(row["valid"], row["cases"]) for row in best)])
    if met is not None:
        places = candidates.table.index[: len(best)]
        known = _of_verdict(candidates, best) or [None] * len(best)
        certain = (results.ranged and bool(results.judged_targets)) or any(one and one.open_limits for one in known)
        cells = []
        for i, one in zip(places, known, strict=True):
            count, of = int(met[0][i]), int(met[1][i])
            if one is not None and one.conditions == of:
                count = one.met  # not where a limit is open
            # what meets the target at the high end only, or within its error, is neither met nor missed
            cells.append(part_of(count, of) + " (open)" * (one is not None and one.status == "open"))
        rows.append([f"Meets the targets{' for certain' * certain} in", *cells])
    ranks = [int(row["rank"]) for row in best]
    heads = [f"Candidate {rank}{' (tie)' if ranks.count(rank) > 1 else ''}" for rank in ranks]
    title = "Candidates" if candidates.choices or candidates.goal == UNRANKED else "Life of the design"
    model = results.held_level("contact_model") if "contact_model" in results.factors else ""
    facts = {"several": several, "drawn": candidates.drawn, "rising": candidates.rising, "goal": candidates.goal[1]}
    facts |= {
        "within": within_words(results) if results.ranged else "",
        "shown": {row[0] for row in rows},
        "many": len(best),
    }
    facts["mixed"] = bool(candidates.conditions) and bool(mixed(results).any())
    facts["scattered"] = candidates.drawn and Cases(candidates).scatter is not None
    facts["hopeless"] = results.verdict is not None and results.verdict.out_of_reach is not None
    facts["open"] = any("(open)" in str(cell) for cell in rows[-1])
    note = phrase("designs", "note", model=model, **facts)
    return compared("candidates", title, heads if candidates.choices else ["All conditions"], rows, note)


def _on_targets(candidates: Candidates, best: list[pd.Series]) -> list[list[Any]]:
    """Return a row for each target that is no life: its worst value over the conditions that a design holds."""
    results, rows = candidates.results, []
    for name, ends in results.config.requirement.items():
        if is_life(name) or name == candidates.goal[0]:  # which have rows already
            continue
        values, unit, words = results.quantity(name)
        for end, way, place in (("min", "max", "smallest"), ("max", "min", "largest")):
            if end in ends.ends:
                case = candidates.worst_cases(values.astype(float), way)[[int(str(row.name)) for row in best]]
                head = with_unit(f"{capital(words)}{f', {place}' * bool(candidates.conditions)}", unit)
                rows.append([head, *(float(value) for value in np.where(case < 0, np.nan, values[case]))])
    return rows


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
        row["Ends it"] = (
            "–" if cases.reason[at] else f"{either(names[at], cases.high_end[at])}, {BODIES[int(guide[at])]}"
        )
        rows.append(row)
    note = phrase("designs", "rows", idle=[*map(heading, idle(results))])
    return Table.of("rows", "Life of each row of the table", rows, note)


def idle(results: Results) -> list[str]:
    """Return the columns of numbers of a table that change no case, such as shares of the time."""
    return [name for name in results.labels if is_numeric_dtype(results.table[name])]


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
    lost = any(row["valid"] < row["cases"] for row in best)
    places = {"worst": at_worst if rising else "largest", "median": f"median{' where it holds' * lost}"}
    places = places if candidates.conditions else {"worst": ""}
    known = _of_verdict(candidates, best) if rising else []
    if worst := _worst_row(candidates, known, at_worst if candidates.conditions else ""):
        rows.append(worst)
        places.pop("worst")
    if candidates.results.ranged:
        places = {key: f"{place}, within the ranges" if place else place for key, place in places.items()}
    rows += [row_of(key, capital(candidates.goal[1]), place) for key, place in places.items()]
    if known:
        rows.append(["Ends it", *(_end_cell(candidates, one) for one in known)])
    if candidates.conditions:
        named = ["–" if np.isinf(row["worst"]) else condition_words(candidates, int(row["worst_case"])) for row in best]
        if worst:
            pairs = zip(named, known, strict=True)
            named = [text if one is None or text == "–" else worst_words(candidates, one) for text, one in pairs]
        rows.append(["Worst condition", *named])
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
    bodies = dict.fromkeys([one.body, one.body_high] if one.ends_high in LIMITS and one.high > one.low else [one.body])
    return f"{place} (most of it in {load_case})" if roller else " or ".join(bodies)


def _end_cell(candidates: Candidates, one: Candidate | None) -> str:
    """Say what ends a candidate and which body, or where it is not met or not judged."""
    if one is None or not one.ends:
        return "–"
    if one.ends in LIMITS:
        return f"{ends_words(one)}, {body_words(candidates, one)}"
    where = condition_words(candidates, one.case)
    text = plain_reason(one.ends) + f" at {where}" * bool(where)
    return ", ".join(filter(None, (text, roller_words(candidates.results, one.case))))


def _of_verdict(candidates: Candidates, best: list[pd.Series]) -> list[Candidate | None]:
    """Return these designs as the verdict judges them; nothing if the verdict is on other designs."""
    found = candidates.results.verdict
    if found is None or found.goal != candidates.goal or found.choices != candidates.choices:
        return []
    known = {one.number: one for one in found.ranked.candidates}
    return [known.get(int(str(row.name))) for row in best]


def _worst_row(candidates: Candidates, known: list[Candidate | None], place: str) -> list[Any]:
    """Return the row on the life of each design at its worst condition, empty for drawn conditions.

    It is that of the verdict: none where a design does not hold a condition, and both ends of a range if one is one.
    """
    head, unit = f"{capital(candidates.goal[1])}{', ' * bool(place)}{place}", candidates.goal[2]
    if candidates.drawn or not known:
        return []
    if any(one is not None and one.high > one.low * (1 + SAME) for one in known):
        texts = ("–" if one is None else UNHELD if one.high == 0.0 else span_words(one, unit) for one in known)
        return [
            head,
            *(UNJUDGED if one is not None and not one.judged else t for one, t in zip(known, texts, strict=True)),
        ]
    return [
        with_unit(head, unit),
        *(math.nan if one is None else Life(one.low, one.beyond) if one.low > 0.0 else UNHELD for one in known),
    ]


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
    return either(one.ends, one.ends_high)


def either(at_low: str, at_high: str) -> str:
    """Return the words of what ends a life at the low and at the high end of its range, once if it is the same."""
    return " or ".join(dict.fromkeys(ended_by(name) for name in (at_low, at_high) if name))


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


def life_error(results: Results) -> Sentence | None:
    """State the largest error by the solution of the lives of the first candidate, where it exceeds `LARGE_ERROR`."""
    found = results.verdict
    ranked = None if found is None else found.ranked
    if ranked is None or not ranked.best or not ranked.goal_rises:
        return None
    candidates, best = Candidates.grouped(results, ranked.goal), ranked.best[0]
    cases = Cases(candidates)
    name = design_words(candidates, best.choices) if len(ranked.candidates) > 1 else ""
    return life_error_of(cases, candidates.design == best.number, name)


def life_error_of(cases: Cases, own: np.ndarray, name: str) -> Sentence | None:
    """State the largest error by the solution of the lives of a named design, shape (n,) bool, above `LARGE_ERROR`."""
    error = float(cases.error[own & (cases.reason == "")].max(initial=0.0))
    return say("accuracy", "life", name=name, error=error) if error > LARGE_ERROR else None
