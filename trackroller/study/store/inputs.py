"""Store the files that a study was made from, and notice when one of them is edited while the study is solved.

Each input is read once, when the study is loaded, and its SHA-256 is noted at that moment. `inputs/` receives the bytes
with this digest. A study file is stored with every default written out, beside the file as the user wrote it in
`inputs/given/`.
"""

from __future__ import annotations

import functools
import hashlib
from pathlib import Path

from trackroller.errors import InputError, WorkError
from trackroller.files import noted_reads, sha256, write_whole
from trackroller.materials import builtin_database, load_database
from trackroller.study.design.growth import as_planned
from trackroller.study.file.load import load_study
from trackroller.study.file.study import Study
from trackroller.study.store.folder import StudyFolder

MATERIALS = "materials.yaml"


def store_inputs(study: Study, folder: StudyFolder) -> dict[str, dict[str, str]]:
    """Write the inputs of a study into its folder, and remove the inputs of an earlier version.

    Parameters
    ----------
    study : Study
        The study with the digests of its inputs.
    folder : StudyFolder
        Its folder.

    Returns
    -------
    dict
        For each file in `inputs/`: its `sha256`, and the `path` of the file that it is a copy of, '' for none.

    Raises
    ------
    WorkError
        If an input was edited after the study was loaded, or the folder cannot be written.
    """
    stored = {}
    for path, (kind, digest) in study.inputs.items():
        content = path.read_bytes() if path.is_file() else b""
        _compare(path, digest, hashlib.sha256(content).hexdigest())
        names = {"table": path.name, "materials file": MATERIALS, "limit": f"limits/{path.name}"}
        name = names.get(kind, f"given/{digest[:8]}-{path.name}")
        stored[name] = {"sha256": digest, "path": str(path)}
        _write(folder.inputs / name, digest, content)
    table = None if study.config.table is None else Path(study.config.table).name
    text = study.merged(table=table).encode()
    stored[folder.study_file.name] = {"sha256": hashlib.sha256(text).hexdigest(), "path": ""}
    _write(folder.study_file, stored[folder.study_file.name]["sha256"], text)
    for old in folder.inputs.rglob("*"):
        if old.is_file() and old.relative_to(folder.inputs).as_posix() not in stored:
            old.unlink()
    return stored


def _write(path: Path, digest: str, content: bytes) -> None:
    if not path.is_file() or sha256(path) != digest:
        write_whole(path, functools.partial(Path.write_bytes, data=content))


def check_inputs(folder: StudyFolder) -> None:
    """Compare the files that a study was made from with the digests in its record.

    An edited study file that says the same, as after an edit of a comment, counts as unchanged.

    Raises
    ------
    WorkError
        If a file was edited or removed; the message has both digests.
    """
    record = folder.record()
    for stored in record.get("inputs", {}).values():
        path = Path(stored["path"])
        now = sha256(path) if path.is_file() else "no file"
        if stored["path"] and now != stored["sha256"] and not _says_the_same(path, record["study"]):
            _compare(path, stored["sha256"], now)


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
        If a stored input or the record of the plan was altered.
    InputError
        If the study file is not accepted.
    """
    record = folder.record()
    if not record and folder.plan_file.exists():
        raise WorkError(
            f"{folder.plan_file} was altered or damaged (its digest differs), or another version wrote it. Start "
            "`trackroller run` with the study file: it plans anew and keeps every case that is still valid."
        )
    for name, stored in record.get("inputs", {}).items():
        path = folder.inputs / name
        now = sha256(path) if path.is_file() else "no file"
        if now != stored["sha256"]:
            raise WorkError(
                f"{path} was altered after it was written: its SHA-256 was {stored['sha256']} and is {now}. Start "
                "`trackroller run` with the study file: it stores its inputs again."
            )
    materials = folder.inputs / MATERIALS
    with noted_reads():
        database = load_database(materials) if materials.is_file() else builtin_database()
        return as_planned(load_study(folder.study_file, database), record)
