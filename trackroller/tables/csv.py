"""Split the text of a CSV file into the cells of its lines.

Semicolons, tabs, bars or commas separate the cells: the first of these that stands in the line of
names. A line `sep=;`, which Excel understands, may say it instead. Blanks separate the cells of
files that may have them.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator
from pathlib import Path

from trackroller.errors import InputError
from trackroller.files import cell_as_meant
from trackroller.numerics.table_cells import SEPARATORS, RefusedCell, is_number, stated_separator

BLANK = " "
_QUOTED = re.compile(r'"[^"]*"')
_WORD = re.compile(r'"([^"]*)"|(\S+)')
_END_OF_DOS = re.compile(r"\s*\x1a\s*\Z")  # Ctrl-Z


def csv_lines(
    text: str, path: Path, field: str, blanks: bool = False
) -> tuple[Iterator[tuple[int, list[str]]], str]:
    """Return numbers and cells of the lines of a CSV file, and the character between its cells.

    Spaces around a cell are left out. A cell that holds a formula, or that has swallowed the next
    lines because a quotation mark is missing, is `RefusedCell`.

    Parameters
    ----------
    text : str
        Content of the file.
    path : Path
        Its path, for messages.
    field : str
        Key of the study or spectrum that names the file, for messages.
    blanks : bool
        Whether blanks may separate the cells.

    Raises
    ------
    InputError
        While the lines are read, if a quotation mark is missing or a cell is too long.
    """
    text = _END_OF_DOS.sub("\n", text)
    first = next(_lines(text), "")
    stated = stated_separator(first)
    if stated:
        return _cells(text, path, field, stated, skip_first=True), stated
    if re.match(r'"?sep=', first, re.IGNORECASE):
        allowed = "sep= and the character between the cells, such as sep=;"
        raise InputError(field, first, allowed, "Correct or remove this line.").at(path, 1)
    separator = _separator(_head(text), blanks)
    if separator == BLANK:
        return _words(text), separator
    return _cells(text, path, field, separator), separator


def _lines(text: str) -> Iterator[str]:
    """Yield the lines without blanks around them."""
    for line in io.StringIO(text, newline=None):
        yield line.strip(" \r\n")


def _head(text: str) -> str:
    """Return the first line that is neither empty nor a comment; of a file of comments and numbers
    the names.
    """
    for line in _lines(text):
        if line.strip() and not line.startswith("#"):
            return line
    return ""


def _separator(head: str, blanks: bool) -> str:
    """Return what separates the cells of the line of names, or of the first line of numbers."""
    unquoted = _QUOTED.sub("0", head)
    words = unquoted.split()
    if blanks and len(words) > 1 and all(map(is_number, words)):  # maybe with decimal commas
        return BLANK if "\t" not in unquoted else "\t"
    for sign in SEPARATORS:
        if sign in unquoted:
            return sign
    return BLANK if blanks and len(words) > 1 else ","


def _words(text: str) -> Iterator[tuple[int, list[str]]]:
    """Yield the words of each line; a unit in brackets belongs to the name before it, and '#' to
    the word behind it.
    """
    for number, line in enumerate(_lines(text), start=1):
        line = re.sub(r"^#\s*", "#", line)
        line = re.sub(r"\s+(?=[\[(])", "", line)
        yield number, [quoted or bare for quoted, bare in _WORD.findall(line)]


def _cells(
    text: str, path: Path, field: str, separator: str, skip_first: bool = False
) -> Iterator[tuple[int, list[str]]]:
    """Yield number and cells of each line; the number of a cell over several lines is that of its
    last line.
    """
    stream = io.StringIO(text, newline="")
    reader = csv.reader(stream, delimiter=separator, skipinitialspace=True, strict=True)
    try:
        for row in reader:
            if not (skip_first and reader.line_num == 1):
                yield reader.line_num, [_cell(cell, separator) for cell in row]
    except csv.Error as exc:
        remedy = 'Close the quotation marks; write one within a text twice: "".'
        if "limit" in str(exc):
            remedy = "Shorten its cells."
        wrong = f"cannot be read as CSV ({exc})"
        error = InputError(field, str(path), "a CSV file", remedy, wrong)
        raise error.at(path, reader.line_num) from None


def _cell(cell: str, separator: str) -> str:
    """Return a cell without blanks around it, `RefusedCell` if it is no value."""
    cell = cell.strip()
    if cell.startswith("="):
        return RefusedCell(
            cell,
            "a value; this is a formula",
            "Write its value; if it is a name, write ' before it.",
        )
    if "\n" in cell and separator in cell:
        allowed = "the text of one cell; this one goes over several lines"
        return RefusedCell(cell, allowed, "Close its quotation marks.")
    return cell_as_meant(cell)
