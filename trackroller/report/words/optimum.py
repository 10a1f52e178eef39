"""Sentences and a table on the result of a search for the best designs."""

from __future__ import annotations

from typing import Any

import numpy as np

from trackroller.parameters.of_carriage import parameter_of
from trackroller.report.numbers import Life, capital, lasting, long_name, percent, quantity, setting, with_unit
from trackroller.report.tables.table import Table, factor_cell, heading
from trackroller.report.words.designs import BEST, compared, ended_by
from trackroller.report.words.sentence import Sentence, say
from trackroller.report.words.verdict import SHORT, given_in_vain
from trackroller.results.judging import beyond_data, choices_of, goal_column, optimum_of
from trackroller.results.results import Results
from trackroller.results.verdict import not_checked
from trackroller.roller.output_names import is_life
from trackroller.study.file.search import judged_by

AT_END = 1e-3  # of the range of a choice, within which a value stands at its end
SMALL = 5e-4  # relative change of a goal below which it counts as unchanged


def optimum_sentences(results: Results) -> list[Sentence]:
    """Say which design a search recommends, how it was found, how sure its goals are, and what a tolerance costs.

    Returns
    -------
    The sentences; none for a study that is no search.
    """
    search = optimum_of(results)
    if search is None:
        return []
    least = least_violation(search)
    said = [_invalid(results, search, least) if least else None]
    if least < 1:
        best = next(one for one in search["optima"] if one["design"] == search["recommended"])
        said += [_recommended(results, search, best), _unreached(results, search), _checked(search)]
        said.append(_tolerance(results, search, best))
    facts = ("designs", "generations", "model", "valid", "stopped")
    said.append(_unchecked(results, search))
    said.append(say("optimum", "searched", beside=search.get("beside"), **{name: search[name] for name in facts}))
    return [sentence for sentence in said if sentence is not None]


def least_violation(search: dict[str, Any]) -> float:
    """Return the share of the conditions in which the best design is not valid [1]; 0 if a design is always valid."""
    return float(min((one["violation"][0] for one in search["optima"]), default=1.0))


def design_words(results: Results, number: int) -> str:
    """Name a design of a search by its choices."""
    return ", ".join(setting(name, value) for name, value in choices_of(results, number).items())


def goal_texts(results: Results, search: dict[str, Any], one: dict[str, Any]) -> list[str]:
    """Write the goals of an optimum with their units; a life beyond the S-N data says so."""
    texts = []
    for goal, value in zip(search["goals"], one["values"], strict=True):
        _, units, words = goal_column(results, goal)
        beyond = bool(beyond_data(results, goal)[one["design"]])
        texts.append(f"{words} {lasting(value, units, beyond) if units == 'h' else quantity(value, units)}")
    return texts


def _recommended(results: Results, search: dict[str, Any], best: dict[str, Any]) -> Sentence:
    values = {
        "least": least_violation(search),
        "design": design_words(results, best["design"]),
        "front": search["front"],
        "constraints": [str(one) for one in results.config.constraints],
    }
    values["edges"] = [long_name(name) for name in _edges(results, best["design"])]
    alike = all(one["values"] == best["values"] for one in search["optima"])
    values["goals"] = goal_texts(results, search, best)
    several = len(search["goals"]) > 1 and search["front"] > 1 and not alike
    if several and not values["least"] and not results.config.analysis.target:  # the goals alone do not choose
        ends = [goal_texts(results, search, one) for one in _ends(search)]
        return say("optimum", "requirement", ends=ends, **values)
    return say("optimum", "recommended", alike=alike, **values)


def _ends(search: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the optima that are best in the first and in the last goal."""
    signs = [-1.0 if direction == "max" else 1.0 for direction in search["goals"].values()]
    return [min(search["optima"], key=lambda one: signs[i] * one["values"][i]) for i in (0, len(signs) - 1)]


def _edges(results: Results, number: int) -> list[str]:
    """Return the choices of a design that stand at an end of the range that the search may take."""
    found = []
    for name, value in choices_of(results, number).items():
        ends = results.design.factors[name].numbers[:2]
        width = ends[1] - ends[0] if len(ends) == 2 else 0.0
        if width and min(abs(value - end) for end in ends) <= AT_END * abs(width):
            found.append(name)
    return found


def _unchecked(results: Results, search: dict[str, Any]) -> Sentence | None:
    """Name the limits that the search did not check, where a goal is a life."""
    if not any(is_life(judged_by(goal)[1]) for goal in search["goals"]):
        return None
    left_out = not_checked(results)
    names = [SHORT.get(name) or ended_by(name) for name in left_out]
    vain = given_in_vain(results, left_out)
    return say("verdict", "not_checked", names=names, vain=vain) if names else None


def _invalid(results: Results, search: dict[str, Any], least: float) -> Sentence:
    """Say that no design is valid in all conditions, and why."""
    reasons = sorted(search["reasons"].items(), key=lambda pair: -pair[1])
    conditions = results.design.meta["inner_samples"]
    return say("optimum", "invalid", least=least, conditions=conditions, reasons=reasons)


def _unreached(results: Results, search: dict[str, Any]) -> Sentence | None:
    """Name the probabilities and lives that no design brings above 0, and goals without a value."""
    low = []
    for goal in (goal for goal, way in search["goals"].items() if way == "max"):
        values, _, words = goal_column(results, goal)
        rises = is_life(goal) or judged_by(goal)[0] == "probability"  # other goals may be negative
        if np.isnan(values).all() or (rises and not np.nanmax(values) > 0):
            low.append(words)
    return say("optimum", "unreached", goals=low) if low else None


def _checked(search: dict[str, Any]) -> Sentence:
    optima = search["optima"]
    change = max(abs(c) for one in optima for c in _changes(one["values"], one["reference"]))
    worse = sum(one["violation"][1] > one["violation"][0] for one in optima)
    return say("optimum", "checked", change=change, worse=worse, many=len(optima), several=len(search["goals"]) > 1)


def _changes(before: list[float], after: list[float]) -> list[float]:
    """Return the relative changes of goals; 0 for a goal that was 0, and for unlimited goals."""
    return [b / a - 1 if a and np.isfinite([a, b]).all() else 0.0 for a, b in zip(before, after, strict=True)]


def _tolerance(results: Results, search: dict[str, Any], best: dict[str, Any]) -> Sentence | None:
    """Say what a small change of each real choice costs."""
    words, neighbours = [goal_column(results, goal)[2] for goal in search["goals"]], []
    for near in search["neighbours"]:
        name, step = near["choice"], float(near["step"])
        moved = f"{'+' if step > 0 else ''}{quantity(step, getattr(parameter_of(name), 'unit', '1'))}"
        invalid = near["violation"] if near["violation"] > best["violation"][0] else 0.0
        changes = zip(words, _changes(best["values"], near["values"]), strict=True)
        neighbours.append((long_name(name), moved, invalid, [pair for pair in changes if abs(pair[1]) > SMALL]))
    return say("optimum", "tolerance", neighbours=neighbours) if neighbours else None


def optima_table(results: Results) -> Table | None:
    """Compare the recommended design and further optima, as columns: choices, goals, goals at reference."""
    search = optimum_of(results)
    if search is None or least_violation(search) == 1:
        return None
    shown = sorted(search["optima"], key=lambda one: one["design"] != search["recommended"])[:BEST]
    choices = [choices_of(results, one["design"]) for one in shown]
    rows: list[list[Any]] = [[heading(n), *(factor_cell(n, own[n]) for own in choices)] for n in choices[0]]
    for i, (goal, way) in enumerate(search["goals"].items()):
        _, units, words = goal_column(results, goal)
        head = with_unit(capital(words), units) if units not in ("", "1") else capital(words)
        for key, mark in (("values", " ↑" if way == "max" else " ↓"), ("reference", ", at reference")):
            numbers = [float(one[key][i]) for one in shown]
            if is_life(goal) and units == "h":
                marked = beyond_data(results, goal)
                numbers = [Life(v, bool(marked[one["design"]])) for v, one in zip(numbers, shown, strict=True)]
            rows.append([f"{head}{mark}", *numbers])
    if any(one["violation"][0] for one in shown):
        rows.append(["Not valid in", *(percent(one["violation"][0]) for one in shown)])
    first = "Closest to valid" if least_violation(search) else "Recommended"
    heads = [first, *(f"Optimum {i}" for i in range(2, len(shown) + 1))]
    note = "Each design is judged over all its conditions. Bold: differs from the first design."
    return compared("optima", "Optima of the search", heads, rows, note)
