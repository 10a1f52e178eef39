"""Figures of sensitivities: ranked indices, growth of a sample, Morris plane, interactions.

Those of an analysis take the dataset of `trackroller.results.sensitivity.analyse`. Every function
returns a figure with its caption, or None where the design does not support it.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import seaborn
import xarray as xr
from matplotlib.figure import Figure

from trackroller.errors import listing
from trackroller.report.figures import style
from trackroller.report.numbers import capital
from trackroller.report.tables import indices
from trackroller.results.ranking import headline, order
from trackroller.study.outputs import USUAL

Look = dict[str, Any]
WORTH = 0.02  # of the variance: smaller interactions alone are no figure


def main_outputs(sens: xr.Dataset) -> list[str]:
    """Name the outputs that have an index, the most important first."""
    index = headline(sens)
    names = [str(n) for n in sens["output"].values if np.isfinite(sens[index].sel(output=n)).any()]
    usual = [name for name in USUAL if name in names]  # lives first
    return [*usual, *(name for name in names if name not in usual)]


def title(sens: xr.Dataset, output: str) -> str:
    """Name an output with a capital first letter."""
    return capital(indices.of_output(sens, output))


def _heat(table: np.ndarray, names: list[str], label: str, head: str) -> Figure:
    """Draw a heat map of pairs with its values written in."""
    figure, (axes,) = style.panels(head, 34 + 5.2 * len(names))
    texts = [
        [f"{v:.2f}".removeprefix("0") if abs(v) < 10 else f"{v:.3g}" for v in row] for row in table
    ]
    top = max(float(np.nanmax(np.abs(table))), 1e-9)
    look: Look = {
        "cmap": "Greys",
        "vmin": 0.0,
        "vmax": top,
        "annot": np.array(texts),
        "annot_kws": {"size": 7},
    }
    bar = {"label": label, "shrink": 0.9, "pad": 0.02}
    seaborn.heatmap(table, ax=axes, fmt="", cbar_kws=bar, **look)
    axes.set_yticks(0.5 + np.arange(len(names)), names, rotation=0)
    axes.set_xticks(
        0.5 + np.arange(len(names)), names, rotation=25, ha="right", rotation_mode="anchor"
    )
    axes.tick_params(length=0)
    axes.grid(visible=False)
    return figure


def morris_plane(sens: xr.Dataset, output: str) -> style.Drawn:
    """Draw sigma over mu*: effects grow to the right; above the line they depend on the other
    factors.

    It answers: which factors can be left out of a further study, and which act only together with
    others?
    """
    if "mu_star" not in sens:
        return None
    part = sens.sel(output=output)
    x, y = part["mu_star"].values, part["sigma"].values
    both = np.isfinite(x) & np.isfinite(y)
    if not both.any():  # one effect of a factor has no spread
        return None
    drawn = set(part["factor"].values[both])
    figure, (axes,) = style.panels(
        f"{title(sens, output)}: elementary effects", 64 + 1.2 * int(both.sum())
    )
    top = float(x[both].max()) * 1.15 or 1.0
    for share, dash in ((1.0, "--"), (0.5, ":")):
        label = "σ = μ*/2"
        if share == 1:
            label = "σ = μ*"
        axes.plot(
            [0, top], [0, share * top], color="0.4", linestyle=dash, linewidth=0.8, label=label
        )
    whisker: Look = {"capsize": 1.5, "elinewidth": 0.7, "linestyle": "none"}
    whisker |= {"markeredgecolor": "0.15", "markeredgewidth": 0.5}
    ranks = [rank for rank in order(sens, output) if rank.factor in drawn]
    left_out = [rank.name for rank in order(sens, output) if rank.factor not in drawn]
    for i, (rank, colour) in enumerate(zip(ranks, style.palette(len(ranks)), strict=True)):
        half = np.abs([[rank.value - rank.low], [rank.high - rank.value]])
        look = {"color": colour, "marker": style.MARKERS[i % 10], "label": capital(rank.name)}
        axes.errorbar(
            rank.value, float(part["sigma"].sel(factor=rank.factor)), xerr=half, **whisker | look
        )
    unit = indices.effect_unit(sens, output)
    axes.set(xlabel=f"mean absolute effect μ* [{unit}]", ylabel=f"spread of the effects σ [{unit}]")
    axes.set(xlim=(0, top), ylim=(0, float(y[both].max()) * 1.15 or 1.0))
    figure.legend(loc="outside right upper")
    caption = (
        "Elementary effects over each factor's whole range. Above the lines the effect of a factor "
        "differs from place to place: it is curved or depends on other factors. Whiskers: 95 % "
        "intervals."
    )
    if left_out:
        caption += f" Not drawn, because one effect has no spread: {listing(left_out)}."
    return figure, style.FigureInfo(f"morris-{output}", caption)


def interactions(sens: xr.Dataset, output: str) -> style.Drawn:
    """Draw a heat map of two-factor interactions, main effects on the diagonal.

    It answers: which two factors have to be chosen together? None if no interaction reaches 5 % of
    the variance.
    """
    part = sens.sel(output=output)
    name = next((n for n in ("S2", "interaction_share", "interaction") if n in part), "")
    if not name or not np.isfinite(part[name].values).any():
        return None
    sized = name == "interaction"
    if not sized and np.nanmax(part[name].values) < WORTH:
        return None
    fitted = name == "interaction_share" and "main_share" not in part
    if fitted:
        own = "fit_alone"
    else:
        own = {"S2": "S1", "interaction_share": "main_share", "interaction": "effect"}[name]
    table = np.where(np.isfinite(part[name].values), part[name].values, part[name].values.T)
    np.fill_diagonal(table, part[own].values)
    # estimates of a share may be negative
    if sized:
        table = np.abs(table)
    else:
        table = np.maximum(table, 0.0)
    table = np.where(np.triu(np.ones_like(table, dtype=bool)), table, np.nan)
    names = [capital(str(n)) for n in part["factor_name"].values]
    label = "share of variance [–]"
    if sized:
        label = f"size [{indices.effect_unit(sens, output)}]"
    figure = _heat(table, names, label, f"{title(sens, output)}: interactions")
    caption = (
        "Off the diagonal: the interaction of two factors; on the diagonal: each factor alone."
    )
    if fitted:
        caption += " Approximate: from a polynomial fitted to the sample."
    return figure, style.FigureInfo(f"interactions-{output}", caption)
