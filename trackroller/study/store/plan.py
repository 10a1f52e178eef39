"""Plan which cases of a study must be solved, and in which chunks.

A case that any file of the study holds is never planned again. The other cases go into chunks, each with a case
list under `plan/` that is named by its content. Growing a study therefore adds chunks and changes no finished one.
A lock protects the plan: every process that works from it holds the lock together with the others, and only its
sole holder may change the plan.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from trackroller.errors import InputError, WorkError
from trackroller.files import sha256, write_text
from trackroller.numerics.numbers import all_equal
from trackroller.roller.case import to_table
from trackroller.roller.options import options_of_cases
from trackroller.study.cost import study_rate
from trackroller.study.design.build import case_columns
from trackroller.study.design.growth import with_history
from trackroller.study.file.config import check_name
from trackroller.study.store import chunks
from trackroller.study.store.folder import StudyFolder, Tell, matches_checksum, sweep, try_lock, wait_for_lock
from trackroller.study.store.identity import chunk_name, fingerprints
from trackroller.study.store.inventory import Inventory, check_default_model, forget_failed, take_inventory
from trackroller.study.store.sources import solver_digest

if TYPE_CHECKING:
    from trackroller.study.file.study import Study

SHORTEST, LONGEST = 8.0, 40.0  # seconds of solving a chunk: the start of a job (1-2 s) must remain a small part
MOST_CHUNKS = 400
SMALLEST_CHUNK = 100
LARGEST_CHUNK = 20_000


@dataclass(frozen=True)
class Plan:
    """Chunks of a study.

    Attributes
    ----------
    study : Study
        The study; a grown Latin hypercube knows its earlier sizes.
    folder : StudyFolder
        Files of the study.
    chunks : dict
        Number of cases by the name of the chunk, in the order of the design.
    size : int
        Number of cases of the design.
    distinct : int
        Number of different cases among these.
    uses : tuple of str
        Names of the files that hold the cases which are in no chunk of this plan.
    """

    study: Study
    folder: StudyFolder
    chunks: dict[str, int]
    size: int
    distinct: int
    uses: tuple[str, ...] = ()

    @property
    def open(self) -> list[str]:
        """Return the names of the chunks that are not complete."""
        return [name for name in self.chunks if not self.folder.chunk(name).is_file()]


def study_folder(study_name: str, results: Path | str = "results") -> StudyFolder:
    """Return the folder of a study's results."""
    return StudyFolder(Path(results) / check_name(study_name))


def identify(study: Study, design: xr.Dataset) -> np.ndarray:
    """Return the fingerprint of each case of a design, dtype S32, shape (n,).

    Raises
    ------
    InputError
        If a case of the design is not valid.
    """
    options, group = options_of_cases(design, {})
    table = to_table(design.drop_vars(list(design.coords)), study.materials)
    return fingerprints(table, *options, group=group)


def locate(study: Study, folder: StudyFolder) -> tuple[xr.Dataset, Inventory, np.ndarray]:
    """Return a study's design, its solved cases, and the index of each case of the design there; -1 if not solved."""
    design, found = study.design(), take_inventory(folder)
    return design, found, found.find(identify(study, design))


def chunk_size(study: Study, cases: int) -> int:
    """Return the number of cases of a chunk: some seconds of solving, and at least two chunks for two processors."""
    if study.config.chunk_size:
        return study.config.chunk_size
    speed = study_rate(study)
    wanted = math.ceil(speed * min(max(cases / speed / 16, SHORTEST), LONGEST))
    wanted = max(min(wanted, math.ceil(cases / 2)), SMALLEST_CHUNK, math.ceil(cases / MOST_CHUNKS))
    return min(wanted, LARGEST_CHUNK)


def plan_key(study: Study) -> str:
    """Return the hash of everything that a plan depends on, found without drawing the design."""
    friction = sorted((sorted(pair), levels) for pair, levels in study.materials.friction_table.items())
    told = [solver_digest(), study.merged(), sorted(study.materials.materials.items()), friction]
    if study.config.table is not None:
        told.append(sha256(study.table_path))
    return hashlib.sha256(repr(told).encode()).hexdigest()


@contextlib.contextmanager
def working_plan(
    study: Study, results: Path | str = "results", *, tell: Tell | None = None, rerun_failed: bool = False
) -> Iterator[Plan]:
    """Plan a study and keep other processes from changing the plan.

    Parameters
    ----------
    study : Study
        The checked study.
    results : path
        Parent of the study's folder.
    tell : callable, optional
        Receives one line for each event that the user should read, such as a damaged file.
    rerun_failed : bool
        Remove the failed cases, so that they are solved again.

    Yields
    ------
    Plan
        The plan, which stays as it is until the context ends.

    Raises
    ------
    InputError
        If the design holds an invalid case, the results folder cannot be a folder, or it holds results of an earlier
        default contact model.
    WorkError
        If another process works on another version of the study, or the folder cannot be written.
    """
    tell = tell or (lambda line: None)
    folder = study_folder(study.name, results)
    check_default_model(study, folder)
    folder.create()
    with open(folder.lock, "rb+") as lock:
        if alone := try_lock(lock):
            _repair_and_plan(study, folder, tell, rerun_failed)
        wait_for_lock(lock, shared=True)
        plan = read_plan(study, folder)
        if plan is None or (rerun_failed and not alone):
            raise WorkError(
                f"study '{study.name}': another process is solving it, from another version of the study file or "
                f"of the materials. Wait until that process ends, or stop it; then start again: {folder.root} keeps "
                "every finished case. To solve both versions at once, give this one another name."
            )
        yield plan


def read_plan(study: Study, folder: StudyFolder) -> Plan | None:
    """Return the plan on the disk, or None if it is missing or was made for another version of the study."""
    study, data = with_history(study, folder), _written(folder)
    if data.get("key") != plan_key(study):
        return None
    try:
        return Plan(study, folder, data["chunks"], data["size"], data["distinct"], tuple(data["uses"]))
    except (KeyError, TypeError):
        return None


def _written(folder: StudyFolder) -> dict[str, Any]:
    """Return the content of the plan file; {} if the file is missing or cannot be read."""
    try:
        return dict(json.loads(folder.plan_file.read_text()))
    except (OSError, ValueError, TypeError):
        return {}


def _repair_and_plan(study: Study, folder: StudyFolder, tell: Tell, rerun_failed: bool) -> None:
    """Remove damaged files, and plan anew unless the plan on the disk accounts for every case."""
    if _written(folder).get("solver_digest", solver_digest()) != solver_digest():
        tell(f"the solver's code has changed since {folder.root} was planned: all its cases are solved anew")
    for path in (folder.design, folder.gathered):
        if path.is_dir():
            raise InputError(path.name, str(path), "a file; this is a folder", "Move the folder away.")
        if path.exists() and not matches_checksum(folder, path):
            tell(f"{path} is truncated or was altered (its checksum differs): it is made anew")
            path.unlink()
    found = take_inventory(folder)
    chunks.remove_corrupt(found.corrupt, tell)
    sweep(folder)
    if rerun_failed:
        tell(f"{forget_failed(folder, found)} failed cases are solved again")
        found = take_inventory(folder)
    plan = read_plan(study, folder)
    if plan is None or not _is_complete(plan, found, tell):
        plan = _new_plan(with_history(study, folder), folder, found, tell)
    for name in plan.chunks:
        if not folder.chunk(name).is_file():
            folder.mark(name).unlink(missing_ok=True)
        elif not folder.mark(name).is_file():
            folder.mark(name).touch()


def _is_complete(plan: Plan, found: Inventory, tell: Tell) -> bool:
    """Return whether each case of a plan is in a solved file or in a sound case list."""
    sound = set(plan.uses) <= {path.name for path in found.paths}
    for name in plan.chunks:
        try:
            chunks.check(plan.folder.case_list(name))
        except (chunks.CorruptFile, FileNotFoundError) as exc:
            tell(f"corrupt or missing case list, its cases are planned anew: {exc}")
            sound = False
    return sound


def _new_plan(study: Study, folder: StudyFolder, found: Inventory, tell: Tell) -> Plan:
    """Plan the cases that no file holds; the plan file is written last."""
    if study.config.grown_from:
        tell(f"the sample grows from {study.config.grown_from[-1]} to {study.config.samples}: its first cases stay")
    design = study.design()
    cases = identify(study, design)
    options, group = options_of_cases(design, {})
    wanted, first = np.unique(cases, return_index=True)
    place = found.find(wanted)
    missing = np.sort(first[place < 0])
    size = chunk_size(study, len(missing))
    fields = design.drop_vars(list(design.coords))[list(case_columns(design))].drop_attrs()
    # a value that all cases share is written once
    fields = fields.map(lambda column: column[0] if all_equal(column.values) else column).assign_coords(case=cases)
    sizes: dict[str, int] = {}
    for number, told in enumerate(options):
        rows = missing[group[missing] == number]
        for part in np.array_split(rows, max(1, math.ceil(len(rows) / size))):
            if len(part):
                name = chunk_name(cases[part])
                chunks.write(folder.case_list(name), fields.isel(case=part).assign_attrs(options=json.dumps(told)))
                sizes[name] = len(part)
    uses = sorted(found.paths[i].name for i in np.unique(found.states["file"].values[place[place >= 0]]))
    folder.design.unlink(missing_ok=True)
    write_text(folder.study_file, study.merged(whole_paths=True))
    data: dict[str, Any] = {"key": plan_key(study), "solver_digest": solver_digest(), "study": study.name}
    data |= {"size": len(cases), "distinct": len(wanted), "chunks": sizes, "uses": uses}
    write_text(folder.plan_file, json.dumps(data))
    for path in folder.lock.parent.iterdir():  # *.npz: lists of earlier versions of the program
        if path.suffix in (".nc", ".npz", ".solved") and path.stem not in sizes:
            path.unlink(missing_ok=True)
    return Plan(study, folder, sizes, len(cases), len(wanted), tuple(uses))
