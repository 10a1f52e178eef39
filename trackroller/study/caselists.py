"""Read and write the list of cases of a chunk; the name of a list is the hash of its cases."""

from __future__ import annotations

import json
import zipfile
import zlib
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from trackroller.numerics.numbers import all_equal
from trackroller.study.design.build import case_columns
from trackroller.study.files import StudyFolder, WorkError, write_whole
from trackroller.study.identity import chunk_name


@dataclass(frozen=True)
class CaseList:
    """Cases of a chunk.

    Attributes
    ----------
    name : str
        Name of the chunk.
    cases : numpy.ndarray of dtype S32, shape (n,)
        Fingerprints.
    columns : dict
        Case fields by name, shape (n,) each.
    options : dict
        Keyword arguments of `solve`, the same for all cases of a chunk.
    """

    name: str
    cases: np.ndarray
    columns: dict[str, np.ndarray]
    options: dict[str, Any]

    def take(self, rows: np.ndarray) -> CaseList:
        """Return the rows with the indices `rows`."""
        columns = {name: values[rows] for name, values in self.columns.items()}
        return CaseList(self.name, self.cases[rows], columns, self.options)

    def design(self) -> xr.Dataset:
        """Return the cases as a design for `solve`."""
        return xr.Dataset({name: ("case", values) for name, values in self.columns.items()})


def load_list(folder: StudyFolder, name: str) -> CaseList:
    """Read the case list of a chunk.

    Raises
    ------
    WorkError
        If the list is missing, damaged, or holds the cases of another chunk.
    """
    path = folder.case_list(name)
    try:
        with np.load(path, allow_pickle=False) as file:
            cases, options = file["cases"], json.loads(str(file["options"]))
            columns = {key: file[key] for key in case_columns(file)}
    except FileNotFoundError:
        raise list_is_gone(folder, name) from None
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile, zlib.error) as exc:
        raise WorkError(f"{path}: corrupt case list ({exc}). Start again: its cases are planned anew.") from None
    if chunk_name(cases) != name:
        raise WorkError(f"{path}: corrupt case list (its cases do not fit its name). Start again.")
    columns = {key: v.astype(object) if v.dtype.kind == "U" else v for key, v in columns.items()}
    columns = {key: np.broadcast_to(v, len(cases)) for key, v in columns.items()}
    return CaseList(name, cases, columns, options)


def list_is_gone(folder: StudyFolder, name: str) -> WorkError:
    """Return the error for a chunk that is no longer planned."""
    why = "the study was edited and planned anew by another process"
    return WorkError(f"{folder.case_list(name)} is missing: {why}. Start again: every finished case is kept.")


def write_list(folder: StudyFolder, cases: CaseList) -> None:
    """Write the case list of a chunk, whole or not at all."""
    columns = {name: _shortened(values) for name, values in cases.columns.items()}
    plain = {k: v.astype(str) if v.dtype == object else v for k, v in columns.items()}
    options = np.array(json.dumps(cases.options))

    def save(beside: Any) -> None:
        with open(beside, "wb") as stream:
            np.savez(stream, cases=cases.cases, options=options, allow_pickle=False, **plain)

    write_whole(folder.case_list(cases.name), save)


def _shortened(values: np.ndarray) -> np.ndarray:
    """Return the first value alone if all values of a column are equal."""
    return values[:1] if all_equal(values) else values
