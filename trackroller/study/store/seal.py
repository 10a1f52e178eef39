"""Write results with their digests, and compare a result with its digest before it is read.

Each result has a record, see `trackroller.study.store.digests`; a folder such as `figures/` has a line for each file.
A result without a record is compared with the RO-Crate beside it, if there is one. A lone netCDF file has neither and
is read as it is.
"""

from __future__ import annotations

import contextlib
import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import xarray as xr

from trackroller.errors import InputError, WorkError
from trackroller.files import check_place, disk_errors, flush, scratch_name, sha256, sync_folder
from trackroller.study.store import ownership
from trackroller.study.store.digests import (
    LONE,
    METADATA,
    OUTDATED,
    digest_of_file,
    listed,
    of_crate,
    read_record,
    record_of,
)
from trackroller.study.store.netcdf import read_netcdf
from trackroller.study.store.ownership import write_record

REPORT = ("sensitivity.nc", "report.html", "figures", "tables")  # what is made from study.nc


def _place(path: Path) -> tuple[Path, Path]:
    """Return the folder that the record of a result names files from, and the record."""
    root = ownership.root_of(path) or path.parent
    return root, record_of(root, path)


def files_of(path: Path) -> list[Path]:
    """Return the files of a result, which is a file or a folder; hidden files do not count."""
    files = sorted(path.rglob("*")) if path.is_dir() else [path]
    return [file for file in files if file.is_file() and not file.name.startswith(".")]


@contextlib.contextmanager
def sealing(path: Path) -> Iterator[Path]:
    """Yield a temporary path; what the caller writes there replaces the result at `path`, and its record.

    Of a folder, each file is put in place; files that the folder holds beside stay. The record names old and new files
    before the first is replaced, so that a process stopped in between leaves neither a result that looks altered nor a
    file that looks like somebody else's. The description of the study goes with data that it describes: it is written
    last of all. Outside of a study, a lone file has no record.

    Raises
    ------
    InputError
        If a link, or a file of somebody else, stands in the place of a file.
    WorkError
        If the files cannot be written.
    """
    check_place(path, "file to write")
    root, beside = ownership.root_of(path), scratch_name(path)
    if root is not None:
        ownership.adopt(root)
        ownership.note(root, beside)
    try:
        with disk_errors(path):
            path.parent.mkdir(parents=True, exist_ok=True)
        yield beside
        with disk_errors(path):
            _put(path, beside, root)
    finally:
        if beside.is_dir():
            shutil.rmtree(beside, ignore_errors=True)
        with contextlib.suppress(OSError):
            beside.unlink(missing_ok=True)


def _put(path: Path, beside: Path, root: Path | None) -> None:
    """Put what was made at a temporary path in the place of a result."""
    folder = beside.is_dir()
    if root is None and not folder:
        flush(beside)
        os.replace(beside, path)
        sync_folder(path.parent)
        return
    home = root or path  # a folder of figures in no study keeps its own record
    record = record_of(root, path) if root else path / LONE
    files = ownership.files_below(beside) if folder else [beside]
    made = {path / file.relative_to(beside) if folder else path: file for file in files}
    digests = {goal: sha256(file) for goal, file in made.items()}
    known = listed(home)
    for goal, digest in digests.items():
        ownership.replaceable(goal, home, digest, known)
    new = {goal.relative_to(home).as_posix(): {digest} for goal, digest in digests.items()}
    if read_record(record) == (True, new) and all(digest_of_file(goal) == digest for goal, digest in digests.items()):
        return  # what stands there keeps its date
    ownership.make_way(record, home)
    old = read_record(record)[1]
    write_record(record, {name: old.get(name, set()) | new.get(name, set()) for name in {*old, *new}}, current=False)
    if root is not None and path.suffix == ".nc":
        discard(path.parent / METADATA)
    if folder:
        path.mkdir(exist_ok=True)
    known = listed(home)
    for goal, file in made.items():
        goal.parent.mkdir(parents=True, exist_ok=True)
        flush(file)
        ownership.make_way(goal, home, same=digests[goal], known=known)
        os.replace(file, goal)
    for name in old.keys() - new.keys():
        ownership.remove(home / name, home, known)
    for place in {goal.parent for goal in made}:
        sync_folder(place)
    write_record(record, new, current=True)


def put(path: Path, save: Callable[[Path], object]) -> Path:
    """Write a file as a result, see `sealing`: `save` writes its content to the temporary path that it receives."""
    with sealing(path) as beside, disk_errors(path):
        save(beside)
    return path


def put_text(path: Path, text: str) -> Path:
    """Write a text as a result, see `put`."""
    return put(path, lambda beside: beside.write_text(text, encoding="utf-8", newline="\n"))


def forget_report(root: Path) -> None:
    """Mark analysis, figures and report as outdated: they were made from earlier results of the study."""
    for name in REPORT:
        current, names = read_record(record := record_of(root, root / name))
        if current:
            write_record(record, names, current=False)


def discard(path: Path) -> None:
    """Remove a result and its record, if there is one; it does not look lost."""
    ownership.clear(path)
    if (root := ownership.root_of(path)) is not None:
        ownership.remove(record_of(root, path), root)


def recorded(path: Path) -> dict[str, str] | None:
    """Return the recorded SHA-256 of a result by file, relative to the study's folder; None without a record.

    A result that is outdated, or that a killed process replaced in part, counts as one without a record.
    """
    record = _place(path)[1]
    try:
        text = record.read_text(encoding="utf-8")
    except FileNotFoundError:
        return None
    except (OSError, UnicodeDecodeError):
        return {}
    known = {name: min(digests) for name, digests in read_record(record)[1].items()}
    return None if text.startswith(OUTDATED) else known


def altered(path: Path) -> str | None:
    """Return what is wrong with a result that was recorded, None if it is as it was written.

    Parameters
    ----------
    path : pathlib.Path
        A file or folder in a study's folder. A folder may hold further files.
    """
    known = recorded(path)
    if known is None:
        return None
    root, record = _place(path)
    now = {name: sha256(root / name) for name in known if (root / name).is_file()}
    if known != now and known != recorded(path):  # another process has just written the result
        return altered(path)
    if not known and (files := files_of(path)):
        return _altered(files[0], sha256(files[0]), None, record)
    for name in sorted(known):
        if known[name] != now.get(name):
            return _altered(root / name, now.get(name), known[name], record)
    return None


def _altered(path: Path, now: str | None, before: str | None, record: Path) -> str:
    if now is None:
        return f"{path} is missing, but its SHA-256 stands in {record}"
    stands = f"{before} stands" if before else "no digest stands"
    return f"{path} was altered or damaged after it was written: its SHA-256 is {now}, but {stands} in {record}"


def is_sealed(path: Path) -> bool:
    """Return whether a result has a record and is as it was written."""
    return recorded(path) is not None and altered(path) is None


def check_sealed(path: Path) -> Path:
    """Return the path of a result after its content was compared with the recorded digest.

    Raises
    ------
    WorkError
        If the result was altered or damaged after it was written.
    """
    why = altered(path)
    if why is None and recorded(path) is None and (known := digest_of(path)) is not None:
        if (now := sha256(path)) != known:
            why = _altered(path, now, known, path.parent / METADATA)
    if why is not None:
        raise WorkError(f"{why}. `trackroller run STUDY --report` makes it again from the chunks, which are kept.")
    return path


def digest_of(path: Path) -> str | None:
    """Return the digest of a file in its record, otherwise in the RO-Crate beside it; None if it has neither.

    A file without a digest may describe earlier results.
    """
    if known := recorded(path):
        return known.get(path.name, "")
    return of_crate(path.parent).get(path.name)


def read_result(path: Path | str) -> xr.Dataset:
    """Return a netCDF result in memory, after its content was compared with the recorded digest.

    Raises
    ------
    InputError
        If the file is missing, is not a netCDF file, or declares more values than it can hold.
    WorkError
        If the file was altered or damaged after it was written.
    """
    path = Path(path)
    if not path.is_file():
        raise InputError("results", str(path), "the path of a netCDF file", "Run the study first.", "does not exist")
    return read_netcdf(check_sealed(path), "results", "Run the study again.")
