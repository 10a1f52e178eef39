"""Names of a designer for the parameters of a case: aliases, and radii of the roller that give its
axis distance.

The groove of the roller consists of two arcs of the radius R = -r_C,TR, which touch the guide at
the contact angle. They meet in the middle of the groove at the radius

    A_T + (R - r_C,G) cos(alpha) - sqrt(R^2 - (R - r_C,G)^2 sin(alpha)^2).

The outer radius of the roller lies above it by the depth of the groove; a relief cut in the middle
does not count.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from trackroller.errors import Collector, InputError
from trackroller.numerics.numbers import number_in
from trackroller.parameters import PARAMETERS, expressions
from trackroller.parameters.example import EXAMPLE
from trackroller.roller.geometry import rolling_radius

ALIASES = {"mu": "friction_coefficient"}
# names of options that people use, in case and study files
OTHER_OPTIONS = {"failures": "failure_probability"}
WRITTEN = ALIASES | OTHER_OPTIONS  # names that a file may have in place of those in messages
RADII = ("outer_radius", "groove_depth")  # mm
_ACROSS = "(abs(roller_profile_radius) - guide_profile_radius) * {}(radians(contact_angle))"
AXIS_DISTANCE = (
    f"where(roller_profile_radius < 0, outer_radius - groove_depth - {_ACROSS.format('cos')} "
    # no groove: not a number
    f"+ sqrt(roller_profile_radius ** 2 - ({_ACROSS.format('sin')}) ** 2), sqrt(-1))"
)


def renamed(values: Mapping[Any, Any]) -> dict[Any, Any]:
    """Return values with the names of parameters in place of aliases; refuse a parameter that is
    given twice.
    """
    out: dict[Any, Any] = {}
    for key, value in values.items():
        name = ALIASES.get(key, key)
        if name in out or (name != key and name in values):
            raise InputError(
                name,
                value,
                "one value",
                "Remove one of the two.",
                f"stands beside {key}, which is another name of it",
            )
        out[name] = value
    return out


def with_options(values: Mapping[Any, Any]) -> dict[Any, Any]:
    """Return the keys of a file with the name of each option in place of its other name.

    Examples
    --------
    >>> with_options({"failures": "5%", "mu": 0.1})
    {'failure_probability': '5%', 'mu': 0.1}
    """
    out = dict(values)
    for other, name in OTHER_OPTIONS.items():
        if other not in out:
            continue
        if name in out:
            wrong = f"stands beside {name}, which is another name of it"
            raise InputError(other, out[other], "one value", "Remove one of the two.", wrong)
        out = {name if key == other else key: value for key, value in out.items()}
    return out


def overridden(values: Mapping[str, Any], given: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of a case file, overridden by those of the command line.

    A value overrides that of its other name, such as `mu` that of `friction_coefficient`. An axis
    distance overrides the radii of the roller (`RADII`), and a radius the axis distance; radii that
    are overridden are checked, too.
    """
    given = with_options(renamed(given))
    values = with_options(values)
    for name in RADII if "axis_distance" in given else ():
        if name in values:
            radius(name, values[name])
    instead = {*given, *(RADII if "axis_distance" in given else ())}
    if set(RADII) & set(given):
        instead |= {"axis_distance"}
    else:
        instead |= set()
    return (
        renamed(
            {
                name: value
                for name, value in values.items()
                if ALIASES.get(name, name) not in instead
            }
        )
        | given
    )


def radius(name: str, value: Any, where: str = "") -> float:
    """Return an outer radius or the depth of a groove [mm]."""
    field = f"{where}{name}"
    allowed = f"a length > 0 in mm, the {name.replace('_', ' ')} of the roller"
    return number_in(
        value, field, allowed, math.nextafter(0.0, 1.0), PARAMETERS["axis_distance"].upper, "mm"
    )


def check_radii(named: Mapping[str, Any]) -> bool:
    """Return whether outer radius and depth of the groove are named; refuse one of them alone or
    beside axis_distance.

    Raises
    ------
    InputError
        If the two radii do not give the axis distance without ambiguity.
    """
    given = [name for name in RADII if name in named]
    if not given:
        return False
    if "axis_distance" in named:
        remedy = f"Remove {' and '.join(given)}, or axis_distance."
        raise InputError(
            "axis_distance", named["axis_distance"], "one description of the roller's size", remedy
        )
    if len(given) < len(RADII):
        allowed = "outer_radius together with groove_depth; both give the axis distance"
        raise InputError(
            given[0], named[given[0]], allowed, "Add the other one, or give axis_distance."
        )
    return True


def with_axis_distance(values: Mapping[str, Any], number: Any) -> dict[str, Any]:
    """Return the values of one case with the axis distance in place of outer radius and depth of
    the groove.

    Parameters
    ----------
    values : mapping
        Values by name.
    number : callable
        Returns the number of a parameter, (name, value).
    """
    if not check_radii(values):
        return dict(values)
    known = {}
    wrong = Collector()
    for name in (*RADII, "guide_profile_radius", "roller_profile_radius", "contact_angle"):
        with wrong.part():
            if name in RADII:
                known[name] = radius(name, values[name])
            else:
                known[name] = number(name, values.get(name, EXAMPLE[name]))
    wrong.check()
    axis = float(expressions.evaluate(AXIS_DISTANCE, known))
    if not math.isfinite(axis):
        remedy = "Give axis_distance, or a groove: roller_profile_radius < 0."
        raise InputError(
            "outer_radius", values["outer_radius"], "the radius of a roller with a groove", remedy
        )
    touching = float(
        rolling_radius(axis, known["guide_profile_radius"], math.radians(known["contact_angle"]))
    )
    if touching >= known["outer_radius"]:
        allowed = (
            f"a groove so deep that the contact at the radius {touching:.5g} mm lies below "
            "the outer radius"
        )
        raise InputError("groove_depth", values["groove_depth"], allowed, "Give a larger depth.")
    return {name: value for name, value in values.items() if name not in RADII} | {
        "axis_distance": axis
    }


def _columns_of_rows(factors: Mapping[str, Any]) -> dict[str, Any]:
    """Return a value of each column of the factors that are rows of a table."""
    columns: dict[str, Any] = {}
    for factor in factors.values():
        if isinstance(factor, Mapping):
            rows = factor.get("rows") or ()
            columns |= {
                name: value
                for row in rows
                if isinstance(row, Mapping)
                for name, value in row.items()
            }
    return columns


def study_with_radii(data: Mapping[str, Any], wrong: Collector) -> dict[str, Any]:
    """Return the keys of a study file with the axis distance as a factor that follows from outer
    radius and depth.

    The two become factors of the study, also if they stand in `base`, and the expression
    `AXIS_DISTANCE` uses them. `wrong` collects the errors; aliases and radii that are wrong are
    left out.
    """
    sections: dict[str, Any] = {"base": {}, "factors": {}}
    sections |= {key: data[key] for key in sections if data.get(key) is not None}
    if not all(isinstance(part, Mapping) for part in sections.values()):
        return dict(data)
    for section, part in sections.items():
        sections[section] = {name: value for name, value in part.items() if name not in ALIASES}
        with wrong.part(section):
            sections[section] = renamed(part)
    base, factors = sections.values()
    derived = {"expression": AXIS_DISTANCE}
    of_user = {
        name: value
        for name, value in factors.items()
        if name != "axis_distance" or value != derived
    }
    before = len(wrong.errors)
    with wrong.part():
        if check_radii({**_columns_of_rows(of_user), **base, **of_user}):
            given = {
                name: {"values": [radius(name, base[name], "base.")]}
                for name in RADII
                if name in base
            }
            factors = given | factors | {"axis_distance": derived}
            base = {name: value for name, value in base.items() if name not in RADII}
    if len(wrong.errors) > before:
        base, factors = (
            {name: part[name] for name in part if name not in RADII} for part in (base, factors)
        )
    out = dict(data)
    if base:
        out["base"] = base
    if factors:
        out["factors"] = factors
    return out
