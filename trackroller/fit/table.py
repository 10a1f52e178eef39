"""Tables of tests: a CSV file, a workbook or a data frame, with a name, unit and place for each cell."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

from trackroller.errors import Collector, InputError, unknown_name
from trackroller.files import noted_reads
from trackroller.fit.heads import NAMES_OF_TESTS, UNITS_OF_HEADS, Head, read_heads
from trackroller.numerics.numbers import finite_number, number_or_nan
from trackroller.numerics.plain import plain, rows_of
from trackroller.numerics.table_cells import split_head
from trackroller.numerics.units import PLAIN, in_unit, split_quantity
from trackroller.study.file.user_columns import UNITS, line_of_names, read_table

FIELD = "tests"


@dataclass(frozen=True)
class TestTable:
    """The rows of a table of tests.

    Attributes
    ----------
    rows : list of dict
        The cells of each row by the names of the columns; numbers are in the units of `UNITS`.
    lines : list of int
        Line of each row in the file, or its number in a data frame, the first being 1.
    path : Path or None
        The file; None for a data frame.
    digest : str
        SHA-256 of the file; "" for a data frame.
    heads : mapping of str to str
        Heads in the table by column, where they are another name of it.
    """

    rows: list[dict[str, Any]]
    lines: list[int]
    path: Path | None = None
    digest: str = ""
    heads: Mapping[str, str] = field(default_factory=dict)

    __test__ = False  # pytest takes the name for that of a test

    @property
    def name(self) -> str:
        """Return the name of the file, or what stands for it."""
        if self.path is None:
            return "a data frame"
        return self.path.name

    def error(self, row: int, column: str, allowed: str, remedy: str = "", wrong: str = "") -> InputError:
        """Return an error that names row and column.

        Parameters
        ----------
        row : int
            Place in `rows`.
        column : str
            Name of the column.
        allowed, remedy, wrong : str
            See `InputError`.
        """
        value = self.rows[row].get(column, "")
        head = self.heads.get(column, column)
        if self.path is not None:
            place = head
        else:
            place = f"row {self.lines[row]}, {head}"
        return self.placed(InputError(place, value, allowed, remedy, wrong), self.lines[row])

    def placed(self, error: InputError, line: int = 0) -> InputError:
        """Return an error with the file of the table and a line of it, 0 for the table as a whole."""
        if self.path is None:
            return error
        return error.at(self.path, line)

    def number(
        self,
        row: int,
        column: str,
        lower: float = -math.inf,
        upper: float = math.inf,
        remedy: str = "Correct the cell.",
    ) -> float:
        """Return a finite number in the unit of its column; NaN for an empty cell.

        Raises
        ------
        InputError
            If the cell is no finite number, or lies outside the bounds, which are allowed values themselves.
        """
        cell = self.rows[row].get(column)
        if _is_empty(cell):
            return math.nan
        unit = UNITS.get(column, "-")
        shown = f" {unit}"
        if unit in PLAIN:
            shown = ""
        allowed = _allowed_number(shown, lower, upper)
        try:
            value = finite_number(cell, unit, column)
        except InputError:
            raise self.error(row, column, allowed, "Correct the cell, or its unit.") from None
        if not lower <= value <= upper:
            raise self.error(row, column, allowed, remedy)
        return float(value)

    def text(self, row: int, column: str) -> str:
        """Return the text of a cell without spaces around it, '' for an empty one."""
        cell = self.rows[row].get(column)
        return "" if _is_empty(cell) else str(cell).strip()

    def keep(self, rows: Sequence[int]) -> TestTable:
        """Return the table with some of its rows."""
        lines = [self.lines[i] for i in rows]
        return TestTable([self.rows[i] for i in rows], lines, self.path, self.digest, self.heads)

    def __len__(self) -> int:
        return len(self.rows)

    def __iter__(self) -> Iterator[int]:
        return iter(range(len(self.rows)))


LEAST = 1e-300  # smallest number above 0
# more or less is a mistake: 30,000 years at 1 kHz, and stresses below any load cell and above any strength [MPa]
MOST_CYCLES = 1e15
LEAST_STRESS = 1e-3
MOST_STRESS = 1e5
MISSING = ("NAType", "NaTType")  # types of the values of pandas that say that a cell is empty


def _allowed_number(unit: str, lower: float, upper: float) -> str:
    """Return which numbers are allowed in words; the unit has a blank before it, or is ''."""
    if LEAST < lower and upper < math.inf:
        return f"a finite number from {lower:g} to {upper:g}{unit}"
    words = "a finite number"
    if unit:
        words = f"a finite number in{unit}"
    if lower == LEAST:
        words += " above 0"
    elif lower > -math.inf:
        words += f" of at least {lower:g}{unit}"
    if upper < math.inf:
        return f"{words} and of at most {upper:g}{unit}"
    return words


def _is_empty(cell: Any) -> bool:
    """Return whether a cell holds neither a number nor a text."""
    if isinstance(cell, str):
        return not cell.strip()
    return cell is None or type(cell).__name__ in MISSING or (isinstance(cell, float) and math.isnan(cell))


def read_tests(
    table: Any,
    needed: Collection[str],
    known: Collection[str],
    optional: Collection[str] = (),
    others: Mapping[str, str] = NAMES_OF_TESTS,
) -> TestTable:
    """Read a table of tests.

    Parameters
    ----------
    table : path, data frame, list of mappings or mapping of columns
        One test a row; heads of columns may hold units, such as `amplitude [MPa]`.
    needed : collection of str
        Names of columns that must be there.
    known : collection of str
        Names of all columns that may be there.
    optional : collection of str
        Names of columns whose cells may be empty.
    others : mapping of str to str
        Other names of columns, see `trackroller.fit.heads`.

    Returns
    -------
    TestTable
        The rows, by the names of `known`.

    Raises
    ------
    InputError
        For a file that is not readable, a misspelt or missing column, and an empty table.
    """
    if isinstance(table, (str, Path)):
        tests, place = _tests_of_file(Path(table), known, optional, others)
    else:
        tests = _from_rows(table, known, others)
        place = 0
    names = list(dict.fromkeys(name for row in tests.rows for name in row))
    wrong = Collector()
    for name in names:
        with wrong.part():
            if name not in known:
                raise tests.placed(unknown_name("column", split_head(str(name))[0], known), place)
    for name in needed:
        with wrong.part():
            if name not in names and not wrong.errors:
                allowed = f"a column {name}{_with_unit(name)}"
                remedy = f"The table has {', '.join(names) or 'no columns'}."
                raise tests.placed(InputError(f"column {name}", None, allowed, remedy), place)
    wrong.check()
    return tests


def _with_unit(name: str) -> str:
    unit = UNITS.get(name, "-")
    return "" if unit in PLAIN else f" [{unit}]"


def _tests_of_file(
    path: Path, known: Collection[str], optional: Collection[str], others: Mapping[str, str]
) -> tuple[TestTable, int]:
    """Return the rows of a file by the names of the columns, and the line of its head."""
    line, written = line_of_names(path, FIELD)
    try:
        heads = read_heads(written, known, others)
    except InputError as error:
        raise error.at(path, line) from None
    names = {split_head(head)[0]: meaning for head, meaning in heads.items()}
    numbers = {name: UNITS[meaning.column] for name, meaning in names.items() if meaning.column in UNITS}
    empty = {head for head, meaning in heads.items() if meaning.column in optional}
    tests, place = from_file(path, {*optional, *empty}, further=numbers)
    columns = {name: meaning for name, meaning in {**heads, **names}.items() if name in tests.rows[0]}
    rows = [dict(_renamed(name, cell, columns.get(name)) for name, cell in row.items()) for row in tests.rows]
    read_as = {meaning.column: name for name, meaning in columns.items()}
    return TestTable(rows, tests.lines, tests.path, tests.digest, read_as), place


def _renamed(name: str, cell: Any, head: Head | None) -> tuple[str, Any]:
    """Return name and value of a cell whose head is another name; a unit at the end of the head stands behind it."""
    if head is None:
        return name, cell
    states_unit = head.unit in UNITS_OF_HEADS.values() and split_quantity(cell) is None
    return head.column, f"{cell} {head.unit}" if cell and states_unit else cell


def from_file(
    path: Path,
    optional: Collection[str] = (),
    field: str = FIELD,
    row: str = "test",
    further: Mapping[str, str] = MappingProxyType({}),
) -> tuple[TestTable, int]:
    """Return the rows of a CSV file or a workbook, whatever its columns are, and the line of its head.

    Parameters
    ----------
    path : Path
        The file.
    optional : collection of str
        Names of columns whose cells may be empty.
    field, row : str
        Words of messages for the table and for a row.
    further : mapping of str to str
        Units of further columns of numbers by their names.
    """
    wrong = Collector()
    with noted_reads() as read:
        cells = read_table(path, field, row, wrong, optional=optional, further=further)
    wrong.check()
    rows = [dict(zip(cells.names, line, strict=True)) for line in cells.lines.values()]
    return TestTable(rows, list(cells.lines), path, read[path.resolve()][1]), cells.head


def _from_rows(table: Any, known: Collection[str], others: Mapping[str, str]) -> TestTable:
    allowed = "the path of a table, a data frame, a list of rows (each a mapping), or a mapping of columns"
    if table is None:
        raise InputError(FIELD, None, allowed)
    if hasattr(table, "columns"):
        entries = rows_of(table, FIELD)
    elif isinstance(table, Mapping):
        columns = {name: plain(values, str(name)) for name, values in table.items()}
        for name, values in columns.items():
            if not isinstance(values, list):
                raise InputError(f"{FIELD}: {name}", values, "a list with one value for each test")
        if len({len(values) for values in columns.values()}) > 1:
            raise InputError(FIELD, list(columns), "columns of the same length")
        entries = [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]
    else:
        entries = plain(table, FIELD)
        if not isinstance(entries, list) or not all(isinstance(row, Mapping) for row in entries):
            remedy = "Name the columns, such as {'amplitude': [...], 'cycles': [...], 'failed': [...]}."
            raise InputError(FIELD, table, allowed, remedy)
    if not entries:
        raise InputError(FIELD, None, "a table with at least one test")
    heads = read_heads(dict.fromkeys(str(head) for row in entries for head in row), known, others)
    written = {head: meaning.column for head, meaning in heads.items()}
    written |= {head: f"{meaning.column} [{meaning.unit}]" for head, meaning in heads.items() if meaning.unit}
    rows = [dict(_cell(written.get(str(head), str(head)), value) for head, value in row.items()) for row in entries]
    read_as = {meaning.column: head for head, meaning in heads.items()}
    return TestTable(rows, list(range(1, len(rows) + 1)), heads=read_as)


def _cell(head: str, value: Any) -> tuple[str, Any]:
    """Return name and value of a cell, in the unit of the column if its head states another one."""
    name, unit = split_head(head)
    if name not in UNITS or unit in PLAIN or value is None or isinstance(value, str):
        return (name if name in UNITS or unit in PLAIN else head), value
    number = number_or_nan(value)
    return name, value if math.isnan(number) else in_unit(number, unit, UNITS[name], name)
