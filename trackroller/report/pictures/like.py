"""Results of contact models over those of one of them, like against like."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from trackroller.report.numbers import grouped
from trackroller.report.pictures.axis import Axis
from trackroller.report.pictures.frame import WIDE, cut_apart, framed, lower_axis
from trackroller.report.pictures.marks import dot, joined, label, percent_place, upright, width_of
from trackroller.report.pictures.picture import Picture, caption_of
from trackroller.results.answer import Answer

MOST_DOTS = 60  # of one row


def ratios_of(own: Any, other: Any) -> np.ndarray:
    """Return the ratios of results on like rows, NaN where they have none."""
    mine = np.asarray(own, dtype=float)
    theirs = np.asarray(other, dtype=float)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.where(mine == theirs, 1.0, mine / theirs))


def draw_like(answer: Answer, data: Mapping[str, Any]) -> Picture:
    """Draw ratios of results on like rows, one row of dots for each model and output."""
    ratios = {model: ratios_of(one["y"], one["x"]) for model, one in data["points"].items()}
    if ratios:
        every = np.concatenate([one[np.isfinite(one)] for one in ratios.values()])
    else:
        every = np.empty(0)
    across = Axis.of([*every, 1.0])
    height = max(60.0, 44.0 * len(ratios))
    names = cut_apart(list(ratios), 150)
    left = max([width_of(name) for name in names], default=40.0) + 16
    parts = [
        lower_axis(across, f"÷ {data['base']}", WIDE, lines=True),
        upright("x", across.place(1.0)),
    ]
    for place, (name, one) in enumerate(zip(names, ratios.values(), strict=True)):
        y = 100 * (place + 0.5) / len(ratios)
        parts.append(label(name, 0, percent_place(y), "end", dx=-10, dy=4))
        known = one[np.isfinite(one)]
        if known.size <= MOST_DOTS:
            dots = known
        else:
            dots = np.quantile(known, np.linspace(0, 1, MOST_DOTS))
        spread = 30.0 / len(ratios)
        for number_of, value in enumerate(dots):
            # golden section: an even scatter without chance
            moved = y + spread * (((number_of * 0.618034) % 1) - 0.5)
            style = "d faint co"
            if place % 2 == 0:
                style = "d faint cm"
            parts.append(dot(style, across.place(float(value)), moved, 3))
    words = "; ".join(
        f"{name}: {grouped(float(np.nanmin(one)), 3)} to {grouped(float(np.nanmax(one)), 3)}"
        for name, one in ratios.items()
        if np.isfinite(one).any()
    )
    pairs = max((int(np.isfinite(one).sum()) for one in ratios.values()), default=0)
    drawn = framed(joined(parts), height, words, left=left, right=14)
    thinned = ""
    if pairs > MOST_DOTS:
        thinned = f", {MOST_DOTS} of them drawn evenly"
    return Picture(
        drawn,
        caption_of(
            data,
            f"Each result over that of {data['base']} in the same case: {pairs:,} pairs{thinned}.",
        ),
    )
