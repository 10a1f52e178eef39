"""Which chunks a study consists of, so that each missing case is solved once and no finished one again.

A chunk is a list of cases under `plan/`, named by its content. The planner keeps every list that still holds
wanted cases, and makes new lists only for cases that stand in none: growing a study adds chunks and touches no
old one. Planning twice gives the same plan.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import math
import shutil
import zipfile
import zlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.roller.case import to_table
from trackroller.study import store
from trackroller.study.caselists import load_list, save_list, sound_cases, write_list
from trackroller.study.design.build import build, table_path
from trackroller.study.design.entries import OPTION_FACTORS
from trackroller.study.design.growth import with_history
from trackroller.study.files import StudyFolder, link_or_copy, locked, write_whole
from trackroller.study.identity import chunk_name, fingerprints
from trackroller.study.mend import Tell, drop_corrupt
from trackroller.study.sources import solver_digest

if TYPE_CHECKING:
    import xarray as xr

    from trackroller.study.config import Study

SHORTEST, LONGEST = 8.0, 40.0  # seconds of solving a chunk: starting a job (1-2 s) must stay a small part
MOST_CHUNKS = 400
SMALLEST_CHUNK = 100
LARGEST_CHUNK = 20_000


@dataclass(frozen=True)
class Plan:
    """Chunks of a study (in order) and how many cases it has; `cases` only when freshly made."""

    study: Study
    folder: StudyFolder
    chunks: dict[str, int]
    size: int
    design: xr.Dataset | None = None
    cases: np.ndarray | None = None
    notes: list[str] = field(default_factory=list)


def study_folder(study_name: str, results: Path | str = "results") -> StudyFolder:
    """Folder of a study's results."""
    from trackroller.study.config import check_name

    return StudyFolder(Path(results) / check_name(study_name))


def case_options(study: Study, design: xr.Dataset) -> tuple[list[dict[str, Any]] | dict[str, Any], np.ndarray]:
    """Options of `solve` for each case, and the group of equal options each case belongs to, shape (n,)."""
    n = design.sizes["case"]
    varying = [name for name in OPTION_FACTORS if name in design.coords]
    if not varying:
        return study.options, np.zeros(n, dtype=int)
    keys = list(zip(*[design[name].values.tolist() for name in varying], strict=True))
    known = {key: i for i, key in enumerate(dict.fromkeys(keys))}
    ready = [study.options | dict(zip(varying, key, strict=True)) for key in known]
    group = np.array([known[key] for key in keys])
    return [ready[i] for i in group], group


def identify(study: Study, design: xr.Dataset) -> np.ndarray:
    """Fingerprint of each case of a design, shape (n,); raises `InputError` for a case that is no case."""
    options, _ = case_options(study, design)
    return fingerprints(to_table(design.drop_vars(list(design.coords)), study.materials), options)


def chunk_size(study: Study, cases: int) -> int:
    """Cases a job: some seconds of solving, but at least two chunks when there is work for two cores."""
    if study.config.chunk_size:
        return study.config.chunk_size
    from trackroller.study.cost import study_rate

    speed = study_rate(study)
    wanted = math.ceil(speed * min(max(cases / speed / 16, SHORTEST), LONGEST))
    wanted = max(min(wanted, math.ceil(cases / 2)), SMALLEST_CHUNK, math.ceil(cases / MOST_CHUNKS))
    return min(wanted, LARGEST_CHUNK)


def plan_key(study: Study) -> str:
    """Hash of everything a plan depends on, found without drawing the design."""
    digest = hashlib.sha256(f"{solver_digest()}\n{study.merged()}".encode())
    material_names = {*study.materials.names()}
    for name in sorted(material_names):
        digest.update(repr(study.materials.material(name)).encode())
    pairs = [(a, b) for a in sorted(material_names) for b in sorted(material_names)]
    for pair in pairs:
        with contextlib.suppress(ValueError):
            digest.update(repr(study.materials.friction(*pair)).encode())
    if study.config.table is not None:
        digest.update(Path(table_path(study)).read_bytes())
    return digest.hexdigest()


def make_plan(study: Study, results: Path | str = "results", *, tell: Tell | None = None, check: bool = True) -> Plan:
    """Plan a study and write its case lists.

    Parameters
    ----------
    study : the checked study
    results : parent of the study's folder
    tell : called with one line for each thing the user should know (a corrupt file, a changed solver)
    check : read every kept file and drop the corrupt ones

    Raises `InputError` for a design with bad cases or a folder that cannot be written.
    """
    folder = study_folder(study.name, results).create()
    tell = tell or (lambda line: None)
    study = with_history(study, folder)
    with locked(folder.plan_lock):
        if check:
            drop_corrupt(folder, tell)
            for path in sorted((folder.root / "plan").glob("*.npz")):
                sound_cases(path, tell)
        _tell_changed_solver(folder, tell)
        ready = _kept_plan(study, folder)
        if ready is None and study.config.grown_from:
            tell(f"the sample grows from {study.config.grown_from[-1]} to {study.config.samples}: its first cases stay")
        return ready if ready is not None else _new_plan(study, folder, tell)


def _tell_changed_solver(folder: StudyFolder, tell: Tell) -> None:
    """Say so when the cases of a folder were planned for another version of the solver's code."""
    try:
        known = json.loads(folder.plan_file.read_text()).get("solver_digest")
    except (OSError, ValueError, AttributeError):
        return
    if known != solver_digest():
        tell(f"the solver's code has changed since {folder.root} was planned: all its cases are solved anew")


def _kept_plan(study: Study, folder: StudyFolder) -> Plan | None:
    """The plan on the disk when nothing it depends on has changed."""
    try:
        data = json.loads(folder.plan_file.read_text())
        if data["key"] != plan_key(study) or not all(folder.case_list(name).is_file() for name in data["chunks"]):
            return None
        return Plan(study, folder, data["chunks"], data["size"])
    except (OSError, ValueError, KeyError, TypeError):
        return None


def _new_plan(study: Study, folder: StudyFolder, tell: Tell) -> Plan:
    design = build(study)
    cases = identify(study, design)
    wanted, first = np.unique(cases, return_index=True)
    options, group = case_options(study, design)
    _relist(folder, design, cases, options)
    chunks: dict[str, int] = {}
    covered = np.zeros(len(wanted), dtype=bool)
    for path in sorted((folder.root / "plan").glob("*.npz")):
        name = path.stem
        listed = sound_cases(path, tell)
        if listed is None:
            continue
        place = np.searchsorted(wanted, listed).clip(max=max(len(wanted) - 1, 0))
        hit = wanted[place] == listed
        if not hit.any() or covered[place[hit]].all():
            continue
        if not folder.kept(name).is_file() and not hit.all():
            name, listed = _seal(folder, name, tell)
            if name == "":
                continue
            place = np.searchsorted(wanted, listed).clip(max=len(wanted) - 1)
            hit = wanted[place] == listed
            if not hit.any():
                continue
        covered[place[hit]] = True
        chunks[name] = len(listed)
    missing = np.sort(first[~covered])
    size = chunk_size(study, len(missing))
    for number in range(int(group.max()) + 1 if len(group) else 0):
        rows = missing[group[missing] == number]
        count = max(1, math.ceil(len(rows) / size))
        for part in np.array_split(rows, count):
            if len(part):
                told = options if isinstance(options, dict) else options[part[0]]
                chunks[write_list(folder, design, cases, part, told)] = len(part)
    data = {
        "key": plan_key(study),
        "solver_digest": solver_digest(),
        "study": study.name,
        "size": len(cases),
        "chunks": chunks,
    }
    _write_text(folder.plan_file, json.dumps(data))
    _write_text(folder.root / "study.yaml", study.merged(whole_paths=True))
    return Plan(study, folder, chunks, len(cases), design, cases)


def _write_text(path: Path, text: str) -> None:
    write_whole(path, lambda beside: Path(beside).write_text(text, encoding="utf-8"))


def read_parts(folder: StudyFolder, name: str, tell: Tell) -> list[store.Block]:
    """Finished blocks of an unfinished chunk; corrupt ones are named and removed."""
    blocks = []
    for path in sorted(folder.parts(name).glob("*.nc")):
        try:
            blocks.append(store.read(path))
        except store.CorruptFile as exc:
            tell(f"corrupt block of finished cases, they are solved again: {exc}")
            path.unlink(missing_ok=True)
    return blocks


def _relist(folder: StudyFolder, design: xr.Dataset, cases: np.ndarray, options: Any) -> None:
    """Case lists for solved chunks that have lost theirs, of the cases that are still wanted."""
    for path in sorted((folder.root / "store").glob("*.nc")):
        if folder.case_list(path.stem).is_file():
            continue
        with contextlib.suppress(store.CorruptFile):
            block = store.read(path)
            where = {case: i for i, case in enumerate(cases.tolist())}
            kept = np.array([i for i, case in enumerate(block.cases.tolist()) if case in where], dtype=int)
            if not len(kept):
                continue
            block = block.take(kept)
            rows = np.array([where[case] for case in block.cases.tolist()])
            told = options if isinstance(options, dict) else options[rows[0]]
            name = write_list(folder, design, cases, rows, told)
            if name != path.stem:
                keep(folder, name, block)
                path.unlink()
                folder.chunk(path.stem).unlink(missing_ok=True)


def _seal(folder: StudyFolder, name: str, tell: Tell) -> tuple[str, np.ndarray]:
    """Turn what is finished of a chunk that is no longer wanted whole into a chunk of its own."""
    blocks = read_parts(folder, name, tell)
    try:
        listed = load_list(folder, name)
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile, zlib.error):
        listed = None
    sealed = ("", np.empty(0, dtype="S32"))
    if blocks and listed is not None:
        block = store.concatenate(blocks)
        where = {case: i for i, case in enumerate(listed.cases.tolist())}
        rows = np.array([where[case] for case in block.cases.tolist()])
        new = chunk_name(block.cases)
        save_list(folder.case_list(new), block.cases, {k: v[rows] for k, v in listed.columns.items()}, listed.options)
        keep(folder, new, block)
        sealed = (new, block.cases)
    if sealed[0] != name:
        folder.case_list(name).unlink(missing_ok=True)
        shutil.rmtree(folder.parts(name), ignore_errors=True)
    return sealed


def keep(folder: StudyFolder, name: str, block: store.Block) -> None:
    """Store a finished chunk, under both its names."""
    store.write(folder.kept(name), block)
    link_or_copy(folder.kept(name), folder.chunk(name))
    shutil.rmtree(folder.parts(name), ignore_errors=True)
