"""Read the points of a cross-section from a text file beside the case or study that names the file."""

from __future__ import annotations

import re
from typing import Any

from trackroller.errors import InputError
from trackroller.files import find_beside, read_text

HEADINGS = 5  # largest number of heading lines before the first point
_COMMA = re.compile(r"[-+]?\d*,\d+(?:[eE][-+]?\d+)?")  # a number with a decimal comma


def read_points(name: Any, field: str) -> list[list[float]]:
    """Read rows of two numbers from a text file.

    Columns are separated by commas, semicolons, tabs or blanks; heading lines are allowed. Decimal commas are
    understood where another character separates the columns. The file lies beside the case or study file that names it,
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
    text = read_text(find_beside(name, field), field)
    rows: list[list[float]] = []
    for number, line in enumerate(text.splitlines(), start=1):
        cells = _cells(line.split("#")[0])
        if not cells:
            continue
        try:
            rows.append([float(cells[0]), float(cells[1])])
        except (ValueError, IndexError):
            if rows or number > HEADINGS:
                raise InputError(
                    f"{field}, line {number}",
                    line,
                    "two numbers x, z [mm]",
                    "Decimal points; decimal commas only between semicolons, tabs or blanks; remarks after '#'.",
                ) from None
    return rows


def _cells(line: str) -> list[str]:
    """Return the columns of a line, decimal commas replaced where semicolons, tabs or blanks separate the columns."""
    columns = [cell.strip() for cell in line.split(";")] if ";" in line else line.split()
    if len(columns) > 1 and (";" in line or all(_COMMA.fullmatch(cell) for cell in columns[:2])):
        return [cell.replace(",", ".") if _COMMA.fullmatch(cell) else cell for cell in columns]
    return line.replace(",", " ").split()
