"""Figures of sensitivities: ranked indices, growth of a sample, Morris plane, interactions.

Those of an analysis take the dataset of `trackroller.results.sensitivity.analyse`. Every function returns a figure
with its caption, or None where the design does not support it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import seaborn
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from trackroller.report.figures import style
from trackroller.report.numbers import capital, count, with_unit
from trackroller.report.words import indices
from trackroller.report.words.samples import quantity_words
from trackroller.results.findings import WORTH
from trackroller.results.looks import looks_of
from trackroller.results.ranking import SIGNED, SIZED, decisive, headline, order
from trackroller.results.results import Results
from trackroller.study.outputs import USUAL

Look = dict[str, Any]
MAX_BARS = 12


def main_outputs(sens: xr.Dataset) -> list[str]:
    """Name the outputs that have an index, the most important first."""
    index = headline(sens)
    names = [str(n) for n in sens["output"].values if np.isfinite(sens[index].sel(output=n)).any()]
    return sorted(names, key=lambda n: USUAL.index(n) if n in USUAL else len(USUAL))  # lives first


def title(sens: xr.Dataset, output: str) -> str:
    """Name an output with a capital first letter."""
    return capital(indices.of_output(sens, output))


def tornado(sens: xr.Dataset, output: str) -> style.Drawn:
    """Draw bars of the headline index with 95 % intervals, the largest on top; first-order beside total Sobol indices.

    It answers: which factor decides, and how sure is that?
    """
    index = headline(sens)
    ranks = order(sens, output)[:MAX_BARS]
    if not decisive(sens, output):
        return None
    figure, (axes,) = style.panels(f"{title(sens, output)}: what decides it", 22 + 6.0 * len(ranks))
    place = np.arange(len(ranks))[::-1].astype(float)
    drawn = ("ST", "S1") if index == "ST" else (index,)
    for i, name in enumerate(drawn):
        own = {r.factor: r for r in order(sens, output, name)}
        value, low, high = np.array([own[r.factor][2:] if r.factor in own else [np.nan] * 3 for r in ranks]).T
        if name not in SIGNED:  # a share of variance is not drawn below 0
            value, low, high = (np.maximum(v, 0.0) for v in (value, low, high))
        at = place + (0.19 - 0.38 * i) * (len(drawn) > 1)
        look: Look = {"height": 0.38 if len(drawn) > 1 else 0.62, "hatch": "////" * i, "linewidth": 0.6}
        axes.barh(at, value, color=style.palette(2)[i], edgecolor="0.15", label=indices.INDEX_WORDS[name], **look)
        whisker: Look = {"fmt": "none", "ecolor": "0.1", "capsize": 1.8, "linewidth": 0.9}
        axes.errorbar(value, at, xerr=np.abs([value - low, high - value]), **whisker)
    if len(drawn) > 1:
        axes.legend(loc="lower right")
    style.name_rows(axes, place, [capital(r.name) for r in ranks])
    axes.axvline(0, color="0.2", linewidth=0.7)
    axes.set_xlabel(_axis(sens, output, index))
    caption = (
        f"{capital(indices.INDEX_WORDS[index])} of each factor on {indices.of_output(sens, output)}; whiskers: 95 % "
        f"intervals. {sens.attrs.get('treatment', '')}."
    )
    return figure, style.FigureInfo(f"tornado-{output}", caption)


def _axis(sens: xr.Dataset, output: str, index: str) -> str:
    text = indices.INDEX_WORDS[index]
    return with_unit(text, indices.effect_unit(sens, output)) if index in SIZED else f"{text}: share of variance [–]"


def _heat(table: np.ndarray, names: list[str], label: str, head: str) -> Figure:
    """Draw a heat map of pairs with its values written in."""
    figure, (axes,) = style.panels(head, 34 + 5.2 * len(names))
    texts = [[f"{v:.2f}".removeprefix("0") if abs(v) < 10 else f"{v:.3g}" for v in row] for row in table]
    top = max(float(np.nanmax(np.abs(table))), 1e-9)
    look: Look = {"cmap": "Greys", "vmin": 0.0, "vmax": top, "annot": np.array(texts), "annot_kws": {"size": 7}}
    bar = {"label": label, "shrink": 0.9, "pad": 0.02}
    seaborn.heatmap(table, ax=axes, fmt="", cbar_kws=bar, **look)
    axes.set_yticks(0.5 + np.arange(len(names)), names, rotation=0)
    axes.set_xticks(0.5 + np.arange(len(names)), names, rotation=25, ha="right", rotation_mode="anchor")
    axes.tick_params(length=0)
    axes.grid(visible=False)
    return figure


def _doubled(axes: Axes, sizes: Sequence[int] | np.ndarray, unit: str) -> None:
    """Write the sizes of a sample that doubles under the axis."""
    axes.set_xscale("log", base=2)
    axes.set_xticks(sizes, [count(int(size)) for size in sizes])
    axes.minorticks_off()
    axes.set_xlabel(f"{unit} [–]")


def morris_plane(sens: xr.Dataset, output: str) -> style.Drawn:
    """Draw sigma over mu*: effects grow to the right; above the line they depend on the other factors.

    It answers: which factors can be left out of a further study, and which act only together with others?
    """
    if "mu_star" not in sens:
        return None
    part = sens.sel(output=output)
    x, y = part["mu_star"].values, part["sigma"].values
    if not np.isfinite(x).any():
        return None
    figure, (axes,) = style.panels(f"{title(sens, output)}: elementary effects", 64 + 1.2 * int(np.isfinite(x).sum()))
    top = float(np.nanmax(x)) * 1.15 or 1.0
    for share, dash in ((1.0, "--"), (0.5, ":")):
        label = "σ = μ*" if share == 1 else "σ = μ*/2"
        axes.plot([0, top], [0, share * top], color="0.4", linestyle=dash, linewidth=0.8, label=label)
    whisker: Look = {"capsize": 1.5, "elinewidth": 0.7, "linestyle": "none"}
    whisker |= {"markeredgecolor": "0.15", "markeredgewidth": 0.5}
    ranks = order(sens, output)
    for i, (rank, colour) in enumerate(zip(ranks, style.palette(len(ranks)), strict=True)):
        half = np.abs([[rank.value - rank.low], [rank.high - rank.value]])
        look = {"color": colour, "marker": style.MARKERS[i % 10], "label": capital(rank.name)}
        axes.errorbar(rank.value, float(part["sigma"].sel(factor=rank.factor)), xerr=half, **whisker | look)
    unit = indices.effect_unit(sens, output)
    axes.set(xlabel=f"mean absolute effect μ* [{unit}]", ylabel=f"spread of the effects σ [{unit}]")
    axes.set(xlim=(0, top), ylim=(0, float(np.nanmax(y)) * 1.15 or 1.0))
    figure.legend(loc="outside right upper")
    caption = (
        "Elementary effects over each factor's whole range. Above the lines the effect of a factor differs from place "
        "to place: it is curved or depends on other factors. Whiskers: 95 % intervals."
    )
    return figure, style.FigureInfo(f"morris-{output}", caption)


def interactions(sens: xr.Dataset, output: str) -> style.Drawn:
    """Draw a heat map of two-factor interactions, main effects on the diagonal.

    It answers: which two factors have to be chosen together? None if no interaction reaches 5 % of the variance.
    """
    part = sens.sel(output=output)
    name = next((n for n in ("S2", "interaction_share", "interaction") if n in part), "")
    if not name or not np.isfinite(part[name].values).any():
        return None
    sized = name == "interaction"
    if not sized and np.nanmax(part[name].values) < WORTH:
        return None
    fitted = name == "interaction_share" and "main_share" not in part
    own = "fit_alone" if fitted else {"S2": "S1", "interaction_share": "main_share", "interaction": "effect"}[name]
    table = np.where(np.isfinite(part[name].values), part[name].values, part[name].values.T)
    np.fill_diagonal(table, part[own].values)
    table = np.abs(table) if sized else np.maximum(table, 0.0)  # estimates of a share may be negative
    table = np.where(np.triu(np.ones_like(table, dtype=bool)), table, np.nan)
    names = [capital(str(n)) for n in part["factor_name"].values]
    label = f"size [{indices.effect_unit(sens, output)}]" if sized else "share of variance [–]"
    figure = _heat(table, names, label, f"{title(sens, output)}: interactions")
    caption = "Off the diagonal: the interaction of two factors; on the diagonal: each factor alone."
    caption += " Approximate: from a polynomial fitted to the sample." if fitted else ""
    return figure, style.FigureInfo(f"interactions-{output}", caption)


def intervals(results: Results) -> style.Drawn:
    """Draw the half width of the widest interval of each output of `until` against the number of cases.

    It answers: was growing worth its cases? None for a study with fewer than two looks.
    """
    growth = looks_of(results)
    if growth is None or len(growth["looks"]) < 2:
        return None
    cases = [one["cases"] for one in growth["looks"]]
    names = list(growth["looks"][0]["half_width"])
    figure, (axes,) = style.panels("Intervals as the sample grew", 58)
    for i, (name, colour) in enumerate(zip(names, style.palette(len(names)), strict=True)):
        width = np.array([one["half_width"][name] for one in growth["looks"]], dtype=float)
        look = {"marker": style.MARKERS[i % len(style.MARKERS)], "linestyle": style.LINES[i % len(style.LINES)]}
        axes.plot(cases, width, color=colour, label=capital(quantity_words(name, results.design.method)), **look)
    axes.axhline(growth["half_width"], color="0.3", linewidth=0.8, linestyle=":", label="wanted")
    _doubled(axes, cases, "cases")
    axes.set(ylim=(0.0, None), ylabel="half width of the\nwidest interval [–]")
    figure.legend(loc="outside lower center", ncols=2)
    caption = f"95 % intervals from {growth['replicates']} independent replicates at each doubling of the sample."
    return figure, style.FigureInfo("intervals-against-cases", caption)
