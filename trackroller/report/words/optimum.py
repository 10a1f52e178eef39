"""Sentences on what a search for the best designs found."""

from __future__ import annotations

from typing import Any

import numpy as np

from trackroller.analysis.judging import beyond_data, choices_of, goal_column, optimum_of
from trackroller.analysis.table import StudyView
from trackroller.report.numbers import capital, count, lasting, listing, long_name, percent, plain, quantity, setting
from trackroller.report.words.sentence import Sentence

SMALL = 5e-4  # relative change of a goal below which it counts as unchanged


def optimum_sentences(view: StudyView) -> list[Sentence]:
    """Say which design a search recommends, how it was found, how sure its goals are, and what a tolerance costs.

    Returns
    -------
    The sentences; none for a study that is no search.
    """
    found = optimum_of(view.solved) if view.results is not None else None
    if found is None:
        return []
    said = [_recommended(view, found), _invalid(view, found), _unreached(view, found)]
    said += [_checked(view, found), _tolerance(view, found), _searched(found)]
    return [Sentence("optimum", text) for text in said if text]


def design_words(view: StudyView, number: int) -> str:
    """Name a design of a search by its choices."""
    return ", ".join(setting(name, value) for name, value in choices_of(view.solved, number).items())


def goal_texts(view: StudyView, found: dict[str, Any], one: dict[str, Any]) -> list[str]:
    """Write the goals of an optimum with their units; a life beyond the S-N data says so."""
    texts = []
    for goal, value in zip(found["goals"], one["values"], strict=True):
        _, units, words = goal_column(view.solved, goal)
        beyond = bool(beyond_data(view.solved, goal)[one["design"]])
        texts.append(f"{words} {lasting(value, units, beyond) if units == 'h' else quantity(value, units)}")
    return texts


def _recommended(view: StudyView, found: dict[str, Any]) -> str:
    best = next(one for one in found["optima"] if one["design"] == found["recommended"])
    text = f"Recommended: {design_words(view, best['design'])}. Its goals: {listing(goal_texts(view, found, best))}"
    if found["front"] == 1:
        return f"{text}. It is best in every goal."
    return f"{text}. Of {count(found['front'])} Pareto-optimal designs it is nearest to the best of every goal."


def _invalid(view: StudyView, found: dict[str, Any]) -> str:
    """Say that no design is valid in all conditions, and why."""
    least = min(one["violation"][0] for one in found["optima"])
    if least == 0:
        return ""
    many = view.solved.design.meta["inner_samples"]
    causes = sorted(found["reasons"].items(), key=lambda pair: -pair[1])
    told = listing([f"{plain(word)} ({count(n)} cases)" for word, n in causes])
    return (
        f"No design is valid in all {count(many)} conditions: the best ones fail in {percent(least)} of them. "
        f"What excludes cases: {told}. Relax a constraint, widen a range, or remove a condition that no design holds."
    )


def _unreached(view: StudyView, found: dict[str, Any]) -> str:
    """Name the probabilities and lives that no design brings above 0, and goals without a value."""
    low = []
    for goal, way in found["goals"].items():
        values, _, words = goal_column(view.solved, goal)
        if way == "max" and not np.nanmax(values, initial=0.0) > 0:
            low.append(words)
    return f"No design reaches a {listing(low)} above 0: the goal is out of reach in these ranges." if low else ""


def _checked(view: StudyView, found: dict[str, Any]) -> str:
    changes = [
        abs(b / a - 1) if a and np.isfinite([a, b]).all() else 0.0
        for one in found["optima"]
        for a, b in zip(one["values"], one["reference"], strict=True)
    ]
    worse = sum(one["violation"][1] > one["violation"][0] for one in found["optima"])
    text = f"Solved again at `reference`, the goals of {count(len(found['optima']))} optima change by at most "
    text += f"{100 * max(changes):.2g} %."
    return text + (f" {count(worse)} of them are valid in fewer conditions there." if worse else "")


def _tolerance(view: StudyView, found: dict[str, Any]) -> str:
    """Say what a small change of each real choice costs."""
    best = next(one for one in found["optima"] if one["design"] == found["recommended"])
    words = [goal_column(view.solved, goal)[2] for goal in found["goals"]]
    told = []
    for near in found["neighbours"]:
        head = f"{long_name(near['choice'])} {near['step']}"
        if near["violation"] > best["violation"][0]:
            told.append(f"{head} makes it invalid in {percent(near['violation'])} of the conditions")
            continue
        changes = [
            f"{words[i]} by {100 * (b / a - 1):+.2g} %"
            for i, (a, b) in enumerate(zip(best["values"], near["values"], strict=True))
            if a and np.isfinite([a, b]).all() and abs(b / a - 1) > SMALL
        ]
        told.append(f"{head} changes {listing(changes)}" if changes else f"{head} changes no goal")
    return f"Tolerance: {'; '.join(told)}." if told else ""


def _searched(found: dict[str, Any]) -> str:
    text = f"The search solved {count(found['designs'])} designs in {found['generations']} generations with "
    text += f"`{found['model']}`; {count(found['valid'])} are valid in all conditions. It ended because "
    return capital(f"{text}{found['stopped']}.")
