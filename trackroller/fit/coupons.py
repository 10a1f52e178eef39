"""Fit the S-N line of a material to coupons: amplitude, cycles, failed or run-out.

How the line enters a life of a roller: the program takes the peak von Mises stress of an overrolling as a fully
reversed amplitude. The amplitude of a coupon under bending or axial load equals its von Mises amplitude, and that of a
coupon under torsion is multiplied by sqrt(3). A mean stress of the coupons is not corrected, and neither is their size.

The fitted line is free of the tensile strength: sigma_D, N_k and k define it, and the cycles N_Rm, at which it reaches
R_m, follow from them.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from trackroller.errors import InputError, check_names, listing
from trackroller.fit.fitted import Fit, Group
from trackroller.fit.line import BOUNDS, Line, Tests
from trackroller.fit.posterior import Normal, ln_range
from trackroller.fit.table import LEAST, TestTable, read_tests
from trackroller.numerics.numbers import number_or_nan

NEEDED = ("amplitude", "cycles", "failed")
COLUMNS = (*NEEDED, "group", "test", "note")
LOAD_TYPES = {
    "rotating bending": (1.0, "the bending amplitude is taken as von Mises amplitude"),
    "bending": (1.0, "the bending amplitude is taken as von Mises amplitude"),
    "axial": (1.0, "the axial amplitude is the von Mises amplitude"),
    "torsion": (math.sqrt(3.0), "sqrt(3) times the amplitude of the shear stress is the von Mises amplitude"),
    "rolling contact": (1.0, "the amplitude is the peak von Mises stress of an overrolling"),
}
YES = ("1", "1.0", "true", "yes", "y", "failed", "failure", "fracture", "broken", "ja", "x")
NO = ("0", "0.0", "false", "no", "n", "run-out", "runout", "run out", "survived", "suspended", "nein", "none")
FEWEST_CYCLES = 1_000.0  # below it, a number of cycles that is not whole may be a travel
TRAVEL = "If it is a travel in km, fit rollers with `trackroller fit bench`."
NO_LIMIT = (
    "No fatigue limit makes the tests likelier than the line alone, on which run-outs are long lives: the line was "
    "fitted without a limit."
)
DEFAULT_KNEE = 2e6  # cycles at which a line without run-outs states its strength


def fit_sn(  # noqa: PLR0913 - one argument for each choice of a fit
    table: Any,
    *,
    name: str = "",
    load_type: str | None = None,
    stress_ratio: float | None = None,
    group: str | None = None,
    slope: float | None = None,
    scatter_in_cycles: float | None = None,
    knee: bool | None = None,
    like: str | None = None,
    prior: Mapping[str, Sequence[float]] | None = None,
) -> Fit:
    """Fit an S-N line with its scatter, and with its fatigue limit if specimens ran out, to a table of coupons.

    Parameters
    ----------
    table : path, data frame, list of mappings or mapping of columns
        Columns `amplitude [MPa]`, `cycles` and `failed` (yes or no), and if wanted `group`, `test` and `note`.
    name : str
        Name of the material that is made.
    load_type : str, optional
        How the coupons were loaded: "rotating bending", "bending", "axial", "torsion" or "rolling contact".
    stress_ratio : float, optional
        Smallest over largest stress of a cycle, -1 for full reversal [1].
    group : str, optional
        The group to fit, if the table has several in its column `group`.
    slope, scatter_in_cycles : float, optional
        Slope k and scatter T_N that are held [1]; by default both are fitted.
    knee : bool, optional
        Whether a fatigue limit with its own scatter is fitted; by default if failures and run-outs meet, and a limit
        makes the tests likelier than the line alone.
    like : str, optional
        A material whose other values, such as E and R_m, the fitted one takes.
    prior : mapping, optional
        Priors of the posterior: {"slope": [mean, sd], "scatter_in_cycles": [median, sd of ln], "fatigue_strength":
        [median in MPa, sd of ln]}. Others are flat. The intervals take no prior.

    Returns
    -------
    Fit
        `.material`, `.data`, `.interval(...)` and `.report(path)`.

    Raises
    ------
    InputError
        For a table that no line can be fitted to; the message names row and column.

    Examples
    --------
    >>> rows = {"amplitude": [900, 900, 800, 800, 700, 700], "cycles": [9e4, 1.3e5, 2e5, 3.5e5, 8e5, 1e6],
    ...         "failed": [True] * 6}
    >>> fit = fit_sn(rows, load_type="axial", stress_ratio=-1)
    >>> round(fit.material["woehler_exponent"], 2)
    8.42
    """
    tests = read_tests(table, NEEDED, COLUMNS, ("group", "test", "note"))
    if load_type is not None:
        check_names("load type", [load_type], LOAD_TYPES)
    ratio = math.nan if stress_ratio is None else number_or_nan(stress_ratio)
    if stress_ratio is not None and not ratio < 1.0:
        raise InputError("stress ratio", stress_ratio, "a number below 1", "Give -1 for full reversal.")
    tests = _of_group(tests, group)
    factor = LOAD_TYPES[load_type][0] if load_type else 1.0
    check_held(slope, scatter_in_cycles)
    observed = _observed(tests, factor)
    _check_duplicates(tests)
    if slope is None:
        check_falls(tests, observed, "cycles")
    _check_identified(tests, observed, slope, scatter_in_cycles)
    meet = _limit_shows(observed) if knee is None else knee
    held = None if scatter_in_cycles is None else deviation_of(scatter_in_cycles)
    line = Line(observed, slope=slope, scatter=held, knee=meet)
    if line.size <= len(line.free):
        allowed = f"more rows than fitted values; {listing([*line.free])} are {len(line.free)} values"
        raise InputError("tests", line.size, allowed, "Test more specimens, or hold slope or scatter_in_cycles.")
    priors = priors_of(prior)
    given = {
        "load type": load_type or "not given",
        "stress ratio": "not given" if stress_ratio is None else f"{ratio:g}",
    }
    notes = _notes(load_type, ratio, meet, observed)
    if knee is None and meet and not line.limit_matters:
        line = replace(line, knee=False)
        notes.append(NO_LIMIT)
    own = Group("fatigue", line, priors, at=_stated_at(line))
    return Fit("sn", name or "fitted material", (own,), tests, like, given, notes)


def _too_flat(field: str, slope: Any) -> InputError:
    """Return the error about a slope that no S-N line has, but Basquin's b = 1/k."""
    number = number_or_nan(slope)
    meant = (
        f"If Basquin's b is meant, the slope is k = 1/b: write {1.0 / abs(number):.3g}." if 0 < abs(number) < 1 else ""
    )
    return InputError(field, slope, "a number of at least 1", meant)


def priors_of(given: Mapping[str, Sequence[float]] | None) -> dict[str, Normal]:
    """Return the priors of a line by the names of its values, from those of a user; see `fit_sn`."""
    given = dict(given or {})
    check_names("prior", given, ("slope", "scatter_in_cycles", "fatigue_strength"))
    found = {}
    for name, pair in given.items():
        allowed = "[mean, standard deviation > 0] of the slope" if name == "slope" else "[median > 0, sd of ln > 0]"
        if not isinstance(pair, Sequence) or isinstance(pair, str) or len(pair) != 2:
            raise InputError(f"prior.{name}", pair, allowed)
        middle, deviation = map(number_or_nan, pair)
        if not (middle > 0 and deviation > 0):
            raise InputError(f"prior.{name}", list(pair), allowed)
        if name == "slope":
            if middle < 1.0:
                raise _too_flat("prior.slope", middle)
            found["slope"] = Normal(middle, deviation)
        elif name == "scatter_in_cycles":  # ln s of T_N = exp(2.563 s)
            own = math.log(middle) / math.log(ln_range(1.0))
            found["log_scatter"] = Normal(math.log(own), deviation / math.log(middle))
        else:
            found["log_strength"] = Normal(math.log(middle), deviation)
    return found


def _of_group(tests: TestTable, group: str | None) -> TestTable:
    """Return the rows of one group; refuse a table with several groups of which none is asked for."""
    found = Counter(tests.text(row, "group") for row in tests)
    if group is not None:
        rows = [row for row in tests if tests.text(row, "group") == group]
        if not rows:
            raise InputError("group", group, f"a group of the table: {listing(sorted(found), 'or')}")
        return tests.keep(rows)
    if len(found) > 1:
        first = tests.text(0, "group")
        row = next(row for row in tests if tests.text(row, "group") != first)
        allowed = f"one group; the table mixes {listing(sorted(map(repr, found)))}"
        raise tests.error(row, "group", allowed, "Choose one with --group NAME (group=), and fit each alone.")
    return tests


def _observed(tests: TestTable, factor: float) -> Tests:
    """Return amplitude and cycles of each row as logarithms."""
    stress, low, high = [], [], []
    for row in tests:
        amplitude = tests.number(row, "amplitude", LEAST)
        cycles = tests.number(row, "cycles", LEAST, math.inf)
        for column, value in (("amplitude", amplitude), ("cycles", cycles)):
            if math.isnan(value):
                raise tests.error(row, column, "a number; the cell is empty", "Fill the cell, or remove the row.")
        if cycles < FEWEST_CYCLES and not cycles.is_integer():
            raise tests.error(row, "cycles", "a whole number of load cycles", TRAVEL)
        if math.isinf(cycles):
            remedy = "Write the cycles at which the specimen was stopped, with failed = no."
            raise tests.error(row, "cycles", "a finite number of load cycles", remedy)
        word = tests.text(row, "failed").lower()
        if word not in (*YES, *NO):
            raise tests.error(row, "failed", "yes or no, 1 or 0, failed or run-out", "Correct the cell.")
        stress.append(math.log(factor * amplitude))
        low.append(math.log(cycles))
        high.append(math.log(cycles) if word in YES else math.inf)
    if max(low) < math.log(FEWEST_CYCLES):
        longest = int(np.argmax(low))
        allowed = f"a life of at least {FEWEST_CYCLES:g} cycles in one row; this one is the longest"
        raise tests.error(longest, "cycles", allowed, TRAVEL)
    return Tests(np.array(stress), np.array(low), np.array(high))


def _check_duplicates(tests: TestTable) -> None:
    """Refuse a name that stands twice, and two failures without names that are equal to the last digit."""
    seen: dict[tuple, int] = {}
    for row in tests:
        name = tests.text(row, "test")
        failure = tests.text(row, "failed").lower() in YES
        key = ("test", name) if name else ("", *(tests.number(row, n) for n in ("amplitude", "cycles")))
        if (name or failure) and key in seen:
            other = tests.lines[seen[key]]
            remedy = "Remove one of the two; if both were tested, name them in a column `test`."
            wrong = f"stands in row {other} as well"
            raise tests.error(row, "test" if name else "cycles", "each test once", remedy, wrong)
        seen[key] = row


def deviation_of(scatter_in_cycles: float) -> float:
    """Return the standard deviation of ln N of a scatter T_N."""
    return math.log(scatter_in_cycles) / math.log(ln_range(1.0))


def check_held(slope: float | None, scatter_in_cycles: float | None) -> None:
    """Refuse a slope or scatter that is held outside the bounds of a line."""
    low, high = BOUNDS["slope"]
    if slope is not None and 0 < abs(number_or_nan(slope)) < low:
        raise _too_flat("slope", slope)
    if slope is not None and not low <= number_or_nan(slope) <= high:
        raise InputError("slope", slope, f"a number from {low:g} to {high:g}", "Give k of N = c S^-k, such as 8.")
    low, high = (ln_range(math.exp(end)) for end in BOUNDS["log_scatter"])
    if scatter_in_cycles is not None and not low <= number_or_nan(scatter_in_cycles) <= high:
        allowed = f"a number from {low:.3g} to {high:.3g}"
        raise InputError("scatter", scatter_in_cycles, allowed, "Give T_N = N_90/N_10, such as 4.")


def check_falls(tests: TestTable, observed: Tests, column: str, rows: Sequence[int] | None = None) -> None:
    """Refuse lives that grow with the stress beyond chance.

    Parameters
    ----------
    tests : TestTable
        The table.
    observed : Tests
        Stresses and lives.
    column : str
        Column of the lives, for the message.
    rows : sequence of int, optional
        Row of the table of each test; by default all rows in their order.
    """
    own = observed.failed
    if own.sum() < 3 or np.ptp(observed.stress[own]) < 1e-9:
        return
    from scipy import stats  # heavy, and a sheet of a fitted material needs no regression

    found = stats.linregress(observed.stress[own], observed.middle[own])
    if found.slope > 0 and found.pvalue < 0.1:
        place = int(np.flatnonzero(own)[np.argmax(observed.middle[own])])
        allowed = "lives that fall with the stress; these grow, as a line with a negative slope"
        remedy = "Look whether columns or groups were mixed up."
        raise tests.error(place if rows is None else rows[place], column, allowed, remedy)


def _check_identified(tests: TestTable, observed: Tests, slope: float | None, scatter: float | None) -> None:
    """Refuse one level with a free slope, and run-outs alone with free values."""
    last = len(tests) - 1
    free = [name for name, value in (("slope", slope), ("scatter_in_cycles", scatter)) if value is None]
    if free and not observed.failed.any():
        allowed = "at least one failure; all specimens ran out"
        remedy = f"Hold {listing(free)} for a one-sided bound, or test at a higher amplitude."
        raise tests.error(last, "failed", allowed, remedy)
    if slope is None and np.ptp(observed.stress) < 1e-9:
        remedy = "Hold the slope (--slope 8), or test a second amplitude."
        raise tests.error(last, "amplitude", "a second level beside this one, from which the slope follows", remedy)
    own = observed.stress[observed.failed]
    if slope is None and own.size and np.ptp(own) < 1e-9:
        remedy = "Hold the slope (--slope 8), or test another amplitude to failure."
        raise tests.error(last, "amplitude", "failures at two levels or more, from which the slope follows", remedy)


def _limit_shows(observed: Tests) -> bool:
    """Return whether run-outs are as long as the longest failures, so that a fatigue limit shows."""
    failed = observed.failed
    if (~failed).sum() < 2 or failed.sum() < 2:
        return False
    return bool(observed.low[~failed].max() >= observed.middle[failed].max() - 0.1)


def _stated_at(line: Line) -> float:
    """Return the cycles at which a line without fatigue limit states its strength: the longest test, rounded up."""
    longest = float(np.exp(line.tests.low[np.isfinite(line.tests.low)].max()))
    return max(DEFAULT_KNEE, 10.0 ** math.ceil(math.log10(longest)))


def _notes(load_type: str | None, ratio: float, knee: bool, observed: Tests) -> list[str]:
    """Return sentences on how the line enters a life."""
    said = []
    if load_type is None:
        said.append("The load type was not given: the amplitudes are taken as von Mises amplitudes.")
    else:
        said.append(
            f"Load type {load_type}: {LOAD_TYPES[load_type][1]}. A roller is rated by its peak von Mises stress."
        )
    if math.isnan(ratio):
        said.append("The stress ratio was not given: the amplitudes are taken as fully reversed.")
    elif ratio != -1.0:
        said.append(f"Stress ratio {ratio:g}: the amplitudes enter without a correction for the mean stress.")
    levels = Counter(np.round(observed.stress, 9).tolist())
    failing = Counter(np.round(observed.stress[observed.failed], 9).tolist())
    mixed = [level for level in levels if 0 < failing.get(level, 0) < levels[level]]
    if knee and mixed:
        said.append(
            f"{len(mixed)} levels hold failures and run-outs. Their failures count for the slope with the chance to "
            "fail at the level; a fit of the failures alone, or of levels above the limit alone, finds another slope."
        )
    return said


def of_words(words: Collection[str], field: str) -> dict[str, list[float]]:
    """Return priors from words such as slope=8,2 of a command line.

    Raises
    ------
    InputError
        For a word of another form.
    """
    found = {}
    for word in words:
        name, sign, pair = word.partition("=")
        numbers = [number_or_nan(part) for part in pair.split(",")]
        if not sign or len(numbers) != 2 or any(map(math.isnan, numbers)):
            raise InputError(field, word, "NAME=MIDDLE,DEVIATION", "For example slope=8,2")
        found[name.strip()] = numbers
    return found
