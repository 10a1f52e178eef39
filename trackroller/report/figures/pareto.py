"""Figures for decisions: the Pareto front, and the scatter of life at the design points of an inner/outer design."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from trackroller.analysis.ranking import ranked_factors
from trackroller.analysis.table import StudyView
from trackroller.parameters import REGIME_LABELS, ROLE_OF
from trackroller.report.figures import style
from trackroller.report.numbers import capital, listing, long_name, plain, with_unit
from trackroller.report.tables.targets import MAX_POINTS
from trackroller.report.words.design_points import best_point, point_words
from trackroller.report.words.levels import coloured
from trackroller.report.words.pareto import goal_heading, goals_of, pareto_sentence
from trackroller.study.design.entries import OPTION_FACTORS

_WAYS = {"max": "up", "min": "down"}


def _given(front: xr.Dataset) -> str:
    """Warn where conditions of use are among the factors: a designer cannot choose their best value."""
    names = front.attrs["factors"].split(", ")
    given = [plain(n) for n in names if ROLE_OF.get(n) == "condition" or "load" in n or "drive" in n]
    told = f" Factors that the use sets and a designer cannot choose: {listing(given)}." if given else ""
    models = [long_name(n) for n in names if n in OPTION_FACTORS]
    return told + (f" An option of the calculation, not of the design: {listing(models)}." if models else "")


def pareto_front(front: xr.Dataset, view: StudyView | None = None) -> style.Drawn:
    """Draw all allowed designs, coloured by the factor that decides the first goal, and the Pareto set.

    It answers: what does more of one goal cost in another, and which choice leads to which end of the set? The panels
    show the first goal over each other one.

    Parameters
    ----------
    front : dataset of `trackroller.analysis.pareto.pareto`
    view : the study, for the validity and the deciding factor of the designs
    """
    goals = goals_of(front)
    if not (front["optimal"].values == 1).any() or front.sizes["row"] < 2:
        return None
    others = goals[1:4]
    figure = style.new_figure(78)
    panels = figure.subplots(1, len(others), squeeze=False)[0]
    for axes, goal in zip(panels, others, strict=True):
        _trade(axes, front, goal, goals[0], _groups(front, view, goals[0][0]), joined=len(goals) == 2)
    handles, texts = panels[0].get_legend_handles_labels()
    figure.legend(handles, texts, loc="outside lower left", ncols=3, markerscale=1.5, alignment="left")
    kind = str(front.attrs.get("kind", "design"))
    style.head(figure, f"Pareto-optimal {kind}s", "Arrows on the axes: the wanted direction.")
    wanted = listing([f"{front[n].attrs.get('long_name') or long_name(n)} {_WAYS[w]}" for n, w in goals])
    caption = f"Pareto set for {wanted}.{_given(front)}"
    return figure, style.FigureInfo("pareto-front", caption, pareto_sentence(front, view).text)


def _groups(front: xr.Dataset, view: StudyView | None, goal: str) -> list[tuple[str, np.ndarray]]:
    """Return the rows of the front by the factor that decides the goal; without one all stand together."""
    if view is None or not view.factors or front.attrs.get("kind", "design") == "design point":
        return []
    allowed, rows = np.zeros(len(view.table), dtype=bool), front["row"].values
    allowed[rows] = True
    lead = next(iter(ranked_factors(view.analysis, goal, view.factors)))
    place = np.searchsorted(np.flatnonzero(allowed), rows)
    return [(text, mask[place]) for text, mask in coloured(view, lead, allowed)]


def _trade(
    axes: Any,
    front: xr.Dataset,
    across: tuple[str, str],
    upwards: tuple[str, str],
    groups: list[tuple[str, np.ndarray]],
    joined: bool,
) -> None:
    """Draw one goal over another; steps join the Pareto set of a study with two goals."""
    (x, up_x), (y, up_y) = across, upwards
    best = front["optimal"].values == 1
    xs, ys = front[x].values.astype(float), front[y].values.astype(float)
    finite = np.isfinite(xs) & np.isfinite(ys)
    rest, shown = ~best & finite, best & finite
    other = rest & ~np.any([mask for _, mask in groups], axis=0) if groups else rest
    if other.any():
        axes.scatter(
            xs[other],
            ys[other],
            s=5,
            color="0.65",
            marker=".",
            rasterized=True,
            label=f"other {front.attrs.get('kind', 'design')}s",
        )
    for (text, mask), colour, marker in zip(groups, style.palette(len(groups)), style.MARKERS, strict=False):
        look = {"s": 6, "color": colour, "marker": marker, "alpha": 0.6, "linewidth": 0}
        axes.scatter(xs[rest & mask], ys[rest & mask], rasterized=True, label=text, **look)
    if joined:
        order = np.argsort(xs[shown])
        step = {"max": "steps-pre", "min": "steps-post"}[up_x]
        axes.plot(xs[shown][order], ys[shown][order], color="0.1", linewidth=0.8, drawstyle=step)
    look = {"marker": "D", "edgecolor": "0.1", "linewidth": 0.9, "zorder": 3, "label": "Pareto set"}
    axes.scatter(xs[shown], ys[shown], s=18, facecolor="white", **look)
    for name, set_scale, values in ((x, axes.set_xscale, xs[finite]), (y, axes.set_yscale, ys[finite])):
        if values.size and "life" in name and values.min() > 0 and values.max() > 20 * values.min():
            set_scale("log")
            style.log_ticks(axes.xaxis if name == x else axes.yaxis, values.min(), values.max())
    axes.set_xlabel(goal_heading(front, x) + (" →" if up_x == "max" else " ←"))
    axes.set_ylabel(goal_heading(front, y) + (" →" if up_y == "max" else " ←"))


def robust_points(table: xr.Dataset, output: str) -> style.Drawn:
    """Draw the spread of life and B10 of each design point, and how often it slips or lifts off.

    It answers: which design point keeps its life when conditions scatter, and which may slip?

    Parameters
    ----------
    table : dataset of `trackroller.analysis.robustness.robustness`
    output : a life

    Notes
    -----
    Where B10 holds the scatter of the material, percentiles without this scatter are not drawn beside it.
    """
    part = table.sel(output=output)
    if not np.isfinite(part["percentile_value"].values).any():
        return None
    rank = np.argsort(-np.nan_to_num(part["b10"].values, nan=-1.0))[:MAX_POINTS]
    figure = style.new_figure(30 + 5.0 * len(rank))
    left, right = figure.subplots(1, 2, sharey=True, width_ratios=(2.4, 1))
    place = np.arange(len(rank))[::-1]
    own = float(table.attrs.get("log_life_scatter", 0.0)) > 0
    _spread(left, part, rank, place, own)
    left.set_yticks(place, [capital(point_words(table, int(p))) for p in rank])
    name = str(part["output_name"].item())
    left.set_xlabel(with_unit(capital(name), str(part["output_units"].item())))
    _shares(right, table, rank, place)
    for axes in (left, right):
        axes.grid(axis="y", visible=False)
        axes.tick_params(axis="y", length=0)
    figure.legend(loc="outside lower center", ncols=6, columnspacing=1.0, handletextpad=0.4)
    style.head(figure, f"{capital(name)} where conditions scatter")
    inner = listing([long_name(n) for n in table.attrs["inner_factors"].split(", ")])
    caption = (
        f"Design points by falling B10, each with the same {table.attrs['inner_samples']} samples of {inner}. "
        "Whiskers: 95 % intervals. Lives of the rolling cases; the share of the others on the right."
        + (" B10 holds the material's own scatter of life as well." if own else "")
    )
    return figure, style.FigureInfo(f"robustness-{output}", caption, best_point(table, output).text)


def _spread(axes: Any, part: xr.Dataset, rank: np.ndarray, place: np.ndarray, own: bool) -> None:
    """Draw B10 with its interval and, where both describe the same distribution, the percentiles of life."""
    colours = style.palette(4)
    if not own:
        low, middle, high = (part["percentile_value"].sel(percentile=p).values[rank] for p in (5.0, 50.0, 95.0))
        axes.hlines(place, low, high, color=colours[0], alpha=0.35, linewidth=5, label="5 to 95 %")
        axes.plot(middle, place, color="0.1", marker="|", markersize=7, linestyle="none", label="median")
    b10, ends = part["b10"].values[rank], [part[f"b10_{end}"].values[rank] for end in ("low", "high")]
    look = {"marker": "D", "markersize": 3.5, "linestyle": "none", "markeredgecolor": "0.1", "markeredgewidth": 0.4}
    error = np.abs(np.stack(ends) - b10)
    axes.errorbar(b10, place, xerr=error, color=colours[3], capsize=1.5, elinewidth=0.8, label="B10", **look)
    axes.set_xscale("log")
    style.log_ticks(axes.xaxis, *axes.get_xlim())


def _shares(axes: Any, table: xr.Dataset, rank: np.ndarray, place: np.ndarray) -> None:
    """Draw the shares of the cases that do not roll at each design point."""
    start = np.zeros(len(rank))
    for i, regime in ((1, "full_slip"), (2, "lift_off"), (3, "failed")):
        share = 100 * table["probability"].sel(regime=regime).values[rank]
        if share.any():
            look = {"color": style.REGIME_COLOURS[i], "hatch": style.REGIME_HATCHES[i], "edgecolor": "0.15"}
            axes.barh(place, share, 0.62, left=start, linewidth=0.5, label=REGIME_LABELS[i], **look)
            start = start + share
    axes.set_xlabel("share of cases [%]")
    axes.set_xlim(0, max(5.0, 1.1 * float(start.max())))
