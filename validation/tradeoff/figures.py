"""The figure of error against cost."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from trackroller.report.figures import style
from validation.tradeoff.truth import SAMPLES

QUANTITIES = {"friction_force": "friction forces over μ F_N", "peak_stress": "peak stress"}


def draw_all(found: dict[str, Any], folder: Path) -> list[style.FigureInfo]:
    """Draw the error that 99 % of the designs keep over the cost of a complete case; return the index."""
    with style.look():
        figure = style.new_figure(90, 2 * style.COLUMN_MM)
        panels = figure.subplots(1, len(QUANTITIES))
        models = list(dict.fromkeys(row["model"] for row in found["rungs"]))
        for axes, (quantity, words) in zip(panels, QUANTITIES.items(), strict=True):
            for model, colour, marker in zip(models, style.palette(len(models)), style.MARKERS, strict=False):
                for sample, line in zip(SAMPLES, ("-", ":"), strict=True):
                    spent = {
                        row["accuracy"]: row["complete"] for row in found["costs"][sample] if row["model"] == model
                    }
                    own = [row for row in found["rungs"] if row["model"] == model]
                    axes.plot(
                        [spent[row["accuracy"]] for row in own],
                        [max(row["exact"][sample][quantity][1], 1e-9) for row in own],
                        marker=marker,
                        color=colour,
                        linestyle=line,
                        markerfacecolor=colour if line == "-" else "none",
                        label=f"{model}, {sample}",
                    )
            axes.set_xscale("log")
            axes.set_yscale("log")
            axes.set_xlabel("cost of a complete case")
            axes.set_ylabel(f"error of the {words}")
        panels[0].legend(frameon=False, fontsize=6)
        style.head(
            figure, "What accuracy costs", "error that 99 % keep: preview, standard, reference from left to right"
        )
        caption = (
            "Error against the exact theory that 99 % of ordinary and of wide designs keep, over the cost of a "
            "complete case, for the three rungs of each contact model."
        )
        info = style.FigureInfo(
            "tradeoff", caption, "Beyond its own error, a contact model gains nothing from a finer rung."
        )
        style.save(figure, folder, info.name)
    style.write_index([info], folder)
    return [info]
