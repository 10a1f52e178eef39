"""The commands of shelves: show and check the rows of a table, and find the least roller that is
enough.
"""

from __future__ import annotations

import json
import math
import os
import shlex
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from trackroller.cli.case import YAML, read_case, writable, write_yaml_file
from trackroller.cli.usage import print_doubts, print_line
from trackroller.damage import limit_word
from trackroller.damage.bearing import FIELD as BEARING
from trackroller.damage.catalogue import FIELD as CATALOGUE
from trackroller.damage.stud import FIELD as STUD
from trackroller.errors import InputError, raise_all
from trackroller.files import files_beside, write_text
from trackroller.report.sizing import head_of, lead_of, notes_of, shown
from trackroller.report.terminal import print_table, print_text
from trackroller.study.design.factor_names import SHELVES
from trackroller.study.design.levels import entries, in_words
from trackroller.study.file.load import parse_study
from trackroller.study.file.shelf import ROLLER, base_beside_shelf, with_rows, without_overridden
from trackroller.study.file.shelf_example import CASE, EXAMPLE
from trackroller.study.file.study import Study
from trackroller.study.store.crate import write_crate
from trackroller.study.store.ledger import study_folder

if TYPE_CHECKING:
    from trackroller.results.mounting import Mounting
    from trackroller.results.results import Results
    from trackroller.results.size import Sizing


def print_shelf(
    file: Path | None,
    of: str,
    case: Path | None,
    settings: list[str] | None,
    example: bool = False,
) -> None:
    """Print the rows of a shelf after all checks of a study: `of` says of what, a case gives rail
    and empty cells. With `example`, print a shelf to start from, or write it to `file`.
    """
    if example:
        _write_example(file)
        return
    if file is None or not file.exists():
        remedy = (
            "Check the path, or write one to start from: trackroller shelf --example rollers.csv"
        )
        wrong = "is not given" if file is None else "does not exist"
        raise InputError("shelf", str(file or ""), "the path of a table of rollers", remedy, wrong)
    if of not in SHELVES:
        raise InputError("--of", of, ", ".join(SHELVES), "Choose one of them.")
    study = shelf_study(file, of, case, settings)
    factor = study.parsed[of]
    heads = ["name", *(head_of(name, factor.units) for name in factor.beside)]
    rows = []
    for i, level in enumerate(factor.levels):
        values = [_cell(name, column[i]) for name, column in factor.beside.items()]
        rows.append([in_words(of, level), *values])
    print_table(heads, rows)
    print_text(f"rows: {len(rows)}. A study takes them as factors: {{{of}: {{file: {file.name}}}}}")
    print_doubts(study.doubts())


def _write_example(file: Path | None) -> None:
    """Write or print the example of a shelf."""
    if file is None:
        print(EXAMPLE, end="")
        return
    _write_new(file, EXAMPLE, ".csv", "shelf")
    then = f"trackroller shelf {shlex.quote(str(file))}"
    print_line(f"{file} is written. Write your rollers into it, then: {then}")


def _write_new(file: Path, text: str, end: str, what: str) -> None:
    """Write a file to start from; a file that is there stays."""
    if file.suffix.lower() != end or os.path.lexists(file):
        wrong = ""
        if os.path.lexists(file):
            wrong = "is there already"
        allowed = f"a new file whose name ends in {end}"
        raise InputError(what, str(file), allowed, "Give another name.", wrong)
    write_text(writable(file), text)


def _write_example_case(file: Path) -> int:
    """Write the example of a case with loads, rail and duty, and return the exit code."""
    _write_new(file, CASE, ".yaml", "case")
    then = f"trackroller size {shlex.quote(str(file))} --shelf rollers.csv --life '3 years'"
    start = "trackroller shelf --example rollers.csv writes a shelf"
    print_line(f"{file} is written. Change its values, then: {then} ({start})")
    return 0


def _check_given(case: Path, shelf: Path | None) -> Path:
    """Return the path of the shelf; a user who has no files learns how to get them."""
    if not case.exists():
        remedy = f"Check the path, or write one to start from: trackroller size --example {case}"
        raise InputError("case file", str(case), "the path of a file", remedy, "does not exist")
    if shelf is None:
        start = "trackroller shelf --example rollers.csv"
        remedy = f"Add --shelf rollers.csv; {start} writes one to start from."
        raise InputError("--shelf", None, "a table of rollers", remedy, "is missing")
    return shelf


def print_size(  # noqa: PLR0913 - one argument for each option of the command
    case: Path,
    shelf: Path | None,
    life: str | None,
    failures: str | None,
    safety: str | None,
    temperature: str | None,
    wear_depth: str | None,
    least: str | None,
    each: bool,
    out: Path | None,
    results: Path,
    as_json: bool,
    quiet: bool,
    example: bool,
) -> int:
    """Print which rollers of a shelf are enough, and return the exit code: 0 if one is.

    With `each`, `out` receives the carriage file with the roller of each place; of a spectrum it
    receives the file with the least roller. With `example`, `case` is written as a file to start
    from.
    """
    if example:
        return _write_example_case(case)
    shelf = _check_given(case, shelf)
    target = None
    from trackroller.results.size import is_spectrum, size  # heavy: analysis

    if out is not None:
        target = _target(out, each or is_spectrum(case))

    with _as_options():
        sizing = size(
            case,
            shelf,
            life=life,
            failures=failures,
            safety=safety,
            temperature=temperature,
            wear_depth=wear_depth,
            least=least,
            each=each,
            results=results,
            progress=not quiet,
        )
    for own in _studies_of(sizing):
        write_crate(study_folder(own.study.name, results).root)
    is_met = bool(sizing.least)
    if sizing.mounting is not None:
        is_met = sizing.mounting.enough
    if target is not None and sizing.mounting is not None and sizing.mounting.enough:
        write_yaml_file(target, sizing.mounting.carriage)
    elif target is not None and sizing.spectrum:
        write_yaml_file(target, _beside(target, case, sizing.spectrum))
    if as_json:
        print(json.dumps(sizing.to_dict(), ensure_ascii=False, allow_nan=False))
        return int(not is_met)
    _print_sizing(sizing, target)
    return int(not is_met)


@contextmanager
def _as_options() -> Iterator[None]:
    """Name in errors the options of `trackroller size` in place of the arguments of `size`."""
    try:
        yield
    except InputError as error:
        raise_all(_of_option(one) for one in error.errors)


def _of_option(error: InputError) -> InputError:
    """Return an error on an argument of `size` as one on the option of its name."""
    from trackroller.results.size import REQUIRED  # heavy: analysis

    if error.field == "size":  # nothing is required
        remedy = "Add --life '3 years', or --safety 1.5, for example."
        return InputError("--life", None, error.allowed, remedy, "is missing")
    if error.field in (*REQUIRED, "each"):
        return error.named(f"--{error.field.replace('_', '-')}")
    return error


def _print_sizing(sizing: Sizing, target: Path | None) -> None:
    """Print the least roller, the table of rollers, their load ratios, and the places of a
    carriage.
    """
    print_text(lead_of(sizing))
    for sentence in notes_of(sizing):
        print_text(sentence)
    rows = [[shown(value) for value in row] for row in sizing.table.itertuples(index=False)]
    print_table([head_of(str(name), sizing.units) for name in sizing.table], rows)
    if sizing.ratios is not None:
        _print_ratios(sizing)
    if sizing.mounting is not None:
        _print_mounting(sizing.mounting, target)
    if sizing.spectrum and target is None:
        print_text("no study is kept of a spectrum; -o sized.yaml writes it with the least roller")
    elif sizing.spectrum and target is not None:
        then = f"trackroller spectrum {shlex.quote(str(target))} --report page.html"
        print_text(f"{target}: the spectrum with {sizing.least}; its page: {then}")
    for own in _studies_of(sizing):
        print_text(f"study {own.study.name}: trackroller report {own.study.name} writes its page")


def _studies_of(sizing: Sizing) -> list[Results]:
    """Return the solved studies of a sizing."""
    return [own for own in (sizing.results, sizing.overload) if own is not None]


def _beside(target: Path, case: Path, spectrum: Mapping[str, Any]) -> dict[str, Any]:
    """Return the keys of a spectrum whose table of blocks is found from the folder of a file."""
    keys = dict(spectrum)
    if isinstance(keys["blocks"], str):
        keys["blocks"] = os.path.relpath(case.parent / keys["blocks"], target.parent)
    return keys


def _target(out: Path, is_written: bool) -> Path:
    """Return the path of the carriage or spectrum, checked before anything is solved."""
    if not is_written:
        allowed = "a file beside --each, or with a spectrum"
        raise InputError("--out", str(out), allowed, "Add --each, or leave it out.")
    if out.suffix.lower() not in YAML:
        raise InputError("--out", str(out), "a name that ends in .yaml", "Give another name.")
    return writable(out)


def _print_mounting(mounting: Mounting, target: Path | None) -> None:
    """Print the roller of each place of a carriage."""
    if mounting.enough:
        print_text("each place with its own roller, solved together:")
    else:
        print_text("No rollers are enough together; these are at their place alone:")
    heads = [head_of(str(name), {}) for name in mounting.table]
    rows = [[shown(value) for value in row] for row in mounting.table.itertuples(index=False)]
    print_table(heads, rows)
    if target is not None and mounting.enough:
        print_text(f"{target}: the carriage with these rollers")


def _print_ratios(sizing: Sizing) -> None:
    """Print what all forces of the case may be multiplied by until each limit is reached."""
    assert sizing.ratios is not None
    table = sizing.ratios.table.reindex(sizing.table[ROLLER])
    print_text("all forces may be multiplied by, until a limit is at 100 %:")
    rows = [[name, *map(shown, row)] for name, *row in table.itertuples()]
    print_table([ROLLER, *(limit_word(str(name)) for name in table)], rows)


def shelf_study(file: Path, of: str, case: Path | None, settings: list[str] | None) -> Study:
    """Return a study of the rows of a shelf beside the values of a case, which the shelf
    overrides.
    """
    base: dict[str, Any] = {}
    if case is not None or settings:
        base, _, _ = read_case(case, settings, base_beside_shelf)
    with files_beside(file):
        keys, places = with_rows(
            {"name": "shelf", "base": base, "factors": {of: {"file": file.name}}}
        )
    with places.in_files():
        study = parse_study(without_overridden(keys, of))
    return study


def _cell(name: str, value: Any) -> str:
    """Return a value of a row as text."""
    if value is None or value == "" or (isinstance(value, float) and math.isnan(value)):
        return "–"
    if name in (BEARING.name, CATALOGUE.name, STUD.name):
        return entries(json.loads(value))
    return in_words(name, value)
