"""Bars of how far limits are used: from 0 to 150 %, with a line at 100 %, and both ends of a
range.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from markupsafe import Markup

from trackroller.report.numbers import carried_range
from trackroller.report.pictures.axis import Axis
from trackroller.report.pictures.bars import COLOURS, ROW
from trackroller.report.pictures.marks import element, joined, label, line, picture, upright
from trackroller.results.answer import Answer, Column

FULL = 1.5  # use at the right end of a bar [1]
TICKS = ((0.0, "0"), (0.5, "50"), (1.0, "100"), (1.5, "150"))
DIFFERENT = 0.6  # of the axis [%]: ends that differ by less are one bar from 0


@dataclass(frozen=True)
class UseBars:
    """The bars of the column of role `use`.

    Attributes
    ----------
    column : the low end of the use [1]; `until` names the high end
    state : column of the state, which colours the bars; '' without one
    """

    column: Column
    state: str = ""

    @classmethod
    def of(cls, answer: Answer) -> UseBars | None:
        """Return the bars of an answer, None if its table has no column of role `use`."""
        column = next((one for one in answer.columns if one.role == "use"), None)
        if column is None or answer.table.empty:
            return None
        return cls(column, next((one.name for one in answer.columns if one.kind == "state"), ""))

    @property
    def axis(self) -> Axis:
        """Return the axis of all rows."""
        return Axis(0.0, FULL)

    def head(self) -> Markup:
        """Return the axis that stands in the head of the table."""
        ends = {0.0: "start", FULL: "end"}
        parts = [
            label(text, self.axis.place(use), "24", ends.get(use, "middle")) for use, text in TICKS
        ]
        parts.append(label("100 %", self.axis.place(1.0), "10", "middle", "rt"))
        return element("svg", joined(parts), height=28, aria_hidden="true")

    def row(self, row: Mapping[Any, Any]) -> Markup:
        """Return the bar of a row: from 0 to the use, or from the low to the high end of a
        range.
        """
        low, high = float(row[self.column.name]), float(row[self.column.until])
        grid = [upright("g", self.axis.place(use)) for use, _ in TICKS]
        marks = [*grid, upright("r", self.axis.place(1.0))]
        if not math.isnan(low):
            start, end = self.axis.place(low), self.axis.place(high)
            left = start
            if end - start < DIFFERENT:
                left = 0.0
            marks.append(line("w", left, "50%", end, "50%"))
        if math.isnan(low):
            words = "not known"
        else:
            words = f"{carried_range(100 * low, 100 * high)} % of the limit"
        return picture(joined(marks), ROW, words, COLOURS.get(str(row.get(self.state, "")), "cm"))
