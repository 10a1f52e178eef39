"""Sentences on what a search for the best designs found."""

from __future__ import annotations

from typing import Any

import numpy as np

from trackroller.analysis.judging import beyond_data, choices_of, goal_column, optimum_of
from trackroller.analysis.table import StudyView
from trackroller.parameters import PARAMETERS
from trackroller.report.numbers import lasting, long_name, quantity, setting
from trackroller.report.words.sentence import Sentence, say

SMALL = 5e-4  # relative change of a goal below which it counts as unchanged


def optimum_sentences(view: StudyView) -> list[Sentence]:
    """Say which design a search recommends, how it was found, how sure its goals are, and what a tolerance costs.

    Returns
    -------
    The sentences; none for a study that is no search.
    """
    search = optimum_of(view.solved) if view.results is not None else None
    if search is None:
        return []
    least = least_violation(search)
    said = [_invalid(view, search, least) if least else None]
    if least < 1:
        best = next(one for one in search["optima"] if one["design"] == search["recommended"])
        said += [_recommended(view, search, best), _unreached(view, search), _checked(search)]
        said.append(_tolerance(view, search, best))
    facts = ("designs", "generations", "model", "valid", "stopped")
    said.append(say("optimum", "searched", beside=search.get("beside"), **{name: search[name] for name in facts}))
    return [sentence for sentence in said if sentence is not None]


def least_violation(search: dict[str, Any]) -> float:
    """Return the share of the conditions in which the best design is not valid [1]; 0 if a design is always valid."""
    return float(min((one["violation"][0] for one in search["optima"]), default=1.0))


def design_words(view: StudyView, number: int) -> str:
    """Name a design of a search by its choices."""
    return ", ".join(setting(name, value) for name, value in choices_of(view.solved, number).items())


def goal_texts(view: StudyView, search: dict[str, Any], one: dict[str, Any]) -> list[str]:
    """Write the goals of an optimum with their units; a life beyond the S-N data says so."""
    texts = []
    for goal, value in zip(search["goals"], one["values"], strict=True):
        _, units, words = goal_column(view.solved, goal)
        beyond = bool(beyond_data(view.solved, goal)[one["design"]])
        texts.append(f"{words} {lasting(value, units, beyond) if units == 'h' else quantity(value, units)}")
    return texts


def _recommended(view: StudyView, search: dict[str, Any], best: dict[str, Any]) -> Sentence:
    values = {"least": least_violation(search), "design": design_words(view, best["design"]), "front": search["front"]}
    alike = all(one["values"] == best["values"] for one in search["optima"])
    return say("optimum", "recommended", goals=goal_texts(view, search, best), alike=alike, **values)


def _invalid(view: StudyView, search: dict[str, Any], least: float) -> Sentence:
    """Say that no design is valid in all conditions, and why."""
    reasons = sorted(search["reasons"].items(), key=lambda pair: -pair[1])
    conditions = view.solved.design.meta["inner_samples"]
    return say("optimum", "invalid", least=least, conditions=conditions, reasons=reasons)


def _unreached(view: StudyView, search: dict[str, Any]) -> Sentence | None:
    """Name the probabilities and lives that no design brings above 0, and goals without a value."""
    wanted = [goal_column(view.solved, goal) for goal, way in search["goals"].items() if way == "max"]
    low = [words for values, _, words in wanted if not np.nanmax(values, initial=0.0) > 0]
    return say("optimum", "unreached", goals=low) if low else None


def _checked(search: dict[str, Any]) -> Sentence:
    optima = search["optima"]
    change = max(abs(c) for one in optima for c in _changes(one["values"], one["reference"]))
    worse = sum(one["violation"][1] > one["violation"][0] for one in optima)
    return say("optimum", "checked", change=change, worse=worse, many=len(optima))


def _changes(before: list[float], after: list[float]) -> list[float]:
    """Return the relative changes of goals; 0 for a goal that was 0, and for unlimited goals."""
    return [b / a - 1 if a and np.isfinite([a, b]).all() else 0.0 for a, b in zip(before, after, strict=True)]


def _tolerance(view: StudyView, search: dict[str, Any], best: dict[str, Any]) -> Sentence | None:
    """Say what a small change of each real choice costs."""
    words, neighbours = [goal_column(view.solved, goal)[2] for goal in search["goals"]], []
    for near in search["neighbours"]:
        name, step = near["choice"], float(near["step"])
        moved = f"{'+' if step > 0 else ''}{quantity(step, PARAMETERS[name].unit if name in PARAMETERS else '1')}"
        invalid = near["violation"] if near["violation"] > best["violation"][0] else 0.0
        changes = zip(words, _changes(best["values"], near["values"]), strict=True)
        neighbours.append((long_name(name), moved, invalid, [pair for pair in changes if abs(pair[1]) > SMALL]))
    return say("optimum", "tolerance", neighbours=neighbours) if neighbours else None
