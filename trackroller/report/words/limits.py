"""Sentences and a table on limits: which one comes first, how they change the order of designs, what each costs."""

from __future__ import annotations

import numpy as np

from trackroller.damage import LIMITS
from trackroller.damage.wear import KM_PER_HOUR
from trackroller.report.numbers import capital, count, level_text, long_name, rounded
from trackroller.report.tables.table import Table, factor_cell, heading
from trackroller.report.words.designs import design_words
from trackroller.report.words.sentence import Sentence, say
from trackroller.results.candidates import Candidates
from trackroller.results.first_limits import Turn, deciding, first_limit, turn
from trackroller.results.limit_notes import guessed_values
from trackroller.results.lives import FIRST_LIMIT
from trackroller.results.results import Results
from trackroller.results.unsure import COEFFICIENT, POSITION, settled, varied


def title(name: str) -> str:
    """Return the words of a limit without the remark in brackets."""
    return LIMITS[name].title.partition(" (")[0]


def limit_sentences(results: Results) -> list[Sentence]:
    """Say how often each limit comes first, and how the order of the designs turns; nothing without limits."""
    candidates = results.candidates()
    if candidates is None or candidates.goal != FIRST_LIMIT:
        return []
    names = first_limit(results)[results.valid]
    counts = {n: int((names == n).sum()) for n in sorted(set(names) - {""}, key=lambda n: -int((names == n).sum()))}
    titles = {title(name): cases for name, cases in counts.items()}
    said = [say("limits", "first_limits", counts=titles, valid=int(results.valid.sum()))] if counts else []
    order, same = turn(candidates), whichever_first(results)
    turned = None if order is None else _turned(candidates, order)
    return [*said, *(sentence for sentence in (turned, same) if sentence is not None)]


def guesses(results: Results) -> Sentence | None:
    """Name the limits that rest on placeholders of materials, with the materials; None if no limit does."""
    placed: dict[str, dict[str, None]] = {}
    for limit, material, _ in guessed_values(results.data):
        placed.setdefault(title(limit), {})[material.strip("'")] = None
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


def _unsure(candidates: Candidates) -> dict[str, str]:
    """Return words for the values that a study varies within their ranges, and for the ranges."""
    names = varied(candidates)
    if names == [POSITION]:
        return {"what": "placeholders of materials", "span": "each within its range"}
    factors = candidates.results.table[COEFFICIENT]
    span = f"each from {rounded(factors.min())} to {rounded(factors.max())} times its value"
    return {"what": "wear coefficients" + " and other placeholders" * (POSITION in names), "span": span}


def whichever_first(results: Results) -> Sentence | None:
    """Say in how many conditions the first limit is the same for all values within their ranges; None without them."""
    candidates = results.candidates()
    counts = settled(candidates) if candidates is not None else None
    if candidates is None or counts is None or not counts[1]:
        return None
    return say("limits", "whichever_first", certain=counts[0], of=counts[1], **_unsure(candidates))


def _turned(candidates: Candidates, order: Turn) -> Sentence:
    """Say how many designs change their place, and which one changes most."""
    before, after = order.before, order.after
    steps = {i: before.index(i) - after.index(i) for i in after}
    most = max(steps, key=lambda i: abs(steps[i]))
    values = {"changed": sum(step != 0 for step in steps.values()), "designs": len(after)}
    values |= {"before": before.index(most) + 1, "after": after.index(most) + 1}
    name = design_words(candidates, candidates.table.iloc[after.index(most)])
    return say("limits", "turned", **values, correlation=order.correlation, name=name)


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
    note = "Number of valid cases that each limit of the pair ends first."
    if others:
        note += f" {capital(long_name(others[0]))} across."
    return Table.of("first_limits", "Which limit comes first", rows, note)


def _counts(names: np.ndarray) -> str:
    """Write 'shakedown 9, heat 3', the most frequent limit first; a dash without a valid case."""
    known, counts = np.unique(names[names != ""].astype(str), return_counts=True)
    order = np.argsort(-counts, kind="stable")
    return ", ".join(f"{title(known[i])} {count(int(counts[i]))}" for i in order) or "–"
