"""The one picture of the first screen: front, history, distribution, like against like, or slice."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from markupsafe import Markup

from trackroller.report.numbers import capital, grouped, level_text, unit_text
from trackroller.report.pictures.axis import Axis
from trackroller.report.pictures.curves import points
from trackroller.report.pictures.frame import (
    WIDE,
    bounds_of,
    cut,
    framed,
    left_out_words,
    left_room,
    lower_axis,
    output_title,
    required_levels,
    upright_axis,
    with_unit,
)
from trackroller.report.pictures.marks import (
    anchor_at,
    dot,
    element,
    joined,
    label,
    percent_place,
    spread_labels,
    stretched,
    upright,
    width_of,
)
from trackroller.results.answer import Answer, Column
from trackroller.study.design.levels import NAMED

TALL = 260.0  # height of a front [px]
FLAT = 190.0  # height of a picture that takes the whole width [px]
LINE = 15.0  # height of a line of text in a picture [px]
MOST_POINTS = 800  # of a front that are drawn; of more, those of the front and an even part of the others
MOST_LINES = 6  # of a distribution or a slice with a name
MOST_STEPS = 120  # places of a distribution
MOST_DOTS = 60  # of one row of like against like
STROKES = ("", "dashed", "dotted", "chain")


@dataclass(frozen=True)
class Picture:
    """A picture with what it draws in words, and whether it stands beside the table."""

    drawn: Markup
    caption: str
    beside: bool = False


def picture_of(answer: Answer) -> Picture | None:
    """Return the picture of the first screen of an answer, None if its table or its curves are the picture."""
    for name, draw in DRAWINGS.items():
        if answer.picture.get(name) is not None:
            return draw(answer, answer.picture)
    return None


def _goals(answer: Answer, data: Mapping[str, Any]) -> Picture | None:
    """Draw a search: the front of two goals, or the best value of one goal so far; None without a known value."""
    if len(data["words"]) == 1:
        return _history(answer, data)
    return _front(answer, data)


def _front(answer: Answer, data: Mapping[str, Any]) -> Picture | None:
    """Draw a front: its designs as dots, other ones as rings, the named ones large; upwards the first goal."""
    values = np.asarray(data["goals"], dtype=float)[:, [1, 0]]
    known = np.isfinite(values).all(axis=1)
    if not known.any():
        return None
    front = np.asarray(data["front"], dtype=bool)
    across, up = Axis.of(values[:, 0]), Axis.of(values[:, 1])
    parts = [upright_axis(up, TALL)]
    rows = _thinned(front)
    parts += [
        dot("d small cm" if front[i] else "ring", across.place(values[i, 0]), 100 - up.place(values[i, 1]), 2.6)
        for i in rows
        if known[i]
    ]
    titles = row_names(answer, len(data["named"]))
    named = [
        {"x": values[i, 0], "y": values[i, 1], "title": text}
        for i, text in zip(data["named"], titles, strict=True)
        if known[i]
    ]
    parts += _named_dots(named, across, up)
    words, units = data["words"], data["units"]
    parts.append(lower_axis(across, with_unit(capital(words[1]), units[1]), WIDE))
    left = left_room(up, TALL)
    title = with_unit(capital(words[0]), units[0])
    parts.append(label(title, 0, "0", "start", dx=2 - left, dy=-7))
    spoken = "; ".join(f"{one['title']}: {grouped(one['x'], 3)}, {grouped(one['y'], 3)}" for one in named)
    drawn = framed(joined(parts), TALL, spoken or title, left=left, right=14, top=24)
    said = f"Small dots: {int(front.sum()):,} designs that no other one beats"
    if (~front).any():
        said += "; rings: other designs"
    said += "; large: those of the headline."
    if len(values[0]) < len(words):
        said += f" Not drawn: {', '.join(words[2:])}."
    if not known.all():
        said += f" Not drawn, because a goal is not known: {int((~known).sum()):,} designs."
    if len(rows) < len(front):
        said += f" {len(front) - len(rows):,} designs are not drawn."
    return Picture(drawn, _caption(data, said), beside=True)


def _thinned(best: np.ndarray) -> list[int]:
    """Return the rows to draw: those of the front, and an even part of the others."""
    others = np.flatnonzero(~best)
    room = max(0, MOST_POINTS - int(best.sum()))
    if len(others) > room:
        others = others[np.linspace(0, len(others) - 1, room).astype(int)] if room else others[:0]
    front = np.flatnonzero(best)
    if len(front) > MOST_POINTS:
        front = front[np.linspace(0, len(front) - 1, MOST_POINTS).astype(int)]
    return sorted([*front.tolist(), *others.tolist()])


def _named_dots(named: Sequence[Mapping[str, Any]], across: Axis, up: Axis) -> list[Markup]:
    """Return large dots with their titles, on the side that has room, at heights that do not collide."""
    places = [(across.place(float(one["x"])), 100 - up.place(float(one["y"]))) for one in named]
    heights = [y * TALL / 100 for _, y in places]
    texts = spread_labels(heights, LINE, LINE / 2, TALL - LINE / 2)
    parts = []
    for one, (x, y), height in zip(named, places, texts, strict=True):
        end = x > 50
        parts.append(dot("d cm", x, y, 5.5))
        text = cut(str(one["title"]), WIDE * (x if end else 100 - x) / 100)
        anchor = "end" if end else "start"
        parts.append(label(text, x, f"{height:.0f}", anchor, "strong", dx=-12 if end else 12, dy=4))
    return parts


def _history(answer: Answer, data: Mapping[str, Any]) -> Picture | None:
    """Draw the best value of the goal so far over the evaluations."""
    best = np.asarray(data["history"], dtype=float)
    steps = np.arange(1.0, len(best) + 1.0)
    known = np.isfinite(best)
    if not known.any():
        return None
    across = Axis.of(steps, False, room=0.0)
    up = Axis.of(best[known])
    line = [(across.place(x), 100 - up.place(y)) for x, y in zip(steps[known], best[known], strict=True)]
    stairs = [place for i, place in enumerate(line) for place in _stair(line, i)]
    layer = stretched(element("polyline", class_="l cm", points=points(stairs)), TALL)
    title = with_unit(capital(data["words"][0]), data["units"][0])
    left = left_room(up, TALL)
    parts = [upright_axis(up, TALL), layer, required_levels(answer, up)]
    parts += [lower_axis(across, "designs solved", WIDE), label(title, 0, "0", "start", dx=2 - left, dy=-7)]
    drawn = framed(joined(parts), TALL, f"{title} of the best design so far", left=left, right=14, top=24)
    return Picture(drawn, _caption(data, "Best design so far, over the designs that were solved."), beside=True)


def _stair(line: Sequence[tuple[float, float]], i: int) -> list[tuple[float, float]]:
    if i == 0:
        return [line[0]]
    return [(line[i][0], line[i - 1][1]), line[i]]


def _distribution(answer: Answer, data: Mapping[str, Any]) -> Picture:
    """Draw which share of the conditions reaches each value, for each candidate."""
    names = row_names(answer, len(data["values"]))
    values = {name: np.asarray(one, dtype=float) for name, one in zip(names, data["values"], strict=True)}
    shown = dict(list(values.items())[:MOST_LINES])
    bounds = bounds_of(answer)
    every = np.concatenate([one[np.isfinite(one)] for one in shown.values()]) if shown else np.empty(0)
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
    words = "; ".join(f"{name}: median {grouped(float(np.median(one)), 3)}" for name, one in shown.items() if one.size)
    drawn = framed(joined(parts), FLAT, words, left=46, right=14, top=24)
    more = f" {len(values) - len(shown):,} more candidates are not drawn." if len(values) > len(shown) else ""
    return Picture(drawn, _caption(data, f"Share of the conditions that reach a value [%].{more}"))


def _near_left(bounds: Sequence[tuple[float, str]], across: Axis) -> bool:
    return any(across.place(value) < 30 for value, _ in bounds)


def _reached(values: np.ndarray, across: Axis, place: int) -> Markup:
    """Return a falling line: the share of values that are at least as large as a place on the axis."""
    ordered = np.sort(np.where(np.isnan(values), -np.inf, values))
    if not ordered.size:
        return Markup()
    rows = np.unique(np.linspace(0, ordered.size - 1, min(MOST_STEPS, ordered.size)).astype(int))
    line = [(0.0, 0.0)] if ordered[0] > 0 else []
    for row in rows:
        reached = 100 * (ordered.size - row) / ordered.size
        x = across.place(float(ordered[row])) if ordered[row] > -math.inf else 0.0
        line.append((x, 100 - reached))
    last = float(ordered[-1])
    if math.isfinite(last):
        line.append((across.place(last), 100.0))
    kind = "cm" if place == 0 else "cg"
    return element("polyline", class_=f"l {kind} {STROKES[place % len(STROKES)]}".rstrip(), points=points(line))


def _names_of_lines(shown: Mapping[str, np.ndarray], across: Axis) -> list[Markup]:
    """Return the names of the lines, each beside its median, at heights that do not collide."""
    if len(shown) < 2:
        return []
    rows = np.linspace(0.2, 0.8, len(shown))
    parts = []
    for place, (name, values) in enumerate(shown.items()):
        known = np.sort(values[~np.isnan(values)])
        if not known.size:
            continue
        x = across.place(float(np.quantile(known, rows[place], method="nearest")))
        end = x > 70
        kind = "strong cm" if place == 0 else "strong"
        y = percent_place(100 * float(rows[place]))
        parts.append(label(cut(name, WIDE / 2), x, y, "end" if end else "start", kind, dx=-10 if end else 10, dy=-2))
    return parts


def row_names(answer: Answer, count: int) -> list[str]:
    """Return the names of the first rows of the table of an answer, each another one."""
    columns = [column for column in answer.columns if column.role == "name"]
    found: list[str] = []
    for place in range(min(count, len(answer.table))):
        row = answer.table.iloc[place]
        text = ", ".join(_level_words(column, row[column.name]) for column in columns)
        found.append(text if text and text not in found else f"{text} ({place + 1})".strip())
    return found


def _level_words(column: Column, value: Any) -> str:
    if isinstance(value, str) or column.name in NAMED:
        return level_text(column.name, value)
    return f"{grouped(float(value))} {unit_text(column.units)}".replace("–", "").strip().replace(" °", "°")


def _ratios(own: Any, other: Any) -> np.ndarray:
    """Return the ratios of results on like rows, NaN where they have none."""
    mine = np.asarray(own, dtype=float)
    theirs = np.asarray(other, dtype=float)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.where(mine == theirs, 1.0, mine / theirs))


def _like(answer: Answer, data: Mapping[str, Any]) -> Picture:
    """Draw ratios of results on like rows, one row of dots for each model and output."""
    ratios = {model: _ratios(one["y"], one["x"]) for model, one in data["points"].items()}
    every = np.concatenate([one[np.isfinite(one)] for one in ratios.values()]) if ratios else np.empty(0)
    across = Axis.of([*every, 1.0])
    height = max(60.0, 44.0 * len(ratios))
    left = max([width_of(cut(name, 150)) for name in ratios], default=40.0) + 16
    parts = [lower_axis(across, f"÷ {data['base']}", WIDE, lines=True), upright("x", across.place(1.0))]
    for place, (name, one) in enumerate(ratios.items()):
        y = 100 * (place + 0.5) / len(ratios)
        parts.append(label(cut(name, 150), 0, percent_place(y), "end", dx=-10, dy=4))
        known = one[np.isfinite(one)]
        kept = known if known.size <= MOST_DOTS else np.quantile(known, np.linspace(0, 1, MOST_DOTS))
        spread = 30.0 / len(ratios)
        for number_of, value in enumerate(kept):
            moved = y + spread * (((number_of * 0.618034) % 1) - 0.5)  # golden section: an even scatter without chance
            parts.append(dot("d faint cm" if place % 2 == 0 else "d faint co", across.place(float(value)), moved, 3))
    words = "; ".join(
        f"{name}: {grouped(float(np.nanmin(one)), 3)} to {grouped(float(np.nanmax(one)), 3)}"
        for name, one in ratios.items()
        if np.isfinite(one).any()
    )
    pairs = max((int(np.isfinite(one).sum()) for one in ratios.values()), default=0)
    drawn = framed(joined(parts), height, words, left=left, right=14)
    thinned = f", {MOST_DOTS} of them drawn evenly" if pairs > MOST_DOTS else ""
    return Picture(
        drawn, _caption(data, f"Each result over that of {data['base']} in the same case: {pairs:,} pairs{thinned}.")
    )


def _caption(data: Mapping[str, Any], said: str) -> str:
    """Return what a picture draws: the words of the record if it has some, otherwise those of the picture."""
    parts = [data.get("caption") or said, left_out_words(data)]
    return " ".join(part for part in parts if part)


DRAWINGS: dict[str, Callable[[Answer, Mapping[str, Any]], Picture | None]] = {
    "goals": _goals,
    "values": _distribution,
    "points": _like,
}
MAP_ROW = 26.0  # height of a row of a map [px]
SHADES = 7  # of a map
WORTH = 0.02  # of the variance: a map is drawn from such an interaction on


def map_of(answer: Answer) -> tuple[Markup, str] | None:
    """Return the map of the pairs that interact, with what it draws; None where no pair holds 2 % of the variance."""
    if answer.picture.get("pairs") is None:
        return None
    shares = np.asarray(answer.picture["pairs"], dtype=float)
    names = [capital(str(title)) for title in answer.picture["titles"]]
    own = np.tril(np.nan_to_num(shares), -1)
    if own.max(initial=0.0) < WORTH:
        return None
    kept = [i for i in range(len(names)) if max(own[i].max(), own[:, i].max()) >= WORTH]
    return _drawn_map(own[np.ix_(kept, kept)], [names[i] for i in kept])


def _drawn_map(shares: np.ndarray, names: Sequence[str]) -> tuple[Markup, str]:
    """Draw the shares of the pairs of factors as cells with their numbers."""
    size = len(names) - 1  # the first factor has no row, the last one no column
    cell = 100 / size
    parts = []
    for row in range(size):
        y = row * cell
        parts.append(label(cut(names[row + 1], 110), 0, percent_place(y + cell / 2), "end", dx=-6, dy=4))
        for column in range(row + 1):
            share = float(shares[row + 1, column])
            shade = min(SHADES - 1, int(SHADES * share / max(float(shares.max()), WORTH)))
            place = (percent_place(column * cell), percent_place(y))
            length = percent_place(cell)
            parts.append(element("rect", class_=f"s{shade}", x=place[0], y=place[1], width=length, height=length))
            middle = percent_place(y + cell / 2)
            parts.append(label(f"{100 * share:.0f}", (column + 0.5) * cell, middle, kind="strong", dx=0, dy=4))
    for column in range(size):
        parts.append(label(cut(names[column], 260 / size), (column + 0.5) * cell, "100%", dx=0, dy=15))
    left = max(width_of(cut(name, 110)) for name in names[1:]) + 14
    words = "; ".join(
        f"{names[i]} and {names[j]} {100 * shares[i, j]:.0f} %" for i in range(len(names)) for j in range(i)
    )
    drawn = framed(joined(parts), MAP_ROW * size, words, left=left)
    return drawn, "Share of the variance that a pair of factors holds beyond each of them alone [%]."
