"""Sentences on the cases of a study: which are valid, the shortest and longest life, and where peak stresses lie."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from trackroller.analysis.table import MOST_LEVELS, OUTSIDE, StudyView
from trackroller.parameters import REGIME_LABELS
from trackroller.report.numbers import count, lasting, listing, setting
from trackroller.report.words.accuracy import bodies_of, of_body, words_of
from trackroller.report.words.sentence import Sentence, phrase, say


def valid_cases(view: StudyView) -> Sentence:
    """Say how many cases roll, stay inside the model and meet the constraints, and why the others do not."""
    lost = {REGIME_LABELS[c]: int((view.regime == c).sum()) for c in (1, 2, 3)}
    lost["not converged"] = int(((view.regime == 0) & ~view.rolling).sum())
    reasons = [(flag, body, int(hit.sum())) for flag, body, hit in _outside(view) if hit.any()]
    values: dict[str, Any] = {"total": len(view.table), "lost": {words: n for words, n in lost.items() if n}}
    values |= {name: int(getattr(view, name).sum()) for name in ("rolling", "inside", "valid")}
    if view.met is not None:
        values["constraints"] = [f"`{limit}`" for limit in view.study["constraints"]]
    values |= {"flags": view.flags, "reasons": reasons, "outside": _reason_words(reasons), "removed": _removed(view)}
    return say("cases", "valid", **{"constraints": [], **values})


def _removed(view: StudyView) -> list[str]:
    """Name the levels that meet the constraints nowhere, and the factors that have one level left."""
    said = []
    for name in view.factors if view.valid.any() else ():
        own, levels = view.table[name], view.levels(name)
        before = [v for v in levels if (own[view.inside] == v).any()] if len(levels) <= MOST_LEVELS else []
        left = [setting(name, v) for v in before if (own[view.valid] == v).any()]
        if gone := [setting(name, v) for v in before if setting(name, v) not in left]:
            said.append(phrase("cases", "removed", gone=gone, left=left))
    return said


def _outside(view: StudyView) -> list[tuple[str, str, np.ndarray]]:
    """Return the rolling cases outside the model by flag, and by body if the data set has flags of bodies."""
    hits = []
    for flag in (f for f in OUTSIDE if f in view.flags):
        for body in bodies_of(flag, view.by_body):
            hits.append((flag, body, view.flagged(flag, body) & view.rolling))
    return hits


def _reason_words(reasons: Sequence[tuple[str, str, int]]) -> list[str]:
    said: dict[str, list[str]] = {}
    for flag, body, cases in reasons:
        said.setdefault(flag, []).append(f"{of_body(flag, body)} ({count(cases)})".lstrip())
    return [f"{words_of(flag)} {' or '.join(where)}" for flag, where in said.items()]


def extremes(view: StudyView, column: str, words: str, unit: str, shown: Sequence[str], rows: np.ndarray) -> Sentence:
    """Name the shortest and the longest life of the cases shown, and where they are."""
    values = view.column(column)
    good, beyond = np.flatnonzero(rows & np.isfinite(values)), view.beyond_data(column)
    if not good.size:
        return say("cases", "none")
    two = [int(good[end(values[good])]) for end in (np.argmin, np.argmax)][: good.size]
    places = [listing([setting(f, view.table[f].iloc[i]) for f in shown]) for i in two]
    ends = [f"{lasting(values[i], unit, beyond[i])} at {place}" for i, place in zip(two, places, strict=True)]
    return say("cases", "extremes", words=words, ends=ends, unlimited=int((rows & np.isposinf(values)).sum()))


def surface(view: StudyView, body: str, rows: np.ndarray) -> Sentence | None:
    """Say in how many cases the peak stress of a body lies at the surface."""
    flags = view.column(f"at_surface_{body}")
    known, hit = int((rows & ~np.isnan(flags)).sum()), int((rows & (flags == 1)).sum())
    return say("cases", "surface", body=body, count=hit, of=known) if known else None


def strength(body: str, stress: np.ndarray, limit: np.ndarray, most: np.ndarray, rows: np.ndarray) -> Sentence | None:
    """Say how many rolling cases stay below the fatigue limit of a body and how many exceed its tensile strength.

    Parameters
    ----------
    stress, limit, most : peak stress, fatigue limit and tensile strength [MPa], shape (n,)
    rows : rolling cases, shape (n,) bool
    """
    rows = rows & np.isfinite(stress) & np.isfinite(limit)
    of, below, above = (int(part.sum()) for part in (rows, rows & (stress < limit), rows & (stress > most)))
    return say("cases", "strength", body=body, of=of, below=below, above=above) if of else None
