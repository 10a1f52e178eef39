"""Read the points of a cross-section from a text file beside the case or study that names the file.

A file of points is a table as `tables.user_table` reads it, with the columns x and z. Beside the
dialect of tables, blanks may separate the columns, the line of names may be missing, and text of
Windows in western countries is read.
"""

from __future__ import annotations

import contextlib
import math
import re
from pathlib import Path
from typing import Any

import numpy as np

from trackroller.contact.profiles import PointRows
from trackroller.errors import Collector, InputError
from trackroller.files import find_beside, read_bytes, text_of
from trackroller.numerics.numbers import number_or_nan
from trackroller.numerics.table_cells import RefusedCell
from trackroller.roller.simpack_profile import is_simpack, simpack_points
from trackroller.tables.table_kind import TableKind
from trackroller.tables.user_table import UserTable, read_user_table

AXES = {"x": "mm", "y": "mm", "z": "mm"}
CAPITALS = {"X": "x", "Y": "y", "Z": "z"}
# variation of a column over that of the others up to which it only says where the section lies
EVEN = 1e-3
TEXT = "a text file with two columns"

_PACKED = {
    b"PK\x03\x04": "is a workbook or another packed file",
    b"\xd0\xcf\x11\xe0": "is an old workbook",
}
_NO_TEXT = re.compile(r"[\x01-\x08\x0e-\x19\x1b-\x1f]")
_SCALE = re.compile(  # a scale in a comment
    r"(?:scale|factors?|faktor|ma(?:ß|ss)stab|magnif\w*|gain|exaggerat\w*|zoom|überhöh\w*|ueberhoeh\w*)(?:\W+[xyz])?"
    r"\W+([-+\d.,eE]+(?:\s*[:/]\s*[\d.,]+)?)"
    r"|(?<![\d:.,])((?:[125]|25)0*\s*:\s*1|1\s*:\s*(?:[125]|25)0*)(?![\d:.,])"
    r"|(\d[\d.,]*)\s*-?\s*(?:fold|fach)\b"
    # V=1000, but no speed and no version
    r"|\b(?-i:V[vhxyz]?)\s*[:=]\s*(\d+)(?![\d.,])(?!\s*[^\W\dx_:])",
    re.IGNORECASE,
)


def read_points(name: Any, field: str) -> PointRows:
    """Read rows of two numbers from a text file.

    The file lies beside the case or study file that names it, or below the working directory.
    Absolute paths and '..' are refused, so that a study file from somebody else cannot read private
    files. Files of SIMPACK (`.prr`, `.prw`) are read with their unit, shift and mirroring.

    Parameters
    ----------
    name : str
        Relative path of the file.
    field : str
        `guide_profile.file` or `roller_profile.file`, for error messages.

    Returns
    -------
    PointRows
        Points [x, z] [mm] in the order of the file, with their lines.

    Raises
    ------
    InputError
        If the path is not allowed, the file does not exist, or a line does not hold two numbers.
    """
    path = find_beside(name, field)
    text = _text(path, field)
    lines = [
        (number, line) for number, line in enumerate(text.split("\n"), start=1) if line.strip()
    ]
    if is_simpack([line for _, line in lines]):
        return simpack_points(lines, path, field)
    kind = TableKind(
        field, "point", AXES, aliases=CAPITALS, names=("x", "z"), blanks=True, small=True
    )
    wrong = Collector()
    table = read_user_table(path, kind, wrong, content=text.encode())
    _check_scales(table, path, field)
    places = _places(table, path, field)
    points = _points(table, places, path, field, wrong)
    wrong.check()
    return PointRows(list(points.values()), path, tuple(points))


def _text(path: Path, field: str) -> str:
    """Return the text of a file in UTF-8, UTF-16 or the encoding of Windows in western
    countries.
    """
    content = read_bytes(path, field)
    for mark, wrong in _PACKED.items():
        if content.startswith(mark):
            remedy = "Save the sheet with the columns x and z as CSV."
            raise InputError(field, str(path), TEXT, remedy, wrong)
    text = text_of(content, path, field, western=True)
    if _NO_TEXT.search(text):
        raise InputError(
            field, str(path), TEXT, "Save the points as text.", "holds bytes that are no text"
        )
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _check_scales(table: UserTable, path: Path, field: str) -> None:
    """Refuse a scale other than 1 in a comment: nobody knows whether the numbers contain it."""
    for number, remark in table.remarks.items():
        for scale in _SCALE.finditer(remark):
            stated = next(filter(None, scale.groups()))
            if _scale(stated) != 1.0:
                wrong = f"states a scale of {stated}, which is not applied"
                remedy = "Multiply the numbers, or remove this line."
                raise InputError(field, remark, "points without a scale", remedy, wrong).at(
                    path, number
                )


def _scale(text: str) -> float:
    """Return the number of a scale such as '10', '2,5' or '1:2'; NaN for another text."""
    numerator, *denominator = re.split("[:/]", text.replace(",", "."))
    number = number_or_nan(numerator.strip().rstrip("."))
    if not denominator:
        return number
    divisor = number_or_nan(denominator[0].strip().rstrip("."))
    return number / divisor if divisor else math.nan


def _places(table: UserTable, path: Path, field: str) -> tuple[int, int]:
    """Return the places of the position across the profile and of the height.

    Of three columns x, y and z one is constant and says where the section lies.
    """
    named = [name for name in AXES if name in table.names]
    if len(named) == 3:
        widths = [_width(table.column(table.names.index(name)), name) for name in named]
        even = int(np.argmin(widths))
        if widths[even] <= EVEN * sorted(widths)[1]:
            del named[even]
    places = [table.names.index(name) for name in named]
    stated = [table.units[place] for place in places]
    if len(named) != 2:
        wrong = "do not say which columns are the position across the profile and the height"
        remedy = "Name them x and z; of x, y and z one has to be constant."
        error = InputError(
            field, ", ".join(table.names), "two of the names x, y and z", remedy, wrong
        )
        raise error.at(path, table.head)
    if any(stated) and not all(stated):
        wrong = f"gives a unit for one column only, '{''.join(stated)}'"
        remedy = "Write both, such as x [um]; z [um]."
        error = InputError(
            field, ", ".join(table.names), "a unit for each of the two columns", remedy, wrong
        )
        raise error.at(path, table.head)
    return places[0], places[1]


def _width(cells: list[str], name: str) -> float:
    """Return the range of a column [mm]; inf for one without numbers."""
    numbers = []
    for cell in cells:
        with contextlib.suppress(InputError):  # of a unit; its line is told with the points
            numbers.append(_length(cell, name))
    finite = [number for number in numbers if math.isfinite(number)]
    if finite:
        return max(finite) - min(finite)
    return math.inf


def _length(cell: str, name: str) -> float:
    """Return the number of a cell in mm, NaN for a cell without a number."""
    if isinstance(cell, RefusedCell):
        return math.nan
    return number_or_nan(cell, AXES[name], name)


def _points(
    table: UserTable, places: tuple[int, int], path: Path, field: str, wrong: Collector
) -> dict[int, list[float]]:
    """Return the points [mm] by their lines; a line without two finite numbers adds an error."""
    points = {}
    names = [table.names[place] for place in places]
    for number, line in table.lines.items():
        cells = [line[place] for place in places]
        # the reader has added their errors
        if any(isinstance(cell, RefusedCell) or not cell for cell in cells):
            continue
        try:
            points[number] = [_length(cell, name) for cell, name in zip(cells, names, strict=True)]
        except InputError as error:
            wrong.errors += [one.at(path, number) for one in error.errors]
            continue
        if not np.isfinite(points[number]).all():
            allowed = "two finite numbers x, z"
            remedy = "Leave out the lines of lost points."
            lost = InputError(
                field, "; ".join(cells), allowed, remedy, "is a point that was not measured"
            )
            wrong.errors.append(lost.at(path, number))
    return points
