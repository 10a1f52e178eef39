"""Figures of one case: tractions and friction energy over its contact patches, and all its figures.

`plot_case` shows what Wenzel et al. 2022 show in their figures 6, 7 and 11, for any case.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.ticker import MaxNLocator

from trackroller.errors import InputError
from trackroller.report.figures import style
from trackroller.report.figures.contact_outline import DrawnPatch, case_text, outline, patches_of
from trackroller.report.figures.contact_sections import sections
from trackroller.report.numbers import number, rounded
from trackroller.study.store.put import replacing

ARROWS = (17, 11)  # along the long and the short axis of the patch
SLENDER = 4.0  # ratio of the axes above which a patch is not drawn to scale
PANEL_MM = 70.0  # width of a map
# black arrows are visible on it
LIGHT = ListedColormap(matplotlib.colormaps["YlGnBu"](np.linspace(0, 0.62, 64)))


def _shapes(patches: list[DrawnPatch]) -> str:
    if patches[0].solved:
        return "the loaded part of both contact patches"
    return "both contact ellipses"


def _canvas(
    patches: list[DrawnPatch], profile: bool = False
) -> tuple[Figure, list[Axes], Axes | None, bool]:
    """Return a figure with the patches side by side and, on request, axes for a profile.

    The patches are drawn to one scale unless they are very slender.
    """
    boxes = np.array([p.box for p in patches])
    count = len(patches)
    (left, rear), (right, front) = boxes[:, ::2].min(axis=0), boxes[:, 1::2].max(axis=0)
    a, b = 0.5 * (right - left), 0.5 * (front - rear)
    to_scale = 1 / SLENDER <= b / a <= SLENDER
    height = 40.0
    if to_scale:
        height = float(np.clip(PANEL_MM * b / a, 22, 66))
    figure = style.new_figure(39 + height + 40 * profile)
    ratios = None
    if profile:
        ratios = [height, 30]
    grid = figure.add_gridspec(1 + profile, count, height_ratios=ratios)
    maps = [figure.add_subplot(grid[0, i]) for i in range(count)]
    for axes in maps:
        axes.set(xlim=(left - 0.08 * a, right + 0.08 * a), ylim=(rear - 0.12 * b, front + 0.12 * b))
        aspect = "auto"
        if to_scale:
            aspect = "equal"
        axes.set(aspect=aspect, xlabel="$x_\\mathrm{C}$ (lateral) [mm]")
        ticks = 3
        if to_scale and b < 1.2 * a:
            ticks = 5
        axes.xaxis.set_major_locator(MaxNLocator(ticks))
        axes.yaxis.set_major_locator(MaxNLocator(5))
        axes.grid(False)
    maps[0].set_ylabel("$y_\\mathrm{C}$ (rolling) [mm]")
    profile_axes = None
    if profile:
        profile_axes = figure.add_subplot(grid[-1, :])
    return figure, maps, profile_axes, to_scale


def _fill(axes: Axes, patch: DrawnPatch, values: np.ndarray, top: float, cmap: Any) -> Any:
    """Draw filled contours clipped to the edge of the patch, and return them."""
    levels = np.linspace(0, top, 17)
    if patch.solved:
        x, y, shown = patch.framed(values)
    else:
        x = patch.x
        y = patch.y
        shown = values
    image = axes.contourf(x, y, np.clip(shown, 0, levels[-1]), levels=levels, cmap=cmap)
    edge = PathPatch(outline(patch), facecolor="none", edgecolor="black", linewidth=0.9)
    axes.add_patch(edge)
    image.set_clip_path(edge)
    axes.set_title(f"Contact {patch.contact}")
    return image


def shear_arrows(ds: xr.Dataset) -> style.Drawn:
    """Draw direction and size of the shear traction on the roller, with the spin pole."""
    patches = patches_of(ds, "shear_lateral", "shear_rolling")
    sizes = [np.hypot(p.field("shear_lateral"), p.field("shear_rolling")) for p in patches]
    top = max((float(s.max()) for s in sizes), default=0.0)
    image = None
    if not top > 0:  # no contact, or no friction
        return None
    figure, grid, _, to_scale = _canvas(patches)
    for axes, patch, size in zip(grid, patches, sizes, strict=True):
        image = _fill(axes, patch, size, top, LIGHT)
        _arrows(axes, patch, top, to_scale)
        _pole(axes, patch)
    style.colour_bar(figure, image, grid, "Shear traction $|\\tau|$ on the roller [MPa]")
    style.head(figure, "Shear traction on the roller")
    best = int(np.argmax([s.max() for s in sizes]))
    pole = ""
    if any(p.spin_pole is not None for p in patches):
        pole = "The black dot is the spin pole, about which the surfaces turn on each other. "
    caption = (
        f"Shear traction on the roller over {_shapes(patches)} (arrows: direction and size; "
        f"shade: size, MPa). {pole}{case_text(ds, to_scale)}"
    )
    largest = number(float(sizes[best].max()))
    sentence = f"The largest shear traction is {largest} MPa, in contact {patches[best].contact}."
    return figure, style.FigureInfo("contact_shear", caption, sentence)


def _arrows(axes: Axes, patch: DrawnPatch, top: float, to_scale: bool) -> None:
    if patch.a >= patch.b:
        count = ARROWS
    else:
        count = ARROWS[::-1]
    columns, rows = (_every(len(v), n) for v, n in ((patch.x, count[0]), (patch.y, count[1])))
    pick = np.ix_(rows, columns)
    keep = patch.inside[pick]
    x, y = np.meshgrid(patch.x[columns], patch.y[rows])
    u, v = patch.field("shear_lateral")[pick], patch.field("shear_rolling")[pick]
    step = float(min(np.ptp(axes.get_xlim()) / count[0], np.ptp(axes.get_ylim()) / count[1]))
    size: dict[str, Any] = {"angles": "uv", "scale_units": "width", "scale": top / 0.075}
    if to_scale:
        size = {"angles": "xy", "scale_units": "xy", "scale": top / (1.5 * step)}
    size |= {
        "units": "inches",
        "width": 0.010,
        "headwidth": 4,
        "headlength": 4.5,
        "headaxislength": 4,
    }
    axes.quiver(x[keep], y[keep], u[keep], v[keep], pivot="mid", zorder=3, **size)


def _every(length: int, count: int) -> np.ndarray:
    """Return about `count` evenly spaced indices, symmetric about the middle."""
    step = max(-(-(length - 1) // (count - 1)), 1)
    return np.arange((length - 1) % step // 2, length, step)


def _pole(axes: Axes, patch: DrawnPatch) -> None:
    if patch.spin_pole is None:
        return
    x, y = patch.spin_pole
    (left, right), (rear, front) = axes.get_xlim(), axes.get_ylim()
    if left <= x <= right and rear <= y <= front:
        axes.plot(
            x,
            y,
            "o",
            color="black",
            markersize=5,
            markeredgecolor="white",
            markeredgewidth=0.8,
            zorder=5,
        )
    elif np.isfinite(x):
        if x > 0.5 * (left + right):
            at, side = (0.99, "right")
        else:
            at, side = (0.01, "left")
        axes.text(
            at,
            0.03,
            f"spin pole at x = {number(x)} mm",
            fontsize=7,
            ha=side,
            transform=axes.transAxes,
        )


def friction_energy(ds: xr.Dataset) -> style.Drawn:
    """Draw the friction energy per area over both patches, and its profile across the running
    track.
    """
    name = "friction_energy_density"
    patches = patches_of(ds, name)
    fields = [np.where(p.inside, p.field(name), 0.0) for p in patches]
    top = max((float(f.max()) for f in fields), default=0.0)
    image = None
    if not top > 0:
        return None
    figure, grid, across, to_scale = _canvas(patches, profile=True)
    assert across is not None
    for axes, patch, field in zip(grid, patches, fields, strict=True):
        image = _fill(axes, patch, field, top, "cividis")
    style.colour_bar(figure, image, grid, "Friction energy per area and distance [J/(m mm²)]")
    profiles = [p.summed(f) for p, f in zip(patches, fields, strict=True)]
    for i, (patch, profile) in enumerate(zip(patches, profiles, strict=True)):
        look = {"color": style.PAIR[i], "linestyle": style.LINES[i]}
        across.plot(patch.x, profile, label=f"contact {patch.contact}", **look)
    across.locator_params(axis="x", nbins=5)
    across.set(xlim=grid[0].get_xlim(), ylim=(0, None), xlabel="$x_\\mathrm{C}$ (lateral) [mm]")
    across.set(title="Across the running track", ylabel="Sum along $y_\\mathrm{C}$\n[J/(m mm)]")
    figure.legend(loc="outside lower left", ncols=2)
    style.head(figure, "Friction energy of both contacts")
    caption = (
        f"Friction energy per area and distance travelled over {_shapes(patches)}, and summed "
        "along the rolling direction over each strip of the running track. "
        f"{case_text(ds, to_scale)}"
    )
    totals = [float(q.summed(p)) for p, q in zip(profiles, patches, strict=True)]
    words = " and ".join(
        f"{number(t)} J/m in contact {p.contact}" for t, p in zip(totals, patches, strict=True)
    )
    worst = int(np.argmax([p.max() for p in profiles]))
    place = float(patches[worst].x[int(np.argmax(profiles[worst]))])
    sentence = (
        f"Friction takes {words}; the strip at x = {rounded(place, 2)} mm of contact "
        f"{patches[worst].contact} takes most."
    )
    return figure, style.FigureInfo("contact_energy", caption, sentence)


def plot_case(ds: xr.Dataset, out_dir: Path) -> list[style.FigureInfo]:
    """Draw one solved case as SVG and PNG.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `solve` for one case with the outputs 'contact', 'peak_stress', 'tractions' and
        'subsurface'. A figure whose output is missing is not drawn.
    out_dir : pathlib.Path
        Folder for the figures; it is created if it does not exist.

    Returns
    -------
    list of FigureInfo
        The figures drawn: `contact_shear`, `contact_energy`, and `contact_1_stress` and
        `contact_2_stress` with both section planes of both bodies. A contact that has lifted off is
        left out.

    Raises
    ------
    InputError
        If the data set has several cases, or a file of somebody else stands in the place of a
        figure.
    """
    if "case" in ds.dims:
        if ds.sizes["case"] != 1:
            raise InputError(
                "ds", f"{ds.sizes['case']} cases", "one case at a time", "Use ds.isel(case=i)."
            )
        ds = ds.isel(case=0)
    with replacing(Path(out_dir)) as beside:
        beside.mkdir()
        return style.draw_all(figures_of(ds), beside)


def figures_of(ds: xr.Dataset) -> list[Callable[[], style.Drawn]]:
    """Return the functions that draw the figures of one case without the dimension `case`."""
    of_contacts = [partial(sections, ds, int(contact)) for contact in ds["contact"]]
    return [partial(shear_arrows, ds), partial(friction_energy, ds), *of_contacts]
