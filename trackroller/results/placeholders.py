"""Values of materials that nobody has measured, on which the limits of a result rest: a table and warnings."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from trackroller.damage import LIMITS
from trackroller.errors import listing
from trackroller.materials.properties import PROPERTIES
from trackroller.results.answer import Caution, Column, Part
from trackroller.roller.limit_notes import placeholders_of

POLYMER = 20e3  # MPa; a material with a lower Young's modulus is treated as a polymer
COLUMNS = (
    Column("material", "Material", "", "material of the value", "text", role="name"),
    Column("value", "Value", "", "name of the value in config/materials.yaml", "text", role="name"),
    Column("limit", "Limit", "", "limit that rests on it", "text"),
    Column("low", "Expected", "", "range in which the value is expected", until="high"),
    Column("units", "Unit", "", "unit of the range", "text"),
    Column("note", "Note", "", "what the database says of the value", "text"),
)


def placeholders_part(ds: xr.Dataset) -> Part:
    """Return the placeholders of the materials of a result, and what the database says against other values.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of one case, of a spectrum, or of a roller that wears.
    """
    rows = [
        _row(one.material, one.name, LIMITS[one.limit].word, one.low, one.high, one.units, one.note)
        for one in placeholders_of(ds)
    ]
    stored = json.loads(str(ds.attrs.get("materials", "{}")))
    rows += [row for values in stored.values() for row in _notes(values)]
    table = pd.DataFrame(rows, columns=[name for one in COLUMNS for name in (one.name, one.until) if name])
    return Part("placeholders", "Values that nobody has measured", table.drop_duplicates(ignore_index=True), COLUMNS)


def _row(material: str, value: str, limit: str, low: float, high: float, units: str, note: str) -> dict[str, Any]:
    return {
        "material": material,
        "value": value,
        "limit": limit,
        "low": low,
        "high": high,
        "units": units,
        "note": note,
    }


def _notes(values: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield what the database says against the values of one material, and what polymers need."""
    name = str(values.get("name", ""))
    by_note: dict[str, list[str]] = {}
    for key, note in values.get("notes", {}).items():
        by_note.setdefault(note, []).append(PROPERTIES[key].symbol)
    for note, symbols in by_note.items():
        yield _row(name, listing(symbols), "", np.nan, np.nan, "", note)
    for guess in values.get("guesses", ()):
        yield _row(name, str(guess), "", np.nan, np.nan, "", "a guess without a source")
    modulus = values.get("youngs_modulus")
    if modulus is not None and float(modulus) < POLYMER:
        note = "values of a polymer depend on temperature and moisture: give those in use"
        yield _row(name, "stiffness, strength, friction", "", np.nan, np.nan, "", note)


def guess_cautions(part: Part, what: str = "") -> Iterator[Caution]:
    """Yield one warning for each material with values that nobody has measured."""
    for material, rows in part.table.groupby("material", sort=False):
        limits = listing(list(dict.fromkeys(limit for limit in rows["limit"] if limit)))
        by_note: dict[str, list[str]] = {}
        for row in rows[rows["limit"] == ""].to_dict("records"):
            by_note.setdefault(row["note"], []).append(row["value"].replace("_", " "))
        notes = "; ".join(f"{listing(values)}: {note}" for note, values in by_note.items())
        yield Caution("guessed", 1, 1, f"{material}: {'; '.join(text for text in (limits, notes) if text)}", what)
