"""Sentences on a roller that wears: why the travel ends, depth, pressure and fatigue."""

from __future__ import annotations

import numpy as np
import xarray as xr

from trackroller.damage.wear import KM_PER_HOUR
from trackroller.parameters import BODIES
from trackroller.report.numbers import lasting, quantity, rounded
from trackroller.report.words.sentence import Sentence, phrase, say
from trackroller.roller.limit_notes import placeholders_of
from trackroller.roller.stored_inputs import inputs_of
from trackroller.roller.wearing import ENDS


def deeper_contact(ds: xr.Dataset) -> int:
    """Return the contact whose profiles have lost more depth at the end; contact 1 if both are alike."""
    depth = ds["groove_depth"].isel(travel=-1).sum("body")
    return int(ds["contact"].values[int(np.argmax(depth.values > 0.999 * depth.values.max()))])


def run_in(ds: xr.Dataset) -> str:
    """Return how fast the groove of a new roller wears, in one sentence; an empty text if wear was not computed."""
    if "run_in_distance" not in ds or not np.isfinite(float(ds["run_in_distance"])):
        return ""
    return phrase("wear", "run_in", depths=_worn(ds["wear_depth_per_km"]), distance=float(ds["run_in_distance"]))


def sentences(ds: xr.Dataset) -> list[Sentence]:
    """Return what a user asks first: how far, how deep, how pressure and patch change, and the life with wear."""
    return [_end(ds), *_guessed(ds), _pressure(ds), *(s for body in BODIES if (s := _life(ds, body)) is not None)]


def _worn(depth: xr.DataArray) -> dict[str, float]:
    """Return the largest depth of each body that wears [µm], from depths in mm over contact and body."""
    depths = {body: 1e3 * float(depth.sel(body=body).max()) for body in BODIES}
    return {body: depth for body, depth in depths.items() if depth > 0.0}


def _end(ds: xr.Dataset) -> Sentence:
    why = ENDS.get(str(ds.attrs["end"]), "it is not finished")
    depths = _worn(ds["groove_depth"].isel(travel=-1))
    travel = float(ds["travel"][-1])
    hours = travel / (KM_PER_HOUR * float(inputs_of(ds)["velocity"]))
    return say("wear", "wear_end", travel=travel, life=lasting(hours, "h"), depths=depths, why=why)


def _guessed(ds: xr.Dataset) -> list[Sentence]:
    """Say of which materials the wear coefficient is a guess."""
    own = [one for one in placeholders_of(ds) if one.name == "wear_coefficient"]
    named = [
        f"{one.material}{f' on {one.on}' * bool(one.on)}, expected from {rounded(one.low)} to "
        f"{quantity(one.high, one.units)}"
        for one in own
    ]
    return [say("wear", "wear_guessed", named=list(dict.fromkeys(named)))] if named else []


def _pressure(ds: xr.Dataset) -> Sentence:
    own = ds.sel(contact=deeper_contact(ds))
    pressures, wide = own["max_pressure"].values, own["semi_axis_lateral"].values
    course = {"pressures": pressures, "travel": own["travel"].values, "most": int(np.argmax(pressures))}
    error = float(own["pressure_error"].max())
    return say("wear", "wear_pressure", contact=int(own["contact"]), wider=wide[-1] / wide[0], error=error, **course)


def _life(ds: xr.Dataset, body: str) -> Sentence | None:
    """Return the fatigue life of a body that counts wear; None if no life was computed or it is not known."""
    if "fatigue_damage" not in ds:
        return None
    own = ds.sel(body=body)
    damage, new = own["fatigue_damage"].isel(travel=-1).values, float(own["life_travel_new"].min())
    if np.isnan(damage).any() or np.isnan(new):
        return None
    life = float(own["life_travel"].min()) if own["life_travel"].notnull().any() else np.inf
    error = float(own["fatigue_damage_error"].isel(travel=-1).max())
    return say("wear", "wear_life", body=body, life=life, new=new, damage=float(damage.max()), error=error)
