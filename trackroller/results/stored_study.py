"""Open the results of a study: from its folder, from `study.nc`, or from what `solve` returned for
a study's design.

This is the only place that reads a study file from the attribute of a data set.
"""

from __future__ import annotations

import dataclasses
import json
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from trackroller.errors import InputError
from trackroller.results.results import Results
from trackroller.roller.dataset import VARIABLES
from trackroller.roller.stored_inputs import NOT_GIVEN
from trackroller.study.design.carriage_cases import ROW
from trackroller.study.design.factor_names import CASE_FIELDS
from trackroller.study.design.stored import restored, solved_part
from trackroller.study.file.load import checked_keys, with_present_keys
from trackroller.study.file.study import Study
from trackroller.study.outputs import case_dims
from trackroller.study.store import chunks
from trackroller.study.store.fingerprint import StudyCases
from trackroller.study.store.folder import StudyFolder, check_readable
from trackroller.study.store.gather import collect
from trackroller.study.store.input_files import MATERIALS, study_of_folder
from trackroller.study.store.ledger import Ledger
from trackroller.study.store.manifest import digests_of
from trackroller.study.store.mark import STORE_FORMAT
from trackroller.study.store.netcdf import read_result
from trackroller.study.store.program_digest import solver_digest
from trackroller.study.store.provenance import DATE
from trackroller.study.store.solved_dataset import labelled
from trackroller.yaml_file import parse_mapping

_REMEDY = "Run the study again."
NOTICE = "notice"  # attribute with a sentence that every page of the study shows at its top
MISSING = "missing_cases"  # attribute with the number of cases that are not solved yet
_EARLIER = (
    "Another version of the solver made these results. `trackroller run` with the study "
    "file solves them anew."
)


def open_study(source: xr.Dataset | Path | str, indices: Path | str | None = None) -> Results:
    """Open the results of a study.

    Parameters
    ----------
    source : xarray.Dataset, pathlib.Path or str
        Folder of a study, its file `study.nc`, the data set in such a file, or the result of
        `trackroller.solve` for the design of a study.
    indices : pathlib.Path or str, optional
        File `sensitivity.nc` with the indices of the study. By default they are computed when they
        are needed.

    Returns
    -------
    Results
        The results with the same meaning as before they were written. For the folder of a study
        that is not gathered yet, the cases that are solved: the attribute `missing_cases` of the
        data counts the others, and `notice` says so.

    Raises
    ------
    InputError
        If there is no such file, it holds no study, this version would read its study file
        differently, its rows are not those of its design, or the folder holds a link.
    WorkError
        If the file was altered after it was written.

    Examples
    --------
    >>> import trackroller as tr
    >>> factors = {"roller_profile_radius": {"values": [-7, -8]}}
    >>> study = {"name": "groove", "factors": factors, "contact_model": "sliding"}
    >>> ds = tr.solve(tr.load_study(study).design(), accuracy="preview")
    >>> tr.open_study(ds).data.sizes["roller_profile_radius"]
    2
    """
    if not isinstance(source, (xr.Dataset, str, Path)):
        remedy = "Give the folder results/NAME, or its file study.nc."
        raise InputError("study", type(source).__name__, "a path or a data set", remedy)
    known = None
    if indices is not None:
        known = read_result(indices)
    file = None
    data: xr.Dataset | None
    if isinstance(source, xr.Dataset):
        data = source
    else:
        data = _gathered(Path(source))
        file = _materials_file(Path(source))
    if data is None:
        return _read_unfinished(StudyFolder(Path(source)), known)
    data = data.assign_attrs(_checked_version(data))
    study = _study(data)
    data = data.assign_attrs({NOT_GIVEN: json.dumps(study.not_given)})
    design = restored(data, study.parsed, case_dims(data, study.factors))
    # the cases of a design beside their results: not labelled yet
    if "options" in data.attrs and "case" in data.dims:
        names = [name for name in data.data_vars if name not in CASE_FIELDS]
        solved = data[names].transpose("case", ...)
        if "regime" in names:
            solved = chunks.from_results(solved, np.arange(data.sizes["case"]))
        data = labelled(study, design, data.drop_vars(names), solved)
    _check_dims(data, case_dims(data, study.factors))
    return Results(study, design, data, known, file)


def open_as_reported(root: Path) -> Results:
    """Open the results in a folder with the indices that a report has written there, and without
    indices otherwise.

    Nothing is computed: a page or a figure that must not wait takes these results.
    """
    results = open_study(root)
    stored = root / "sensitivity.nc"
    known = stored.is_file() and not results.unfinished and digests_of(stored)
    if known:
        indices = read_result(stored)
    else:
        indices = xr.Dataset()
    return dataclasses.replace(results, known_indices=indices)


def solved_results(ledger: Ledger) -> Results:
    """Return the results of a study whose cases are all solved."""
    study = ledger.study
    data = labelled(study, study.drawn, ledger.cases.design, collect(ledger))
    return Results(study, study.drawn, data, materials_file=_materials_file(ledger.folder.root))


def _materials_file(path: Path) -> Path:
    """Return the materials file in the folder of a study; `path` is that folder, or `study.nc` in
    it.
    """
    if path.is_dir():
        folder = path
    else:
        folder = path.parent
    return StudyFolder(folder).inputs / MATERIALS


def _gathered(path: Path) -> xr.Dataset | None:
    """Return the results in `study.nc`; None for the folder of a study whose plan is not gathered
    yet.
    """
    if path.is_dir():
        check_readable(path)
    file = path
    record = {}
    if path.is_dir():
        file = StudyFolder(path).gathered
        record = StudyFolder(path).record()
    planned = record.get("study")
    if not file.is_file() and planned is None:
        allowed = "a folder results/NAME with study.nc, or such a file"
        raise InputError(
            "study", str(path), allowed, "Run the study to its end first.", "holds no results"
        )
    data = None
    if file.is_file():
        data = read_result(file)
    if data is None or planned not in (None, data.attrs.get("study")):
        return None
    date = {}
    if "planned" in record:
        date = {DATE: record["planned"]}
    return data.assign_attrs(date)


def _read_unfinished(folder: StudyFolder, indices: xr.Dataset | None) -> Results:
    """Return the solved cases of a study that is not gathered yet."""
    study = study_of_folder(folder)
    ledger = Ledger(StudyCases(study), folder)
    place = ledger.state_number
    of_row = ledger.cases.rows
    # whole rows of the design: a carriage has several cases
    rows = np.setdiff1d(of_row, of_row[place < 0])
    solved = np.flatnonzero(np.isin(of_row, rows))
    if not len(rows) or len(solved) == len(place):
        state = "has no solved case yet"
        if len(rows):
            state = "is solved, but not gathered into study.nc"
        raise InputError(
            "study",
            str(folder.root),
            "a study with results",
            "Run the study to its end first.",
            state,
        )
    drawn = solved_part(study.drawn, rows)
    cases = ledger.cases.design.isel(case=solved)
    if ROW in cases.coords:
        cases = cases.assign_coords({ROW: ("case", np.searchsorted(rows, cases[ROW].values))})
    data = labelled(study, drawn, cases, collect(ledger, solved)).assign_coords(case=rows)
    lacking = [n for n in study.drawn.factors if n not in drawn.factors]
    only = ""
    if lacking:
        only = f" They hold one value only of {' and '.join(lacking)}."
    notice = (
        f"Unfinished study: {len(solved)} of {len(place)} cases are solved, and all numbers "
        f"are those of these.{only}"
    )
    warnings.warn(notice, stacklevel=3)
    if study.config.method.points:  # its goals are statistics of whole design points
        study = dataclasses.replace(study, config=study.config.model_copy(update={"pareto": {}}))
    data = data.assign_attrs({NOTICE: notice, MISSING: len(place) - len(solved)})
    return Results(study, drawn, data, indices, _materials_file(folder.root))


def _check_dims(data: xr.Dataset, along: tuple[str, ...]) -> None:
    """Refuse results that have another dimension than those of the cases and of the output
    itself.
    """
    for name, v in data.data_vars.items():
        if name in VARIABLES:
            known = (*along, *VARIABLES[str(name)].dims)
        elif name in ("regime", "converged"):
            known = along
        else:
            continue
        added = [str(dim) for dim in v.dims if dim not in known]
        if added:
            allowed = f"the dimensions {', '.join(known)}"
            remedy = (
                f"Select one place of it, such as ds.isel({added[0]}=0), or run the study again."
            )
            raise InputError(
                str(name), ", ".join(added), allowed, remedy, "is a dimension that was added"
            )


def _checked_version(data: xr.Dataset) -> dict[str, str]:
    """Refuse results in another format; return the notice for results of another solver, {} for
    those of this one.
    """
    solver = data.attrs.get("solver_digest")
    written = data.attrs.get("store_format")
    if solver is None or (solver == solver_digest() and written == STORE_FORMAT):
        return {}
    if written != STORE_FORMAT:
        name = f"study.nc of {data.attrs.get('study_name')}"
        allowed = f"results in format {STORE_FORMAT}"
        wrong = "is that of another version"
        raise InputError(name, f"format {written}", allowed, _REMEDY, wrong)
    warnings.warn(_EARLIER, stacklevel=3)
    return {NOTICE: _EARLIER}


def _study(data: xr.Dataset) -> Study:
    """Return the study whose file a data set holds; refuse a file that would be read with another
    meaning.
    """
    text = data.attrs.get("study")
    if not isinstance(text, str):
        raise InputError(
            "study",
            sorted(map(str, data.attrs)),
            "results with their study file as attribute",
            _REMEDY,
        )
    stored = with_present_keys(parse_mapping(text, "stored study file"))
    name = str(stored.get("name", ""))
    try:
        config = checked_keys(stored)
    except InputError as error:
        wrong = f"has a study file that this version does not read ({error.errors[0]})"
        raise InputError("study", name, "", _REMEDY, wrong) from None
    study = Study(config, not_given=tuple(json.loads(data.attrs.get(NOT_GIVEN, "[]"))))
    changed = _changed(stored, study.as_dict())
    if changed:
        allowed = "a study file that is read as it was written"
        wrong = f"has another {changed} in this version"
        raise InputError("study", name, allowed, _REMEDY, wrong)
    return study


def _changed(stored: Mapping[str, Any], now: Mapping[str, Any]) -> str:
    """Return the first key whose value has changed, or that only one of two mappings has; '' if
    there is none.
    """
    for key, value in stored.items():
        if key not in now:
            return key
        if isinstance(value, Mapping) and isinstance(now[key], Mapping):
            inner = _changed(value, now[key])
            if inner:
                return f"{key}.{inner}"
        elif value != now[key]:
            return key
    return next((key for key in now if key not in stored), "")
