"""The lives of one solved roller by fatigue: of roller, guide and pair, in hours, kilometres and
overrollings.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from trackroller.damage.sn_curve import PROBABILITIES, SNCurve
from trackroller.damage.wear import KM_PER_HOUR
from trackroller.fit.stored import StoredFit, fits_of_case
from trackroller.materials import Material
from trackroller.parameters import BODIES, FIRST_TO_FAIL, REGIMES
from trackroller.results.answer import Column, FurtherTable, yes_or_blank
from trackroller.results.life_columns import past_data
from trackroller.results.margins import BROKEN, SKIDS, overrollings, worst_contact

TESTED = (0.1, 0.5)  # failure probabilities at which the interval of tests is stated
MEDIAN = 0.5
WHY = {
    "": "",
    BROKEN: "no life: the peak stress exceeds the tensile strength",
    SKIDS: "no fatigue life: friction heat and wear decide",
    "unknown guide": "not known: give guide_overrollings_per_hour",
    "unknown roller": "not defined in this regime",
}
ENDS_PAIR = {  # what ends the pair, by FIRST_TO_FAIL
    "roller": "the roller fails first",
    "guide": "the guide fails first",
    "none": "",
    "unknown": "of the roller alone: the hours of the guide are not known",
}
COLUMNS = (
    Column(
        "body",
        "Body",
        "",
        "body that the life is of; the pair ends with its first body",
        "text",
        role="name",
    ),
    Column("probability", "Failed by then", "1", "share of like rollers that have failed", "share"),
    Column("low", "Life", "h", "life by fatigue, or the 90 % interval of tests", until="high"),
    Column("km_low", "Travel", "km", "the same life as travel", until="km_high"),
    Column(
        "cycles_low",
        "Overrollings",
        "1",
        "the same life as overrollings of a point of the body",
        until="cycles_high",
    ),
    Column("rate", "Overrollings an hour", "1/h", "overrollings of a point of the body"),
    Column("contact", "Contact", "", "contact whose track decides", "count"),
    Column("basis", "By", "", "what the life follows from", "text"),
    Column("extrapolated", "Extrapolated", "", "whether the life lies beyond the data", "text"),
    Column("why", "Remark", "", "why a life is not known", "text"),
)


def lives_part(
    ds: xr.Dataset,
    inputs: Mapping[str, Any],
    materials: Mapping[str, Material],
    lifeless: Mapping[str, str],
) -> FurtherTable | None:
    """Return the lives of a solved roller by fatigue; None for a result without lives.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of one case.
    inputs : mapping
        Inputs of the case by name.
    materials : mapping of str to Material
        Material of each body. A body whose material has scatter has lives at 10, 50 and 90 %
        failure probability.
    lifeless : mapping of str to str
        Why a body has no fatigue life, see `trackroller.results.margins.lifeless_bodies`.
    """
    if "pair_life_hours" not in ds:
        return None
    tested, _ = fits_of_case(ds)
    rows = []
    for body in BODIES:
        rows += list(_of_body(ds, body, inputs, materials[body], lifeless[body]))
        if body in tested and not lifeless[body]:
            rows += list(_by_tests(ds, body, inputs, tested[body]))
    rows.append(_of_pair(ds, inputs, lifeless, materials))
    table = pd.DataFrame(
        rows, columns=[name for column in COLUMNS for name in (column.name, column.until) if name]
    )
    note = "Without scatter of its material a body has a median life alone."
    return FurtherTable("lives", "Life by fatigue", table, COLUMNS, note)


def _row(
    body: str, inputs: Mapping[str, Any], low: float, high: float, **others: Any
) -> dict[str, Any]:
    """Return a life between two ends [h] with its travel and overrollings."""
    rate = overrollings(inputs, body)
    way = KM_PER_HOUR * float(inputs["velocity"])
    row: dict[str, Any] = {
        "body": body,
        "low": low,
        "high": high,
        "km_low": low * way,
        "km_high": high * way,
    }
    row |= {"cycles_low": low * rate, "cycles_high": high * rate, "rate": rate, "contact": math.nan}
    return row | {"basis": "", "extrapolated": "", "why": ""} | others


def _of_body(
    ds: xr.Dataset, body: str, inputs: Mapping[str, Any], material: Material, lifeless: str
) -> Iterator[dict[str, Any]]:
    """Yield the lives of a body by its S-N line."""
    unknown = math.isnan(float(ds[f"{body}_life_hours"]))
    rolls = int(ds["regime"]) == REGIMES.index("rolling")
    cause = "unknown roller"
    if rolls:
        cause = f"unknown {body}"
    why = WHY[lifeless or (cause if unknown else "")]
    if why:
        yield _row(body, inputs, math.nan, math.nan, probability=MEDIAN, why=why)
        return
    curve = SNCurve.of(material, str(ds.attrs["life_rule"]))
    stress = ds.get("fatigue_stress", ds.get("peak_stress"))
    by_contact = ds["life_cycles"].sel(body=body)
    contact = float(by_contact.idxmin("contact"))  # NaN where the contacts have no lives
    lives = {MEDIAN: float(by_contact.min())}
    if curve.scatters and stress is not None:
        own = stress.sel(body=body).values
        lives = {
            p: float(np.min(curve.changed(failure_probability=p).life_cycles(own)))
            for p in PROBABILITIES
        }
    basis = "S-N line without scatter"
    if curve.scatters:
        basis = "S-N line"
    for probability, cycles in lives.items():
        hours = cycles / overrollings(inputs, body)
        beyond = yes_or_blank(bool(past_data(cycles, material.cycles_at_fatigue_limit)))
        row = {
            "probability": probability,
            "contact": contact,
            "basis": basis,
            "extrapolated": beyond,
        }
        yield _row(body, inputs, hours, hours, **row)


def _by_tests(
    ds: xr.Dataset, body: str, inputs: Mapping[str, Any], fit: StoredFit
) -> Iterator[dict[str, Any]]:
    """Yield the 90 % intervals of the lives of a body by the tests of its material."""
    stress, cycles = worst_contact(ds, body, fit)
    if not (stress > 0 and math.isfinite(cycles)):
        return
    rate = overrollings(inputs, body)
    beyond = yes_or_blank(bool(fit.extrapolates(stress, cycles)))
    basis = f"90 % by the {fit.rows} tests of {fit.name}"
    for probability in TESTED:
        low, high = fit.cycles(stress, probability)
        entry = {"probability": probability, "basis": basis, "extrapolated": beyond}
        row = _row(body, inputs, low / rate, high / rate, **entry)
        # known without the overrollings of the guide
        yield row | {"cycles_low": low, "cycles_high": high}


def _of_pair(
    ds: xr.Dataset,
    inputs: Mapping[str, Any],
    lifeless: Mapping[str, str],
    materials: Mapping[str, Material],
) -> dict[str, Any]:
    """Return the median life of the pair, which ends with its first body."""
    hours = float(ds["pair_life_hours"])
    first = FIRST_TO_FAIL[int(ds["first_to_fail"])]
    why = next(filter(None, lifeless.values()), "")
    if not why and math.isnan(hours):
        why = "unknown roller"
    body = "roller"
    if first == "guide":
        body = "guide"
    row = {
        "body": "pair",
        "probability": MEDIAN,
        "cycles_low": math.nan,
        "cycles_high": math.nan,
        "rate": math.nan,
    }
    if why:
        return _row(body, inputs, math.nan, math.nan) | row | {"why": WHY[why]}
    cycles = float(ds["life_cycles"].sel(body=body).min())
    beyond = yes_or_blank(bool(past_data(cycles, materials[body].cycles_at_fatigue_limit)))
    ending = ENDS_PAIR[first]
    return (
        _row(body, inputs, hours, hours)
        | row
        | {"basis": "S-N line", "extrapolated": beyond, "why": ending}
    )
