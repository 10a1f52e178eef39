"""Digests of the program's own files: of which code a result was made.

A result depends on the rooms in which it is made: a solved case on those up to `roller`, an analysis on those up to
`results`. The digest of rooms is that of the bytes of their files. A changed comment therefore counts as a change: two
versions of the program rarely differ by comments alone, and no rule has to say what a comment is.

The solver's digest is part of each case's fingerprint (`solver_digest`). Rules of the workflow depend on a digest file
instead of on source files, because the date of a source file changes when a copy is made::

    from trackroller.study.store.program_digest import digest_file

    rule sensitivity:
        input:
            study=f"{RESULTS}/study.nc",
            code=digest_file(f"{RESULTS}/code", "results"),

`digest_file` returns a path. It writes this file when the workflow is read, and only if the digest has changed.

Examples
--------
>>> from trackroller.study.store.program_digest import code_digest, room_files
>>> [path.name for path in room_files("errors")]
['environment.py', 'errors.py']
>>> len(code_digest("errors"))
16
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from functools import cache
from pathlib import Path

from trackroller.damage.own import digests
from trackroller.study.store.put import put_text

PACKAGE = Path(__file__).resolve().parents[2]
SOLVER = "roller"  # the last room that decides the numbers of a case
ROOMS = (  # a room imports from the rooms before it only
    "environment",
    "errors",
    "files",
    "yaml_file",
    "numerics",
    "tables",
    "halfspace",
    "damage",
    "parameters",
    "materials",
    "contact",
    "roller",
    "one_patch",
    "methods",
    "carriage",
    "study",
    "fit",
    "results",
    "report",
    "app",
    "cli",
)
# The values of materials stand in each fingerprint, so the file of materials need not count as well.
BY_VALUE = ("materials.yaml",)
CONTENT = (".py", ".json", ".csv", ".npz", ".yaml", ".j2", ".html", ".css", ".js", ".mplstyle")


def room_files(last: str) -> list[Path]:
    """Return the source and data files of a room and of all rooms before it.

    Parameters
    ----------
    last : str
        Name of the room.

    Returns
    -------
    list of pathlib.Path
        The files room by room, sorted in each. The top `trackroller/__init__.py` is left out: it holds public names and
        the version only.
    """
    rooms = ROOMS[: ROOMS.index(last) + 1]
    places = [place for room in rooms for place in (PACKAGE / room, PACKAGE / f"{room}.py")]
    return [path for place in places for path in files_of(place)]


def files_of(place: Path) -> list[Path]:
    """Return a file, or the source and data files of a folder, sorted; files that an editor leaves do not count."""
    if place.is_dir():
        files = sorted(place.rglob("*"))
    else:
        files = [place]
    return [path for path in files if path.suffix in CONTENT and path.is_file() and path.name[0] != "."]


def code_digest(last: str, *beside: str, leave_out: Iterable[str] = ()) -> str:
    """Return a digest of the files of a room and of all rooms before it.

    Parameters
    ----------
    last : str
        Name of the room.
    *beside : str
        Further files and folders, such as "validation/paper", from the folder that holds the package.
    leave_out : iterable of str
        Names of files that do not count.

    Returns
    -------
    str
        16 hexadecimal digits. Two copies of the same package have the same digest, wherever they lie.
    """
    files = room_files(last)
    digest = hashlib.sha256()
    for name in beside:
        files += files_of(PACKAGE.parent / name)
    for path in files:
        if path.name not in leave_out:
            name = path.relative_to(PACKAGE.parent).as_posix()
            # a checkout on Windows may have other ends of lines
            content = path.read_bytes().replace(b"\r\n", b"\n")
            digest.update(f"{name} {len(content)}\n".encode() + content)
    return digest.hexdigest()[:16]


@cache
def solver_digest() -> str:
    """Return the digest of all that `trackroller.solve` depends on except the values in a fingerprint."""
    digest = code_digest(SOLVER, leave_out=BY_VALUE)
    own = {path.stem: sha for path, sha in digests().items()}
    if own:
        return hashlib.sha256(f"{digest} {sorted(own.items())}".encode()).hexdigest()[:16]
    return digest


def digest_file(folder: str | Path, last: str, *beside: str, leave_out: Iterable[str] = ()) -> str:
    """Write the digest of rooms into a folder if it has changed, and return the path of the file.

    Parameters
    ----------
    folder : str or pathlib.Path
        Where digests are kept; it is created.
    last, *beside, leave_out
        What the digest covers, see `code_digest`.

    Returns
    -------
    str
        Path of the file. The file keeps its date while the code stays the same, so that it can be an input of a rule.
    """
    path = Path(folder) / f"{'.'.join([last, *(Path(name).stem for name in beside[:1])])}.txt"
    digest = code_digest(last, *beside, leave_out=leave_out) + "\n"
    if not path.is_file() or path.read_text(encoding="utf-8") != digest:
        put_text(path, digest)
    return str(path)
