"""One factor of a study: its values and their probability.

A factor is a small dictionary with exactly one of these keys:

================ =====================================================================
uniform          ``[low, high]`` loguniform       ``[low, high]``, both of one sign normal
``[mean, standard deviation]`` truncnormal      ``[mean, standard deviation, low, high]`` (mean and
deviation before the cut) triangular       ``[low, most likely, high]`` lognormal        ``[median,
standard deviation of the natural logarithm]`` weibull          ``[scale, shape]``; 63.2 % of the
values lie between 0 and the scale values           a list of numbers or of categories (names, pairs
of names, null), equally likely rows             a list of mappings, each with a name, which is the
level, and with values of columns, equally likely linspace         ``[first, last, how many]``,
equally likely logspace         ``[first, last, how many]`` (the values themselves, not exponents),
equally likely expression       arithmetic over other factors and base values, e.g. ``"-1.2 *
guide_profile_radius"``
================ =====================================================================

Listed values are those that a person writes, 0.15 and not 0.15000000000000002; see
`numerics.numbers.written`.

`rows` gives each of its columns a value at each level; `units` may stand beside it, the units of
columns by name.

`weights` may stand beside a list: one positive number a value. A random sample draws the values in
their proportion.

In an inner/outer array design (`inner_outer`), `scatter: true | false` may stand beside the key.
Without it, distributions scatter (inner array) and lists are design points (outer array).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from trackroller.errors import InputError, check_names
from trackroller.numerics.numbers import written
from trackroller.numerics.plain import how_to_write
from trackroller.numerics.units import split_quantity
from trackroller.parameters import expressions

DISTRIBUTIONS = {
    "uniform": 2,
    "loguniform": 2,
    "normal": 2,
    "truncnormal": 4,
    "triangular": 3,
    "lognormal": 2,
    "weibull": 2,
}
UNBOUNDED = ("normal", "lognormal", "weibull")
ROWS = "rows"
LISTS = ("values", "linspace", "logspace", ROWS)
KINDS = (*DISTRIBUTIONS, *LISTS, "expression")
MOST_SPREAD = 5.0  # beyond, the values of one sample span 26 powers of ten
LEAST_SHAPE = 0.2  # below, they span 50
# quantile at which an unbounded distribution is cut in designs that visit the ends of a range
TAIL = 0.01


@dataclass(frozen=True)
class Factor:
    """What varies in a study, checked: a list, a distribution or an expression.

    Parameters
    ----------
    name : name of the factor
    kind : one of `KINDS`
    numbers : numbers of a distribution
    levels : listed values
    text : the expression
    scatter : whether the factor belongs to the inner array of an inner/outer array design
    weights : probabilities of the listed values [1], empty if all are equally likely
    beside : values of the columns of `rows` at each level, by name
    units : units of these columns, as far as they are given
    """

    name: str
    kind: str
    numbers: tuple[float, ...] = ()
    levels: tuple[Any, ...] = ()
    text: str = ""
    scatter: bool = False
    weights: tuple[float, ...] = ()
    beside: Mapping[str, tuple[Any, ...]] = field(default_factory=dict, hash=False)
    units: Mapping[str, str] = field(default_factory=dict, hash=False)

    @property
    def discrete(self) -> bool:
        """Return whether the factor has a list of values."""
        return self.kind in LISTS

    @property
    def varies(self) -> bool:
        """Return whether the factor is independent and has more than one value."""
        return self.kind != "expression" and len(self.levels) != 1

    @property
    def numeric(self) -> bool:
        """Return whether all values of the factor are numbers; an expression gives numbers."""
        return not self.discrete or all(_is_number(v) for v in self.levels)

    @property
    def ordered(self) -> bool:
        """Return whether the factor goes from less to more, which needs finite numbers as
        values.
        """
        return self.numeric and (not self.discrete or all(math.isfinite(v) for v in self.levels))

    def take(self, index: np.ndarray) -> np.ndarray:
        """Return listed values by index.

        Parameters
        ----------
        index : numbers of the values in the list, shape (n,)

        Returns
        -------
        Values, shape (n,): float for numbers, object for categories.
        """
        return column([self.levels[i] for i in np.asarray(index, dtype=int)], self.numeric)

    def columns_at(self, levels: np.ndarray) -> dict[str, np.ndarray]:
        """Return the columns of `rows` at some levels.

        Parameters
        ----------
        levels : levels of the factor, shape (n,)

        Returns
        -------
        Values by name, shape (n,): float where all values of a column are numbers, NaN for a number
        that is missing.
        """
        place = {level: i for i, level in enumerate(self.levels)}
        index = [place[level] for level in levels.tolist()]
        columns = {}
        for name, values in self.beside.items():
            numeric = self.column_is_numeric(name)
            columns[name] = column([values[i] for i in index], numeric)
        return columns

    def column_is_numeric(self, name: str) -> bool:
        """Return whether a column of `rows` holds numbers; some of them may be missing, but not
        all.
        """
        given = [value for value in self.beside[name] if value is not None]
        return bool(given) and all(_is_number(value) for value in given)

    def bin(self, unit: np.ndarray) -> np.ndarray:
        """Return the index of the listed value at the quantiles `unit`, shape (n,)."""
        if self.weights:
            return np.asarray(np.searchsorted(np.cumsum(self.weights)[:-1], unit, side="right"))
        return np.asarray(np.minimum((unit * len(self.levels)).astype(int), len(self.levels) - 1))

    def from_unit(self, unit: np.ndarray, tail: float = 0.0) -> np.ndarray:
        """Return the values at quantiles.

        Parameters
        ----------
        unit : quantiles in [0, 1] [1], shape (n,)
        tail : quantile [1] at which an unbounded distribution is cut, for designs that visit 0 and
            1

        Returns
        -------
        Values, shape (n,).
        """
        unit = np.clip(np.asarray(unit, dtype=float), 0.0, 1.0)
        if self.discrete:
            return self.take(self.bin(unit))
        if self.kind == "uniform":
            low, high = self.numbers
            return low + unit * (high - low)
        if self.kind == "loguniform":
            low, high = self.numbers
            return low * (high / low) ** unit
        from scipy.stats import norm, triang, truncnorm  # heavy, and grids of values do not need it

        if self.kind == "triangular":
            low, mode, high = self.numbers
            return np.asarray(triang.ppf(unit, (mode - low) / (high - low), low, high - low))
        if self.kind in UNBOUNDED:
            cut = max(tail, 1e-9)
            unit = np.clip(unit, cut, 1 - cut)
            first, second = self.numbers
            if self.kind == "normal":
                return np.asarray(norm.ppf(unit, first, second))
            if self.kind == "lognormal":
                return np.asarray(first * np.exp(second * norm.ppf(unit)))
            return np.asarray(first * (-np.log1p(-unit)) ** (1.0 / second))
        mean, deviation, *ends = self.numbers
        low, high = ends
        cut_low = (low - mean) / deviation
        cut_high = (high - mean) / deviation
        return np.asarray(
            np.clip(truncnorm.ppf(unit, cut_low, cut_high, mean, deviation), low, high)
        )


def column(values: list[Any], numeric: bool) -> np.ndarray:
    """Return values as a column.

    Parameters
    ----------
    values : numbers or categories
    numeric : whether all of them are numbers

    Returns
    -------
    Shape (n,): float for numbers, object for categories (a list as a tuple).
    """
    if numeric:
        return np.array(values, dtype=float)
    out = np.empty(len(values), dtype=object)
    for i, value in enumerate(values):
        out[i] = value
        if isinstance(value, list):
            out[i] = tuple(value)
    return out


def label(value: Any) -> str:
    """Return a value as text for axes, tables and coordinates of a file."""
    if isinstance(value, (tuple, list)):
        return " / ".join(label(v) for v in value)
    if isinstance(value, Mapping):
        return str(value.get("name", "inline"))
    if _is_number(value):
        return f"{value:g}"
    return "not given" if value is None else str(value)


def readable(values: np.ndarray) -> np.ndarray:
    """Return a column (n,) with its categories as texts, see `label`; a column of numbers stays as
    it is.
    """
    if values.dtype.kind in "OSU":
        return np.array([label(v) for v in values], dtype=object)
    return values


def parse(name: str, spec: Any) -> Factor:
    """Check the dictionary of a factor.

    Parameters
    ----------
    name : name of the factor
    spec : its dictionary

    Returns
    -------
    Factor

    Raises
    ------
    InputError : with the name of the factor, what is wrong and what is allowed
    """
    field = f"factors.{name}"
    if not isinstance(spec, Mapping):
        allowed = f"a mapping with one of {', '.join(KINDS)}"
        example = ""
        if isinstance(spec, (list, tuple)):
            example = f"Write {{values: {spec}}}."
        raise InputError(
            field,
            spec,
            allowed,
            example or "For example {uniform: [0.1, 0.3]} or {values: [1, 2]}.",
        )
    scatter = spec.get("scatter")
    if not (scatter is None or isinstance(scatter, bool)):
        raise InputError(f"{field}.scatter", scatter, "true or false")
    check_names(f"{field} key", spec, (*KINDS, "scatter", "weights", "units"))
    keys = [key for key in spec if key in KINDS]
    if len(keys) != 1:
        raise InputError(field, dict(spec), f"exactly one of {', '.join(KINDS)}")
    kind = keys[0]
    value = spec[kind]
    where = f"{field}.{kind}"
    if "weights" in spec and kind not in LISTS:
        raise InputError(
            f"{field}.weights", spec["weights"], f"weights of the values of a list, not of {kind}"
        )
    if kind == "expression":
        expressions.names(value, where)
        return Factor(name, kind, text=value)
    if not isinstance(value, (list, tuple)) or not value:
        raise InputError(where, value, "a list that is not empty", how_to_write(value))
    if kind in DISTRIBUTIONS:
        return Factor(name, kind, _distribution(kind, value, where), scatter=scatter is not False)
    return _listed(name, kind, spec, field)


def _listed(name: str, kind: str, spec: Mapping[str, Any], field: str) -> Factor:
    """Return the factor of a list or of rows."""
    value = list(spec[kind])
    where = f"{field}.{kind}"
    beside: dict[str, tuple[Any, ...]] = {}
    if kind == ROWS:
        levels, beside = _rows(name, value, where)
    else:
        levels = _levels(kind, value, where)
    weights: tuple[float, ...] = ()
    if "weights" in spec:
        weights = _weights(spec["weights"], levels, f"{field}.weights")
    scatter = bool(spec.get("scatter"))
    units = spec.get("units", {})
    return Factor(
        name, kind, levels=levels, scatter=scatter, weights=weights, beside=beside, units=units
    )


def _rows(
    name: str, rows: list[Any], where: str
) -> tuple[tuple[Any, ...], dict[str, tuple[Any, ...]]]:
    """Return the levels of rows and their columns; a column with the name of the factor holds the
    levels themselves.
    """
    if not all(isinstance(row, Mapping) and isinstance(row.get("name"), str) for row in rows):
        raise InputError(
            where, rows, "mappings, each with a name", "For example {name: A, contact_angle: 30}."
        )
    names = [row["name"] for row in rows]
    for own in names:
        if names.count(own) > 1:
            raise InputError(
                f"{where}.{own}.name", own, "a different name for each row", "Rename one of them."
            )
    columns = [key for key in rows[0] if key != "name"]
    for row in rows:
        others = {*row, "name"} ^ {*columns, "name"}
        if others:
            allowed = "the same columns in each row"
            raise InputError(
                f"{where}.{row['name']}.{min(others)}",
                None,
                allowed,
                "Add the value, or write null.",
            )
    beside = {key: tuple(row[key] for row in rows) for key in columns}
    levels = beside.pop(name, tuple(names))
    return levels, beside


def _weights(value: Any, levels: tuple[Any, ...], where: str) -> tuple[float, ...]:
    """Return the probabilities of the listed values."""
    if not isinstance(value, (list, tuple)):
        raise InputError(where, value, f"a list of {len(levels)} positive numbers, one a value")
    numbers = _numbers(value, len(levels), where)
    if not min(numbers) > 0:
        raise InputError(
            where, value, "numbers above 0", "Remove the value that never occurs from the list."
        )
    return tuple(number / sum(numbers) for number in numbers)


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool)


def _numbers(values: Any, count: int, where: str) -> tuple[float, ...]:
    if len(values) != count or not all(_is_number(v) and math.isfinite(v) for v in values):
        texts = [v for v in values if isinstance(v, str)]
        remedy = ""
        if texts:
            remedy = "Sample a fraction in [0, 1] and write the dependent range as an expression."
        if any(map(split_quantity, texts)):
            remedy = (
                "Only parameters take units: write the numbers of a factor of your own "
                "without them."
            )
        if where.endswith("space"):
            remedy = "Write [first, last, number of values]."
        raise InputError(where, values, f"{count} finite numbers", remedy)
    return tuple(float(v) for v in values)


def _distribution(kind: str, value: Any, where: str) -> tuple[float, ...]:
    numbers = _numbers(value, DISTRIBUTIONS[kind], where)
    low, high = numbers[0], numbers[-1]
    good, allowed = {
        "uniform": (low < high, "low < high"),
        "loguniform": (low < high and low * high > 0, "low < high of one sign, not 0"),
        "normal": (numbers[1] > 0, "a standard deviation > 0"),
        "truncnormal": (
            numbers[1] > 0 and numbers[-2] < high,
            "a standard deviation > 0 and low < high",
        ),
        "triangular": (
            low <= numbers[1] <= high and low < high,
            "low <= most likely <= high, low < high",
        ),
        "lognormal": (
            low != 0 and 0 < high <= MOST_SPREAD,
            f"a median other than 0, and 0 < sd of ln <= {MOST_SPREAD:g}",
        ),
        "weibull": (
            low != 0 and high >= LEAST_SHAPE,
            f"a scale other than 0, and a shape >= {LEAST_SHAPE:g}",
        ),
    }[kind]
    if not good:
        raise InputError(where, value, allowed)
    return numbers


def _levels(kind: str, value: list[Any], where: str) -> tuple[Any, ...]:
    if kind == "values":
        levels: list[Any] = [tuple(v) if isinstance(v, list) else v for v in value]
        if any(_is_number(v) and math.isnan(v) for v in levels):
            raise InputError(
                where, value, "numbers or names, but not NaN", "Write null for 'not given'."
            )
        if all(_is_number(v) for v in levels):
            levels = written([float(v) for v in levels])
    else:
        first, last, count = _numbers(value, 3, where)
        if count != int(count) or count < 1:
            raise InputError(
                where, value, "[first, last, how many] with a whole number >= 1 as the third"
            )
        if kind == "logspace" and first * last <= 0:
            raise InputError(where, value, "first and last of one sign, not 0")
        space: Any = np.geomspace
        if kind == "linspace":
            space = np.linspace
        levels = written([float(v) for v in space(first, last, int(count))])
    if len({repr(v) for v in levels}) < len(levels):
        raise InputError(where, value, "each value once", "Remove the repeated value.")
    return tuple(levels)
