"""The sentence on the Pareto set of a study, and the table of its designs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from trackroller.parameters.of_carriage import parameter_of
from trackroller.report.numbers import Life, capital, lasting, listing, long_name, percent, quantity, with_unit
from trackroller.report.tables.table import Table, factor_cell
from trackroller.report.words.accuracy import FRICTION_OUTPUTS
from trackroller.report.words.designs import within_words
from trackroller.report.words.sentence import Sentence, phrase, say
from trackroller.results.pareto import end_places, goals_of, holes_of
from trackroller.results.results import Results
from trackroller.roller.output_names import is_life
from trackroller.study.file.goals import statistic


def pareto_sentence(front: xr.Dataset, results: Results | None = None) -> Sentence:
    """State the size and the ends of a Pareto set, and how many of its designs lie outside the model.

    Parameters
    ----------
    front : dataset of `trackroller.results.pareto.pareto`
    results : the study, for the validity of the designs
    """
    best, goals = np.flatnonzero(front["optimal"].values == 1), [name for name, _ in goals_of(front)]
    kind, rows = str(front.attrs.get("kind", "design")), front["row"].values[best]
    values: dict[str, Any] = {name: front.attrs.get(name, "") for name in ("model", "judged")}
    values |= {"count": len(best), "of": front.sizes["row"], "kind": kind}
    if len(best):
        table = np.stack([front[name].values.astype(float) for name in goals], axis=1)
        places = end_places(front)
        ends = [[_goal_value(front, name, float(front[name].values[at])) for name in goals] for at in places]
        words = [goal_words(front, name) for name in goals]
        values["goals"] = [f"{word} {value}" for word, value in zip(words, ends[0], strict=True)]
        values["first"] = [f"{value} {word}" for word, value in zip(words, ends[0], strict=True)]
        others = [i for i in range(1, len(places)) if (table[places[i]] != table[places[0]]).any()]
        values["others"] = [listing(end) for end in dict.fromkeys(tuple(ends[i]) for i in others)]
        values["holes"] = holes_words(front)
        values["alike"] = len(np.unique(table[best], axis=0)) == 1
    if results is not None and results.ranged and any(is_life(statistic(name)[1]) for name in goals):
        values["judged"] = listing([text for text in (values["judged"], within_words(results)) if text])
    values["outside"] = int((~results.valid[rows]).sum()) if results is not None and kind == "design" else 0
    values["alone"] = "pair_life_hours" in goals and results is not None and not results.knows("guide_life_hours")
    return say("pareto", "pareto", several=len(goals) > 1, partly=partly_holding(front), **values)


def partly_holding(front: xr.Dataset) -> int:
    """Count the designs of a Pareto set that do not hold in all conditions in which any design holds."""
    if "valid_in" not in front or "conditions" not in front.attrs:
        return 0
    return int(((front["optimal"] == 1) & (front["valid_in"] < front.attrs["conditions"])).sum())


def holes_words(front: xr.Dataset, named: bool = True) -> list[str]:
    """Write the gaps of a Pareto set: between which values of a goal it has no design.

    The goal is `named`, unless the sentence around has named it.
    """
    goal, holes = holes_of(front)
    texts = [" and ".join(_goal_value(front, goal, value, plainly=True) for value in ends) for ends in holes]
    of_goal = f" of the {goal_words(front, goal)}" * named
    return [f"between {text}" + of_goal * (text is texts[-1]) for text in texts]


def goal_words(front: xr.Dataset, name: str) -> str:
    """Name a goal or a factor of a Pareto set."""
    return str(front[name].attrs.get("long_name") or long_name(name))


def goal_heading(front: xr.Dataset, name: str) -> str:
    """Return the words and the unit of a goal or factor of a Pareto set, as the head of a column."""
    units = str(front[name].attrs.get("units", "")) or getattr(parameter_of(name), "unit", "")
    text = capital(goal_words(front, name))
    return with_unit(text, units) if units and units not in ("1", "-") else text


def _goal_value(front: xr.Dataset, name: str, value: float, plainly: bool = False) -> str:
    """Write a goal's value with its unit; a life beyond the S-N data says so, unless it is an end of a hole."""
    unit = str(front[name].attrs.get("units", "1") or "1")
    if statistic(name)[0] == "probability":
        return percent(value)
    if f"beyond_{name}" in front and not plainly:
        return lasting(value, unit, bool(front[f"beyond_{name}"].values[front[name].values == value].any()))
    return quantity(value, unit)


MAX_DESIGNS = 12  # rows of the table of the Pareto set


def pareto_table(front: xr.Dataset, results: Results, error: Sentence | None) -> Table | None:
    """List Pareto-optimal designs along the first goal, with a column that says which lie outside the model."""
    goals = goals_of(front)
    best = np.flatnonzero(front["optimal"].values == 1)
    if min(len(goals), len(best)) < 2:
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
        columns["Model"] = ["inside" if results.valid[row] else "outside" for row in columns[head]]
    remark = error.text if error and any(statistic(n)[1] in FRICTION_OUTPUTS for n, _ in goals) else ""
    values = {"constraints": front.attrs.get("constraints"), "kind": kind, "error": remark}
    note = phrase("pareto", "note", **values, shown=len(shown), of=len(best))
    rows = list(zip(*columns.values(), strict=True))
    return Table("pareto", f"Pareto-optimal {kind}s", list(columns), rows, note)


def _column(front: xr.Dataset, name: str, shown: np.ndarray) -> list[Any]:
    """Return the cells of a goal or factor; lives beyond the S-N data are marked."""
    values = front[name].values[shown].tolist()
    if f"beyond_{name}" in front:
        return [Life(v, b) for v, b in zip(values, front[f"beyond_{name}"].values[shown], strict=True)]
    return [factor_cell(name, v if isinstance(v, str) else float(v) + 0.0) for v in values]  # -0 is 0
