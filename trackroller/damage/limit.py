"""Protocol of a limit: what one file of this room declares, and what its function receives.

A limit ends the life of a roller or of its guide. Its file holds the formulas and one object
`LIMIT`. Output groups, result variables, fields of a case, values of a material, the JSON schema
and the documentation follow from it. A life in hours is overrollings over
`SolvedRollers.overrollings_per_hour`. A case gives its own value of a material as
`roller_material={"like": "PA6", "permissible_pressure": 60.0}`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from trackroller.damage.histories import RollerTractions
from trackroller.damage.mapping import MappingField
from trackroller.numerics.parameter import Parameter
from trackroller.numerics.variable import BODIES, REGIMES, Variable

SN_SCATTER = "S-N scatter"
TRACTIONS = "tractions"
OF_GUIDE = ("guide_overrollings_per_hour",)  # fields of a case that concern the guide alone
Values = dict[str, np.ndarray]  # results by name


def missing(column: np.ndarray) -> np.ndarray:
    """Return where a column of a case has no value, (n,) bool: a number is NaN, or the text of a
    mapping is empty.
    """
    if column.dtype == object:
        return np.asarray(column == "")
    return np.asarray(np.isnan(column))


def roller_overrollings(velocity: ArrayLike, rolling_radius: ArrayLike) -> np.ndarray:
    """Return the overrollings of a point of the roller, one in each revolution.

    Parameters
    ----------
    velocity : array_like
        v > 0 [m/min].
    rolling_radius : array_like
        r_A > 0 [mm].

    Returns
    -------
    numpy.ndarray
        v / (2 pi r_A) [1/h].
    """
    return np.asarray(velocity) * 60e3 / (2 * np.pi * np.asarray(rolling_radius))


def skidding(regime: np.ndarray) -> np.ndarray:
    """Return which of n rollers skid by their regime, (n, 1) bool.

    A skidding roller wears and heats up until it fails, and its overrollings are no cycles of
    fatigue.
    """
    return np.asarray((np.asarray(regime) == REGIMES.index("full_slip"))[:, None])


def _no_tractions() -> RollerTractions:
    raise LookupError("a limit without the need 'tractions' asks for them")


def _no_gap(case: int, contact: int, lateral: np.ndarray) -> np.ndarray:
    raise LookupError("the profiles of these rollers are not known")


@dataclass(frozen=True)
class SolvedRollers:
    """Solved rollers as a limit receives them; every array has the case as first axis.

    Parameters
    ----------
    cases : mapping of str to numpy.ndarray
        Parameters of the cases by name, (n,), in the units of `PARAMETERS`; fields that are
        mappings as JSON texts.
    materials : mapping of str to numpy.ndarray
        Values of the materials of roller and guide by name, (n, 2), in the units of `PROPERTIES`;
        NaN if not given.
    values : mapping of str to numpy.ndarray
        Results of the solver and of the groups that the limit needs, by name: (n,), (n, contact),
        or (n, contact, body).
    rolling_radius : numpy.ndarray
        r_A, (n,) [mm].
    options : mapping
        Options of the solution by name, such as `life_rule` and `failure_probability`.
    tractions : callable
        Function that returns the tractions of the patches; limits that need "tractions" may call
        it.
    unworn_gap : callable
        Function of the number of a case, the place of a contact (0 or 1), and lateral places
        outward (m,) [mm], which returns the gap of the unworn, undeformed profiles there, (m,)
        [mm].
    regime : numpy.ndarray, optional
        Number in `REGIMES` of each case, (n,); None before the balance is known.
    ends : mapping of str to numpy.ndarray
        By the name of a value that is a placeholder with a range, the worse and the better end of
        the range over the value, (n, body, 2) [1].
    place : int
        Where the placeholders are: 0 at their values, 1 at the worse and 2 at the better ends.
    """

    cases: Mapping[str, np.ndarray]
    materials: Mapping[str, np.ndarray]
    values: Mapping[str, np.ndarray]
    rolling_radius: np.ndarray
    options: Mapping[str, Any] = field(default_factory=dict)
    tractions: Callable[[], RollerTractions] = _no_tractions
    unworn_gap: Callable[[int, int, np.ndarray], np.ndarray] = _no_gap
    regime: np.ndarray | None = None
    ends: Mapping[str, np.ndarray] = field(default_factory=dict)
    place: int = 0

    def at_end(self, end: int) -> SolvedRollers:
        """Return the rollers with the values of `ends` at the worse (0) or the better (1) ends of
        their ranges.
        """
        moved = {
            name: self.materials[name] * shares[..., end] for name, shares in self.ends.items()
        }
        return replace(self, materials=dict(self.materials) | moved, ends={}, place=end + 1)

    @property
    def skids(self) -> np.ndarray:
        """Return which rollers skid, see `skidding`, (n, 1); none before the balance is known."""
        if self.regime is None:
            return np.zeros((len(self.rolling_radius), 1), dtype=bool)
        return skidding(self.regime)

    @property
    def overrollings_per_hour(self) -> np.ndarray:
        """Return the overrollings of a point of roller and guide, (n, 2) [1/h]; NaN for a guide
        without a number.
        """
        roller = roller_overrollings(self.cases["velocity"], self.rolling_radius)
        return np.stack([roller, self.cases["guide_overrollings_per_hour"]], axis=1)


@dataclass(frozen=True)
class LimitUse:
    """What one limit says: how far it is used, and the hours until it is reached.

    Both have the shape (n, body), and are None where the limit has none.

    `utilisation` is the load over the load at which the limit is reached [1]. NaN stands for a
    value that is not known. `at_once`, (n, body), marks bodies that break at once, so that the
    limit is reached without a life. `life_low` and `life_high`, (n, body) [h], are given by a limit
    whose own formula knows its life within a range.
    """

    utilisation: np.ndarray | None
    life_hours: np.ndarray | None
    at_once: np.ndarray | None = None
    life_low: np.ndarray | None = None
    life_high: np.ndarray | None = None


def worst(values: np.ndarray) -> np.ndarray:
    """Return the largest value of both contacts, (n, contact, body) to (n, body); NaN if a contact
    has none.
    """
    return np.asarray(np.max(values, axis=1))


@dataclass(frozen=True)
class Limit:
    """What can end the life of a body, declared once.

    Parameters
    ----------
    name, title : str
        Name in data sets, and its words where it is defined: in the proof of a page and in the
        documentation.
    group : str
        Group of `outputs` that brings the results.
    evaluate : callable
        Function of a `SolvedRollers` that returns the results by name.
    use : callable
        Function of `SolvedRollers` and of the results that returns a `LimitUse`; None if the
        limit is not checked.
    meaning : str
        Meaning of the group for the documentation. A group of the solver has its meaning there.
    needs : tuple of str
        What has to be computed first: the groups "peak_stress" and "friction_work" of the solver,
        and `TRACTIONS`.
    shared : callable, optional
        Function of a `SolvedRollers` that returns what `evaluate` needs of the tractions, once for
        the values of the materials and both ends of their placeholders. A name that begins with an
        underscore is no result.
    bound : callable, optional
        Function of a `SolvedRollers` with the results of `shared` that returns an upper bound of
        the utilisation, (n, body) [1]. It costs little. Where it stays below 1 the limit is kept,
        and the option `at_most` leaves the number out.
    shared_by_mechanics : bool
        Whether cases with equal forces and tractions share these values. `shared` must then not use
        the speed or values of strength and wear.
    results : tuple of Variable
        What `evaluate` returns.
    parameters : tuple of Parameter
        Fields of a case that belong to this limit. They change no force and no stress.
    materials : tuple of Parameter
        Values of a material that belong to this limit.
    mappings : tuple of MappingField
        Fields of a case that are mappings and belong to this limit.
    requires : tuple of str
        Fields of a case and values of a material without which the limit is not known.
    requires_by : mapping of str to mapping of str to tuple of str
        What else is required, by option and by those of its values that require more.
    instead : mapping of str to tuple of str
        By a required value of a material, the mark and the value that takes its place where the
        mark is 1.
    or_field : mapping of str to str
        By a required value of a material, the field of a case that bounds the same. The material
        may lack its value where the case gives this field; otherwise both count.
    bodies : tuple of str
        Bodies that the limit concerns.
    bounded : bool
        Whether a utilisation above 1 exceeds the limit. False where it only makes the life finite.
    beside : bool
        Whether the limit is a second model of an end that another limit has. It does not enter the
        first limit.
    evidence_of : str
        Name of the limit of whose end this one knows other tests, or an empty text. The range of
        the life to that end reaches to the life by this limit, see
        `trackroller.damage.first_limit.with_evidence`.
    line : str
        What the tests are that a life by fatigue follows from, or an empty text.
    distribution : str
        What the failure probability of the life rests on: "S-N scatter", "Weibull 10/9", "none".
    compares : tuple of str
        The result of which the largest value is compared, or the first of several that is there,
        and the words of the value that it must not exceed.
    standard : str
        The standard that the limit follows, or an empty text.
    assumes : tuple of str
        Assumptions as sentences, for the sheet.
    short : str
        Word for it in headlines and tables; the title without its remark in brackets if it is not
        given.
    """

    name: str
    title: str
    group: str
    evaluate: Callable[[SolvedRollers], Values]
    use: Callable[[SolvedRollers, Values], LimitUse] | None = None
    meaning: str = ""
    needs: tuple[str, ...] = ()
    shared: Callable[[SolvedRollers], Values] | None = None
    bound: Callable[[SolvedRollers], np.ndarray] | None = None
    shared_by_mechanics: bool = True
    results: tuple[Variable, ...] = ()
    parameters: tuple[Parameter, ...] = ()
    materials: tuple[Parameter, ...] = ()
    mappings: tuple[MappingField, ...] = ()
    requires: tuple[str, ...] = ()
    requires_by: Mapping[str, Mapping[str, tuple[str, ...]]] = field(default_factory=dict)
    instead: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    or_field: Mapping[str, str] = field(default_factory=dict)
    bodies: tuple[str, ...] = BODIES
    bounded: bool = True
    beside: bool = False
    evidence_of: str = ""
    line: str = ""
    distribution: str = "none"
    compares: tuple[str, str] = ("", "")
    standard: str = ""
    assumes: tuple[str, ...] = ()
    short: str = ""

    @property
    def rivals(self) -> bool:
        """Return whether the limit is a second model that may turn a verdict: other tests of an end
        turn none, because the range of its life counts them.
        """
        return self.beside and not self.evidence_of

    @property
    def word(self) -> str:
        """Return the word for the limit in headlines and tables."""
        return self.short or self.title.partition(" (")[0]

    def required(self, options: Mapping[str, Any]) -> tuple[str, ...]:
        """Return the fields of a case and values of a material that the limit requires under
        options of a solution.
        """
        return self.requires + tuple(
            name for key, own in self.requires_by.items() for name in own.get(options[key], ())
        )

    def required_of(self, solved: SolvedRollers) -> Iterator[tuple[str, np.ndarray]]:
        """Yield each value of a material that the limit requires, and of which bodies, (n, 2)."""
        for name in self.required(solved.options):
            if name in solved.materials:
                mark, other = self.instead.get(name, (name, ""))
                marked = (solved.materials[mark] == 1.0) & (other != "")
                counts = ~marked
                if name in self.or_field:
                    given = ~missing(solved.cases[self.or_field[name]])[:, None]
                    counts &= ~(given & np.isnan(solved.materials[name]))
                yield from ((name, counts), *(((other, marked),) if other else ()))

    def lacking(self, solved: SolvedRollers) -> np.ndarray:
        """Return where a value that the limit of a body requires is not given, (n, body) bool."""
        out = np.zeros((len(solved.rolling_radius), len(BODIES)), dtype=bool)
        for name in self.required(solved.options):
            column = solved.cases.get(name)
            if column is not None:
                out |= missing(column)[:, None] & [name not in OF_GUIDE, True]
        for name, concerned in self.required_of(solved):
            out |= np.isnan(solved.materials[name]) & concerned
        return out

    def served(self, solved: SolvedRollers) -> np.ndarray:
        """Return which cases have all that the limit of a body requires, or give a field that
        serves this limit alone, (n,) bool.
        """
        own = [
            *(one.name for one in self.parameters if one.allow_missing),
            *(one.name for one in self.mappings),
        ]
        out = np.asarray(~self.lacking(solved).all(axis=1))
        for name in own:
            if name in solved.cases:
                out |= ~missing(solved.cases[name])
        return out

    def kept_by_bound(self, solved: SolvedRollers) -> np.ndarray:
        """Return which bodies get a bound of the utilisation in place of the number, (n, body)
        bool.

        The bound shows that they keep the limit at the worse ends of the placeholders, too.
        """
        asked = self.name in solved.options.get("at_most", ())
        if self.bound is None or not asked or self.group in solved.options["outputs"]:
            return np.zeros((len(solved.rolling_radius), len(BODIES)), dtype=bool)
        return np.asarray(self.bound(solved.at_end(0)) < 1.0)

    def moves(self, solved: SolvedRollers) -> np.ndarray:
        """Return whose use of the limit rests on a value of a material that is known within a
        range only, (n,) bool.
        """
        out = np.zeros(len(solved.rolling_radius), dtype=bool)
        for name, _ in self.required_of(solved):
            if name in solved.ends:
                out |= np.any(solved.ends[name] != 1.0, axis=(1, 2))
        return out


def variables(group: str, *rows: tuple[Any, ...]) -> tuple[Variable, ...]:
    """Return variables from rows of name, dimensions, unit, symbol, long name, and perhaps further
    fields (mapping).
    """
    return tuple(
        Variable(name, group, *columns[:4], **dict(*columns[4:])) for name, *columns in rows
    )


def optional(
    name: str,
    symbol: str,
    unit: str,
    meaning: str,
    lower: float,
    upper: float = math.inf,
    closed: bool = False,
) -> Parameter:
    """Return a field of a case or a value of a material that may be left out; `closed` allows its
    bounds.
    """
    open_upper = not closed and math.isfinite(upper)
    return Parameter(
        name,
        symbol,
        unit,
        math.nan,
        meaning,
        lower,
        upper,
        not closed,
        open_upper,
        allow_missing=True,
        label=meaning,
    )
