"""Parts that the figures of a study share: capped lives, legends, medians with bands."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

CLASSES, FEWEST = 8, 5  # most classes of a sample along an axis, and fewest rows of a class
Entries = list[tuple[str, dict[str, Any]]]


def capped(life: np.ndarray) -> tuple[np.ndarray, float | None]:
    """Place lives on a logarithmic axis.

    Unlimited lives lie at ten times the next power of ten above the longest finite life.

    Parameters
    ----------
    life : lives, shape (n,)

    Returns
    -------
    Values with NaN where nothing can be drawn, and the height of the unlimited lives, None if all
    lives are finite.
    """
    life = np.asarray(life, dtype=float)
    finite = life[np.isfinite(life) & (life > 0)]
    top = 1.0
    if finite.size:
        top = float(10 ** (np.ceil(np.log10(finite.max())) + 1))
    values = np.where(np.isposinf(life), top, np.where(life > 0, life, np.nan))
    cap = None
    if np.isposinf(life).any():
        cap = top
    return values, cap


def legend(figure: Figure, entries: Entries | Mapping[str, Artist], columns: int = 3) -> None:
    """Draw the legend under the axes, where it covers no data; `entries` are texts with looks, or
    artists by label.

    It has fewer columns where its texts are too long for the width of the figure.
    """
    if isinstance(entries, Mapping):
        own = entries
    else:
        own = {text: Line2D([], [], **look) for text, look in entries}
    for count in range(columns, 0, -1):
        box = figure.legend(
            own.values(), own, loc="outside lower left", ncols=count, alignment="left"
        )
        if count == 1 or box.get_window_extent().width <= figure.bbox.width:
            return
        box.remove()


def quantiles(
    values: np.ndarray,
    index: np.ndarray,
    count: int,
    shares: tuple[int, int, int] = (5, 50, 95),
    fewest: int = 1,
) -> np.ndarray:
    """Return three percentiles of the values (n,) of each group, shape (3, count); NaN for a group
    of few values.

    Between two values it is their mean, as in the tables, which also holds for values without end.
    """
    percentiles = np.full((3, count), np.nan)
    for k in range(count):
        own = values[(index == k) & ~np.isnan(values)]
        if own.size >= fewest:
            low, high = (np.percentile(own, shares, method=way) for way in ("lower", "higher"))
            percentiles[:, k] = np.where(low == high, low, (low + high) / 2)
    return percentiles


def band(
    axes: Axes, at: np.ndarray, values: np.ndarray, look: dict[str, Any], ordered: bool
) -> Any:
    """Draw the middle of three percentiles, shape (3, groups), with a band, or with bars for
    unordered groups.
    """
    low, middle, high = values
    if ordered:
        axes.fill_between(at, low, high, color=look["color"], alpha=0.18, linewidth=0)
        unjoined = {}
    else:
        axes.vlines(at, low, high, color=look["color"], alpha=0.35, linewidth=4)
        unjoined = {"linestyle": "none"}
    return axes.plot(at, middle, **{"markersize": 3, **look, **unjoined})[0]


def running(axes: Axes, x: np.ndarray, y: np.ndarray, look: dict[str, Any]) -> None:
    """Draw the median of a sample along x, in classes of equally many rows, with a band from 5 to
    95 %.

    Parameters
    ----------
    x, y : values of the rows, shape (n,); a row without one of them is left out
    look : `color`, `marker` and more of the line
    """
    good = np.isfinite(x) & np.isfinite(y)
    x, y = x[good], y[good]
    levels, index = np.unique(x, return_inverse=True)
    most = max(min(CLASSES, x.size // FEWEST), 1)
    if levels.size > most:
        index = np.argsort(np.argsort(x, kind="stable"), kind="stable") * most // x.size
    count = int(index.max(initial=-1)) + 1
    at = np.array([np.median(x[index == k]) for k in range(count)])
    band(axes, at, quantiles(y, index, count), look, ordered=True)
