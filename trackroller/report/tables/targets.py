"""Tables of targets: how probable it is that a case meets each of them, and which designs always do."""

from __future__ import annotations

import numpy as np
import xarray as xr

from trackroller.analysis.designs import Designs
from trackroller.analysis.table import StudyView
from trackroller.report.numbers import capital, count
from trackroller.report.tables.table import Table
from trackroller.report.words.targets import (
    WHOLE,
    _cell,
    _level_words,
    point_words,
    samples_of_points,
    target,
    target_words,
)
from trackroller.study.design.levels import in_words

MAX_POINTS = 24  # rows of the table of design points


def target_tables(table: xr.Dataset, view: StudyView) -> list[Table]:
    """List the probability of each target at each design point (or in all cases), and at each level of a factor.

    Where designs repeat over conditions, a column counts the designs that meet all targets in all their conditions.
    """
    if "target_probability" not in table:
        return []
    targets = range(table.sizes["target"])
    sure = "share of the cases" if WHOLE.get(str(table.attrs.get("method"))) else "95 % interval"
    heads = [f"{capital(target_words(table, t))} ({sure})" for t in targets]
    said = [target(table, t).text for t in targets]
    said.append("A case that is not valid, or has no value, misses every target.")
    if float(table.attrs.get("log_life_scatter", 0.0)) > 0:
        said.append("Lives hold the material's own scatter.")
    places = range(table.sizes.get("target_level", 0))
    levels = [[capital(_level_words(table, i)), *_cells(table, "level", i)] for i in places]
    title = "Targets by level of a factor"
    if table["target_probability"].ndim == 1:
        rows = [["All cases", *_cells(table, "target")], *levels]
        if met := _designs_that_meet(table, view):
            heads.insert(0, "Designs that meet all in all conditions")
            rows = [[row[0], count_of, *row[1:]] for row, count_of in zip(rows, met, strict=True)]
        return [Table("targets", title, ["Level", *heads], rows, " ".join(said))]
    order = np.argsort(-table["target_probability"].values[-1], kind="stable")
    rows = [[capital(point_words(table, int(p))), *_cells(table, "target", int(p))] for p in order[:MAX_POINTS]]
    said.append(samples_of_points(table))
    if len(order) > len(rows):
        said.append(f"{len(order) - len(rows)} more design points are in sensitivity.nc.")
    tables = [Table("targets", "Targets: probability by design point", ["Design point", *heads], rows, " ".join(said))]
    note = "Mean over the design points at each level."
    return [*tables, Table("targets_levels", title, ["Level", *heads], levels, note)] if levels else tables


def _cells(table: xr.Dataset, kind: str, place: int | None = None) -> list[str]:
    return [_cell(table.isel(target=t), kind, place) for t in range(table.sizes["target"])]


def _designs_that_meet(table: xr.Dataset, view: StudyView) -> list[str]:
    """Write how many designs meet all targets in all their conditions: of all designs, then at each level of a choice.

    A level of a condition has a dash. The list is empty where designs do not repeat over conditions.
    """
    designs = Designs.of(view)
    if designs is None or not (designs.comparable and designs.conditions and designs.choices):
        return []
    met = designs.targets_met()
    if met is None:
        return []
    every, chosen = met == designs.size, [np.ones(len(met), dtype=bool)]
    choices = designs.table.sort_index()
    for i in range(table.sizes.get("target_level", 0)):
        name, text = str(table["level_factor"][i].item()), str(table["level_text"][i].item())
        own = choices[name] if name in choices else None
        low, high = float(table["level_low"][i]), float(table["level_high"][i])
        at = (
            np.zeros(len(met), dtype=bool)
            if own is None
            else [in_words(name, v) == text for v in own]
            if text
            else own.between(low, high)
        )
        chosen.append(np.asarray(at))
    return [f"{count(int(every[at].sum()))} of {count(int(at.sum()))}" if at.any() else "–" for at in chosen]
