"""Sentences and tables on regimes, validity flags, reasons of failure and other events."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from trackroller.analysis.events import FEW, confining, meets, most_frequent
from trackroller.analysis.table import StudyView
from trackroller.parameters import REGIME_LABELS, REGIMES
from trackroller.parameters.validity import VALIDITY
from trackroller.report.numbers import level_text, listing, long_name, number, plain, setting, share
from trackroller.report.tables.table import Table
from trackroller.report.words.accuracy import bodies_of, words_of
from trackroller.report.words.levels import at_least, at_most
from trackroller.report.words.sentence import Sentence, say


def silent_drive(view: StudyView) -> Sentence | None:
    """Say that a motor force which the study does not name drives the cases that skid; None if there are none."""
    force = view.study["not_given"].get("motor_force")
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


def regime_table(view: StudyView) -> Table | None:
    """Count the cases in each regime; In short says where each regime occurs."""
    if "regime" not in view.table:
        return None
    counts = {name: int((view.regime == code).sum()) for code, name in enumerate(REGIME_LABELS)}
    rows = [{"Regime": name, "Cases": n, "Share": share(n, len(view.table))} for name, n in counts.items() if n]
    return Table.of("regimes", "Regimes", rows)


def validity_table(view: StudyView) -> Table | None:
    """Count the rolling cases that carry each validity flag, by body where it is known, and say where they occur."""
    rows, rolling = [], int(view.rolling.sum())
    for flag, body in [(name, body) for name in view.flags for body in bodies_of(name, view.by_body)]:
        hit = view.flagged(flag, body) & view.rolling
        said = occurrence(view, hit, f"The flag '{plain(flag)}'{f' of the {body}' if body else ''}", view.rolling)
        if said is not None:
            row = {"Flag": plain(flag), "Body": body or "either"}
            row |= {"Meaning": VALIDITY[flag].criterion if flag in VALIDITY else words_of(flag)}
            cases = int(hit.sum())
            rows.append(row | {"Cases": cases, "Share of the rolling": share(cases, rolling), "Where": said.text})
    return Table.of("validity", "Validity flags of the rolling cases", rows)


def reason_table(ds: xr.Dataset) -> Table | None:
    """List why cases failed or miss their tolerance, the most frequent reason first, with the first case of each."""
    if "reason" not in ds:
        return None
    texts, first, counts = np.unique(ds["reason"].values.astype(str).ravel(), return_index=True, return_counts=True)
    known = zip(counts.tolist(), texts.tolist(), first.tolist(), strict=True)
    rows = [{"Cases": cases, "Reason": text, "First case": case} for cases, text, case in known if text]
    rows.sort(key=lambda row: -row["Cases"])
    return Table.of("reasons", "Why cases failed or miss their tolerance", rows[:8])
