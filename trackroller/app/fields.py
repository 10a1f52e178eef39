"""What the page offers: every parameter with a range for its slider, the materials, the options and
the designs.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from trackroller.materials import load_database
from trackroller.materials.tables import material_rows
from trackroller.methods import METHODS
from trackroller.parameters import (
    MAPPING_FIELDS,
    MATERIAL_FIELDS,
    OF_LIMITS,
    OPTIONS,
    PARAMETERS,
    Parameter,
)
from trackroller.parameters.example import LASTING
from trackroller.parameters.sizes import SIZES
from trackroller.report.numbers import capital, unit_text
from trackroller.roller.doubts import USUAL

SPAN = 4.0  # a slider goes from a quarter of the example's value to four times this value
WIDEST = 100.0  # bounds that are farther apart say what the solver takes, not what rollers have
GROUPS = {"condition": "Loads and use", "choice": "Roller and guide"}


def all_fields() -> dict[str, Any]:
    """Return what the page offers, as values of JSON; a parameter or option that is declared
    appears by itself.
    """
    return {
        "parameters": [
            _parameter(parameter) for parameter in (*PARAMETERS.values(), *SIZES.values())
        ],
        "materials": material_rows(load_database()),
        "bodies": list(MATERIAL_FIELDS),
        "first": {
            name: value if isinstance(value, str) else f"{value:g}"
            for name, value in LASTING.items()
        },
        "files": sorted(
            p.as_posix()
            for pattern in ("*.csv", "*/*.csv")
            for p in Path().glob(pattern)
            if _is_own(p)
        ),
        "mappings": [
            {"name": name, "meaning": meaning} for name, meaning in MAPPING_FIELDS.items()
        ],
        "options": [
            {
                "name": o.name,
                "value": o.default,
                "meaning": o.meaning,
                "values": o.values,
                "kind": o.kind,
            }
            for o in OPTIONS.values()
        ],
        "designs": list(METHODS),
    }


def _is_own(path: Path) -> bool:
    """Return whether a file lies in this folder, not behind a link, and has a name that a study
    file can hold.
    """
    return path.as_posix().isprintable() and path.resolve().is_relative_to(Path.cwd().resolve())


def _parameter(parameter: Parameter) -> dict[str, Any]:
    """Return a parameter with its group on the page and the ends of its slider."""
    return {
        **{name: getattr(parameter, name) for name in ("name", "symbol", "meaning", "role")},
        "label": capital(parameter.long_name),
        "unit": unit_text(parameter.unit).replace("–", ""),
        "allowed": parameter.allowed(),
        "group": _group(parameter),
        "value": None if math.isnan(parameter.default) else parameter.default,
        "ends": slider(parameter),
        "infinite": parameter.allow_infinite,
        "optional": parameter.allow_missing,
    }


def _group(parameter: Parameter) -> str:
    """Return the head below which the field of a parameter stands."""
    if parameter.name in SIZES:
        return "Sizes of a drawing, duty"
    if parameter.name in OF_LIMITS:
        return "Limits"
    return GROUPS[parameter.role]


def slider(parameter: Parameter) -> tuple[float, float] | None:
    """Return the ends of the slider of a parameter.

    Parameters
    ----------
    parameter : Parameter
        The parameter.

    Returns
    -------
    tuple of float or None
        Its usual values if its bounds are close together. Otherwise a quarter of the example's
        value and four times this value, or both signs of the latter for a number that may have
        either sign. None without an example other than 0.

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
    return min(example / SPAN, example * SPAN), max(example / SPAN, example * SPAN)
