"""Maps over two factors: life, and the regimes."""

from __future__ import annotations

import itertools
import textwrap
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.axis import Axis, XAxis
from matplotlib.colors import LogNorm
from matplotlib.patches import Patch, Rectangle

from trackroller.parameters import REGIME_LABELS
from trackroller.report.figures import style
from trackroller.report.figures.levels import held_words
from trackroller.report.numbers import (
    capital,
    factor_label,
    level_text,
    long_name,
    rounded,
    with_unit,
)
from trackroller.results.factor_levels import BINS, classes
from trackroller.results.lives_by_tests import beyond_sn_data
from trackroller.results.ranking import ranked_factors
from trackroller.results.results import Results

FEWEST = 5  # a sample with fewer cases outside the most frequent regime has no map
MAX_TICKS = 9
MOST_LETTERS = 80  # of all labels below an axis; longer labels are slanted
MOST_WRITTEN = 72  # cells of a map with its values written in
Pair = tuple[str, str]


def life_map(results: Results) -> style.Drawn:
    """Draw life over the two numeric factors with most effect.

    It answers: how long does the roller live, and where on the map has it no life? A small map has
    its lives written in. The map of regimes says why a cell has no life.
    """
    if results.life is None or not results.has(results.life[0]):
        return None
    pair = _life_pair(results)
    if pair is None:
        return None
    column, words, unit = results.life
    rows, levels_held = results.hold(pair)
    lives = rows[column][results.rolling[rows.index]]
    if not (np.isfinite(lives) & (lives > 0)).any():
        return None
    over = capital(f"{words} over {long_name(pair[0])} and {long_name(pair[1])}")
    figure, (axes,) = style.panels(over, 84)
    image = _life_cells(axes, results, rows, pair, column)
    extend = "neither"
    if np.isposinf(rows[column]).any():
        extend = "max"
    bar = figure.colorbar(
        image, ax=axes, aspect=25, pad=0.02, extend=extend, label=with_unit(capital(words), unit)
    )
    style.log_ticks(bar.ax.yaxis, *image.get_clim())
    axes.set(xlabel=factor_label(pair[0]), ylabel=factor_label(pair[1]))
    how = "Each cell is the median of its cases; grey cells have no life"
    if results.grid:
        how = "Grey cells have no life"
    if (
        axes.texts
        and (beyond_sn_data(results, column)[rows.index] & results.rolling[rows.index]).any()
    ):
        how += "; lives in brackets lie beyond the S-N data"
    return figure, style.FigureInfo("life_map", f"{over}. {how}. {held_words(levels_held)}".strip())


def _life_pair(results: Results) -> Pair | None:
    """Return the pair of numeric factors with several levels and the largest effect on life.

    None for a sample in which other factors have more effect than the pair: its map would show
    their scatter.
    """
    names = [f for f in results.factors if results.numeric(f) and len(results.levels(f)) > 1]
    column = ""
    if results.life:
        column = results.life[0]
    size = ranked_factors(results.analysis, column, results.factors)

    def rank(pair: Pair) -> tuple[float, ...]:
        """Return what ranks a pair, the first number first: whether it has a finite life, how many
        of its factors have more than two levels, and its effect.
        """
        rows, _ = results.hold(pair)
        has_life = float(np.isfinite(rows[column]).any())
        several = float(sum(len(results.levels(f)) > 2 for f in pair))
        return has_life, several, sum(size[f] for f in pair)

    pairs = list(itertools.combinations(names, 2))
    if not pairs:
        return None
    x, y = max(pairs, key=rank)
    if not results.grid and size[x] + size[y] < 0.5 * sum(size.values()):
        return None
    if len(results.levels(x)) >= len(results.levels(y)):
        return x, y
    return y, x


def cell_name(name: str, end: Any) -> str:
    """Write the level of a cell at an axis, short and without unit, or the ends (low, high) of its
    class.
    """
    if isinstance(end, str):
        return textwrap.fill(level_text(name, end).replace(" on ", " on\u00a0"), 24).replace(
            "\u00a0", " "
        )
    if isinstance(end, tuple):
        return f"{end[0]:.3g}…{end[1]:.3g}"
    return rounded(end)


def _table(values: pd.Series, keys: list[np.ndarray], shape: tuple[int, int]) -> np.ndarray:
    """Return the medians over (second factor, first factor), shape (n_y, n_x); NaN where there is
    no case.
    """
    cells = np.full(shape, np.nan)
    medians = values.groupby([keys[1], keys[0]]).median()
    cells[medians.index.get_level_values(0), medians.index.get_level_values(1)] = medians
    return cells


def _life_cells(axes: Axes, results: Results, rows: pd.DataFrame, pair: Pair, column: str) -> Any:
    inside = np.isin(np.arange(len(results.table)), rows.index)
    most: int | None = BINS
    if results.grid:
        most = None
    sides = [classes(results.table, name, inside, most) for name in pair]
    keys = [index for index, _ in sides]
    shape = (len(sides[1][1]), len(sides[0][1]))
    life = _table(rows[column].where(results.rolling[rows.index]), keys, shape)
    axes.set_facecolor("0.75")  # cells without a life
    cells = np.ma.masked_invalid(np.where(np.isposinf(life), 1e300, life))
    finite = life[np.isfinite(life) & (life > 0)]
    if finite.max() > finite.min():
        top = finite.max()
    else:
        top = 10 * finite.min()
    norm = LogNorm(finite.min(), top)
    image = axes.pcolormesh(cells, cmap="cividis", norm=norm, edgecolor="face", linewidth=0.1)
    for axis, name, (_, ends) in zip((axes.xaxis, axes.yaxis), pair, sides, strict=True):
        set_ticks(axis, [cell_name(name, end) for end in ends])
    axes.grid(False)
    beyond = pd.Series(beyond_sn_data(results, column)[rows.index], rows.index, dtype=float)
    _written(
        axes, life, _table(beyond.where(results.rolling[rows.index]), keys, shape) >= 0.5, image
    )
    return image


def _written(axes: Axes, values: np.ndarray, beyond: np.ndarray, image: Any) -> None:
    """Write the lives into the cells of a small map, those beyond the S-N data in brackets."""
    if values.size > MOST_WRITTEN or values.shape[1] > MAX_TICKS:
        return
    for (j, i), value in np.ndenumerate(values):
        if np.isfinite(value):
            colour = "white"
            if image.norm(value) > 0.55:
                colour = "black"
            if beyond[j, i]:
                text = f"({rounded(float(value), 2)})"
            else:
                text = rounded(float(value), 2)
            axes.text(i + 0.5, j + 0.5, text, color=colour, ha="center", va="center", fontsize=7)


def set_ticks(axis: Axis, texts: list[str]) -> None:
    """Write texts at the middle of the cells, thinned when there are many."""
    shown = range(0, len(texts), -(-len(texts) // MAX_TICKS))
    axis.set_ticks([i + 0.5 for i in shown], [texts[i] for i in shown])
    if isinstance(axis, XAxis) and sum(map(len, texts)) > MOST_LETTERS:
        axis.set_tick_params(rotation=35)


def regime_map(results: Results) -> style.Drawn:
    """Draw which combinations roll, slip or lift off, over the two factors that separate the
    regimes most.

    It answers: where may the roller not be used? Return None if all cases roll, or nearly all cases
    of a sample.
    """
    if len(results.factors) < 2:
        return None
    most = np.unique(results.regime, return_counts=True)[1].max()
    fewest = FEWEST
    if results.grid:
        fewest = 1
    if len(results.table) - most < fewest:
        return None
    ranked = sorted(results.factors, key=lambda f: -_regime_spread(results, f))
    # long names go on the vertical axis, where they have room; of two numbers the one with fewer
    # levels goes there
    x, y = sorted(ranked[:2], key=lambda f: (not results.numeric(f), -len(results.levels(f))))
    pair = (x, y)
    figure, (axes,) = style.panels("Regimes: rolling, full slip, lift-off", 76)
    note = _regime_shares(axes, results, pair)
    axes.set(xlabel=factor_label(pair[0]), ylabel=factor_label(pair[1]))
    caption = f"Regime of the cases over {long_name(pair[0])} and {long_name(pair[1])}. {note}"
    return figure, style.FigureInfo("regime_map", caption.strip())


def _regime_spread(results: Results, name: str) -> float:
    """Return how much the share of a regime changes over the levels of a factor; it decides which
    factor is drawn.
    """
    index, _ = classes(results.table, name, np.ones(len(results.table), dtype=bool), BINS)
    shares = pd.crosstab(index, results.regime, normalize="index").reindex(
        columns=[1, 2, 3], fill_value=0.0
    )
    return float(np.ptp(shares.to_numpy(), axis=0).max())


def _regime_shares(axes: Axes, results: Results, pair: Pair) -> str:
    """Draw cells over both factors, each divided from left to right by the share of the regimes."""
    every = np.ones(len(results.table), dtype=bool)
    keys, ends = zip(*(classes(results.table, f, every, BINS) for f in pair), strict=True)
    texts = [[cell_name(f, end) for end in part] for f, part in zip(pair, ends, strict=True)]
    both = zip(style.REGIME_COLOURS, style.REGIME_HATCHES, strict=True)
    looks: list[dict[str, Any]] = [
        {"facecolor": colour, "hatch": hatch, "edgecolor": "0.25"} for colour, hatch in both
    ]
    gaps = [0.04 if len(t) <= 12 else 0.0 for t in texts]
    thin = 0.0
    if all(gaps):
        thin = 0.3
    width = 1 - 2 * gaps[0]
    for i, j in np.ndindex(len(texts[0]), len(texts[1])):
        here = results.regime[(keys[0] == i) & (keys[1] == j)]
        left = i + gaps[0]
        for code in range(4) if here.size else ():
            part = width * float((here == code).mean())
            if part > 0:
                axes.add_patch(
                    Rectangle(
                        (left, j + gaps[1]), part, 1 - 2 * gaps[1], linewidth=thin, **looks[code]
                    )
                )
            left += part
    axes.set(xlim=(0, len(texts[0])), ylim=(0, len(texts[1])))
    for axis, labels in ((axes.xaxis, texts[0]), (axes.yaxis, texts[1])):
        set_ticks(axis, labels)
    axes.grid(False)
    handles = [
        Patch(label=REGIME_LABELS[c], **looks[c]) for c in range(4) if (results.regime == c).any()
    ]
    axes.figure.legend(handles=handles, loc="outside lower left", ncols=4, handletextpad=0.5)
    others = len(results.factors) > 2
    if others:
        return (
            "Each cell is divided by the share of its cases in each regime, over all other factors."
        )
    return ""
