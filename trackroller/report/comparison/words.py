"""State where each cheaper contact model is good enough, over friction and drive, in sentences from the results."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
import xarray as xr

from trackroller.report.comparison.errors import GOOD, errors, measured
from trackroller.report.comparison.groups import (
    DRIVE,
    FRICTION,
    Groups,
    drives,
    factors,
    groups,
    name_of,
    span,
)
from trackroller.report.comparison.pairs import pairs
from trackroller.report.numbers import capital, percent
from trackroller.report.tables import Table

NAMES = {"sliding": "The sliding model", "fastsim": "FASTSIM"}
MOST = 0.9  # share of the designs of a level that counts as the level
FLAT = 0.1  # a factor whose levels differ less in the share of good designs is not worth a sentence
FEWEST = 3  # designs that roll in both models; of fewer nothing is said


def sentences(paired: xr.Dataset, tolerance: float = GOOD) -> list[str]:
    """Return all sentences on the comparison of the contact models.

    Parameters
    ----------
    paired : dataset of `trackroller.report.comparison.pairs`
    tolerance : error [1] up to which a model is good enough
    """
    if not paired.sizes["design"]:
        return [overview(paired, tolerance)]
    return [overview(paired, tolerance), *short(paired, tolerance), *details(paired, tolerance)]


def overview(paired: xr.Dataset, tolerance: float = GOOD) -> str:
    """Say how the models were compared, or why they cannot be compared."""
    reference, number = paired.attrs["reference"], paired.sizes["design"]
    left = f" {paired.attrs['left']} cases have no partner and are left out." if paired.attrs["left"] else ""
    if not number:
        return (
            f"The contact models cannot be compared: no design was solved with {reference} and another model. "
            "A grid, an inner/outer array or a table has such pairs; a sample that draws the model has none."
        )
    return (
        f"Errors are taken against {_exact(reference)} where both models roll, in {_designs(number)} that differ "
        f"in nothing but the model; good enough means within {percent(tolerance)}, at a level "
        f"of a factor in 9 of 10 designs; in brackets the errors.{left}"
    )


def short(paired: xr.Dataset, tolerance: float = GOOD) -> list[str]:
    """Say in one sentence a model which share of the designs is within the tolerance."""
    if not paired.sizes["design"]:
        return [overview(paired, tolerance)]
    found, said = errors(paired), []
    exact = paired["regime"].sel(contact_model=paired.attrs["reference"]).values
    for model in map(str, found["contact_model"].values):
        one = found.sel(contact_model=model)
        if _compared(one) < FEWEST:
            rolls = f"{_compared(one) or 'none'} of {_designs(paired.sizes['design'])} rolls"
            said.append(f"{NAMES[model]}: too little to compare, for {rolls}.")
            continue
        parts = [
            f"{q.words.split(' (')[0]} in {percent(_share(one[q.name].values, tolerance))}"
            for q in measured(one)
            if q.name in ("normal_force", "friction_force", "friction_energy", "peak_stress", "life")
        ]
        told = f"{', '.join(parts)} of {_designs(_compared(one))}"
        own = paired["regime"].sel(contact_model=model).values
        unlike = int(((own >= 0) & (exact >= 0) & (own != exact)).sum())
        more = f" In {_designs(unlike)} the two are not in the same regime." if unlike else ""
        said.append(f"{NAMES[model]} is within {percent(tolerance)} of {found.attrs['reference']}: {told}.{more}")
    return said


def details(paired: xr.Dataset, tolerance: float = GOOD) -> list[str]:
    """Return the sentences by friction and drive: up to which friction each quantity is good enough."""
    if not paired.sizes["design"]:
        return []
    found, said = errors(paired), []
    for model in map(str, found["contact_model"].values):
        one = found.sel(contact_model=model)
        if _compared(one) < FEWEST:
            continue
        said += _by_drive(one, model, tolerance)
    return said


def report_section(ds: xr.Dataset) -> dict[str, Any]:
    """Return sentences and a table of errors for the report.

    The mapping is empty where there are no models to compare.
    """
    paired = pairs(ds)
    if paired is None:
        return {}
    rows = []
    if paired.sizes["design"]:
        found = errors(paired)
        for model, q in product(map(str, found["contact_model"].values), measured(found)):
            e = _rolling(found[q.name].sel(contact_model=model))
            if e.size:
                cells = [percent(v) for v in (float(np.mean(e <= GOOD)), *_spread(e))]
                rows.append([f"{model}: {q.words}", *cells, str(e.size)])
    heads = ["Model, quantity", f"designs within {percent(GOOD)}", "median error", "90 % below", "largest", "designs"]
    table = Table("contact_models", "Errors of the cheaper models", heads, rows)
    return {
        "short": short(paired),
        "said": [overview(paired), *details(paired)],
        "tables": [table] if rows else [],
    }


def _exact(reference: str) -> str:
    return {"kalker": "the exact theory (kalker)"}.get(reference, f"{reference}, the most exact model here,")


def _designs(number: int) -> str:
    return f"{number} design{'s' if number > 1 else ''}"


def _rolling(error: xr.DataArray) -> np.ndarray:
    return np.asarray(error.values[~np.isnan(error.values)])


def _compared(one: xr.Dataset) -> int:
    return max((int(one[q.name].notnull().sum()) for q in measured(one)), default=0)


def _spread(e: np.ndarray) -> tuple[float, float, float]:
    """Median, what nine in ten stay below, and the largest; each is an error that was found."""
    return tuple(float(np.percentile(e, p, method="nearest")) for p in (50, 90, 100))  # type: ignore[return-value]


def _by_drive(one: xr.Dataset, model: str, tolerance: float) -> list[str]:
    """A sentence a drive: up to which friction each quantity is good enough."""
    if FRICTION not in factors(one):
        return []
    drive, said = drives(one), []
    for k, text in enumerate(drive.texts):
        way = f", {text}" if DRIVE in factors(one) else ""
        said.append(_sentence(one.isel(design=np.flatnonzero(drive.index == k)), f"{NAMES[model]}{way}", tolerance))
    return said


def _sentence(one: xr.Dataset, who: str, tolerance: float) -> str:
    clauses: dict[str, list[str]] = {"good": [], "bad": []}
    along = groups(one, FRICTION)
    for q in measured(one):
        e = one[q.name].values
        if not _rolling(one[q.name]).size:
            continue
        where = levels_kept(along, e, tolerance)
        clauses["good" if where else "bad"].append(f"{q.words} {where} ({_range(e)})".replace("  ", " "))
    good = f"good enough for {', '.join(clauses['good'])}" if clauses["good"] else ""
    bad = f"not good enough for {', '.join(clauses['bad'])}" if clauses["bad"] else ""
    if not good and not bad:
        return f"{who}: nothing to compare, for no case rolls."
    return f"{who}: {'; '.join(c for c in (good, bad) if c)}."


def _range(e: np.ndarray) -> str:
    return f"{percent(float(np.nanmin(e)))} to {percent(float(np.nanmax(e)))}"


def levels_kept(along: Groups, e: np.ndarray, tolerance: float = GOOD) -> str:
    """Name the levels at which nine of ten designs keep the tolerance.

    The text is empty if there is no such level.

    Parameters
    ----------
    along : groups of the designs
    e : error of every design [1], shape (n,), NaN where none is
    """
    known = np.array(
        [np.isfinite(e[along.index == k]).any() or np.isposinf(e[along.index == k]).any() for k in range(len(along))]
    )
    at = np.flatnonzero(known)
    keeps = np.array([np.mean(e[(along.index == k) & ~np.isnan(e)] <= tolerance) >= MOST for k in at])
    if not keeps.any():
        return ""
    name = name_of(along.name)
    if keeps.all():
        return f"at every {name}"
    if not along.ordered:
        return f"with {name} " + " or ".join(along.texts[k] for k, kept in zip(at, keeps, strict=True) if kept)
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
    """First and last index of every run of True."""
    edge = np.flatnonzero(np.diff(np.concatenate([[False], keeps, [False]]).astype(int)))
    return [(int(a), int(b) - 1) for a, b in edge.reshape(-1, 2)]


def _main(one: xr.Dataset) -> list[Any]:
    """Return the quantities whose error is drawn over other factors: forces and stress."""
    return [q for q in measured(one) if q.name in ("normal_force", "friction_force", "peak_stress")]


def telling_factors(one: xr.Dataset, tolerance: float = GOOD) -> list[str]:
    """Name the factors over whose levels the share of good designs changes, most of all first."""
    varied, found = factors(one), []
    names = [n for n in varied if n not in (FRICTION, DRIVE) and n in one.coords]
    names += ["lean"] if {FRICTION, "contact_angle"} <= set(varied) else []
    for name in names:
        along = groups(one, name)
        shares = [_shares_along(one[q.name].values, along, tolerance) for q in _main(one)]
        changes = [float(np.nanmax(s) - np.nanmin(s)) for s in shares if np.isfinite(s).any()]
        if changes and max(changes) > FLAT:
            found.append((max(changes), name))
    return [name for _, name in sorted(found, key=lambda pair: -pair[0])]


def _shares_along(e: np.ndarray, along: Groups, tolerance: float) -> np.ndarray:
    """Share of good designs in every group, NaN where none rolls."""
    return np.array([_share(e[along.index == k], tolerance) for k in range(len(along))])


def _share(e: np.ndarray, tolerance: float) -> float:
    """Share of good designs among those that roll, NaN if none does."""
    e = e[~np.isnan(e)]
    return float(np.mean(e <= tolerance)) if e.size else np.nan


def gap(found: xr.Dataset, name: str) -> str:
    """Say how far each cheaper model is off in one quantity; '' if that is not known."""
    said = []
    for model in map(str, found["contact_model"].values):
        e = _rolling(found[name].sel(contact_model=model)) if name in found else np.empty(0)
        if e.size:
            middle, _, most = _spread(e)
            said.append(f"{model} is off by {percent(middle)} in the median and {percent(most)} at most")
    words = next((q.words.split(" (")[0] for q in measured(found) if q.name == name), name)
    return f"{capital(words)}: {', '.join(said)}." if said else ""
