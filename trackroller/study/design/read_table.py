"""Read the user's own cases, and the designs of a search, from a CSV file or workbook."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from trackroller.errors import Collector, InputError, contained, listing, nearest, unknown_name
from trackroller.files import read_bytes
from trackroller.methods.factor import column
from trackroller.numerics.numbers import read_number
from trackroller.numerics.table_cells import RefusedCell, Stored, is_number, split_head
from trackroller.numerics.units import PLAIN, in_unit
from trackroller.parameters import PARAMETERS
from trackroller.roller.aliases import AXIS_DISTANCE, RADII
from trackroller.study.design.factor_names import (
    FACTOR_NAMES,
    SHELVES,
    check_own_name,
    names_without_blanks,
    without_blanks,
)
from trackroller.study.design.field_values import field_value
from trackroller.study.file.user_columns import column_names, read_table
from trackroller.tables.user_table import UserTable


def table(path: Any, used: Collection[str] = ()) -> dict[str, np.ndarray]:
    """Read the user's own cases from a CSV file or a workbook.

    Parameters
    ----------
    path : CSV or workbook with one named column a factor
    used : names that expressions use

    Returns
    -------
    Columns: name -> values, shape (n,). Blanks in names of further columns become underscores.

    Raises
    ------
    InputError : no such file, a line of another length, or a cell that is empty, not clear or of
        another kind
    """
    wrong = Collector()
    if used:  # an expression writes a name without its blanks
        used = {
            *used,
            *(name for name in column_names(Path(path), "table") if without_blanks(name) in used),
        }
    cases = read_cases(Path(path), wrong, used)
    with wrong.part():
        _check_names(cases, used, path)
    try:
        names = names_without_blanks(cases.names, "table column")
    except InputError as error:
        raise error.at(path, cases.head) from None
    columns: dict[str, np.ndarray] = {}
    for j, head in enumerate(cases.names):
        cells = {number: line[j] for number, line in cases.lines.items()}
        numbers = _numbers_of(head, cells)
        if numbers is None:
            columns[names[head]] = _cells_of(head, cells, path, wrong)
        else:
            columns[names[head]] = numbers
    wrong.check()
    return columns


def genes(path: Any) -> np.ndarray:
    """Read the designs of a search, one row of genes each, shape (designs, choices).

    The program writes this file, and nothing in it is doubtful: designs of 0 and 3 may sum up
    without being a total.
    """
    try:
        return np.loadtxt(path, delimiter=",", skiprows=1, ndmin=2)
    except ValueError as error:
        raise InputError(
            "table", str(path), "designs as a search writes them", "Run the search again."
        ) from error


def table_lines(path: Path) -> list[int]:
    """Return the number of the line of each case of a table."""
    return list(read_cases(path, Collector()).lines)


def read_cases(path: Path, wrong: Collector, used: Collection[str] = ()) -> UserTable:
    """Return the table of the cases of a study, whatever its size; see `read_table`."""
    return read_table(
        path, "table", "case", wrong, used, content=read_bytes(path, "table", math.inf)
    )


def _check_names(cases: UserTable, used: Collection[str], path: Any) -> None:
    """Refuse further columns of a table that look like a parameter, and a table with further
    columns only.
    """
    further = [name for name in cases.names if name not in FACTOR_NAMES and name not in used]
    wrong = Collector()
    for name in further:
        with wrong.part():
            bare, unit = split_head(name)  # the name of a further column holds its unit
            check_own_name(name, "table column")
            if name in RADII:
                remedy = f'Add factors: {{axis_distance: {{expression: "{AXIS_DISTANCE}"}}}}.'
                raise InputError(
                    "table column", name, "a parameter, or a column that an expression uses", remedy
                )
            if nearest(bare, FACTOR_NAMES) or len(further) == len(cases.names):
                raise unknown_name("table column", bare, FACTOR_NAMES)
            if cases.all(cases.names.index(name), is_number):
                _check_meaning(name, bare, unit, cases.names)
    for error in wrong.errors:
        error.at(path, cases.head)
    wrong.check()


def _check_meaning(name: str, bare: str, unit: str, names: Collection[str]) -> None:
    """Refuse a column of numbers that nothing uses, and whose head speaks of a parameter that no
    column gives.
    """
    words = set(bare.lower().replace("_", " ").split())
    # "axial load" means axial_force rather than radial_force, the first one that `load` stands for
    meant = sorted(contained(bare, PARAMETERS), key=lambda one: not words & set(one.split("_")))
    if not meant and unit not in PLAIN:
        with contextlib.suppress(InputError):
            in_unit(1.0, unit, "N", name)
            meant = ["radial_force", "axial_force", "motor_force"]
    if meant and meant[0] not in names:
        wrong = (
            "is a column of numbers that nothing would use, though its name speaks of a parameter"
        )
        remedy = (
            f"If {listing(meant, 'or')} is meant, write this name; remove the column otherwise."
        )
        raise InputError(
            "table column", name, "a parameter, or a column that an expression uses", remedy, wrong
        )


def _numbers_of(name: str, cells: Mapping[int, str]) -> np.ndarray | None:
    """Return a column of plain numbers that its parameter allows, None for any other column."""
    if name in SHELVES:  # names of rows, also where they are digits
        return None
    if name not in PARAMETERS:
        if name in FACTOR_NAMES or not all(isinstance(cell, Stored) for cell in cells.values()):
            return None
        return np.array([read_number(cell) for cell in cells.values()], dtype=float)
    try:
        numbers = np.array([read_number(cell) for cell in cells.values()], dtype=float)
    except ValueError:
        return None
    if PARAMETERS[name].accepts(numbers).all():
        return numbers
    return None


def _value_of(name: str, cell: str) -> Any:
    """Return the checked value of a cell; a column that is no factor holds words."""
    if name == "material_pair":
        return field_value(name, [part.strip() for part in cell.split("/")], name)
    if name in FACTOR_NAMES:
        return field_value(name, cell, name)
    return str(cell)


def _cells_of(name: str, cells: Mapping[int, str], path: Any, wrong: Collector) -> np.ndarray:
    """Return a column with words, units or wrong cells; each wrong cell adds an error."""
    values: list[Any] = []
    for number, cell in cells.items():
        if not cell or isinstance(cell, RefusedCell):  # the reader has added its error
            continue
        try:
            values.append(_value_of(name, cell))
        except InputError as error:
            wrong.errors += [one.at(path, number) for one in error.errors]
    return column(
        values, name in PARAMETERS and not any(isinstance(value, str) for value in values)
    )
