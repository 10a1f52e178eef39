"""Maps over two factors: life with the regimes shaded, and the regimes themselves."""

from __future__ import annotations

import itertools
import textwrap
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.report.figures import style
from trackroller.report.figures.study_effects import effects
from trackroller.report.figures.study_life import MAX_POINTS
from trackroller.report.figures.study_view import StudyView

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MAX_TICKS = 9
MAX_CELLS = 12  # levels a sampled factor may take to be drawn as cells


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
    cells = view.grid or all(len(view.levels(f)) <= MAX_CELLS for f in pair)
    if not cells and len(rows) > MAX_POINTS:
        held = f"{MAX_POINTS} of the {len(rows)} cases of the sample."
    image = _life_cells(axes, view, rows, pair, column) if cells else _life_points(axes, rows, pair, column)
    bar = figure.colorbar(
        image,
        ax=axes,
        location="bottom",
        aspect=30,
        pad=0.03,
        extend="max" if np.isposinf(rows[column]).any() else "neither",
    )
    bar.set_label(style.with_unit(words, unit))
    style.log_ticks(bar.ax.xaxis, *image.get_clim())
    axes.set_xlabel(style.factor_label(pair[0]))
    axes.set_ylabel(style.factor_label(pair[1]))
    axes.grid(False)
    style.head(figure, f"{words} over {style.long_name(pair[0])} and {style.long_name(pair[1])}", held)
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
        few = [len(view.levels(f)) <= MAX_CELLS for f in pair]
        alike = view.grid or few[0] == few[1]  # a sample is drawn as cells or as points, not as rows of points
        several = float(sum(many[f] for f in pair))
        return float(finite), float(alike), several, float(regimes), sum(swing.get(f, 0) for f in pair)

    pairs = list(itertools.combinations(names, 2))
    if not pairs:
        return None
    x, y = max(pairs, key=worth)
    return (x, y) if len(view.levels(x)) >= len(view.levels(y)) else (y, x)


def _table(rows: pd.DataFrame, pair: tuple[str, str], column: str, levels: tuple[list, list]) -> np.ndarray:
    """Values (medians of a sample) over (second factor, first factor), shape (n_y, n_x); NaN where there is no case."""
    cells = np.full((len(levels[1]), len(levels[0])), np.nan)
    place = [{v: i for i, v in enumerate(part)} for part in levels]
    medians = rows.groupby(list(pair), as_index=False)[column].median()
    for x, y, value in zip(medians[pair[0]], medians[pair[1]], medians[column], strict=True):
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
    image = axes.pcolormesh(
        np.ma.masked_invalid(np.where(np.isposinf(life), 1e300, life)),
        cmap="cividis",
        norm=norm,
        edgecolor="face",
        linewidth=0.1,
    )
    _ticks(axes, pair, levels)
    if "regime" in rows and view.grid:
        regime = _table(rows, pair, "regime", levels)
        for code in (1, 2, 3):
            _hatched(axes, regime == code, code)
    return image


def _ticks(axes: Axes, pair: tuple[str, str], levels: tuple[list, list]) -> None:
    """Level values at the middle of the cells, thinned when there are many."""
    for axis, name, values in ((axes.xaxis, pair[0], levels[0]), (axes.yaxis, pair[1], levels[1])):
        step = -(-len(values) // MAX_TICKS)
        shown = range(0, len(values), step)
        texts = [tick_text(name, values[i]) for i in shown]
        axis.set_ticks([i + 0.5 for i in shown], texts)
        axis.set_tick_params(length=2)
    if max((len(t.get_text()) for t in axes.get_xticklabels()), default=0) > 40 // max(len(axes.get_xticks()), 1):
        axes.tick_params(axis="x", rotation=35 if max(len(t.get_text()) for t in axes.get_xticklabels()) > 6 else 0)


def tick_text(name: str, value: Any) -> str:
    """A level at an axis: short, without unit."""
    if isinstance(value, str):
        return textwrap.fill(style.level_text(name, value).replace(" on ", " on\u00a0"), 24).replace("\u00a0", " ")
    return "∞" if np.isposinf(value) else style.rounded(value, 3)


def _hatched(axes: Axes, cells: np.ndarray, code: int) -> None:
    """Hatch the cells of a regime, outline the region and write its name in its middle."""
    from matplotlib.patches import Rectangle

    if not cells.any():
        return
    for j, i in np.argwhere(cells):
        axes.add_patch(
            Rectangle(
                (i, j),
                1,
                1,
                facecolor=(1, 1, 1, 0.35),
                edgecolor=(0.25, 0.25, 0.25),
                linewidth=0,
                hatch=style.REGIME_HATCHES[code] or "....",
            )
        )
    _outline(axes, cells)
    spots = np.argwhere(cells) + 0.5
    middle = spots[np.argmin(((spots - spots.mean(axis=0)) ** 2).sum(axis=1))]
    thin = np.ptp(spots[:, 1]) + 1 < 0.22 * cells.shape[1]
    text = axes.text(
        middle[1],
        middle[0],
        style.REGIME_LABELS[code],
        ha="center",
        va="center",
        fontsize=6.8,
        zorder=5,
        rotation=90 if thin else 0,
        bbox={"facecolor": "white", "edgecolor": "0.3", "linewidth": 0.5, "boxstyle": "round,pad=0.2"},
    )
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
            points = axes.scatter(
                part[pair[0]],
                part[pair[1]],
                c=part[column],
                cmap="cividis",
                norm=norm,
                s=13,
                marker=marker,
                linewidth=0.6 if code else 0.2,
                edgecolor="black" if code else "0.6",
                label=style.REGIME_LABELS[code],
                rasterized=len(part) > 500,
            )
            image = image or points
    axes.figure.legend(loc="outside lower left", ncols=3, handletextpad=0.2)
    return image


def _life_info(view: StudyView, rows: pd.DataFrame, pair: tuple[str, str], held: str) -> style.FigureInfo:
    column, words, unit = view.life or ("", "", "")
    what = f"{words} ({unit}) over {style.long_name(pair[0])} and {style.long_name(pair[1])}"
    caption = (
        f"{what}; the outlined and labelled parts are full slip "
        f"(the drive torque cannot be transmitted) and lift-off (one contact only). {held}"
    )
    if not view.grid:
        cells = all(len(view.levels(f)) <= MAX_CELLS for f in pair)
        marked = "one mark a case; squares: full slip, triangles: lift-off"
        how = "median of the cases in each cell" if cells else marked
        caption = f"{what}, {how}. {held}"
    good = rows[np.isfinite(rows[column])]
    best, worst = good.loc[good[column].idxmax()], good.loc[good[column].idxmin()]

    def at(row: Any) -> str:
        return " and ".join(f"{style.long_name(f)} {style.level_text(f, row[f])}" for f in pair)

    sentence = (
        f"The shortest life shown is {style.rounded(worst[column], 3)} {unit} at {at(worst)}, the longest "
        f"{style.rounded(best[column], 3)} {unit} at {at(best)}."
    )
    return style.FigureInfo("life_map", caption, sentence)
