"""What the page offers: every parameter with a range for its slider, the materials, the options and the designs."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from trackroller.materials import load_database
from trackroller.materials.tables import material_rows
from trackroller.parameters import (
    MAPPING_FIELDS,
    MATERIAL_FIELDS,
    OF_LIMITS,
    OPTIONS,
    PARAMETERS,
    Parameter,
)
from trackroller.parameters.example import LASTING
from trackroller.report.numbers import capital, unit_text
from trackroller.roller.doubts import USUAL
from trackroller.study.design.sampling import METHODS

SPAN = 4.0  # a slider goes from a quarter of the example's value to four times this value
NO_OPTIONS = ("outputs", "accuracy", "stop_if", "shortcuts")  # the page decides on them
WIDEST = 100.0  # bounds that are farther apart say what the solver takes, not what rollers have
GROUPS = {"condition": "Loads and use", "choice": "Roller and guide"}


def all_fields() -> dict[str, Any]:
    """Return what the page offers, as values of JSON; a parameter or option that is declared appears by itself."""
    return {
        "parameters": [_parameter(parameter) for parameter in PARAMETERS.values()],
        "materials": [_material(row) for row in material_rows(load_database())],
        "bodies": list(MATERIAL_FIELDS),
        "first": {name: value if isinstance(value, str) else f"{value:g}" for name, value in LASTING.items()},
        "files": sorted(path.as_posix() for pattern in ("*.csv", "*/*.csv") for path in Path().glob(pattern)),
        "mappings": [{"name": name, "meaning": meaning} for name, meaning in MAPPING_FIELDS.items()],
        "options": [
            {"name": o.name, "value": o.default, "meaning": o.meaning, "values": dict(o.values), "kind": o.kind}
            for o in OPTIONS.values()
            if o.name not in NO_OPTIONS
        ],
        "outputs": dict(OPTIONS["outputs"].values),
        "accuracies": dict(OPTIONS["accuracy"].values),
        "designs": list(METHODS),
    }


def _parameter(parameter: Parameter) -> dict[str, Any]:
    """Return a parameter with its group on the page and the ends of its slider."""
    ends = slider(parameter)
    return {
        "name": parameter.name,
        "label": capital(parameter.long_name),
        "symbol": parameter.symbol,
        "unit": unit_text(parameter.unit).replace("–", ""),
        "meaning": parameter.meaning,
        "allowed": parameter.allowed(),
        "group": "Limits" if parameter.name in OF_LIMITS else GROUPS[parameter.role],
        "role": parameter.role,
        "value": None if math.isnan(parameter.default) else parameter.default,
        "ends": ends,
        "infinite": parameter.allow_infinite,
        "optional": parameter.allow_missing,
    }


def slider(parameter: Parameter) -> tuple[float, float] | None:
    """Return the ends of the slider of a parameter.

    Parameters
    ----------
    parameter : Parameter
        The parameter.

    Returns
    -------
    tuple of float or None
        Its usual values if its bounds are close together. Otherwise a quarter of the example's value and four times
        this value, or both signs of the latter for a number that may have either sign. None without an
        example other than 0.

    Examples
    --------
    >>> slider(PARAMETERS["contact_angle"]), slider(PARAMETERS["axial_force"])
    ((5.0, 85.0), (-120.0, 120.0))
    """
    example = parameter.default
    if math.isnan(example) or example == 0.0:
        return None
    if parameter.upper - parameter.lower <= WIDEST:
        return USUAL.get(parameter.name, (parameter.lower, parameter.upper))
    if parameter.lower < 0 < parameter.upper and not parameter.nonzero:
        return -SPAN * abs(example), SPAN * abs(example)
    low, high = sorted((example / SPAN, example * SPAN))
    return low, high


def _material(row: dict[str, str]) -> dict[str, str]:
    words = [value for key, value in row.items() if key not in ("name", "origin", "placeholders")]
    facts = ", ".join(f"{key} {value}" for key, value in row.items() if "[" in key)
    return {"name": row["name"], "facts": facts, "search": " ".join([row["name"], *words]).lower()}
