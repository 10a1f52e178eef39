"""The page of a load spectrum, and its record on a terminal."""

from __future__ import annotations

import json
import shlex
from functools import partial
from pathlib import Path

import xarray as xr

from trackroller.report import html
from trackroller.report.numbers import lives_in_years
from trackroller.report.pages.record import (
    body_materials,
    inputs_apart,
    pictures,
    print_record,
    record_text,
)
from trackroller.report.tables.inputs import input_rows
from trackroller.results.spectrum_answer import answer_of_spectrum
from trackroller.roller.stored_inputs import NOT_GIVEN

KIND = "load spectrum of a track roller"


@lives_in_years
def write_spectrum(ds: xr.Dataset, path: Path | str, file: str = "spectrum.yaml") -> Path:
    """Write the page of a load spectrum as one HTML file that stands alone, or as PDF by the name
    of the file.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `solve_spectrum`.
    path : Path or str
        The file to write.
    file : str
        Name of the spectrum file, for the command that repeats the page.

    Returns
    -------
    Path
        The file.
    """
    from trackroller.report.figures import spectrum  # heavy: matplotlib

    drawn = pictures(partial(spectrum.damage_by_block, ds))
    inputs = json.loads(ds.attrs["roller"])
    given = json.loads(ds.attrs[NOT_GIVEN])
    text = record_text(
        answer_of_spectrum(ds),
        KIND,
        f"trackroller spectrum {shlex.quote(file)} --report {shlex.quote(Path(path).name)}",
        first_figures=list(drawn.values()),
        materials=body_materials(json.loads(ds.attrs["materials"])),
        **inputs_apart(input_rows(inputs, given)),
    )
    return html.write_page(Path(path), text)


@lives_in_years
def print_spectrum(ds: xr.Dataset) -> None:
    """Print the record of a load spectrum: blocks and lives, and at the end its limits and
    warnings.
    """
    print_record(answer_of_spectrum(ds))
