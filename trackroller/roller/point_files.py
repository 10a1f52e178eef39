"""Read the points of a cross-section from a text file beside the case or study that names the file."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from trackroller.errors import Collector, InputError
from trackroller.files import find_beside, read_text
from trackroller.numerics.units import in_unit

HEADINGS = 5  # largest number of heading lines before the first point
_COMMA = re.compile(r"[-+]?\d*,\d+(?:[eE][-+]?\d+)?")  # a number with a decimal comma


def read_points(name: Any, field: str) -> list[list[float]]:
    """Read rows of two numbers from a text file.

    Columns are separated by commas, semicolons, tabs or blanks; heading lines are allowed, and the last of them may
    state the units of both columns, as in `x [mm]; z [um]`. Decimal commas are understood where another character
    separates the columns. The file lies beside the case or study file that names it,
    or below the working directory. Absolute paths and '..' are refused, so that a study file from somebody else cannot
    read private files.

    Parameters
    ----------
    name : str
        Relative path of the file.
    field : str
        `guide_profile.file` or `roller_profile.file`, for error messages.

    Returns
    -------
    list of list of float
        Points [x, z] [mm].

    Raises
    ------
    InputError
        If the path is not allowed, the file does not exist, or a line does not hold two numbers.
    """
    path = find_beside(name, field)
    text = read_text(path, field)
    rows: list[list[float]] = []
    wrong, head, units = Collector(), 0, ["mm", "mm"]
    for number, line in enumerate(text.splitlines(), start=1):
        cells = _cells(line.split("#")[0])
        if not cells:
            continue
        try:
            pair = float(cells[0]), float(cells[1])
        except (ValueError, IndexError):
            if rows or number > HEADINGS:
                remedy = "Decimal points; decimal commas only between semicolons, tabs or blanks; remarks after '#'."
                wrong.errors.append(
                    InputError(field, line, f"two numbers x, z [{', '.join(units)}]", remedy).at(path, number)
                )
            elif found := re.findall(r"\[([^\[\]]*)\]", line):
                head, units = number, found
            continue
        if not rows and head:
            _check_units(units, field, path, head)
        rows.append([in_unit(value, unit, "mm", field) for value, unit in zip(pair, units, strict=True)])
    wrong.check()
    return rows


def _check_units(units: list[str], field: str, path: Path, head: int) -> None:
    """Refuse units in a heading line that are no lengths, or not one for each column."""
    try:
        if len(units) != 2:
            raise InputError(field, ", ".join(units), "a unit for each of the two columns", "Write x [um], z [um].")
        for unit in units:
            in_unit(1.0, unit, "mm", field)
    except InputError as error:
        raise error.at(path, head) from None


def _cells(line: str) -> list[str]:
    """Return the columns of a line, decimal commas replaced where semicolons, tabs or blanks separate the columns."""
    columns = [cell.strip() for cell in line.split(";")] if ";" in line else line.split()
    if len(columns) > 1 and (";" in line or all(_COMMA.fullmatch(cell) for cell in columns[:2])):
        return [cell.replace(",", ".") if _COMMA.fullmatch(cell) else cell for cell in columns]
    return line.replace(",", " ").split()
