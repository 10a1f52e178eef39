"""Fit the S-N line of a material to coupons: amplitude, cycles, failed or run-out.

How the line enters a life of a roller: the program takes the peak von Mises stress of an
overrolling as a fully reversed amplitude. The amplitude of a coupon under bending or axial load
equals its von Mises amplitude, and that of a coupon under torsion is multiplied by sqrt(3). A mean
stress of the coupons is not corrected, and neither is their size.

The fitted line is free of the tensile strength: sigma_D, N_k and k define it, and the cycles N_Rm,
at which it reaches R_m, follow from them.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from trackroller.errors import InputError, check_names, listing
from trackroller.fit.heads import OF_COUPONS, has_failed, only_marks, says_how, told_heads
from trackroller.fit.line import BOUNDS, Line, Tests
from trackroller.fit.material_fit import Group, MaterialFit, check_texts
from trackroller.fit.posterior import Normal, ln_range
from trackroller.fit.table import (
    LEAST,
    LEAST_STRESS,
    MOST_CYCLES,
    MOST_STRESS,
    TestTable,
    read_tests,
)
from trackroller.numerics.numbers import finite_number, number_or_nan
from trackroller.numerics.plain import plain
from trackroller.roller.doubts import sentence_of_unusual

NEEDED = ("amplitude", "cycles")
COLUMNS = (*NEEDED, "failed", "group", "test", "note", "censored", "status")
LOAD_TYPES = {
    "rotating bending": (1.0, "the bending amplitude is taken as von Mises amplitude"),
    "bending": (1.0, "the bending amplitude is taken as von Mises amplitude"),
    "axial": (1.0, "the axial amplitude is the von Mises amplitude"),
    "torsion": (
        math.sqrt(3.0),
        "sqrt(3) times the amplitude of the shear stress is the von Mises amplitude",
    ),
    "rolling contact": (1.0, "the amplitude is the peak von Mises stress of an overrolling"),
}
FEWEST_CYCLES = 1_000.0  # below it, a number of cycles that is not whole may be a travel
STOPPED = "Correct the cell; of a run-out, write the cycles at which the specimen was stopped."
TRAVEL = "If it is a travel in km, fit rollers with `trackroller fit bench`."
NO_LIMIT = (
    "No fatigue limit makes the tests likelier than the line alone, on which run-outs are "
    "long lives: the line was "
    "fitted without a limit."
)
SHOWS_NO_LIMIT = (
    "The run-outs do not show a fatigue limit, as two or more would that are as long as the "
    "longest failures: they count as long lives on the line."
)
# ASSUME: MPa; the largest amplitude of a series, soft polymers to bearing steel
USUAL_AMPLITUDE = (3.0, 5000.0)
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
) -> MaterialFit:
    """Fit an S-N line with its scatter, and with its fatigue limit if specimens ran out, to a table
    of coupons.

    Parameters
    ----------
    table : path, data frame, list of mappings or mapping of columns
        Columns `amplitude [MPa]`, `cycles` and `failed` (yes or no), and if wanted `group`, `test`
        and `note`. A column `censored` or `runout` is the opposite of `failed`; other usual names,
        such as `stress_amplitude_MPa`, `load`, `N`, `specimen` and `fracture`, are taken, and the
        notes of the fit say so.
    name : str
        Name of the material that is made.
    load_type : str, optional
        How the coupons were loaded: "rotating bending", "bending", "axial", "torsion" or "rolling
        contact".
    stress_ratio : float, optional
        Smallest over largest stress of a cycle, -1 for full reversal [1].
    group : str, optional
        The group to fit, if the table has several in its column `group`.
    slope, scatter_in_cycles : float, optional
        Slope k and scatter T_N that are held [1]; by default both are fitted.
    knee : bool, optional
        Whether a fatigue limit with its own scatter is fitted; by default if failures and run-outs
        meet, and a limit makes the tests likelier than the line alone.
    like : str, optional
        A material whose other values, such as E and R_m, the fitted one takes.
    prior : mapping, optional
        Priors of the posterior: {"slope": [mean, sd], "scatter_in_cycles": [median, sd of ln],
        "fatigue_strength": [median in MPa, sd of ln]}. Others are flat. The intervals take no
        prior.

    Returns
    -------
    MaterialFit
        `.material`, `.data`, `.interval(...)` and `.report(path)`.

    Raises
    ------
    InputError
        For a table that no line can be fitted to; the message names row and column.

    Examples
    --------
    >>> rows = {"amplitude": [900, 900, 800, 800, 700, 700], "failed": [True] * 6}
    >>> rows["cycles"] = [9e4, 1.3e5, 2e5, 3.5e5, 8e5, 1e6]
    >>> fit = fit_sn(rows, load_type="axial", stress_ratio=-1)
    >>> round(fit.material["woehler_exponent"], 2)
    8.42
    """
    optional = [column for column in COLUMNS if column not in NEEDED]
    check_texts(name=name, like=like)
    if knee is not None and not isinstance(knee, (bool, np.bool_)):
        raise InputError("knee", knee, "true or false", "Leave it out to let the tests decide.")
    tests = read_tests(table, NEEDED, COLUMNS, optional, OF_COUPONS)
    if load_type is not None:
        check_names("load type", [load_type], LOAD_TYPES)
    if stress_ratio is None:
        ratio = math.nan
    else:
        ratio = finite_number(stress_ratio)
    if stress_ratio is not None and not ratio < 1.0:
        raise InputError(
            "stress ratio", stress_ratio, "a finite number below 1", "Give -1 for full reversal."
        )
    tests = _of_group(tests, group)
    factor = 1.0
    if load_type:
        factor = LOAD_TYPES[load_type][0]
    slope, scatter_in_cycles = check_held(slope, scatter_in_cycles)
    failed = _read_ends(tests)
    observed = _observed(tests, factor, failed)
    _check_duplicates(tests, failed)
    if slope is None:
        check_falls(tests, observed, "cycles")
    _check_identified(tests, observed, slope, scatter_in_cycles)
    has_limit = knee
    if knee is None:
        has_limit = _limit_shows(observed)
    scatter = None
    if scatter_in_cycles is not None:
        scatter = deviation_of(scatter_in_cycles)
    line = Line(observed, slope=slope, scatter=scatter, knee=bool(has_limit))
    _check_number(tests, line)
    priors = priors_of(prior)
    given = {
        "load type": load_type or "not given",
        "stress ratio": "not given" if stress_ratio is None else f"{ratio:g}",
    }
    notes = [*_read_as(tests, failed), *_notes(load_type, ratio, bool(has_limit), observed)]
    notes += _unusual_amplitude(observed, factor)
    if knee is None:
        line, sentences = _decided(line)
        notes += sentences
    fatigue = Group("fatigue", line, priors, at=_stated_at(line))
    return MaterialFit("sn", name or "fitted material", (fatigue,), tests, like, given, notes)


def _check_number(tests: TestTable, line: Line) -> None:
    """Refuse a line with as many fitted values as specimens, or more."""
    lacking = len(line.free) + 1 - line.size
    if lacking <= 0:
        return
    holdable = [option for name, option in HELD.items() if name in line.free]
    remedy = f"Test {lacking} more specimens"
    last_word = "and"
    if lacking == 1:
        remedy = "Test 1 more specimen"
        last_word = "or"
    if lacking <= len(holdable):
        remedy += f", or hold {listing(holdable, last_word)}"
    fitted = f"{listing(line.free)} are {len(line.free)} values"
    allowed = f"more rows than fitted values; {fitted}"
    raise tests.placed(InputError("tests", line.size, allowed, f"{remedy}."))


def _too_flat(field: str, slope: Any) -> InputError:
    """Return the error about a slope that no S-N line has, but Basquin's b = 1/k."""
    number = number_or_nan(slope)
    meant = ""
    if 0 < abs(number) < 1:
        meant = f"If Basquin's b is meant, the slope is k = 1/b: write {1.0 / abs(number):.3g}."
    return InputError(field, slope, "a number of at least 1", meant)


def priors_of(given: Mapping[str, Sequence[float]] | None) -> dict[str, Normal]:
    """Return the priors of a line by the names of its values, from those of a user; see
    `fit_sn`.
    """
    given = {} if given is None else plain(given, "prior")
    if not isinstance(given, Mapping):
        remedy = "Name the value, such as {'slope': [8, 2]}."
        raise InputError(
            "prior", given, f"a mapping from {listing([*PRIORS], 'or')} to two numbers", remedy
        )
    check_names("prior", given, PRIORS)
    priors = {}
    for name, pair in given.items():
        low, high = PRIORS[name]
        first = "median"
        second = "standard deviation of ln"
        if name == "slope":
            first = "mean"
            second = "standard deviation"
        allowed = (
            f"[{first} from {low:.4g} to {high:.4g}, {second} from {LEAST_SPREAD:g} to "
            f"{MOST_SPREAD:g}]"
        )
        remedy = (
            f"For example [{EXAMPLES[name]}], on the command line --prior "
            f"{name}={EXAMPLES[name].replace(' ', '')}."
        )
        if not isinstance(pair, list) or len(pair) != 2:
            raise InputError(f"prior.{name}", pair, allowed, remedy)
        middle, deviation = map(finite_number, pair)
        if name == "slope" and 0 < abs(middle) < low:
            raise _too_flat("prior.slope", middle)
        if not (low <= middle <= high and LEAST_SPREAD <= deviation <= MOST_SPREAD):
            raise InputError(f"prior.{name}", pair, allowed, remedy)
        if name == "slope":
            priors["slope"] = Normal(middle, deviation)
        elif name == "scatter_in_cycles":  # ln s of T_N = exp(2.563 s)
            scatter = math.log(middle) / math.log(ln_range(1.0))
            priors["log_scatter"] = Normal(math.log(scatter), deviation / math.log(middle))
        else:
            priors["log_strength"] = Normal(math.log(middle), deviation)
    return priors


# how a value of a line is held, by its name: on the command line, in Python
HELD = {
    "slope": "the slope (--slope 8)",
    "log_scatter": "the scatter (--scatter 4, in Python scatter_in_cycles=4)",
}


def _range_of_scatter() -> tuple[float, float]:
    """Return the bounds of the scatter T_N."""
    low, high = (ln_range(math.exp(end)) for end in BOUNDS["log_scatter"])
    return low, high


# bounds of the middle of a prior
PRIORS = {
    "slope": BOUNDS["slope"],
    "scatter_in_cycles": _range_of_scatter(),
    "fatigue_strength": (1.0, MOST_STRESS),
}
EXAMPLES = {"slope": "8, 2", "scatter_in_cycles": "4, 0.5", "fatigue_strength": "500, 0.2"}
LEAST_SPREAD = 1e-4  # of a prior
MOST_SPREAD = 1e4


def _of_group(tests: TestTable, group: str | None) -> TestTable:
    """Return the rows of one group; refuse a table with several groups of which none is asked
    for.
    """
    counts = Counter(tests.text(row, "group") for row in tests)
    if group is not None:
        group = str(group)
        rows = [row for row in tests if tests.text(row, "group") == group]
        if not rows:
            names = sorted(filter(None, counts))
            if not names:
                raise InputError(
                    "group", group, "a group of the table, which has none", "Leave the group out."
                )
            raise InputError("group", group, f"a group of the table: {listing(names, 'or')}")
        return tests.keep(rows)
    if len(counts) > 1:
        first = tests.text(0, "group")
        row = next(row for row in tests if tests.text(row, "group") != first)
        allowed = f"one group; the table mixes {listing(sorted(map(repr, counts)))}"
        raise tests.error(
            row, "group", allowed, "Choose one with --group NAME (group=), and fit each alone."
        )
    return tests


def _column_of_ends(tests: TestTable) -> str:
    """Return the column that says which specimens failed; refuse a table with none or two of
    them.
    """
    names = tests.rows[0]
    given = [column for column in ("failed", "censored") if column in names]
    if len(given) == 2:
        heads = [tests.heads.get(column, column) for column in given]
        raise tests.error(
            0,
            "censored",
            "one column that says which specimens failed",
            f"Remove {listing(heads, 'or')}.",
        )
    in_words = [
        column
        for column in ("status", "note")
        if column in names and all(says_how(tests.text(r, column)) for r in tests)
    ]
    if not given and not in_words:
        allowed = (
            "a column failed, with yes for a failure and no for a run-out; or a column "
            "runout, with the opposite"
        )
        remedy = f"The table has {', '.join(tests.heads.get(name, name) for name in names)}."
        raise tests.placed(InputError("column failed", None, allowed, remedy))
    return [*given, *in_words][0]


def _read_ends(tests: TestTable) -> list[bool]:
    """Return which specimens failed, by the codes and words of the table."""
    column = _column_of_ends(tests)
    cells = [tests.text(row, column) for row in tests]
    marks = only_marks(cells)
    failures = []
    for row, cell in enumerate(cells):
        failed = has_failed(cell, column, marks)
        if failed is None:
            yes = "yes for a run-out"
            if column == "failed":
                yes = "yes for a failure"
            allowed = f"yes or no, 1 or 0, true or false, failed or run-out; {yes}"
            remedy = "Fill the cell, or mark the others with x alone."
            if cell:
                remedy = "Correct the cell."
            raise tests.error(row, column, allowed, remedy)
        failures.append(failed)
    return failures


def _read_as(tests: TestTable, failed: Sequence[bool]) -> list[str]:
    """Return sentences on how heads and codes were read that are not those of the documentation."""
    column = _column_of_ends(tests)
    heads = {
        name: head
        for name, head in tests.heads.items()
        if name in (*NEEDED, "failed", "censored", "group")
    }
    if column in ("censored", "status", "note"):
        heads[column] = tests.heads.get(column, column)
    sentences = []
    if heads:
        sentences = [told_heads(heads, {"amplitude": " [MPa]"})]
    if column != "failed" or only_marks(tests.text(row, column) for row in tests):
        number = len(failed) - sum(failed)
        sentences.append(
            f"By the column '{tests.heads.get(column, column)}' {number} of {len(failed)} "
            "specimens ran out."
        )
    return sentences


def _observed(tests: TestTable, factor: float, failed: Sequence[bool]) -> Tests:
    """Return amplitude and cycles of each row as logarithms."""
    stress = []
    low = []
    high = []
    for row in tests:
        amplitude = tests.number(row, "amplitude", LEAST_STRESS, MOST_STRESS)
        cycles = tests.number(row, "cycles", LEAST, MOST_CYCLES, STOPPED)
        for column, value in (("amplitude", amplitude), ("cycles", cycles)):
            if math.isnan(value):
                raise tests.error(
                    row, column, "a number; the cell is empty", "Fill the cell, or remove the row."
                )
        if cycles < FEWEST_CYCLES and not cycles.is_integer():
            raise tests.error(row, "cycles", "a whole number of load cycles", TRAVEL)
        stress.append(math.log(factor * amplitude))
        low.append(math.log(cycles))
        if failed[row]:
            high.append(math.log(cycles))
        else:
            high.append(math.inf)
    if max(low) < math.log(FEWEST_CYCLES):
        longest = int(np.argmax(low))
        allowed = f"a life of at least {FEWEST_CYCLES:g} cycles in one row; this one is the longest"
        raise tests.error(longest, "cycles", allowed, TRAVEL)
    return Tests(np.array(stress), np.array(low), np.array(high))


def _check_duplicates(tests: TestTable, failed: Sequence[bool]) -> None:
    """Refuse a name that stands twice, and two failures without names that are equal to the last
    digit.
    """
    first_rows: dict[tuple, int] = {}
    for row in tests:
        name = tests.text(row, "test")
        key: tuple[object, ...]
        if name:
            key = ("test", name)
        else:
            key = ("", *(tests.number(row, n) for n in ("amplitude", "cycles")))
        if (name or failed[row]) and key in first_rows:
            other = tests.lines[first_rows[key]]
            remedy = "Remove one of the two; if both were tested, name them in a column `test`."
            wrong = f"stands in row {other} as well"
            column = "cycles"
            if name:
                column = "test"
            raise tests.error(row, column, "each test once", remedy, wrong)
        first_rows[key] = row


def deviation_of(scatter_in_cycles: float) -> float:
    """Return the standard deviation of ln N of a scatter T_N."""
    return math.log(scatter_in_cycles) / math.log(ln_range(1.0))


def check_held(slope: Any, scatter_in_cycles: Any) -> tuple[float | None, float | None]:
    """Return slope and scatter that are held as numbers; refuse those outside the bounds of a
    line.
    """
    low, high = BOUNDS["slope"]
    if slope is not None:
        number = finite_number(slope)
        if 0 < abs(number) < low:
            raise _too_flat("slope", slope)
        if not low <= number <= high:
            raise InputError(
                "slope",
                slope,
                f"a number from {low:g} to {high:g}",
                "Give k of N = c S^-k, such as 8.",
            )
        slope = number
    low, high = _range_of_scatter()
    if scatter_in_cycles is not None:
        number = finite_number(scatter_in_cycles)
        if not low <= number <= high:
            allowed = f"a number from {low:.3g} to {high:.3g}"
            raise InputError(
                "scatter", scatter_in_cycles, allowed, "Give T_N = N_90/N_10, such as 4."
            )
        scatter_in_cycles = number
    return slope, scatter_in_cycles


def check_falls(
    tests: TestTable, observed: Tests, column: str, rows: Sequence[int] | None = None
) -> None:
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
    failed = observed.failed
    if failed.sum() < 3 or np.ptp(observed.stress[failed]) < 1e-9:
        return
    from scipy import stats  # heavy, and a sheet of a fitted material needs no regression

    regression = stats.linregress(observed.stress[failed], observed.middle[failed])
    if regression.slope > 0 and regression.pvalue < 0.1:
        place = int(np.flatnonzero(failed)[np.argmax(observed.middle[failed])])
        allowed = "lives that fall with the stress; these grow, as a line with a negative slope"
        remedy = "Look whether columns or groups were mixed up."
        if rows is not None:
            place = rows[place]
        raise tests.error(place, column, allowed, remedy)


def _check_identified(
    tests: TestTable, observed: Tests, slope: float | None, scatter: float | None
) -> None:
    """Refuse one level with a free slope, and run-outs alone with free values."""
    last = len(tests) - 1
    free = [
        HELD[name] for name, value in (("slope", slope), ("log_scatter", scatter)) if value is None
    ]
    if free and not observed.failed.any():
        allowed = "at least one failure; all specimens ran out"
        remedy = f"Hold {listing(free)} for a one-sided bound, or test at a higher amplitude."
        raise tests.error(last, _column_of_ends(tests), allowed, remedy)
    if slope is None and np.ptp(observed.stress) < 1e-9:
        remedy = "Hold the slope (--slope 8), or test a second amplitude."
        raise tests.error(
            last,
            "amplitude",
            "a second level beside this one, from which the slope follows",
            remedy,
        )
    own = observed.stress[observed.failed]
    if slope is None and own.size and np.ptp(own) < 1e-9:
        remedy = "Hold the slope (--slope 8), or test another amplitude to failure."
        raise tests.error(
            last,
            "amplitude",
            "failures at two levels or more, from which the slope follows",
            remedy,
        )


def _limit_shows(observed: Tests) -> bool:
    """Return whether run-outs are as long as the longest failures, so that a fatigue limit
    shows.
    """
    failed = observed.failed
    if (~failed).sum() < 2 or failed.sum() < 2:
        return False
    return bool(observed.low[~failed].max() >= observed.middle[failed].max() - 0.1)


def _decided(line: Line) -> tuple[Line, list[str]]:
    """Return a line without the limit that the tests do not ask for, and the sentence about it."""
    if line.knee and not line.limit_matters:
        return replace(line, knee=False), [NO_LIMIT]
    if not line.knee and not line.tests.failed.all():
        return line, [SHOWS_NO_LIMIT]
    return line, []


def _stated_at(line: Line) -> float:
    """Return the cycles at which a line without fatigue limit states its strength: the longest
    test, rounded up.
    """
    longest = float(np.exp(line.tests.low[np.isfinite(line.tests.low)].max()))
    return max(DEFAULT_KNEE, 10.0 ** math.ceil(math.log10(longest)))


def _unusual_amplitude(observed: Tests, factor: float) -> list[str]:
    """Return a sentence if the largest amplitude is far from that of any coupon, as in another
    unit; `factor` is the von Mises stress over the amplitude [1].
    """
    largest = float(np.exp(observed.stress.max())) / factor
    text = sentence_of_unusual("amplitude", largest, "MPa", USUAL_AMPLITUDE, "")
    if text:
        return [text]
    return []


def _notes(load_type: str | None, ratio: float, knee: bool, observed: Tests) -> list[str]:
    """Return sentences on how the line enters a life."""
    sentences = []
    if load_type is None:
        sentences.append(
            "The load type was not given: the amplitudes are taken as von Mises amplitudes."
        )
    else:
        sentences.append(
            f"Load type {load_type}: {LOAD_TYPES[load_type][1]}. A roller is rated by its peak "
            "von Mises stress."
        )
    if math.isnan(ratio):
        sentences.append(
            "The stress ratio was not given: the amplitudes are taken as fully reversed."
        )
    elif ratio != -1.0:
        sentences.append(
            f"Stress ratio {ratio:g}: the amplitudes enter without a correction for the mean "
            "stress."
        )
    levels = Counter(np.round(observed.stress, 9).tolist())
    failing = Counter(np.round(observed.stress[observed.failed], 9).tolist())
    mixed = [level for level in levels if 0 < failing.get(level, 0) < levels[level]]
    if knee and mixed:
        sentences.append(
            f"{len(mixed)} levels hold failures and run-outs. Their failures count for the slope "
            "with the chance to "
            "fail at the level; a fit of the failures alone, or of levels above the limit alone, "
            "finds another slope."
        )
    return sentences


def of_words(words: Collection[str], field: str) -> dict[str, list[float]]:
    """Return priors from words such as slope=8,2 of a command line.

    Raises
    ------
    InputError
        For a word of another form.
    """
    priors = {}
    for word in words:
        name, sign, pair = word.partition("=")
        numbers = [finite_number(part) for part in pair.split(",")]
        if not sign or len(numbers) != 2 or any(map(math.isnan, numbers)):
            raise InputError(
                field, word, "NAME=MIDDLE,DEVIATION, two finite numbers", "For example slope=8,2"
            )
        if name.strip() in priors:
            remedy = f"Give {name.strip()} once."
            raise InputError(
                field,
                word,
                "one prior for each value",
                remedy,
                f"stands beside another {name.strip()}",
            )
        priors[name.strip()] = numbers
    return priors
