"""Parts that the figures of a study share: capped lives, marks, legends."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from trackroller.report.figures import style
from trackroller.report.numbers import level_text

MAX_POINTS = 1000  # of a sample, in one scatter plot
Entries = list[tuple[str, dict[str, Any]]]


def capped(life: np.ndarray) -> tuple[np.ndarray, float | None]:
    """Place lives on a logarithmic axis.

    Unlimited ones lie one decade above the longest finite one.

    Parameters
    ----------
    life : lives, shape (n,)

    Returns
    -------
    Values with NaN where nothing can be drawn, and the height of the unlimited ones (None: there are none).
    """
    life = np.asarray(life, dtype=float)
    finite = life[np.isfinite(life) & (life > 0)]
    top = float(10 ** (np.ceil(np.log10(finite.max())) + 1)) if finite.size else 1.0
    values = np.where(np.isposinf(life), top, np.where(life > 0, life, np.nan))
    return values, top if np.isposinf(life).any() else None


def mark_unlimited(axes: Axes, height: float | None) -> None:
    """Draw a dotted line and a word at the height of the unlimited lives."""
    if height is None:
        return
    axes.axhline(height, color="0.35", linewidth=0.8, linestyle=(0, (1, 2)), zorder=0)
    axes.annotate(
        "unlimited",
        (1.0, height),
        xycoords=("axes fraction", "data"),
        xytext=(-2, 2),
        textcoords="offset points",
        ha="right",
        va="bottom",
        fontsize=6.5,
        color="0.25",
    )


def marks(axes: Axes, rows: pd.DataFrame, x: str, y: str, look: dict[str, Any], filled: Any) -> None:
    """Draw marks, filled where `filled` (n,) says so and hollow elsewhere.

    More than 500 of them as pixels.

    Parameters
    ----------
    look : `color`, `marker` and `s`, the area of a mark [pt^2]
    """
    filled = np.broadcast_to(np.asarray(filled, dtype=bool), len(rows))
    colour = look["color"]
    for chosen, face in ((filled, colour), (~filled, "white")):
        part = rows[chosen]
        shown = {"marker": look["marker"], "s": look["s"], "facecolor": face, "edgecolor": colour}
        axes.scatter(part[x], part[y], linewidth=0.8, zorder=3, rasterized=len(part) > 500, **shown)


def legend(figure: Figure, entries: Entries, columns: int = 3) -> None:
    """Draw the legend under the axes, so that it never covers data."""
    figure.legend(
        handles=[Line2D([], [], label=text, **look) for text, look in entries],
        loc="outside lower left",
        ncols=columns,
        alignment="left",
        handlelength=2.4,
        borderaxespad=0.2,
        columnspacing=1.2,
    )


def drive_entries(drives: list[Any]) -> Entries:
    """Return the legend entries of motor forces, told apart by dashes."""
    looks = [{"color": "0.2", "linestyle": style.LINES[j % 6]} for j in range(len(drives))]
    return [(level_text("motor_force", d), look) for d, look in zip(drives, looks, strict=True)]


def drive_of(levels: list[Any] | None) -> list[Any]:
    """Return the drives to tell apart: up to five levels, else one line for all."""
    return levels if levels is not None and len(levels) <= 5 else [None]


def sampled(rows: pd.DataFrame, most: int = MAX_POINTS) -> tuple[pd.DataFrame, str]:
    """Thin out the points of a picture, and say so; sentences never use these rows."""
    if len(rows) <= most:
        return rows, ""
    return rows.sample(most, random_state=0), f"{most} of {len(rows)} cases are drawn."
