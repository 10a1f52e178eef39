"""Read the tables of users, CSV files and workbooks: a line of names, then lines with one cell for each name.

The columns of a CSV file are separated by commas, or by semicolons or tabs, between which decimal commas are allowed. A
name may have a unit in brackets, such as `axial_force [kN]`, which then stands behind each cell of the column.
"""

from __future__ import annotations

import csv
import datetime
import io
import math
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from trackroller.errors import Collector, InputError
from trackroller.files import MAX_BYTES, read_bytes, read_text
from trackroller.numerics.units import split_quantity
from trackroller.parameters import PARAMETERS
from trackroller.roller.aliases import ALIASES

_DECIMAL_COMMA = re.compile(r"([-+]?\d*),(\d+(?:[eE][-+]?\d+)?)")
_HEAD = re.compile(r"([^\[\]]*?)\s*\[([^\[\]]*)\]")
WITH_UNIT = (*PARAMETERS, "distance")  # columns whose numbers have units


class Rows(NamedTuple):
    """A table of a user: names of the columns, number of their line, and the cells of each further line by number."""

    names: list[str]
    head: int
    lines: dict[int, list[str]]


def read_rows(path: Path, field: str, what: str, wrong: Collector, most: float = MAX_BYTES) -> Rows:
    """Read a CSV file, or the sheet of a workbook whose name ends in .xlsx.

    Lines have their number in the file, the first line being 1. Spaces around a cell and empty lines are left out.

    Parameters
    ----------
    path : Path
        The file.
    field : str
        Key of the study or spectrum that names the file, for messages.
    what : str
        What a line describes, such as 'case'.
    wrong : Collector
        Receives the errors of lines of another length, which are left out.
    most : float
        Largest size of the file [bytes].

    Raises
    ------
    InputError
        If the file is not readable, has only one line, or repeats a name.
    """
    lines, sign = _cells(path, field, what, most)
    found = dict(lines)
    if len(found) < 2:
        raise InputError(field, str(path), f"a table with a line of names and at least one {what}")
    head = next(iter(found))
    names, units = _heads(found.pop(head))
    if len(set(names)) < len(names) or not all(names):
        error = InputError(field, ", ".join(names), "a different name for each column", "Correct the names.")
        raise error.at(path, head)
    for number in [number for number, line in found.items() if len(line) != len(names)]:
        line = found.pop(number)
        hint = "Separate the columns by semicolons if the numbers have decimal commas." if sign == "," else ""
        allowed = f"{len(names)} cells; there are {len(line)}"
        wrong.errors.append(InputError(field, ", ".join(line), allowed, hint).at(path, number))
    if sign != "," or any(units):
        for line in found.values():
            line[:] = [_cell(cell, unit, sign) for cell, unit in zip(line, units, strict=True)]
    return Rows(names, head, found)


def column_names(path: Path, field: str) -> list[str]:
    """Return the names of the columns of a table; [] for an empty one."""
    lines, _ = _cells(path, field, "case", math.inf)
    return next((_heads(line)[0] for _, line in lines), [])


def _cells(path: Path, field: str, what: str, most: float) -> tuple[Iterator[tuple[int, list[str]]], str]:
    """Return the lines that are not empty with their numbers, and the character between the columns."""
    if is_workbook(path):
        lines = workbook_lines(read_bytes(path, field, most), path, field, what)
        return ((number, line) for number, line in lines if any(line)), ";"
    text = read_text(path, field, most)
    head = next((line for line in text.splitlines() if line.strip()), "")
    sign = next((sign for sign in ";\t" if sign in head), ",")
    return _csv_lines(text, path, field, sign), sign


def _csv_lines(text: str, path: Path, field: str, sign: str) -> Iterator[tuple[int, list[str]]]:
    try:
        reader = csv.reader(io.StringIO(text, newline=""), delimiter=sign)
        for row in reader:
            cells = [cell.strip() for cell in row]
            if any(cells):
                yield reader.line_num, cells
    except csv.Error as exc:
        raise InputError(field, str(path), f"a readable CSV file ({exc})", "Shorten its cells.") from None


def _heads(cells: list[str]) -> tuple[list[str], list[str]]:
    """Return the names of the columns and their units; '' for a column whose cells have no unit."""
    parts = [_HEAD.fullmatch(cell) for cell in cells]
    names = [cell if part is None else part[1] for cell, part in zip(cells, parts, strict=True)]
    names = [ALIASES.get(name, name) for name in names]
    pairs = zip(names, parts, strict=True)
    return names, [part[2].strip(" -") if part and name in WITH_UNIT else "" for name, part in pairs]


def _cell(cell: str, unit: str, sign: str) -> str:
    """Return a cell with a decimal point, and with the unit of its column if it has none of its own."""
    if sign != "," and (parts := _DECIMAL_COMMA.fullmatch(cell)):
        cell = f"{parts[1]}.{parts[2]}"
    return f"{cell} {unit}" if unit and cell and not split_quantity(cell) else cell


def is_workbook(path: Path) -> bool:
    """Return whether a path names a workbook, by its ending."""
    return path.suffix.lower() in (".xlsx", ".xlsm")


def workbook_lines(content: bytes, path: Path, field: str, what: str) -> Iterator[tuple[int, list[str]]]:
    """Yield number and cells of the rows of a workbook's only sheet, or of its sheet of cases or blocks.

    The cells of a row end with its last cell that is not empty, or with the width of the first row.

    Parameters
    ----------
    content : bytes
        Content of the file.
    path : Path
        Its path, for messages.
    field : str
        Key of the study or spectrum that names the file, for messages.
    what : str
        What a row describes; of several sheets the one with this name in the plural is read.

    Raises
    ------
    InputError
        If the file is no workbook, has several sheets, holds dates, or openpyxl is missing.
    """
    try:
        import openpyxl  # noqa: PLC0415 - optional, and heavy
    except ImportError:
        remedy = "Install it with `pip install openpyxl`, or save the table as CSV."
        raise InputError(
            field, str(path), "a CSV file, because openpyxl, which reads workbooks, is missing", remedy
        ) from None
    try:
        book = openpyxl.load_workbook(io.BytesIO(content), read_only=True, data_only=True)
    except Exception as exc:  # zipfile, XML and openpyxl raise a dozen kinds
        remedy = "Save it as .xlsx again, or as CSV."
        raise InputError(field, str(path), f"a readable workbook ({exc})", remedy) from None
    sheets = book.worksheets
    named = [sheet for sheet in sheets if sheet.title.lower() in (what, f"{what}s")] or sheets
    if len(named) != 1:
        titles = ", ".join(sheet.title for sheet in sheets)
        raise InputError(field, titles, "a workbook with one sheet", f"Name the sheet that is meant '{what}s'.")
    named[0].reset_dimensions()  # some programs write wrong ones
    width = 0
    for number, row in enumerate(named[0].iter_rows(values_only=True), start=1):
        cells = [_text(value, field, path, number) for value in row]
        while len(cells) > width and not cells[-1]:
            cells.pop()
        cells += [""] * (width - len(cells))
        width = width or len(cells)
        yield number, cells


def _text(value: Any, field: str, path: Path, number: int) -> str:
    """Return a cell as text: numbers with all their figures, '' for an empty cell."""
    if isinstance(value, (datetime.date, datetime.time, datetime.timedelta)):  # Excel makes dates of 1-2 and 3/4
        allowed = "a number or a text; the sheet holds a date"
        raise InputError(field, str(value), allowed, "Give the cell the format of a number or a text.").at(path, number)
    return "" if value is None else str(value).strip()
