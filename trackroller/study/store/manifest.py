"""The manifest of a study's folder: whose the folder is, which files in it are ours, and what they hold.

`plan.json` is the manifest of a study. It bears our mark, holds the plan (which case is solved in which chunk), and
lists under `files` the SHA-256 of each result that this program wrote into the folder. The rules are:

1. A folder is ours if its `plan.json` bears our mark and fits its own digest. The mark is the first file of a folder. A
   folder without it that is not empty is somebody else's, and one with the mark of another format is that of another
   version. Both are refused; nothing else in a folder tells whose it is.
2. A file is ours as long as it holds what we wrote. The manifest lists its digest, or the file proves itself: a block
   of cases ends with its checksum (`chunks.py`), and a JSON record of the program holds its own digest
   (`write_record`). Locks and marks are empty files, and a log begins with a line of ours.
3. Only a file of ours is replaced or removed. If another file stands in its place, or ours with other content, the
   command stops and names it. The user moves or removes the file and starts again.
4. A digest is written down before its file. While a file is replaced, the manifest lists the old and the new digest,
   so that a process that is killed in between leaves a file of ours.
5. A file is made in `plan/.scratch/` and renamed when it is whole. The sole holder of the study's lock empties that
   folder, in which only killed processes leave something.
6. The RO-Crate of a finished study lists the same digests. It goes where the folder goes: a copy without the plan can be
   read, verified and solved again, but is not written into. The crate is removed before a file that it lists changes,
   and with earlier results goes what was made from them.
7. Links inside the folder are refused; `results` and `results/NAME` may be links.
8. Every other file stays as it is.

`replace.py` writes and removes files by these rules, `verify.py` compares them with their digests.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import json
import os
import re
import stat
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from trackroller.errors import InputError
from trackroller.files import (
    disk_errors,
    is_link,
    locked,
    open_here,
    refuse_link,
    refuse_links,
    scratch_name,
    sha256,
    write_whole,
)

MARK, CRATE = "plan.json", "ro-crate-metadata.json"
LONE = ".trackroller.json"  # manifest of a folder of figures that lies in no study
STORE_FORMAT = 2  # raise it when a file of the store gets another meaning; other formats are refused
OURS = {"store_format": STORE_FORMAT, "made_by": "trackroller"}
SCRATCH, LOCK = "plan/.scratch", "plan/.manifest"
WHAT = "results folder"  # in messages
BLOCK = re.compile(r"(plan|chunks)/[0-9a-f]{16}\.nc")
RECORD = re.compile(r"plan\.json|looks/\d+\.json|\.page\.json|(.*/)?\.trackroller\.json")
LOG = re.compile(r"logs/.+\.log|page\.log")
BEGIN_OF_LOG = re.compile(rb"\d{4}-\d\d-\d\d \d\d:\d\d:\d\d,\d{3} |trackroller: ")
AGAIN = "Move or remove it, then start again."
Digests = dict[str, list[str]]  # of each file, by its path in the folder; two while a file is replaced


def read_record(path: Path) -> dict[str, Any]:
    """Return a JSON record of the program; {} if it is missing, altered, or not in the format of this version."""
    record = _stored_record(path)
    if record.get("store_format") != STORE_FORMAT:
        return {}
    return {key: value for key, value in record.items() if key not in OURS}


def write_record(path: Path, record: Mapping[str, Any], beside: Path | None = None) -> None:
    """Write a JSON record with our mark and its digest; `beside` is its temporary path."""
    text = _signed(record)
    write_whole(path, lambda place: place.write_text(text, encoding="utf-8", newline="\n"), beside)


def _signed(record: Mapping[str, Any]) -> str:
    """Return the text of a record with our mark and its digest."""
    marked = {**OURS, **record}
    return json.dumps({**marked, "digest": _digest_of(marked)}) + "\n"


def _digest_of(record: Mapping[str, Any]) -> str:
    return hashlib.sha256(json.dumps(record, sort_keys=True).encode()).hexdigest()


def _stored_record(path: Path) -> dict[str, Any]:
    """Return a record of any format with our mark, {} if there is none that fits its digest."""
    try:
        state = os.lstat(path)
        return dict(_parsed(path, (state.st_ino, state.st_mtime_ns, state.st_size, state.st_mode)))
    except OSError:
        return {}


@functools.lru_cache(64)  # each written file asks for it, and the plan of a large study has megabytes
def _parsed(path: Path, state: tuple[int, ...]) -> dict[str, Any]:
    try:
        with open_here(path, "rb") as stream:
            record = json.load(stream)
        sound = record.pop("digest") == _digest_of(record) and record["made_by"] == OURS["made_by"]
        return record if sound else {}
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return {}


def is_study(root: Path) -> bool:
    """Return whether a folder bears our mark."""
    return bool(_stored_record(root / MARK).get("store_format") == STORE_FORMAT)


def mark_folder(root: Path) -> None:
    """Make a folder ours: write its mark as the first file in it, unless it has one.

    An empty `plan.json`, as a process leaves it that is killed here, counts as none. The lock lets one of several
    processes write the mark.
    """
    with open_here(root / MARK, "ab") as stream:
        if os.fstat(stream.fileno()).st_size:
            return
    with locked(root / MARK), open_here(root / MARK, "ab") as stream:
        if os.fstat(stream.fileno()).st_size:
            return
        try:
            stream.write(_signed({}).encode())
            stream.flush()
            os.fsync(stream.fileno())
        except OSError:
            stream.truncate(0)
            raise


def check_folder(root: Path) -> None:
    """Refuse a folder of somebody else or of another version, and links inside a folder.

    Raises
    ------
    InputError
        If the folder exists, is not empty and does not bear our mark, or holds a link.
    """
    if not root.is_dir():
        return
    with disk_errors(root):
        refuse_link(root / MARK, WHAT)
        if is_study(root):
            refuse_links(root, WHAT, inside=True)
        elif "store_format" in _stored_record(root / MARK):
            allowed, wrong = "a folder of this version", "was made by another version of trackroller"
            remedy = "Move the folder away and run the study again: its cases are solved anew."
            raise InputError(WHAT, str(root), allowed, remedy, wrong)
        elif not _is_empty(root):
            raise _somebody_elses(root)


def check_readable(root: Path) -> None:
    """Refuse to read a folder with links inside, or with a `plan.json` of somebody else; it may be without one."""
    refuse_links(root, WHAT, inside=True)
    if os.path.lexists(root / MARK):
        check_folder(root)


def _is_empty(root: Path) -> bool:
    """Return whether a folder holds no file and no link, at any level, but the empty mark of a killed process."""
    for place, folders, names in os.walk(root):
        files = [Path(place, name) for name in names]
        if any(is_link(path) for path in (*files, *(Path(place, name) for name in folders))):
            return False
        if any(path != root / MARK or path.stat().st_size for path in files):
            return False
    return True


def _somebody_elses(root: Path) -> InputError:
    """Return the error for a folder without our mark."""
    names = sorted(os.listdir(root))
    holds = ", ".join(names[:4])
    if len(names) > 4:
        holds += f" and {len(names) - 4} more"
    remedy = "Give the study another name, choose another --results, or move the folder away."
    if MARK in names:
        holds += f"; its {MARK} is damaged or somebody else's"
        remedy = f"Restore {MARK} from a copy, or move the folder away and solve the study anew."
    allowed, wrong = "a new or empty folder, or one that trackroller made", "was not made by trackroller and holds"
    return InputError(WHAT, str(root), allowed, remedy, f"{wrong} {holds}")


@dataclass(frozen=True)
class Manifest:
    """The manifest of a folder.

    Parameters
    ----------
    root : pathlib.Path
        The folder from which the manifest names files.
    name : str
        Its path in the folder: `plan.json` for a study.
    """

    root: Path
    name: str = MARK

    @property
    def path(self) -> Path:
        """Return the file."""
        return self.root / self.name

    @property
    def of_study(self) -> bool:
        """Return whether this is the manifest of a study."""
        return self.name == MARK

    @property
    def plan(self) -> dict[str, Any]:
        """Return the plan of a study; {} if there is none, or the manifest was altered."""
        return {key: value for key, value in read_record(self.path).items() if key != "files"}

    @property
    def files(self) -> Digests:
        """Return the digests of all files; an entry that leads out of the folder does not count."""
        listed = read_record(self.path).get("files", {})
        return {name: list(digests) for name, digests in listed.items() if _is_inside(name)}

    def name_of(self, path: Path) -> str:
        """Return the name of a file in the manifest."""
        return path.relative_to(self.root).as_posix()

    def below(self, path: Path) -> Digests:
        """Return the digests of a result, which is a file or a folder."""
        place = self.name_of(path)
        return {name: known for name, known in self.files.items() if name == place or name.startswith(f"{place}/")}

    def scratch(self, path: Path) -> Path:
        """Return the temporary path at which this process makes a file or folder."""
        if not self.of_study:
            return scratch_name(path)
        return scratch_name(self.root / SCRATCH / self.name_of(path).replace("/", "."))

    @contextlib.contextmanager
    def held(self) -> Iterator[None]:
        """Keep other processes from changing the manifest of a study, and the files that it lists."""
        if not self.of_study:
            yield
            return
        lock = self.root / LOCK
        refuse_link(lock.parent, WHAT)
        with disk_errors(lock):
            lock.parent.mkdir(exist_ok=True)
        with locked(lock):
            yield

    def note(self, names: Mapping[str, str]) -> None:
        """Add the digests that files are about to get to those that they have; `held` must be entered."""
        files = self.files
        for name, digest in names.items():
            known = files.get(name, [])
            files[name] = sorted({*known, digest})
        self.write(self.plan, files)

    def settle(self, names: Mapping[str, str], gone: Iterable[str] = ()) -> None:
        """Keep the digests that files have now, and drop the files that are gone; `held` must be entered."""
        files = self.files | {name: [digest] for name, digest in names.items()}
        for name in gone:
            files.pop(name, None)
        self.write(self.plan, files)

    def write(self, plan: Mapping[str, Any], files: Digests) -> None:
        """Write the manifest if it changes; `held` must be entered."""
        record = {**plan, "files": dict(sorted(files.items()))}
        if record != read_record(self.path):
            write_record(self.path, record, self.scratch(self.path))

    def owns(self, path: Path, content: str = "", known: Digests | None = None) -> bool:
        """Return whether the place of a file is free, or holds a file of ours that was not changed.

        Parameters
        ----------
        path : pathlib.Path
            The file.
        content : str
            Digest of what is about to be written: a file that holds it already is in nobody's way.
        known : dict, optional
            The digests of all files, if the caller has read them.
        """
        try:
            state = os.lstat(path)
        except FileNotFoundError:
            return True
        except NotADirectoryError:
            return False
        if not stat.S_ISREG(state.st_mode):
            return False
        name = self.name_of(path)
        digests = (self.files if known is None else known).get(name)
        if digests is not None or content:
            return digest_of_file(path) in {*(digests or ()), content}
        return _proves_itself(path, name, state.st_size)

    def check(self, *paths: Path, contents: Mapping[Path, str] | None = None, damaged: Iterable[Path] = ()) -> None:
        """Refuse to write where a link, a folder, a file of somebody else or a changed file of ours stands.

        Parameters
        ----------
        *paths : pathlib.Path
            The files to write.
        contents : dict, optional
            Digests of what is about to be written, see `owns`.
        damaged : iterable of pathlib.Path
            Files of which the caller has found that they are damaged.

        Raises
        ------
        InputError
            It names every such file.
        """
        known = self.files
        new = contents or {}
        for part in {part for path in paths for part in self.parts(path)}:
            refuse_link(part, WHAT)
        foreign = [*damaged, *(path for path in paths if not self.owns(path, new.get(path, ""), known))]
        if foreign:
            raise self._foreign(foreign, known)

    def parts(self, path: Path) -> list[Path]:
        """Return a path and the folders above it, down to those in the root."""
        return [path, *(parent for parent in path.parents if self.root in parent.parents)]

    def _foreign(self, paths: list[Path], known: Digests) -> InputError:
        """Return the error for files in whose place nothing is written."""
        first = paths[0]
        if first.is_dir():
            wrong = "is a folder"
        elif self.name_of(first) in known or BLOCK.fullmatch(self.name_of(first)):
            wrong = "was altered or damaged after it was written"
        else:
            wrong = "was not written by trackroller"
        if len(paths) > 1:
            others = ", ".join(map(str, paths[1:6]))
            wrong += f"; so it is with {others}"
        if len(paths) > 6:
            wrong += f" and {len(paths) - 6} more"
        remedy = AGAIN if len(paths) == 1 else AGAIN.replace(" it,", " these files,")
        return InputError(WHAT, str(first), "a file as trackroller wrote it", remedy, wrong)


def manifest_of(path: Path) -> Manifest | None:
    """Return the manifest of the study in whose folder a path lies, None if it lies in none."""
    roots = (parent for parent in list(path.parents)[:4] if is_study(parent))
    root = next(roots, None)
    return None if root is None else Manifest(root)


def _is_inside(name: str) -> bool:
    """Return whether a name does not lead out of its folder."""
    return not Path(name).is_absolute() and ".." not in Path(name).parts


def _proves_itself(path: Path, name: str, size: int) -> bool:
    """Return whether a file that no manifest lists is ours by what it holds."""
    if BLOCK.fullmatch(name):
        return ends_with_checksum(path)
    if RECORD.fullmatch(name):
        return bool(_stored_record(path))
    if LOG.fullmatch(name) and size:
        with open_here(path, "rb") as stream:
            return bool(BEGIN_OF_LOG.match(stream.read(64)))
    return size == 0  # a lock or a mark; an empty file holds nothing that could be lost


def ends_with_checksum(path: Path) -> bool:
    """Return whether the last 32 bytes of a file are the SHA-256 of the bytes before them."""
    with open_here(path, "rb") as stream:
        content = stream.read()
    return bool(hashlib.sha256(content[:-32]).digest() == content[-32:])


def digest_of_file(path: Path) -> str:
    """Return the digest of a regular file, '' for anything else."""
    try:
        return sha256(path) if stat.S_ISREG(os.lstat(path).st_mode) else ""
    except OSError:
        return ""


def digest_of(text: str) -> str:
    """Return the digest of a text as it is written to a file."""
    return hashlib.sha256(text.encode()).hexdigest()


def files_below(root: Path) -> list[Path]:
    """Return all files below a folder, in order."""
    return sorted(Path(place, name) for place, _, names in os.walk(root) for name in names)


def crate_graph(root: Path) -> list[dict[str, Any]]:
    """Return the entries of the crate of a folder, [] if there is no crate."""
    try:
        with open_here(root / CRATE, "rb") as stream:
            return [entry for entry in json.load(stream)["@graph"] if isinstance(entry, dict)]
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return []


def digests_of_crate(root: Path) -> dict[str, str]:
    """Return the digests of the files that the crate of a folder lists, {} if there is no crate."""
    return {str(entry.get("@id")): str(entry["sha256"]) for entry in crate_graph(root) if "sha256" in entry}
