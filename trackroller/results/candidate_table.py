"""The table of a decision: one row a candidate with what it reaches over its conditions."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from trackroller.damage import LIMITS, limit_word
from trackroller.parameters import BODIES
from trackroller.parameters.carriage_fields import long_name_of, parameter_of
from trackroller.results.answer import STATES, Column
from trackroller.results.case_ranges import CaseRanges
from trackroller.results.comparison import Comparison, wilson
from trackroller.results.fatigue_lines import line_of, lines_text
from trackroller.results.life_columns import BESIDE, EVIDENCE, OF_PAIR, RIVALS, lacks_a_body
from trackroller.results.subgroups import (
    case_text,
    labels_in_place,
    places_of,
    places_text,
    plain,
)
from trackroller.roller.output_names import is_life
from trackroller.study.outputs import flat, of_first_limit

DESCRIBED = 500  # candidates whose misses are described by levels; of further ones they are counted


def candidate_table(own: Comparison) -> pd.DataFrame:
    """Return one row a candidate, in the order of their numbers.

    Parameters
    ----------
    own : the comparison of a study

    Returns
    -------
    The columns of `candidate_columns`, `number` and `case` (its worst condition, a row of the
    study) and `middle`, the geometric middle of the range at the worst condition.
    """
    table = own.members.copy()
    table.insert(0, "number", np.arange(own.count))
    table = table.assign(
        **_ends(own), **_counts(own), **_shares(own), **_second_models(own), **_exceeded(own)
    )
    table["state"] = states_of(own, table)
    table[["fails", "fails_counted"]] = pd.DataFrame(_fails(own, table), index=table.index)
    table["edge"] = _edges(own)
    for name, other in own.others.items():
        table[f"of_{name}"] = _worst_of(own, other)
    return table.assign(**_goods(own, table))


def _worst_of(own: Comparison, other: CaseRanges) -> np.ndarray:
    """Return another output of each candidate at its worst condition that is held, shape
    (candidates,).
    """
    rows = own.ranges.holds & other.holds & (own.own if own.drawn else own.reachable)
    return other.sign * _least(own, other.sign * other.worse, rows)


def _columns_of_others(own: Comparison) -> list[Column]:
    """Return the columns of the other outputs that the study requires or follows."""
    meaning = "{}: at its worst condition that is held"
    return [
        Column(f"of_{name}", _capital(words), units, meaning.format(words))
        for name, words, units in (other.output for other in own.others.values())
    ]


def _capital(words: str) -> str:
    return words[:1].upper() + words[1:]


def _goods(own: Comparison, table: pd.DataFrame) -> dict[str, Any]:
    """Return the columns of the user's own of each candidate, such as its price, which `table` has
    not yet.
    """
    first = [rows[0] for rows in own.rows]
    return {
        _good(name, table): own.results.table[name].to_numpy()[first] for name in own.results.goods
    }


def _good(name: str, table: pd.DataFrame) -> str:
    """Return the name of a column of the user's own in a table that may have one of this name."""
    if name in table:
        return f"own_{name}"
    return name


def _goods_columns(own: Comparison, table: pd.DataFrame) -> list[Column]:
    """Return the columns of the user's own as they are shown."""
    columns = []
    for name in own.results.goods:
        kind = "text"
        if own.results.table[name].dtype.kind == "f":
            kind = "whole"
        key = name
        if f"own_{name}" in table:
            key = f"own_{name}"
        units = str(own.results.data[name].attrs.get("units", ""))
        columns.append(Column(key, long_name_of(name), units, "column of the shelf", kind))
    return columns


def _choice_column(name: str) -> Column:
    """Return the column of a choice."""
    words = long_name_of(name)
    known = parameter_of(name)
    if known is None:
        return Column(name, words, "", words, "level", role="name")
    unit = known.units
    if unit == "1":
        unit = ""
    return Column(name, words, unit, known.meaning, "level", role="name")


STATE = Column(
    "state",
    "Verdict",
    meaning="met: the low end over (1 + error) reaches the requirement. Missed: the high end times "
    "(1 + error) does not. Otherwise open; none: no condition is held",
    kind="state",
)
WHERE_WORST = (
    Column("worst", "Worst condition", "", "the levels of the condition at the low end", "text"),
    Column(
        "ends",
        "Ended by",
        "",
        "what ends the candidate at the low end of its worst condition",
        "text",
    ),
)
LINE = Column(
    "line",
    "Tests",
    "",
    "tests that the life by fatigue follows from, at the low and at the high end; alone: the "
    "material has no others that count",
    "text",
)
SECOND_MODEL = (
    Column(
        "second",
        "Second model",
        "",
        "the second model of the same end with the shortest life",
        "text",
    ),
    Column(
        "second_low", "By second model", "h", "its life at its worst condition", until="second_high"
    ),
)
SECOND_STATE = Column(
    "second_state",
    "Verdict by second model",
    "",
    "the requirement by the second model in place of fatigue; wear and other limits with a life "
    "count as they are",
    "state",
)
EXCEEDED = Column(
    "exceeded", "Above 100 %", "", "limits that are exceeded somewhere, the worst one", "text"
)
TO_THE_LEADER = (
    Column(
        "ratio_low",
        "To the leader",
        "1",
        "ratio to the leader in the same condition",
        "ratio",
        "ratio_high",
    ),
    Column(
        "longer",
        "Better in",
        "",
        "conditions in which the candidate is better than the leader",
        "count",
    ),
)
ERROR = Column(
    "error", "Error", "1", "told 95 % error of the solution at the worst condition", "error"
)
EXTRAPOLATED = Column(
    "extrapolated",
    "Extrapolated",
    "",
    "conditions whose life lies beyond the data of its rule",
    "count",
)
EDGE = Column(
    "edge", "At the end of", "", "choices at the smallest or largest of their levels", "text"
)


def candidate_columns(own: Comparison, table: pd.DataFrame) -> tuple[Column, ...]:
    """Return the columns of the table of candidates that a reader is shown, as far as the study has
    them.
    """
    columns = []
    if own.required:
        columns.append(STATE)
    columns += [_choice_column(choice) for choice in own.choices]
    columns += _goods_columns(own, table)
    columns += _output_columns(own)
    columns += _columns_of_others(own)
    columns += [*WHERE_WORST, *_ends_apart(table)]
    if (table["line"] != "").any():
        columns.append(LINE)
    columns += _count_columns(own)
    columns += _drawn_columns(own, own.ranges.output[2])
    if (table["second"] != "").any():
        columns += SECOND_MODEL
        if any(one.output in OF_PAIR for one in own.required):
            columns.append(SECOND_STATE)
    if (table["exceeded"] != "").any():
        columns.append(EXCEEDED)
    if own.count > 1:
        columns += TO_THE_LEADER
    if table["error"].notna().any():
        columns.append(ERROR)
    columns.append(EXTRAPOLATED)
    if (table["edge"] != "").any():
        columns.append(EDGE)
    return tuple(columns)


def _output_columns(own: Comparison) -> list[Column]:
    """Return the columns of the compared output: its range at the worst condition, its median and
    its best value.
    """
    name, words, units = own.ranges.output
    life = words
    if is_life(name):
        chance = 0.5
        if of_first_limit(name):
            chance = float(own.results.data.attrs.get("failure_probability", 0.5))
        life = f"{words}, at {100 * chance:g} % failure probability"
    worst = f"{life}: worst condition, low to high end of its range"
    median = f"{words}: median of the conditions that are held"
    best = f"{words}: best condition that is held"
    return [
        Column("low", "Worst", units, worst, until="high", role="bar"),
        Column("median", "Median", units, median, role="bar"),
        Column("best", "Best", units, best, role="bar"),
    ]


def _drawn_columns(own: Comparison, units: str) -> list[Column]:
    """Return the columns of drawn conditions: shares and order statistics with their intervals; []
    for listed ones.
    """
    if not own.drawn:
        return []
    share = "share that is held"
    if own.required:
        share = "share of the drawn conditions that meet the requirement"
    reach = "stay within"
    if own.ranges.rises:
        reach = "reach"
    return [
        Column("share", "Share", "1", share, "share"),
        Column(
            "share_low", "95 %", "1", "Wilson's interval of the share", "share", until="share_high"
        ),
        Column(
            "share_short",
            "With error",
            "1",
            "share if all lives are shorter, or longer, by their told error",
            "share",
            until="share_long",
        ),
        Column("tenth", "Tenth part", units, f"what nine of ten drawn conditions {reach}"),
        Column(
            "tenth_low",
            "Its 95 %",
            units,
            "interval of the tenth part by order statistics",
            until="tenth_high",
        ),
        Column(
            "median_low",
            "95 % of the median",
            units,
            "interval by order statistics",
            until="median_high",
        ),
    ]


def _count_columns(own: Comparison) -> list[Column]:
    """Return the columns that count conditions; of drawn ones a share says how many meet a
    requirement.
    """
    columns = [
        Column(
            "holds", "Holds", "", "conditions in which the roller rolls inside all limits", "count"
        ),
        Column("judged", "Judged", "", "conditions that the model can judge", "count"),
        Column("of", "Of", "", "conditions of the candidate", "count"),
    ]
    if not own.required or own.drawn:
        return columns
    meets = Column(
        "meets", "Meets", "", "conditions that meet the requirement within the error", "count"
    )
    fails = Column(
        "fails",
        "Fails where",
        "",
        "levels that cover the sure misses, or counts of their causes",
        "text",
    )
    return [*columns[:2], meets, columns[2], fails]


def _ends_apart(table: pd.DataFrame) -> list[Column]:
    """Return the column of what ends candidates at the high end; none if it is the same as at the
    low end.
    """
    if (table["ends"] == table["ends_high"]).all():
        return []
    return [
        Column(
            "ends_high",
            "At the high end",
            "",
            "what ends the candidate at the high end of its range",
            "text",
        )
    ]


def _ends(own: Comparison) -> dict[str, Any]:
    """Return the range at the worst condition, the median and the best condition, and what ends the
    candidate.
    """
    ranges = own.ranges
    if own.drawn:
        rows = own.own
    else:
        rows = own.reachable
    worse, case = own.smallest(ranges.worse, rows)
    better, case_better = _at_best_place(own, rows)
    if ranges.rises:
        low, high = worse, better
    else:
        low, high = better, worse
    best = -own.ranges.sign * _least(own, -own.ranges.sign * ranges.better, rows & ranges.holds)
    with np.errstate(invalid="ignore", over="ignore"):
        middle = np.where((low > 0) & (high > 0), np.sqrt(low) * np.sqrt(high), 0.5 * (low + high))
    names = [name for name in own.conditions if own.results.table[name].nunique() > 1]
    worst = [_condition_text(own, names, row) for row in case]
    if ranges.rises:
        at_worse = ("_low", "_high")
    else:
        at_worse = ("_high", "_low")
    ends, body = _end_words(own, case, at_worse[0])
    ends_high, body_high = _end_words(own, case_better, at_worse[1])
    lines, alone = _lines_of(own, case, at_worse[0], body)
    lines_high, alone_high = _lines_of(own, case_better, at_worse[1], body_high)
    alone &= alone_high
    return {
        "case": case,
        "low": low,
        "high": high,
        "middle": np.where(low == high, low, middle),
        "median": own.median(ranges.middle, rows & ranges.holds),
        "best": best,
        "worst": worst,
        "ends": ends,
        "body": body,
        "ends_high": ends_high,
        "body_high": body_high,
        "line_low": lines,
        "line_high": lines_high,
        "line": [lines_text(*at) for at in zip(lines, lines_high, alone.tolist(), strict=True)],
        "line_alone": alone,
        "error": np.where(case < 0, np.nan, ranges.told_error[case]),
        "extrapolated": _conditions_with(own, ranges.beyond & rows),
    }


def _at_best_place(own: Comparison, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the better end at the worst condition of each candidate, and its case, shape
    (candidates,) each.

    Where a factor spans the range of a placeholder, the place at which this end is best counts.
    """
    best = np.full(own.count, np.nan)
    case = np.full(own.count, -1)
    for level in np.unique(own.level[rows & own.own]):
        values, cases = own.smallest(own.ranges.better, rows & (own.level == level))
        with np.errstate(invalid="ignore"):
            longer = np.isnan(best) | (own.ranges.sign * values > own.ranges.sign * best)
        best = np.where(longer, values, best)
        case = np.where(longer, cases, case)
    return best, case


def _least(own: Comparison, values: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Return the smallest of some values of each candidate, shape (candidates,); NaN without
    a row.
    """
    chosen = np.flatnonzero(rows & own.own & ~np.isnan(values))
    out = np.full(own.count, np.inf)
    np.minimum.at(out, own.candidate[chosen], values[chosen])
    some = np.bincount(own.candidate[chosen], minlength=own.count) > 0
    return np.where(some, out, np.nan)


def _condition_text(own: Comparison, names: list[str], row: int) -> str:
    if row < 0 or not names:
        return ""
    return case_text(own.results.table, names, row)


def _end_words(own: Comparison, case: np.ndarray, end: str) -> tuple[list[str], list[str]]:
    """Return what ends each candidate in a case, and the body; '' where nothing does, or it is not
    known.
    """
    names, guide = own.ranges.first_at(end)
    if end == "_low":
        value = own.ranges.low
    else:
        value = own.ranges.high
    words = []
    bodies = []
    for row in case:
        if row < 0:
            word = ""
        else:
            word = str(own.ranges.reason[row])
        ended = row >= 0 and not word and np.isfinite(value[row])
        if ended:
            word = str(names[row])
        words.append(limit_word(_end_of(word.removeprefix("limit "))))
        first_body = ""
        if ended and word:
            first_body = BODIES[int(guide[row])]
        bodies.append(first_body)
    return words, bodies


def _end_of(limit: str) -> str:
    """Return the limit whose end another one has tests of; the limit itself where it has its own
    end.
    """
    if limit in LIMITS:
        return LIMITS[limit].evidence_of or limit
    return limit


def _lines_of(
    own: Comparison, case: np.ndarray, end: str, bodies: Sequence[str]
) -> tuple[list[str], np.ndarray]:
    """Return the tests that the life by fatigue of each candidate follows from in a case, and
    whether its material has no others, (candidates,); '' where another limit gives the end.
    """
    names = own.ranges.first_at(end)[0]
    stored = json.loads(str(own.results.data.attrs.get("materials", "{}")))
    lines = []
    alone = np.ones(len(case), dtype=bool)
    for number, (row, body) in enumerate(zip(case, bodies, strict=True)):
        line = ""
        if body:
            material = str(own.results.material(body)[row])
            line = line_of(str(names[row]), stored.get(material, {}))
        if line:
            alone[number] = not _has_evidence(own, row, body)
        lines.append(line)
    return lines, alone


def _has_evidence(own: Comparison, row: int, body: str) -> bool:
    """Return whether a case knows a life of a body by other tests than those of the S-N curve."""
    hours = own.hours_by_limit("")
    if hours is None:
        return False
    listed = own.results.data["limit"].values.tolist()
    places = [place for place, name in enumerate(listed) if name in EVIDENCE]
    return bool(np.isfinite(hours[row, places, BODIES.index(body)]).any())


def _conditions_with(own: Comparison, rows: np.ndarray) -> np.ndarray:
    """Count for each candidate the conditions that have at least one of the marked cases.

    Parameters
    ----------
    rows : bool, shape (cases,)

    Returns
    -------
    Numbers of conditions, shape (candidates,).
    """
    candidate_of_pair, _, pair_of_case = own.pairs
    marked = pair_of_case[rows & own.own]
    has_case = np.bincount(marked, minlength=len(candidate_of_pair)) > 0
    return own.counted(has_case)


def _counts(own: Comparison) -> dict[str, Any]:
    every = np.ones(len(own.pairs[0]), dtype=bool)
    sure, may = own.met()
    return {
        "holds": own.counted(own.all_in_pair(own.ranges.holds)),
        "judged": own.counted(own.all_in_pair(own.ranges.judged)),
        "meets": own.counted(own.all_in_pair(sure)),
        "perhaps": own.counted(own.some_in_pair(may)),
        "of": own.counted(every),
    }


def states_of(own: Comparison, table: pd.DataFrame, exact: bool = False) -> list[str]:
    """Return the state of each candidate: met, open or missed of the requirement, or none; '' where
    none is judged.

    Conditions that no candidate holds do not count. `exact` leaves the errors of the solution out.
    """
    holds = table["holds"].to_numpy()
    unjudged = (table["of"] - table["judged"]).to_numpy()
    never = (holds == 0) & (unjudged == 0)
    if not own.required or (own.drawn and not np.isfinite(own.wanted_share)):
        return ["none" if gone else "" for gone in never]
    if own.drawn:
        if exact:
            ends = ("share", "share")
        else:
            ends = ("share_short", "share_long")
        surely, perhaps = (table[name].to_numpy() >= own.wanted_share for name in ends)
    else:
        sure, may = own.met(exact)
        surely = _everywhere(own, sure)
        perhaps = _perhaps_everywhere(own, may)
    state = np.where(surely, "met", np.where(perhaps, "open", "missed"))
    return [str(one) for one in np.where(never, STATES[3], state)]


def _everywhere(own: Comparison, rows: np.ndarray) -> np.ndarray:
    """Return the candidates of which all cases that count are among some rows, shape
    (candidates,).
    """
    counts = own.reachable
    bad = np.bincount(own.candidate[counts & ~rows], minlength=own.count)
    some = np.bincount(own.candidate[counts], minlength=own.count) > 0
    return np.asarray((bad == 0) & some)


def _perhaps_everywhere(own: Comparison, rows: np.ndarray) -> np.ndarray:
    """Return the candidates of which all cases that count are among some rows at one place of the
    placeholders at least, shape (candidates,): a placeholder has one value in all conditions.

    A place at which a candidate was not tried says nothing of it.
    """
    perhaps = np.zeros(own.count, dtype=bool)
    for place in np.unique(own.level[own.own]):
        here = own.reachable & (own.level == place)
        tried = np.bincount(own.candidate[here], minlength=own.count) > 0
        perhaps |= tried & _everywhere(own, rows | ~here)
    return perhaps


def _shares(own: Comparison) -> dict[str, Any]:
    """Return the share of the drawn conditions that meets the requirement, with both of its
    ranges.
    """
    if not own.drawn:
        return {}
    hits = own.hits()
    size = np.bincount(own.candidate[own.own], minlength=own.count)
    share = own.shares(hits)
    low, high = wilson(share * size, size)
    sure, may = own.met()
    tenth = np.array([own.tenth_part(number) for number in range(own.count)])
    middle = np.array([own.middle_interval(number) for number in range(own.count)])
    return {
        "n": size,
        "share": share,
        "share_low": low,
        "share_high": high,
        "share_short": np.minimum(share, own.shares(sure)),
        "share_long": np.maximum(share, own.shares(may)),
        "tenth": tenth[:, 0],
        "tenth_low": tenth[:, 1],
        "tenth_high": tenth[:, 2],
        "median_low": middle[:, 0],
        "median_high": middle[:, 1],
    }


def _fails(own: Comparison, table: pd.DataFrame) -> list[tuple[str, bool]]:
    """Return where each candidate surely misses its requirement, or is not held without one, and
    whether this counts causes in place of levels.
    """
    if own.required:
        good = own.some_in_pair(own.met()[1])[own.pairs[2]]
        good_count = table["perhaps"]
    else:
        good = own.ranges.holds
        good_count = table["holds"]
    names = [name for name in own.conditions if own.results.table[name].nunique() > 1]
    missed = table["of"].to_numpy() - good_count.to_numpy()
    everywhere = np.where(table["of"] > 1, "everywhere", "")
    out = []
    for number in range(own.count):
        if missed[number] == 0:
            out.append(("", False))
        elif missed[number] == table["of"].iloc[number]:
            out.append((str(everywhere[number]), False))
        elif number < DESCRIBED and not own.drawn:
            out.append(_where(own, names, number, good))
        else:
            out.append((f"misses in {missed[number]} of {table['of'].iloc[number]}", True))
    return out


def _where(own: Comparison, names: list[str], number: int, good: np.ndarray) -> tuple[str, bool]:
    """Return the levels that cover the misses of a candidate, otherwise how often it misses by
    what; and whether it is the latter.
    """
    rows = own.rows[number]
    part = own.results.table.iloc[rows]
    names = labels_in_place(part, names, own.results.labels, ~good[rows])
    places = places_of(part, names, ~good[rows], np.ones(len(rows), dtype=bool))
    few = [place for place in places if len(place) <= MOST_FACTORS]
    if places and len(few) == len(places):
        return places_text(places, part), False
    miss = "too much"
    if own.ranges.rises:
        miss = "too short"
    reasons = pd.Series(own.ranges.reason[rows][~good[rows]]).replace("", miss)
    counts = reasons.map(lambda word: limit_word(str(word).removeprefix("limit "))).value_counts()
    return ", ".join(f"{word} in {count}" for word, count in counts.items()), True


MOST_FACTORS = 2  # whose levels describe where a candidate fails


def _second_models(own: Comparison) -> dict[str, Any]:
    """Return the life of each candidate by the second model that is shortest, with its name and its
    state.

    A second model that knows no life of a body whose fatigue is known says nothing of this
    candidate.
    """
    nothing = {"second": "", "second_low": np.nan, "second_high": np.nan, "second_state": ""}
    value = own.hours_by_limit("")
    if value is None or not is_life(own.ranges.output[0]):
        return nothing
    names = [str(name) for name in own.results.data["limit"].values]
    rows = own.own & own.reachable
    if own.drawn:
        rows = own.own & own.ranges.holds
    shortest = np.full(own.count, np.inf)
    longest = np.full(own.count, np.inf)
    which = np.full(own.count, "", dtype=object)
    lives = np.full((2, len(value)), np.nan)  # of the second model that counts for each case
    for name in RIVALS:
        ends = _ends_by(own, names, name)
        if ends is None:
            continue
        least = [_least(own, end, rows) for end in ends]
        unknown = np.bincount(own.candidate[rows & np.isnan(ends[0])], minlength=own.count) > 0
        shorter = ~unknown & ~np.isnan(least[0]) & ((which == "") | (least[0] < shortest))
        which[shorter] = limit_word(name)
        shortest = np.where(shorter, least[0], shortest)
        longest = np.where(shorter, least[1], longest)
        lives = np.where(own.own & shorter[own.candidate], ends, lives)
    known = which != ""
    lives = np.fmin(lives, _other_ends(own, names))
    return {
        "second": [str(name) for name in which],
        "second_low": np.where(known, shortest, np.nan),
        "second_high": np.where(known, longest, np.nan),
        "second_state": [str(one) for one in np.where(known, _second_states(own, lives), "")],
    }


def _ends_by(own: Comparison, limits: list[str], name: str) -> np.ndarray | None:
    """Return the shorter life of both bodies by a second model, at both ends of its range, shape
    (2, n) [h].

    The life is NaN where the model lacks that of a body whose fatigue is known; None for a model
    that knows no life.
    """
    hours = [own.hours_by_limit(end) for end in ("", "_low", "_high")]
    if name in limits:
        place = limits.index(name)
    else:
        place = -1
    if hours[0] is None or place < 0:
        return None
    middle = hours[0][:, place]
    if np.isnan(middle[own.own]).all():
        return None
    lacks = lacks_a_body(hours[0], limits, name)
    ends = []
    for end in hours[1:]:
        if end is None:
            values = middle
        else:
            values = np.where(np.isnan(end[:, place]), middle, end[:, place])
        ends.append(np.where(lacks, np.nan, np.fmin.reduce(values, axis=1)))
    return np.stack(ends)


def _other_ends(own: Comparison, limits: list[str]) -> np.ndarray:
    """Return the hours until the first limit but fatigue and second models, at both ends of its
    range, shape (2, n) [h]; NaN where none is known.
    """
    others = [
        place for place, name in enumerate(limits) if name != "fatigue" and name not in BESIDE
    ]
    value = own.hours_by_limit("")
    assert value is not None  # a study with second models has the hours of limits
    ends = []
    for end in ("_low", "_high"):
        hours = own.hours_by_limit(end)
        if hours is None:
            hours = value
        known = np.where(np.isnan(hours), value, hours)[:, others].reshape(len(value), -1)
        least = np.min(known, axis=1, initial=np.inf, where=~np.isnan(known))
        ends.append(np.where(np.isnan(known).all(axis=1), np.nan, least))
    return np.stack(ends)


def _second_states(own: Comparison, lives: np.ndarray) -> np.ndarray:
    """Return the state of each candidate if a second model gives its lives, shape (candidates,); ''
    if none is judged.

    Parameters
    ----------
    own : the comparison
    lives : shorter life of both bodies by the second model and by all limits but fatigue, at both
        ends of its range, shape (2, n) [h]
    """
    if not any(one.output in OF_PAIR for one in own.required):
        return np.full(own.count, "")
    sure, may = own.met(lives=lives)
    if not own.drawn:
        surely = _everywhere(own, sure)
        perhaps = _perhaps_everywhere(own, may)
    elif np.isfinite(own.wanted_share):
        surely, perhaps = (own.shares(rows) >= own.wanted_share for rows in (sure, may))
    else:
        return np.full(own.count, "")
    return np.where(surely, "met", np.where(perhaps, "open", "missed"))


def _exceeded(own: Comparison) -> dict[str, Any]:
    """Return the limit of each candidate that is used most above 100 %, its body, its use and its
    hours.
    """
    nothing: dict[str, Any] = {
        "exceeded": "",
        "exceeded_by": "",
        "exceeded_body": "",
        "use": np.nan,
        "use_hours": np.nan,
    }
    data = own.results.data
    if "limit_state" not in data or "utilisation" not in data:
        return nothing
    words = str(data["limit_state"].attrs["flag_meanings"]).split()
    state = flat(data, "limit_state", own.results.dims)
    use = flat(data, "utilisation", own.results.dims).astype(float)
    beyond = np.where((state == words.index("exceeded")) & (use > 1.0), use, np.nan)
    flattened = beyond.reshape(len(beyond), -1)
    most = np.where(np.isnan(flattened), -np.inf, flattened)
    limit_and_body = most.argmax(axis=1)
    worst = most.max(axis=1)
    rows = own.own & np.isfinite(worst)
    if not own.drawn:
        rows &= own.reachable
    if not rows.any():
        return nothing
    names = [str(name) for name in data["limit"].values]
    hours = own.hours_by_limit("")
    order = np.flatnonzero(rows)
    order = order[np.lexsort((-worst[order], own.candidate[order]))]
    numbers, first = np.unique(own.candidate[order], return_index=True)
    records = [nothing] * own.count
    for number, row in zip(numbers, order[first], strict=True):
        limit, body = divmod(int(limit_and_body[row]), len(BODIES))
        word = limit_word(names[limit])
        own_hours = np.nan
        if hours is not None:
            own_hours = float(hours[row, limit, body])
        records[number] = {
            "exceeded": f"{word} of the {BODIES[body]} {100 * worst[row]:.3g} %",
            "exceeded_by": word,
            "exceeded_body": BODIES[body],
            "use": float(worst[row]),
            "use_hours": own_hours,
        }
    return {name: [record[name] for record in records] for name in nothing}


def _edges(own: Comparison) -> list[str]:
    """Return the choices of each candidate that stand at the smallest or largest of at least three
    numbers.
    """
    table = own.members
    out = np.full(own.count, "", dtype=object)
    for name in own.choices:
        levels = own.results.levels(name)
        if len(levels) < 3 or not own.results.numeric(name):
            continue
        at = table[name].isin([levels[0], levels[-1]]).to_numpy()
        words = long_name_of(name)
        added = np.where(at, words, "")
        out = np.array([", ".join(filter(None, pair)) for pair in zip(out, added, strict=True)])
    return [str(one) for one in out]


def names_of(own: Comparison, numbers: list[int]) -> list[dict[str, Any]]:
    """Return the choices of some candidates that tell them apart; all choices of a single one.

    Values that all candidates share are left out.
    """
    table = own.members.iloc[numbers]
    varying = [n for n in own.choices if own.members[n].nunique() > 1]
    if len(numbers) > 1:
        varying = [n for n in varying if table[n].nunique() > 1] or varying
    return [{name: plain(table[name].iloc[i]) for name in varying} for i in range(len(numbers))]


def shared_names(own: Comparison, numbers: list[int]) -> dict[str, Any]:
    """Return the choices that some candidates have in common, and that others of the study lack."""
    table = own.members.iloc[numbers]
    return {
        name: plain(table[name].iloc[0])
        for name in own.choices
        if table[name].nunique() == 1 and own.members[name].nunique() > 1
    }
