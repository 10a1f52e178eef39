"""Make analysis, figures and report of a gathered study: one function for command line and workflow."""

from __future__ import annotations

import logging
import shutil
from collections.abc import Callable
from pathlib import Path

import xarray as xr

from trackroller.analysis.sensitivity import analyse
from trackroller.errors import InputError
from trackroller.files import write_whole
from trackroller.report.pages.study import write_report
from trackroller.study.store.folder import StudyFolder

log = logging.getLogger("trackroller")


def build_report(folder: StudyFolder, tell: Callable[[str], None] = log.info) -> Path:
    """Write `sensitivity.nc`, `figures/` and `report.html` beside the gathered results of a study.

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
        If the folder cannot be written.
    """
    if not folder.gathered.is_file():
        raise InputError("study", str(folder.root), "a study with study.nc", "Run the study to its end first.")
    study, analysis = str(folder.gathered), str(folder.root / "sensitivity.nc")
    figures, report = str(folder.root / "figures"), folder.root / "report.html"
    tell("analyse the results")
    analyse_study(study, analysis)
    tell("draw the figures")
    draw_study(study, analysis, figures)
    tell("write the report")
    report_study(study, figures, analysis, str(report))
    return report


def analyse_study(study_nc: str, out: str) -> None:
    """Write the sensitivity analysis of a study, or a file that says why there is none."""
    try:
        analyse(study_nc, out)
    except InputError as exc:
        log.info("no sensitivity analysis: %s", exc)
        empty = xr.Dataset(attrs={"comment": f"no sensitivity analysis: {exc}"})
        write_whole(Path(out), lambda beside: empty.to_netcdf(beside))


def draw_study(study_nc: str, sensitivity_nc: str, out_dir: str) -> None:
    """Draw all figures of a study; the folder appears whole or not at all."""
    from trackroller.report.figures.study import draw_all  # heavy: matplotlib and seaborn

    out = Path(out_dir)
    beside = out.with_name(f".{out.name}.tmp")
    shutil.rmtree(beside, ignore_errors=True)
    beside.mkdir(parents=True)
    draw_all(Path(study_nc), beside, Path(sensitivity_nc))
    shutil.rmtree(out, ignore_errors=True)
    beside.rename(out)


def report_study(study_nc: str, figures: str, sensitivity_nc: str, out: str) -> None:
    """Write the report, with the sensitivity analysis where there is one."""
    write_report(Path(study_nc), Path(figures), Path(out), Path(sensitivity_nc))
