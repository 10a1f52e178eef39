"""Life (else peak stress) against every factor, coloured by the factor that decides."""

from __future__ import annotations

import textwrap
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from trackroller.report.claims import classes, leading_factor
from trackroller.report.effects import effect_of
from trackroller.report.figures import style
from trackroller.report.figures.panels import capped, legend, mark_unlimited
from trackroller.report.numbers import (
    SPOKEN,
    capital,
    factor_label,
    level_text,
    long_name,
    number,
    short_levels,
    with_unit,
)
from trackroller.report.view import StudyView

MAX_PANELS = 9
COLOURS = 5  # as many levels of the deciding factor are told apart
BINS = 6
FEWEST = 3  # a median is drawn from at least this number of rows


def by_factor(view: StudyView) -> tuple[Figure, style.FigureInfo] | None:
    """Draw the median and quartiles of an output along each factor, a colour a level of the deciding factor.

    Returns
    -------
    Figure and what it shows; None for a study without factors, valid cases, or life and peak stress.
    """
    shown = shown_output(view)
    if shown is None or not view.factors:
        return None
    column, words, unit = shown
    rows = view.valid & ~np.isnan(view.column(column))
    if rows.sum() < 2:
        return None
    lead = leading_factor(view, column, rows) or view.factors[0]
    values, top = capped(view.column(column)[rows]) if "life" in words else (view.column(column)[rows], None)
    names = list(view.factors[:MAX_PANELS])
    columns = min(3, len(names))
    figure = style.new_figure(26 + 50 * -(-len(names) // columns), style.WIDE_MM)
    first, groups = None, _groups(view, lead, rows)
    for i, name in enumerate(names):
        axes = figure.add_subplot(-(-len(names) // columns), columns, i + 1, sharey=first)
        first = first or axes
        _panel(axes, view, name, rows, values, [("", np.ones(rows.sum(), bool))] if name == lead else groups)
        axes.tick_params(labelleft=i % columns == 0)
        mark_unlimited(axes, top)
    if first is not None and "life" in words:
        first.set_yscale("log")
        style.log_ticks(first.yaxis, *first.get_ylim())
    figure.supylabel(with_unit(capital(words), unit), fontsize=7.5)
    if len(names) > 1:
        looks = [{"color": c, "marker": m} for c, m in zip(style.palette(len(groups)), style.MARKERS, strict=False)]
        legend(figure, [(text, look) for (text, _), look in zip(groups, looks, strict=True)])
    told = f"Lines: medians for each level of {long_name(lead)}; bands: the middle half of the valid designs."
    style.head(figure, f"{capital(words)} against each factor", told)
    style.finish(figure)
    caption = f"{capital(words)} of the {rows.sum():,} valid designs along each factor, all others as they vary. {told}"
    return figure, style.FigureInfo(f"bands-{column}", caption, _sentence(view, column, words, rows))


def shown_output(view: StudyView) -> tuple[str, str, str] | None:
    """Return column, words and unit of the life of a study, else of its peak stress, or None."""
    if view.life:
        return view.life
    stresses = [(f"peak_stress_{b}", f"peak stress of the {b}", "MPa") for b in ("roller", "guide")]
    return next((s for s in stresses if view.has(s[0])), None)


def _groups(view: StudyView, lead: str, rows: np.ndarray) -> list[tuple[str, np.ndarray]]:
    """Name and rows of each level (or third) of the deciding factor."""
    index, ends = classes(view, lead, rows, 3)
    present = [k for k in range(len(ends)) if (index == k).any()]
    if len(present) > COLOURS:  # a number of many levels: lowest, highest and between
        chosen = np.unique(np.linspace(0, len(present) - 1, COLOURS).round().astype(int))
        present = [present[k] for k in chosen]
    return [(_class_words(lead, ends[k]), index == k) for k in present]


def _class_words(name: str, end: Any) -> str:
    if isinstance(end, tuple):
        return f"{long_name(name)} {number(float(f'{end[0]:.3g}'))} to {level_text(name, float(f'{end[1]:.3g}'))}"
    return (
        level_text(name, end)
        if name in SPOKEN or isinstance(end, str)
        else f"{long_name(name)} {level_text(name, end)}"
    )


def _panel(
    axes: Axes, view: StudyView, name: str, rows: np.ndarray, values: np.ndarray, groups: list[tuple[str, np.ndarray]]
) -> None:
    """Draw one factor: a line a group where the factor has an order, else marks with bars."""
    index, ends = classes(view, name, rows, BINS)
    ordered, own = view.ordered(name), view.table[name].to_numpy()[rows]
    at = (
        np.array([np.median(own[index == k]) if (index == k).any() else np.nan for k in range(len(ends))])
        if ordered
        else np.arange(len(ends), dtype=float)
    )
    colours = style.palette(len(groups)) if len(groups) > 1 else ["0.2"]
    for g, ((_, chosen), colour) in enumerate(zip(groups, colours, strict=True)):
        low, middle, high = _quartiles(values, index, chosen, len(ends))
        shift = 0.0 if ordered else 0.12 * (g - (len(groups) - 1) / 2)
        look = {"color": colour, "marker": style.MARKERS[g % 10], "markersize": 3}
        if ordered:
            axes.fill_between(at, low, high, color=colour, alpha=0.18, linewidth=0)
        else:
            axes.vlines(at + shift, low, high, color=colour, alpha=0.35, linewidth=4)
        axes.plot(at + shift, middle, linestyle="-" if ordered else "none", **look)
    axes.set_xlabel(factor_label(name) if ordered else capital(long_name(name)))
    if ordered:
        axes.xaxis.set_major_locator(MaxNLocator(5))
        return
    texts = [
        textwrap.fill(t, 18)
        for t in short_levels([_class_words(name, e) if isinstance(e, tuple) else level_text(name, e) for e in ends])
    ]
    axes.set_xticks(at, texts, rotation=0 if len(texts) <= 3 and max(map(len, texts)) < 14 else 35, fontsize=6.2)
    for label in axes.get_xticklabels():
        label.set(ha="right" if label.get_rotation() else "center", rotation_mode="anchor")
    axes.set_xlim(-0.6, len(at) - 0.4)


def _quartiles(values: np.ndarray, index: np.ndarray, chosen: np.ndarray, count: int) -> np.ndarray:
    """Lower quartile, median and upper quartile in each class, (3, count); NaN for fewer than three rows."""
    found = np.full((3, count), np.nan)
    for k in range(count):
        own = values[chosen & (index == k)]
        own = own[~np.isnan(own)]
        if own.size >= FEWEST:
            found[:, k] = np.percentile(own, (25, 50, 75), method="nearest")
    return found


def _sentence(view: StudyView, column: str, words: str, rows: np.ndarray) -> str:
    """State the two largest effects that have one direction."""
    found = [s for f in view.factors if (s := effect_of(view, column, words, f, rows)) is not None]
    clear = [s for s in found if s.kind in ("pairs", "classes")] or found
    clear.sort(key=lambda s: -abs(np.log(s.values["ratio"])))
    return " ".join(s.text for s in clear[:2])
