"""Which combinations of factors roll, slip fully or lift off."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Patch, Rectangle

from trackroller.parameters import REGIME_LABELS
from trackroller.report.figures import style
from trackroller.report.figures.maps import Pair, cell_name, set_ticks
from trackroller.report.findings import occurrence
from trackroller.report.groups import BINS, classes
from trackroller.report.numbers import capital, factor_label, long_name
from trackroller.report.view import StudyView

FEWEST = 5  # a sample with fewer cases outside the most frequent regime has no map


def regime_map(view: StudyView) -> style.Drawn:
    """Draw which combinations roll, slip or lift off, over the two factors that separate the regimes most.

    It answers: where may the roller not be used? Return None if all cases roll, or nearly all cases of a sample.
    """
    if "regime" not in view.table or len(view.factors) < 2:
        return None
    most = np.unique(view.regime, return_counts=True)[1].max()
    if len(view.table) - most < (1 if view.grid else FEWEST):
        return None
    ranked = sorted(view.factors, key=lambda f: -_spread(view, f))
    pair: Pair = (ranked[0], ranked[1])
    pair = pair if len(view.levels(pair[0])) >= len(view.levels(pair[1])) else (pair[1], pair[0])
    if not view.numeric(pair[0]):  # a factor with long names goes on the vertical axis, where its names have room
        pair = (pair[1], pair[0])
    figure = style.new_figure(76)
    axes = figure.subplots()
    note = _shares(axes, view, pair)
    axes.set_xlabel(factor_label(pair[0]))
    axes.set_ylabel(factor_label(pair[1]))
    axes.grid(False)
    style.head(figure, "Regimes: rolling, full slip, lift-off", note)
    said = [occurrence(view, view.regime == code, capital(REGIME_LABELS[code])) for code in (1, 2)]
    caption = f"Regime of the cases over {long_name(pair[0])} and {long_name(pair[1])}. {note}"
    return figure, style.FigureInfo("regime_map", caption.strip(), " ".join(s.text for s in said if s))


def _spread(view: StudyView, name: str) -> float:
    """Return how much the share of a regime changes over the levels of a factor; it decides which factor is drawn."""
    index, ends = classes(view, name, np.ones(len(view.table), dtype=bool), BINS)
    spread = 0.0
    for code in (1, 2, 3):
        shares = [float((view.regime[index == k] == code).mean()) for k in range(len(ends)) if (index == k).any()]
        spread = max(spread, max(shares) - min(shares))
    return spread


def _shares(axes: Axes, view: StudyView, pair: Pair) -> str:
    """Draw cells over both factors, each divided from left to right by the share of the regimes."""
    every = np.ones(len(view.table), dtype=bool)
    keys, ends = zip(*(classes(view, f, every, BINS) for f in pair), strict=True)
    texts = [[cell_name(f, end) for end in part] for f, part in zip(pair, ends, strict=True)]
    both = zip(style.REGIME_COLOURS, style.REGIME_HATCHES, strict=True)
    looks: list[dict[str, Any]] = [{"facecolor": colour, "hatch": hatch, "edgecolor": "0.25"} for colour, hatch in both]
    gaps = [0.04 if len(t) <= 12 else 0.0 for t in texts]
    width, thin = 1 - 2 * gaps[0], 0.3 if all(gaps) else 0.0
    for i, j in np.ndindex(len(texts[0]), len(texts[1])):
        here, left = view.regime[(keys[0] == i) & (keys[1] == j)], i + gaps[0]
        for code in range(4) if here.size else ():
            part = width * float((here == code).mean())
            if part > 0:
                axes.add_patch(Rectangle((left, j + gaps[1]), part, 1 - 2 * gaps[1], linewidth=thin, **looks[code]))
            left += part
    axes.set_xlim(0, len(texts[0]))
    axes.set_ylim(0, len(texts[1]))
    for axis, labels in ((axes.xaxis, texts[0]), (axes.yaxis, texts[1])):
        set_ticks(axis, labels)
    axes.tick_params(length=0)
    if sum(map(len, texts[0])) > 100:
        axes.tick_params(axis="x", rotation=35)
    handles = [Patch(label=REGIME_LABELS[c], **looks[c]) for c in range(4) if (view.regime == c).any()]
    axes.figure.legend(handles=handles, loc="outside lower left", ncols=4, handletextpad=0.5)
    others = len(view.factors) > 2
    return "Each cell is divided by the share of its cases in each regime, over all other factors." if others else ""
