"""A sizing in words: which roller to take, and the heads and cells of its tables."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from trackroller.numerics.units import PLAIN
from trackroller.parameters import PARAMETERS
from trackroller.parameters.example import not_given_text
from trackroller.study.design.factor_names import SIZES
from trackroller.study.file.shelf import ROLLER

if TYPE_CHECKING:
    from trackroller.results.size import Sizing

# what a ratio of the table of rollers counts
RATIOS = {
    "life_ratio": "times the required life",
    "temperature_ratio": "times its temperature rise is permitted",
    "wear_ratio": "times the required life to the wear depth",
}
# how near the best roller comes where none is enough
NEAREST = {
    "life_ratio": "{} lasts {:.3g} times the required life",
    "temperature_ratio": "{} warms by {:.3g} times the permitted rise",
    "wear_ratio": "{} wears off the depth after {:.3g} times the required life",
}
OWN_UNITS = {"life_hours": "h"}  # of columns that a sizing adds


def lead_of(sizing: Sizing) -> str:
    """Return which roller to take, in one sentence."""
    if not sizing.least:
        return _none_is_enough(sizing)
    row = sizing.table.set_index(ROLLER).loc[sizing.least].to_dict()
    parts = _reached(sizing, row)
    number = int((sizing.table["verdict"] == "enough").sum())
    leads = "has the largest load ratio"
    if sizing.least_of:
        leads = "is the least"
    elif "life_hours" in row:
        leads = "lasts longest"
    of = f"of {number} that are enough"
    if number == 1:
        leads = "alone is enough"
        of = ""
    return f"{sizing.least} {leads} {of}".rstrip() + f": {', '.join(parts)}."


def _none_is_enough(sizing: Sizing) -> str:
    """Return that no roller is enough, with the nearest one to each requirement that none meets."""
    table = sizing.table.set_index(ROLLER)
    parts = []
    for column, words in NEAREST.items():
        if column in table and (table[column] < 1.0).all() and table[column].max() > 0.0:
            ratio = float(table[column].max())
            if column == "temperature_ratio":
                ratio = 1.0 / ratio
            parts.append(words.format(table[column].idxmax(), ratio))
    if "overload" in table and (table["overload"] != "held").all():
        ratios = table["load_ratio"].fillna(0.0)
        best = str(ratios.idxmax())
        ends = dict(zip(map(str, table.index), table["load_ends"], strict=True))[best]
        if ends:
            parts.append(f"{best} reaches {ends} at {ratios.max():.3g} times the forces")
    if not parts:
        return "No roller of the shelf is surely enough."
    return f"No roller of the shelf is surely enough; the nearest: {'; '.join(parts)}."


def _reached(sizing: Sizing, row: Mapping[Any, Any]) -> list[str]:
    """Return what a roller reaches of what is required, and a second model that says otherwise."""
    parts = []
    if sizing.least_of:
        parts.append(f"{sizing.least_of} {row[sizing.least_of]:g}")
    for name, words in RATIOS.items():
        if math.isfinite(row.get(name, math.nan)):
            parts.append(f"{row[name]:.3g} {words}")
    if "overload" in row:
        parts.append("within all limits at the forces times the safety")
    if math.isfinite(row.get("load_ratio", math.nan)):
        parts.append(f"{row['load_ends']} at {row['load_ratio']:.3g} times the forces")
    if row.get("second_model"):
        parts.append(f"but the {row['second_model']}")
    return parts


def notes_of(sizing: Sizing) -> list[str]:
    """Return a sentence on rollers that may be enough and less, on those without a rank, and on
    values that nobody gave.
    """
    notes = []
    if sizing.open_and_less:
        names = ", ".join(sizing.open_and_less)
        notes.append(f"open, and less: {names}. A finer accuracy or better values decide")
    if sizing.unranked:
        names = ", ".join(sizing.unranked)
        notes.append(f"{names}: no {sizing.least_of}, and so not ranked by it")
    if sizing.not_given:
        notes.append(not_given_text(sizing.not_given))
    return notes


def head_of(name: str, units: Mapping[str, str]) -> str:
    """Return the head of a column with its unit; `units` holds those of the user's own columns."""
    unit = units.get(name, OWN_UNITS.get(name, ""))
    if name in PARAMETERS:
        unit = PARAMETERS[name].unit
    elif name in SIZES:
        unit = "mm"
    if unit in PLAIN:
        return name
    return f"{name} [{unit}]"


def shown(value: Any) -> str:
    """Return a value of the table of rollers as text."""
    if isinstance(value, float):
        if math.isnan(value):
            return "–"
        if math.isinf(value):
            return "any"
        return f"{float(f'{value:.4g}'):,.10g}"
    return str(value) or "–"
