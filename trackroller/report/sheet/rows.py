"""Rows of a sheet: a quantity in words, its value and its unit."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.parameters import MAPPING_FIELDS, PARAMETERS
from trackroller.report.numbers import level_text, number, rounded, unit_text
from trackroller.roller.record import is_default

if TYPE_CHECKING:
    import xarray as xr

    from trackroller.materials import Material
    from trackroller.roller.limits import Limits


@dataclass(frozen=True)
class Row:
    """A quantity in words with its value, its unit, and whether it is the default of an input."""

    words: str
    value: str
    unit: str = ""
    default: bool = False


def is_told(name: str, value: Any) -> bool:
    """Return whether an input stands on the sheet: mappings and the guide only if they are given."""
    return value is not None or name not in (*MAPPING_FIELDS, "guide_overrollings_per_hour")


def input_row(name: str, value: Any) -> Row:
    """Return an input with its unit; mark the default."""
    if name in PARAMETERS:
        parameter = PARAMETERS[name]
        shown = "not given" if value is None else number(value) if isinstance(value, (int, float)) else str(value)
        words = f"{parameter.long_name} {parameter.symbol}"
        return Row(words, shown, unit_text(parameter.unit).replace("–", ""), is_default(name, value))
    if name in MAPPING_FIELDS:
        shown = level_text(name, value if isinstance(value, str) else json.dumps(value, sort_keys=True))
    else:
        shown = str(value.get("name", "inline")) if isinstance(value, Mapping) else str(value)
    return Row(name.replace("_", " "), shown, "", is_default(name, value))


def material_rows(material: Material) -> list[Row]:
    """Return the values of a material."""
    return [
        Row("name", material.name),
        Row("Young's modulus E", number(material.youngs_modulus), "MPa"),
        Row("Poisson's ratio nu", number(material.poisson_ratio)),
        Row("tensile strength R_m", number(material.tensile_strength), "MPa"),
        Row("fatigue limit sigma_D", number(material.fatigue_limit), "MPa"),
        Row("cycles at the fatigue limit N_k", number(material.cycles_at_fatigue_limit)),
        Row("exponent of the S-N curve k", rounded(material.woehler_exponent)),
    ]


def quantity_rows(ds: xr.Dataset, names: tuple[tuple[str, str], ...]) -> list[Row]:
    """Return the finite ones of some results, each with its unit."""
    return [
        Row(words, number(float(ds[name])), unit_text(ds[name].attrs.get("units", "1")).replace("–", ""))
        for name, words in names
        if name in ds and np.isfinite(float(ds[name]))
    ]


def limit_rows(found: Limits, inputs: Mapping[str, Any]) -> list[Row]:
    """Return the limits of a roller in words."""
    low, high = map(rounded, found.axial_force)
    rows = [Row("lift-off: both contacts carry load for axial forces", f"{low} to {high}", "N")]
    if any(map(math.isnan, found.axial_force)):
        rows = [Row(rows[0].words, "not defined: no state with two loaded contacts was found")]
    if any(map(math.isfinite, found.motor_force)):
        drive, brake = map(rounded, found.motor_force)
        rows.append(Row("full slip: the roller does not skid for motor forces", f"{drive} to {brake}", "N"))
    lock = found.self_locking_friction
    told = f"from {rounded(lock)} (now {number(inputs['friction_coefficient'])})"
    special = "none up to 2" if math.isinf(lock) else "not defined: a contact has lifted"
    return [*rows, Row("self-locking by friction", told if math.isfinite(lock) else special)]
