"""Draw the contact models side by side for a study with them as a factor: errors, friction energy, stress, life."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from trackroller.analysis.contact_models import GOOD, errors, measured, pairs
from trackroller.analysis.table import StudyView
from trackroller.report.figures import style
from trackroller.report.figures.comparison_panels import Frame, frame, line, panels, rolling
from trackroller.report.figures.panels import capped, legend, mark_unlimited
from trackroller.report.numbers import capital, percent, with_unit
from trackroller.report.words.comparison import gap, short

Values = Callable[[xr.Dataset], xr.DataArray]
LEAST = 6e-4  # error at the lower end of the axes [1]


def drawers(view: StudyView) -> list[partial[style.Drawn]]:
    """Return the functions that draw the figures of the comparison.

    There are none for a study with one contact model or without pairs of cases.

    Parameters
    ----------
    view : the study as a table
    """
    paired = pairs(view)
    if paired is None or not paired.sizes["design"] or not measured(deviations := errors(paired)):
        return []
    draws = (error, energy, peak_and_life)
    return [partial(draw, paired, deviations) for draw in draws]


def _lines(shown: Frame, axes: Any, values: Values) -> dict[str, Any]:
    """Draw one line for each model in every column of a row of panels.

    The lines of several cases are their medians; the reference has a band.
    """
    handles, rolls = {}, rolling(shown.ds)
    for model in map(str, shown.ds["contact_model"].values):
        own = np.where(rolls, values(shown.ds.sel(contact_model=model)).values, np.nan)
        for column, panel in enumerate(axes):
            band = shown.bands(own, column)
            shade = shown.many and model == shown.ds.attrs["reference"]
            handles[model] = line(panel, shown.x, band, model, shade)
    return handles


def _close(figure: Any, handles: dict[str, Any], title: str) -> None:
    legend(figure, handles)
    style.head(figure, title)


def _lines_words(shown: Frame) -> str:
    """Say for a caption what the lines are, and which factors are held."""
    many = f" Lines: medians of the cases; band: 5 to 95 % with {shown.ds.attrs['reference']}." if shown.many else ""
    return f"{many} {shown.held}".rstrip()


def error(paired: xr.Dataset, deviations: xr.Dataset) -> style.Drawn:
    """Draw the error of the cheaper models against the reference over friction and drive."""
    shown = frame(paired)
    wanted = [q for q in measured(deviations) if q.name not in ("friction_energy_balance", "stick")]
    if shown is None or not wanted:
        return None
    figure, axes = panels(shown, [f"{q.label}\nerror [%]" for q in wanted], 27.0)
    handles: dict[str, Any] = {}
    for row, q in zip(axes, wanted, strict=True):
        top = 1.0
        for model in map(str, deviations["contact_model"].values):
            e = np.clip(deviations[q.name].sel(contact_model=model).values, LEAST, 1e3)
            for column, panel in enumerate(row):
                band = 100 * shown.bands(e, column)
                handles[f"{model} against {paired.attrs['reference']}"] = line(panel, shown.x, band, model, shown.many)
                top = float(np.nanmax([top, np.nanmax(band, initial=0.0)]))
        for panel in row:
            panel.axhline(100 * GOOD, color="0.35", linewidth=0.8, linestyle=(0, (1, 2)), zorder=0)
            panel.set_yscale("log")
            panel.set_ylim(0.05, max(100.0, 1.5 * top))
    _close(figure, handles, "Errors of the cheaper contact models")
    many = " Lines: medians of the cases; bands: 5 to 95 %." if shown.many else ""
    caption = (
        f"Error of the cheaper contact models against {paired.attrs['reference']}, at the worse contact of the cases "
        f"that roll. Dotted: {percent(GOOD)}. Marks at the lower end: {percent(LEAST)} or less.{many}"
    )
    return figure, style.FigureInfo("models-error", caption, short(paired)[0])


def energy(paired: xr.Dataset, deviations: xr.Dataset) -> style.Drawn:
    """Draw the friction energy of both contacts per distance.

    It is the sum over the patches, and for comparison the work of the resultants.
    """
    name, balance = "friction_energy_per_distance", "friction_energy_balance"
    shown = frame(paired, hold=True)
    if shown is None or name not in paired:
        return None
    figure, axes = panels(shown, ["Friction energy of both\ncontacts per distance [J/m]"], 40.0)
    handles = _lines(shown, axes[0], lambda one: one[name].sum("contact", skipna=False))
    if "sliding" in handles and balance in paired:
        handles = {f"{m}, local product" if m == "sliding" else m: h for m, h in handles.items()}
        implied = shown.ds[balance].sel(contact_model="sliding").sum("contact", skipna=False)
        own = np.where(rolling(shown.ds), implied.values, np.nan)
        look = {"linestyle": "-.", "markerfacecolor": "white"}
        for column, panel in enumerate(axes[0]):
            drawn = line(panel, shown.x, shown.bands(own, column), "sliding", False, **look)
            handles["sliding, from the resultants"] = drawn
    axes[0, 0].set_yscale("log")
    style.log_ticks(axes[0, 0].yaxis, *axes[0, 0].get_ylim())
    _close(figure, handles, "Friction energy by contact model")
    caption = (
        "Friction energy of both contacts per distance, where the roller rolls. The paper computes the local product "
        "of traction and slip; the energy from the resultants is the work that drive and tilting forces put in."
        f"{_lines_words(shown)}"
    )
    return figure, style.FigureInfo("models-energy", caption, gap(deviations, "friction_energy"))


def peak_and_life(paired: xr.Dataset, deviations: xr.Dataset) -> style.Drawn:
    """Draw the peak von Mises stress of the roller, or of the only body with stresses, and the life."""
    rows: list[tuple[str, Values]] = []
    shown = frame(paired, hold=True)
    if shown is None:
        return None
    if "peak_stress" in paired:
        bodies = list(map(str, paired["body"].values))
        body = "roller" if "roller" in bodies else bodies[0]
        rows.append((f"Peak stress of\nthe {body} [MPa]", lambda one: one["peak_stress"].sel(body=body).max("contact")))
    height = None
    if "life" in paired:
        capped_life, height = capped(shown.ds["life"].values)
        lives = shown.ds["life"].copy(data=capped_life)
        label = with_unit(capital(paired.attrs["life"]), paired["life"].attrs["units"])
        rows.append((label.replace(" of ", " of\n"), lambda one: lives.sel(contact_model=one["contact_model"].item())))
    if not rows:
        return None
    figure, axes = panels(shown, [label for label, _ in rows], 33.0)
    handles: dict[str, Any] = {}
    for row, (_, values) in zip(axes, rows, strict=True):
        handles |= _lines(shown, row, values)
    if "life" in paired:
        lived = lives.values[np.isfinite(lives.values)]
        for panel in axes[-1]:
            panel.set_yscale("log")
            mark_unlimited(panel, height)
        style.log_ticks(axes[-1, 0].yaxis, float(lived.min()), float(lived.max()))
    _close(figure, handles, "Peak stress and life by contact model")
    caption = f"Peak von Mises stress and life by contact model, at the worse of the two contacts.{_lines_words(shown)}"
    return figure, style.FigureInfo("models-peak-life", caption, gap(deviations, "peak_stress"))
