"""Small multiples: life (or another output) against each factor with bands of percentiles."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.analysis.labels import factor_name
from trackroller.analysis.restore import design_of
from trackroller.report import sentences as words
from trackroller.report.figures import style
from trackroller.study.design.factors import Factor, label
from trackroller.study.outputs import Output, outputs

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

BINS = 9
LEVELS = (5.0, 25.0, 50.0, 75.0, 95.0)
WANTED = ("roller_life_hours", "roller_life_cycles", "guide_life_hours", "guide_life_cycles")


def bands(ds: xr.Dataset, output: str = "") -> tuple[Figure, style.FigureInfo] | None:
    """Median, quartiles and 5 to 95 % of an output along each factor, over all that the others do.

    Parameters
    ----------
    ds : gathered study
    output : name (see `trackroller.study.outputs`); default the first life there is, else the first output
    """
    design = design_of(ds)
    found = outputs(ds, design.factors, [output] if output else None)
    found = [o for o in found if np.isfinite(o.values).sum() >= 2]
    shown = next((o for name in WANTED for o in found if o.name == name), found[0] if found else None)
    if shown is None or not design.factors:
        return None
    from matplotlib.ticker import MaxNLocator

    columns = min(3, len(design.factors))
    rows = -(-len(design.factors) // columns)
    width = 170.0 if columns == 3 else style.COLUMN_MM
    figure = style.new_figure(20 + 42 * rows, width)
    said, first = [], None
    for i, (name, factor) in enumerate(design.factors.items()):
        axes = figure.add_subplot(rows, columns, i + 1, sharey=first)
        first = first or axes
        at, levels, table = percentiles(design.columns[name], factor, shown)
        _draw(axes, at, table, factor, levels)
        axes.set_xlabel(words.upper(style.factor_label(name)))
        if factor.ordered:
            axes.xaxis.set_major_locator(MaxNLocator(4))
        if i % columns:
            axes.tick_params(labelleft=False)
        words_of = words.band(factor_name(name), levels, table[2], shown.long_name, shown.units, factor.ordered)
        said.append((_change(table[2]), words_of))
    if first is not None and shown.scale == "log10":
        first.set_yscale("log")
        style.log_ticks(first.yaxis, *first.get_ylim())
    figure.supylabel(style.with_unit(words.upper(shown.long_name), shown.units), fontsize=7.5)
    style.head(
        figure,
        f"{words.upper(shown.long_name)} against each factor",
        "Line: median; dark band: middle half; light band: 5 to 95 % of the cases.",
    )
    style.finish(figure)
    said.sort(key=lambda pair: -pair[0])
    kept = f"{int(np.isfinite(shown.values).sum())} of {shown.values.size} cases"
    left = ", ".join(f"{n} {why}" for why, n in shown.excluded.items())
    caption = f"{words.upper(shown.long_name)} against each factor while all others vary over the study; {kept}" + (
        f", left out: {left}." if left else "."
    )
    sentence = words.upper("; ".join(text for _, text in said[:2])) + "."
    return figure, style.FigureInfo(f"bands-{shown.name}", caption, sentence)


def _change(median: np.ndarray) -> float:
    """Relative change along a factor, for choosing what to say first."""
    good = median[np.isfinite(median) & (median > 0)]
    return float(np.log(good.max() / good.min())) if good.size > 1 else 0.0


def percentiles(column: np.ndarray, factor: Factor, shown: Output) -> tuple[np.ndarray, list[str], np.ndarray]:
    """Percentiles of an output per level or bin of a factor.

    Returns places on the axis (m,), their labels, and values of shape (5, m) on the natural scale.
    """
    values = 10**shown.values if shown.scale == "log10" else shown.values
    if factor.discrete and len(factor.levels) > 15 and factor.ordered:
        found: list = []
    else:  # a Morris design shows few values of a continuous factor
        found = list(factor.levels) if factor.discrete else np.unique(column.astype(float)).tolist()
    if 0 < len(found) <= 15 or not factor.ordered:
        order = sorted(found) if factor.ordered else found
        if factor.ordered:
            masks = [column.astype(float) == level for level in order]
        else:
            masks = [np.array([value == level for value in column]) for level in order]
        at = np.array(order, dtype=float) if factor.ordered else np.arange(len(order), dtype=float)
        labels = [_level(factor.name, level) if factor.discrete else words.number(level) for level in order]
    else:
        edges = np.unique(np.quantile(column.astype(float), np.linspace(0, 1, BINS + 1)))
        index = np.clip(np.searchsorted(edges, column.astype(float), side="right") - 1, 0, len(edges) - 2)
        masks = [index == b for b in range(len(edges) - 1)]
        at = np.array([np.median(column[m].astype(float)) if m.any() else np.nan for m in masks])
        labels = [words.number(float(a)) for a in at]
    table = np.full((len(LEVELS), len(at)), np.nan)
    for b, mask in enumerate(masks):
        inside = values[mask & np.isfinite(values)]
        if inside.size:
            table[:, b] = np.percentile(inside, LEVELS)
    return at, labels, table


def _level(name: str, level: Any) -> str:
    return style.level_text(name, level if isinstance(level, (int, float)) else label(level))


def _draw(axes, at: np.ndarray, table: np.ndarray, factor: Factor, labels: list[str]) -> None:  # type: ignore[no-untyped-def]
    colour = style.palette(1)[0]
    if factor.ordered:
        axes.fill_between(at, table[0], table[4], color=colour, alpha=0.18, linewidth=0)
        axes.fill_between(at, table[1], table[3], color=colour, alpha=0.38, linewidth=0)
        axes.plot(at, table[2], color="0.1", marker="o", markersize=2.5)
        return
    axes.vlines(at, table[0], table[4], color=colour, alpha=0.35, linewidth=6)
    axes.vlines(at, table[1], table[3], color=colour, alpha=0.9, linewidth=6)
    axes.plot(at, table[2], color="0.1", marker="_", markersize=9, markeredgewidth=1.5, linestyle="none")
    whole = [text.replace(" mm", "\u00a0mm").replace(" N", "\u00a0N") for text in style.short_levels(labels)]
    shown = [textwrap.fill(text, 17) for text in whole]
    wide = max(len(line) for text in shown for line in text.split("\n")) * len(at)
    if wide <= 27:
        axes.set_xticks(at, shown)
    elif len(at) <= 3:
        axes.set_xticks(at, shown, rotation=35, ha="right", rotation_mode="anchor", linespacing=0.95)
    else:  # lines of slanted names would run into each other
        axes.set_xticks(at, shown, rotation=90, fontsize=6.2, linespacing=0.95)
    axes.set_xlim(-0.6, len(at) - 0.4)
