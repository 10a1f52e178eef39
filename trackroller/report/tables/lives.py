"""The lives of one solved roller in hours, kilometres and overrollings: roller, guide, and both as a pair."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from trackroller.damage.limit import roller_overrollings
from trackroller.damage.sn_curve import PROBABILITIES, SNCurve
from trackroller.fit.stored import StoredFit, fits_of_case
from trackroller.materials import Material
from trackroller.parameters import BODIES, FIRST_TO_FAIL
from trackroller.report.numbers import BEYOND, hour_unit, lasting, number, rounded
from trackroller.report.tables.inputs import Row
from trackroller.report.words.by_tests import worst
from trackroller.results.lives import past_data
from trackroller.roller.geometry import rolling_radius

MOST = 1e15  # above which the high end of an interval is no number
UNKNOWN = {"guide": "not known: give guide_overrollings_per_hour", "roller": "not defined in this regime"}


def overrollings(inputs: Mapping[str, Any], body: str) -> float:
    """Return the overrollings of a point of a body [1/h]; NaN if the overrollings of the guide are not given."""
    if body == "guide":
        rate = inputs.get("guide_overrollings_per_hour")
        return math.nan if rate is None else float(rate)
    alpha = math.radians(inputs["contact_angle"])
    radius = rolling_radius(inputs["axis_distance"], inputs["guide_profile_radius"], alpha)
    return float(roller_overrollings(inputs["velocity"], radius))


def life_rows(
    ds: xr.Dataset, inputs: Mapping[str, Any], materials: Mapping[str, Material], lifeless: Mapping[str, str]
) -> list[Row]:
    """Return the overrollings an hour, the life of each body, and the life of the pair.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of one case with the output `life`; other results have no rows.
    inputs : mapping
        Inputs of the case by name.
    materials : mapping of str to Material
        Material of each body. A body whose material has scatter has lives at 10, 50 and 90 % failure probability.
    lifeless : mapping of str to str
        Why a body has no fatigue life; an empty text if it has one.
    """
    if "pair_life_hours" not in ds:
        return []
    rows, (tested, _) = [], fits_of_case(ds)
    for body in BODIES:
        rate = overrollings(inputs, body)
        if math.isfinite(rate):
            rows.append(Row(f"{body}, overrollings of a point", number(rate), "1/h"))
    for body in BODIES:
        rows += _of_body(ds, body, inputs, materials[body], lifeless[body])
        if body in tested and not lifeless[body]:
            rows += _by_tests(ds, body, inputs, tested[body])
    return [*rows, _of_pair(ds, inputs, lifeless, materials)]


def _of_body(ds: xr.Dataset, body: str, inputs: Mapping[str, Any], material: Material, lifeless: str) -> list[Row]:
    if lifeless:
        return [Row(f"{body}, no fatigue life", lifeless)]
    if math.isnan(float(ds[f"{body}_life_hours"])):
        return [Row(f"{body}, median life", UNKNOWN[body])]
    curve, stress = SNCurve.of(material, str(ds.attrs["life_rule"])), ds.get("fatigue_stress", ds.get("peak_stress"))
    scatters = bool(curve.scatters)
    if not scatters or stress is None:
        cycles = float(ds["life_cycles"].sel(body=body).min())
        remark = " (its material has no scatter T_N)" * (not scatters)
        return [Row(f"{body}, median life{remark}", _life(cycles, body, inputs, material))]
    lives = [curve.changed(failure_probability=p).life_cycles(stress.sel(body=body).values) for p in PROBABILITIES]
    return [
        Row(f"{body}, until {100 * p:.0f} % have failed", _life(float(np.min(cycles)), body, inputs, material))
        for p, cycles in zip(PROBABILITIES, lives, strict=True)
    ]


def _by_tests(ds: xr.Dataset, body: str, inputs: Mapping[str, Any], fit: StoredFit) -> list[Row]:
    """Return the 90 % intervals of the lives of a body by the tests of its material."""
    stress, cycles = worst(ds, body, fit)
    if not (stress > 0 and math.isfinite(cycles)):
        return []
    rate = overrollings(inputs, body)
    scale, unit = (1.0, "overrollings") if math.isnan(rate) else (rate, "h")
    remark = f" ({BEYOND})" if fit.extrapolates(stress, cycles) else ""
    rows = []
    for probability in (0.1, 0.5):
        low, high = (end / scale for end in fit.cycles(stress, probability))
        upper = f"to {rounded(high, 2)} {unit}" if high < MOST else f"{unit} or more"
        words = f"{body}, 90 % by the {fit.rows} tests of {fit.name}, until {100 * probability:.0f} % have failed"
        rows.append(Row(words, f"{rounded(low, 2)} {upper}{remark}" if low < MOST else lasting(math.inf)))
    return rows


def _life(cycles: float, body: str, inputs: Mapping[str, Any], material: Material) -> str:
    """Write a life in cycles as hours, kilometres of travel and overrollings."""
    hours = cycles / overrollings(inputs, body)
    beyond = bool(past_data(cycles, material.cycles_at_fatigue_limit))
    return _text(hours, inputs, beyond, f"{rounded(cycles)} {'turns' if body == 'roller' else 'overrollings'}")


def _text(hours: float, inputs: Mapping[str, Any], beyond: bool, further: str = "") -> str:
    if math.isinf(hours):
        return lasting(hours)
    way = hours * inputs["velocity"] * 60.0 / 1e3
    lengths = [f"{rounded(hours)} {hour_unit(hours)}", f"{rounded(way)} km", *([further] if further else [])]
    return "; ".join(lengths) + f" ({BEYOND})" * beyond


def _of_pair(
    ds: xr.Dataset, inputs: Mapping[str, Any], lifeless: Mapping[str, str], materials: Mapping[str, Material]
) -> Row:
    """Return the life of the pair, which ends with its first body."""
    hours, first = float(ds["pair_life_hours"]), FIRST_TO_FAIL[int(ds["first_to_fail"])]
    if any(lifeless.values()):
        return Row("pair, no fatigue life", next(filter(None, lifeless.values())))
    if math.isnan(hours):
        return Row("pair, median life", UNKNOWN["roller"])
    body = "guide" if first == "guide" else "roller"
    cycles = float(ds["life_cycles"].sel(body=body).min())
    life = _text(hours, inputs, bool(past_data(cycles, materials[body].cycles_at_fatigue_limit)))
    if first == "unknown":
        return Row("pair, median life of the roller alone (the guide's hours are unknown)", life)
    return Row("pair, median life by fatigue" + (f" (the {first} fails first)" if first != "none" else ""), life)
