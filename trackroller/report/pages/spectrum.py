"""The facts of a load spectrum, for the terminal and for its page: lives, damage by block, and sentences on both."""

from __future__ import annotations

import json
import math
import shlex
from functools import partial
from pathlib import Path

import numpy as np
import xarray as xr

from trackroller.damage import LIMITS
from trackroller.parameters import BODIES, PARAMETERS, REGIME_LABELS
from trackroller.parameters.example import drive_question, not_given_text
from trackroller.report import html
from trackroller.report.numbers import (
    between,
    capital,
    chance,
    life,
    life_unit,
    listing,
    lives_in_years,
    long_name,
    rounded,
    unit_text,
    with_unit,
)
from trackroller.report.pages.sheet import body_materials, pictures, versions_text
from trackroller.report.tables.inputs import Row, input_rows
from trackroller.report.tables.limits import at_temperature, not_checked, placeholders, unchecked
from trackroller.report.tables.table import Table, cell
from trackroller.report.terminal import print_table, print_text
from trackroller.report.words.accuracy import flags_of
from trackroller.report.words.spectrum import UNITS, known_damage, sentences
from trackroller.roller.stored_inputs import NOT_GIVEN, doubts_of
from trackroller.study.spectrum.file import LOAD_FIELDS


def life_rows(ds: xr.Dataset, body: str) -> list[Row]:
    """Return the life of a body in hours, km and shifts, and at each failure probability if its material scatters.

    Blocks by share of the time have no shifts.
    """
    units = UNITS if ds.attrs.get("period") != "hour" else UNITS[:-1]
    lives = [(name, float(ds[f"{body}_life_{name}"]), unit) for name, unit in units]
    rows = [
        Row(f"life in {name}", life(value), "" if math.isnan(value) else life_unit(unit, value))
        for name, value, unit in lives
    ]
    if "life_shifts_at_probability" in ds:
        at = ds["life_shifts_at_probability"].sel(body=body)
        per_shift = [float(ds["duration"].sum()), float(ds["distance"].sum()) / 1e3, 1.0][: len(units)]
        for p in ds["probability"].values if not bool(at.isnull().all()) else ():
            shifts = float(at.sel(probability=p).min(skipna=False))
            scaled = [(shifts * scale, unit) for scale, (_, unit) in zip(per_shift, units, strict=True)]
            lengths = ", ".join(f"{life(value)} {life_unit(unit, value)}" for value, unit in scaled)
            rows.append(Row(f"until {100 * float(p):g} % have failed", lengths))
    return rows


def block_table(ds: xr.Dataset) -> Table:
    """List the blocks of a shift: distance, the loads that differ, regime, stress and damage with its share."""
    loads = [n for n in LOAD_FIELDS if len(np.unique(ds[n].values[~np.isnan(ds[n].values)])) > 1]
    differ = [with_unit(capital(long_name(name)), PARAMETERS[name].unit) for name in loads]
    by_share = ds.attrs.get("period") == "hour"
    heads = ["Block", "Distance [m]", "Share of the time [–]" if by_share else "Duration [h]", *differ, "Regime"]
    for body in BODIES:
        heads += [f"{capital(body)} peak [MPa]", f"{capital(body)} damage [–]", "Share"]
    rows, shown = [], {body: known_damage(ds, body) for body in BODIES}
    for i, name in enumerate(ds["block"].values):
        cells = [str(name), *(cell(float(ds[n][i])) for n in ("distance", "duration", *loads))]
        cells.append(REGIME_LABELS[int(ds["regime"][i])])
        for body, (contact, damage) in shown.items():
            whole, stress = float(np.nansum(damage)), float(ds["peak_stress"].sel(body=body, contact=contact)[i])
            cells += [cell(stress), cell(damage[i]), chance(damage[i] / whole) if whole > 0 else "–"]
        rows.append(cells)
    whole_name = "Sum of an hour" if by_share else "Sum of a shift"
    sums = [whole_name, *(cell(float(ds[n].sum())) for n in ("distance", "duration")), *[""] * (len(loads) + 1)]
    for _, damage in shown.values():
        sums += ["", f"{'≥ ' * bool(np.isnan(damage).any())}{cell(float(np.nansum(damage)))}", ""]
    rows.append(sums)
    same = [n for n in LOAD_FIELDS if n not in loads and np.isfinite(ds[n].values).all()]
    same_loads = [f"{PARAMETERS[n].long_name} {cell(float(ds[n][0]))} {unit_text(PARAMETERS[n].unit)}" for n in same]
    note = "Stress and damage are those of the track that fails first"
    if any(np.isnan(damage).any() for _, damage in shown.values()):
        note += " by the blocks with known damage; sums and shares hold these blocks alone"
    note += f". Same in all blocks: {'; '.join(same_loads)}."
    title = "Blocks of an hour of travel" if by_share else "Blocks of a shift"
    return Table("spectrum", title, heads, rows, note.replace(" –;", ";").replace(" –.", "."))


def limit_table(ds: xr.Dataset) -> Table | None:
    """List the limits of a spectrum with the share that the worst block uses and the hours; None without limits."""
    if "life_shifts_by_limit" not in ds:
        return None
    heads, rows = ["Limit"], []
    for body in BODIES:
        heads += [f"{capital(body)} used", f"{capital(body)} lasts"]
    for name in (name for name in ds["limit"].values.tolist() if name not in unchecked(ds)):
        own, row = ds.sel(limit=name), [LIMITS[name].title]
        for body in BODIES:
            used = float(own["utilisation"].sel(body=body))
            low, high = (float(own[f"life_hours_by_limit{end}"].sel(body=body)) for end in ("_low", "_high"))
            lasts = "–" if math.isnan(low) else between(low, high)
            row += ["–" if np.isnan(used) else f"{rounded(100.0 * used)} %", lasts]
        rows.append(row)
    note = (
        "The share that the worst block uses, and the hours of travel until the sum over the blocks is reached. A "
        "limit without a life has no hours. A dash stands for a missing value. A range runs from the worse to the "
        "better end of the placeholders of materials."
    )
    return Table("spectrum_limits", "Limits", heads, rows, note)


def warnings(ds: xr.Dataset) -> list[str]:
    """Return each validity flag in words, with its remedy and the blocks that carry it."""
    blocks_of_flag: dict[str, list[str]] = {}
    for i, name in enumerate(ds["block"].values if "validity" in ds else ()):
        for flag in flags_of(ds.isel(block=i)):
            blocks_of_flag.setdefault(f"{flag.sentence} {flag.remedy}", []).append(f"'{name}'")
    flagged = [f"{text} Blocks: {listing(blocks)}." for text, blocks in blocks_of_flag.items()]
    return [*flagged, *placeholders(ds), *at_temperature(ds), *not_checked(ds)]


def assumed(ds: xr.Dataset) -> list[str]:
    """Return what was not given, and a question about a drive that is not given."""
    given = json.loads(ds.attrs.get(NOT_GIVEN, "{}"))
    texts = [not_given_text(given), drive_question(given, set(PARAMETERS) - set(given))]
    return [capital(text) for text in texts if text]


@lives_in_years
def write_spectrum(ds: xr.Dataset, path: Path | str, file: str = "spectrum.yaml") -> Path:
    """Write the page of a load spectrum as one HTML file that stands alone, or as PDF by the name of the file.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `solve_spectrum`.
    path : Path or str
        The file to write.
    file : str
        Name of the spectrum file, for the command that repeats the page.

    Returns
    -------
    Path
        The file.
    """
    from trackroller.report.figures import spectrum  # heavy: matplotlib

    inputs, given = json.loads(ds.attrs["roller"]), json.loads(ds.attrs[NOT_GIVEN])
    drawn = pictures(partial(spectrum.damage_by_block, ds))
    content = {
        "name": capital(str(ds.attrs["title"])),
        "description": str(ds.attrs.get("description", "")),
        "said": [sentence.text for sentence in sentences(ds)],
        "lives": [(body, life_rows(ds, body)) for body in BODIES],
        "conventions": capital(str(ds.attrs["life_conventions"])),
        "figure": next(iter(drawn.values()), None),
        "inputs": input_rows(inputs, given),
        "assumed": assumed(ds),
        "doubts": doubts_of(ds),
        "materials": body_materials(json.loads(ds.attrs["materials"])),
        "tables": [table for table in (limit_table(ds), block_table(ds)) if table is not None],
        "flags": warnings(ds),
        "command": f"trackroller spectrum {shlex.quote(file)} --report {shlex.quote(Path(path).name)}",
        "versions": versions_text(),
    }
    return html.write_page(Path(path), html.render("spectrum.html.j2", content))


@lives_in_years
def print_spectrum(ds: xr.Dataset) -> None:
    """Print the damage of each block, the lives, sentences on their causes and warnings."""
    period = ds.attrs.get("period", "shift")
    for part, words in ((block_table(ds), f"damage per {period}"), (limit_table(ds), "limits")):
        if part is not None:
            print_table(part.heads, part.rows, range(1, len(part.heads)), f"{ds.attrs['title']}: {words}")
            print_text(part.note)
    for body in BODIES:
        lives = "; ".join(f"{row.words}: {row.value} {row.unit}".rstrip() for row in life_rows(ds, body))
        print_text(lives, body)
    for sentence in sentences(ds):
        print_text(sentence.text)
    for text in warnings(ds):
        print_text(text, "warning")
    for text in assumed(ds):
        print_text(text)
