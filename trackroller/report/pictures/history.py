"""The best value of a search with one goal over its candidates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from trackroller.report.numbers import capital
from trackroller.report.pictures.axis import Axis
from trackroller.report.pictures.curves import points
from trackroller.report.pictures.frame import (
    WIDE,
    framed,
    left_room,
    lower_axis,
    required_levels,
    upright_axis,
    with_unit,
)
from trackroller.report.pictures.marks import element, joined, label, stretched
from trackroller.report.pictures.picture import Picture, caption_of
from trackroller.results.answer import Answer

TALL = 260.0  # height [px]


def draw_history(answer: Answer, data: Mapping[str, Any]) -> Picture | None:
    """Draw the best value of the goal so far over the evaluations; None without a known value."""
    best = np.asarray(data["history"], dtype=float)
    steps = np.arange(1.0, len(best) + 1.0)
    known = np.isfinite(best)
    if not known.any():
        return None
    across = Axis.of(steps, False, room=0.0)
    up = Axis.of(best[known])
    line = [
        (across.place(x), 100 - up.place(y)) for x, y in zip(steps[known], best[known], strict=True)
    ]
    stairs = [place for i, place in enumerate(line) for place in _stair(line, i)]
    layer = stretched(element("polyline", class_="l cm", points=points(stairs)), TALL)
    title = with_unit(capital(data["words"][0]), data["units"][0])
    left = left_room(up, TALL)
    parts = [upright_axis(up, TALL), layer, required_levels(answer, up)]
    parts += [
        lower_axis(across, "designs solved", WIDE),
        label(title, 0, "0", "start", dx=2 - left, dy=-7),
    ]
    drawn = framed(
        joined(parts), TALL, f"{title} of the best design so far", left=left, right=14, top=24
    )
    return Picture(
        drawn,
        caption_of(data, "Best design so far, over the designs that were solved."),
        beside=True,
    )


def _stair(line: Sequence[tuple[float, float]], i: int) -> list[tuple[float, float]]:
    if i == 0:
        return [line[0]]
    return [(line[i][0], line[i - 1][1]), line[i]]
