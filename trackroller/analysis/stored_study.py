"""Read a solved study back: from its folder, from `study.nc`, or from what `solve` returned for a study's design.

This is the only place that reads a study file from the attribute of a data set.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from trackroller.analysis.table import StudyResults
from trackroller.errors import InputError
from trackroller.study.design.entries import CASE_FIELDS
from trackroller.study.design.stored import FACTOR, restored
from trackroller.study.file.load import checked_keys
from trackroller.study.file.study import Study
from trackroller.study.outputs import case_dims
from trackroller.study.store import chunks
from trackroller.study.store.folder import STORE_FORMAT, StudyFolder
from trackroller.study.store.labels import labelled
from trackroller.study.store.seal import read_result
from trackroller.study.store.sources import solver_digest
from trackroller.yaml_file import parse_mapping

_REMEDY = "Run the study again."
NOTICE = "notice"  # attribute with a sentence that every page of the study shows at its top
_EARLIER = "Another version of the solver made these results. `trackroller run` with the study file solves them anew."


def read_results(source: xr.Dataset | Path | str) -> StudyResults:
    """Read a solved study.

    Parameters
    ----------
    source : xarray.Dataset, pathlib.Path or str
        Folder of a study, its file `study.nc`, the data set in such a file, or the result of `trackroller.solve` for
        the design of a study.

    Returns
    -------
    StudyResults
        The study with the same meaning as before it was written.

    Raises
    ------
    InputError
        If there is no such file, it holds no study, this version would read its study file differently, or its rows
        are not those of its design.
    WorkError
        If the file was altered after it was written.
    """
    data = source if isinstance(source, xr.Dataset) else read_result(_file(Path(source)))
    data = data.assign_attrs(_checked_version(data))
    study = _study(data)
    design = restored(data, study.parsed, case_dims(data, study.factors))
    if "options" in data.attrs and "case" in data.dims:  # the cases of a design beside their results: not labelled yet
        values = {name: v for name, v in data.data_vars.items() if name not in CASE_FIELDS}
        block = data[list(values)].transpose("case", ...)
        if "regime" in values:
            block = chunks.from_results(block, np.arange(data.sizes["case"]))
        axes = {n: v.variable for n, v in data.coords.items() if "case" not in v.dims and n != FACTOR}
        results = {name: v.variable for name, v in block.data_vars.items()}
        data = labelled(study, design, data.drop_vars(list(values)), results, axes, data.attrs)
    return StudyResults(study, design, data)


def _file(path: Path) -> Path:
    """Return the path of `study.nc`."""
    file = StudyFolder(path).gathered if path.is_dir() else path
    if not file.is_file():
        allowed = "a folder results/NAME with study.nc, or such a file"
        raise InputError("study", str(path), allowed, "Run the study to its end first.")
    return file


def _checked_version(data: xr.Dataset) -> dict[str, str]:
    """Refuse results in another format; return the notice for results of another solver, {} for those of this one."""
    solver, written = data.attrs.get("solver_digest"), data.attrs.get("store_format")
    if solver is None or (solver == solver_digest() and written == STORE_FORMAT):
        return {}
    if written != STORE_FORMAT:
        name = f"study.nc of {data.attrs.get('study_name')}"
        raise InputError(
            name, f"format {written}", f"results in format {STORE_FORMAT}; another version wrote it", _REMEDY
        )
    warnings.warn(_EARLIER, stacklevel=3)
    return {NOTICE: _EARLIER}


def _study(data: xr.Dataset) -> Study:
    """Return the study whose file a data set holds; refuse a file that would be read with another meaning."""
    text = data.attrs.get("study")
    if not isinstance(text, str):
        raise InputError("study", sorted(map(str, data.attrs)), "results with their study file as attribute", _REMEDY)
    stored = parse_mapping(text, "stored study file")
    study = Study(checked_keys(stored))
    if changed := _changed(stored, study.as_dict()):
        allowed = f"a study file that is read as it was written; {changed} has another meaning in this version"
        raise InputError("study", str(stored.get("name", "")), allowed, _REMEDY)
    return study


def _changed(stored: Mapping[str, Any], now: Mapping[str, Any]) -> str:
    """Return the first key whose value has changed, '' if there is none; keys that are new have their defaults."""
    for key, value in stored.items():
        if key not in now:
            return key
        if isinstance(value, Mapping) and isinstance(now[key], Mapping):
            if inner := _changed(value, now[key]):
                return f"{key}.{inner}"
        elif value != now[key]:
            return key
    return ""
