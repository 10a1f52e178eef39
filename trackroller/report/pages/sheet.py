"""The sheet of one roller and the page of a load spectrum as HTML, to print or to send."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from trackroller.report import html
from trackroller.report.figures.roller_section import drawing
from trackroller.report.numbers import lives_in_years
from trackroller.report.pages.sheet_facts import collect
from trackroller.report.words.wear import run_in

SHOWN = ("contact_shear", "contact_1_stress", "contact_2_stress")  # figures of the sheet, as far as drawn
FULL = 150.0  # percent of a limit at the right end of a bar


def write_sheet(ds: xr.Dataset, path: Path | str, name: str = "") -> Path:
    """Write the sheet of a solved roller as one HTML file that stands alone, or as PDF by the name of the file.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `trackroller.solve` for one case. Figures need the outputs `tractions` and `subsurface`.
    path : Path or str
        The file to write.
    name : str
        Head of the sheet.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        If `ds` is not the result of one case, or for another name than .html or .pdf.
    WorkError
        If no browser is there that prints a PDF.
    """
    return html.write_page(Path(path), render(ds, name))


@lives_in_years
def render(ds: xr.Dataset, name: str = "") -> str:
    """Return the sheet as HTML text; see `write_sheet`."""
    drawn = {}
    if any(v.ndim > 2 for v in ds.values()):
        from trackroller.report.figures import contact, wear  # heavy: matplotlib

        drawn = pictures(*contact.figures_of(ds), partial(wear.over_patch, ds))
    facts = collect(ds)
    content = {
        "facts": facts,
        "aside": _less_stressed(ds),
        "name": name or "Track roller",
        "drawing": drawing(ds) if "normal_force" in ds else "",
        "figures": [drawn[name] for name in SHOWN if name in drawn],
        "worn": run_in(ds),
        "depth": drawn.get("wear_depth"),
        "full": FULL,
        "probability": f"{100 * float(ds.attrs['failure_probability']):g} %",
    }
    return html.render("sheet.html.j2", content)


def _less_stressed(ds: xr.Dataset) -> str:
    """Name the stress figure that the print leaves out: that of the contact with the lower peak stress."""
    peaks = np.nan_to_num(ds["peak_stress"].max("body").values) if "peak_stress" in ds else np.zeros(2)
    return f"contact_{np.argmin(peaks) + 1}_stress"


def pictures(*jobs: Callable[[], Any]) -> dict[str, dict[str, str]]:
    """Draw figures, and return the data URI, caption and sentence of each by its name."""
    from trackroller.report.figures import style  # heavy: matplotlib

    with tempfile.TemporaryDirectory() as place:
        infos = style.draw_all(jobs, Path(place))
        return {i.name: vars(i) | {"source": html.data_uri(Path(place, f"{i.name}.svg"))} for i in infos}
