"""The frame of a picture with two axes: lines, ticks, titles and the required line."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from markupsafe import Markup

from trackroller.report.bounds import required_of_output
from trackroller.report.numbers import as_required, unit_text
from trackroller.report.pictures.axis import Axis
from trackroller.report.pictures.marks import (
    anchor_at,
    element,
    joined,
    label,
    level,
    percent_place,
    picture,
    upright,
    width_of,
)
from trackroller.results.answer import Answer, Required

NARROW = 190.0  # width of a small picture on a narrow screen [px]; its ticks have to fit into it
WIDE = 280.0  # the same of a picture that has a row of its own [px]
STEP = 12  # of the room beside a picture that the style sheet knows [px]


def with_unit(title: str, units: str) -> str:
    """Return a title with its unit in brackets; a plain number has none."""
    unit = unit_text(units).replace("–", "")
    if unit:
        return f"{title} [{unit}]"
    return title


def upright_axis(axis: Axis, height: float) -> Markup:
    """Return lines across the picture with their numbers on the left."""
    parts = []
    for value, text in axis.lines(height):
        y = 100 - axis.place(value)
        parts += [level("g", y), label(text, 0, percent_place(y), "end", dx=-6, dy=4)]
    return joined(parts)


def left_room(axis: Axis, height: float) -> int:
    """Return the room that the numbers on the left need [px]."""
    widths = [width_of(text) for _, text in axis.lines(height)]
    return int(max(widths, default=20.0)) + 12


def lower_axis(axis: Axis, title: str, width: float, lines: bool = False) -> Markup:
    """Return the ticks and the title below a picture."""
    parts = []
    for value, text in axis.ticks(width):
        x = axis.place(value)
        if lines:
            parts.append(upright("g", x))
        parts.append(label(text, x, "100%", dx=0, dy=15))
    return joined([*parts, label(title, 50, "100%", dx=0, dy=31)])


def lower_names(names: Sequence[str], places: Sequence[float], width: float) -> Markup:
    """Return names below a picture; a name that is longer than its share of the width is cut, its
    title is whole.
    """
    share = width / max(1, len(names))
    parts = []
    for name, place in zip(names, places, strict=True):
        text = cut(name, share)
        whole = ""
        if text != name:
            whole = element("title", name)
        content = joined([Markup.escape(text), Markup(whole)])
        anchor = anchor_at(place)
        text_anchor = anchor
        if anchor == "start":
            text_anchor = ""
        parts.append(
            element(
                "text", content, x=percent_place(place), y="100%", dy=15, text_anchor=text_anchor
            )
        )
    return joined(parts)


def cut(text: str, width: float) -> str:
    """Return a text that fits a width [px]: its beginning and an ellipsis where it is longer."""
    if width_of(text) <= width:
        return text
    letters = max(1, int(len(text) * width / width_of(text)) - 1)
    return f"{text[:letters]}…"


def framed(
    content: Markup, height: float, words: str, left: float = 52, right: float = 10, top: float = 6
) -> Markup:
    """Return a picture with room for its axes [px].

    The style sheet of a page holds the steps of this room, because its policy forbids styles of
    single elements.
    """
    steps = [
        f"{side}{math.ceil(room / STEP) * STEP}"
        for side, room in (("l", left), ("r", right), ("t", top))
    ]
    return element("div", picture(content, height, words), class_=" ".join(["frame", *steps]))


def bounds_of(answer: Answer) -> list[tuple[float, str]]:
    """Return the bounds that are required of the output of an answer, with their words."""
    return [bound for one in required_of_output(answer) for bound in _bounds(one)]


def _bounds(required: Required) -> list[tuple[float, str]]:
    ends = [(required.least, "required"), (required.most, "at most")]
    return [(value, f"{word} {as_required(value)}") for value, word in ends if math.isfinite(value)]


def required_levels(answer: Answer, axis: Axis) -> Markup:
    """Return the required values as lines across a picture."""
    return joined([level("r", 100 - axis.place(value)) for value, _ in bounds_of(answer)])


def output_title(answer: Answer) -> str:
    """Return the words and the unit of the output of an answer."""
    return with_unit(answer.output[1], answer.output[2])


def left_out_words(picture_data: Mapping[str, Any]) -> str:
    """Return how many rows a picture leaves out; '' for none."""
    left = int(picture_data.get("left_out", 0))
    if left:
        return f"{left:,} rows are not drawn: they are not valid at every level."
    return ""
