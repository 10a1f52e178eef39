"""Sentences on choices: the Pareto set of a study and the design points of an inner/outer design."""

from __future__ import annotations

import numpy as np
import xarray as xr

from trackroller.analysis.pareto import end_places, goals_of
from trackroller.analysis.table import StudyView
from trackroller.parameters import PARAMETERS
from trackroller.report.numbers import GUIDE_UNKNOWN, capital, count, lasting, listing, long_name, quantity, with_unit
from trackroller.report.words.sentence import Sentence


def pareto_sentence(front: xr.Dataset, view: StudyView | None = None) -> Sentence:
    """State the size and the ends of a Pareto set, and how many of its designs lie outside the model.

    Parameters
    ----------
    front : dataset of `trackroller.analysis.pareto.pareto`
    view : the study, for the validity of the designs
    """
    best = np.flatnonzero(front["optimal"].values == 1)
    goals, left = goals_of(front), f"Left out: {front.attrs['excluded']}."
    model = f" The designs are those solved with {front.attrs['model']}." if front.attrs.get("model") else ""
    allowed, kind = count(front.sizes["row"]), str(front.attrs.get("kind", "design"))
    values = {"count": len(best), "of": front.sizes["row"], "ends": []}
    if not len(best):
        return Sentence("pareto", f"No {kind} is left. {left}{model}", values)
    ends = []
    for (name, _), at in zip(goals, end_places(front), strict=True):
        ends.append((name, int(front["row"][at]), {g: float(front[g].values[at]) for g, _ in goals}))
    goal_values = [f"{goal_words(front, n)} {_goal_value(front, n, ends[0][2][n])}" for n, _ in goals]
    alike = all(end[2] == ends[0][2] for end in ends) and len(np.unique(_goal_table(front)[best], axis=0)) == 1
    if front.sizes["row"] == 1:
        text = f"One {kind} is left, so there is no Pareto set: {listing(goal_values)}."
    elif len(best) == 1:
        text = f"One of {allowed} allowed {kind}s is best in everything: {listing(goal_values)}."
    elif alike:
        tied = f"{count(len(best))} of {allowed} allowed {kind}s tie"
        text = f"{tied}, and no other {kind} is better in a goal: {listing(goal_values)}."
    else:
        one, two = ends[0], ends[1]
        first = listing([f"{_goal_value(front, g, one[2][g])} {goal_words(front, g)}" for g, _ in goals])
        last = listing([_goal_value(front, g, two[2][g]) for g, _ in goals])
        span = f"from {first} to {last}" if one[2] != two[2] else f"all with {first}"
        text = f"{count(len(best))} of {allowed} allowed {kind}s are Pareto-optimal: {span}."
    if view is not None and kind == "design":
        outside = int((~view.valid[front["row"].values[best]]).sum())
        values["outside"] = outside
        text += (
            f" {count(outside)} of the set {'lies' if outside == 1 else 'lie'} outside the model." if outside else ""
        )
    text += f" The set takes {front.attrs['judged']}." if front.attrs.get("judged") else ""
    if kind == "case":
        text += (
            " Each case is one design at one condition; `design: inner_outer` compares designs over their conditions."
        )
    if any(name == "pair_life_hours" for name, _ in goals) and view is not None and not view.has("guide_life_hours"):
        text += f" {capital(GUIDE_UNKNOWN)}."
    return Sentence("pareto", f"{text} {left}{model}", values | {"ends": ends})


def _goal_table(front: xr.Dataset) -> np.ndarray:
    return np.stack([front[name].values.astype(float) for name, _ in goals_of(front)], axis=1)


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
