"""Which limit ends the pair first, over the two factors that decide it."""

from __future__ import annotations

import numpy as np

from trackroller.analysis.first_limits import deciding, first_limit
from trackroller.analysis.lives import FIRST_LIMIT
from trackroller.analysis.table import StudyView
from trackroller.report.numbers import capital, count, level_text, long_name
from trackroller.report.tables.table import Table, factor_cell, heading
from trackroller.report.words.limits import title


def first_limit_table(view: StudyView) -> Table | None:
    """Count the first limits of the valid cases over the two factors that decide most about them.

    None for a study without limits, or if the first limit depends on no factor.
    """
    if view.life != FIRST_LIMIT:
        return None
    names = first_limit(view)
    factors = deciding(view, names)
    if not factors:
        return None
    first, *others = factors
    across = [(level, view.table[others[0]] == level) for level in view.levels(others[0])] if others else []
    rows = []
    for level in view.levels(first):
        mine = (view.table[first] == level).to_numpy() & view.valid
        parts = [mine & own.to_numpy() for _, own in across] or [mine]
        rows.append([factor_cell(first, level), *(_counts(names[part]) for part in parts)])
    heads = [level_text(others[0], level) for level, _ in across] or ["All valid cases"]
    note = "Number of valid cases that each limit of the pair ends first."
    if others:
        note += f" {capital(long_name(others[0]))} across."
    return Table("first_limits", "Which limit comes first", [heading(first), *heads], rows, note)


def _counts(names: np.ndarray) -> str:
    """Write 'shakedown 9, heat 3', the most frequent limit first; a dash without a valid case."""
    known, counts = np.unique(names[names != ""].astype(str), return_counts=True)
    order = np.argsort(-counts, kind="stable")
    return ", ".join(f"{title(known[i])} {count(int(counts[i]))}" for i in order) or "–"
