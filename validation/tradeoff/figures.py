"""Error against cost by quantity, and convergence of the stages."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.report.figures import style
from trackroller.report.numbers import rounded, with_unit
from validation.tradeoff.summary import levels, yardstick

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Record = dict[str, Any]
Drawn = tuple["Figure", style.FigureInfo]

# quantity -> words for the axis, and what is told in the title
PARETO = {
    "normal_force": ("normal force", "of F_N"),
    "friction_force": ("friction force", "of μ F_N"),
    "spin_moment": ("spin moment", "of μ F_N √(ab)"),
    "friction_energy": ("friction energy", "–"),
    "peak_stress": ("peak stress", "–"),
    "life": ("life", "–"),
}
# (stage, model, method) -> legend, in the order of the legend
SERIES = {
    ("equilibrium", "sliding", "quadrature"): "sliding, forces only: Gauss points",
    ("peak", "sliding", "search"): "sliding, complete: search of the peak",
    ("peak", "sliding", "grid"): "sliding: peak as the highest grid point",
    ("elements", "kalker", "elements"): "Kalker, complete: elements across",
    ("ellipse", "sliding", "published"): "published table of the ellipse",
}
CONVERGENCE = {
    ("tractions", "sliding", "grid", "friction_force"): "friction force summed over a grid",
    ("stress", "sliding", "plane waves", "stress"): "stress: waves and chords",
    ("stress", "sliding", "bilinear elements", "stress"): "stress: bilinear elements",
    ("peak", "sliding", "grid", "peak_stress"): "peak as the highest grid point",
    ("elements", "kalker", "elements", "friction_force"): "Kalker: friction force",
    ("elements", "kalker", "elements", "peak_stress"): "Kalker: peak stress",
}


def draw_all(summary: dict[str, Any], out_dir: Path) -> list[style.FigureInfo]:
    """Draw every figure for which there are measurements; return their index."""
    infos = []
    with style.look():
        for item in (*(pareto(summary, quantity) for quantity in PARETO), convergence(summary)):
            if item is not None:
                figure, info = item
                style.save(figure, out_dir, info.name)
                infos.append(info)
    style.write_index(infos, out_dir)
    return infos


def pareto(summary: dict[str, Any], quantity: str) -> Drawn | None:
    """Draw the error of one quantity over the time of a case: 99th percentile filled, median hollow, presets ringed."""
    one = yardstick(summary["ladders"])
    records = [{**r, "cost": r["cost"] / one} for r in summary["settings"] if quantity in r["errors"]]
    series = {key: [r for r in records if (r["stage"], r["model"], r["method"]) == key] for key in SERIES}
    series = {key: found for key, found in series.items() if found}
    if not series:
        return None
    words, unit = PARETO[quantity]
    figure = style.new_figure(96, style.COLUMN_MM)
    axes = figure.add_subplot()
    axes.set_xscale("log")
    axes.set_yscale("log")
    colours, taken = style.palette(len(SERIES)), []
    for key, found in series.items():
        k = list(SERIES).index(key)
        taken += _series(axes, found, quantity, colours[k], style.MARKERS[k], style.LINES[k], SERIES[key])
    letters = _presets(axes, records, summary["presets"], quantity)
    axes.set_xlabel("Time of a case over that of sliding at standard [–]")
    axes.set_ylabel(f"Relative error of the {words} [{unit}]")
    axes.margins(x=0.12, y=0.06)
    style.log_ticks(axes.xaxis, *axes.get_xlim())
    figure.legend(loc="outside lower left", ncols=1, handlelength=2.6, labelspacing=0.25)
    style.head(figure, f"What accuracy of the {words} costs", "filled: 99 % of the designs lie below; hollow: median")
    _names(axes, taken, letters)  # last: legend and title decide where the points come to lie
    caption = (
        f"Error of the {words} against a converged solution of the same contact model (sliding, kalker), over "
        "the processor time of a case, which is divided by that of a complete case of sliding at standard. Filled "
        "marks: 99th percentile of the designs; hollow marks: median; rings: presets. Labels: Gauss points, quadrature "
        "and effort of the search, or elements across the patch."
    )
    return figure, style.FigureInfo(f"tradeoff_{quantity}", caption, _sentence(series, quantity, words))


def _series(axes: Axes, found: list[Record], quantity: str, colour: Any, marker: str, line: Any, label: str) -> list:
    found = sorted(found, key=lambda r: r["cost"])
    cost = np.array([r["cost"] for r in found])
    high = np.array([levels(r, quantity)[2] for r in found])
    middle = np.array([levels(r, quantity)[0] for r in found])
    shown = np.isfinite(high) & (high > 0)
    front = shown & (high <= np.minimum.accumulate(np.where(shown, high, math.inf)))
    rest = shown & ~front
    axes.plot(cost[front], high[front], color=colour, marker=marker, linestyle=line, label=label, zorder=3)
    axes.plot(cost[rest], high[rest], color=colour, marker=marker, linestyle="none", alpha=0.45, zorder=2)
    low = np.isfinite(middle) & (middle > 0) & (front | ~shown)
    axes.plot(
        cost[low],
        middle[low],
        color=colour,
        marker=marker,
        linestyle="none",
        markerfacecolor="white",
        markeredgewidth=0.7,
        markersize=3.0,
        zorder=2,
    )
    return [(cost[i], high[i], found[i]["label"], colour) for i in np.flatnonzero(front)]


def _presets(axes: Axes, records: list[Record], presets: dict[str, Record], quantity: str) -> list[tuple[float, float]]:
    """Draw rings and letters of the presets; return the ringed points."""
    ringed: list[tuple[float, float]] = []
    for name, parts in presets.items():
        for r in (r for r in records if r["ladder"] and r["ladder"] == parts.get(_part(r))):
            high = levels(r, quantity)[2]
            if (r["stage"] == "peak" and quantity not in ("peak_stress", "life")) or not 0 < high < math.inf:
                continue
            place = r["cost"], high
            axes.plot(
                *place,
                marker="o",
                markersize=8.5,
                markerfacecolor="none",
                linestyle="none",
                zorder=4,
                markeredgecolor="black",
                markeredgewidth=0.9,
                label=None if ringed else "presets: P(review), S(tandard), R(eference)",
            )
            axes.annotate(
                name[0].upper(), place, xytext=(-9, -9), fontsize=6.5, textcoords="offset points", fontweight="bold"
            )
            ringed.append(place)
    return ringed


def _part(record: Record) -> str:
    """Return which part of a preset the setting of a record is."""
    return {"equilibrium": "forces", "peak": "peak"}.get(record["stage"], record["model"])


def _names(axes: Axes, points: list, letters: list[tuple[float, float]]) -> None:
    """Write names beside the points where there is room, away from marks, preset letters and other names."""
    axes.figure.draw_without_rendering()  # type: ignore[union-attr]
    scale = 72.0 / axes.figure.dpi
    taken = [
        (u - 9.0, v - 9.0, u - 4.0, v - 2.5) for u, v in axes.transData.transform(letters or np.empty((0, 2))) * scale
    ]
    marks = axes.transData.transform([(x, y) for x, y, _, _ in points]) * scale
    taken += [(u - 3.0, v - 3.0, u + 3.0, v + 3.0) for u, v in marks]
    for (x, y, text, colour), (u, v) in zip(points, marks, strict=True):
        width, height = 4.4 * len(text), 5.0
        for dx, dy in ((3.5, 3.0), (4.5, -2.5), (3.5, -8.0), (-width - 3.5, 3.0)):
            box = (u + dx, v + dy, u + dx + width, v + dy + height)
            if not any(box[0] < c and a < box[2] and box[1] < d and b < box[3] for a, b, c, d in taken):
                taken.append(box)
                axes.annotate(text, (x, y), xytext=(dx, dy), textcoords="offset points", fontsize=6.0, color=colour)
                break


def _sentence(series: dict[Any, list[Record]], quantity: str, words: str) -> str:
    parts = []
    for key, name in ((("peak", "sliding", "search"), "sliding"), (("elements", "kalker", "elements"), "kalker")):
        if quantity == "normal_force" and key[0] == "peak":
            continue
        found = [r for r in series.get(key, []) if math.isfinite(levels(r, quantity)[2])]
        if found:
            best = min(found, key=lambda r: levels(r, quantity)[2])
            parts.append(
                f"the most exact setting of {name} errs by less than {rounded(levels(best, quantity)[2], 2)} in 99 % "
                f"of the designs and takes {rounded(best['cost'], 2)} times the yardstick"
            )
    return f"The {words}: " + "; ".join(parts) + "." if parts else f"The {words} against its cost."


def convergence(summary: dict[str, Any]) -> Drawn | None:
    """Draw the median error against points per length with the observed orders."""
    order = {(o["stage"], o["model"], o["method"], o["quantity"]): o["order"] for o in summary["orders"]}
    figure = style.new_figure(112, style.COLUMN_MM)
    axes = figure.add_subplot()
    axes.set_xscale("log")
    axes.set_yscale("log")
    colours, drawn = style.palette(len(CONVERGENCE)), 0
    for k, (key, words) in enumerate(CONVERGENCE.items()):
        found = [
            r
            for r in summary["settings"]
            if (r["stage"], r["model"], r["method"]) == key[:3] and key[3] in r["errors"] and r["points"]
        ]
        if len(found) < 3:
            continue
        drawn += 1
        found = sorted(found, key=lambda r: r["points"])
        told = f", order {order[key]:.1f}" if key in order else ""
        axes.plot(
            [r["points"] for r in found],
            [levels(r, key[3])[0] for r in found],
            color=colours[k],
            marker=style.MARKERS[k],
            linestyle=style.LINES[k % len(style.LINES)],
            label=words + told,
        )
    if not drawn:
        return None
    low, high = axes.get_xlim()
    style.log_ticks(axes.xaxis, low, high)
    axes.set_xlabel(with_unit("Points across the patch, or of quadrature", "-"))
    axes.set_ylabel(with_unit("Relative error, median of the designs", "-"))
    figure.legend(loc="outside lower left", ncols=1, handlelength=2.6, labelspacing=0.25)
    style.head(figure, "How fast the stages converge", "median error over the designs; order: slope of the line")
    caption = (
        "Median error of single stages of sliding and kalker against their discretisation, with the observed "
        "order (least squares in logarithms; points at the rounding error are left out)."
    )
    return figure, style.FigureInfo(
        "tradeoff_convergence",
        caption,
        "Quadrature in smooth pieces converges much faster than grids and elements.",
    )
