"""The range of each usual output of a study over the cases that are held."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from trackroller.results.answer import Column
from trackroller.results.case_ranges import CaseRanges
from trackroller.results.solved_cases import SolvedCases
from trackroller.results.subgroups import case_text
from trackroller.roller.output_names import is_life
from trackroller.study.outputs import default_names

MOST_OUTPUTS = 8  # rows of the table
COLUMNS = (
    Column("output", "Output", "", "result of the study", "text", role="name"),
    Column("units", "Unit", "", "unit of the result", "text"),
    Column("smallest", "Smallest", "", "smallest value over the cases that are held"),
    Column("median", "Median", "", "median over the cases that are held"),
    Column("largest", "Largest", "", "largest value over the cases that are held"),
    Column("at_smallest", "Smallest at", "", "levels of the case with the smallest value", "text"),
    Column("at_largest", "Largest at", "", "levels of the case with the largest value", "text"),
    Column("cases", "Cases", "", "cases that are held and have a value", "count"),
    Column("error", "Error", "1", "median of the told 95 % errors", "error"),
)


def output_ranges(results: SolvedCases, ranges: CaseRanges) -> pd.DataFrame:
    """Return one row an output with its range over the cases that are held, the columns of
    `COLUMNS`.

    Parameters
    ----------
    results : the solved study
    ranges : the output that comes first; the other usual ones follow
    """
    ranges_of_all = [ranges]
    for name in default_names(results.data, results.design.factors, results.dims):
        if name != ranges.output[0] and len(ranges_of_all) < MOST_OUTPUTS:
            _, units, words = results.quantity(name)
            ranges_of_all.append(CaseRanges(results, (name, words, units), is_life(name)))
    return pd.DataFrame([_row(results, own) for own in ranges_of_all])


def _row(results: SolvedCases, ranges: CaseRanges) -> dict[str, Any]:
    """Return the range of one output with its cases."""
    rows = np.flatnonzero(results.of_one_model(ranges.holds) & ~np.isnan(ranges.value))
    _, words, units = ranges.output
    row: dict[str, Any] = {
        "output": words,
        "name": ranges.output[0],
        "units": units,
        "cases": len(rows),
    }
    if not len(rows):
        empty = {"smallest": np.nan, "median": np.nan, "largest": np.nan, "error": np.nan}
        return (
            row
            | empty
            | {"at_smallest": "", "at_largest": "", "row_smallest": -1, "row_largest": -1}
        )
    values = ranges.value[rows]
    least, most = int(rows[values.argmin()]), int(rows[values.argmax()])
    names = list(results.labels) or list(results.factors)  # labels name the rows of a table
    return row | {
        "smallest": float(values.min()),
        "median": float(np.median(values)),
        "largest": float(values.max()),
        "at_smallest": case_text(results.table, names, least),
        "at_largest": case_text(results.table, names, most),
        "row_smallest": least,
        "row_largest": most,
        "error": _median_error(ranges.told_error[rows]),
    }


def _median_error(errors: np.ndarray) -> float:
    """Return the median of the errors that are stated; NaN without one."""
    stated = errors[~np.isnan(errors)]
    if stated.size:
        return float(np.median(stated))
    return float("nan")
