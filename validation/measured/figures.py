"""The figure of the page "Against measurements"."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from trackroller.report.figures import style
from validation.measured.facts import column, read
from validation.measured.solve import FULL_SLIP, measured_traction


def draw_all(results: Mapping[str, Any], folder: Path) -> None:
    """Draw the creep curves of locomotive and twin disc into a folder (PNG and SVG), with an index.

    Parameters
    ----------
    results : mapping
        What `validation.measured.solve.results` returns.
    folder : Path
        The folder.
    """
    with style.look():
        figure = style.new_figure(75)
        left, right = figure.subplots(1, 2)
        measured, bare, film = style.palette(3)
        points = read("locomotive_creep")
        creepage = column(points, "longitudinal_creepage")
        own = results["locomotive"]
        left.errorbar(
            creepage,
            column(points, "traction_mean"),
            2.0 * column(points, "traction_deviation"),
            fmt="o",
            ms=3,
            color=measured,
            label="measured, ± 2 standard deviations",
        )
        left.plot(creepage, own["half_space"], color=bare, label="bare bodies, μ 0.33")
        left.plot(creepage, own["film"], color=film, ls="--", label="film and falling friction, fitted")
        left.set_xscale("log")
        style.log_ticks(left.xaxis, 0.3, 25.0)
        left.set_title("locomotive")
        discs = column(read("twin_disc"), "longitudinal_creepage")
        below = discs <= FULL_SLIP
        right.plot(discs[below], measured_traction()[below], "o", ms=3, color=measured, label="measured")
        right.plot(discs[below], results["twin_disc"]["traction"][below], color=bare, label="bare bodies")
        right.set_title("dry twin discs")
        for axes in (left, right):
            axes.set_xlabel("longitudinal creepage [%]")
            axes.set_ylim(bottom=0)
            axes.legend(frameon=False)
        left.set_ylabel("F/F_N [1]")
        style.head(figure, "Measured creep curves rise more slowly than those of bare bodies")
        style.save(figure, folder, "measured_creep")
    info = style.FigureInfo(
        "measured_creep",
        "Traction coefficient over longitudinal creepage: a locomotive and dry twin discs beside the exact theory.",
        "The film was fitted to the locomotive by others; its curve checks the code, and not the model.",
    )
    style.write_index([info], folder)
