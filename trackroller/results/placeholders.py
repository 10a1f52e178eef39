"""Values of materials that nobody has measured, on which the limits of a result rest: a table and
warnings.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from trackroller.damage import LIMITS
from trackroller.errors import listing
from trackroller.results.answer import Caution, Column, FurtherTable, yes_or_blank
from trackroller.roller.limit_notes import placeholders_of

POLYMER = 20e3  # MPa; a material with a lower Young's modulus is treated as a polymer
COLUMNS = (
    Column("material", "Material", "", "material of the value", "text", role="name"),
    Column("value", "Value", "", "name of the value in config/materials.yaml", "text", role="name"),
    Column("limit", "Limit", "", "limit that rests on it", "text"),
    Column("low", "Expected", "", "range in which the value is expected", until="high"),
    Column("units", "Unit", "", "unit of the range", "text"),
    Column("guessed", "Guess", "", "whether the value has no source", "text"),
    Column("note", "Note", "", "what the database says of the value", "text"),
)


def placeholders_part(ds: xr.Dataset) -> FurtherTable:
    """Return the placeholders of the materials of a result, and what the database says against
    other values.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of one case, of a spectrum, or of a roller that wears.
    """
    rows = [
        _row(
            one.material,
            one.name,
            "yes",
            one.note,
            LIMITS[one.limit].word,
            one.low,
            one.high,
            one.units,
        )
        for one in placeholders_of(ds)
    ]
    stored = json.loads(str(ds.attrs.get("materials", "{}")))
    rows += [row for values in stored.values() for row in _notes(values)]
    table = pd.DataFrame(
        rows, columns=[name for one in COLUMNS for name in (one.name, one.until) if name]
    )
    return FurtherTable(
        "placeholders",
        "Values that nobody has measured",
        table.drop_duplicates(ignore_index=True),
        COLUMNS,
    )


def _row(
    material: str,
    value: str,
    guessed: str,
    note: str,
    limit: str = "",
    low: float = np.nan,
    high: float = np.nan,
    units: str = "",
) -> dict[str, Any]:
    return {
        "material": material,
        "value": value,
        "limit": limit,
        "low": low,
        "high": high,
        "units": units,
        "guessed": guessed,
        "note": note,
    }


def _notes(values: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield what the database says against the values of one material, a row each, and what
    polymers need.
    """
    name = str(values.get("name", ""))
    notes = values.get("notes", {})
    guesses = [str(one) for one in values.get("guesses", ())]
    for key in dict.fromkeys((*notes, *guesses)):
        yield _row(name, key, yes_or_blank(key in guesses), notes.get(key, ""))
    if _is_polymer(values):
        note = "values of a polymer depend on temperature and moisture: give those in use"
        yield _row(name, "stiffness, strength, friction", "", note)


def _is_polymer(values: dict[str, Any]) -> bool:
    modulus = values.get("youngs_modulus")
    return modulus is not None and float(modulus) < POLYMER


def guess_cautions(part: FurtherTable, what: str = "") -> Iterator[Caution]:
    """Yield one warning for each material in the table: how many guesses it has, limits on them,
    and whether notes.
    """
    for material, rows in part.table.groupby("material", sort=False):
        guesses = rows[rows["guessed"] == "yes"]
        texts = []
        number = guesses["value"].nunique()
        if number:
            if number == 1:
                count_words = "1 value"
            else:
                count_words = f"{number} values"
            texts.append(count_words)
        limits = list(dict.fromkeys(limit for limit in guesses["limit"] if limit))
        if limits:
            verb = "rest"
            if len(limits) == 1:
                verb = "rests"
            pronoun = "them"
            if number == 1:
                pronoun = "it"
            texts.append(f"{listing(limits)} {verb} on {pronoun}")
        if len(guesses) < len(rows):
            texts.append("see its notes")
        yield Caution("guessed", 1, 1, f"{material}: {'; '.join(texts)}", what)
