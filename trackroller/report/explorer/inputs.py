"""The inputs of each case, for the command that solves it again, and the strengths of its materials."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import xarray as xr

from trackroller.parameters import MAPPING_FIELDS, MATERIAL_FIELDS, OPTIONS, PARAMETERS
from trackroller.report.columns import study_dims
from trackroller.report.explorer.rows import Column, coded
from trackroller.report.numbers import plain
from trackroller.report.view import StudyView
from trackroller.roller.record import setting_text
from trackroller.study.outputs import flat


def solve_inputs(ds: xr.Dataset, view: StudyView, known: dict[str, Column]) -> tuple[list[list[Any]], list[Column]]:
    """Return what `trackroller solve --set` needs to repeat a case.

    Parameters
    ----------
    ds : gathered study
    view : the same study as a table
    known : columns that the explorer has already, by name

    Returns
    -------
    settings : key, and the text that is the same in all cases or the name of a column in a list of one
    columns : further columns that the settings name
    """
    dims, settings, more = study_dims(ds), [], []
    for key in (*PARAMETERS, *MATERIAL_FIELDS, *MAPPING_FIELDS, *OPTIONS):
        name = f"{key}_value" if f"{key}_value" in ds.variables else key
        if name in ds.variables and set(ds[name].dims) & set(dims):
            if name not in known:
                more.append(_input(name, flat(ds, name, tuple(dims))))
            settings.append([key, [name]])
        elif (text := setting_text(_fixed(ds, view, name))) is not None and key != "shortcuts":
            settings.append([key, text])
    return settings, more


def _input(name: str, values: np.ndarray) -> Column:
    if values.dtype.kind in "fiu":
        return Column(name, plain(name), "", "input", values.astype(float))
    return coded(name, plain(name), "input", values.astype(str))


def _fixed(ds: xr.Dataset, view: StudyView, name: str) -> Any:
    """Return a setting that is the same in all cases, None if it is not given."""
    if name in ds.variables and not ds[name].ndim:
        return ds[name].item()
    if name in OPTIONS:
        return view.study.get(name, ds.attrs.get(name))
    return view.study.get("base", {}).get(name, getattr(PARAMETERS.get(name), "default", None))


def strengths(ds: xr.Dataset) -> dict[str, list[float]]:
    """Return tensile strength and fatigue limit [MPa] of each material of the study, by name."""
    materials = json.loads(ds.attrs.get("materials") or "{}")
    return {
        str(name): [values["tensile_strength"], values["tensile_strength"] * values["fatigue_strength_ratio"]]
        for name, values in materials.items()
        if {"tensile_strength", "fatigue_strength_ratio"} <= set(values)
    }
