"""Maps over two factors: life with the regimes shaded, and the regimes themselves."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.parameters import PARAMETERS
from trackroller.plots import style
from trackroller.plots.study_life import MAX_POINTS, effects
from trackroller.plots.study_view import StudyView

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MAX_TICKS = 9


def life_map(view: StudyView) -> tuple[Figure, style.FigureInfo] | None:
    """Life over the two numeric factors that tell most, with full slip and lift-off hatched and labelled."""
    if view.life is None or not view.has(view.life[0]):
        return None
    pair = _life_pair(view)
    if pair is None:
        return None
    column, words, unit = view.life
    rows, held = view.hold(pair)
    if not np.isfinite(rows[column]).any():
        return None
    figure = style.new_figure(96)
    axes = figure.subplots()
    image = _life_cells(axes, view, rows, pair, column) if view.grid else _life_points(axes, rows, pair, column)
    bar = figure.colorbar(image, ax=axes, location="bottom", aspect=30, pad=0.03, extend="max" if np.isposinf(
        rows[column]).any() else "neither")  # fmt: skip
    bar.set_label(style.with_unit(words, unit))
    axes.set_xlabel(style.factor_label(pair[0]))
    axes.set_ylabel(style.factor_label(pair[1]))
    axes.grid(False)
    style.head(figure, f"{words} over {_long(pair[0])} and {_long(pair[1])}", held)
    style.finish(figure)
    return figure, _life_info(view, rows, pair, held)


def _life_pair(view: StudyView) -> tuple[str, str] | None:
    """Of the pairs of numeric factors, the one that shows most regimes, then most effect on life."""
    names = [f for f in view.factors if view.numeric(f) and len(view.levels(f)) > 1]
    swing = {name: float(np.nanmax(m) - np.nanmin(m)) for name, _, m in effects(view)}
    many = {f: len(view.levels(f)) > 2 for f in names}

    def worth(pair: tuple[str, str]) -> tuple[float, ...]:
        rows, _ = view.hold(pair)
        regimes = rows["regime"].nunique() if "regime" in rows and view.grid else 1
        finite = np.isfinite(rows[view.life[0]]).any() if view.life else False
        return float(finite), float(sum(many[f] for f in pair)), float(regimes), sum(swing.get(f, 0) for f in pair)

    pairs = list(itertools.combinations(names, 2))
    if not pairs:
        return None
    x, y = max(pairs, key=worth)
    return (x, y) if len(view.levels(x)) >= len(view.levels(y)) else (y, x)


def _table(rows: pd.DataFrame, pair: tuple[str, str], column: str, levels: tuple[list, list]) -> np.ndarray:
    """Values over (second factor, first factor), shape (n_y, n_x); NaN where there is no case."""
    cells = np.full((len(levels[1]), len(levels[0])), np.nan)
    place = [{v: i for i, v in enumerate(part)} for part in levels]
    for x, y, value in zip(rows[pair[0]], rows[pair[1]], rows[column], strict=True):
        cells[place[1][y], place[0][x]] = value
    return cells


def _life_cells(axes: Axes, view: StudyView, rows: pd.DataFrame, pair: tuple[str, str], column: str) -> Any:
    from matplotlib.colors import LogNorm

    levels = view.levels(pair[0]), view.levels(pair[1])
    life = _table(rows, pair, column, levels)
    finite = life[np.isfinite(life) & (life > 0)]
    low, high = finite.min(), finite.max()
    norm = LogNorm(low, high if high > low else 10 * low)
    axes.set_facecolor("0.75")  # cells without a life
    image = axes.pcolormesh(np.ma.masked_invalid(np.where(np.isposinf(life), 1e300, life)), cmap="cividis", norm=norm,
                            edgecolor="face", linewidth=0.1)  # fmt: skip
    _ticks(axes, pair, levels)
    if "regime" in rows:
        regime = _table(rows, pair, "regime", levels)
        for code in (1, 2, 3):
            _hatched(axes, regime == code, code)
    return image


def _ticks(axes: Axes, pair: tuple[str, str], levels: tuple[list, list]) -> None:
    """Level values at the middle of the cells, thinned when there are many."""
    for axis, name, values in ((axes.xaxis, pair[0], levels[0]), (axes.yaxis, pair[1], levels[1])):
        step = -(-len(values) // MAX_TICKS)
        shown = range(0, len(values), step)
        texts = [_tick(name, values[i]) for i in shown]
        axis.set_ticks([i + 0.5 for i in shown], texts)
        axis.set_tick_params(length=2)
    if max((len(t.get_text()) for t in axes.get_xticklabels()), default=0) > 40 // max(len(axes.get_xticks()), 1):
        axes.tick_params(axis="x", rotation=35 if max(len(t.get_text()) for t in axes.get_xticklabels()) > 6 else 0)


def _tick(name: str, value: Any) -> str:
    if isinstance(value, str):
        return style.level_text(name, value).replace(" on ", "\non ")
    return "∞" if np.isposinf(value) else style.number(float(f"{value:.3g}"))


def _hatched(axes: Axes, cells: np.ndarray, code: int) -> None:
    """Hatch the cells of a regime, outline the region and write its name in its middle."""
    from matplotlib.patches import Rectangle

    if not cells.any():
        return
    for j, i in np.argwhere(cells):
        axes.add_patch(Rectangle((i, j), 1, 1, facecolor="none", edgecolor="white", linewidth=0,
                                 hatch=style.REGIME_HATCHES[code] or "...."))  # fmt: skip
    _outline(axes, cells)
    spots = np.argwhere(cells) + 0.5
    middle = spots[np.argmin(((spots - spots.mean(axis=0)) ** 2).sum(axis=1))]
    thin = np.ptp(spots[:, 1]) + 1 < 0.22 * cells.shape[1]
    text = axes.text(middle[1], middle[0], style.REGIME_LABELS[code], ha="center", va="center", fontsize=6.8, zorder=5,
                     rotation=90 if thin else 0, bbox={"facecolor": "white", "edgecolor": "0.3", "linewidth": 0.5,
                                                       "boxstyle": "round,pad=0.2"})  # fmt: skip
    text.set_in_layout(False)


def _outline(axes: Axes, cells: np.ndarray) -> None:
    from matplotlib.collections import LineCollection

    padded = np.pad(cells, 1)
    edges = []
    for j, i in np.argwhere(padded[1:, :] != padded[:-1, :]):
        edges.append([(i - 1, j), (i, j)])
    for j, i in np.argwhere(padded[:, 1:] != padded[:, :-1]):
        edges.append([(i, j - 1), (i, j)])
    axes.add_collection(LineCollection(edges, colors="black", linewidths=1.0, zorder=4))


def _life_points(axes: Axes, rows: pd.DataFrame, pair: tuple[str, str], column: str) -> Any:
    """A sample: one mark a case, its regime in the shape of the mark."""
    from matplotlib.colors import LogNorm

    rows = rows if len(rows) <= MAX_POINTS else rows.sample(MAX_POINTS, random_state=0)
    life = rows[column].to_numpy()
    finite = life[np.isfinite(life) & (life > 0)]
    low, high = np.quantile(finite, [0.01, 0.99])
    norm = LogNorm(low, high if high > low else 10 * low)
    regime = rows["regime"].to_numpy() if "regime" in rows else np.zeros(len(rows))
    image = None
    for code, marker in ((0, "o"), (1, "s"), (2, "^")):
        part = rows[regime == code]
        if len(part):
            points = axes.scatter(part[pair[0]], part[pair[1]], c=part[column], cmap="cividis", norm=norm, s=13, marker=marker,
                                  linewidth=0.6 if code else 0.2, edgecolor="black" if code else "0.6",
                                  label=style.REGIME_LABELS[code], rasterized=len(part) > 500)  # fmt: skip
            image = image or points
    axes.figure.legend(loc="outside lower left", ncols=3, handletextpad=0.2)
    return image


def _life_info(view: StudyView, rows: pd.DataFrame, pair: tuple[str, str], held: str) -> style.FigureInfo:
    column, words, unit = view.life or ("", "", "")
    caption = (f"{words} ({unit}) over {_long(pair[0])} and {_long(pair[1])}; the outlined and labelled parts are full slip "
               f"(the drive torque cannot be transmitted) and lift-off (one contact only). {held}")  # fmt: skip
    if not view.grid:
        caption = (f"{words} ({unit}) over {_long(pair[0])} and {_long(pair[1])}, one mark a case; squares: full slip, "
                   f"triangles: lift-off. {held}")  # fmt: skip
    good = rows[np.isfinite(rows[column])]
    best, worst = good.loc[good[column].idxmax()], good.loc[good[column].idxmin()]

    def at(row: Any) -> str:
        return " and ".join(f"{_long(f)} {style.level_text(f, row[f])}" for f in pair)

    sentence = (f"The shortest life shown is {style.number(worst[column])} {unit} at {at(worst)}, the longest "
                f"{style.number(best[column])} {unit} at {at(best)}.")  # fmt: skip
    return style.FigureInfo("life_map", caption, sentence)


def _long(name: str) -> str:
    return PARAMETERS[name].long_name if name in PARAMETERS else style.plain(name)


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
    if view.grid or not all(view.numeric(f) for f in pair):
        pair = pair if _columns(view, pair[0]) >= _columns(view, pair[1]) else (pair[1], pair[0])
        if not view.numeric(pair[0]):  # long names stand beside the rows, not under the columns
            pair = (pair[1], pair[0])
    figure = style.new_figure(84)
    axes = figure.subplots()
    points = not view.grid and all(view.numeric(f) for f in pair)
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
    sentence = f"Of {len(view.table)} cases: {said}; {_long(ranked[0])} decides most, then {_long(ranked[1])}."
    caption = f"Regime of the cases over {_long(pair[0])} and {_long(pair[1])}. {note}"
    return figure, style.FigureInfo("regime_map", caption.strip(), sentence)


def _columns(view: StudyView, name: str) -> int:
    return len(view.levels(name))


def _regime_shares(axes: Axes, view: StudyView, pair: tuple[str, str]) -> None:
    """Cells over both factors, each divided from left to right by the share of the regimes."""
    from matplotlib.patches import Patch, Rectangle

    keys = [_binned(view, f) for f in pair]
    texts = [_cell_names(view, f) for f in pair]
    regime = view.table["regime"].to_numpy()
    for i in range(len(texts[0])):
        for j in range(len(texts[1])):
            here = regime[(keys[0] == i) & (keys[1] == j)]
            left = i + 0.04
            for code in range(4):
                share = float((here == code).mean()) if here.size else 0.0
                if share > 0:
                    axes.add_patch(Rectangle((left, j + 0.04), 0.92 * share, 0.92, facecolor=style.REGIME_COLOURS[code],
                                             hatch=style.REGIME_HATCHES[code], edgecolor="0.25", linewidth=0.3))  # fmt: skip
                left += 0.92 * share
    axes.set_xlim(0, len(texts[0]))
    axes.set_ylim(0, len(texts[1]))
    for axis, labels in ((axes.xaxis, texts[0]), (axes.yaxis, texts[1])):
        step = -(-len(labels) // MAX_TICKS)
        axis.set_ticks([i + 0.5 for i in range(0, len(labels), step)], labels[::step])
    axes.tick_params(length=0)
    if sum(map(len, texts[0])) > 42:
        axes.tick_params(axis="x", rotation=35)
    seen = [c for c in range(4) if (regime == c).any()]
    axes.figure.legend(handles=[Patch(facecolor=style.REGIME_COLOURS[c], hatch=style.REGIME_HATCHES[c], edgecolor="0.25",
                                      label=style.REGIME_LABELS[c]) for c in seen],
                       loc="outside lower left", ncols=4, handletextpad=0.5)  # fmt: skip


def _cell_names(view: StudyView, name: str) -> list[str]:
    levels = view.levels(name)
    if not view.numeric(name) or len(levels) <= 20:
        return [_tick(name, v) for v in levels]
    edges = np.quantile(view.table[name], np.linspace(0, 1, 9))
    return [f"{a:.3g}…{b:.3g}" for a, b in zip(edges[:-1], edges[1:], strict=True)]


def _regime_points(axes: Axes, view: StudyView, pair: tuple[str, str]) -> None:
    rows = view.table
    rows = rows if len(rows) <= MAX_POINTS else rows.sample(MAX_POINTS, random_state=0)
    for code, marker in enumerate("os^X"):
        part = rows[rows["regime"] == code]
        if len(part):
            axes.scatter(part[pair[0]], part[pair[1]], s=11, marker=marker, facecolor=style.REGIME_COLOURS[code],
                         edgecolor="0.25", linewidth=0.5, label=style.REGIME_LABELS[code], rasterized=len(part) > 500)  # fmt: skip
    axes.figure.legend(loc="outside lower left", ncols=4, handletextpad=0.2)
