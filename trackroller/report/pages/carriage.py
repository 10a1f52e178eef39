"""The page of a carriage: its record, and its picture with the forces of the rollers; the record on
a terminal.
"""

from __future__ import annotations

import shlex
from functools import partial
from pathlib import Path

import xarray as xr

from trackroller.report import html
from trackroller.report.headlines import end_of_carriage
from trackroller.report.numbers import capital, lives_in_years
from trackroller.report.pages.record import pictures, print_record, record_text
from trackroller.results.carriage_answer import answer_of_carriage

KIND = "carriage on track rollers"


@lives_in_years
def write_carriage(ds: xr.Dataset, path: Path | str, file: str = "carriage.yaml") -> Path:
    """Write the page of a carriage as one HTML file that stands alone, or as PDF by the name of the
    file.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `trackroller.carriage`.
    path : Path or str
        The file to write.
    file : str
        Name of the carriage file, for the command that repeats the page.

    Returns
    -------
    Path
        The file.
    """
    from trackroller.report.figures import carriage  # heavy: matplotlib

    drawn = pictures(partial(carriage.views, ds))
    text = record_text(
        answer_of_carriage(ds),
        KIND,
        f"trackroller carriage {shlex.quote(file)} --report {shlex.quote(Path(path).name)}",
        first_figures=list(drawn.values()),
        notes={
            "Conventions": [
                f"{capital(text)}." for text in str(ds.attrs["conventions"]).split("; ")
            ]
        },
    )
    return html.write_page(Path(path), text)


@lives_in_years
def print_carriage(ds: xr.Dataset) -> None:
    """Print the record of a carriage: loads and margins, and at the end its rollers, warnings, and
    what ends it.
    """
    answer = answer_of_carriage(ds)
    print_record(answer)
    if end_of_carriage(answer):
        print(end_of_carriage(answer))
