"""State in sentences at which friction and drive each cheaper contact model is good enough."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
import xarray as xr

from trackroller.analysis.contact_models import (
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
from trackroller.analysis.groups import DRIVE, Groups, drives, groups
from trackroller.analysis.table import StudyView
from trackroller.report.numbers import listing, long_name, percent
from trackroller.report.tables.table import Table
from trackroller.report.words.levels import group_texts, span

FRICTION = "friction_coefficient"
NAMES = {"sliding": "The sliding model", "fastsim": "FASTSIM", "kalker_table": "The table of the exact theory"}
MOST = 0.9  # a level is good enough if this share of its cases is
FEWEST = 3  # smallest number of cases, rolling in both models, for a sentence


def overview(paired: xr.Dataset) -> str:
    """Say how the models were compared, or why they cannot be compared."""
    reference, number = paired.attrs["reference"], paired.sizes["design"]
    left = f" {paired.attrs['left']} cases have no partner and are left out." if paired.attrs["left"] else ""
    if not number:
        return (
            f"The contact models cannot be compared: no case was solved with {reference} and another model. "
            "A grid, an inner/outer array or a table has pairs of cases; a sample that draws the model has no pairs."
        )
    rolls = paired["regime"] == 0
    both = [(str(m), int((rolls.sel(contact_model=m) & rolls[-1]).sum())) for m in paired["contact_model"].values[:-1]]
    rolling = listing([f"{count} with {model}" for model, count in both])
    return (
        f"Each cheaper model is compared with {_exact(reference)} in {_cases(number)} that differ in nothing but the "
        f"model. Errors count where both models roll: {rolling}. A model is good enough at a level of a factor if 9 of "
        f"10 cases there err by {percent(GOOD)} or less. Brackets hold the smallest and the largest error.{left}"
    )


def short(paired: xr.Dataset) -> list[str]:
    """Say in one sentence a model which share of the cases is within 5 %."""
    if not paired.sizes["design"]:
        return [overview(paired)]
    deviations, said = errors(paired), []
    exact = paired["regime"].sel(contact_model=paired.attrs["reference"]).values
    for model in map(str, deviations["contact_model"].values):
        one = deviations.sel(contact_model=model)
        if compared(one) < FEWEST:
            rolls = f"{compared(one) or 'no'} case{'s' * (compared(one) != 1)} of {paired.sizes['design']}"
            said.append(f"{NAMES[model]}: cannot be compared with the reference, because both models roll in {rolls}.")
            continue
        parts = [
            f"{q.words.split(' (')[0]} in {percent(good_share(one[q.name].values))}"
            for q in measured(one)
            if q.name in ("normal_force", "friction_force", "friction_energy", "peak_stress", "life")
        ]
        shares = f"{', '.join(parts)} of {_cases(compared(one))}"
        own = paired["regime"].sel(contact_model=model).values
        unlike = int(((own >= 0) & (exact >= 0) & (own != exact)).sum())
        more = f" In {_cases(unlike)} the two are not in the same regime." if unlike else ""
        said.append(f"{NAMES[model]} is within {percent(GOOD)} of {deviations.attrs['reference']}: {shares}.{more}")
    return said


def details(paired: xr.Dataset) -> list[str]:
    """Say for each model and drive up to which friction each quantity is good enough."""
    view = designs(paired)
    if not paired.sizes["design"] or FRICTION not in view.factors:
        return []
    deviations, along = errors(paired), groups(view, FRICTION)
    said = []
    for model in map(str, deviations["contact_model"].values):
        one = deviations.sel(contact_model=model)
        for text, rows in by_drive(view) if compared(one) >= FEWEST else ():
            head = f"{NAMES[model]}{f', {text}' if text else ''}"
            said.append(_sentence(one.where(xr.DataArray(rows, dims="design")), along, head))
    return said


def by_drive(view: StudyView) -> list[tuple[str, np.ndarray]]:
    """Return each drive of a study in words with a mask of its cases; one empty text if the drive is no factor."""
    if DRIVE not in view.factors:
        return [("", np.ones(len(view.table), dtype=bool))]
    drive = drives(view)
    return [(text, drive.index == k) for k, text in enumerate(group_texts(drive))]


def report_section(view: StudyView) -> dict[str, Any]:
    """Return sentences and a table of errors for the report.

    The mapping is empty where there are no models to compare.
    """
    paired = pairs(view)
    if paired is None:
        return {}
    rows = []
    if paired.sizes["design"]:
        deviations = errors(paired)
        for model, q in product(map(str, deviations["contact_model"].values), measured(deviations)):
            e = known(deviations[q.name].sel(contact_model=model))
            if e.size:
                cells = [percent(v) for v in (good_share(e), *spread(e))]
                rows.append([f"{model}: {q.words}", *cells, str(e.size)])
    heads = ["Model, quantity", f"cases within {percent(GOOD)}", "median error", "90 % below", "largest", "cases"]
    table = Table("contact_models", "Errors of the cheaper models", heads, rows)
    said = [overview(paired), *details(paired)]
    return {"short": short(paired), "said": said, "tables": [table] if rows else []}


def _exact(reference: str) -> str:
    return {"kalker": "the exact theory (kalker)"}.get(reference, f"{reference}, the most exact model here,")


def _cases(number: int) -> str:
    return f"{number} case{'s' if number > 1 else ''}"


def _sentence(one: xr.Dataset, along: Groups, who: str) -> str:
    clauses: dict[str, list[str]] = {"good enough for": [], "not good enough for": []}
    for q in measured(one):
        where = levels_kept(along, one[q.name].values)
        clause = f"{q.words} {where} ({_range(known(one[q.name]))})".replace("  ", " ")
        clauses["good enough for" if where else "not good enough for"].append(clause)
    sentence = "; ".join(f"{head} {', '.join(listed)}" for head, listed in clauses.items() if listed)
    return f"{who}: {sentence or 'nothing to compare, because no case rolls'}."


def _range(e: np.ndarray) -> str:
    return f"{percent(float(e.min()))} to {percent(float(e.max()))}"


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
    for first, end in _runs(keeps):
        low, high = float(along.low[at[first]]), float(along.high[at[end]])
        if first == 0:
            said.append(f"up to {name} of {span(along.name, high, high)}")
        elif end == last:
            said.append(f"from {name} of {span(along.name, low, low)} on")
        else:
            said.append(f"at {name} of {span(along.name, low, high)}")
    return " and ".join(said)


def _runs(keeps: np.ndarray) -> list[tuple[int, int]]:
    """Return the first and last index of every run of True."""
    edge = np.flatnonzero(np.diff(np.concatenate([[False], keeps, [False]]).astype(int)))
    return [(int(a), int(b) - 1) for a, b in edge.reshape(-1, 2)]
