"""The table of the optima that a search reports."""

from __future__ import annotations

from typing import Any

from trackroller.analysis.judging import beyond_data, choices_of, goal_column, optimum_of
from trackroller.analysis.table import StudyView
from trackroller.report.numbers import Life, capital, percent, with_unit
from trackroller.report.tables.table import Table, factor_cell, heading

MOST = 5  # designs that stand side by side


def optima_table(view: StudyView, most: int = MOST) -> Table | None:
    """Compare the recommended design and further optima, as columns: choices, goals, goals at reference."""
    found = optimum_of(view.solved) if view.results is not None else None
    if found is None:
        return None
    shown = sorted(found["optima"], key=lambda one: one["design"] != found["recommended"])[:most]
    choices = [choices_of(view.solved, one["design"]) for one in shown]
    rows: list[list[Any]] = [[heading(n), *(factor_cell(n, own[n]) for own in choices)] for n in choices[0]]
    for i, (goal, way) in enumerate(found["goals"].items()):
        _, units, words = goal_column(view.solved, goal)
        head = with_unit(capital(words), units) if units not in ("", "1") else capital(words)
        for key, told in (("values", " ↑" if way == "max" else " ↓"), ("reference", ", at reference")):
            numbers = [float(one[key][i]) for one in shown]
            if "life" in goal and units == "h":
                marked = beyond_data(view.solved, goal)
                numbers = [Life(v, bool(marked[one["design"]])) for v, one in zip(numbers, shown, strict=True)]
            rows.append([f"{head}{told}", *numbers])
    if any(one["violation"][0] for one in shown):
        rows.append(["Not valid in", *(percent(one["violation"][0]) for one in shown)])
    heads = ["", "Recommended", *(f"Optimum {i}" for i in range(2, len(shown) + 1))]
    marks = {(i, j) for i, row in enumerate(rows) for j in range(2, len(row)) if row[j] != row[1]}
    note = "Each design is judged over all its conditions. Bold: differs from the recommended design."
    return Table("optima", "Optima of the search", heads, rows, note, frozenset(marks))
