"""Life, or peak stress where a study has no life, against every factor; coloured by the deciding factor."""

from __future__ import annotations

import itertools

import numpy as np
from matplotlib.axes import Axes

from trackroller.report.figures import style
from trackroller.report.figures.panels import band, capped, legend, mark_unlimited, quantiles, set_axis
from trackroller.report.numbers import capital, factor_label, long_name, with_unit
from trackroller.report.words.levels import coloured
from trackroller.results.findings import shown_output
from trackroller.results.groups import Groups, classes, groups
from trackroller.results.ranking import ranked_factors
from trackroller.results.results import Results
from trackroller.roller.output_names import is_life
from trackroller.study.design.levels import OF_MATERIALS

MAX_PANELS = 9
BINS = 6
Series = list[tuple[str, np.ndarray]]
PANEL_LETTERS = 33  # letters of 7 pt under the axis of a panel
MATTERS = 0.1  # of the largest index: a category with a larger one is never pooled
FEWEST = 3  # a median is drawn from at least this number of rows


def by_factor(results: Results) -> style.Drawn:
    """Draw the median and quartiles of an output along each factor, a colour a level of the deciding factor.

    It answers: which way and how far does each factor move the life, and is that so for every material?

    Returns
    -------
    Figure and what it shows; None for a study without factors, valid cases, or life and peak stress.
    """
    shown = shown_output(results)
    if shown is None or not results.factors:
        return None
    column, words, unit = shown
    rows = results.of_one_model(results.valid & ~np.isnan(results.column(column)))
    if rows.sum() < 2:
        return None
    lead = _lead(results, column)
    values, top = capped(results.column(column)[rows]) if is_life(column) else (results.column(column)[rows], None)
    drawable = (name for name in results.factors if _drawable(results, name, rows, np.ones(rows.sum(), bool)))
    names = [*itertools.islice(drawable, MAX_PANELS)]
    if not names:
        return None
    columns = min(3, len(names))
    lines = -(-len(names) // columns)
    figure, levels = style.new_figure(26 + 50 * lines), coloured(results, lead, rows)
    colours = style.colours([text for text, _ in levels], lead in OF_MATERIALS)
    series = {name: _series(results, name, rows, levels, lead) for name in names}
    panels = figure.subplots(lines, columns, sharey=True, squeeze=False).ravel()
    for axes in panels[len(names) :]:
        axes.remove()
    for axes, name in zip(panels, names, strict=False):
        _panel(axes, groups(results.table, name, rows, BINS), values, series[name], colours)
        mark_unlimited(axes, top)
    if is_life(column):
        panels[0].set_yscale("log")
        style.log_ticks(panels[0].yaxis, *panels[0].get_ylim())
    figure.supylabel(with_unit(capital(words), unit), fontsize=7.5)
    apart = any(len(drawn) > 1 for drawn in series.values())
    if apart:
        looks = [{"color": c, "marker": m} for c, m in zip(colours, style.MARKERS, strict=False)]
        legend(figure, [(text, look) for (text, _), look in zip(levels, looks, strict=True)])
    own = f" of {results.held_level('contact_model')}" if "contact_model" in results.factors else ""
    caption = (
        f"{capital(words)} of valid cases{own} along the factors, all other factors as they vary. "
        f"Lines: medians{' of each colour' * apart}; bands: the middle half of the cases."
    )
    return figure, style.FigureInfo(f"bands-{column}", caption)


def _enough(index: np.ndarray) -> np.ndarray:
    """Say which classes have enough rows for a median."""
    return np.asarray(np.bincount(index) >= FEWEST)


def _lead(results: Results, column: str) -> str:
    """Return the factor to colour by: the deciding factor, or a category whose levels must not be pooled."""
    size = ranked_factors(results.analysis, column, results.factors)
    lead = next(iter(size))
    category = next((name for name in size if name in results.categories), lead)
    return category if results.ordered(lead) and size[category] >= MATTERS * size[lead] else lead


def _series(results: Results, name: str, rows: np.ndarray, levels: Series, lead: str) -> Series:
    """Return the groups that get a line each; a deciding number and a factor with too few rows have one line."""
    whole = [("", np.ones(rows.sum(), bool))]
    if name == lead:
        return whole if results.ordered(name) or len(levels) < len(results.levels(name)) else levels
    return levels if any(_drawable(results, name, rows, chosen) for _, chosen in levels) else whole


def _drawable(results: Results, name: str, rows: np.ndarray, chosen: np.ndarray) -> bool:
    """Say whether at least two classes of a factor have enough rows for a median."""
    return bool(_enough(classes(results.table, name, rows, BINS)[0][chosen]).sum() > 1)


def _panel(axes: Axes, along: Groups, values: np.ndarray, series: Series, colours: list[str]) -> None:
    """Draw one factor: one line for each group where the factor has an order, otherwise marks with bars."""
    apart = len(series) > 1 and all(np.ptp(along.index[chosen]) == 0 for _, chosen in series)  # colours name the levels
    for g, ((_, chosen), colour) in enumerate(zip(series, colours if len(series) > 1 else ["0.2"], strict=True)):
        shift = 0.0 if along.ordered or apart else 0.12 * (g - (len(series) - 1) / 2)
        drawn = quantiles(values[chosen], along.index[chosen], len(along), (25, 50, 75), FEWEST)
        band(axes, along.at + shift, drawn, {"color": colour, "marker": style.MARKERS[g % 10]}, along.ordered)
    axes.set_xlabel(factor_label(along.name) if along.ordered else capital(long_name(along.name)))
    set_axis(axes, along, PANEL_LETTERS, named=not apart)
