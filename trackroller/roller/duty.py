"""The duty of a roller, hours a day and days a year, which turns lives in hours into years.

A duty may state strokes in place of hours: {strokes_per_day: 400, stroke: 0.8 m, days_per_year: 365}. A stroke is one
way. Hours, travel and the overrollings of the busiest point of the guide follow from them. Each roller on the rail
passes a point in the middle of its stroke once per stroke, so that n rollers whose strokes overlap pass it n times.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from trackroller.damage.mapping import MappingField
from trackroller.errors import InputError
from trackroller.parameters import Parameter

if TYPE_CHECKING:
    import xarray as xr

FIELD = MappingField(
    "duty",
    "hours a day and days a year of travel",
    numbers=(
        Parameter("hours_per_day", "", "h", math.nan, "hours of travel a day", 0.0, 24.0, open_lower=True),
        Parameter("days_per_year", "", "day", math.nan, "days of travel a year", 0.0, 366.0, open_lower=True),
    ),
)
OF_STROKES = MappingField(
    "duty",
    "strokes a day, each one way, the length of a stroke, and days a year of travel",
    numbers=(
        Parameter("strokes_per_day", "", "-", math.nan, "strokes a day, each one way", 0.0, open_lower=True),
        Parameter("stroke", "", "m", math.nan, "length of a stroke", 0.0, open_lower=True),
        FIELD.numbers[1],
        Parameter("rollers_on_rail", "", "-", 1.0, "rollers that pass a point of the middle in a stroke", 1.0),
    ),
    may_miss=("rollers_on_rail",),
)
STROKES = ("strokes_per_day", "stroke", "rollers_on_rail")  # keys that a duty in hours does not have
OVERROLLINGS = "guide_overrollings_per_hour"
EXAMPLE = "Write duty: {hours_per_day: 16, days_per_year: 250}."
ATTRIBUTE = "duty"  # of the result of one case: JSON
STROKES_ATTRIBUTE = "strokes"  # beside it, where the duty was given in strokes: JSON


def checked_duty(value: Any) -> dict[str, float]:
    """Return a duty with its numbers, every day of the year unless `days_per_year` is given.

    Raises
    ------
    InputError
        If `hours_per_day` is missing, if hours stand beside strokes, or if a number is impossible.
    """
    if not isinstance(value, Mapping):
        raise InputError("duty", value, "hours_per_day and days_per_year", EXAMPLE)
    every_day = {"days_per_year": 365.0, **value}
    if not any(key in value for key in STROKES):
        return FIELD.canonical(every_day)
    if "hours_per_day" in value:
        allowed = "either hours_per_day, or strokes_per_day and stroke"
        wrong = "stands beside strokes, which give it"
        remedy = "Remove hours_per_day, or the strokes."
        raise InputError("duty.hours_per_day", value["hours_per_day"], allowed, remedy, wrong)
    duty = OF_STROKES.canonical(every_day)
    if not duty.get("rollers_on_rail", 1.0).is_integer():
        raise InputError("duty.rollers_on_rail", value["rollers_on_rail"], "a whole number of rollers", "Count them.")
    return duty


def is_of_strokes(duty: Mapping[str, float] | None) -> bool:
    """Return whether a checked duty states strokes in place of hours."""
    return duty is not None and "stroke" in duty


def strokes_in(duty: Mapping[str, float] | None) -> dict[str, float] | None:
    """Return the strokes of a checked duty as they were given, None for a duty in hours."""
    if duty is None or not is_of_strokes(duty):
        return None
    return {name: duty[name] for name in STROKES if name in duty}


def duty_words(duty: Mapping[str, float], strokes: Mapping[str, float] | None = None) -> str:
    """Return a duty as a text: as it was given, and what follows from strokes.

    Parameters
    ----------
    duty : mapping
        `hours_per_day` and `days_per_year` [1].
    strokes : mapping, optional
        `strokes_per_day`, `stroke` [m], and `rollers_on_rail` if it was given.

    Examples
    --------
    >>> duty = {"hours_per_day": 0.1, "days_per_year": 300.0}
    >>> duty_words(duty)
    '0.1 h a day, 300 days a year'
    >>> duty_words(duty, {"strokes_per_day": 400.0, "stroke": 0.9})
    '400 strokes of 0.9 m a day, 300 days a year: 0.1 h and 0.36 km a day'
    """
    hours = f"{duty['hours_per_day']:.4g} h"
    days = f"{duty['days_per_year']:.4g} days a year"
    if not strokes:
        return f"{hours} a day, {days}"
    number = strokes["strokes_per_day"]
    travel = number * strokes["stroke"] / 1000.0
    given = f"{number:,.6g} strokes of {strokes['stroke']:.4g} m a day"
    if "rollers_on_rail" in strokes:
        given += f" with {strokes['rollers_on_rail']:g} on the rail"
    return f"{given}, {days}: {hours} and {travel:.4g} km a day"


def in_hours(duty: Mapping[str, float], hours_per_km: float) -> dict[str, float]:
    """Return a duty of strokes as hours a day and days a year.

    Parameters
    ----------
    duty : mapping
        The checked duty.
    hours_per_km : float
        Hours of travel for a km [h/km].

    Raises
    ------
    InputError
        If the strokes take more than a day.

    Examples
    --------
    >>> duty = checked_duty({"strokes_per_day": 400, "stroke": "0.9 m"})
    >>> in_hours(duty, 1 / 3.6)  # at 1 m/s
    {'hours_per_day': 0.1, 'days_per_year': 365.0}
    """
    hours = duty["strokes_per_day"] * duty["stroke"] * hours_per_km / 1000.0
    if hours > 24.0:
        allowed = f"at most {math.floor(24.0 * duty['strokes_per_day'] / hours):,} strokes, which take 24 hours"
        raise InputError("duty.strokes_per_day", duty["strokes_per_day"], allowed, "Correct strokes or velocity.")
    return {"hours_per_day": hours, "days_per_year": duty["days_per_year"]}


def passes_per_km(duty: Mapping[str, float]) -> float:
    """Return how often rollers pass a point in the middle of the guide for a km of travel [1/km]."""
    return duty.get("rollers_on_rail", 1.0) * 1000.0 / duty["stroke"]


def overrollings_per_hour(passes: Any, velocity: Any) -> Any:
    """Return the overrollings of a point of the guide in an hour of travel [1/h].

    Parameters
    ----------
    passes : float or numpy.ndarray
        Passes of rollers for a km of travel [1/km].
    velocity : float or numpy.ndarray
        Velocity of travel [m/min].
    """
    return passes * 0.06 * velocity


def of_roller(
    duty: Mapping[str, float], velocity: float | None, overrollings: Any
) -> tuple[dict[str, float], dict[str, float]]:
    """Return a duty in hours, and the parameters of the roller that follow from its strokes.

    Parameters
    ----------
    duty : mapping
        The checked duty, in hours or strokes.
    velocity : float, optional
        Velocity of the roller as given [m/min].
    overrollings : float, optional
        Its `guide_overrollings_per_hour` as given [1/h], beside which strokes are refused.

    Raises
    ------
    InputError
        If strokes lack the velocity, or contradict the overrollings.
    """
    if not is_of_strokes(duty):
        return dict(duty), {}
    refuse_overrollings(overrollings, OVERROLLINGS)
    if velocity is None:
        allowed = "the velocity, which turns strokes into hours"
        raise InputError("velocity", None, allowed, "Add velocity: 60 m/min.")
    in_time = in_hours(duty, 1.0 / (0.06 * velocity))
    return in_time, {OVERROLLINGS: overrollings_per_hour(passes_per_km(duty), velocity)}


def refuse_overrollings(given: Any, field: str) -> None:
    """Refuse overrollings of the guide beside strokes, from which they follow."""
    if given is not None:
        remedy = f"Remove {field.rpartition('.')[2]}, or write hours_per_day in place of the strokes."
        wrong = "stands beside the strokes of the duty, which give it"
        raise InputError(field, given, "either overrollings or strokes", remedy, wrong)


def years(hours: Any, duty: Mapping[str, float]) -> Any:
    """Return a life in years of a duty.

    Parameters
    ----------
    hours : float or numpy.ndarray
        Hours of travel [h].
    duty : mapping
        `hours_per_day` and `days_per_year` [1].

    Examples
    --------
    >>> years(8000, {"hours_per_day": 16, "days_per_year": 250})
    2.0
    """
    return hours / (duty["hours_per_day"] * duty["days_per_year"])


def with_duty(
    ds: xr.Dataset, duty: Mapping[str, float] | None, strokes: Mapping[str, float] | None = None
) -> xr.Dataset:
    """Return the result of one case or spectrum with its duty as attributes; without a duty as it is.

    `strokes` are those of the duty as they were given, None for a duty in hours.
    """
    if duty is not None:
        ds = ds.assign_attrs({ATTRIBUTE: json.dumps(duty)})
    if strokes is not None:
        ds = ds.assign_attrs({STROKES_ATTRIBUTE: json.dumps(strokes)})
    return ds


def duty_of(ds: xr.Dataset) -> dict[str, float] | None:
    """Return the duty that the result of one case or spectrum was solved with, None if it has none."""
    if ATTRIBUTE in ds.attrs:
        return json.loads(ds.attrs[ATTRIBUTE])
    return None


def strokes_of(ds: xr.Dataset) -> dict[str, float] | None:
    """Return the strokes that the duty of a result was given in, None for a duty in hours."""
    if STROKES_ATTRIBUTE in ds.attrs:
        return json.loads(ds.attrs[STROKES_ATTRIBUTE])
    return None


def strokes_words(ds: xr.Dataset) -> str:
    """Return the duty of a result as a sentence if it was given in strokes, '' otherwise."""
    duty = duty_of(ds)
    strokes = strokes_of(ds)
    if duty is None or strokes is None:
        return ""
    return f"Duty: {duty_words(duty, strokes)}."
