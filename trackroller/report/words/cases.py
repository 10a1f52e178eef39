"""Sentences and tables on cases: valid ones, regimes, flags, reasons of failure, other events, and ends of a result."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from trackroller.parameters import REGIME_LABELS, REGIMES
from trackroller.parameters.validity import VALIDITY
from trackroller.report.numbers import count, lasting, level_text, listing, long_name, number, plain, setting, share
from trackroller.report.tables.table import Table
from trackroller.report.words.accuracy import bodies_of, of_body
from trackroller.report.words.levels import at_least, at_most
from trackroller.report.words.sentence import Sentence, phrase, say
from trackroller.results.events import FEW, confining, meets, most_frequent
from trackroller.results.groups import MOST_LEVELS
from trackroller.results.results import OUTSIDE, Results
from trackroller.roller.record import names_not_given


def valid_cases(results: Results) -> Sentence:
    """Say how many cases roll, stay inside the model and meet the constraints, and why the others do not."""
    lost = {REGIME_LABELS[c]: int((results.regime == c).sum()) for c in (1, 2, 3)}
    lost["not converged"] = int(((results.regime == 0) & ~results.rolling).sum())
    reasons = [(flag, body, int(hit.sum())) for flag, body, hit in _outside(results) if hit.any()]
    values: dict[str, Any] = {"total": len(results.table), "lost": {words: n for words, n in lost.items() if n}}
    values |= {name: int(getattr(results, name).sum()) for name in ("rolling", "inside", "valid")}
    if results.allowed is not None:
        values["constraints"] = [f"`{limit}`" for limit in results.config.constraints]
    values |= {
        "flags": results.flags,
        "reasons": reasons,
        "outside": _reason_words(reasons),
        "removed": _removed(results),
    }
    return say("cases", "valid", **{"constraints": [], **values})


def _removed(results: Results) -> list[str]:
    """Name the levels that meet the constraints nowhere, and the factors that have one level left."""
    said = []
    for name in results.factors if results.valid.any() else ():
        own, levels = results.table[name], results.levels(name)
        before = [v for v in levels if (own[results.inside] == v).any()] if len(levels) <= MOST_LEVELS else []
        left = [setting(name, v) for v in before if (own[results.valid] == v).any()]
        if gone := [setting(name, v) for v in before if setting(name, v) not in left]:
            said.append(phrase("cases", "removed", gone=gone, left=left))
    return said


def _outside(results: Results) -> list[tuple[str, str, np.ndarray]]:
    """Return the rolling cases outside the model by flag, and by body if the data set has flags of bodies."""
    hits = []
    for flag in (f for f in OUTSIDE if f in results.flags):
        for body in bodies_of(flag, results.by_body):
            hits.append((flag, body, results.flagged(flag, body) & results.rolling))
    return hits


def _reason_words(reasons: Sequence[tuple[str, str, int]]) -> list[str]:
    said: dict[str, list[str]] = {}
    for flag, body, cases in reasons:
        said.setdefault(flag, []).append(f"{of_body(flag, body)} ({count(cases)})".lstrip())
    return [f"{VALIDITY[flag].words} {' or '.join(where)}" for flag, where in said.items()]


def extremes(results: Results, column: str, words: str, unit: str, shown: Sequence[str], rows: np.ndarray) -> Sentence:
    """Name the shortest and the longest life of the cases shown, and where they are."""
    values = results.column(column)
    good, beyond = np.flatnonzero(rows & np.isfinite(values)), results.beyond_data(column)
    if not good.size:
        return say("cases", "none")
    two = [int(good[end(values[good])]) for end in (np.argmin, np.argmax)][: good.size]
    places = [listing([setting(f, results.table[f].iloc[i]) for f in shown]) for i in two]
    ends = [f"{lasting(values[i], unit, beyond[i])} at {place}" for i, place in zip(two, places, strict=True)]
    return say("cases", "extremes", words=words, ends=ends, unlimited=int((rows & np.isposinf(values)).sum()))


def surface(results: Results, body: str, rows: np.ndarray) -> Sentence | None:
    """Say in how many cases the peak stress of a body lies at the surface."""
    flags = results.column(f"at_surface_{body}")
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


def silent_drive(results: Results) -> Sentence | None:
    """Say that a motor force which the study does not name drives the cases that skid; None if there are none."""
    force = results.config.base["motor_force"] if "motor_force" in names_not_given(results.data.attrs) else 0.0
    skid = results.regime == REGIMES.index("full_slip")
    if not force or not skid.any():
        return None
    return say("cases", "silent_drive", motor_force=force)


def occurrence(results: Results, hit: np.ndarray, what: str, among: np.ndarray | None = None) -> Sentence | None:
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
        return say("cases", "everywhere", **values)
    only = confining(results, hit, among)
    inside = among.copy()
    for name, levels in only:
        inside &= meets(results, name, levels)
    met = int(inside.sum())
    # few events may share levels by chance, unless all cases at these levels have the event
    common = met == cases and all(isinstance(levels, list) for _, levels in only)
    if only and (cases >= FEW or common):
        return say("cases", "only", **values, conditions=only, inside=met, places=_places(results, only))
    if cases < FEW:
        shared = [(n, own) for n, own in only if isinstance(own, list) and len(own) == 1] if cases > 1 else []
        named = np.flatnonzero(hit).tolist()
        return say("cases", "cases", **values, cases=named, conditions=shared, places=_places(results, shared))
    most = most_frequent(results, hit, among)
    if most is None:
        return say("cases", "share", **values)
    return say("cases", "frequent", **values, **dict(zip(("factor", "most", "least"), most, strict=True)))


def _places(results: Results, conditions: list[tuple[str, Any]]) -> list[str]:
    return [f"at {_levels_words(results, name, levels)}" for name, levels in conditions]


def _levels_words(results: Results, name: str, levels: Any) -> str:
    if isinstance(levels, tuple):
        own = results.table[name]
        low, high = levels
        if low <= own.min():
            return at_most(name, high, own.min())
        if high >= own.max():
            return at_least(name, low, own.max())
        return f"{long_name(name)} {number(low)} to {level_text(name, high, words=False)}"
    first = setting(name, levels[0])
    return listing([first, *(level_text(name, v) for v in levels[1:])], "or")


def lift_off(results: Results) -> Sentence | None:
    """Say how many cases lift off and from which axial force on."""
    lifted = results.regime == 2
    axial = np.abs(results.column("axial_force"))
    if not lifted.any() or np.isnan(axial[lifted]).any():
        return None
    return say("cases", "lift_off", count=int(lifted.sum()), least=float(axial[lifted].min()))


def regime_table(results: Results) -> Table | None:
    """Count the cases in each regime; In short says where each regime occurs."""
    counts = {name: int((results.regime == code).sum()) for code, name in enumerate(REGIME_LABELS)}
    rows = [{"Regime": name, "Cases": n, "Share": share(n, len(results.table))} for name, n in counts.items() if n]
    return Table.of("regimes", "Regimes", rows)


def validity_table(results: Results) -> Table | None:
    """Count the rolling cases that carry each validity flag, by body where it is known, and say where they occur."""
    rows, rolling = [], int(results.rolling.sum())
    for flag, body in [(name, body) for name in results.flags for body in bodies_of(name, results.by_body)]:
        hit = results.flagged(flag, body) & results.rolling
        said = occurrence(results, hit, f"The flag '{plain(flag)}'{f' of the {body}' if body else ''}", results.rolling)
        if said is not None:
            row = {"Flag": plain(flag), "Body": body or "either"}
            row |= {"Meaning": VALIDITY[flag].criterion}
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
