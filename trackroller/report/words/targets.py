"""Sentences and tables on the targets of a study: how probable it is that a design meets each of them."""

from __future__ import annotations

import numpy as np
import xarray as xr

from trackroller.analysis.ranking import estimate
from trackroller.report.numbers import capital, count, level_text, long_name, number, quantity, setting
from trackroller.report.tables.cases import Table
from trackroller.report.words.pareto import chance, point_words
from trackroller.report.words.sentence import Sentence

SAME = 1e-6  # probabilities that differ by less are called the same
MAX_POINTS = 24  # rows of the table of design points
INTERVAL = "95 % interval "
WHOLE = {"grid": "designs of the grid", "table": "rows of the table"}  # designs without an interval


def target_words(table: xr.Dataset, target: int) -> str:
    """Name a target: 'life of the roller of at least 500 h', 'slip from 0.1 to 0.2', 'all targets'."""
    part = table.isel(target=target)
    name, unit = str(part["target_name"].item()), str(part["target_units"].item())
    low, high = float(part["target_min"]), float(part["target_max"])
    if np.isfinite(low) and np.isfinite(high):
        return f"{name} from {quantity(low, unit)} to {quantity(high, unit)}"
    if np.isfinite(low):
        return f"{name} of at least {quantity(low, unit)}"
    return f"{name} of at most {quantity(high, unit)}" if np.isfinite(high) else name


def target(table: xr.Dataset, number: int) -> Sentence:
    """State how probable it is to meet a target at the best and the worst design point, or in all cases.

    Then name the factor whose levels differ most, where their intervals lie apart.

    Parameters
    ----------
    table : analysis with the variables of `trackroller.analysis.targets.targets`
    number : of the target
    """
    part, what = table.isel(target=number), capital(target_words(table, number))
    share, low, high = estimate(part, "target_probability")
    values = {"target": number, "share": share.tolist(), "low": low.tolist(), "high": high.tolist()}
    if share.ndim:
        best, worst = int(np.argmax(share)), int(np.argmin(share))
        values |= {"best": best, "worst": worst}
        told = chance(share[best], low[best], high[best], INTERVAL)
        same = len(share) > 1 and share[best] - share[worst] < SAME
        where = f"all {len(share)} design points" if same else point_words(table, best)
        text = f"{what}: probability {told} at {where}"
        if len(share) > 1 and not same:
            text += f"; no other of the {count(len(share))} design points has more. The least, "
            text += f"{chance(share[worst], low[worst], high[worst], INTERVAL)}, is at {point_words(table, worst)}"
    elif np.isfinite(low):
        text = f"{what}: probability {chance(share, low, high, INTERVAL)} over all cases"
    else:
        of = WHOLE.get(str(table.attrs.get("method")), "cases")
        text = f"{what}: met by {chance(share)} of the {of}"
    most = _widest(part)
    if most is not None:
        values["levels"] = most
        ends = [f"{_cell(part, 'level', i)} at {_level_words(part, i)}" for i in most]
        name = capital(long_name(str(part["level_factor"][most[0]].item())))
        text += f". {name} changes it most: from {ends[0]} to {ends[1]}"
    return Sentence("target", f"{text}.", values)


def _widest(part: xr.Dataset) -> tuple[int, int] | None:
    """Return the levels with the least and the largest probability of the factor whose levels differ most.

    None if their intervals meet, so that the difference may be chance.
    """
    best: tuple[float, int, int] | None = None
    if "level_probability" not in part:
        return None
    share, low, high = estimate(part, "level_probability")
    for name in dict.fromkeys(part["level_factor"].values.tolist()):
        own = np.flatnonzero(part["level_factor"].values == name)
        least, most = int(own[np.argmin(share[own])]), int(own[np.argmax(share[own])])
        apart = share[most] - share[least]
        if apart > 0 and not high[least] >= low[most] and (best is None or apart > best[0]):
            best = float(apart), least, most
    return None if best is None else best[1:]


def _cell(part: xr.Dataset, kind: str, place: int | None) -> str:
    found = estimate(part, f"{kind}_probability")
    return chance(*(found if place is None else found[:, place]))


def _level_words(part: xr.Dataset, level: int) -> str:
    """Name a level, or the range of a class: 'friction coefficient 0.1 to 0.15'."""
    name, text = str(part["level_factor"][level].item()), str(part["level_text"][level].item())
    low, high = float(part["level_low"][level]), float(part["level_high"][level])
    if text or low == high:
        return setting(name, text or low)
    return f"{long_name(name)} {number(low)} to {level_text(name, high, words=False)}"


def target_tables(table: xr.Dataset) -> list[Table]:
    """List the probability of each target at each design point (or in all cases), and at each level of a factor."""
    if "target_probability" not in table:
        return []
    targets = range(table.sizes["target"])
    heads = [f"{capital(target_words(table, t))} (95 % interval)" for t in targets]
    said = [target(table, t).text for t in targets]
    said.append("A case that does not roll, misses a constraint or has no value misses every target.")
    if float(table.attrs.get("log_life_scatter", 0.0)) > 0:
        said.append("Lives hold the material's own scatter.")
    places = range(table.sizes.get("target_level", 0))
    levels = [[capital(_level_words(table, i)), *_cells(table, "level", i)] for i in places]
    title = "Targets: probability by level of a factor"
    if table["target_probability"].ndim == 1:
        every = ["All cases", *_cells(table, "target")]
        return [Table("targets", title, ["Level", *heads], [every, *levels], " ".join(said))]
    order = np.argsort(-table["target_probability"].values[-1], kind="stable")
    rows = [[capital(point_words(table, int(p))), *_cells(table, "target", int(p))] for p in order[:MAX_POINTS]]
    said.append(f"Every design point has the same {count(int(table.attrs['inner_samples']))} samples.")
    if len(order) > len(rows):
        said.append(f"{len(order) - len(rows)} more design points are in sensitivity.nc.")
    found = [Table("targets", "Targets: probability by design point", ["Design point", *heads], rows, " ".join(said))]
    note = "Mean over the design points at each level."
    return [*found, Table("targets_levels", title, ["Level", *heads], levels, note)] if levels else found


def _cells(table: xr.Dataset, kind: str, place: int | None = None) -> list[str]:
    return [_cell(table.isel(target=t), kind, place) for t in range(table.sizes["target"])]
