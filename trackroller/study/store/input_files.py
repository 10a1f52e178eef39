"""Store the files that a study was made from, and notice when one of them is edited while the study is solved.

Each input is read once, when the study is loaded, and its SHA-256 is noted at that moment. `inputs/` receives the bytes
with this digest. A study file is stored with every default written out, beside the file as the user wrote it in
`inputs/given/`. Where the files lie is not stored.
"""

from __future__ import annotations

import dataclasses
import hashlib
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import xarray as xr

from trackroller.damage import LIMITS
from trackroller.damage.own import FOLDER, hint
from trackroller.errors import InputError, WorkError
from trackroller.files import Reads, noted_reads, read_bytes, sha256
from trackroller.materials import builtin_database, load_database
from trackroller.materials.file import FITS, posterior_path
from trackroller.parameters import MATERIAL_FIELDS
from trackroller.study.design.growth import as_planned
from trackroller.study.file.load import load_study
from trackroller.study.file.study import Study
from trackroller.study.store.folder import StudyFolder, check_readable
from trackroller.study.store.put import replacing

MATERIALS = "materials.yaml"
LIMITS_FOLDER = "limits/"  # in `inputs/`: the files of a user's own limits


def store_inputs(study: Study, folder: StudyFolder, cases: xr.Dataset) -> dict[str, dict[str, str]]:
    """Write the inputs of a study into its folder, and remove the inputs of an earlier plan.

    Parameters
    ----------
    study : Study
        The study with the digests of its inputs.
    folder : StudyFolder
        Its folder.
    cases : xarray.Dataset
        Its cases, which name its materials: the fits of these are stored as well, because the range of a life by tests
        rests on them.

    Returns
    -------
    dict
        For each file in `inputs/` its `sha256`.

    Raises
    ------
    InputError
        If a file of somebody else, or a changed one, stands in the place of an input.
    WorkError
        If an input was edited after the study was loaded, or the folder cannot be written.
    """
    contents = {}
    for path, (kind, digest) in study.inputs.items():
        content = path.read_bytes() if path.is_file() else b""
        _compare(path, digest, hashlib.sha256(content).hexdigest())
        names = {"table": path.name, "materials file": MATERIALS, "limit": f"{LIMITS_FOLDER}{path.name}"}
        contents[names.get(kind, f"given/{digest[:8]}-{path.name}")] = content
        if kind == "materials file":
            used = {str(name) for field in MATERIAL_FIELDS if field in cases for name in np.unique(cases[field])}
            fits = [fit for fit in (posterior_path(path, name) for name in used) if fit.is_file()]
            contents |= {f"{FITS}/{fit.name}": read_bytes(fit, "fit") for fit in fits}
    if study.config.table is None:
        table = None
    else:
        table = Path(study.config.table).name
    contents[folder.study_file.name] = study.merged(table=table).encode()
    with replacing(folder.inputs) as beside:
        for name, content in contents.items():
            (beside / name).parent.mkdir(parents=True, exist_ok=True)
            (beside / name).write_bytes(content)
    return {name: {"sha256": hashlib.sha256(content).hexdigest()} for name, content in contents.items()}


def check_inputs(folder: StudyFolder, inputs: Reads) -> None:
    """Compare the files that a study was made from with their digests when the study was loaded.

    An edited study file that says the same, as after an edit of a comment, counts as unchanged.

    Raises
    ------
    WorkError
        If a file was edited or removed; the message has both digests.
    """
    for path, (_, digest) in inputs.items():
        now = sha256(path) if path.is_file() else "no file"
        if now != digest and not _says_the_same(path, folder.record().get("study", "")):
            _compare(path, digest, now)


def _says_the_same(path: Path, study: str) -> bool:
    """Return whether a file is a study file that means the study of a plan."""
    try:
        return load_study(path, planned=True).merged() == study
    except InputError:
        return False


def _compare(path: Path, before: str, now: str) -> None:
    if now != before:
        raise WorkError(
            f"{path} was edited while the study was solved from its earlier version: its SHA-256 was {before} and is "
            f"{now}. Nothing is mixed. Start again: the cases that did not change are kept."
        )


def study_of_folder(folder: StudyFolder) -> Study:
    """Return the study of a folder as it was planned, with the materials stored there and no others.

    Raises
    ------
    WorkError
        If a stored input was altered.
    InputError
        If the study file is not accepted, or the folder is not that of a study.
    """
    check_readable(folder.root)
    record = folder.record()
    for name, stored in record.get("inputs", {}).items():
        path = folder.inputs / name
        now = sha256(path) if path.is_file() else "no file"
        if now != stored["sha256"]:
            raise WorkError(
                f"{path} was altered after it was written: its SHA-256 was {stored['sha256']} and is {now}. Move or "
                "remove it, then start `trackroller run` with the study file: it stores its inputs again."
            )
    _check_limits(folder, record.get("inputs", {}))
    materials = folder.inputs / MATERIALS
    with noted_reads():
        if materials.is_file():
            database = load_database(materials)
        else:
            database = builtin_database()
        study = as_planned(load_study(folder.study_file, database), record)
    return dataclasses.replace(study, not_given=tuple(record.get("not_given", study.not_given)))


def _check_limits(folder: StudyFolder, inputs: Iterable[str]) -> None:
    """Refuse a study whose own limits are not loaded; its materials and outputs would not be known."""
    files = [folder.inputs / name for name in inputs if name.startswith(LIMITS_FOLDER)]
    lacking = [file for file in files if file.stem not in LIMITS]
    if lacking:
        file = lacking[0]
        remedy = hint(file.stem) or f"Read {file}, copy it to {FOLDER}, and add --allow-code."
        names = ", ".join(one.stem for one in lacking)
        raise InputError("study", str(folder.root), f"limits that are loaded, here {names}", remedy)
