"""Digests of the folder of a study: which there are, and the one place that reads them.

- The fingerprint of a case names all that decides its numbers, see `trackroller.study.store.identity`.
- The checksum of a chunk, or of a list of cases, is the end of its file (`sums_up`): a file is proved by itself.
- The plan holds its own digest (`mark`), and with it the name and the state of every chunk.
- The record of a result, `plan/NAME.sha256` in the format of `sha256sum`, holds the digest of each of its files
  (`read_record`). It says that the files are ours, and whether they are those of the newest results.
- The crate of a finished study lists every file with its digest (`of_crate`). It goes where the folder goes.

Every digest is a SHA-256. `trackroller.study.store.ownership` asks which files are ours, and
`trackroller.study.store.seal` writes results and compares them before they are read.
"""

from __future__ import annotations

import functools
import hashlib
import json
import os
import re
import stat
from pathlib import Path
from typing import Any

from trackroller.files import STUDY_MARK, open_here, sha256

MARK, METADATA = STUDY_MARK, "ro-crate-metadata.json"
LONE = ".trackroller.sha256"  # record of a folder of figures that lies in no study
OUTDATED = "# outdated\n"  # first line of the record of a result that is not, or not yet, the newest one
MAPPINGS = ("inputs", "chunks")  # keys of `plan.json` that hold an entry for each name
LINE = re.compile(r"(?P<digest>[0-9a-f]{64})  (?P<name>[^\n]+)\n")
Digests = dict[str, set[str]]  # of each file, by its path in the folder of its study


def sums_up(content: bytes) -> bool:
    """Return whether the last 32 bytes of a file are the SHA-256 of the bytes before them."""
    return hashlib.sha256(content[:-32]).digest() == content[-32:]


def mark(root: Path) -> dict[str, Any]:
    """Return what `plan.json` of a folder says; {} if there is none, or it does not fit its digest."""
    path = root / MARK
    try:
        state = os.lstat(path)
        return dict(_mark(path, (state.st_ino, state.st_mtime_ns, state.st_size, state.st_mode)))
    except OSError:
        return {}


@functools.lru_cache(64)  # each chunk asks for it, and that of a large study has megabytes
def _mark(path: Path, state: tuple[int, ...]) -> dict[str, Any]:
    try:
        with open_here(path, "rb") as stream:
            record = json.load(stream)
        known = record.pop("digest") == record_digest(record)
        whole = all(isinstance(record.get(key, {}), dict) for key in MAPPINGS)
        return record if known and whole else {}
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return {}


def record_digest(record: dict[str, Any]) -> str:
    """Return the digest of a record, which stands in it as `digest`."""
    return hashlib.sha256(json.dumps(record, sort_keys=True).encode()).hexdigest()


def record_of(root: Path, path: Path) -> Path:
    """Return the file with the digests of a result of a study, in the format of `sha256sum`."""
    return root / "plan" / f"{path.relative_to(root).as_posix().replace('/', '.')}.sha256"


def read_record(record: Path) -> tuple[bool, Digests]:
    """Return whether a record of digests is that of the newest result, and the digests by file.

    A file has several digests while it is replaced. Files are named as the record names them, without '../'. A record
    that names a file outside its folder is not ours.
    """
    try:
        with open_here(record, "rb") as stream:
            text = stream.read().decode()
    except (OSError, ValueError):
        return False, {}
    lines, names = text.removeprefix(OUTDATED), Digests()
    if LINE.sub("", lines):
        return False, {}
    for line in LINE.finditer(lines):
        names.setdefault(line["name"].removeprefix("../"), set()).add(line["digest"])
    if any(Path(name).is_absolute() or ".." in Path(name).parts for name in names):
        return False, {}
    return not text.startswith(OUTDATED), names


def listed(root: Path) -> Digests:
    """Return the digests of all files in the records of a study.

    A caller that asks about many files reads the records once and passes them on.
    """
    known: Digests = {}
    for record in (*sorted((root / "plan").glob("*.sha256")), root / LONE):
        for name, digests in read_record(record)[1].items():
            known.setdefault(name, set()).update(digests)
    return known


def digest_of_file(path: Path) -> str:
    """Return the digest of a regular file, '' for anything else."""
    try:
        return sha256(path) if stat.S_ISREG(os.lstat(path).st_mode) else ""
    except OSError:
        return ""


def crate_graph(root: Path) -> list[dict[str, Any]]:
    """Return the entries of the crate of a folder, [] if there is no crate."""
    try:
        with open_here(root / METADATA, "rb") as stream:
            return [entry for entry in json.load(stream)["@graph"] if isinstance(entry, dict)]
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return []


def of_crate(root: Path) -> dict[str, str]:
    """Return the digests of the files that the crate of a folder lists, {} if there is no crate."""
    return {str(entry.get("@id")): str(entry["sha256"]) for entry in crate_graph(root) if "sha256" in entry}
