"""The list of cases of a chunk on the disk, named by its content."""

from __future__ import annotations

import json
import zipfile
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.study.design.build import case_columns
from trackroller.study.files import StudyFolder, write_whole
from trackroller.study.identity import chunk_name
from trackroller.study.mend import Tell

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class CaseList:
    """The cases of a chunk: fingerprints (n,), the design's rows and the solver's options."""

    name: str
    cases: np.ndarray
    columns: dict[str, np.ndarray]
    options: dict[str, Any]

    def design(self, index: np.ndarray | None = None) -> xr.Dataset:
        """Rows as a design that `solve` takes."""
        import xarray as xr

        rows = slice(None) if index is None else index
        return xr.Dataset({name: ("case", values[rows]) for name, values in self.columns.items()})


def load_list(folder: StudyFolder, name: str) -> CaseList:
    """The case list of a chunk."""
    with np.load(folder.case_list(name), allow_pickle=False) as file:
        columns = {key: file[key] for key in case_columns(file)}
        columns = {k: v.astype(object) if v.dtype.kind == "U" else v for k, v in columns.items()}
        return CaseList(name, file["cases"], columns, json.loads(str(file["options"])))


def sound_cases(path: Path, tell: Tell) -> np.ndarray | None:
    """Fingerprints of a case list; a corrupt list is named and removed."""
    try:
        with np.load(path, allow_pickle=False) as file:
            cases = file["cases"]
            for key in file.files:  # reading compares each with its checksum
                file[key]
        if chunk_name(cases) == path.stem:
            return cases
        why = "its content does not fit its name"
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile, zlib.error) as exc:
        why = str(exc)
    tell(f"{path}: corrupt case list ({why}); its cases are planned anew")
    path.unlink(missing_ok=True)
    return None


def write_list(
    folder: StudyFolder, design: xr.Dataset, cases: np.ndarray, rows: np.ndarray, options: dict[str, Any]
) -> str:
    """Write rows of a design as the list of a chunk unless it is there already; returns the chunk's name."""
    listed = cases[rows]
    name = chunk_name(listed)
    path = folder.case_list(name)
    if not path.is_file():
        columns = {key: design[key].values[rows] for key in case_columns(design)}
        save_list(path, listed, columns, options)
    return name


def save_list(path: Path, cases: np.ndarray, columns: dict[str, np.ndarray], options: dict[str, Any]) -> None:
    """Write a case list, whole or not at all."""

    def save(beside: Path) -> None:
        plain = {k: v.astype(str) if v.dtype == object else v for k, v in columns.items()}
        with open(beside, "wb") as stream:
            np.savez_compressed(stream, cases=cases, options=np.array(json.dumps(options)), allow_pickle=False, **plain)

    write_whole(path, save)
