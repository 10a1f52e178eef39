"""Make analysis, figures and report of a gathered study: one function for command line and workflow."""

from __future__ import annotations

import contextlib
import logging
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import xarray as xr

from trackroller.analysis.sensitivity import analyse
from trackroller.analysis.stored_study import read_results
from trackroller.analysis.table import StudyResults, StudyView
from trackroller.errors import InputError
from trackroller.files import interrupts_wait_for_files, whole_folder, write_whole
from trackroller.report.pages.study import contents, page_text, write_report
from trackroller.study.store.crate import write_crate
from trackroller.study.store.folder import StudyFolder, locked
from trackroller.study.store.seal import check_sealed, read_result, sealing

log = logging.getLogger("trackroller")


@interrupts_wait_for_files()
def build_report(folder: StudyFolder, tell: Callable[[str], None] = log.info) -> Path:
    """Write `sensitivity.nc`, `figures/`, `report.html` and the crate beside the gathered results of a study.

    Two processes that report on the same study do so one after the other.

    Parameters
    ----------
    folder : StudyFolder
        The study's folder; it must hold `study.nc`.
    tell : callable
        Called with one line before each step.

    Returns
    -------
    Path
        The report.

    Raises
    ------
    InputError
        If the study is not gathered yet.
    WorkError
        If a result was altered after it was written, or the folder cannot be written.
    """
    if not folder.gathered.is_file():
        raise InputError("study", str(folder.root), "a study with study.nc", "Run the study to its end first.")
    with _alone(folder, tell):
        tell("analyse the results")
        results = read_results(folder.gathered)
        view = results.view.analysed(_analysed(results, folder.root / "sensitivity.nc"))
        tell("draw the figures")
        _draw(view, folder.root / "figures")
        tell("write the report")
        report = _report(view, folder.root / "figures", folder.root / "report.html")
        if folder.plan_file.exists():  # results that were solved in Python have no plan, and no crate
            write_crate(folder.root)
    return report


def report_text(results: StudyResults) -> str:
    """Return the report of a solved study as HTML, with its analysis and figures; no file is left behind."""
    from trackroller.report.figures.study import draw_all  # heavy: matplotlib and seaborn

    view = results.view.analysed(_analysis(results))
    with tempfile.TemporaryDirectory() as place:
        draw_all(view, Path(place))
        return page_text(view, contents(view), Path(place))


def _analysis(results: StudyResults) -> xr.Dataset:
    """Return the sensitivity analysis of a study, or a data set without variables that says why there is none."""
    try:
        return analyse(results)
    except InputError as exc:
        log.info("no sensitivity analysis: %s", exc)
        return xr.Dataset(attrs={"comment": f"no sensitivity analysis: {exc}"})


def _analysed(results: StudyResults, out: Path) -> xr.Dataset:
    analysis = _analysis(results)
    with sealing(out):
        write_whole(out, lambda beside: analysis.to_netcdf(beside))
    return analysis


def analyse_study(study_nc: str, out: str) -> None:
    """Write the sensitivity analysis of a study, or a file that says why there is none."""
    _analysed(read_results(study_nc), Path(out))


def _read(study_nc: str | Path, sensitivity_nc: str | Path) -> StudyView:
    analysis = read_result(sensitivity_nc) if Path(sensitivity_nc).is_file() else None
    return read_results(study_nc).view.analysed(analysis)


def draw_study(
    study_nc: str | Path, sensitivity_nc: str | Path, out_dir: str | Path, folder: StudyFolder | None = None
) -> list[Any]:
    """Draw all figures of a study and return them; the folder appears whole or not at all.

    Parameters
    ----------
    study_nc, sensitivity_nc : path
        Gathered results and their analysis.
    out_dir : path
        Folder of the figures.
    folder : StudyFolder, optional
        Its lock is held, so that no report is made meanwhile. The workflow's main process holds it already.
    """
    with contextlib.nullcontext() if folder is None else _alone(folder):
        return _draw(_read(study_nc, sensitivity_nc), Path(out_dir))


@contextlib.contextmanager
def _alone(folder: StudyFolder, tell: Callable[[str], None] | None = None) -> Iterator[None]:
    """Keep other reports from being made, and the plan from being changed."""
    file = folder.create().lock.with_name(".report")
    file.touch()
    with locked(folder.lock, shared=True), locked(file, tell=tell):
        yield


def _draw(view: StudyView, out: Path) -> list[Any]:
    from trackroller.report.figures.study import draw_all  # heavy: matplotlib and seaborn

    seal = sealing(out) if (out.parent / "plan").is_dir() else contextlib.nullcontext()
    with seal, whole_folder(out) as beside:
        return draw_all(view, beside)


def report_study(study_nc: str, figures: str, sensitivity_nc: str, out: str) -> None:
    """Write the report, with the sensitivity analysis where there is one."""
    _report(_read(study_nc, sensitivity_nc), check_sealed(Path(figures)), Path(out))


def _report(view: StudyView, figures: Path, out: Path) -> Path:
    with sealing(out), sealing(out.with_name("tables")):
        return write_report(view, figures, out)
