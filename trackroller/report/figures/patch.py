"""Figures of one contact by itself: its creep curve, and pressure and tractions of one of its
cases.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from trackroller.parameters.patch_fields import CREEPAGES
from trackroller.report.figures import style
from trackroller.report.figures.panels import legend
from trackroller.report.numbers import rounded

PER_CENT = 100.0
WORDS = {
    "longitudinal_creepage": ("longitudinal creepage [%]", PER_CENT),
    "lateral_creepage": ("lateral creepage [%]", PER_CENT),
    "spin": ("spin creepage [1/mm]", 1.0),
}
HALF_STUCK = 0.5  # share of the adhesion area of the case whose fields are drawn


def along_cases(ds: xr.Dataset) -> xr.Dataset:
    """Return a result with the dimension `case`, which a single one lacks."""
    if "case" in ds.dims:
        return ds
    return ds.expand_dims("case")


def varied_creepage(ds: xr.Dataset) -> str:
    """Return the creepage that varies between the cases; the longitudinal one if none or several
    do.
    """
    varied = [name for name in CREEPAGES if np.ptp(ds[name].values) > 0.0]
    if varied:
        return varied[0]
    return CREEPAGES[0]


def drawn_case(ds: xr.Dataset) -> int:
    """Return the number of the case in which adhesion and slip share the contact most evenly."""
    return int(np.argmin(np.abs(ds["stick_area_fraction"].values - HALF_STUCK)))


def creep_curve(ds: xr.Dataset) -> style.Drawn:
    """Draw force over its bound and adhesion area over the creepage that varies.

    Parameters
    ----------
    ds : result of `trackroller.patch`

    Returns
    -------
    The figure and its caption; None for a single case.
    """
    own = along_cases(ds)
    if own.sizes["case"] < 2:
        return None
    name = varied_creepage(own)
    words, scale = WORDS[name]
    order = np.argsort(own[name].values, kind="stable")
    x = scale * own[name].values[order]
    figure, (axes,) = style.panels("Creep curve", 75)
    bound = (own["friction_coefficient"] * own["normal_force"]).values
    curves = [
        ("longitudinal force over mu F_N", -own["driving_force"].values / bound),
        ("lateral force over mu F_N", -own["lateral_force"].values / bound),
        ("adhesion area over the patch", own["stick_area_fraction"].values),
    ]
    entries = []
    for (label, values), colour, line in zip(curves, style.COLOURS, style.LINES, strict=False):
        axes.plot(x, values[order], color=colour, linestyle=line, marker=".")
        entries.append((label, {"color": colour, "linestyle": line}))
    axes.set(xlabel=words)
    legend(figure, entries)
    caption = (
        "Friction forces against the creepage over the largest friction force at rest, and share "
        "of the adhesion area. Each point is a solved case."
    )
    return figure, style.FigureInfo("patch_creep_curve", caption)


def fields(ds: xr.Dataset) -> style.Drawn:
    """Draw pressure and shear traction of one case: maps of an ellipse, and their course along the
    middle.

    Parameters
    ----------
    ds : result of `trackroller.patch`

    Returns
    -------
    The figure and its caption.
    """
    own = along_cases(ds)
    case = drawn_case(own)
    one = own.isel(case=case)
    x, y = one["patch_x"].values, one["patch_y"].values
    shear = np.hypot(one["shear_lateral"].values, one["shear_rolling"].values)
    pressure = one["pressure"].values
    discs = ds.attrs["kind"] == "discs"
    count = 3
    if discs:
        count = 1
    figure, panels = style.panels("Pressure and shear traction", 75, count)
    middle = len(x) // 2
    axes = panels[-1]
    bound = float(one["friction_coefficient"]) * pressure[:, middle]
    entries = [
        ("friction at rest times pressure", {"color": "0.5", "linestyle": ":"}),
        ("shear traction", {"color": style.COLOURS[0], "linestyle": "-"}),
    ]
    for (_, look), values in zip(entries, (bound, shear[:, middle]), strict=True):
        axes.plot(y, values, **look)
    axes.set(xlabel="rolling direction [mm]", ylabel="along the middle [MPa]", ylim=(0.0, None))
    if not discs:
        for axes, values, words in zip(
            panels, (pressure, shear), ("pressure", "shear traction"), strict=False
        ):
            image = axes.pcolormesh(
                x, y, np.where(pressure > 0.0, values, np.nan), cmap="cividis", shading="nearest"
            )
            axes.grid(False)
            axes.set(title=f"{words} [MPa]", xlabel="lateral [mm]")
            figure.colorbar(image, ax=axes, location="bottom", pad=0.02)
        panels[0].set_ylabel("rolling direction [mm]")
    legend(figure, entries)
    parts = ", ".join(
        f"{WORDS[name][0].split(' [')[0]} {_creepage_text(one, name)}" for name in CREEPAGES
    )
    caption = (
        f"Case {case}: {parts}. New material enters at the largest place in the rolling direction. "
        "Where the traction is below the friction, the surfaces stick."
    )
    return figure, style.FigureInfo("patch_fields", caption)


def _creepage_text(one: xr.Dataset, name: str) -> str:
    unit = " /mm"
    if name != "spin":
        unit = " %"
    return f"{rounded(WORDS[name][1] * float(one[name]))}{unit}"
