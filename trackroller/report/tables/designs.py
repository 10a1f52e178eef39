"""Tables of designs: the best ones with their lives, the body or limit that fails first, and their margins."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from trackroller.analysis.designs import Designs
from trackroller.analysis.table import StudyView
from trackroller.parameters import BODIES, FIRST_TO_FAIL
from trackroller.report.numbers import Life, capital, count, head_unit, percent, rounded
from trackroller.report.tables.table import Table, factor_cell, heading
from trackroller.report.words.designs import BEYOND_MEANS, alone, condition_words

BEST = 5  # designs in the table of the best


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
    marks = {(i, j) for i, row in enumerate(rows) for j in range(2, len(row)) if row[j] != row[1]}
    several = bool(designs.choices)
    heads, title = ["", *(_heads(best) if several else ["All conditions"])], "Best valid designs"
    title = title if several else "Life of the design"
    note = _note(designs)
    return Table("best_designs", title, heads, rows, note, frozenset(marks))


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
