"""The front of a search with two goals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from markupsafe import Markup

from trackroller.report.numbers import capital, grouped
from trackroller.report.pictures.axis import Axis
from trackroller.report.pictures.frame import (
    WIDE,
    cut,
    framed,
    left_room,
    lower_axis,
    upright_axis,
    with_unit,
)
from trackroller.report.pictures.marks import (
    dot,
    joined,
    label,
    spread_labels,
    width_of,
)
from trackroller.report.pictures.picture import Picture, caption_of, row_names
from trackroller.results.answer import Answer

TALL = 260.0  # height of a front and of a history [px]
LINE = 15.0  # height of a line of text in a picture [px]
# of a front that are drawn; of more, those of the front and an even part of the others
MOST_POINTS = 800


def draw_front(answer: Answer, data: Mapping[str, Any]) -> Picture | None:
    """Draw a front: its candidates as dots, other ones as rings, the named ones large; upwards the
    first goal.

    None is drawn where no candidate has two known goals.
    """
    values = np.asarray(data["goals"], dtype=float)[:, [1, 0]]
    known = np.isfinite(values).all(axis=1)
    if not known.any():
        return None
    front = np.asarray(data["front"], dtype=bool)
    across, up = Axis.of(values[:, 0]), Axis.of(values[:, 1])
    parts = [upright_axis(up, TALL)]
    rows = _thinned(front)
    styles = np.where(front, "d small cm", "ring")
    parts += [
        dot(styles[i], across.place(values[i, 0]), 100 - up.place(values[i, 1]), 2.6)
        for i in rows
        if known[i]
    ]
    titles = row_names(answer, len(data["named"]))
    named = [
        {"x": values[i, 0], "y": values[i, 1], "title": text}
        for i, text in zip(data["named"], titles, strict=True)
        if known[i]
    ]
    parts += _named_dots(named, across, up, values[rows][known[rows]])
    words, units = data["words"], data["units"]
    parts.append(lower_axis(across, with_unit(capital(words[1]), units[1]), WIDE))
    left = left_room(up, TALL)
    title = with_unit(capital(words[0]), units[0])
    parts.append(label(title, 0, "0", "start", dx=2 - left, dy=-7))
    spoken = "; ".join(
        f"{one['title']}: {grouped(one['x'], 3)}, {grouped(one['y'], 3)}" for one in named
    )
    drawn = framed(joined(parts), TALL, spoken or title, left=left, right=14, top=24)
    caption = f"Small dots: {int(front.sum()):,} designs that no other one beats"
    if (~front).any():
        caption += "; rings: other designs"
    caption += "; large: those of the headline."
    if len(values[0]) < len(words):
        caption += f" Not drawn: {', '.join(words[2:])}."
    if not known.all():
        caption += f" Not drawn, because a goal is not known: {int((~known).sum()):,} designs."
    if len(rows) < len(front):
        caption += f" {len(front) - len(rows):,} designs are not drawn."
    return Picture(drawn, caption_of(data, caption), beside=True)


def _thinned(best: np.ndarray) -> list[int]:
    """Return the rows to draw: those of the front, and an even part of the others."""
    others = np.flatnonzero(~best)
    room = max(0, MOST_POINTS - int(best.sum()))
    if len(others) > room:
        if room:
            others = others[np.linspace(0, len(others) - 1, room).astype(int)]
        else:
            others = others[:0]
    front = np.flatnonzero(best)
    if len(front) > MOST_POINTS:
        front = front[np.linspace(0, len(front) - 1, MOST_POINTS).astype(int)]
    return sorted([*front.tolist(), *others.tolist()])


def _named_dots(
    named: Sequence[Mapping[str, Any]], across: Axis, up: Axis, drawn: np.ndarray
) -> list[Markup]:
    """Return large dots with their titles, on the side where they cover fewer dots, at heights that
    do not collide.

    Parameters
    ----------
    named : candidates with `x`, `y` and `title`
    across, up : axes of both goals
    drawn : both goals of each dot, shape (n, 2)
    """
    places = [(across.place(float(one["x"])), 100 - up.place(float(one["y"]))) for one in named]
    heights = [y * TALL / 100 for _, y in places]
    texts = spread_labels(heights, LINE, LINE / 2, TALL - LINE / 2)
    dots = np.array([(across.place(x), (100 - up.place(y)) * TALL / 100) for x, y in drawn])
    parts = []
    for one, (x, y), height in zip(named, places, texts, strict=True):
        title = str(one["title"])
        end = _stands_left(title, x, height, dots)
        parts.append(dot("d cm", x, y, 5.5))
        room = 100 - x
        anchor = "start"
        shift = 12
        if end:
            room = x
            anchor = "end"
            shift = -12
        text = cut(title, WIDE * room / 100)
        parts.append(label(text, x, f"{height:.0f}", anchor, "strong", dx=shift, dy=4))
    return parts


def _stands_left(title: str, x: float, height: float, dots: np.ndarray) -> bool:
    """Return whether a title stands to the left of its dot: where its text is less cut, or covers
    fewer dots.

    Parameters
    ----------
    title : the text
    x : place of its dot across the picture [%]
    height : of the text [px]
    dots : places of the dots, [%] and [px], shape (n, 2)
    """
    room = {True: WIDE * x / 100, False: WIDE * (100 - x) / 100}
    if min(room.values()) < width_of(title):
        return x > 50
    beside = np.abs(dots[:, 1] - height) < LINE / 2
    span = 100 * (width_of(title) + 12) / WIDE
    away = dots[:, 0] - x
    left = int((beside & (away < -1) & (away > -span)).sum())
    right = int((beside & (away > 1) & (away < span)).sum())
    return x > 50 if left == right else left < right
