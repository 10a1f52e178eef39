"""A gathered data set as plain columns, one value a case: factors, inputs and results."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from trackroller.parameters import PARAMETERS
from trackroller.study.outputs import read_study

INNER = ("contact", "body", "y", "x", "n", "section_x", "section_y", "section_z", "component")
CATEGORIES = ("material_pair", "roller_material", "guide_material")
CONTACT_RESULTS = (
    "normal_force",
    "lateral_force",
    "driving_force",
    "spin_moment",
    "max_pressure",
    "semi_axis_lateral",
    "semi_axis_rolling",
    "friction_power",
    "friction_energy_per_distance",
    "stick_area_fraction",
)
BODY_RESULTS = ("peak_stress", "peak_z", "life_cycles", "error_estimate")
PLAIN_RESULTS = (
    "regime",
    "validity",
    "converged",
    "roller_life_hours",
    "guide_life_hours",
    "slip",
    "stopped",
    "energy_residual",
    "contact_model_used",
)
SURFACE_SHARE = 0.01  # a peak above 1 % of the smaller semi-axis counts as lying at the surface


def any_with(ds: xr.Dataset, dim: str) -> str:
    """Name a variable that has a dimension."""
    return next(str(n) for n, v in ds.variables.items() if dim in v.dims)


def study_dims(ds: xr.Dataset) -> list[str]:
    """Name the dimensions that count cases, in the order of the data set: `case`, or the factors of a grid."""
    dims = [str(d) for d in ds.dims if d not in INNER and ds[any_with(ds, str(d))].ndim]
    return [d for d in dims if d == "case" or d in ds.coords or d in PARAMETERS]


def case_columns(ds: xr.Dataset, dims: list[str]) -> dict[str, np.ndarray]:
    """Flatten every wanted quantity over `dims` in one common order."""
    columns: dict[str, np.ndarray] = {}
    sizes = tuple(ds.sizes[d] for d in dims)

    def flat(da: xr.DataArray) -> np.ndarray:
        missing = [d for d in dims if d not in da.dims]
        values = da.expand_dims({d: ds.sizes[d] for d in missing}).transpose(*dims).values
        values = np.broadcast_to(values, sizes).reshape(-1)
        return values.astype(str) if values.dtype.kind in "OSU" else values.astype(float)

    case_names = [
        n
        for n, v in ds.variables.items()
        if v.dims == ("case",) and n not in ("case", "reason") and n not in ds.data_vars
    ]
    wanted = [*(d for d in dims if d != "case"), *case_names, *PARAMETERS, *CATEGORIES, *PLAIN_RESULTS]
    for name in dict.fromkeys(map(str, wanted)):
        if name in ds.variables and ds[name].ndim and set(ds[name].dims) <= set(dims):
            columns[name] = flat(ds[name])
    for name in CONTACT_RESULTS:
        if name in ds and "contact" in ds[name].dims:
            for i in range(ds.sizes["contact"]):
                columns[f"{name}_{i + 1}"] = flat(ds[name].isel(contact=i))
    if "validity_body" in ds:
        for i, body in enumerate(map(str, ds["body"].values)):
            columns[f"validity_{body}"] = flat(ds["validity_body"].isel(body=i))
    return columns | dict(_body_columns(ds, flat))


def _body_columns(ds: xr.Dataset, flat: Any) -> Iterator[tuple[str, np.ndarray]]:
    """Peak (with its depth and contact) and life of the worse contact of each body; fit and where it peaks."""
    if "body" not in ds.dims or "contact" not in ds.dims:
        return
    for i, body in enumerate(map(str, ds["body"].values)):
        parts = {
            n: np.stack([flat(ds[n].isel(body=i, contact=c)) for c in range(ds.sizes["contact"])])
            for n in BODY_RESULTS
            if n in ds and {"contact", "body"} <= set(ds[n].dims)
        }
        if "peak_stress" in parts:
            peak = parts["peak_stress"]
            worse = np.argmax(np.where(np.isnan(peak), -np.inf, peak), axis=0)[None]
            yield f"peak_stress_{body}", np.take_along_axis(peak, worse, 0)[0]
            yield f"peak_contact_{body}", worse[0] + 1.0
            if "error_estimate" in parts:
                yield f"error_estimate_{body}", np.take_along_axis(parts["error_estimate"], worse, 0)[0]
            if "peak_z" in parts:
                depth = np.take_along_axis(parts["peak_z"], worse, 0)[0]
                yield f"at_surface_{body}", _at_surface(ds, flat, worse, depth)
        if "life_cycles" in parts:
            lives = parts["life_cycles"]
            lowest = np.where(np.isnan(lives), np.inf, lives).min(axis=0)
            yield f"life_cycles_{body}", np.where(np.isnan(lives).all(axis=0), np.nan, lowest)


def _at_surface(ds: xr.Dataset, flat: Any, worse: np.ndarray, depth: np.ndarray) -> np.ndarray:
    limit = np.full(depth.shape, 1e-3)  # mm, when the study has no semi-axes
    if "semi_axis_lateral" in ds and "semi_axis_rolling" in ds:
        smaller = np.stack(
            [
                np.minimum(*(flat(ds[f"semi_axis_{n}"].isel(contact=c)) for n in ("lateral", "rolling")))
                for c in range(ds.sizes["contact"])
            ]
        )
        limit = SURFACE_SHARE * np.take_along_axis(smaller, worse, 0)[0]
    return np.where(np.isnan(depth), np.nan, (depth <= limit).astype(float))


def factor_names(ds: xr.Dataset, dims: list[str], table: pd.DataFrame) -> list[str]:
    """Name the factors: dimensions of a grid, or columns along `case` that vary and follow from no others."""
    names = [d for d in dims if d != "case" and ds.sizes[d] > 1]
    if "case" not in dims:
        return names
    listed = [
        str(n)
        for n, v in ds.variables.items()
        if v.dims == ("case",) and n in table and n not in PLAIN_RESULTS and n != "case"
    ]
    varying = [n for n in listed if table[n].nunique(dropna=False) > 1]
    given = read_study(ds).get("factors")
    if isinstance(given, Mapping):  # a quantity that an expression gives is no factor of its own
        free = [str(n) for n, spec in given.items() if not (isinstance(spec, Mapping) and "expression" in spec)]
        varying = [n for n in free if n in varying] or varying
    if "material_pair" in varying:
        varying = [n for n in varying if n not in ("roller_material", "guide_material")]
    return names + varying


def base_values(ds: xr.Dataset) -> dict[str, Any]:
    """Return the values of the parameters that are the same in all cases."""
    base = read_study(ds).get("base")
    values = {name: parameter.default for name, parameter in PARAMETERS.items()}
    values |= dict(base) if isinstance(base, Mapping) else {}
    for name in (*PARAMETERS, *CATEGORIES):
        if name in ds.variables and ds[name].ndim == 0:
            values[name] = ds[name].item()
    return values
