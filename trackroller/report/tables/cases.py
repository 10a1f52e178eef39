"""Tables of where designs end: regimes, validity flags, reasons of failure, and the limit that comes first."""

from __future__ import annotations

import numpy as np
import xarray as xr

from trackroller.analysis.first_limits import deciding, first_limit
from trackroller.analysis.lives import FIRST_LIMIT
from trackroller.analysis.table import StudyView
from trackroller.parameters import REGIME_LABELS
from trackroller.parameters.validity import VALIDITY
from trackroller.report.numbers import capital, count, level_text, long_name, plain, share
from trackroller.report.tables.table import Table, factor_cell, heading
from trackroller.report.words.accuracy import bodies_of, words_of
from trackroller.report.words.limits import title
from trackroller.report.words.regimes import occurrence


def regime_table(view: StudyView) -> Table | None:
    """Count the cases in each regime; In short says where each regime occurs."""
    if "regime" not in view.table or not len(view.table):
        return None
    rows = []
    for code, name in enumerate(REGIME_LABELS):
        hit = view.regime == code
        if hit.any():
            rows.append([name, int(hit.sum()), share(int(hit.sum()), len(hit))])
    return Table("regimes", "Regimes", ["Regime", "Cases", "Share"], rows)


def validity_table(view: StudyView) -> Table | None:
    """Count the rolling cases that carry each validity flag, by body where it is known, and say where they occur."""
    rows = []
    for flag in view.flags:
        for body in bodies_of(flag, view.by_body):
            hit = view.flagged(flag, body) & view.rolling
            if not hit.any():
                continue
            said = occurrence(view, hit, f"The flag '{plain(flag)}'{f' of the {body}' if body else ''}", view.rolling)
            cases, rolls = int(hit.sum()), int(view.rolling.sum())
            meaning = VALIDITY[flag].criterion if flag in VALIDITY else words_of(flag)
            rows.append([plain(flag), body or "either", meaning, cases, share(cases, rolls), said.text if said else ""])
    if not rows:
        return None
    heads = ["Flag", "Body", "Meaning", "Cases", "Share of the rolling", "Where"]
    return Table("validity", "Validity flags of the rolling cases", heads, rows)


def reason_table(ds: xr.Dataset) -> Table | None:
    """List why cases failed or miss their tolerance, the most frequent reason first, with the first case of each."""
    if "reason" not in ds:
        return None
    every = ds["reason"].values.astype(str).ravel()
    texts, first, counts = np.unique(every, return_index=True, return_counts=True)
    rows = [[int(c), t, int(i)] for t, i, c in zip(texts, first, counts, strict=True) if t]
    heads = ["Cases", "Reason", "First case"]
    rows.sort(key=lambda r: -r[0])
    return Table("reasons", "Why cases failed or miss their tolerance", heads, rows[:8]) if rows else None


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
    across = [(level, view.table[others[0]] == level) for level in view.levels(others[0])] if others else []
    rows = []
    for level in view.levels(first):
        mine = (view.table[first] == level).to_numpy() & view.valid
        parts = [mine & own.to_numpy() for _, own in across] or [mine]
        rows.append([factor_cell(first, level), *(_counts(names[part]) for part in parts)])
    heads = [level_text(others[0], level) for level, _ in across] or ["All valid cases"]
    note = "Number of valid cases that each limit of the pair ends first."
    if others:
        note += f" {capital(long_name(others[0]))} across."
    return Table("first_limits", "Which limit comes first", [heading(first), *heads], rows, note)


def _counts(names: np.ndarray) -> str:
    """Write 'shakedown 9, heat 3', the most frequent limit first; a dash without a valid case."""
    known, counts = np.unique(names[names != ""].astype(str), return_counts=True)
    order = np.argsort(-counts, kind="stable")
    return ", ".join(f"{title(known[i])} {count(int(counts[i]))}" for i in order) or "–"
