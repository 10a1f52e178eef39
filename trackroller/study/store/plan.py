"""The plan of a study: which cases must be solved, in which chunks, and from which inputs.

Data goes one way. The design of a study is built and its cases are identified once; the inventory says which of them
are solved; the other cases go into chunks, each with a case list that is named by its content. Growing a study
therefore adds chunks and changes no finished one.

Every process that works from a plan holds the study's lock together with the others (`working_plan`). Only the sole
holder of the lock repairs the folder and may change the plan.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from trackroller.errors import InputError, WorkError
from trackroller.files import sha256, try_lock
from trackroller.methods import METHODS
from trackroller.numerics.numbers import all_equal
from trackroller.study.cost import study_rate
from trackroller.study.design.build import case_columns
from trackroller.study.design.growth import sample_of
from trackroller.study.design.levels import in_words
from trackroller.study.file.config import check_name
from trackroller.study.file.load import without_former
from trackroller.study.store import chunks, digests, ownership
from trackroller.study.store.folder import StudyFolder, Tell, unheard, wait_for_lock
from trackroller.study.store.identity import Cases, chunk_name, solver_and_materials
from trackroller.study.store.inputs import store_inputs
from trackroller.study.store.inventory import Inventory, forget_failed, take_inventory
from trackroller.study.store.ownership import MADE_BY
from trackroller.study.store.provenance import now
from trackroller.study.store.seal import discard
from trackroller.study.store.sources import solver_digest
from trackroller.yaml_file import parse_mapping

if TYPE_CHECKING:
    from trackroller.study.file.study import Study

SHORTEST, LONGEST = 8.0, 40.0  # seconds of solving a chunk: long beside the start of a job (1-2 s), short to lose
LARGEST_CHUNK = 20_000
MOST_LEVELS = 3  # that the words for a chunk list


@dataclass(frozen=True)
class Plan:
    """The chunks of a study, and which of them are open.

    Attributes
    ----------
    study : Study
        The study, with the size to which its sample has grown.
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
    cases : Cases
        The cases, which a process builds and identifies once.
    """

    study: Study
    folder: StudyFolder
    chunks: dict[str, int]
    size: int
    distinct: int
    uses: tuple[str, ...]
    cases: Cases

    @property
    def open(self) -> list[str]:
        """Return the names of the chunks that are not complete."""
        return [name for name in self.chunks if not self.folder.chunk(name).is_file()]


def study_folder(study_name: str, results: Path | str = "results") -> StudyFolder:
    """Return the folder in which a run of a study keeps its results."""
    return StudyFolder(Path(results) / check_name(study_name))


def locate(study: Study, folder: StudyFolder) -> tuple[xr.Dataset, Inventory, np.ndarray]:
    """Return a study's design, its solved cases, and the index of each case of the design there; -1 if not solved."""
    cases, inventory = Cases(study), take_inventory(folder)
    return cases.design, inventory, inventory.find(cases.fingerprints)


def chunk_size(study: Study, cases: int) -> int:
    """Return the number of cases of a chunk: some seconds of solving, and at least two chunks for two processors.

    A killed process loses the chunks that it works on, so a chunk of slow cases holds few of them.
    """
    if study.config.chunk_size:
        return study.config.chunk_size
    speed = study_rate(study)
    seconds = min(max(cases / speed / 16, SHORTEST), LONGEST)
    return max(1, min(round(speed * seconds), math.ceil(cases / 2), LARGEST_CHUNK))


def plan_key(study: Study) -> str:
    """Return the hash of everything that a plan depends on, found without drawing the design."""
    stated = [solver_and_materials(study.materials), study.merged(), *([study.grown] if study.grown else [])]
    if study.config.table is not None:
        stated.append(sha256(study.table_path))
    return hashlib.sha256(repr(stated).encode()).hexdigest()


def read_plan(study: Study, folder: StudyFolder) -> Plan | None:
    """Return the plan on the disk, or None if it is missing or was made for another version of the study."""
    return _recorded(study, folder, folder.record())


def _recorded(study: Study, folder: StudyFolder, record: Mapping[str, Any]) -> Plan | None:
    """Return the plan of a record, or None if the record was made for another version of the study."""
    if record.get("key") != plan_key(study):
        return None
    uses = tuple(record["uses"])
    return Plan(study, folder, record["chunks"], record["size"], record["distinct"], uses, Cases(study))


def sound_plan(study: Study, folder: StudyFolder, found: Inventory) -> tuple[Plan | None, list[str]]:
    """Return the plan on the disk if it accounts for every case, and a line on each damaged case list.

    Each case must be in a solved file or in the sound list of an open chunk, and no case of an open chunk may be solved
    already, as it is after a process was killed while it forgot failed cases.
    """
    plan = _recorded(study, folder, folder.record())
    if plan is None:
        return None, []
    sound, damaged = set(plan.uses) <= {path.name for path in found.paths}, []
    for name in plan.chunks:
        try:
            listed = chunks.check(folder.case_list(name))
            sound &= folder.chunk(name).is_file() or bool((found.find(listed) < 0).all())
        except (chunks.CorruptFile, FileNotFoundError) as exc:
            damaged.append(f"corrupt or missing case list, its cases are planned anew: {exc}")
    return (plan if sound and not damaged else None), damaged


def new_plan(study: Study, folder: StudyFolder, found: Inventory) -> Plan:
    """Return a plan of the cases that no file holds, and write its case lists."""
    cases = Cases(study)
    names, (options, group) = cases.fingerprints, cases.options
    wanted, first = np.unique(names, return_index=True)
    place = found.find(wanted)
    missing = np.sort(first[place < 0])
    size = chunk_size(study, len(missing))
    columns = {name: cases.design[name].values for name in case_columns(cases.design)}
    # a value that all cases share is written once
    shared = {name: values[:1].reshape(()) for name, values in columns.items() if all_equal(values)}
    fields = xr.Dataset({n: ((), shared[n]) if n in shared else ("case", v) for n, v in columns.items()})
    sizes: dict[str, int] = {}
    identity = solver_and_materials(study.materials)
    parts = [part for number in range(len(options)) for part in _split(missing[group[missing] == number], size)]
    for count, part in enumerate(parts, 1):
        name = chunk_name(names[part])
        # an index of all names would take 70 bytes a case
        block = fields.isel(case=part, missing_dims="ignore").assign_coords(case=names[part])
        words = ", ".join([f"chunk {count} of {len(parts)}", *_levels_of(study, part)])
        attrs = {"options": json.dumps(options[group[part[0]]]), "identity": identity, "words": words}
        chunks.write(folder.case_list(name), block.assign_attrs(attrs))
        sizes[name] = len(part)
    uses = sorted(found.paths[i].name for i in np.unique(found.states["file"].values[place[place >= 0]]))
    return Plan(study, folder, sizes, len(names), len(wanted), tuple(uses), cases)


def unused_cases(study: Study, folder: StudyFolder, found: Inventory, place: np.ndarray) -> str:
    """Say how many solved cases the design of a study does not hold, and why; '' if it holds all of them.

    Parameters
    ----------
    study : Study
        The study, whose design may differ from the one that was solved.
    folder : StudyFolder
        Its folder.
    found : Inventory
        Its solved cases.
    place : numpy.ndarray of int, shape (n,)
        Index of each case of the design in `found.states`; -1 for a case that is not solved.
    """
    solved = found.states.sizes["case"]
    if study.config.method.proposes or study.config.until is not None:  # each step is a design of its own
        return ""
    if not solved or folder.of_another_solver or not (unused := solved - len(np.unique(place[place >= 0]))):
        return ""
    before, remedy = folder.earlier(), "They stay in chunks/."
    earlier = before.get("factors", {})
    added = [name for name in study.config.factors if name not in earlier]
    why = f": {' and '.join(added)} became a factor" if earlier and added else ""
    if why and not study.config.method.crossed:
        remedy = (
            f"A {study.config.design} design with another factor is drawn anew. To keep both, give it another name."
        )
    elif why:
        remedy = "The old value of a new factor must be one of its levels to keep them."
    elif not _keeps_rows(study) and before.get("samples") != study.samples:
        why = f": {study.config.inner or study.config.design} draws each number of samples anew"
        remedy = "Design sobol keeps its rows when its samples grow."
    return f"{unused} solved cases of the earlier design are not in this one{why}. {remedy}"


def _keeps_rows(study: Study) -> bool:
    """Return whether a larger sample begins with the rows of a smaller one; True for a design without samples."""
    method = METHODS[study.config.inner or study.config.design]
    return method.grows or not method.sampled


def _split(rows: np.ndarray, size: int) -> list[np.ndarray]:
    """Return the rows in parts of at most `size` rows."""
    return np.array_split(rows, math.ceil(len(rows) / size)) if len(rows) else []


def _levels_of(study: Study, rows: np.ndarray) -> list[str]:
    """Return the levels of the cases of a chunk for each listed factor of which the chunk holds some levels only."""
    words = []
    for name, factor in study.drawn.factors.items():
        levels = list(dict.fromkeys(study.drawn.columns[name][rows].tolist())) if factor.discrete else []
        if not 0 < len(levels) < len(factor.levels):
            continue
        if factor.numeric and len(levels) > 1:
            words.append(f"{name} {in_words(name, min(levels))} to {in_words(name, max(levels))}")
        else:
            shown = ", ".join(in_words(name, level) for level in levels[:MOST_LEVELS])
            words.append(f"{name} {shown}" + ", ..." * (len(levels) > MOST_LEVELS))
    return words


def record_of(plan: Plan, inputs: Mapping[str, Any]) -> dict[str, Any]:
    """Return the record of a plan, which `read_plan` reads: what it was made from, and its chunks."""
    return {
        **MADE_BY,
        "key": plan_key(plan.study),
        "solver_digest": solver_digest(),
        "name": plan.study.name,
        "study": plan.study.merged(),
        "not_given": list(plan.study.not_given),
        "inputs": dict(inputs),
        "size": plan.size,
        "distinct": plan.distinct,
        "chunks": plan.chunks,
        "uses": list(plan.uses),
        **({"grown": list(plan.study.grown), "sample": sample_of(plan.study)} if plan.study.grown else {}),
    }


@contextlib.contextmanager
def working_plan(
    study: Study, results: Path | str = "results", *, tell: Tell = unheard, rerun_failed: bool = False
) -> Iterator[Plan]:
    """Plan a study and keep other processes from changing the plan.

    Parameters
    ----------
    study : Study
        The checked study.
    results : path
        Parent of the study's folder.
    tell : callable
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
        If the design holds an invalid case, the results folder cannot be a folder or is somebody else's, or a file of
        somebody else stands in the place of a result.
    WorkError
        If another process works on another version of the study, an input was edited after the study was loaded, or the
        folder cannot be written.
    """
    folder = study_folder(study.name, results).create()
    with open(folder.lock, "rb+") as lock:
        plan = _make_plan(study, folder, tell, rerun_failed) if try_lock(lock) else None
        wait_for_lock(lock, shared=True)
        if plan is None and not rerun_failed:  # another process has planned
            plan = read_plan(study, folder)
        if plan is None:
            raise WorkError(
                f"study '{study.name}': another process is solving it, from another version of the study file or "
                f"of the materials. Wait until that process ends, or stop it; then start again: {folder.root} keeps "
                "every finished case. To solve both versions at once, give this one another name."
            )
        yield plan


def _make_plan(study: Study, folder: StudyFolder, tell: Tell, rerun_failed: bool) -> Plan:
    """Remove damaged files, and plan anew unless the plan on the disk accounts for every case."""
    if folder.of_another_solver:
        tell(f"the solver's code has changed since {folder.root} was planned: all its cases are solved anew")
    _check_same_study(study, folder)
    for path in (folder.design, folder.gathered, folder.root / digests.METADATA):
        ownership.make_way(path, folder.root, lambda line: tell(f"{line}, and made anew"))
    inventory = _sound_inventory(folder, tell)
    if rerun_failed:
        tell(f"{forget_failed(folder, inventory)} failed cases are solved again")
        inventory = take_inventory(folder)
    plan, damaged = sound_plan(study, folder, inventory)
    for line in damaged:
        tell(line)
    if plan is None:
        plan = new_plan(study, folder, inventory)
        if inventory.paths and (
            unused := unused_cases(study, folder, inventory, inventory.find(plan.cases.fingerprints))
        ):
            tell(unused)
        discard(folder.design)
    _keep(plan, tell)
    return plan


def _check_same_study(study: Study, folder: StudyFolder) -> None:
    """Refuse the folder of another study that was given the name of this one; a study may have been renamed itself."""
    earlier, now = without_former(folder.earlier()), parse_mapping(study.merged(), "study file")
    other = earlier.get("name", study.name)
    if other != study.name and any(earlier.get(key) != now.get(key) for key in ("base", "factors")):
        remedy = "Give this study another name, choose another --results, or rename the folder."
        wrong = f"holds the study '{other}', which has other inputs"
        raise InputError("results folder", str(folder.root), "a folder of this study", remedy, wrong)


def _sound_inventory(folder: StudyFolder, tell: Tell) -> Inventory:
    """Return the solved cases after damaged files are moved away and temporary files are removed."""
    inventory = take_inventory(folder)
    for path, why in inventory.corrupt.items():
        kept = ownership.set_aside(folder.root, path)
        tell(f"corrupt results, their cases are solved again, and the file is kept as {kept}: {why}")
    ownership.sweep(folder.root)
    return inventory


def _keep(plan: Plan, tell: Tell) -> None:
    """Write the record of a plan after its inputs, and remove the files of earlier plans."""
    folder, earlier = plan.folder, plan.folder.record()
    record = record_of(plan, store_inputs(plan.study, folder))
    record["planned"] = earlier.get("planned", now()) if earlier.get("study") == record["study"] else now()
    if record != earlier:
        folder.write_record(record, tell)
    for path in folder.lock.parent.iterdir():
        of_chunk = path.suffix in (".nc", ".solved", ".lock") and not path.name.startswith(".")
        if of_chunk and path.stem not in plan.chunks:
            ownership.remove(path, folder.root)
    for name in plan.chunks:
        mark = folder.mark(name)
        ownership.make_way(mark, folder.root)
        if not folder.chunk(name).is_file():
            mark.unlink(missing_ok=True)
        elif not mark.is_file():  # a mark keeps its date, on which the workflow's rules depend
            mark.touch()
