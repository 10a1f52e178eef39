"""The candidates of a study and their conditions for the explorer: numbers to brush by, and a list
of each.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from trackroller.parameters import FIRST_TO_FAIL
from trackroller.report.explorer.rows import ExplorerColumn
from trackroller.report.numbers import GUIDE_UNKNOWN, Life, capital, count, part_of, with_unit
from trackroller.report.tables.table import cell, factor_cell, goal_heading, heading
from trackroller.results.candidates import Candidates, hardest_first
from trackroller.results.lives_by_tests import beyond_sn_data
from trackroller.results.pareto import study_pareto
from trackroller.results.results import Results
from trackroller.study.file.goals import statistic

MOST_LISTED = 200  # candidates or conditions in a list; the axis holds all of them


def candidate_columns(results: Results) -> tuple[list[ExplorerColumn], dict[str, Any]]:
    """Return what the explorer needs to compare candidates over their conditions.

    Parameters
    ----------
    results : the solved study

    Returns
    -------
    columns : `design` (number in the ranking, the best first), `design_worst` (worst life over the
        valid conditions of the candidate), and `condition` (number of the combination of
        conditions, the hardest first) if the candidates share their conditions; none if the goal
        does not rank the candidates
    lists : under `design` and `condition` the `factors`, the `heads` and the `rows` of a list,
        `of`, the number of all its entries, and a `note` for the reader; empty if no candidate
        repeats
    """
    candidates = results.candidates()
    if (
        candidates is None
        or len(candidates.size) < 2
        or candidates.size.max() < 2
        or not candidates.ranks
    ):
        return [], {}
    own = candidates.candidate >= 0
    number = np.argsort(candidates.table.index.to_numpy())[candidates.candidate]
    worst = np.where(own, candidates.table["worst"].to_numpy()[number], np.nan)
    words, unit = candidates.goal[1:]
    columns = [
        _numbered("design", "Design, the best first", np.where(own, number, -1)),
        ExplorerColumn(
            "design_worst",
            f"Worst {words} of the design",
            unit,
            "design",
            worst,
            log=candidates.rising,
        ),
    ]
    head = with_unit(f"Worst {words}", unit)
    lists = {"design": _candidates(candidates, head)}
    if candidates.possible > 1:
        condition = hardest_first(candidates)
        columns.append(_numbered("condition", "Condition, the hardest first", condition))
        lists["condition"] = _conditions(candidates, condition, number, head)
    return columns, lists


def _numbered(name: str, label: str, codes: np.ndarray) -> ExplorerColumn:
    levels = tuple(float(i + 1) for i in range(codes.max() + 1))
    return ExplorerColumn(
        name, label, "", "design", codes, levels, tuple(count(int(level)) for level in levels)
    )


def _candidates(candidates: Candidates, worst: str) -> dict[str, Any]:
    """List the candidates by rank, with their lives, the conditions in which they are valid, and
    what fails first.
    """
    heads, cells, note = _goals(candidates)
    nine = []
    ends = ["worst"]
    if "b10" in candidates.table:
        nine = [f"Nine of ten reach [{candidates.goal[2]}]"]
        ends = ["b10", "worst"]
    rows = []
    for _, row in candidates.table.head(MOST_LISTED).iterrows():
        key = tuple(row[n] for n in candidates.choices)
        lives = [Life(row[name], row[f"{name}_beyond"]) for name in ends]
        valid = part_of(row["valid"], row["cases"])
        further = [*map(cell, lives), valid]
        if not candidates.rising:
            further = [*(cell(float(life)) for life in lives), valid]
        if not alone(candidates):
            further += [first_words(row) or "–"]
        further += cells.get(key, ["–"] * len(heads))
        rows.append([*(cell(factor_cell(n, row[n])) for n in candidates.choices), *further])
    if alone(candidates):
        first = []
        note += f" {capital(GUIDE_UNKNOWN).replace('`', '')}."
    else:
        first = ["Fails first"]
    heads = [*map(heading, candidates.choices), *nine, worst, "Holds in", *first, *heads]
    return {
        "factors": candidates.choices,
        "heads": heads,
        "rows": rows,
        "of": len(candidates.table),
        "note": note.strip(),
    }


def _goals(candidates: Candidates) -> tuple[list[str], dict[tuple[Any, ...], list[str]], str]:
    """Return the goals of the study that are statistics over the conditions of a candidate, with
    its Pareto set.

    Returns
    -------
    Heads, cells by candidate, and what a reader has to know; empty if the goals of the study are
    those of single cases.
    """
    goals = candidates.results.config.pareto
    if not any(statistic(name)[0] for name in goals):
        return [], {}, ""
    note = (
        "The goals of this study are statistics over its scatter: they compare designs. Goals "
        "below compares cases."
    )
    front = study_pareto(candidates.results)
    if front is None:
        return (
            [],
            {},
            f"{note} Their Pareto set needs sensitivity.nc beside the study; it stands in the "
            "report.",
        )
    names = [name for name in goals if name not in candidates.choices]
    best = np.where(front["optimal"].values == 1, "yes", "no")
    values = zip(*(front[name].values.tolist() for name in names), strict=True)
    lines = [[*map(cell, line), str(mark)] for line, mark in zip(values, best, strict=True)]
    keys = zip(*(front[name].values.tolist() for name in candidates.choices), strict=True)
    heads = [*(goal_heading(front, name) for name in names), "In the Pareto set"]
    return heads, dict(zip(keys, lines, strict=True)), note


def _conditions(
    candidates: Candidates, condition: np.ndarray, number: np.ndarray, worst: str
) -> dict[str, Any]:
    """List the conditions with the candidates that are valid there, the worst life, and the
    candidate that does best.
    """
    results = candidates.results
    rows = []
    if candidates.rising:
        sign = 1.0
    else:
        sign = -1.0
    values = results.column(candidates.goal[0])
    beyond = beyond_sn_data(results, candidates.goal[0])
    for there in (condition == i for i in range(min(condition.max() + 1, MOST_LISTED))):
        cases = np.flatnonzero(there & candidates.usable)
        ranked = cases[np.argsort(sign * values[cases], kind="stable")]
        cells = [part_of(len(cases), there.sum()), "–", "–"]
        if cases.size:
            least, most = ranked[0], ranked[-1]
            cells[1:] = [cell(Life(values[least], beyond[least])), count(int(number[most]) + 1)]
        first = results.table.iloc[int(np.argmax(there))]
        rows.append([*(cell(factor_cell(n, first[n])) for n in candidates.conditions), *cells])
    heads = [*map(heading, candidates.conditions), "Valid designs", worst, "Best design"]
    return {
        "factors": candidates.conditions,
        "heads": heads,
        "rows": rows,
        "of": int(condition.max()) + 1,
        "note": "",
    }


def alone(candidates: Candidates) -> bool:
    """Return whether the roller stands for the pair in every case, because the guide's hours are
    unknown.
    """
    return candidates.rising and not candidates.results.knows("guide_life_hours")


def first_words(row: pd.Series) -> str:
    """Say which body fails first, and in how many cases if it is not always the same."""
    counts = {word: int(row[f"first_{word}"]) for word in FIRST_TO_FAIL}
    known = {word: cases for word, cases in counts.items() if cases}
    if len(known) == 1:
        return next(iter(known))
    return ", ".join(f"{word} in {count(cases)}" for word, cases in known.items())
