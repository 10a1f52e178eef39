"""Results of contact models over those of one of them, like against like."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from markupsafe import Markup

from trackroller.report.numbers import grouped
from trackroller.report.pictures.axis import Axis
from trackroller.report.pictures.frame import WIDE, cut_apart, framed, lower_axis
from trackroller.report.pictures.marks import dot, joined, label, percent_place, upright, width_of
from trackroller.report.pictures.picture import Picture, caption_of
from trackroller.results.answer import Answer

MOST_DOTS = 60  # of one row
LONGEST = 150  # width of the name of a row [px]


def ratios_of(own: Any, other: Any) -> np.ndarray:
    """Return the ratios of results on like rows, NaN where they have none."""
    mine = np.asarray(own, dtype=float)
    theirs = np.asarray(other, dtype=float)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.where(mine == theirs, 1.0, mine / theirs))


def draw_like(answer: Answer, data: Mapping[str, Any]) -> Picture:
    """Draw ratios of results on like rows, one row of dots for each model and output."""
    ratios = {model: ratios_of(one["y"], one["x"]) for model, one in data["points"].items()}
    known = {name: one[np.isfinite(one)] for name, one in ratios.items()}
    across = Axis.of([*np.concatenate([*known.values(), np.empty(0)]), 1.0])
    height = max(60.0, 44.0 * len(known))
    names = cut_apart(list(known), LONGEST)
    left = max([width_of(name) for name in names], default=40.0) + 16
    parts = [
        lower_axis(across, f"÷ {data['base']}", WIDE, lines=True),
        upright("x", across.place(1.0)),
    ]
    for place, (name, values) in enumerate(zip(names, known.values(), strict=True)):
        parts += _row_of_dots(across, place, len(known), name, values)
    drawn = framed(joined(parts), height, _ranges_in_words(ratios), left=left, right=14)
    return Picture(drawn, caption_of(data, _meaning_of_dots(data["base"], known)))


def _row_of_dots(
    across: Axis, place: int, rows: int, name: str, values: np.ndarray
) -> Iterator[Markup]:
    """Yield the label of a row and its dots, scattered over the height of the row."""
    y = 100 * (place + 0.5) / rows
    yield label(name, 0, percent_place(y), "end", dx=-10, dy=4)
    if values.size > MOST_DOTS:
        values = np.quantile(values, np.linspace(0, 1, MOST_DOTS))
    style = "d faint co"
    if place % 2 == 0:
        style = "d faint cm"
    spread = 30.0 / rows
    for number, value in enumerate(values):
        # golden section: an even scatter without chance
        moved = y + spread * (((number * 0.618034) % 1) - 0.5)
        yield dot(style, across.place(float(value)), moved, 3)


def _ranges_in_words(ratios: Mapping[str, np.ndarray]) -> str:
    """Return the smallest and the largest ratio of each row that has a finite one, as text."""
    ranges = []
    for name, values in ratios.items():
        if np.isfinite(values).any():
            least = grouped(float(np.nanmin(values)), 3)
            most = grouped(float(np.nanmax(values)), 3)
            ranges.append(f"{name}: {least} to {most}")
    return "; ".join(ranges)


def _meaning_of_dots(base: str, known: Mapping[str, np.ndarray]) -> str:
    """Return what a dot is, and how many pairs of results the rows show."""
    pairs = max((values.size for values in known.values()), default=0)
    thinned = ""
    if pairs > MOST_DOTS:
        thinned = f", {MOST_DOTS} of them drawn evenly"
    return f"Each result over that of {base} in the same case: {pairs:,} pairs{thinned}."
