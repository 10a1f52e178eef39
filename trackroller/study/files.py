"""Files that appear whole or not at all, locks that die with their process, and a study's folder."""

from __future__ import annotations

import contextlib
import errno
import os
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from trackroller.errors import InputError


class WorkError(RuntimeError):
    """The work failed for a reason outside the input (full disk, broken file); says what to do."""


@dataclass(frozen=True)
class StudyFolder:
    """Where a study's files lie: `results/NAME/`."""

    root: Path

    @property
    def design(self) -> Path:
        """The cases."""
        return self.root / "design.nc"

    @property
    def gathered(self) -> Path:
        """The gathered data set."""
        return self.root / "study.nc"

    @property
    def plan_file(self) -> Path:
        """Which chunks the study consists of."""
        return self.root / "plan.json"

    @property
    def plan_lock(self) -> Path:
        """Lock of the planner."""
        return self.root / "store" / ".plan.lock"

    def case_list(self, chunk: str) -> Path:
        """The cases of a chunk."""
        return self.root / "plan" / f"{chunk}.npz"

    def chunk(self, chunk: str) -> Path:
        """A solved chunk, as the workflow sees it."""
        return self.root / "chunks" / f"{chunk}.nc"

    def kept(self, chunk: str) -> Path:
        """The same file under a name that the workflow never deletes."""
        return self.root / "store" / f"{chunk}.nc"

    def parts(self, chunk: str) -> Path:
        """Folder of the blocks of an unfinished chunk."""
        return self.root / "store" / f"{chunk}.parts"

    def lock(self, chunk: str) -> Path:
        """Lock of a chunk."""
        return self.root / "store" / f"{chunk}.lock"

    def create(self) -> StudyFolder:
        """Make the folders; raises `WorkError` where nothing can be written, `InputError` for what is no folder."""
        try:
            for name in ("plan", "chunks", "store"):
                (self.root / name).mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=self.root / "store"):
                pass
        except OSError as exc:
            if exc.errno in (errno.ENOTDIR, errno.EEXIST, errno.ENAMETOOLONG, errno.ELOOP):
                raise InputError(
                    "results folder",
                    str(self.root),
                    f"it cannot be a folder ({exc.strerror})",
                    "Choose another with --results.",
                ) from None
            raise disk_error(exc, self.root) from None
        return self


def disk_error(exc: OSError, path: Path) -> WorkError:
    """A message for a write that failed, with what to do."""
    if exc.errno in (errno.ENOSPC, errno.EDQUOT):
        what, remedy = "the disk is full", "Free some space"
    elif exc.errno in (errno.EROFS, errno.EACCES, errno.EPERM):
        what, remedy = f"it cannot be written ({exc.strerror})", "Mend its rights (or choose another --results)"
    else:
        what, remedy = f"writing failed ({exc.strerror or exc})", "Mend the folder or the disk"
    return WorkError(f"{path}: {what}. {remedy}, then start again: every finished case is kept.")


def write_whole(path: Path, write: Callable[[Path], object]) -> None:
    """Write a file beside its place, flush it to the disk, and move it there in one step.

    `write` gets the path of the temporary file. A failure leaves nothing behind; `OSError` (and netCDF's
    RuntimeError for a full disk) becomes `WorkError`.
    """
    beside = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write(beside)
        with open(beside, "rb+") as stream:
            os.fsync(stream.fileno())
        os.replace(beside, path)
        _sync_folder(path.parent)
    except (OSError, RuntimeError) as exc:
        if isinstance(exc, OSError) and (exc.errno or 0) > 0:
            raise disk_error(exc, path) from exc
        free = os.statvfs(path.parent)  # the netCDF library hides the operating system's error
        code = errno.ENOSPC if free.f_bavail * free.f_frsize < 16_000_000 else errno.EIO
        raise disk_error(OSError(code, str(exc)), path) from exc
    finally:
        with contextlib.suppress(OSError):
            beside.unlink()


def _sync_folder(folder: Path) -> None:
    with contextlib.suppress(OSError):  # some file systems cannot sync a folder
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def link_or_copy(source: Path, target: Path) -> None:
    """The same content under a second name: a hard link, or a copy where there are none."""

    def write(beside: Path) -> None:
        try:
            os.link(source, beside)
        except OSError:
            beside.write_bytes(source.read_bytes())

    write_whole(target, write)


@contextlib.contextmanager
def locked(path: Path, tell: Callable[[str], None] | None = None) -> Iterator[None]:
    """Hold a lock that the system releases when the process ends, however it ends."""
    import fcntl

    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        stream = open(path, "a")
    except OSError as exc:
        raise disk_error(exc, path) from None
    with stream:
        told = False
        while True:
            try:
                fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
                break
            except BlockingIOError:
                if tell is not None and not told:
                    tell(f"{path.stem}: another process works on this, waiting for it")
                    told = True
                time.sleep(0.2)
            except OSError:  # a file system without locks: atomic files are safe, work may be done twice
                break
        yield


def sweep(folder: Path) -> None:
    """Remove temporary files that killed processes left behind."""
    for path in folder.glob(".*.tmp"):
        parts = path.name.split(".")
        owner = parts[-2] if len(parts) > 2 else ""
        if not (owner.isdigit() and Path(f"/proc/{owner}").exists()):
            with contextlib.suppress(OSError):
                path.unlink()
