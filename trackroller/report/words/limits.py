"""Sentences on limits: which one the pair reaches first, how they change the order of designs, and what each costs."""

from __future__ import annotations

import numpy as np

from trackroller.analysis.designs import Designs
from trackroller.analysis.first_limits import first_limit, turn, without_first
from trackroller.analysis.lives import FIRST_LIMIT, body_lives
from trackroller.analysis.table import StudyView
from trackroller.analysis.unsure import COEFFICIENT, POSITION, settled, unbeaten, varied
from trackroller.damage import LIMITS
from trackroller.damage.wear import KM_PER_HOUR
from trackroller.report.numbers import capital, count, lasting, listing, rounded
from trackroller.report.tables.limits import guessed_values
from trackroller.report.words.designs import design_words
from trackroller.report.words.sentence import Sentence

MOST_NAMED = 4  # designs that a sentence names


def title(name: str) -> str:
    """Return the words of a limit without the remark in brackets."""
    return LIMITS[name].title.partition(" (")[0]


def limit_of_best(view: StudyView) -> Sentence | None:
    """Say which limit the best design reaches first, and its life without this limit; None without limits."""
    designs = Designs.of(view)
    if designs is None or designs.goal != FIRST_LIMIT or not designs.comparable or not designs.table.iloc[0]["valid"]:
        return None
    return _gain(designs)


def limit_sentences(view: StudyView) -> list[Sentence]:
    """Say how often each limit comes first, and how the order of the designs turns; nothing without limits."""
    designs = Designs.of(view)
    if designs is None or designs.goal != FIRST_LIMIT:
        return []
    names = first_limit(view)[view.valid]
    counts = {n: int((names == n).sum()) for n in sorted(set(names) - {""}, key=lambda n: -int((names == n).sum()))}
    parts = [f"{title(n)} in {count(k)}" for n, k in counts.items()]
    text = f"The first limit of the pair is {listing(parts)} of the {count(int(view.valid.sum()))} valid cases."
    said = [Sentence("first_limits", text, counts, view.valid)] if counts else []
    order = turn(designs)
    if order is not None:
        said.append(_turned(designs, order.before, order.after, order.correlation))
    return said


def guesses(view: StudyView) -> Sentence | None:
    """Name the limits that rest on placeholders of materials, with the materials; None if no limit does."""
    materials: dict[str, list[str]] = {}
    for limit, material, _ in guessed_values(view.data):
        materials.setdefault(limit, []).append(material.strip("'"))
    placed = [f"{title(name)} ({listing(list(dict.fromkeys(own)))})" for name, own in materials.items()]
    text = f"Placeholders of materials, guesses without a source, decide {listing(placed)}: measure them."
    return Sentence("guesses", text, materials) if placed else None


def worn(view: StudyView) -> Sentence | None:
    """Say in how many cases the groove wears away before the life ends; None if in none."""
    rows, name = view.valid & view.flagged("worn"), FIRST_LIMIT[0]
    end = "a life of roller or guide ends"
    if view.has(name):
        speed = view.column("velocity") if view.has("velocity") else float(view.data["velocity"])
        travel = KM_PER_HOUR * speed * view.column(name)
        rows, end = rows & (travel > view.column("run_in_distance")), "the pair reaches its first limit"
    if not rows.any():
        return None
    km = view.column("run_in_distance")[rows]
    text = f"In {count(int(rows.sum()))} of {count(int(view.valid.sum()))} valid cases the groove wears away "
    text += f"(run-in distance {rounded(km.min())} to {rounded(km.max())} km) before {end}: the rate of "
    text += "the new profiles gives the lives of these cases by order of magnitude only."
    return Sentence("worn", text, {"count": int(rows.sum()), "least": km.min(), "most": km.max()}, view.valid)


def best_whatever(view: StudyView) -> Sentence | None:
    """Say which designs are the best whatever the values known within a range are; None without such values."""
    designs = Designs.of(view)
    best = unbeaten(designs) if designs is not None else None
    if designs is None or best is None or not len(best):
        return None
    what, span = _unsure(view, varied(designs))
    rows = designs.table[designs.table.index.isin(best)]
    names = [design_words(designs, row) for _, row in rows.iterrows()]
    values = {"designs": rows.index.tolist(), "of": len(designs.size)}
    if len(names) == 1:
        text = f"Whatever the {what} are, {span}, the best design is {names[0]}."
        return Sentence("best_whatever", text, values, designs.usable)
    more = f" and {count(len(names) - MOST_NAMED)} more" if len(names) > MOST_NAMED else ""
    text = f"{capital(what)}, {span}, decide which of {count(len(names))} designs is the best: "
    text += f"{'; '.join(names[:MOST_NAMED])}{more}. "
    others = len(designs.size) - len(names)
    text += f"The other {count(others)} of {count(len(designs.size))} designs are never the best."
    return Sentence("best_whatever", text, values, designs.usable)


def _unsure(view: StudyView, names: list[str]) -> tuple[str, str]:
    """Return words for the values that a study varies within their ranges, and for the ranges."""
    if names == [POSITION]:
        return "placeholders of materials", "each within its range"
    factors = view.table[COEFFICIENT]
    span = f"each from {rounded(factors.min())} to {rounded(factors.max())} times its value"
    return "wear coefficients" + " and other placeholders" * (POSITION in names), span


def whichever_first(view: StudyView) -> Sentence | None:
    """Say in how many conditions the first limit is the same for all values within their ranges; None without them."""
    designs = Designs.of(view)
    counts = settled(designs) if designs is not None else None
    if designs is None or counts is None or not counts[1]:
        return None
    certain, ends = counts
    what, span = _unsure(view, varied(designs))
    text = f"Whatever the {what} are, {span}, the same limit comes first in {count(certain)} of {count(ends)} "
    text += "combinations of the other factors" + ("." if certain == ends else "; in the others they decide.")
    return Sentence("whichever_first", text, {"certain": certain, "of": ends}, view.valid)


def _gain(designs: Designs) -> Sentence:
    """Say what the best design would last at its worst condition without its first limit."""
    case = int(designs.table.iloc[0]["worst_case"])
    first, now, following, then = without_first(designs.view, case)
    lives = body_lives("").values()
    beyond = following == "fatigue" and any(designs.view.beyond_data(name)[case] for name in lives)
    where = " at its worst condition" if designs.conditions else ""
    text = f"{capital(title(first))} ends the best design first{where}"
    if np.isinf(now):
        text = f"The best design reaches no limit{where}"
    elif np.isinf(then):
        text += "; without it, it would reach no other limit that is known"
    else:
        text += f"; without it, {title(following)} would follow after {lasting(then, 'h', beyond)}"
    values = {"first": first, "hours": now, "next": following, "then": then, "case": case}
    return Sentence("gain", f"{text}.", values, designs.usable)


def _turned(designs: Designs, before: tuple[int, ...], after: tuple[int, ...], correlation: float) -> Sentence:
    """Say how many designs change their place, and which one changes most."""
    rows = designs.usable
    steps = {i: before.index(i) - after.index(i) for i in after}
    changed = sum(step != 0 for step in steps.values())
    values = {"changed": changed, "correlation": correlation, "before": before, "after": after}
    if not changed:
        text = f"Ranked by the life of the S-N curve alone, the best {count(len(after))} designs have the same order."
        return Sentence("turned", text, values, rows)
    most = max(steps, key=lambda i: abs(steps[i]))
    name = design_words(designs, designs.table.iloc[after.index(most)])
    text = f"Ranked by the first limit instead of the S-N curve alone, {count(changed)} of the best "
    text += f"{count(len(after))} designs change their place (rank correlation {rounded(correlation, 2)}); "
    text += f"most of all {name}, from {before.index(most) + 1} to {after.index(most) + 1}."
    return Sentence("turned", text, values, rows)
