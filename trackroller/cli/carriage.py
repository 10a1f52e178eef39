"""The command of a carriage: loads, lives and margins of its rollers, and the files that follow
from them.
"""

from __future__ import annotations

import hashlib
import os
import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from trackroller.cli.case import (
    YAML,
    writable,
    writable_data,
    writable_page,
    write_result,
    write_yaml_file,
)
from trackroller.cli.usage import print_doubts, print_line
from trackroller.errors import InputError
from trackroller.files import sha256, write_text

if TYPE_CHECKING:
    import xarray as xr

    from trackroller.carriage.file import Carriage

# line of a study by which its table is known to be unchanged
TABLE_OF_US = "# Written beside it: {}, SHA-256 {}"
MANY = 20  # load cases from which on a progress bar is shown
START = "trackroller carriage --example -o {}"  # how a user gets a file to change


def run_carriage(
    file: Path | None,
    example: bool,
    as_json: bool,
    out: Path | None,
    report: Path | None,
    spectrum: str | None,
    study: bool,
) -> None:
    """Solve a carriage file, and write or print the result; with `example`, write or print a file
    to start from.

    `out` receives the spectrum of the roller `spectrum`, or with `study` a study of all loads with
    a CSV file of its cases; otherwise netCDF. `report` receives the page. `as_json` prints JSON;
    without it and `out`, tables are printed.
    """
    if example:
        _write_example(
            file,
            out,
            {"--json": as_json, "--report": report, "--spectrum": spectrum, "--study": study},
        )
        return
    file = _given(file)
    target = _target(out, spectrum, study)
    page = _page(report)
    table = None
    if target is not None and study:
        table = _beside(target)
    from trackroller.carriage.file import load_carriage
    from trackroller.report.pages.carriage import print_carriage, write_carriage  # heavy: jinja2
    from trackroller.report.pages.sheet import as_json as text_of

    whole = load_carriage(file)
    loads_alone = (spectrum is not None or study) and page is None and not as_json
    ds = _solved(whole, loads_alone)
    if target is not None:
        _write(whole, ds, target, spectrum, table)
    if page is not None:
        write_carriage(ds, page, file.name)
    if as_json:
        print(text_of(ds))
    elif target is None:
        print_carriage(ds)


def _solved(whole: Carriage, loads_alone: bool) -> xr.Dataset:
    """Return the solution of a carriage, or its loads, which need neither margins nor lives; print
    what is doubtful.
    """
    # heavy: scipy
    from trackroller.carriage.solve import doubts_of_rollers, forces_of, solve_carriage
    from trackroller.roller.stored_inputs import doubts_of
    from trackroller.study.progress import progress_bar

    if loads_alone:
        ds = forces_of(whole)
        print_doubts(doubts_of_rollers(whole, ds))
        return ds
    with progress_bar(whole.name, len(whole.cases) >= MANY) as bar:
        bar.started(len(whole.cases), 0)
        ds = solve_carriage(whole, advanced=lambda count: bar.advanced(count, 0))
    print_doubts(doubts_of(ds))
    return ds


def _write(
    whole: Carriage, ds: xr.Dataset, target: Path, spectrum: str | None, table: Path | None
) -> None:
    """Write the spectrum of one roller, a study of all loads with its table, or netCDF."""
    from trackroller.carriage.files import spectrum_of, study_of

    if spectrum is not None:
        write_yaml_file(target, spectrum_of(whole, ds, spectrum))
    elif table is not None:
        keys, rows = study_of(whole, ds, table.name)
        write_text(table, rows)
        digest = hashlib.sha256(rows.encode()).hexdigest()
        write_yaml_file(target, keys, TABLE_OF_US.format(table.name, digest))
    else:
        write_result(ds, target)


def _page(report: Path | None) -> Path | None:
    """Return the path of the page, checked before anything is solved."""
    if report is None:
        return None
    return writable_page(report)


def _given(file: Path | None) -> Path:
    """Return the carriage file; a user who has none learns how to get one."""
    if file is None:
        remedy = f"Write one to start from: {START.format('shuttle.yaml')}, and change its values."
        raise InputError(
            "carriage file", None, "a file with masses, rollers and load cases", remedy
        )
    if not file.exists():
        remedy = (
            f"Check the path, or write an example there: {START.format(shlex.quote(str(file)))}"
        )
        raise InputError("carriage file", str(file), "the path of a file", remedy, "does not exist")
    return file


def _write_example(file: Path | None, out: Path | None, others: Mapping[str, object]) -> None:
    """Write or print the example; a file that is there stays."""
    from trackroller.carriage.example import EXAMPLE

    beside = [name for name, value in others.items() if value]
    if file is not None:
        beside.insert(0, str(file))
    if beside:
        remedy = f"Write the example first: {START.format('shuttle.yaml')}"
        raise InputError(
            "--example", beside[0], "nothing but -o beside it", remedy, "stands beside it"
        )
    if out is None:
        print(EXAMPLE, end="")
        return
    if out.suffix.lower() not in YAML or os.path.lexists(out):
        wrong = ""
        if os.path.lexists(out):
            wrong = "is there already"
        raise InputError(
            "--out", str(out), "a new file whose name ends in .yaml", "Give another name.", wrong
        )
    write_text(writable(out), EXAMPLE)
    print_line(
        f"{out} is written. Change its values, then: trackroller carriage {shlex.quote(str(out))}"
    )


def _beside(study: Path) -> Path:
    """Return the table of cases to write beside a study; refuse to replace one that is not as it
    was written.
    """
    table = study.with_suffix(".csv")
    if not os.path.lexists(table):
        return table
    written = []
    if study.is_file():
        written = study.read_text(encoding="utf-8").splitlines()
    if not table.is_file() or TABLE_OF_US.format(table.name, sha256(table)) not in written:
        allowed = f"a name beside which {table.name} is free, or as this command wrote it"
        remedy = f"Give another name with -o, or move {table.name} away."
        raise InputError(
            "--out",
            study.name,
            allowed,
            remedy,
            f"would replace {table.name}, which somebody has changed",
        )
    return table


def _target(out: Path | None, spectrum: str | None, study: bool) -> Path | None:
    """Return the file to write; refuse options that contradict each other."""
    if spectrum is not None and study:
        raise InputError(
            "--study", "true", "one of --spectrum and --study", "Run the command once for each."
        )
    if spectrum is None and not study:
        if out is None:
            return None
        return writable_data(out, " --json prints the result as text.")
    option = "--spectrum"
    if spectrum is None:
        option = "--study"
    if out is not None and out.suffix.lower() in YAML:
        return writable(out)
    allowed = f"a file whose name ends in .yaml, which {option} writes"
    raise InputError("--out", out and str(out), allowed, "Add -o shift.yaml.")
