"""The share of the conditions that reaches each value, for each candidate."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from markupsafe import Markup

from trackroller.report.numbers import grouped
from trackroller.report.pictures.axis import Axis
from trackroller.report.pictures.curves import points
from trackroller.report.pictures.frame import (
    WIDE,
    bounds_of,
    cut_apart,
    framed,
    lower_axis,
    output_title,
    upright_axis,
)
from trackroller.report.pictures.marks import (
    anchor_at,
    element,
    joined,
    label,
    percent_place,
    stretched,
    upright,
)
from trackroller.report.pictures.picture import Picture, caption_of, row_names
from trackroller.results.answer import Answer

FLAT = 190.0  # height [px]
MOST_LINES = 6  # with a name
MOST_STEPS = 120  # places of a line
STROKES = ("", "dashed", "dotted", "chain")


def draw_distribution(answer: Answer, data: Mapping[str, Any]) -> Picture:
    """Draw which share of the conditions reaches each value, for each candidate."""
    names = row_names(answer, len(data["values"]))
    values = {
        name: np.asarray(one, dtype=float) for name, one in zip(names, data["values"], strict=True)
    }
    shown = dict(list(values.items())[:MOST_LINES])
    bounds = bounds_of(answer)
    if shown:
        every = np.concatenate([one[np.isfinite(one)] for one in shown.values()])
    else:
        every = np.empty(0)
    low, high = _first_ends(data)
    ends = np.concatenate([low, high])
    every = np.concatenate([every, ends[np.isfinite(ends)]])
    across = Axis.of([*every[every > 0], *(value for value, _ in bounds)])
    up = Axis(0.0, 100.0)
    lines = [_reached(one, across, place) for place, one in enumerate(shown.values())]
    has_band = not np.array_equal(low, high)
    if has_band:
        lines.insert(0, _band(low, high, across))
    parts = [upright_axis(up, FLAT), lower_axis(across, output_title(answer), WIDE, lines=True)]
    parts.append(stretched(joined(lines), FLAT))
    for value, text in bounds:
        x = across.place(value)
        parts += [upright("r", x), label(text, x, "0", anchor_at(x), "rt", dy=-7)]
    parts += _names_of_lines(shown, across)
    if not _near_left(bounds, across):
        parts.append(label("reached by [%]", 0, "0", "start", dx=-42, dy=-7))
    words = "; ".join(
        f"{name}: median {grouped(float(np.median(one)), 3)}"
        for name, one in shown.items()
        if one.size
    )
    drawn = framed(joined(parts), FLAT, words, left=46, right=14, top=24)
    further = ""
    if len(values) > len(shown):
        further = f" {len(values) - len(shown):,} more candidates are not drawn."
    band = ""
    if has_band:
        band = " Line: the middle of the range of each condition; band: its low to its high end."
    if has_band and len(shown) > 1:
        band = f"{band[:-1]}, of the first candidate."
    caption = f"Share of the conditions that reach a value [%].{band}{further}"
    return Picture(drawn, caption_of(data, caption))


def _first_ends(data: Mapping[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    """Return the low and the high ends of the conditions of the first candidate, in rising order;
    none of a record without them.
    """
    low, high = ([*data.get(end, [])][:1] for end in ("low", "high"))
    if not low or not high:
        return np.empty(0), np.empty(0)
    return np.asarray(low[0], dtype=float), np.asarray(high[0], dtype=float)


def _band(low: np.ndarray, high: np.ndarray, across: Axis) -> Markup:
    """Return the area between the line of the low ends and that of the high ends."""
    edges = [*_places_reached(low, across), *reversed(_places_reached(high, across))]
    return element("polygon", class_="f cm", points=points(edges))


def _near_left(bounds: Sequence[tuple[float, str]], across: Axis) -> bool:
    return any(across.place(value) < 30 for value, _ in bounds)


def _reached(values: np.ndarray, across: Axis, place: int) -> Markup:
    """Return a falling line: the share of values that are at least as large as a place on the
    axis.
    """
    line = _places_reached(values, across)
    if not line:
        return Markup()
    kind = "cg"
    if place == 0:
        kind = "cm"
    return element(
        "polyline", class_=f"l {kind} {STROKES[place % len(STROKES)]}".rstrip(), points=points(line)
    )


def _places_reached(values: np.ndarray, across: Axis) -> list[tuple[float, float]]:
    """Return the corners of the falling line of some values [%]; none without a value."""
    ordered = np.sort(np.where(np.isnan(values), -np.inf, values))
    if not ordered.size:
        return []
    rows = np.unique(np.linspace(0, ordered.size - 1, min(MOST_STEPS, ordered.size)).astype(int))
    line = []
    if ordered[0] > 0:
        line = [(0.0, 0.0)]
    for row in rows:
        reached = 100 * (ordered.size - row) / ordered.size
        x = 0.0
        if ordered[row] > -math.inf:
            x = across.place(float(ordered[row]))
        line.append((x, 100 - reached))
    last = float(ordered[-1])
    if math.isfinite(last):
        line.append((across.place(last), 100.0))
    return line


def _names_of_lines(shown: Mapping[str, np.ndarray], across: Axis) -> list[Markup]:
    """Return the names of the lines, each beside its median, at heights that do not collide."""
    if len(shown) < 2:
        return []
    rows = np.linspace(0.2, 0.8, len(shown))
    parts = []
    names = cut_apart(list(shown), WIDE / 2)
    for place, (name, values) in enumerate(zip(names, shown.values(), strict=True)):
        known = np.sort(values[~np.isnan(values)])
        if not known.size:
            continue
        x = across.place(float(np.quantile(known, rows[place], method="nearest")))
        end = x > 70
        kind = "strong"
        if place == 0:
            kind = "strong cm"
        y = percent_place(100 * float(rows[place]))
        anchor = "start"
        shift = 10
        if end:
            anchor = "end"
            shift = -10
        parts.append(label(name, x, y, anchor, kind, dx=shift, dy=-2))
    return parts
