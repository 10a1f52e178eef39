"""List the solved cases of a study: which file and row holds each case, and which files are damaged."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr

from trackroller.study.store import chunks, ownership
from trackroller.study.store.folder import StudyFolder
from trackroller.study.store.identity import chunk_name


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

    @property
    def hours(self) -> float:
        """Return the time of solving, of all runs together [h]."""
        return float(self.states.attrs["seconds"]) / 3600

    def find(self, wanted: np.ndarray) -> np.ndarray:
        """Return the index of each wanted case in `states`, shape (n,); -1 marks a case that is not solved."""
        cases = self.states["case"].values
        place = np.searchsorted(cases, wanted)
        return np.where(np.append(cases, b"")[place] == wanted, place, -1)


def take_inventory(folder: StudyFolder) -> Inventory:
    """Read every file with solved cases and verify its checksum."""
    corrupt: dict[Path, str] = {}
    sound = list(chunks.read_sound(folder.solved_files(), corrupt, chunks.read_state))
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
    """Remove the failed cases from the files, so that the next plan holds them; return their number.

    A file without its failed cases gets another name, because its name is the hash of its cases.
    """
    failed = found.states["file"].values[found.states["regime"].values == chunks.FAILED]
    for number in np.unique(failed):
        block = chunks.read(found.paths[number])
        solved = block.isel(case=(block["regime"] != chunks.FAILED).values)
        if solved.sizes["case"]:
            chunks.write(folder.chunk(chunk_name(solved["case"].values)), solved, packed=True)
        ownership.remove(found.paths[number], folder.root)
    return len(failed)
