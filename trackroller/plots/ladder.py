"""The three contact models side by side, over friction and drive, and across the patch."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.plots import style

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# told apart by dash and mark as much as by colour
LOOKS: dict[str, dict[str, Any]] = {
    "sliding": {"color": "#000000", "linestyle": "-", "marker": "o"},
    "fastsim": {"color": "#d55e00", "linestyle": ":", "marker": "s"},
    "kalker": {"color": "#0072b2", "linestyle": "--", "marker": "^"},
}
FRICTION = "friction_coefficient"
SIZE = 2.8
STILL = 1e-8  # slip over the largest that counts as none


def models(ds: xr.Dataset) -> list[str]:
    """Contact models of the data set, cheapest first."""
    return [m for m in LOOKS if m in [str(v) for v in ds["contact_model"].values]]


def rolls_in_all(ds: xr.Dataset) -> xr.DataArray:
    """Cases that roll by every model; others are not comparable."""
    return (ds["regime"] == 0).all("contact_model")


def _panels(ds: xr.Dataset, rows: int, height: float) -> tuple[Figure, Any]:
    figure = style.new_figure(height)
    drives = ds["motor_force"].values
    axes = figure.subplots(rows, len(drives), sharex=True, sharey="row", squeeze=False)
    for column, drive in enumerate(drives):
        axes[0, column].set_title(style.capital(style.level_text("motor_force", drive)), loc="left", pad=3)
        axes[-1, column].set_xlabel(r"Friction coefficient $\mu$ [–]")
        for row in range(rows):
            axes[row, column].set_xscale("log")
            style.log_ticks(axes[row, column].xaxis, *np.sort(ds[FRICTION].values)[[0, -1]])
    return figure, axes


def _curves(ds: xr.Dataset) -> Iterator[tuple[int, str, xr.Dataset]]:
    """Column of the drive, contact model and the cases of each line over friction."""
    for column, drive in enumerate(ds["motor_force"].values):
        for model in models(ds):
            yield column, model, ds.sel(motor_force=drive, contact_model=model)


def _line(axes: Axes, ds: xr.Dataset, name: str, model: str, hollow: bool = False, **more: Any) -> Any:
    look = LOOKS[model]
    face = "white" if hollow else look["color"]
    return axes.plot(ds[FRICTION], ds[name], markersize=SIZE, markerfacecolor=face, markeredgewidth=0.7,
                     **(look | more))[0]  # fmt: skip


def _finish(figure: Figure, handles: dict[str, Any], title: str, words: str, columns: int = 3) -> Figure:
    """The figure with its legend (label -> line) and its heading."""
    figure.legend(list(handles.values()), list(handles), loc="outside lower center", ncols=columns, handlelength=2.6,
                  columnspacing=1.2)  # fmt: skip
    style.head(figure, title, words)
    style.finish(figure)
    return figure


def forces(ds: xr.Dataset) -> Figure:
    """Normal and lateral force and spin moment of both contacts over friction."""
    from matplotlib.lines import Line2D

    wanted = (("normal_force", "Normal force\n" + r"$F_\mathrm{N}$ [N]"),
              ("lateral_force", "Lateral force\n" + r"$F_\mathrm{T}$ [N]"),
              ("spin_moment", "Spin moment\n" + r"$M_\mathrm{R}$ [N·mm]"))  # fmt: skip
    figure, axes = _panels(ds, len(wanted), 122.0)
    handles: dict[str, Any] = {}
    for row, (name, label) in enumerate(wanted):
        axes[row, 0].set_ylabel(label)
        for column, model, part in _curves(ds):
            for contact in (1, 2):
                handles[model] = _line(axes[row, column], part.sel(contact=contact), name, model, contact == 2)
    for contact, face in ((1, "0.3"), (2, "white")):
        mark = Line2D([], [], color="0.3", marker="o", linestyle="", markersize=3.5, markerfacecolor=face)
        handles[f"contact {contact}"] = mark
    return _finish(figure, handles, "Forces by contact model",
                   "Paper's roller, 200 N radial, 30 N axial, outer curve 220 mm.")  # fmt: skip


def energy(ds: xr.Dataset) -> Figure:
    """Friction energy of both contacts per distance: summed over the patches, and what the resultants put in."""
    figure, axes = _panels(ds, 1, 66.0)
    axes[0, 0].set_ylabel("Friction energy of both\ncontacts per distance [J/m]")
    handles: dict[str, Any] = {}
    for column, model, cases in _curves(ds):
        part = cases.sum("contact", skipna=False).assign_coords({FRICTION: ds[FRICTION]})
        label = f"{model}, local product" if model == "sliding" else model
        handles[label] = _line(axes[0, column], part, "friction_energy_per_distance", model)
        if model == "sliding":
            own = _line(axes[0, column], part, "friction_energy_balance", model, True, linestyle="-.")
            handles["sliding, from the resultants"] = own
    for panel in axes[0]:
        panel.set_yscale("log")
    shown = ds["friction_energy_per_distance"].sum("contact", skipna=False).values
    style.log_ticks(axes[0, 0].yaxis, 0.8 * float(np.nanmin(shown)), float(np.nanmax(shown)))
    return _finish(figure, handles, "Friction energy by contact model",
                   "Rolling only; missing points slip altogether.", 2)  # fmt: skip


def peak_and_life(ds: xr.Dataset) -> Figure:
    """Peak von Mises stress and life of the roller over friction."""
    from trackroller.plots.study_life import capped

    figure, axes = _panels(ds, 2, 96.0)
    axes[0, 0].set_ylabel("Peak stress of\nthe roller [MPa]")
    axes[1, 0].set_ylabel("Life of the\nroller [h]")
    worst = ds.assign(worst=ds["peak_stress"].sel(body="roller").max("contact"))
    handles: dict[str, Any] = {}
    for column, model, part in _curves(worst):
        handles[model] = _line(axes[0, column], part, "worst", model)
        life = part.assign(shown=(FRICTION, capped(part["roller_life_hours"].values)[0]))
        _line(axes[1, column], life, "shown", model)
    for panel in axes[1]:
        panel.set_yscale("log")
    return _finish(figure, handles, "Peak stress and life by contact model", "The more loaded of the two contacts.")


def error(found: xr.Dataset, tolerance: float) -> Figure:
    """Error of the cheaper models against the exact theory over friction; `found` of `study.ladder.errors`."""
    wanted = (("normal_force", "Normal force"), ("friction_force", r"Friction over $\mu F_\mathrm{N}$"),
              ("friction_energy", "Friction energy"), ("peak_stress", "Peak stress"))  # fmt: skip
    figure, axes = _panels(found, len(wanted), 132.0)
    handles: dict[str, Any] = {}
    for row, (name, label) in enumerate(wanted):
        axes[row, 0].set_ylabel(f"{label}\nerror [%]")
        axes[row, 0].set_yscale("log")
        axes[row, 0].set_ylim(0.05, 100)
        for panel in axes[row]:
            panel.axhline(100 * tolerance, color="0.35", linewidth=0.8, linestyle=(0, (1, 2)), zorder=0)
        for column, model, part in _curves(found[[name]]):
            line = _line(axes[row, column], 100 * part.clip(6e-4), name, model)
            handles[f"{model} against kalker"] = line
    words = f"Dotted: {style.number(100 * tolerance)} %; at the foot: 0.06 % or less. The worse contact; rolling only."
    return _finish(figure, handles, "What the cheaper models miss", words, 2)


def stick(ds: xr.Dataset) -> Figure:
    """Share of the patch that sticks over friction."""
    figure, axes = _panels(ds, 1, 58.0)
    axes[0, 0].set_ylabel("Share of the patch\nthat sticks [%]")
    handles: dict[str, Any] = {}
    for column, model, part in _curves(100.0 * ds[["stick_area_fraction"]].max("contact")):
        handles[model] = _line(axes[0, column], part, "stick_area_fraction", model)
    return _finish(figure, handles, "Stick by contact model", "The larger share of the two contacts.")


def patches(fields: xr.Dataset, contact: int = 1) -> Figure:
    """Tractions (arrows) and stick (hatched) over the patch, one row a friction coefficient, one column a model."""
    from matplotlib.ticker import MaxNLocator

    names, mus = models(fields), fields[FRICTION].values
    figure = style.new_figure(26.0 + 33.0 * len(mus), 2 * style.COLUMN_MM)
    axes = figure.subplots(len(mus), len(names), squeeze=False, sharex="row", sharey="row")
    image: Any = None
    inside = fields["friction_energy_density"] / (fields[FRICTION] * fields["max_pressure"])
    top = float(np.nanmax(inside.sel(contact=contact).quantile(0.995, ("x", "y")).values))
    top = float(f"{1.05 * top:.1g}") if top > 0 else 1.0
    for row, mu in enumerate(mus):
        for column, name in enumerate(names):
            one = fields.sel({FRICTION: mu, "contact_model": name, "contact": contact})
            image = _patch(axes[row, column], one, float(mu), top)
            if row == 0:
                axes[row, column].set_title(name, pad=3)
        axes[row, 0].set_ylabel(f"$\\mu$ = {style.number(float(mu))}\n" + r"$y_\mathrm{C}$ (rolling) [mm]")
    for last in axes[-1]:
        last.set_xlabel(r"$x_\mathrm{C}$ (lateral) [mm]")
    bar = figure.colorbar(image, ax=axes, location="right", aspect=40, pad=0.01, ticks=MaxNLocator(5))
    bar.set_label(r"Friction energy density over $\mu p_\mathrm{max}$ [–]")
    style.head(figure, "Friction across the patch, free rolling",
               f"Contact {contact}. Arrows: friction on the roller; hatched: stick; shade: dissipation per area and "
               r"distance over $\mu p_\mathrm{max}$.")  # fmt: skip
    style.finish(figure)
    return figure


def _patch(axes: Axes, one: xr.Dataset, mu: float, top: float) -> Any:
    from matplotlib.patches import Ellipse

    x, y = one["patch_x"].values, one["patch_y"].values
    pressure = np.nan_to_num(one["pressure"].values)
    scale = mu * float(one["max_pressure"])
    dense = np.nan_to_num(one["friction_energy_density"].values) / scale
    levels = np.linspace(0, top, 13)
    image = axes.contourf(x, y, np.clip(dense, 0, top), levels=levels, cmap="Greys", extend="max", alpha=0.55)
    edge = Ellipse((0, 0), 2 * float(one["semi_axis_lateral"]), 2 * float(one["semi_axis_rolling"]),
                   facecolor="none", edgecolor="black", linewidth=0.9)  # fmt: skip
    axes.add_patch(edge)
    image.set_clip_path(edge)
    slip = np.hypot(one["slip_lateral"].values, one["slip_rolling"].values)
    stuck = (pressure > 0) & (slip <= STILL * np.nanmax(slip))  # the exact theory leaves rounding
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
