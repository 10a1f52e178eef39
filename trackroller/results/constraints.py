"""Cases that meet the key `constraints` of a study file: indices, lives and sentences use no
others.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import xarray as xr

from trackroller.errors import InputError, nearest
from trackroller.methods.factor import readable
from trackroller.parameters import MATERIAL_FIELDS, PARAMETERS, REGIMES
from trackroller.parameters.carriage_fields import parameter_of
from trackroller.parameters.expressions import condition
from trackroller.study.outputs import constant, flat, outputs, regimes

Column = tuple[np.ndarray, str, str]  # values (n,), units, long name


def quantity_of(
    ds: xr.Dataset,
    dims: tuple[str, ...],
    name: str,
    base: Mapping[str, Any],
    factors: Iterable[str] = (),
) -> Column:
    """Return a factor, a parameter, the regime or an output of every case.

    Parameters
    ----------
    ds : gathered study
    dims : its case dimensions, see `trackroller.study.outputs.case_dims`
    name : of the quantity
    base : values of the base case in the study file
    factors : names of the factors, if they are no coordinates of `ds`

    Returns
    -------
    Values in every regime, shape (n,), units and long name.

    Raises
    ------
    InputError : the name is unknown
    """
    if name == "regime":
        return np.array(REGIMES, dtype=object)[regimes(ds, dims)], "", "regime"
    given = name in ds.variables or constant(ds, name) is not None
    if (
        name in PARAMETERS
        or name in MATERIAL_FIELDS
        or (given and (name in ds.coords or name in factors))
    ):
        rows = int(np.prod([ds.sizes[d] for d in dims]))
        if given:
            column = flat(ds, name, dims)
        else:
            column = _constant(base, name, rows)
        values = readable(column)
        known = parameter_of(name)
        if known is None:
            return values, "", name.replace("_", " ")
        return values, known.units, known.long_name
    try:
        output = outputs(ds, dims, [name], REGIMES[:3], scale="natural", unlimited=True)[0]
    except InputError as error:
        close = nearest(name, REGIMES)
        if close:
            remedy = f"Did you mean '{close}'?"
        else:
            remedy = error.remedy
        raise InputError(
            "pareto or constraints", name, error.allowed, remedy, error.wrong
        ) from None
    return output.values, output.units, output.long_name


def _constant(base: Mapping[str, Any], name: str, rows: int) -> np.ndarray:
    """Return a parameter that the result lacks."""
    value = base.get(name, "")
    if name not in base and name in PARAMETERS:
        value = PARAMETERS[name].default
    if value is None:
        value = np.nan
    return np.full(rows, value)


def meeting(
    constraints: Iterable[str], values: Mapping[str, np.ndarray], rows: int
) -> dict[str, np.ndarray]:
    """Return for each constraint which cases meet it.

    Parameters
    ----------
    constraints : comparisons
    values : column of each name in the comparisons, shape (n,)
    rows : number of cases n

    Returns
    -------
    Comparison -> mask of shape (n,), False where a value of the comparison is undefined.
    """
    known = {**values, **{name: name for name in REGIMES}}
    return {text: np.broadcast_to(condition(text, known), (rows,)) for text in constraints}
