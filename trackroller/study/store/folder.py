"""Name the files of a study, lock them, and keep the record of what was planned."""

from __future__ import annotations

import contextlib
import errno
import json
import os
import time
import warnings
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import IO, Any

from trackroller.errors import InputError
from trackroller.files import check_utf_8, disk_error, open_here, try_lock, why_not
from trackroller.study.store import digests, ownership
from trackroller.study.store.digests import record_digest
from trackroller.study.store.ownership import MADE_BY
from trackroller.study.store.seal import is_sealed, read_result
from trackroller.study.store.sources import solver_digest
from trackroller.yaml_file import parse_mapping

Tell = Callable[[str], None]
Count = Callable[[int, int], None]
STORE_FORMAT = 1  # raise it when a file of the store gets another meaning; other formats are refused by name
NO_FOLDER = (errno.ENOTDIR, errno.EEXIST, errno.ENAMETOOLONG, errno.ELOOP)


def unheard(*facts: object) -> None:
    """Take what a run tells or counts where nobody listens."""


class StudyFolder:
    """Paths of the files of one study, `results/NAME/`; a folder that was renamed is the same study.

    Attributes
    ----------
    root : pathlib.Path
        The folder, which may be a link.
    design, gathered : pathlib.Path
        The cases of the study, and its gathered results.
    inputs, study_file : pathlib.Path
        Folder with the files that the study was made from, and the study file in it, with every default written out.
    plan_file : pathlib.Path
        The record of the plan: its chunks, and the study and inputs that it was made from. It marks the folder as ours.
    lock : pathlib.Path
        Lock that processes share while they work from the plan; only its sole holder may change the plan.
    """

    def __init__(self, root: Path) -> None:
        self.root = root
        self.design, self.gathered = root / "design.nc", root / "study.nc"
        self.inputs, self.plan_file = root / "inputs", root / "plan.json"
        self.study_file = self.inputs / "study.yaml"
        self.lock = root / "plan" / ".lock"

    def case_list(self, chunk: str) -> Path:
        """Return the cases of a chunk."""
        return self.root / "plan" / f"{chunk}.nc"

    def chunk_lock(self, chunk: str) -> Path:
        """Return the empty file that a process locks while it solves a chunk."""
        return self.root / "plan" / f"{chunk}.lock"

    def mark(self, chunk: str) -> Path:
        """Return the empty file by which the workflow knows that a chunk is solved. It may be deleted at any time."""
        return self.root / "plan" / f"{chunk}.solved"

    def chunk(self, chunk: str) -> Path:
        """Return the results of a solved chunk."""
        return self.root / "chunks" / f"{chunk}.nc"

    def solved_files(self) -> list[Path]:
        """Return the files with results of solved cases; files with names that no chunk has do not count."""
        paths = sorted((self.root / "chunks").glob("*.nc"))
        return [path for path in paths if ownership.CASES.fullmatch(f"chunks/{path.name}") and path.is_file()]

    def lost_files(self) -> list[Path]:
        """Return the files with solved cases that the plan counts on and that are gone."""
        record = self.record()
        solved = [name for name in record.get("chunks", {}) if self.mark(name).is_file()]
        paths = [*map(self.chunk, solved), *(self.root / "chunks" / name for name in record.get("uses", ()))]
        return [path for path in paths if not path.is_file()]

    def create(self) -> StudyFolder:
        """Create the folders of the study and mark them as ours.

        Returns
        -------
        StudyFolder
            This folder.

        Raises
        ------
        InputError
            If the path exists and is not a folder, or the folder is somebody else's or holds a link.
        WorkError
            If the folder cannot be written.
        """
        check_utf_8(self.root.absolute(), "results folder")
        ownership.check(self.root)
        try:
            for name in ("plan", "chunks"):
                (self.root / name).mkdir(parents=True, exist_ok=True)
            with open_here(self.lock, "a"):
                pass
        except OSError as exc:
            if exc.errno in NO_FOLDER:
                wrong = f"cannot be a folder ({why_not(exc, self.root)})"
                remedy = "Choose another with --results."
                raise InputError("results folder", str(self.root), "the path of a folder", remedy, wrong) from None
            raise disk_error(exc, self.root) from None
        self._mark()
        return self

    def _mark(self) -> None:
        """Write the mark of a new folder; give a folder of an earlier version its mark and records.

        Only the sole holder of the lock does so, unless a process of an earlier version holds it.
        """
        for _ in range(100):
            known = digests.mark(self.root)
            if MADE_BY.items() <= known.items():
                return
            with open(self.lock, "rb+") as lock:
                if not try_lock(lock):
                    time.sleep(0.05)
                    continue
                ownership.adopt(self.root)
                if known.get("store_format") == STORE_FORMAT:
                    self.write_record({key: value for key, value in known.items() if key != "store_format"})
                elif not os.path.lexists(self.plan_file):
                    self.write_record({})
                return

    def record(self) -> dict[str, Any]:
        """Return the record of the plan; {} if there is none, it was altered, or its format is not this version's."""
        record = digests.mark(self.root)
        return record if record.pop("store_format", None) == STORE_FORMAT else {}

    @property
    def of_another_solver(self) -> bool:
        """Return whether the study was planned with another version of the solver."""
        return bool(self.record().get("solver_digest", solver_digest()) != solver_digest())

    def earlier(self) -> dict[str, Any]:
        """Return the study as it was planned or gathered last, {} if neither record is sound."""
        text = self.record().get("study")
        if text is None and self.gathered.is_file() and is_sealed(self.gathered):
            text = read_result(self.gathered).attrs.get("study")
        return {} if text is None else parse_mapping(text, str(self.plan_file))

    def write_record(self, record: Mapping[str, Any], tell: Tell = warnings.warn) -> None:
        """Write the record of the plan with its digest, and the mark that the folder is ours."""
        stored = {"store_format": STORE_FORMAT, **MADE_BY, **record}
        text = json.dumps({**stored, "digest": record_digest(stored)}) + "\n"
        ownership.write(self.plan_file, lambda beside: beside.write_text(text, encoding="utf-8", newline="\n"), tell)


def wait_for_lock(stream: IO[bytes], shared: bool = False, tell: Tell | None = None) -> None:
    """Wait until `try_lock` succeeds; call `tell` once if another process holds the lock."""
    if try_lock(stream, shared):
        return
    if tell is not None:
        tell(f"{Path(stream.name).stem.lstrip('.')}: another process works on this, waiting for it")
    while not try_lock(stream, shared):
        time.sleep(0.05)


@contextlib.contextmanager
def locked(path: Path, shared: bool = False, tell: Tell | None = None) -> Iterator[None]:
    """Hold the lock of an empty file; the system releases the lock when the process ends, however it ends.

    A file with content is never locked: on Windows a lock keeps every reader out, even the process that holds it.
    """
    with open_here(path, "ab") as stream:
        wait_for_lock(stream, shared, tell)
        yield


@contextlib.contextmanager
def reporting(folder: StudyFolder, tell: Tell | None = None) -> Iterator[None]:
    """Keep others from making a report, gathering results and changing the plan."""
    with locked(folder.create().lock, shared=True), locked(folder.lock.with_name(".report"), tell=tell):
        yield
