"""Export of the report's tables as CSV files and one XLSX workbook."""

from __future__ import annotations

import csv
import re
import zipfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape

import numpy as np

from trackroller.report.tables import Table, cell
from trackroller.study.files import write_whole


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
            csv.writer(file).writerows([table.heads, *table.rows])
        paths.append(path)
    book = folder / "tables.xlsx"
    write_whole(book, lambda beside: _save(beside, _workbook(tables)))
    return [*paths, book]


def _save(path: Path, parts: dict[str, str]) -> None:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        for name, text in parts.items():
            file.writestr(zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0)), text)


_XML = '<?xml version="1.0" encoding="UTF-8" standalone="yes"?>\n'
_MAIN = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
_OFFICE = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
_PACKAGE = "http://schemas.openxmlformats.org/package/2006"


def _workbook(tables: Sequence[Table]) -> dict[str, str]:
    """Return the parts of an Office Open XML workbook (ISO/IEC 29500), one sheet a table."""
    names = [re.sub(r"[\[\]:*?/\\]", " ", t.name)[:31] for t in tables]
    kind = "application/vnd.openxmlformats-officedocument.spreadsheetml"
    sheets = [f'<sheet name="{escape(n)}" sheetId="{i}" r:id="rId{i}"/>' for i, n in enumerate(names, 1)]
    links = [
        f'<Relationship Id="rId{i}" Type="{_OFFICE}/worksheet" Target="worksheets/sheet{i}.xml"/>'
        for i in range(1, len(names) + 1)
    ]
    types = [
        f'<Override PartName="/xl/worksheets/sheet{i}.xml" ContentType="{kind}.worksheet+xml"/>'
        for i in range(1, len(names) + 1)
    ]
    parts = {
        "[Content_Types].xml": f'<Types xmlns="{_PACKAGE}/content-types"><Default Extension="rels" ContentType='
        '"application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="xml" ContentType='
        f'"application/xml"/><Override PartName="/xl/workbook.xml" ContentType="{kind}.sheet.main+xml"/>'
        f"{''.join(types)}</Types>",
        "_rels/.rels": f'<Relationships xmlns="{_PACKAGE}/relationships"><Relationship Id="rId1" '
        f'Type="{_OFFICE}/officeDocument" Target="xl/workbook.xml"/></Relationships>',
        "xl/workbook.xml": f'<workbook xmlns="{_MAIN}" xmlns:r="{_OFFICE}">'
        f"<sheets>{''.join(sheets)}</sheets></workbook>",
        "xl/_rels/workbook.xml.rels": f'<Relationships xmlns="{_PACKAGE}/relationships">'
        f"{''.join(links)}</Relationships>",
    }
    for i, table in enumerate(tables, 1):
        rows = "".join(f"<row>{''.join(map(_xml_cell, row))}</row>" for row in [table.heads, *table.rows])
        parts[f"xl/worksheets/sheet{i}.xml"] = f'<worksheet xmlns="{_MAIN}"><sheetData>{rows}</sheetData></worksheet>'
    return {name: _XML + text for name, text in parts.items()}


def _xml_cell(value: Any) -> str:
    if isinstance(value, (int, float, np.number)) and np.isfinite(value):
        return f"<c><v>{float(value)!r}</v></c>"
    text = re.sub(r"[\x00-\x08\x0b\x0c\x0e-\x1f]", " ", value if isinstance(value, str) else cell(value))
    return f'<c t="inlineStr"><is><t xml:space="preserve">{escape(text)}</t></is></c>'
