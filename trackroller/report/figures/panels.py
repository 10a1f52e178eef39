"""Parts that the figures of a study share: capped lives, marks, legends."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from trackroller.report.claims import classes
from trackroller.report.figures import style
from trackroller.report.numbers import level_text, long_name, number, setting
from trackroller.report.view import StudyView

COLOURS = 5  # most levels of the deciding factor that get a colour each
CLASSES, FEWEST = 8, 5  # most classes of a sample along an axis, and fewest rows of a class
Entries = list[tuple[str, dict[str, Any]]]


def capped(life: np.ndarray) -> tuple[np.ndarray, float | None]:
    """Place lives on a logarithmic axis.

    Unlimited lives lie one decade above the longest finite life.

    Parameters
    ----------
    life : lives, shape (n,)

    Returns
    -------
    Values with NaN where nothing can be drawn, and the height of the unlimited lives, None without any.
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
        fontsize=7,
        color="0.25",
    )


def marks(axes: Axes, rows: pd.DataFrame, x: str, y: str, look: dict[str, Any], filled: Any) -> None:
    """Draw marks, filled where `filled` (n,) says so and hollow elsewhere.

    Parameters
    ----------
    look : `color`, `marker` and `s`, the area of a mark [pt^2]
    """
    filled = np.broadcast_to(np.asarray(filled, dtype=bool), len(rows))
    colour = look["color"]
    for chosen, face in ((filled, colour), (~filled, "white")):
        part = rows[chosen]
        shown = {"marker": look["marker"], "s": look["s"], "facecolor": face, "edgecolor": colour}
        axes.scatter(part[x], part[y], linewidth=0.8, zorder=3, **shown)


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


def running(axes: Axes, x: np.ndarray, y: np.ndarray, look: dict[str, Any]) -> None:
    """Draw the median of a sample along x, in classes of equally many rows, with a band from 5 to 95 %.

    Parameters
    ----------
    x, y : values of the rows, shape (n,); rows without either are left out
    look : `color`, `marker` and more of the line
    """
    good = np.isfinite(x) & np.isfinite(y)
    x, y = x[good], y[good]
    levels, index = np.unique(x, return_inverse=True)
    most = min(CLASSES, x.size // FEWEST)
    if levels.size > max(most, 1):
        index = np.argsort(np.argsort(x, kind="stable"), kind="stable") * max(most, 1) // max(x.size, 1)
    members = [index == k for k in np.unique(index)]
    at = [np.median(x[m]) for m in members]
    low, middle, high = np.array([np.percentile(y[m], (5, 50, 95), method="nearest") for m in members]).reshape(-1, 3).T
    axes.fill_between(at, low, high, color=look["color"], alpha=0.18, linewidth=0)
    axes.plot(at, middle, markersize=3, **look)


def groups_of(view: StudyView, lead: str, rows: np.ndarray) -> list[tuple[str, np.ndarray]]:
    """Return each level (or third) of the deciding factor in words, and which of the chosen rows have it.

    Parameters
    ----------
    rows : the chosen cases, shape (n,) bool
    """
    index, ends = classes(view, lead, rows, 3)
    present = [k for k in range(len(ends)) if (index == k).any()]
    if len(present) > COLOURS:  # a number of many levels: lowest, highest and between
        chosen = np.unique(np.linspace(0, len(present) - 1, COLOURS).round().astype(int))
        present = [present[k] for k in chosen]
    return [(class_words(lead, ends[k]), index == k) for k in present]


def class_words(name: str, end: Any) -> str:
    """Write a level of a factor, or the ends (low, high) of a class, with the name of a factor that needs it."""
    if isinstance(end, tuple):
        return f"{long_name(name)} {number(float(f'{end[0]:.3g}'))} to {level_text(name, float(f'{end[1]:.3g}'))}"
    return level_text(name, end) if isinstance(end, str) else setting(name, end)
