"""Write and remove the files of a study by the rules of `manifest.py`."""

from __future__ import annotations

import contextlib
import os
import shutil
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from trackroller.errors import InputError
from trackroller.files import check_place, disk_errors, flush, is_link, scratch_name, sync_folder, write_whole
from trackroller.study.store.manifest import (
    CRATE,
    LONE,
    MARK,
    SCRATCH,
    WHAT,
    Manifest,
    check_folder,
    digest_of_file,
    digests_of_crate,
    files_below,
    manifest_of,
    write_record,
)

GATHERED = "study.nc"
PAGES = (
    "sensitivity.nc",
    "report.html",
    "figures",
    "tables",
    "explorer.html",
)  # what is made from the gathered results


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
    manifest = manifest_of(path)
    beside = scratch_name(path) if manifest is None else manifest.scratch(path)
    try:
        with disk_errors(path):
            path.parent.mkdir(parents=True, exist_ok=True)
            beside.parent.mkdir(parents=True, exist_ok=True)
        yield beside
        with disk_errors(path):
            if manifest is not None or beside.is_dir():
                _replace(manifest or Manifest(path, LONE), path, beside)
            else:
                flush(beside)
                os.replace(beside, path)
                sync_folder(path.parent)
    finally:
        _remove_scratch(beside)


def put(path: Path, save: Callable[[Path], object]) -> Path:
    """Write a file, see `replacing`: `save` writes its content to the temporary path that it receives."""
    with replacing(path) as beside, disk_errors(path):
        save(beside)
    return path


def put_text(path: Path, text: str) -> Path:
    """Write a text file, see `put`."""
    return put(path, lambda beside: beside.write_text(text, encoding="utf-8", newline="\n"))


def put_block(path: Path, save: Callable[[Path], object]) -> None:
    """Write a block of cases, which ends with its checksum and needs no manifest."""
    manifest = manifest_of(path)
    if manifest is None:
        write_whole(path, save)
        return
    manifest.check(path)
    write_whole(path, save, manifest.scratch(path))


def put_record(path: Path, record: Mapping[str, Any]) -> None:
    """Write a JSON record, which holds its own digest."""
    manifest = manifest_of(path)
    if manifest is None:
        write_record(path, record)
        return
    manifest.check(path)
    write_record(path, record, manifest.scratch(path))


def _replace(manifest: Manifest, path: Path, beside: Path) -> None:
    """Put what was made at a temporary path in the place of a result: note its digests, rename, settle."""
    made = {path: beside}
    if beside.is_dir():
        made = {path / file.relative_to(beside): file for file in files_below(beside)}
    contents = {goal: digest_of_file(file) for goal, file in made.items()}
    names = {manifest.name_of(goal): digest for goal, digest in contents.items()}
    for file in made.values():
        flush(file)
    with manifest.held():
        manifest.check(*made, contents=contents)
        before = manifest.below(path)
        stands = all(digest_of_file(goal) == digest for goal, digest in contents.items())
        if stands and before == {name: [digest] for name, digest in names.items()}:
            return  # what stands there keeps its date
        manifest.note(names)
        for goal, digest in contents.items():
            name = manifest.name_of(goal)
            if not _holds(goal, digest, before.get(name, [])):
                _remove_dependents(manifest, name)
        for goal, file in made.items():
            goal.parent.mkdir(parents=True, exist_ok=True)
            os.replace(file, goal)
        for place in {goal.parent for goal in made}:
            sync_folder(place)
        gone = before.keys() - names
        _unlink(manifest, [manifest.root / name for name in gone])
        manifest.settle(names, gone)


def _holds(path: Path, digest: str, listed: list[str]) -> bool:
    """Return whether a file holds some content already, or held it until it was removed."""
    return digest_of_file(path) == digest if path.exists() else listed == [digest]


def _remove_dependents(manifest: Manifest, name: str) -> None:
    """Remove the crate before a file that it lists changes, and with other results what was made from them."""
    if not manifest.of_study:
        return
    if name == GATHERED:
        _forget(manifest, *PAGES)
    if name in digests_of_crate(manifest.root):
        _forget(manifest, CRATE)


def _forget(manifest: Manifest, *results: str) -> None:
    """Remove results from a folder and from its manifest; a file that was changed stays, as somebody else's."""
    names = [name for result in results for name in manifest.below(manifest.root / result)]
    _unlink(manifest, [manifest.root / name for name in names])
    manifest.settle({}, names)
    for result in results:
        remove_empty(manifest.root / result)


def _unlink(manifest: Manifest, paths: list[Path]) -> None:
    """Remove the files that are ours and unchanged."""
    known = manifest.files
    for path in paths:
        if not any(map(is_link, manifest.parts(path))) and manifest.owns(path, known=known):
            path.unlink(missing_ok=True)


def remove(root: Path, *results: str) -> None:
    """Remove results of a study, files or folders that its manifest lists, as far as they are ours and unchanged."""
    manifest = Manifest(root)
    with manifest.held():
        for result in results:
            _remove_dependents(manifest, result)
        _forget(manifest, *results)


def remove_proved(path: Path) -> None:
    """Remove a block, a record, a lock or a mark; one of somebody else stays."""
    manifest = manifest_of(path)
    if manifest is not None:
        _unlink(manifest, [path])


def remove_empty(root: Path) -> None:
    """Remove a folder and the folders in it, as far as no file is left in them."""
    for place, _, _ in os.walk(root, topdown=False):
        with contextlib.suppress(OSError):
            os.rmdir(place)


def _remove_scratch(path: Path) -> None:
    if path.is_dir() and not is_link(path):
        shutil.rmtree(path, ignore_errors=True)
    with contextlib.suppress(OSError):
        path.unlink(missing_ok=True)


def sweep(root: Path) -> None:
    """Remove what killed processes left half made; only the sole holder of the study's lock may call it."""
    scratch = root / SCRATCH
    if not any(map(is_link, Manifest(root).parts(scratch))):
        _remove_scratch(scratch)


def check_for_workflow(root: Path) -> None:
    """Refuse a folder in which Snakemake would delete a file that is not ours.

    Snakemake removes the outputs and log files of a job without a look at them, and the folder `figures/` as a whole.
    """
    figures = root / "figures"
    paths = [root / name for name in ("design.nc", GATHERED, "sensitivity.nc", "report.html", CRATE)]
    paths += (root / "plan").glob("*.solved")
    paths += [file for place in ("figures", "logs", "looks") for file in files_below(root / place)]
    if not figures.is_dir():
        paths.append(figures)
    Manifest(root).check(*paths)


def delete_study(root: Path) -> None:
    """Delete the folder of a study with everything in it.

    Raises
    ------
    InputError
        If the folder is not that of a study, or holds a file of somebody else; nothing is deleted then.
    """
    check_folder(root)
    manifest = Manifest(root)
    known = manifest.files
    files = [path for path in files_below(root) if root / SCRATCH not in path.parents]
    foreign = [path for path in files if not manifest.owns(path, known=known)]
    if foreign:
        names = ", ".join(map(manifest.name_of, foreign[:4]))
        if len(foreign) > 4:
            names += f" and {len(foreign) - 4} more"
        remedy = "Move these files away, or delete the folder yourself."
        wrong = f"holds files that trackroller did not write: {names}"
        raise InputError(WHAT, str(root), "a folder with files that trackroller wrote", remedy, wrong)
    sweep(root)
    for path in files:
        if path != root / MARK and manifest.owns(path, known=known):
            path.unlink(missing_ok=True)
    (root / MARK).unlink(missing_ok=True)  # it proves what the other files are, so it goes last
    remove_empty(root)
