"""Friction, stick and dissipation across the patch by contact model, free and driven."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.patches import Ellipse
from matplotlib.ticker import MaxNLocator

from trackroller.report.figures import style
from trackroller.report.numbers import level_text, number

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

STILL = 1e-8  # slip over the largest that counts as none


def patches(fields: xr.Dataset, contact: int = 1) -> Figure:
    """Draw tractions (arrows) and adhesion (hatched) over the patch by friction and drive (rows) and model (columns).

    Parameters
    ----------
    fields : dataset of `validation.contact_models.product.patch_fields`, over `contact_model` and `row`
    contact : the contact drawn
    """

    names, rows = list(map(str, fields["contact_model"].values)), fields.sizes["row"]
    figure = style.new_figure(28.0 + 29.0 * rows, 2 * style.COLUMN_MM)
    axes = figure.subplots(rows, len(names), squeeze=False, sharex="row", sharey="row")
    image: Any = None
    inside = fields["friction_energy_density"] / (fields["friction_coefficient"] * fields["max_pressure"])
    top = float(np.nanmax(inside.sel(contact=contact).quantile(0.995, ("x", "y")).values))
    top = float(f"{1.05 * top:.1g}") if top > 0 else 1.0
    for row in range(rows):
        mu, force = (float(fields[n][row]) for n in ("friction_coefficient", "motor_force"))
        for column, name in enumerate(names):
            one = fields.isel(row=row).sel({"contact_model": name, "contact": contact})
            image = _patch(axes[row, column], one, mu, top)
            if row == 0:
                axes[row, column].set_title(name, pad=3)
        text = f"$\\mu$ = {number(mu)}, {level_text('motor_force', force)}"
        axes[row, 0].set_ylabel(f"{text}\n" + r"$y_\mathrm{C}$ (rolling) [mm]")
    for last in axes[-1]:
        last.set_xlabel(r"$x_\mathrm{C}$ (lateral) [mm]")
    bar = figure.colorbar(image, ax=axes, location="right", aspect=40, pad=0.01, ticks=MaxNLocator(5))
    bar.set_label(r"Friction energy density over $\mu p_\mathrm{max}$ [–]")
    style.head(
        figure,
        "Friction across the patch",
        f"Contact {contact}. Arrows: friction on the roller; hatched: stick; shade: dissipation per area and "
        r"distance over $\mu p_\mathrm{max}$.",
    )
    return figure


def _patch(axes: Axes, one: xr.Dataset, mu: float, top: float) -> Any:

    x, y = one["patch_x"].values, one["patch_y"].values
    pressure = np.nan_to_num(one["pressure"].values)
    scale = mu * float(one["max_pressure"])
    dense = np.nan_to_num(one["friction_energy_density"].values) / scale
    levels = np.linspace(0, top, 13)
    image = axes.contourf(x, y, np.clip(dense, 0, top), levels=levels, cmap="Greys", extend="max", alpha=0.55)
    edge = Ellipse(
        (0, 0),
        2 * float(one["semi_axis_lateral"]),
        2 * float(one["semi_axis_rolling"]),
        facecolor="none",
        edgecolor="black",
        linewidth=0.9,
    )
    axes.add_patch(edge)
    image.set_clip_path(edge)
    slip = np.hypot(one["slip_lateral"].values, one["slip_rolling"].values)
    stuck = (pressure > 0) & (slip <= STILL * np.nanmax(slip))  # elements that stick have a slip of rounding errors
    if stuck.any():
        hatch = axes.contourf(x, y, stuck.astype(float), levels=[0.5, 1.5], colors=[(1, 1, 1, 0)], hatches=["//////"])
        hatch.set_edgecolor("0.15")
        hatch.set_linewidth(0.0)
        hatch.set_clip_path(edge)
        axes.contour(x, y, stuck.astype(float), levels=[0.5], colors="#0072b2", linewidths=0.9)
    inside = pressure > 0.05 * pressure.max()
    pick_x = np.unique(np.linspace(0, x.size - 1, 15).round().astype(int))
    pick_y = np.unique(np.linspace(0, y.size - 1, 9).round().astype(int))
    where = np.ix_(pick_y, pick_x)
    tx, ty = (np.where(inside, one[n].values, np.nan)[where] / scale for n in ("shear_lateral", "shear_rolling"))
    axes.quiver(x[pick_x], y[pick_y], tx, ty, angles="uv", scale=14, width=0.005, headwidth=4, color="black")
    axes.set_xlim(1.06 * x[0], 1.06 * x[-1])
    axes.set_ylim(1.1 * y[0], 1.1 * y[-1])
    axes.grid(False)
    return image
