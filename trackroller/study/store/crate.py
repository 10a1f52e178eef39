"""Describe a solved study as a Workflow Run RO-Crate: its files with digests, its inputs, versions and licence.

The crate is the study folder. `ro-crate-metadata.json` lists the files. `inputs/` holds what is needed to solve the
study anywhere: the study file with every default written out, its table of cases and the user's materials. Results are
listed with the digests that were recorded when they were written; a result that does not fit its digest is refused.

References
----------
RO-Crate 1.1, https://w3id.org/ro/crate/1.1; Workflow Run Crate 0.5, https://w3id.org/ro/wfrun/workflow/0.5
"""

from __future__ import annotations

import json
import mimetypes
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.errors import InputError
from trackroller.files import sha256
from trackroller.roller.differences import Difference, compare
from trackroller.study.store.crate_entries import CRATE, crate_graph
from trackroller.study.store.folder import StudyFolder, check_readable
from trackroller.study.store.input_files import study_of_folder
from trackroller.study.store.manifest import REPORT, check_unaltered, digests_of
from trackroller.study.store.netcdf import read_result
from trackroller.study.store.provenance import versions
from trackroller.study.store.put import put_text

if TYPE_CHECKING:
    from trackroller.study.file.study import Study

INPUTS = "inputs"
STUDY_FILE = f"{INPUTS}/study.yaml"
DATA = ("design.nc", "study.nc")
LICENCE = "https://spdx.org/licenses/MIT"
PROFILES = tuple(f"https://w3id.org/ro/wfrun/{name}" for name in ("process/0.5", "workflow/0.5"))


def write_crate(root: Path) -> Path:
    """Write the description of all files of a study, whose inputs were stored when it was planned.

    Parameters
    ----------
    root : Path
        Its folder, `results/NAME`.

    Returns
    -------
    Path
        The metadata file.

    Raises
    ------
    WorkError
        If an input or a result was altered after it was written, or the folder cannot be written.
    """
    study = study_of_folder(StudyFolder(root))
    # a user may delete what a report made: `trackroller report` makes it again
    names = [*DATA, *(name for name in REPORT if (root / name).exists())]
    inputs = digests_of(check_unaltered(root / INPUTS))
    results: dict[str, str] = {}
    for name in names:
        results |= digests_of(check_unaltered(root / name))
    newest = str(np.datetime64(int(max((root / name).stat().st_mtime for name in results)), "s")) + "Z"
    path = root / CRATE
    as_before = _text(study, root, inputs, results, _end_of_run(root))
    if digests_of(path) and path.read_text(encoding="utf-8") == as_before:
        return path  # a copy has other dates, and describes the same run
    return put_text(path, _text(study, root, inputs, results, newest))


def _end_of_run(root: Path) -> str:
    """Return when the run ended that the crate of a folder describes, '' without a crate."""
    return next((str(entry.get("endTime", "")) for entry in crate_graph(root) if entry.get("@id") == "#run"), "")


def _text(study: Study, root: Path, inputs: dict[str, str], results: dict[str, str], ended: str) -> str:
    graph = _graph(study, root, inputs, results, ended)
    return json.dumps({"@context": "https://w3id.org/ro/crate/1.1/context", "@graph": graph}, indent=1) + "\n"


def _entry(place: str, kind: str | list[str], **properties: Any) -> dict[str, Any]:
    return {"@id": place, "@type": kind, **properties}


def _references(names: Iterable[str]) -> list[dict[str, str]]:
    return [{"@id": name} for name in names]


def _file(root: Path, name: str, digest: str) -> dict[str, Any]:
    path = root / name
    entry = _entry(name, "File", sha256=digest, contentSize=path.stat().st_size)
    kind = mimetypes.guess_type(name, strict=False)[0]
    if path.suffix == ".yaml":
        kind = "application/yaml"
    if kind is not None:
        entry["encodingFormat"] = kind
    if name == STUDY_FILE:
        entry["@type"] = ["File", "SoftwareSourceCode", "ComputationalWorkflow"]
        entry |= {"name": "study file with every default", "programmingLanguage": {"@id": "#study-language"}}
    return entry


def _graph(
    study: Study, root: Path, inputs: dict[str, str], results: dict[str, str], ended: str
) -> list[dict[str, Any]]:
    """Return the entries of the metadata file, the study, its run, the programs, the licence and every file.

    `inputs` and `results` hold the digest of each file by its name.
    """
    programs = versions()
    work = "CreativeWork"
    return [
        _entry(CRATE, work, about={"@id": "./"}, conformsTo={"@id": "https://w3id.org/ro/crate/1.1"}),
        _entry(
            "./",
            "Dataset",
            name=f"Study '{study.name}' of track rollers",
            description=study.config.description or f"Results of the study {study.name}",
            datePublished=ended,
            license={"@id": LICENCE},
            conformsTo=_references(PROFILES),
            mainEntity={"@id": STUDY_FILE},
            mentions={"@id": "#run"},
            hasPart=_references((*inputs, *results)),
        ),
        _entry(
            "#run",
            "CreateAction",
            name="solve, analyse and report the study",
            endTime=ended,
            instrument={"@id": STUDY_FILE},
            object=_references(inputs),
            result=_references(results),
            softwareRequirements=_references(f"#{name}" for name in programs),
        ),
        _entry("#study-language", "ComputerLanguage", name="trackroller study file", version=programs["trackroller"]),
        _entry(LICENCE, work, name="MIT License", identifier="MIT"),
        *(_entry(name, work, name=f"Workflow Run Crate profile {name[28:]}") for name in PROFILES),
        *(_entry(f"#{name}", "SoftwareApplication", name=name, softwareVersion=v) for name, v in programs.items()),
        *(_file(root, name, digest) for name, digest in (inputs | results).items()),
    ]


def _kinds(entry: Mapping[str, Any]) -> list[Any]:
    """Return the types of an entry, which states one or a list of them."""
    kinds = entry.get("@type", [])
    return kinds if isinstance(kinds, list) else [kinds]


def read_crate(root: Path | str) -> dict[str, dict[str, Any]]:
    """Return the files that a crate lists, by their path from its root.

    Raises
    ------
    InputError
        If the folder is not a crate of a study.
    WorkError
        If the metadata file was altered after it was written.
    """
    check_readable(Path(root))
    check_unaltered(Path(root) / CRATE)
    files = {str(entry.get("@id")): entry for entry in crate_graph(Path(root)) if "File" in _kinds(entry)}
    if not files:
        remedy = "Give a folder results/NAME of a study that was run to its end."
        wrong = f"holds no readable {CRATE}"
        raise InputError("crate", str(root), "a study that was run to its end", remedy, wrong)
    for name in files:
        if Path(name).is_absolute() or ".." in Path(name).parts:
            raise InputError(
                "crate", name, "files inside the crate", "Do not use this crate.", "leads out of the crate"
            )
    return files


def damaged_files(root: Path | str) -> dict[str, str]:
    """Return what is wrong with the files of a crate: missing or changed, by file; empty if all are as written.

    Raises
    ------
    InputError
        If the folder is not a crate.
    """
    damaged = {}
    for name, entry in read_crate(root).items():
        path = Path(root) / name
        if not path.is_file():
            damaged[name] = "missing"
        elif sha256(path) != entry.get("sha256"):
            damaged[name] = "changed"
    return damaged


def study_of_crate(root: Path | str) -> Study:
    """Return the study of a crate, with the materials in it and no others.

    Raises
    ------
    InputError
        If the folder is not a crate, an input is damaged, or the study file is not accepted.
    """
    damaged = {name: state for name, state in damaged_files(root).items() if name.startswith(INPUTS)}
    if damaged:
        name, state = next(iter(damaged.items()))
        raise InputError("crate", name, "inputs as they were written", "Fetch the crate again.", f"is {state}")
    return study_of_folder(StudyFolder(Path(root)))


def compare_results(before: Path, after: Path) -> dict[str, Difference]:
    """Return the difference of each variable of two `study.nc`, see `compare`."""
    return compare(read_result(before), read_result(after))
