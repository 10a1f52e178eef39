"""Export of the report's tables, and of the cases of a study, as CSV files and XLSX workbooks."""

from __future__ import annotations

import csv
import re
import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from trackroller.errors import InputError
from trackroller.report import html
from trackroller.report.tables.table import Table, cell
from trackroller.study.store.seal import put


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
    put(book, lambda beside: _save(beside, tables))
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
        return put(path, lambda beside: inert.to_csv(beside, index=False))
    if path.suffix.lower() != ".xlsx":
        raise InputError("cases", str(path), "a file whose name ends in .xlsx or .csv", "Change the name.")
    if len(table) > MOST_ROWS:
        remedy = "Write them as .csv."
        raise InputError("cases", len(table), f"at most {MOST_ROWS:,} cases in a workbook", remedy)
    sheet = Table("cases", "Cases", list(map(str, table.columns)), table.astype(object).to_numpy().tolist())
    return put(path, lambda beside: _save(beside, [sheet]))


def _inert(value: Any) -> Any:
    """Return a cell with an apostrophe before a text that a spreadsheet would run as a formula; numbers stay."""
    if not isinstance(value, str) or not value.startswith(("=", "+", "-", "@", "\t", "\r")):
        return value
    return value if re.fullmatch(r"[+-]?[\d.,]+(e[+-]?\d+)?", value) else f"'{value}"


def _save(path: Path, tables: Sequence[Table]) -> None:
    """Write a workbook with one sheet a table."""
    names = [re.sub(r"[\[\]:*?/\\]", " ", table.name)[:31] for table in tables]
    parts: dict[str, tuple[str, list[Any]]] = {
        "[Content_Types].xml": ("types", []),
        "_rels/.rels": ("root", []),
        "xl/workbook.xml": ("book", []),
        "xl/_rels/workbook.xml.rels": ("links", []),
    }
    for i, table in enumerate(tables, 1):
        parts[f"xl/worksheets/sheet{i}.xml"] = "sheet", [table.heads, *table.rows]
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        for name, (part, rows) in parts.items():
            content = {"part": part, "names": names, "rows": rows}
            text = html.render("workbook.xml.j2", content, figure=_figure, printable=_printable)
            file.writestr(zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0)), text)


def _figure(value: Any) -> str | None:
    """Return a finite number with all its figures, None for anything else."""
    return repr(float(value)) if isinstance(value, (int, float, np.number)) and np.isfinite(value) else None


def _printable(value: Any) -> str:
    """Return a text without the characters that XML forbids."""
    return re.sub(r"[\x00-\x08\x0b\x0c\x0e-\x1f]", " ", value if isinstance(value, str) else cell(value))
