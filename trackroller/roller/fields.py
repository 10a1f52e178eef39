"""Fields of a case: their names, and what a single value becomes."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from trackroller.contact import friction_laws, profiles
from trackroller.errors import InputError
from trackroller.numerics.numbers import read_number
from trackroller.parameters import MAPPING_FIELDS, MATERIAL_FIELDS, PARAMETERS
from trackroller.roller.point_files import read_points

FIELDS = (*PARAMETERS, *MATERIAL_FIELDS, *MAPPING_FIELDS)


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
            raise InputError(name, value, "a mapping, or one written as JSON") from None
    if not isinstance(value, Mapping):
        raise InputError(name, value, "a mapping, or not given")
    told = (
        friction_laws.canonical(value, name) if name == "friction_law" else profiles.canonical(value, name, read_points)
    )
    return json.dumps(told, sort_keys=True) if told else ""


def number(name: str, value: Any) -> float:
    """Return a number of a case as a float, NaN if it may be missing and is; raises `InputError` if it is none."""
    parameter = PARAMETERS[name]
    if value is None and parameter.allow_missing:
        return math.nan
    if isinstance(value, float) and math.isnan(value):  # the caller knows whether it may be missing
        return math.nan
    try:
        return read_number(value)
    except ValueError:
        raise InputError(name, value, parameter.allowed()) from None


class Default(float):
    """The value of a number that was not given."""


def own_friction(law: Any) -> float:
    """Friction at rest of a case that gives none: the first value of a table, otherwise the default."""
    own = friction_laws.at_rest(law) if law else None
    return PARAMETERS["friction_coefficient"].default if own is None else own


def own_frictions(laws: np.ndarray) -> np.ndarray:
    """Return the friction coefficients [1] of cases that give none, from their friction laws, both of shape (n,)."""
    known = {repr(law): own_friction(law) for law in np.ravel(laws)}
    return np.array([known[repr(law)] for law in np.ravel(laws)]).reshape(np.shape(laws))
