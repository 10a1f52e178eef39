"""Figures of sensitivities: tornado, overview, convergence, Morris plane, interactions.

Every function takes the dataset of `trackroller.analysis.sensitivity.analyse_dataset` and returns a figure with its
caption and sentence, or None where the design does not support it.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from trackroller.report import sentences as words
from trackroller.report.figures import style

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

log = logging.getLogger(__name__)
Drawn = tuple["Figure", style.FigureInfo] | None
MAX_BARS = 12
FIRST = (
    "roller_life_hours",
    "roller_life_cycles",
    "guide_life_hours",
    "guide_life_cycles",
    "friction_power",
    "roller_peak_stress",
    "guide_peak_stress",
    "max_pressure",
    "friction_energy",
)
AXIS = {
    "S1": "share of variance, alone",
    "ST": "share of variance",
    "first": "share of variance, alone",
    "main_share": "share of variance, alone",
    "mu_star": "mean absolute effect μ*",
    "effect": "change over the range",
}


def main_outputs(sens: xr.Dataset, count: int) -> list[str]:
    """The outputs most asked for that have an index."""
    index = words.headline(sens)
    names = [str(n) for n in sens["output"].values if np.isfinite(sens[index].sel(output=n)).any()]
    return sorted(names, key=lambda n: FIRST.index(n) if n in FIRST else len(FIRST))[:count]


def effect_unit(sens: xr.Dataset, output: str) -> str:
    """Unit of an effect: decades on the logarithmic scale."""
    part = sens.sel(output=output)
    return "decades" if str(part["scale"].item()) == "log10" else style.unit_text(str(part["output_units"].item()))


def title(sens: xr.Dataset, output: str) -> str:
    """Output in words, with a large first letter."""
    return words.upper(words.of_output(sens, output))


def tornado(sens: xr.Dataset, output: str) -> Drawn:
    """Bars of the headline index with 95 % intervals, the largest on top."""
    index = words.headline(sens)
    ranks = words.order(sens, output)[:MAX_BARS]
    if not ranks:
        return None
    figure = style.new_figure(24 + 6.5 * len(ranks))
    axes = figure.add_subplot()
    colours = style.palette(4)
    place = np.arange(len(ranks))[::-1].astype(float)
    second = {r.factor: r for r in words.order(sens, output, "S1")} if index == "ST" else {}
    high = 0.38 if second else 0.62
    _bars(
        axes,
        place + (high / 2 if second else 0),
        ranks,
        high,
        colours[0],
        "",
        "with interactions" if second else AXIS[index],
        index not in words.SIGNED,
    )
    if second:
        alone = [second[r.factor] for r in ranks if r.factor in second]
        at = np.array([p for p, r in zip(place, ranks, strict=True) if r.factor in second]) - high / 2
        _bars(axes, at, alone, high, colours[1], "////", "alone", True)
        axes.legend(loc="lower right")
    axes.set_yticks(place, [words.upper(r.name) for r in ranks])
    axes.tick_params(axis="y", length=0)
    axes.grid(axis="y", visible=False)
    axes.axvline(0, color="0.2", linewidth=0.7)
    unit = f" [{effect_unit(sens, output)}]" if index in ("mu_star", "effect") else " [–]"
    axes.set_xlabel(AXIS[index] + unit)
    style.head(figure, f"{title(sens, output)}: what decides it")
    style.finish(figure)
    caption = (
        f"{_told(index)} of each factor on {words.of_output(sens, output)}; whiskers: 95 % "
        f"intervals. {sens.attrs.get('treatment', '')}."
    )
    return figure, style.FigureInfo(f"tornado-{output}", caption, words.tornado(sens, output))


def _told(index: str) -> str:
    return words.upper(AXIS[index].replace(", alone", " explained alone"))


def _bars(axes, place, ranks, height, colour, hatch, label, shares) -> None:  # type: ignore[no-untyped-def]
    value = np.array([r.value for r in ranks])
    ends = np.array([[r.low, r.high] for r in ranks]).T
    if shares:  # no share of variance is below nothing
        value, ends = np.maximum(value, 0.0), np.where(np.isnan(ends), np.nan, np.maximum(ends, 0.0))
    error = np.abs(ends - value)
    axes.barh(place, value, height, color=colour, hatch=hatch, edgecolor="0.15", linewidth=0.6, label=label)
    good = np.isfinite(error).all(axis=0)
    if good.any():
        axes.errorbar(
            value[good], place[good], xerr=error[:, good], fmt="none", ecolor="0.1", capsize=1.8, linewidth=0.9
        )


def overview(sens: xr.Dataset) -> Drawn:
    """All outputs at once: the headline index of each factor, relative to the largest where it has units."""
    index = words.headline(sens)
    table = sens[index].transpose("factor", "output").values
    table = np.abs(table) if index in words.SIGNED else np.where(np.isnan(table), np.nan, np.maximum(table, 0.0))
    keep = np.isfinite(table).any(axis=0)
    if keep.sum() < 2:
        return None
    table = table[:, keep]
    if index in ("mu_star", "effect"):
        table = table / np.nanmax(table, axis=0)
    rank = np.argsort(-np.nan_to_num(table).mean(axis=1))
    names = [words.upper(str(n)) for n in sens["factor_name"].values[rank]]
    outputs = [words.upper(str(n)) for n in sens["output_name"].values[keep]]
    figure = _heat(
        table[rank].T,
        outputs,
        names,
        "relative to the largest" if index in ("mu_star", "effect") else AXIS[index],
        "Influence on every output",
    )
    caption = f"{_told(index)} of every factor (columns) on every output (rows)."
    return figure, style.FigureInfo("influence-overview", caption, words.overview(sens))


def _heat(table: np.ndarray, rows: list[str], columns: list[str], label: str, head: str) -> Figure:
    """A heat map with its values written in."""
    figure = style.new_figure(38 + 5.2 * len(rows), style.COLUMN_MM if len(columns) <= 6 else 60 + 8.0 * len(columns))
    axes = figure.add_subplot()
    limit = max(float(np.nanmax(np.abs(table))), 1e-9)
    image = axes.imshow(table, cmap="Greys", vmin=0.0, vmax=limit, aspect="auto")
    for (i, j), value in np.ndenumerate(table):
        if np.isfinite(value):
            axes.text(
                j,
                i,
                f"{value:.2f}".removeprefix("0") if abs(value) < 10 else f"{value:.3g}",
                ha="center",
                va="center",
                fontsize=6,
                color="white" if value > 0.6 * limit else "0.1",
            )
    axes.set_yticks(range(len(rows)), rows)
    axes.set_xticks(range(len(columns)), columns, rotation=40, ha="right", rotation_mode="anchor")
    axes.tick_params(length=0)
    axes.grid(visible=False)
    figure.colorbar(image, ax=axes, label=label, shrink=0.9, pad=0.02)
    style.head(figure, head)
    return figure


def convergence(sens: xr.Dataset, output: str) -> Drawn:
    """The headline index of the leading factors over the number of samples, with 95 % bands."""
    index = words.headline(sens)
    ranks = words.order(sens, output)[:5]
    if f"{index}_course" not in sens or not ranks or sens.sizes.get("sample_size", 0) < 2:
        return None
    figure = style.new_figure(62)
    axes = figure.add_subplot()
    part = sens.sel(output=output)
    for i, (rank, colour) in enumerate(zip(ranks, style.palette(len(ranks)), strict=True)):
        one = part.sel(factor=rank.factor)
        size, low, high = one["sample_size"].values, one[f"{index}_course_low"], one[f"{index}_course_high"]
        axes.fill_between(size, low, high, color=colour, alpha=0.15, linewidth=0)
        axes.plot(
            size,
            one[f"{index}_course"],
            color=colour,
            marker=style.MARKERS[i],
            label=words.upper(rank.name),
            linestyle=style.LINES[i % len(style.LINES)],
        )
    axes.set_xscale("log", base=2)
    axes.set_xticks(part["sample_size"].values, [str(n) for n in part["sample_size"].values])
    axes.minorticks_off()
    unit = {"saltelli": "base samples", "morris": "trajectories"}.get(str(sens.attrs["method"]), "rows")
    axes.set_xlabel(f"{unit} [–]")
    short = f"effect μ* [{effect_unit(sens, output)}]" if index == "mu_star" else f"{AXIS[index]} [–]"
    axes.set_ylabel(short)
    top = [np.nanmax(part[f"{index}_course"].sel(factor=r.factor).values) for r in ranks]
    axes.set_ylim(min(0.0, -0.1 * max(top)), 1.35 * max(top))
    figure.legend(loc="outside lower center", ncols=2)
    style.head(figure, f"{title(sens, output)}: course of the indices")
    style.finish(figure)
    caption = f"{_told(index)} from the first samples up to all of them; bands: 95 % intervals."
    return figure, style.FigureInfo(f"convergence-{output}", caption, words.convergence(sens, output))


def morris_plane(sens: xr.Dataset, output: str) -> Drawn:
    """sigma over mu*: right matters, above the line acts differently from place to place."""
    if "mu_star" not in sens:
        return None
    part = sens.sel(output=output)
    x, y = part["mu_star"].values, part["sigma"].values
    if not np.isfinite(x).any():
        return None
    figure = style.new_figure(58 + 2.3 * int(np.isfinite(x).sum() + 2))
    axes = figure.add_subplot()
    top = float(np.nanmax(x)) * 1.15 or 1.0
    axes.plot([0, top], [0, top], color="0.4", linestyle="--", linewidth=0.8, label="σ = μ*")
    axes.plot([0, top], [0, top / 2], color="0.4", linestyle=":", linewidth=0.8, label="σ = μ*/2")
    for i, (rank, colour) in enumerate(_ranked(sens, output)):
        j = int(np.flatnonzero(part["factor"].values == rank.factor)[0])
        half = np.abs([[rank.value - rank.low], [rank.high - rank.value]])
        axes.errorbar(
            x[j],
            y[j],
            xerr=half if np.isfinite(half).all() else None,
            color=colour,
            capsize=1.5,
            marker=style.MARKERS[i % len(style.MARKERS)],
            linestyle="none",
            markeredgecolor="0.15",
            markeredgewidth=0.5,
            elinewidth=0.7,
            label=words.upper(rank.name),
        )
    unit = effect_unit(sens, output)
    axes.set_xlabel(f"mean absolute effect μ* [{unit}]")
    axes.set_ylabel(f"spread of the effects σ [{unit}]")
    axes.set_xlim(0, top)
    axes.set_ylim(0, float(np.nanmax(y)) * 1.15 or 1.0)
    figure.legend(loc="outside lower center", ncols=2)
    style.head(figure, f"{title(sens, output)}: elementary effects")
    style.finish(figure)
    caption = (
        "Elementary effects over each factor's whole range: to the right a factor matters; above the lines "
        "its effect depends on where one is. Whiskers: 95 % intervals."
    )
    return figure, style.FigureInfo(f"morris-{output}", caption, words.morris(sens, output))


def _ranked(sens: xr.Dataset, output: str) -> Iterator[tuple[words.Rank, object]]:
    ranks = words.order(sens, output)
    colours = style.palette(10)
    for i, rank in enumerate(ranks):
        yield rank, colours[i % len(colours)]


def interactions(sens: xr.Dataset, output: str) -> Drawn:
    """Heat map of two-factor interactions, main effects on the diagonal."""
    part = sens.sel(output=output)
    name = next((n for n in ("S2", "interaction_share", "interaction") if n in part), "")
    if not name or not np.isfinite(part[name].values).any():
        return None
    table = np.array(part[name].values, dtype=float)
    table = np.where(np.isfinite(table), table, table.T)
    if name != "interaction":
        table = np.where(np.isfinite(table), np.maximum(table, 0.0), table)  # estimates of nothing fall below 0
    fitted = name == "interaction_share" and "main_share" not in part
    own = "fit_alone" if fitted else {"S2": "S1", "interaction_share": "main_share", "interaction": "effect"}[name]
    np.fill_diagonal(table, np.abs(part[own].values) if own == "effect" else np.maximum(part[own].values, 0.0))
    table = np.where(np.triu(np.ones_like(table, dtype=bool)), np.abs(table), np.nan)
    names = [words.upper(str(n)) for n in part["factor_name"].values]
    unit = effect_unit(sens, output) if name == "interaction" else "share of variance"
    figure = _heat(
        table,
        names,
        names,
        f"{unit} [–]" if name != "interaction" else f"size [{unit}]",
        f"{title(sens, output)}: interactions",
    )
    caption = "Off the diagonal what two factors do together beyond the sum of both; on it each factor alone."
    if fitted:
        caption += " Approximate: from a polynomial fitted to the sample."
    return figure, style.FigureInfo(f"interactions-{output}", caption, words.interactions(sens, output))


def draw_all(study_nc: Path, sensitivity_nc: Path, out_dir: Path) -> list[style.FigureInfo]:
    """Draw every figure the analysis of a study supports, as SVG and PNG, and `index-sensitivity.json`.

    Parameters
    ----------
    study_nc : gathered study
    sensitivity_nc : its analysis (`trackroller.analysis.sensitivity.analyse`)
    out_dir : folder for the figures

    Returns
    -------
    What was drawn, in the order of the report. A figure that cannot be drawn is left out with a logged warning.
    """
    import xarray as xr

    from trackroller.analysis.pareto import study_pareto
    from trackroller.report.figures.bands import bands
    from trackroller.report.figures.pareto import parallel, pareto_front, robust_points

    with xr.open_dataset(study_nc) as a, xr.open_dataset(sensitivity_nc) as b:
        ds, sens = a.load(), b.load()
    jobs: list[Callable[[], Drawn]] = []
    if sens.attrs.get("method") == "inner_outer":
        jobs += [partial(robust_points, sens, str(n)) for n in sens["output"].values if "life" in str(n)]
    else:
        jobs.append(partial(overview, sens))
        for draw, count in ((tornado, 4), (convergence, 1), (morris_plane, 2), (interactions, 2)):
            jobs += [partial(draw, sens, name) for name in main_outputs(sens, count)]
    jobs.append(partial(bands, ds))
    if (front := study_pareto(ds)) is not None:
        jobs += [partial(pareto_front, front), partial(parallel, front)]
    infos = []
    with style.look():
        for job in jobs:
            try:
                if (drawn := job()) is not None:
                    style.save(drawn[0], Path(out_dir), drawn[1].name)
                    infos.append(drawn[1])
            except Exception as problem:
                log.warning("a figure of the sensitivities was not drawn: %s", problem, exc_info=True)
    style.write_index(infos, Path(out_dir), "index-sensitivity.json")
    return infos
