"""The ledger of a study: which case is solved in which chunk, and which chunk is open.

Data goes one way. The design of a study is built and its cases are identified once; the files of
the chunks say which of them are solved; the other cases are planned: they go into new chunks, each
with a case list that is named by its content. Growing a study therefore adds chunks and changes no
finished one.

Every process that works from a ledger holds the study's lock together with the others
(`working_ledger`). Only the sole holder of the lock repairs the folder and may plan anew.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from trackroller.errors import InputError, WorkError
from trackroller.files import sha256, try_lock, wait_for_lock
from trackroller.methods import METHODS
from trackroller.numerics.numbers import all_equal
from trackroller.study.cost import study_rate
from trackroller.study.design.build import case_columns
from trackroller.study.design.growth import sample_of
from trackroller.study.design.levels import in_words
from trackroller.study.file.config import check_name
from trackroller.study.store import chunks
from trackroller.study.store.crate_entries import CRATE
from trackroller.study.store.fingerprint import StudyCases, chunk_name, solver_and_materials
from trackroller.study.store.folder import StudyFolder, Tell, unheard
from trackroller.study.store.input_files import store_inputs
from trackroller.study.store.manifest import Manifest
from trackroller.study.store.program_digest import solver_digest
from trackroller.study.store.provenance import now
from trackroller.study.store.put import sweep
from trackroller.yaml_file import parse_mapping

if TYPE_CHECKING:
    from trackroller.study.file.study import Study

# seconds of solving a chunk: long beside the start of a job (1-2 s), short to lose
SHORTEST, LONGEST = 8.0, 40.0
LARGEST_CHUNK = 20_000
MOST_LEVELS = 3  # that the words for a chunk list


@dataclass(frozen=True)
class Ledger:
    """Which case of a study is solved in which chunk, and which chunk is open.

    The files of the solved chunks are read when a caller first asks for a solved case; `anew` reads
    them again.

    Attributes
    ----------
    cases : StudyCases
        The cases of the study, which a process builds and identifies once.
    folder : StudyFolder
        Files of the study.
    chunks : dict
        Number of cases by the name of each planned chunk, in the order of the design.
    size : int
        Number of cases of the planned design.
    distinct : int
        Number of different cases among these.
    uses : tuple of str
        Names of the files that hold the cases which are in no planned chunk.
    """

    cases: StudyCases
    folder: StudyFolder
    chunks: dict[str, int] = field(default_factory=dict)
    size: int = 0
    distinct: int = 0
    uses: tuple[str, ...] = ()

    @property
    def study(self) -> Study:
        """Return the study, with the size to which its sample has grown."""
        return self.cases.study

    @property
    def open(self) -> list[str]:
        """Return the names of the chunks that are not complete."""
        return [name for name in self.chunks if not self.folder.chunk(name).is_file()]

    def anew(self) -> Ledger:
        """Return the ledger without what was read, so that it reads the files as they are now."""
        return replace(self)

    @cached_property
    def _read(self) -> tuple[xr.Dataset, list[Path], dict[Path, str]]:
        """Read every file with solved cases and verify its checksum; return `states`, `paths` and
        `corrupt`.
        """
        corrupt: dict[Path, str] = {}
        sound = list(chunks.read_sound(self.folder.solved_files(), corrupt, chunks.read_state))
        none = chunks.failure(np.empty(0, dtype="S32"), "")[["regime", "reason"]]
        numbered = [none.assign(file=("case", np.empty(0, int)), row=("case", np.empty(0, int)))]
        for number, (_, state) in enumerate(sound):
            rows = np.arange(state.sizes["case"])
            numbered.append(
                state.assign(file=("case", np.full(len(rows), number)), row=("case", rows))
            )
        every = chunks.join(numbered)
        _, first = np.unique(every["case"].values, return_index=True)
        return every.isel(case=first), [path for path, _ in sound], corrupt

    @property
    def states(self) -> xr.Dataset:
        """Return the solved cases of the folder, each once, also those of earlier designs.

        `regime` (code of `REGIMES`), `reason` of a failure, `file` (index into `paths`) and `row`
        in that file, along `case` in ascending order of the fingerprints; the attribute `seconds`
        is the time spent on solving [s].
        """
        return self._read[0]

    @property
    def paths(self) -> list[Path]:
        """Return the sound files with solved cases."""
        return self._read[1]

    @property
    def corrupt(self) -> dict[Path, str]:
        """Return the damaged files, and what is wrong with each."""
        return self._read[2]

    @property
    def hours(self) -> float:
        """Return the hours that all runs together spent on solving."""
        return float(self.states.attrs["seconds"]) / 3600

    def find(self, fingerprints: np.ndarray) -> np.ndarray:
        """Return the index of each wanted case in `states`, shape (n,); -1 marks a case that is not
        solved.
        """
        cases = self.states["case"].values
        number = np.searchsorted(cases, fingerprints)
        return np.where(np.append(cases, b"")[number] == fingerprints, number, -1)

    @cached_property
    def state_number(self) -> np.ndarray:
        """Return the index of each case of the design in `states`, shape (n,); -1 marks a case that
        is not solved.
        """
        return self.find(self.cases.fingerprints)

    def forget_failed(self) -> int:
        """Remove the failed cases from the files, so that they are planned again; return their
        number.

        A file without its failed cases gets another name, because its name is the hash of its
        cases.
        """
        failed = self.states["file"].values[self.states["regime"].values == chunks.FAILED]
        for number in np.unique(failed):
            block = chunks.read(self.paths[number])
            solved = block.isel(case=(block["regime"] != chunks.FAILED).values)
            if solved.sizes["case"]:
                chunks.write(
                    self.folder.chunk(chunk_name(solved["case"].values)), solved, packed=True
                )
            Manifest(self.folder.root).unlink([self.paths[number]])
        return len(failed)


def study_folder(study_name: str, results: Path | str = "results") -> StudyFolder:
    """Return the folder in which a run of a study keeps its results."""
    return StudyFolder(Path(results) / check_name(study_name))


def chunk_size(study: Study, cases: int) -> int:
    """Return the number of cases of a chunk: some seconds of solving, and at least two chunks for
    two processors.

    A killed process loses the chunks that it works on, so a chunk of slow cases holds few of them.
    """
    if study.config.chunk_size:
        return study.config.chunk_size
    speed = study_rate(study)
    seconds = min(max(cases / speed / 16, SHORTEST), LONGEST)
    return max(1, min(round(speed * seconds), math.ceil(cases / 2), LARGEST_CHUNK))


def plan_key(study: Study) -> str:
    """Return the hash of everything that a plan depends on, found without drawing the design."""
    stated = [
        solver_and_materials(study.materials),
        study.merged(),
        *([study.grown] if study.grown else []),
    ]
    if study.config.table is not None:
        stated.append(sha256(study.table_path))
    return hashlib.sha256(repr(stated).encode()).hexdigest()


def read_ledger(study: Study, folder: StudyFolder) -> Ledger | None:
    """Return the ledger on the disk, or None if it is missing or was made for another version of
    the study.
    """
    record = folder.record()
    if record.get("key") != plan_key(study):
        return None
    return Ledger(
        StudyCases(study),
        folder,
        record["chunks"],
        record["size"],
        record["distinct"],
        tuple(record["uses"]),
    )


def sound_ledger(files: Ledger) -> tuple[Ledger | None, list[str]]:
    """Return the ledger on the disk if it accounts for every case, and a line on each damaged case
    list.

    Each case must be in a solved file or in the sound list of an open chunk, and no case of an open
    chunk may be solved already, as it is after a process was killed while it forgot failed cases.
    """
    folder = files.folder
    ledger = read_ledger(files.study, files.folder)
    if ledger is None:
        return None, []
    sound = set(ledger.uses) <= {path.name for path in files.paths}
    damaged = []
    for name in ledger.chunks:
        try:
            fingerprints = chunks.check(folder.case_list(name))
            sound &= folder.chunk(name).is_file() or bool((files.find(fingerprints) < 0).all())
        except (chunks.CorruptFile, FileNotFoundError) as exc:
            damaged.append(f"corrupt or missing case list, its cases are planned anew: {exc}")
    if not sound or damaged:
        return None, damaged
    return ledger, []


def planned(files: Ledger) -> Ledger:
    """Return the ledger in which each case that no file holds has a chunk, and write the case lists
    of these chunks.
    """
    study = files.study
    folder = files.folder
    cases = files.cases
    names = cases.fingerprints
    options, group = cases.options
    distinct, first = np.unique(names, return_index=True)
    state_number = files.find(distinct)
    missing = np.sort(first[state_number < 0])
    size = chunk_size(study, len(missing))
    columns = {name: cases.design[name].values for name in case_columns(cases.design)}
    # a value that all cases share is written once
    shared = {name: values[:1].reshape(()) for name, values in columns.items() if all_equal(values)}
    fields = xr.Dataset({name: ("case", values) for name, values in columns.items()})
    fields = fields.assign({name: ((), value) for name, value in shared.items()})
    sizes: dict[str, int] = {}
    identity = solver_and_materials(study.materials)
    parts = [
        part
        for number in range(len(options))
        for part in _split(missing[group[missing] == number], size)
    ]
    for count, part in enumerate(parts, 1):
        name = chunk_name(names[part])
        # an index of all names would take 70 bytes a case
        block = fields.isel(case=part, missing_dims="ignore").assign_coords(case=names[part])
        words = ", ".join([f"chunk {count} of {len(parts)}", *_levels_of(study, cases.rows[part])])
        attrs = {
            "options": json.dumps(options[group[part[0]]]),
            "identity": identity,
            "words": words,
        }
        chunks.write(folder.case_list(name), block.assign_attrs(attrs))
        sizes[name] = len(part)
    uses = sorted(
        files.paths[i].name
        for i in np.unique(files.states["file"].values[state_number[state_number >= 0]])
    )
    return replace(files, chunks=sizes, size=len(names), distinct=len(distinct), uses=tuple(uses))


def unused_cases(ledger: Ledger) -> str:
    """Say how many solved cases the design of a study does not hold, and why; '' if it holds all of
    them.

    Parameters
    ----------
    ledger : Ledger
        The ledger of the study, whose design may differ from the one that was solved.
    """
    study = ledger.study
    folder = ledger.folder
    solved = ledger.states.sizes["case"]
    state_number = ledger.state_number
    # each step is a design of its own
    if study.config.method.proposes or study.config.until is not None:
        return ""
    unused = solved - len(np.unique(state_number[state_number >= 0]))
    if not unused or folder.of_another_solver:
        return ""
    before = folder.earlier()
    remedy = "They stay in chunks/."
    earlier = before.get("factors", {})
    added = [name for name in study.config.factors if name not in earlier]
    why = ""
    if earlier and added:
        why = f": {' and '.join(added)} became a factor"
    if why and not study.config.method.crossed:
        remedy = (
            f"A {study.config.method_name} design with another factor is drawn anew. To keep "
            "both, give it another name."
        )
    elif why:
        remedy = "The old value of a new factor must be one of its levels to keep them."
    elif not _keeps_rows(study) and before.get("samples") != study.samples:
        method = study.config.inner or study.config.method_name
        why = f": {method} draws each number of samples anew"
        remedy = "Design sobol keeps its rows when its samples grow."
    return f"{unused} solved cases of the earlier design are not in this one{why}. {remedy}"


def _keeps_rows(study: Study) -> bool:
    """Return whether a larger sample begins with the rows of a smaller one; True for a design
    without samples.
    """
    method = METHODS[study.config.inner or study.config.method_name]
    return method.grows or not method.sampled


def _split(rows: np.ndarray, size: int) -> list[np.ndarray]:
    """Return the rows in parts of at most `size` rows."""
    if len(rows):
        return np.array_split(rows, math.ceil(len(rows) / size))
    return []


def _levels_of(study: Study, rows: np.ndarray) -> list[str]:
    """Return the levels of the cases of a chunk for each listed factor of which the chunk holds
    some levels only.
    """
    words = []
    for name, factor in study.drawn.factors.items():
        levels = []
        if factor.discrete:
            levels = list(dict.fromkeys(study.drawn.columns[name][rows].tolist()))
        if not 0 < len(levels) < len(factor.levels):
            continue
        if factor.numeric and len(levels) > 1:
            words.append(f"{name} {in_words(name, min(levels))} to {in_words(name, max(levels))}")
        else:
            shown = [in_words(name, level) for level in levels[:MOST_LEVELS]]
            if len(levels) > MOST_LEVELS:
                shown.append("...")
            words.append(f"{name} {', '.join(shown)}")
    return words


def record_of(ledger: Ledger, inputs: Mapping[str, Any]) -> dict[str, Any]:
    """Return the record of a ledger, which `read_ledger` reads: what it was made from, and its
    chunks.
    """
    return {
        "key": plan_key(ledger.study),
        "solver_digest": solver_digest(),
        "name": ledger.study.name,
        "study": ledger.study.merged(),
        "not_given": list(ledger.study.not_given),
        "inputs": dict(inputs),
        "size": ledger.size,
        "distinct": ledger.distinct,
        "chunks": ledger.chunks,
        "uses": list(ledger.uses),
        **(
            {"grown": list(ledger.study.grown), "sample": sample_of(ledger.study)}
            if ledger.study.grown
            else {}
        ),
    }


@contextlib.contextmanager
def working_ledger(
    study: Study,
    results: Path | str = "results",
    *,
    tell: Tell = unheard,
    rerun_failed: bool = False,
) -> Iterator[Ledger]:
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
    Ledger
        The ledger, whose chunks stay as they are until the context ends.

    Raises
    ------
    InputError
        If the design holds an invalid case, the results folder cannot be a folder or is somebody
        else's, or a file of somebody else stands in the place of a result.
    WorkError
        If another process works on another version of the study, an input was edited after the
        study was loaded, or the folder cannot be written.
    """
    folder = study_folder(study.name, results).create()
    with open(folder.lock, "rb+") as lock:
        ledger = None
        if try_lock(lock):
            ledger = _plan(study, folder, tell, rerun_failed)
        wait_for_lock(lock, shared=True)
        if ledger is None and not rerun_failed:  # another process has planned
            ledger = read_ledger(study, folder)
        if ledger is None:
            raise _in_use(study, folder, rerun_failed)
        yield ledger


def _in_use(study: Study, folder: StudyFolder, rerun_failed: bool) -> WorkError:
    """Return the error for a folder that another process holds, so that this one can neither plan
    nor join in.
    """
    wait = (
        f"Wait until that process ends, or stop it; then start again: {folder.root} keeps "
        "every finished case."
    )
    if rerun_failed:
        why = "and failed cases are not removed under it"
        return WorkError(f"study '{study.name}': another process is solving it, {why}. {wait}")
    why = "from another version of the study file or of the materials"
    both = "To solve both versions at once, give this one another name."
    return WorkError(f"study '{study.name}': another process is solving it, {why}. {wait} {both}")


def _plan(study: Study, folder: StudyFolder, tell: Tell, rerun_failed: bool) -> Ledger:
    """Remove damaged files, and plan anew unless the ledger on the disk accounts for every case."""
    if folder.of_another_solver:
        tell(
            f"the solver's code has changed since {folder.root} was planned: all its cases are "
            "solved anew"
        )
    _check_same_study(study, folder)
    files = Ledger(StudyCases(study), folder)
    _check_files(files)
    sweep(folder.root)
    if rerun_failed:
        tell(f"{files.forget_failed()} failed cases are solved again")
        files = files.anew()
    ledger, damaged = sound_ledger(files)
    for line in damaged:
        tell(line)
    if ledger is None:
        ledger = planned(files)
        unused = ""
        if files.paths:
            unused = unused_cases(files)
        if unused:
            tell(unused)
        Manifest(folder.root).discard(folder.design)
    _keep(ledger)
    return ledger.anew()


def _check_same_study(study: Study, folder: StudyFolder) -> None:
    """Refuse the folder of another study that was given the name of this one; a study may have been
    renamed itself.
    """
    earlier = folder.earlier()
    now = parse_mapping(study.merged(), "study file")
    other = earlier.get("name", study.name)
    if other != study.name and any(earlier.get(key) != now.get(key) for key in ("base", "factors")):
        remedy = "Give this study another name, choose another --results, or rename the folder."
        wrong = f"holds the study '{other}', which has other inputs"
        raise InputError(
            "results folder", str(folder.root), "a folder of this study", remedy, wrong
        )


def _check_files(files: Ledger) -> None:
    """Refuse damaged files of solved or planned cases, and what stands in the place of a result."""
    folder = files.folder
    manifest = Manifest(folder.root)
    results = [folder.design, folder.gathered, folder.root / CRATE]
    results += [folder.root / name for name in manifest.current(folder.inputs)]
    lists = [folder.case_list(name) for name in folder.record().get("chunks", {})]
    manifest.check(*results, *lists, damaged=files.corrupt)


def _keep(ledger: Ledger) -> None:
    """Write the record of a ledger after its inputs, and remove the files of earlier plans."""
    folder = ledger.folder
    manifest = Manifest(folder.root)
    earlier = folder.record()
    record = record_of(ledger, store_inputs(ledger.study, folder, ledger.cases.design))
    if earlier.get("study") == record["study"]:
        record["planned"] = earlier.get("planned", now())
    else:
        record["planned"] = now()
    if record != earlier:
        folder.write_record(record)
    for path in folder.lock.parent.iterdir():
        of_chunk = path.suffix in (".nc", ".solved", ".lock") and not path.name.startswith(".")
        if of_chunk and path.stem not in ledger.chunks:
            manifest.unlink([path])
    for name in ledger.chunks:
        mark = folder.mark(name)
        if not folder.chunk(name).is_file():
            manifest.unlink([mark])
        elif not mark.is_file():  # a mark keeps its date, on which the workflow's rules depend
            mark.touch()
