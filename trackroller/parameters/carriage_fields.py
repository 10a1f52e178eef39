"""Declare the fields of a carriage that a study can vary, with the unit in which it states them.

`carriage_speed` is the speed in each load case that states one, and `carriage_speed_in_curve` that of the load case
`curve`. `carriage_x_of_FL` is a coordinate of the roller `FL`.
"""

from __future__ import annotations

import math
import re

from trackroller.numerics.parameter import Parameter
from trackroller.parameters.numbers import PARAMETERS
from trackroller.parameters.sizes import SIZES

PREFIX = "carriage_"
AXES = ("x", "y", "z")
_SMALL = 1e-9
LABELS = {"mass": "mass of the carriage"} | {  # where the name says too little
    f"{part}{axis}": f"{words} {axis}"
    for part, words in (
        ("mass_", "centre of the carriage in"),
        ("payload_", "centre of the payload in"),
        ("drive_", "drive in"),
        ("", "place of the roller in"),
    )
    for axis in AXES
}


def _field(name: str, unit: str, meaning: str, role: str = "choice", **further: object) -> Parameter:
    label = LABELS.get(name, name.replace("_", " "))
    return Parameter(PREFIX + name, "", unit, math.nan, meaning, label=label, role=role, **further)  # type: ignore[arg-type]


OF_LOAD_CASE = {  # fields of each load case
    field.name: field
    for field in (
        _field("speed", "m/s", "speed in the load cases that state one", "condition", lower=_SMALL),
        _field("acceleration", "m/s2", "acceleration in the load cases that state one", "condition"),
        _field(
            "curve_radius",
            "mm",
            "radius of the curves, > 0 to the left; inf is a straight",
            "condition",
            allow_infinite=True,
            nonzero=True,
        ),
        _field("gradient", "deg", "slope in the load cases that state one", "condition", lower=-90.0, upper=90.0),
        _field("cant", "deg", "lateral tilt in the load cases that state one", "condition", lower=-90.0, upper=90.0),
    )
}
OF_ROLLER = {  # coordinates of one roller
    field.name: field for field in (_field(axis, "mm", f"coordinate {axis} of a roller") for axis in AXES)
}
OF_WHOLE = {  # fields of the whole carriage
    field.name: field
    for field in (
        _field("wheelbase", "mm", "distance along x of the foremost and the rearmost roller", lower=_SMALL),
        _field("gauge", "mm", "distance along y of the outermost rollers", lower=_SMALL),
        _field("mass", "kg", "mass of the carriage without payload", lower=0.0),
        *(_field(f"mass_{axis}", "mm", f"coordinate {axis} of this mass") for axis in AXES),
        _field("payload", "kg", "mass of all payloads together", "condition", lower=0.0),
        *(
            _field(f"payload_{axis}", "mm", f"coordinate {axis} of the common centre of the payloads", "condition")
            for axis in AXES
        ),
        *(_field(f"drive_{axis}", "mm", f"coordinate {axis} of the point at which the drive pulls") for axis in AXES),
        _field("preload", "N", "force between the rollers of each pair with preload", lower=0.0),
        _field("play", "mm", "play of each pair with play", lower=0.0),
    )
}


def word_of(name: str) -> str:
    """Return a name of a load case or roller as a field has it: letters, digits and '_'."""
    return re.sub(r"\W", "_", name)


def split_field(name: str) -> tuple[str, str] | None:
    """Return the name of a field of a carriage and the load case or roller that it names, '' for none.

    Returns None for a name that is no field.
    """
    if name in OF_WHOLE or name in OF_LOAD_CASE:
        return name, ""
    for joint, fields in (("_in_", OF_LOAD_CASE), ("_of_", OF_ROLLER)):
        head, _, place = name.partition(joint)
        if place and head in fields:
            return head, place
    return None


def field_of(name: str) -> Parameter | None:
    """Return the declaration of a field of a carriage, None for any other name."""
    parts = split_field(name)
    if parts is None:
        return None
    return (OF_WHOLE | OF_LOAD_CASE | OF_ROLLER)[parts[0]]


def parameter_of(name: str) -> Parameter | None:
    """Return the declaration of a parameter or size of the roller or of a field of a carriage; None for other names."""
    return PARAMETERS.get(name) or SIZES.get(name) or field_of(name)


def long_name_of(name: str) -> str:
    """Return the name of a factor for figures and reports, in which a load case or roller is named."""
    known = parameter_of(name)
    place = (split_field(name) or ("", ""))[1]
    if known is None:
        return name.replace("_", " ")
    if place:
        return f"{known.long_name}, {place}"
    return known.long_name
