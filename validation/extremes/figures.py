"""The map of the extremes: scenes against checks, and regimes around the borders."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.patches import Patch, Rectangle

from trackroller.parameters import REGIME_LABELS
from trackroller.report.figures.style import (
    REGIME_COLOURS,
    REGIME_HATCHES,
    FigureInfo,
    head,
    look,
    new_figure,
    save,
    write_index,
)

Record = dict[str, Any]
CHECKS = {
    "finite": "finite",
    "solved": "solved",
    "residual": "residual",
    "scaling": "units",
    "mirror": "mirror",
    "condition": "cond.",
    "monotone": "monot.",
    "constant": "constant",
    "border": "border",
    "limit": "limit",
    "close": "close",
    "estimate": "estimate",
}


def deviation_text(value: float) -> str:
    """Return the text of a deviation: 0, its power of ten, or infinite."""
    if value == 0:
        return "0"
    if not math.isfinite(value):
        return "inf"
    if 0.01 <= value < 100:
        return f"{value:.1g}" if value < 10 else f"{value:.0f}"
    return f"{value:.0e}".replace("e-0", "e-").replace("e+0", "e").replace("e+", "e")


def draw_map(record: Record, out_dir: Path, model: str) -> FigureInfo:
    """Draw scenes x checks of one contact model: largest deviation, shaded by its share of the tolerance."""
    rows = [r for r in record["scenes"] if r["model"] == model]
    names = [c for c in CHECKS if any(f["check"] == c for r in rows for f in r["findings"])]
    with look():
        figure = new_figure(18 + 5.2 * len(rows), 180.0)
        axes = figure.add_subplot()
        axes.grid(False)
        broken = 0
        for i, row in enumerate(rows):
            found = {f["check"]: f for f in row["findings"]}
            for j, name in enumerate(names):
                if name not in found:
                    continue
                f = found[name]
                deviation = float(f["deviation"])
                broken += not f["holds"]
                share = deviation / f["tolerance"] if f["tolerance"] else float(deviation > 0) * 2
                grey = 0.97 - 0.4 * min(max(1 + math.log10(max(share, 1e-8)) / 8, 0.0), 1.0)
                axes.add_patch(_cell(j, i, str(grey), "" if f["holds"] else "xxxx"))
                beyond = name == "solved" and f["holds"] and deviation > 0
                shown = "beyond" if beyond else deviation_text(deviation)
                axes.text(
                    j, i, shown, ha="center", va="center", fontsize=6.5, fontweight="normal" if f["holds"] else "bold"
                )
        axes.set(xlim=(-0.5, len(names) - 0.5), ylim=(len(rows) - 0.5, -0.5))
        axes.set_xticks(range(len(names)), [CHECKS[n] for n in names], fontsize=7)
        axes.set_yticks(range(len(rows)), [r["scene"] for r in rows])
        axes.xaxis.tick_top()
        axes.tick_params(length=0)
        head(
            figure,
            f"Extremes with the contact model {model}",
            "largest deviation of each check, relative (finite, solved: share of cases; condition: number; estimate: "
            "over the estimated error); darker: closer to what is tolerated on a logarithmic scale; crossed: not "
            "met; blank: no claim; beyond: fails where the model ends, as stated",
        )
        axes.spines[["left", "bottom"]].set_visible(False)
        save(figure, out_dir, f"extremes_{model}")
    total = sum(len(r["findings"]) for r in rows)
    return FigureInfo(
        f"extremes_{model}",
        f"Scenes against checks, contact model {model}.",
        f"{total - broken} of {total} claims hold.",
    )


def _cell(j: int, i: int, colour: str, hatch: str) -> Any:

    return Rectangle(
        (j - 0.47, i - 0.45),
        0.94,
        0.9,
        facecolor=colour,
        edgecolor="0.35" if hatch else colour,
        hatch=hatch,
        linewidth=0.5,
    )


def draw_regimes(record: Record, out_dir: Path) -> FigureInfo:
    """Draw the regimes over axial force and friction."""

    data = record["map"]
    axial, friction = np.array(data["axial"]), np.array(data["friction"])
    with look():
        figure = new_figure(82, 180.0)
        panels = figure.subplots(1, 2, sharey=True)
        seen: set[int] = set()
        for axes, (name, fields) in zip(panels, data["maps"].items(), strict=True):
            regime = np.array(fields["regime"])
            axes.grid(False)
            for k in range(4):
                if (regime == k).any():
                    seen.add(k)
                    axes.contourf(
                        axial,
                        friction,
                        (regime == k).astype(float),
                        levels=[0.5, 1.5],
                        colors=[REGIME_COLOURS[k]],
                        hatches=[REGIME_HATCHES[k]],
                    )
            if np.array(fields["jamming"]).any():
                axes.contour(
                    axial,
                    friction,
                    np.array(fields["jamming"]),
                    levels=[0.5],
                    colors="k",
                    linestyles="--",
                    linewidths=1.0,
                )
            axes.axvline(1.0, color="k", linewidth=0.7, linestyle=":")
            axes.set(yscale="log", xlabel=r"Axial force over $|F_\mathrm{rad}|\,\tan\alpha$ [–]", title=name)
        panels[0].set_ylabel(r"Friction coefficient $\mu$ [–]")
        handles = [
            Patch(facecolor=REGIME_COLOURS[k], hatch=REGIME_HATCHES[k], edgecolor="0.3", label=REGIME_LABELS[k])
            for k in sorted(seen)
        ]
        figure.legend(handles=handles, loc="outside lower center", ncols=4)
        head(
            figure,
            "Regimes around the borders",
            "paper's roller, 200 N, alpha = 30°; dotted: lift-off without friction; above the dashed line friction "
            "alone carries the lateral load (bit jamming)",
        )
        save(figure, out_dir, "extremes_regimes")
    return FigureInfo(
        "extremes_regimes",
        "Regimes of the paper's roller over axial force and friction, contact model sliding.",
        "With more friction a contact lifts at a smaller axial force; with little friction the roller cannot drive.",
    )


def draw_kernels(record: Record, out_dir: Path) -> FigureInfo:
    """Draw the relative errors of kernels against many digits."""
    kernels = record["kernels"]
    with look():
        figure = new_figure(30 + 9.5 * len(kernels), 180.0)
        axes = figure.add_subplot()
        for i, kernel in enumerate(kernels):
            errors = np.maximum(kernel["errors"], 1e-17)
            axes.scatter(errors, np.full(len(errors), i), marker="|", color="k", s=60, linewidths=1.1)
            axes.scatter([kernel["tolerance"]], [i], marker="<", color="0.5", s=22, label=None if i else "tolerated")
        axes.set(xscale="log", xlabel="Relative error [–]", ylim=(len(kernels) - 0.5, -0.5))
        axes.set_yticks(range(len(kernels)), [f"{k['name']}\nover {k['quantity']}" for k in kernels])
        axes.legend(loc="lower right")
        head(
            figure,
            "Kernels against many digits",
            "each stroke is a point of the sweep (1e-17: no difference); the 12-point rule stands "
            "against 600 points and shows its own quadrature error, not cancellation",
        )
        save(figure, out_dir, "extremes_kernels")
    return FigureInfo(
        "extremes_kernels",
        "Relative errors of kernels at places of cancellation.",
        "Every kernel keeps at least nine digits; the 12-point rule keeps seven, because its quadrature is coarse.",
    )


def draw_extremes(record: Record, out_dir: Path) -> list[FigureInfo]:
    """Draw all figures of the catalogue and write their index."""
    infos = [draw_map(record, out_dir, m) for m in dict.fromkeys(r["model"] for r in record["scenes"])]
    infos += [draw_regimes(record, out_dir), draw_kernels(record, out_dir)]
    write_index(infos, out_dir)
    return infos
