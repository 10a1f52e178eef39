"""The record of a roller that wears: how far it went and why it ended, depth, pressure and fatigue
of both bodies.

Keys of `Answer.headline`: `travel` [km], `hours` [h], `depths` (µm by body that wears), `end` (why
the travel ends), `contact` (that wears more), `pressure_first`, `pressure_last`, `pressure_most`
[MPa], `travel_most` [km], `wider` (width of the patch at the end over that at first [1]),
`pressure_error` [1], `guessed` (whether the wear coefficient is a placeholder), `fatigue` ({body,
travel [km]} of the body whose damage sum by fatigue reaches 1 first within the run, or None),
`state` (of the required travel: `met`, `open`, `missed`, or '' without one).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from trackroller.damage.wear import KM_PER_HOUR
from trackroller.parameters import BODIES
from trackroller.parameters.carriage_fields import long_name_of
from trackroller.results.answer import Answer, Caution, Column, FurtherTable, Required
from trackroller.results.friction import friction_cautions
from trackroller.results.life_columns import OF_PAIR
from trackroller.results.placeholders import guess_cautions, placeholders_part
from trackroller.results.roller_answer import CODES, facts_of_data, not_given_words
from trackroller.results.validity_flags import flags_of
from trackroller.roller.limit_notes import placeholders_of
from trackroller.roller.requirement import requirement_of
from trackroller.roller.stored_inputs import NOT_GIVEN, inputs_of
from trackroller.roller.wearing import ENDS

BEFORE = ("permissible", "lift_off", "full_slip")  # ends of a run that end the roller as well
SOLVED = 1e-6  # residual of a solved balance, over the normal force times the distance of the axes
MICROMETRES = 1e3  # in a mm
COLUMNS = (
    Column("body", "Body", "", "body that wears", "text", role="name"),
    Column("depth", "Worn depth", "µm", "largest depth at the end of the travel", "whole"),
    Column(
        "life_travel",
        "Life with wear",
        "km",
        "travel until the damage sum by fatigue is 1; from the end of the run to ∞ where the run "
        "ends before",
        until="life_travel_high",
    ),
    Column(
        "life_new", "Life of the new groove", "km", "the same under the stress of the new groove"
    ),
    Column("damage", "Damage sum", "1", "largest damage sum by fatigue at the end of the travel"),
    Column("damage_error", "Error", "1", "estimated error of the damage sum", "error"),
)
OF_BODY = (
    ("groove_depth", "depth", MICROMETRES, "µm"),
    ("peak_stress", "peak stress", 1.0, "MPa"),
    ("fatigue_damage", "damage sum", 1.0, "1"),
)
OF_CONTACT = (
    ("max_pressure", "Pressure", "MPa"),
    ("semi_axis_lateral", "Half width", "mm"),
    ("contact_angle", "Contact angle", "degree"),
    ("normal_force", "Normal force", "N"),
    ("friction_power", "Friction power", "W"),
    ("slip", "Creepage", "1"),
    ("drive_torque", "Drive torque", "N mm"),
)


def answer_of_wear(ds: xr.Dataset) -> Answer:
    """Return the record of a roller that wears.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `trackroller.wear`.
    """
    guesses = placeholders_part(ds)
    table = _table(ds)
    required = _required(ds)
    head = _headline(ds) | {"fatigue": _first_by_fatigue(table, float(ds["travel"][-1]))}
    parts = [states_part(ds)]
    if not guesses.table.empty:
        parts.append(guesses)
    return Answer(
        question="wear",
        kind="worn",
        headline=head | {"state": _state(ds, table, head, required)},
        output=("groove_depth", "worn depth", "mm"),
        table=table,
        columns=COLUMNS,
        required=required,
        parts=tuple(parts),
        not_used=_not_judged(ds),
        not_given=_not_given(ds),
        warnings=tuple(_warnings(ds, guesses)),
        facts=facts_of_data(ds, name="A track roller while it wears"),
    )


def deeper_contact(ds: xr.Dataset) -> int:
    """Return the contact whose profiles have lost more depth at the end; contact 1 if both are
    alike.
    """
    depth = ds["groove_depth"].isel(travel=-1).sum("body")
    return int(ds["contact"].values[int(np.argmax(depth.values > 0.999 * depth.values.max()))])


def _headline(ds: xr.Dataset) -> dict[str, Any]:
    """Return the numbers of the headline."""
    last = ds["groove_depth"].isel(travel=-1)
    depths = {body: MICROMETRES * float(last.sel(body=body).max()) for body in BODIES}
    own = ds.sel(contact=deeper_contact(ds))
    pressures = own["max_pressure"].values
    wide = own["semi_axis_lateral"].values
    most = int(np.argmax(pressures))
    travel = float(ds["travel"][-1])
    return {
        "travel": travel,
        "hours": travel / (KM_PER_HOUR * float(inputs_of(ds)["velocity"])),
        "depths": {body: depth for body, depth in depths.items() if depth > 0.0},
        "end": ENDS.get(str(ds.attrs["end"]), "it is not finished"),
        "contact": int(own["contact"]),
        "pressure_first": float(pressures[0]),
        "pressure_last": float(pressures[-1]),
        "pressure_most": float(pressures[most]),
        "travel_most": float(own["travel"].values[most]),
        "wider": float(wide[-1] / wide[0]),
        "pressure_error": float(own["pressure_error"].max()),
        "guessed": any(one.name == "wear_coefficient" for one in placeholders_of(ds)),
    }


def _table(ds: xr.Dataset) -> pd.DataFrame:
    """Return one row a body; lives by fatigue are NaN where they are not known."""
    rows = []
    for body in BODIES:
        own = ds.sel(body=body)
        row = {
            "body": body,
            "depth": MICROMETRES * float(own["groove_depth"].isel(travel=-1).max()),
        }
        rows.append(row | _fatigue(own))
    return pd.DataFrame(
        rows, columns=[name for one in COLUMNS for name in (one.name, one.until) if name]
    )


def _fatigue(own: xr.Dataset) -> dict[str, float]:
    """Return the life of a body by fatigue that counts wear; it is longer than the run if the run
    ends before.
    """
    unknown = dict.fromkeys(
        ("life_travel", "life_travel_high", "life_new", "damage", "damage_error"), np.nan
    )
    if "fatigue_damage" not in own:
        return unknown
    damage = own["fatigue_damage"].isel(travel=-1).values
    new = float(own["life_travel_new"].min())
    if np.isnan(damage).any() or np.isnan(new):
        return unknown
    reached = bool(own["life_travel"].notnull().any())
    life_high = np.inf
    if reached:
        life = float(own["life_travel"].min())
        life_high = life
    else:
        life = float(own["travel"][-1])
    return {
        "life_travel": life,
        "life_travel_high": life_high,
        "life_new": new,
        "damage": float(damage.max()),
        "damage_error": float(own["fatigue_damage_error"].isel(travel=-1).max()),
    }


def _first_by_fatigue(table: pd.DataFrame, travel: float) -> dict[str, Any] | None:
    """Return the body whose damage sum reaches 1 first within the run, and its travel [km]; None
    without one.
    """
    reached = table[table["life_travel_high"] <= travel]
    if reached.empty:
        return None
    first = min(reached.to_dict("records"), key=lambda row: float(row["life_travel"]))
    return {"body": str(first["body"]), "travel": float(first["life_travel"])}


def _required(ds: xr.Dataset) -> tuple[Required, ...]:
    """Return the travel that the case requires: its own, or that of a required life."""
    inputs = inputs_of(ds)
    least = [own.least for name, own in requirement_of(ds).items() if name in OF_PAIR]
    travels = [
        hours * KM_PER_HOUR * float(inputs["velocity"]) for hours in least if np.isfinite(hours)
    ]
    if inputs.get("required_travel") is not None:
        travels.append(float(inputs["required_travel"]))
    travels = [travel for travel in travels if np.isfinite(travel)]
    if travels:
        return (Required("travel", "travel", "km", least=max(travels)),)
    return ()


def _not_judged(ds: xr.Dataset) -> dict[str, str]:
    """Return the requirements that a run of wear does not judge."""
    others = [name for name in requirement_of(ds) if name not in OF_PAIR]
    return {f"requirement.{name}": "a run of wear judges a life of the pair" for name in others}


def _state(
    ds: xr.Dataset, table: pd.DataFrame, head: Mapping[str, Any], required: Sequence[Required]
) -> str:
    """Return whether the required travel is reached before wear, fatigue or a contact ends the
    roller.

    Where the wear coefficient is a placeholder, only fatigue that ends the new groove before is
    surely too early.
    """
    if not required:
        return ""
    least, last = required[0].least, float(head["travel"])
    fatigue = np.inf
    if head["fatigue"]:
        fatigue = head["fatigue"]["travel"]
    if head["guessed"]:
        if max(fatigue, float(table["life_new"].min())) < least:
            return "missed"
        return "open"
    end = np.inf
    if str(ds.attrs["end"]) in BEFORE:
        end = last
    if min(fatigue, end) < least:
        return "missed"
    if last >= least:
        return "met"
    return "open"


def _not_given(ds: xr.Dataset) -> dict[str, str]:
    """Return the values that nobody gave; the travel is that of the run."""
    words = {}
    if NOT_GIVEN in ds.attrs:
        words = not_given_words(ds)
    return {name: value for name, value in words.items() if name != "travel"}


def states_part(ds: xr.Dataset) -> FurtherTable:
    """Return the states of the contact that wears more: depth, pressure, patch, forces, stress and
    damage.
    """
    contact = deeper_contact(ds)
    own = ds.sel(contact=contact)
    if "drive_torque" in own:  # 0 where it is smaller than the residual of its balance allows
        least = SOLVED * own["normal_force"] * inputs_of(ds)["axis_distance"]
        own = own.assign(
            drive_torque=own["drive_torque"].where(np.abs(own["drive_torque"]) > least, 0.0)
        )
    columns = [Column("travel", "Travel", "km", "", "whole", role="name")]
    table = {"travel": own["travel"].values.astype(float)}
    for name, words, scale, unit in (row for row in OF_BODY if row[0] in own):
        for body in BODIES:
            values = scale * own[name].sel(body=body).values
            if not np.isnan(values).all():
                table[f"{name}_{body}"] = values
                columns.append(Column(f"{name}_{body}", f"{body} {words}", unit, "", "whole"))
    for name, words, unit in (row for row in OF_CONTACT if row[0] in own):
        table[name] = own[name].values.astype(float)
        columns.append(Column(name, words, unit, "", "whole"))
    return FurtherTable(
        "states", f"States of contact {contact}", pd.DataFrame(table), tuple(columns)
    )


def _warnings(ds: xr.Dataset, guesses: FurtherTable) -> Iterator[Caution]:
    """Yield the flags of all states, placeholders, and values that were not given."""
    for flag in flags_of(ds):
        yield Caution(CODES.get(flag.name, "flagged"), 1, 1, f"{flag.sentence} {flag.remedy}", "")
    yield from guess_cautions(guesses)
    yield from friction_cautions(ds.attrs)
    words = _not_given(ds)
    if words:
        text = ", ".join(f"{long_name_of(name)} {value}" for name, value in words.items())
        yield Caution("not_given", 1, 1, text, "")
