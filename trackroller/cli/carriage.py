"""The command of a carriage: loads, lives and margins of its rollers, and the files that follow from them."""

from __future__ import annotations

from pathlib import Path

from trackroller.cli.case import YAML, writable, writable_data, writable_page, write_result, write_spectrum_file
from trackroller.cli.usage import print_doubts
from trackroller.errors import InputError


def run_carriage(
    file: Path, as_json: bool, out: Path | None, report: Path | None, spectrum: str | None, study: bool
) -> None:
    """Solve a carriage file, and write or print the result.

    `out` receives the spectrum of the roller `spectrum`, or with `study` a study of the worst loads, otherwise netCDF.
    `report` receives the page. `as_json` prints JSON; without it and `out`, tables are printed.
    """
    target = _target(out, spectrum, study)
    page = None if report is None else writable_page(report)
    from trackroller.carriage.file import load_carriage
    from trackroller.carriage.files import doubts_of_carriage, spectrum_of, study_of
    from trackroller.carriage.solve import forces_of, solve_carriage  # heavy: scipy
    from trackroller.report.pages.carriage import print_carriage, write_carriage  # heavy: jinja2
    from trackroller.report.pages.sheet import as_json as text_of

    whole = load_carriage(file)
    if spectrum is not None and page is None and not as_json:
        ds = forces_of(whole)  # a spectrum needs neither margins nor lives
    else:
        ds = solve_carriage(whole, lives=spectrum is None or page is not None)
    print_doubts(doubts_of_carriage(whole, ds))
    if target is not None and spectrum is not None:
        write_spectrum_file(target, spectrum_of(whole, ds, spectrum))
    elif target is not None and study:
        write_spectrum_file(target, study_of(whole, ds))
    elif target is not None:
        write_result(ds, target)
    if page is not None:
        write_carriage(ds, page, file.name)
    if as_json:
        print(text_of(ds))
    elif target is None:
        print_carriage(ds)


def _target(out: Path | None, spectrum: str | None, study: bool) -> Path | None:
    """Return the file to write; refuse options that contradict each other."""
    if spectrum is not None and study:
        raise InputError("--study", "true", "one of --spectrum and --study", "Run the command once for each.")
    if spectrum is None and not study:
        return None if out is None else writable_data(out, " --json prints the result as text.")
    option = "--study" if spectrum is None else "--spectrum"
    if out is None or out.suffix.lower() not in YAML:
        allowed = f"a file whose name ends in .yaml, which {option} writes"
        raise InputError("--out", None if out is None else str(out), allowed, "Add -o shift.yaml.")
    return writable(out)
