"""The manifest of a folder: which files in it this program wrote, and what they hold.

`plan.json` marks the folder of a study as ours. `plan/files.jsonl` lists the files that this
program wrote there, one line for each content that a file has had or is about to get: its path and
the SHA-256 of the content. Lines are only added. This is promised:

1. A folder is ours if its `plan.json` bears our mark and fits its own digest. The mark is the first
   file of a folder (`mark.py`). Any other folder that is not empty is refused, whatever it holds
   (`folder.py`).
2. A file is replaced or removed only if it holds what this program wrote: the manifest lists its
   digest. If something else stands in its place, the command stops and names it. The user moves or
   removes it and starts again.
3. The digest is written down before the file. A process that is killed in between leaves a file of
   ours: the one of before, whose digest is listed too.
4. A block of cases needs no line: it is named by its cases and ends with its checksum
   (`chunks.py`). The plan holds its own digest. A log keeps changing: it is ours by its name, once
   it is listed.
5. A file is made in `plan/.scratch/` and renamed when it is whole. The sole holder of the study's
   lock empties that folder, in which only killed processes leave something.
6. The RO-Crate of a finished study lists the same digests and goes where the folder goes: a copy
   without the plan can be read, verified and solved again. The crate is removed before a file that
   it lists changes.
7. A link inside the folder is refused. Every other file stays as it is.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
import stat
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from trackroller.errors import InputError, WorkError
from trackroller.files import disk_errors, is_link, locked, open_here, refuse_link, scratch_name
from trackroller.study.store.crate_entries import CRATE, digests_of_crate
from trackroller.study.store.digests import digest_of_file, ends_with_checksum
from trackroller.study.store.mark import LIST, MARK, is_study

WHAT = "results folder"  # in messages
SCRATCH = "plan/.scratch"
LOCK = "plan/.manifest"
GATHERED = "study.nc"
# what is made from the gathered results
REPORT = ("sensitivity.nc", "report.html", "figures", "tables")
# in place of a digest: what stands there, if anything, is not the newest result
OUTDATED = "outdated"
CHANGING = "changing"  # in place of a digest: a log, which is ours by its name
EMPTY = (".lock", ".solved")  # locks and marks, whose name says all
BLOCK = re.compile(r"(plan|chunks)/[0-9a-f]{16}\.nc")
Contents = dict[str, list[str]]  # digests of each file by its path in the folder, the newest last


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
        """Return the digests of all files, read once: a caller that asks about many files passes
        them on.
        """
        listed: Contents = {}
        with contextlib.suppress(OSError), open_here(self.path, "rb") as stream:
            for line in stream:
                # a line that was cut off
                with contextlib.suppress(ValueError, TypeError, KeyError, RecursionError):
                    entry = json.loads(line)
                    listed.setdefault(str(entry["file"]), []).append(str(entry["sha256"]))
        return {name: digests for name, digests in listed.items() if _is_inside(name)}

    def current(self, path: Path) -> dict[str, str]:
        """Return the newest digest of each file of a result, which is a file or a folder; {} if it
        is outdated.
        """
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
        folder = self.root / SCRATCH
        for part in self.parts(folder):
            refuse_link(part, WHAT)
        return scratch_name(folder / self.name_of(path).replace("/", "."))

    def note(self, digests: Mapping[str, str]) -> None:
        """Write down what files are about to hold; the first line of a list names the list
        itself.
        """
        self.check()
        with disk_errors(self.path):
            self.path.parent.mkdir(parents=True, exist_ok=True)
            with self._locked(), open_here(self.path, "ab+") as stream:
                entries = dict(digests)
                if stream.seek(0, os.SEEK_END) == 0:
                    entries = {self.name: CHANGING, **digests}
                lines = [
                    json.dumps({"file": name, "sha256": digest}) for name, digest in entries.items()
                ]
                if not _ends_with_line(stream):
                    lines.insert(0, "")
                stream.write("".join(f"{line}\n" for line in lines).encode())
                stream.flush()
                os.fsync(stream.fileno())

    def _locked(self) -> contextlib.AbstractContextManager[None]:
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
        if listed is None:
            listed = self.contents()
        digests = listed.get(name, [])
        return CHANGING in digests or digest_of_file(path) in {new, *digests} - {""}

    def check(
        self, *paths: Path, new: Mapping[Path, str] | None = None, damaged: Iterable[Path] = ()
    ) -> None:
        """Refuse to write where a link, a folder, a file of somebody else or a changed file of ours
        stands.

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
        digests = new or {}
        for part in sorted({part for path in (self.path, *paths) for part in self.parts(path)}):
            refuse_link(part, WHAT)
        if not self.owns(self.path, listed=listed):
            raise self._foreign([self.path], {})
        foreign = [path for path in paths if not self.owns(path, digests.get(path, ""), listed)]
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
        remedy = "Move or remove it, then start again."
        if len(paths) > 1:
            remedy = "Move or remove these files, then start again."
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
    """Return the manifest of the study in whose folder a path lies, None if it lies in none, or is
    temporary.
    """
    root = next((parent for parent in list(path.parents)[:4] if is_study(parent)), None)
    if root is None or root / SCRATCH in path.parents:
        return None
    return Manifest(root)


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
        digest = digest_of_file(file)
        if digest in digests:
            continue
        if listed != _listed(path)[1]:  # another process has just written the result
            return why_altered(path)
        if not digest:
            return f"{file} is missing, but its SHA-256 stands in {source}"
        stands = f"its SHA-256 is {digest}, but {digests[-1]} stands in {source}"
        return f"{file} was altered or damaged after it was written: {stands}"
    return None


def _listed(path: Path) -> tuple[Path, Contents, Path]:
    """Return the folder of a result, the digests that are listed of its files, and the file that
    lists them.
    """
    manifest = manifest_of(path)
    if manifest is not None:
        current = manifest.current(path)
        if current:
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
    reason = why_altered(path)
    if reason is not None:
        remedy = (
            "Move or remove it; `trackroller run STUDY --report` then makes it again from "
            "the chunks"
        )
        raise WorkError(f"{reason}. {remedy}, which are kept.")
    return path


def digests_of(path: Path) -> dict[str, str]:
    """Return the digest of each file of a result; {} unless it is listed and holds what was written
    down last.
    """
    root, listed, _ = _listed(path)
    newest = {name: digests[-1] for name, digests in listed.items()}
    if all(digest_of_file(root / name) == digest for name, digest in newest.items()):
        return newest
    return {}


def remove_empty(root: Path) -> None:
    """Remove a folder and the folders in it, as far as no file is left in them."""
    for folder, _, _ in os.walk(root, topdown=False):
        with contextlib.suppress(OSError):
            os.rmdir(folder)


def files_below(root: Path) -> list[Path]:
    """Return all files below a folder, in order."""
    return sorted(Path(folder, name) for folder, _, names in os.walk(root) for name in names)


def _is_inside(name: str) -> bool:
    """Return whether a name does not lead out of its folder."""
    return not Path(name).is_absolute() and ".." not in Path(name).parts


def _ends_with_line(stream: IO[bytes]) -> bool:
    """Return whether a file is empty or ends with a whole line; a killed process may have cut its
    last line off.
    """
    if stream.seek(0, os.SEEK_END) == 0:
        return True
    stream.seek(-1, os.SEEK_END)
    return stream.read(1) == b"\n"
