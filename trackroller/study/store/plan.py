"""The plan of a study: which cases must be solved, in which chunks, and from which inputs.

Data goes one way. The design of a study is built and its cases are identified once; the inventory says which of them
are solved; the other cases go into chunks, each with a case list that is named by its content. Growing a study
therefore adds chunks and changes no finished one.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from trackroller.files import sha256
from trackroller.methods import METHODS
from trackroller.numerics.numbers import all_equal
from trackroller.study.cost import study_rate
from trackroller.study.design.build import case_columns
from trackroller.study.design.growth import sample_of
from trackroller.study.design.levels import in_words
from trackroller.study.file.config import check_name
from trackroller.study.store import chunks
from trackroller.study.store.folder import StudyFolder
from trackroller.study.store.identity import Cases, chunk_name, solver_and_materials
from trackroller.study.store.inventory import Inventory, take_inventory
from trackroller.study.store.ownership import MADE_BY
from trackroller.study.store.sources import solver_digest

if TYPE_CHECKING:
    from trackroller.study.file.study import Study

SHORTEST, LONGEST = 8.0, 40.0  # seconds of solving a chunk: long beside the start of a job (1-2 s), short to lose
LARGEST_CHUNK = 20_000
MOST_LEVELS = 3  # that the words for a chunk list


@dataclass(frozen=True)
class Plan:
    """Chunks of a study.

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
