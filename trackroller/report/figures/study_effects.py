"""Main effect of every factor on life."""

from __future__ import annotations

import textwrap
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.parameters import PARAMETERS
from trackroller.report.figures import style
from trackroller.report.figures.study_view import StudyView

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MAX_ROWS = 9  # levels of one factor shown; more are put together in bins
Effect = tuple[str, list[str], np.ndarray]  # factor, its levels, mean log10 life at each


def effects(view: StudyView) -> list[Effect]:
    """Mean log10 life at each level (or bin) of each factor, the most influential factor first.

    Averages are over all cases with a life, whatever the other factors; an unlimited life counts as the
    longest finite one, so that such effects are lower bounds.
    """
    if view.life is None:
        return []
    life, good = _countable(view.table[view.life[0]].to_numpy(dtype=float))
    table, logs = view.table[good], np.log10(life[good])
    found = []
    for name in view.factors:
        labels, members = groups(view, name, table[name].to_numpy())
        means = np.array([logs[g].mean() if g.any() else np.nan for g in members])
        if np.isfinite(means).sum() > 1:
            found.append((name, labels, means))
    return sorted(found, key=lambda item: -float(np.nanmax(item[2]) - np.nanmin(item[2])))


def _countable(life: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Lives with the unlimited ones at the longest finite one, and where there is a life at all."""
    finite = np.isfinite(life) & (life > 0)
    if not finite.any():
        return life, finite
    return np.where(np.isposinf(life), life[finite].max(), life), finite | np.isposinf(life)


def groups(view: StudyView, name: str, values: np.ndarray, unit: bool = False) -> tuple[list[str], list[np.ndarray]]:
    """Names of the levels of a factor (of five bins when there are many) and which of `values` (n,) belong to each.

    With `unit` the names carry their unit and are not cut.
    """
    levels = view.levels(name)
    if not view.numeric(name) or len(levels) <= MAX_ROWS:
        return [style.level_text(name, v) if unit else _short(name, v) for v in levels], [values == v for v in levels]
    edges = np.unique(np.quantile(values[np.isfinite(values)], np.linspace(0, 1, 6)))
    index = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, len(edges) - 2)
    told = style.unit_text(PARAMETERS[name].unit) if unit and name in PARAMETERS else ""
    ending = "" if told == "–" else told
    span = float(edges[-1] - edges[0])
    names = [f"{style.near(a, span)} … {style.near(b, span)} {ending}".strip() for a, b in pairwise(edges)]
    return names, [index == i for i in range(len(edges) - 1)]


def _short(name: str, value: Any) -> str:
    text = style.level_text(name, value, unit=name in ("guide_curve_radius", "motor_force"))
    if len(text) <= 30:
        return text
    return "\n on ".join(text.split(" on ", 1)) if " on " in text else textwrap.fill(text, 26)


def main_effects(view: StudyView) -> tuple[Figure, style.FigureInfo] | None:
    """Mean log life by level of each factor, all on one axis."""
    found = effects(view)
    if view.life is None or not found:
        return None
    _, words, unit = view.life
    heights = [sum(1 + 0.7 * label.count("\n") for label in labels) + 1.6 for _, labels, _ in found]
    figure = style.new_figure(26 + 3.4 * sum(heights))
    axes = figure.subplots()
    _effect_lines(axes, view, found)
    raw = view.table[view.life[0]].to_numpy(dtype=float)
    life, good = _countable(raw)
    axes.axvline(10.0 ** np.log10(life[good]).mean(), color="0.4", linewidth=0.8, linestyle="--", zorder=0)
    axes.set_xscale("log")
    style.log_ticks(axes.xaxis, *axes.get_xlim())
    figure.supxlabel(style.with_unit(f"Geometric mean of the {words[0].lower()}{words[1:]}", unit), fontsize=7.5)
    missing, endless = int((~good).sum()), int(np.isposinf(raw).sum())
    note = f" {missing} of {len(life)} cases have no life and are left out." if missing else ""
    if endless:
        note += f" {endless} unlimited lives count as the longest finite one, {style.number(life[good].max())} {unit}."
    style.head(figure, "Main effect of each factor on life", f"Dashed: mean of all cases.{note}")
    style.finish(figure)
    caption = (
        f"Geometric mean of the life ({unit}) at each level of each factor, averaged over all other factors, "
        f"the most influential factor on top.{note}"
    )
    return figure, style.FigureInfo("main_effects", caption, _most_and_least(found))


def _effect_lines(axes: Axes, view: StudyView, found: list[Effect]) -> None:
    """A line a factor, one below the other, each level on a row of its own."""
    colours, ticks, names, place = style.palette(len(found)), [], [], 0.0
    for i, (factor, labels, means) in enumerate(found):
        axes.annotate(
            _heading(factor, labels),
            (0.0, place),
            xycoords=("axes fraction", "data"),
            xytext=(2, 0),
            textcoords="offset points",
            fontsize=7,
            fontweight="bold",
            va="center",
            clip_on=False,
        )
        spots = []
        for label in labels:
            place += 1 + 0.7 * label.count("\n") * 0.5
            spots.append(place)
            place += 0.7 * label.count("\n") * 0.5
        place += 1.6
        line = "-" if view.numeric(factor) else "none"  # nothing lies between two materials
        axes.plot(
            10.0**means,
            spots,
            color=colours[i % len(colours)],
            marker=style.MARKERS[i % 10],
            linewidth=1.0,
            linestyle=line,
        )
        ticks += spots
        names += labels
    axes.set_yticks(ticks, names)
    axes.set_ylim(place - 0.6, -1.0)


def _most_and_least(found: list[Effect]) -> str:
    """Which factor moves the mean life most, and which least."""
    swings = [10 ** float(np.nanmax(means) - np.nanmin(means)) for _, _, means in found]
    name = style.capital(style.long_name(found[0][0]))
    sentence = f"{name} moves the mean life most, by a factor of {style.rounded(swings[0], 3)}"
    if len(found) > 1:
        sentence += f"; {style.long_name(found[-1][0])} least, by a factor of {style.rounded(swings[-1], 3)}"
    return sentence + "."


def _heading(name: str, labels: list[str]) -> str:
    unit = PARAMETERS[name].unit if name in PARAMETERS else "-"
    told = name in ("guide_curve_radius", "motor_force") and not any(" … " in text for text in labels)
    bare = told or unit == "-"
    return (
        style.capital(style.long_name(name))
        if bare
        else f"{style.capital(style.long_name(name))} [{style.unit_text(unit)}]"
    )
