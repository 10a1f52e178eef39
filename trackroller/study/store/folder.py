"""Name the files of a study, lock them, and record the checksums of its results."""

from __future__ import annotations

import contextlib
import errno
import fcntl
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import IO, Any

from trackroller.errors import InputError
from trackroller.files import disk_error, read_mapping, sha256, write_text

Tell = Callable[[str], None]
NO_FOLDER = (errno.ENOTDIR, errno.EEXIST, errno.ENAMETOOLONG, errno.ELOOP)


class StudyFolder:
    """Paths of the files of one study, `results/NAME/`.

    Attributes
    ----------
    design, gathered : pathlib.Path
        The cases of the study, and its gathered results.
    study_file : pathlib.Path
        The study file with every default written out.
    plan_file : pathlib.Path
        The names of the chunks that the study consists of.
    lock : pathlib.Path
        Lock that processes share while they work from the plan; only its sole holder may change the plan.
    """

    def __init__(self, root: Path) -> None:
        self.root = root
        self.design, self.gathered = root / "design.nc", root / "study.nc"
        self.study_file, self.plan_file = root / "study.yaml", root / "plan.json"
        self.lock = root / "plan" / ".lock"

    def earlier(self) -> dict[str, Any]:
        """Return the study as it was planned last, {} if there is none."""
        try:
            return read_mapping(self.study_file, "study")
        except InputError:
            return {}

    def case_list(self, chunk: str) -> Path:
        """Return the cases of a chunk."""
        return self.root / "plan" / f"{chunk}.nc"

    def mark(self, chunk: str) -> Path:
        """Return the empty file by which the workflow knows that a chunk is solved. It may be deleted at any time."""
        return self.root / "plan" / f"{chunk}.solved"

    def chunk(self, chunk: str) -> Path:
        """Return the results of a solved chunk."""
        return self.root / "chunks" / f"{chunk}.nc"

    def part(self, chunk: str, first_case: str) -> Path:
        """Return the results of one block of a chunk that is not complete yet."""
        return self.root / "parts" / f"{chunk}-{first_case}.nc"

    def parts(self, chunk: str = "*") -> list[Path]:
        """Return the existing blocks of one chunk, or of all chunks."""
        return sorted((self.root / "parts").glob(f"{chunk}-*.nc"))

    def solved_files(self) -> Iterator[Path]:
        """Find the files with results of solved cases: parts first, as a process may complete a chunk meanwhile."""
        yield from self.parts()
        yield from sorted((self.root / "chunks").glob("*.nc"))

    def checksum(self, path: Path) -> Path:
        """Return the file that holds the checksum of `design.nc` or `study.nc`."""
        return self.root / "plan" / f"{path.name}.sha256"

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
        try:
            for name in ("plan", "chunks", "parts"):
                (self.root / name).mkdir(parents=True, exist_ok=True)
            with open(self.lock, "a"):
                pass
        except OSError as exc:
            if exc.errno in NO_FOLDER:
                allowed = f"it cannot be a folder ({exc.strerror})"
                raise InputError("results folder", str(self.root), allowed, "Choose another with --results.") from None
            raise disk_error(exc, self.root) from None
        return self


def record_checksum(folder: StudyFolder, path: Path) -> None:
    """Write the SHA-256 of a file, in the format of `sha256sum`, into the folder `plan`."""
    write_text(folder.checksum(path), f"{sha256(path)}  ../{path.name}\n")


def matches_checksum(folder: StudyFolder, path: Path) -> bool:
    """Return whether a file is as it was when its checksum was recorded."""
    try:
        return folder.checksum(path).read_text().split()[:1] == [sha256(path)]
    except (OSError, UnicodeDecodeError):
        return False


def try_lock(stream: IO[bytes], shared: bool = False) -> bool:
    """Take or convert the lock of an open file, unless another process holds a conflicting lock.

    Return True on a file system without locks: files are replaced whole there, so no result can be lost, but
    two processes may solve the same case.
    """
    try:
        fcntl.flock(stream, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return True
    return True


def wait_for_lock(stream: IO[bytes], shared: bool = False, tell: Tell | None = None) -> None:
    """Wait until `try_lock` succeeds; call `tell` once if another process holds the lock."""
    while not try_lock(stream, shared):
        if tell is not None:
            tell(f"{Path(stream.name).stem}: another process works on this, waiting for it")
            tell = None
        time.sleep(0.05)


@contextlib.contextmanager
def locked(path: Path, shared: bool = False, tell: Tell | None = None) -> Iterator[None]:
    """Hold the lock of an existing file; the system releases the lock when the process ends, however it ends."""
    with open(path, "rb+") as stream:
        wait_for_lock(stream, shared, tell)
        yield


def sweep(folder: StudyFolder) -> None:
    """Remove what killed processes left: temporary files and parts of complete chunks.

    Only the sole holder of the lock may call this, after damaged chunks are removed.
    """
    for path in folder.parts():
        if folder.chunk(path.stem.partition("-")[0]).is_file():
            path.unlink(missing_ok=True)
    for path in (*folder.root.glob(".*.tmp"), *folder.root.glob("*/.*.tmp")):
        if path.is_file():  # the figures are drawn in a temporary folder
            path.unlink(missing_ok=True)
