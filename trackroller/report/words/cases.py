"""Sentences on the cases of a study: which are valid, the shortest and longest life, and where peak stresses lie."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from trackroller.analysis.table import MOST_LEVELS, OUTSIDE, StudyView
from trackroller.parameters import REGIME_LABELS
from trackroller.report.numbers import BEYOND, NO_FAILURE, capital, count, lasting, listing, setting, share, shortened
from trackroller.report.words.accuracy import bodies_of, of_body, words_of
from trackroller.report.words.sentence import Sentence


def valid_cases(view: StudyView) -> Sentence:
    """Say how many cases roll, stay inside the model and meet the constraints, and why the others do not."""
    total, rolls, inside, valid = len(view.table), *(int(m.sum()) for m in (view.rolling, view.inside, view.valid))
    lost = {REGIME_LABELS[c]: int((view.regime == c).sum()) for c in (1, 2, 3)}
    lost["not converged"] = int(((view.regime == 0) & ~view.rolling).sum())
    why = ", ".join(f"{count(n)} {words}" for words, n in lost.items() if n)
    text = f"{count(rolls)} of {count(total)} cases roll{f' (the others: {why})' if why else ''}"
    reasons = [(flag, body, int(hit.sum())) for flag, body, hit in _outside(view) if hit.any()]
    if not rolls:
        text += "."
    elif not view.flags:
        text += "; the data set carries no validity flags."
    elif inside == rolls:
        text += "; all of them lie inside the model."
    else:
        kept = f"{count(inside)} of them stay" if inside else "none of them stays"
        text += f"; {kept} inside the model: elsewhere {_reason_words(reasons)}."
    if inside and view.met is not None:
        constraints = listing([f"`{limit}`" for limit in view.study["constraints"]])
        text += f" {count(valid) if valid else 'None'} of the {count(inside)} meet {constraints}.{_removed(view)}"
    if valid and valid < rolls:
        text += f" Statements on life and stress use the {count(valid)} unless they name another set"
        text += "; sensitivity indices also count the cases outside the model." if inside < rolls else "."
    values = {"total": total, "rolling": rolls, "inside": inside, "valid": valid, "lost": lost, "reasons": reasons}
    return Sentence("valid", text, values, np.ones(total, dtype=bool))


def _removed(view: StudyView) -> str:
    """Name the levels that meet the constraints nowhere, and the factors that have one level left."""
    said = []
    for name in view.factors if view.valid.any() else ():
        own, levels = view.table[name], view.levels(name)
        before = [v for v in levels if (own[view.inside] == v).any()] if len(levels) <= MOST_LEVELS else []
        left = [v for v in before if (own[view.valid] == v).any()]
        gone = [setting(name, v) for v in before if v not in left]
        if gone and len(left) == 1:
            said.append(f" Only {setting(name, left[0])} meets the constraints.")
        elif gone:
            said.append(f" {capital(shortened(gone))} meet{'s' * (len(gone) == 1)} the constraints nowhere.")
    return "".join(said)


def _outside(view: StudyView) -> list[tuple[str, str, np.ndarray]]:
    """Return the rolling cases outside the model by flag, and by body if the data set has flags of bodies."""
    hits = []
    for flag in (f for f in OUTSIDE if f in view.flags):
        for body in bodies_of(flag, view.by_body):
            hits.append((flag, body, view.flagged(flag, body) & view.rolling))
    return hits


def _reason_words(reasons: Sequence[tuple[str, str, int]]) -> str:
    said: dict[str, list[str]] = {}
    for flag, body, cases in reasons:
        said.setdefault(flag, []).append(f"{of_body(flag, body)} ({count(cases)})".lstrip())
    return listing([f"{words_of(flag)} {' or '.join(where)}" for flag, where in said.items()], "or")


def extremes(view: StudyView, column: str, words: str, unit: str, shown: Sequence[str], rows: np.ndarray) -> Sentence:
    """Name the shortest and the longest life of the cases shown, and where they are."""
    values = view.column(column)
    good, beyond = np.flatnonzero(rows & np.isfinite(values)), view.beyond_data(column)
    if not good.size:
        return Sentence("none", "No valid case shown here has a finite life.", {}, rows)
    low, high = int(good[np.argmin(values[good])]), int(good[np.argmax(values[good])])
    at = [listing([setting(f, view.table[f].iloc[i]) for f in shown]) for i in (low, high)]
    ends = [f"{lasting(values[i], unit, beyond[i])} at {place}" for i, place in zip((low, high), at, strict=True)]
    text = f"The {words} of the valid cases shown lies between {' and '.join(ends)}."
    if good.size == 1:
        text = f"One valid case shown here has a finite {words}: {ends[0]}."
    endless = int((rows & np.isposinf(values)).sum())
    text += f" {count(endless)} more have {NO_FAILURE} ({BEYOND})." if endless else ""
    claims = {"column": column, "low": low, "high": high, "unlimited": endless}
    return Sentence("extremes", text, claims, rows)


def surface(view: StudyView, body: str, rows: np.ndarray) -> Sentence | None:
    """Say in how many cases the peak stress of a body lies at the surface."""
    flags = view.column(f"at_surface_{body}")
    known, hit = int((rows & ~np.isnan(flags)).sum()), int((rows & (flags == 1)).sum())
    if not known:
        return None
    where = f"at the surface in {count(hit)} of {count(known)} valid cases ({share(hit, known)})"
    if hit in (0, known):
        where = f"{'at' if hit else 'below'} the surface in all {count(known)} valid cases"
    text = f"The peak stress of the {body} lies {where}."
    return Sentence("surface", text, {"body": body, "count": hit, "of": known}, rows)


def strength(body: str, stress: np.ndarray, limit: np.ndarray, most: np.ndarray, rows: np.ndarray) -> Sentence | None:
    """Say how many rolling cases stay below the fatigue limit of a body and how many exceed its tensile strength.

    Parameters
    ----------
    stress, limit, most : peak stress, fatigue limit and tensile strength [MPa], shape (n,)
    rows : rolling cases, shape (n,) bool
    """
    rows = rows & np.isfinite(stress) & np.isfinite(limit)
    of, below, above = (int(part.sum()) for part in (rows, rows & (stress < limit), rows & (stress > most)))
    if not of:
        return None
    first = f"{share(below, of)} of the {count(of)} rolling cases stay" if below else "No rolling case stays"
    text = f"{first} below the fatigue limit of the {body}"
    text += f"; {share(above, of)} exceed its tensile strength and have no fatigue life" if above else ""
    return Sentence("strength", f"{text}.", {"body": body, "of": of, "below": below, "above": above}, rows)
