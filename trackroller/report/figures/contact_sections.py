"""Von Mises stress in the two planes through the peak, for both bodies of a contact."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from trackroller.report.figures import style
from trackroller.report.figures.contact_outline import widths
from trackroller.report.figures.contact_patch import case_text
from trackroller.report.numbers import rounded

PLANES = (
    ("von_mises_xz", "xz_x", "xz_z", "x", "lateral"),
    ("von_mises_yz", "yz_y", "yz_z", "y", "rolling"),
)


def sections(ds: xr.Dataset, contact: int) -> tuple[Figure, style.FigureInfo] | None:
    """Lateral and rolling section of roller and guide under one contact, the peak marked."""
    if not all(n in ds for n in ("von_mises_xz", "von_mises_yz", "xz_x", "xz_z", "yz_y", "yz_z")):
        return None
    part = ds.sel(contact=contact)
    bodies = [str(b) for b in part["body"].values if np.isfinite(part["von_mises_xz"].sel(body=b)).any()]
    if not bodies:
        return None
    heights = [_height(part.sel(body=bodies[0]), plane) for plane in PLANES] * len(bodies)
    figure = style.new_figure(30 + sum(heights) + 10 * len(heights))
    grid = figure.subplots(len(heights), 1, squeeze=False, height_ratios=heights)[:, 0]
    top = float(np.nanmax([part[p[0]].max() for p in PLANES]))
    image: Any = None
    if "peak_stress" in part:
        top = max(top, float(part["peak_stress"].max()))
    for i, body in enumerate(bodies):
        for j, plane in enumerate(PLANES):
            image = _section(grid[2 * i + j], part.sel(body=body), body, plane, top)
    bar = figure.colorbar(image, ax=list(grid), location="bottom", aspect=35, pad=0.01, ticks=MaxNLocator(6))
    bar.set_label("Von Mises stress [MPa]")
    flat = (
        "" if all(_to_scale(part.sel(body=bodies[0]), p) for p in PLANES) else " Flat sections are stretched in depth."
    )
    style.head(
        figure,
        f"Von Mises stress under contact {contact}",
        f"{case_text(ds)} Cross: peak; black bar: width of the patch.{flat}",
    )
    style.finish(figure)
    caption = (
        f"Von Mises stress (MPa) under contact {contact} in the lateral and the rolling section plane through the peak "
        f"of each body; depth counts into the body, the cross marks the peak. {case_text(ds)}"
    )
    return figure, style.FigureInfo(f"contact_{contact}_stress", caption, _sentence(part, bodies))


def _height(part: xr.Dataset, plane: tuple[str, ...]) -> float:
    """Height [mm] of a panel 66 mm wide that shows the section to scale, within what can be read."""
    across, depth = part[plane[1]].values, part[plane[2]].values
    return float(np.clip(66 * np.ptp(depth) / np.ptp(across), 20, 40))


def _to_scale(part: xr.Dataset, plane: tuple[str, ...]) -> bool:
    return bool(20 < 66 * np.ptp(part[plane[2]].values) / np.ptp(part[plane[1]].values))


def _section(axes: Axes, part: xr.Dataset, body: str, plane: tuple[str, ...], top: float) -> Any:
    name, across, down, axis, words = plane
    x, z, stress = part[across].values, part[down].values, part[name].values
    levels = np.linspace(0, top, 17)
    image = axes.contourf(x, z, np.clip(stress, 0, top), levels=levels, cmap="cividis")
    axes.contour(x, z, stress, levels=levels[2::2], colors="white", linewidths=0.35, alpha=0.7)
    axes.set_ylim(float(z.max()), float(z.min()) - 0.03 * float(np.ptp(z)))
    axes.set_aspect("equal" if _to_scale(part, plane) else "auto", anchor="W")
    for ends in widths(part, axis):
        axes.plot(ends, [0, 0], color="black", linewidth=2.2, solid_capstyle="butt", clip_on=False, zorder=4)
    other = "y" if axis == "x" else "x"
    place = ""
    if f"peak_{other}" in part:
        place = f", plane ${other}_\\mathrm{{C}}$ = {rounded(float(part[f'peak_{other}']), 2)} mm"
    axes.set_title(f"{body.capitalize()}, {words} section{place}", loc="left", fontsize=7.5, pad=4)
    axes.set_xlabel(f"${axis}_\\mathrm{{C}}$ ({words}) [mm]", labelpad=1)
    axes.set_ylabel("Depth $z_\\mathrm{C}$ [mm]")
    axes.locator_params(axis="x", nbins=6)
    axes.locator_params(axis="y", nbins=5)
    axes.grid(False)
    _mark_peak(axes, part, axis)
    return image


def _mark_peak(axes: Axes, part: xr.Dataset, axis: str) -> None:
    if not all(n in part for n in ("peak_stress", f"peak_{axis}", "peak_z")):
        return
    x, z, value = (float(part[n]) for n in (f"peak_{axis}", "peak_z", "peak_stress"))
    if not np.isfinite(x + z + value):
        return
    axes.plot(x, z, marker="x", color="white", markersize=7, markeredgewidth=2.6, zorder=5, clip_on=False)
    axes.plot(x, z, marker="x", color="black", markersize=6, markeredgewidth=1.3, zorder=6, clip_on=False)
    right = x < 0.25 * axes.get_xlim()[1]
    axes.annotate(
        f"{value:.0f} MPa",
        (x, z),
        xytext=(8 if right else -8, -8),
        textcoords="offset points",
        fontsize=6.8,
        ha="left" if right else "right",
        va="center",
        zorder=7,
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.0, "alpha": 0.9},
    )


def _sentence(part: xr.Dataset, bodies: list[str]) -> str:
    if "peak_stress" not in part or "peak_z" not in part:
        return "The peak was not computed."
    said = []
    for body in bodies:
        value, depth = float(part["peak_stress"].sel(body=body)), float(part["peak_z"].sel(body=body))
        where = "at the surface" if depth < 1e-3 else f"{rounded(depth, 2)} mm deep"
        said.append(f"{value:.0f} MPa {where} in the {body}")
    return f"The peak is {' and '.join(said)}."
