"""A gathered data set as plain columns, one value a case: factors, inputs and results."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from trackroller.methods import Design
from trackroller.parameters import MAPPING_FIELDS, MATERIAL_FIELDS, PARAMETERS
from trackroller.roller.dataset import shown
from trackroller.study.design.build import OF_SHELF
from trackroller.study.design.levels import OF_MATERIALS
from trackroller.study.outputs import OF_WORD, constant, flat

CONTACT_RESULTS = shown("contact")
WHOLE_RESULTS = shown()
BODY_RESULTS = ("peak_stress", "peak_z", "life_cycles", "error_estimate", "fatigue_stress")
PLAIN_RESULTS = (
    "regime",
    "validity",
    "converged",
    "roller_life_hours",
    "guide_life_hours",
    "pair_life_hours",
    "pair_life_to_first_limit_hours",
    "first_to_fail",
    *WHOLE_RESULTS,
    "stopped",
    "energy_residual",
    "contact_model_used",
    "accuracy_used",
)
OF_BODIES = ("validity_body", "life_to_first_limit_hours", "limiting_mechanism")
# of the smaller semi-axis: a peak above this depth counts as lying at the surface
SURFACE_SHARE = 0.01


def _columns(ds: xr.Dataset, dims: Sequence[str], names: Iterable[str]) -> dict[str, np.ndarray]:
    """Flatten those quantities that have one value a case, numbers as floats."""
    varying = [n for n in dict.fromkeys(names) if n in ds.variables and ds[n].ndim]
    flattened = {n: flat(ds, n, tuple(dims)) for n in varying if set(ds[n].dims) <= set(dims)}
    return {n: _texts_or_floats(values) for n, values in flattened.items()}


def _texts_or_floats(values: np.ndarray) -> np.ndarray:
    if values.dtype.kind in "OSU":
        return values.astype(str)
    return values.astype(float)


def input_columns(ds: xr.Dataset, dims: Sequence[str]) -> dict[str, np.ndarray]:
    """Flatten factors and other inputs that vary over `dims` in one common order."""
    own = [
        n
        for n, v in ds.variables.items()
        if v.dims == ("case",) and n not in ("case", "reason", *ds.data_vars)
    ]
    own += [n for n, v in ds.coords.items() if OF_SHELF in v.attrs and n not in MAPPING_FIELDS]
    # numbers that belong to a friction coefficient given as a word
    words = [f"{n}{OF_WORD}" for n in PARAMETERS]
    return _columns(
        ds,
        dims,
        [*(d for d in dims if d != "case"), *map(str, own), *PARAMETERS, *words, *OF_MATERIALS],
    )


def case_columns(ds: xr.Dataset, dims: Sequence[str]) -> dict[str, np.ndarray]:
    """Flatten inputs and wanted results over `dims` in one common order."""
    ds = ds.transpose(..., "contact", "body", missing_dims="ignore")

    def column(name: str) -> np.ndarray:
        return flat(ds, name, tuple(dims)).astype(float)

    columns = input_columns(ds, dims) | _columns(ds, dims, PLAIN_RESULTS)
    for name in (n for n in CONTACT_RESULTS if n in ds and "contact" in ds[n].dims):
        columns |= {f"{name}_{i}": values for i, values in enumerate(column(name).T, 1)}
    if {"peak_stress", "peak_z"} <= set(ds):
        ds = ds.assign(at_surface=at_surface(ds))
    needed = {n: {"contact", "body"} for n in (*BODY_RESULTS, "at_surface")} | {
        name: {"body"} for name in OF_BODIES
    }
    of_bodies = {
        n: column(n) for n, inner in needed.items() if n in ds and inner <= set(ds[n].dims)
    }
    for name, table in _of_bodies(of_bodies).items():
        columns |= {
            f"{name}_{body}": values
            for body, values in zip(ds["body"].values, table.T, strict=True)
        }
    return columns


def at_surface(ds: xr.Dataset) -> xr.DataArray:
    """Say of each contact and body whether the peak stress lies at the surface (1) or below it (0),
    NaN if unknown.

    A peak lies at the surface down to a depth of 1 % of the smaller semi-axis, or of 1 µm if the
    semi-axes are unknown.
    """
    limit: Any = 1e-3
    if {"semi_axis_lateral", "semi_axis_rolling"} <= set(ds):
        limit = SURFACE_SHARE * np.minimum(ds["semi_axis_lateral"], ds["semi_axis_rolling"])
    at_surface: xr.DataArray = (ds["peak_z"] <= limit).astype(float).where(ds["peak_z"].notnull())
    return at_surface.transpose(*ds["peak_z"].dims)


def _of_bodies(results: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return flags, peak stress of the worse contact, its error and place, and the shorter life,
    (n, bodies) each.

    Parameters
    ----------
    results : results by name, shape (n, contacts, bodies) or (n, bodies)
    """
    worse_of = {name.removesuffix("_body"): results[name] for name in OF_BODIES if name in results}
    if "peak_stress" in results:
        peak = results["peak_stress"]
        worse = np.argmax(np.where(np.isnan(peak), -np.inf, peak), axis=1)[:, None]
        for name in (n for n in ("peak_stress", "error_estimate", "at_surface") if n in results):
            worse_of[name] = np.take_along_axis(results[name], worse, axis=1)[:, 0]
    if "fatigue_stress" in results:
        worse_of["fatigue_stress"] = np.fmax.reduce(results["fatigue_stress"], axis=1)
    if "life_cycles" in results:
        worse_of["life_cycles"] = np.fmin.reduce(results["life_cycles"], axis=1)
    return worse_of


def factor_names(
    ds: xr.Dataset, dims: Sequence[str], design: Design, table: pd.DataFrame
) -> list[str]:
    """Name the factors that vary: dimensions of a grid, or independent factors along `case`."""
    if "case" not in dims:
        return [d for d in dims if ds.sizes[d] > 1]
    varying = [
        name for name in design.factors if name in table and table[name].nunique(dropna=False) > 1
    ]
    if "material_pair" in varying:
        return [n for n in varying if n not in MATERIAL_FIELDS]
    return varying


def base_values(ds: xr.Dataset, base: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of the parameters that are the same in all cases."""
    values = {name: parameter.default for name, parameter in PARAMETERS.items()} | dict(base)
    shared = {name: constant(ds, name) for name in (*PARAMETERS, *OF_MATERIALS)}
    return values | {name: value for name, value in shared.items() if value is not None}


def codes(table: pd.DataFrame, names: Iterable[Any]) -> np.ndarray:
    """Number the combinations of columns, shape (n,), in the order of appearance."""
    columns = list(names)
    if not columns:
        return np.zeros(len(table), dtype=int)
    return table.groupby(columns, sort=False, dropna=False, observed=True).ngroup().to_numpy()
