"""The page of a roller that wears: profiles and course over the travel, in words, figures and one table."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np
import xarray as xr

from trackroller.parameters import BODIES
from trackroller.report import html
from trackroller.report.numbers import capital, with_unit
from trackroller.report.pages.sheet import pictures
from trackroller.report.pages.sheet_facts import body_materials, command_of, versions_text
from trackroller.report.tables.inputs import input_rows
from trackroller.report.tables.limits import placeholders
from trackroller.report.tables.table import Table, cell
from trackroller.report.words.accuracy import flags_of
from trackroller.report.words.wear import deeper_contact, sentences
from trackroller.roller.record import inputs_of, materials_of

MOST = 12  # rows of the table
SOLVED = 1e-6  # residual of a solved balance, over the normal force times the distance of the axes
COLUMNS = (
    ("max_pressure", "pressure", 1.0, "MPa"),
    ("semi_axis_lateral", "half width", 1.0, "mm"),
    ("contact_angle", "contact angle", 1.0, "degree"),
    ("normal_force", "normal force", 1.0, "N"),
    ("friction_power", "friction power", 1.0, "W"),
)


def state_table(ds: xr.Dataset) -> Table:
    """List the states of the contact that wears more: depth, pressure, patch, forces, stress and damage."""
    contact = deeper_contact(ds)
    own = ds.sel(contact=contact)
    bodies = [(name, body, scale, unit) for name, scale, unit in _OF_BODY if name in ds for body in BODIES]
    bodies = [row for row in bodies if own[row[0]].sel(body=row[1]).notnull().any()]
    columns = [row for row in COLUMNS if row[0] in ds]
    named = [with_unit(f"{capital(body)} {_OF_BODY_WORDS[name]}", unit) for name, body, _, unit in bodies]
    heads = ["Travel [km]", *named]
    heads += [with_unit(capital(words), unit) for _, words, _, unit in columns]
    heads += [with_unit("Creepage", "-"), with_unit("Drive torque", "N mm")] if "slip" in ds else []
    picked = np.unique(np.linspace(0, ds.sizes["travel"] - 1, min(MOST, ds.sizes["travel"])).round().astype(int))
    rows = []
    for i in picked.tolist():
        at = own.isel(travel=i)
        cells = [cell(float(at["travel"])), *(cell(scale * float(at[n].sel(body=b))) for n, b, scale, _ in bodies)]
        cells += [cell(scale * float(at[name])) for name, _, scale, _ in columns]
        cells += [cell(float(at["slip"])), cell(_beyond_noise(at))] if "slip" in ds else []
        rows.append(cells)
    return Table("wear_states", f"States of contact {contact}", heads, rows, "")


def _beyond_noise(at: xr.Dataset) -> float:
    """Return the drive torque of a state [N mm]; 0 where it is smaller than the residual of its balance allows."""
    torque, largest = float(at["drive_torque"]), float(at["normal_force"]) * inputs_of(at)["axis_distance"]
    return torque if abs(torque) > SOLVED * largest else 0.0


_OF_BODY = (("groove_depth", 1e3, "µm"), ("peak_stress", 1.0, "MPa"), ("fatigue_damage", 1.0, "-"))
_OF_BODY_WORDS = {"groove_depth": "depth", "peak_stress": "peak stress", "fatigue_damage": "damage sum"}


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
