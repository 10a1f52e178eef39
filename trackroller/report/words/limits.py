"""Sentences and a table on limits: which one comes first, and what they rest on."""

from __future__ import annotations

import numpy as np

from trackroller.damage.wear import KM_PER_HOUR
from trackroller.report.numbers import capital, count, level_text, long_name, quantity
from trackroller.report.tables.table import Table, factor_cell, heading
from trackroller.report.words.designs import limit_title, within_words
from trackroller.report.words.sentence import Sentence, say
from trackroller.results.findings import Finding
from trackroller.results.first_limits import deciding, first_limit
from trackroller.results.lives import FIRST_LIMIT
from trackroller.results.results import Results
from trackroller.roller.limit_notes import guessed_lines, placeholders_of


def limit_words(_: Results, finding: Finding) -> Sentence:
    """Say which limits come first."""
    counts = {limit_title(name): cases for name, cases in finding.values["counts"].items()}
    beaten = {limit_title(name): quantity(hours, "h") for name, hours in finding.values["beaten"].items()}
    return say("limits", "first_limits", counts=counts, valid=finding.values["of"], beaten=beaten)


def guesses(results: Results) -> Sentence | None:
    """Name the limits that rest on placeholders of materials, with the materials; None if no limit does."""
    placed: dict[str, dict[str, None]] = {}
    if results.life is not None and (lines := guessed_lines(results.data)):
        placed[limit_title("fatigue")] = dict.fromkeys(lines)
    for one in placeholders_of(results.data):
        placed.setdefault(limit_title(one.limit), {})[one.material] = None
    return say("limits", "guesses", placed={limit: list(own) for limit, own in placed.items()}) if placed else None


def worn(results: Results) -> Sentence | None:
    """Say in how many cases the groove wears away before the life ends; None if in none."""
    rows, name = results.valid & results.flagged("worn"), FIRST_LIMIT[0]
    if results.has(name):
        speed = results.column("velocity") if results.has("velocity") else float(results.data["velocity"])
        rows = rows & (KM_PER_HOUR * speed * results.column(name) > results.column("run_in_distance"))
    if not rows.any():
        return None
    km, valid = results.column("run_in_distance")[rows], int(results.valid.sum())
    values = {"count": int(rows.sum()), "valid": valid, "of_limits": results.has(name)}
    return say("limits", "worn", **values, least=km.min(), most=km.max())


def first_limit_table(results: Results) -> Table | None:
    """Count the first limits of the valid cases over the two factors that decide most about them.

    None for a study without limits, or if the first limit depends on no factor.
    """
    if results.life != FIRST_LIMIT:
        return None
    names = first_limit(results)
    factors = deciding(results, names)
    if not factors:
        return None
    first, *others = factors
    across = {"All valid cases": results.valid}
    for other in others:
        across = {
            level_text(other, v): results.valid & (results.table[other] == v).to_numpy() for v in results.levels(other)
        }
    rows = []
    for level in results.levels(first):
        own = (results.table[first] == level).to_numpy()
        counts = {head: _counts(names[own & rows_there]) for head, rows_there in across.items()}
        rows.append({heading(first): factor_cell(first, level)} | counts)
    note = "Number of valid cases that each limit of the pair ends first"
    note += f", with {within_words(results)}." if results.ranged else "."
    if others:
        note += f" {capital(long_name(others[0]))} across."
    return Table.of("first_limits", "Which limit comes first", rows, note)


def _counts(names: np.ndarray) -> str:
    """Write 'shakedown 9, heat 3', the most frequent limit first; a dash without a valid case."""
    known, counts = np.unique(names[names != ""].astype(str), return_counts=True)
    order = np.argsort(-counts, kind="stable")
    return ", ".join(f"{limit_title(known[i])} {count(int(counts[i]))}" for i in order) or "–"
