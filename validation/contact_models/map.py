"""The map behind `contact_model="auto"`: the cheapest contact model within a tolerance."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.patches import Patch

from trackroller.report.figures import style
from trackroller.report.numbers import factor_label, number
from trackroller.roller.case import Case, to_table
from trackroller.roller.choice import choose as choice
from trackroller.roller.options import Options

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SHADES = ("#ffffff", "#d5d5d5", "#8f8f8f")
HATCHES = ("", "////", "")
LABELS = ("sliding", "fastsim", "kalker")
POINTS = 40


def choice_map(tolerance: float = 0.05) -> Figure:
    """Regions over friction and contact angle for the paper's free roller, and shares of designs by tolerance."""

    figure = style.new_figure(124.0)
    upper, lower = figure.subplots(2, 1, height_ratios=(1.5, 1.0))
    _regions(upper, tolerance)
    _shares(lower)
    handles = [
        Patch(facecolor=c, hatch=h, edgecolor="0.2", label=n) for c, h, n in zip(SHADES, HATCHES, LABELS, strict=True)
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=3)
    style.head(
        figure,
        "The cheapest contact model that a tolerance allows",
        f"Above: paper's roller, free, no axial force, {number(100 * tolerance)} % (dashed: half and "
        "twice). Below: random designs.",
    )
    style.finish(figure)
    return figure


def _regions(axes: Axes, tolerance: float) -> None:

    mus, angles = np.geomspace(0.02, 0.6, POINTS), np.linspace(12.0, 78.0, POINTS)
    cases = [
        Case(friction_coefficient=float(mu), contact_angle=float(angle), axial_force=0, motor_force=0)
        for angle in angles
        for mu in mus
    ]
    table = to_table(cases, None)
    x, y = np.meshgrid(mus, angles)

    error = choice.measured_errors(table, Options(contact_model="auto"))

    def chosen(limit: float) -> np.ndarray:
        names = choice.cheapest(error, limit)
        return np.array([LABELS.index(n) for n in names], float).reshape(POINTS, POINTS)

    filled = axes.contourf(x, y, chosen(tolerance), levels=[-0.5, 0.5, 1.5, 2.5], colors=SHADES, hatches=HATCHES)
    filled.set_edgecolor("0.2")  # of the hatches
    filled.set_linewidth(0.0)
    axes.contour(x, y, chosen(tolerance), levels=[0.5, 1.5], colors="black", linewidths=1.0)
    for limit in (tolerance / 2, 2 * tolerance):
        axes.contour(x, y, chosen(limit), levels=[0.5, 1.5], colors="black", linewidths=0.7, linestyles="--")
    axes.set_xscale("log")
    style.log_ticks(axes.xaxis, 0.02, 0.6)
    axes.set_xlabel(r"Friction coefficient $\mu$ [–]")
    axes.set_ylabel(factor_label("contact_angle"))


def _shares(axes: Axes) -> None:

    m = choice.stored()
    at, left = np.arange(len(m["tolerances"])), np.zeros(len(m["tolerances"]))
    for k, name in enumerate(LABELS):
        width = 100 * m["shares"][:, k]
        axes.barh(at, width, 0.7, left, color=SHADES[k], hatch=HATCHES[k], edgecolor="0.2", label=name)
        left = left + width
    axes.set_yticks(at, [f"{number(100 * float(t))} %" for t in m["tolerances"]])
    axes.invert_yaxis()
    axes.set_xlim(0, 100)
    axes.set_ylabel("Tolerance")
    axes.set_xlabel(f"Share of {int(m['checked'])} random designs [%]")
    axes.grid(False)
