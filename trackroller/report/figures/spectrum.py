"""The figure of a load spectrum: the share of each block in the damage of roller and guide."""

from __future__ import annotations

import numpy as np
import xarray as xr

from trackroller.parameters import BODIES
from trackroller.report.figures import style
from trackroller.report.numbers import chance, listing
from trackroller.results.spectrum_answer import known_damage

MOST = 16  # blocks drawn one by one; the others stand together


def damage_by_block(ds: xr.Dataset) -> style.Drawn:
    """Draw the share of each block in the damage of the track that fails first, one panel a body.

    Parameters
    ----------
    ds : result of `solve_spectrum`

    Returns
    -------
    The figure and its caption, or None if no body has known damage.
    """
    shares = {}
    unknown = {}
    for body in BODIES:
        _, damage = known_damage(ds, body)
        whole = float(np.nansum(damage))
        if whole > 0:
            shares[body] = np.nan_to_num(damage) / whole
            unknown[body] = np.isnan(damage)
    if not shares:
        return None
    names = [str(name) for name in ds["block"].values]
    order = np.argsort(-sum(shares.values()), kind="stable")
    nowhere = np.logical_and.reduce(list(unknown.values()))
    order = order[~nowhere[order]]
    shown = order[:MOST]
    further = order[MOST:]
    words = [names[i] for i in shown]
    if len(further):
        words.append(f"{len(further)} others")
    figure, panels = style.panels(
        f"Damage by block: {ds.attrs['title']}", 24 + 6.0 * len(words), len(shares), sharey=True
    )
    worst_blocks = []
    for axes, colour, (body, part) in zip(panels, style.PAIR, shares.items(), strict=False):
        values = part[shown]
        if len(further):
            values = np.append(values, part[further].sum())
        bars = axes.barh(words, 100 * values, color=colour, height=0.62)
        axes.bar_label(bars, [chance(float(v)) for v in values], padding=2, fontsize=7)
        axes.set(xlim=(0, 125), xticks=range(0, 101, 25), xlabel=f"damage of the {body} [%]")
        axes.grid(axis="y", visible=False)
        most = int(np.argmax(part))
        worst_blocks.append(
            f"{chance(float(part[most]))} of the damage of the {body} comes from '{names[most]}'"
        )
    panels[0].invert_yaxis()
    caption = (
        "Share of each block in the damage of all blocks, in the track of each body that "
        "fails first."
    )
    caption += _blocks_left_out(ds, unknown)
    return figure, style.FigureInfo("damage_by_block", caption, f"{listing(worst_blocks)}.")


def _blocks_left_out(ds: xr.Dataset, unknown: dict[str, np.ndarray]) -> str:
    """Return sentences on the blocks without known damage of each body; '' without such blocks."""
    blocks = {
        body: listing(ds["block"].values[rows].tolist())
        for body, rows in unknown.items()
        if rows.any()
    }
    if len(set(blocks.values())) == 1 and len(blocks) == len(unknown):
        return f" Blocks without known damage are not counted: {next(iter(blocks.values()))}."
    sentences = ""
    for body, names in blocks.items():
        sentences += f" Not counted for the {body}, without known damage: {names}."
    return sentences
