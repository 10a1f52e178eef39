"""The page of a roller that wears: its record, profiles and course over the travel."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import xarray as xr

from trackroller.report import html
from trackroller.report.pages.record import (
    body_materials,
    command_of,
    inputs_apart,
    options_text,
    pictures,
    record_text,
)
from trackroller.report.tables.inputs import input_rows
from trackroller.results.wear_answer import answer_of_wear
from trackroller.roller.stored_inputs import inputs_of, materials_of, not_given_of

KIND = "wear over the travel"


def write_wear(ds: xr.Dataset, path: Path | str) -> Path:
    """Write the page of a roller that wears as one HTML file that stands alone, or as PDF by the
    name of the file.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `trackroller.wear`.
    path : Path or str
        The file to write.

    Returns
    -------
    Path
        The file.
    """
    from trackroller.report.figures import wear  # heavy: matplotlib

    drawn = pictures(partial(wear.profiles, ds), partial(wear.course, ds))
    text = record_text(
        answer_of_wear(ds),
        KIND,
        command_of(
            ds, ("wear", "--to", f"{float(ds.attrs['to']):g}km", "--report", Path(path).name)
        ),
        first_figures=list(drawn.values()),
        materials=body_materials(materials_of(ds)),
        options=options_text(ds),
        **inputs_apart(input_rows(inputs_of(ds), not_given_of(ds))),
    )
    return html.write_page(Path(path), text)
