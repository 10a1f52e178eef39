"""Sentences on a roller that wears: why the travel ends, depth, pressure and fatigue."""

from __future__ import annotations

import numpy as np
import xarray as xr

from trackroller.parameters import BODIES
from trackroller.report.numbers import rounded
from trackroller.report.words.sentence import Sentence
from trackroller.roller.wearing import ENDS


def deeper_contact(ds: xr.Dataset) -> int:
    """Return the contact whose profiles have lost more depth at the end; contact 1 if both are alike."""
    depth = ds["groove_depth"].isel(travel=-1).sum("body")
    return int(ds["contact"].values[int(np.argmax(depth.values > 0.999 * depth.values.max()))])


def run_in(ds: xr.Dataset) -> str:
    """Return how fast the groove of a new roller wears, in one sentence; an empty text if wear was not computed."""
    if "run_in_distance" not in ds or not np.isfinite(float(ds["run_in_distance"])):
        return ""
    rates = ds["wear_depth_per_km"]
    first = rates.max("contact")
    depths = {body: 1e3 * float(first.sel(body=body)) for body in BODIES}
    lost = [f"the {body} loses {rounded(depth)} µm" for body, depth in depths.items() if depth > 0.0]
    return (
        f"At first {' and '.join(lost)} a km; after {rounded(float(ds['run_in_distance']))} km (run-in "
        "distance) the profiles have changed as much as their gap at the edge of the patch."
    )


def sentences(ds: xr.Dataset) -> list[Sentence]:
    """Return what a user asks first: how far, how deep, how pressure and patch change, and the life with wear."""
    return [_end(ds), _pressure(ds), *(s for body in BODIES if (s := _life(ds, body)) is not None)]


def _end(ds: xr.Dataset) -> Sentence:
    end, travel = str(ds.attrs["end"]), float(ds["travel"][-1])
    depths = {b: 1e3 * float(ds["groove_depth"].sel(body=b).isel(travel=-1).max()) for b in BODIES}
    lost = [f"the {body} has lost {rounded(depth)} µm" for body, depth in depths.items() if depth > 0.0]
    why = ENDS.get(end, "it is not finished")
    text = f"After {rounded(travel)} km {' and '.join(lost) or 'neither body has worn'}. The run ends there: {why}."
    return Sentence("wear_end", text, {"end": end, "travel": travel} | depths)


def _pressure(ds: xr.Dataset) -> Sentence:
    own = ds.sel(contact=deeper_contact(ds))
    pressure, wide = own["max_pressure"].values, own["semi_axis_lateral"].values
    most, travel = int(np.argmax(pressure)), own["travel"].values
    between = f", {rounded(pressure[most])} MPa at {rounded(travel[most])} km" if 0 < most < len(travel) - 1 else ""
    wider = rounded(wide[-1] / wide[0])
    grown = "" if wider == "1" else f"{wider} times "
    text = (
        f"The largest pressure of contact {int(own['contact'])} is {rounded(pressure[0])} MPa at first{between} and "
        f"{rounded(pressure[-1])} MPa at the end, where the patch is {grown}as wide as at first."
    )
    error = float(own["pressure_error"].max())
    text += f" Its estimated error is {rounded(100 * error, 2)} % at most."
    values = {"first": pressure[0], "largest": pressure[most], "last": pressure[-1], "error": error}
    return Sentence("wear_pressure", text, values)


def _life(ds: xr.Dataset, body: str) -> Sentence | None:
    """Return the fatigue life of a body that counts wear; None if no life was computed or it is not known."""
    if "fatigue_damage" not in ds:
        return None
    own = ds.sel(body=body)
    damage, new = own["fatigue_damage"].isel(travel=-1).values, float(own["life_travel_new"].min())
    if np.isnan(damage).any() or np.isnan(new):
        return None
    life = float(own["life_travel"].min()) if own["life_travel"].notnull().any() else np.nan
    error = float(own["fatigue_damage_error"].isel(travel=-1).max())
    values = {"body": body, "life": life, "new": new, "error": error}
    under = f"under the stress of the new groove after {rounded(new)} km"
    if np.isfinite(life):
        text = f"Fatigue of the {body}: the damage sum reaches 1 after {rounded(life)} km, {under}."
    else:
        text = f"Fatigue of the {body}: the damage sum is {rounded(float(damage.max()))} at the end; it is 1 {under}."
    text += f" The estimated error of the damage sum is {rounded(100 * error, 2)} %."
    return Sentence("wear_life", text, values)
