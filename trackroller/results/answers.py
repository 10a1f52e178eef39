"""The record of whatever was solved, by the kind of its data set."""

from __future__ import annotations

from collections.abc import Callable

import xarray as xr

from trackroller.results.answer import Answer
from trackroller.results.carriage_answer import answer_of_carriage
from trackroller.results.roller_answer import answer_of_roller
from trackroller.results.spectrum_answer import answer_of_spectrum
from trackroller.results.wear_answer import answer_of_wear
from trackroller.roller.stored_inputs import CASE


def answer_of(ds: xr.Dataset) -> Answer | None:
    """Return the record of a roller, a roller that wears, a spectrum or a carriage; None for
    results of several cases.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `trackroller.solve`, `trackroller.wear`, `trackroller.carriage` or
        `solve_spectrum`.
    """
    makers: dict[str, Callable[[xr.Dataset], Answer]] = {
        "groove_depth": answer_of_wear,
        "damage_sum": answer_of_spectrum,
        "load_case": answer_of_carriage,
    }
    for name, make in makers.items():
        if name in ds.variables:
            return make(ds)
    if CASE in ds.attrs and "case" not in ds.dims:
        return answer_of_roller(ds)
    return None
