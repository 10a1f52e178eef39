"""Life against friction, and the parts of line charts that other figures share."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.report.figures import style
from trackroller.report.figures.study_view import StudyView

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MANY_LINES = 6  # more lines than this in one panel are not told apart: one panel a drive
MAX_POINTS = 1000  # of a sample, in one scatter plot


def capped(life: np.ndarray) -> tuple[np.ndarray, float | None]:
    """Life for a logarithmic axis: unlimited lives are laid one decade above the longest finite one.

    Result: values with NaN where nothing can be drawn, and the height of the unlimited ones (None: none).
    """
    life = np.asarray(life, dtype=float)
    finite = life[np.isfinite(life) & (life > 0)]
    top = float(10 ** (np.ceil(np.log10(finite.max())) + 1)) if finite.size else 1.0
    values = np.where(np.isposinf(life), top, np.where(life > 0, life, np.nan))
    return values, top if np.isposinf(life).any() else None


def mark_unlimited(axes: Axes, height: float | None) -> None:
    """Dotted line and words at the height where unlimited lives are drawn."""
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


def series(axes: Axes, rows: pd.DataFrame, x: str, y: str, look: dict[str, Any], line: bool) -> None:
    """One line (or cloud) with filled marks for rolling and hollow ones for full slip and lift-off."""
    rows = rows.sort_values(x)
    colour, marker = look["color"], look["marker"]
    if line:
        axes.plot(rows[x], rows[y], color=colour, linestyle=look.get("linestyle", "-"), zorder=2)
    else:
        from matplotlib.patheffects import Normal, Stroke

        axes.plot(
            *binned_median(rows[x], rows[y]),
            color=colour,
            linestyle=look.get("linestyle", "-"),
            zorder=4,
            path_effects=[Stroke(linewidth=3.2, foreground="white"), Normal()],
        )
    rolling = (rows["regime"] == 0) if "regime" in rows else np.ones(len(rows), dtype=bool)
    marks(axes, rows, x, y, colour, marker, 14 if line else 7, rolling)


def marks(axes: Axes, rows: pd.DataFrame, x: str, y: str, colour: Any, marker: str, size: float, filled: Any) -> None:
    """Marks of `size` [pt^2], filled where `filled` (n,) says so and hollow elsewhere; many of them as pixels."""
    filled = np.broadcast_to(np.asarray(filled, dtype=bool), len(rows))
    for chosen, face in ((filled, colour), (~filled, "white")):
        part = rows[chosen]
        axes.scatter(
            part[x],
            part[y],
            s=size,
            marker=marker,
            facecolor=face,
            edgecolor=colour,
            linewidth=0.8,
            zorder=3,
            rasterized=len(part) > 500,
        )


def binned_median(x: pd.Series, y: pd.Series, bins: int = 6) -> tuple[np.ndarray, np.ndarray]:
    """Median of y at few levels of x, else in bins of equally many points; empty for fewer than five a bin."""
    good = np.isfinite(x) & np.isfinite(y)
    at, value = x[good].to_numpy(), y[good].to_numpy()
    levels = np.unique(at)
    if 2 <= len(levels) <= bins:
        return levels, np.array([np.median(value[at == level]) for level in levels])
    if len(at) < 5 * bins:
        return np.array([]), np.array([])
    parts = np.array_split(np.argsort(at), bins)
    return np.array([np.median(at[p]) for p in parts]), np.array([np.median(value[p]) for p in parts])


def legend(
    figure: Figure, entries: list[tuple[str, dict[str, Any]]], title: str | None = None, columns: int = 1
) -> None:
    """Legend under the axes, so that it never covers data."""
    from matplotlib.lines import Line2D

    handles = [Line2D([], [], label=text, **look) for text, look in entries]
    figure.legend(
        handles=handles,
        loc="outside lower left",
        ncols=columns,
        title=title,
        alignment="left",
        handlelength=2.4,
        borderaxespad=0.2,
        columnspacing=1.2,
    )


def hollow_entry(rows: pd.DataFrame) -> list[tuple[str, dict[str, Any]]]:
    """Legend entry for hollow marks when there are any."""
    if "regime" not in rows:
        return []
    seen = [style.REGIME_LABELS[r] for r in (1, 2, 3) if (rows["regime"] == r).any()]
    look = {"color": "0.3", "marker": "o", "markerfacecolor": "white", "linestyle": "none"}
    return [(f"hollow: {' or '.join(seen)}", look)] if seen else []


def drive_entries(drives: list[Any]) -> list[tuple[str, dict[str, Any]]]:
    """Legend entries of motor forces, told apart by dashes."""
    return [
        (style.level_text("motor_force", d), {"color": "0.2", "linestyle": style.LINES[j % 6]})
        for j, d in enumerate(drives)
    ]


def life_against_friction(view: StudyView) -> tuple[Figure, style.FigureInfo] | None:
    """Life over the friction coefficient, a line a material pair, by drive."""
    x = "friction_coefficient"
    if view.life is None or not view.behind(x) or not view.numeric(x) or not view.has(view.life[0], x):
        return None
    column, words, unit = view.life
    pair = next((f for f in ("material_pair", "roller_material", "guide_material") if f in view.factors), None)
    drive = "motor_force" if "motor_force" in view.factors and len(view.levels("motor_force")) <= 5 else None
    rows, held = view.hold(tuple(f for f in (*view.behind(x), pair, drive) if f))
    if not view.grid and len(rows) > MAX_POINTS:
        held = f"{MAX_POINTS} of the {len(rows)} cases of the sample."
    rows = _thinned(rows, view.grid).copy()
    rows["_life"], top = capped(rows[column].to_numpy())
    if not np.isfinite(rows["_life"]).any():
        return None
    pairs = view.levels(pair) if pair else [None]
    drives = view.levels(drive) if drive else [None]
    split = len(pairs) * len(drives) > MANY_LINES
    panels = drives if split else [None]
    colours = style.palette(len(pairs))
    looks = [
        {"color": colours[i], "marker": style.MARKERS[i % 10], "linestyle": style.LINES[i % 6]}
        for i in range(len(pairs))
    ]
    extra = len(pairs) + 2 + (0 if split else len(drives))
    figure = style.new_figure(14 + 4 * extra + (38 * len(panels) if split else 55))
    grid = figure.subplots(len(panels), 1, sharex=True, sharey=True, squeeze=False)[:, 0]
    several = drive is not None and not split  # drives in one panel are told apart by dashes
    for axes, shown in zip(grid, panels, strict=True):
        for i, p in enumerate(pairs):
            for j, d in enumerate([shown] if split else drives):
                part = rows if p is None else rows[rows[pair] == p]
                part = part if d is None else part[part[drive] == d]
                look = {**looks[i], "linestyle": style.LINES[j % 6]} if several else looks[i]
                series(axes, part, x, "_life", look, view.grid)
        axes.set_yscale("log")
        style.log_ticks(axes.yaxis, *axes.get_ylim())
        mark_unlimited(axes, top)
        if split:
            axes.set_title(style.capital(style.level_text("motor_force", shown)), loc="left", fontsize=7.5, pad=3)
    grid[-1].set_xlabel(style.factor_label(x))
    for axes in grid:
        axes.set_ylabel(style.with_unit("Life" if split else words, unit))
    entries: list[tuple[str, dict[str, Any]]] = []
    if pair:
        plain = {"linestyle": "none"} if several else {}
        entries += [(style.level_text(pair, p), look | plain) for p, look in zip(pairs, looks, strict=True)]
    if several:
        entries += drive_entries(drives)
    legend(figure, entries + hollow_entry(rows))
    style.head(figure, f"{words} against friction", held)
    style.finish(figure)
    return figure, _friction_info(view, rows, pair, pairs, drives, held)


def _friction_info(
    view: StudyView, rows: pd.DataFrame, pair: str | None, pairs: list, drives: list, held: str
) -> style.FigureInfo:
    _, words, unit = view.life or ("", "", "")
    caption = (
        f"{words} ({unit}) over the friction coefficient"
        + (f", one line for each of {len(pairs)} material pairs" if pair else "")
        + (f", for {len(drives)} motor forces" if drives[0] is not None else "")
        + f". {held}"
        + ("" if view.grid else " Lines: medians.")
    )
    name, x = "life_against_friction", "friction_coefficient"
    shown = rows[np.isfinite(rows["_life"])].sort_values(x)
    if not view.grid:
        return style.FigureInfo(name, caption, _sample_sentence(shown, x, unit))
    for factor in (pair, "motor_force" if drives[0] is not None else None):
        if factor:
            shown = shown[shown[factor] == view.held_level(factor)]
    if len(shown) < 2:
        return style.FigureInfo(name, caption, "Too few cases have a life to state a trend.")
    where = ", ".join(style.level_text(n, view.held_level(n)) for n in (pair, "motor_force") if n in view.factors)
    first, last = shown.iloc[0], shown.iloc[-1]
    sentence = change_sentence("friction", first["_life"], last["_life"], first[x], last[x], where, "life")
    return style.FigureInfo(name, caption, sentence)


def _sample_sentence(shown: pd.DataFrame, x: str, unit: str) -> str:
    """Median life of the fifths of a sample with the lowest and the highest friction: other factors vary as well."""
    fifth = len(shown) // 5
    if fifth < 3:
        return "Too few cases have a life to state a trend."
    low, high = shown.iloc[:fifth], shown.iloc[-fifth:]
    said = [f"{style.rounded(part['_life'].median(), 3)} {unit}" for part in (low, high)]
    return (
        f"The fifth of the cases with the lowest friction (up to {style.rounded(low[x].max(), 3)}) has a median "
        f"life of {said[0]}, the fifth with the highest (from {style.rounded(high[x].min(), 3)}) one of {said[1]}."
    )


def change_sentence(what: str, y0: float, y1: float, x0: float, x1: float, where: str, result: str) -> str:
    """'Raising friction from 0.02 to 0.4 shortens life by a factor of 7.3 (where).'"""
    ratio = y1 / y0
    place = f" ({where})" if where else ""
    span = f"Raising {what} from {style.rounded(x0, 3)} to {style.rounded(x1, 3)}"
    if 0.98 < ratio < 1.02:
        return f"{span} leaves the {result} unchanged within 2 %{place}."
    verb = "shortens" if ratio < 1 else "lengthens"
    return f"{span} {verb} the {result} by a factor of {style.rounded(max(ratio, 1 / ratio), 3)}{place}."


def _thinned(rows: pd.DataFrame, grid: bool) -> pd.DataFrame:
    return rows if grid or len(rows) <= MAX_POINTS else rows.sample(MAX_POINTS, random_state=0)
