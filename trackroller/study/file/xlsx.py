"""Read the sheet of a workbook as a person sees it.

The limits on what a workbook unpacks to hold before anything is parsed: a zip of 300 kB may hold gigabytes.
"""

from __future__ import annotations

import datetime
import io
import re
import warnings
import zipfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from trackroller.errors import InputError, raise_all
from trackroller.numerics.table_cells import Refused, Stored

MAX_UNPACKED = 50_000_000  # bytes of all parts
MAX_CELLS = 500_000  # also empty ones between others
MAX_LETTERS = 32_767  # of a cell, as in Excel; many cells may share one text
MAX_TAGS = 4 * MAX_CELLS  # of a sheet or of its texts: a cell with a number has four
MAX_OTHER_TAGS = 100_000  # of any other part, such as the formats, each of which takes openpyxl 50 us
MAX_COLUMNS = 1_000
LARGEST_WHOLE = 2**53  # up to which floats hold all whole numbers
MOST_NAMED = 5  # rows or columns that a message names
Lines = list[tuple[int, list[str]]]

_SHOW = "Show what counts (clear the filter of the sheet), and delete what does not."
_TRUE = ("1", "true")
_USUAL = ("General", "0", "0.00", "#,##0", "#,##0.00", "@", "0.00E+00", "0.0", "0.000")
_STATISTIC = re.compile(r"\s*(?:SUM|SUBTOTAL|AVERAGE|AGGREGATE|MIN|MAX|MEDIAN|STDEV\S*|COUNT)\s*\([^()]*\)\s*", re.I)
_CELLS = re.compile(r"\$?([A-Z]{1,3})\$?(\d+)(?::\$?([A-Z]{1,3})\$?(\d+))?(?![\w(!])", re.I)
_WHOLE_COLUMN = re.compile(r"\w*\[[^\[\]]*\]|\$?([A-Z]{1,3}):\$?\1(?![\w(!])", re.I)  # `Table1[Load]`, `A:A`
_WORD = re.compile(r"[^\W\d]\w*(?!\w*\()|!")  # a name, or a cell of another sheet


@dataclass(frozen=True)
class _Formula:
    """A formula of a cell, and the value that the workbook stores for it; None without one."""

    text: str
    value: str | None

    def checked(self, shown: str, sums_up: bool, computed_on_load: bool) -> str:
        """Return the text of the cell, `Refused` if the value is missing or sums up the cells above.

        XlsxWriter stores 0 for every formula, and asks Excel to compute the workbook as it opens it.
        """
        text = f"={self.text}"
        if self.value is None or (computed_on_load and self.value == "0"):
            remedy = "Open the workbook in Excel or LibreOffice and save it there."
            return Refused(text, "a value; the workbook holds a formula without its value", remedy)
        if isinstance(shown, Refused):
            return Refused(text, *shown.message)
        if sums_up:
            allowed = "a line of its own; this formula sums up the lines above"
            return Refused(text, allowed, "Remove the line, or put it into another sheet.")
        return shown

    def takes_several_above(self, place: tuple[int, int], sheet: str = "") -> bool:
        """Return whether the formula refers to several cells of its own column above it, and to others above only."""
        text, own, others = re.sub(r'"[^"]*"', '""', self.text), set[int](), {0}
        text = re.sub(rf"(?:'{re.escape(sheet)}'|(?<![\w'.]){re.escape(sheet)})!", "", text) if sheet else text
        for first, start, last, end in _CELLS.findall(text):
            columns = {first.upper(), (last or first).upper()}
            (own if columns == {_letter(place[1])} else others).update((int(start), int(end or start)))
        return len(own) > 1 and max(own | others) < place[0] and not _WORD.search(_CELLS.sub("", text))

    def continues(self, above: _Formula | None, place: tuple[int, int]) -> bool:
        """Return whether the formula is that of the cell above moved down by one row, as in a column of levels."""
        from openpyxl.formula.translate import Translator  # noqa: PLC0415 - optional, and heavy

        if above is None or not above.text:
            return False
        letter = _letter(place[1])
        moved = Translator(f"={above.text}", f"{letter}{place[0] - 1}").translate_formula(f"{letter}{place[0]}")
        return bool(moved == f"={self.text}")


@dataclass
class _Facts:
    """What a sheet says about its cells beside their values; rows and columns count from 1."""

    width: int = 0
    last: int = 0
    hidden_rows: list[int] = field(default_factory=list)
    hidden_columns: set[int] = field(default_factory=set)
    merged: list[str] = field(default_factory=list)
    formulas: dict[tuple[int, int], _Formula] = field(default_factory=dict)
    computed_on_load: bool = False
    title: str = ""

    def sums_up(self, place: tuple[int, int]) -> bool:
        """Return whether the formula of a cell sums up cells above it: a statistic of them, or any formula at the end.

        Below the last row no further case can follow from a formula, unless it continues the formulas above it.
        """
        formula = self.formulas[place]
        several, statistic = formula.takes_several_above(place, self.title), _STATISTIC.fullmatch(formula.text)
        if several and statistic:
            return True
        if place[0] != self.last or not (several or (statistic and _WHOLE_COLUMN.search(formula.text))):
            return False
        return not formula.continues(self.formulas.get((place[0] - 1, place[1])), place)

    def check(self, path: Path, field: str) -> None:
        """Refuse a sheet that a person sees otherwise than the program, or that is too large."""
        if self.width > MAX_COLUMNS or self.last * self.width > MAX_CELLS:
            allowed = f"a sheet of at most {MAX_COLUMNS:,} columns and {MAX_CELLS:,} cells"
            size = f"{self.width:,} columns, {self.last:,} rows"
            remedy = "Remove what does not belong to the table, or save the sheet as CSV."
            raise InputError(field, size, allowed, remedy).at(path, self.last)
        wrong = []
        if self.hidden_rows:
            rows = f"row{'s' * (len(self.hidden_rows) > 1)} {_few(self.hidden_rows)}"
            error = InputError(field, rows, "rows that are shown; hidden and filtered rows may count or not", _SHOW)
            wrong.append(error.at(path, self.hidden_rows[0]))
        if self.hidden_columns:
            letters = [_letter(column) for column in sorted(self.hidden_columns)]
            columns = f"column{'s' * (len(letters) > 1)} {_few(letters)}"
            wrong.append(InputError(field, columns, "columns that are shown; hidden columns may count or not", _SHOW))
            wrong[-1].file = str(path)
        for ref in self.merged[:MOST_NAMED]:
            row = re.sub(r"\D+(\d+).*", r"\1", ref)
            if int(row) <= self.last:
                remedy = "Split the cells and fill each of them."
                error = InputError(field, f"cells {ref}", "a cell for each line and column; these are merged", remedy)
                wrong.append(error.at(path, int(row)))
        raise_all(wrong)


def _number_of(letters: str) -> int:
    from openpyxl.utils import column_index_from_string  # noqa: PLC0415 - optional, and heavy

    return int(column_index_from_string(letters))


def _letter(column: int) -> str:
    from openpyxl.utils import get_column_letter  # noqa: PLC0415 - optional, and heavy

    return str(get_column_letter(column))


def _few(names: Sequence[object]) -> str:
    """Return the first names, and how many follow."""
    more = len(names) - MOST_NAMED
    return ", ".join(map(str, names[:MOST_NAMED])) + (f" and {more} more" if more > 0 else "")


def sheet_lines(content: bytes, path: Path, field: str, what: str, most_rows: int | None = None) -> Lines:
    """Return numbers and cells of the rows of a workbook's visible sheet, or of its sheet of cases or blocks.

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
    most_rows : int, optional
        Return the first rows only, and leave out the checks of the whole sheet.

    Returns
    -------
    list of tuple of int and list of str
        Numbers are `Stored`, and cells that a person reads otherwise than the program would are `Refused`. A row ends
        with its last cell that is not empty, or with the width of the first row.

    Raises
    ------
    InputError
        If the file is no workbook, unpacks to too much, has several sheets, hides or merges cells, or openpyxl is
        missing.
    """
    try:
        from openpyxl.reader.excel import ExcelReader  # noqa: PLC0415 - optional, and heavy
    except ImportError:
        allowed, remedy = "a CSV file, because openpyxl, which reads workbooks, is missing", "Install it with"
        remedy = f"{remedy} `pip install openpyxl`, or save the table as CSV."
        raise InputError(field, str(path), allowed, remedy) from None
    try:
        with warnings.catch_warnings(action="ignore"):  # of parts that no cell needs
            _check_size(content, path, field)
            reader = ExcelReader(io.BytesIO(content), read_only=True, data_only=True, keep_links=False)
            reader.read()
            sheet = _chosen(reader.wb.worksheets, path, field, what)
            if most_rows is not None:
                return _rows(sheet, _Facts(width=MAX_COLUMNS, last=most_rows))
            parts = {sheet.name: relation.target for sheet, relation in reader.parser.find_sheets()}
            with reader.archive.open(parts[sheet.title]) as stream:
                facts = _facts_of(stream)
            facts.title = sheet.title
            facts.check(path, field)
            _check_struck(sheet, facts, path, field)
            facts.computed_on_load = b'fullCalcOnLoad="1"' in reader.archive.read(reader.parser.workbook_part_name)
            return _rows(sheet, facts)
    except InputError:
        raise
    except Exception as exc:  # zipfile, XML and openpyxl raise a dozen kinds
        why = " ".join(str(exc).split())[:200] or type(exc).__name__
        raise InputError(
            field, str(path), f"a readable workbook ({why})", "Save it as .xlsx again, or as CSV."
        ) from None


def _check_size(content: bytes, path: Path, field: str) -> None:
    """Refuse a workbook that is large as it is unpacked; the sizes that it declares may be wrong."""
    remedy = "Save the sheet as CSV."
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        entries = archive.infolist()
        sizes = [sum(entry.file_size for entry in entries), 0]
        for entry in entries if sizes[0] <= MAX_UNPACKED else ():
            tags, end = 0, b""
            most = MAX_TAGS if "worksheets/" in entry.filename else MAX_OTHER_TAGS
            most = MAX_TAGS // 2 if "sharedStrings" in entry.filename else most
            with archive.open(entry) as stream:
                while (chunk := stream.read(1 << 18)) and sizes[1] <= MAX_UNPACKED:
                    sizes[1] += len(chunk)
                    tags += chunk.count(b"<")
                    if b"<!DOCTYPE" in end + chunk:  # its entities can grow without limit
                        raise InputError(field, str(path), "a workbook without a document type definition", remedy)
                    end = chunk[-9:]
                    if tags > most:
                        allowed = f"a workbook of at most about {MAX_CELLS:,} cells; {entry.filename} is larger"
                        raise InputError(field, str(path), allowed, remedy)
    if max(sizes) > MAX_UNPACKED:
        allowed = f"a workbook that unpacks to at most {MAX_UNPACKED // 1_000_000} MB"
        raise InputError(field, str(path), f"{allowed}; this one takes {max(sizes) / 1e6:.0f} MB", remedy)


def _chosen(sheets: list[Any], path: Path, field: str, what: str) -> Any:
    """Return the only visible sheet that holds cells, or the one that is named for what its rows describe."""
    shown = [sheet for sheet in sheets if sheet.sheet_state == "visible"]
    named = [sheet for sheet in sheets if sheet.title.strip().lower() in (what, f"{what}s")]
    if len(named) == 1 and named[0] not in shown:
        raise InputError(field, f"sheet {named[0].title!r} of {path}", "a visible sheet; this one is hidden", _SHOW)
    meant = named if len(named) == 1 else shown if len(shown) == 1 else [sheet for sheet in shown if _holds(sheet)]
    if len(meant) != 1:
        titles = ", ".join(sheet.title for sheet in meant or sheets)
        allowed = "a workbook with one visible sheet that holds cells"
        raise InputError(field, f"sheets {titles} of {path}", allowed, f"Name the sheet that is meant '{what}s'.")
    return meant[0]


def _holds(sheet: Any) -> bool:
    """Return whether a sheet holds a cell with a value."""
    sheet.reset_dimensions()
    rows = sheet.iter_rows(max_row=MAX_CELLS // MAX_COLUMNS, max_col=MAX_COLUMNS, values_only=True)
    return any(value is not None for row in rows for value in row)


def _facts_of(stream: Any) -> _Facts:
    """Return what the XML of a sheet says about its cells beside their values."""
    facts, hidden, number = _Facts(), set[int](), 0
    for _, element in ElementTree.iterparse(stream):
        tag, given = element.tag.rpartition("}")[2], element.attrib
        if tag == "col" and (given.get("hidden") in _TRUE or float(given.get("width", 1)) == 0):
            hidden.update(range(int(given["min"]), min(int(given["max"]), MAX_COLUMNS) + 1))
        elif tag == "mergeCell":
            facts.merged.append(given.get("ref", ""))
        elif tag == "row":
            number = int(given.get("r", number + 1))
            columns = list(_filled(element, number, facts.formulas))
            if columns:
                facts.last, facts.width = max(facts.last, number), max(facts.width, *columns)
                facts.hidden_columns.update(hidden.intersection(columns))
                if given.get("hidden") in _TRUE or float(given.get("ht", 1)) == 0:
                    facts.hidden_rows.append(number)
            element.clear()
    return facts


def _filled(row: ElementTree.Element, number: int, formulas: dict[tuple[int, int], _Formula]) -> Iterator[int]:
    """Yield the columns of the cells of a row that hold something, and note the formulas."""
    column = 0
    for cell in row:
        letters = cell.get("r", "").rstrip("0123456789")
        column = _number_of(letters) if letters else column + 1
        parts = {part.tag.rpartition("}")[2]: part for part in cell}
        value = parts["v"].text if "v" in parts else None
        if (formula := parts.get("f")) is not None:
            empty_text = cell.get("t") == "str" and "v" in parts
            formulas[number, column] = _Formula(formula.text or "", "" if empty_text else value)
        if formula is not None or value or "is" in parts:
            yield column


def _rows(sheet: Any, facts: _Facts) -> Lines:
    """Return numbers and cells of the rows."""
    if not facts.last:  # openpyxl takes 0 for 'no limit'
        return []
    sheet.reset_dimensions()  # some programs write wrong ones
    lines: Lines = []
    width = letters = 0
    for number, row in enumerate(sheet.iter_rows(max_row=facts.last, max_col=facts.width), start=1):
        cells = [_text(cell) for cell in row]
        letters += sum(map(len, cells))
        if letters > MAX_UNPACKED:
            allowed = f"cells of at most {MAX_UNPACKED // 1_000_000} million characters in all"
            raise InputError("sheet", sheet.title, allowed, "Remove the long texts, or save the sheet as CSV.")
        for j in range(len(cells)):
            if (formula := facts.formulas.get((number, j + 1))) is not None:
                cells[j] = formula.checked(cells[j], facts.sums_up((number, j + 1)), facts.computed_on_load)
        while len(cells) > width and not cells[-1]:
            cells.pop()
        cells += [""] * (width - len(cells))
        width = width or len(cells)
        lines.append((number, cells))
    return lines


def _check_struck(sheet: Any, facts: _Facts, path: Path, field: str) -> None:
    """Refuse rows with text that is struck through: a person does not count them."""
    struck = {place for place, font in enumerate(sheet.parent._fonts) if font.strike}
    if not (struck and facts.last):
        return
    sheet.reset_dimensions()
    rows = [
        number
        for number, row in enumerate(sheet.iter_rows(max_row=facts.last, max_col=facts.width), start=1)
        if any(cell.value not in (None, "") and cell.style_array.fontId in struck for cell in row)
    ]
    if rows:
        named = f"row{'s' * (len(rows) > 1)} {_few(rows)}"
        remedy = "Delete what does not count, and give the rest another font."
        error = InputError(field, named, "rows that are not struck through; these may count or not", remedy)
        raise error.at(path, rows[0])


def _text(cell: Any) -> str:
    """Return a cell as a person sees it, numbers with all their figures; '' for an empty cell."""
    value = cell.value
    if value is None:
        return ""
    if isinstance(value, (datetime.date, datetime.time, datetime.timedelta)):  # Excel makes dates of 1-2 and 3/4
        allowed = "a number or a text; the sheet holds a date"
        return Refused(str(value), allowed, "Give the cell the format of a number or a text.")
    if cell.data_type == "e":
        return Refused(str(value), "a value; the formula of this cell has an error", "Correct the formula.")
    if isinstance(value, bool):
        return str(value).upper()
    if isinstance(value, (int, float)):
        return _formatted(value, cell.number_format)
    text = str(value)
    if len(text) > MAX_LETTERS:
        return Refused(f"{text[:40]}...", f"a text of at most {MAX_LETTERS:,} characters", "Shorten the text.")
    return text.strip()


def _formatted(value: float, code: str) -> str:
    """Return a number as text; the code of its format may add a unit, a per cent sign or zeros, or hide something.

    A whole number with more figures than a float holds is a label.
    """
    if isinstance(value, int) and abs(value) > LARGEST_WHOLE:
        return str(value)
    number = Stored(value if isinstance(value, int) else repr(value))
    if code in _USUAL:
        return number
    sections = code.split(";")
    place = 1 if value < 0 else 2 if value == 0 else 0
    own = place if place < len(sections) else 0
    section = re.sub(r"\[\$([^-\]]*)[^\]]*\]", r'"\1"', sections[own])  # a currency
    section = re.sub(r"\[[^\]]*\]|[_*].", "", section)  # colours, conditions, room
    words = "".join(a or b for a, b in re.findall(r'"([^"]*)"|\\(.)', section))
    bare = re.sub(r'"[^"]*"|\\.', "", section)
    minus = own != 1 or re.search(r"[-(\[]", sections[1] + words)  # in brackets, in red
    if not minus or not re.search(r"[0#?@]|General|Standard", bare) or re.search(r"[0#?],+(?![,0#?])", bare):
        allowed = "a number that is shown; the format of this cell hides it, or a part of it"
        return Refused(number, allowed, "Give the cell the format General.")
    if "%" in bare:
        return f"{100 * value:.15g} %"
    if words := words.strip(" -+()") or re.sub(r"[Ee][-+]|General|Standard|[^A-Za-z€$£°µ]", "", bare):
        if re.match(r'[^"\\]*(?:[0#?@]|General|Standard)', section):
            return f"{number} {words}"
        zeros = re.fullmatch(r'"([^"]*)"(0+)', section)  # a label such as P-007
        return f"{zeros[1]}{int(value):0{len(zeros[2])}d}" if zeros and value == int(value) else f"{words} {number}"
    return f"{int(value):0{len(bare)}d}" if re.fullmatch("0{2,}", bare) and value == int(value) else number
