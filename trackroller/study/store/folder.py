"""Name the files of a study, and keep the record of what was planned."""

from __future__ import annotations

import contextlib
import errno
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from trackroller.errors import InputError
from trackroller.files import check_utf_8, disk_error, locked, open_here, why_not
from trackroller.study.store.code_digest import solver_digest
from trackroller.study.store.manifest import (
    BLOCK,
    MARK,
    WHAT,
    Manifest,
    check_folder,
    mark_folder,
)
from trackroller.study.store.replace import GATHERED
from trackroller.yaml_file import parse_mapping

Tell = Callable[[str], None]
Count = Callable[[int, int], None]
NO_FOLDER = (errno.ENOTDIR, errno.EEXIST, errno.ENAMETOOLONG, errno.ELOOP)


def unheard(*facts: object) -> None:
    """Take what a run tells or counts where nobody listens."""


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
        The manifest with the plan. It marks the folder as ours.
    lock : pathlib.Path
        Lock that processes share while they work from the plan; only its sole holder may change the plan.
    """

    def __init__(self, root: Path) -> None:
        self.root = root
        self.design = root / "design.nc"
        self.gathered = root / GATHERED
        self.inputs = root / "inputs"
        self.study_file = self.inputs / "study.yaml"
        self.plan_file = root / MARK
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
        plan = self.plan()
        solved = [name for name in plan.get("chunks", {}) if self.mark(name).is_file()]
        paths = [*map(self.chunk, solved), *(self.root / "chunks" / name for name in plan.get("uses", ()))]
        return [path for path in paths if not path.is_file()]

    def create(self) -> StudyFolder:
        """Create the folder of the study and mark it as ours.

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
            mark_folder(self.root)
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

    def plan(self) -> dict[str, Any]:
        """Return the plan in the manifest; {} if there is none, or it was altered."""
        return Manifest(self.root).plan

    def write_plan(self, plan: Mapping[str, Any]) -> None:
        """Write the plan into the manifest."""
        manifest = Manifest(self.root)
        with manifest.held():
            manifest.write(plan, manifest.files)

    @property
    def of_another_solver(self) -> bool:
        """Return whether the study was planned with another version of the solver."""
        return bool(self.plan().get("solver_digest", solver_digest()) != solver_digest())

    def earlier(self) -> dict[str, Any]:
        """Return the study as it was planned last, {} if it was not planned."""
        text = self.plan().get("study")
        return {} if text is None else parse_mapping(text, str(self.plan_file))


@contextlib.contextmanager
def reporting(folder: StudyFolder, tell: Tell | None = None) -> Iterator[None]:
    """Keep others from making a report, gathering results and changing the plan."""
    with locked(folder.create().lock, shared=True), locked(folder.lock.with_name(".report"), tell=tell):
        yield
