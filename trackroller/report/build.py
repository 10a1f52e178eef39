"""Make analysis, figures and report of a gathered study: one function for command line and workflow."""

from __future__ import annotations

import logging
import shutil
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import xarray as xr

from trackroller.analysis.sensitivity import analyse_dataset
from trackroller.analysis.table import StudyView
from trackroller.errors import InputError
from trackroller.files import write_whole
from trackroller.report.pages.study import contents, page_text, write_report
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
    tell("analyse the results")
    view = StudyView.of(xr.load_dataset(folder.gathered))
    view = replace(view, analysis=_analysed(view.data, folder.root / "sensitivity.nc"))
    tell("draw the figures")
    _draw(view, folder.root / "figures")
    tell("write the report")
    return write_report(view, folder.root / "figures", folder.root / "report.html")


def report_text(ds: xr.Dataset) -> str:
    """Return the report of a gathered study as HTML, with its analysis and figures; no file is left behind.

    Parameters
    ----------
    ds : gathered study
    """
    from trackroller.report.figures.study import draw_all  # heavy: matplotlib and seaborn

    view = StudyView.of(ds, _analysis(ds))
    with tempfile.TemporaryDirectory() as place:
        draw_all(view, Path(place))
        return page_text(view, contents(view), Path(place))


def _analysis(ds: xr.Dataset) -> xr.Dataset:
    """Return the sensitivity analysis of a study, or a data set without variables that says why there is none."""
    try:
        return analyse_dataset(ds)
    except InputError as exc:
        log.info("no sensitivity analysis: %s", exc)
        return xr.Dataset(attrs={"comment": f"no sensitivity analysis: {exc}"})


def _analysed(ds: xr.Dataset, out: Path) -> xr.Dataset | None:
    result = _analysis(ds)
    write_whole(out, lambda beside: result.to_netcdf(beside))
    return result if result.data_vars else None


def analyse_study(study_nc: str, out: str) -> None:
    """Write the sensitivity analysis of a study, or a file that says why there is none."""
    with xr.open_dataset(study_nc, cache=False) as opened:  # variables one by one: a study may be large
        _analysed(opened, Path(out))


def draw_study(study_nc: str, sensitivity_nc: str, out_dir: str) -> None:
    """Draw all figures of a study; the folder appears whole or not at all."""
    _draw(StudyView.read(study_nc, sensitivity_nc), Path(out_dir))


def _draw(view: StudyView, out: Path) -> None:
    from trackroller.report.figures.study import draw_all  # heavy: matplotlib and seaborn

    beside = out.with_name(f".{out.name}.tmp")
    shutil.rmtree(beside, ignore_errors=True)
    beside.mkdir(parents=True)
    draw_all(view, beside)
    shutil.rmtree(out, ignore_errors=True)
    beside.rename(out)


def report_study(study_nc: str, figures: str, sensitivity_nc: str, out: str) -> None:
    """Write the report, with the sensitivity analysis where there is one."""
    write_report(StudyView.read(study_nc, sensitivity_nc), Path(figures), Path(out))
