"""The blocks of a page that shows an answer: title line, headline, table, picture, what was not
checked, warnings.

`screen_of` makes them from the record, and `templates/blocks.html.j2` writes them. Study, sheet,
spectrum, carriage and wear take the same blocks.
"""

from __future__ import annotations

import base64
import csv
import io
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from markupsafe import Markup

from trackroller.damage import checked_limits
from trackroller.files import inert_cell
from trackroller.report.headlines import WARNING_HEADS, headline_of, warning_rows
from trackroller.report.numbers import carried, count, long_name, on_duty, plain, unit_text
from trackroller.report.pictures import curves
from trackroller.report.pictures.bars import Bars
from trackroller.report.pictures.first_screen import picture_of
from trackroller.report.pictures.pairs_map import map_of
from trackroller.report.pictures.picture import row_names
from trackroller.report.pictures.uses import UseBars
from trackroller.report.tables.rows import (
    MOST_SHOWN,
    ShownTable,
    definitions,
    ends_table,
    fit_columns,
    rows_before_fold,
    rows_of,
)
from trackroller.results.answer import Answer, FurtherTable

MOST_TRANSPOSED = 4  # rows of a table that may stand beside its picture as columns
MOST_EFFECTS = 4  # of the first screen; the others stand under Why
MOST_DOWNLOADED = 5000  # rows of a table that a page holds as a file


@dataclass(frozen=True)
class Drawn:
    """A column of bars.

    Attributes
    ----------
    head : the axis of its head
    rows : one bar a row
    title, unit, meaning : of its head
    place : column before which the bars stand
    """

    head: Markup
    rows: tuple[Markup, ...]
    title: str
    unit: str
    meaning: str
    place: int


@dataclass(frozen=True)
class Shown:
    """A table as a page shows it.

    Attributes
    ----------
    rows : heads and cells
    bars : its columns of bars
    key : what the marks of a bar mean
    first : rows before the fold
    of : all rows of the answer
    """

    rows: ShownTable
    bars: tuple[Drawn, ...]
    key: tuple[tuple[Markup, str], ...]
    first: int
    of: int


def screen_of(answer: Answer) -> dict[str, Any]:
    """Return what the template of the blocks needs.

    Parameters
    ----------
    answer : Answer
        The record.

    Returns
    -------
    dict
        `title`, `description`, `facts`, `headline`, `table`, `others` (columns that do not fit),
        `transposed`, `shared`, `picture`, `effects`, `effects_first`, `effects_caption`, `map`,
        `not_checked`, `not_used`, `not_given`, `warnings`, `ends`, `outputs`, `definitions`,
        `limits` (their words and what they mean), `parts` (further tables with their rows),
        `download`.
    """
    with on_duty(answer.facts.get("duty")):
        picture = picture_of(answer)
        shown = table_of(answer)
        beside = picture is not None and picture.beside
        effects = curves.effects(answer)
        first = 0
        if _curves_are_the_picture(answer, picture is not None or bool(shown.bars)):
            first = MOST_EFFECTS
        transposed = []
        if beside:
            transposed = transposed_names(answer)
        caption = ""
        if effects:
            caption = curves.caption(answer)
        return {
            "title": str(answer.facts.get("name", "")),
            "description": str(answer.facts.get("description") or ""),
            "facts": facts_line(answer),
            "headline": headline_of(answer),
            "table": shown,
            "others": _others(answer),
            "transposed": transposed,
            "shared": shown.rows.shared,
            "picture": picture,
            "effects_first": effects[:first],
            "effects": effects[first:],
            "effects_caption": caption,
            "map": map_of(answer),
            "not_checked": answer.not_checked,
            "not_used": {plain(name): why for name, why in answer.not_used.items()},
            "not_given": {long_name(name): value for name, value in answer.not_given.items()},
            "warnings": warnings_of(answer),
            "ends": ends_table(answer),
            "outputs": _outputs(answer),
            "definitions": list(definitions(answer)),
            "limits": [
                (limit.word, limit.title) for limit in checked_limits() if limit.word != limit.title
            ],
            "parts": [(part, part_rows(answer, part)) for part in answer.parts],
            "download": download_of(answer),
            "output_heads": OUTPUT_HEADS,
        }


OUTPUT_HEADS = ("Output", "Unit", "Smallest", "Median", "Largest")


def _outputs(answer: Answer) -> list[tuple[str, ...]]:
    """Return the ranges of the outputs as texts; none where the table of the answer shows them."""
    if answer.question == "how it behaves" or answer.outputs.empty:
        return []
    rows = answer.outputs.to_dict("records")
    numbers = ("smallest", "median", "largest")
    return [
        (row["output"], unit_text(row["units"]), *(carried(row[name]) for name in numbers))
        for row in rows
    ]


def transposed_names(answer: Answer) -> list[str]:
    """Return the names of the rows that stand as columns beside a picture: those of the
    headline.
    """
    named = len(answer.picture.get("named", ())) or len(answer.table)
    return row_names(answer, min(named, len(answer.table), MOST_TRANSPOSED))


def _curves_are_the_picture(answer: Answer, other: bool) -> bool:
    """Return whether effect curves are the picture of the first screen."""
    return answer.question == "what matters" or not other


def facts_line(answer: Answer) -> str:
    """Return the line below the title: question, date, size, models, accuracy."""
    facts = answer.facts
    sizes = []
    candidates = facts.get("candidates") or 0
    if candidates > 1:
        sizes.append(f"{count(candidates)} candidates")
    conditions = _conditions(facts.get("conditions"))
    if conditions:
        drawn = ""
        if facts.get("drawn"):
            drawn = "drawn "
        sizes.append(f"{conditions} {drawn}conditions")
    counted = facts.get("counted", "cases")
    cases = ""
    if facts.get("cases", 0) > 1:
        cases = f"{count(facts['cases'])} {counted}"
    size = cases
    if cases and sizes:
        size = f"{cases}: {', '.join(sizes)}"
    models = facts.get("models", "")
    if not isinstance(models, str):
        models = ", ".join(map(str, models))
    parts = [
        answer.question,
        str(facts.get("date") or "")[:10],
        size,
        models,
        str(facts.get("accuracy") or ""),
    ]
    return " · ".join(part for part in parts if part)


def _conditions(number: Any) -> str:
    """Return how many conditions candidates have, as one number or as a range; '' for one
    condition.
    """
    if isinstance(number, int):
        ends = [number, number]
    else:
        ends = list(number or ())
    if not ends or max(ends) < 2:
        return ""
    return " to ".join(dict.fromkeys(count(end) for end in ends))


def table_of(answer: Answer) -> Shown:
    """Return the table of an answer with its bars; columns that do not fit the page are left to the
    proof.
    """
    fit = fit_columns(answer, _bar_columns(answer))
    rows = rows_of(answer, fit.shown)
    names = [column.name for column in fit.shown]
    bars = Bars.of(answer)
    key: tuple[tuple[Markup, str], ...] = ()
    if bars:
        key = tuple(bars.key())
    return Shown(
        rows, tuple(_drawn(answer, names)), key, rows_before_fold(answer), len(answer.table)
    )


def _bar_columns(answer: Answer) -> int:
    """Return how many columns of bars a table has."""
    return len([one for one in (UseBars.of(answer), Bars.of(answer)) if one is not None])


def _drawn(answer: Answer, names: Sequence[str]) -> Iterator[Drawn]:
    """Yield the columns of bars of a table, which has columns of these names."""
    records = answer.table.head(MOST_SHOWN).to_dict("records")
    uses = UseBars.of(answer)
    if uses is not None:
        own = uses.column
        drawn = tuple(uses.row(row) for row in records)
        yield Drawn(uses.head(), drawn, own.title, "%", own.meaning, names.index(own.name) + 1)
    bars = Bars.of(answer)
    if bars is not None:
        place = next((i for i, name in enumerate(names) if name in bars.columns), len(names))
        meaning = "; ".join(column.meaning for column in bars.columns.values() if column.meaning)
        drawn = tuple(bars.row(row) for row in records)
        yield Drawn(bars.head(), drawn, bars.title, bars.units, meaning, place + (uses is not None))


def part_rows(answer: Answer, part: FurtherTable) -> ShownTable:
    """Return heads and cells of a further table of an answer."""
    return rows_of(replace(answer, table=part.table, columns=part.columns, required=()))


def _others(answer: Answer) -> ShownTable | None:
    """Return the columns that do not fit the first screen, with the names of their rows."""
    fit = fit_columns(answer, _bar_columns(answer))
    if not fit.others:
        return None
    names = [column for column in fit.shown if column.role == "name"]
    return rows_of(answer, [*names, *fit.others])


def warnings_of(answer: Answer) -> list[tuple[str, str, str]]:
    """Return the warnings: head, rows, where."""
    return [(WARNING_HEADS[one.code], warning_rows(one), one.where) for one in answer.warnings]


def download_of(answer: Answer) -> str:
    """Return the table of an answer as a link to a CSV file with all digits; '' if it is too long
    for a page.
    """
    if len(answer.table) > MOST_DOWNLOADED:
        return ""
    text = io.StringIO()
    writer = csv.writer(text)
    for row in (answer.table.columns.to_list(), *answer.table.to_numpy(object).tolist()):
        writer.writerow([inert_cell(value) for value in row])
    return f"data:text/csv;base64,{base64.b64encode(text.getvalue().encode()).decode('ascii')}"


def empty_proof() -> dict[str, Any]:
    """Return the proof of a page that has no study behind it."""
    lists = dict.fromkeys(("base", "materials", "solution", "tables", "doubts", "record"), ())
    return {"notice": "", "factors": None, "study_text": "", "used": None, **lists}
