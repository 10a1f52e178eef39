"""Figures 6 to 11 of Wenzel et al. 2022, drawn from our numbers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.ticker import MaxNLocator

from trackroller.report.figures import style
from trackroller.report.figures.contact import friction_energy, shear_arrows
from trackroller.report.figures.contact_sections import sections
from validation.paper.compute import MODELS, reference, solved

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Drawn = tuple["Figure", style.FigureInfo]
TITLES = {"sliding": "contact model sliding (the paper's)", "kalker": "contact model kalker (exact theory)"}
SOURCES = ("published program", "ours, sliding", "ours, kalker", "CONTACT")


def draw_all(folder: Path) -> list[style.FigureInfo]:
    """Draw every figure into `folder` (PNG and SVG) with an index; returns what they show."""
    infos = []
    with style.look():
        for figure, info in _figures():
            style.save(figure, folder, info.name)
            infos.append(info)
    style.write_index(infos, folder)
    return infos


def _figures() -> Iterator[Drawn]:
    overview = solved("driven", "sliding")
    for kind, draw in (("shear", shear_arrows), ("energy", friction_energy)):
        for model in MODELS:
            drawn = draw(solved("driven", model))
            if drawn is not None:
                number = "figures 6 and 10" if model == "sliding" else "figure 10"
                yield _renamed(drawn, f"paper_10_{kind}_{model}", number, model)
    for i in (1, 2):
        drawn = sections(overview, i)
        if drawn is not None:
            number = "figures 6 and 11" if i == 1 else "figure 6"
            yield _renamed(drawn, f"paper_6_stress_contact_{i}", number, "sliding")
    for scene, part, words in (("frictionless", "top", "free, μ = 0.0001"), ("free", "bottom", "free, μ = 0.3")):
        drawn = sections(solved(scene, "sliding"), 1)
        if drawn is not None:
            yield _renamed(drawn, f"paper_7_{scene}", f"figure 7, {part}", "sliding", words)
    yield bars()
    yield tractions()
    drawn = sections(solved("driven", "kalker"), 1)
    if drawn is not None:
        yield _renamed(drawn, "paper_11_kalker", "figure 11", "kalker")


def _renamed(drawn: Drawn, name: str, number: str, model: str, scene: str = "driven, μ = 0.3") -> Drawn:
    figure, info = drawn
    caption = f"Paper's {number}: {scene}, {TITLES[model]}. {info.caption}"
    return figure, replace(info, name=name, caption=caption)


def _values(source: str, name: str, contact: int) -> float:
    known = reference()
    if source == "published program":
        value: Any = known["driven"]["published"][name]
    elif source == "CONTACT":
        value = known["driven"]["contact"][name]
    else:
        value = solved("driven", source.rpartition(" ")[2])[name].values.tolist()
    value = value[contact]
    return float(max(value)) if isinstance(value, list) else float(value)


def bars() -> Drawn:
    """Draw figure 8: forces and stresses of both contacts by program."""
    figure = style.new_figure(122, style.COLUMN_MM)
    upper, lower = figure.subplots(2, 1)
    groups = [
        ("normal_force", "$F_\\mathrm{N%d}$"),
        ("lateral_force", "$F_\\mathrm{T%d}$"),
        ("driving_force", "$F_\\mathrm{A%d}$"),
    ]
    stresses = [("max_pressure", "$p_\\mathrm{max,%d}$"), ("peak_stress", "$\\sigma_\\mathrm{DEH,%d}$")]
    hatches, colours = ("//", "", "", ".."), style.palette(4)
    for axes, names in ((upper, groups), (lower, stresses)):
        labels = [label % (c + 1) for name, label in names for c in (0, 1)]
        place = np.arange(len(labels), dtype=float)
        for k, source in enumerate(SOURCES):
            values = [_values(source, name, c) for name, _ in names for c in (0, 1)]
            axes.bar(
                place + 0.2 * (k - 1.5),
                values,
                0.19,
                color=colours[k],
                hatch=hatches[k],
                edgecolor="white",
                linewidth=0.3,
                label=source,
            )
        axes.set_xticks(place, labels)
        axes.axhline(0.0, color="black", linewidth=0.6)
    upper.set_ylabel("Force on the roller [N]")
    lower.set_ylabel("Stress [MPa]")
    figure.legend(*upper.get_legend_handles_labels(), loc="outside lower left", ncols=2)
    style.head(figure, "Forces and stresses of the paper's case", "Driven with 30 N, μ = 0.3")
    apart = _values("ours, sliding", "lateral_force", 1) / _values("CONTACT", "lateral_force", 1) - 1.0
    return figure, style.FigureInfo(
        "paper_8_bars",
        "Paper's figure 8: forces on the roller and stresses in both contacts, driven, μ = 0.3; published program, "
        "this software with both contact models, and CONTACT. σ_DEH is the larger of both bodies; the published "
        "program has no values on the surface.",
        f"The lateral force of contact 2 in sliding is {100 * apart:.0f} % larger than in CONTACT; kalker agrees with "
        "CONTACT.",
    )


def tractions() -> Drawn:
    """Draw figure 9: pressure and both shear components of contact 1, both models."""
    names = (("pressure", "$p$"), ("shear_lateral", "$\\tau_x$"), ("shear_rolling", "$\\tau_y$"))
    figure = style.new_figure(94, style.COLUMN_MM)
    grid = figure.subplots(3, 2, sharex=True, sharey=True)
    for column, model in enumerate(MODELS):
        part = solved("driven", model).isel(contact=0)
        inside = part["pressure"].values > 0
        for row, (name, symbol) in enumerate(names):
            axes = grid[row, column]
            values = np.where(inside, part[name].values, np.nan)
            top = 650.0 if name == "pressure" else 200.0
            colours = "YlGnBu" if name == "pressure" else "RdBu_r"
            image = axes.contourf(
                part["patch_x"],
                part["patch_y"],
                values,
                cmap=colours,
                levels=np.linspace(0.0 if name == "pressure" else -top, top, 14),
            )
            lines = axes.contour(
                part["patch_x"],
                part["patch_y"],
                values,
                levels=[-100, 0, 100] if row else [300, 500],
                colors="black",
                linewidths=0.5,
            )
            axes.clabel(lines, fontsize=5.5, fmt="%g")
            axes.set_aspect("equal")
            axes.set_title(f"{symbol}, {model}", loc="left", fontsize=7.5, pad=3)
            if column == 1:
                bar = figure.colorbar(image, ax=list(grid[row]), location="right", aspect=14, pad=0.02)
                bar.set_label(f"{symbol} [MPa]")
                bar.locator = _few()
                bar.update_ticks()
    for axes in grid[-1]:
        axes.set_xlabel("$x_\\mathrm{C}$ (lateral) [mm]")
    for axes in grid[:, 0]:
        axes.set_ylabel("$y_\\mathrm{C}$ [mm]")
    style.head(figure, "Pressure and shear of contact 1", "On the roller, driven with 30 N, μ = 0.3")
    return figure, style.FigureInfo(
        "paper_9_tractions",
        "Paper's figure 9: pressure and shear on the roller in contact 1, driven, μ = 0.3: sliding with the "
        "empirical spin pole (left) and kalker, the exact theory (right).",
        "The lateral shear differs most. Sliding puts the spin pole on the edge, but elasticity moves it inside: the "
        "part of the opposite sign grows, and the lateral force falls.",
    )


def _few() -> Any:

    return MaxNLocator(5)
