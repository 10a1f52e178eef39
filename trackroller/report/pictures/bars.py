"""Bars of a table: one axis for all rows, worst, median and best of a candidate or a share with its
interval.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from markupsafe import Markup

from trackroller.report.numbers import (
    NOT_HELD,
    capital,
    carried_range,
    grouped,
    may_be_lost,
    unit_text,
)
from trackroller.report.pictures.axis import Axis
from trackroller.report.pictures.frame import bounds_of
from trackroller.report.pictures.marks import (
    dot,
    element,
    joined,
    label,
    line,
    picture,
    upright,
    width_of,
)
from trackroller.results.answer import Answer, Column

LENGTH = 190.0  # smallest width of the bars of a table [px]
SHORT = 115.0  # the same where a table has two columns of bars
ROW = 24  # height of a bar [px]
DIFFERENT = 0.6  # of the axis [%]: ends that differ by less are one dot
COLOURS = {"met": "cm", "open": "co", "missed": "cx", "none": "cx"}  # classes by the state
COLOURS |= {"kept": "cm", "finite": "cm", "exceeded": "cx", "unknown": "cg"}


@dataclass(frozen=True)
class Bars:
    """The bars of a table.

    Attributes
    ----------
    title, units : of the axis
    axis : one axis for all rows
    columns : columns of role `bar` by their name
    shares : whether they are shares, which are drawn from 0 to 100 %
    bounds : required values with their words
    state : column of the state, which colours the bars; '' without one
    length : smallest width, into which the ticks of the head have to fit [px]
    loses : whether an infinite number is that of a condition that is not held
    """

    title: str
    units: str
    axis: Axis
    columns: Mapping[str, Column]
    shares: bool
    bounds: tuple[tuple[float, str], ...]
    state: str = ""
    length: float = LENGTH
    loses: bool = False

    @classmethod
    def of(cls, answer: Answer) -> Bars | None:
        """Return the bars of an answer, None if its table has no column of role `bar`."""
        columns = drawn_columns(answer)
        if not columns or answer.table.empty:
            return None
        state = next((column.name for column in answer.columns if column.kind == "state"), "")
        shares = all(column.kind == "share" for column in columns.values())
        first = next(iter(columns.values()))
        if shares:
            return cls(capital(first.title), "%", Axis(0.0, 1.0), columns, True, (), state)
        bounds = tuple(bounds_of(answer))
        names = [
            name for column in columns.values() for name in (column.name, column.until) if name
        ]
        values = answer.table[names].to_numpy(dtype=float).ravel()
        axis = Axis.of([*values, *(value for value, _ in bounds)])
        unit = unit_text(answer.output[2]).replace("–", "")
        length = LENGTH
        if any(column.role == "use" for column in answer.columns):
            length = SHORT
        loses = may_be_lost(answer.question, answer.output[2])
        title = capital(answer.output[1])
        return cls(title, unit, axis, columns, False, bounds, state, length, loses)

    def head(self) -> Markup:
        """Return the axis that stands in the head of the table."""
        if self.shares:
            ticks = [(share, f"{100 * share:.0f}") for share in (0.0, 0.25, 0.5, 0.75, 1.0)]
        else:
            ticks = self.axis.ticks(self.length)
        parts = [self._tick(value, text) for value, text in ticks]
        parts += [self._bound(value, text) for value, text in self.bounds[:1]]
        return element("svg", joined(parts), height=28, aria_hidden="true")

    def _tick(self, value: float, text: str) -> Markup:
        place = self.axis.place(value)
        anchor = {0.0: "start", 100.0: "end"}.get(place, "middle")
        return label(text, place, "24", anchor)

    def _bound(self, value: float, text: str) -> Markup:
        place = self.axis.place(value)
        reach = 50 * width_of(text) / self.length
        if place < reach:
            anchor = "start"
        else:
            anchor = "middle"
            if place > 100 - reach:
                anchor = "end"
        return label(text, place, "10", anchor, "rt")

    def row(self, row: Mapping[Any, Any]) -> Markup:
        """Return the bar of a row."""
        colour = COLOURS.get(str(row.get(self.state, "")), "cm")
        grid = [upright("g", self.axis.place(value)) for value in self._grid()]
        required = [upright("r", self.axis.place(value)) for value, _ in self.bounds]
        if self.shares:
            marks = self._share_marks(row)
        else:
            marks = self._range_marks(row)
        return picture(joined([*grid, *required, *marks]), ROW, self.words(row), colour)

    def _grid(self) -> list[float]:
        """Return where lines cross the rows: at each power of ten, or at the ticks."""
        if self.shares:
            return [0.0, 0.25, 0.5, 0.75, 1.0]
        powers = self.axis.powers()
        if len(powers) > 1:
            return powers
        return [value for value, _ in self.axis.ticks(self.length)]

    def _share_marks(self, row: Mapping[Any, Any]) -> Iterator[Markup]:
        for column in self.columns.values():
            low = float(row[column.name])
            if math.isnan(low):
                continue
            if column.until:
                yield line(
                    "q",
                    self.axis.place(low),
                    "50%",
                    self.axis.place(float(row[column.until])),
                    "50%",
                )
            else:
                yield line("w", 0.0, "50%", self.axis.place(low), "50%")

    def _range_marks(self, row: Mapping[Any, Any]) -> Iterator[Markup]:
        """Yield the best condition as a line, the range of the worst one as a bar, the median as a
        stroke.
        """
        first = next(iter(self.columns.values()))
        low = float(row[first.name])
        high = low
        if first.until:
            high = float(row[first.until])
        best = float(row.get("best", math.nan))
        if not (math.isnan(best) or math.isnan(low) or self._is_lost(low)):
            yield line("t", self.axis.place(low), "50%", self.axis.place(best), "50%")
        if not math.isnan(low) and not self._is_lost(low):
            start = self.axis.place(low)
            end = start
            if not math.isnan(high):
                end = self.axis.place(high)
            if end - start < DIFFERENT:
                yield dot("d", start, "50%", 4.5)
            else:
                yield line("w", start, "50%", end, "50%")
        median = math.nan
        if "median" in self.columns:
            median = float(row["median"])
        if not math.isnan(median):
            yield line("q", self.axis.place(median), "25%", self.axis.place(median), "75%")

    def words(self, row: Mapping[Any, Any]) -> str:
        """Return the numbers of a bar in words."""
        texts = []
        for column in self.columns.values():
            low = float(row[column.name])
            if math.isnan(low):
                continue
            high = low
            if column.until:
                high = float(row[column.until])
            if self.shares:
                text = " to ".join(dict.fromkeys((grouped(100 * low, 3), grouped(100 * high, 3))))
                texts.append(f"{column.title} {text} %")
            else:
                text = f"{carried_range(low, high)} {self.units}".rstrip()
                if self._is_lost(low):
                    text = NOT_HELD
                texts.append(f"{column.title} {text}")
        return ", ".join(texts) or "unknown"

    def _is_lost(self, value: float) -> bool:
        """Return whether a value is that of a condition that is not held, which has no place on the
        axis; a life may be unlimited.
        """
        return self.loses and math.isinf(value)

    def key(self) -> list[tuple[Markup, str]]:
        """Return the marks of a bar with their words."""
        if self.shares:
            drawn = [column for column in self.columns.values() if column.until]
            return [
                (_sample(line("q", 8, "50%", 92, "50%")), f"{column.title} interval")
                for column in drawn
            ]
        first = next(iter(self.columns.values()))
        marks = [(_sample(dot("d", 50, "50%", 4.5)), first.title.lower())]
        if first.until:
            marks.append((_sample(line("w", 8, "50%", 92, "50%")), "its low to high"))
        if "median" in self.columns:
            marks.append((_sample(line("q", 50, "0", 50, "100%")), "median"))
        if "best" in self.columns:
            marks.append((_sample(line("t", 0, "50%", 100, "50%")), "to the best condition"))
        if self.bounds:
            marks.append((_sample(upright("r", 50)), "required"))
        return marks


def drawn_columns(answer: Answer) -> dict[str, Column]:
    """Return the columns that the bars of a table draw: those of role `bar`, otherwise those of a
    share.
    """
    bars = [column for column in answer.columns if column.role == "bar"]
    if not bars:
        bars = [column for column in answer.columns if column.kind == "share"]
    return {column.name: column for column in bars}


def _sample(mark: Markup) -> Markup:
    return element("svg", mark, class_="cm", width=26, height=12, aria_hidden="true")
