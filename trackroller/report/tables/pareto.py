"""The table of Pareto-optimal designs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from trackroller.analysis.pareto import end_places, goals_of
from trackroller.analysis.table import StudyView
from trackroller.report.numbers import Life, capital
from trackroller.report.tables.table import Table, factor_cell
from trackroller.report.words.accuracy import FRICTION_OUTPUTS
from trackroller.report.words.pareto import goal_heading, goal_words
from trackroller.report.words.sentence import Sentence
from trackroller.study.file.goals import statistic

MAX_DESIGNS = 12  # rows of the table of the Pareto set


def pareto_table(front: xr.Dataset, view: StudyView, error: Sentence | None) -> Table | None:
    """List Pareto-optimal designs along the first goal, with a column that says which lie outside the model."""
    goals = goals_of(front)
    best = np.flatnonzero(front["optimal"].values == 1)
    if not len(best) or front.sizes["row"] < 2:
        return None
    first, way = goals[0]
    best = best[np.argsort(front[first].values[best] * (-1 if way == "max" else 1), kind="stable")]
    spread = np.linspace(0, len(best) - 1, min(MAX_DESIGNS, len(best))).astype(int)
    shown = best[np.union1d(spread, np.flatnonzero(np.isin(best, end_places(front))))]  # the sentence names the ends
    kind = str(front.attrs.get("kind", "design"))
    head = capital(kind) if kind == "design point" else "Worst case" if front.attrs.get("judged") else "Case"
    columns: dict[str, Sequence[Any]] = {head: front["row"].values[shown].tolist()}
    arrows = {name: " ↑" if way == "max" else " ↓" for name, way in goals}
    further = [n for n in map(str, front.data_vars) if n not in (*arrows, "optimal") and not n.startswith("beyond_")]
    for name in (*arrows, *further):
        columns[goal_heading(front, name) + arrows.get(name, "")] = _column(front, name, shown)
    if kind != "design point":
        columns["Model"] = ["inside" if view.valid[row] else "outside" for row in columns[head]]
    wishes = [f"{goal_words(front, n)} as {'high' if w == 'max' else 'low'} as possible" for n, w in goals]
    note = f"{capital('; '.join(wishes))}."
    note += f" Allowed where {front.attrs['constraints']}." if front.attrs.get("constraints") else ""
    if len(best) > len(shown):
        note += f" The table shows {len(shown)} of the {len(best)} {kind}s, spread evenly along the first goal, and the"
        note += " best of each goal."
    note += f" {error.text}" if error and any(statistic(n)[1] in FRICTION_OUTPUTS for n, _ in goals) else ""
    rows = list(zip(*columns.values(), strict=True))
    return Table("pareto", f"Pareto-optimal {kind}s", list(columns), rows, note)


def _column(front: xr.Dataset, name: str, shown: np.ndarray) -> list[Any]:
    """Return the cells of a goal or factor; lives beyond the S-N data are marked."""
    values = front[name].values[shown].tolist()
    if f"beyond_{name}" in front:
        return [Life(v, b) for v, b in zip(values, front[f"beyond_{name}"].values[shown], strict=True)]
    return [factor_cell(name, v if isinstance(v, str) else float(v) + 0.0) for v in values]  # -0 is 0
