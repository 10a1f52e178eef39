"""How a roller behaves over the cases of a study: the answer where nothing is to be decided."""

from __future__ import annotations

from typing import Any

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
from trackroller.results.first_ends import UNKNOWN, end_of_case, ends_by_factor
from trackroller.results.output_ranges import COLUMNS, output_ranges
from trackroller.results.requirement import required_of
from trackroller.results.solved_cases import SolvedCases
from trackroller.results.what_matters import shown_ranges


def answer_how_it_behaves(results: SolvedCases) -> Answer:
    """Return the range of the outputs of a study, and what ends its cases.

    Parameters
    ----------
    results : SolvedCases
        A solved study.
    """
    ranges = shown_ranges(results)
    if ranges is None:
        nothing = CaseRanges(results, ("regime", "regime", ""), False)
        return _answer(results, nothing, pd.DataFrame([{"output": "regime"}]), {})
    rows = results.of_one_model(ranges.held)
    table = output_ranges(results, ranges)
    first = table.iloc[0]
    ends = pd.Series(end_of_case(ranges)[rows]).value_counts()
    told = {
        "smallest": float(first["smallest"]),
        "largest": float(first["largest"]),
        "at_smallest": first["at_smallest"],
        "at_largest": first["at_largest"],
        "error": float(first["error"]),
        "ends": [
            {"limit": str(end), "body": "", "count": int(n)}
            for end, n in ends.items()
            if end != UNKNOWN
        ],
        "of": int(results.of_one_model().sum()),
        "lost": int((results.of_one_model() & ~rows).sum()),
    }
    return _answer(results, ranges, table, told)


def _answer(
    results: SolvedCases, ranges: CaseRanges, table: pd.DataFrame, told: dict[str, Any]
) -> Answer:
    known = bool(told)
    columns: tuple[Column, ...] = COLUMNS if known else COLUMNS[:1]
    if known and table["error"].isna().all():
        columns = tuple(column for column in columns if column.name != "error")
    return Answer(
        question="how it behaves",
        kind="range" if known else "nothing",
        headline=told,
        output=ranges.output,
        table=table,
        columns=columns,
        required=required_of(results),
        curves=Effects.of(ranges).curves() if known else (),
        ends=ends_by_factor(results, ranges) if known else pd.DataFrame(),
        not_checked=checks_left_out(results),
        not_used=given_for_nothing(results),
        not_given=not_given_words(results),
        warnings=tuple(case_cautions(results, ranges, results.of_one_model())) if known else (),
        facts=facts_of(results),
    )
