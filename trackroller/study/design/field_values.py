"""Check values of the fields of a case and of options."""

from __future__ import annotations

import math
from collections.abc import Collection
from typing import Any

from trackroller.contact.friction_laws import at_rest
from trackroller.damage.own import unknown_field
from trackroller.errors import InputError, unknown_name
from trackroller.numerics.numbers import number_or_nan
from trackroller.numerics.parameter import Parameter
from trackroller.parameters import MAPPING_FIELDS, MATERIAL_FIELDS, OPTIONS, PARAMETERS
from trackroller.roller.aliases import ALIASES, RADII
from trackroller.roller.fields import mapping_text
from trackroller.study.design.factor_names import CASE_FIELDS, OPTION_FACTORS


def choice(value: Any, where: str, options: Collection[str]) -> str:
    """Check that a value is one of the options.

    Parameters
    ----------
    value : the value
    where : name of the study key
    options : allowed words

    Returns
    -------
    The value.

    Raises
    ------
    InputError : with the nearest option
    """
    if not isinstance(value, str) or value not in options:
        raise unknown_name(where, value, options)
    return value


def base_value(key: Any, value: Any, section: str = "base") -> Any:
    """Check a value of the base case.

    Parameters
    ----------
    key : name of the case field
    value : its value
    section : name of the study key that holds the values

    Returns
    -------
    The value in the type of its field.

    Raises
    ------
    InputError : unknown field, or a value outside its bounds
    """
    known = (*CASE_FIELDS, "material_pair")
    if key in (*OPTIONS, "duty"):
        remedy = f"Write {key}: {value} on a line of its own that is not indented."
        raise InputError(
            f"{section}.{key}", value, "parameters of the roller", remedy, "is a key of the study"
        )
    if key not in known:
        raise unknown_field(section, str(key), (*known, *ALIASES, *RADII), OPTIONS)
    return field_value(key, value, f"{section}.{key}")


def field_value(key: str, value: Any, where: str) -> Any:
    """Return the value of a case field or of an option in the type of its field."""
    if key == "material_pair":
        if not isinstance(value, (list, tuple)) or len(value) != 2:
            raise InputError(where, value, "a pair [roller material, guide material]")
        return [_material_name(name, where) for name in value]
    if key in OPTION_FACTORS:
        return choice(value, where, OPTION_FACTORS[key])
    if key in MATERIAL_FIELDS:
        return _material_name(value, where)
    if key in MAPPING_FIELDS:
        return _mapping(key, value, where)
    return parameter_value(PARAMETERS[key], value, where)


def _material_name(value: Any, where: str) -> str:
    if not isinstance(value, str) or not value:
        raise InputError(
            where,
            value,
            "the name of a material in the database",
            "Add your own material with `trackroller materials add`.",
        )
    return value


def _mapping(name: str, value: Any, where: str) -> str:
    """Return a friction law or profile as its canonical text."""
    try:
        text = mapping_text(name, value)
        if name == "friction_law" and not text:
            _refuse_constant_law(value)
        return text
    except InputError as exc:
        if exc.field.startswith(name):
            field = exc.field.replace(name, where, 1)
        else:
            field = f"{where}: {exc.field}"
        raise exc.named(field) from None


def _refuse_constant_law(value: Any) -> None:
    """Refuse a table of friction with one value, which `friction_coefficient` states."""
    friction = at_rest(value)
    if friction is not None:
        allowed = "a table whose friction changes with the slip speed"
        remedy = f"Remove the law and give friction_coefficient: {friction:g}."
        raise InputError("friction_law", "a table of one value", allowed, remedy)


def parameter_value(parameter: Parameter, value: Any, where: str) -> Any:
    """Return a value of a parameter as a float, a friction level or None.

    Raises
    ------
    InputError
        If it is no number, or one that the parameter does not allow.
    """
    if value is None and parameter.allow_missing:
        return None
    if isinstance(value, str) and value in parameter.words:
        return value
    number = number_or_nan(value, parameter.unit, where)
    if math.isnan(number) or not parameter.accepts(number):
        remedy = parameter.remedy(number, value)
        if isinstance(value, list):
            remedy = (
                f"Give several values under factors: {{{parameter.name}: {{values: {value}}}}}."
            )
        raise InputError(where, value, parameter.allowed(), remedy)
    return number
