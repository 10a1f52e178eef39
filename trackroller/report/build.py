"""Make analysis, figures and report of a gathered study, for the command line and the workflow."""

from __future__ import annotations

import logging
from collections.abc import Callable
from pathlib import Path
from typing import Any

import xarray as xr

from trackroller.errors import InputError
from trackroller.files import interrupts_wait_for_files

# public: reports without a folder
from trackroller.report.pages.study import report_text as report_text
from trackroller.report.pages.study import write_report
from trackroller.results.results import Results
from trackroller.results.stored_study import open_as_reported, open_study
from trackroller.study.store.crate import write_crate
from trackroller.study.store.folder import StudyFolder, reporting
from trackroller.study.store.manifest import REPORT, Manifest
from trackroller.study.store.put import put, replacing

log = logging.getLogger("trackroller")
UNFINISHED = "unfinished"  # folder for the pages of solved cases


@interrupts_wait_for_files()
def build_report(folder: StudyFolder, tell: Callable[[str], None] = log.info) -> Path:
    """Write `sensitivity.nc`, `figures/`, `report.html` and the crate beside the gathered results
    of a study.

    Two processes that report on the same study do so one after the other. A study that is not
    gathered yet gets analysis, figures and report of its solved cases in the folder `unfinished/`,
    without a crate.

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
        If no case is solved yet, the folder is somebody else's, or a file of somebody else stands
        in the place of one.
    WorkError
        If a result was altered after it was written, or the folder cannot be written.
    """
    with reporting(folder, tell):
        results = open_study(folder.root)
        place = place_of_pages(results, folder)
        manifest = Manifest(folder.root)
        pages = [place / name for name in REPORT]
        written = [folder.root / name for page in pages for name in manifest.current(page)]
        # what is not ours is refused before the work; a folder may hold further files
        manifest.check(*(page for page in pages if not page.is_dir()), *written)
        tell("analyse the results")
        write_analysis(results, place / "sensitivity.nc")
        tell("draw the figures")
        draw_figures(results, place / "figures")
        tell("write the report")
        report = write_report(results, place / "report.html")
        # results solved in Python have no plan, and no crate
        if folder.plan_file.exists() and not results.unfinished:
            write_crate(folder.root)
            manifest.discard(folder.root / UNFINISHED)
    return report


def place_of_pages(results: Results, folder: StudyFolder) -> Path:
    """Return the folder for figures and pages of a study: its own, or `unfinished/` in it."""
    if results.unfinished:
        return folder.root / UNFINISHED
    return folder.root


def draw_solved(folder: StudyFolder, out_dir: Path | None = None) -> tuple[Path, list[Any]]:
    """Draw the figures of a study, of its solved cases if it is unfinished; return their folder and
    the figures.
    """
    with reporting(folder):
        results = open_as_reported(folder.root)
        out = out_dir or place_of_pages(results, folder) / "figures"
        return out, draw_figures(results, out)


def write_analysis(results: Results, out: Path) -> None:
    """Write the sensitivity analysis of a study, or a file that says why there is none."""
    try:
        analysis = results.indices()
    except InputError as exc:
        analysis = xr.Dataset(attrs={"comment": f"no sensitivity analysis: {exc}"})
    put(out, lambda beside: analysis.to_netcdf(beside))


def draw_figures(results: Results, out: Path) -> list[Any]:
    """Draw all figures of a study and return them; they are put in place when all of them are
    drawn.
    """
    from trackroller.report.figures.study import draw_all  # heavy: matplotlib and seaborn

    with replacing(out) as beside:
        beside.mkdir()
        return draw_all(results, beside)
