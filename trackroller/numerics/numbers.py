"""Read numbers that a user wrote, round them, and compare the values of a column."""

from __future__ import annotations

import functools
import math
import re
from fractions import Fraction
from typing import Any

import numpy as np

from trackroller.errors import InputError
from trackroller.numerics.table_cells import plain_quantity
from trackroller.numerics.units import in_unit, split_quantity

_TEXT = re.compile(
    r"[-+]?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|\.?(?:inf|Inf|INF)|infinity)", re.ASCII
)
MAX_LENGTH = 400  # characters of a number


class RangeError(ValueError):
    """A number that the computer cannot hold."""


def read_number(value: Any) -> float:
    """Return a number, or a text that is a number in the digits 0 to 9, as a float.

    Parameters
    ----------
    value : int, float or str
        What the user wrote.

    Returns
    -------
    float
        The number.

    Raises
    ------
    ValueError
        If the value is no number, such as true, `3_0`, digits of other scripts, `nan` and texts
        over 400 characters.
    """
    if type(value) is float:
        return value
    if isinstance(value, (bool, np.bool_, bytes)) or value is np.ma.masked:
        raise ValueError("true, false, bytes and masked values are not numbers")
    if isinstance(value, str):
        text = value.strip()
        if len(text) > MAX_LENGTH or not _TEXT.fullmatch(text):
            raise ValueError("not a number")
        if text.lower().endswith(("inf", "infinity")):
            return float(text.lstrip("."))
        number = float(text)
        if math.isinf(number) or (number == 0 and re.search("[1-9]", re.split("[eE]", text)[0])):
            size = "large" if number else "small"
            raise RangeError(f"is too {size} for a number of the computer")
        return number
    try:
        with np.errstate(over="raise"):
            return float(value)
    except (TypeError, ArithmeticError) as exc:
        raise ValueError(str(exc)) from None


def number_or_nan(
    value: Any, unit: str | None = None, field: str = "", difference: bool = False
) -> float:
    """Return a number as `read_number` does, or NaN for a value that is no number; all bounds
    refuse NaN.

    Parameters
    ----------
    value : int, float or str
        What the user wrote.
    unit : str, optional
        Unit of the number, '-' for none; a text may then have a unit that can be converted to it,
        such as '70 GPa'.
    field : str
        Name of the field, for messages on the unit and on numbers that no computer holds; without
        it these are NaN.
    difference : bool
        Whether the number is the difference of two values, see `in_unit`.

    Returns
    -------
    float
        The number in `unit`, or NaN.

    Raises
    ------
    InputError
        If the text has a unit that is unknown or measures something else.
    """
    parts = None
    if unit is not None:
        parts = split_quantity(value)
    digits = value
    if parts is not None:
        digits = parts[0]
    try:
        number = read_number(digits)
    except RangeError as exc:
        if not field:
            return math.nan
        allowed = "0, and numbers between 1e-307 and 1e308 in size"
        remedy = "Write 0 if it is meant."
        if "large" in str(exc):
            remedy = "Write a smaller number."
        raise InputError(field, value, allowed, remedy, str(exc)) from None
    except ValueError:
        return math.nan
    if unit is None or parts is None:
        return number
    return in_unit(number, parts[1], unit, field, difference)


def finite_number(value: Any, unit: str | None = None, field: str = "") -> float:
    """Return a number as `number_or_nan` does, but NaN for an infinite one too; all bounds refuse
    NaN.

    Examples
    --------
    >>> finite_number("2 kN", "N", "radial_force"), finite_number("inf")
    (2000.0, nan)
    """
    number = number_or_nan(value, unit, field)
    return number if math.isfinite(number) else math.nan


def number_in(
    value: Any,
    field: str,
    allowed: str,
    lower: float = -math.inf,
    upper: float = math.inf,
    unit: str | None = None,
) -> float:
    """Return a number between two bounds, which are allowed values themselves.

    Parameters
    ----------
    value : int, float or str
        What the user wrote.
    field, allowed : str
        Name of the field, and what is allowed, for the message.
    lower, upper : float
        Bounds.
    unit : str, optional
        See `number_or_nan`.

    Returns
    -------
    float
        The number.

    Raises
    ------
    InputError
        If the value is no number or lies outside the bounds.
    """
    number = number_or_nan(value, unit, field)
    if not lower <= number <= upper:
        remedy = ""
        if isinstance(value, str) and plain_quantity(value):
            remedy = f"Write {plain_quantity(value)}."
        raise InputError(field, value, allowed, remedy)
    return number


def read_array(values: Any, field: str, allowed: str) -> np.ndarray:
    """Return values as an array of floats; NaN and inf are kept.

    Parameters
    ----------
    values : array_like
        What the user gave.
    field, allowed : str
        Name of the field, and what is allowed, for the message.

    Returns
    -------
    numpy.ndarray
        The array.

    Raises
    ------
    InputError
        If a value is no real number, or if the lengths of nested lists differ.
    """
    try:
        with np.errstate(over="raise"):
            array = np.asarray(values)
            if array.dtype.kind not in "fiuO":
                raise TypeError(f"values of type {array.dtype}")
            return array.astype(float, copy=False)
    except (TypeError, ValueError, ArithmeticError):
        raise InputError(field, values, allowed) from None


def all_equal(values: np.ndarray) -> bool:
    """Return whether all values (n,) of a column are equal; NaN, which stands for 'not given',
    equals NaN.
    """
    same = values == values[:1]
    if values.dtype.kind == "f":
        same |= np.isnan(values) & np.isnan(values[:1])
    return bool(np.all(same))


@functools.lru_cache(maxsize=256)
def rounded_up(value: float) -> float:
    """Return a number > 0 rounded up to two figures."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return float(f"{math.ceil(value / unit - 1e-9) * unit:.3g}")


def written(values: list[float]) -> list[float]:
    """Return computed values as a person writes them: 0.15 for 0.15000000000000002.

    Parameters
    ----------
    values : list of float
        Such as the levels of `numpy.linspace`, `numpy.arange` or `numpy.geomspace`, or a list that
        a person wrote.

    Returns
    -------
    list of float
        Values that differ from the given ones by rounding errors only, a few in the last digit.
        Evenly spaced values follow exactly from the first, the last and their number; other values
        get 12 digits if the difference is a rounding error.

    Examples
    --------
    >>> written(np.arange(-0.3, 0.2, 0.1).tolist()), written([0.1 + 0.2, 1 / 3])
    ([-0.3, -0.2, -0.1, 0.0, 0.1], [0.3, 0.3333333333333333])
    """
    n = len(values)
    if n > 2 and all(map(math.isfinite, values)):
        # the error of a step, at most one unit in the last place of the largest value, counts in
        # each step
        error = 2 * n * math.ulp(max(map(abs, values)))
        ends = [Fraction(repr(_written(end, error))) for end in (values[0], values[-1])]
        below = ends[0].denominator * ends[1].denominator * (n - 1)
        first = int(ends[0] * below)
        step = int((ends[1] - ends[0]) * (below // (n - 1)))
        even = [(first + i * step) / below for i in range(n)]
        if all(abs(one - value) <= error for one, value in zip(even, values, strict=True)):
            return even
    return [_written(value, 16 * math.ulp(value)) for value in values]


def _written(value: float, error: float) -> float:
    """Return a number with 12 digits if it is the same within an error, otherwise as it is."""
    short = float(f"{value:.12g}")
    return short if abs(short - value) <= error else value


def rounded(values: np.ndarray) -> np.ndarray:
    """Return values rounded to 40 binary digits, about 12 decimal ones.

    Nearly all values become equal that differ by rounding errors only.

    Examples
    --------
    >>> bool(rounded(0.1 + 0.2) == rounded(0.3))
    True
    """
    mantissa, exponent = np.frexp(values)
    return np.ldexp(np.round(mantissa * 2.0**40), exponent - 40)
