"""Read the cells of a workbook (.xlsx) as texts, with openpyxl."""

from __future__ import annotations

import datetime
import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from trackroller.errors import InputError


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
