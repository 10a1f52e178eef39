"""Cases that meet the key `constraints` of a study file: indices, lives and sentences use no others."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
import xarray as xr

from trackroller.errors import InputError, nearest
from trackroller.parameters import MATERIAL_FIELDS, PARAMETERS, REGIMES
from trackroller.parameters.expressions import condition
from trackroller.study.design.factors import readable
from trackroller.study.file.goals import names_in
from trackroller.study.outputs import flat, outputs, read_study, regimes

Column = tuple[np.ndarray, str, str]  # values (n,), units, long name


def column(ds: xr.Dataset, dims: tuple[str, ...], name: str, factors: Iterable[str] = ()) -> Column:
    """Return a factor, a parameter, the regime or an output of every case.

    Parameters
    ----------
    ds : gathered study
    dims : its case dimensions, see `trackroller.study.outputs.case_dims`
    name : of the quantity
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
    given = name in ds.variables
    if name in PARAMETERS or name in MATERIAL_FIELDS or (given and (name in ds.coords or name in factors)):
        rows = int(np.prod([ds.sizes[d] for d in dims]))
        values = readable(flat(ds, name, dims) if given else _constant(ds, name, rows))
        known = PARAMETERS.get(name)
        return values, known.units if known else "", known.long_name if known else name.replace("_", " ")
    try:
        found = outputs(ds, dims, [name], REGIMES[:3], scale="natural", unlimited=True)[0]
    except InputError as error:
        close = nearest(name, REGIMES)
        remedy = f"Did you mean '{close}'?" if close else error.remedy
        raise InputError("pareto or constraints", name, error.allowed, remedy) from None
    return found.values, found.units, found.long_name


def _constant(ds: xr.Dataset, name: str, rows: int) -> np.ndarray:
    """Return a parameter that the result lacks from its study file."""
    base = read_study(ds).get("base", {})
    value = base.get(name, PARAMETERS[name].default if name in PARAMETERS else "")
    return np.full(rows, np.nan if value is None else value)


def meeting(constraints: Iterable[str], values: Mapping[str, np.ndarray], rows: int) -> dict[str, np.ndarray]:
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


def allowed_cases(ds: xr.Dataset, dims: tuple[str, ...], factors: Iterable[str] = ()) -> np.ndarray | None:
    """Mark the cases that meet all constraints of the study file.

    Parameters
    ----------
    ds : gathered study with its study file as attribute
    dims : its case dimensions
    factors : names of the factors, if they are no coordinates of `ds`

    Returns
    -------
    Mask of shape (n,), or None if the study file has no constraints.

    Raises
    ------
    InputError : a constraint names an unknown quantity or is no comparison
    """
    texts = list(read_study(ds).get("constraints") or ())
    if not texts:
        return None
    rows, factors = int(np.prod([ds.sizes[d] for d in dims])), list(factors)
    values = {n: column(ds, dims, n, factors)[0] for n in sorted({n for text in texts for n in names_in(text)})}
    return np.asarray(np.all(list(meeting(texts, values, rows).values()), axis=0))
