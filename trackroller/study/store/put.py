"""Put results into the folder of a study, each file whole and after its digest was written down.

`manifest.py` says what is promised. Outside of a study, a file is replaced as it stands.
"""

from __future__ import annotations

import contextlib
import os
import shutil
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from trackroller.errors import InputError
from trackroller.files import (
    check_place,
    disk_errors,
    flush,
    is_link,
    scratch_name,
    sha256,
    sync_folder,
    write_whole,
)
from trackroller.study.store.crate_entries import CRATE, digests_of_crate
from trackroller.study.store.digests import digest_of_file
from trackroller.study.store.manifest import (
    CHANGING,
    GATHERED,
    OUTDATED,
    REPORT,
    SCRATCH,
    WHAT,
    Manifest,
    files_below,
    manifest_of,
)
from trackroller.study.store.mark import LIST, MARK, is_study

LONE = ".trackroller.jsonl"  # manifest of a folder of figures that lies in no study


def _manifest_to_write(path: Path) -> Manifest | None:
    """Return the manifest of a file to write; refuse a study whose mark was damaged or removed
    meanwhile.
    """
    manifest = manifest_of(path)
    if manifest is not None:
        return manifest
    for parent in list(path.parents)[:4]:
        if os.path.lexists(parent / LIST) and not is_study(parent):
            remedy = f"Restore {MARK} from a copy, or move the folder away, then start again."
            raise InputError(
                WHAT, str(parent / MARK), "the plan of the study", remedy, "is missing or damaged"
            )
    return None


@contextlib.contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield a temporary path; what the caller writes there replaces the result at `path`.

    Of a folder, each file is put in place; files that the folder holds beside stay. Outside of a
    study, a lone file is replaced as it stands, and a folder keeps a manifest of its own.

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
    """Put what was made at a temporary path in the place of a result, after its digests were
    written down.
    """
    scratch_files = {path: beside}
    if beside.is_dir():
        scratch_files = {path / file.relative_to(beside): file for file in files_below(beside)}
    new = {goal: sha256(file) for goal, file in scratch_files.items()}
    manifest.check(*scratch_files, new=new)
    digests = {manifest.name_of(goal): digest for goal, digest in new.items()}
    before = manifest.current(path)
    if before == digests and all(digest_of_file(goal) == digest for goal, digest in new.items()):
        return  # what stands there keeps its date
    superfluous = before.keys() - digests.keys()
    changes = {**_outdated(manifest, before, digests), **digests}
    if manifest.of_study:
        _remove_crate(manifest, changes)
    manifest.note(changes)
    _put_in_place(scratch_files)
    manifest.unlink(manifest.root / name for name in superfluous)


def _outdated(
    manifest: Manifest, before: Mapping[str, str], digests: Mapping[str, str]
) -> dict[str, str]:
    """Return the mark of what new digests outdate: files that are not made again, and a report of
    earlier results.
    """
    outdated = dict.fromkeys(before.keys() - digests.keys(), OUTDATED)
    if manifest.of_study and digests.get(GATHERED, before.get(GATHERED)) != before.get(GATHERED):
        for part in REPORT:
            outdated |= dict.fromkeys(manifest.current(manifest.root / part), OUTDATED)
    return outdated


def _remove_crate(manifest: Manifest, digests: Mapping[str, str]) -> None:
    """Remove the crate if it lists one of some files with another digest."""
    listed = digests_of_crate(manifest.root)
    if any(listed.get(name, digest) != digest for name, digest in digests.items()):
        manifest.discard(manifest.root / CRATE)


def _put_in_place(scratch_files: Mapping[Path, Path]) -> None:
    """Rename files that are whole to where they belong."""
    for file in scratch_files.values():
        flush(file)
    for goal, file in scratch_files.items():
        goal.parent.mkdir(parents=True, exist_ok=True)
        os.replace(file, goal)
    for folder in {goal.parent for goal in scratch_files}:
        sync_folder(folder)


def put(path: Path, save: Callable[[Path], object]) -> Path:
    """Write a file, see `replacing`: `save` writes its content to the temporary path that it
    receives.
    """
    with replacing(path) as beside, disk_errors(path):
        save(beside)
    return path


def put_text(path: Path, text: str) -> Path:
    """Write a text file, see `put`."""
    return put(path, lambda beside: beside.write_text(text, encoding="utf-8", newline="\n"))


def put_unlisted(path: Path, save: Callable[[Path], object]) -> None:
    """Write a file whose digest the manifest does not list: a block of cases, a plan, or a file
    that was claimed.
    """
    manifest = _manifest_to_write(path)
    if manifest is None:
        write_whole(path, save)
        return
    manifest.check(path)
    write_whole(path, save, manifest.scratch(path))


def claim(path: Path) -> Path:
    """Make a file that keeps changing, such as a log, ours by its name; refuse one of somebody
    else.

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


def sweep(root: Path) -> None:
    """Remove what killed processes left half made; only the sole holder of the study's lock may
    call it.
    """
    scratch = root / SCRATCH
    if not any(map(is_link, Manifest(root).parts(scratch))):
        _remove_scratch(scratch)


def _remove_scratch(path: Path) -> None:
    if path.is_dir() and not is_link(path):
        shutil.rmtree(path, ignore_errors=True)
    with contextlib.suppress(OSError):
        path.unlink(missing_ok=True)
