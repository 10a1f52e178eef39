"""Peak stress against fit, and the forces of both contacts against axial force."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.report.figures import style
from trackroller.report.figures.study_life import drive_entries, legend, marks
from trackroller.report.figures.study_view import StudyView

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

CLOUD = 400  # cases of a sample drawn, where more would hide each other
FORCES = (
    ("normal_force", "Normal force", r"$F_\mathrm{N}$"),
    ("lateral_force", "Lateral force", r"$F_\mathrm{T}$"),
    ("driving_force", "Driving force", r"$F_\mathrm{A}$"),
)


def add_fit(view: StudyView, rows: pd.DataFrame) -> tuple[pd.DataFrame, str]:
    """Rows with a column `_fit`, and its axis label.

    Fit is groove over guide radius; where a roller is straight or convex the ratio is turned over, so that
    it passes through 0 instead of infinity.
    """
    rows = rows.copy()
    roller = rows.get("roller_profile_radius", view.base.get("roller_profile_radius"))
    guide = rows.get("guide_profile_radius", view.base.get("guide_profile_radius"))
    roller, guide = (np.broadcast_to(np.asarray(v, dtype=float), len(rows)) for v in (roller, guide))
    r_t, r_g = style.SYMBOLS["r_C,TR"], style.SYMBOLS["r_C,G"]
    if np.all((roller < 0) & np.isfinite(roller)):
        rows["_fit"] = -roller / guide
        return rows, f"Fit: groove over guide radius $-${r_t}/{r_g} [–]"
    rows["_fit"] = -guide / roller
    return rows, f"Fit: guide over groove radius $-${r_g}/{r_t} [–]"


def stress_against_fit(view: StudyView) -> tuple[Figure, style.FigureInfo] | None:
    """Peak von Mises stress over the fit, by friction; filled marks at the surface, hollow ones below."""
    fits = next((f for f in map(view.behind, ("roller_profile_radius", "guide_profile_radius")) if f), ())
    bodies = [b for b in ("roller", "guide") if view.has(f"peak_stress_{b}")]
    if not fits or not bodies:
        return None
    hues = ("friction_coefficient", "material_pair", "motor_force")
    hue = next((f for f in hues if f in view.factors and f not in fits), None)
    rows, held = view.hold((*fits, hue) if hue else fits)
    rows, label = add_fit(view, rows)
    groups = _stress_groups(view, rows, hue)
    colours = style.palette(len(groups))
    figure = style.new_figure(20 + 40 * len(bodies) + 3.6 * (len(groups) + 2))
    panels = figure.subplots(len(bodies), 1, sharex=True, sharey=True, squeeze=False)[:, 0]
    for axes, body in zip(panels, bodies, strict=True):
        for i, (_, part) in enumerate(groups):
            _stress_series(axes, part, body, colours[i], style.MARKERS[i], style.LINES[i % 6], view.grid)
        axes.set_title(body.capitalize(), loc="left", fontsize=7.5, pad=3)
        axes.set_ylabel(style.with_unit("Peak von Mises\nstress", "MPa"))
        axes.set_ylim(bottom=0) if not view.grid else axes.margins(y=0.12)
    panels[-1].set_xlabel(label)
    line = {"linestyle": "none"} if not view.grid else {}
    entries: list[tuple[str, dict[str, Any]]] = [
        (text, {"color": colours[i], "marker": style.MARKERS[i], "linestyle": style.LINES[i % 6], **line})
        for i, (text, _) in enumerate(groups)
        if text
    ]
    dot = {"color": "0.3", "marker": "o", "linestyle": "none"}
    entries += [("filled: peak at the surface", dot), ("hollow: peak below it", {**dot, "markerfacecolor": "white"})]
    legend(figure, entries, columns=2 if all(len(t) < 30 for t, _ in entries) else 1)
    style.head(figure, "Peak stress against fit", held)
    style.finish(figure)
    return figure, _stress_info(view, rows, bodies[0], hue, held)


def _stress_groups(view: StudyView, rows: pd.DataFrame, hue: str | None) -> list[tuple[str, pd.DataFrame]]:
    """At most five lines: of a numeric factor lowest, highest, base and between; all of a sample in thirds."""
    if hue is None:
        return [("", rows)]
    levels = view.levels(hue, rows)
    name = "μ = " if hue == "friction_coefficient" else ""
    if not view.grid and view.numeric(hue) and len(levels) > 5:
        rows = rows if len(rows) <= 3 * CLOUD else rows.sample(3 * CLOUD, random_state=0)
        edges = np.quantile(rows[hue], [0, 1 / 3, 2 / 3, 1])
        return [
            (
                f"{name}{edges[i]:.3g} … {edges[i + 1]:.3g}",
                rows[(rows[hue] >= edges[i]) & ((rows[hue] < edges[i + 1]) | (i == 2))],
            )
            for i in range(3)
        ]
    if view.numeric(hue) and len(levels) > 5:
        wanted = {0, len(levels) - 1, len(levels) // 2, levels.index(view.held_level(hue))}
        levels = [levels[i] for i in sorted(wanted)]
    return [(name + style.level_text(hue, v), rows[rows[hue] == v]) for v in levels]


def _stress_series(axes, part, body: str, colour, marker: str, line, grid: bool) -> None:
    part = part.sort_values("_fit")
    y = f"peak_stress_{body}"
    if grid:
        axes.plot(part["_fit"], part[y], color=colour, linestyle=line, zorder=2)
    flag = part.get(f"at_surface_{body}")
    surface = np.ones(len(part), dtype=bool) if flag is None else (flag == 1).to_numpy()
    marks(axes, part, "_fit", y, colour, marker, 15 if grid else 8, surface)


def _stress_info(view: StudyView, rows: pd.DataFrame, body: str, hue: str | None, held: str) -> style.FigureInfo:
    caption = (
        "Peak von Mises stress (MPa) of roller and guide, the worse of the two contacts, over the fit of groove "
        f"and guide. Filled marks: the peak lies at the surface; hollow marks: below it. {held}"
    )
    y, flag = f"peak_stress_{body}", f"at_surface_{body}"
    good = rows[np.isfinite(rows[y])].sort_values("_fit")
    if len(good) < 2:
        return style.FigureInfo("stress_against_fit", caption, "Too few cases have a peak stress to state a trend.")
    if view.grid and hue:
        good = good[good[hue] == view.held_level(hue)]
    fifth = 1 if view.grid else max(len(good) // 5, 1)
    low, high = good.iloc[:fifth], good.iloc[-fifth:]
    sentence = (
        f"From a fit of {style.rounded(low['_fit'].median(), 3)} to {style.rounded(high['_fit'].median(), 3)} the "
        f"{'' if view.grid else 'median '}peak stress of the {body} goes from "
        f"{style.rounded(low[y].median(), 3)} to {style.rounded(high[y].median(), 3)} MPa"
    )
    if flag in rows and np.isfinite(rows[flag]).any():
        sentence += f"; it lies {surface_share(rows[flag].to_numpy())}"
    return style.FigureInfo("stress_against_fit", caption, sentence + ".")


def surface_share(flags: np.ndarray) -> str:
    """'at the surface in 40 % of the cases' from flags (1 surface, 0 below, NaN unknown), shape (n,)."""
    share = float(np.nanmean(flags))
    if share in (0.0, 1.0):
        return "at the surface in every case" if share else "below the surface in every case"
    return f"at the surface in {max(1.0, min(99.0, 100 * share)):.0f} % of the cases"


def forces_against_axial(view: StudyView) -> tuple[Figure, style.FigureInfo] | None:
    """Normal, lateral and driving force of both contacts over the axial force, by drive."""
    x = "axial_force"
    if not view.behind(x) or not view.numeric(x):
        return None
    kinds = [k for k in FORCES if f"{k[0]}_1" in view.table and (view.has(f"{k[0]}_1") or view.has(f"{k[0]}_2"))]
    if not kinds:
        return None
    drive = "motor_force" if "motor_force" in view.factors and len(view.levels("motor_force")) <= 5 else None
    rows, held = view.hold((*view.behind(x), drive) if drive else view.behind(x))
    drives = view.levels(drive, rows) if drive else [None]
    every = rows
    if not view.grid and len(rows) > CLOUD:
        rows = rows.sample(CLOUD, random_state=0)
        held = f"{CLOUD} of the {len(every)} cases of the sample."
    colours = style.palette(3)
    figure = style.new_figure(22 + 32 * len(kinds) + 4 * (len(drives) + 1))
    panels = figure.subplots(len(kinds), 1, sharex=True, squeeze=False)[:, 0]
    for axes, (name, words, symbol) in zip(panels, kinds, strict=True):
        for contact in (1, 2):
            for j, level in enumerate(drives):
                part = (rows if level is None else rows[rows[drive] == level]).sort_values(x)
                _force_series(
                    axes, part, x, f"{name}_{contact}", contact, colours[contact - 1], style.LINES[j % 6], view.grid
                )
        axes.set_ylabel(style.with_unit(f"{words}\n{symbol}", "N"))
        axes.margins(y=0.1)
    _shade_lift_off(panels, rows, x, view.grid)
    panels[-1].set_xlabel(style.factor_label(x))
    entries: list[tuple[str, dict[str, Any]]] = [
        (
            f"contact {c}",
            {
                "color": colours[c - 1],
                "marker": "os"[c - 1],
                "linestyle": "none",
                "markerfacecolor": colours[0] if c == 1 else "none",
            },
        )
        for c in (1, 2)
    ]
    if drive and view.grid:
        entries += drive_entries(drives)
    legend(figure, entries, columns=2)
    style.head(figure, "Forces of both contacts against axial force", held)
    style.finish(figure)
    return figure, _force_info(every, held, len(drives))


def _force_series(axes, part, x: str, y: str, contact: int, colour, line, grid: bool) -> None:
    if grid:
        axes.plot(part[x], part[y], color=colour, linestyle=line, zorder=2)
    size = ((10, 20) if grid else (5, 9))[contact - 1]
    marks(axes, part, x, y, colour, "os"[contact - 1], size, contact == 1)


def _shade_lift_off(panels, rows: pd.DataFrame, x: str, grid: bool) -> None:
    """Shade the axial forces at which a contact lifts off in every line; a sample has no such limit."""
    if not grid or "regime" not in rows:
        return
    lifted = rows.groupby(x)["regime"].apply(lambda r: bool((r == 2).all()))
    values = lifted.index.to_numpy()
    halves = np.concatenate([values[:1], (values[1:] + values[:-1]) / 2, values[-1:]])
    for i in np.flatnonzero(lifted.to_numpy()):
        for axes in panels:
            axes.axvspan(
                halves[i],
                halves[i + 1],
                facecolor=style.REGIME_COLOURS[2],
                alpha=0.25,
                hatch="xxxx",
                edgecolor="white",
                linewidth=0,
                zorder=0,
            )
    if lifted.any():
        i = np.flatnonzero(lifted.to_numpy())[0]
        panels[0].annotate(
            "lift-off",
            (halves[-1], 0.3),
            xycoords=("data", "axes fraction"),
            ha="right",
            fontsize=6.8,
            bbox={"facecolor": "white", "edgecolor": "none", "pad": 1},
        )


def _force_info(rows: pd.DataFrame, held: str, drives: int) -> style.FigureInfo:
    caption = (
        "Forces (N) of contact 1 (filled circles) and contact 2 (open squares) on the roller over the axial force"
        + (f", for {drives} motor forces" if drives > 1 else "")
        + f". {held}"
    )
    name = "forces_against_axial_force"
    regime = rows["regime"] if "regime" in rows else np.zeros(len(rows))
    axial = rows["axial_force"].to_numpy()
    lifted = axial[regime == 2]
    if lifted.size:
        first = style.number(lifted[np.argmin(np.abs(lifted))])
        sentence = f"{lifted.size} of {len(rows)} cases lift off, the first at an axial force of {first} N."
        return style.FigureInfo(name, caption, sentence)
    if "normal_force_1" not in rows:
        return style.FigureInfo(name, caption, "The normal forces are not part of this study.")
    both = rows[["normal_force_1", "normal_force_2"]].to_numpy()
    good = np.isfinite(both).all(axis=1)
    if good.sum() < 2:
        return style.FigureInfo(name, caption, "Too few cases have forces in both contacts to compare them.")
    last = np.flatnonzero(good)[np.argmax(np.abs(axial[good]))]
    one, two = (style.number(v) for v in both[last])
    at = style.number(axial[last])
    sentence = f"At an axial force of {at} N the contacts carry {one} and {two} N; no case lifts off."
    return style.FigureInfo(name, caption, sentence)
