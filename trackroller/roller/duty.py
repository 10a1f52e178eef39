"""The duty of a roller, hours a day and days a year, which turns lives in hours into years."""

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
EXAMPLE = "Write duty: {hours_per_day: 16, days_per_year: 250}."
ATTRIBUTE = "duty"  # of the result of one case: JSON


def checked_duty(value: Any) -> dict[str, float]:
    """Return a duty with both numbers, every day of the year unless `days_per_year` is given.

    Raises
    ------
    InputError
        If `hours_per_day` is missing, or a number is impossible.
    """
    if not isinstance(value, Mapping):
        raise InputError("duty", value, "hours_per_day and days_per_year", EXAMPLE)
    return FIELD.canonical({"days_per_year": 365.0, **value})


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


def with_duty(ds: xr.Dataset, duty: Mapping[str, float] | None) -> xr.Dataset:
    """Return the result of one case or spectrum with its duty as attribute; without a duty as it is."""
    return ds if duty is None else ds.assign_attrs({ATTRIBUTE: json.dumps(duty)})


def duty_of(ds: xr.Dataset) -> dict[str, float] | None:
    """Return the duty that the result of one case or spectrum was solved with, None if it has none."""
    return json.loads(ds.attrs[ATTRIBUTE]) if ATTRIBUTE in ds.attrs else None
