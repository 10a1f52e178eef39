"""Name the fields of a case and convert single values of them."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from trackroller.contact import friction_laws, profiles
from trackroller.damage import LIMITS
from trackroller.damage.stud import FIELD as STUD
from trackroller.damage.stud import MATERIAL, OF_MATERIAL
from trackroller.errors import InputError
from trackroller.materials import load_database
from trackroller.numerics.numbers import number_or_nan
from trackroller.numerics.rows import once_each
from trackroller.parameters import MAPPING_FIELDS, MATERIAL_FIELDS, PARAMETERS
from trackroller.parameters.example import EXAMPLE
from trackroller.roller.point_files import read_points

FIELDS = (*PARAMETERS, *MATERIAL_FIELDS, *MAPPING_FIELDS)
# key of a mapping by which tables and headlines call it, and its length
NAME, LONGEST_NAME = "name", 40
_OF_LIMITS = {own.name: own for limit in LIMITS.values() for own in limit.mappings}


def other_than_default(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return those values of a case that are given, and are not the default of their parameter."""
    usual = {name: parameter.default for name, parameter in PARAMETERS.items()}
    return {
        name: value
        for name, value in values.items()
        if value is not None and value != usual.get(name)
    }


def mapping_text(name: str, value: Any) -> str:
    """Return the canonical JSON of a field that is a mapping.

    Parameters
    ----------
    name : str
        One of `MAPPING_FIELDS`.
    value : mapping, str or None
        The mapping, or its JSON text.

    Returns
    -------
    str
        JSON with sorted keys; "" for None.

    Raises
    ------
    InputError
        If the value is no mapping, or not one that the field allows.
    """
    if value is None or (isinstance(value, str) and not value.strip()):
        return ""
    if isinstance(value, str):
        try:
            value = json.loads(value)
        except ValueError:
            remedy = ""
            if name.endswith("_profile"):
                remedy = f"Write {name}: {{file: {value}}} for a file of points."
            raise InputError(name, value, "a mapping, or one written as JSON", remedy) from None
    if not isinstance(value, Mapping):
        raise InputError(name, value, "a mapping, or not given")
    if name == "friction_law":
        mapping = friction_laws.canonical(value, name)
    elif name in _OF_LIMITS:
        mapping = _with_name(name, value)
    else:
        mapping = profiles.canonical(value, name, read_points)
    if mapping:
        return json.dumps(mapping, sort_keys=True)
    return ""


def _with_name(field: str, value: Mapping[str, Any]) -> dict[str, Any]:
    """Return the checked mapping of a limit, with the name by which tables call it where one is
    given.
    """
    given = {key: own for key, own in value.items() if key != NAME}
    if field == STUD.name:
        given = _with_material(given)
    mapping = _OF_LIMITS[field].canonical(given)
    own = value.get(NAME)
    if own is None:
        return mapping
    if not isinstance(own, str) or not own.strip() or len(own) > LONGEST_NAME:
        allowed = f"a text of at most {LONGEST_NAME} signs"
        raise InputError(f"{field}.{NAME}", own, allowed, "For example name: NSK-6000.")
    return mapping | {NAME: own.strip()}


def _with_material(given: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of a stud with those of its material where the user gives none.

    A value of the database that has no source is left out, so that no stud rests on a guess. The
    values stand in the case from then on, whatever becomes of the database.
    """
    name = given.get(MATERIAL)
    lacking = [key for key in OF_MATERIAL if given.get(key) is None]
    if not isinstance(name, str) or not lacking:
        return dict(given)
    material = load_database().material(name, f"{STUD.name}.{MATERIAL}")
    if material.sn_points:  # a line by points has no cycles at the tensile strength
        lacking = [key for key in lacking if key != "cycles_at_tensile_strength"]
    out = dict(given)
    for key in lacking:
        value = getattr(material, key)
        record = material.records.get(key)
        if value is None or not math.isfinite(value) or (record is not None and record.placeholder):
            continue
        out[key] = float(value)
    return out


def number(name: str, value: Any) -> float:
    """Return a number of a case as a float; NaN if the user left it out and the parameter allows
    this.

    Parameters
    ----------
    name : str
        Name in `PARAMETERS`.
    value : object
        What the user gave.

    Raises
    ------
    InputError
        If the value is no number.
    """
    parameter = PARAMETERS[name]
    if value is None and parameter.allow_missing:
        return math.nan
    # the caller checks whether the parameter may be left out
    if isinstance(value, float) and math.isnan(value):
        return math.nan
    given = number_or_nan(value, parameter.unit, name)
    if math.isnan(given):
        raise InputError(name, value, parameter.allowed(), parameter.remedy(given, value))
    return given


def own_friction(law: Any) -> float:
    """Return the friction at rest of a case without friction coefficient: that of its law's table,
    or the default.
    """
    own = None
    if isinstance(law, (str, Mapping)) and law:
        own = friction_laws.at_rest(law)
    if own is None:
        return EXAMPLE["friction_coefficient"]
    return own


def own_frictions(laws: np.ndarray) -> np.ndarray:
    """Return `own_friction` of the friction laws of n cases, shape (n,) [1]."""
    return np.array(once_each(own_friction, np.ravel(laws))).reshape(np.shape(laws))
