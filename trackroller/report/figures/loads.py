"""Peak stress against fit, and the forces of both contacts against axial force."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from trackroller.parameters import BODIES
from trackroller.report.figures import style
from trackroller.report.figures.levels import coloured, held_words
from trackroller.report.figures.panels import Entries, legend, running
from trackroller.report.numbers import factor_label, level_text, listing, symbol, with_unit
from trackroller.results.ranking import ranked_factors
from trackroller.results.results import Results
from trackroller.study.design.levels import OF_MATERIALS

SAME = 0.9  # rank correlation above which a factor carries the same information as the fit
# names of the levels that share a line, and their rows
Groups = list[tuple[list[str], pd.DataFrame]]
MEDIANS = "Lines: medians of the cases; bands: 5 to 95 %."
FORCES = (
    ("normal_force", "Normal force", r"$F_\mathrm{N}$"),
    ("lateral_force", "Lateral force", r"$F_\mathrm{T}$"),
    ("driving_force", "Driving force", r"$F_\mathrm{A}$"),
)


def stress_against_fit(results: Results) -> style.Drawn:
    """Draw peak stress over the fit, coloured by what decides it beside the fit.

    It answers: how much stress does a closer groove save, and does it move the peak from below to
    the surface? Where the cases of a line all have different fits, marks are filled if the peak
    lies at the surface; otherwise the lines are medians with bands.
    """
    fits = next(
        (f for f in map(results.behind, ("roller_profile_radius", "guide_profile_radius")) if f), ()
    )
    bodies = [b for b in BODIES if results.has(f"peak_stress_{b}")]
    if not fits or not bodies:
        return None
    hue = _hue(results, f"peak_stress_{bodies[0]}", fits)
    rows, levels_held = results.hold(tuple(name for name in (*fits, hue) if name))
    rows, label = add_fit(results, rows[results.rolling[rows.index]])
    if rows["_fit"].nunique() < 2:
        return None
    columns = [f"peak_stress_{body}" for body in bodies]
    levels = _levels(results, hue, rows)
    groups = [([text], rows[mask]) for text, mask in levels]
    single = results.grid and not any(part["_fit"].duplicated().any() for _, part in groups)
    if single:
        groups = _merged(groups, columns)
    figure, panels = style.panels(
        "Peak stress against fit",
        64 + 3.6 * (len(groups) + 2),
        len(bodies),
        sharex=True,
        sharey=True,
    )
    entries: Entries = []
    names = [text for text, _ in levels]
    colours = style.colours(names, hue in OF_MATERIALS)
    for texts, part in groups:
        i = names.index(texts[0])
        look = {"color": colours[i], "marker": style.MARKERS[i], "linestyle": style.LINES[i % 6]}
        if hue:
            entries += [(listing(texts), look)]
        for axes, body in zip(panels, bodies, strict=True):
            _stress_series(axes, part, body, look, single)
    for axes, body in zip(panels, bodies, strict=True):
        axes.set(title=body.capitalize(), ylim=(0, None), xlabel=label)
    panels[0].set_ylabel(with_unit(r"Peak von Mises stress $\sigma_\mathrm{DEH}$", "MPa"))
    marks = MEDIANS
    if single:
        marks = "Filled marks: the peak lies at the surface; hollow marks: below it."
        entries += _entries_of_places()
    legend(figure, entries, 2)
    caption = (
        "Peak von Mises stress (MPa) of roller and guide, the worse of the two contacts, over the "
        f"fit of groove and guide; rolling cases. {marks} {held_words(levels_held)}"
    )
    return figure, style.FigureInfo("stress_against_fit", caption.strip())


def _entries_of_places() -> Entries:
    """Return what the legend says of marks by the place of the peak."""
    dot = {"color": "0.3", "marker": "o", "linestyle": "none"}
    return [
        ("filled: at the surface", dot),
        ("hollow: below it", {**dot, "markerfacecolor": "white"}),
    ]


def _levels(results: Results, hue: str, rows: pd.DataFrame) -> list[tuple[str, np.ndarray]]:
    """Return the levels of the factor that decides the colour, each with its rows; one level
    without such a factor.
    """
    if not hue:
        return [("", np.ones(len(rows), bool))]
    inside = np.isin(np.arange(len(results.table)), rows.index)
    return coloured(results, hue, inside)


def _hue(results: Results, column: str, fits: tuple[str, ...]) -> str:
    """Return the factor besides the fit that decides the peak stress, '' if there is none.

    In a sample a factor that decides the fit does not count beside it.
    """
    fit = add_fit(results, results.table)[0]["_fit"]
    same = [
        f
        for f in results.factors
        if results.numeric(f) and abs(fit.corr(results.table[f], method="spearman")) > SAME
    ]
    others = tuple(f for f in results.factors if f not in fits and f not in same)
    return next(iter(ranked_factors(results.analysis, column, others)), "")


def add_fit(results: Results, rows: pd.DataFrame) -> tuple[pd.DataFrame, str]:
    """Return rows with a column `_fit`, and its axis label.

    Fit is groove over guide radius; where a roller is straight or convex the ratio is inverted, so
    that it passes through 0 instead of infinity.
    """
    rows = rows.copy()
    names = ("roller_profile_radius", "guide_profile_radius")
    radii = (np.asarray(rows.get(name, results.base.get(name)), dtype=float) for name in names)
    roller, guide = (np.broadcast_to(radius, len(rows)) for radius in radii)
    r_t, r_g = symbol("r_C,TR"), symbol("r_C,G")
    if np.all((roller < 0) & np.isfinite(roller)):
        rows["_fit"] = -roller / guide
        return rows, f"Fit: groove over guide radius $-${r_t}/{r_g} [–]"
    rows["_fit"] = -guide / roller
    return rows, f"Fit: guide over groove radius $-${r_g}/{r_t} [–]"


def _merged(groups: Groups, columns: list[str]) -> Groups:
    """Join groups with the same stresses: materials that differ in strength alone."""
    alike: dict[tuple[str, ...], tuple[list[str], pd.DataFrame]] = {}
    for texts, part in groups:
        values = part.sort_values("_fit")[["_fit", *columns]].to_numpy(dtype=float)
        key = tuple(f"{value:.4g}" for value in values.ravel())
        alike.setdefault(key, ([], part))[0].extend(texts)
    return list(alike.values())


def _stress_series(
    axes: Any, part: pd.DataFrame, body: str, look: dict[str, Any], single: bool
) -> None:
    part = part.sort_values("_fit")
    y = f"peak_stress_{body}"
    if not single:
        return running(axes, part["_fit"].to_numpy(), part[y].to_numpy(), look)
    axes.plot(part["_fit"], part[y], color=look["color"], linestyle=look["linestyle"], zorder=2)
    flag = part.get(f"at_surface_{body}", pd.Series(1.0, part.index))
    faces = [look["color"] if lies == 1 else "white" for lies in flag]
    shown = {"s": 15, "marker": look["marker"], "linewidth": 0.8, "zorder": 3}
    return axes.scatter(part["_fit"], part[y], color=faces, edgecolor=look["color"], **shown)


def forces_against_axial(results: Results) -> style.Drawn:
    """Draw normal, lateral and driving force of both contacts over the axial force, by drive.

    It answers: how do the contacts share the load, and from which axial force on does one lift off?
    """
    x = "axial_force"
    if not results.behind(x) or not results.numeric(x):
        return None
    kinds = [
        k
        for k in FORCES
        if f"{k[0]}_1" in results.table and (results.has(f"{k[0]}_1") or results.has(f"{k[0]}_2"))
    ]
    if not kinds:
        return None
    drives: list[Any] = [None]  # one line for all drives
    shown = results.behind(x)
    if "motor_force" in results.factors and len(results.levels("motor_force")) <= 5:
        drives = results.levels("motor_force")
        shown = (*shown, "motor_force")
    rows, levels_held = results.hold(shown)
    figure, panels = style.panels(
        "Forces of both contacts against axial force", 74, len(kinds), sharex=True
    )
    looks = _looks_of_contacts(results.grid)
    for axes, (name, words, letter) in zip(panels, kinds, strict=True):
        for contact, look in enumerate(looks, 1):
            _force_lines(axes, rows, f"{name}_{contact}", drives, look, results.grid)
        axes.set(xlabel=factor_label(x), ylabel=with_unit(f"{words} {letter}", "N"))
        axes.margins(y=0.1)
    if results.grid:
        _shade_lift_off(panels, rows, x)
    entries: Entries = [(f"contact {c + 1}", looks[c] | {"linestyle": "none"}) for c in (0, 1)]
    for level, dashes in zip(drives, style.LINES, strict=False):
        if level is not None:
            look = {"color": "0.2", "linestyle": dashes}
            entries.append((level_text("motor_force", level), look))
    legend(figure, entries, 5)
    caption = _caption_of_forces(len(drives), levels_held, results.grid)
    return figure, style.FigureInfo("forces_against_axial_force", caption)


def _caption_of_forces(drives: int, levels_held: dict[str, Any], solved: bool) -> str:
    each = ""
    if drives > 1:
        each = f", for {drives} motor forces"
    note = MEDIANS
    if solved:
        note = held_words(levels_held)
    caption = (
        "Forces (N) of contact 1 (circles) and contact 2 (squares) on the roller over the axial "
        f"force{each}. {note}"
    )
    return caption.strip()


def _looks_of_contacts(solved: bool) -> list[dict[str, Any]]:
    """Return the looks of the lines of both contacts; `solved` is True where each mark is a solved
    case and no median.
    """
    marks: list[dict[str, Any]] = [{"marker": "o"}, {"marker": "s"}]
    if solved:
        marks = [
            {"marker": "o", "markersize": 3},
            {"marker": "s", "markersize": 4.5, "markerfacecolor": "white"},
        ]
    return [{"color": colour} | mark for colour, mark in zip(style.PAIR, marks, strict=True)]


def _force_lines(
    axes: Any,
    rows: pd.DataFrame,
    name: str,
    drives: Sequence[Any],
    look: dict[str, Any],
    solved: bool,
) -> None:
    """Draw a force over the axial force, one line for each drive; None stands for all drives."""
    for drive, dashes in zip(drives, style.LINES, strict=False):
        part = rows
        if drive is not None:
            part = rows[rows["motor_force"] == drive]
        part = part.sort_values("axial_force")
        own_look = look | {"linestyle": dashes}
        _force_series(axes, part["axial_force"], part[name], own_look, solved)


def _force_series(
    axes: Any, at: pd.Series, forces: pd.Series, look: dict[str, Any], solved: bool
) -> None:
    """Draw the solved forces of a grid, or the running median of the forces of a sample."""
    if solved:
        axes.plot(at.to_numpy(dtype=float), forces.to_numpy(dtype=float), **look)
    else:
        running(axes, at.to_numpy(dtype=float), forces.to_numpy(dtype=float), look)


def _shade_lift_off(panels: Any, rows: pd.DataFrame, x: str) -> None:
    """Shade the axial forces at which a contact lifts off in every line."""
    lifted = rows.groupby(x)["regime"].apply(lambda r: bool((r == 2).all()))
    values = lifted.index.to_numpy()
    halves = np.concatenate([values[:1], (values[1:] + values[:-1]) / 2, values[-1:]])
    look = {
        "facecolor": style.REGIME_COLOURS[2],
        "alpha": 0.25,
        "hatch": "xxxx",
        "edgecolor": "white",
        "linewidth": 0,
    }
    for i in np.flatnonzero(lifted.to_numpy()):
        for axes in panels:
            axes.axvspan(halves[i], halves[i + 1], zorder=0, **look)
    if lifted.any():
        box = {"facecolor": "white", "edgecolor": "none", "pad": 1}
        place = {"xycoords": ("data", "axes fraction"), "ha": "right", "fontsize": 7, "bbox": box}
        panels[0].annotate("lift-off", (halves[-1], 0.3), **place)
