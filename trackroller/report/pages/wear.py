"""The page of a roller that wears: profiles and course over the travel, in words, figures and one table."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np
import xarray as xr

from trackroller.parameters import BODIES
from trackroller.report import html
from trackroller.report.numbers import capital, with_unit
from trackroller.report.pages.sheet import body_materials, command_of, pictures, versions_text
from trackroller.report.tables.inputs import input_rows
from trackroller.report.tables.limits import placeholders
from trackroller.report.tables.table import Table, cell
from trackroller.report.words.accuracy import flags_of
from trackroller.report.words.wear import deeper_contact, sentences
from trackroller.roller.stored_inputs import inputs_of, materials_of

MOST = 12  # rows of the table
SOLVED = 1e-6  # residual of a solved balance, over the normal force times the distance of the axes
OF_BODY = (
    ("groove_depth", "depth", 1e3, "µm"),
    ("peak_stress", "peak stress", 1.0, "MPa"),
    ("fatigue_damage", "damage sum", 1.0, "-"),
)
COLUMNS = (
    ("max_pressure", "Pressure", "MPa"),
    ("semi_axis_lateral", "Half width", "mm"),
    ("contact_angle", "Contact angle", "degree"),
    ("normal_force", "Normal force", "N"),
    ("friction_power", "Friction power", "W"),
    ("slip", "Creepage", "-"),
    ("drive_torque", "Drive torque", "N mm"),
)


def state_table(ds: xr.Dataset) -> Table:
    """List the states of the contact that wears more: depth, pressure, patch, forces, stress and damage."""
    contact = deeper_contact(ds)
    own = ds.sel(contact=contact)
    if "drive_torque" in own:  # 0 where it is smaller than the residual of its balance allows
        least = SOLVED * own["normal_force"] * inputs_of(ds)["axis_distance"]
        own = own.assign(drive_torque=own["drive_torque"].where(np.abs(own["drive_torque"]) > least, 0.0))
    columns = {"Travel [km]": own["travel"]}
    for name, words, scale, unit in (row for row in OF_BODY if row[0] in own):
        for body in BODIES:
            if own[name].sel(body=body).notnull().any():
                columns[with_unit(f"{capital(body)} {words}", unit)] = scale * own[name].sel(body=body)
    columns |= {with_unit(words, unit): own[name] for name, words, unit in COLUMNS if name in own}
    picked = np.unique(np.linspace(0, ds.sizes["travel"] - 1, min(MOST, ds.sizes["travel"])).round().astype(int))
    rows = [[cell(float(column[i])) for column in columns.values()] for i in picked]
    return Table("wear_states", f"States of contact {contact}", list(columns), rows)


def write_wear(ds: xr.Dataset, path: Path | str) -> Path:
    """Write the page of a roller that wears as one HTML file that stands alone, or as PDF by the name of the file.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `trackroller.wear`.
    path : Path or str
        The file to write.

    Returns
    -------
    Path
        The file.
    """
    from trackroller.report.figures import wear  # heavy: matplotlib

    drawn = pictures(partial(wear.profiles, ds), partial(wear.course, ds))
    flags = {f"{flag.sentence} {flag.remedy}" for i in (0, -1) for flag in flags_of(ds.isel(travel=i))}
    content = {
        "name": "A track roller while it wears",
        "said": [sentence.text for sentence in sentences(ds)],
        "figures": list(drawn.values()),
        "states": state_table(ds),
        "inputs": input_rows(inputs_of(ds)),
        "materials": body_materials(materials_of(ds)),
        "flags": [*placeholders(ds), *sorted(flags)],
        "command": command_of(ds, ("wear", "--to", f"{float(ds.attrs['to']):g}km", "--report", Path(path).name)),
        "options": ", ".join(f"{name} {ds.attrs[name]}" for name in ("contact_model", "accuracy") if name in ds.attrs),
        "versions": versions_text(),
    }
    return html.write_page(Path(path), html.render("wear.html.j2", content))
