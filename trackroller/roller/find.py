"""How far a parameter of a roller may go until a condition on its results is no longer met:
`tr.find`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.damage import groups_of
from trackroller.damage.first_limit import GROUP as LIMITS_GROUP
from trackroller.errors import InputError, unknown_name
from trackroller.materials import MaterialDatabase, load_database
from trackroller.numerics.brackets import narrowed
from trackroller.numerics.numbers import number_in
from trackroller.numerics.units import without_units
from trackroller.parameters import PARAMETERS, REGIMES, Parameter
from trackroller.parameters.expressions import condition as meets
from trackroller.parameters.expressions import names
from trackroller.roller.aliases import ALIASES, RADII
from trackroller.roller.case import Case
from trackroller.roller.doubts import doubts_of_case
from trackroller.roller.output_names import PARTS, unit_of
from trackroller.roller.solver import solve

if TYPE_CHECKING:
    import xarray as xr

STEPS = 24  # values tried on either side of the case
RATIO = 16.0  # a value of one sign is tried from a sixteenth to sixteen times the case's
PARTS_OF_A_STEP = (8,) * 5  # each round cuts the step that holds an end into so many parts
ROUNDING = 1e-9  # of a life, below which its ends are one
LARGEST = 1e300  # largest finite end of a search
STATUS = "status"  # group of results that are always there


@dataclass(frozen=True)
class FoundRange:
    """The range of a parameter in which a condition is met.

    Attributes
    ----------
    name, unit : str
        The parameter.
    condition : str
        The condition.
    start : float
        Value of the case.
    low, high : float
        Ends of the range that holds the case's value, or that lies next to it if the case itself
        does not meet the condition; NaN if no value meets it.
    tried : tuple of float
        Smallest and largest value that was tried. An end of the range that equals one of these is
        no limit.
    below, above : str
        What is the case just outside either end; an empty text where the search ended.
    notes : tuple of str
        What the condition does not count: ends of the range of a life, and a guide whose hours are
        not known.
    """

    name: str
    unit: str
    condition: str
    start: float
    low: float
    high: float
    tried: tuple[float, float]
    below: str
    above: str
    notes: tuple[str, ...] = ()

    @property
    def value(self) -> float:
        """Return the end of the range that is a limit; the one nearer to the start of two, NaN if
        there is none.
        """
        ends = [end for end, why in ((self.low, self.below), (self.high, self.above)) if why]
        return min(ends, key=lambda end: abs(end - self.start), default=math.nan)

    @property
    def met(self) -> bool:
        """Return whether any value meets the condition."""
        return not math.isnan(self.low)

    def as_dict(self) -> dict[str, Any]:
        """Return the attributes and the answer in words, as values of JSON; a number that is not
        known is None.
        """
        numbers = {key: getattr(self, key) for key in ("start", "low", "high", "value")}
        known = dict.fromkeys(numbers) | {
            key: number for key, number in numbers.items() if math.isfinite(number)
        }
        texts = {
            key: getattr(self, key)
            for key in ("name", "unit", "condition", "below", "above", "text")
        }
        return {**known, **texts, "tried": list(self.tried)}

    @property
    def text(self) -> str:
        """Return the answer in words."""
        unit = f" {self.unit}"
        if self.unit == "-":
            unit = ""
        words = PARAMETERS[self.name].long_name
        tried = f"{self.tried[0]:.4g} and {self.tried[1]:.4g}{unit}"
        if not self.met:
            return " ".join(
                [f"No {words} between {tried} meets '{self.condition}': {self.below}", *self.notes]
            )
        now = f"now {self.start:g}{unit}"
        if not self.low <= self.start <= self.high:
            now += ", where it is not met"
        sentences = [
            f"'{self.condition}' is met from {self.low:.6g} to {self.high:.6g}{unit} of {words} "
            f"({now})."
        ]
        open_ends = []
        for side, end, results in (
            ("Below", self.low, self.below),
            ("Above", self.high, self.above),
        ):
            if results:
                sentences.append(f"{side} {end:.6g}{unit}: {results}")
            else:
                open_ends.append(f"{end:.4g}{unit}")
        if open_ends:
            sentences.append(f"The search ended at {' and '.join(open_ends)}.")
        return " ".join([*sentences, *self.notes])


def find(
    case: Case | Mapping[str, Any],
    name: str,
    condition: str,
    *,
    between: tuple[float, float] | None = None,
    database: MaterialDatabase | None = None,
    **options: Any,
) -> FoundRange:
    """Find the values of a parameter for which a roller meets a condition.

    Parameters
    ----------
    case : Case or mapping
        The roller with its loads.
    name : str
        The parameter that is changed, such as "axial_force".
    condition : str
        Comparisons of results with one number a case, such as "pair_life_to_first_limit_hours >=
        10500 h and slip < 0.01"; see `trackroller.roller.output_names` for the names. `regime` and
        parameters may be compared, too.
    between : tuple of float, optional
        Values between which the parameter is tried, in its unit. Default: a sixteenth to sixteen
        times the value of the case; for a parameter of either sign, four times the size of the
        larger of value and example both ways. Bounds of the parameter cut both, and `between` is
        widened to the case's value; the notes tell both.
    database : MaterialDatabase, optional
        Materials; the built-in ones and the user's own if not given.
    **options
        Options of `trackroller.solve`.

    Returns
    -------
    FoundRange
        The range of values that meet the condition and holds the case's value, or is next to it.

    Raises
    ------
    InputError
        If a name is unknown, the condition is no comparison, the parameter cannot be changed, or
        `between` is no pair of different finite numbers or lies outside the bounds of the
        parameter.

    Notes
    -----
    The search tries 49 values, and then cuts the steps at both ends of the range into eight parts,
    five times. An interval that lies between two tried values is not seen. Values that the program
    refuses do not meet the condition.

    Examples
    --------
    >>> import trackroller as tr
    >>> free = {"friction_coefficient": 0, "motor_force": 0}
    >>> found = tr.find(free, "axial_force", "regime == rolling", contact_model="sliding")
    >>> round(found.high, 2)  # F_rad tan(alpha)
    115.47
    """
    if isinstance(case, Case):
        given = case
    else:
        given = Case(**case)
    name = ALIASES.get(name, name)
    if name in RADII:
        remedy = "Find axis_distance: with the groove it gives the outer radius."
        raise InputError("find", name, "a parameter that the case keeps", remedy)
    if name not in PARAMETERS:
        raise unknown_name("find", name, PARAMETERS)
    start = getattr(given, name)
    if not isinstance(start, (int, float)) or not math.isfinite(start):
        raise InputError(
            "find", name, "a parameter with a number in the case", f"Give the case a finite {name}."
        )
    search = _RangeSearch(given, name, condition, database, options)
    notes: list[str] = []
    if between is not None:
        between, notes = _cut(PARAMETERS[name], float(start), between)
    return search.range_around(
        float(start), _values(PARAMETERS[name], float(start), between), notes
    )


def _cut(parameter: Parameter, start: float, between: Any) -> tuple[tuple[float, float], list[str]]:
    """Return the range to search, within the bounds of a parameter and with the start in it, and
    what was changed.
    """
    allowed = f"two different finite numbers [{parameter.unit}], each {parameter.allowed()}"
    remedy = f"Write between=(lowest, highest) in {parameter.unit}, or leave it out."
    if isinstance(between, (str, Mapping)) or not isinstance(between, Iterable):
        raise InputError("between", between, allowed, remedy)
    given = list(between)
    finite = [
        number_in(end, "between", allowed, -LARGEST, LARGEST, parameter.unit) for end in given
    ]
    if len(finite) != 2 or finite[0] == finite[1]:
        raise InputError("between", given, allowed, remedy)
    low = max(min(finite), parameter.lower)
    high = min(max(finite), parameter.upper)
    if low >= high:
        raise InputError("between", given, allowed, remedy, "lies outside the bounds")
    if parameter.unit == "-":
        unit = ""
    else:
        unit = f" {parameter.unit}"
    notes = []
    if (low, high) != (min(finite), max(finite)):
        notes.append(
            f"The search was cut to {low:g} to {high:g}{unit}, the bounds of {parameter.long_name}."
        )
    if not low <= start <= high:
        notes.append(f"The search was widened to the value of the case, {start:g}{unit}.")
    return (min(low, start), max(high, start)), notes


def _toward(start: float, end: float) -> np.ndarray:
    """Return the values from the start to an end of the search, without the start.

    Even steps miss what lies near the start if the end is far away, so that the steps grow where
    the end is more than `RATIO` times the start away.
    """
    distance = abs(end - start)
    near = abs(start) or 1.0
    steps = np.linspace(0.0, distance, STEPS + 1)[1:]
    if distance > RATIO * near:
        steps = np.geomspace(near / STEPS, distance, STEPS)
    values = start + math.copysign(1.0, end - start) * steps
    values[-1] = end
    return np.asarray(values)


def _values(parameter: Parameter, start: float, between: tuple[float, float] | None) -> np.ndarray:
    """Return the values to try first, rising, the start among them."""
    signed = parameter.lower < 0.0 < parameter.upper
    if between is not None:
        values = np.concatenate(
            [_toward(start, between[0])[::-1], [start], _toward(start, between[1])]
        )
    elif signed or start == 0.0:
        example = 0.0
        if math.isfinite(parameter.default):
            example = abs(parameter.default)
        width = 4.0 * max(abs(start), example, 1e-6)
        values = start + width * np.linspace(-1.0, 1.0, 2 * STEPS + 1)
    else:
        values = np.sort(start * RATIO ** np.linspace(-1.0, 1.0, 2 * STEPS + 1))
    values[np.argmin(np.abs(values - start))] = start
    return np.unique(values[parameter.accepts(values)])


def _run_around(is_met: np.ndarray, distance: np.ndarray) -> tuple[int, int]:
    """Return first and last place of the run of places that meet a condition, around the nearest of
    them.
    """
    inside = int(np.flatnonzero(is_met)[np.argmin(distance[is_met])])
    first, last = inside, inside
    while first > 0 and is_met[first - 1]:
        first -= 1
    while last < len(is_met) - 1 and is_met[last + 1]:
        last += 1
    return first, last


class _RangeSearch:
    """Solve a roller at values of one parameter, and compare its results."""

    def __init__(
        self,
        case: Case,
        name: str,
        condition: str,
        database: MaterialDatabase | None,
        options: Mapping[str, Any],
    ) -> None:
        self.case = case
        self.name = name
        self.database = database
        self.plain = without_units(condition, unit_of, "find")
        self.condition = condition
        used = names(self.plain, "find") - set(REGIMES)
        for word in used - {"regime"}:
            if word not in PARTS and word not in PARAMETERS:
                raise unknown_name("find", word, (*PARTS, "regime", *PARAMETERS))
        self.results = sorted(used & set(PARTS))
        self.parameters = sorted(used & set(PARAMETERS))
        groups = {PARTS[result].variable.group for result in self.results} - {STATUS}
        if LIMITS_GROUP in groups:
            groups |= set(groups_of("find", ["all"]))
        self.options = {**options, "outputs": tuple(sorted(groups | {"forces"}))}
        self.ranged: set[str] = set()

    def at(self, values: Iterable[float]) -> list[tuple[bool, str]]:
        """Return for each value whether the condition is met, and what the results are."""
        answers: list[tuple[bool, str]] = []
        cases: dict[int, Case] = {}
        for number, value in enumerate(values):
            answers.append((False, ""))
            try:
                cases[number] = replace(self.case, **{self.name: float(value)})
            except InputError as error:
                answers[number] = (False, f"it is refused: {error.errors[0]}")
        if cases:
            for number, answer in zip(cases, self._solved(list(cases.values())), strict=True):
                answers[number] = answer
        return answers

    def _solved(self, cases: list[Case]) -> list[tuple[bool, str]]:
        ds = solve(cases, database=self.database, **self.options)
        columns: dict[str, Any] = {
            one: PARTS[one].values(ds).values
            for one in self.results
            if PARTS[one].variable.name in ds
        }
        lacking = [one for one in self.results if one not in columns]
        if lacking:
            raise InputError(
                "find", self.condition, f"results of this roller; it has no {', '.join(lacking)}"
            )
        for result in self.results:
            low = PARTS.get(f"{result}_low")
            if low is None or low.variable.name not in ds:
                continue
            if (low.values(ds).values < columns[result] * (1.0 - ROUNDING)).any():
                self.ranged.add(result)
        regime = ds["regime"].values
        columns["regime"] = np.array(REGIMES, dtype=object)[regime]
        columns |= {
            one: np.array([getattr(case, one) for case in cases], dtype=object)
            for one in self.parameters
        }
        words = {**columns, **{regime: regime for regime in REGIMES}}
        is_met = np.broadcast_to(meets(self.plain, words, "find"), (len(cases),))
        answers = []
        for i, good in enumerate(is_met.tolist()):
            parts = [
                f"{name} {self._band(ds, name, i, float(columns[name][i]))}"
                for name in self.results
            ]
            if regime[i] != REGIMES.index("rolling") or not parts:
                parts.insert(0, REGIMES[regime[i]].replace("_", " "))
            answers.append((bool(good), ", ".join(parts) + "."))
        return answers

    def _band(self, ds: xr.Dataset, name: str, place: int, value: float) -> str:
        """Write a result, and both ends of its range where placeholders give it one."""
        ends = [PARTS.get(f"{name}_{end}") for end in ("low", "high")]
        if any(one is None or one.variable.name not in ds for one in ends):
            return f"{value:.5g}"
        low, high = (float(one.values(ds).values[place]) for one in ends if one is not None)
        if not low < high * (1.0 - ROUNDING):
            return f"{value:.5g}"
        return f"{value:.5g} ({low:.4g} to {high:.4g})"

    def notes(self) -> tuple[str, ...]:
        """Say what the condition does not count."""
        sentences = [
            f"{one} holds at the values of the placeholders; {one}_low is surely reached."
            for one in sorted(self.ranged)
        ]
        alone = (
            self.case.guide_overrollings_per_hour is None
            and self.name != "guide_overrollings_per_hour"
        )
        if alone and any(one.startswith("pair_life") for one in self.results):
            sentences.append("The guide's hours are not known: give guide_overrollings_per_hour.")
        return tuple(sentences)

    def odd_at(self, value: float) -> list[str]:
        """Return the doubts about the case with another value that the case itself does not
        have.
        """
        database = self.database
        if database is None:
            database = load_database()
        try:
            changed = replace(self.case, **{self.name: value})
        except InputError:  # the search tells that it is refused
            return []
        of_case = doubts_of_case(self.case, database)
        return [text for text in doubts_of_case(changed, database) if text not in of_case]

    def range_around(
        self, start: float, values: np.ndarray, notes: Iterable[str] = ()
    ) -> FoundRange:
        """Return the range of values that meet the condition and holds the start, or is next to it.

        The `notes` are added to those of the search.
        """
        answers = self.at(values)
        is_met = np.array([good for good, _ in answers])
        tried = (float(values[0]), float(values[-1]))
        unit = PARAMETERS[self.name].unit
        if not is_met.any():
            nearest = answers[int(np.argmin(np.abs(values - start)))][1]
            why = f"now {nearest}"
            none = math.nan
            return FoundRange(
                self.name,
                unit,
                self.condition,
                start,
                none,
                none,
                tried,
                why,
                "",
                (*self.notes(), *notes),
            )
        first, last = _run_around(is_met, np.abs(values - start))
        # of each end, the last value that meets the condition and the first one beyond; an open end
        # has no bracket
        brackets: dict[int, tuple[float, float]] = {}
        results: dict[float, str] = {}
        for side, last_inside, beyond in ((0, first, first - 1), (1, last, last + 1)):
            if 0 <= beyond < len(values):
                brackets[side] = (float(values[last_inside]), float(values[beyond]))
                results[float(values[beyond])] = answers[beyond][1]

        def meets_at(_: list[int], inner: list[float]) -> list[bool]:
            of_inner = self.at(inner)
            results.update(zip(inner, (text for _, text in of_inner), strict=True))
            return [good for good, _ in of_inner]

        closer = narrowed(list(brackets.values()), PARTS_OF_A_STEP, meets_at)
        ends = [float(values[first]), float(values[last])]
        texts = ["", ""]
        for side, (met, beyond_end) in zip(brackets, closer, strict=True):
            ends[side] = met
            texts[side] = results[beyond_end]
        low, high = ends
        odd = dict.fromkeys(text for end in (low, high) for text in self.odd_at(end))
        notes = (*self.notes(), *notes, *(f"Doubtful: {text}" for text in odd))
        return FoundRange(
            self.name, unit, self.condition, start, low, high, tried, texts[0], texts[1], notes
        )
