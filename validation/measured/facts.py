"""Read the tables of this folder: numbers of others, each with its unit at the head of its column."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np

HERE = Path(__file__).parent


def read(name: str) -> list[dict[str, Any]]:
    """Return the rows of a table of this folder by the names of its columns, without their units.

    Parameters
    ----------
    name : str
        Name of the file without its ending, such as "twin_disc".

    Returns
    -------
    list of dict
        Numbers as float, in the unit that stands at the head of the column, and texts; NaN for an empty cell.
    """
    with (HERE / f"{name}.csv").open(encoding="utf-8", newline="") as file:
        return [{head.split(" [")[0]: _value(cell) for head, cell in row.items()} for row in csv.DictReader(file)]


def column(rows: list[dict[str, Any]], name: str) -> np.ndarray:
    """Return a column of numbers, (n,)."""
    return np.array([row[name] for row in rows], float)


def _value(cell: str) -> float | str:
    """Return the number of a cell, or its text."""
    if not cell:
        return float("nan")
    try:
        return float(cell)
    except ValueError:
        return cell
