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
    across = Axis.of([*every[every > 0], *(value for value, _ in bounds)])
    up = Axis(0.0, 100.0)
    lines = [_reached(one, across, place) for place, one in enumerate(shown.values())]
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
    return Picture(
        drawn, caption_of(data, f"Share of the conditions that reach a value [%].{further}")
    )


def _near_left(bounds: Sequence[tuple[float, str]], across: Axis) -> bool:
    return any(across.place(value) < 30 for value, _ in bounds)


def _reached(values: np.ndarray, across: Axis, place: int) -> Markup:
    """Return a falling line: the share of values that are at least as large as a place on the
    axis.
    """
    ordered = np.sort(np.where(np.isnan(values), -np.inf, values))
    if not ordered.size:
        return Markup()
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
    kind = "cg"
    if place == 0:
        kind = "cm"
    return element(
        "polyline", class_=f"l {kind} {STROKES[place % len(STROKES)]}".rstrip(), points=points(line)
    )


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
