"""Name the files of a study, mark its folder as ours, and keep the record of what was planned."""

from __future__ import annotations

import contextlib
import errno
import os
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from trackroller.errors import InputError
from trackroller.files import (
    check_utf_8,
    disk_error,
    disk_errors,
    is_link,
    locked,
    open_here,
    refuse_link,
    refuse_links,
    why_not,
)
from trackroller.study.store.manifest import BLOCK, GATHERED, SCRATCH, WHAT, Manifest, files_below, remove_empty
from trackroller.study.store.mark import MARK, OURS, is_study, read_mark, signed
from trackroller.study.store.program_digest import solver_digest
from trackroller.study.store.put import put_unlisted, sweep
from trackroller.yaml_file import parse_mapping

Tell = Callable[[str], None]
Count = Callable[[int, int], None]
NO_FOLDER = (errno.ENOTDIR, errno.EEXIST, errno.ENAMETOOLONG, errno.ELOOP)


def unheard(*facts: object) -> None:
    """Take what a run tells or counts where nobody listens."""


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
        elif not _is_empty(root):
            raise _foreign_folder(root)


def check_readable(root: Path) -> None:
    """Refuse to read a folder with links inside, or with a damaged `plan.json`.

    A copy of results may be without `plan.json`, and that of an earlier version may be read.
    """
    refuse_links(root, WHAT, inside=True)
    if os.path.lexists(root / MARK) and not read_mark(root):
        check_folder(root)


def _is_empty(root: Path) -> bool:
    """Return whether a folder holds no file and no link, at any level, but the empty mark of a killed process."""
    for place, folders, names in os.walk(root):
        if any(is_link(Path(place, name)) for name in folders):
            return False
        for path in (Path(place, name) for name in names):
            if path != root / MARK or path.stat().st_size:
                return False
    return True


def _foreign_folder(root: Path) -> InputError:
    """Return the error for a folder without our mark."""
    if read_mark(root):
        wrong = "was made by another version of trackroller"
        remedy = "Move the folder away and start again: its cases are solved anew."
        return InputError(WHAT, str(root), "a folder of this version", remedy, wrong)
    names = sorted(os.listdir(root))
    wrong = f"was not made by trackroller and holds {', '.join(names[:4])}"
    if len(names) > 4:
        wrong += f" and {len(names) - 4} more"
    if MARK in names:
        wrong += f"; its {MARK} is damaged or somebody else's"
    allowed = "a new or empty folder, or one that trackroller made"
    remedy = (
        "Give the study another name, choose another --results, or move the folder away. "
        f"If it is the folder of a study, restore its {MARK} from a copy."
    )
    return InputError(WHAT, str(root), allowed, remedy, wrong)


class StudyFolder:
    """Paths of the files of one study, `results/NAME/`; a folder that was renamed is the same study.

    Attributes
    ----------
    root : pathlib.Path
        The folder, which may be a link.
    design, gathered : pathlib.Path
        The cases of the study, and its gathered results.
    inputs, study_file : pathlib.Path
        Folder with the files that the study was made from, and the study file in it, with every default written out.
    plan_file : pathlib.Path
        The record of the plan: its chunks, and the study and inputs that it was made from. It marks the folder as ours.
    lock : pathlib.Path
        Lock that processes share while they work from the plan; only its sole holder may change the plan.
    """

    def __init__(self, root: Path) -> None:
        self.root = root
        self.design = root / "design.nc"
        self.gathered = root / GATHERED
        self.inputs = root / "inputs"
        self.plan_file = root / MARK
        self.study_file = self.inputs / "study.yaml"
        self.lock = root / "plan" / ".lock"

    def case_list(self, chunk: str) -> Path:
        """Return the cases of a chunk."""
        return self.root / "plan" / f"{chunk}.nc"

    def chunk_lock(self, chunk: str) -> Path:
        """Return the empty file that a process locks while it solves a chunk."""
        return self.root / "plan" / f"{chunk}.lock"

    def mark(self, chunk: str) -> Path:
        """Return the empty file by which the workflow knows that a chunk is solved. It may be deleted at any time."""
        return self.root / "plan" / f"{chunk}.solved"

    def chunk(self, chunk: str) -> Path:
        """Return the results of a solved chunk."""
        return self.root / "chunks" / f"{chunk}.nc"

    def solved_files(self) -> list[Path]:
        """Return the files with results of solved cases; files with names that no chunk has do not count."""
        paths = sorted((self.root / "chunks").glob("*.nc"))
        return [path for path in paths if BLOCK.fullmatch(f"chunks/{path.name}")]

    def lost_files(self) -> list[Path]:
        """Return the files with solved cases that the plan counts on and that are gone."""
        record = self.record()
        solved = [name for name in record.get("chunks", {}) if self.mark(name).is_file()]
        paths = [*map(self.chunk, solved), *(self.root / "chunks" / name for name in record.get("uses", ()))]
        return [path for path in paths if not path.is_file()]

    def create(self) -> StudyFolder:
        """Create the folders of the study and mark them as ours.

        Returns
        -------
        StudyFolder
            This folder.

        Raises
        ------
        InputError
            If the path exists and is not a folder, or the folder is somebody else's or holds a link.
        WorkError
            If the folder cannot be written.
        """
        check_utf_8(self.root.absolute(), WHAT)
        check_folder(self.root)
        try:
            self.root.mkdir(parents=True, exist_ok=True)
            self._mark()
            for name in ("plan", "chunks"):
                (self.root / name).mkdir(exist_ok=True)
            with open_here(self.lock, "ab"):
                pass
        except OSError as exc:
            if exc.errno in NO_FOLDER:
                wrong = f"cannot be a folder ({why_not(exc, self.root)})"
                remedy = "Choose another with --results."
                raise InputError(WHAT, str(self.root), "the path of a folder", remedy, wrong) from None
            raise disk_error(exc, self.root) from None
        return self

    def _mark(self) -> None:
        """Write the mark as the first file of the folder, unless it has one.

        An empty `plan.json`, as a process leaves it that is killed here, counts as none. The lock lets one of several
        processes write the mark.
        """
        if is_study(self.root):
            return
        with locked(self.plan_file), open_here(self.plan_file, "ab") as stream:
            if os.fstat(stream.fileno()).st_size:
                return
            try:
                stream.write(signed({}).encode())
                stream.flush()
                os.fsync(stream.fileno())
            except OSError:
                stream.truncate(0)
                raise
        if not is_study(self.root):
            raise _foreign_folder(self.root)

    def record(self) -> dict[str, Any]:
        """Return the record of the plan; {} if there is none, it was altered, or it is that of another version."""
        if not is_study(self.root):
            return {}
        return {key: value for key, value in read_mark(self.root).items() if key not in OURS}

    @property
    def of_another_solver(self) -> bool:
        """Return whether the study was planned with another version of the solver."""
        return bool(self.record().get("solver_digest", solver_digest()) != solver_digest())

    def earlier(self) -> dict[str, Any]:
        """Return the study as it was planned last, {} if it was not planned."""
        text = self.record().get("study")
        if text is None:
            return {}
        return parse_mapping(text, str(self.plan_file))

    def write_record(self, record: Mapping[str, Any]) -> None:
        """Write the record of the plan with its digest, and the mark that the folder is ours."""
        text = signed(record)
        put_unlisted(self.plan_file, lambda beside: beside.write_text(text, encoding="utf-8", newline="\n"))


@contextlib.contextmanager
def reporting(folder: StudyFolder, tell: Tell | None = None) -> Iterator[None]:
    """Keep others from making a report, gathering results and changing the plan."""
    with locked(folder.create().lock, shared=True), locked(folder.lock.with_name(".report"), tell=tell):
        yield


def check_for_workflow(root: Path) -> None:
    """Refuse a folder in which Snakemake would delete a file that is not ours.

    Snakemake removes the outputs and log files of a job without a look at them, and the folder `figures/` as a whole.
    An empty file, as a mark is, holds nothing that could be lost.
    """
    figures = root / "figures"
    paths = [root / name for name in ("design.nc", GATHERED, "sensitivity.nc", "report.html", "ro-crate-metadata.json")]
    paths += (root / "plan").glob("*.solved")
    paths += [file for place in ("figures", "logs", "looks") for file in files_below(root / place)]
    if not figures.is_dir():
        paths.append(figures)
    Manifest(root).check(*filter(_holds_something, paths))


def _holds_something(path: Path) -> bool:
    """Return whether anything but an empty file stands at a path."""
    return os.path.lexists(path) and (not path.is_file() or path.stat().st_size > 0)


def delete_study(root: Path) -> None:
    """Delete the folder of a study with everything in it.

    Raises
    ------
    InputError
        If the folder is not that of a study, or holds a file of somebody else; nothing is deleted then.
    """
    check_folder(root)
    manifest = Manifest(root)
    listed = manifest.contents()
    files = [path for path in files_below(root) if root / SCRATCH not in path.parents]
    ours = [path for path in files if not _holds_something(path) or manifest.owns(path, listed=listed)]
    foreign = [path for path in files if path not in ours]
    if foreign:
        names = ", ".join(map(manifest.name_of, foreign[:4]))
        if len(foreign) > 4:
            names += f" and {len(foreign) - 4} more"
        remedy = "Move these files away, or delete the folder yourself."
        wrong = f"holds files that trackroller did not write: {names}"
        raise InputError(WHAT, str(root), "a folder with files that trackroller wrote", remedy, wrong)
    sweep(root)
    # manifest and mark prove what the other files are, so they go last
    for path in sorted(ours, key=lambda path: (path == root / MARK, path == manifest.path)):
        path.unlink(missing_ok=True)
    remove_empty(root)
