"""The paper's example: values of parameters that a case or a study does not name."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from trackroller.parameters.numbers import OF_LIMITS, PARAMETERS


class Default(float):
    """A number of the example, which `Case` can distinguish from a number that the user gave."""


class DefaultName(str):
    """The material of the example, which `Case` can distinguish from a name that the user gave."""


EXAMPLE: dict[str, Any] = {
    name: Default(p.default) for name, p in PARAMETERS.items() if not math.isnan(p.default)
} | dict.fromkeys(("roller_material", "guide_material"), DefaultName("1.7225-normalised"))
# A free roller that lives long, with which the live page and the README begin; the paper's lives
# for hours.
LASTING: dict[str, Any] = {
    "motor_force": 0.0,
    "friction_coefficient": 0.1,
    "roller_profile_radius": -6.4,
    **dict.fromkeys(("roller_material", "guide_material"), "1.7225-quenched-tempered"),
}
_ABSENT = ("layer_flexibility",)  # parameters whose 0 means that there is none of it
_PAIR = ("material_pair", "roller_material", "guide_material")


def not_given(named: Iterable[str]) -> dict[str, Any]:
    """Return the values that are used for the parameters that a file does not name, as plain
    numbers and names.

    Parameters
    ----------
    named : iterable of str
        Parameters that the file names; `material_pair` stands for both materials.
    """
    named = set(named)
    if "material_pair" in named:
        named |= set(_PAIR)
    values: dict[str, Any] = {}
    for name, value in EXAMPLE.items():
        if name in named:
            continue
        if isinstance(value, str):
            values[name] = str(value)
        else:
            values[name] = float(value)
    return values


def used_of(values: Mapping[str, Any], names: Iterable[str]) -> dict[str, Any]:
    """Return the values of parameters that were not given, without the radius that a drawn profile
    replaces.

    Parameters
    ----------
    values : mapping
        Values by name; a factor of a study stands for itself.
    names : iterable of str
        Parameters that were not given.
    """
    profile = values.get("roller_profile")
    if isinstance(profile, Mapping):
        levels = profile.get("values", [profile])
    else:
        levels = getattr(profile, "levels", [profile])
    replaced = ""
    if all(levels):
        replaced = "roller_profile_radius"
    return {
        name: values[name]
        for name in names
        if name != replaced and not is_absent(name, values[name])
    }


def is_absent(name: str, value: Any) -> bool:
    """Return whether a value means that there is none of what a parameter describes, so that nobody
    has to be told.

    Parameters
    ----------
    name : str
        Name of a parameter.
    value : number or array
        Its value, or its values in several cases.

    Examples
    --------
    >>> is_absent("layer_flexibility", 0.0), is_absent("motor_force", 0.0)
    (True, False)
    """
    return name in _ABSENT and not np.any(value)


def with_unit(name: str, value: Any) -> str:
    """Return a parameter with its value and unit, such as 'motor_force -30 N'."""
    unit = "-"
    if name in PARAMETERS:
        unit = PARAMETERS[name].unit
    if isinstance(value, (int, float)):
        shown = f"{value:g}"
    else:
        shown = str(value)
    return f"{name} {shown}" + ("" if unit == "-" else f" {unit}")


def not_given_text(values: Mapping[str, Any]) -> str:
    """Return what was not given as one sentence, '' if every parameter was given; see
    `not_given`.
    """
    parts = [
        (
            head,
            ", ".join(
                with_unit(name, value)
                for name, value in values.items()
                if (name in OF_LIMITS) is other
            ),
        )
        for head, other in (("taken from the paper's example", False), ("default", True))
    ]
    notes = "; ".join(f"{head}: {text}" for head, text in parts if text)
    return f"not given, {notes}" if notes else ""


def drive_question(values: Mapping[str, Any], named: Iterable[str]) -> str:
    """Return a question about the drive for a file that names other parameters but no drive,
    otherwise ''.

    Parameters
    ----------
    values : mapping
        Parameters that are not given, see `not_given`.
    named : iterable of str
        Parameters that the file names.
    """
    if "motor_force" not in values or not set(named):
        return ""
    return (
        f"Is the roller driven? motor_force is not given, so {values['motor_force']:g} N is used, "
        "as in the paper's "
        "example: write motor_force: 0 for a free roller, a number < 0 for a driven one and > 0 "
        "for a braked one."
    )
