"""The table of an answer: heads, cells as texts and numbers, what all rows share, and what does not fit the page."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from trackroller.report.numbers import (
    capital,
    carried_range,
    head_unit,
    level_text,
    number,
    unit_text,
)
from trackroller.results.answer import Answer, Column
from trackroller.study.design.levels import NAMED

STATE_SIGNS = {"met": "● met", "open": "◐ open", "missed": "✕ missed", "none": "– none"}
MOST_ROWS = 15  # of a table that stands on a page whole
FIRST_ROWS = 12  # of a longer one, before the fold
FOLDED_ROWS = 200  # of a longer one, behind the fold; the others stand in the files
PAGE = 1120.0  # width of a table on a page [px]
BARS = 210.0  # width of the bars of a table [px]
GAP = 17.0  # between two columns [px]
LETTER = 7.3  # mean width of a letter of a table [px]
WRAPPED = 26  # letters of a line of a text in a table
NARROW_KINDS = ("ratio", "error")  # that a card of a narrow screen leaves out
NARROW_NAMES = ("median", "best")
UNDRAWN = ("best",)  # columns that are drawn and not written


@dataclass(frozen=True)
class Head:
    """The head of a column: title, unit, definition, and its classes."""

    name: str
    title: str
    unit: str
    meaning: str
    kind: str


@dataclass(frozen=True)
class Cell:
    """A cell: what it says, and its classes."""

    text: str
    kind: str
    state: str = ""


@dataclass(frozen=True)
class Rows:
    """The table of an answer as it is shown.

    Attributes
    ----------
    heads : of its columns
    cells : of its rows
    shared : what all rows share, in words
    """

    heads: tuple[Head, ...]
    cells: tuple[tuple[Cell, ...], ...]
    shared: tuple[str, ...]


def rows_of(answer: Answer, columns: Iterable[Column] | None = None) -> Rows:
    """Return the table of an answer; columns that are equal in all rows are said once."""
    shared = answer.shared
    every = tuple(answer.columns) if columns is None else tuple(columns)
    shown = [one for one in every if one.name not in shared and one.name not in UNDRAWN]
    records = answer.table.to_dict("records")
    cells = tuple(tuple(cell_of(answer, column, row) for column in shown) for row in records)
    first = records[0] if records else {}
    said = [_shared_text(answer, column, first) for column in answer.columns if column.name in shared]
    return Rows(tuple(head_of(answer, column) for column in shown), cells, tuple(text for text in said if text))


def head_of(answer: Answer, column: Column) -> Head:
    """Return the head of a column."""
    return Head(column.name, column.title, unit_of(column), column.meaning, classes_of(answer, column))


def unit_of(column: Column) -> str:
    """Return the unit of a column as its head shows it."""
    if column.name in NAMED and column.role == "name":
        return ""
    signs = {"share": "%", "ratio": "×", "error": "± %"}
    unit = column.units or signs.get(column.kind, "")
    if unit == "h":
        return head_unit("h")
    return unit_text(unit).replace("–", "")


def classes_of(answer: Answer, column: Column) -> str:
    """Return the classes of a column: aligned to the right, one line, left out in a card."""
    classes = []
    if _is_number(answer, column):
        classes.append("n")
    elif column.kind == "state":
        classes.append("v")
    elif column.role == "name":
        classes.append("s")
    if column.kind in NARROW_KINDS or column.name in NARROW_NAMES:
        classes.append("z")
    if column.role == "name":
        classes.append("u")
    return " ".join(classes)


def _is_number(answer: Answer, column: Column) -> bool:
    if column.kind in ("state", "text"):
        return False
    if column.kind != "level":
        return True
    return not any(isinstance(value, str) for value in answer.table[column.name])


def cell_of(answer: Answer, column: Column, row: Mapping[Any, Any]) -> Cell:
    """Return a cell of a row."""
    value = row[column.name]
    kind = classes_of(answer, column)
    if column.kind == "state":
        return Cell(STATE_SIGNS.get(str(value), str(value)), kind, str(value))
    return Cell(text_of(answer, column, row), kind)


def text_of(answer: Answer, column: Column, row: Mapping[Any, Any]) -> str:
    """Return what a cell says, without the unit of its head."""
    value = row[column.name]
    if _missing(value):
        return "–"
    if column.kind == "level":
        return _level_text(column, value)
    if isinstance(value, str):
        return value
    if column.kind == "count":
        return number(float(value), 12)
    low = float(value)
    high = float(row[column.until]) if column.until and not _missing(row[column.until]) else low
    if column.kind in ("share", "error"):
        return _percent_range(low, high)
    if column.kind == "ratio":
        return carried_range(low, high, COARSE_RATIO)
    return carried_range(low, high, _error_of(row, column), _bounds(answer, column))


COARSE_RATIO = 1.0  # a ratio is written with two figures


def _missing(value: Any) -> bool:
    return value is None or (isinstance(value, float) and math.isnan(value))


def _level_text(column: Column, value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, str) or column.name in NAMED:
        return level_text(column.name, value)
    return number(float(value))


def _percent_range(low: float, high: float) -> str:
    """Return shares in percent; only all is 100 and only none is 0."""
    return " to ".join(dict.fromkeys(_percent(value) for value in (low, high)))


def _percent(value: float) -> str:
    whole = 100 * value
    if math.isinf(whole):
        return number(whole)
    if 0 < whole < 1 or 99 < whole < 100:
        return number(whole, 2 if whole < 1 else 4)
    return number(float(f"{whole:.0f}"), 12) if whole >= 1 else "0"


def _error_of(row: Mapping[Any, Any], column: Column) -> float:
    """Return the told error of the numbers of a row; it belongs to the output alone."""
    error = row.get("error")
    return float(error) if error is not None and column.role == "bar" else math.nan


def _bounds(answer: Answer, column: Column) -> list[float]:
    if column.role != "bar":
        return []
    return [end for one in answer.required if one.output == answer.output[0] for end in (one.least, one.most)]


def _shared_text(answer: Answer, column: Column, row: Mapping[Any, Any]) -> str:
    text = text_of(answer, column, row)
    if text in ("–", ""):
        return ""
    title = column.title[:1].lower() + column.title[1:] if column.title[1:2].islower() else column.title
    unit = unit_of(column)
    return f"{title} {text} {unit}".strip().replace(" °", "°")


@dataclass(frozen=True)
class Fit:
    """Which columns of a table stand on the first screen, and which ones in the proof."""

    shown: tuple[Column, ...]
    others: tuple[Column, ...]


def fit_columns(answer: Answer, bars: bool, width: float = PAGE) -> Fit:
    """Return the columns that fit a width, from the first one on; columns that name a row or are drawn stay."""
    shared = answer.shared
    left = width - (BARS if bars else 0.0)
    shown, others = [], []
    for column in sorted(answer.columns, key=lambda one: not one.role and one.kind != "state"):
        if column.name in shared or column.name in UNDRAWN:
            continue
        needed = _width(answer, column)
        if column.role or needed <= left:
            left -= needed
            shown.append(column)
        else:
            others.append(column)
    order = {column.name: place for place, column in enumerate(answer.columns)}
    shown.sort(key=lambda one: order[one.name])
    others.sort(key=lambda one: order[one.name])
    return Fit(tuple(shown), tuple(others))


def _width(answer: Answer, column: Column) -> float:
    """Return the estimated width of a column [px]; texts wrap, and numbers do not."""
    texts = [text_of(answer, column, row) for row in answer.table.to_dict("records")]
    longest = max([len(text) for text in texts], default=1)
    if column.kind == "text":
        longest = min(longest, WRAPPED)
    if column.kind == "state":
        longest = len("✕ missed")
    heads = [len(word) for word in (*column.title.split(), unit_of(column))]
    return LETTER * max(longest, *heads) + GAP


def definitions(answer: Answer) -> Iterator[tuple[str, str]]:
    """Yield each column with its definition."""
    for column in answer.columns:
        if column.meaning:
            unit = unit_of(column)
            yield (f"{column.title} [{unit}]" if unit else column.title), column.meaning


def ends_table(answer: Answer) -> tuple[list[str], list[list[str]], str]:
    """Return heads and rows of the counts of what ends the cases, and what ends all of them if that is one thing."""
    ends = answer.ends
    if ends.empty:
        return [], [], ""
    limits = [str(name) for name in ends.columns if name not in ("factor", "level")]
    first = ends[ends["factor"] == ends["factor"].iloc[0]]
    totals = {limit: int(first[limit].sum()) for limit in limits}
    ending = [limit for limit in limits if totals[limit] > 0]
    if len(ending) == 1:
        return [], [], f"{number(totals[ending[0]], 12)} cases: {ending[0]}"
    titles = {curve.factor: (curve.title, curve.units) for curve in answer.curves}
    rows = []
    for row in ends.to_dict("records"):
        name = str(row["factor"])
        title, units = titles.get(name, (capital(name.replace("_", " ")), ""))
        level = _level_text(Column(name, title), row["level"])
        unit = "" if name in NAMED or isinstance(row["level"], str) else unit_text(units).replace("–", "")
        rows.append([title, f"{level} {unit}".strip(), *(number(float(row[limit]), 12) for limit in ending)])
    return ["Factor", "Level", *(capital(limit) for limit in ending)], rows, ""
