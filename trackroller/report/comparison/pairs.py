"""Designs that were solved with several contact models: the cases of a study, sorted by design and model."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from trackroller.numerics.numbers import all_equal
from trackroller.parameters import EXACTNESS, MAPPING_FIELDS, MATERIAL_FIELDS, PARAMETERS
from trackroller.report.columns import CONTACT_RESULTS
from trackroller.roller.geometry import contact_geometry
from trackroller.study.design.entries import OPTION_FACTORS
from trackroller.study.outputs import flat, read_study

MODEL = "contact_model"
INPUTS = (*PARAMETERS, *MATERIAL_FIELDS, *MAPPING_FIELDS, "material_pair", *(o for o in OPTION_FACTORS if o != MODEL))
LIVES = (
    ("roller_life_hours", "life of the roller", "h"),
    ("guide_life_hours", "life of the guide", "h"),
    ("life_cycles", "life", "overrollings"),
)
RESULTS = ("regime", *CONTACT_RESULTS, "friction_energy_balance", "peak_stress", *(life for life, *_ in LIVES))


def pairs(ds: xr.Dataset) -> xr.Dataset | None:
    """Return the designs of a study by contact model; None if the study has but one model.

    Parameters
    ----------
    ds : gathered study, a grid unstacked into its factors or with one dimension `case`

    Returns
    -------
    Dataset over `contact_model` (the cheapest first, the reference last) and `design`: those results that a comparison
    looks at, NaN where a design lacks a model (regime -1), and as coordinates all inputs, `spin` and `lean`, which is
    mu tan(alpha). A design is here if the reference and one model more solved it; two cases are one design if they
    agree in every input but the model. Attributes: `reference`, `factors` (JSON list of what else varies), `left`
    (cases without a partner), `life` (words), `grid` (1: every combination is there), `base` (JSON).
    """
    if MODEL not in ds.variables or "regime" not in ds:
        return None
    present = set(np.unique(ds[MODEL].values.astype(str)).tolist())
    models = [m for m in EXACTNESS[::-1] if m in present]
    if len(models) < 2:
        return None
    order = tuple(map(str, ds["regime"].dims))
    if MODEL in order:
        order = (MODEL, *(d for d in order if d != MODEL))
    columns = _inputs(ds, order)
    rows = _matched_rows(flat(ds, MODEL, order).astype(str), columns, models)
    return _sorted_out(ds, order, models, rows, columns)


def _inputs(ds: xr.Dataset, order: tuple[str, ...]) -> dict[str, np.ndarray]:
    """Return every input that the data set knows, one value a case, (rows,)."""
    study, found = read_study(ds), {}
    names = [n for n in dict.fromkeys((*INPUTS, *study.get("factors", {}), *order)) if n not in (MODEL, "case")]
    rows = int(np.prod([ds.sizes[d] for d in order]))
    for name in names:
        held = f"{name}_value" if f"{name}_value" in ds.variables else name  # friction given as a word
        if held in ds.variables and set(ds[held].dims) <= set(order):
            values = flat(ds, held, order) if ds[held].ndim else np.full(rows, ds[held].item())
            values = np.broadcast_to(values, (rows,))
        elif name in PARAMETERS:
            given = study.get("base", {}).get(name, PARAMETERS[name].default)
            values = np.full(rows, given if isinstance(given, (int, float)) else np.nan)
        else:
            continue
        found[name] = values.astype(float) if values.dtype.kind in "fiu" else values.astype(str)
    return found


def _matched_rows(own: np.ndarray, columns: Mapping[str, np.ndarray], models: list[str]) -> np.ndarray:
    """Return the row of each model and design, shape (models, designs), -1 where the design lacks it.

    The designs stand in the order of their rows.

    `own` is the model of each row (n,), `columns` are its inputs.
    """
    code = np.zeros(own.size, dtype=np.int64)
    for values in columns.values():
        if all_equal(values):
            continue
        _, number = np.unique(values, return_inverse=True)
        _, code = np.unique(code * (int(number.max()) + 1) + number, return_inverse=True)
    rows = np.full((len(models), int(code.max(initial=-1)) + 1), -1)
    for i, model in enumerate(models):
        at = np.flatnonzero(own == model)[::-1]  # of equal cases the first
        rows[i, code[at]] = at
    rows = rows[:, (rows[-1] >= 0) & (rows[:-1] >= 0).any(axis=0)]
    return rows[:, np.argsort(rows[-1], kind="stable")]


def _sorted_out(
    ds: xr.Dataset, order: tuple[str, ...], models: list[str], rows: np.ndarray, columns: Mapping[str, np.ndarray]
) -> xr.Dataset:
    data: dict[str, Any] = {}
    lacking = rows < 0
    for name in (n for n in RESULTS if n in ds):
        values = flat(ds, name, order).astype(float)[rows]
        values[lacking] = -1.0 if name == "regime" else np.nan
        rest = [d for d in ds[name].dims if d not in order]
        data[name] = ((MODEL, "design", *rest), values)
    inputs = {name: values[rows[-1]] for name, values in columns.items()}
    coords: dict[str, Any] = {name: ("design", values) for name, values in inputs.items()}
    coords |= {n: ds[n].values for n in ("contact", "body") if n in ds.coords}
    coords["spin"] = ("design", spin(inputs), {"long_name": "spin phi rho", "units": "1"})
    lean = inputs["friction_coefficient"] * np.tan(np.deg2rad(inputs["contact_angle"]))
    coords["lean"] = ("design", lean, {"long_name": "mu tan(alpha)", "units": "1"})
    out = xr.Dataset(data, coords={MODEL: models, **coords})
    study = read_study(ds)
    out.attrs = {
        "reference": models[-1],
        "factors": json.dumps(_factors(study, inputs, order)),
        "grid": int(MODEL in order),
        "left": int(ds["regime"].size - (~lacking).sum()),
        "life": "",
        "base": json.dumps(study.get("base", {}), default=str),
    }
    return _with_life(out)


def _factors(study: Mapping[str, Any], inputs: Mapping[str, np.ndarray], order: tuple[str, ...]) -> list[str]:
    """Return the factors that vary besides the contact model, in the study's order, without derived ones."""
    given = study.get("factors", {})
    free = [str(n) for n, spec in given.items() if not (isinstance(spec, Mapping) and "expression" in spec)]
    free += [n for n in OPTION_FACTORS if isinstance(study.get(n), list)] + [d for d in order if d != "case"]
    vary = [n for n, values in inputs.items() if not all_equal(values) and n != MODEL]
    return [n for n in dict.fromkeys(free) if n in vary] or [n for n in vary if n not in MATERIAL_FIELDS]


def _with_life(ds: xr.Dataset) -> xr.Dataset:
    """Add the variable `life`: the first of `LIVES` that has numbers."""
    for name, words, unit in LIVES:
        if name in ds and bool((ds[name] > 0).any()):
            life = ds[name].min([d for d in ("contact", "body") if d in ds[name].dims])
            ds["life"] = life.assign_attrs(long_name=words, units=unit)
            ds.attrs["life"] = words
            break
    return ds


def spin(inputs: Mapping[str, np.ndarray]) -> np.ndarray:
    """Return the dimensionless spin of designs, phi rho with phi = sin(alpha)/r_A and 4/rho = k_x + k_y.

    Parameters
    ----------
    inputs : mapping of str to numpy.ndarray
        Columns of `geometry.contact_geometry`, shape (n,).

    Returns
    -------
    numpy.ndarray
        phi rho [1], shape (n,).

    Notes
    -----
    phi [1/mm] is the spin creepage and rho [mm] is the radius of curvature of Kalker (1990), "Three-Dimensional Elastic
    Bodies in Rolling Contact". Their product over the friction coefficient says how close the patch is to full sliding.
    It does not depend on load and stiffness.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        found = contact_geometry(inputs)
        curvature = found.curvature_lateral + found.curvature_rolling
        return np.asarray(np.sin(found.contact_angle) / found.rolling_radius * 4.0 / curvature)
