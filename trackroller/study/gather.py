"""Gather solved cases into one file: a grid gets a dimension for each factor, a sample the dimension `case`."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from trackroller.numerics.numbers import all_equal
from trackroller.parameters import FRICTION_LEVELS, MATERIAL_FIELDS
from trackroller.roller.dataset import file_attributes
from trackroller.study import provenance, store
from trackroller.study.design.factors import Factor, readable
from trackroller.study.files import StudyFolder, Tell, WorkError, record_checksum, write_whole
from trackroller.study.inventory import Inventory, take_inventory
from trackroller.study.plan import Plan, identify

if TYPE_CHECKING:
    from trackroller.study.config import Study

MOST_MEMORY = 300_000_000  # bytes of results in memory; more results go through a temporary file
Variables = dict[str, tuple[tuple[str, ...], np.ndarray, dict[str, Any], dict[str, Any]]]


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
    The time is proportional to the number of results. Above `MOST_MEMORY` the results pass through a temporary
    file in the study's folder.
    """
    study, folder = plan.study, plan.folder
    design = study.design()
    cases = identify(study, design)
    if not folder.design.is_file():
        write_design(study, folder)
    found = take_inventory(folder)
    place = found.find(cases)
    if missing := int((place < 0).sum()):
        damaged = "".join(f" Corrupt: {why}." for why in found.corrupt.values())
        raise WorkError(f"{missing} of {len(cases)} cases are not solved.{damaged} Start the run again.")
    numbers, first = np.unique(found.file[place], return_index=True)
    headers = [found.headers[i] for i in numbers[np.argsort(first)]]
    grid = study.drawn.factors if study.drawn.method == "grid" else {}
    sizes = dict(zip(grid, study.drawn.meta["shape"], strict=True)) if grid else {"case": len(cases)}
    layout = store.merged_layout(header.layout for header in headers)
    why = {case.encode(): reason for case, reason in found.reasons.items()}
    reasons = np.array([why.get(case, "") for case in cases.tolist()], dtype=object)

    def save(beside: Path) -> None:
        with tempfile.TemporaryFile(dir=folder.root) as scratch:
            results = _results(_collect(scratch, layout, found, place), layout, sizes, reasons)
            coords = _labels(study, design, sizes, grid)
            for header in headers:
                for name, entry in header.coords.items():
                    into = coords if entry["coordinate"] else results
                    values = np.asarray(entry["values"])
                    into.setdefault(name, _variable(entry["dims"], values, entry["attrs"], into is coords))
            attrs = _attributes(study, design, headers)
            xr.Dataset(results, coords, attrs).to_netcdf(beside, engine="netcdf4")

    write_whole(folder.gathered, save)
    record_checksum(folder, folder.gathered)
    if tell is not None:
        tell(f"gathered {len(cases)} cases into {folder.gathered}")
    return folder.gathered


def _attributes(study: Study, design: xr.Dataset, headers: list[store.Block]) -> dict[str, Any]:
    """Return the global attributes: what the solver wrote, and what is needed to repeat the study."""
    names = sorted({str(m) for name in MATERIAL_FIELDS for m in np.unique(design[name].values.astype(str))})
    attrs: dict[str, Any] = {}
    for header in headers:
        attrs = header.attrs | attrs
    kept = {k: v for k, v in attrs.items() if isinstance(v, (str, int, float)) and k not in study.factors}
    return kept | provenance.attributes(study, names)


def _results(
    values: np.ndarray, layout: dict[str, store.Layout], sizes: dict[str, int], reasons: np.ndarray
) -> Variables:
    """Return the results of the cases, shape (columns, n), as variables, and the reasons of the failed ones."""
    variables, start = {}, 0
    for name, entry in layout.items():
        part = values[start : start + entry.size].T.reshape(*sizes.values(), *entry.shape)
        variables[name] = _variable((*sizes, *entry.dims), part.astype(entry.dtype, copy=False), entry.attrs)
        start += entry.size
    attrs = {"long_name": "why a case failed or misses its tolerance"}
    return variables | {"reason": _variable(tuple(sizes), reasons.reshape(*sizes.values()), attrs)}


def _collect(scratch: Any, layout: dict[str, store.Layout], found: Inventory, place: np.ndarray) -> np.ndarray:
    """Return the results of the cases, shape (columns, n); each file is read once."""
    shape = (sum(entry.size for entry in layout.values()), len(place))
    if 8 * shape[0] * shape[1] <= MOST_MEMORY:
        values = np.empty(shape)
    else:
        os.posix_fallocate(scratch.fileno(), 0, 8 * shape[0] * shape[1])  # a full disk must not end in SIGBUS
        values = np.memmap(scratch, dtype=float, mode="r+", shape=shape)
    order = np.argsort(found.file[place], kind="stable")
    numbers, start = np.unique(found.file[place][order], return_index=True)
    for number, rows in zip(numbers, np.split(order, start[1:]), strict=True):
        try:
            block = store.read_named(found.paths[number])
        except (store.CorruptFile, FileNotFoundError) as exc:
            raise WorkError(f"corrupt results: {exc}. Start again: only its cases are solved.") from None
        values[:, rows] = store.aligned(block, layout)[found.row[place[rows]]].T
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
    dims: tuple[str, ...], values: np.ndarray, attrs: dict[str, Any], coordinate: bool = False
) -> tuple[tuple[str, ...], np.ndarray, dict[str, Any], dict[str, Any]]:
    """Return dimensions, values, attributes and encoding of a variable of the file; only results have a fill value."""
    encoding: dict[str, Any] = {"coordinates": None}  # one attribute of the file lists all of them
    encoding["_FillValue"] = np.nan if values.dtype.kind == "f" and not coordinate else None
    if dims and values.dtype.kind not in "OSU":
        encoding |= {"zlib": True, "complevel": 4, "shuffle": True}
    flags = ("flag_values", "flag_masks")  # these take the type of their variable
    told = {key: np.asarray(value, values.dtype) if key in flags else value for key, value in attrs.items()}
    return tuple(dims), values, told, encoding
