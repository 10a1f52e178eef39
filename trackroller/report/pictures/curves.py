"""Effects of factors as small pictures on one output axis: the curve with its spread, or dots for
single levels.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from trackroller.report.bounds import bounds_of_output
from trackroller.report.numbers import capital, carried, grouped, level_text, unit_text
from trackroller.report.pictures.axis import Axis
from trackroller.report.pictures.frame import (
    NARROW,
    framed,
    left_room,
    lower_axis,
    lower_names,
    required_levels,
    upright_axis,
    with_unit,
)
from trackroller.report.pictures.marks import dot, element, joined, line, percent_place, stretched
from trackroller.results.answer import Answer, Curve
from trackroller.study.design.levels import NAMED

HEIGHT = 125.0
MOST_NAMES = 6  # levels without an order that get a name each; of more, the picture numbers them


@dataclass(frozen=True)
class Effect:
    """The picture of one effect: its head, its height in words, the picture."""

    title: str
    height: str
    picture: Markup


def effects(answer: Answer) -> list[Effect]:
    """Return a picture for each curve of an answer, all on one axis of the output."""
    curves = [curve for curve in answer.curves if np.isfinite(curve.middle).any()]
    if not curves:
        return []
    ends = [*(_inside(curve) for curve in curves)]
    bounds = bounds_of_output(answer)
    axis = Axis.of([*np.concatenate(ends), *bounds])
    return [
        Effect(capital(curve.title), height_words(curve), _drawn(answer, curve, axis))
        for curve in curves
    ]


def height_words(curve: Curve) -> str:
    """Return the height of a curve: '×42', or a difference where it is no ratio."""
    if math.isinf(curve.height):
        return "to 0"
    if curve.by_ratio:
        return f"×{grouped(curve.height, 2)}"
    return f"Δ {grouped(curve.height, 2)}"


def _inside(curve: Curve) -> np.ndarray:
    """Return the finite numbers of a curve, which its axis holds."""
    every = np.concatenate(
        [np.asarray(ends, dtype=float) for ends in (curve.middle, curve.low, curve.high)]
    )
    return every[np.isfinite(every)]


def _drawn(answer: Answer, curve: Curve, axis: Axis) -> Markup:
    words = f"{curve.title}: " + "; ".join(
        f"{_text(curve, level)} {carried(float(middle))}"
        for level, middle in zip(curve.levels, curve.middle, strict=True)
    )
    numeric = curve.ordered and not _named(curve)
    places = _places(curve, numeric)
    parts = [upright_axis(axis, HEIGHT)]
    if numeric:
        parts += [_band(curve, axis, places), required_levels(answer, axis)]
        if len(places) <= MOST_NAMES:
            parts += _dots(curve, axis, places)
        parts.append(_below(curve))
    else:
        parts += [
            *_posts(curve, axis, places),
            required_levels(answer, axis),
            *_dots(curve, axis, places),
        ]
        texts = [_text(curve, level) for level in curve.levels]
        if len(texts) > MOST_NAMES:
            texts = [str(place) for place in range(1, len(texts) + 1)]
        parts.append(lower_names(texts, places, NARROW))
    return framed(joined(parts), HEIGHT, words, left=left_room(axis, HEIGHT))


def _named(curve: Curve) -> bool:
    return any(isinstance(level, str) or not math.isfinite(float(level)) for level in curve.levels)


def _text(curve: Curve, level: object) -> str:
    if isinstance(level, str) or curve.factor in NAMED:
        return level_text(curve.factor, level)
    return grouped(float(str(level)))


def _places(curve: Curve, numeric: bool) -> list[float]:
    """Return where the levels stand: on an axis, or side by side."""
    if not numeric:
        count = len(curve.levels)
        return [100 * (i + 0.5) / count for i in range(count)]
    axis = level_axis(curve.levels, curve.logarithmic)
    return [axis.place(float(level)) for level in curve.levels]


def level_axis(levels: Sequence[float], logarithmic: bool) -> Axis:
    """Return the axis of the levels of a factor, from its smallest to its largest."""
    return Axis.of(map(float, levels), logarithmic and min(levels) > 0, room=0.0)


def _below(curve: Curve) -> Markup:
    axis = level_axis(curve.levels, curve.logarithmic)
    unit = unit_text(curve.units).replace("–", "")
    return lower_axis(axis, unit, NARROW)


def _band(curve: Curve, axis: Axis, places: Sequence[float]) -> Markup:
    """Return the spread of a curve as a band, and its middle as a line; levels without a value part
    both.
    """
    layers = []
    for rows in _runs(np.isfinite(curve.middle)):
        upper = [
            (places[i], 100 - axis.place(float(curve.high[i])))
            for i in rows
            if np.isfinite(curve.high[i])
        ]
        lower = [
            (places[i], 100 - axis.place(float(curve.low[i])))
            for i in rows
            if np.isfinite(curve.low[i])
        ]
        middle = [(places[i], 100 - axis.place(float(curve.middle[i]))) for i in rows]
        if len(upper) > 1 and len(lower) > 1:
            layers.append(
                element("polygon", class_="f cm", points=points([*upper, *reversed(lower)]))
            )
        layers.append(element("polyline", class_="l cm", points=points(middle)))
    return stretched(joined(layers), HEIGHT)


def points(places: Sequence[tuple[float, float]]) -> str:
    """Return places of a line in percent."""
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in places)


def _runs(known: np.ndarray) -> list[list[int]]:
    """Return neighbouring levels that have a value."""
    runs: list[list[int]] = []
    for i in np.flatnonzero(known):
        if runs and runs[-1][-1] == i - 1:
            runs[-1].append(int(i))
        else:
            runs.append([int(i)])
    return runs


def _dots(curve: Curve, axis: Axis, places: Sequence[float]) -> list[Markup]:
    known = [i for i in range(len(places)) if np.isfinite(curve.middle[i])]
    return [dot("d cm", places[i], 100 - axis.place(float(curve.middle[i])), 3.5) for i in known]


def _posts(curve: Curve, axis: Axis, places: Sequence[float]) -> list[Markup]:
    """Return the spread at levels without an order, one post each."""
    known = [
        i for i in range(len(places)) if np.isfinite(curve.low[i]) and np.isfinite(curve.high[i])
    ]
    return [
        line(
            "p cm",
            places[i],
            percent_place(100 - axis.place(float(curve.low[i]))),
            places[i],
            percent_place(100 - axis.place(float(curve.high[i]))),
        )
        for i in known
    ]


MADE_OF = {  # `Curve.by`
    "like cases": "median of like cases at each level",
    "fit": "fit of all cases",
    "changes": "changes between cases that differ in this factor alone",
    "drawn cases": "median of the drawn cases at each level",
}


def _made_of(answer: Answer) -> str:
    """Return what the curves are made of; where they differ, each kind with its factors."""
    kinds = list(dict.fromkeys(curve.by for curve in answer.curves))
    if len(kinds) == 1:
        return MADE_OF[kinds[0]]
    texts = []
    for kind in kinds:
        titles = [curve.title for curve in answer.curves if curve.by == kind]
        texts.append(f"{MADE_OF[kind]} ({', '.join(titles)})")
    return "; ".join(texts)


def caption(answer: Answer) -> str:
    """Return what the pictures of effects draw."""
    title = with_unit(capital(answer.output[1]), answer.output[2])
    text = f"{title}: {_made_of(answer)}; band from the 10th to the 90th hundredth of the cases"
    if any(math.isfinite(end) for one in answer.required for end in (one.least, one.most)):
        text += "; dashed: required"
    ratios = all(curve.by_ratio for curve in answer.curves)
    height = "Δ is the largest less"
    if ratios:
        height = "× is the largest over"
    text += f". {height} the smallest middle."
    numbered = [
        curve for curve in answer.curves if not curve.ordered and len(curve.levels) > MOST_NAMES
    ]
    for curve in numbered:
        names = ", ".join(
            f"{place} {_text(curve, level)}" for place, level in enumerate(curve.levels, 1)
        )
        text += f" {curve.title}: {names}."
    left = [f"{curve.title} {curve.left_out:,}" for curve in answer.curves if curve.left_out]
    if left:
        return (
            f"{text} Valid cases without a partner at some level are left out: {', '.join(left)}."
        )
    return text
