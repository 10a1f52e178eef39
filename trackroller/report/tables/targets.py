"""Tables of targets: how probable it is that a design meets each of them."""

from __future__ import annotations

import numpy as np
import xarray as xr

from trackroller.report.numbers import capital, count
from trackroller.report.tables.table import Table
from trackroller.report.words.design_points import point_words
from trackroller.report.words.targets import _cell, _level_words, target, target_words

MAX_POINTS = 24  # rows of the table of design points


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
