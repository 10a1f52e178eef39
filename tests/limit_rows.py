"""Rows of the record of one roller, for tests."""

from __future__ import annotations

from typing import Any

from trackroller.report.headlines import headline_of
from trackroller.results.answer import Answer


def limit_row(answer: Answer, name: str, body: str) -> dict[str, Any]:
    """Return the row of a limit for a body; a row of both bodies is that of each."""
    rows = answer.table.to_dict("records")
    return next(row for row in rows if row["name"] == name and row["body"] in (body, "roller and guide"))


def part_of(answer: Answer, name: str) -> Any:
    """Return a further table of a record as a data frame."""
    return next(part.table for part in answer.parts if part.name == name)


def headline(answer: Answer) -> str:
    """Return the headline of a record."""
    return headline_of(answer).text
