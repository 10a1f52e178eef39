"""A table of a report, and how its heads and cells are written."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from trackroller.parameters.carriage_fields import parameter_of
from trackroller.report.numbers import (
    Life,
    capital,
    count,
    lasting,
    level_text,
    long_name,
    rounded,
    unit_text,
    with_unit,
)
from trackroller.study.design.levels import NAMED


@dataclass(frozen=True)
class Table:
    """A table: `name` of its files, title, heads with units, rows of numbers and texts, and a note.

    `marks` are the cells (row, column) that stand out; the first column holds the heads of the
    rows.
    """

    name: str
    title: str
    heads: Sequence[str]
    rows: Sequence[Sequence[Any]]
    note: str = ""
    marks: frozenset[tuple[int, int]] = frozenset()

    @classmethod
    def of(
        cls, name: str, title: str, rows: Sequence[Mapping[str, Any]], note: str = ""
    ) -> Table | None:
        """Return a table, or None if it has no row; each row maps the heads of all columns to its
        cells.
        """
        if rows:
            return cls(name, title, list(rows[0]), [list(row.values()) for row in rows], note)
        return None


def cell(value: Any) -> str:
    """Write a cell: texts as they are, whole numbers with commas, others in four figures."""
    if isinstance(value, str):
        return value
    if isinstance(value, Life):
        return lasting(value, beyond=value.beyond)
    if isinstance(value, (int, np.integer)):
        return count(int(value))
    return rounded(float(value), 4)


def heading(name: str) -> str:
    """Write the head of a factor's column or row, with its unit."""
    parameter = parameter_of(name)
    if name in NAMED or parameter is None or parameter.unit == "-":
        return capital(long_name(name))
    return f"{capital(long_name(name))} [{unit_text(parameter.unit)}]"


def factor_cell(name: str, value: Any) -> Any:
    """Return a level for a table: a number if the head of the column holds the unit, otherwise
    words.
    """
    if isinstance(value, str) or name in NAMED or not np.isfinite(value):
        return level_text(name, value)
    return float(value)


def goal_heading(front: xr.Dataset, name: str) -> str:
    """Return the words and the unit of a goal or a factor of a Pareto set, as the head of a
    column.
    """
    attrs = front[name].attrs
    units = str(attrs.get("units", "")) or getattr(parameter_of(name), "unit", "")
    text = capital(str(attrs.get("long_name") or long_name(name)))
    if units and units not in ("1", "-"):
        return with_unit(text, units)
    return text
