"""The command line: read the arguments and call the command.

Exit codes: 0 done, 1 the work failed, 2 the input is wrong, 3 an error of the program.
"""

from __future__ import annotations

import codecs
import functools
import gc
import io
import os
import signal
import sys
import tempfile
import traceback
import unicodedata
import warnings
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

import typer

from trackroller import __version__
from trackroller.cli import INTERRUPTED, STOPPED
from trackroller.cli.fit import fit
from trackroller.cli.materials import materials
from trackroller.cli.usage import Commands, print_line
from trackroller.errors import InputError, WorkError
from trackroller.files import (
    FAILED_WRITES,
    check_utf_8,
    disk_error,
    interrupts_wait_for_files,
    long_name,
)
from trackroller.numerics.threads import check_threads
from trackroller.parameters import options_text

app = typer.Typer(
    cls=Commands,
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    help="Parameter studies of locating-bearing track rollers.",
    epilog="--allow-code with any command: load the limits of your own in config/limits/NAME.py, "
    "which are programs.",
)
app.add_typer(materials, name="materials")
app.add_typer(fit, name="fit")

CASE_HELP = "case file (YAML); without it and --set the first roller of the live page"
SET_HELP = f"key=value, may be repeated; a parameter of the case or an option: {options_text()}"
SIGNS = dict(zip("−–×·→µ°±∞≤≥↑↓", "- - x * -> u deg +- inf <= >= ^ v".split(), strict=True))
NoShortcuts = Annotated[
    bool, typer.Option("--no-shortcuts", help="skip no stage; the results stay the same")
]
Results = Annotated[Path, typer.Option("--results", help="folder that holds results/NAME/")]
StudyFile = Annotated[Path, typer.Argument(help="study file (YAML)", show_default=False)]
AnyStudy = Annotated[
    str, typer.Argument(help="study file, or name of a study that was run", show_default=False)
]


def _version(asked_for: bool) -> None:
    if asked_for:
        typer.echo(f"trackroller {__version__}")
        raise typer.Exit


def command(module: str, name: str) -> Callable[[Callable[..., None]], None]:
    """Register a command whose arguments a function declares, and the function `name` of a module
    takes.

    The module is imported when the command runs, so that no other command waits for what it needs.
    The function returns the exit code, or None for 0.
    """

    def register(declared: Callable[..., None]) -> None:
        @app.command()
        @functools.wraps(declared)
        def run(**arguments: Any) -> None:
            raise typer.Exit(getattr(import_module(module), name)(**arguments) or 0)

    return register


@app.callback()
def _root(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="print it")
    ] = False,
) -> None:
    pass


@command("trackroller.cli.case", "solve_and_tell")
def solve(  # noqa: PLR0913 - one argument for each option of the command
    case: Annotated[Path | None, typer.Argument(help=CASE_HELP)] = None,
    settings: Annotated[list[str] | None, typer.Option("--set", help=SET_HELP)] = None,
    as_json: Annotated[bool, typer.Option("--json", help="print JSON")] = False,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="write netCDF (.nc) or a workbook (.xlsx)")
    ] = None,
    sheet: Annotated[
        Path | None, typer.Option("--report", help="write a sheet (.html or .pdf) as well")
    ] = None,
    limits: Annotated[
        str | None, typer.Option(help="print limits in one table: all, or names with commas")
    ] = None,
    find: Annotated[
        str | None, typer.Option("--find", help="parameter whose range is sought; needs --for")
    ] = None,
    condition: Annotated[
        str | None, typer.Option("--for", help="what is met there, e.g. 'max_pressure < 900'")
    ] = None,
    no_shortcuts: NoShortcuts = False,
) -> None:
    """Solve one case, or find how far a parameter may go, and exit with 1 if the case or the search
    fails.

    The keys are the parameters and materials of a case and the options of a study file.
    """


@command("trackroller.cli.study", "print_plan")
def plan(
    target: Annotated[
        Path | None, typer.Argument(help="study or case file (YAML)", show_default=False)
    ] = None,
    results: Results = Path("results"),
    explain: Annotated[
        bool, typer.Option("--explain", help="print which stages run, and why")
    ] = False,
    settings: Annotated[list[str] | None, typer.Option("--set", help="key=value of a case")] = None,
    no_shortcuts: NoShortcuts = False,
) -> None:
    """Print the number of cases and chunks, the expected time and disk space; solve nothing."""


@command("trackroller.cli.study", "run_with_progress")
def run(
    study: StudyFile,
    results: Results = Path("results"),
    rerun_failed: Annotated[
        bool, typer.Option("--rerun-failed", help="solve the failed cases again")
    ] = False,
    scheduler: Annotated[
        str | None, typer.Option(help="local or tcp://host:port, dask.distributed")
    ] = None,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="no progress bar")] = False,
    report: Annotated[
        bool, typer.Option("--report", help="make analysis, figures and report as well")
    ] = False,
) -> None:
    """Solve the missing cases of a study and gather the results; a stopped run goes on where it
    stopped.
    """


@command("trackroller.cli.study", "make_report")
def report(
    study: AnyStudy,
    results: Results = Path("results"),
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="a copy as .html or .pdf; cases as .xlsx")
    ] = None,
) -> None:
    """Make analysis, figures and report of a study that was run."""


@command("trackroller.cli.study", "print_best")
def best(
    study: AnyStudy,
    results: Results = Path("results"),
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="the report as a page (.html or .pdf)")
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="print the record of the answer as JSON")
    ] = False,
) -> None:
    """Print the answer to a study that was run: headline, table and warnings."""


@command("trackroller.cli.study", "print_explorer")
def explore(
    study: Annotated[
        str, typer.Argument(help="results/NAME, NAME, or a study.nc", show_default=False)
    ],
    results: Results = Path("results"),
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="file (.html); beside study.nc if not given")
    ] = None,
) -> None:
    """Write the explorer of a study that was run as one page (HTML) that works without a
    network.
    """


@command("trackroller.cli.study", "print_status")
def status(
    study: AnyStudy,
    results: Results = Path("results"),
    figures: Annotated[
        bool, typer.Option("--figures", help="draw the figures of the solved cases as well")
    ] = False,
) -> None:
    """Print how many cases are solved, missing and failed, the causes of failures, and the time
    left.
    """


@command("trackroller.cli.study", "print_repeat")
def repeat(
    study: AnyStudy,
    case: Annotated[
        int, typer.Argument(help="case number (variable `case` of study.nc)", show_default=False)
    ],
    results: Results = Path("results"),
) -> None:
    """Solve one case again, compare (exit 1 if a value differs by more than rounding), print a
    command for it alone.
    """


@command("trackroller.cli.study", "print_verified")
def verify(
    folder: Annotated[
        Path,
        typer.Argument(
            help="name of a study that was run, or its folder results/NAME", show_default=False
        ),
    ],
    results: Results = Path("results"),
) -> None:
    """Check every file of a study against the digests in its RO-Crate; exit 1 if one is missing or
    changed.
    """


@command("trackroller.cli.study", "print_rerun")
def rerun(
    crate: Annotated[
        Path,
        typer.Argument(help="results/NAME, or a copy of it from elsewhere", show_default=False),
    ],
    results: Annotated[
        Path, typer.Option("--results", help="folder for the repeated study")
    ] = Path("rerun"),
) -> None:
    """Solve a study again from its RO-Crate alone and compare; exit 1 if a value differs by more
    than rounding.
    """


@command("trackroller.cli.case", "run_spectrum")
def spectrum(
    file: Annotated[
        Path | None, typer.Argument(help="loads of a roller in blocks; with --from the roller")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="print JSON")] = False,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="write netCDF (.nc), with --from YAML")
    ] = None,
    report: Annotated[
        Path | None, typer.Option("--report", help="write the page (.html or .pdf) too")
    ] = None,
    log: Annotated[
        Path | None,
        typer.Option("--from", help="log of loads over time or distance; -o receives it"),
    ] = None,
) -> None:
    """Print the damage of a load spectrum by block, and the life of roller and guide in hours and
    km.

    With --from, write the load spectrum of a measured log instead.
    """


@command("trackroller.cli.carriage", "run_carriage")
def carriage(
    file: Annotated[
        Path | None, typer.Argument(help="masses, rollers and load cases (YAML); see --example")
    ] = None,
    example: Annotated[
        bool, typer.Option("--example", help="print a file to start from, or write it to -o")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="print JSON")] = False,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", help="write netCDF (.nc), or the file below")
    ] = None,
    report: Annotated[
        Path | None, typer.Option("--report", help="write the page (.html or .pdf) too")
    ] = None,
    spectrum: Annotated[
        str | None, typer.Option("--spectrum", help="roller whose spectrum -o receives")
    ] = None,
    study: Annotated[
        bool, typer.Option("--study", help="-o receives a study of all loads, and a CSV beside it")
    ] = False,
) -> None:
    """Print loads and lives of the rollers of a carriage by load case, and the margins to lift-off
    and tipping.
    """


@command("trackroller.cli.shelf", "print_shelf")
def shelf(
    file: Annotated[
        Path | None,
        typer.Argument(
            help="table of rollers, bearings or guides (CSV, .xlsx)", show_default=False
        ),
    ] = None,
    of: Annotated[
        str, typer.Option("--of", help="what a row is: roller, bearing or guide")
    ] = "roller",
    case: Annotated[
        Path | None, typer.Option("--case", help="case whose rail and values the rows are put to")
    ] = None,
    settings: Annotated[list[str] | None, typer.Option("--set", help=SET_HELP)] = None,
    example: Annotated[
        bool, typer.Option("--example", help="print a table to start from, or write it to FILE")
    ] = False,
) -> None:
    """Show the rows of a shelf and check them: names, units, values, and whether they fit the
    rail.
    """


@command("trackroller.cli.shelf", "print_size")
def size(  # noqa: PLR0913 - one argument for each option of the command
    case: Annotated[
        Path,
        typer.Argument(
            help="case, carriage, spectrum or study file (YAML) with loads, rail, duty",
            show_default=False,
        ),
    ],
    shelf: Annotated[
        Path | None, typer.Option("--shelf", help="table of rollers", show_default=False)
    ] = None,
    life: Annotated[
        str | None,
        typer.Option("--life", help="required life: '3 years' beside a duty, or hours of travel"),
    ] = None,
    failures: Annotated[
        str | None, typer.Option("--failures", help="share that may fail within --life, such as 5%")
    ] = None,
    safety: Annotated[
        str | None,
        typer.Option("--safety", help="factor >= 1 on all forces within all limits, such as 1.5"),
    ] = None,
    temperature: Annotated[
        str | None,
        typer.Option("--temperature", help="permissible temperature in degC: 60, or '60 degC'"),
    ] = None,
    wear_depth: Annotated[
        str | None,
        typer.Option(
            "--wear-depth", help="permissible wear depth within --life, in mm: 0.05, or '50 um'"
        ),
    ] = None,
    least: Annotated[
        str | None, typer.Option("--least", help="column of the shelf, such as price")
    ] = None,
    each: Annotated[
        bool, typer.Option("--each", help="each place of a carriage takes its own roller")
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option("-o", "--out", help="write the carriage of --each, or the spectrum (.yaml)"),
    ] = None,
    results: Results = Path("results"),
    as_json: Annotated[bool, typer.Option("--json", help="print JSON")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="no progress bar")] = False,
    example: Annotated[
        bool, typer.Option("--example", help="write a case file to start from")
    ] = False,
) -> None:
    """Find the least roller of a shelf that is enough for a life, failures, overload, temperature
    or wear depth; 1 if none is.
    """


@command("trackroller.cli.patch", "run_patch")
def patch(
    file: Annotated[
        Path,
        typer.Argument(
            help="one contact: load, shape, materials, friction (YAML)", show_default=False
        ),
    ],
    creepage: Annotated[
        str | None,
        typer.Option("--creepage", help="longitudinal creepages from:to in per cent, such as 0:2%"),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="print JSON")] = False,
    out: Annotated[Path | None, typer.Option("-o", "--out", help="write netCDF (.nc)")] = None,
    report: Annotated[
        Path | None, typer.Option("--report", help="write the page (.html or .pdf) too")
    ] = None,
) -> None:
    """Print forces, friction power and adhesion of one ellipse, or of two discs, at given
    creepages.
    """


@command("trackroller.cli.case", "run_wear")
def wear(
    case: Annotated[Path | None, typer.Argument(help=CASE_HELP)] = None,
    to: Annotated[str, typer.Option("--to", help="travel at which to end, such as 500km")] = "50km",
    settings: Annotated[list[str] | None, typer.Option("--set", help=SET_HELP)] = None,
    as_json: Annotated[bool, typer.Option("--json", help="print JSON")] = False,
    out: Annotated[
        Path | None,
        typer.Option("-o", "--out", help="netCDF (.nc); a run goes on from what it holds"),
    ] = None,
    report: Annotated[
        Path | None, typer.Option("--report", help="write the page (.html or .pdf) too")
    ] = None,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="no line for each state")] = False,
) -> None:
    """Follow roller and guide while their profiles wear, and print how far and how deep."""


@command("trackroller.cli.case", "plot_target")
def plot(
    target: Annotated[
        str, typer.Argument(help="case file (YAML), or name of a study", show_default=False)
    ],
    settings: Annotated[list[str] | None, typer.Option("--set", help="key=value of a case")] = None,
    out: Annotated[Path | None, typer.Option("-o", "--out", help="folder for the figures")] = None,
    results: Results = Path("results"),
) -> None:
    """Draw a case (tractions, friction energy, stress sections) or the figures of a study."""


@app.command("app")
def live_page(
    folder: Annotated[Path, typer.Argument(help="folder for studies and results")] = Path(),
    no_browser: Annotated[
        bool, typer.Option("--no-browser", help="print the address only")
    ] = False,
    port: Annotated[
        int | None,
        typer.Option(min=1, max=65_535, help="port on 127.0.0.1; a free one if not given"),
    ] = None,
    allow_host: Annotated[
        list[str] | None,
        typer.Option(help="HOST[:PORT] of a forwarded port that may ask too; may be repeated"),
    ] = None,
) -> None:
    """Open the live page of a roller or a carriage: sliders, pictures, variants, studies; Ctrl-C
    ends it.
    """
    from trackroller.app.start import serve

    serve(folder, port, not no_browser, allow_host or ())
    # Python aborts if it is torn down while a thread of the solver is inside compiled code
    os._exit(0)


def main() -> None:
    """Run the command line and end the process with its exit code.

    The codes are 0 done, 1 the work failed, 2 the input is wrong, 3 an error of the program, 130
    stopped by Ctrl-C. Every error is one line on stderr; an error of the program leaves its
    traceback in a log file that the line names. A warning is one line too, which is printed once.
    """
    codecs.register_error("plain", _plain)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="plain")
    print_once = functools.cache(print_line)
    warnings.showwarning = lambda message, *_: print_once(str(message))
    code = run_app(app)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # nothing is left to stop
    # Python looks for circles once more when it ends, for a fifth of the time of `trackroller
    # solve`
    gc.freeze()
    raise SystemExit(code)


def run_app(command: Callable[[], object]) -> int:
    """Call a command, print every error in one line on stderr, and return the exit code."""
    try:
        for word in sys.argv[1:]:
            check_utf_8(word, "argument")
        check_threads()
        with interrupts_wait_for_files():
            command()
    except SystemExit as exc:
        return _code_of(exc)
    except InputError as exc:
        return max(_tell(text, 2) for text in exc.shown)
    except WorkError as exc:
        return _tell(str(exc), 1)
    except KeyboardInterrupt:
        return _tell(STOPPED, INTERRUPTED)
    except BrokenPipeError:
        sys.stderr.close()
        return 1
    except OSError as exc:
        return _tell_of_file(exc)
    except Exception as exc:
        return _tell(
            f"internal error, {type(exc).__name__}. Please report it with the log {_log(exc)}", 3
        )
    return 0


def _code_of(exc: SystemExit) -> int:
    """Return the exit code of a command that ended itself; an interruption is told."""
    if exc.code == INTERRUPTED:
        return _tell(STOPPED, INTERRUPTED)
    if isinstance(exc.code, int):
        return exc.code
    return int(exc.code is not None)


def _tell_of_file(exc: OSError) -> int:
    """Print why the system refused a file, and return the exit code."""
    too_long = long_name(exc)
    if too_long is not None:
        return _tell(str(too_long), 2)
    if exc.errno in FAILED_WRITES:
        return _tell(str(disk_error(exc, Path(exc.filename or "the output"))), 1)
    # other failed writes have their own messages: this file could not be read
    return _tell(
        f"{exc.filename or 'a file'} cannot be read ({exc.strerror or exc}). Repair or replace it.",
        1,
    )


def _plain(error: UnicodeError) -> tuple[str, int]:
    """Replace signs that a terminal without UTF-8 lacks; a minus or an exponent must not become a
    question mark.
    """
    if not isinstance(error, UnicodeEncodeError):
        raise error
    run = error.object[error.start : error.end]
    power = ""
    if unicodedata.decomposition(run[0]).startswith("<super>"):
        power = "^"
    return power + "".join(map(_plain_sign, run)), error.end


def _plain_sign(sign: str) -> str:
    # a superscript 2 becomes 2, a letter loses its accent
    parts = unicodedata.normalize("NFKD", sign)
    if sign in SIGNS:
        return SIGNS[sign]
    return "".join(_ascii_sign(part) for part in parts) or "?"


def _ascii_sign(sign: str) -> str:
    if sign in SIGNS:
        return SIGNS[sign]
    if sign.isascii():
        return sign
    return ""


def _tell(line: str, code: int) -> int:
    print_line(line)
    return code


def _log(exc: Exception) -> str:
    """Write the traceback into a log file and return its path."""
    trace = traceback.format_exception(exc)
    try:
        handle, name = tempfile.mkstemp(prefix="trackroller-", suffix=".log")
        # names may not be UTF-8
        with open(handle, "w", encoding="utf-8", errors="backslashreplace") as file:
            file.writelines([f"trackroller {__version__}: {' '.join(sys.argv)}\n\n", *trace])
    except OSError as why:
        return f"that could not be written ({why.strerror}): {''.join(trace[-2:])}"
    return name
