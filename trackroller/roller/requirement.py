"""What a user requires of an output: the key `requirement` of study files, of case files and of the
live page.

requirement:
  pair_life_hours: {min: 3 years, probability: 0.95}
  peak_stress_roller: {max: 600 MPa}
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.errors import InputError, collected, unknown_name
from trackroller.numerics.numbers import number_or_nan
from trackroller.numerics.units import check_hours, split_quantity
from trackroller.roller.duty import EXAMPLE, years
from trackroller.roller.output_names import is_life, unit_of

if TYPE_CHECKING:
    import xarray as xr

KEY = "requirement"
WORDS = ("min", "max", "probability")
DEFAULT = "pair_life_hours"  # of {min: 500} without the name of an output
# lives of the pair, which count to the first limit; that of one body by fatigue counts by itself
LIVES_OF_PAIR = ("pair_life_to_first_limit_hours", DEFAULT)
YEARS = re.compile(r"\s*([0-9.eE+-]+)\s*(?:a|yr|yrs|year|years)\s*", re.ASCII)


@dataclass(frozen=True)
class Requirement:
    """What is required of one output.

    Attributes
    ----------
    least, most : smallest and largest value that is enough [unit of the output]; infinite without
        one
    probability : share of the conditions that have to meet it [1]; NaN without one
    years : `least` in years of the duty, where the user gave years; NaN otherwise
    written : the entry as a file states it again
    """

    least: float = -math.inf
    most: float = math.inf
    probability: float = math.nan
    years: float = math.nan
    written: Mapping[str, Any] = field(default_factory=dict)

    @property
    def ends(self) -> dict[str, float]:
        """Return `min` and `max`, as far as they are given."""
        both = {"min": self.least, "max": self.most}
        return {end: number for end, number in both.items() if math.isfinite(number)}

    @property
    def only_least(self) -> bool:
        """Return whether a smallest value is required, and no largest one."""
        return self.most == math.inf

    @property
    def in_shares(self) -> bool:
        """Return whether a share of the conditions is enough."""
        return not math.isnan(self.probability)

    def meets(self, values: Any) -> np.ndarray:
        """Return which values are enough; a value that is not known is not."""
        return np.asarray((values >= self.least) & (values <= self.most))


def checked_requirement(value: Any, duty: Mapping[str, float] | None = None) -> Any:
    """Return the key `requirement` with each entry as a `Requirement`.

    Parameters
    ----------
    value : mapping
        Outputs, each with `min`, `max` and `probability`. {min: 500} alone is one of `DEFAULT`.
    duty : mapping, optional
        Hours a day and days a year, by which a life in years is one in hours.

    Raises
    ------
    InputError
        If an entry has another word, no end, ends in the wrong order, or years without a duty.

    Examples
    --------
    >>> duty = {"hours_per_day": 16, "days_per_year": 250}
    >>> own = checked_requirement({"min": "2 years"}, duty)["pair_life_hours"]
    >>> own.least, own.years
    (8000.0, 2.0)
    """
    if isinstance(value, Mapping):
        value = {str(name).replace(" ", ""): own for name, own in value.items()}
        if value and set(value) <= set(WORDS):
            value = {DEFAULT: value}
    elif value is not None:
        remedy = "For example requirement: {roller_life_hours: {min: 500}}."
        raise InputError(KEY, value, "outputs, each with min, max or both", remedy)
    return collected(value or {}, lambda name, given: _one(name, given, duty))


def _one(name: str, given: Any, duty: Mapping[str, float] | None) -> Requirement:
    """Return the entry of one output."""
    where = f"{KEY}.{name}"
    if isinstance(given, Requirement):
        return given
    if not isinstance(given, Mapping) or not set(given) & {"min", "max"}:
        raise InputError(where, given, "min, max or both, each a number", "For example {min: 500}.")
    for word in given:
        if word not in WORDS:
            raise unknown_name(where, str(word), WORDS)
    if "probability" in given:
        share = _share(given["probability"], f"{where}.probability")
    else:
        share = math.nan
    ends = {end: given[end] for end in ("min", "max") if end in given}
    numbers = collected(ends, lambda end, value: _end(name, value, f"{where}.{end}", duty))
    least = numbers.get("min", -math.inf)
    most = numbers.get("max", math.inf)
    if least >= most:
        raise InputError(where, dict(given), "min below max")
    written = {end: _again(ends[end], numbers[end]) for end in ends}
    if not math.isnan(share):
        written["probability"] = share
    in_years = math.nan
    if duty is not None and _years(given.get("min")) is not None:
        in_years = float(years(least, duty))
    return Requirement(least, most, share, in_years, written)


def _again(given: Any, number: float) -> Any:
    """Return the end as a file states it: years as they were given, everything else in the unit of
    the output.
    """
    if _years(given) is None:
        return number
    return str(given).strip()


def _share(given: Any, where: str) -> float:
    """Return a probability above 0 and up to 1; '95 %' is 0.95."""
    number = number_or_nan(given, "-", where)
    if not 0.0 < number <= 1.0:
        raise InputError(
            where, given, "a number above 0 and up to 1", "For example probability: 0.95."
        )
    return number


def _years(given: Any) -> float | None:
    """Return the number of years of a text such as '3 years'; None for anything else."""
    years = None
    if isinstance(given, str):
        years = YEARS.fullmatch(given)
    if years is None or math.isnan(number_or_nan(years[1])):
        return None
    return number_or_nan(years[1])


def _end(name: str, given: Any, where: str, duty: Mapping[str, float] | None) -> float:
    """Return a smallest or largest value in the unit of its output, a life in years by the duty in
    hours.
    """
    unit = unit_of(name)
    in_years = _years(given)
    if in_years is not None and unit == "h":
        if duty is None:
            raise InputError(
                where, given, "years beside a duty, or hours of travel", EXAMPLE, "needs a duty"
            )
        number = in_years / float(years(1.0, duty))
    else:
        parts = split_quantity(given)
        if parts:
            check_hours(given, parts[1], unit or "", where)
        number = number_or_nan(given, unit, where)
    if not math.isfinite(number):
        raise InputError(
            where,
            given,
            "a number",
            f"It may have a unit that can be converted to {unit or 'its own'}.",
        )
    if is_life(name) and number <= 0:
        raise InputError(where, given, "a life above 0")
    return number


def written(required: Mapping[str, Requirement]) -> dict[str, dict[str, Any]]:
    """Return requirements as a file states them."""
    return {name: dict(own.written) for name, own in required.items()}


def requirement_of(ds: xr.Dataset) -> dict[str, Requirement]:
    """Return what the result of one case has to meet, from its attributes; {} without a
    requirement.
    """
    duty = None
    if "duty" in ds.attrs:
        duty = json.loads(ds.attrs["duty"])
    requirement: dict[str, Requirement] = checked_requirement(
        json.loads(ds.attrs.get(KEY, "{}")), duty
    )
    return requirement
