"""Draw the von Mises stress of both bodies of a contact: in two planes through the peak, and on the
surface.

The roller stands above the guide as in the drawing of the README: x lateral, y in the rolling
direction, z into each body.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.patches import PathPatch

from trackroller.halfspace.stress import FRICTION_SIGNS, stress_on_grid, von_mises
from trackroller.report.figures import style
from trackroller.report.figures.contact_outline import DrawnPatch, case_text, outline, widths
from trackroller.report.numbers import near, rounded
from trackroller.results.case_columns import at_surface
from trackroller.roller.stored_inputs import MATERIALS, materials_of

PLANES = (
    ("von_mises_xz", "xz_x", "xz_z", "x", "lateral"),
    ("von_mises_yz", "yz_y", "yz_z", "y", "rolling"),
)
TRACTIONS = ("pressure", "shear_lateral", "shear_rolling")
AROUND = 0.25  # share of the traction grid by which the surface is shown beyond each of its ends
SLENDER = 2.5  # ratio of the sections above which they are not drawn to one scale
ROW_MM, SHARE_MM = 36.0, 125.0  # height of a row; width that the panels of a row share


def sections(ds: xr.Dataset, contact: int) -> style.Drawn:
    """Draw lateral section, rolling section and surface of roller and guide under one contact, the
    peak marked.

    It answers: where does each body break first, at the surface or below it, and how far does the
    stress reach?
    """
    if "von_mises_xz" not in ds:
        return None
    part = ds.sel(contact=contact)
    bodies = [
        str(b) for b in part["body"].values if np.isfinite(part["von_mises_xz"].sel(body=b)).any()
    ]
    if not bodies:
        return None
    surfaces = {
        body: stress for body in bodies if (stress := surface_stress(ds, contact, body)) is not None
    }
    shown = [part[plane[0]] for plane in PLANES]
    if "peak_stress" in part:
        shown.append(part["peak_stress"])
    top = float(np.nanmax([*(v.max() for v in shown), *(s[2].max() for s in surfaces.values())]))
    shares, height, to_scale = _panel_sizes(part.sel(body=bodies[0]), bool(surfaces))
    figure = style.new_figure(34 + (height + 7) * len(bodies))
    grid = figure.subplots(len(bodies), len(shares), squeeze=False, width_ratios=shares)
    image: Any = None
    for row, body in zip(grid, bodies, strict=True):
        for axes, plane in zip(row, PLANES, strict=False):
            image = _section(axes, part.sel(body=body), body, plane, (top, to_scale))
        if body in surfaces:
            _surface(
                row[2],
                DrawnPatch(ds, contact),
                part.sel(body=body),
                surfaces[body],
                (top, to_scale),
            )
    style.colour_bar(figure, image, list(grid.ravel()), "Von Mises stress [MPa]")
    style.head(figure, f"Von Mises stress under contact {contact}")
    surface_words = ""
    if surfaces:
        surface_words = " and on its surface"
    caption = (
        f"Von Mises stress (MPa) under contact {contact} in the lateral and the rolling section "
        f"plane through the peak of each body{surface_words}; z counts into the body. A cross "
        f"marks the peak; on the surface a ring marks a peak below it. {case_text(ds, to_scale)}"
    )
    return figure, style.FigureInfo(f"contact_{contact}_stress", caption, _sentence(part, bodies))


def _panel_sizes(part: xr.Dataset, with_surface: bool) -> tuple[list[float], float, bool]:
    """Return the shares of the width that the panels of a row have, the height of a row [mm], and
    whether lengths are drawn to one scale.
    """
    lateral = float(np.ptp(part["xz_x"].values))
    rolling = float(np.ptp(part["yz_y"].values))
    depth = float(np.ptp(part["xz_z"].values))
    to_scale = 1 / SLENDER < lateral / rolling < SLENDER
    shares = [1.0, 1.0]
    if to_scale:
        shares = [lateral, rolling]
    if with_surface:
        shares.append(shares[0])
        depth = max(rolling, depth)
    height = ROW_MM
    if to_scale:
        height = min(SHARE_MM * depth / sum(shares), 60.0)
    return shares, height, to_scale


def surface_stress(
    ds: xr.Dataset, contact: int, body: str
) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """Compute the von Mises stress on the surface of a body from the solved tractions.

    Parameters
    ----------
    ds : result of one case with its tractions and materials

    Returns
    -------
    x (nx) and y (ny) in the contact [mm] and the stress (ny, nx) [MPa], or None where tractions or
    materials are not known
    """
    patch = None
    if {"patch_x", "patch_y", *TRACTIONS} <= set(ds.variables):
        patch = DrawnPatch(ds, contact)
    if patch is None or not patch.there or MATERIALS not in ds.attrs:
        return None
    margin = [max(1, int(np.ceil(AROUND * v.size))) for v in (patch.y, patch.x)]
    x, y = _widened(patch.x, margin[1]), _widened(patch.y, margin[0])
    fields = [np.pad(patch.field(name), [(m, m) for m in margin]) for name in TRACTIONS]
    sign = FRICTION_SIGNS[("roller", "guide").index(body)]
    poisson = materials_of(ds)[f"{body}_material"]["poisson_ratio"]
    stress = stress_on_grid(x, y, fields[0], sign * fields[1], sign * fields[2], [0.0], poisson)
    return x, y, von_mises(stress[0])


def _widened(places: np.ndarray, margin: int) -> np.ndarray:
    step = (places[-1] - places[0]) / (places.size - 1)
    return places[0] + step * np.arange(-margin, places.size + margin)


def _section(
    axes: Axes, part: xr.Dataset, body: str, plane: tuple[str, ...], drawn: tuple[float, bool]
) -> Any:
    name, across, down, axis, words = plane
    x = part[across].values
    z = part[down].values
    stress = part[name].values
    image = _fill(axes, x, z, stress, drawn[0])
    roller = body == "roller"
    far, near_ = float(z.max()), float(z.min()) - 0.03 * float(np.ptp(z))
    if roller:
        axes.set_ylim(near_, far)
        axes.set_anchor("S")
    else:
        axes.set_ylim(far, near_)
        axes.set_anchor("N")
    if drawn[1]:
        axes.set_aspect("equal")
    else:
        axes.set_aspect("auto")
    for ends in widths(part, axis):
        axes.plot(
            ends,
            [0, 0],
            color="black",
            linewidth=2.2,
            solid_capstyle="butt",
            clip_on=False,
            zorder=4,
        )
    other = "x"
    if axis == "x":
        other = "y"
    place = ""
    if f"peak_{other}" in part:
        where = near(float(part[f"peak_{other}"]), float(np.ptp(x)))
        place = f"\nat ${other}_\\mathrm{{C}}$ = {where} mm"
    depth = "$z_\\mathrm{C}$ [mm]"
    if axis == "x":
        depth = "Depth $z_\\mathrm{C}$ [mm]"
    axes.set(title=f"{body.capitalize()}, {words} section{place}", ylabel=depth)
    _labels(axes, f"${axis}_\\mathrm{{C}}$ ({words}) [mm]")
    if axis == "y":  # the narrow section
        axes.locator_params(axis="x", nbins=2)
    _mark_peak(axes, part, (axis, "z"))
    return image


def _fill(axes: Axes, x: np.ndarray, y: np.ndarray, stress: np.ndarray, top: float) -> Any:
    levels = np.linspace(0, top, 17)
    image = axes.contourf(x, y, np.clip(stress, 0, top), levels=levels, cmap="cividis")
    axes.contour(x, y, stress, levels=levels[2::2], colors="white", linewidths=0.35, alpha=0.7)
    return image


def _labels(axes: Axes, across: str) -> None:
    axes.set_xlabel(across, labelpad=1)
    axes.locator_params(nbins=5)
    axes.grid(False)


def _surface(
    axes: Axes, patch: DrawnPatch, part: xr.Dataset, field: tuple, drawn: tuple[float, bool]
) -> None:
    """Draw the stress on the surface of one body, as far as the sections reach, with the edge of
    the patch.
    """
    x, y, stress = field
    _fill(axes, x, y, stress, drawn[0])
    axes.add_patch(PathPatch(outline(patch), facecolor="none", edgecolor="black", linewidth=0.9))
    for limit, own, places in ((axes.set_xlim, "xz_x", x), (axes.set_ylim, "yz_y", y)):
        reach = part[own].values
        limit(max(float(reach[0]), float(places[0])), min(float(reach[-1]), float(places[-1])))
    aspect = "auto"
    if drawn[1]:
        aspect = "equal"
    axes.set(title=f"{str(part['body'].item()).capitalize()}, surface", aspect=aspect)
    axes.set_ylabel("$y_\\mathrm{C}$ (rolling) [mm]", labelpad=1)
    _labels(axes, "$x_\\mathrm{C}$ (lateral) [mm]")
    _mark_peak(axes, part, ("x", "y"))


def _mark_peak(axes: Axes, part: xr.Dataset, plane: tuple[str, str]) -> None:
    if not all(n in part for n in ("peak_stress", "peak_x", "peak_y", "peak_z")):
        return
    x, y, value = (float(part[n]) for n in (*(f"peak_{axis}" for axis in plane), "peak_stress"))
    if not np.isfinite(x + y + value):
        return
    below = plane[1] == "y" and at_surface(part) == 0
    marker = "x"
    if below:
        marker = "o"
    look: dict[str, Any] = {"marker": marker, "markerfacecolor": "none", "clip_on": False}
    axes.plot(x, y, color="white", markersize=7, markeredgewidth=2.6, zorder=5, **look)
    axes.plot(x, y, color="black", markersize=6, markeredgewidth=1.3, zorder=6, **look)
    if below:
        return
    right = x < np.mean(axes.get_xlim())
    if plane[1] == "y" or axes.get_ylim()[1] > axes.get_ylim()[0]:
        up = 9
    else:
        up = -9
    box = {"facecolor": "white", "edgecolor": "none", "pad": 1.0, "alpha": 0.9}
    if right:
        right_of = 8
    else:
        right_of = -8
    place: dict[str, Any] = {
        "xytext": (right_of, up),
        "textcoords": "offset points",
        "va": "center",
    }
    aligned = "right"
    if right:
        aligned = "left"
    place |= {"ha": aligned, "zorder": 7, "bbox": box}
    axes.annotate(f"{value:.0f} MPa", (x, y), fontsize=7, **place)


def _sentence(part: xr.Dataset, bodies: list[str]) -> str:
    if "peak_stress" not in part or "peak_z" not in part:
        return "The peak was not computed."
    texts = []
    for body in bodies:
        own = part.sel(body=body)
        value = float(own["peak_stress"])
        depth = float(own["peak_z"])
        if at_surface(own) == 1:
            where = "at the surface"
        else:
            where = f"{rounded(depth, 2)} mm deep"
        texts.append(f"{value:.0f} MPa {where} in the {body}")
    return f"The peak is {' and '.join(texts)}."
