"""Read the tables of users: a line of names, then one row a line, from a CSV file or a workbook.

The dialect is:

- text in UTF-8, or in UTF-16 with its mark, or the only visible sheet of a workbook;
- semicolons, tabs, bars or commas between the cells, the same in all lines;
- one line of names, each with its unit in brackets where it has one, such as `axial_force [kN]`; a line of units may
  follow;
- one cell a name in each further line; numbers with decimal points, or with decimal commas where commas do not separate
  the cells; a unit may stand behind a number;
- lines that begin with '#' are comments.

The reader asks of each other cell and line whether a person would read it otherwise. It then refuses it with file,
line, column and remedy. Nothing is filled in or guessed.
"""

from __future__ import annotations

import dataclasses
import itertools
import math
import re
import unicodedata
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from trackroller.errors import Collector, InputError, listing, raise_all
from trackroller.files import read_bytes, text_of
from trackroller.numerics.numbers import number_or_nan
from trackroller.numerics.table_cells import (
    Refused,
    Stored,
    decimal_signs,
    is_number,
    plain_column,
    plain_labels,
    plain_quantity,
    split_head,
    unbracketed,
)
from trackroller.numerics.units import PLAIN, in_unit, split_quantity
from trackroller.tables.csv import csv_lines
from trackroller.tables.xlsx import MAX_COLUMNS, sheet_lines

MOST_ERRORS = 1_000  # of a table; a message shows fewer
ROUNDED = 0.01  # relative difference between a sum and what a line of totals states
FAR = 1.8  # times the largest addend
HEAD_ROWS = 1_000  # rows of a workbook among which the line of names is sought for its names alone
Row = tuple[int, list[str]]  # number and cells of a line

_SUM = re.compile(
    r"(?:grand |sub-?)?totals?|sum|summe|gesamt(?:summe)?|zwischensumme|mean|average|mittelwert|[Σ∑]",
    re.IGNORECASE,
)
_EXCEL_ERROR = re.compile(r"#(?:DIV/0!|N/A|NAME\?|NULL!|NUM!|REF!|VALUE!|#+)", re.IGNORECASE)
_STATED_UNIT = re.compile(
    r"\[([^\[\]]{1,20})\]|\(([^()]{1,20})\)"
    r"|\b(?:in|units?|einheit|einheiten)\b(?: is| =|:|=)? *([^\s,;:]{1,20})",
    re.IGNORECASE,
)
_BARE_UNITS = ("N", "%", "lbf", "kgf", "kp")
_OTHER_FORMATS = (".xls", ".xlsb", ".ods", ".fods", ".numbers")
_OLD = "a workbook of the old format .xls, or one with a password"
_ZIP, _OLE = b"PK\x03\x04", b"\xd0\xcf\x11\xe0"  # first bytes of new and of old workbooks


@dataclass(frozen=True)
class TableKind:
    """What a table of users holds.

    Parameters
    ----------
    field : str
        Key of the study or spectrum that names the file, for messages.
    row : str
        What a row describes, such as 'case'.
    units : mapping
        Units of the known columns of numbers by their names.
    words : collection of str
        Names of known columns of words.
    aliases : mapping
        Names that stand for known ones.
    optional : collection of str
        Names of columns whose cells may be empty.
    names : sequence of str
        Names of the columns of a file without a line of names; () if it needs one.
    blanks : bool
        Whether blanks may separate the cells.
    small : bool
        Whether no number reaches 1000 in the unit of its column, so that `4.472` has decimals if no cell decides.
    """

    field: str
    row: str
    units: Mapping[str, str]
    words: Collection[str] = ()
    aliases: Mapping[str, str] = dataclasses.field(default_factory=dict)
    optional: Collection[str] = ()
    names: Sequence[str] = ()
    blanks: bool = False
    small: bool = False

    def knows(self, name: str) -> bool:
        """Return whether a name is that of a known column."""
        return name in self.units or name in self.words or name in self.aliases


@dataclass
class UserTable:
    """A table of a user: names of the columns, number of their line, and the cells of each further line by number.

    Numbers of known columns have a decimal point, no thousands signs, and their unit behind them. Cells of further
    columns that hold numbers only are `Stored`; cells of other columns stay as they are. `known` holds the units of the
    known columns, `units` those that the file states for its columns, `signs` the decimal signs of its numbers,
    `separator` what stands between the cells of a CSV file, `places` where the columns stand in a line of the file,
    `width` the largest number of cells of a line, and `remarks` the comments by their lines.
    """

    names: list[str]
    head: int
    lines: dict[int, list[str]]
    known: Mapping[str, str]
    units: list[str] = dataclasses.field(default_factory=list)
    signs: frozenset[str] = frozenset()
    separator: str = ""
    places: list[int] = dataclasses.field(default_factory=list)
    width: int = 0
    remarks: dict[int, str] = dataclasses.field(default_factory=dict)

    def column(self, j: int) -> list[str]:
        """Return the cells of a column."""
        return [line[j] for line in self.lines.values()]

    def all(self, j: int, holds: Callable[[str], bool]) -> bool:
        """Return whether all cells of a column meet a condition."""
        return all(holds(line[j]) for line in self.lines.values())

    def cells(self) -> Iterator[tuple[int, str, str]]:
        """Yield the number of the line, the name of the column and the text of each cell."""
        for number, line in self.lines.items():
            for name, cell in zip(self.names, line, strict=True):
                yield number, name, cell


@dataclass(frozen=True)
class _Source:
    """The file of a table, what it holds, and the errors of its lines and cells."""

    path: Path
    kind: TableKind
    wrong: Collector

    def refuse(self, number: int, name: str, value: object, allowed: str, remedy: str = "", wrong: str = "") -> None:
        """Add the error of a line."""
        error = InputError(name, value, allowed, remedy, wrong)
        self.wrong.errors.append(error.at(self.path, number))

    @contextmanager
    def in_line(self, number: int) -> Iterator[None]:
        """Name file and line in the errors of a block."""
        try:
            yield
        except InputError as error:
            raise_all(one.at(self.path, number) for one in error.errors)


def read_user_table(
    path: Path,
    kind: TableKind,
    wrong: Collector,
    used: Collection[str] = (),
    content: bytes | None = None,
) -> UserTable:
    """Read a CSV file, or the sheet of a workbook whose name ends in .xlsx or .xlsm.

    Lines have their number in the file, the first line being 1. Spaces around a cell, empty lines, comments and empty
    columns are left out.

    Parameters
    ----------
    path : Path
        The file.
    kind : TableKind
        What it holds.
    wrong : Collector
        Receives the errors of single lines and cells.
    used : collection of str
        Names of further columns that expressions use.
    content : bytes, optional
        Content of the file, or its first lines; by default a file of at most `MAX_BYTES` is read.

    Raises
    ------
    InputError
        If the file is not readable, has only one line, or has heads that are no names.
    """
    source = _Source(path, kind, wrong)
    if content is None:
        content = read_bytes(path, kind.field)
    lines, separator = _file_lines(content, path, kind)
    filled = [(number, cells) for number, cells in lines if any(cells)]
    head, heads, below = _split(filled, kind)
    rows = dict(_without_comments(below, heads, source))
    _check_rows(rows, heads, source)
    _check_head(heads, rows, head, source)
    _check_lengths(rows, len(heads), separator, source)
    _check_rows(rows, heads, source)
    with source.in_line(head):
        named = _named_columns(heads, rows, kind.field)
        names, units = _names([heads[j] for j in named], used, kind)
    for line in rows.values():
        line[:] = [line[j] for j in named]
    table = UserTable(names, head, rows, kind.units, units, separator=separator, places=named)
    _check_commas(table, source)
    table.width = max(len(cells) for _, cells in filled)
    table.remarks = {n: _joined(cells) for n, cells in filled if _is_comment(cells)}
    table.remarks = {n: text for n, text in table.remarks.items() if n != head and n not in rows}
    _read_line_of_units(table, used, source)
    numbers = _columns_of_numbers(table, used)
    _read_numbers(table, numbers, kind.small)
    _check_remarks(table, source)
    _refuse_totals(table, numbers, source)
    _refuse_mixtures(table, numbers, used)
    _check_cells(table, source)
    return table


def head_names(content: bytes, path: Path, kind: TableKind) -> list[str]:
    """Return the names of the columns of a table; [] for an empty one."""
    lines, _ = _file_lines(content, path, kind, HEAD_ROWS)
    number, heads, _ = _split(_until_names(lines), kind)
    with _Source(path, kind, Collector()).in_line(number):
        return _names([head for head in heads if head], (), kind)[0]


def is_workbook(path: Path) -> bool:
    """Return whether a path names a workbook, by its ending."""
    return path.suffix.lower() in (".xlsx", ".xlsm")


def _file_lines(content: bytes, path: Path, kind: TableKind, most_rows: int | None = None) -> tuple[Iterable[Row], str]:
    """Return the lines with their numbers, and the character between the cells of a CSV file."""
    _check_format(content, path, kind.field)
    if is_workbook(path):
        return sheet_lines(content, path, kind.field, kind.row, most_rows), ""
    return csv_lines(text_of(content, path, kind.field), path, kind.field, kind.blanks)


def _check_format(content: bytes, path: Path, field: str) -> None:
    """Refuse other formats, and a file whose ending does not say what it holds."""
    remedy = "Save the table as .xlsx or as CSV."
    if content.startswith(_OLE):
        allowed = "a CSV file or a workbook (.xlsx)"
        raise InputError(field, str(path), allowed, remedy, f"is {_OLD}")
    if path.suffix.lower() in _OTHER_FORMATS:
        allowed = "a CSV file or a workbook (.xlsx)"
        raise InputError(field, str(path), allowed, remedy, "has another format")
    zipped = content.startswith(_ZIP)
    if is_workbook(path) and not zipped:
        remedy = "Give the file the ending .csv, or save the table as .xlsx."
        raise InputError(field, str(path), "a readable workbook", remedy, "is no workbook")
    if zipped and not is_workbook(path):
        wrong = "is a workbook or another archive"
        remedy = "Give a workbook the ending .xlsx."
        raise InputError(field, str(path), "a CSV file", remedy, wrong)
    if content.lstrip().startswith(b"<"):
        raise InputError(field, str(path), "a CSV file", remedy, "is a page of HTML or XML")


def _joined(cells: Iterable[str]) -> str:
    return " ".join(filter(None, cells))


def _is_comment(cells: Sequence[str]) -> bool:
    first = cells[0]
    return first.startswith("#") and not isinstance(first, Refused) and not _EXCEL_ERROR.match(first)


def _until_names(lines: Iterable[Row]) -> Iterator[Row]:
    """Yield the filled lines up to the first one that is no comment."""
    for number, cells in lines:
        if any(cells):
            yield number, cells
            if not _is_comment(cells):
                return


def _split(lines: Iterable[Row], kind: TableKind) -> tuple[int, list[str], list[Row]]:
    """Return the number of the line of names, the names, and the lines below.

    NumPy writes the names behind '#'. A file that needs no names may begin with its first row.
    """
    lines = list(lines)
    first = next((i for i, (_, cells) in enumerate(lines) if not _is_comment(cells)), None)
    if first is None:
        return 0, [], []
    number, cells = lines[first]
    if first and not _are_names(cells, kind):
        before, (mark, *others) = lines[first - 1]
        commented = [mark.lstrip("# "), *others]
        if _are_names(commented, kind):
            return before, _without_end(commented), lines[first:]
    if kind.names and _is_quantity(cells[0]):
        return number, list(kind.names), lines[first:]
    return number, _without_end(cells), lines[first + 1 :]


def _are_names(cells: Iterable[str], kind: TableKind) -> bool:
    return any(kind.knows(split_head(cell)[0]) for cell in cells)


def _is_quantity(cell: str) -> bool:
    """Return whether a cell holds a number, maybe with a decimal comma and a unit."""
    return is_number(cell) or not math.isnan(_value(plain_quantity(cell) or cell))


def _without_end(heads: list[str]) -> list[str]:
    """Return heads without the empty ones behind the last name."""
    while heads and not heads[-1]:
        heads = heads[:-1]
    return heads


def _without_comments(lines: list[Row], heads: list[str], source: _Source) -> Iterator[Row]:
    """Yield the lines that are no comments; where all lines begin with '#', it belongs to their labels."""
    labels = all(_is_comment(cells) for _, cells in lines)
    for number, cells in lines:
        if labels or not _is_comment(cells):
            yield number, cells
        elif _is_row_behind_a_mark(cells, len(heads)):
            remedy = "Remove the line if it does not count, and '#' if it does."
            why = "begins with '#', but has cells as a line that counts"
            source.refuse(number, source.kind.field, ", ".join(cells), "", remedy, why)


def _is_row_behind_a_mark(cells: list[str], width: int) -> bool:
    """Return whether a comment has the cells of a row."""
    is_number_alone = width == 1 and is_number(cells[0].lstrip("# "))
    is_whole = len(cells) >= width and any(cells[1:])
    return is_number_alone or is_whole or any(map(is_number, cells[1:]))


def _check_rows(rows: dict[int, list[str]], heads: list[str], source: _Source) -> None:
    """Refuse a table without names or rows."""
    if heads and rows:
        return
    source.wrong.check()
    allowed = f"a table with a line of names and at least one {source.kind.row}"
    raise InputError(source.kind.field, str(source.path), allowed)


def _check_head(heads: list[str], rows: dict[int, list[str]], head: int, source: _Source) -> None:
    """Refuse a line above the line of names, and names that blanks separate."""
    kind = source.kind
    if _are_names(heads, kind):
        _check_separated(heads, head, source)
        return
    shown = ", ".join(filter(None, heads))
    for number, line in itertools.islice(rows.items(), 20):
        if _are_names(line, kind):
            allowed = f"the names of the columns, which stand in line {number}"
            remedy = "Remove the lines above it, or put '#' before them."
            raise InputError(kind.field, shown, allowed, remedy).at(source.path, head)
    if kind.names:
        with source.in_line(head):
            for name in heads:
                _check_spelling(name, kind)
        example = "; ".join(f"{name} [{kind.units[name]}]" for name in kind.names)
        allowed = f"a {kind.row}, or the names of the columns, such as {example}"
        remedy = (
            f"If it names the columns, write {listing(kind.names)} with their units; otherwise remove such lines, or "
            "put '#' before them."
        )
        wrong = f"is neither a {kind.row} nor the names of the columns"
        raise InputError(kind.field, shown, allowed, remedy, wrong).at(source.path, head)
    _check_separated(heads, head, source)


def _check_separated(heads: list[str], head: int, source: _Source) -> None:
    """Refuse names that blanks separate."""
    words = heads[0].split()
    if len(heads) == 1 and sum(map(source.kind.knows, words)) > 1:
        allowed = "names with a semicolon, tab, bar or comma between them"
        remedy = "Separate the columns by one of these."
        raise InputError(source.kind.field, heads[0], allowed, remedy).at(source.path, head)


def _check_lengths(rows: dict[int, list[str]], width: int, separator: str, source: _Source) -> None:
    """Move lines with more or fewer cells than names to the errors; empty cells at the end of a line do not count.

    Where no line has a cell for each name, the first one is named alone.
    """
    for line in rows.values():
        while len(line) > width and not line[-1]:
            line.pop()
    others = {number: line for number, line in rows.items() if len(line) != width}
    most = 1 if len(others) == len(rows) else MOST_ERRORS
    remedy = "Write one name for each column, and one cell for each name."
    if separator == ",":
        remedy = "Write decimal points, or separate the columns by semicolons."
    cells = "1 cell" if width == 1 else f"{width} cells"
    for number, line in itertools.islice(others.items(), most):
        allowed = f"{cells}, one for each name; there are {len(line)}"
        source.refuse(number, source.kind.field, ", ".join(line), allowed, remedy)
    for number in others:
        del rows[number]


def _check_commas(table: UserTable, source: _Source) -> None:
    """Refuse numbers between commas without names and points: `-4,472` may be one number."""
    number, line = next(iter(table.lines.items()))
    if table.separator != "," or table.head != number:
        return
    if not any(mark in cell for _, _, cell in table.cells() for mark in ".,"):
        wrong = "may have commas between columns or decimal commas"
        remedy = "Separate the columns by semicolons, or write the names of the columns."
        error = InputError(source.kind.field, ",".join(line), "numbers that are clear", remedy, wrong)
        raise error.at(source.path, number)


def _is_unnamed(head: str) -> bool:
    return not head or re.fullmatch(r"Unnamed: \d+", head) is not None


def _named_columns(heads: list[str], rows: dict[int, list[str]], field: str) -> list[int]:
    """Return the places of the columns with names; refuse cells without a name, and a second table."""
    unnamed = [j for j, head in enumerate(heads) if _is_unnamed(head)]
    named = [j for j, head in enumerate(heads) if not _is_unnamed(head)]
    for j in unnamed:
        cells = [line[j] for line in rows.values()]
        if any(cells):
            wrong = f"are cells of column {j + 1}, which has no name"
            remedy = "Name it, or remove it."
            if _counts(cells):
                remedy = "Leave the index out (pandas: index=False), or name it."
            shown = ", ".join(cells[:3])
            raise InputError(field, shown, "a name for each column", remedy, wrong)
    for j in unnamed:
        beside = [heads[k] for k in named if k > j]
        if beside and len(beside) < len(named):
            stand = "stands" if len(beside) == 1 else "stand"
            wrong = f"{stand} beside the empty column {j + 1}, as a second table does"
            remedy = "Remove the empty column if these columns belong to the table, and these columns if not."
            raise InputError(field, ", ".join(beside), "columns of one table", remedy, wrong)
    return named


def _counts(cells: list[str]) -> bool:
    """Return whether cells count the rows from 0 or 1 on."""
    from_zero = [str(i) for i in range(len(cells) + 1)]
    return cells in (from_zero[:-1], from_zero[1:])


def _names(heads: list[str], used: Collection[str], kind: TableKind) -> tuple[list[str], list[str]]:
    """Return the names of the columns and their units; '' for a column without unit.

    A column that is no number of the program keeps the unit as a part of its name, because no number is converted.
    """
    if len(heads) > MAX_COLUMNS:
        allowed = f"at most {MAX_COLUMNS:,} columns"
        raise InputError(kind.field, f"{len(heads)} columns", allowed, "Remove some of them.")
    names = []
    units = []
    wrong = Collector()
    for head in heads:
        whole = unicodedata.normalize("NFC", head)
        name, unit = split_head(whole)
        name = kind.aliases.get(name, name)
        known = name in kind.units
        plain = unit in PLAIN
        with wrong.part():
            _check_named(head, name, unit, used, kind)
        names.append(name if known or plain else whole)
        units.append(unit if known and not plain else "")
    for name, beside in itertools.pairwise(names):
        with wrong.part():
            _check_unit_beside(name, beside, kind)
    wrong.check()
    counts = Counter(names)
    doubled = [name for name in names if counts[name] > 1]
    if doubled:
        allowed = "a different name for each column"
        raise InputError(kind.field, ", ".join(doubled), allowed, "Rename or remove a column.")
    return names, units


def _check_named(head: str, name: str, unit: str, used: Collection[str], kind: TableKind) -> None:
    """Refuse a head that is not clear, and a unit that nothing would convert."""
    if isinstance(head, Refused):
        raise InputError(kind.field, head, *head.message)
    if name in kind.units and unit:
        _check_unit(name, unit, kind.units)
    if not kind.knows(name):
        _check_spelling(head, kind)
    if name in used and name not in kind.units and unit not in PLAIN:
        allowed = f"a column without a unit, because an expression uses {name} and knows no units"
        remedy = f"Convert the numbers to the unit that the expression needs, and name the column {name}."
        raise InputError("column", head, allowed, remedy)


def _check_spelling(head: str, kind: TableKind) -> None:
    """Refuse a known name with a unit that does not stand in brackets, such as `velocity_m/s`."""
    for name, own in kind.units.items():
        if not head.lower().startswith(name):
            continue
        unit = head[len(name) :].strip(" _:-<>{}[]()")
        if unit == own or _is_unit(name, unit, kind.units):
            wrong = "is no name with a unit in brackets"
            raise InputError("column", head, "names of columns", f"Write {name} [{unit}].", wrong)


def _check_unit_beside(name: str, beside: str, kind: TableKind) -> None:
    """Refuse a unit in a cell of its own: with decimal commas its column would hold the decimals."""
    if name in kind.units and not kind.knows(beside) and _is_unit(name, beside, kind.units):
        wrong = f"is a unit in a cell of its own, beside {name}"
        raise InputError("column", beside, "names of columns", f"Write {name} [{beside}], or rename it.", wrong)


def _check_unit(name: str, unit: str, known: Mapping[str, str]) -> None:
    """Refuse a unit that measures something else than the column."""
    same = unit == known[name] or (unit in PLAIN and known[name] in PLAIN)
    if not same:
        in_unit(1.0, unit, known[name], name)


def _read_line_of_units(table: UserTable, used: Collection[str], source: _Source) -> None:
    """Take a line of units below the names out of the table, if there is one, and complete the units."""
    number, line = next(iter(table.lines.items()))
    if not _is_line_of_units(table, line, source.kind):
        return
    wrong = Collector()
    with source.in_line(number):
        for j, (name, cell) in enumerate(zip(table.names, line, strict=True)):
            with wrong.part():
                table.units[j] = _unit_below(name, cell, table.units[j], used, table.known)
        wrong.check()
    del table.lines[number]
    if not table.lines:
        source.wrong.check()
        allowed = f"a table with at least one {source.kind.row} below the units"
        raise InputError(source.kind.field, str(source.path), allowed, "Add a line.")


def _is_line_of_units(table: UserTable, line: list[str], kind: TableKind) -> bool:
    """Return whether a line holds no number of a known column, but units, or '-' for pure numbers and words."""
    pairs = list(zip(table.names, line, strict=True))
    below = {name: unbracketed(cell) for name, cell in pairs if name in table.known}
    if any(map(is_number, below.values())):
        return False
    known = {cell for name, cell in pairs if kind.knows(name)}
    return known == {"-"} or any(_is_unit(name, unit, table.known) for name, unit in below.items())


def _unit_below(name: str, cell: str, stated: str, used: Collection[str], known: Mapping[str, str]) -> str:
    """Return the unit of a column of which the head states a unit or '', and the line below another or none."""
    unit = unbracketed(cell)
    if name not in known:
        if name in used and unit not in PLAIN:
            allowed = "no unit, because an expression uses this column and knows no units"
            remedy = "Convert the numbers to the unit that the expression needs."
            raise InputError(name, cell, allowed, remedy)
        return stated
    if unit in ("", stated):
        return stated
    if stated:
        allowed = f"the unit at the head of the column, {stated}"
        raise InputError(name, cell, allowed, "Remove one of them.")
    _check_unit(name, unit, known)
    return "" if unit in PLAIN else unit


def _check_remarks(table: UserTable, source: _Source) -> None:
    """Refuse a comment that states another unit for numbers of which neither the head nor the cells state one."""
    bare = [
        name
        for name, column in zip(table.names, zip(*table.lines.values(), strict=True), strict=True)
        if name in table.known and not any(map(_with_unit, column))
    ]
    for number, text in itertools.islice(table.remarks.items(), HEAD_ROWS):
        for unit in _units_of(text):
            meant = [name for name in bare if _is_other_unit(name, unit, table.known)]
            if meant:
                own = table.known[meant[0]]
                stand = "stands" if len(meant) == 1 else "stand"
                wrong = f"names the unit {unit}, and {listing(meant)} {stand} without a unit"
                remedy = f"Write {meant[0]} [{unit}] or {meant[0]} [{own}], or remove this line."
                allowed = "units at the heads of the columns"
                error = InputError(source.kind.field, text, allowed, remedy, wrong)
                raise error.at(source.path, number)


def _is_other_unit(name: str, unit: str, known: Mapping[str, str]) -> bool:
    """Return whether a text is a unit of a column's numbers, and of another size than their own."""
    return _is_unit(name, unit, known) and in_unit(1.0, unit, known[name], name) != 1.0


def _units_of(text: str) -> list[str]:
    """Return the words of a comment that may be units: in brackets, behind 'in' or 'unit', or no word of plain text."""
    stated = [next(filter(None, found)) for found in _STATED_UNIT.findall(text)]
    words = re.sub(r"\d[\d.,]*\s*[^\s\d,;:=()\[\]]+", " ", text)  # without quantities such as 3 kN
    others = [word.strip(".") for word in re.split(r"[\s,;:=#()\[\]]+", words)]
    bare = [word for word in others if re.search(r"[A-ZµμΩ/%°]", word[1:]) or word in _BARE_UNITS]
    return stated + bare


def _is_unit(name: str, text: str, known: Mapping[str, str]) -> bool:
    """Return whether a text is a unit of a column's numbers."""
    if text in PLAIN or split_quantity(f"1 {text}") is None:
        return False
    try:
        in_unit(1.0, text, known[name], name)
    except InputError:
        return False
    return True


def _columns_of_numbers(table: UserTable, used: Collection[str]) -> list[int]:
    """Return the places of the known columns, and of those that hold numbers for an expression."""
    return [
        j for j, name in enumerate(table.names) if name in table.known or (name in used and table.all(j, is_number))
    ]


def _read_numbers(table: UserTable, numbers: list[int], small: bool) -> None:
    """Write the numbers of the table plainly, with their units; cells that are not clear become `Refused`."""
    columns = [table.column(j) for j in range(len(table.names))]
    cells = [cell for j in numbers for cell in columns[j]]
    table.signs = decimal_signs(cells)
    if small and not table.signs and _in_own_units(table):
        table.signs = frozenset(mark for mark in ".," if any(mark in cell for cell in cells))
    for j, column in enumerate(columns):
        if j in numbers:
            read = _plain_numbers(_with_one_sign(column, cells, table.signs), j, table)
        else:
            read = plain_labels(column, table.signs)
        if read is not column:
            for line, cell in zip(table.lines.values(), read, strict=True):
                line[j] = cell


def _with_one_sign(column: list[str], cells: list[str], signs: frozenset[str]) -> list[str]:
    """Return a column in which numbers with another decimal sign than the first of all cells are `Refused`."""
    if len(signs) < 2:
        return column
    first = next(cell for cell in cells if decimal_signs([cell]))
    own = decimal_signs([first])
    allowed = f"one decimal sign in the file; {first} has another one"
    remedy = "Write all numbers in the same way."
    read = []
    for cell in column:
        is_other = bool(decimal_signs([cell]) - own)
        read.append(Refused(cell, allowed, remedy) if is_other else cell)
    return read


def _in_own_units(table: UserTable) -> bool:
    """Return whether each unit that heads state is that of its known column."""
    pairs = zip(table.names, table.units, strict=True)
    return all(unit in ("", table.known.get(name)) for name, unit in pairs)


def _plain_numbers(cells: list[str], j: int, table: UserTable) -> Sequence[str]:
    """Return the numbers of a column as the program writes them."""
    name = table.names[j]
    read = plain_column(cells, table.signs)
    if name not in table.known:
        return [cell if isinstance(cell, Refused) else Stored(cell) for cell in read]
    unit = table.units[j]
    if unit:
        return [f"{cell} {unit}" if _is_without_unit(cell) else cell for cell in read]
    own = table.known[name]
    if own not in PLAIN and any(map(_with_unit, read)):
        return list(map(_beside_units, read))
    return read


def _beside_units(cell: str) -> str:
    """Return a cell of a column in which other cells have units.

    A number without a unit is returned as `Refused`, because it could be in their unit; its message is raised where the
    cell is used.
    """
    if not _is_without_unit(cell) or number_or_nan(cell) == 0.0:
        return cell
    remedy = f"Write the unit behind {cell}, or at the head of the column."
    return Refused(cell, "a number with its unit, as in other cells of the column", remedy)


def _is_without_unit(cell: str) -> bool:
    return not isinstance(cell, Refused) and not math.isnan(number_or_nan(cell))


def _with_unit(cell: str) -> bool:
    parts = split_quantity(cell)
    return parts is not None and parts[1] != "" and not isinstance(cell, Refused)


def _refuse_totals(table: UserTable, numbers: list[int], source: _Source) -> None:
    """Move lines that are named as a total, and a last line that surely is one, to the errors."""
    labels = [j for j, name in enumerate(table.names) if name not in table.known and j not in numbers]
    rows = list(table.lines.items())
    totals = [number for number, line in rows if _is_named_total(line, labels or [0])]
    if rows and _sums_up([line for _, line in rows[:-1]], rows[-1][1], numbers):
        totals.append(rows[-1][0])
    row = source.kind.row
    allowed = f"one {row} a line; this line sums up the lines above or below"
    remedy = f"Remove the line; if it is a {row}, rename it or put it further up."
    for number in dict.fromkeys(totals):
        line = table.lines.pop(number)
        source.refuse(number, source.kind.field, ", ".join(line), allowed, remedy)


def _is_named_total(line: list[str], labels: list[int]) -> bool:
    return any(_SUM.fullmatch(line[j].strip(" :")) for j in labels)


def _sums_up(above: list[list[str]], line: list[str], numbers: list[int]) -> bool:
    """Return whether the numbers of a line are sums of the lines above, maybe rounded, of three addends at least.

    Levels such as 0, 10, 20 and 30 or 0, 3, 0 and 3 often add up; their sum is not far above the largest.
    """
    is_far = False
    for j in numbers:
        value = _value(line[j])
        if not line[j] or value == 0:
            continue
        addends = [number for number in (_value(cells[j]) for cells in above) if number]
        if len(addends) < 3 or not math.isclose(sum(addends), value, rel_tol=ROUNDED):
            return False
        if abs(value) > FAR * max(map(abs, addends)):
            is_far = True
    return is_far


def _value(cell: str) -> float:
    parts = split_quantity(cell)
    return number_or_nan(parts[0] if parts else cell)


def _refuse_mixtures(table: UserTable, numbers: list[int], used: Collection[str]) -> None:
    """Refuse words and units in a column of numbers that an expression uses."""
    allowed = "a plain number, because an expression uses the column and other cells of it are numbers"
    remedy = "Write a number without unit, or words in all of its cells."
    for j, name in enumerate(table.names):
        is_free = name in used and name not in table.known and j not in numbers
        if not is_free or table.all(j, lambda cell: math.isnan(_value(cell))):
            continue
        for line in table.lines.values():
            if line[j] and not isinstance(line[j], Refused) and not is_number(line[j]):
                line[j] = Refused(line[j], allowed, remedy)


def _check_cells(table: UserTable, source: _Source) -> None:
    """Refuse cells that are empty or not clear."""
    optional = {*source.kind.optional}
    for j, name in enumerate(table.names):
        if name not in optional and table.lines and not any(table.column(j)):
            optional.add(name)
            allowed = "a value in each line; all cells are empty"
            source.refuse(table.head, name, None, allowed, "Remove the column.")
    for number, name, cell in table.cells():
        if not cell and name not in optional:
            remedy = "Fill the cell, or remove the line."
            source.refuse(number, name, cell, "a value; the cell is empty", remedy)
        elif isinstance(cell, Refused):
            source.refuse(number, name, str(cell), *cell.message)
        if len(source.wrong.errors) > MOST_ERRORS:
            break
