"""Fit values of a material to rollers on a bench: travel, and what ended each test.

Each row is solved once. Its stresses do not depend on the values that are fitted, so a life follows
from the S-N line for any of them, and a travel to a wear depth is inversely proportional to the
wear coefficient.

An end by another mode, or by the other body, is a suspension: the roller had lived that long.

ASSUME: the scatter belongs to the body. Where the table does not say in which contact it failed,
the contact with the shorter life counts, as everywhere in the program; where it says so, the other
contact is a suspension. ASSUME: stresses are those of new profiles; friction, wear and fatigue are
independent of each other.
"""

from __future__ import annotations

import json
import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from trackroller.damage.pressure_line import CYCLES, EXPONENT
from trackroller.damage.wear import KM_PER_HOUR
from trackroller.errors import Collector, InputError, check_names, listing
from trackroller.files import files_beside, find_beside
from trackroller.fit.coupons import check_falls, check_held, deviation_of, priors_of
from trackroller.fit.line import Line, Tests, log_or_end
from trackroller.fit.material_fit import Group, MaterialFit, check_texts
from trackroller.fit.posterior import ln_range
from trackroller.fit.solved_rollers import DEFAULTS, Solved, solved_rollers
from trackroller.fit.table import LEAST, TestTable, read_tests
from trackroller.materials import Material, load_database
from trackroller.numerics.numbers import finite_number
from trackroller.numerics.plain import plain
from trackroller.numerics.units import split_quantity
from trackroller.parameters import BODIES, LIMITS, MATERIAL_FIELDS, PARAMETERS, REGIMES
from trackroller.parameters.example import not_given_text
from trackroller.parameters.validity import VALIDITY
from trackroller.roller.aliases import ALIASES, overridden
from trackroller.roller.case import FIELDS, Case
from trackroller.roller.settings import BESIDE, checked_case
from trackroller.roller.solver import solve
from trackroller.yaml_file import read_mapping

# values of the line of each kind, of stress and of pressure; both have the scatter of the material
OF_LINE = {
    "fatigue": ("fatigue_strength", "slope"),
    "rolling": ("rolling_pressure", "rolling_exponent"),
}
FITTED = (
    *("fatigue_strength", "slope", "scatter", "rolling_pressure", "rolling_exponent"),
    *("wear_coefficient", "friction_coefficient"),
)
OWN = ("test", "base", "travel_from", "travel_to", "end", "contact", "drive_force", "note")
COLUMNS = (*OWN, *PARAMETERS, *MATERIAL_FIELDS, *ALIASES)
MODES = ("fatigue", *(name for name in LIMITS if name != "fatigue"), "other")
# at which a drive force is solved
FRICTIONS = (0.01, 0.03, 0.06, 0.1, 0.15, 0.2, 0.3, 0.4, 0.55, 0.7, 0.9)
UNIT_WEAR = 1e-6  # wear coefficient with which travels to a depth are computed [mm3/(N m)]
LONGEST = 50_000.0  # h: nearly six years without a stop
FLAG = {name: 1 << place for place, name in enumerate(VALIDITY)}
DEEPEST = 100.0  # mm, a wear depth above it is a mistake


@dataclass(frozen=True)
class End:
    """What ended a test: mode, body, and depth of wear [mm]; the mode "none" is a suspension."""

    mode: str
    body: str = ""
    depth: float = math.nan


def fit_bench(  # noqa: PLR0913 - one argument for each choice of a fit
    table: Any,
    fit: Sequence[str] | str = ("fatigue_strength", "slope", "scatter"),
    *,
    name: str = "",
    body: str | None = None,
    slope: float | None = None,
    scatter_in_cycles: float | None = None,
    like: str | None = None,
    base: Mapping[str, Any] | None = None,
    prior: Mapping[str, Sequence[float]] | None = None,
) -> MaterialFit:
    """Fit values of a material to rollers that ran on a bench.

    Parameters
    ----------
    table : path, data frame, list of mappings or mapping of columns
        One roller a row. `travel_from` and `travel_to` [km] hold the travel between which it ended,
        `end` says how: "fatigue roller", "wear roller 0.05 mm", another limit such as "bearing", or
        "none" for a roller that was stopped whole at `travel_from`. `base` names a case file;
        parameters of a case are further columns. `contact` (1 or 2) says which contact failed, and
        `drive_force` [N] the force that moved a roller without motor.
    fit : sequence of str or str
        What is fitted: "fatigue_strength", "slope", "scatter", "wear_coefficient",
        "friction_coefficient". "rolling_pressure" and "rolling_exponent" in place of the first two
        fit the line of pressure p_R at N_R overrollings, the limit `pressure_line`. Slope and
        scatter that are not named are those of the material.
    name : str
        Name of the material that is made; by default that of the tested body with "fitted".
    body : str, optional
        Body whose values are fitted, "roller" or "guide"; by default the one that failed.
    slope, scatter_in_cycles : float, optional
        Slope of the line, k or k_R, and scatter T_N that are held instead of fitted [1].
    like : str, optional
        Material whose other values the fitted one takes; by default the tested one.
    base : mapping, optional
        Fields of a case and options for all rows, in place of the column `base`.
    prior : mapping, optional
        Priors of the posterior, see `trackroller.fit_sn`.

    Returns
    -------
    MaterialFit
        `.material`, `.data`, `.interval(...)` and `.report(path)`. The values hold for the contact
        model, the life criterion and the accuracy of the fit.

    Raises
    ------
    InputError
        For a table that no value can be fitted to; the message names row and column.

    Examples
    --------
    >>> import trackroller as tr
    >>> ends = ["fatigue roller"] * 4 + ["none"]
    >>> bench = {"radial_force": [-200, -200, -160, -160, -130], "end": ends}
    >>> bench["travel_from"] = [15, 22, 40, 60, 150]
    >>> bench["travel_to"] = [15, 22, 40, 60, None]
    >>> rig = {"motor_force": 0, "friction_coefficient": 0.1, "contact_model": "sliding"}
    >>> fit = tr.fit_bench(bench, "fatigue_strength, scatter", base=rig)
    >>> low, high = fit.interval("fatigue_strength")
    >>> low < fit.material["fatigue_limit"] < high
    True
    """
    values = _values_to_fit(fit)
    check_texts(name=name, like=like)
    check_base(base)
    slope, scatter_in_cycles = check_held(slope, scatter_in_cycles)
    kind = _kind_of_line(values)
    fixed: dict[str, float | None] = {"scatter": scatter_in_cycles}
    fixed |= dict.fromkeys(("slope", "rolling_exponent"), slope)
    values = [value for value in values if fixed.get(value) is None]
    if not values:
        raise InputError(
            "fit", fit, "at least one value that is not held", f"Name {OF_LINE[kind][0]} as well."
        )
    if body is not None:
        check_names("body", [body], BODIES)
    rows = read_tests(
        table,
        ("travel_from", "end"),
        COLUMNS,
        [n for n in COLUMNS if n not in ("travel_from", "end")],
    )
    _check_names_once(rows)
    ends = [_end(rows, row) for row in rows]
    travels = [_travel(rows, row, ends[row]) for row in rows]
    cases, options = _cases(rows, base)
    _check_hours(rows, travels, cases)
    tested = body or _body_of(rows, ends, values)
    material = _material_of(rows, cases, tested)
    solved = _solved(rows, cases, options, tested)
    groups = []
    if {*OF_LINE[kind], "scatter"} & set(values):
        constants = _constants(values, kind, material, slope, scatter_in_cycles)
        line = _line_group(rows, ends, travels, solved, tested, kind, material, constants)
        groups.append(replace(line, priors=priors_of(prior)))
    if "wear_coefficient" in values:
        groups.append(_wear(rows, ends, travels, cases, options, tested))
    if "friction_coefficient" in values:
        groups.append(_friction(rows, cases, options))
    given = {key: str(options.get(key, default)) for key, default in DEFAULTS.items()}
    return MaterialFit(
        "bench",
        name or f"{material.name} fitted",
        tuple(groups),
        rows,
        like or material.name,
        given | {"body": tested},
        [*_notes(values), *_outside(rows, solved, tested)],
        not_given_notes(cases),
    )


def _constants(
    values: Sequence[str],
    kind: str,
    material: Material,
    slope: float | None,
    scatter: float | None,
) -> dict[str, float | None]:
    """Return the slope of the line and the deviation of ln N that are not fitted: those that are
    held, or those of the material. `scatter` is T_N.
    """
    constants: dict[str, float | None] = dict.fromkeys(("slope", "scatter"))
    if OF_LINE[kind][1] not in values:
        constants["slope"] = _slope_of(material, kind, slope)
    if "scatter" not in values:
        constants["scatter"] = _scatter_of(material, scatter)
    return constants


def _notes(values: Sequence[str]) -> list[str]:
    """Return under which conditions the fitted values hold."""
    notes = [
        "The values hold for the contact model, the life criterion and the accuracy of the fit."
    ]
    if "wear_coefficient" in values:
        notes.append(
            "Travels to a depth are the mean of the two closed forms of the limit wear; "
            "`trackroller fit wear` follows the profile of one groove instead."
        )
    if "friction_coefficient" in values and {*values} != {"friction_coefficient"}:
        notes.append(
            "The rows were solved with the friction that they state, not with the fitted one."
        )
    return notes


def check_base(base: Any) -> None:
    """Refuse a base that is no mapping; None stands for the paper's example."""
    if base is not None and not isinstance(base, Mapping):
        raise InputError(
            "base",
            base,
            "a mapping with fields of a case and options",
            "Give the values themselves.",
        )


def _values_to_fit(fit: Sequence[str] | str) -> list[str]:
    """Return the names of the values to fit, from a list or a text with commas."""
    if isinstance(fit, str):
        values = [part.strip() for part in fit.split(",")]
    else:
        values = plain(fit, "fit")
    if not isinstance(values, list):
        raise InputError("fit", fit, f"a list of {', '.join(FITTED)}")
    check_names("fit", values, FITTED)
    return values


def _kind_of_line(values: Sequence[str]) -> str:
    """Return the kind of the line that is fitted; refuse both kinds from the same tests."""
    kinds = [kind for kind, names in OF_LINE.items() if set(names) & set(values)]
    if len(kinds) > 1:
        allowed = "values of one line, of stress or of pressure: a material has one scatter"
        first, second = (listing(list(names)) for names in OF_LINE.values())
        remedy = f"Fit {first}, or {second}; a second fit with another name gives the other line."
        raise InputError("fit", ", ".join(values), allowed, remedy)
    return next(iter(kinds), "fatigue")


def _check_names_once(rows: TestTable) -> None:
    """Refuse a test that stands twice, by its name, or by all of its cells."""
    first_rows: dict[Any, int] = {}
    for row in rows:
        name = rows.text(row, "test")
        key = name or json.dumps({k: str(v) for k, v in rows.rows[row].items()}, sort_keys=True)
        fails = rows.text(row, "end").lower() not in ("none", "")
        if key in first_rows and (name or fails):
            remedy = "Remove one of the two; if both were tested, name them in the column test."
            wrong = f"stands in row {rows.lines[first_rows[key]]} as well"
            column = "travel_from"
            if name:
                column = "test"
            raise rows.error(row, column, "each test once", remedy, wrong)
        first_rows[key] = row


def _end(rows: TestTable, row: int) -> End:
    """Return what ended a test, from words such as 'wear roller 0.05 mm'."""
    words = rows.text(row, "end").lower().split()
    if words in (["none"], ["run-out"], ["runout"], ["run", "out"], ["suspended"]):
        return End("none")
    allowed = (
        f"none, or how it ended: {', '.join(MODES)}; then roller or guide, such as 'fatigue roller'"
    )
    if not words or words[0] not in MODES:
        raise rows.error(row, "end", allowed, "Correct the cell.")
    mode = words[0]
    further = words[1:]
    body = ""
    if further and further[0] in BODIES:
        body = further.pop(0)
    if mode in ("fatigue", "wear") and not body:
        raise rows.error(row, "end", allowed, f"Write {mode} roller, or {mode} guide.")
    if mode != "wear":
        if further:
            raise rows.error(row, "end", allowed, "Remove the further words.")
        return End(mode, body)
    parts = split_quantity(" ".join(further))
    remedy = "Write the depth that was reached with its unit, such as wear roller 0.05 mm."
    if parts is None:
        raise rows.error(row, "end", "wear, body and depth", remedy)
    try:
        depth = finite_number(" ".join(parts), "mm", "end")
    except InputError:
        raise rows.error(row, "end", "a depth as a length", remedy) from None
    if not 0 < depth <= DEEPEST:
        raise rows.error(
            row, "end", f"a finite depth above 0 and of at most {DEEPEST:g} mm", remedy
        )
    return End(mode, body, depth)


def _travel(rows: TestTable, row: int, end: End) -> tuple[float, float]:
    """Return the travels between which a test ended [km]; the second is inf for a suspension."""
    low = rows.number(row, "travel_from", 0.0)
    whole = (
        "Write the travel of the end, or end = none and an empty travel_to for a roller that "
        "was stopped whole."
    )
    high = rows.number(row, "travel_to", LEAST, remedy=whole)
    if math.isnan(low):
        raise rows.error(row, "travel_from", "a travel [km]; the cell is empty", "Fill the cell.")
    if end.mode == "none":
        if not math.isnan(high) and high != low:
            remedy = "Leave travel_to empty, or say how the roller ended."
            raise rows.error(row, "travel_to", "no travel, because the roller did not end", remedy)
        if low == 0:
            raise rows.error(
                row, "travel_from", "the travel at which the test was stopped, above 0"
            )
        return low, math.inf
    if math.isnan(high):
        remedy = "Write the travel of the end; it equals travel_from if the end was observed."
        raise rows.error(
            row, "travel_to", "a travel [km], because the roller ended; the cell is empty", remedy
        )
    if high < low:
        raise rows.error(
            row, "travel_to", f"a travel of at least travel_from = {low:g} km", "Swap the two."
        )
    return low, high


def _cases(rows: TestTable, base: Mapping[str, Any] | None) -> tuple[list[Case], dict[str, Any]]:
    """Return the case of each row, and the options that all of them share."""
    cases = []
    options = []
    wrong = Collector()
    read = {}
    folder = rows.path or Path("tests.csv")
    for row in rows:
        file = rows.text(row, "base")
        own = {
            name: cell
            for name, cell in rows.rows[row].items()
            if name not in OWN and rows.text(row, name) != ""
        }
        with wrong.part():
            try:
                with files_beside(folder):
                    if file and file not in read:
                        read[file] = dict(read_mapping(find_beside(file, "base"), "case file"))
                    values = overridden(read.get(file, {}) | dict(base or {}), own)
                    case, one, _ = checked_case(
                        {k: v for k, v in values.items() if k not in BESIDE}
                    )
                    _check_empty(rows, row, case)
            except InputError as error:
                if error.field in rows.rows[row]:
                    field = error.field
                else:
                    field = "base" if file else "case"
                raise (
                    error.named(f"row {rows.lines[row]}, {field}") if rows.path is None else
                    error.at(rows.path, rows.lines[row])
                ) from None  # fmt: skip
            cases.append(case)
            options.append({key: value for key, value in one.items() if key != "outputs"})
    wrong.check()
    for row, one in enumerate(options):
        if one != options[0]:
            key = next(k for k in {**one, **options[0]} if one.get(k) != options[0].get(k))
            remedy = "Give the same options in all case files."
            raise rows.error(row, "base", f"the same {key} as in the first row", remedy)
    rule = options[0].get("life_rule", "elementary")
    if rule != "elementary":
        remedy = "Fit the line with life_rule elementary; a case may take another rule afterwards."
        raise InputError(
            "life_rule", rule, "elementary, because the fitted line is straight", remedy
        )
    return cases, options[0]


def _check_empty(rows: TestTable, row: int, case: Case) -> None:
    """Refuse empty cells of parameters that nothing else gives: they would be those of the paper's
    example.
    """
    for name in rows.rows[row]:
        if name in case.not_given:
            remedy = "Fill the cell, or give the value in the file of the column base."
            raise InputError(name, "", "a value; the cell is empty", remedy)


def not_given_notes(cases: Sequence[Case]) -> list[str]:
    """Return the sentence on parameters of which neither the tests nor their base give a value."""
    text = not_given_text({name: getattr(case, name) for case in cases for name in case.not_given})
    if text:
        return [f"{text[0].upper()}{text[1:]}."]
    return []


def _body_of(rows: TestTable, ends: Sequence[End], values: Collection[str]) -> str:
    """Return the body that failed in the tests; refuse a table in which both did."""
    if set(values) <= {"wear_coefficient"}:
        modes = {"wear"}
    else:
        modes = {"fatigue"}
    failed = {end.body for end in ends if end.mode in modes and end.body}
    if len(failed) > 1:
        row = next(row for row, end in enumerate(ends) if end.mode in modes and end.body == "guide")
        remedy = (
            "Choose one with --body roller or --body guide; ends of the other one are suspensions."
        )
        raise rows.error(row, "end", "ends of one body; rollers and guides failed", remedy)
    if not failed:
        return "roller"
    return failed.pop()


def _material_of(rows: TestTable, cases: Sequence[Case], body: str) -> Material:
    """Return the material of the tested body; refuse a table that mixes materials."""
    field = f"{body}_material"
    used = [getattr(case, field) for case in cases]
    for row, material in enumerate(used):
        if material != used[0]:
            remedy = "Fit each material from a table of its own."
            allowed = (
                f"one material of the {body}; the table mixes it with that of row {rows.lines[0]}"
            )
            column = "base"
            if field in rows.rows[row]:
                column = field
            raise rows.error(row, column, allowed, remedy)
    return load_database().material(used[0], field)


def _check_hours(
    rows: TestTable, travels: Sequence[tuple[float, float]], cases: Sequence[Case]
) -> None:
    """Refuse a travel that would take years without a stop, which is rather a number of
    overrollings.
    """
    remedy = "Write km, not a number of overrollings, or correct the speed."
    for row, (ends, case) in enumerate(zip(travels, cases, strict=True)):
        for column, travel in zip(("travel_from", "travel_to"), ends, strict=True):
            hours = travel / (KM_PER_HOUR * case.velocity)
            if LONGEST < hours < math.inf:  # an infinite travel_to is that of a suspension
                speed = f"{case.velocity:g} m/min"
                allowed = (
                    f"a travel of at most {LONGEST:g} h without a stop; this one takes "
                    f"{hours:.3g} h at {speed}"
                )
                raise rows.error(row, column, allowed, remedy)


def _solved(
    rows: TestTable, cases: Sequence[Case], options: Mapping[str, Any], body: str
) -> Solved:
    """Solve the rows, and refuse one that does not roll, or whose body breaks at once."""
    solved = solved_rollers(cases, options)
    words = {"lift_off": "lifts off", "full_slip": "slips fully", "failed": "has no solution"}
    for row, regime in enumerate(solved.regime):
        if regime != "rolling":
            loads = [
                n for n in ("radial_force", "axial_force", "motor_force") if n in rows.rows[row]
            ]
            allowed = "loads under which both contacts roll"
            remedy = "Correct the loads, or remove the row."
            column = loads[0] if loads else "base"
            wrong = f"belongs to a roller that {words.get(regime, regime)}"
            raise rows.error(row, column, allowed, remedy, wrong)
        if solved.flags[row, BODIES.index(body)] & FLAG["static"]:
            stress = float(np.max(solved.stress[row, :, BODIES.index(body)]))
            column = "base"
            if "radial_force" in rows.rows[row]:
                column = "radial_force"
            wrong = f"gives the {body} a stress of {stress:.4g} MPa, above its tensile strength"
            raise rows.error(
                row,
                column,
                "loads under which the body does not break",
                "Correct the loads.",
                wrong,
            )
    return solved


def _outside(rows: TestTable, solved: Solved, body: str) -> list[str]:
    """Return notes on rows whose stresses lie outside the model."""
    notes = []
    for name in ("half_space", "conformal"):
        lines = [
            str(rows.lines[row])
            for row in rows
            if solved.flags[row, BODIES.index(body)] & FLAG[name]
        ]
        if lines:
            notes.append(
                f"In row {listing(lines)} {VALIDITY[name].words}: the stress is an estimate."
            )
    return notes


def _line_group(
    rows: TestTable,
    ends: Sequence[End],
    travels: Sequence[tuple[float, float]],
    solved: Solved,
    body: str,
    kind: str,
    material: Material,
    constants: Mapping[str, float | None],
) -> Group:
    """Return the line of fatigue of a body: over the stress, or of `rolling` over the pressure."""
    if kind == "rolling":
        load = solved.pressure
        k = material.rolling_exponent or EXPONENT
        at = material.rolling_cycles or CYCLES
    else:
        load = solved.stress
        k = material.woehler_exponent
        at = material.cycles_at_fatigue_limit
    b = BODIES.index(body)
    loads = []
    low = []
    high = []
    origin = []
    for row in rows:
        ended = ends[row].mode == "fatigue" and ends[row].body == body
        contacts, failed = _contacts_of_row(rows, row, load, solved, body, k)
        if not ended:
            contacts = {failed}
        for contact in contacts:
            start, stop = travels[row]
            if not ended or contact != failed:
                stop = math.inf
            per_km = solved.per_km[row, contact, b]
            loads.append(math.log(load[row, contact, b]))
            low.append(log_or_end(start * per_km))
            high.append(log_or_end(stop * per_km))
            origin.append(row)
    known = np.isfinite(np.array(low)) | np.isfinite(np.array(high))
    tests = Tests(np.array(loads)[known], np.array(low)[known], np.array(high)[known])
    rows_of_tests = tuple(np.array(origin)[known].tolist())
    line = _checked_line(rows, tests, rows_of_tests, constants)
    return Group(kind, line, at=at, rows=rows_of_tests)


def _contacts_of_row(
    rows: TestTable, row: int, load: np.ndarray, solved: Solved, body: str, slope: float
) -> tuple[set[int], int]:
    """Return the contacts of a roller that a test tells of, and the one that failed, or would fail
    first by the slope of the line over the `load`.

    A row that states the failed contact tells of the other one too: it ran as long without a
    failure.
    """
    b = BODIES.index(body)
    life = load[row, :, b] ** -slope / solved.per_km[row, :, b]  # up to a factor [km]
    if np.isnan(life).any():
        remedy = "Give guide_overrollings_per_hour, or fit the roller."
        raise rows.error(row, "base", f"a known number of overrollings of the {body}", remedy)
    stated = rows.number(row, "contact", 1, 2)
    if math.isnan(stated):
        worse = int(np.argmin(life))
        return {worse}, worse
    if stated not in (1, 2):
        raise rows.error(row, "contact", "1 or 2, the contact that failed", "Correct the cell.")
    return {0, 1}, int(stated) - 1


def _checked_line(
    rows: TestTable, tests: Tests, origin: tuple[int, ...], constants: Mapping[str, float | None]
) -> Line:
    """Return the line of some tests; refuse tests that cannot tell the values that are fitted."""
    slope = constants["slope"]
    scatter = constants["scatter"]
    last = len(rows) - 1
    if not tests.failed.any() and (slope is None or scatter is None):
        remedy = (
            "Hold slope and scatter (--slope 8 --scatter 4) for a one-sided bound, or test "
            "until a roller fails."
        )
        raise rows.error(
            last,
            "end",
            "at least one end by fatigue of the body",
            remedy,
            "ends no test by fatigue",
        )
    if slope is None and np.ptp(tests.stress[tests.failed]) < 1e-3:
        remedy = "Hold it (--slope 8), leave slope out of the fit, or test another load to failure."
        column = "base"
        if "radial_force" in rows.rows[last]:
            column = "radial_force"
        raise rows.error(
            last, column, "failures at two loads or more, from which the slope follows", remedy
        )
    if slope is None:
        check_falls(rows, tests, "travel_from", origin)
    line = Line(tests, slope=slope, scatter=scatter, specimens=len(set(origin)))
    if len(rows) <= len(line.free):
        remedy = "Test more rollers, or fit fewer values."
        allowed = f"more rows than the {len(line.free)} fitted values"
        raise rows.placed(InputError("tests", len(rows), allowed, remedy))
    return line


def _slope_of(material: Material, kind: str, constant: float | None) -> float:
    """Return the slope of a line that is held, or that of a material."""
    own = material.woehler_exponent
    if kind == "rolling":
        own = material.rolling_exponent
    slope = constant or own
    if slope is None:
        remedy = "Hold it with --slope 18 (slope=18), or fit rolling_exponent as well."
        field = f"material '{material.name}'.rolling_exponent"
        raise InputError(field, None, "the exponent of its line of pressure, which is held", remedy)
    return float(slope)


def _scatter_of(material: Material, constant: float | None) -> float:
    """Return the standard deviation of ln N that is held, or that of a material."""
    if constant is not None:
        return deviation_of(constant)
    t_n = material.scatter_in_cycles
    t_s = material.scatter_in_stress
    if t_n is None and t_s is None:
        remedy = "Hold it with --scatter 4 (scatter_in_cycles=4), or fit it as well."
        raise InputError(
            f"material '{material.name}'.scatter_in_cycles",
            None,
            "the scatter T_N, which is held",
            remedy,
        )
    if t_n is not None:
        cycles = t_n
    else:
        cycles = t_s**material.woehler_exponent  # type: ignore[operator]
    return max(math.log(cycles) / math.log(ln_range(1.0)), 0.011)


def _wear(
    rows: TestTable,
    ends: Sequence[End],
    travels: Sequence[tuple[float, float]],
    cases: Sequence[Case],
    options: Mapping[str, Any],
    body: str,
) -> Group:
    """Return the line of wear of a body: ln of the travel over that of the unit wear
    coefficient.
    """
    depths = [float(case.permissible_wear_depth or math.nan) for case in cases]
    for row, end in enumerate(ends):
        if end.mode == "wear" and end.body == body:
            depths[row] = end.depth
    used = [row for row in rows if not math.isnan(depths[row]) and depths[row] > 0]
    if not any(ends[row].mode == "wear" and ends[row].body == body for row in used):
        remedy = (
            f"Leave wear_coefficient out of the fit, or write ends such as wear {body} 0.05 mm."
        )
        raise rows.error(len(rows) - 1, "end", f"at least one end by wear of the {body}", remedy)
    unit = travels_to_depths(
        [cases[row] for row in used], options, body, [depths[row] for row in used]
    )
    low = []
    high = []
    for row, km in zip(used, unit, strict=True):
        start, stop = travels[row]
        if ends[row].mode != "wear" or ends[row].body != body:
            stop = math.inf
        low.append(log_or_end(start / km))
        high.append(log_or_end(stop / km))
    return wear_group(np.array(low), np.array(high), tuple(used))


def wear_group(low: np.ndarray, high: np.ndarray, rows: tuple[int, ...]) -> Group:
    """Return the line of wear from ln of travels over those of the unit coefficient, each of shape
    (n,).
    """
    known = np.isfinite(low) | np.isfinite(high)
    tests = Tests(np.zeros(int(known.sum())), low[known], high[known])
    scatter = None
    if int(tests.failed.sum()) < 2:  # one depth tells the coefficient, but no scatter
        scatter = HELD_SCATTER
    line = Line(tests, scatter=scatter, sloped=False)
    return Group("wear", line, scale=UNIT_WEAR, rows=tuple(np.array(rows)[known].tolist()))


HELD_SCATTER = 0.4  # of ln travel to a depth, where one depth alone was measured


def travels_to_depths(
    cases: Sequence[Case], options: Mapping[str, Any], body: str, depths: Sequence[float]
) -> np.ndarray:
    """Return the travels at which new grooves reach depths with the unit wear coefficient [km],
    (n,).

    Parameters
    ----------
    cases : sequence of Case
        The rollers.
    options : mapping
        Options of the solution.
    body : str
        The body that wears.
    depths : sequence of float
        A depth for each roller [mm].

    Notes
    -----
    The value of the limit `wear`, the mean of its two closed forms. The travel to a depth is
    inversely proportional to the wear coefficient, because forces and profiles do not depend on it.
    """
    rollers = [
        worn_alone(case, body) | {"permissible_wear_depth": depth}
        for case, depth in zip(cases, depths, strict=True)
    ]
    ds = solve(rollers, **{**options, "outputs": ("forces", "wear")})
    hours = ds["wear_life_hours"].sel(body=body).min("contact").values
    return np.asarray(hours * KM_PER_HOUR * np.array([case.velocity for case in cases]))


def worn_alone(case: Case, body: str) -> dict[str, Any]:
    """Return the fields of a case whose body wears with the unit coefficient, and whose other body
    hardly wears.
    """
    values = {name: getattr(case, name) for name in FIELDS}
    database = load_database()
    for own in BODIES:
        field = f"{own}_material"
        wears = {"wear_coefficient": UNIT_WEAR if own == body else 1e-6 * UNIT_WEAR}
        values[field] = database.material(getattr(case, field), field).as_dict() | wears
    return values


def _friction(rows: TestTable, cases: Sequence[Case], options: Mapping[str, Any]) -> Group:
    """Return the line of friction: ln of the coefficient by which each roller needs its measured
    drive force.
    """
    coefficients = []
    used = []
    for row in rows:
        force = rows.number(row, "drive_force", LEAST)
        if math.isnan(force):
            continue
        if cases[row].motor_force != 0:
            remedy = "Set motor_force to 0 in this row, or leave drive_force empty."
            raise rows.error(
                row, "drive_force", "a force that moves a roller without motor", remedy
            )
        coefficients.append(_friction_of(rows, row, cases[row], options, force))
        used.append(row)
    if len(coefficients) < 2:
        remedy = "Measure it on two rollers or more, or leave friction_coefficient out of the fit."
        raise rows.error(len(rows) - 1, "drive_force", "a force in two rows or more", remedy)
    values = np.array(coefficients)
    line = Line(Tests(np.zeros(len(values)), values, values), sloped=False)
    return Group("friction", line, rows=tuple(used))


def _friction_of(
    rows: TestTable, row: int, case: Case, options: Mapping[str, Any], force: float
) -> float:
    """Return ln of the friction coefficient at which a roller needs a drive force."""
    values = {name: getattr(case, name) for name in FIELDS}
    ds = solve(
        [values | {"friction_coefficient": mu} for mu in FRICTIONS],
        **{**options, "outputs": ("forces",)},
    )
    needed = np.abs(ds["transmitted_force"].values)
    rolls = np.isfinite(needed) & (ds["regime"].values == REGIMES.index("rolling"))
    needed = needed[rolls]
    coefficient = np.array(FRICTIONS)[rolls]
    rising = np.concatenate([[True], np.diff(np.maximum.accumulate(needed)) > 0])
    needed = needed[rising]
    coefficient = coefficient[rising]
    if not needed.size or not needed[0] <= force <= needed[-1]:
        allowed = "a roller that rolls"
        if needed.size:
            allowed = f"a force from {needed.min():.3g} to {needed.max():.3g} N"
        remedy = (
            f"The model needs it for frictions from {FRICTIONS[0]} to {FRICTIONS[-1]}; check "
            "force and loads."
        )
        raise rows.error(row, "drive_force", allowed, remedy)
    return float(np.interp(math.log(force), np.log(needed), np.log(coefficient)))
