"""Commands that plan and run a study, report on it, repeat a case, and check or solve again its
RO-Crate.
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, TextIO

import numpy as np

from trackroller.cli.case import (
    case_of,
    free_for_page,
    names_study,
    tell_doubts,
    writable,
    writable_page,
)
from trackroller.cli.usage import print_doubts, print_line
from trackroller.errors import InputError
from trackroller.parameters.example import drive_question, not_given_text, used_of
from trackroller.report.terminal import print_table, print_text
from trackroller.roller.case import to_table
from trackroller.roller.differences import Difference
from trackroller.roller.explain import explain as stages_of
from trackroller.roller.options import Options, options_of_cases
from trackroller.study.cost import duration
from trackroller.study.design.factor_names import OPTION_FACTORS
from trackroller.study.file.load import load_study
from trackroller.study.file.study import Study
from trackroller.study.progress import progress_bar, shown_steps
from trackroller.study.repeat import repeat_case
from trackroller.study.run import run_study
from trackroller.study.status import Status, find_folder, find_study, plan_rows, status_of
from trackroller.study.store.crate import (
    compare_results,
    damaged_files,
    read_crate,
    study_of_crate,
    write_crate,
)
from trackroller.study.store.folder import StudyFolder, check_folder
from trackroller.study.store.ledger import study_folder
from trackroller.study.store.mark import is_study

EXPLORER = "explorer.html"
MOST = 20_000  # --explain examines at most this many cases of a study


def run_with_progress(
    study: Path, results: Path, rerun_failed: bool, scheduler: str | None, quiet: bool, report: bool
) -> None:
    """Run a study with a progress bar of cases/s and the time left; with `report`, make its
    report.
    """
    from trackroller.results.run import run_any  # heavy: analysis

    checked = load_study(study)
    _print_not_given({**checked.config.base, **checked.factors}, checked.not_given, sys.stderr)
    print_doubts(checked.doubts())
    solved_before: list[bool] = []  # of each round of the study

    def started(total: int, done: int) -> None:
        solved_before.append(done == total)
        bar.started(total, done)

    with progress_bar(checked.name, not quiet) as bar:
        ledger = run_any(
            checked,
            results,
            rerun_failed=rerun_failed,
            scheduler=scheduler,
            started=started,
            tell=bar.tell,
            progress=bar.advanced,
        )
    if solved_before and all(solved_before):
        unused = ""
        if scheduler:
            unused = f"; --scheduler {scheduler} is not used"
        print_line(f"nothing is left to solve of '{checked.name}'{unused}")
    if report:
        print(_report(ledger.folder))
    else:
        write_crate(ledger.folder.root)
        print(ledger.folder.gathered)


def make_report(study: str, results: Path, out: Path | None) -> None:
    """Make analysis, figures and report of a study that was run, and a copy at `out`; or write its
    cases to `out`.
    """
    folder = find_study(study, results)[1]
    table = out is not None and out.suffix.lower() in (".xlsx", ".csv")
    if out is None:
        target = out
    else:
        target = writable(out) if table else writable_page(out)
    if target is not None and table:
        from trackroller.report.workbook import write_results
        from trackroller.results.stored_study import open_study  # heavy: SALib

        print(write_results(open_study(folder.root), target))
        return
    report = _report(folder)
    print(report)
    if target is not None:
        from trackroller.report.html import write_page  # heavy: jinja2

        print(write_page(target, report.read_text(encoding="utf-8")))


def _report(folder: StudyFolder) -> Path:
    from trackroller.report.build import build_report  # heavy: SALib

    with shown_steps() as tell:
        return build_report(folder, tell)


def print_explorer(study: str, results: Path, out: Path | None) -> None:
    """Write the explorer of a study from its folder or its `study.nc`, and print where it is."""
    from trackroller.report.build import place_of_pages  # heavy: SALib
    from trackroller.report.explorer.page import write_explorer
    from trackroller.results.stored_study import open_study

    path = results / study
    folder_of_study = find_folder(study, results)
    if folder_of_study is not None:
        path = folder_of_study.root
    elif Path(study).exists():
        path = Path(study)
    target = _page(out)
    if target is not None and target.suffix.lower() == ".pdf":
        raise InputError(
            "--out", str(out), "a file whose name ends in .html; the explorer works in a browser"
        )
    solved = open_study(path)
    root = path
    if not path.is_dir():
        root = path.parent
    folder = StudyFolder(root)
    if out is None and is_study(folder.root):
        folder.create()
    elif out is None:
        free_for_page(folder.root / EXPLORER)
    print(write_explorer(solved, target or place_of_pages(solved, folder) / EXPLORER))


def _page(out: Path | None) -> Path | None:
    """Return the path of a page, checked before anything is made."""
    if out is None:
        return None
    return writable_page(out)


def print_best(study: str, results: Path, out: Path | None, as_json: bool = False) -> None:
    """Print the answer to a study: headline, table and warnings, or its record as JSON; write its
    page to `out`.
    """
    from trackroller.report.build import report_text  # heavy: SALib
    from trackroller.report.html import write_page
    from trackroller.report.printed import print_answer
    from trackroller.results.results import shown_answer
    from trackroller.results.stored_study import open_study

    target = _page(out)
    if find_folder(study, results) is None and Path(study).is_dir():
        folder = Path(study)
    else:
        folder = find_study(study, results)[1].root
    solved = open_study(folder)
    answer = shown_answer(solved)
    if as_json:
        print(json.dumps(answer.to_dict(), ensure_ascii=False, allow_nan=False))
    else:
        print_answer(answer)
    if target is not None:
        print(write_page(target, report_text(solved)))


def print_status(study: str, results: Path, figures: bool) -> int:
    """Print how many cases of a study are done, missing and failed, and the failures by cause.

    Returns
    -------
    int
        The exit code: 1 if a file of the study is damaged or was altered.
    """
    checked, folder = find_study(study, results)
    status = status_of(checked, folder)
    print(
        f"study     {checked.name}: {status.total} cases, {status.done} done, {status.missing} "
        "missing, "
        f"{status.failed} failed"
    )
    _print_left(status)
    if status.outdated:
        print_text(
            "another version of the solver made the results: the next run solves every case anew",
            "outdated",
        )
    regimes = [f"{count} {name}" for name, count in status.regimes.items() if count]
    if regimes:
        print(f"regimes   {', '.join(regimes)}")
    for reason, count in status.by_reason.items():
        print(f"failed    {count} x {reason}")
    for (factor, level), count in status.by_level.items():
        print(f"failed    {count} at {factor} = {level}")
    for line in status.corrupt:
        print(f"corrupt   {line} (the next run makes it again)")
    if status.failed:
        print("          `trackroller run STUDY --rerun-failed` solves just these again")
    if figures:
        from trackroller.report.build import draw_solved  # heavy: matplotlib

        target, names = draw_solved(folder)
        print(f"figures   {len(names)} in {target}")
    return int(bool(status.corrupt))


def _print_left(status: Status) -> None:
    """Print the time left, the next chunk, and what can be looked at."""
    if status.missing:
        print(f"time left {duration(status.seconds_left)} on one core")
        if status.upcoming:
            print(f"next      {status.upcoming}")
        if status.done:
            print("look      `trackroller report` and `explore` work on the solved cases")
    elif status.gathered:
        print("gathered  yes")
    else:
        print("gathered  not yet: run it once more")


def print_repeat(study: str, case: int, results: Path) -> int:
    """Solve a case again and compare; return the exit code, 0 if no result differs by more than
    rounding explains.
    """
    checked, folder = find_study(study, results)
    again = repeat_case(checked, case, folder)
    print(again.command())
    differs = _print_differences(again.differences)
    if not differs:
        print(f"case {case}: equal to the stored result {_how_equal(again.differences)}")
    return int(differs)


def _print_differences(compared: Mapping[str, Difference]) -> bool:
    """Print the variables that differ by more than rounding explains, and return whether there are
    any.
    """
    differing = {
        name: difference for name, difference in compared.items() if difference.exceeds_rounding
    }
    for name, (apart, allowed, scale) in differing.items():
        if apart < math.inf:
            print(f"{name}: differs by {apart:.1e} of {scale}; rounding explains {allowed:.0e}")
        else:
            print(f"{name}: is missing now, or has other gaps or words")
    return bool(differing)


def _how_equal(compared: Mapping[str, Difference]) -> str:
    """Return how closely values agree that differ by no more than rounding explains."""
    rounded = {name: difference for name, difference in compared.items() if difference.apart > 0}
    if not rounded:
        return "in every number"
    name, (apart, _, scale) = max(rounded.items(), key=lambda item: item[1].apart)
    return f"up to rounding; the largest difference is {apart:.1e} of {scale} ({name})"


ARCHIVES = (".zip", ".tar", ".tgz", ".gz", ".xz", ".bz2", ".7z")


def _crate_at(named: Path, results: Path) -> Path:
    """Return the folder of a crate by its path or by its name in the results folder; refuse an
    archive of it.
    """
    if named.is_file():
        packed = named.suffix.lower() in ARCHIVES
        wrong = "is an archive" if packed else "is a file"
        tool = "tar xf"
        if named.suffix.lower() == ".zip":
            tool = "unzip"
        remedy = "Name the folder."
        if packed:
            remedy = f"Unpack it ({tool} {named.name}), and name the folder."
        raise InputError(
            "folder", str(named), "the folder of a study, such as results/NAME", remedy, wrong
        )
    inside = results / named
    if named.exists():
        return named
    if inside.is_dir():
        return inside
    remedy = "Check the path; `trackroller run` makes the folder."
    raise InputError(
        "folder",
        str(named),
        "the folder of a study, such as results/NAME",
        remedy,
        f"exists neither here nor in {results}",
    )


def print_verified(folder: Path, results: Path) -> int:
    """Print the damaged files of a crate and return the exit code: 0 if there is none."""
    folder = _crate_at(folder, results)
    damaged = damaged_files(folder)
    for name, state in damaged.items():
        print(f"{state}: {name}")
    if not damaged:
        print(f"{len(read_crate(folder))} files are as they were written")
    return int(bool(damaged))


def print_rerun(crate: Path, results: Path) -> int:
    """Solve the study of a crate again, print the comparison and return the exit code: 0 if every
    value is the same.
    """
    crate = _crate_at(crate, Path("results"))
    stored = crate / "study.nc"
    if stored.name not in read_crate(crate) or not stored.is_file():
        raise InputError(
            "crate", str(crate), "a crate that holds study.nc", "Run the study to its end first."
        )
    study = study_of_crate(crate)
    _check_unoccupied(study, study_folder(study.name, results))
    ledger = run_study(study, results)
    compared = compare_results(stored, ledger.folder.gathered)
    differs = _print_differences(compared)
    new = [name for name, difference in compared.items() if math.isnan(difference.apart)]
    if new:
        print(f"not compared, because {stored} lacks them: {', '.join(new)}")
    if not differs:
        same = len(compared) - len(new)
        print(f"{same} variables have the same values as {stored}, equal {_how_equal(compared)}")
    return int(differs)


def _check_unoccupied(study: Study, folder: StudyFolder) -> None:
    """Refuse a folder that holds anything but the unfinished results of the same study, which is
    then solved on.
    """
    check_folder(folder.root)
    record = folder.record()
    begun = record.get("study") in (None, study.merged()) and not folder.gathered.exists()
    if folder.root.is_dir() and any(folder.root.iterdir()) and not (record and begun):
        wrong = "stands there already, and stays as it is"
        raise InputError(
            "--results", str(folder.root), "a new folder", "Choose one with --results.", wrong
        )


def print_plan(
    target: Path | None,
    results: Path,
    explain: bool,
    settings: list[str] | None,
    no_shortcuts: bool,
) -> None:
    """Print the plan of a study file, or the stages of a case file or of the paper's example with
    key=value words.
    """
    if target is None or not names_study(target):
        _print_case(target, settings, no_shortcuts)
        return
    study = load_study(target)
    for name, text in plan_rows(study, status_of(study, study_folder(study.name, results))):
        print_text(text, name)
    _print_not_given({**study.config.base, **study.factors}, study.not_given)
    print_doubts(study.doubts())
    if explain:
        print()
        _explain(study, no_shortcuts)


def _print_not_given(
    values: Mapping[str, Any], not_given: Iterable[str], to: TextIO | None = None
) -> None:
    """Print the values that are taken from the paper's example, and ask about a drive that is not
    given.
    """
    used = used_of(values, not_given)
    for line in filter(
        None, (not_given_text(used), drive_question(used, values.keys() - used.keys()))
    ):
        print_text(line, to=to)


def _print_case(path: Path | None, settings: list[str] | None, no_shortcuts: bool) -> None:
    case, options, _ = case_of(path, settings)
    tell_doubts(case)
    values = case.as_dict()
    _print_not_given(values, case.not_given)
    if no_shortcuts:
        options["shortcuts"] = False
    _print_stages(to_table(case), Options(**options))


def _explain(study: Study, no_shortcuts: bool) -> None:
    """Print the stages of the cases of a study, for each combination of options apart."""
    design = study.design()
    table = to_table(design.drop_vars(list(design.coords)), study.materials)
    options, group = options_of_cases(design, {})
    if len(table) > MOST:
        print(f"stages of the first {MOST} of {len(table)} cases")
        table = table.take(np.arange(MOST))
        group = group[:MOST]
    for number in np.unique(group):
        rows = np.flatnonzero(group == number)
        own = dict(options[number])
        if no_shortcuts:
            own["shortcuts"] = False
        if len(options) > 1:
            varied = [name for name in OPTION_FACTORS if name in study.factors]
            print(", ".join(f"{name.replace('_', ' ')} {own[name]}" for name in varied) + ":")
        _print_stages(table.take(rows), Options(**own))


def _print_stages(table, options) -> None:
    rows = []
    for stage in stages_of(table, options):
        count = "-"
        if stage.runs:
            count = f"{stage.count}"
        rows.append((stage.name, count, f"{stage.total} {stage.unit}", stage.why))
    print_table(("stage", "runs", "of", "why"), rows, right=(1, 2))
