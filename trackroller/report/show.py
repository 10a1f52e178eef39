"""What shows the results of a study: report, explorer, workbook, and the view in a notebook."""

from __future__ import annotations

from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

import xarray as xr

from trackroller.errors import InputError
from trackroller.report.explorer.page import explorer_text, write_explorer
from trackroller.report.html import write_page
from trackroller.report.pages.study import page_text, proof_of, report_text
from trackroller.report.workbook import write_results
from trackroller.results.results import Results, shown_answer
from trackroller.results.stored_study import open_study


@dataclass(frozen=True)
class NotebookView:
    """A page that a notebook shows in a frame.

    Attributes
    ----------
    text : str
        The page as HTML.
    height : int
        Height of the frame [px].
    """

    text: str
    height: int = 820

    def _repr_html_(self) -> str:
        style = f'width="100%" height="{self.height}" style="border: 0"'
        return f'<iframe srcdoc="{escape(self.text)}" title="trackroller" {style}></iframe>'


def results_of(result: Any, name: str) -> Results:
    """Return the results of a study from what a user gives.

    Parameters
    ----------
    result : Results or xarray.Dataset
        Results of a study, or its data set.
    name : str
        Public function that shows them, for the message.

    Raises
    ------
    InputError
        If it is something else.
    """
    if isinstance(result, Results):
        return result
    if isinstance(result, xr.Dataset):
        return open_study(result)
    remedy = "Give what trackroller.run or trackroller.open_study returns."
    raise InputError(name, type(result).__name__, "results of a study, or their data set", remedy)


def write_report(results: Results, path: Path | str) -> Path:
    """Write the report of a study as HTML, or as PDF by the name of the file, and return its
    path.
    """
    return write_page(Path(path), report_text(results))


def explore(results: Results | xr.Dataset, path: Path | str | None = None) -> Path | NotebookView:
    """Show the explorer of a study, which works without a network.

    Parameters
    ----------
    results : Results or xarray.Dataset
        Results of a study, or its data set.
    path : Path or str, optional
        HTML file to write. By default nothing is written, and a notebook shows the explorer.

    Returns
    -------
    Path or NotebookView
        The file, or the view.

    Raises
    ------
    InputError
        If `results` are not those of a study.

    Examples
    --------
    >>> import trackroller as tr
    >>> case = {"friction_coefficient": 0.2, "contact_angle": 45}
    >>> study = {"name": "shown", "base": case, "factors": {"axial_force": {"values": [0, 20]}}}
    >>> study |= {"contact_model": "sliding", "accuracy": "preview"}
    >>> results = tr.run(study, progress=False)
    >>> tr.explore(results, "explorer.html").name
    'explorer.html'
    """
    known = results_of(results, "explore")
    if path is None:
        return NotebookView(explorer_text(known))
    return write_explorer(known, Path(path))


def workbook(results: Results | xr.Dataset, path: Path | str) -> Path:
    """Write the cases of a study with every limit, as a workbook or as CSV.

    Parameters
    ----------
    results : Results or xarray.Dataset
        Results of a study, or its data set.
    path : Path or str
        File to write; its name ends in .xlsx or .csv.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        If `results` are not those of a study, or for another name than .xlsx or .csv.

    Examples
    --------
    >>> import trackroller as tr
    >>> factors = {"axial_force": {"values": [0, 20]}}
    >>> study = {"name": "listed", "factors": factors, "contact_model": "sliding"}
    >>> tr.workbook(tr.run(study, progress=False), "cases.csv").name
    'cases.csv'
    """
    return write_results(results_of(results, "workbook"), Path(path))


def view(results: Results) -> NotebookView:
    """Return the answer to a study with the table of its designs, as a notebook shows it; the
    explorer stays away.
    """
    return NotebookView(page_text(shown_answer(results), proof_of(results), None))
