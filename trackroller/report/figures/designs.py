"""The life of designs over their conditions."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from trackroller.analysis.designs import Designs
from trackroller.analysis.table import StudyView
from trackroller.report.figures import style
from trackroller.report.numbers import capital, count, listing, long_name
from trackroller.report.words.designs import alone, design_words

MOST = 20  # designs shown
LONGEST = 48  # letters of a name beside the axis; longer names are numbered


def lives_by_design(view: StudyView) -> style.Drawn:
    """Draw the worst life of roller and guide of each design, and the median and best life of the pair.

    It answers: which design keeps its life at its worst condition, and which of its two bodies ends it? For random
    conditions the life that nine of ten reach stands beside the worst one.
    """
    designs = Designs.of(view)
    if designs is None or not (designs.comparable and designs.rising and designs.conditions) or len(designs.size) < 2:
        return None
    table = designs.table[designs.table["valid"] > 0]
    table = table[np.isfinite(table["worst"])].head(MOST)
    if len(table) < 2:
        return None
    names = [capital(design_words(designs, row)) for _, row in table.iterrows()]
    numbered = max(map(len, names)) > LONGEST
    figure, (axes,) = style.panels("Life of the designs over their conditions", 30 + 5.0 * len(table))
    place = np.arange(len(table))[::-1]
    _draw(axes, designs, table, place)
    style.name_rows(axes, place, list(map(str, range(1, len(names) + 1))) if numbered else names)
    # whole marks in the first and the last line
    axes.set(ylim=(-0.6, len(table) - 0.4), xlabel=f"life [{designs.goal[2]}]", xscale="log")
    style.log_ticks(axes.xaxis, *axes.get_xlim())
    figure.legend(loc="outside lower center", ncols=5, columnspacing=1.0, handletextpad=0.4)
    caption = (
        "Designs in the order of the table of the best designs, over "
        f"{listing([long_name(n) for n in designs.conditions])}; {len(table)} of "
        f"{count(len(designs.size))} designs. Lives of the valid conditions. Hollow marks lie beyond the S-N data."
    )
    caption += f" {'; '.join(f'{i}: {name}' for i, name in enumerate(names, 1))}." if numbered else ""
    what = "its worst condition, among designs that are valid in as many"
    what = "nine of ten sampled conditions" if designs.drawn else what
    finding = f"{names[0]} lasts longest in {what}."
    if designs.drawn and not table["b10"].max() > 0:
        finding = "For each design one in ten or more of the sampled conditions are not valid."
    return figure, style.FigureInfo("designs", caption, finding)


def _draw(axes: Any, designs: Designs, table: pd.DataFrame, place: np.ndarray) -> None:
    """Draw a line from the worst to the best life of each design, with marks; hollow marks lie beyond the S-N data."""
    best = table["best"].replace(np.inf, np.nan).fillna(table["worst"])
    axes.hlines(place, table["worst"], best, color="0.75", linewidth=3, zorder=1, label="worst to best condition")
    axes.plot(table["median"], place, color="0.1", marker="|", markersize=7, linestyle="none", label="median")
    if designs.drawn:
        look: dict[str, Any] = {"color": "0.1", "marker": "D", "markersize": 3.5, "linestyle": "none"}
        axes.plot(table["b10"].where(table["b10"] > 0), place, label="nine of ten reach", **look)
    for body, marker, colour in (("roller", "o", style.PAIR[0]), ("guide", "s", style.PAIR[1])):
        if alone(designs) and body == "guide":
            continue
        lives, beyond = table[f"worst_{body}"].to_numpy(), table[f"worst_{body}_beyond"].to_numpy(dtype=bool)
        faces = np.where(beyond, "white", colour).tolist()
        look = {"marker": marker, "s": 26, "edgecolors": colour, "linewidths": 1.1, "zorder": 3}
        axes.scatter(lives, place, c=faces, label=f"worst of the {body}", **look)
