"""Which combinations of factors roll, slip fully or lift off."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.report.figures import style
from trackroller.report.figures.study_life import MAX_POINTS
from trackroller.report.figures.study_maps import MAX_CELLS, MAX_TICKS, tick_text
from trackroller.report.figures.study_view import StudyView

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def regime_spread(view: StudyView, name: str) -> float:
    """How much the share of each regime changes over the levels of a factor (0: not at all, 1: fully)."""
    table = view.table
    key = _binned(view, name)
    spread = 0.0
    for code in (1, 2, 3):
        hit = table["regime"] == code
        if hit.any():
            share = hit.groupby(key).mean()
            spread = max(spread, float(share.max() - share.min()))
    return spread


def _binned(view: StudyView, name: str, count: int = 8) -> np.ndarray:
    """Index of the level (or of the bin of a finely sampled number) of every case."""
    values, levels = view.table[name].to_numpy(), view.levels(name)
    if not view.numeric(name) or len(levels) <= 20:
        place = {v: i for i, v in enumerate(levels)}
        return np.array([place.get(v, -1) for v in values])
    edges = np.quantile(values, np.linspace(0, 1, count + 1))
    return np.clip(np.searchsorted(edges, values, side="right") - 1, 0, count - 1)


def regime_map(view: StudyView) -> tuple[Figure, style.FigureInfo] | None:
    """Which combinations roll, slip or lift off, over the two factors that decide it most."""
    if "regime" not in view.table or view.table["regime"].nunique() < 2 or not view.factors:
        return None
    ranked = sorted(view.factors, key=lambda f: -regime_spread(view, f))
    if len(ranked) < 2:
        return None
    pair = (ranked[0], ranked[1])
    points = not view.grid and all(view.numeric(f) and _columns(view, f) > MAX_CELLS for f in pair)
    if not points:
        pair = pair if _columns(view, pair[0]) >= _columns(view, pair[1]) else (pair[1], pair[0])
        if not view.numeric(pair[0]):  # long names stand beside the rows, not under the columns
            pair = (pair[1], pair[0])
    figure = style.new_figure(84)
    axes = figure.subplots()
    (_regime_points if points else _regime_shares)(axes, view, pair)
    axes.set_xlabel(style.factor_label(pair[0]))
    axes.set_ylabel(style.factor_label(pair[1]))
    axes.grid(False)
    others = len(view.factors) > 2 and not points
    note = "Each cell is divided by the share of its cases in each regime, over all other factors." if others else ""
    style.head(figure, "Regimes: rolling, full slip, lift-off", note)
    style.finish(figure)
    counts = view.table["regime"].value_counts()
    said = ", ".join(f"{int(counts.get(c, 0))} {style.REGIME_LABELS[c]}" for c in range(4) if counts.get(c, 0))
    sentence = f"Of {len(view.table)} cases: {said}; {_deciding(view, ranked)}."
    caption = f"Regime of the cases over {style.long_name(pair[0])} and {style.long_name(pair[1])}. {note}"
    return figure, style.FigureInfo("regime_map", caption.strip(), sentence)


def _deciding(view: StudyView, ranked: list[str]) -> str:
    """Which factors the regimes change with, in words."""
    spread = {f: regime_spread(view, f) for f in ranked[:3]}
    total = max(spread.values())
    names = [style.long_name(f) for f in ranked[:3] if spread[f] > 0.1 * total]
    if len(names) == 1:
        return f"{names[0]} alone decides"
    return f"{names[0]} decides most, then {' and '.join(names[1:])}"


def _columns(view: StudyView, name: str) -> int:
    return len(view.levels(name))


def _regime_shares(axes: Axes, view: StudyView, pair: tuple[str, str]) -> None:
    """Cells over both factors, each divided from left to right by the share of the regimes."""
    from matplotlib.patches import Patch, Rectangle

    keys = [_binned(view, f) for f in pair]
    texts = [_cell_names(view, f) for f in pair]
    regime = view.table["regime"].to_numpy()
    both = zip(style.REGIME_COLOURS, style.REGIME_HATCHES, strict=True)
    looks: list[dict[str, Any]] = [{"facecolor": colour, "hatch": hatch, "edgecolor": "0.25"} for colour, hatch in both]
    gaps = [0.04 if len(t) <= 12 else 0.0 for t in texts]
    width, thin = 1 - 2 * gaps[0], 0.3 if all(gaps) else 0.0
    for i in range(len(texts[0])):
        for j in range(len(texts[1])):
            here = regime[(keys[0] == i) & (keys[1] == j)]
            left = i + gaps[0]
            for code in range(4):
                share = float((here == code).mean()) if here.size else 0.0
                if share > 0:
                    cell = Rectangle((left, j + gaps[1]), width * share, 1 - 2 * gaps[1], linewidth=thin, **looks[code])
                    axes.add_patch(cell)
                left += width * share
    axes.set_xlim(0, len(texts[0]))
    axes.set_ylim(0, len(texts[1]))
    for axis, labels in ((axes.xaxis, texts[0]), (axes.yaxis, texts[1])):
        step = -(-len(labels) // MAX_TICKS)
        axis.set_ticks([i + 0.5 for i in range(0, len(labels), step)], labels[::step])
    axes.tick_params(length=0)
    if sum(map(len, texts[0])) > 42:
        axes.tick_params(axis="x", rotation=35)
    seen = [c for c in range(4) if (regime == c).any()]
    handles = [Patch(label=style.REGIME_LABELS[c], **looks[c]) for c in seen]
    axes.figure.legend(handles=handles, loc="outside lower left", ncols=4, handletextpad=0.5)


def _cell_names(view: StudyView, name: str) -> list[str]:
    levels = view.levels(name)
    if not view.numeric(name) or len(levels) <= 20:
        return [tick_text(name, v) for v in levels]
    edges = np.quantile(view.table[name], np.linspace(0, 1, 9))
    return [f"{a:.3g}…{b:.3g}" for a, b in pairwise(edges)]


def _regime_points(axes: Axes, view: StudyView, pair: tuple[str, str]) -> None:
    rows = view.table
    rows = rows if len(rows) <= MAX_POINTS else rows.sample(MAX_POINTS, random_state=0)
    for code, marker in enumerate("os^X"):
        part = rows[rows["regime"] == code]
        if len(part):
            axes.scatter(
                part[pair[0]],
                part[pair[1]],
                s=11,
                marker=marker,
                facecolor=style.REGIME_COLOURS[code],
                edgecolor="0.25",
                linewidth=0.5,
                label=style.REGIME_LABELS[code],
                rasterized=len(part) > 500,
            )
    axes.figure.legend(loc="outside lower left", ncols=4, handletextpad=0.2)
