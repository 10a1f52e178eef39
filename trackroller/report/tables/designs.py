"""Tables that compare the best designs side by side: of a study over its conditions, and of a search."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from trackroller.analysis.designs import Designs
from trackroller.analysis.judging import beyond_data, choices_of, goal_column, optimum_of
from trackroller.analysis.table import StudyView
from trackroller.parameters import BODIES, FIRST_TO_FAIL
from trackroller.report.numbers import Life, capital, count, head_unit, percent, rounded, with_unit
from trackroller.report.tables.table import Table, factor_cell, heading
from trackroller.report.words.designs import BEYOND_MEANS, alone, condition_words
from trackroller.report.words.optimum import least_violation

BEST = 5  # designs that stand side by side


def best_table(view: StudyView) -> Table | None:
    """List the best valid designs as columns, each over all its conditions.

    Where a design differs from the best one, the cell stands out.
    """
    designs = Designs.of(view)
    if designs is None or not designs.comparable:
        return None
    best = [row for _, row in designs.table.head(BEST).iterrows() if row["valid"]]
    rows: list[list[Any]] = [[heading(n), *(factor_cell(n, row[n]) for row in best)] for n in designs.choices]
    rows += _lives(designs, best) if designs.rising else _stresses(designs, best)
    for name, words in (("slip_margin", "Least margin to slip"), ("lift_off_margin", "Least margin to lift-off")):
        if any(row[name] < 1 for row in best):  # without a drive nothing slips
            rows.append([words, *(percent(row[name]) if np.isfinite(row[name]) else "–" for row in best)])
    if designs.conditions:
        for name, words in (("rolls", "Rolls in"), ("valid", "Valid in")):
            rows.append([words, *(f"{count(int(row[name]))} of {count(int(row['cases']))}" for row in best)])
    if (met := designs.targets_met()) is not None:
        places = designs.table.index[: len(best)]
        rows.append(
            ["Meets the targets in", *(f"{count(int(met[i]))} of {count(int(designs.size[i]))}" for i in places)]
        )
    if not designs.choices:
        return _compared("best_designs", "Life of the design", ["All conditions"], rows, _note(designs))
    return _compared("best_designs", "Best valid designs", _heads(best), rows, _note(designs))


def _compared(name: str, title: str, heads: list[str], rows: list[list[Any]], note: str) -> Table:
    """Return a table of designs as columns, in which the cells that differ from those of the first design stand out."""
    marks = {(i, j) for i, row in enumerate(rows) for j in range(2, len(row)) if row[j] != row[1]}
    return Table(name, title, ["", *heads], rows, note, frozenset(marks))


def _heads(best: list[pd.Series]) -> list[str]:
    """Return 'Best 1', or 'Best 1 (tie)' for designs that share a rank."""
    ranks = [int(row["rank"]) for row in best]
    return [f"Best {rank}{' (tie)' if ranks.count(rank) > 1 else ''}" for rank in ranks]


def _lives(designs: Designs, best: list[pd.Series]) -> list[list[Any]]:
    """Return the rows on lives, with the worst condition and the body that fails first."""
    words, unit = designs.goal[1], head_unit(designs.goal[2])
    several = bool(designs.conditions)
    rows: list[list[Any]] = []
    if designs.drawn:
        rows.append([f"Nine of ten reach [{unit}]", *(Life(row["b10"], row["b10_beyond"]) for row in best)])
        rows.append(["95 % interval", *(f"{rounded(row['b10_low'])} to {rounded(row['b10_high'])}" for row in best)])
    shown = (
        [("worst", "worst condition"), ("median", "median"), ("best", "best condition")] if several else [("worst", "")]
    )
    for key, place in shown:
        head = f"{capital(words)}{f', {place}' if place else ''} [{unit}]"
        rows.append([head, *(Life(row[key], row[f"{key}_beyond"]) for row in best)])
    if several:
        rows.append(["Worst condition", *(condition_words(designs, int(row["worst_case"])) for row in best)])
    if not alone(designs):
        for body in BODIES:
            if any(np.isfinite(row[f"worst_{body}"]) for row in best):
                head = f"Life of the {body}{', worst condition' if several else ''} [{unit}]"
                rows.append([head, *(Life(row[f"worst_{body}"], row[f"worst_{body}_beyond"]) for row in best)])
        rows.append(["Fails first", *(first_words(row) for row in best)])
    return rows


def first_words(row: pd.Series) -> str:
    """Say which body fails first, and in how many cases if it is not always the same."""
    counts = {word: int(row[f"first_{word}"]) for word in FIRST_TO_FAIL}
    parts = [f"{word} in {count(n)}" for word, n in counts.items() if n]
    return next(word for word, n in counts.items() if n) if len(parts) == 1 else ", ".join(parts)


def _stresses(designs: Designs, best: list[pd.Series]) -> list[list[Any]]:
    words = capital(designs.goal[1])
    keys = (("worst", "largest"), ("median", "median")) if designs.conditions else (("worst", ""),)
    rows = [[f"{words}{f', {of}' if of else ''} [MPa]", *(float(row[key]) for row in best)] for key, of in keys]
    if designs.conditions:
        rows.append(["Worst condition", *(condition_words(designs, int(row["worst_case"])) for row in best)])
    return rows


def _note(designs: Designs) -> str:
    """Say how designs are ranked, and what the table's terms mean."""
    view = designs.view
    by = "longer life" if designs.rising else "lower peak stress"
    note = f"Designs that are valid in more conditions come first, then those with a {by} at their worst condition."
    if designs.drawn and designs.rising:
        note = (
            "Designs by the life that nine of ten sampled conditions reach; a condition that is not valid counts as 0."
        )
    if not designs.conditions:
        note = f"Designs by {designs.goal[1]}."
    note += f" {BEYOND_MEANS}" if designs.rising else ""
    note += " Margin to slip: share of the transmissible force that the drive leaves. Margin to lift-off: load of the "
    note += "lighter over that of the heavier contact. Bold: differs from the best."
    model = f" Designs solved with {view.held_level('contact_model')}." if "contact_model" in view.factors else ""
    return note + model


def optima_table(view: StudyView) -> Table | None:
    """Compare the recommended design and further optima, as columns: choices, goals, goals at reference."""
    search = optimum_of(view.solved) if view.results is not None else None
    if search is None or least_violation(search) == 1:
        return None
    shown = sorted(search["optima"], key=lambda one: one["design"] != search["recommended"])[:BEST]
    choices = [choices_of(view.solved, one["design"]) for one in shown]
    rows: list[list[Any]] = [[heading(n), *(factor_cell(n, own[n]) for own in choices)] for n in choices[0]]
    for i, (goal, way) in enumerate(search["goals"].items()):
        _, units, words = goal_column(view.solved, goal)
        head = with_unit(capital(words), units) if units not in ("", "1") else capital(words)
        for key, mark in (("values", " ↑" if way == "max" else " ↓"), ("reference", ", at reference")):
            numbers = [float(one[key][i]) for one in shown]
            if "life" in goal and units == "h":
                marked = beyond_data(view.solved, goal)
                numbers = [Life(v, bool(marked[one["design"]])) for v, one in zip(numbers, shown, strict=True)]
            rows.append([f"{head}{mark}", *numbers])
    if any(one["violation"][0] for one in shown):
        rows.append(["Not valid in", *(percent(one["violation"][0]) for one in shown)])
    first = "Closest to valid" if least_violation(search) else "Recommended"
    heads = [first, *(f"Optimum {i}" for i in range(2, len(shown) + 1))]
    note = "Each design is judged over all its conditions. Bold: differs from the first design."
    return _compared("optima", "Optima of the search", heads, rows, note)
