"""Figures of designs: their life over their conditions, and the Pareto front."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from trackroller.parameters import ROLE_OF
from trackroller.report.figures import style
from trackroller.report.figures.panels import Entries, legend
from trackroller.report.numbers import capital, count, listing, long_name, plain, quantity, rounded
from trackroller.report.words.designs import alone, design_words
from trackroller.report.words.levels import coloured
from trackroller.report.words.pareto import goal_heading, pareto_sentence
from trackroller.results.candidates import Candidates
from trackroller.results.pareto import goals_of
from trackroller.results.ranking import ranked_factors
from trackroller.results.results import Results
from trackroller.study.design.entries import OPTION_FACTORS
from trackroller.study.design.levels import OF_MATERIALS

MOST = 20  # designs shown
LONGEST = 48  # letters of a name beside the axis; longer names are numbered


def lives_by_design(results: Results) -> style.Drawn:
    """Draw the worst life of roller and guide of each design, and the median and best life of the pair.

    It answers: which design keeps its life at its worst condition, and which of its two bodies ends it? For random
    conditions the life that nine of ten reach stands beside the worst one.
    """
    candidates = results.candidates()
    if (
        candidates is None
        or not (candidates.comparable and candidates.rising and candidates.conditions)
        or len(candidates.size) < 2
    ):
        return None
    table = candidates.table[candidates.table["valid"] > 0]
    table = table[np.isfinite(table["worst"])].head(MOST)
    if len(table) < 2:
        return None
    names = [capital(design_words(candidates, row)) for _, row in table.iterrows()]
    numbered = max(map(len, names)) > LONGEST
    figure, (axes,) = style.panels("Life of the designs over their conditions", 30 + 5.0 * len(table))
    place = np.arange(len(table))[::-1]
    _draw(axes, candidates, table, place)
    style.name_rows(axes, place, list(map(str, range(1, len(names) + 1))) if numbered else names)
    # whole marks in the first and the last line
    axes.set(ylim=(-0.6, len(table) - 0.4), xlabel=f"life [{candidates.goal[2]}]", xscale="log")
    style.log_ticks(axes.xaxis, *axes.get_xlim())
    figure.legend(loc="outside lower center", ncols=5, columnspacing=1.0, handletextpad=0.4)
    caption = (
        "Designs in the order of the table of the best designs, over "
        f"{listing([long_name(n) for n in candidates.conditions])}; {len(table)} of "
        f"{count(len(candidates.size))} designs. Lives of the valid conditions. Hollow marks lie beyond the S-N data."
    )
    caption += f" {'; '.join(f'{i}: {name}' for i, name in enumerate(names, 1))}." if numbered else ""
    ends = rounded(table["worst"].min()), quantity(table["worst"].max(), candidates.goal[2])
    finding = f"The lives of these designs at the worst of their valid conditions lie between {ends[0]} and {ends[1]}."
    if candidates.drawn and not table["b10"].max() > 0:
        finding = "For each design one in ten or more of the sampled conditions are not valid."
    return figure, style.FigureInfo("designs", caption, finding)


def _draw(axes: Any, candidates: Candidates, table: pd.DataFrame, place: np.ndarray) -> None:
    """Draw a line from the worst to the best life of each design, with marks; hollow marks lie beyond the S-N data."""
    best = table["best"].replace(np.inf, np.nan).fillna(table["worst"])
    axes.hlines(place, table["worst"], best, color="0.75", linewidth=3, zorder=1, label="worst to best condition")
    axes.plot(table["median"], place, color="0.1", marker="|", markersize=7, linestyle="none", label="median")
    if candidates.drawn:
        look: dict[str, Any] = {"color": "0.1", "marker": "D", "markersize": 3.5, "linestyle": "none"}
        axes.plot(table["b10"].where(table["b10"] > 0), place, label="nine of ten reach", **look)
    for body, marker, colour in (("roller", "o", style.PAIR[0]), ("guide", "s", style.PAIR[1])):
        if alone(candidates) and body == "guide":
            continue
        lives, beyond = table[f"worst_{body}"].to_numpy(), table[f"worst_{body}_beyond"].to_numpy(dtype=bool)
        faces = np.where(beyond, "white", colour).tolist()
        look = {"marker": marker, "s": 26, "edgecolors": colour, "linewidths": 1.1, "zorder": 3}
        axes.scatter(lives, place, c=faces, label=f"worst of the {body}", **look)


OTHER = "0.65"  # grey of the designs without a level of their own
_WAYS = {"max": "up", "min": "down"}
_ARROWS = {"max": "→", "min": "←"}


def _given(front: xr.Dataset) -> str:
    """Warn where conditions of use are among the factors: a designer cannot choose their best value."""
    names = front.attrs["factors"].split(", ")
    given = [plain(n) for n in names if ROLE_OF.get(n) == "condition" or "load" in n or "drive" in n]
    warning = f" Factors that the use sets and a designer cannot choose: {listing(given)}." if given else ""
    models = [long_name(n) for n in names if n in OPTION_FACTORS]
    return warning + (f" An option of the calculation, not of the design: {listing(models)}." if models else "")


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
    caption = f"Pareto set for {wanted} (arrows on the axes).{_given(front)}"
    return figure, style.FigureInfo("pareto-front", caption, pareto_sentence(front, results).text)


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
        if values.size and "life" in name and values.min() > 0 and values.max() > 20 * values.min():
            (axes.set_xscale if name == x else axes.set_yscale)("log")
            style.log_ticks(axis, values.min(), values.max())
    axes.set(xlabel=f"{goal_heading(front, x)} {_ARROWS[up_x]}", ylabel=f"{goal_heading(front, y)} {_ARROWS[up_y]}")
