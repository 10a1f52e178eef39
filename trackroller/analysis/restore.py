"""The design of a result, drawn again from the study file stored in it and checked against its rows."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from trackroller.errors import InputError
from trackroller.numerics.numbers import all_equal
from trackroller.parameters import MATERIAL_FIELDS, PARAMETERS
from trackroller.study.design.draws import of_columns
from trackroller.study.design.entries import OPTION_FACTORS
from trackroller.study.design.sampling import OPTIONS, SampledDesign, sample
from trackroller.study.outputs import BOOKKEEPING, case_dims, flat, read_study, settings


def design_of(ds: xr.Dataset, study: Mapping[str, Any] | None = None) -> SampledDesign:
    """Draw the design of a result again.

    Parameters
    ----------
    ds : gathered study with its merged study file as attribute `study`
    study : that study file, if it has been read already

    Returns
    -------
    SampledDesign

    Raises
    ------
    InputError : there is no study file, or its factors do not reproduce the rows
    """
    study = read_study(ds) if study is None else study
    method = str(study.get("design", ds.attrs.get("design", ""))) if study else ""
    if not method:
        raise InputError("study", ds.attrs.get("study"), "a result with its merged study file as attribute `study`")
    specs = dict(study.get("factors", {}))
    for name in OPTION_FACTORS:
        if isinstance(study.get(name), list):
            specs[name] = {"values": study[name]}
    if method == "table":
        return _table_design(ds, specs)
    options = {k: study[k] for k in OPTIONS.get(method, {}) if study.get(k) is not None}
    if study.get("exchange") == "groups":
        options["groups"] = settings(study)["groups"]
    base = {k: v for k, v in study.get("base", {}).items() if isinstance(v, (int, float))}
    design = sample(specs, method, int(study.get("samples", 1024)), int(study.get("seed", 1)), base=base, **options)
    _check_rows(ds, design)
    return design


def _check_rows(ds: xr.Dataset, design: SampledDesign) -> None:
    dims = case_dims(ds, design.factors)
    rows = int(np.prod([ds.sizes[d] for d in dims])) if dims else 1
    if rows != design.size:
        allowed = f"the {design.size} rows of its design {design.method}"
        raise InputError("study", f"{rows} rows", allowed, "Gather the study again.")
    for name, factor in design.factors.items():
        if name not in ds.variables or not factor.ordered or ds[name].dtype.kind not in "fiu":
            continue
        if not np.allclose(flat(ds, name, dims), design.columns[name], rtol=1e-6, atol=1e-12):
            allowed = "the values of its design: same seed, same samplers"
            remedy = "Rows and study file do not belong together. Run the study again."
            raise InputError("study", name, allowed, remedy)


def _table_design(ds: xr.Dataset, specs: Mapping[str, Any]) -> SampledDesign:
    """Return the design of a table: its factors are the columns that vary, without the expressions beside it."""
    columns: dict[str, np.ndarray] = {}
    for name in map(str, ds.variables):
        values = ds[name].values
        number = values.dtype.kind in "fiu"
        if ds[name].dims != ("case",) or name in specs or name in {*BOOKKEEPING, "case"} - {"material_pair"}:
            continue
        if number and (np.isnan(values).any() or not (name in PARAMETERS or name in ds.coords)):
            continue
        if values.dtype.kind in "fiuOUST" and not all_equal(values):
            columns[name] = values.astype(float if number else object)
    if "material_pair" in columns:  # the pair stands for its two materials
        columns = {name: values for name, values in columns.items() if name not in MATERIAL_FIELDS}
    free, unit = of_columns(columns)
    if not free:
        raise InputError("study", list(ds.variables), "a table with at least one column that varies")
    return SampledDesign(columns, free, "table", unit, {})
