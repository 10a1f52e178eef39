"""Read the user's own cases, and the designs of a search, from a CSV file or workbook."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from trackroller.errors import Collector, InputError, nearest, unknown_name
from trackroller.methods.factor import column
from trackroller.numerics.cells import Refused, Stored, split_head
from trackroller.numerics.numbers import read_number
from trackroller.parameters import PARAMETERS
from trackroller.roller.aliases import AXIS_DISTANCE, RADII
from trackroller.study.design.entries import FACTOR_NAMES, check_own_name, field_value
from trackroller.study.file.user_table import column_names, read_table


def table(path: Any, used: Collection[str] = ()) -> dict[str, np.ndarray]:
    """Read the user's own cases from a CSV file or a workbook.

    Parameters
    ----------
    path : CSV or workbook with one named column a factor
    used : names that expressions use

    Returns
    -------
    Columns: name -> values, shape (n,).

    Raises
    ------
    InputError : no such file, a line of another length, or a cell that is empty, not clear or of another kind
    """
    wrong = Collector()
    found = read_table(Path(path), "table", "case", wrong, math.inf, used)
    with wrong.part():
        _check_names(found.names, used, path, found.head)
    columns = {}
    for j, name in enumerate(found.names):
        cells = {number: line[j] for number, line in found.lines.items()}
        numbers = _numbers_of(name, cells)
        columns[name] = _cells_of(name, cells, path, wrong) if numbers is None else numbers
    wrong.check()
    return columns


def genes(path: Any) -> np.ndarray:
    """Read the designs of a search, one row of genes each, shape (designs, choices)."""
    path, wrong = Path(path), Collector()
    designs = read_table(path, "table", "design", wrong, math.inf, column_names(path, "table"))
    wrong.check()
    return np.array([[read_number(cell) for cell in line] for line in designs.lines.values()])


def table_lines(path: Path) -> list[int]:
    """Return the number of the line of each case of a table."""
    return list(read_table(path, "table", "case", Collector(), math.inf).lines)


def _check_names(names: list[str], used: Collection[str], path: Any, head: int) -> None:
    """Refuse further columns of a table that look like a misspelt name, and a table with further columns only."""
    own, wrong = [name for name in names if name not in FACTOR_NAMES and name not in used], Collector()
    for name in own:
        with wrong.part():
            bare = split_head(name)[0]  # the name of a further column holds its unit
            check_own_name(name, "table column")
            if name in RADII:
                remedy = f'Add factors: {{axis_distance: {{expression: "{AXIS_DISTANCE}"}}}}.'
                raise InputError("table column", name, "a parameter, or a column that an expression uses", remedy)
            if nearest(bare, FACTOR_NAMES) or len(own) == len(names):
                raise unknown_name("table column", bare, FACTOR_NAMES)
    for error in wrong.errors:
        error.at(path, head)
    wrong.check()


def _numbers_of(name: str, cells: Mapping[int, str]) -> np.ndarray | None:
    """Return a column of plain numbers that its parameter allows, None for any other column."""
    if name not in PARAMETERS:
        if name in FACTOR_NAMES or not all(isinstance(cell, Stored) for cell in cells.values()):
            return None
        return np.array([read_number(cell) for cell in cells.values()], dtype=float)
    try:
        numbers = np.array([read_number(cell) for cell in cells.values()], dtype=float)
    except ValueError:
        return None
    return numbers if PARAMETERS[name].accepts(numbers).all() else None


def _cells_of(name: str, cells: Mapping[int, str], path: Any, wrong: Collector) -> np.ndarray:
    """Return a column with words, units or wrong cells; each wrong cell adds an error."""
    values: list[Any] = []
    for number, cell in cells.items():
        if not cell or isinstance(cell, Refused):  # the reader has added its error
            continue
        try:
            pair = [part.strip() for part in cell.split("/")] if name == "material_pair" else cell
            values.append(field_value(name, pair, name) if name in FACTOR_NAMES else str(cell))
        except InputError as error:
            wrong.errors += [one.at(path, number) for one in error.errors]
    return column(values, name in PARAMETERS and not any(isinstance(value, str) for value in values))
