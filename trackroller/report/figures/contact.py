"""Figures of one case: tractions and friction energy on the patches, stresses in the planes through the peak.

They show what Wenzel et al. 2022 show in their figures 6, 7 and 11, for any case.
"""

from __future__ import annotations

import logging
import warnings
from pathlib import Path
from typing import Any

import xarray as xr

from trackroller.errors import InputError
from trackroller.report.figures import style
from trackroller.report.figures.contact_patch import friction_energy, shear_arrows
from trackroller.report.figures.contact_sections import sections

log = logging.getLogger(__name__)


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
    jobs: list[tuple[Any, tuple]] = [(shear_arrows, ()), (friction_energy, ())]
    jobs += [(sections, (contact,)) for contact in ds["contact"].values.tolist()]
    infos = []
    with style.look(), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for draw, arguments in jobs:
            try:
                drawn = draw(ds, *arguments)
                if drawn is None:
                    continue
                style.save(drawn[0], Path(out_dir), drawn[1].name)
            except Exception as problem:
                log.warning("figure %s was not drawn: %s", draw.__name__, problem, exc_info=True)
                continue
            infos.append(drawn[1])
    return infos
