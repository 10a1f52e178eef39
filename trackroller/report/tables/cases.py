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
