"""Sentences on regimes and other events: how often they occur, and at which levels of the factors."""

from __future__ import annotations

from typing import Any

import numpy as np

from trackroller.analysis.events import FEW, confining, meets, most_frequent
from trackroller.analysis.table import StudyView
from trackroller.parameters import REGIMES
from trackroller.report.numbers import level_text, listing, long_name, number, setting
from trackroller.report.words.levels import at_least, at_most
from trackroller.report.words.sentence import Sentence, say


def silent_drive(view: StudyView) -> Sentence | None:
    """Say that a motor force which the study does not name drives the cases that skid; None if there are none."""
    force = view.study.get("not_given", {}).get("motor_force")
    skid = view.regime == REGIMES.index("full_slip")
    if not force or not skid.any():
        return None
    return say("regimes", "silent_drive", motor_force=force)


def occurrence(view: StudyView, hit: np.ndarray, what: str, among: np.ndarray | None = None) -> Sentence | None:
    """Say how often an event occurs and at which levels of the factors.

    None if it never does.

    Parameters
    ----------
    hit : whether the event occurs, shape (n,) bool
    what : the event as the subject of the sentence, 'Full slip'
    among : the cases that are looked at, shape (n,) bool; all if not given
    """
    among = np.ones(len(hit), dtype=bool) if among is None else among
    hit, whole, cases = hit & among, int(among.sum()), int((hit & among).sum())
    if not cases:
        return None
    values: dict[str, Any] = {"what": what, "count": cases, "of": whole}
    if cases == whole:
        return say("regimes", "everywhere", **values)
    only = confining(view, hit, among)
    inside = among.copy()
    for name, levels in only:
        inside &= meets(view, name, levels)
    met = int(inside.sum())
    # few events may share levels by chance, unless all cases at these levels have the event
    common = met == cases and all(isinstance(levels, list) for _, levels in only)
    if only and (cases >= FEW or common):
        return say("regimes", "only", **values, conditions=only, inside=met, places=_places(view, only))
    if cases < FEW:
        shared = [(n, own) for n, own in only if isinstance(own, list) and len(own) == 1] if cases > 1 else []
        named = np.flatnonzero(hit).tolist()
        return say("regimes", "cases", **values, cases=named, conditions=shared, places=_places(view, shared))
    most = most_frequent(view, hit, among)
    if most is None:
        return say("regimes", "share", **values)
    return say("regimes", "frequent", **values, **dict(zip(("factor", "most", "least"), most, strict=True)))


def _places(view: StudyView, conditions: list[tuple[str, Any]]) -> list[str]:
    return [f"at {_levels_words(view, name, levels)}" for name, levels in conditions]


def _levels_words(view: StudyView, name: str, levels: Any) -> str:
    if isinstance(levels, tuple):
        own = view.table[name]
        low, high = levels
        if low <= own.min():
            return at_most(name, high, own.min())
        if high >= own.max():
            return at_least(name, low, own.max())
        return f"{long_name(name)} {number(low)} to {level_text(name, high, words=False)}"
    first = setting(name, levels[0])
    return listing([first, *(level_text(name, v) for v in levels[1:])], "or")


def lift_off(view: StudyView) -> Sentence | None:
    """Say how many cases lift off and from which axial force on."""
    lifted = view.regime == 2
    axial = np.abs(view.column("axial_force"))
    if not lifted.any() or np.isnan(axial[lifted]).any():
        return None
    return say("regimes", "lift_off", count=int(lifted.sum()), least=float(axial[lifted].min()))
