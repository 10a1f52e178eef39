"""Store a design in a data set of cases, and read it back; nothing is drawn again.

Places (quantiles, codes or numbers of levels) of random and classical designs stand in the
coordinate `design_place`. Those of a grid and of a table follow from the values themselves. The
attribute `design_meta` holds the numbers of the method as JSON, such as the groups of a Saltelli
design.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from trackroller.errors import InputError
from trackroller.methods import METHODS, Design
from trackroller.methods.factor import Factor
from trackroller.methods.grid import cells
from trackroller.methods.table import of_columns
from trackroller.study.design.sampling import columns_of_rows
from trackroller.study.outputs import constant, flat

PLACE = "design_place"
FACTOR = "design_factor"
META = "design_meta"
REMEDY = "Rows and study file do not belong together. Run the study again."


def stored(design: Design) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the coordinates and attributes that hold a design.

    Parameters
    ----------
    design : the drawn design

    Returns
    -------
    Coordinates along `case`, and attributes, for an xarray.Dataset.
    """
    meta = {"columns": list(design.columns), "size": design.size, **design.meta}
    attrs = {"design": design.method.name, META: json.dumps(meta)}
    if design.method.follows:
        return {}, attrs
    words = {
        "long_name": "place in the design: quantile, code, or number of the listed value",
        "units": "1",
    }
    names = np.array(list(design.factors), dtype=object)
    return {
        PLACE: (("case", FACTOR), design.unit, words),
        FACTOR: (FACTOR, names, {"long_name": "factor"}),
    }, attrs


def restored(ds: xr.Dataset, parsed: Mapping[str, Factor], dims: tuple[str, ...]) -> Design:
    """Return the design that a data set of cases holds.

    Parameters
    ----------
    ds : cases or results with the coordinates and attributes of `stored`
    parsed : all factors of the study file
    dims : dimensions of `ds` that count cases

    Returns
    -------
    Design, equal to the one that was stored

    Raises
    ------
    InputError : the design is missing, or rows and factors are not those of the study file
    """
    known = str(ds.attrs.get("design", ""))
    meta = json.loads(ds.attrs.get(META, "null"))
    if known not in METHODS or meta is None:
        raise InputError(
            "study",
            sorted(map(str, ds.attrs)),
            f"results with the attributes design and {META}",
            REMEDY,
        )
    method = METHODS[known]
    names = meta.pop("columns")
    size = meta.pop("size")
    rows = int(np.prod([ds.sizes[d] for d in dims]))
    if rows != max(size, 1):
        raise InputError(
            "study",
            f"{rows} rows",
            f"the {size} rows of its design {known}",
            "Gather the study again.",
        )
    if method.observed:
        columns = {name: _column(ds, name, dims) for name in names}
        free, unit = of_columns(
            {name: values for name, values in columns.items() if name not in parsed}
        )
        return Design(columns, free, method, unit, meta)
    free = {name: factor for name, factor in parsed.items() if factor.varies}
    if method.crossed:
        unit = cells(meta["shape"])
    else:
        unit = flat(ds, PLACE, dims)
        if [str(name) for name in ds[FACTOR].values] != list(free):
            raise InputError(
                "study", list(map(str, ds[FACTOR].values)), f"the factors {', '.join(free)}", REMEDY
            )
    levels = {
        name: method.values(factor, unit[:, j]) for j, (name, factor) in enumerate(free.items())
    }
    _check_values(ds, free, levels, dims)
    columns = {}
    for name in (name for name in names if name in parsed):
        if not parsed[name].discrete:
            columns[name] = _column(ds, name, dims)
        elif name in levels:
            columns[name] = levels[name]
        else:
            columns[name] = parsed[name].take(np.zeros(rows))
    columns |= columns_of_rows(parsed, columns)
    return Design({name: columns[name] for name in names}, free, method, unit, meta)


def _check_values(
    ds: xr.Dataset,
    free: Mapping[str, Factor],
    levels: Mapping[str, np.ndarray],
    dims: tuple[str, ...],
) -> None:
    """Refuse rows whose numbers are not those that the design draws."""
    for name, values in levels.items():
        known = name in ds.variables or constant(ds, name) is not None
        if not known or not free[name].ordered:
            continue
        rows = flat(ds, name, dims)
        number = rows.dtype.kind in "fiu"
        if number and not np.allclose(rows, values, rtol=1e-6, atol=1e-12):
            raise InputError("study", name, "the values of its design", REMEDY)


def solved_part(design: Design, rows: np.ndarray) -> Design:
    """Return the design of some rows: a smaller random sample, otherwise a table, which needs no
    structure.

    Parameters
    ----------
    design : Design
        The whole design.
    rows : numpy.ndarray of int, shape (n,)
        Rows to keep.
    """
    columns = {name: values[rows] for name, values in design.columns.items()}
    if design.method.subset:
        # they are not complete
        meta = {key: value for key, value in design.meta.items() if key != "replicates"}
        return Design(columns, design.factors, design.method, design.unit[rows], meta)
    free, unit = of_columns({name: columns[name] for name in design.factors})
    return Design(columns, free, METHODS["table"], unit, {"rank_correlations": ()})


def _column(ds: xr.Dataset, name: str, dims: tuple[str, ...]) -> np.ndarray:
    """Return a column of a design: numbers as floats, texts as objects."""
    if name not in ds.variables and constant(ds, name) is None:
        raise InputError("study", name, "a column of the results", "Gather the study again.")
    values = flat(ds, name, dims)
    if values.dtype.kind in "fiu":
        return values.astype(float)
    return values.astype(object)
