"""List the solved cases of a study: which file and row holds each, which files are damaged, and what model solved."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from trackroller.errors import InputError
from trackroller.parameters import OPTIONS
from trackroller.study.store import chunks
from trackroller.study.store.folder import StudyFolder

if TYPE_CHECKING:
    from trackroller.study.file.study import Study


@dataclass
class Inventory:
    """Solved cases of a study, each once.

    Attributes
    ----------
    states : xarray.Dataset
        `regime` (code of `REGIMES`), `reason` of a failure, `file` (index into `paths`) and `row` in that file, along
        `case` in ascending order of the fingerprints; the attribute `seconds` is the time spent on solving [s].
    paths : list of pathlib.Path
        Sound files.
    corrupt : dict
        Damaged files, and what is wrong with each.
    """

    states: xr.Dataset
    paths: list[Path]
    corrupt: dict[Path, str]

    def find(self, wanted: np.ndarray) -> np.ndarray:
        """Return the index of each wanted case in `states`, shape (n,); -1 marks a case that is not solved."""
        cases = self.states["case"].values
        place = np.searchsorted(cases, wanted)
        return np.where(np.append(cases, b"")[place] == wanted, place, -1)


def take_inventory(folder: StudyFolder) -> Inventory:
    """Read every file with solved cases and verify its checksum."""
    corrupt: dict[Path, str] = {}
    sound = list(chunks.read_sound(folder.solved_files(), corrupt, chunks.read_state))
    sound.reverse()  # a complete chunk counts before a part of it
    none = chunks.failure(np.empty(0, dtype="S32"), "")[["regime", "reason"]]
    states = [none, *(state for _, state in sound)]
    numbered = [
        state.assign(file=("case", np.full(state.sizes["case"], i - 1)), row=("case", np.arange(state.sizes["case"])))
        for i, state in enumerate(states)
    ]
    every = chunks.join(numbered)
    _, first = np.unique(every["case"].values, return_index=True)
    return Inventory(every.isel(case=first), [path for path, _ in sound], corrupt)


def forget_failed(folder: StudyFolder, found: Inventory) -> int:
    """Remove the failed cases from the files, so that the next run solves them; return their number."""
    failed = found.states["file"].values[found.states["regime"].values == chunks.FAILED]
    for number in np.unique(failed):
        path = found.paths[number]
        block = chunks.read(path)
        good = block.isel(case=(block["regime"] != chunks.FAILED).values)
        kept = chunks.write_part(folder, path.stem.partition("-")[0], good) if good.sizes["case"] else None
        if kept != path:
            path.unlink(missing_ok=True)
    return len(failed)


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
    # a list is a factor, which was never a default
    if isinstance(earlier, str) and earlier != option.default:
        raise InputError(
            "contact_model",
            option.default,
            f"the default has changed from {earlier} to {option.default}, the study file names no contact model, and "
            f"{folder.root} was solved with {earlier}",
            f"Nothing was changed. Add the line `contact_model: {earlier}` to the study file to keep that model and "
            f"its results, or `contact_model: {option.default}` to solve all cases anew.",
        )
