"""The figure of the Pareto front of a study."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from trackroller.report.figures import style
from trackroller.report.figures.levels import coloured
from trackroller.report.figures.panels import Entries, legend
from trackroller.report.numbers import listing, long_name
from trackroller.report.tables.table import goal_heading
from trackroller.results.pareto import goals_of
from trackroller.results.ranking import ranked_factors
from trackroller.results.results import Results
from trackroller.roller.output_names import is_life
from trackroller.study.design.levels import OF_MATERIALS
from trackroller.study.file.goals import statistic

OTHER = "0.65"  # grey of the candidates without a level of their own
_WAYS = {"max": "up", "min": "down"}
_ARROWS = {"max": "→", "min": "←"}


def pareto_front(front: xr.Dataset, results: Results | None = None) -> style.Drawn:
    """Draw all allowed candidates, coloured by the factor that decides the first goal, and the
    Pareto set.

    It answers: what does more of one goal cost in another, and which choice leads to which end of
    the set? The panels show the first goal over each other one.

    Parameters
    ----------
    front : dataset of `trackroller.results.pareto.pareto`
    results : the study, for the validity and the deciding factor of the candidates

    Returns
    -------
    Figure and what it shows; None for fewer than two goals or candidates, or without a Pareto set.
    """
    goals = goals_of(front)
    if not (front["optimal"].values == 1).any() or min(front.sizes["row"], len(goals)) < 2:
        return None
    others = goals[1:4]
    kind = str(front.attrs.get("kind", "design"))
    figure, panels = style.panels(f"Pareto-optimal {kind}s", 78, len(others))
    colour, entries = _colours(front, results, goals[0][0])
    for axes, goal in zip(panels, others, strict=True):
        _trade(axes, front, goal, goals[0], colour, joined=len(goals) == 2)
    entries.append(
        (
            "Pareto set",
            {"marker": "D", "markerfacecolor": "white", "color": "0.1", "linestyle": "none"},
        )
    )
    legend(figure, entries)
    goals_words = listing(
        [f"{front[n].attrs.get('long_name') or long_name(n)} {_WAYS[w]}" for n, w in goals]
    )
    return figure, style.FigureInfo(
        "pareto-front", f"Pareto set for {goals_words} (arrows on the axes)."
    )


def _colours(front: xr.Dataset, results: Results | None, goal: str) -> tuple[np.ndarray, Entries]:
    """Return the colour of each row by the factor that decides the goal, and the entries of the
    legend.
    """
    rows = front["row"].values
    colour = np.full(len(rows), OTHER, dtype=object)
    entries: Entries = []
    if (
        results is not None
        and results.factors
        and front.attrs.get("kind", "design") != "design point"
    ):
        allowed = np.isin(np.arange(len(results.table)), rows)
        lead = next(iter(ranked_factors(results.analysis, goal, results.factors)))
        place = np.searchsorted(np.flatnonzero(allowed), rows)
        groups = coloured(results, lead, allowed)
        for (text, mask), own in zip(
            groups, style.colours([t for t, _ in groups], lead in OF_MATERIALS), strict=True
        ):
            colour[mask[place]] = own
            entries.append((text, {"marker": "o", "color": own, "linestyle": "none"}))
    if (colour == OTHER).any():
        entries.append(("other designs", {"marker": "o", "color": OTHER, "linestyle": "none"}))
    return colour, entries


def _trade(
    axes: Any,
    front: xr.Dataset,
    across: tuple[str, str],
    upwards: tuple[str, str],
    colour: np.ndarray,
    joined: bool,
) -> None:
    """Draw one goal over another; steps join the Pareto set of a study with two goals.

    The candidates are drawn in random order, so that in a dense cloud no level hides the others.
    """
    (x, up_x), (y, up_y) = across, upwards
    xs, ys = front[x].values.astype(float), front[y].values.astype(float)
    finite = np.isfinite(xs) & np.isfinite(ys)
    shown = (front["optimal"].values == 1) & finite
    others = np.random.default_rng(1).permutation(np.flatnonzero(finite & ~shown))
    size = 14
    if len(others) > 500:
        size = 6
    axes.scatter(
        xs[others],
        ys[others],
        s=size,
        c=colour[others].tolist(),
        alpha=0.6,
        linewidth=0,
        rasterized=True,
    )
    if joined:
        order = np.argsort(xs[shown])
        step = {"max": "steps-pre", "min": "steps-post"}[up_x]
        axes.plot(xs[shown][order], ys[shown][order], color="0.1", linewidth=0.8, drawstyle=step)
    axes.scatter(
        xs[shown], ys[shown], s=18, c=colour[shown].tolist(), marker="D", edgecolor="0.1", zorder=3
    )
    for name, axis, values in ((x, axes.xaxis, xs[finite]), (y, axes.yaxis, ys[finite])):
        if (
            values.size
            and is_life(statistic(name)[1])
            and values.min() > 0
            and values.max() > 20 * values.min()
        ):
            (axes.set_xscale if name == x else axes.set_yscale)("log")
            style.log_ticks(axis, values.min(), values.max())
    axes.set(
        xlabel=f"{goal_heading(front, x)} {_ARROWS[up_x]}",
        ylabel=f"{goal_heading(front, y)} {_ARROWS[up_y]}",
    )
