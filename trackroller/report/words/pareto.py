"""Sentences on choices: the Pareto set of a study and the design points of an inner/outer design."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from trackroller.analysis.pareto import end_places, goals_of
from trackroller.analysis.table import StudyView
from trackroller.parameters import PARAMETERS
from trackroller.report.numbers import capital, lasting, long_name, quantity, with_unit
from trackroller.report.words.sentence import Sentence, say


def pareto_sentence(front: xr.Dataset, view: StudyView | None = None) -> Sentence:
    """State the size and the ends of a Pareto set, and how many of its designs lie outside the model.

    Parameters
    ----------
    front : dataset of `trackroller.analysis.pareto.pareto`
    view : the study, for the validity of the designs
    """
    best, goals = np.flatnonzero(front["optimal"].values == 1), [name for name, _ in goals_of(front)]
    kind, rows = str(front.attrs.get("kind", "design")), front["row"].values[best]
    values: dict[str, Any] = {name: front.attrs.get(name, "") for name in ("excluded", "model", "judged")}
    values |= {"count": len(best), "of": front.sizes["row"], "kind": kind}
    if len(best):
        table = np.stack([front[name].values.astype(float) for name in goals], axis=1)
        ends = [[_goal_value(front, name, float(front[name].values[at])) for name in goals] for at in end_places(front)]
        words = [goal_words(front, name) for name in goals]
        values["goals"] = [f"{word} {value}" for word, value in zip(words, ends[0], strict=True)]
        values["first"] = [f"{value} {word}" for word, value in zip(words, ends[0], strict=True)]
        first, second = table[end_places(front)[:2]]
        values["last"] = ends[1] if (first != second).any() else []
        values["alike"] = len(np.unique(table[best], axis=0)) == 1
    values["outside"] = int((~view.valid[rows]).sum()) if view is not None and kind == "design" else 0
    values["alone"] = "pair_life_hours" in goals and view is not None and not view.has("guide_life_hours")
    return say("pareto", "pareto", **values)


def goal_words(front: xr.Dataset, name: str) -> str:
    """Name a goal or a factor of a Pareto set."""
    return str(front[name].attrs.get("long_name") or long_name(name))


def goal_heading(front: xr.Dataset, name: str) -> str:
    """Return the words and the unit of a goal or factor of a Pareto set, as the head of a column."""
    units = str(front[name].attrs.get("units", "")) or (PARAMETERS[name].unit if name in PARAMETERS else "")
    text = capital(goal_words(front, name))
    return with_unit(text, units) if units and units not in ("1", "-") else text


def _goal_value(front: xr.Dataset, name: str, value: float) -> str:
    """Write a goal's value with its unit; a life beyond the S-N data says so."""
    unit = str(front[name].attrs.get("units", "1") or "1")
    if f"beyond_{name}" in front:
        return lasting(value, unit, bool(front[f"beyond_{name}"].values[front[name].values == value].any()))
    return quantity(value, unit)
