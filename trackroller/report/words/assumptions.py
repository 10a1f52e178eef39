"""What a sheet rests on: assumptions, standards, friction from the database, and the database's own
warnings.
"""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from trackroller.damage import LIMITS, first_limit
from trackroller.materials import Material
from trackroller.materials.properties import PROPERTIES
from trackroller.report.numbers import capital, listing, number, plain, unit_text
from trackroller.report.tables.inputs import friction_source
from trackroller.roller.stored_inputs import friction_records

ALWAYS = (
    "Dry contact: no lubricant and no dirt.",
    "Isothermal: no value of a material and no friction changes with temperature, and nothing "
    "expands.",
    "Smooth surfaces, elastic half-spaces, steady rolling and constant loads; no shocks and "
    "no vibration.",
    "Pressure limit: R_m stands for the yield strength.",
)
NO_WEAR = "No wear: the profiles stay as given."


def assumptions(ds: xr.Dataset) -> list[str]:
    """Return the assumptions of a solved case, those of the limits that were computed among
    them.
    """
    if "run_in_distance" in ds:
        wear = LIMITS["wear"].assumes
    else:
        wear = (NO_WEAR,)
    others = (
        sentence for name in _computed(ds) if name != "wear" for sentence in LIMITS[name].assumes
    )
    return [*ALWAYS, *wear, *others]


def standards(ds: xr.Dataset) -> str:
    """Return the standards that the computed limits follow, in one sentence."""
    standards = [
        f"{LIMITS[name].standard} ({name})" for name in _computed(ds) if LIMITS[name].standard
    ]
    if standards:
        return f"{capital('; '.join(standards))}."
    return "No standard is followed."


def _computed(ds: xr.Dataset) -> list[str]:
    """Return the limits that have a utilisation or a life; those of the output `life` without
    the checked limits too.
    """
    if "utilisation" not in ds:
        if "life_cycles" in ds:
            return ["fatigue"]
        return []
    known = ds.variables["utilisation"].notnull() | ds.variables["life_hours_by_limit"].notnull()
    if first_limit.AT_MOST in ds:
        known = known | ds.variables[first_limit.AT_MOST].notnull()
    return (
        ds["limit"].values[known.any([dim for dim in known.dims if dim != "limit"]).values].tolist()
    )


def friction_sentence(ds: xr.Dataset) -> str:
    """Say which entry of the database the friction coefficient is; an empty text if the case gives
    the number.
    """
    sentences = [
        f"Friction coefficient {number(r['value'])}: {r['level']} value of the database for "
        f"{r['material_pair']}, source: {friction_source(r)}."
        for r in friction_records(ds.attrs)
    ]
    return " ".join(sentences)


def strength_sentences(materials: Mapping[str, Material]) -> list[str]:
    """Say for each material which values stand for its yield strength."""
    out = []
    for material in dict.fromkeys(materials.values()):
        given = [
            f"{plain(name)} {number(value)} {unit_text(PROPERTIES[name].unit)}"
            for name in ("yield_strength", "hardness")
            if (value := getattr(material, name)) is not None
        ]
        yields = "neither yield strength nor hardness"
        if given:
            yields = f"shakedown and standard rating use {listing(given)}"
        out.append(
            f"{material.name}: {yields}; the pressure limit uses R_m = "
            f"{number(material.tensile_strength)} MPa."
        )
    return out
