"""Tables of cases that a validity flag marks, and of reasons why cases failed."""

from __future__ import annotations

import numpy as np
import xarray as xr

from trackroller.parameters.validity import VALIDITY
from trackroller.report.numbers import plain
from trackroller.report.tables.table import Table
from trackroller.results.results import Results
from trackroller.results.validity_flags import bodies_of

OF_LIVES = ("deep_life",)  # validity flags that say how far a life holds
MOST_REASONS = 8


def validity_table(results: Results) -> Table | None:
    """Count the rolling cases that carry each validity flag, by body where it is known.

    A flag of lives is left out of a study without lives.
    """
    rows = []
    rolling = int(results.rolling.sum())
    flags = [name for name in results.flags if results.life is not None or name not in OF_LIVES]
    for flag in flags:
        for body in bodies_of(flag, results.by_body):
            cases = int((results.flagged(flag, body) & results.rolling).sum())
            if cases:
                meaning = VALIDITY[flag].criterion
                own = {"Flag": plain(flag), "Body": body or "either", "Meaning": meaning}
                rows.append({**own, "Cases": cases, "Of": rolling})
    return Table.of("validity", "Validity flags of the rolling cases", rows)


def reason_table(ds: xr.Dataset) -> Table | None:
    """List why cases failed or miss their tolerance, the most frequent reason first, with the first
    case of each.
    """
    if "reason" not in ds:
        return None
    texts, first, counts = np.unique(
        ds["reason"].values.astype(str).ravel(), return_index=True, return_counts=True
    )
    known = zip(counts.tolist(), texts.tolist(), first.tolist(), strict=True)
    rows = [
        {"Cases": cases, "Reason": text, "First case": case} for cases, text, case in known if text
    ]
    rows.sort(key=lambda row: -row["Cases"])
    return Table.of("reasons", "Why cases failed or miss their tolerance", rows[:MOST_REASONS])
