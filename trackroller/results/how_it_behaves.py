"""How a roller behaves over the cases of a study: the answer where nothing is to be decided."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from trackroller.results.answer import Answer, Column
from trackroller.results.answer_parts import (
    case_cautions,
    checks_left_out,
    facts_of,
    given_for_nothing,
    not_given_words,
)
from trackroller.results.case_ranges import CaseRanges
from trackroller.results.effect_curves import Effects
from trackroller.results.first_ends import end_of_case, ends_by_factor
from trackroller.results.places import levels_of, place_text
from trackroller.results.requirement import required_of
from trackroller.results.results import Results
from trackroller.results.what_matters import shown_ranges
from trackroller.roller.output_names import is_life
from trackroller.study.outputs import default_names

MOST_OUTPUTS = 8  # rows of the table


def answer_how_it_behaves(results: Results) -> Answer:
    """Return the range of the outputs of a study, and what ends its cases.

    Parameters
    ----------
    results : Results
        A solved study.
    """
    ranges = shown_ranges(results)
    if ranges is None:
        nothing = CaseRanges(results, ("regime", "regime", ""), False)
        return _answer(results, nothing, pd.DataFrame([{"output": "regime"}]), {})
    rows = results.of_one_model(ranges.held)
    table = pd.DataFrame([_row(results, own) for own in _outputs(results, ranges)])
    first = table.iloc[0]
    ends = pd.Series(end_of_case(ranges)[rows]).value_counts()
    told = {
        "smallest": float(first["smallest"]),
        "largest": float(first["largest"]),
        "at_smallest": first["at_smallest"],
        "at_largest": first["at_largest"],
        "ends": [{"limit": str(end), "body": "", "count": int(count)} for end, count in ends.items()],
        "of": int(results.of_one_model().sum()),
        "lost": int((results.of_one_model() & ~rows).sum()),
    }
    return _answer(results, ranges, table, told)


def _answer(results: Results, ranges: CaseRanges, table: pd.DataFrame, told: dict[str, Any]) -> Answer:
    known = bool(told)
    return Answer(
        question="how it behaves",
        kind="range" if known else "nothing",
        headline=told,
        output=ranges.output,
        table=table,
        columns=COLUMNS if known else COLUMNS[:1],
        required=required_of(results),
        curves=Effects.of(ranges).curves() if known else (),
        ends=ends_by_factor(results, ranges) if known else pd.DataFrame(),
        not_checked=checks_left_out(results),
        not_used=given_for_nothing(results),
        not_given=not_given_words(results),
        warnings=tuple(case_cautions(results, ranges, results.of_one_model())) if known else (),
        facts=facts_of(results),
    )


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


def _outputs(results: Results, ranges: CaseRanges) -> list[CaseRanges]:
    """Return the output of the answer and the other usual ones."""
    found = [ranges]
    for name in default_names(results.data, results.design.factors, results.dims):
        if name != ranges.output[0] and len(found) < MOST_OUTPUTS:
            _, units, words = results.quantity(name)
            found.append(CaseRanges(results, (name, words, units), is_life(name)))
    return found


def _row(results: Results, ranges: CaseRanges) -> dict[str, Any]:
    """Return the range of one output with its cases."""
    rows = np.flatnonzero(results.of_one_model(ranges.held) & ~np.isnan(ranges.value))
    _, words, units = ranges.output
    row: dict[str, Any] = {"output": words, "name": ranges.output[0], "units": units, "cases": len(rows)}
    if not len(rows):
        empty = {"smallest": np.nan, "median": np.nan, "largest": np.nan, "error": np.nan}
        return row | empty | {"at_smallest": "", "at_largest": "", "row_smallest": -1, "row_largest": -1}
    values = ranges.value[rows]
    least, most = int(rows[values.argmin()]), int(rows[values.argmax()])
    names = list(results.labels) or list(results.factors)  # labels name the rows of a table
    return row | {
        "smallest": float(values.min()),
        "median": float(np.quantile(values, 0.5, method="inverted_cdf")),
        "largest": float(values.max()),
        "at_smallest": _levels_text(results, names, least),
        "at_largest": _levels_text(results, names, most),
        "row_smallest": least,
        "row_largest": most,
        "error": float(np.median(ranges.error[rows])),
    }


def _levels_text(results: Results, names: list[str], row: int) -> str:
    levels = levels_of(results.table, names, row)
    return place_text({name: (level,) for name, level in levels.items()})
