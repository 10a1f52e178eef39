"""The picture of a carriage from the side and from above, with the forces of its rollers."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from trackroller.report.figures import style
from trackroller.report.figures.panels import legend
from trackroller.report.numbers import rounded
from trackroller.results.carriage_answer import worst_place

LONGEST = 0.3  # of the size of the carriage: the arrow of the largest force
APART = 0.45  # of the smallest distance between rollers, so that the arrows of a pair do not meet
ROOM = 0.55  # of the width of a view, right of the last roller: for its name and forces
LABEL_WIDTH, LABEL_HEIGHT = 0.9, 0.3  # of a label beside its roller, over the size of the carriage
VIEWS = (("from the side", 0, 2), ("from above", 0, 1))  # axes of the picture


def views(ds: xr.Dataset) -> style.Drawn:
    """Draw a carriage from the side and from above in the worst load case.

    Parameters
    ----------
    ds : result of `trackroller.carriage`

    Returns
    -------
    The figure and its caption.
    """
    worst, case = worst_place(ds)
    own = ds.sel(load_case=case)
    at = ds["roller_at"].values
    radial = -own["radial_force"].values[:, None] * ds["roller_pushes"].values
    axial = own["axial_force"].values[:, None] * ds["roller_axis"].values
    size = max(float(np.ptp(at, axis=0).max()), 1.0)
    gaps = np.linalg.norm(at[:, None] - at[None], axis=2)
    longest = (
        min(LONGEST * size, APART * float(np.min(gaps[gaps > 0], initial=np.inf))),
        LONGEST * size,
    )
    scales = [
        most / max(float(np.linalg.norm(force, axis=1).max()), 1e-9)
        for most, force in zip(longest, (radial, axial), strict=True)
    ]
    figure, panels = style.panels(
        f"{ds.attrs['title']}: forces of the rollers on their rails, {case}", 78, 2
    )
    for axes, (words, across, up) in zip(panels, VIEWS, strict=True):
        axes.plot(
            *at[:, [across, up]].T, "o", color="0.35", ms=9, mfc="white", ls="none", label="roller"
        )
        masses = ds["mass_at"].values
        axes.plot(*masses[:, [across, up]].T, "D", color="0.35", ms=4, label="mass")
        for colour, scale, forces in zip(style.PAIR, scales, (radial, axial), strict=False):
            _arrows(axes, at[:, [across, up]], scale * forces[:, [across, up]], colour)
        _name(axes, own, at[:, [across, up]], worst, masses[:, [across, up]], size)
        direction = "y, left"
        if up == 2:
            direction = "z, up"
        axes.set(xlabel="x, forward [mm]", ylabel=f"{direction} [mm]", title=words)
        axes.set_aspect("equal", adjustable="datalim")
        axes.margins(0.2)
        axes.update_datalim([(float(at[:, 0].max()) + ROOM * size, float(at[:, up].mean()))])
        axes.autoscale_view()
    looks: list[tuple[str, dict[str, Any]]] = [
        ("roller", {"marker": "o", "color": "0.35", "mfc": "white", "ls": "none"})
    ]
    looks.append(("mass", {"marker": "D", "color": "0.35", "ms": 4, "ls": "none"}))
    looks += [
        (word, {"color": colour, "lw": 2})
        for word, colour in zip(("radial", "axial"), style.PAIR, strict=False)
    ]
    legend(figure, looks, columns=4)
    caption = (
        f"Carriage from the side and from above in the load case {case}, which damages roller "
        f"{worst} most. Arrows are the forces of the rollers on their rails, radial and axial ones "
        "to scales of their own; both forces (N) stand beside each roller; diamonds are masses."
    )
    return figure, style.FigureInfo("carriage", caption)


def _arrows(axes: Any, at: np.ndarray, forces: np.ndarray, colour: str) -> None:
    """Draw the forces that are seen in a view as arrows from their rollers."""
    shown = np.linalg.norm(forces, axis=1) > 0
    axes.quiver(
        *at[shown].T,
        *forces[shown].T,
        angles="xy",
        scale_units="xy",
        scale=1,
        color=colour,
        width=0.007,
        zorder=4,
    )
    axes.update_datalim((at + forces)[shown])


def _name(
    axes: Any, own: xr.Dataset, at: np.ndarray, worst: str, masses: np.ndarray, size: float
) -> None:
    """Write name and forces beside each roller; rollers that one view shows at one point share a
    label.

    A label stands above its roller, and below it where a mass stands in its place.
    """
    labels: dict[tuple[float, float], list[str]] = {}
    for j, name in enumerate(own["roller"].values):
        radial, axial = (rounded(float(own[key][j])) for key in ("radial_force", "axial_force"))
        if float(own["radial_force"][j]) == 0:
            forces = "lifted"
        else:
            forces = f"{radial}, {axial}"
        text = f"{name} {forces}"
        if name == worst:
            text += " (worst)"
        labels.setdefault((float(at[j, 0]), float(at[j, 1])), []).append(text)
    for place, texts in labels.items():
        away = (masses - np.array(place)) / size
        is_taken = ((away > 0) & (away < np.array([LABEL_WIDTH, LABEL_HEIGHT]))).all(axis=1).any()
        if is_taken:
            offset, side = ((6, -6), "top")
        else:
            offset, side = ((6, 6), "baseline")
        axes.annotate(
            "\n".join(texts), place, xytext=offset, textcoords="offset points", fontsize=7, va=side
        )
