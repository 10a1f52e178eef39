"""Commands that solve or draw one case, or solve the blocks of a load spectrum."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from trackroller.cli.usage import print_doubts, print_line
from trackroller.errors import InputError, WorkError
from trackroller.files import files_beside, read_text, write_text, write_whole
from trackroller.materials import load_database
from trackroller.parameters import REGIMES
from trackroller.parameters.example import LASTING, with_unit
from trackroller.roller.aliases import WRITTEN, overridden
from trackroller.roller.case import Case
from trackroller.roller.doubts import doubts_of_case
from trackroller.roller.settings import checked_case, with_beside
from trackroller.yaml_file import (
    errors_by_line,
    parse_mapping,
    parse_yaml,
    read_mapping,
    write_yaml,
)

if TYPE_CHECKING:
    import xarray as xr

Checked = TypeVar("Checked")
COMPLETE = ("forces", "contact", "peak_stress", "life")
WORKBOOK = "A name that ends in .xlsx writes a workbook."
PRINTED = " --json prints the result as text, and --report writes a page."
# the first bytes of a file, by the end of its name
BY_US = "# Written by trackroller, which may replace this file. Remove this line if you change it."
KINDS = {".html": b"<!doctype html>", ".htm": b"<!doctype html>", ".pdf": b"%PDF", ".xlsx": b"PK"}
KINDS |= dict.fromkeys((".yaml", ".yml"), BY_US.encode())
MADE = b"trackroller"  # stands in what this program writes
MARKS = {".html": b'<meta name="generator" content="trackroller">', ".pdf": b""}
MARKS[".htm"] = MARKS[".html"]
YAML = (".yaml", ".yml")
SHEET_OUTPUTS = (*COMPLETE, "friction_work", "tractions", "subsurface")


def settings_of(words: list[str] | None) -> dict[str, Any]:
    """Return the mapping of key=value words, if there are any; the values are read as YAML."""
    settings: dict[str, Any] = {}
    for word in words or ():
        key, sign, value = word.partition("=")
        if not sign or not key:
            raise InputError(
                "--set", word, "key=value", "For example --set friction_coefficient=0.1"
            )
        if len(word.splitlines()) > 1:
            raise InputError(
                "--set", word, "one key=value on one line", "Give --set once for each key."
            )
        if not value.strip():
            raise InputError(
                "--set",
                word,
                "key=value",
                f"Give a value, or leave --set {key.strip()} out.",
                "has no value",
            )
        if key.strip() in settings:
            raise InputError(
                "--set",
                word,
                "each key once",
                "Remove one of the two.",
                f"gives {key.strip()} twice",
            )
        settings[key.strip()] = parse_yaml(value, f"--set {key}")
    return settings


def case_of(
    path: Path | None, words: list[str] | None
) -> tuple[Case, dict[str, Any], dict[str, Any]]:
    """Return the case, the options, duty and sheet of a case file and of --set words; see
    `checked_case`.

    Without any of them it is the roller with which the live page begins.
    """
    return read_case(path, words, checked_case)


def read_case(
    path: Path | None, words: list[str] | None, checked: Callable[[dict[str, Any]], Checked]
) -> Checked:
    """Return what a function makes of the values of a case file, over which --set words stand."""
    if path is not None and "=" in path.name and not path.exists():
        remedy = f"Write --set {path}: each key has a --set of its own."
        raise InputError("case file", str(path), "the path of a file", remedy, "does not exist")
    if path is None:
        text = ""
    else:
        text = read_text(path, "case file")
    given = settings_of(words)
    if path is not None:
        values = parse_mapping(text, "case file")
    else:
        values = {} if given else dict(LASTING)
    named = {*given, *(WRITTEN.get(name, name) for name in given)}
    with errors_by_line(text, named, aliases=WRITTEN), files_beside(path):
        return checked(overridden(values, given))


def tell_start(path: Path | None, words: list[str] | None) -> None:
    """Print on stderr which roller is solved where neither a case file nor --set words were
    given.
    """
    if path is None and not words:
        first = ", ".join(with_unit(name, value) for name, value in LASTING.items())
        print_line(
            f"No case was given. This is the roller with which the live page begins: {first}."
        )


def tell_doubts(case: Case) -> None:
    """Print a line on stderr for each unusual value of a case."""
    print_doubts(doubts_of_case(case, load_database()))


def groups_of(words: str) -> tuple[str, ...]:
    """Return the groups of outputs of the limits `all`, or of limits whose names are separated by
    commas.
    """
    from trackroller import damage  # heavy: numpy and scipy

    return damage.groups_of("--limits", [word.strip() for word in words.split(",")])


def _left_out(words: str) -> tuple[str, ...]:
    """Return the limits that a choice of limits leaves out."""
    from trackroller import damage  # heavy: as above

    return damage.others([word.strip() for word in words.split(",")])


def _served(case: Case, options: Mapping[str, Any]) -> tuple[str, ...]:
    """Return the groups of outputs of the checked limits whose inputs a case gives."""
    from trackroller.roller.case import to_table
    from trackroller.roller.case_limits import solved_of, to_compute  # heavy: as above
    from trackroller.roller.options import Options

    of_limits = Options(**{**options, "outputs": ("limits",)})
    limits = to_compute(solved_of(to_table(case), {}, of_limits), of_limits)
    return tuple(limit.group for limit in limits)


def solve_case(
    case: Case, options: Mapping[str, Any], beside: Mapping[str, Any], **further: Any
) -> xr.Dataset:
    """Solve a case with what `case_of` returned beside it; `further` are other options of
    `solve`.
    """
    tell_doubts(case)
    from trackroller.roller.solver import solve  # heavy: xarray and dask

    return with_beside(solve(case, **{**options, **further}), beside)


def writable(out: Path) -> Path:
    """Return the file to write for the path that a user gave.

    The target of a symbolic link is written, and the link stays. A file that this program wrote is
    replaced; a PDF by any other PDF, because a printed page has no mark.

    Raises
    ------
    InputError
        If the folder is missing, or `out` is there and is not a regular file, or a file of somebody
        else, which may be the very file that the command reads.
    """
    target = Path(os.path.realpath(out))
    if target.exists() and not target.is_file():
        raise InputError(
            "--out", str(out), "the path of a regular file", "Give the name of a file to write."
        )
    if target.is_file() and not _is_ours(target, out.suffix.lower()):
        allowed = "a new file, or one of its kind that trackroller wrote"
        remedy = "Give another name, or move the file away."
        raise InputError(
            "--out", str(out), allowed, remedy, "is a file that trackroller did not write"
        )
    if not target.parent.is_dir():
        wrong = "stands in a folder that does not exist"
        raise InputError(
            "--out", str(out), "a file in a folder", f"Create the folder {target.parent}.", wrong
        )
    return target


def writable_data(out: Path, otherwise: str = "") -> Path:
    """Return the netCDF file to write for the path that a user gave; see `writable`.

    Another ending than .nc is refused, because a file must be what its name says. `otherwise` says
    how to get the result in another form.
    """
    if out.suffix.lower() != ".nc":
        remedy = f"Write {out.stem or 'result'}.nc.{otherwise}"
        raise InputError(
            "--out",
            str(out),
            "a file whose name ends in .nc, because it is written as netCDF",
            remedy,
        )
    return writable(out)


def _is_ours(path: Path, suffix: str) -> bool:
    """Return whether a file is empty, or of the kind that a suffix stands for and written by this
    program.

    netCDF is the default. It names the program in its history; a CSV file has columns that no table
    of a user may have.
    """
    content = path.read_bytes()
    if suffix == ".csv":
        return not content or {b"regime", b"converged"} <= {
            *content.partition(b"\n")[0].split(b",")
        }
    head = content
    if suffix in (".html", ".htm"):
        head = content[:4096]
    return not content or (
        content.startswith(KINDS.get(suffix, (b"CDF", b"\x89HDF")))
        and MARKS.get(suffix, MADE) in head
    )


def write_yaml_file(target: Path, values: Mapping[str, Any], comment: str = "") -> None:
    """Write a spectrum or study file as YAML, with the mark by which `writable` knows it; `target`
    comes from there.

    A `comment` is a line below the mark.
    """
    parts = [BY_US, comment, write_yaml(values)]
    write_text(target, "\n".join(part for part in parts if part))


def free_for_page(page: Path) -> None:
    """Refuse to write a page that the user did not name over a file that is no page of this
    program.
    """
    if os.path.lexists(page) and not (page.is_file() and _is_ours(page, ".html")):
        allowed = "a new file, or a page that trackroller wrote"
        wrong = "is a file of somebody else"
        raise InputError("--out", str(page), allowed, "Give another path with -o.", wrong)


def writable_page(page: Path) -> Path:
    """Return the page to write for the path that a user gave, .html or .pdf; see `writable`."""
    from trackroller.report.html import check_page  # heavy: jinja2

    check_page(page)
    return writable(page)


def write_result(dataset: xr.Dataset, target: Path) -> None:
    """Write a result as netCDF, whole or not at all; `target` comes from `writable`."""
    write_whole(target, lambda beside: dataset.to_netcdf(beside, engine="netcdf4"))


def _write_roller(dataset: xr.Dataset, target: Path, book: bool) -> None:
    """Write the result of one case as a workbook or as netCDF."""
    if not book:
        write_result(dataset, target)
        return
    from trackroller.report.workbook import write_roller  # heavy: pandas and jinja2

    write_roller(dataset, target)


def _options(
    given: Case, options: Mapping[str, Any], limits: str | None, sheet: bool, plain: bool
) -> dict[str, Any]:
    """Return the outputs of a case that is told with its margins, and the limits that it leaves
    out.

    A `plain` result, which is not told, has the outputs of the case file.
    """
    if plain and not sheet and limits is None:
        return {}
    if limits is not None:
        return {"outputs": (*COMPLETE[:2], *groups_of(limits)), "not_checked": _left_out(limits)}
    shown: tuple[str, ...] = COMPLETE
    if sheet:
        shown = SHEET_OUTPUTS
    outputs = dict.fromkeys((*shown, "limits", *_served(given, options)))
    return {"outputs": tuple(outputs)}


def _target(out: Path | None) -> Path | None:
    """Return the path of the results, a workbook or netCDF, checked before anything is solved."""
    if out is None:
        return None
    if out.suffix.lower() == ".xlsx":
        return writable(out)
    return writable_data(out, f" {WORKBOOK}{PRINTED}")


def _page(sheet: Path | None) -> Path | None:
    """Return the path of the page, checked before anything is solved."""
    if sheet is None:
        return None
    return writable_page(sheet)


def _name(case: Path | None) -> str:
    """Return the name of a case for its page; an example without a file has none."""
    if case is None:
        return ""
    return case.stem


def solve_and_tell(  # noqa: PLR0913 - one argument for each option of the command
    case: Path | None,
    settings: list[str] | None,
    as_json: bool,
    out: Path | None,
    sheet: Path | None,
    limits: str | None,
    find: str | None,
    condition: str | None,
    no_shortcuts: bool,
) -> int:
    """Solve a case, write or print what was asked for, and return the exit code: 1 if the case
    failed.

    `limits` are names of limits, of which the margins alone are printed. `find` is a parameter, and
    `condition` what is met in the range that is sought.
    """
    if find is not None or condition is not None:
        _check_search_alone(find, out, sheet, limits)
        return _find_and_tell(case, settings, find, condition, as_json)
    given, options, beside = case_of(case, settings)
    book = out is not None and out.suffix.lower() == ".xlsx"
    target = _target(out)
    page = _page(sheet)
    plain = as_json or (target is not None and not book) or "outputs" in options
    chosen = _options(given, options, limits, page is not None, plain)
    if no_shortcuts:
        chosen["shortcuts"] = False
    dataset = solve_case(given, options, beside, **chosen)
    tell_start(case, settings)
    if target is not None:
        _write_roller(dataset, target, book)
    if page is not None:
        from trackroller.report.pages.sheet import write_sheet  # heavy: rich and jinja2

        write_sheet(dataset, page, _name(case))
    if as_json or target is None:
        _print_case(dataset, as_json, limits is not None)
    if not is_failed(dataset):
        return 0
    if as_json or target is not None:
        print(f"trackroller: the case failed: {dataset['reason'].item()}", file=sys.stderr)
    return 1


def _print_case(dataset: xr.Dataset, as_json: bool, margins_alone: bool) -> None:
    """Print the result of a case as JSON, its margins alone, or its facts; a case that failed has
    no margins.
    """
    from trackroller.report.pages.sheet import as_json as json_of  # heavy: rich and jinja2
    from trackroller.report.pages.sheet import print_facts, print_limits

    if as_json:
        print(json_of(dataset))
    elif margins_alone and not is_failed(dataset):
        print_limits(dataset)
    else:
        print_facts(dataset)


def _check_search_alone(
    find: str | None, out: Path | None, sheet: Path | None, limits: str | None
) -> None:
    """Refuse other results beside a search."""
    if out is not None or sheet is not None or limits is not None:
        remedy = "Give one of them at a time."
        raise InputError(
            "--find", find or "", "a search alone, without -o, --report and --limits", remedy
        )


def _find_and_tell(
    path: Path | None,
    settings: list[str] | None,
    name: str | None,
    condition: str | None,
    as_json: bool,
) -> int:
    """Print the range of a parameter in which a condition is met; return 1 if no value meets it."""
    if name is None or condition is None:
        if name is None:
            lacking, example = "--find", "axial_force"
        else:
            lacking, example = "--for", "'max_pressure < 900'"
        raise InputError(
            lacking, "", "both --find and --for", f"For example {lacking} {example}.", "is missing"
        )
    case, options, _ = case_of(path, settings)
    tell_start(path, settings)
    tell_doubts(case)
    from trackroller.roller.find import find  # heavy: xarray and dask

    settings_of_solve = {key: value for key, value in options.items() if key != "outputs"}
    range_ = find(case, name, condition, **settings_of_solve)
    if as_json:
        print(json.dumps(range_.as_dict(), allow_nan=False))
    else:
        print(range_.text)
    return int(not range_.met)


def run_spectrum(
    file: Path | None, as_json: bool, out: Path | None, report: Path | None, log: Path | None
) -> None:
    """Solve the blocks of a spectrum file, and write or print the result.

    `out` receives netCDF, and `report` the page. `as_json` prints JSON; without it and `out`,
    tables are printed. With `log`, `out` receives the spectrum of a log instead, and `file` is the
    case file of its roller.
    """
    if log is not None:
        _write_log(log, file, out, as_json or report is not None)
        return
    if file is None:
        raise InputError(
            "spectrum file", None, "the path of a file", "Write trackroller spectrum shift.yaml."
        )
    if out is None:
        target = None
    else:
        target = writable_data(out, PRINTED)
    if report is None:
        page = None
    else:
        page = writable_page(report)
    from trackroller.report.pages.sheet import as_json as json_of  # heavy: jinja2
    from trackroller.report.pages.spectrum import print_spectrum, write_spectrum
    from trackroller.study.spectrum.file import load_spectrum
    from trackroller.study.spectrum.solve import doubts_of_spectrum, solve_spectrum

    spectrum = load_spectrum(file)
    print_doubts(doubts_of_spectrum(spectrum, load_database()))
    dataset = solve_spectrum(spectrum)
    if target is not None:
        write_result(dataset, target)
    if page is not None:
        write_spectrum(dataset, page, file.name)
    if as_json:
        print(json_of(dataset))
    elif target is None:
        print_spectrum(dataset)


def _write_log(log: Path, roller: Path | None, out: Path | None, has_other_outputs: bool) -> None:
    """Write the load spectrum of a log, and print what a user must know of the log."""
    if has_other_outputs or out is None or out.suffix.lower() not in YAML:
        allowed = "--from with -o and a file whose name ends in .yaml"
        raise InputError(
            "--from",
            str(log),
            allowed,
            "Add -o shift.yaml, and solve that file by trackroller spectrum.",
        )
    target = writable(out)
    from trackroller.study.spectrum.history import spectrum_of_log  # heavy: numpy

    if roller is None:
        given = {}
    else:
        given = read_mapping(roller, "case file")
    if roller is not None:
        case_of(roller, None)  # refuses wrong values before the log is read
    spectrum, notes = spectrum_of_log(log, given)
    write_yaml_file(target, spectrum)
    for note in notes:
        print(note)


def run_wear(
    case: Path | None,
    to: str,
    settings: list[str] | None,
    as_json: bool,
    out: Path | None,
    report: Path | None,
    quiet: bool,
) -> None:
    """Follow a roller while it wears; `out` receives the states one by one, and a later run goes on
    from there. `as_json` prints JSON in place of the tables.
    """
    target = None if out is None else writable_data(out)
    page = _page(report)
    new, options, beside = case_of(case, settings)
    tell_start(case, settings)
    tell_doubts(new)

    from trackroller.report.pages.record import print_record
    from trackroller.report.pages.sheet import as_json as json_of
    from trackroller.report.pages.wear import write_wear
    from trackroller.results.wear_answer import answer_of_wear
    from trackroller.roller.wear import wear

    def tell(dataset: xr.Dataset, goal: float) -> None:
        if target is not None:
            write_result(dataset, target)
        if not quiet and not as_json:
            last = dataset.isel(travel=-1)
            depth = 1e3 * float(last["groove_depth"].max())
            print_line(f"{float(last['travel']):.4g} of {goal:g} km, depth {depth:.3g} um")

    dataset = wear(new, to, resume=_states_before(target, out), tell=tell, **options)
    if target is not None:
        write_result(dataset, target)
    worn = with_beside(dataset, beside)
    if page is not None:
        write_wear(worn, page)
    if as_json:
        print(json_of(worn))
    else:
        print_record(answer_of_wear(worn))


def _states_before(target: Path | None, out: Path | None) -> xr.Dataset | None:
    """Return the states from which a run of wear goes on; None without a file that holds some."""
    from trackroller.study.store.netcdf import read_netcdf

    if target is None or not target.exists() or not target.stat().st_size:
        return None
    remedy = "A run goes on from what the file holds: give another name."
    before = read_netcdf(target, "--out", remedy)
    if "next_step" not in before:
        allowed = "a new file, or one that `trackroller wear` wrote, to go on from"
        wrong = "holds something else"
        raise InputError("--out", str(out), allowed, "Give another name.", wrong)
    return before


def is_failed(dataset: xr.Dataset) -> bool:
    """Return True if the single case of a result has no solution."""
    return REGIMES[int(dataset["regime"])] == "failed"


def plot_target(target: str, settings: list[str] | None, out: Path | None, results: Path) -> None:
    """Draw the case of a case file, or the figures of a study."""
    path = Path(target)
    if path.suffix in (".yaml", ".yml") and not names_study(path):
        from trackroller.report.figures.contact import plot_case

        drawn_outputs = ("forces", "contact", "peak_stress", "tractions", "subsurface")
        dataset = solve_case(*case_of(path, settings), outputs=drawn_outputs)
        if is_failed(dataset):
            raise WorkError(f"{path} has no solution to draw: {dataset['reason'].item()}")
        folder = out or Path(f"{path.stem}-figures")
        drawn = plot_case(dataset, folder)
    else:
        from trackroller.report.build import draw_solved
        from trackroller.study.status import find_study

        folder, drawn = draw_solved(find_study(target, results)[1], out)
    print(f"{len(drawn)} figures in {folder}")


def names_study(path: Path) -> bool:
    """Return True for a study file, which has factors, a base, a name or a method; any other file
    is a case file.
    """
    return bool(
        {"factors", "base", "name", "design", "method"}
        & set(read_mapping(path, "study or case file"))
    )
