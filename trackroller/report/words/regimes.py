"""Sentences on regimes and other events: how often they occur, and at which levels of the factors."""

from __future__ import annotations

from typing import Any

import numpy as np

from trackroller.analysis.events import FEW, confining, meets, most_frequent
from trackroller.analysis.table import StudyView
from trackroller.parameters import REGIMES
from trackroller.report.numbers import count, level_text, listing, long_name, number, quantity, setting, share
from trackroller.report.words.levels import at_least, at_most
from trackroller.report.words.sentence import Sentence


def silent_drive(view: StudyView) -> Sentence | None:
    """Say that a motor force which the study does not name drives the cases that skid; None if there are none."""
    force = view.study.get("not_given", {}).get("motor_force")
    skid = view.regime == REGIMES.index("full_slip")
    if not force or not skid.any():
        return None
    text = (
        f"The study gives no motor force: {quantity(force, 'N')} of the paper's example drive the roller in all cases. "
    )
    text += "Write `motor_force: 0` for a free roller."
    return Sentence("silent_drive", text, {"motor_force": force, "count": int(skid.sum())}, skid)


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
    values: dict[str, Any] = {"count": cases, "of": whole}
    if cases == whole:
        return Sentence("everywhere", f"{what} occurs in all {count(whole)} cases.", values, among)
    head = f"{what} occurs in {count(cases)} of {count(whole)} cases ({share(cases, whole)})"
    only = confining(view, hit, among)
    inside = among.copy()
    for name, levels in only:
        inside &= meets(view, name, levels)
    met = int(inside.sum())
    # few events may share levels by chance, unless all cases at these levels have the event
    common = met == cases and all(isinstance(levels, list) for _, levels in only)
    if only and (cases >= FEW or common):
        there = "all" if met == cases else f"{count(cases)} of the {count(met)}"
        text = f"{head}, only {_places(view, only)}: in {there} cases there."
        return Sentence("only", text, values | {"conditions": only, "inside": met}, among)
    if cases < FEW:
        named = [int(i) for i in np.flatnonzero(hit)]
        text = f"{what} occurs in {cases} of {count(whole)} cases ({listing([str(i) for i in named])})"
        shared = [(n, own) for n, own in only if isinstance(own, list) and len(own) == 1] if cases > 1 else []
        where = f", only {_places(view, shared)}" if shared else ""
        return Sentence("cases", f"{text}{where}.", values | {"cases": named, "conditions": shared}, among)
    most = most_frequent(view, hit, among)
    if most is None:
        return Sentence("share", f"{head}.", values, among)
    name, high, low = most
    levels_said = [f"{setting(name, level)} ({count(k)} of {count(n)} cases)" for level, k, n in (high, low)]
    text = f"{head}, most often at {levels_said[0]} and least at {levels_said[1]}."
    return Sentence("frequent", text, values | {"factor": name, "most": high, "least": low}, among)


def _places(view: StudyView, conditions: list[tuple[str, Any]]) -> str:
    return listing([f"at {_levels_words(view, name, levels)}" for name, levels in conditions])


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
    cases, least = int(lifted.sum()), float(axial[lifted].min())
    text = f"The smallest axial force at which a case lifts off is {number(least)} N."
    return Sentence("lift_off", text, {"count": cases, "least": least}, np.ones(len(lifted), dtype=bool))
