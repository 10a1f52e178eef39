"""Read the tables of users: a line of names, then one row a line, from a CSV file or a workbook.

The dialect is:

- text in UTF-8, or in UTF-16 with its mark, or the only visible sheet of a workbook;
- semicolons, tabs, bars or commas between the cells, the same in all lines;
- one line of names, each with its unit in brackets where it has one, such as `axial_force [kN]`; a
  line of units may follow;
- one cell a name in each further line; numbers with decimal points, or with decimal commas where
  commas do not separate the cells; a unit may stand behind a number;
- lines that begin with '#' are comments.

The reader asks of each other cell and line whether a person would read it otherwise. It then
refuses it with file, line, column and remedy. Nothing is filled in or guessed.
"""

from __future__ import annotations

import dataclasses
import itertools
import math
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from trackroller.errors import Collector, InputError, checked_text, listing
from trackroller.files import read_bytes, text_of
from trackroller.numerics.numbers import number_or_nan
from trackroller.numerics.table_cells import (
    RefusedCell,
    Stored,
    decimal_signs,
    is_number,
    plain_column,
    plain_labels,
    unbracketed,
)
from trackroller.numerics.units import PLAIN, in_unit, split_quantity
from trackroller.tables.column_heads import (
    check_head,
    check_unit,
    head_names_and_units,
    is_comment,
    is_unit,
    named_columns,
    split_lines,
    until_names,
)
from trackroller.tables.csv import csv_lines
from trackroller.tables.table_kind import Row, Source, TableKind
from trackroller.tables.totals import total_lines, value_of
from trackroller.tables.xlsx import sheet_lines

MOST_ERRORS = 1_000  # of a table; a message shows fewer
HEAD_ROWS = 1_000  # rows of a workbook among which the line of names is sought for its names alone

_STATED_UNIT = re.compile(
    r"\[([^\[\]]{1,20})\]|\(([^()]{1,20})\)"
    r"|\b(?:in|units?|einheit|einheiten)\b(?: is| =|:|=)? *([^\s,;:]{1,20})",
    re.IGNORECASE,
)
_BARE_UNITS = ("N", "%", "lbf", "kgf", "kp")
_OTHER_FORMATS = (".xls", ".xlsb", ".ods", ".fods", ".numbers")
_OLD = "a workbook of the old format .xls, or one with a password"
_ZIP = b"PK\x03\x04"  # first bytes of new workbooks
_OLE = b"\xd0\xcf\x11\xe0"  # first bytes of old workbooks


@dataclass
class UserTable:
    """A table of a user: names of the columns, number of their line, and the cells of each further
    line by number.

    Numbers of known columns have a decimal point, no thousands signs, and their unit behind them.
    Cells of further columns that hold numbers only are `Stored`; cells of other columns stay as
    they are. `known` holds the units of the known columns, `units` those that the file states for
    its columns, `signs` the decimal signs of its numbers, `separator` what stands between the cells
    of a CSV file, `places` where the columns stand in a line of the file, `width` the largest
    number of cells of a line, and `remarks` the comments by their lines.
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


def read_user_table(
    path: Path,
    kind: TableKind,
    wrong: Collector,
    used: Collection[str] = (),
    content: bytes | None = None,
) -> UserTable:
    """Read a CSV file, or the sheet of a workbook whose name ends in .xlsx or .xlsm.

    Lines have their number in the file, the first line being 1. Spaces around a cell, empty lines,
    comments and empty columns are left out.

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
    source = Source(path, kind, wrong)
    if content is None:
        content = read_bytes(path, kind.field)
    lines, separator = _file_lines(content, path, kind)
    table = _named_columns_of(lines, separator, used, source)
    _read_line_of_units(table, used, source)
    numbers = _columns_of_numbers(table, used)
    _read_numbers(table, numbers, kind.small)
    _check_remarks(table, source)
    _refuse_totals(table, numbers, source)
    _refuse_mixtures(table, numbers, used)
    _check_cells(table, source)
    return table


def _check_texts(lines: Iterable[Row], source: Source) -> None:
    """Refuse lines with characters that no terminal should receive."""
    for number, cells in lines:
        with source.in_line(number):
            checked_text(" ".join(cells), source.kind.field, lines=True)


def _named_columns_of(
    lines: Iterable[Row], separator: str, used: Collection[str], source: Source
) -> UserTable:
    """Return the lines of a file as a table of named columns, whose cells are as they stand in the
    file.
    """
    kind = source.kind
    filled = [(number, cells) for number, cells in lines if any(cells)]
    _check_texts(filled, source)
    head, heads, below = split_lines(filled, kind)
    rows = dict(_without_comments(below, heads, source))
    _check_rows(rows, heads, source)
    check_head(heads, rows, head, source)
    _check_lengths(rows, len(heads), separator, source)
    _check_rows(rows, heads, source)
    with source.in_line(head):
        named = named_columns(heads, rows, kind.field)
        names, units = head_names_and_units([heads[j] for j in named], used, kind)
    rows = {number: [line[j] for j in named] for number, line in rows.items()}
    comments = {number: cells for number, cells in filled if is_comment(cells)}
    table = UserTable(names, head, rows, kind.units, units, separator=separator, places=named)
    table.width = max(len(cells) for _, cells in filled)
    table.remarks = {
        n: _joined(cells) for n, cells in comments.items() if n != head and n not in rows
    }
    _check_commas(table, source)
    return table


def head_names(content: bytes, path: Path, kind: TableKind) -> tuple[int, list[str]]:
    """Return the number of the line of names in a table, and the names; [] for an empty one."""
    lines, _ = _file_lines(content, path, kind, HEAD_ROWS)
    number, heads, _ = split_lines(until_names(lines), kind)
    with Source(path, kind, Collector()).in_line(number):
        return number, head_names_and_units([head for head in heads if head], (), kind)[0]


def is_workbook(path: Path) -> bool:
    """Return whether a path names a workbook, by its ending."""
    return path.suffix.lower() in (".xlsx", ".xlsm")


def _file_lines(
    content: bytes, path: Path, kind: TableKind, most_rows: int | None = None
) -> tuple[Iterable[Row], str]:
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


def _without_comments(lines: list[Row], heads: list[str], source: Source) -> Iterator[Row]:
    """Yield the lines that are no comments; where all lines begin with '#', it belongs to their
    labels.
    """
    labels = all(is_comment(cells) for _, cells in lines)
    for number, cells in lines:
        if labels or not is_comment(cells):
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


def _check_rows(rows: dict[int, list[str]], heads: list[str], source: Source) -> None:
    """Refuse a table without names or rows."""
    if heads and rows:
        return
    source.wrong.check()
    allowed = f"a table with a line of names and at least one {source.kind.row}"
    raise InputError(source.kind.field, str(source.path), allowed)


def _check_lengths(rows: dict[int, list[str]], width: int, separator: str, source: Source) -> None:
    """Move lines with more or fewer cells than names to the errors; empty cells at the end of a
    line do not count.

    Where no line has a cell for each name, the first one is named alone.
    """
    for line in rows.values():
        while len(line) > width and not line[-1]:
            line.pop()
    others = {number: line for number, line in rows.items() if len(line) != width}
    most = 1 if len(others) == len(rows) else MOST_ERRORS
    longer = "Write one name for each column, and one cell for each name."
    if separator == ",":
        longer = "Write decimal points, or separate the columns by semicolons."
    shorter = "Write one cell for each name, or remove the line."
    cells = "1 cell" if width == 1 else f"{width} cells"
    for number, line in itertools.islice(others.items(), most):
        allowed = f"{cells}, one for each name; there are {len(line)}"
        remedy = shorter if len(line) < width else longer
        source.refuse(number, source.kind.field, ", ".join(line), allowed, remedy)
    for number in others:
        del rows[number]


def _check_commas(table: UserTable, source: Source) -> None:
    """Refuse numbers between commas without names and points: `-4,472` may be one number."""
    number, line = next(iter(table.lines.items()))
    if table.separator != "," or table.head != number:
        return
    if not any(mark in cell for _, _, cell in table.cells() for mark in ".,"):
        wrong = "may have commas between columns or decimal commas"
        remedy = "Separate the columns by semicolons, or write the names of the columns."
        error = InputError(
            source.kind.field, ",".join(line), "numbers that are clear", remedy, wrong
        )
        raise error.at(source.path, number)


def _read_line_of_units(table: UserTable, used: Collection[str], source: Source) -> None:
    """Take a line of units below the names out of the table, if there is one, and complete the
    units.
    """
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
    """Return whether a line holds no number of a known column, but units, or '-' for pure numbers
    and words.
    """
    pairs = list(zip(table.names, line, strict=True))
    below = {name: unbracketed(cell) for name, cell in pairs if name in table.known}
    if any(map(is_number, below.values())):
        return False
    known = {cell for name, cell in pairs if kind.knows(name)}
    return known == {"-"} or any(is_unit(name, unit, table.known) for name, unit in below.items())


def _unit_below(
    name: str, cell: str, stated: str, used: Collection[str], known: Mapping[str, str]
) -> str:
    """Return the unit of a column of which the head states a unit or '', and the line below another
    or none.
    """
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
    check_unit(name, unit, known)
    return "" if unit in PLAIN else unit


def _check_remarks(table: UserTable, source: Source) -> None:
    """Refuse a comment that states another unit for numbers of which neither the head nor the cells
    state one.
    """
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
    return is_unit(name, unit, known) and in_unit(1.0, unit, known[name], name) != 1.0


def _units_of(text: str) -> list[str]:
    """Return the words of a comment that may be units: in brackets, behind 'in' or 'unit', or no
    word of plain text.
    """
    stated = [next(filter(None, groups)) for groups in _STATED_UNIT.findall(text)]
    words = re.sub(r"\d[\d.,]*\s*[^\s\d,;:=()\[\]]+", " ", text)  # without quantities such as 3 kN
    others = [word.strip(".") for word in re.split(r"[\s,;:=#()\[\]]+", words)]
    bare = [word for word in others if re.search(r"[A-ZµμΩ/%°]", word[1:]) or word in _BARE_UNITS]
    return stated + bare


def _columns_of_numbers(table: UserTable, used: Collection[str]) -> list[int]:
    """Return the places of the known columns, and of those that hold numbers for an expression."""
    return [
        j
        for j, name in enumerate(table.names)
        if name in table.known or (name in used and table.all(j, is_number))
    ]


def _read_numbers(table: UserTable, numbers: list[int], small: bool) -> None:
    """Write the numbers of the table plainly, with their units; cells that are not clear become
    `RefusedCell`.
    """
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
    """Return a column in which numbers with another decimal sign than the first of all cells are
    `RefusedCell`.
    """
    certain = []
    if len(signs) > 1:
        certain = [cell for cell in cells if decimal_signs([cell])]
    if not certain:
        return column
    sign = decimal_signs(certain[:1])
    allowed = f"one decimal sign in the file; {certain[0]} has another one"
    checked = []
    for cell in column:
        if decimal_signs([cell]) - sign:
            cell = RefusedCell(cell, allowed, "Write all numbers in the same way.")
        checked.append(cell)
    return checked


def _in_own_units(table: UserTable) -> bool:
    """Return whether each unit that heads state is that of its known column."""
    pairs = zip(table.names, table.units, strict=True)
    return all(unit in ("", table.known.get(name)) for name, unit in pairs)


def _plain_numbers(cells: list[str], j: int, table: UserTable) -> Sequence[str]:
    """Return the numbers of a column as the program writes them."""
    name = table.names[j]
    numbers = plain_column(cells, table.signs)
    if name not in table.known:
        return list(map(_stored, numbers))
    unit = table.units[j]
    if unit:
        return [_in_unit_of_head(cell, unit) for cell in numbers]
    if table.known[name] not in PLAIN and any(map(_with_unit, numbers)):
        return list(map(_beside_units, numbers))
    return numbers


def _stored(cell: str) -> str:
    """Return a cell of a further column, whose number is not read again."""
    if isinstance(cell, RefusedCell):
        return cell
    return Stored(cell)


def _in_unit_of_head(cell: str, unit: str) -> str:
    """Return a cell with the unit of its column, unless it states a unit of its own."""
    if _is_without_unit(cell):
        return f"{cell} {unit}"
    return cell


def _beside_units(cell: str) -> str:
    """Return a cell of a column in which other cells have units.

    A number without a unit is returned as `RefusedCell`, because it could be in their unit; its
    message is raised where the cell is used.
    """
    if not _is_without_unit(cell) or number_or_nan(cell) == 0.0:
        return cell
    remedy = f"Write the unit behind {cell}, or at the head of the column."
    return RefusedCell(cell, "a number with its unit, as in other cells of the column", remedy)


def _is_without_unit(cell: str) -> bool:
    return not isinstance(cell, RefusedCell) and not math.isnan(number_or_nan(cell))


def _with_unit(cell: str) -> bool:
    parts = split_quantity(cell)
    return parts is not None and parts[1] != "" and not isinstance(cell, RefusedCell)


def _refuse_totals(table: UserTable, numbers: list[int], source: Source) -> None:
    """Move lines that sum up others to the errors."""
    labels = [
        j for j, name in enumerate(table.names) if name not in table.known and j not in numbers
    ]
    row = source.kind.row
    allowed = f"one {row} a line; this line sums up the lines above or below"
    remedy = f"Remove the line; if it is a {row}, rename it or put it further up."
    for number in total_lines(table.lines, numbers, labels or [0]):
        line = table.lines.pop(number)
        source.refuse(number, source.kind.field, ", ".join(line), allowed, remedy)


def _refuse_mixtures(table: UserTable, numbers: list[int], used: Collection[str]) -> None:
    """Refuse words and units in a column of numbers that an expression uses."""
    allowed = (
        "a plain number, because an expression uses the column and other cells of it are numbers"
    )
    remedy = "Write a number without unit, or words in all of its cells."
    for j, name in enumerate(table.names):
        is_free = name in used and name not in table.known and j not in numbers
        if not is_free or table.all(j, lambda cell: math.isnan(value_of(cell))):
            continue
        for line in table.lines.values():
            if line[j] and not isinstance(line[j], RefusedCell) and not is_number(line[j]):
                line[j] = RefusedCell(line[j], allowed, remedy)


def _check_cells(table: UserTable, source: Source) -> None:
    """Refuse cells that are empty or not clear."""
    optional = {*source.kind.optional}
    for j, name in enumerate(table.names):
        if name not in optional and table.lines and not any(table.column(j)):
            optional.add(name)
            allowed = "a value in each line; all cells are empty"
            source.refuse(table.head, name, None, allowed, "Fill the cells, or remove the column.")
    for number, name, cell in table.cells():
        if not cell and name not in optional:
            remedy = "Fill the cell, or remove the line."
            source.refuse(number, name, cell, "a value; the cell is empty", remedy)
        elif isinstance(cell, RefusedCell):
            source.refuse(number, name, str(cell), *cell.message)
        if len(source.wrong.errors) > MOST_ERRORS:
            break
