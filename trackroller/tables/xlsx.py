"""Read the sheet of a workbook as a person sees it, with openpyxl.

The sheet is loaded twice: once with the values that the workbook stores, once with its formulas.
"""

from __future__ import annotations

import datetime
import io
import re
import warnings
import zipfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from trackroller.errors import InputError, raise_all
from trackroller.numerics.table_cells import RefusedCell, Stored

MAX_UNPACKED = 25_000_000  # bytes of all parts: openpyxl needs some twenty times as much memory
MAX_CELLS = 500_000  # also empty ones between others
MAX_LETTERS = 32_767  # of a cell, as in Excel
MOST_LETTERS = 50_000_000  # of all cells: many of them may share one text
MAX_COLUMNS = 1_000
LARGEST_WHOLE = 2**53  # up to which floats hold all whole numbers
MOST_NAMED = 5  # rows or columns that a message names
Lines = list[tuple[int, list[str]]]

_SHOW = "Show what counts (clear the filter of the sheet), and delete what does not."
_UNSTRIKE = "Delete what does not count, and give the rest another font."
_SPLIT = "Split the cells and fill each of them."
_USUAL = ("General", "0", "0.00", "#,##0", "#,##0.00", "@", "0.00E+00", "0.0", "0.000")
_WORDS = re.compile(r'"([^"]*)"|\\(.)')  # in the code of a format
_DIGITS = re.compile(r"[0#?@]|General|Standard")
_BEGINS_WITH_DIGITS = re.compile(r'[^"\\]*(?:[0#?@]|General|Standard)')
_NO_LETTERS = re.compile(r"[Ee][-+]|General|Standard|[^A-Za-z€$£°µ]")
_REFERENCE = re.compile(
    r"\$?([A-Z]{1,3})\$?(\d+)(?::\$?([A-Z]{1,3})\$?(\d+))?(?![\w(])", re.IGNORECASE
)
# `Table1[Load]`, `A:A`
_WHOLE_COLUMN = re.compile(r"\w+\[[^\[\]]*\]|\$?([A-Z]{1,3}):\$?\1(?![\w(])", re.IGNORECASE)


def sheet_lines(
    content: bytes, path: Path, field: str, row_noun: str, most_rows: int | None = None
) -> Lines:
    """Return numbers and cells of the rows of a workbook's visible sheet, or of its sheet of cases
    or blocks.

    Parameters
    ----------
    content : bytes
        Content of the file.
    path : Path
        Its path, for messages.
    field : str
        Key of the study or spectrum that names the file, for messages.
    row_noun : str
        What a row describes; of several sheets the one with this name in the plural is read.
    most_rows : int, optional
        Return the first rows only, and leave out the checks of the whole sheet.

    Returns
    -------
    list of tuple of int and list of str
        Numbers are `Stored`, and cells that a person reads otherwise than the program would are
        `RefusedCell`. A row ends with its last cell that is not empty, or with the width of the
        first row.

    Raises
    ------
    InputError
        If the file is no workbook, unpacks to too much, has several sheets, hides, strikes out or
        merges cells, or openpyxl is missing.
    """
    try:
        from openpyxl import load_workbook  # noqa: PLC0415 - optional, and heavy
    except ImportError:
        remedy = "Install it with `pip install openpyxl`, or save the table as CSV."
        allowed = "a CSV file, because openpyxl, which reads workbooks, is missing"
        raise InputError(field, str(path), allowed, remedy) from None
    try:
        with warnings.catch_warnings(action="ignore"):  # of parts that no cell needs
            _check_size(content, path, field)
            short = most_rows is not None
            values = load_workbook(
                io.BytesIO(content), read_only=short, data_only=True, keep_links=False
            )
            sheet = _chosen(values.worksheets, path, field, row_noun)
            if short:
                sheet.reset_dimensions()  # some programs write wrong ones
                return _filled_up(
                    _texts(row) for row in sheet.iter_rows(max_row=most_rows, max_col=MAX_COLUMNS)
                )
            _check_sheet(sheet, path, field)
            formulas = load_workbook(io.BytesIO(content), keep_links=False)[sheet.title]
            on_load = _is_computed_on_load(content)
            return _filled_up(
                _checked(*rows, on_load) for rows in zip(sheet.rows, formulas.rows, strict=True)
            )
    except InputError:
        raise
    except Exception as exc:  # zipfile, XML and openpyxl raise a dozen kinds
        why = " ".join(str(exc).split())[:200] or type(exc).__name__
        remedy = "Save it as .xlsx again, or as CSV."
        raise InputError(field, str(path), f"a readable workbook ({why})", remedy) from None


def _check_size(content: bytes, path: Path, field: str) -> None:
    """Refuse a workbook that is large as it is unpacked; zipfile unpacks no more than a workbook
    declares.
    """
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        size = sum(entry.file_size for entry in archive.infolist())
    if size > MAX_UNPACKED:
        most = MAX_UNPACKED // 1_000_000
        allowed = (
            f"a workbook that unpacks to at most {most} MB; this one takes {size / 1e6:.0f} MB"
        )
        raise InputError(field, str(path), allowed, "Save the sheet as CSV.")


def _is_computed_on_load(content: bytes) -> bool:
    """Return whether Excel computes all formulas as it opens the workbook; openpyxl assumes it of
    each.
    """
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        parts = [name for name in archive.namelist() if name.endswith("workbook.xml")]
        return any(b'fullCalcOnLoad="1"' in archive.read(name) for name in parts)


def _chosen(sheets: list[Any], path: Path, field: str, row_noun: str) -> Any:
    """Return the only visible sheet that holds cells, or the one that is named for what its rows
    describe.
    """
    shown = [sheet for sheet in sheets if sheet.sheet_state == "visible"]
    named = [sheet for sheet in sheets if sheet.title.strip().lower() in (row_noun, f"{row_noun}s")]
    if len(named) == 1 and named[0] in shown:
        return named[0]
    if len(named) == 1:
        title = f"sheet {named[0].title!r} of {path}"
        raise InputError(field, title, "a visible sheet; this one is hidden", _SHOW)
    if len(shown) == 1:
        meant = shown
    else:
        meant = [sheet for sheet in shown if _holds(sheet)]
    if len(meant) != 1:
        titles = ", ".join(sheet.title for sheet in meant or sheets)
        allowed = "a workbook with one visible sheet that holds cells"
        raise InputError(
            field,
            f"sheets {titles} of {path}",
            allowed,
            f"Name the sheet that is meant '{row_noun}s'.",
        )
    return meant[0]


def _holds(sheet: Any) -> bool:
    """Return whether a sheet holds a cell with a value."""
    rows = sheet.iter_rows(max_row=MAX_CELLS // MAX_COLUMNS, max_col=MAX_COLUMNS, values_only=True)
    return any(value is not None for row in rows for value in row)


def _check_sheet(sheet: Any, path: Path, field: str) -> None:
    """Refuse a sheet that is too large, or that a person sees otherwise than the program."""
    _check_extent(sheet, path, field)
    filled = [cell for row in sheet.rows for cell in row if cell.value not in (None, "")]
    rows = {cell.row for cell in filled}
    hidden = sorted(row for row in rows if _is_hidden(sheet.row_dimensions[row], "height"))
    struck = sorted({cell.row for cell in filled if cell.font.strike})
    letters = _hidden_letters(sheet, {cell.column for cell in filled})
    merged = list(sheet.merged_cells.ranges)[:MOST_NAMED]
    wrong = []
    if hidden:
        allowed = "rows that are shown; hidden and filtered rows may count or not"
        wrong.append(InputError(field, _few("row", hidden), allowed, _SHOW).at(path, hidden[0]))
    if struck:
        allowed = "rows that are not struck through; these may count or not"
        wrong.append(InputError(field, _few("row", struck), allowed, _UNSTRIKE).at(path, struck[0]))
    if letters:
        allowed = "columns that are shown; hidden columns may count or not"
        wrong.append(InputError(field, _few("column", letters), allowed, _SHOW).at(path, 1))
    for place in merged:
        allowed = "a cell for each line and column; these are merged"
        wrong.append(InputError(field, f"cells {place}", allowed, _SPLIT).at(path, place.min_row))
    raise_all(wrong)


def _check_extent(sheet: Any, path: Path, field: str) -> None:
    """Refuse a sheet of too many columns or cells."""
    if sheet.max_column > MAX_COLUMNS or sheet.max_row * sheet.max_column > MAX_CELLS:
        allowed = f"a sheet of at most {MAX_COLUMNS:,} columns and {MAX_CELLS:,} cells"
        size = f"{sheet.max_column:,} columns, {sheet.max_row:,} rows"
        remedy = "Remove what does not belong to the table, or save the sheet as CSV."
        raise InputError(field, size, allowed, remedy).at(path, sheet.max_row)


def _is_hidden(dimension: Any, size: str) -> bool:
    return bool(dimension.hidden) or getattr(dimension, size) == 0


def _hidden_letters(sheet: Any, columns: set[int]) -> list[str]:
    """Return the letters of hidden columns with cells; one entry of a sheet may hide several
    columns.
    """
    from openpyxl.utils import get_column_letter  # noqa: PLC0415 - optional, and heavy

    hidden: set[int] = set()
    for dimension in sheet.column_dimensions.values():
        if _is_hidden(dimension, "width"):
            hidden |= {column for column in columns if dimension.min <= column <= dimension.max}
    return [get_column_letter(column) for column in sorted(hidden)]


def _few(noun: str, names: Sequence[object]) -> str:
    """Return the first names behind their noun, and how many follow."""
    if len(names) == 1:
        return f"{noun} {names[0]}"
    first = f"{noun}s {', '.join(map(str, names[:MOST_NAMED]))}"
    further = len(names) - MOST_NAMED
    if further > 0:
        return f"{first} and {further} more"
    return first


def _filled_up(rows: Iterator[list[str]]) -> Lines:
    """Return the rows with their numbers; each ends with its last cell or has the width of the
    first row.
    """
    lines: Lines = []
    width = letters = 0
    for number, cells in enumerate(rows, start=1):
        letters += sum(map(len, cells))
        if letters > MOST_LETTERS:
            allowed = f"cells of at most {MOST_LETTERS // 1_000_000} million characters in all"
            remedy = "Remove the long texts, or save the sheet as CSV."
            raise InputError("sheet", f"row {number}", allowed, remedy)
        while len(cells) > width and not cells[-1]:
            cells.pop()
        cells += [""] * (width - len(cells))
        width = width or len(cells)
        lines.append((number, cells))
    return lines


def _texts(row: Sequence[Any]) -> list[str]:
    return [_text(cell) for cell in row]


def _checked(values: Sequence[Any], formulas: Sequence[Any], computed_on_load: bool) -> list[str]:
    """Return the texts of a row; formulas without their value, and sums of the cells above, are
    `RefusedCell`.

    XlsxWriter stores 0 for every formula, and asks Excel to compute the workbook as it opens it.
    """
    cells = _texts(values)
    for j, formula in enumerate(formulas):
        if formula.data_type != "f":
            continue
        text = str(getattr(formula.value, "text", formula.value))
        stored = values[j].value
        is_empty = stored is None and values[j].data_type == "n"
        if is_empty or (computed_on_load and stored == 0):
            remedy = "Open the workbook in Excel or LibreOffice and save it there."
            cells[j] = RefusedCell(
                text, "a value; the workbook holds a formula without its value", remedy
            )
        elif _takes_several(text, formula.column_letter) and not isinstance(cells[j], RefusedCell):
            allowed = (
                "a value of its own; this formula sums up the lines above, or takes several of them"
            )
            remedy = "Remove the line, or put it into another sheet; if it counts, write its value."
            cells[j] = RefusedCell(text, allowed, remedy)
    return cells


def _takes_several(formula: str, letter: str) -> bool:
    """Return whether a formula refers to several cells of its own column, as a sum of the lines
    above does.
    """
    text = re.sub(r'"[^"]*"', '""', formula)
    own: set[str] = set()
    for first, start, last, end in _REFERENCE.findall(text):
        if {first.upper(), (last or first).upper()} == {letter}:
            own |= {start, end or start}
    return len(own) > 1 or _WHOLE_COLUMN.search(text) is not None


def _text(cell: Any) -> str:
    """Return a cell as a person sees it, numbers with all their figures; '' for an empty cell."""
    value = cell.value
    if value is None:
        return ""
    # Excel makes dates of 1-2 and 3/4
    if isinstance(value, (datetime.date, datetime.time, datetime.timedelta)):
        allowed = "a number or a text; the sheet holds a date"
        return RefusedCell(str(value), allowed, "Give the cell the format of a number or a text.")
    if cell.data_type == "e":
        return RefusedCell(
            str(value), "a value; the formula of this cell has an error", "Correct the formula."
        )
    if isinstance(value, bool):
        return str(value).upper()
    if isinstance(value, (int, float)):
        return _formatted(value, cell.number_format)
    text = str(value)
    if len(text) > MAX_LETTERS:
        return RefusedCell(
            f"{text[:40]}...", f"a text of at most {MAX_LETTERS:,} characters", "Shorten the text."
        )
    return text.strip()


def _formatted(value: float, code: str) -> str:
    """Return a number as text; the code of its format may add a unit, a per cent sign or zeros, or
    hide something.

    A whole number with more figures than a float holds is a label.
    """
    if isinstance(value, int) and abs(value) > LARGEST_WHOLE:
        return str(value)
    number = Stored(repr(value))
    if code in _USUAL:
        return number
    section = _section(value, code)
    words = "".join(quoted or escaped for quoted, escaped in _WORDS.findall(section))
    digits = _WORDS.sub("", section)
    if not _shows_number(digits) or not _shows_minus(value, code, words):
        allowed = "a number that is shown; the format of this cell hides it, or a part of it"
        return RefusedCell(number, allowed, "Give the cell the format General.")
    if "%" in digits:
        return f"{100 * value:.15g} %"
    if re.fullmatch("0{2,}", digits) and value == int(value):  # a label such as 007 or P-007
        label = f"{int(value):0{len(digits)}d}"
        if not words or section.startswith('"'):
            return words + label
    unit = words.strip(" -+()") or _NO_LETTERS.sub("", digits)
    if not unit:
        return number
    if _BEGINS_WITH_DIGITS.match(section):
        return f"{number} {unit}"
    return f"{unit} {number}"


def _section(value: float, code: str) -> str:
    """Return the part of the code of a format that shows a number, with the sign of a currency as a
    word.
    """
    section = code.split(";")[_own_section(value, code)]
    section = re.sub(r"\[\$([^-\]]*)[^\]]*\]", r'"\1"', section)  # a currency
    return re.sub(r"\[[^\]]*\]|[_*].", "", section)  # colours, conditions, room


def _own_section(value: float, code: str) -> int:
    """Return the place of the part that shows a number: above 0, below 0, or 0; the first one if
    there is no such.
    """
    place = 0
    if value < 0:
        place = 1
    elif value == 0:
        place = 2
    return place if place < len(code.split(";")) else 0


def _shows_number(digits: str) -> bool:
    """Return whether a format shows a number, and no thousandth of it."""
    return bool(_DIGITS.search(digits)) and not re.search(r"[0#?],+(?![,0#?])", digits)


def _shows_minus(value: float, code: str, words: str) -> bool:
    """Return whether a format shows that a number is below 0: by a sign, in brackets, or in a
    colour.
    """
    if _own_section(value, code) != 1:
        return True
    return re.search(r"[-(\[]", code.split(";")[1] + words) is not None
