"""The table of an answer: heads, cells as texts and numbers, what all rows share, and what does not
fit the page.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from trackroller.report.bounds import bounds_of_output
from trackroller.report.numbers import (
    capital,
    carried_range,
    grouped,
    held_text,
    level_text,
    lowered,
    may_be_lost,
    unit_text,
    year_text,
    year_words,
)
from trackroller.report.pictures.axis import tick_text
from trackroller.results.answer import Answer, Column
from trackroller.study.design.levels import NAMED

# of a candidate
STATE_SIGNS = {"met": "● met", "open": "◐ open", "missed": "✕ missed", "none": "– none"}
STATE_SIGNS |= {
    "kept": "● kept",
    "finite": "● finite",
    "exceeded": "✕ exceeded",
    "unknown": "– not known",
}  # of a limit
MOST_ROWS = 15  # of a table that stands on a page whole
FIRST_ROWS = 12  # of a longer one, before the fold
MOST_SHOWN = 200  # of a longer one, the fold included; the others stand in the files
PAGE = 1090.0  # width of a table on a page [px]
BARS = 210.0  # width of the bars of a table [px]
HALF_BARS = 150.0  # width of each of two columns of bars [px]
GAP = 17.0  # between two columns [px]
LETTER = 7.3  # mean width of a letter of a table [px]
WRAPPED = 24  # letters of a line of a text in a table
LINES = 2  # of a text in a table
WIDEST = 40  # letters of such a line; longer texts stand in the proof
OF_RANGE = ("smallest", "median", "largest")  # columns of a row that has an output of its own
NARROW_KINDS = ("ratio", "error")  # that a card of a narrow screen leaves out
NARROW_NAMES = ("median", "best")
WORDS = ("factor", "output")  # columns of words that name a row
UNDRAWN = ("best",)  # columns that are drawn and not written
LONG_LIFE = 1e9  # h; a longer one is no number that a person reads
IN_FILES = "file"  # role of columns that stand in files alone


@dataclass(frozen=True)
class ShownHead:
    """The head of a column: title, unit, definition, and its classes."""

    name: str
    title: str
    unit: str
    meaning: str
    kind: str


@dataclass(frozen=True)
class ShownCell:
    """A cell: what it says, and its classes."""

    text: str
    kind: str
    state: str = ""


@dataclass(frozen=True)
class ShownTable:
    """The table of an answer as it is shown.

    Attributes
    ----------
    heads : of its columns
    cells : of its rows
    shared : what all rows share, in words
    """

    heads: tuple[ShownHead, ...]
    cells: tuple[tuple[ShownCell, ...], ...]
    shared: tuple[str, ...]


def rows_of(answer: Answer, columns: Iterable[Column] | None = None) -> ShownTable:
    """Return the table of an answer; columns that are equal in all rows are said once."""
    shared = answer.shared
    if columns is None:
        every = tuple(answer.columns)
    else:
        every = tuple(columns)
    shown = [one for one in every if one.name not in shared and not _is_hidden(one)]
    records = answer.table.head(MOST_SHOWN).to_dict("records")
    heads = tuple(head_of(answer, column) for column in shown)
    pairs = list(zip(shown, heads, strict=True))
    cells = tuple(
        tuple(cell_of(answer, column, row, head.kind) for column, head in pairs) for row in records
    )
    first = {}
    if records:
        first = records[0]
    notes = [
        _shared_text(answer, column, first) for column in answer.columns if column.name in shared
    ]
    if any(column.units == "h" for column in shown):
        notes.append(year_words())
    return ShownTable(heads, cells, tuple(text for text in notes if text))


def _is_hidden(column: Column) -> bool:
    """Return whether a page leaves a column out, because it is drawn or stands in files alone."""
    return column.name in UNDRAWN or column.role == IN_FILES


def head_of(answer: Answer, column: Column) -> ShownHead:
    """Return the head of a column."""
    return ShownHead(
        column.name,
        capital(column.title),
        unit_of(column),
        column.meaning,
        classes_of(answer, column),
    )


def unit_of(column: Column) -> str:
    """Return the unit of a column as its head shows it."""
    if column.name in NAMED and column.role == "name":
        return ""
    signs = {"share": "%", "ratio": "×", "error": "± %"}
    unit = signs.get(column.kind) or column.units
    return unit_text(unit).replace("–", "")


def classes_of(answer: Answer, column: Column) -> str:
    """Return the classes of a column: aligned to the right, one line, left out in a card."""
    classes = []
    if _is_number(answer, column):
        classes.append("n")
    elif column.kind == "state":
        css = "s"
        if column is _first_state(answer):
            css = "v"
        classes.append(css)
    elif column.role == "name" and _longest(answer, column) <= WRAPPED:
        classes.append("s")
    if column.kind in NARROW_KINDS or column.name in NARROW_NAMES:
        classes.append("z")
    if column.role == "name":
        classes.append("u")
    return " ".join(classes)


def _first_state(answer: Answer) -> Column | None:
    """Return the first column of states."""
    return next((column for column in answer.columns if column.kind == "state"), None)


def _is_number(answer: Answer, column: Column) -> bool:
    if column.kind in ("state", "text"):
        return False
    if column.kind != "level":
        return True
    return not any(isinstance(value, str) for value in answer.table[column.name])


def cell_of(answer: Answer, column: Column, row: Mapping[Any, Any], kind: str) -> ShownCell:
    """Return a cell of a row with the classes of its column."""
    value = row[column.name]
    if column.kind == "state":
        return ShownCell(STATE_SIGNS.get(str(value), str(value)), kind, str(value))
    return ShownCell(text_of(answer, column, row), kind)


def text_of(answer: Answer, column: Column, row: Mapping[Any, Any]) -> str:
    """Return what a cell says, without the unit of its head."""
    value = row[column.name]
    if _missing(value) and column.kind != "bounded":
        return "–"
    if column.kind == "level":
        return _level_text(column, value)
    if column.kind == "bounded":
        return _bounded_text(column, row)
    if column.name == "units":
        return unit_text(str(value)).replace("–", "")
    if isinstance(value, str):
        if column.name in WORDS:
            return capital(value)
        return value
    if column.kind in FIGURES:
        return grouped(float(value), FIGURES[column.kind])
    low = float(value)
    high = low
    if column.until and not _missing(row[column.until]):
        high = float(row[column.until])
    return _range_text(answer, column, row, (low, high))


FIGURES = {"count": 12, "whole": 4}  # of a number by the kind of its column


def _range_text(
    answer: Answer, column: Column, row: Mapping[Any, Any], ends: tuple[float, float]
) -> str:
    """Return what a cell says of a number or of a range."""
    if column.kind in ("share", "error"):
        return _percent_range(*ends)
    if column.kind == "ratio":
        return " to ".join(dict.fromkeys(ratio_text(end) for end in ends))
    if column.kind == "life" and ends[0] >= LONG_LIFE:
        return f"> {tick_text(LONG_LIFE)}"
    if column.kind == "years":
        return _years_range(*ends)
    lost = may_be_lost(answer.question, column.units)
    if lost and any(map(math.isinf, ends)):
        return " to ".join(dict.fromkeys(held_text(end) for end in ends))
    return carried_range(*ends, _error_of(row, column), _bounds(answer, column))


def _years_range(low: float, high: float) -> str:
    """Write years from low to high; a low end below a year has no number."""
    ends = (year_text(low), year_text(high))
    if ends[0] == "–" and ends[1] != "–":
        return f"up to {ends[1]}"
    return " to ".join(dict.fromkeys(ends))


def _bounded_text(column: Column, row: Mapping[Any, Any]) -> str:
    """Return a value and the permitted one: '33.4 of 360 MPa'."""
    value = float(row[column.name])
    most = float(row[column.until])
    unit = unit_text(str(row.get("units", ""))).replace("–", "")
    if math.isnan(value):
        if math.isnan(most):
            return "–"
        return f"at most {grouped(most, 3)} {unit}".strip()
    bound = ""
    if math.isfinite(most):
        bound = f" of {grouped(most, 3)}"
    return f"{grouped(value, 3)}{bound} {unit}".strip().replace(" °", "°")


def ratio_text(ratio: float) -> str:
    """Write a ratio: three figures near 1, where small differences count, otherwise two."""
    figures = 2
    if 0.1 <= ratio < 10:
        figures = 3
    return grouped(ratio, figures)


def rows_before_fold(answer: Answer) -> int:
    """Return how many rows stand before the fold; the limits of one roller are never folded."""
    of = len(answer.table)
    if of > MOST_ROWS and answer.question != "roller":
        return FIRST_ROWS
    return of


def _missing(value: Any) -> bool:
    return value is None or (isinstance(value, float) and math.isnan(value))


def _level_text(column: Column, value: Any) -> str:
    if isinstance(value, bool):
        if value:
            return "yes"
        return "no"
    if isinstance(value, str) or column.name in NAMED:
        return level_text(column.name, value)
    return grouped(float(value))


def _percent_range(low: float, high: float) -> str:
    """Return shares in percent; only all is 100 and only none is 0."""
    return " to ".join(dict.fromkeys(_percent(value) for value in (low, high)))


def _percent(value: float) -> str:
    whole = 100 * value
    if math.isinf(whole):
        return grouped(whole)
    if 0 < whole < 1 or 99 < whole < 100:
        figures = 4
        if whole < 1:
            figures = 2
        return grouped(whole, figures)
    if whole >= 1:
        return grouped(float(f"{whole:.0f}"), 12)
    return "0"


def _error_of(row: Mapping[Any, Any], column: Column) -> float:
    """Return the told error of the numbers of a row; it belongs to the output alone."""
    error = row.get("error")
    is_output = column.role == "bar" or column.name in OF_RANGE
    if error is not None and is_output:
        return float(error)
    return math.nan


def _bounds(answer: Answer, column: Column) -> list[float]:
    if column.role != "bar":
        return []
    return bounds_of_output(answer)


def _shared_text(answer: Answer, column: Column, row: Mapping[Any, Any]) -> str:
    text = text_of(answer, column, row)
    if text in ("–", ""):
        return ""
    title = lowered(column.title)
    unit = unit_of(column)
    return f"{title} {text} {unit}".strip().replace(" °", "°")


@dataclass(frozen=True)
class ColumnSplit:
    """Which columns of a table stand on the first screen, and which ones in the proof."""

    shown: tuple[Column, ...]
    others: tuple[Column, ...]


def fit_columns(answer: Answer, bars: int, width: float = PAGE) -> ColumnSplit:
    """Return the columns that fit a width, from the first one on; columns that name a row or are
    drawn stay.
    """
    shared = answer.shared
    left = width - bars * (BARS if bars == 1 else HALF_BARS)
    shown = []
    others = []
    for column in sorted(answer.columns, key=lambda one: not one.role and one.kind != "state"):
        if column.name in shared or _is_hidden(column):
            continue
        needed = _width(answer, column)
        readable = column.kind != "text" or _longest(answer, column) <= LINES * WIDEST
        if column.role or (readable and needed <= left):
            left -= needed
            shown.append(column)
        else:
            others.append(column)
    order = {column.name: place for place, column in enumerate(answer.columns)}
    shown.sort(key=lambda one: order[one.name])
    others.sort(key=lambda one: order[one.name])
    return ColumnSplit(tuple(shown), tuple(others))


def _width(answer: Answer, column: Column) -> float:
    """Return the estimated width of a column [px]; texts wrap, and numbers do not."""
    longest = _longest(answer, column)
    if column.kind == "text" or column.role == "name":
        longest = max(min(longest, WRAPPED), longest // LINES)
    if column.kind == "state":
        signs = [len(STATE_SIGNS.get(str(state), "")) for state in answer.table[column.name]]
        longest = max(signs, default=0)
    heads = [len(word) for word in (*column.title.split(), unit_of(column))]
    return LETTER * max(longest, *heads) + GAP


def _longest(answer: Answer, column: Column) -> int:
    """Return the letters of the longest cell of a column."""
    texts = [
        text_of(answer, column, row) for row in answer.table.head(MOST_SHOWN).to_dict("records")
    ]
    return max([len(text) for text in texts], default=1)


def definitions(answer: Answer) -> Iterator[tuple[str, str]]:
    """Yield each column with its definition."""
    for column in answer.columns:
        if column.meaning and column.role != IN_FILES:
            unit = unit_of(column)
            title = capital(column.title)
            heading = title
            if unit:
                heading = f"{title} [{unit}]"
            yield heading, capital(column.meaning)


def ends_table(answer: Answer) -> tuple[list[str], list[list[str]], str]:
    """Return heads and rows of the counts of what ends the cases, and what ends all of them if that
    is one thing.
    """
    ends = answer.ends
    if ends.empty:
        return [], [], ""
    limits = [str(name) for name in ends.columns if name not in ("factor", "level")]
    rows = ends.to_dict("records")
    ending = [limit for limit in limits if int(rows[0][limit]) > 0]
    if len(ending) == 1:
        return [], [], f"{grouped(float(rows[0][ending[0]]), 12)} cases: {ending[0]}"
    shown = []
    last = ""
    for row in rows:
        factor = capital(str(row["factor"]))
        if isinstance(row["level"], str):
            level = row["level"]
        else:
            level = grouped(float(row["level"]))
        counts = [grouped(float(row[limit]), 12) for limit in ending]
        factor_cell = factor
        if factor == last:
            factor_cell = ""
        shown.append([factor_cell, level, *counts])
        last = factor
    return ["Factor", "Level", *(capital(limit) for limit in ending)], shown, ""
