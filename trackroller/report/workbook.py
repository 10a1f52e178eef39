"""Export of the report's tables, and of the cases of a study, as CSV files and XLSX workbooks."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from openpyxl import Workbook
from openpyxl.cell import WriteOnlyCell
from openpyxl.cell.cell import ILLEGAL_CHARACTERS_RE

from trackroller.errors import InputError
from trackroller.files import write_whole
from trackroller.report.tables.table import Table, cell


def export(tables: Sequence[Table], folder: Path) -> list[Path]:
    """Write every table as CSV and all of them as one workbook `tables.xlsx`.

    Parameters
    ----------
    folder : place of the files, made when missing

    Returns
    -------
    The paths written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for table in tables:
        path = folder / f"{table.name}.csv"
        with path.open("w", newline="", encoding="utf-8") as file:
            csv.writer(file).writerows([_inert(value) for value in row] for row in [table.heads, *table.rows])
        paths.append(path)
    book = folder / "tables.xlsx"
    write_whole(book, lambda beside: _save(beside, tables))
    return [*paths, book]


MOST_ROWS = 1_048_575  # of a sheet below its head, by the format XLSX


def write_cases(table: pd.DataFrame, path: Path) -> Path:
    """Write the cases of a study as a workbook with one sheet, or as CSV, by the name of the file.

    Parameters
    ----------
    table : one row a case
    path : the file, .xlsx or .csv

    Returns
    -------
    The path.
    """
    if path.suffix.lower() == ".csv":
        texts = table.select_dtypes(exclude="number")
        inert = table.assign(**{str(name): texts[name].map(_inert) for name in texts})
        write_whole(path, lambda beside: inert.to_csv(beside, index=False))
        return path
    if path.suffix.lower() != ".xlsx":
        raise InputError("cases", str(path), "a file whose name ends in .xlsx or .csv", "Change the name.")
    if len(table) > MOST_ROWS:
        remedy = "Write them as .csv."
        raise InputError("cases", len(table), f"a workbook holds at most {MOST_ROWS:,} cases", remedy)
    sheet = Table("cases", "Cases", list(map(str, table.columns)), table.astype(object).to_numpy().tolist())
    write_whole(path, lambda beside: _save(beside, [sheet]))
    return path


def _inert(value: Any) -> Any:
    """Return a cell with an apostrophe before a text that a spreadsheet would run as a formula; numbers stay."""
    if not isinstance(value, str) or not value.startswith(("=", "+", "-", "@", "\t", "\r")):
        return value
    return value if re.fullmatch(r"[+-]?[\d.,]+(e[+-]?\d+)?", value) else f"'{value}"


def _save(path: Path, tables: Sequence[Table]) -> None:
    """Write a workbook with one sheet a table; a text stays a text, also one that looks like a formula."""
    book = Workbook(write_only=True)
    for table in tables:
        sheet = book.create_sheet(re.sub(r"[\[\]:*?/\\]", " ", table.name)[:31])
        for row in (table.heads, *table.rows):
            sheet.append([_xlsx_cell(sheet, value) for value in row])
    book.save(path)


def _xlsx_cell(sheet: Any, value: Any) -> Any:
    if isinstance(value, (int, float, np.number)) and np.isfinite(value):
        return value
    text = WriteOnlyCell(sheet, ILLEGAL_CHARACTERS_RE.sub(" ", cell(value)))
    text.data_type = "s"
    return text
