"""Fit the rule of a maker's catalogue, BL/(c + (1 - c) LF)^p, to permissible loads and lives of one
series.

The rule is a straight line of ln life over ln(c + (1 - c) LF) for each offset c. A maker's table
has no scatter but its rounding, so that the deviations say whether the rule holds, and intervals
take them as independent errors of the logarithm of the life.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from scipy.optimize import brentq, minimize_scalar
from scipy.special import stdtrit

from trackroller.damage.catalogue import LAWS, OFFSETS, POWERS, travel_km
from trackroller.errors import InputError, listing
from trackroller.fit.heads import NAMES_OF_TESTS
from trackroller.fit.line import Interval
from trackroller.fit.material_fit import CONFIDENCE
from trackroller.fit.table import LEAST, TestTable, read_tests
from trackroller.numerics.numbers import finite_number

LIFE, LOAD, LIMIT, FACTOR = "travel", "radial_force", "permissible_radial_force", "load_factor"
COLUMNS = (LIFE, LOAD, LIMIT, FACTOR, "test", "note")
OTHER_HEADS = NAMES_OF_TESTS | {
    LIFE: "life life_km travel_life distance_km lebensdauer laufleistung",
    LOAD: "load force applied_load applied_force belastung last kraft",
    LIMIT: "permissible_load permissible_force load_rating rated_load rating limit_load tragzahl",
    FACTOR: "lf load_ratio lastfaktor",
}
LARGEST_OFFSET = 0.9
MOST_LIFE = 1e9  # km
MOST_FORCE = 1e9  # N
MOST_FACTOR = 1e3
OFFSETS_TRIED = 181
ROUNDING = 1e-3  # least standard deviation of ln life: makers print three digits
MOST_EXPONENT = 20.0


@dataclass(frozen=True)
class CatalogueFit:
    """The rule of a maker's catalogue; `trackroller.fit_catalogue` makes it.

    Attributes
    ----------
    tests : TestTable
        The table as given.
    load_factor, life : numpy.ndarray
        Load factors LF [1] and lives [km], (n,).
    given_offset : float
        Offset that is held [1]; NaN if it is fitted.
    permissible : float
        Permissible radial force [N], if it is the same in all rows; NaN otherwise.
    notes : list of str
        Sentences on how the table was read.
    """

    tests: TestTable
    load_factor: np.ndarray
    life: np.ndarray
    given_offset: float = math.nan
    permissible: float = math.nan
    notes: list[str] = field(default_factory=list)

    @property
    def fits_offset(self) -> bool:
        """Return whether the offset is fitted."""
        return math.isnan(self.given_offset)

    @cached_property
    def offset(self) -> float:
        """Return the load factor c that counts without any load [1]."""
        return self._best_offset(math.nan)

    @property
    def exponent(self) -> float:
        """Return the exponent p of the life on the load factor [1]."""
        return float(self._line(self.offset)[0])

    @property
    def basic_life(self) -> float:
        """Return the life BL at a load factor of 1 [km]."""
        return float(math.exp(self._line(self.offset)[1]))

    @property
    def deviation(self) -> float:
        """Return the largest relative deviation of a life of the table from the rule."""
        rule = travel_km(self.load_factor, self.basic_life, self.exponent, self.offset)
        return float(np.abs(self.life / rule - 1.0).max())

    @cached_property
    def laws(self) -> dict[str, float]:
        """Return the largest relative deviation of the lives from each law of a catalogue, the
        basic life of which is fitted.
        """
        return {law: self._deviation_of(OFFSETS[law], POWERS[law]) for law in LAWS}

    def interval(self, name: str, confidence: float = CONFIDENCE) -> Interval:
        """Return the interval of `exponent` or `offset`, by the profile of the squared deviations.

        A table with no row more than the rule has values has no interval: both ends are NaN.

        Parameters
        ----------
        name : str
            "exponent" or "offset".
        confidence : float
            Share of intervals that hold the true value, if the deviations are independent.
        """
        freedom = len(self.life) - 2 - int(self.fits_offset)
        if freedom < 1:
            return Interval(math.nan, math.nan)
        if name == "offset" and not self.fits_offset:
            return Interval(self.given_offset, self.given_offset)
        least = self._line(self.offset)[2]
        spread = max(least / freedom, ROUNDING**2)
        goal = least + spread * float(stdtrit(freedom, 0.5 + 0.5 * confidence)) ** 2
        if name == "offset":
            bounds = 0.0, LARGEST_OFFSET
            return _ends(lambda offset: self._line(offset)[2], self.offset, bounds, goal)

        def profile(exponent: float) -> float:
            return float(self._squares(self._best_offset(exponent), exponent))

        return _ends(profile, self.exponent, (0.0, MOST_EXPONENT), goal)

    @property
    def catalogue(self) -> dict[str, float]:
        """Return the entries of the field `catalogue` that the table tells; a case also needs
        `axial_force`.
        """
        entry = {}
        if math.isfinite(self.permissible):
            entry["radial_force"] = self.permissible
        entry |= {"basic_life": self.basic_life, "exponent": self.exponent, "offset": self.offset}
        return {name: float(f"{value:.6g}") for name, value in entry.items()}

    def _line(self, offset: float) -> tuple[float, float, float]:
        """Return exponent, ln BL, and sum of the squared deviations of ln life, with an offset."""
        x, y = self._logarithms(offset)
        middle = x.mean()
        exponent = -float((x - middle) @ y / ((x - middle) @ (x - middle)))
        level = float(y.mean() + exponent * middle)
        return exponent, level, float(self._squares(offset, exponent))

    def _logarithms(self, offset: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
        """Return ln(c + (1 - c) LF) with each offset, (..., n), and ln life, (n,)."""
        own = np.asarray(offset)[..., None]
        x = np.log(own + (1.0 - own) * self.load_factor)
        return x, np.log(self.life)

    def _squares(self, offset: np.ndarray | float, exponent: float) -> np.ndarray:
        """Return the least sum of squared deviations of ln life with an offset, (...), and an
        exponent; NaN stands for the best exponent.
        """
        x, y = self._logarithms(offset)
        x = x - x.mean(axis=-1, keepdims=True)
        y = y - y.mean()
        slope: np.ndarray | float = -exponent
        if math.isnan(exponent):
            slope = (np.sum(x * y, axis=-1) / np.sum(x * x, axis=-1))[..., None]
        return np.asarray(np.sum((y - slope * x) ** 2, axis=-1))

    def _best_offset(self, exponent: float) -> float:
        """Return the offset with the least sum of squared deviations, see `_squares`."""
        if not self.fits_offset:
            return self.given_offset
        tried = np.linspace(0.0, LARGEST_OFFSET, OFFSETS_TRIED)
        squares = self._squares(tried, exponent)
        best = int(np.argmin(squares))
        bounds = tried[max(best - 1, 0)], tried[min(best + 1, OFFSETS_TRIED - 1)]
        refined = minimize_scalar(
            lambda offset: float(self._squares(offset, exponent)),
            bounds=bounds,
            method="bounded",
            options={"xatol": 1e-9},
        )
        if refined.fun < squares[best]:
            return float(refined.x)
        return float(tried[best])

    def _deviation_of(self, offset: float, power: float) -> float:
        """Return the largest relative deviation from a rule whose basic life alone is fitted."""
        rule = np.log(travel_km(self.load_factor, 1.0, power, offset))
        apart = np.log(self.life) - rule
        return float(np.abs(np.expm1(apart - apart.mean())).max())


def fit_catalogue(table: Any, *, offset: float | None = None) -> CatalogueFit:
    """Fit the rule of a maker's catalogue to permissible loads and lives of one series.

    Parameters
    ----------
    table : path, data frame, list of mappings or mapping of columns
        Columns `travel [km]`, the life, and either `load_factor`, or `radial_force [N]` and
        `permissible_radial_force [N]`; other usual names, such as `life`, `load` and
        `permissible_load`, are taken, and the notes say so. All rows belong to one basic life.
    offset : float, optional
        Offset c that is held [1]; by default it is fitted.

    Returns
    -------
    CatalogueFit
        `.exponent`, `.offset`, `.basic_life`, `.interval(...)`, `.laws` and `.catalogue`;
        `trackroller.report(fit, path)` writes its page.

    Raises
    ------
    InputError
        For a table that tells no rule; the message names row and column.

    Notes
    -----
    ln L = ln BL - p ln(c + (1 - c) LF) by least squares. Valid for the load factors of the table:
    an offset shows only at small ones.

    Examples
    --------
    >>> rows = {"load_factor": [0.1, 0.25, 0.5, 1.0], "travel": [4421, 1340, 377, 100]}
    >>> fit = fit_catalogue(rows, offset=0)
    >>> round(fit.exponent, 1)
    1.7
    """
    rows = read_tests(table, (LIFE,), COLUMNS, ("test", "note"), OTHER_HEADS)
    life = np.array([rows.number(row, LIFE, LEAST, MOST_LIFE) for row in rows])
    _check_filled(rows, LIFE, life)
    factor, permissible = _load_factors(rows)
    given_offset = _checked_offset(offset)
    values = 2 + int(math.isnan(given_offset))
    different = len(np.unique(factor))
    if different < values:
        allowed = f"at least {values} different load factors, for {values} values of the rule"
        remedy = "Add rows with other loads."
        if values > 2 and different == 2:
            remedy = "Add rows with other loads, or hold the offset: --offset 0 (offset=0)."
        raise rows.placed(InputError("tests", different, allowed, remedy))
    _check_falls(rows, factor, life)
    notes = []
    heads = {column: head for column, head in rows.heads.items() if column in COLUMNS}
    if heads:
        notes.append(f"Read {listing([f'{head} as {name}' for name, head in heads.items()])}.")
    return CatalogueFit(rows, factor, life, given_offset, permissible, notes)


def _load_factors(rows: TestTable) -> tuple[np.ndarray, float]:
    """Return the load factors, and the permissible force if all rows have one."""
    names = set(rows.rows[0])
    forces = LOAD in names, LIMIT in names
    if FACTOR in names and any(forces):
        allowed = f"either {FACTOR}, or {LOAD} and {LIMIT}"
        given = [rows.heads.get(name, name) for name in (LOAD, LIMIT) if name in names]
        raise rows.placed(InputError("column", given[0], allowed, f"Remove {listing(given)}."))
    if FACTOR in names:
        factor = np.array([rows.number(row, FACTOR, LEAST, MOST_FACTOR) for row in rows])
        _check_filled(rows, FACTOR, factor)
        return factor, math.nan
    if not all(forces):
        allowed = f"a column {FACTOR}, or {LOAD} [N] and {LIMIT} [N]"
        remedy = f"The table has {', '.join(rows.heads.get(name, name) for name in rows.rows[0])}."
        raise rows.placed(InputError(f"column {FACTOR}", None, allowed, remedy))
    load, limit = (
        np.array([rows.number(row, name, LEAST, MOST_FORCE) for row in rows])
        for name in (LOAD, LIMIT)
    )
    _check_filled(rows, LOAD, load)
    _check_filled(rows, LIMIT, limit)
    permissible = math.nan
    if np.all(limit == limit[0]):
        permissible = float(limit[0])
    return load / limit, permissible


def _check_filled(rows: TestTable, column: str, values: np.ndarray) -> None:
    """Refuse an empty cell."""
    for row in np.flatnonzero(np.isnan(values)).tolist():
        raise rows.error(
            row, column, "a number; the cell is empty", "Fill the cell, or remove the row."
        )


def _checked_offset(offset: Any) -> float:
    """Return the offset that is held, NaN for none."""
    if offset is None:
        return math.nan
    value = finite_number(offset)
    if not 0.0 <= value <= LARGEST_OFFSET:
        allowed = f"a number from 0 to {LARGEST_OFFSET:g}"
        raise InputError("offset", offset, allowed, "Give 0.03 for 0.03 + 0.97 LF, 0 for LF.")
    return value


def _check_falls(rows: TestTable, factor: np.ndarray, life: np.ndarray) -> None:
    """Refuse a life that is longer under a larger load."""
    order = np.argsort(factor, kind="stable")
    for low, high in zip(order[:-1].tolist(), order[1:].tolist(), strict=True):
        if factor[high] > factor[low] and life[high] >= life[low]:
            allowed = (
                f"a life below {life[low]:g} km, which stands at a load factor of {factor[low]:.4g}"
            )
            wrong = f"stands at the larger load factor of {factor[high]:.4g}"
            remedy = "Correct the row, or fit each series alone."
            raise rows.error(high, LIFE, allowed, remedy, wrong)


def _ends(
    squares: Callable[[float], float], best: float, bounds: tuple[float, float], goal: float
) -> Interval:
    """Return where a profile of squared deviations rises to its goal on both sides of its least."""

    def excess(value: float) -> float:
        return float(squares(value)) - goal

    ends = []
    for bound in bounds:
        if excess(bound) <= 0.0:
            ends.append(bound)
        else:
            ends.append(float(brentq(excess, *sorted((bound, best)), xtol=1e-9)))
    return Interval(*ends)
