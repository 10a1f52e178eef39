"""List the solved cases of a study: which file and row holds each, which files are damaged, and what model solved."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from trackroller.errors import InputError
from trackroller.parameters import OPTIONS
from trackroller.study import store
from trackroller.study.files import StudyFolder

if TYPE_CHECKING:
    from trackroller.study.config import Study


@dataclass
class Inventory:
    """Solved cases of a study, each once.

    Attributes
    ----------
    cases : numpy.ndarray of dtype S32, shape (m,)
        Fingerprints, in ascending order.
    file, row : numpy.ndarray of int, shape (m,)
        Index into `paths` and row in that file.
    regime : numpy.ndarray of int, shape (m,)
        Code of `REGIMES`.
    paths : list of pathlib.Path
        Sound files.
    headers : list of store.Block
        For each file its layout, coordinates and attributes; the blocks have no rows.
    reasons : dict
        Why a case failed or misses its tolerance, by fingerprint.
    corrupt : dict
        Damaged files, and what is wrong with each.
    seconds : float
        Time spent on solving [s].
    """

    cases: np.ndarray
    file: np.ndarray
    row: np.ndarray
    regime: np.ndarray
    paths: list[Path]
    headers: list[store.Block]
    reasons: dict[str, str] = field(default_factory=dict)
    corrupt: dict[Path, str] = field(default_factory=dict)
    seconds: float = 0.0

    def find(self, wanted: np.ndarray) -> np.ndarray:
        """Return the index of each wanted case in `cases`, shape (n,); -1 marks a case that is not solved."""
        place = np.searchsorted(self.cases, wanted)
        return np.where(np.append(self.cases, b"")[place] == wanted, place, -1)

    def failed(self, place: np.ndarray) -> np.ndarray:
        """Return whether the cases with the indices `place` (see `find`) are solved and failed, shape (n,)."""
        return np.append(self.regime, -1)[place] == store.FAILED


def take_inventory(folder: StudyFolder) -> Inventory:
    """Read every file with solved cases and verify its checksum."""
    fingerprints, whole = np.empty(0, dtype="S32"), np.empty(0, dtype=int)
    found = Inventory(fingerprints, whole, whole, whole, paths=[], headers=[])
    cases, regimes = [], []
    for path, block in store.read_sound(folder.solved_files(), found.corrupt):
        cases.append(block.cases)
        regimes.append(block.columns("regime")[:, 0].astype(int))
        found.paths.append(path)
        found.headers.append(block.take(np.empty(0, dtype=int)))
        found.reasons |= block.reasons
        found.seconds += block.seconds
    if not cases:
        return found
    for each in (cases, regimes, found.paths, found.headers):
        each.reverse()  # a complete chunk counts before a part of it
    count = [len(part) for part in cases]
    found.cases, first = np.unique(np.concatenate(cases), return_index=True)
    found.file = np.repeat(np.arange(len(count)), count)[first]
    found.row = np.concatenate([np.arange(n) for n in count])[first]
    found.regime = np.concatenate(regimes)[first]
    return found


def forget_failed(folder: StudyFolder, found: Inventory) -> int:
    """Remove the failed cases from the files, so that the next run solves them; return their number."""
    count = 0
    for number in np.unique(found.file[found.regime == store.FAILED]):
        path = found.paths[number]
        block = store.read_named(path)
        good = np.flatnonzero(~block.failed)
        count += len(block.cases) - len(good)
        kept = path
        if len(good):
            kept = store.write_part(folder, path.stem.partition("-")[0], block.take(good))
        if kept != path or not len(good):
            path.unlink(missing_ok=True)
    return count


def check_default_model(study: Study, folder: StudyFolder) -> None:
    """Refuse to replace results of an earlier default contact model because a study file names no model.

    Parameters
    ----------
    study : Study
        The checked study.
    folder : StudyFolder
        Its results, which are left as they are.

    Raises
    ------
    InputError
        If the study file names no contact model and the folder holds cases that another model solved.
    """
    if "contact_model" in {*study.config.model_fields_set, *study.factors} or not any(folder.solved_files()):
        return
    option = OPTIONS["contact_model"]
    earlier = folder.earlier().get("contact_model", option.default)
    if earlier != option.default:
        raise InputError(
            "contact_model",
            option.default,
            f"it is the default now, the study file names no contact model, and {folder.root} was solved with another",
            f"Nothing was changed. Add the line `contact_model: {earlier}` to the study file to keep that model and "
            f"its results, or `contact_model: {option.default}` to solve all cases anew.",
        )
