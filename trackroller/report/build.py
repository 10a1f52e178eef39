"""Make analysis, figures and report of a gathered study, for the command line and the workflow."""

from __future__ import annotations

import logging
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import xarray as xr

from trackroller.analysis.sensitivity import analyse
from trackroller.analysis.stored_study import read_results, stored_analysis
from trackroller.analysis.table import StudyResults, StudyView
from trackroller.errors import InputError
from trackroller.files import interrupts_wait_for_files
from trackroller.report.pages.study import contents, page_text, write_report
from trackroller.study.store.crate import write_crate
from trackroller.study.store.folder import StudyFolder, reporting
from trackroller.study.store.ownership import PAGES, UNFINISHED, files_below, remove, remove_empty, standing
from trackroller.study.store.seal import put, sealing

log = logging.getLogger("trackroller")


@interrupts_wait_for_files()
def build_report(folder: StudyFolder, tell: Callable[[str], None] = log.info) -> Path:
    """Write `sensitivity.nc`, `figures/`, `report.html` and the crate beside the gathered results of a study.

    Two processes that report on the same study do so one after the other. A study that is not gathered yet gets
    analysis, figures and report of its solved cases in the folder `unfinished/`, without a crate.

    Parameters
    ----------
    folder : StudyFolder
        The study's folder.
    tell : callable
        Called with one line before each step.

    Returns
    -------
    Path
        The report.

    Raises
    ------
    InputError
        If no case is solved yet, the folder is somebody else's, or a file of somebody else stands in the place of one.
    WorkError
        If a result was altered after it was written, or the folder cannot be written.
    """
    with reporting(folder, tell):
        results = read_results(folder.root)
        place = place_of_pages(results, folder)
        for page in (place / name for name in PAGES):
            if not page.is_dir():
                standing(page, folder.root)  # a file of somebody else is refused before the work
        tell("analyse the results")
        view = results.view.analysed(write_analysis(results, place / "sensitivity.nc"))
        tell("draw the figures")
        draw_figures(view, place / "figures")
        tell("write the report")
        report = write_pages(view, place / "figures", place / "report.html")
        if folder.plan_file.exists() and not results.unfinished:  # results solved in Python have no plan, and no crate
            write_crate(folder.root)
            for path in files_below(folder.root / UNFINISHED):
                remove(path, folder.root)
            remove_empty(folder.root / UNFINISHED)
    return report


def place_of_pages(results: StudyResults, folder: StudyFolder) -> Path:
    """Return the folder for figures and pages of a study: its own, or `unfinished/` in it."""
    return folder.root / UNFINISHED if results.unfinished else folder.root


def draw_solved(folder: StudyFolder, out_dir: Path | None = None) -> tuple[Path, list[Any]]:
    """Draw the figures of a study, of its solved cases if it is unfinished; return their folder and the figures."""
    with reporting(folder):
        results = read_results(folder.root)
        out = out_dir or place_of_pages(results, folder) / "figures"
        return out, draw_figures(results.view.analysed(stored_analysis(results, folder.root)), out)


def report_text(results: StudyResults, indices: Callable[[], xr.Dataset] | None = None) -> str:
    """Return the report of a solved study as HTML, with its analysis and figures; no file is left behind.

    `indices` returns the analysis, if the caller has it.
    """
    from trackroller.report.figures.study import draw_all  # heavy: matplotlib and seaborn

    view = results.view.analysed(_analysis(indices or partial(analyse, results)))
    with tempfile.TemporaryDirectory() as place:
        draw_all(view, Path(place))
        return page_text(view, contents(view), Path(place))


def _analysis(indices: Callable[[], xr.Dataset]) -> xr.Dataset:
    """Return the sensitivity analysis of a study, or a data set without variables that says why there is none."""
    try:
        return indices()
    except InputError as exc:
        log.info("no sensitivity analysis: %s", exc)
        return xr.Dataset(attrs={"comment": f"no sensitivity analysis: {exc}"})


def write_analysis(results: StudyResults, out: Path) -> xr.Dataset:
    """Write the sensitivity analysis of a study, or a file that says why there is none, and return it."""
    analysis = _analysis(partial(analyse, results))
    put(out, lambda beside: analysis.to_netcdf(beside))
    return analysis


def draw_figures(view: StudyView, out: Path) -> list[Any]:
    """Draw all figures of a study and return them; they are put in place when all of them are drawn."""
    from trackroller.report.figures.study import draw_all  # heavy: matplotlib and seaborn

    with sealing(out) as beside:
        beside.mkdir()
        return draw_all(view, beside)


def write_pages(view: StudyView, figures: Path, out: Path) -> Path:
    """Write the report and its tables, with the figures in a folder, and return the report's path."""
    return write_report(view, figures, out)
