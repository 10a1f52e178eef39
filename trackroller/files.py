"""Read the files of users, find the files that they name, and write files and folders whole."""

from __future__ import annotations

import atexit
import codecs
import contextlib
import errno
import hashlib
import math
import os
import re
import secrets
import shutil
import signal
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from importlib.machinery import ExtensionFileLoader
from pathlib import Path
from types import FrameType
from typing import IO, Any

import portalocker

from trackroller.errors import InputError, WorkError

LOCK = {True: portalocker.LockFlags.SHARED, False: portalocker.LockFlags.EXCLUSIVE}
MATERIALS = "TRACKROLLER_MATERIALS"  # the environment variable that names a materials file anywhere
STUDY_MARK = "plan.json"  # stands in the folder of a study, beside its finished cases
MAX_BYTES = 5_000_000  # bytes; a larger table of cases belongs into a CSV file
Reads = dict[Path, tuple[str, str]]  # kind and SHA-256 of each file that was read
_beside: ContextVar[Path | None] = ContextVar("beside", default=None)
_reads: ContextVar[Reads | None] = ContextVar("noted", default=None)
_confined: list[Path] = []  # what this process may read and write; everything if empty


def confine(folder: Path) -> None:
    """Let this process read users' files and write files below one folder only, and read the user's
    materials.

    Links are followed before the check, so a link that leads out of the folder is refused.
    Temporary files, such as the figures of a sheet before they stand in its page, have a folder
    that is deleted with the process.
    """
    materials = os.environ.get(MATERIALS)
    own = tempfile.mkdtemp(prefix="trackroller-")
    atexit.register(shutil.rmtree, own, ignore_errors=True)
    tempfile.tempdir = own
    folders = [folder, Path(own)]
    if materials:
        folders.append(Path(os.path.expanduser(materials)))
    _confined[:] = [place.resolve() for place in folders]


def _check_confined(path: Path, what: str) -> None:
    """Refuse a path outside the folder that `confine` names."""
    if _confined and not any(path.resolve().is_relative_to(folder) for folder in _confined):
        wrong = "leads out of the folder of the page, by itself or by a link in it"
        raise InputError(
            what, str(path), f"a file below {_confined[0]}", "Copy the file into the folder.", wrong
        )


def check_utf_8(path: Path | str, what: str) -> None:
    """Refuse a path whose bytes are not UTF-8: neither netCDF, YAML nor a page can hold such a
    name.
    """
    try:
        str(path).encode()
    except UnicodeEncodeError:
        shown = os.fsencode(path).decode("utf-8", "replace")
        remedy = "Rename the file or folder, or a folder above it."
        raise InputError(
            what, shown, "names in UTF-8", remedy, "has a name that is not UTF-8"
        ) from None


def check_place(path: Path, what: str) -> None:
    """Refuse to write a path that is not UTF-8, or that leads out of the folder that `confine`
    names.
    """
    check_utf_8(path, what)
    _check_confined(path.parent, what)


def is_link(path: Path) -> bool:
    """Return whether a path is a link, also if it is dangling."""
    # unlike that of pathlib it returns False for a name that no file can have
    return os.path.islink(path) or bool(getattr(os.path, "isjunction", lambda path: False)(path))


def refuse_link(path: Path, what: str) -> None:
    """Refuse a path that is a link: it may lead to files of other people."""
    if is_link(path):
        remedy = "Remove the link, or replace it by what it leads to."
        raise InputError(what, str(path), "files and folders without links", remedy, "is a link")


def refuse_links(root: Path, what: str, inside: bool = False) -> None:
    """Refuse a folder that holds a link, at any depth, and one that is a link unless only what is
    `inside` counts.
    """
    if not inside:
        refuse_link(root, what)
    for folder, folders, names in os.walk(root):
        for name in (*folders, *names):
            refuse_link(Path(folder, name), what)


@contextmanager
def noted_reads() -> Iterator[Reads]:
    """Note the kind and the SHA-256 of each file that `read_text` reads; an inner context adds to
    the outer one.
    """
    outer = _reads.get()
    reads: Reads = {} if outer is None else outer
    token = _reads.set(reads)
    try:
        yield reads
    finally:
        _reads.reset(token)


def read_bytes(path: Path | str, what: str, most: float = MAX_BYTES) -> bytes:
    """Return the content of a user's file, see `read_text`, and note its digest for
    `noted_reads`.
    """
    path = Path(path)
    with opened(path, what, most) as stream:
        content = stream.read()
    reads = _reads.get()
    if reads is not None:
        reads[path.resolve()] = what, hashlib.sha256(content).hexdigest()
    return content


@contextmanager
def opened(
    path: Path | str,
    what: str,
    most: float,
    remedy: str = "Put many cases into a CSV file and use method: table.",
) -> Iterator[IO[bytes]]:
    """Open a user's file to read its bytes; refuse a file as `read_text` does, a large one with a
    remedy of its own.
    """
    path = Path(path)
    try:
        check_utf_8(path, what)
        _check_confined(path, what)
        if path.is_dir():
            raise InputError(what, str(path), "a file", "Give the path of a file.", "is a folder")
        if path.exists() and not path.is_file():
            raise InputError(
                what,
                str(path),
                "a regular file",
                "Give the path of a file.",
                "is a device or a pipe",
            )
        if path.stat().st_size > most:
            allowed = f"a file of at most {most / 1e6:,.0f} MB"
            raise InputError(
                what, str(path), allowed, remedy, f"has {path.stat().st_size / 1e6:,.0f} MB"
            )
        with open(path, "rb") as stream:
            yield stream
    except InputError:
        raise
    except FileNotFoundError:
        raise InputError(
            what, str(path), "the path of a file", "Check the path.", "does not exist"
        ) from None
    except (OSError, ValueError) as exc:
        too_long = None
        if isinstance(exc, OSError):
            too_long = long_name(exc)
        if too_long is not None:
            raise too_long.named(what) from None
        why: object = exc
        if isinstance(exc, OSError) and exc.strerror:
            why = exc.strerror
        wrong = f"cannot be read ({why})"
        raise InputError(
            what, str(path), "a file that can be read", "Check path and rights.", wrong
        ) from None


def read_text(path: Path | str, what: str, most: float = MAX_BYTES) -> str:
    """Return the text of a user's file.

    Parameters
    ----------
    path : Path or str
        The file.
    what : str
        Kind of file, for messages.
    most : float
        Largest size [bytes].

    Returns
    -------
    str
        The text, without a byte-order mark.

    Raises
    ------
    InputError
        If the file is missing, no regular file, too large, unreadable or neither UTF-8 nor UTF-16
        with its mark.
    """
    return text_of(read_bytes(path, what, most), path, what)


UTF_16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)  # the marks at the beginning of a file


def _with_mark(content: bytes) -> bytes:
    """Return the content of a file; UTF-16 without its mark, of which every other byte is 0, gets
    the mark.
    """
    even, odd = (content[start::2].count(0) for start in (0, 1))
    if max(even, odd) <= 0.3 * len(content) or min(even, odd) > 0:
        return content
    if odd:
        return codecs.BOM_UTF16_LE + content
    return codecs.BOM_UTF16_BE + content


def text_of(content: bytes, path: Path | str, what: str, western: bool = False) -> str:
    """Return the text of the content of a user's file, see `read_text`.

    Parameters
    ----------
    content : bytes
        The file.
    path, what
        See `read_text`.
    western : bool
        Whether UTF-16 without its mark and the encoding of Windows in western countries are read
        too, as instruments write them.
    """
    if western and not content.startswith(UTF_16):
        content = _with_mark(content)
    utf_16 = content.startswith(UTF_16)  # Excel's "Unicode text"
    encoding = "utf-8-sig"
    if utf_16:
        encoding = "utf-16"
    try:
        text = content.decode(encoding)
    except UnicodeDecodeError as exc:
        if western and not utf_16:
            return text_of(content.decode("cp1252", "replace").encode(), path, what)
        remedy = "Save the file as UTF-8; in Excel choose 'CSV UTF-8'."
        wrong = f"is not {exc.encoding.upper()} text at byte {exc.start}"
        error = InputError(
            what, str(path), "text in UTF-8, or in UTF-16 with its mark", remedy, wrong
        )
        if not utf_16:
            error = error.at(path, content.count(b"\n", 0, exc.start) + 1)
        raise error from None
    if "\0" in text:
        raise InputError(
            what,
            str(path),
            "a text",
            "Save the file as UTF-8.",
            "holds zero bytes, so it is no text",
        )
    return text


@contextmanager
def files_beside(path: Path | str | None) -> Iterator[None]:
    """Look for files in the folder of the case or study file `path` first, while that file is
    read.
    """
    folder = None
    if path is not None:
        folder = Path(path).parent
    token = _beside.set(folder)
    try:
        yield
    finally:
        _beside.reset(token)


def find_beside(name: Any, field: str) -> Path:
    """Return the path of a file that a case, study or spectrum file names: the one rule for every
    such path.

    Parameters
    ----------
    name : str
        Path from the folder of the file that names it, or from the working directory.
    field : str
        The key that names it, for messages.

    Raises
    ------
    InputError
        If the path is absolute, holds '..', leads out of both folders, or names no file.
    """
    folders = [folder for folder in (_beside.get(), Path.cwd()) if folder is not None]
    where = " or ".join(dict.fromkeys(f"below {folder.resolve()}" for folder in folders))
    remedy = f"Put the file {where} and give its path from there."
    path = Path(str(name))
    if (
        not isinstance(name, (str, Path))
        or path.is_absolute()
        or ".." in path.parts
        or not str(name).strip()
    ):
        wrong = "is not a path within the folder"
        raise InputError(field, str(name), "a relative path without '..'", remedy, wrong)
    linked = None
    for folder in folders:
        here = folder / path
        if here.is_file() and here.resolve().is_relative_to(folder.resolve()):
            return here
        linked = linked or (here if here.is_file() else None)
    if linked is not None:
        wrong = f"is a link that leads out of the folder, to {linked.resolve()}"
        raise InputError(
            field, str(name), f"a file {where}", "Copy the file to the place of the link.", wrong
        )
    raise InputError(
        field, str(name), f"a file {where}", "Check its name, or put it there.", "is not there"
    )


# no other system call fails for these reasons
FAILED_WRITES = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS)


def long_name(exc: OSError) -> InputError | None:
    """Return the message for a path with a name that the system refuses for its length; None for
    another error.
    """
    if exc.errno != errno.ENAMETOOLONG:
        return None
    path = str(exc.filename or "")
    longest = max((len(os.fsencode(part)) for part in Path(path).parts), default=0)
    allowed = "names of files and folders of at most 255 bytes, and paths of at most 4095"
    return InputError(
        "path",
        path,
        allowed,
        "Give a shorter name.",
        f"is too long: a name in it has {longest} bytes",
    )


def disk_error(exc: OSError, path: Path) -> WorkError:
    """Return the message for a failed write, with the remedy."""
    exc = _true_cause(exc, path)
    if exc.errno in (errno.ENOSPC, errno.EDQUOT):
        cause = "the disk is full"
        remedy = "Free some space"
    elif exc.errno in (errno.EROFS, errno.EACCES, errno.EPERM):
        cause = f"it cannot be written ({exc.strerror})"
        remedy = "Change its permissions (or choose another --results)"
    else:
        cause = f"writing failed ({why_not(exc, path)})"
        remedy = "Repair the folder or the disk"
    of_study = any((place / STUDY_MARK).is_file() for place in (path, *path.parents))
    assurance = ""
    if of_study:
        assurance = ": every finished case is kept"
    return WorkError(f"{path}: {cause}. {remedy}, then start again{assurance}.")


def why_not(exc: OSError, path: Path) -> str:
    """Return in words why a path cannot be made: the system says of a link that leads nowhere that
    a file exists.
    """
    lost = next(
        (place for place in (path, *path.parents) if is_link(place) and not place.exists()), None
    )
    if lost is None:
        return str(exc.strerror or exc)
    return f"{lost} is a link to something that does not exist"


def _true_cause(exc: OSError, path: Path) -> OSError:
    """Return why a file could not be written: a library may report a full disk as a lack of
    rights.
    """
    if exc.errno in (errno.EACCES, errno.EPERM):
        folder = next((place for place in path.parents if place.is_dir()), Path())
        try:
            with tempfile.TemporaryFile(dir=folder) as probe:
                probe.write(bytes(1_000_000))
                probe.flush()
                os.fsync(probe.fileno())
        except OSError as cause:
            return cause
    return exc


_TOKEN = secrets.token_hex(8)  # tells the temporary files of this process from those of others


def scratch_name(path: Path) -> Path:
    """Return the temporary path beside a file or folder under which this process makes it; no one
    else has it.
    """
    return path.with_name(f".{path.name}.{os.getpid()}-{_TOKEN}.tmp")


@contextmanager
def disk_errors(path: Path) -> Iterator[None]:
    """Turn a write to `path` that fails within this context into a `WorkError` with its remedy."""
    try:
        yield
    except WorkError:
        raise
    except (OSError, RuntimeError) as exc:
        if isinstance(exc, OSError) and (exc.errno or 0) > 0:
            raise disk_error(exc, path) from exc
        # the netCDF library hides the system's error
        full = shutil.disk_usage(path.parent).free < 16_000_000
        code = errno.ENOSPC if full else errno.EIO
        raise disk_error(OSError(code, str(exc)), path) from exc


def write_whole(path: Path, write: Callable[[Path], object], beside: Path | None = None) -> None:
    """Write a file under a temporary name, flush it to the disk and rename it.

    A failure leaves no file behind, and a killed process leaves the previous file unchanged.

    Parameters
    ----------
    path : pathlib.Path
        The file to write.
    write : callable
        Writes the content; it receives the temporary path.
    beside : pathlib.Path, optional
        The temporary path, on the same disk; by default a name beside the file.

    Raises
    ------
    WorkError
        If the operating system or the netCDF library cannot write.
    """
    check_place(path, "file to write")
    if beside is None:
        beside = scratch_name(path)
    try:
        with disk_errors(path):
            path.parent.mkdir(parents=True, exist_ok=True)
            beside.parent.mkdir(parents=True, exist_ok=True)
            write(beside)
            flush(beside)
            os.replace(beside, path)
            sync_folder(path.parent)
    finally:
        with contextlib.suppress(OSError):
            beside.unlink()


@contextmanager
def all_or_none(*paths: Path) -> Iterator[None]:
    """Write several files together: if one of them fails, each is again what it was before, or is
    away again.

    Parameters
    ----------
    *paths : pathlib.Path
        The files that are written within this context.

    Notes
    -----
    The previous content stands in a copy beside each file, so that putting it back needs no space
    on the disk.
    """
    copies: dict[Path, Path] = {}
    lacking = [folder for path in paths for folder in path.parents if not folder.exists()]
    try:
        for path in paths:
            if path.exists():
                copies[path] = scratch_name(path).with_suffix(".before")
                with disk_errors(path):
                    shutil.copy2(path, copies[path])
        try:
            yield
        except BaseException:
            for path in paths:
                if path in copies:
                    os.replace(copies[path], path)
                else:
                    path.unlink(missing_ok=True)
            for folder in lacking:
                with contextlib.suppress(OSError):
                    folder.rmdir()
            raise
    finally:
        for copy in copies.values():
            copy.unlink(missing_ok=True)


def flush(path: Path) -> None:
    """Flush a file to the disk."""
    with open(path, "rb+") as stream:
        os.fsync(stream.fileno())


def write_text(path: Path, text: str) -> None:
    """Write a text file whole or not at all; see `write_whole`."""
    write_whole(path, lambda beside: beside.write_text(text, encoding="utf-8", newline="\n"))


def write_private(path: Path, text: str) -> None:
    """Write a text file that only its owner can read, whatever file stood there; see
    `write_whole`.
    """

    def write(beside: Path) -> None:
        beside.unlink(missing_ok=True)
        handle = os.open(beside, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
        with open(handle, "w", encoding="utf-8", newline="\n") as stream:
            stream.write(text)

    write_whole(path, write)


def open_here(path: Path | str, mode: str) -> IO[Any]:
    """Open a file, but no link: where a system cannot refuse links, the check before has to do."""
    return open(
        path,
        mode,
        opener=lambda name, flags: os.open(name, flags | getattr(os, "O_NOFOLLOW", 0), 0o666),
    )


def _interrupt(number: int, frame: FrameType | None) -> None:
    """Raise `KeyboardInterrupt`, but try again in 20 ms where Python or a library would not pass it
    on as it is.

    The libraries of netCDF files hold a lock, which an interrupt would leave held, so that the next
    access would wait forever. Python drops an exception that is raised while it disposes of an
    object. A compiled module that is interrupted while it is imported raises `ImportError` instead.
    """
    while frame is not None:
        module = str(frame.f_globals.get("__name__"))
        imported = frame.f_locals.get("self")
        waits = (
            module.startswith(("netCDF4", "xarray.backends", "weakref"))
            or frame.f_code.co_name == "__del__"
        )
        if waits or (
            module == "importlib._bootstrap_external" and isinstance(imported, ExtensionFileLoader)
        ):
            signal.setitimer(signal.ITIMER_REAL, 0.02)
            return
        frame = frame.f_back
    raise KeyboardInterrupt


@contextmanager
def interrupts_wait_for_files() -> Iterator[None]:
    """Let Ctrl-C wait while a netCDF file is read or written; a thread beside the main one is left
    as it is.
    """
    # not on Windows
    main = threading.current_thread() is threading.main_thread() and hasattr(signal, "setitimer")
    if not main or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        yield
        return
    before = {
        number: signal.signal(number, _interrupt) for number in (signal.SIGINT, signal.SIGALRM)
    }
    try:
        yield
    finally:
        waiting, _ = signal.setitimer(signal.ITIMER_REAL, 0)
        for number, handler in before.items():
            signal.signal(number, handler)
        if waiting:
            raise KeyboardInterrupt


def sync_folder(folder: Path) -> None:
    """Flush the names of the files of a folder to the disk."""
    with contextlib.suppress(OSError):  # some file systems cannot flush a folder
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def reserve(file: IO[bytes], size: int) -> None:
    """Take room on the disk for an open file.

    Parameters
    ----------
    file : binary file
        Open for writing and empty.
    size : int
        Number of bytes.

    Raises
    ------
    OSError
        If the disk is full.
    """
    if hasattr(os, "posix_fallocate"):
        os.posix_fallocate(file.fileno(), 0, size)
        return
    block = bytes(1 << 20)  # a system that promises room only to what is written
    for start in range(0, size, len(block)):
        file.write(block[: size - start])
    file.flush()


def inert_cell(value: Any) -> Any:
    """Return a cell of a table with an apostrophe before a text that a spreadsheet would run as a
    formula.

    Numbers stay as they are, as texts too. No name is refused for its first sign, because `+20 N`
    may name a load case: each table that is written has inert cells, and each that is read has them
    as they were, see `cell_as_meant`.
    """
    if not isinstance(value, str) or not value.startswith(("=", "+", "-", "@", "\t", "\r")):
        return value
    if re.fullmatch(r"[+-]?[\d.,]+(e[+-]?\d+)?|[+-]inf", value):
        return value
    return f"'{value}"


def cell_as_meant(cell: str) -> str:
    """Return a cell of a table without the apostrophe that `inert_cell` has put before it, or a
    person.

    Examples
    --------
    >>> cell_as_meant("'=1+1"), cell_as_meant("'30s"), cell_as_meant("'-5")
    ('=1+1', "'30s", "'-5")
    """
    return cell[1:] if cell.startswith("'") and inert_cell(cell[1:]) == cell else cell


def sha256(path: Path) -> str:
    """Return the SHA-256 of a file, in hexadecimal digits."""
    with open(path, "rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def cores() -> int:
    """Return the number of processors that this process may use; of the machine where the system
    does not say.
    """
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def memory() -> float:
    """Return the memory of this machine [bytes]; infinite where the system does not say."""
    try:
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, ValueError, OSError):
        return math.inf


def try_lock(stream: IO[bytes], shared: bool = False) -> bool:
    """Take or convert the lock of an open file, unless another process holds a conflicting lock.

    Return True on a file system without locks, where two processes may solve the same case and no
    result is lost.
    """
    try:
        portalocker.lock(stream, LOCK[shared] | portalocker.LockFlags.NON_BLOCKING)
    except portalocker.AlreadyLocked:
        return False
    except (portalocker.LockException, OSError):
        return True
    return True


def wait_for_lock(
    stream: IO[bytes], shared: bool = False, tell: Callable[[str], object] | None = None
) -> None:
    """Wait until `try_lock` succeeds; call `tell` once if another process holds the lock."""
    if try_lock(stream, shared):
        return
    if tell is not None:
        tell(f"{Path(stream.name).stem.lstrip('.')}: another process works on this, waiting for it")
    while not try_lock(stream, shared):
        time.sleep(0.05)


@contextmanager
def locked(
    path: Path, shared: bool = False, tell: Callable[[str], object] | None = None
) -> Iterator[None]:
    """Hold the lock of an empty file; the system releases the lock when the process ends, however
    it ends.

    A file with content is never locked: on Windows a lock keeps every reader out, even the process
    that holds it.
    """
    with open_here(path, "ab") as stream:
        wait_for_lock(stream, shared, tell)
        yield
