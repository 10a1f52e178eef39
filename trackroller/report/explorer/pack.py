"""What the explorer takes of the cases: a sample of a large study, and columns as one compressed
block of bytes.
"""

from __future__ import annotations

import base64
import math
import zlib
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from trackroller.report.explorer.rows import ExplorerColumn
from trackroller.report.figures.style import colours
from trackroller.study.design.levels import OF_MATERIALS

# a page of 6 MB, its figures included, can be sent by mail and opens in three seconds
MOST_BYTES = 4_500_000
MOST_ROWS = 50_000
PROBED = 2_000
MOST_COLOURS = 40  # levels that get a colour each, the same as in the figures
RARE = 1_000  # all cases of a state are kept if it has at most so many cases


def pack(columns: Sequence[ExplorerColumn]) -> tuple[list[dict[str, Any]], str]:
    """Compress the columns.

    Parameters
    ----------
    columns : columns of equal length n

    Returns
    -------
    header : for each column its name, label, unit, role, scale, levels, number type and place in
        the block
    block : the numbers, as base64 of a zlib stream (RFC 1950)

    Notes
    -----
    Numbers are little-endian. In each column the first bytes of all numbers come first, then all
    second bytes, and so on: equal bytes then stand side by side, which compresses better. Positions
    in a list of levels are stored plus one; 0 stands for no value.
    """
    header = []
    parts = []
    start = 0
    for column in columns:
        array = _numbers(column)
        part = array.view(np.uint8).reshape(len(array), -1).T.tobytes()
        entry: dict[str, Any] = {
            key: getattr(column, key) for key in ("name", "label", "unit", "role", "log")
        }
        if column.levels is not None:
            # JSON has no infinity
            entry["levels"] = [str(v) if v in (math.inf, -math.inf) else v for v in column.levels]
            entry["texts"] = list(column.texts)
            if column.name != "state":
                entry["colours"] = colours(column.texts[:MOST_COLOURS], column.name in OF_MATERIALS)
            entry["number"] = all(isinstance(level, float) for level in column.levels)
        header.append(entry | {"type": array.dtype.str[1:], "start": start, "bytes": len(part)})
        parts.append(part)
        start += len(part)
    return header, base64.b64encode(zlib.compress(b"".join(parts), 9)).decode("ascii")


def affordable_rows(columns: Sequence[ExplorerColumn]) -> int:
    """Return how many cases a page can show in `MOST_BYTES`, `MOST_ROWS` at most.

    The bytes a case needs are measured on evenly spaced cases, because compression decides them.
    """
    step = max(1, len(columns[0].values) // PROBED)
    probe = [replace(column, values=column.values[::step]) for column in columns]
    count = max(1, len(probe[0].values))
    return min(MOST_ROWS, int(MOST_BYTES * count / len(pack(probe)[1])))


def _numbers(column: ExplorerColumn) -> np.ndarray:
    if column.levels is None:
        kind = "<f8"
        if column.values.dtype == np.float32:
            kind = "<f4"
        return np.ascontiguousarray(column.values, dtype=kind)
    kind = next(k for k in ("<u1", "<u2", "<u4") if len(column.levels) < np.iinfo(k).max)
    return np.ascontiguousarray(column.values + 1, dtype=kind)


def sample_rows(state: np.ndarray, keep: np.ndarray, most: int) -> np.ndarray:
    """Choose the cases to show.

    Parameters
    ----------
    state : stratum of each case, such as its regime and validity, shape (n,) int
    keep : cases that are always shown, shape (n,) bool
    most : number of cases to choose

    Returns
    -------
    Rising row numbers: all rows if there are at most `most`. Otherwise the cases of `keep`, all
    cases of rare states, and a random part of each other state in proportion to its number of
    cases.
    """
    if len(state) <= most:
        return np.arange(len(state))
    rng = np.random.default_rng(1)
    chosen = keep.copy()
    strata, counts = np.unique(state[~keep], return_counts=True)
    rare = strata[counts <= RARE]
    chosen |= np.isin(state, rare)
    left = max(0, most - int(chosen.sum()))
    frequent = int(counts[counts > RARE].sum())
    for stratum, cases in zip(strata, counts, strict=True):
        if cases > RARE:
            rows = np.flatnonzero((state == stratum) & ~keep)
            share = min(cases, max(RARE, left * cases // frequent))
            chosen[rng.choice(rows, int(share), replace=False)] = True
    return np.flatnonzero(chosen)


def extreme_rows(state: np.ndarray, columns: Iterable[np.ndarray]) -> np.ndarray:
    """Mark the cases with the smallest and the largest value of each column in each state.

    Parameters
    ----------
    state : state of each case, shape (n,)
    columns : numbers, shape (n,) each; values that are not finite do not count

    Returns
    -------
    Shape (n,) bool.
    """
    marked = np.zeros(len(state), dtype=bool)
    groups = [np.flatnonzero(state == one) for one in np.unique(state)]
    for values in columns:
        for rows in groups:
            known = rows[np.isfinite(values[rows])]
            if known.size:
                marked[[known[np.argmin(values[known])], known[np.argmax(values[known])]]] = True
    return marked
