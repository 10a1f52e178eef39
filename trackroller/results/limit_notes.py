"""The notes on limits of a result: what a limit lacks, and the placeholders of materials that it rests on."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass

import numpy as np
import xarray as xr

from trackroller.roller.dataset import NOTES

GUESSES = ": placeholders of material"  # in a note on a limit that rests on values without a source
OF_SN_LINE = (
    *("fatigue_limit", "fatigue_strength_ratio", "cycles_at_fatigue_limit", "cycles_at_tensile_strength"),
    *("woehler_exponent", "second_exponent"),
)
# each value in such a note, see `trackroller.roller.stages.outcome.notes_on_limits`
_VALUE = re.compile(
    r"(?P<name>\w+) \((?:on (?P<on>[^,]+), )?[^()]*?"
    r"(?:expected from (?P<low>\S+) to (?P<high>[^\s)]+)(?: (?P<units>.+?))?|no range is given)\)(?=, \w+ \(|$)"
)


@dataclass(frozen=True)
class Placeholder:
    """A value of a material without a source, on which a limit rests.

    Attributes
    ----------
    limit, material, name : str
        Name of the limit, of the material, and of its value.
    on : str
        Material that it runs on, if the value is that of a pair.
    low, high : float
        Range in which the value is expected; NaN if no range is given.
    units : str
        Unit of the range.
    """

    limit: str
    material: str
    name: str
    on: str = ""
    low: float = np.nan
    high: float = np.nan
    units: str = ""


def notes_of(ds: xr.Dataset) -> list[str]:
    """Return the notes on limits, a sentence each."""
    return [note for note in str(ds.attrs.get(NOTES, "")).split("\n") if note]


def guessed_values(ds: xr.Dataset) -> list[tuple[str, str, str]]:
    """Return the limits that rest on placeholders of a material: limit, material, and its values with their ranges."""
    parted = [note.partition(GUESSES) for note in notes_of(ds)]
    parts = [(limit, *rest.strip(" .").partition(": ")) for limit, found, rest in parted if found]
    return [(limit, material, values) for limit, material, _, values in parts]


def placeholders_of(ds: xr.Dataset) -> list[Placeholder]:
    """Return the placeholders of materials on which the limits of a result rest."""
    out = []
    for limit, material, text in guessed_values(ds):
        for one in _VALUE.finditer(text):
            low, high = (float(one[end]) if one[end] else np.nan for end in ("low", "high"))
            named = limit, material.strip("'"), one["name"], one["on"] or ""
            out.append(Placeholder(*named, low, high, one["units"] or ""))
    return out


def guessed_lines(ds: xr.Dataset) -> dict[str, list[str]]:
    """Return the materials whose S-N line rests on guesses without a source, with the names of these values.

    Such values have no range, so that a life by fatigue stays one number, and the notes on limits do not name them.
    """
    stored = json.loads(str(ds.attrs.get("materials", "{}")))
    own = {name: [n for n in values.get("guesses", ()) if n in OF_SN_LINE] for name, values in stored.items()}
    return {name: guesses for name, guesses in own.items() if guesses}
