"""The pages of results, such as the sheet of a roller and the report of a study:
`trackroller.report` writes them.

The module itself can be called: `trackroller.report` is both the room of the reports and the
function that writes one.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

from trackroller.errors import InputError

if TYPE_CHECKING:
    import xarray as xr

    from trackroller.fit.catalogue import CatalogueFit
    from trackroller.fit.material_fit import MaterialFit
    from trackroller.results.results import Results


def write(result: xr.Dataset | Results | MaterialFit | CatalogueFit, path: Path | str) -> Path:
    """Write the page of a result as HTML or PDF.

    Parameters
    ----------
    result : xarray.Dataset, Results, MaterialFit or CatalogueFit
        Results of a study, its data set in `study.nc`, or what `trackroller.solve` returned for its
        design: the report. The data set of one case: its sheet. What `solve_spectrum`,
        `trackroller.carriage`, `trackroller.wear`, `trackroller.patch`, `trackroller.fit_sn`,
        `trackroller.fit_bench` or `trackroller.fit_catalogue` returned: the page of a load
        spectrum, of a carriage, of wear, of one contact, of a fit, of a rule.
    path : Path or str
        The file to write, .html or .pdf. It stands alone and can be sent by mail. A browser prints
        the PDF: Chromium, Chrome or Edge.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        If `result` is none of these, such as the data set of several cases that belong to no study,
        or if `path` is no path.

    Examples
    --------
    >>> import trackroller as tr
    >>> ds = tr.solve(tr.Case(), contact_model="sliding", accuracy="preview")
    >>> tr.report(ds, "sheet.html").name
    'sheet.html'
    """
    import xarray as xr

    if not isinstance(path, (str, os.PathLike)):
        raise InputError("report", path, "the path of a page", "Write a name such as sheet.html.")
    if isinstance(result, xr.Dataset) and "study" not in result.attrs:
        return _write_without_study(result, path)

    from trackroller.fit.catalogue import CatalogueFit
    from trackroller.fit.material_fit import MaterialFit
    from trackroller.report.pages.fit import write_fit
    from trackroller.report.pages.life_rule import write_rule
    from trackroller.report.show import results_of, write_report  # heavy: pandas, SciPy and SALib

    if isinstance(result, MaterialFit):
        return write_fit(result, path)
    if isinstance(result, CatalogueFit):
        return write_rule(result, path)
    return write_report(results_of(result, "report"), path)


def _write_without_study(ds: xr.Dataset, path: Path | str) -> Path:
    """Write the sheet of one case, or the page of a load spectrum, of a carriage, of wear or of one
    contact.
    """
    from trackroller.report.pages.carriage import write_carriage  # heavy: jinja2
    from trackroller.report.pages.patch import write_patch  # heavy: jinja2
    from trackroller.report.pages.sheet import write_sheet  # heavy: jinja2
    from trackroller.report.pages.spectrum import write_spectrum  # heavy: jinja2
    from trackroller.report.pages.wear import write_wear  # heavy: jinja2

    if "patch" in ds.attrs:
        return write_patch(ds, path)
    if "groove_depth" in ds:
        return write_wear(ds, path)
    if "payload_to_lift_off" in ds:
        return write_carriage(ds, path)
    if "damage_sum" in ds:
        return write_spectrum(ds, path)
    return write_sheet(ds, path)


class _CallableModule(ModuleType):
    def __call__(
        self, result: xr.Dataset | Results | MaterialFit | CatalogueFit, path: Path | str
    ) -> Path:
        return write(result, path)


sys.modules[__name__].__class__ = _CallableModule
