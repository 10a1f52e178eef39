"""Read the CSV files of users: a line of names, then lines with one cell for each name.

Columns are separated by commas, or by semicolons or tabs, between which decimal commas are allowed. A name may have a
unit in brackets, such as `axial_force [kN]`, which then stands behind each cell of the column.
"""

from __future__ import annotations

import csv
import io
import re
from pathlib import Path

from trackroller.errors import InputError
from trackroller.parameters import PARAMETERS
from trackroller.roller.aliases import ALIASES

_DECIMAL_COMMA = re.compile(r"([-+]?\d*),(\d+(?:[eE][-+]?\d+)?)")
_HEAD = re.compile(r"([^\[\]]*?)\s*\[([^\[\]]*)\]")
WITH_UNIT = (*PARAMETERS, "distance")  # columns whose numbers have units


def separator(text: str) -> str:
    """Return the character between the columns: a semicolon or tab if the first line has one, otherwise a comma."""
    head = next((line for line in text.splitlines() if line.strip()), "")
    return next((sign for sign in ";\t" if sign in head), ",")


def csv_names(text: str, path: Path | str, field: str) -> list[str]:
    """Return the names of the columns; see `csv_lines`."""
    head = next((line for line in text.splitlines() if line.strip(" ,;\t")), "")
    return csv_lines(f"{head}\n{head}", path, field, "line")[0]


def csv_lines(text: str, path: Path | str, field: str, what: str) -> tuple[list[str], dict[int, list[str]]]:
    """Return the names of the columns, and the cells of each line by its number in the file, the first line being 1.

    Spaces around a cell and empty lines are left out.

    Parameters
    ----------
    text : str
        Content of the file.
    path : Path or str
        Its path, for messages.
    field : str
        Key of the study or spectrum that names the file, for messages.
    what : str
        What a line describes, such as 'case'.

    Raises
    ------
    InputError
        If the file is not readable as CSV, has only one line, repeats a name, or has a line of another length.
    """
    sign = separator(text)
    try:
        reader = csv.reader(io.StringIO(text, newline=""), delimiter=sign)
        cells = ((reader.line_num, [cell.strip() for cell in row]) for row in reader)
        lines = {number: line for number, line in cells if any(line)}
    except csv.Error as exc:
        raise InputError(field, str(path), f"a readable CSV file ({exc})", "Shorten its cells.") from None
    if len(lines) < 2:
        raise InputError(field, str(path), f"a CSV with a line of names and at least one {what}")
    names, units = _heads(lines.pop(next(iter(lines))))
    if len(set(names)) < len(names) or not all(names):
        remedy = f"Correct the first line of {path}."
        raise InputError(field, ", ".join(names), "a different name for each column", remedy)
    for number, line in lines.items():
        if len(line) != len(names):
            hint = "Separate the columns by semicolons if the numbers have decimal commas." if sign == "," else ""
            raise InputError(field, f"{path}, line {number}", f"{len(names)} cells; there are {len(line)}", hint)
    if sign != "," or any(units):
        for line in lines.values():
            line[:] = [_cell(cell, unit, sign) for cell, unit in zip(line, units, strict=True)]
    return names, lines


def _heads(cells: list[str]) -> tuple[list[str], list[str]]:
    """Return the names of the columns and their units; '' for a column whose cells have no unit."""
    parts = [_HEAD.fullmatch(cell) for cell in cells]
    names = [cell if part is None else part[1] for cell, part in zip(cells, parts, strict=True)]
    names = [ALIASES.get(name, name) for name in names]
    pairs = zip(names, parts, strict=True)
    return names, [part[2].strip(" -") if part and name in WITH_UNIT else "" for name, part in pairs]


def _cell(cell: str, unit: str, sign: str) -> str:
    """Return a cell with a decimal point, and with the unit of its column."""
    if sign != "," and (parts := _DECIMAL_COMMA.fullmatch(cell)):
        cell = f"{parts[1]}.{parts[2]}"
    return f"{cell} {unit}" if unit and cell else cell
