"""State in sentences at which friction and drive each cheaper contact model is good enough."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from trackroller.report.numbers import long_name, percent
from trackroller.report.tables.table import Table
from trackroller.report.words.levels import group_texts, span
from trackroller.report.words.sentence import phrase
from trackroller.results.contact_models import (
    GOOD,
    compared,
    designs,
    errors,
    good_share,
    known,
    measured,
    pairs,
    spread,
)
from trackroller.results.groups import DRIVE, Groups, drives, groups
from trackroller.results.results import Results

FRICTION = "friction_coefficient"
NAMES = {"sliding": "The sliding model", "kalker_table": "The table of the exact theory"}
MOST = 0.9  # a level is good enough if this share of its cases is
IN_SHORT = ("normal_force", "friction_force", "friction_energy", "peak_stress", "life")
FEWEST = 3  # smallest number of cases, rolling in both models, for a sentence


def _others(deviations: xr.Dataset) -> list[str]:
    """Return the cheaper models that did not solve their cases as the reference did."""
    return [str(m) for m in deviations["contact_model"].values if m not in deviations.attrs.get("same", ())]


def overview(paired: xr.Dataset) -> str:
    """Say how the models were compared, or why they cannot be compared."""
    reference, rolls = paired.attrs["reference"], paired["regime"] == 0
    same = list(paired.attrs.get("same", ()))
    cheaper = [m for m in map(str, paired["contact_model"].values[:-1]) if m not in same and paired.sizes["design"]]
    both = [(model, int((rolls.sel(contact_model=model) & rolls[-1]).sum())) for model in cheaper]
    values = {"reference": reference, "both": both, "left": paired.attrs["left"], "same": same}
    return phrase("comparison", "overview", **values, number=paired.sizes["design"], good=GOOD)


def short(paired: xr.Dataset) -> list[str]:
    """Say in one sentence a model which share of the cases is within 5 %."""
    if not paired.sizes["design"]:
        return [overview(paired)]
    deviations, said = errors(paired), []
    exact = paired["regime"].sel(contact_model=paired.attrs["reference"]).values
    for model in _others(deviations):
        one, own = deviations.sel(contact_model=model), paired["regime"].sel(contact_model=model).values
        shown = [q for q in measured(one) if q.name in IN_SHORT]
        values = {"name": NAMES[model], "rolling": compared(one), "few": compared(one) < FEWEST}
        values |= {"unlike": int(((own >= 0) & (exact >= 0) & (own != exact)).sum()), "number": paired.sizes["design"]}
        values["parts"] = [(q.words.split(" (")[0], good_share(one[q.name].values)) for q in shown]
        said.append(phrase("comparison", "short", **values, reference=deviations.attrs["reference"], good=GOOD))
    return said


def details(paired: xr.Dataset) -> list[str]:
    """Say for each model and drive up to which friction each quantity is good enough."""
    table = designs(paired)
    if not paired.sizes["design"] or FRICTION not in table:
        return []
    deviations, along = errors(paired), groups(table, FRICTION)
    said = []
    for model in _others(deviations):
        one = deviations.sel(contact_model=model)
        for text, rows in by_drive(table) if compared(one) >= FEWEST else ():
            head = f"{NAMES[model]}{f', {text}' if text else ''}"
            said.append(_sentence(one.where(xr.DataArray(rows, dims="design")), along, head))
    return said


def by_drive(table: pd.DataFrame) -> list[tuple[str, np.ndarray]]:
    """Return each drive of a table of factors in words with a mask of its rows; an empty text if it has no drive."""
    if DRIVE not in table:
        return [("", np.ones(len(table), dtype=bool))]
    drive = drives(table)
    return [(text, drive.index == k) for k, text in enumerate(group_texts(drive))]


def report_section(results: Results) -> dict[str, Any]:
    """Return sentences and a table of errors for the report.

    The mapping is empty where there are no models to compare.
    """
    paired = pairs(results)
    if paired is None:
        return {}
    tables = [_table(paired)] if paired.sizes["design"] else []
    return {"short": short(paired), "said": [overview(paired), *details(paired)], "tables": tables}


def _table(paired: xr.Dataset) -> Table | None:
    deviations, rows = errors(paired), []
    for model, q in product(_others(deviations), measured(deviations)):
        e = known(deviations[q.name].sel(contact_model=model))
        if e.size:
            row = {"Model, quantity": f"{model}: {q.words}", f"cases within {percent(GOOD)}": percent(good_share(e))}
            row |= zip(("median error", "90 % below", "largest"), map(percent, spread(e)), strict=True)
            rows.append(row | {"cases": str(e.size)})
    return Table.of("contact_models", "Errors of the cheaper models", rows)


def _sentence(one: xr.Dataset, along: Groups, who: str) -> str:
    clauses: dict[str, list[str]] = {"good enough for": [], "not good enough for": []}
    for q in measured(one):
        where = levels_kept(along, one[q.name].values)
        error = known(one[q.name])
        clause = f"{q.words} {where} ({percent(error.min())} to {percent(error.max())})".replace("  ", " ")
        clauses["good enough for" if where else "not good enough for"].append(clause)
    sentence = "; ".join(f"{head} {', '.join(listed)}" for head, listed in clauses.items() if listed)
    return f"{who}: {sentence or 'nothing to compare, because no case rolls'}."


def levels_kept(along: Groups, e: np.ndarray) -> str:
    """Name the levels at which nine of ten cases keep the tolerance.

    The text is empty if there is no such level.

    Parameters
    ----------
    along : groups of the cases
    e : error of every case [1], shape (n,), NaN where the case has no error
    """
    shares = np.array([good_share(e[along.index == k]) for k in range(len(along))])
    at = np.flatnonzero(~np.isnan(shares))
    keeps = shares[at] >= MOST
    if not keeps.any():
        return ""
    name = "friction" if along.name == FRICTION else long_name(along.name)
    if keeps.all():
        return f"at every {name}"
    if not along.ordered:
        return f"with {name} " + " or ".join(group_texts(along)[k] for k in at[keeps])
    said, last = [], len(at) - 1
    name = f"{'an' if name[0] in 'aeiou' else 'a'} {name}"
    runs = np.split(np.arange(len(at)), np.flatnonzero(np.diff(keeps)) + 1)
    for first, end in ((run[0], run[-1]) for run in runs if keeps[run[0]]):
        low, high = float(along.low[at[first]]), float(along.high[at[end]])
        if first == 0:
            said.append(f"up to {name} of {span(along.name, high, high)}")
        elif end == last:
            said.append(f"from {name} of {span(along.name, low, low)} on")
        else:
            said.append(f"at {name} of {span(along.name, low, high)}")
    return " and ".join(said)
