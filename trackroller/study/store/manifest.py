"""The manifest of a folder: which files in it this program wrote, and what they hold.

`plan.json` marks the folder of a study as ours. `plan/files.jsonl` lists the files that this program
wrote there, one line for each content that a file has had or is about to get: its path and the
SHA-256 of the content. Lines are only added. This is promised:

1. A folder is ours if its `plan.json` bears our mark and fits its own digest. The mark is the first
   file of a folder. Any other folder that is not empty is refused, whatever it holds (`folder.py`).
2. A file is replaced or removed only if it holds what this program wrote: the manifest lists its
   digest. If something else stands in its place, the command stops and names it. The user moves or
   removes it and starts again.
3. The digest is written down before the file. A process that is killed in between leaves a file of
   ours: the one of before, whose digest is listed too.
4. A block of cases needs no line: it is named by its cases and ends with its checksum (`chunks.py`).
   The plan holds its own digest. A log keeps changing: it is ours by its name, once it is listed.
5. A file is made in `plan/.scratch/` and renamed when it is whole. The sole holder of the study's
   lock empties that folder, in which only killed processes leave something.
6. The RO-Crate of a finished study lists the same digests and goes where the folder goes: a copy
   without the plan can be read, verified and solved again. The crate is removed before a file that
   it lists changes.
7. A link inside the folder is refused. Every other file stays as it is.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import json
import os
import re
import shutil
import stat
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from trackroller.errors import InputError, WorkError
from trackroller.files import (
    STUDY_MARK,
    check_place,
    disk_errors,
    flush,
    is_link,
    locked,
    open_here,
    refuse_link,
    scratch_name,
    sha256,
    sync_folder,
    write_whole,
)

WHAT = "results folder"  # in messages
MARK = STUDY_MARK
LIST = "plan/files.jsonl"
CRATE = "ro-crate-metadata.json"
LONE = ".trackroller.jsonl"  # manifest of a folder of figures that lies in no study
STORE_FORMAT = 1  # raise it when a file of the store gets another meaning; other formats are refused by name
OURS = {"store_format": STORE_FORMAT, "made_by": "trackroller", "manifest": LIST}  # the mark
SCRATCH = "plan/.scratch"
LOCK = "plan/.manifest"
MAPPINGS = ("inputs", "chunks")  # keys of the plan that hold an entry for each name
GATHERED = "study.nc"
REPORT = ("sensitivity.nc", "report.html", "figures", "tables")  # what is made from the gathered results
OUTDATED = "outdated"  # in place of a digest: what stands there, if anything, is not the newest result
CHANGING = "changing"  # in place of a digest: a log, which is ours by its name
EMPTY = (".lock", ".solved")  # locks and marks, whose name says all
BLOCK = re.compile(r"(plan|chunks)/[0-9a-f]{16}\.nc")
AGAIN = "Move or remove it, then start again."
Contents = dict[str, list[str]]  # digests of each file by its path in the folder, the newest last


def signed(record: Mapping[str, Any]) -> str:
    """Return the text of a plan with our mark and its digest."""
    marked = {**OURS, **record}
    return json.dumps({**marked, "digest": _digest_of(marked)}) + "\n"


def _digest_of(record: Mapping[str, Any]) -> str:
    return hashlib.sha256(json.dumps(record, sort_keys=True).encode()).hexdigest()


def read_mark(root: Path) -> dict[str, Any]:
    """Return what `plan.json` of a folder says, of any version; {} if there is none, or it does not fit its digest."""
    path = root / MARK
    try:
        state = os.lstat(path)
        return dict(_parsed_mark(path, (state.st_ino, state.st_mtime_ns, state.st_size, state.st_mode)))
    except OSError:
        return {}


@functools.lru_cache(64)  # each written file asks for it, and the plan of a large study has megabytes
def _parsed_mark(path: Path, state: tuple[int, ...]) -> dict[str, Any]:
    try:
        with open_here(path, "rb") as stream:
            record = json.load(stream)
        known = record.pop("digest") == _digest_of(record)
        whole = all(isinstance(record.get(key, {}), dict) for key in MAPPINGS)
        return record if known and whole else {}
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return {}


def is_study(root: Path) -> bool:
    """Return whether a folder bears our mark."""
    return OURS.items() <= read_mark(root).items()


@dataclass(frozen=True)
class Manifest:
    """The list of the files that this program wrote into a folder.

    Parameters
    ----------
    root : pathlib.Path
        The folder, from which the list names files.
    name : str
        Path of the list in the folder: `plan/files.jsonl` in a study.
    """

    root: Path
    name: str = LIST

    @property
    def path(self) -> Path:
        """Return the file with the list."""
        return self.root / self.name

    @property
    def of_study(self) -> bool:
        """Return whether this is the manifest of a study."""
        return self.name == LIST

    def contents(self) -> Contents:
        """Return the digests of all files, read once: a caller that asks about many files passes them on."""
        listed: Contents = {}
        with contextlib.suppress(OSError), open_here(self.path, "rb") as stream:
            for line in stream:
                with contextlib.suppress(ValueError, TypeError, KeyError, RecursionError):  # a line that was cut off
                    entry = json.loads(line)
                    listed.setdefault(str(entry["file"]), []).append(str(entry["sha256"]))
        return {name: digests for name, digests in listed.items() if _is_inside(name)}

    def current(self, path: Path) -> dict[str, str]:
        """Return the newest digest of each file of a result, which is a file or a folder; {} if it is outdated."""
        newest: dict[str, str] = {}
        for name, digests in sorted(self.contents().items()):
            file = self.root / name
            if path in (file, *file.parents) and digests[-1] not in (OUTDATED, CHANGING):
                newest[name] = digests[-1]
        return newest

    def name_of(self, path: Path) -> str:
        """Return the name of a file in the list."""
        return path.relative_to(self.root).as_posix()

    def parts(self, path: Path) -> list[Path]:
        """Return a path and the folders above it, down to those in the root."""
        return [path, *(parent for parent in path.parents if self.root in parent.parents)]

    def scratch(self, path: Path) -> Path:
        """Return the temporary path at which this process makes a file or folder."""
        if not self.of_study:
            return scratch_name(path)
        place = self.root / SCRATCH
        for part in self.parts(place):
            refuse_link(part, WHAT)
        return scratch_name(place / self.name_of(path).replace("/", "."))

    def note(self, digests: Mapping[str, str]) -> None:
        """Write down what files are about to hold; the first line of a list names the list itself."""
        self.check()
        with disk_errors(self.path):
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with self._held(), open_here(self.path, "ab+") as stream:
                noted = dict(digests)
                if stream.seek(0, os.SEEK_END) == 0:
                    noted = {self.name: CHANGING, **digests}
                lines = [json.dumps({"file": name, "sha256": digest}) for name, digest in noted.items()]
                if not _ends_with_line(stream):
                    lines.insert(0, "")
                stream.write("".join(f"{line}\n" for line in lines).encode())
                stream.flush()
                os.fsync(stream.fileno())

    def _held(self) -> contextlib.AbstractContextManager[None]:
        """Keep other processes from adding lines to the list of a study, on a network disk too."""
        if self.of_study:
            return locked(self.root / LOCK)
        return contextlib.nullcontext()

    def owns(self, path: Path, new: str = "", listed: Contents | None = None) -> bool:
        """Return whether the place of a file is free, or holds a file of ours that was not changed.

        Parameters
        ----------
        path : pathlib.Path
            The file.
        new : str
            Digest of what is about to be written: a file that holds it already is in nobody's way.
        listed : dict, optional
            The digests of all files, if the caller has read them.
        """
        try:
            state = os.lstat(path)
        except FileNotFoundError:
            return True
        except NotADirectoryError:
            return False
        name = self.name_of(path)
        if not stat.S_ISREG(state.st_mode):
            return False
        if self.of_study and name == MARK:
            return is_study(self.root)
        if self.of_study and BLOCK.fullmatch(name):
            return ends_with_checksum(path)
        if state.st_size == 0 and (path.suffix in EMPTY or path == self.path):
            return True
        known = (self.contents() if listed is None else listed).get(name, [])
        return CHANGING in known or digest_of_file(path) in {new, *known} - {""}

    def check(self, *paths: Path, new: Mapping[Path, str] | None = None, damaged: Iterable[Path] = ()) -> None:
        """Refuse to write where a link, a folder, a file of somebody else or a changed file of ours stands.

        The list itself is always looked at.

        Parameters
        ----------
        *paths : pathlib.Path
            The files to write.
        new : dict, optional
            Digests of what is about to be written, see `owns`.
        damaged : iterable of pathlib.Path
            Files of which the caller has found that they are damaged.

        Raises
        ------
        InputError
            It names every such file.
        """
        listed = self.contents()
        coming = new or {}
        for part in sorted({part for path in (self.path, *paths) for part in self.parts(path)}):
            refuse_link(part, WHAT)
        if not self.owns(self.path, listed=listed):
            raise self._foreign([self.path], {})
        foreign = [path for path in paths if not self.owns(path, coming.get(path, ""), listed)]
        foreign += damaged
        if foreign:
            raise self._foreign(foreign, listed)

    def _foreign(self, paths: list[Path], listed: Contents) -> InputError:
        """Return the error for what stands where nothing may be written."""
        first = paths[0]
        name = self.name_of(first)
        if first.is_dir():
            wrong = "is a folder"
        elif name in listed or BLOCK.fullmatch(name):
            wrong = "was altered or damaged after it was written"
        else:
            wrong = "was not written by trackroller"
        if len(paths) > 1:
            wrong += f"; so it is with {', '.join(map(str, paths[1:6]))}"
        if len(paths) > 6:
            wrong += f" and {len(paths) - 6} more"
        if len(paths) == 1:
            remedy = AGAIN
        else:
            remedy = AGAIN.replace(" it,", " these files,")
        return InputError("file", str(first), "a file as trackroller wrote it", remedy, wrong)

    def discard(self, *results: Path) -> None:
        """Remove results, files or folders; a file that was changed stays, as somebody else's."""
        names = [name for result in results for name in self.current(result)]
        if names:
            self.note(dict.fromkeys(names, OUTDATED))
        self.unlink(self.root / name for name in names)
        for result in results:
            remove_empty(result)

    def unlink(self, paths: Iterable[Path]) -> None:
        """Remove the files that are ours and unchanged."""
        listed = self.contents()
        for path in paths:
            if not any(map(is_link, self.parts(path))) and self.owns(path, listed=listed):
                path.unlink(missing_ok=True)


def manifest_of(path: Path) -> Manifest | None:
    """Return the manifest of the study in whose folder a path lies, None if it lies in none, or is temporary."""
    root = next((parent for parent in list(path.parents)[:4] if is_study(parent)), None)
    if root is None or root / SCRATCH in path.parents:
        return None
    return Manifest(root)


def _manifest_to_write(path: Path) -> Manifest | None:
    """Return the manifest of a file to write; refuse a study whose mark was damaged or removed meanwhile."""
    manifest = manifest_of(path)
    if manifest is None:
        for parent in list(path.parents)[:4]:
            if os.path.lexists(parent / LIST) and not is_study(parent):
                remedy = f"Restore {MARK} from a copy, or move the folder away, then start again."
                raise InputError(WHAT, str(parent / MARK), "the plan of the study", remedy, "is missing or damaged")
    return manifest


@contextlib.contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield a temporary path; what the caller writes there replaces the result at `path`.

    Of a folder, each file is put in place; files that the folder holds beside stay. Outside of a study, a lone file is
    replaced as it stands, and a folder keeps a manifest of its own.

    Raises
    ------
    InputError
        If a link, a file of somebody else, or a changed file of ours stands in the place of a file.
    WorkError
        If the files cannot be written.
    """
    check_place(path, "file to write")
    manifest = _manifest_to_write(path)
    if manifest is None:
        beside = scratch_name(path)
    else:
        beside = manifest.scratch(path)
    try:
        with disk_errors(path):
            path.parent.mkdir(parents=True, exist_ok=True)
            beside.parent.mkdir(parents=True, exist_ok=True)
        yield beside
        with disk_errors(path):
            if manifest is None and beside.is_dir():
                manifest = Manifest(path, LONE)
            if manifest is None:
                _put_in_place({path: beside})
            else:
                _replace(manifest, path, beside)
    finally:
        _remove_scratch(beside)


def _replace(manifest: Manifest, path: Path, beside: Path) -> None:
    """Put what was made at a temporary path in the place of a result, after its digests were written down."""
    made = {path: beside}
    if beside.is_dir():
        made = {path / file.relative_to(beside): file for file in files_below(beside)}
    new = {goal: sha256(file) for goal, file in made.items()}
    manifest.check(*made, new=new)
    digests = {manifest.name_of(goal): digest for goal, digest in new.items()}
    before = manifest.current(path)
    if before == digests and all(digest_of_file(goal) == digest for goal, digest in new.items()):
        return  # what stands there keeps its date
    gone = before.keys() - digests.keys()
    outdated = dict.fromkeys(gone, OUTDATED)
    if manifest.of_study and digests.get(GATHERED, before.get(GATHERED)) != before.get(GATHERED):
        for part in REPORT:
            outdated |= dict.fromkeys(manifest.current(manifest.root / part), OUTDATED)
    if manifest.of_study:
        _remove_crate(manifest, outdated | digests)
    manifest.note(outdated | digests)
    _put_in_place(made)
    manifest.unlink(manifest.root / name for name in gone)


def _remove_crate(manifest: Manifest, digests: Mapping[str, str]) -> None:
    """Remove the crate if it lists one of some files with another digest."""
    listed = digests_of_crate(manifest.root)
    if any(listed.get(name, digest) != digest for name, digest in digests.items()):
        manifest.discard(manifest.root / CRATE)


def _put_in_place(made: Mapping[Path, Path]) -> None:
    """Rename files that are whole to where they belong."""
    for file in made.values():
        flush(file)
    for goal, file in made.items():
        goal.parent.mkdir(parents=True, exist_ok=True)
        os.replace(file, goal)
    for place in {goal.parent for goal in made}:
        sync_folder(place)


def put(path: Path, save: Callable[[Path], object]) -> Path:
    """Write a file, see `replacing`: `save` writes its content to the temporary path that it receives."""
    with replacing(path) as beside, disk_errors(path):
        save(beside)
    return path


def put_text(path: Path, text: str) -> Path:
    """Write a text file, see `put`."""
    return put(path, lambda beside: beside.write_text(text, encoding="utf-8", newline="\n"))


def put_unlisted(path: Path, save: Callable[[Path], object]) -> None:
    """Write a file whose digest the manifest does not list: a block of cases, a plan, or a file that was claimed."""
    manifest = _manifest_to_write(path)
    if manifest is None:
        write_whole(path, save)
        return
    manifest.check(path)
    write_whole(path, save, manifest.scratch(path))


def claim(path: Path) -> Path:
    """Make a file that keeps changing, such as a log, ours by its name; refuse one of somebody else.

    Parameters
    ----------
    path : pathlib.Path
        The file; outside of a study nothing is done.
    """
    manifest = _manifest_to_write(path)
    if manifest is not None and CHANGING not in manifest.contents().get(manifest.name_of(path), []):
        manifest.check(path)
        manifest.note({manifest.name_of(path): CHANGING})
    return path


def why_altered(path: Path) -> str | None:
    """Return what is wrong with a result that is listed, None if it is as it was written.

    Parameters
    ----------
    path : pathlib.Path
        A file or folder in a study's folder. A folder may hold further files.
    """
    root, listed, source = _listed(path)
    for name, digests in listed.items():
        file = root / name
        now = digest_of_file(file)
        if now in digests:
            continue
        if listed != _listed(path)[1]:  # another process has just written the result
            return why_altered(path)
        if not now:
            return f"{file} is missing, but its SHA-256 stands in {source}"
        stands = f"its SHA-256 is {now}, but {digests[-1]} stands in {source}"
        return f"{file} was altered or damaged after it was written: {stands}"
    return None


def _listed(path: Path) -> tuple[Path, Contents, Path]:
    """Return the folder of a result, the digests that are listed of its files, and the file that lists them."""
    manifest = manifest_of(path)
    if manifest is None:
        current = {}
    else:
        current = manifest.current(path)
    if manifest is not None and current:
        contents = manifest.contents()
        return manifest.root, {name: contents[name] for name in current}, manifest.path
    of_crate = digests_of_crate(path.parent).items()
    below = {name: [digest] for name, digest in of_crate if Path(name).parts[:1] == (path.name,)}
    return path.parent, below, path.parent / CRATE


def check_unaltered(path: Path) -> Path:
    """Return the path of a result after its content was compared with its digest.

    Raises
    ------
    WorkError
        If the result was altered or damaged after it was written.
    """
    why = why_altered(path)
    if why is not None:
        remedy = "Move or remove it; `trackroller run STUDY --report` then makes it again from the chunks"
        raise WorkError(f"{why}. {remedy}, which are kept.")
    return path


def digests_of(path: Path) -> dict[str, str]:
    """Return the digest of each file of a result; {} unless it is listed and holds what was written down last."""
    root, listed, _ = _listed(path)
    newest = {name: digests[-1] for name, digests in listed.items()}
    if all(digest_of_file(root / name) == digest for name, digest in newest.items()):
        return newest
    return {}


def sweep(root: Path) -> None:
    """Remove what killed processes left half made; only the sole holder of the study's lock may call it."""
    scratch = root / SCRATCH
    if not any(map(is_link, Manifest(root).parts(scratch))):
        _remove_scratch(scratch)


def _remove_scratch(path: Path) -> None:
    if path.is_dir() and not is_link(path):
        shutil.rmtree(path, ignore_errors=True)
    with contextlib.suppress(OSError):
        path.unlink(missing_ok=True)


def remove_empty(root: Path) -> None:
    """Remove a folder and the folders in it, as far as no file is left in them."""
    for place, _, _ in os.walk(root, topdown=False):
        with contextlib.suppress(OSError):
            os.rmdir(place)


def files_below(root: Path) -> list[Path]:
    """Return all files below a folder, in order."""
    return sorted(Path(place, name) for place, _, names in os.walk(root) for name in names)


def ends_with_checksum(path: Path) -> bool:
    """Return whether the last 32 bytes of a file are the SHA-256 of the bytes before them."""
    with open_here(path, "rb") as stream:
        return sums_up(stream.read())


def sums_up(content: bytes) -> bool:
    """Return whether the last 32 bytes of a content are the SHA-256 of the bytes before them."""
    return hashlib.sha256(content[:-32]).digest() == content[-32:]


def digest_of_file(path: Path) -> str:
    """Return the digest of a regular file, '' for anything else."""
    try:
        if stat.S_ISREG(os.lstat(path).st_mode):
            return sha256(path)
        return ""
    except OSError:
        return ""


def digest_of_text(text: str) -> str:
    """Return the digest of a text as it is written to a file."""
    return hashlib.sha256(text.encode()).hexdigest()


def _is_inside(name: str) -> bool:
    """Return whether a name does not lead out of its folder."""
    return not Path(name).is_absolute() and ".." not in Path(name).parts


def _ends_with_line(stream: IO[bytes]) -> bool:
    """Return whether a file is empty or ends with a whole line; a killed process may have cut its last line off."""
    if stream.seek(0, os.SEEK_END) == 0:
        return True
    stream.seek(-1, os.SEEK_END)
    return stream.read(1) == b"\n"


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
