"""Read truths and the results of programs, and compute the errors of each program.

A program takes part by one CSV file: a column `case`, and a column for each quantity that it computes, with its unit.
A remark behind '#' in the first line describes it. Cells may be empty, and cases may be missing: the table of errors
says how many were solved.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from trackroller.errors import Collector, InputError, unknown_name
from trackroller.numerics.numbers import finite_number
from trackroller.report.numbers import rounded
from trackroller.tables.table_kind import TableKind
from trackroller.tables.user_table import UserTable, read_user_table

HERE = Path(__file__).parent
PROGRAMS = HERE / "programs"
QUANTITIES = {
    "lateral_force": "N",
    "driving_force": "N",
    "spin_moment": "N mm",
    "max_pressure": "MPa",
    "half_width": "mm",
    "half_length": "mm",
    "friction_power": "W",
}
# inputs and truths have columns of their own
INPUTS = {
    "normal_force": "N",
    "semi_axis_lateral": "mm",
    "semi_axis_rolling": "mm",
    "rolling_radius": "mm",
    "lateral_radius": "mm",
    "groove_radius": "mm",
    "shear_modulus": "MPa",
    "poisson_ratio": "-",
    "friction_at_rest": "-",
    "friction_lowest": "-",
    "half_value_speed": "mm/s",
    "layer_flexibility": "mm3/N",
    "longitudinal_creepage": "-",
    "lateral_creepage": "-",
    "spin": "1/mm",
    "velocity": "m/s",
}
TRUTHS = {"value": "-", "scale": "-", "uncertainty": "-"}
HEADS = ("program", "set", "quantity", "solved", "median error", "largest error", "error of the truth")


@dataclass(frozen=True)
class Truth:
    """A true value [unit of its quantity], the scale of errors, and its own error over the scale; NaN if unknown."""

    value: float
    scale: float
    uncertainty: float


@dataclass(frozen=True)
class Program:
    """Results of a program: its name, what it says of itself, and its numbers by case and quantity."""

    name: str
    remark: str
    results: Mapping[tuple[str, str], float]


def read_cells(path: Path, units: Mapping[str, str], words: Iterable[str]) -> tuple[UserTable, list[dict[str, str]]]:
    """Return a table, and its rows by the names of its columns; refuse columns that are not known.

    Parameters
    ----------
    path : Path
        The CSV file.
    units : mapping of str to str
        Units of its columns of numbers by their names; their cells may be empty.
    words : iterable of str
        Names of its columns of words.

    Raises
    ------
    InputError
        If the file is no such table; the error names file, line and column.
    """
    kind = TableKind("program", "case", units, words=tuple(words), optional=tuple(units))
    wrong = Collector()
    table = read_user_table(path, kind, wrong)
    for name in table.names:
        if not kind.knows(name):
            with wrong.part():
                raise unknown_name("column", name, [*kind.words, *units]).at(path, table.head)
    wrong.check()
    return table, [dict(zip(table.names, cells, strict=True)) for cells in table.lines.values()]


def read_cases() -> dict[str, dict[str, float | str]]:
    """Return the inputs of all cases by their names, those of patches and of grooves; NaN for an empty cell."""
    cases: dict[str, dict[str, float | str]] = {}
    for name in ("patches", "grooves"):
        for row in read_cells(HERE / f"{name}.csv", INPUTS, ("case", "set"))[1]:
            own: dict[str, float | str] = {"set": row["set"]}
            own |= {key: _number(row[key], INPUTS[key], key) for key in row if key in INPUTS}
            cases[row["case"]] = own
    return cases


def read_truths() -> dict[tuple[str, str], Truth]:
    """Return the true values by case and quantity."""
    truths = {}
    for row in read_cells(HERE / "truths.csv", TRUTHS, ("case", "quantity", "unit"))[1]:
        numbers = {name: _number(row[name], "-", name) for name in TRUTHS}
        truths[row["case"], row["quantity"]] = Truth(**numbers)
    return truths


def read_program(path: Path) -> Program:
    """Read the results of a program.

    Parameters
    ----------
    path : Path
        Its CSV file; the name of the file without its ending is the name of the program.

    Raises
    ------
    InputError
        For an unknown column or case, a case twice, a cell that is no number, or a file without a number that has a
        truth; the error names file and line.
    """
    table, rows = read_cells(path, QUANTITIES, ("case",))
    if "case" not in table.names:
        allowed = "a column case, and a column for each quantity"
        raise InputError("column case", None, allowed, "Name the cases as inputs do.").at(path, table.head)
    truths = read_truths()
    cases = dict.fromkeys(case for case, _ in truths)
    wrong = Collector()
    lines: dict[str, int] = {}
    results = {}
    for number, row in zip(table.lines, rows, strict=True):
        case = row["case"]
        with wrong.part():
            if case not in cases:
                raise unknown_name("case", case, cases).at(path, number)
            if case in lines:
                allowed = f"each case once; line {lines[case]} has it already"
                raise InputError("case", case, allowed, "Remove one of the lines.").at(path, number)
        lines.setdefault(case, number)
        for name in (name for name in row if name in QUANTITIES and row[name]):
            with wrong.part():
                value = _number(row[name], QUANTITIES[name], name)
                if not math.isfinite(value):
                    allowed = f"a number in {QUANTITIES[name]}, or an empty cell"
                    raise InputError(name, row[name], allowed, "Correct the cell.").at(path, number)
                results[case, name] = value
    wrong.check()
    if not any(key in truths for key in results):
        allowed = "a number for at least one case and quantity that has a truth"
        raise InputError("program", path.name, allowed, "See truths.csv.").at(path, table.head)
    return Program(path.stem, " ".join(table.remarks.values()).lstrip("# "), results)


def error_rows(programs: Iterable[Program]) -> list[tuple[str, ...]]:
    """Return the rows of the table of errors in the order of `HEADS`, those of one set and quantity together.

    Parameters
    ----------
    programs : iterable of Program
        The programs.

    Returns
    -------
    list of tuple of str
        For each set, quantity and program: how many cases it solved, median and largest error over the scale of the
        truth, and the error of the truth itself. The smallest median stands first.
    """
    cases = read_cases()
    groups: dict[tuple[str, str], dict[str, Truth]] = {}
    for (case, quantity), truth in read_truths().items():
        groups.setdefault((str(cases[case]["set"]), quantity), {})[case] = truth
    programs = list(programs)
    rows = []
    for (kind, quantity), truths in groups.items():
        own = [(program.name, _errors(program, quantity, truths)) for program in programs]
        solved = [(float(np.median(errors)), name, errors) for name, errors in own if errors]
        doubt = max(truth.uncertainty for truth in truths.values())
        for median, name, errors in sorted(solved):
            count = f"{len(errors)} of {len(truths)}"
            rows.append((name, kind, quantity, count, _percent(median), _percent(max(errors)), _percent(doubt)))
    return rows


def all_programs(more: Iterable[Path] = ()) -> list[Program]:
    """Return the programs of the folder, and those of further files."""
    return [read_program(path) for path in (*sorted(PROGRAMS.glob("*.csv")), *more)]


def _errors(program: Program, quantity: str, truths: Mapping[str, Truth]) -> list[float]:
    """Return the errors of the cases that a program has solved, over the scales of the truths."""
    solved = {case: program.results[case, quantity] for case in truths if (case, quantity) in program.results}
    return [abs(value - truths[case].value) / abs(truths[case].scale) for case, value in solved.items()]


def _number(cell: str, unit: str, name: str) -> float:
    """Return the number of a cell; NaN for an empty one."""
    if not cell:
        return math.nan
    return float(finite_number(cell, unit, name))


def _percent(share: float) -> str:
    if math.isnan(share):
        return "not stated"
    return f"{rounded(100.0 * share, 2)} %"
