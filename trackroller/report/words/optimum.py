"""Sentences on what a search for the best designs found."""

from __future__ import annotations

from typing import Any

import numpy as np

from trackroller.analysis.judging import beyond_data, choices_of, goal_column, optimum_of
from trackroller.analysis.table import StudyView
from trackroller.parameters import PARAMETERS
from trackroller.report.numbers import capital, count, lasting, listing, long_name, percent, plain, quantity, setting
from trackroller.report.words.sentence import Sentence

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
    said = [_invalid(view, search)]
    if least_violation(search) < 1:
        said += [_recommended(view, search), _unreached(view, search), _checked(view, search), _tolerance(view, search)]
    said.append(_searched(search))
    return [Sentence("optimum", text) for text in said if text]


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


def _recommended(view: StudyView, search: dict[str, Any]) -> str:
    best = next(one for one in search["optima"] if one["design"] == search["recommended"])
    head = "Closest to valid" if least_violation(search) else "Recommended"
    text = f"{head}: {design_words(view, best['design'])}. Its goals: {listing(goal_texts(view, search, best))}"
    if search["front"] == 1:
        return f"{text}. It is best in every goal."
    if all(one["values"] == best["values"] for one in search["optima"]):
        return f"{text}. {count(search['front'])} designs have the same goals, so the goals do not choose among them."
    return f"{text}. Of {count(search['front'])} Pareto-optimal designs it is nearest to the best of every goal."


def _invalid(view: StudyView, search: dict[str, Any]) -> str:
    """Say that no design is valid in all conditions, and why."""
    least = least_violation(search)
    if least == 0:
        return ""
    many = view.solved.design.meta["inner_samples"]
    causes = sorted(search["reasons"].items(), key=lambda pair: -pair[1])
    excluded = listing([f"{plain(word)} ({count(n)} cases)" for word, n in causes])
    text = f"No design is valid in all {count(many)} conditions: the best ones fail in {percent(least)} of them. "
    if least == 1:
        text = "No design is valid in any condition. " if many > 1 else "No design is valid. "
    text += f"Cases are excluded by {excluded}. Relax a constraint, widen a range, or remove a condition in which no "
    return f"{text}design is valid."


def _unreached(view: StudyView, search: dict[str, Any]) -> str:
    """Name the probabilities and lives that no design brings above 0, and goals without a value."""
    low = []
    for goal, way in search["goals"].items():
        values, _, words = goal_column(view.solved, goal)
        if way == "max" and not np.nanmax(values, initial=0.0) > 0:
            low.append(words)
    return f"No design brings the {listing(low)} above 0: the goal is out of reach in these ranges." if low else ""


def _checked(view: StudyView, search: dict[str, Any]) -> str:
    changes = [
        abs(b / a - 1) if a and np.isfinite([a, b]).all() else 0.0
        for one in search["optima"]
        for a, b in zip(one["values"], one["reference"], strict=True)
    ]
    worse = sum(one["violation"][1] > one["violation"][0] for one in search["optima"])
    many = len(search["optima"])
    what = f"{count(many)} optima change" if many > 1 else "the optimum change"
    text = f"Solved again at `reference`, the goals of {what} by at most "
    text += f"{100 * max(changes):.2g} %."
    return text + (f" {count(worse)} of them are valid in fewer conditions there." if worse else "")


def _tolerance(view: StudyView, search: dict[str, Any]) -> str:
    """Say what a small change of each real choice costs."""
    best = next(one for one in search["optima"] if one["design"] == search["recommended"])
    words = [goal_column(view.solved, goal)[2] for goal in search["goals"]]
    changed = []
    for near in search["neighbours"]:
        step, units = float(near["step"]), PARAMETERS[near["choice"]].unit if near["choice"] in PARAMETERS else "1"
        head = f"{long_name(near['choice'])} {'+' if step > 0 else ''}{quantity(step, units)}"
        if near["violation"] > best["violation"][0]:
            changed.append(f"{head} makes it invalid in {percent(near['violation'])} of the conditions")
            continue
        changes = [
            f"{words[i]} by {100 * (b / a - 1):+.2g} %".replace("-", "−")
            for i, (a, b) in enumerate(zip(best["values"], near["values"], strict=True))
            if a and np.isfinite([a, b]).all() and abs(b / a - 1) > SMALL
        ]
        changed.append(f"{head} changes {listing(changes)}" if changes else f"{head} changes no goal")
    return f"Tolerance: {'; '.join(changed)}." if changed else ""


def _searched(search: dict[str, Any]) -> str:
    designs, generations = search["designs"], search["generations"]
    text = f"The search solved {count(designs)} design{'s' * (designs != 1)} in {generations} "
    text += f"generation{'s' * (generations != 1)} with "
    text += f"`{search['model']}`; {count(search['valid'])} are valid in all conditions. It ended because "
    beside = f" Beside the budget it solved {search['beside']}." if search.get("beside") else ""
    return capital(f"{text}{search['stopped']}.{beside}")
