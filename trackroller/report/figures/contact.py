"""Figures of one case: tractions and friction energy on the patches, stresses in the planes through the peak.

They show what Wenzel et al. 2022 show in their figures 6, 7 and 11, for any case.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

import xarray as xr

from trackroller.errors import InputError
from trackroller.report.figures import style
from trackroller.report.figures.contact_patch import friction_energy, shear_arrows
from trackroller.report.figures.contact_sections import sections


def plot_case(ds: xr.Dataset, out_dir: Path) -> list[style.FigureInfo]:
    """Draw one solved case as SVG and PNG.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `solve` for one case with the outputs 'contact', 'peak_stress', 'tractions' and 'subsurface'. A figure
        whose output is missing is not drawn.
    out_dir : pathlib.Path
        Folder for the figures; it is created if it does not exist.

    Returns
    -------
    list of FigureInfo
        The figures drawn: `contact_shear`, `contact_energy`, and `contact_1_stress` and `contact_2_stress` with both
        section planes of both bodies. A contact that has lifted off is left out.

    Raises
    ------
    InputError
        If the data set has several cases.
    """
    if "case" in ds.dims:
        if ds.sizes["case"] != 1:
            raise InputError("ds", f"{ds.sizes['case']} cases", "one case is drawn at a time", "Use ds.isel(case=i).")
        ds = ds.isel(case=0)
    return style.draw_all(figures_of(ds), Path(out_dir))


def figures_of(ds: xr.Dataset) -> list[Callable[[], style.Drawn]]:
    """Return the functions that draw the figures of one case without the dimension `case`."""
    of_contacts = [partial(sections, ds, int(contact)) for contact in ds["contact"]]
    return [partial(shear_arrows, ds), partial(friction_energy, ds), *of_contacts]
