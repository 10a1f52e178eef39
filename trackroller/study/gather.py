"""Gather solved cases into one file: a grid gets a dimension for each factor, a sample the dimension `case`."""

from __future__ import annotations

import math
import os
import tempfile
from collections.abc import Hashable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from trackroller.errors import WorkError
from trackroller.files import write_whole
from trackroller.numerics.numbers import all_equal
from trackroller.parameters import FRICTION_LEVELS, MATERIAL_FIELDS
from trackroller.roller.dataset import file_attributes
from trackroller.study import provenance
from trackroller.study.design.factors import Factor, readable
from trackroller.study.store import chunks
from trackroller.study.store.folder import StudyFolder, Tell, record_checksum
from trackroller.study.store.inventory import Inventory
from trackroller.study.store.plan import Plan, locate

if TYPE_CHECKING:
    from trackroller.study.file.study import Study

MOST_MEMORY = 10_000_000  # bytes of a result in memory; a larger one lies in a temporary file
Variables = dict[Hashable, tuple[tuple[Hashable, ...], np.ndarray, dict[str, Any], dict[str, Any]]]


def write_design(study: Study, folder: StudyFolder) -> None:
    """Write `design.nc`, the cases of a study, and record its checksum."""
    design = study.design()
    title = f"Cases of the parameter study '{study.name}' of locating-bearing track rollers"
    described = design.assign_attrs(file_attributes(title, "drawn") | design.attrs)
    encoding = {str(name): {"_FillValue": None} for name in described.variables}
    write_whole(folder.design, lambda beside: described.to_netcdf(beside, engine="netcdf4", encoding=encoding))
    record_checksum(folder, folder.design)


def gather(plan: Plan, tell: Tell | None = None) -> Path:
    """Gather the solved cases of a plan into `study.nc`, and write `design.nc` if it is missing.

    Parameters
    ----------
    plan : Plan
        A plan whose chunks are solved.
    tell : callable, optional
        Receives one line when the file is complete.

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
    The time is proportional to the number of results. A result above `MOST_MEMORY` passes through a temporary
    file in the study's folder.
    """
    study, folder = plan.study, plan.folder
    if not folder.design.is_file():
        write_design(study, folder)
    design, found, place = locate(study, folder)
    count = len(place)
    if missing := int((place < 0).sum()):
        damaged = "".join(f" Corrupt: {why}." for why in found.corrupt.values())
        raise WorkError(f"{missing} of {count} cases are not solved.{damaged} Start the run again.")
    grid = study.drawn.factors if study.drawn.method == "grid" else {}
    sizes = dict(zip(grid, study.drawn.meta["shape"], strict=True)) if grid else {"case": count}

    def save(beside: Path) -> None:
        results, more, attrs = _collect(found, place, folder.root)
        unstacked = {
            name: _variable((*sizes, *v.dims[1:]), v.values.reshape(*sizes.values(), *v.shape[1:]), v.attrs)
            for name, v in results.items()
        }
        coords = _labels(study, design, sizes, grid)
        for name, v in more.items():
            coords.setdefault(name, _variable(v.dims, v.values, v.attrs, coordinate=True))
        told = _attributes(study, design, attrs)
        xr.Dataset(unstacked, coords, told).to_netcdf(beside, engine="netcdf4")

    write_whole(folder.gathered, save)
    record_checksum(folder, folder.gathered)
    if tell is not None:
        tell(f"gathered {count} cases into {folder.gathered}")
    return folder.gathered


def _attributes(study: Study, design: xr.Dataset, attrs: dict[str, Any]) -> dict[str, Any]:
    """Return the global attributes: what the solver wrote, and what is needed to repeat the study."""
    names = sorted({str(m) for name in MATERIAL_FIELDS for m in np.unique(design[name].values.astype(str))})
    kept = {k: v for k, v in attrs.items() if isinstance(v, (str, int, float)) and k not in {*study.factors, "seconds"}}
    return kept | provenance.attributes(study, names)


def _collect(
    found: Inventory, place: np.ndarray, scratch: Path
) -> tuple[dict[Hashable, xr.Variable], dict[Hashable, xr.Variable], dict[str, Any]]:
    """Return the results of the cases (n, ...), the coordinates of their other axes, and the solver's attributes."""
    results: dict[Hashable, xr.Variable] = {}
    coords: dict[Hashable, xr.Variable] = {}
    attrs: dict[str, Any] = {}
    file, row = (found.states[name].values[place] for name in ("file", "row"))
    order = np.argsort(file, kind="stable")
    numbers, start = np.unique(file[order], return_index=True)
    for number, rows in zip(numbers, np.split(order, start[1:]), strict=True):
        try:
            block = chunks.read(found.paths[number])
        except (chunks.CorruptFile, FileNotFoundError) as exc:
            raise WorkError(f"corrupt results: {exc}. Start again: only its cases are solved.") from None
        attrs = block.attrs | attrs
        coords = {name: v.variable for name, v in block.coords.items() if name != "case"} | coords
        for name, v in block.data_vars.items():
            known = results.get(name, v[:0].variable)
            shape = (len(place), *np.maximum(known.shape[1:], v.shape[1:]))  # grids of different sizes
            if known.shape != shape:
                room = _room(shape, v.dtype, scratch)
                room[tuple(map(slice, known.shape))] = known.values
                results[name] = xr.Variable(v.dims, room, known.attrs)
            into: Any = (rows, *map(slice, v.shape[1:]))
            results[name].values[into] = v.values[row[rows]]
            results[name].attrs = results[name].attrs or v.attrs
    return results, coords, attrs


def _room(shape: tuple[int, ...], dtype: np.dtype, folder: Path) -> np.ndarray:
    """Return an array of missing values: NaN, 0 or ''. A large one lies in a temporary file."""
    size = math.prod(shape) * dtype.itemsize
    if dtype.kind in "OUT":
        return np.full(shape, "", dtype=object)
    missing = np.nan if dtype.kind == "f" else 0
    if size <= MOST_MEMORY:
        return np.full(shape, missing, dtype)
    with tempfile.TemporaryFile(dir=folder) as file:
        os.posix_fallocate(file.fileno(), 0, size)  # a full disk must not end in SIGBUS
        values: np.ndarray = np.memmap(file, dtype, "r+", shape=shape)
    values[...] = missing
    return values


def _labels(study: Study, design: xr.Dataset, sizes: dict[str, int], grid: dict[str, Factor]) -> Variables:
    """Return the axes of a grid, the number of each case, and every parameter over the axes that it depends on."""
    labels: Variables = {}

    def add(name: str, dims: tuple[str, ...], values: np.ndarray) -> None:
        known = design.get(name.removesuffix("_value"))
        attrs = known.attrs if known is not None else {"long_name": name.replace("_", " ")}
        labels.setdefault(name, _variable(dims, values, attrs, coordinate=True))

    for dim, factor in grid.items():
        add(dim, (dim,), readable(factor.take(np.arange(sizes[dim]))))
        if dim == "material_pair":
            for i, name in enumerate(MATERIAL_FIELDS):
                add(name, (dim,), np.array([pair[i] for pair in factor.levels], dtype=object))
    number = np.arange(design.sizes["case"])
    words = {"long_name": "case number, for `trackroller repeat`", "units": "1"}
    labels["case"] = _variable(tuple(sizes), number.reshape(*sizes.values()), words, coordinate=True)
    columns = {str(name): column.values for name, column in design.variables.items() if name != "case"}
    if "material_pair" in study.drawn.columns and "material_pair" not in grid:
        columns["material_pair"] = readable(study.drawn.columns["material_pair"])
    for name, values in columns.items():
        if name in grid and set(grid[name].levels) & {*FRICTION_LEVELS, None}:
            name = f"{name}_value"
        add(name, *_varying(values.reshape(*sizes.values()), list(sizes)))
    return labels


def _varying(values: np.ndarray, dims: list[str]) -> tuple[tuple[str, ...], np.ndarray]:
    """Return the dimensions that values depend on, and the values over these dimensions."""
    for dim in tuple(dims):
        axis = dims.index(dim)
        if all_equal(np.moveaxis(values, axis, 0)):
            values = values.take([0], axis=axis).squeeze(axis)
            dims.remove(dim)
    return tuple(dims), values


def _variable(
    dims: tuple[Hashable, ...], values: np.ndarray, attrs: dict[str, Any], coordinate: bool = False
) -> tuple[tuple[Hashable, ...], np.ndarray, dict[str, Any], dict[str, Any]]:
    """Return dimensions, values, attributes and encoding of a variable of the file; only results have a fill value."""
    encoding: dict[str, Any] = {"coordinates": None}  # one attribute of the file lists all of them
    encoding["_FillValue"] = np.nan if values.dtype.kind == "f" and not coordinate else None
    if dims and values.dtype.kind not in "OSU":
        encoding |= {"zlib": True, "complevel": 4, "shuffle": True}
    flags = ("flag_values", "flag_masks")  # these take the type of their variable
    told = {key: np.asarray(value, values.dtype) if key in flags else value for key, value in attrs.items()}
    return tuple(dims), values, told, encoding
