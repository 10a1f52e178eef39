"""How a roller behaves over the cases of a study: the answer where nothing is to be decided."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pandas as pd

from trackroller.results.answer import Answer
from trackroller.results.case_ranges import CaseRanges
from trackroller.results.effect_curves import Effects
from trackroller.results.ends_by_factor import UNKNOWN, end_of_case, ends_by_factor
from trackroller.results.output_ranges import COLUMNS, output_ranges
from trackroller.results.requirement import required_of
from trackroller.results.solved_cases import SolvedCases
from trackroller.results.study_facts import (
    case_cautions,
    checks_left_out,
    facts_of,
    given_for_nothing,
    not_given_words,
)
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
    rows = results.of_one_model(ranges.holds)
    table = output_ranges(results, ranges)
    first = table.iloc[0]
    ends = pd.Series(end_of_case(ranges)[rows]).value_counts()
    headline = {
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
    return _answer(results, ranges, table, headline)


def _answer(
    results: SolvedCases, ranges: CaseRanges, table: pd.DataFrame, headline: dict[str, Any]
) -> Answer:
    answer = Answer(
        question="how it behaves",
        kind="nothing",
        headline=headline,
        output=ranges.output,
        table=table,
        columns=COLUMNS[:1],
        required=required_of(results),
        not_checked=checks_left_out(results),
        not_used=given_for_nothing(results),
        not_given=not_given_words(results),
        facts=facts_of(results),
    )
    if not headline:
        return answer
    error_known = bool(table["error"].notna().any())
    columns = tuple(column for column in COLUMNS if error_known or column.name != "error")
    return replace(
        answer,
        kind="range",
        columns=columns,
        curves=Effects.of(ranges).curves(),
        ends=ends_by_factor(results, ranges),
        warnings=tuple(case_cautions(results, ranges, results.of_one_model())),
    )
