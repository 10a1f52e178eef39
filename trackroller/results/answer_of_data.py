"""The record of the data set of one roller, a spectrum, wear or a carriage, by its kind."""

from __future__ import annotations

import xarray as xr

from trackroller.results.answer import Answer
from trackroller.results.roller_answer import answer_of_roller
from trackroller.roller.stored_inputs import CASE


def answer_of_data(ds: xr.Dataset) -> Answer | None:
    """Return the record of a roller, a roller that wears, a spectrum or a carriage; None for
    results of several cases.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `trackroller.solve`, `trackroller.wear`, `trackroller.carriage` or
        `solve_spectrum`.
    """
    # one roller on a terminal needs none of the others
    if "groove_depth" in ds.variables:
        from trackroller.results.wear_answer import answer_of_wear

        return answer_of_wear(ds)
    if "damage_sum" in ds.variables:
        from trackroller.results.spectrum_answer import answer_of_spectrum

        return answer_of_spectrum(ds)
    if "load_case" in ds.variables:
        from trackroller.results.carriage_answer import answer_of_carriage

        return answer_of_carriage(ds)
    if CASE in ds.attrs and "case" not in ds.dims:
        return answer_of_roller(ds)
    return None
