"""The page of a carriage: its picture with the forces of the rollers, their loads and lives, and the margins."""

from __future__ import annotations

import math
import shlex
from functools import partial
from pathlib import Path

import numpy as np
import xarray as xr

from trackroller.parameters import REGIME_LABELS
from trackroller.report import html
from trackroller.report.numbers import capital, lives_in_years
from trackroller.report.pages.sheet import pictures, versions_text
from trackroller.report.tables.table import Table, cell
from trackroller.report.terminal import print_table, print_text
from trackroller.report.words.carriage import sentences
from trackroller.roller.stored_inputs import doubts_of

LARGE = "–"  # of a margin that is not reached
UNKNOWN = "not known"
BEYOND = "beyond one contact"  # where the model has ended before


def load_table(ds: xr.Dataset) -> Table:
    """List the forces of each roller in each load case, its regime, life and load factor."""
    heads = ["Load case", "Roller", "Radial force [N]", "Axial force [N]"]
    more = [("case_life_hours", "Life under it alone [h]"), ("load_factor", "Load factor [–]")]
    more = [(name, head) for name, head in more if name in ds]
    regimes = "roller_regime" in ds
    rows = []
    for i, case in enumerate(ds["load_case"].values):
        for j, roller in enumerate(ds["roller"].values):
            own = ds.isel(load_case=i, roller=j)
            lifted = float(own["radial_force"]) == 0
            row = [str(case), str(roller), cell(float(own["radial_force"])), cell(float(own["axial_force"]))]
            if regimes:
                row.append("lifted" if lifted else REGIME_LABELS[int(own["roller_regime"])])
            row += ["–" if lifted and name == "case_life_hours" else cell(float(own[name])) for name, _ in more]
            rows.append(row)
    heads += ["Regime"] * regimes + [head for _, head in more]
    note = "Radial forces below 0 press the roller on its rail; axial forces act on the roller along its own axis x_R."
    return Table("carriage_loads", "Loads of the rollers", heads, rows, note)


def roller_table(ds: xr.Dataset) -> Table | None:
    """List the life of each roller over all load cases; None without lives."""
    columns = [
        ("life_km", "Life [km]"),
        ("life_hours", "Life [h]"),
        ("life_years", "Life [years]"),
        ("catalogue_life_km", "By the catalogue [km]"),
    ]
    columns = [(name, head) for name, head in columns if name in ds]
    if not columns:
        return None
    rows = [
        [str(roller), *(cell(float(ds[name].sel(roller=roller))) for name, _ in columns)]
        for roller in ds["roller"].values
    ]
    note = "Lives end at the first limit of the roller or its rail; they add up over the shares of the load cases."
    return Table("carriage_lives", "Lives", ["Roller", *(head for _, head in columns)], rows, note)


def margin_table(ds: xr.Dataset) -> Table:
    """List drive force and margins of each load case."""
    ends = ("one contact", "lift-off", "tipping")
    heads = ["Load case", "Share [%]", "Drive [N]"]
    heads += [f"{part} to {end}" for part in ("Payload", "All loads") for end in ends]
    rows = []
    for i, case in enumerate(ds["load_case"].values):
        shown = [text for part in ("payload", "loads") for text in _margin_cells(ds.isel(load_case=i), part)]
        unsettled = "" if bool(ds["converged"][i]) else " (not settled)"
        rows.append(
            [f"{case}{unsettled}", cell(100 * float(ds["share"][i])), cell(float(ds["drive_force"][i])), *shown]
        )
    note = "A margin is a multiplier of the payload, or of all loads, with the same preload. One contact: the "
    note += "axial force lifts the other contact of a roller; friction may do so earlier, and the model ends there: "
    note += "later margins are not stated. A dash: not up to 1000."
    return Table("carriage_margins", "Load cases and margins", heads, rows, note)


def _margin_cells(ds: xr.Dataset, part: str) -> list[str]:
    """Return the margins of a part of the loads in one load case; later ones than one contact are not stated."""
    one_contact, *later = (float(ds[f"{part}_to_{end}"]) for end in ("one_contact", "lift_off", "tipping"))
    if one_contact < later[0]:
        return [_margin_cell(one_contact), BEYOND, BEYOND]
    return [_margin_cell(value) for value in (one_contact, *later)]


def _margin_cell(value: float) -> str:
    """Return the text of a margin."""
    if math.isnan(value):
        return UNKNOWN
    return cell(value) if math.isfinite(value) else LARGE


def tables(ds: xr.Dataset) -> list[Table]:
    """Return the tables of a carriage, for its page and for the terminal."""
    return [table for table in (roller_table(ds), load_table(ds), margin_table(ds)) if table is not None]


@lives_in_years
def write_carriage(ds: xr.Dataset, path: Path | str, file: str = "carriage.yaml") -> Path:
    """Write the page of a carriage as one HTML file that stands alone, or as PDF by the name of the file.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `trackroller.carriage`.
    path : Path or str
        The file to write.
    file : str
        Name of the carriage file, for the command that repeats the page.

    Returns
    -------
    Path
        The file.
    """
    from trackroller.report.figures import carriage  # heavy: matplotlib

    drawn = pictures(partial(carriage.views, ds))
    masses = [
        [str(name), cell(float(value)), *(cell(float(one)) for one in at)]
        for name, value, at in zip(ds["mass_name"].values, ds["mass"].values, ds["mass_at"].values, strict=True)
    ]
    places = [
        [str(name), *(cell(float(np.round(one, 9))) for one in np.concatenate(own)), "yes" if locates else "no"]
        for name, locates, *own in zip(
            ds["roller"].values,
            ds["locating"].values,
            *(ds[f"roller_{key}"].values for key in ("at", "pushes", "axis")),
            strict=True,
        )
    ]
    heads = ["Roller", *(f"{word} {axis}" for word in ("at [mm]", "pushes", "x_R") for axis in "xyz"), "Locating"]
    content = {
        "name": capital(str(ds.attrs["title"])),
        "description": str(ds.attrs.get("description", "")),
        "said": [sentence.text for sentence in sentences(ds)],
        "doubts": doubts_of(ds),
        "figure": next(iter(drawn.values())),
        "tables": [
            *tables(ds),
            Table("carriage_masses", "Masses", ["Mass", "[kg]", "x [mm]", "y [mm]", "z [mm]"], masses),
            Table("carriage_places", "Places and directions", heads, places),
        ],
        "conventions": [f"{capital(text)}." for text in str(ds.attrs["conventions"]).split("; ")],
        "command": f"trackroller carriage {shlex.quote(file)} --report {shlex.quote(Path(path).name)}",
        "versions": versions_text(),
    }
    return html.write_page(Path(path), html.render("carriage.html.j2", content))


@lives_in_years
def print_carriage(ds: xr.Dataset) -> None:
    """Print loads and lives of the rollers of a carriage, its margins, and sentences on them."""
    for part in tables(ds):
        print_table(part.heads, part.rows, range(2, len(part.heads)), f"{ds.attrs['title']}: {part.title.lower()}")
        print_text(part.note)
    for sentence in sentences(ds):
        print_text(sentence.text)
