"""Name the files of a study, lock them, and keep the record of what was planned."""

from __future__ import annotations

import contextlib
import errno
import hashlib
import json
import shutil
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import IO, Any

from trackroller.errors import InputError
from trackroller.files import check_utf_8, disk_error, try_lock, write_text
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
    """Paths of the files of one study, `results/NAME/`.

    Attributes
    ----------
    design, gathered : pathlib.Path
        The cases of the study, and its gathered results.
    inputs, study_file : pathlib.Path
        Folder with the files that the study was made from, and the study file in it, with every default written out.
    plan_file : pathlib.Path
        The record of the plan: its chunks, and the study and inputs that it was made from.
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
        """Return the files with results of solved cases."""
        return sorted((self.root / "chunks").glob("*.nc"))

    def lost_files(self) -> list[Path]:
        """Return the files with solved cases that the plan counts on and that are gone."""
        record = self.record()
        solved = [name for name in record.get("chunks", {}) if self.mark(name).is_file()]
        paths = [*map(self.chunk, solved), *(self.root / "chunks" / name for name in record.get("uses", ()))]
        return [path for path in paths if not path.is_file()]

    def create(self) -> StudyFolder:
        """Create the folders of the study.

        Returns
        -------
        StudyFolder
            This folder.

        Raises
        ------
        InputError
            If the path exists and is not a folder.
        WorkError
            If the folder cannot be written.
        """
        check_utf_8(self.root.absolute(), "results folder")
        try:
            for name in ("plan", "chunks"):
                (self.root / name).mkdir(parents=True, exist_ok=True)
            with open(self.lock, "a"):
                pass
        except OSError as exc:
            if exc.errno in NO_FOLDER:
                wrong = f"cannot be a folder ({exc.strerror})"
                remedy = "Choose another with --results."
                raise InputError("results folder", str(self.root), "the path of a folder", remedy, wrong) from None
            raise disk_error(exc, self.root) from None
        return self

    def record(self) -> dict[str, Any]:
        """Return the record of the plan; {} if there is none, it was altered, or its format is not this version's."""
        try:
            record = json.loads(self.plan_file.read_text(encoding="utf-8"))
            sound = record.pop("digest") == _digest(record) and record.pop("store_format") == STORE_FORMAT
            return record if sound else {}
        except (OSError, ValueError, TypeError, KeyError, AttributeError, RecursionError):
            return {}

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

    def write_record(self, record: Mapping[str, Any]) -> None:
        """Write the record of the plan with its digest."""
        stored = {"store_format": STORE_FORMAT, **record}
        write_text(self.plan_file, json.dumps({**stored, "digest": _digest(stored)}) + "\n")


def _digest(record: Mapping[str, Any]) -> str:
    return hashlib.sha256(json.dumps(record, sort_keys=True).encode()).hexdigest()


def wait_for_lock(stream: IO[bytes], shared: bool = False, tell: Tell | None = None) -> None:
    """Wait until `try_lock` succeeds; call `tell` once if another process holds the lock."""
    while not try_lock(stream, shared):
        if tell is not None:
            tell(f"{Path(stream.name).stem.lstrip('.')}: another process works on this, waiting for it")
            tell = None
        time.sleep(0.05)


@contextlib.contextmanager
def locked(path: Path, shared: bool = False, tell: Tell | None = None) -> Iterator[None]:
    """Hold the lock of an empty file; the system releases the lock when the process ends, however it ends.

    A file with content is never locked: on Windows a lock keeps every reader out, even the process that holds it.
    """
    with open(path, "ab") as stream:
        wait_for_lock(stream, shared, tell)
        yield


@contextlib.contextmanager
def reporting(folder: StudyFolder, tell: Tell | None = None) -> Iterator[None]:
    """Keep others from making a report, gathering results and changing the plan."""
    with locked(folder.create().lock, shared=True), locked(folder.lock.with_name(".report"), tell=tell):
        yield


def sweep(folder: StudyFolder) -> None:
    """Remove temporary files and folders of killed processes; only the sole holder of the lock may call this."""
    for path in (*folder.root.glob(".*.tmp"), *folder.root.glob("*/.*.tmp")):
        if path.is_dir():
            shutil.rmtree(path, ignore_errors=True)
        else:
            path.unlink(missing_ok=True)
