"""Gather solved cases into one file: a grid gets a dimension for each factor, a sample the
dimension `case`.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Hashable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from trackroller.errors import WorkError
from trackroller.files import reserve
from trackroller.roller.dataset import file_attributes, united
from trackroller.study.store import chunks
from trackroller.study.store.folder import Tell, reporting, unheard
from trackroller.study.store.ledger import Ledger
from trackroller.study.store.manifest import digests_of
from trackroller.study.store.netcdf import small_cache
from trackroller.study.store.provenance import DATE
from trackroller.study.store.put import put
from trackroller.study.store.solved_dataset import labelled

MOST_MEMORY = 10_000_000  # bytes of a result in memory; a larger one lies in a temporary file


def write_design(ledger: Ledger) -> None:
    """Write `design.nc`, the cases of a study, and record its digest."""
    design = ledger.cases.design
    path = ledger.folder.design
    title = f"Cases of the parameter study '{ledger.study.name}' of locating-bearing track rollers"
    described = design.assign_attrs(file_attributes(title, "drawn") | design.attrs)
    encoding = {str(name): _packed(v) for name, v in described.variables.items()}

    def save(beside: Path) -> None:
        with small_cache():
            described.to_netcdf(beside, engine="netcdf4", encoding=encoding)

    put(path, save)


def _packed(values: xr.Variable) -> dict[str, Any]:
    """Return how a column of a design is stored: packed.

    The library packs characters, and no strings: the mapping of a bearing in each of a million
    cases takes 500 MB as strings.
    """
    encoding: dict[str, Any] = {"_FillValue": None}
    if values.dims:
        encoding |= {"zlib": True, "complevel": 4, "shuffle": True}
        if values.dtype.kind in "OUT":
            encoding["dtype"] = "S1"
    return encoding


def gather(ledger: Ledger, tell: Tell = unheard, attrs: Mapping[str, str] | None = None) -> Path:
    """Gather the solved cases of a ledger into `study.nc`, and write `design.nc` if it is missing.

    Parameters
    ----------
    ledger : Ledger
        A ledger whose chunks are solved.
    tell : callable
        Receives one line when the file is complete.
    attrs : mapping, optional
        Further attributes of the file, such as the optima of a search.

    Returns
    -------
    pathlib.Path
        Path of `study.nc`.

    Raises
    ------
    WorkError
        If cases are missing or a file is damaged; the next run solves these cases.

    Notes
    -----
    The time is proportional to the number of results. A result above `MOST_MEMORY` passes through a
    temporary file in the study's folder.
    """
    study = ledger.study
    folder = ledger.folder
    ledger = ledger.anew()
    if not digests_of(folder.design):
        write_design(ledger)
    count = len(ledger.state_number)
    missing = int((ledger.state_number < 0).sum())
    if missing:
        damaged = "".join(f" Corrupt: {reason}." for reason in ledger.corrupt.values())
        raise WorkError(f"{missing} of {count} cases are not solved.{damaged} Start the run again.")

    def save(beside: Path) -> None:
        results = labelled(study, study.drawn, ledger.cases.design, collect(ledger))
        results.attrs.pop(DATE)  # equal results are equal files; the plan keeps the date
        with small_cache():
            results.assign_attrs(attrs or {}).to_netcdf(beside, engine="netcdf4")

    with reporting(folder):
        put(folder.gathered, save)
    tell(f"gathered {count} cases into {folder.gathered}")
    return folder.gathered


def collect(ledger: Ledger, solved: slice | np.ndarray = slice(None)) -> xr.Dataset:
    """Return the results of solved cases along `case`, with the coordinates of their other axes.

    Parameters
    ----------
    ledger : Ledger
        The ledger of the study.
    solved : slice or numpy.ndarray of int, shape (n,)
        The wanted cases of the design, each of which is solved; all by default.
    """
    state_number = ledger.state_number[solved]
    results: dict[Hashable, xr.Variable] = {}
    coords: dict[Hashable, xr.Variable] = {}
    attrs: dict[str, Any] = {}
    file, row = (ledger.states[name].values[state_number] for name in ("file", "row"))
    order = np.argsort(file, kind="stable")
    numbers, start = np.unique(file[order], return_index=True)
    for number, rows in zip(numbers, np.split(order, start[1:]), strict=True):
        try:
            block = chunks.read(ledger.paths[number])
        except (chunks.CorruptFile, FileNotFoundError) as exc:
            raise WorkError(
                f"corrupt results: {exc}. Start again: only its cases are solved."
            ) from None
        attrs = united((attrs or block.attrs, block.attrs))
        coords = {name: v.variable for name, v in block.coords.items() if name != "case"} | coords
        for name, v in block.data_vars.items():
            known = results.get(name, v[:0].variable)
            # grids of different sizes
            shape = (len(state_number), *np.maximum(known.shape[1:], v.shape[1:]))
            if known.shape != shape:
                room = _room(shape, v.dtype, ledger.folder.root)
                room[tuple(map(slice, known.shape))] = known.values
                results[name] = xr.Variable(v.dims, room, known.attrs)
            into: Any = (rows, *map(slice, v.shape[1:]))
            results[name].values[into] = v.values[row[rows]]
            results[name].attrs = results[name].attrs or v.attrs
    return xr.Dataset(results, coords, attrs)


def _room(shape: tuple[int, ...], dtype: np.dtype, folder: Path) -> np.ndarray:
    """Return an array of missing values: NaN, 0 or ''. A large array lies in a temporary file."""
    size = math.prod(shape) * dtype.itemsize
    if dtype.kind in "OUT":
        return np.full(shape, "", dtype=object)
    missing = np.nan if dtype.kind == "f" else 0
    if size <= MOST_MEMORY:
        return np.full(shape, missing, dtype)
    with tempfile.TemporaryFile(dir=folder) as file:
        reserve(file, size)  # a full disk must not end in SIGBUS
        values: np.ndarray = np.memmap(file, dtype, "r+", shape=shape)
    values[...] = missing
    return values
