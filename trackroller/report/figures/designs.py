"""Figures of designs: their life over their conditions, and the Pareto front."""

from __future__ import annotations

import textwrap
from typing import Any

import numpy as np
import xarray as xr

from trackroller.report.figures import style
from trackroller.report.figures.panels import Entries, legend
from trackroller.report.numbers import as_given, capital, count, head_unit, listing, long_name
from trackroller.report.words.designs import body_words, design_words, ends_words
from trackroller.report.words.levels import coloured
from trackroller.report.words.pareto import goal_heading
from trackroller.results.candidates import UNRANKED, Candidates
from trackroller.results.pareto import goals_of
from trackroller.results.ranking import ranked_factors
from trackroller.results.results import Results
from trackroller.results.verdict import Verdict
from trackroller.roller.output_names import is_life
from trackroller.study.design.levels import OF_MATERIALS
from trackroller.study.file.goals import statistic

MOST = 10  # candidates drawn
WIDEST = 44  # letters of a line of a name beside the axis


def candidates_side_by_side(results: Results) -> style.Drawn:
    """Draw the life of each candidate, or its stress, over its conditions and over what nobody has measured.

    It answers: which candidate keeps its life at its worst condition, how sure is that, what ends it there, and does it
    reach the target? None for fewer than two candidates.
    """
    found = results.verdict
    ranked = None if found is None else found.ranked
    if ranked is None or len(ranked.candidates) < 2 or ranked.goal == UNRANKED:
        return None
    rising, unit = ranked.goal_rises, ranked.goal[2]
    listed = [one for one in ranked.candidates if np.isfinite(one.low) and one.low > 0 and one.judged][:MOST]
    if len(listed) < 2:
        return None
    candidates = Candidates.grouped(results, ranked.goal)
    names = [capital(design_words(candidates, one.choices)) for one in listed]
    figure, (axes,) = style.panels(f"{capital(ranked.goal[1])} of each candidate", 26 + 6.4 * len(listed))
    place = np.arange(len(listed))[::-1]
    ends = np.array([[one.low, one.high, one.median, one.best] for one in listed])
    spread, sure = _spread_words(ranked)
    _bars(axes, place, ends, spread, sure)
    required = ranked.required
    if np.isfinite(required):
        axes.axvline(required, color=style.PAIR[1], linewidth=1.1, label=f"target {as_given(required, unit)}")
    known = ends[np.isfinite(ends) & (ends > 0)]
    low, high = (float(end(np.append(known, required) if np.isfinite(required) else known)) for end in (np.min, np.max))
    if rising and high > 20 * low:
        axes.set_xscale("log")
        axes.set_xlim(low / 1.5, high * 1.5)
        style.log_ticks(axes.xaxis, *axes.get_xlim())
    style.name_rows(axes, place, [textwrap.fill(name, WIDEST) for name in names])
    for at, one in zip(place, listed, strict=True):
        text = f"{ends_words(one)}, {body_words(candidates, one)}" if rising and one.ends else ""
        axes.text(1.01, at, text, transform=axes.get_yaxis_transform(), va="center", fontsize=7)
    axes.set(ylim=(-0.6, len(listed) - 0.4), xlabel=f"{ranked.goal[1]} [{head_unit(unit)}]")
    figure.legend(loc="outside lower center", ncols=4, columnspacing=1.0, handletextpad=0.4)
    return figure, style.FigureInfo("designs", _caption(ranked, len(listed)))


def _spread_words(found: Verdict) -> tuple[str, str]:
    """Name the thin line from the worst to the best condition, and the thick one over the range of placeholders."""
    if found.sampled:
        return "sampled conditions", "range at nine of ten sampled conditions"
    return "worst to best condition", "range at the worst condition"


def _bars(axes: Any, place: np.ndarray, ends: np.ndarray, spread: str, sure: str) -> None:
    """Draw a thin line over the conditions, a thick one over the range at the worst one, and marks."""
    low, high, median, best = ends.T
    colour = style.PAIR[0]
    lasts = np.isfinite(best) & (best > 0)
    axes.hlines(place[lasts], low[lasts], best[lasts], color="0.7", linewidth=1.6, zorder=1, label=spread)
    ranged = np.isfinite(high) & (np.abs(high - low) > 1e-9 * np.abs(low))
    if ranged.any():
        axes.hlines(
            place[ranged], low[ranged], high[ranged], color=colour, linewidth=5, alpha=0.55, zorder=2, label=sure
        )
    shown = np.isfinite(median) & (median > 0)
    axes.plot(median[shown], place[shown], color="0.1", marker="|", markersize=8, linestyle="none", label="median")
    axes.plot(low, place, color=colour, marker="o", markersize=4.5, linestyle="none", zorder=3, label="what is sure")


def _caption(found: Verdict, shown: int) -> str:
    """Say what is drawn."""
    parts = []
    if shown < len(found.candidates):
        parts.append(f"{shown} of {count(len(found.candidates))} candidates.")
    if found.goal_rises:
        parts.append("Beside each candidate stands what ends it.")
    if found.out_of_reach is not None:
        parts.append("Conditions that no candidate meets are left out.")
    return " ".join(parts) or f"{capital(found.goal[1])} of all candidates."


OTHER = "0.65"  # grey of the designs without a level of their own
_WAYS = {"max": "up", "min": "down"}
_ARROWS = {"max": "→", "min": "←"}


def pareto_front(front: xr.Dataset, results: Results | None = None) -> style.Drawn:
    """Draw all allowed designs, coloured by the factor that decides the first goal, and the Pareto set.

    It answers: what does more of one goal cost in another, and which choice leads to which end of the set? The panels
    show the first goal over each other one.

    Parameters
    ----------
    front : dataset of `trackroller.results.pareto.pareto`
    results : the study, for the validity and the deciding factor of the designs

    Returns
    -------
    Figure and what it shows; None for fewer than two goals or designs, or without a Pareto set.
    """
    goals = goals_of(front)
    if not (front["optimal"].values == 1).any() or min(front.sizes["row"], len(goals)) < 2:
        return None
    others, kind = goals[1:4], str(front.attrs.get("kind", "design"))
    figure, panels = style.panels(f"Pareto-optimal {kind}s", 78, len(others))
    colour, entries = _colours(front, results, goals[0][0])
    for axes, goal in zip(panels, others, strict=True):
        _trade(axes, front, goal, goals[0], colour, joined=len(goals) == 2)
    entries.append(("Pareto set", {"marker": "D", "markerfacecolor": "white", "color": "0.1", "linestyle": "none"}))
    legend(figure, entries)
    wanted = listing([f"{front[n].attrs.get('long_name') or long_name(n)} {_WAYS[w]}" for n, w in goals])
    return figure, style.FigureInfo("pareto-front", f"Pareto set for {wanted} (arrows on the axes).")


def _colours(front: xr.Dataset, results: Results | None, goal: str) -> tuple[np.ndarray, Entries]:
    """Return the colour of each row by the factor that decides the goal, and the entries of the legend."""
    rows = front["row"].values
    colour = np.full(len(rows), OTHER, dtype=object)
    entries: Entries = []
    if results is not None and results.factors and front.attrs.get("kind", "design") != "design point":
        allowed = np.isin(np.arange(len(results.table)), rows)
        lead = next(iter(ranked_factors(results.analysis, goal, results.factors)))
        place = np.searchsorted(np.flatnonzero(allowed), rows)
        groups = coloured(results, lead, allowed)
        for (text, mask), own in zip(groups, style.colours([t for t, _ in groups], lead in OF_MATERIALS), strict=True):
            colour[mask[place]] = own
            entries.append((text, {"marker": "o", "color": own, "linestyle": "none"}))
    if (colour == OTHER).any():
        entries.append(("other designs", {"marker": "o", "color": OTHER, "linestyle": "none"}))
    return colour, entries


def _trade(
    axes: Any, front: xr.Dataset, across: tuple[str, str], upwards: tuple[str, str], colour: np.ndarray, joined: bool
) -> None:
    """Draw one goal over another; steps join the Pareto set of a study with two goals.

    The designs are drawn in random order, so that in a dense cloud no level hides the others.
    """
    (x, up_x), (y, up_y) = across, upwards
    xs, ys = front[x].values.astype(float), front[y].values.astype(float)
    finite = np.isfinite(xs) & np.isfinite(ys)
    shown = (front["optimal"].values == 1) & finite
    rest = np.random.default_rng(1).permutation(np.flatnonzero(finite & ~shown))
    size = 6 if len(rest) > 500 else 14
    axes.scatter(xs[rest], ys[rest], s=size, c=colour[rest].tolist(), alpha=0.6, linewidth=0, rasterized=True)
    if joined:
        order = np.argsort(xs[shown])
        step = {"max": "steps-pre", "min": "steps-post"}[up_x]
        axes.plot(xs[shown][order], ys[shown][order], color="0.1", linewidth=0.8, drawstyle=step)
    axes.scatter(xs[shown], ys[shown], s=18, c=colour[shown].tolist(), marker="D", edgecolor="0.1", zorder=3)
    for name, axis, values in ((x, axes.xaxis, xs[finite]), (y, axes.yaxis, ys[finite])):
        if values.size and is_life(statistic(name)[1]) and values.min() > 0 and values.max() > 20 * values.min():
            (axes.set_xscale if name == x else axes.set_yscale)("log")
            style.log_ticks(axis, values.min(), values.max())
    axes.set(xlabel=f"{goal_heading(front, x)} {_ARROWS[up_x]}", ylabel=f"{goal_heading(front, y)} {_ARROWS[up_y]}")
