"""Tables of the report: best designs, regimes, validity flags, reasons of failure."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from trackroller.analysis.table import BODIES, StudyView
from trackroller.parameters import REGIME_LABELS
from trackroller.report.numbers import capital, plain, share
from trackroller.report.tables.table import Table, factor_cell, heading
from trackroller.report.words.cases import ranked
from trackroller.report.words.flags import OF_BODY, words_of
from trackroller.report.words.regimes import occurrence
from trackroller.roller.dataset import VALIDITY_BITS

BEST = 5  # designs in the table of the best


def best_table(view: StudyView) -> Table | None:
    """List the best valid designs as columns.

    Where a design differs from the best one, the cell stands out.
    """
    found = ranked(view)
    if found is None:
        return None
    designs = view.table.iloc[found[:BEST]]
    rows: list[list[Any]] = [["Case", *(int(i) for i in found[:BEST])]]
    for name in (n for n in view.factors if n != "contact_model"):
        rows.append([heading(name), *(factor_cell(name, v) for v in designs[name])])
    results = [(f"{b}_life_hours", f"Life of the {b} [h]") for b in BODIES]
    results += [(f"life_cycles_{b}", f"Overrollings of the {b}") for b in BODIES]
    results += [(f"peak_stress_{b}", f"Peak stress of the {b} [MPa]") for b in BODIES]
    rows += [[words, *map(float, designs[c])] for c, words in results if c in designs and designs[c].notna().any()]
    for body in (b for b in BODIES if f"at_surface_{b}" in designs):
        places = {1.0: "at the surface", 0.0: "below the surface"}
        rows.append([f"Place of the peak, {body}", *(places.get(v, "–") for v in designs[f"at_surface_{body}"])])
    marks = {(i, j) for i, row in enumerate(rows) for j in range(2, len(row)) if i and row[j] != row[1]}
    heads = ["", *(f"Best {k + 1}" for k in range(len(designs)))]
    model = "" if "contact_model" not in view.factors else f" Designs solved with {view.held_level('contact_model')}."
    by = f"longest {view.life[1]}" if view.life else "lowest peak stress"
    note = f"Valid designs with the {by}; bold: differs from the best.{model}"
    return Table("best_designs", "Best valid designs", heads, rows, note, frozenset(marks))


def regime_table(view: StudyView) -> Table | None:
    """Count the cases in each regime and say where each regime occurs."""
    if "regime" not in view.table or not len(view.table):
        return None
    rows = []
    for code, name in enumerate(REGIME_LABELS):
        hit = view.regime == code
        if hit.any():
            said = occurrence(view, hit, capital(name)) if code else None
            rows.append([name, int(hit.sum()), share(int(hit.sum()), len(hit)), said.text if said else ""])
    return Table("regimes", "Regimes", ["Regime", "Cases", "Share", "Where"], rows)


def validity_table(view: StudyView) -> Table | None:
    """Count the rolling cases that carry each validity flag, by body if the data tell it, and name where they occur."""
    rows = []
    for flag in view.flags:
        for body in BODIES if view.by_body and flag in OF_BODY else ("",):
            hit = view.flagged(flag, body) & view.rolling
            if not hit.any():
                continue
            said = occurrence(view, hit, capital(f"{plain(flag)}{f' ({body})' if body else ''}"), view.rolling)
            cases, rolls = int(hit.sum()), int(view.rolling.sum())
            meaning = VALIDITY_BITS.get(flag, words_of(flag))
            rows.append([plain(flag), body or "either", meaning, cases, share(cases, rolls), said.text if said else ""])
    if not rows:
        return None
    heads = ["Flag", "Body", "Meaning", "Cases", "Share of the rolling", "Where"]
    return Table("validity", "Validity flags of the rolling designs", heads, rows)


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
