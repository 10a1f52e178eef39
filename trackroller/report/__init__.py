"""The sheet of one roller and the report of a study: `trackroller.report(ds, path)` writes either.

The module itself can be called: `trackroller.report` is both the room of the reports and the function that writes one.
"""

from __future__ import annotations

import sys
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import xarray as xr


def write(ds: xr.Dataset, path: Path | str) -> Path:
    """Write the sheet of one case, the page of a load spectrum or the report of a study, as HTML or PDF.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `trackroller.solve` for one case or for the design of a study, result of `solve_spectrum`, of
        `trackroller.carriage` or of `trackroller.wear`, or the data set in `study.nc`.
    path : Path or str
        The file to write, .html or .pdf. It stands alone and can be sent by mail. A browser prints the PDF: Chromium,
        Chrome or Edge.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        If `ds` is neither the result of one case nor of a study.

    Examples
    --------
    >>> import trackroller as tr
    >>> ds = tr.solve(tr.Case(), contact_model="sliding", accuracy="preview")
    >>> tr.report(ds, "sheet.html").name
    'sheet.html'
    """
    from trackroller.report.pages.carriage import write_carriage  # heavy: jinja2
    from trackroller.report.pages.sheet import write_sheet  # heavy: jinja2
    from trackroller.report.pages.spectrum import write_spectrum  # heavy: jinja2
    from trackroller.report.pages.wear import write_wear  # heavy: jinja2

    if "groove_depth" in ds:
        return write_wear(ds, path)
    if "payload_to_lift_off" in ds:
        return write_carriage(ds, path)
    if "damage_sum" in ds:
        return write_spectrum(ds, path)
    if "study" not in ds.attrs:
        return write_sheet(ds, path)
    from trackroller.report import html
    from trackroller.report.build import report_text
    from trackroller.results.stored_study import open_study  # heavy: pandas, SciPy and SALib, for studies only

    return html.write_page(Path(path), report_text(open_study(ds)))


class _CallableModule(ModuleType):
    def __call__(self, ds: xr.Dataset, path: Path | str) -> Path:
        return write(ds, path)


sys.modules[__name__].__class__ = _CallableModule
