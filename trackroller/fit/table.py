"""Tables of tests: a CSV file, a workbook or a data frame, with a name, unit and place for each cell."""

from __future__ import annotations

import math
import sys
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from trackroller.errors import Collector, InputError, unknown_name
from trackroller.files import noted_reads
from trackroller.numerics.numbers import number_or_nan
from trackroller.numerics.plain import rows_of
from trackroller.numerics.table_cells import split_head
from trackroller.numerics.units import PLAIN, in_unit
from trackroller.study.file.user_columns import UNITS, read_table

FIELD = "tests"
LARGEST = sys.float_info.max


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
    """

    rows: list[dict[str, Any]]
    lines: list[int]
    path: Path | None = None
    digest: str = ""

    __test__ = False  # pytest takes the name for that of a test

    @property
    def name(self) -> str:
        """Return the name of the file, or what stands for it."""
        return "a data frame" if self.path is None else self.path.name

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
        field = column if self.path is not None else f"row {self.lines[row]}, {column}"
        error = InputError(field, value, allowed, remedy, wrong)
        return error if self.path is None else error.at(self.path, self.lines[row])

    def number(self, row: int, column: str, lower: float = -LARGEST, upper: float = LARGEST) -> float:
        """Return a number in the unit of its column; NaN for an empty cell. Only an upper bound inf allows inf.

        Raises
        ------
        InputError
            If the cell is no number, or lies outside the bounds, which are allowed values themselves.
        """
        cell = self.rows[row].get(column)
        if cell is None or cell == "" or (isinstance(cell, float) and math.isnan(cell)):
            return math.nan
        unit = UNITS.get(column, "-")
        shown = "" if unit in PLAIN else f" {unit}"
        low = "above 0" if lower == LEAST else f"of at least {lower:g}{shown}"
        finite = "finite " if upper < math.inf else ""
        allowed = f"a {finite}number{f' in{shown}' if shown else ''} {low if lower > -LARGEST else ''}".strip()
        try:
            value = number_or_nan(cell, unit, column)
        except InputError:
            raise self.error(row, column, allowed, "Correct the cell, or its unit.") from None
        if math.isnan(value) or not lower <= value <= upper:
            raise self.error(row, column, allowed, "Correct the cell.")
        return float(value)

    def text(self, row: int, column: str) -> str:
        """Return the text of a cell without spaces around it, '' for an empty one."""
        cell = self.rows[row].get(column)
        return "" if cell is None or (isinstance(cell, float) and math.isnan(cell)) else str(cell).strip()

    def keep(self, rows: Sequence[int]) -> TestTable:
        """Return the table with some of its rows."""
        return TestTable([self.rows[i] for i in rows], [self.lines[i] for i in rows], self.path, self.digest)

    def __len__(self) -> int:
        return len(self.rows)

    def __iter__(self) -> Iterator[int]:
        return iter(range(len(self.rows)))


LEAST = 1e-300  # smallest number above 0


def read_tests(
    table: Any, needed: Collection[str], known: Collection[str], optional: Collection[str] = ()
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

    Returns
    -------
    TestTable
        The rows.

    Raises
    ------
    InputError
        For a file that is not readable, a misspelt or missing column, and an empty table.
    """
    if isinstance(table, (str, Path)):
        found, place = from_file(Path(table), optional)
    else:
        found, place = _from_rows(table), 0
    names = list(dict.fromkeys(name for row in found.rows for name in row))
    wrong = Collector()
    for name in names:
        with wrong.part():
            if name not in known:
                raise _placed(unknown_name("column", split_head(str(name))[0], known), found, place)
    for name in needed:
        with wrong.part():
            if name not in names and not wrong.errors:
                allowed = f"a column {name}{_with_unit(name)}"
                raise _placed(
                    InputError(f"column {name}", None, allowed, f"The table has {', '.join(names)}."), found, place
                )
    wrong.check()
    return found


def _with_unit(name: str) -> str:
    unit = UNITS.get(name, "-")
    return "" if unit in PLAIN else f" [{unit}]"


def _placed(error: InputError, table: TestTable, line: Any) -> InputError:
    return error.at(table.path, line) if table.path is not None else error


def from_file(
    path: Path, optional: Collection[str] = (), field: str = FIELD, row: str = "test"
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
    """
    wrong = Collector()
    with noted_reads() as read:
        found = read_table(path, field, row, wrong, optional=optional)
    wrong.check()
    rows = [dict(zip(found.names, line, strict=True)) for line in found.lines.values()]
    return TestTable(rows, list(found.lines), path, read[path.resolve()][1]), found.head


def _from_rows(table: Any) -> TestTable:
    if hasattr(table, "columns"):
        given = rows_of(table, FIELD)
    elif isinstance(table, Mapping):
        columns = {name: list(values) for name, values in table.items()}
        if len({len(values) for values in columns.values()}) > 1:
            raise InputError(FIELD, list(columns), "columns of the same length")
        given = [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]
    else:
        given = [dict(row) for row in table]
    if not given:
        raise InputError(FIELD, None, "a table with at least one test")
    rows = [dict(_cell(str(head), value) for head, value in row.items()) for row in given]
    return TestTable(rows, list(range(1, len(rows) + 1)))


def _cell(head: str, value: Any) -> tuple[str, Any]:
    """Return name and value of a cell, in the unit of the column if its head states another one."""
    name, unit = split_head(head)
    if name not in UNITS or unit in PLAIN or value is None or isinstance(value, str):
        return (name if name in UNITS or unit in PLAIN else head), value
    return name, in_unit(float(value), unit, UNITS[name], name)
