"""Sentences and tables on cases: valid ones, regimes, flags, reasons of failure, other events, and ends of a result."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from trackroller.damage import LIMITS
from trackroller.parameters import REGIME_LABELS, REGIMES
from trackroller.parameters.validity import VALIDITY
from trackroller.report.numbers import capital, level_text, listing, long_name, number, plain, setting, share
from trackroller.report.tables.table import Table
from trackroller.report.words.accuracy import bodies_of
from trackroller.report.words.designs import limit_title
from trackroller.report.words.levels import at_least, at_most
from trackroller.report.words.sentence import Sentence, say
from trackroller.results.findings import Finding
from trackroller.results.groups import MOST_LEVELS
from trackroller.results.results import Results
from trackroller.roller.record import names_not_given

OF_LIVES = ("deep_life",)  # validity flags that say how far a life holds
EVENTS = {"full_slip": "Full slip", "lift_off": "Lift-off", "failed": "Failure"}


def valid_cases(results: Results) -> Sentence:
    """Say how many cases roll, lie inside the model and meet the constraints, and in how many a limit is exceeded."""
    lost = {REGIME_LABELS[c]: int((results.regime == c).sum()) for c in (1, 2, 3)}
    lost["not converged"] = int(((results.regime == 0) & ~results.rolling).sum())
    values: dict[str, Any] = {"total": len(results.table), "lost": {words: n for words, n in lost.items() if n}}
    values |= {name: int(getattr(results, name).sum()) for name in ("rolling", "inside", "valid")}
    values["unknown"] = int(results.without_fatigue.sum())
    values["chance"] = results.config.failure_probability
    values["exceeded"] = int((results.valid & ~results.held).sum())
    values["open"] = int((results.held & results.any_limit_in("open")).sum())
    if results.allowed is not None:
        values["constraints"] = [f"`{limit}`" for limit in results.config.constraints]
    return say("cases", "valid", flags=results.flags, **{"constraints": [], **values})


def silent_drive(results: Results) -> Sentence | None:
    """Say that a motor force which the study does not name drives the cases that skid; None if there are none."""
    force = results.config.base["motor_force"] if "motor_force" in names_not_given(results.data.attrs) else 0.0
    skid = results.regime == REGIMES.index("full_slip")
    if not force or not skid.any():
        return None
    return say("cases", "silent_drive", motor_force=force)


def event_words(results: Results, finding: Finding) -> Sentence:
    """Say how often an event occurs, and at which levels of the factors."""
    values = dict(finding.values)
    what = values["what"]
    values["subject"] = f"{capital(limit_title(what))} beyond its limit" if what in LIMITS else EVENTS.get(what, what)
    values["model"] = finding.models[0] if "contact_model" in results.factors else ""
    if "conditions" in values:
        values["places"] = [f"at {_levels_words(results, name, levels)}" for name, levels in values["conditions"]]
    if "products" in values:
        values["places"] = [
            (one.count, one.of, " with ".join(_levels_words(results, *item) for item in one.levels.items()))
            for one in values["products"]
        ]
    return say("cases", finding.kind, **values, among=finding.among)


def _levels_words(results: Results, name: str, levels: Any) -> str:
    if isinstance(levels, tuple) and results.ordered(name) and len(results.levels(name)) > MOST_LEVELS:
        own = results.table[name]
        low, high = levels
        if low <= own.min():
            return at_most(name, high, own.min())
        if high >= own.max():
            return at_least(name, low, own.max())
        return f"{long_name(name)} {number(low)} to {level_text(name, high, words=False)}"
    first = setting(name, levels[0])
    return listing([first, *(level_text(name, v) for v in levels[1:])], "or")


def regime_table(results: Results) -> Table | None:
    """Count the cases in each regime."""
    counts = {name: int((results.regime == code).sum()) for code, name in enumerate(REGIME_LABELS)}
    rows = [{"Regime": name, "Cases": n, "Share": share(n, len(results.table))} for name, n in counts.items() if n]
    return Table.of("regimes", "Regimes", rows)


def validity_table(results: Results) -> Table | None:
    """Count the rolling cases that carry each validity flag, by body where it is known.

    A flag of lives is left out of a study without lives.
    """
    rows, rolling = [], int(results.rolling.sum())
    flags = [name for name in results.flags if results.life is not None or name not in OF_LIVES]
    for flag, body in [(name, body) for name in flags for body in bodies_of(name, results.by_body)]:
        cases = int((results.flagged(flag, body) & results.rolling).sum())
        if cases:
            row = {"Flag": plain(flag), "Body": body or "either", "Meaning": VALIDITY[flag].criterion}
            rows.append(row | {"Cases": cases, "Share of the rolling": share(cases, rolling)})
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
