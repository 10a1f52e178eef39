"""Sentences and a table on limits: which one comes first, how they change the order of designs, what each costs."""

from __future__ import annotations

import numpy as np

from trackroller.analysis.designs import Designs
from trackroller.analysis.first_limits import Turn, deciding, first_limit, turn, without_first
from trackroller.analysis.lives import FIRST_LIMIT, body_lives
from trackroller.analysis.table import StudyView
from trackroller.analysis.unsure import COEFFICIENT, POSITION, settled, unbeaten, varied
from trackroller.damage import LIMITS
from trackroller.damage.wear import KM_PER_HOUR
from trackroller.report.numbers import capital, count, level_text, long_name, rounded
from trackroller.report.tables.limits import guessed_values
from trackroller.report.tables.table import Table, factor_cell, heading
from trackroller.report.words.designs import design_words
from trackroller.report.words.sentence import Sentence, say

MOST_NAMED = 4  # designs that a sentence names


def title(name: str) -> str:
    """Return the words of a limit without the remark in brackets."""
    return LIMITS[name].title.partition(" (")[0]


def limit_of_best(view: StudyView) -> Sentence | None:
    """Say what ends the best design first at its worst condition, and its life without it; None without limits."""
    designs = Designs.of(view)
    if designs is None or designs.goal != FIRST_LIMIT or not designs.comparable or not designs.table.iloc[0]["valid"]:
        return None
    case = int(designs.table.iloc[0]["worst_case"])
    first, hours, following, then = without_first(view, case)
    lives = body_lives("").values()
    beyond = following == "fatigue" and any(view.beyond_data(name)[case] for name in lives)
    values = {"first": title(first), "hours": hours, "next": title(following), "then": then}
    return say("limits", "gain", **values, beyond=beyond, several=bool(designs.conditions))


def limit_sentences(view: StudyView) -> list[Sentence]:
    """Say how often each limit comes first, and how the order of the designs turns; nothing without limits."""
    designs = Designs.of(view)
    if designs is None or designs.goal != FIRST_LIMIT:
        return []
    names = first_limit(view)[view.valid]
    counts = {n: int((names == n).sum()) for n in sorted(set(names) - {""}, key=lambda n: -int((names == n).sum()))}
    titles = {title(name): cases for name, cases in counts.items()}
    said = [say("limits", "first_limits", counts=titles, valid=int(view.valid.sum()))] if counts else []
    order = turn(designs)
    return [*said, _turned(designs, order)] if order is not None else said


def guesses(view: StudyView) -> Sentence | None:
    """Name the limits that rest on placeholders of materials, with the materials; None if no limit does."""
    placed: dict[str, dict[str, None]] = {}
    for limit, material, _ in guessed_values(view.data):
        placed.setdefault(title(limit), {})[material.strip("'")] = None
    return say("limits", "guesses", placed={limit: list(own) for limit, own in placed.items()}) if placed else None


def worn(view: StudyView) -> Sentence | None:
    """Say in how many cases the groove wears away before the life ends; None if in none."""
    rows, name = view.valid & view.flagged("worn"), FIRST_LIMIT[0]
    if view.has(name):
        speed = view.column("velocity") if view.has("velocity") else float(view.data["velocity"])
        rows = rows & (KM_PER_HOUR * speed * view.column(name) > view.column("run_in_distance"))
    if not rows.any():
        return None
    km, valid = view.column("run_in_distance")[rows], int(view.valid.sum())
    values = {"count": int(rows.sum()), "valid": valid, "of_limits": view.has(name)}
    return say("limits", "worn", **values, least=km.min(), most=km.max())


def best_whatever(view: StudyView) -> Sentence | None:
    """Say which designs are the best whatever the values known within a range are; None without such values."""
    designs = Designs.of(view)
    best = unbeaten(designs) if designs is not None else None
    if designs is None or best is None or not len(best):
        return None
    rows = designs.table[designs.table.index.isin(best)]
    names = [design_words(designs, row) for _, row in rows.iterrows()]
    values = {"designs": rows.index.tolist(), "of": len(designs.size), "names": names, "most": MOST_NAMED}
    return say("limits", "best_whatever", **values, **_unsure(designs))


def _unsure(designs: Designs) -> dict[str, str]:
    """Return words for the values that a study varies within their ranges, and for the ranges."""
    names = varied(designs)
    if names == [POSITION]:
        return {"what": "placeholders of materials", "span": "each within its range"}
    factors = designs.view.table[COEFFICIENT]
    span = f"each from {rounded(factors.min())} to {rounded(factors.max())} times its value"
    return {"what": "wear coefficients" + " and other placeholders" * (POSITION in names), "span": span}


def whichever_first(view: StudyView) -> Sentence | None:
    """Say in how many conditions the first limit is the same for all values within their ranges; None without them."""
    designs = Designs.of(view)
    counts = settled(designs) if designs is not None else None
    if designs is None or counts is None or not counts[1]:
        return None
    return say("limits", "whichever_first", certain=counts[0], of=counts[1], **_unsure(designs))


def _turned(designs: Designs, order: Turn) -> Sentence:
    """Say how many designs change their place, and which one changes most."""
    before, after = order.before, order.after
    steps = {i: before.index(i) - after.index(i) for i in after}
    most = max(steps, key=lambda i: abs(steps[i]))
    values = {"changed": sum(step != 0 for step in steps.values()), "designs": len(after)}
    values |= {"before": before.index(most) + 1, "after": after.index(most) + 1}
    name = design_words(designs, designs.table.iloc[after.index(most)])
    return say("limits", "turned", **values, correlation=order.correlation, name=name)


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
    across = {"All valid cases": view.valid}
    for other in others:
        across = {level_text(other, v): view.valid & (view.table[other] == v).to_numpy() for v in view.levels(other)}
    rows = []
    for level in view.levels(first):
        own = (view.table[first] == level).to_numpy()
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
