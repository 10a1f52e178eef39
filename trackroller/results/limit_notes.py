"""The notes on limits of a result: what a limit lacks, and the placeholders of materials that it rests on."""

from __future__ import annotations

import xarray as xr

from trackroller.roller.dataset import NOTES

GUESSES = ": placeholders of material"  # in a note on a limit that rests on values without a source


def notes_of(ds: xr.Dataset) -> list[str]:
    """Return the notes on limits, a sentence each."""
    return [note for note in str(ds.attrs.get(NOTES, "")).split("\n") if note]


def guessed_values(ds: xr.Dataset) -> list[tuple[str, str, str]]:
    """Return the limits that rest on placeholders of a material: limit, material, and its values with their ranges."""
    parted = [note.partition(GUESSES) for note in notes_of(ds)]
    parts = [(limit, *rest.strip(" .").partition(": ")) for limit, found, rest in parted if found]
    return [(limit, material, values) for limit, material, _, values in parts]
