"""Check the rows of shelves, each by itself: its name, and the values of its columns."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

from trackroller.errors import Collector, InputError
from trackroller.methods.factor import ROWS, Factor
from trackroller.numerics.numbers import number_in, number_or_nan
from trackroller.parameters import MAPPING_FIELDS
from trackroller.roller.aliases import RADII, radius
from trackroller.roller.fields import LONGEST_NAME, NAME, mapping_text
from trackroller.roller.settings import LOADS
from trackroller.study.design.factor_names import BEARING_DIAMETER, CASE_FIELDS, check_own_name
from trackroller.study.design.field_values import field_value

# parameters that no row of a shelf sets
OF_LOAD = (*LOADS, "velocity", "guide_overrollings_per_hour")


def field_of_row(shelf: str, name: str) -> str:
    """Return the name of a row of a shelf in messages."""
    return f"factors.{shelf}.{ROWS}.{name}"


def columns_of_shelves(factors: Mapping[str, Factor]) -> dict[str, Factor]:
    """Return the columns of shelves as lists of values, beside the factors themselves.

    Parameters
    ----------
    factors : all factors of a study

    Returns
    -------
    Name -> factor: a column of numbers has numbers as levels, without those that are missing.
    """
    columns = {}
    for factor in factors.values():
        for name, values in factor.beside.items():
            levels = tuple(dict.fromkeys(value for value in values if value is not None))
            columns[name] = Factor(name, "values", levels=levels, scatter=factor.scatter)
    return columns


def checked_rows(shelf: str, rows: list[Any], where: str) -> list[Any]:
    """Return the rows of a shelf with their values in the types of their columns.

    Rows that are no mappings stay as they are: `methods.factor.parse` refuses them.

    Parameters
    ----------
    shelf : name of the shelf
    rows : one mapping a row, by the names of its columns
    where : name of the study key that holds the rows

    Raises
    ------
    InputError : the errors of all rows together
    """
    if not all(isinstance(row, Mapping) for row in rows):
        return rows
    wrong = Collector()
    checked = []
    for row in rows:
        with wrong.part():
            checked.append(_checked_row(shelf, row, where, wrong))
    wrong.check()
    return checked


def _checked_row(
    shelf: str, row: Mapping[str, Any], where: str, wrong: Collector
) -> dict[str, Any]:
    """Return a row with the values of its columns; collect the errors of its cells."""
    name = _row_name(row.get(NAME), where)
    values: dict[str, Any] = {NAME: name}
    for column, value in row.items():
        if column != NAME:
            with wrong.part():
                values[column] = _value_in_row(shelf, name, column, value)
    if shelf in MAPPING_FIELDS and not values.get(shelf):
        field = f"{field_of_row(shelf, name)}.{shelf}"
        raise InputError(field, None, f"the values of a {shelf}", "", "is missing")
    return values


def _row_name(name: Any, where: str) -> str:
    """Return the name of a row of a shelf, which is the level of its factor."""
    if isinstance(name, (int, float)) and not isinstance(name, bool):
        name = str(name)
    if not isinstance(name, str) or not name.strip() or len(name) > LONGEST_NAME:
        remedy = "For example {name: V25, contact_angle: 30}."
        raise InputError(
            f"{where}.{NAME}", name, f"a name of at most {LONGEST_NAME} signs in each row", remedy
        )
    return name.strip()


def _value_in_row(shelf: str, name: str, column: str, value: Any) -> Any:
    """Return the value of a column in a row of a shelf in the type of the column."""
    where = f"{field_of_row(shelf, name)}.{column}"
    if column in OF_LOAD:
        raise _of_load(column, value, where)
    if column in RADII:
        return radius(column, value, where.removesuffix(column))
    if column == BEARING_DIAMETER:
        return number_in(value, where, "a length > 0 in mm", math.nextafter(0.0, 1.0), unit="mm")
    if column == shelf:
        text = field_value(column, value, where)
        return text and mapping_text(column, json.loads(text) | {NAME: name})
    if column in CASE_FIELDS:
        return field_value(column, value, where)
    return _own_value(column, value, where)


def _of_load(column: str, value: Any, where: str) -> InputError:
    """Return the error for a column of loads, which belong to the use of the goods."""
    remedy = "Write it under base."
    if column in LOADS:
        remedy = f"Write it under base. What a catalogue allows is catalogue_{column}."
    return InputError(where, value, "values of the goods, not of their use", remedy)


def _own_value(column: str, value: Any, where: str) -> Any:
    """Return the value of a column of the user's own: a finite number, a text or None."""
    check_own_name(column, where)
    if not column.isidentifier():
        allowed = "columns whose names are letters, digits and '_'"
        raise InputError(where, value, allowed, "Rename the column.")
    if value is None or isinstance(value, str):
        return value
    number = number_or_nan(value)
    if not math.isfinite(number):
        raise InputError(where, value, "a finite number or a text")
    return number
