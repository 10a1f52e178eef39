"""A picture of an answer with its words, and the names of the rows that it draws."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from markupsafe import Markup

from trackroller.report.numbers import grouped, level_text, unit_text
from trackroller.report.pictures.frame import left_out_words
from trackroller.results.answer import Answer, Column
from trackroller.study.design.levels import NAMED


@dataclass(frozen=True)
class Picture:
    """A picture with what it draws in words, and whether it stands beside the table."""

    drawn: Markup
    caption: str
    beside: bool = False


def caption_of(data: Mapping[str, Any], words: str) -> str:
    """Return what a picture draws: the words of the record if it has some, otherwise those of the
    picture.
    """
    parts = [data.get("caption") or words, left_out_words(data)]
    return " ".join(part for part in parts if part)


def row_names(answer: Answer, count: int) -> list[str]:
    """Return the names of the first rows of the table of an answer, each another one."""
    columns = [column for column in answer.columns if column.role == "name"]
    names: list[str] = []
    for place in range(min(count, len(answer.table))):
        row = answer.table.iloc[place]
        text = ", ".join(_level_words(column, row[column.name]) for column in columns)
        if text and text not in names:
            words = text
        else:
            words = f"{text} ({place + 1})".strip()
        names.append(words)
    return names


def _level_words(column: Column, value: Any) -> str:
    if isinstance(value, str) or column.name in NAMED:
        return level_text(column.name, value)
    return (
        f"{grouped(float(value))} {unit_text(column.units)}".replace("–", "")
        .strip()
        .replace(" °", "°")
    )
