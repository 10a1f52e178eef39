"""Split the text of a CSV file into the cells of its lines.

Semicolons, tabs, bars or commas separate the cells: the first of these that stands in the line of names. A line
`sep=;`, which Excel understands, may say it instead.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator
from pathlib import Path

from trackroller.errors import InputError
from trackroller.numerics.table_cells import SEPARATORS, Refused, stated_separator


def csv_lines(text: str, path: Path, field: str) -> tuple[Iterator[tuple[int, list[str]]], str]:
    """Return numbers and cells of the lines of a CSV file, and the character between its cells.

    Spaces around a cell are left out. A cell that holds a formula, or that has swallowed the next lines because a
    quotation mark is missing, is `Refused`.

    Parameters
    ----------
    text : str
        Content of the file.
    path : Path
        Its path, for messages.
    field : str
        Key of the study or spectrum that names the file, for messages.

    Raises
    ------
    InputError
        While the lines are read, if a quotation mark is missing or a cell is too long.
    """
    text = re.sub(r"\s*\x1a\s*\Z", "\n", text)  # Ctrl-Z, the end of a file of DOS
    lines = (line.strip(" \r\n") for line in io.StringIO(text, newline=None))
    first = next(lines, "")
    stated = stated_separator(first)
    if not stated and re.match(r'"?sep=', first, re.IGNORECASE):
        allowed = "sep= and the character between the cells, such as sep=;"
        raise InputError(field, first, allowed, "Correct or remove this line.").at(path, 1)
    if not stated and first[:1] not in ("", "#"):
        return _lines(text, path, field, _separator(first)), _separator(first)
    head = next((line for line in lines if line.strip() and line.strip()[0] != "#"), "")
    separator = stated or _separator(head)
    return _lines(text, path, field, separator, bool(stated)), separator


def _separator(head: str) -> str:
    unquoted = re.sub(r'"[^"]*"', "", head)
    return next((sign for sign in SEPARATORS if sign in unquoted), ",")


def _lines(
    text: str, path: Path, field: str, separator: str, skip_first: bool = False
) -> Iterator[tuple[int, list[str]]]:
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=separator, strict=True)
    try:
        for row in reader:
            if not (skip_first and reader.line_num == 1):
                yield reader.line_num, [_cell(cell, separator) for cell in row]
    except csv.Error as exc:
        remedy = 'Close the quotation marks; write one within a text twice: "".'
        remedy = "Shorten its cells." if "limit" in str(exc) else remedy
        error = InputError(field, str(path), "a CSV file", remedy, f"cannot be read as CSV ({exc})")
        raise error.at(path, reader.line_num) from None


def _cell(cell: str, separator: str) -> str:
    cell = cell.strip()
    if cell[:1] == "=":
        return Refused(cell, "a value; this is a formula", "Write its value.")
    if "\n" in cell and separator in cell:
        return Refused(cell, "the text of one cell; this one goes over several lines", "Close its quotation marks.")
    return cell
