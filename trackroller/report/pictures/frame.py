"""The frame of a picture with two axes: lines, ticks, titles and the required line."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from itertools import takewhile
from typing import Any

from markupsafe import Markup

from trackroller.report.bounds import required_of_output
from trackroller.report.numbers import as_required, unit_text
from trackroller.report.pictures.axis import LETTER, Axis
from trackroller.report.pictures.marks import (
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
    """Return names below a picture, each in the middle of its share of the width; a name that is
    longer is cut, its title is whole.
    """
    share = width / max(1, len(names)) - LETTER  # a letter stays free between neighbours
    parts = []
    for name, text, place in zip(names, cut_apart(names, share), places, strict=True):
        whole = ""
        if text != name:
            whole = element("title", name)
        content = joined([Markup.escape(text), Markup(whole)])
        at = percent_place(place)
        parts.append(element("text", content, x=at, y="100%", dy=15, text_anchor="middle"))
    return joined(parts)


def cut(text: str, width: float) -> str:
    """Return a text that fits a width [px]: its beginning and an ellipsis where it is longer."""
    if width_of(text) <= width:
        return text
    letters = max(1, int(width / LETTER + 1e-9) - 1)
    return f"{text[:letters]}…"


def cut_apart(names: Sequence[str], width: float) -> list[str]:
    """Return names that fit a width [px], so that names that differ look different.

    Names whose beginnings are alike lose what they share, up to a whole word where that is enough.
    """
    texts = [cut(name, width) for name in names]
    for text in dict.fromkeys(texts):
        cut_names = [name for name, own in zip(names, texts, strict=True) if own == text]
        alike = list(dict.fromkeys(cut_names))
        if len(alike) > 1:
            shorter = dict(zip(alike, _without_beginning(alike, width), strict=True))
            texts = [shorter.get(name, own) for name, own in zip(names, texts, strict=True)]
    return texts


def _without_beginning(names: Sequence[str], width: float) -> list[str]:
    """Return different names without the beginning that all of them share, cut to a width [px]."""
    letters = takewhile(lambda column: len(set(column)) == 1, zip(*names, strict=False))
    shared = "".join(column[0] for column in letters)
    word = re.match(r".*[ /-]", shared)
    texts: list[str] = []
    if word:
        texts = [cut(f"…{name[word.end() :]}", width) for name in names]
    if len(set(texts)) == len(names):
        return texts
    texts = [f"…{name[len(shared) :]}" for name in names]
    if len(shared) < 2:  # nothing is left to drop: the width holds no letter that differs
        return [cut(text, width) for text in texts]
    return cut_apart(texts, width)


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
