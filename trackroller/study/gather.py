"""Gather solved cases into one file: a grid gets a dimension for each factor, a sample the dimension `case`."""

from __future__ import annotations

import json
import os
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import netCDF4
import numpy as np

from trackroller.parameters import FRICTION_LEVELS, MATERIAL_FIELDS, PARAMETERS
from trackroller.roller.dataset import file_attributes
from trackroller.study import provenance, store
from trackroller.study.design.build import build, case_columns
from trackroller.study.design.factors import Factor, label
from trackroller.study.files import StudyFolder, Tell, WorkError, record_checksum, write_whole
from trackroller.study.inventory import Inventory, take_inventory
from trackroller.study.plan import Plan, identify

if TYPE_CHECKING:
    import xarray as xr

    from trackroller.study.config import Study

MOST_MEMORY = 300_000_000  # bytes of results in memory; more results go through a temporary file


@dataclass(frozen=True)
class Axes:
    """Dimensions of the gathered cases: names, lengths, and the factors of a grid by dimension."""

    dims: tuple[str, ...]
    shape: tuple[int, ...]
    factors: dict[str, Factor]


def write_design(study: Study, folder: StudyFolder, design: xr.Dataset | None = None) -> None:
    """Write `design.nc`, the cases of a study, and record its checksum."""
    design = build(study) if design is None else design
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
    sampled = study.drawn
    design = build(study, sampled)
    cases = identify(study, design)
    if not folder.design.is_file():
        write_design(study, folder, design)
    found = take_inventory(folder)
    place = found.find(cases)
    if missing := int((place < 0).sum()):
        damaged = "".join(f" Corrupt: {why}." for why in found.corrupt.values())
        raise WorkError(f"{missing} of {len(cases)} cases are not solved.{damaged} Start the run again.")
    axes = Axes(("case",), (len(cases),), {})
    if sampled.method == "grid" and sampled.factors:
        axes = Axes(tuple(sampled.factors), tuple(sampled.meta["shape"]), sampled.factors)

    def save(beside: Path) -> None:
        with netCDF4.Dataset(beside, "w") as file:
            labels = _write_axes(file, design, axes, sampled.columns)
            numbers, first = np.unique(found.file[place], return_index=True)
            headers = [found.headers[i] for i in numbers[np.argsort(first)]]
            labels += _write_coordinates(file, headers)
            _write_results(file, folder, axes, found, place, headers)
            file.setncatts(_attributes(study, design, headers) | {"coordinates": " ".join(labels)})

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


def _write_coordinates(file: netCDF4.Dataset, headers: list[store.Block]) -> list[str]:
    """Write the results without a case dimension; return the names of the auxiliary coordinates."""
    coords: dict[str, Any] = {}
    for header in headers:
        coords = header.coords | coords
    for name, entry in coords.items():
        _put(file, name, tuple(entry["dims"]), np.asarray(entry["values"]), entry["attrs"], coordinate=True)
    return [name for name, entry in coords.items() if entry["coordinate"] and name not in file.dimensions]


def _write_results(
    file: netCDF4.Dataset,
    folder: StudyFolder,
    axes: Axes,
    found: Inventory,
    place: np.ndarray,
    headers: list[store.Block],
) -> None:
    layout = store.merged_layout(header.layout for header in headers)
    with tempfile.TemporaryFile(dir=folder.root) as scratch:
        values = _collect(scratch, layout, found, place)
        start = 0
        for name, entry in layout.items():
            part = values[start : start + entry.size].T.reshape(*axes.shape, *entry.shape)
            _put(file, name, (*axes.dims, *entry.dims), part.astype(entry.dtype), entry.attrs)
            start += entry.size
    reasons = np.full(len(place), "", dtype=object)
    known = np.array([case.encode() for case in found.reasons], dtype="S32")
    why = dict(zip(found.find(known).tolist(), found.reasons.values(), strict=True))
    for i in np.flatnonzero(np.isin(place, list(why))):
        reasons[i] = why[place[i]]
    attrs = {"long_name": "why a case failed or misses its tolerance"}
    _put(file, "reason", axes.dims, reasons.reshape(axes.shape), attrs)


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


def _write_axes(file: netCDF4.Dataset, design: xr.Dataset, axes: Axes, drawn: dict[str, np.ndarray]) -> list[str]:
    """Write the dimensions and every parameter as a coordinate; return the names of the auxiliary coordinates."""
    labels: list[str] = []
    for dim, length in zip(axes.dims, axes.shape, strict=True):
        file.createDimension(dim, length)

    def add(name: str, dims: tuple[str, ...], values: np.ndarray, attrs: dict[str, Any]) -> None:
        _put(file, name, dims, values, attrs, coordinate=True)
        if name not in axes.dims:
            labels.append(name)

    for dim, factor in axes.factors.items():
        levels = factor.levels if factor.numeric else [label(v) for v in factor.levels]
        add(dim, (dim,), np.array(levels, dtype=float if factor.numeric else object), _parameter_attrs(dim))
        if dim == "material_pair":
            for i, name in enumerate(MATERIAL_FIELDS):
                materials = np.array([pair[i] for pair in factor.levels], dtype=object)
                add(name, (dim,), materials, _parameter_attrs(name))
    number = np.arange(design.sizes["case"]).reshape(axes.shape)
    add("case", axes.dims, number, {"long_name": "case number, for `trackroller repeat`", "units": "1"})
    for name, values in _columns(design, axes, drawn).items():
        if name in axes.factors and set(axes.factors[name].levels) & {*FRICTION_LEVELS, None}:
            name = f"{name}_value"
        if name not in file.variables:
            dims, part = _varying(values, axes)
            add(name, dims, part, _parameter_attrs(name))
    return labels


def _columns(design: xr.Dataset, axes: Axes, drawn: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return the parameters of the cases by name, each of shape (n,)."""
    columns = {str(name): design[name].values for name in case_columns(design)}
    columns |= {str(name): design[name].values for name in design.coords if name != "case"}
    if "material_pair" in drawn and "material_pair" not in axes.factors:
        columns["material_pair"] = np.array([label(v) for v in drawn["material_pair"]], dtype=object)
    return columns


def _varying(values: np.ndarray, axes: Axes) -> tuple[tuple[str, ...], np.ndarray]:
    """Return the dimensions that a column depends on, and its values over these dimensions."""
    dims, part = list(axes.dims), values.reshape(axes.shape)
    for dim in axes.dims:
        axis = dims.index(dim)
        first = part.take([0], axis=axis)
        equal = part == first
        if values.dtype.kind == "f":
            equal |= np.isnan(part) & np.isnan(first)
        if np.all(equal):
            part = first.squeeze(axis)
            dims.remove(dim)
    return tuple(dims), part


def _parameter_attrs(name: str) -> dict[str, Any]:
    base = name.removesuffix("_value")
    if base in PARAMETERS:
        parameter = PARAMETERS[base]
        return {"units": parameter.units, "long_name": parameter.long_name, "symbol": parameter.symbol}
    return {"long_name": name.replace("_", " ")}


def _put(
    file: netCDF4.Dataset,
    name: str,
    dims: tuple[str, ...],
    values: np.ndarray,
    attrs: dict[str, Any],
    coordinate: bool = False,
) -> None:
    """Write a variable and create its missing dimensions; only results have a fill value."""
    values = np.asarray(values)
    for dim, length in zip(dims, values.shape, strict=True):
        if dim not in file.dimensions:
            file.createDimension(dim, length)
    if values.dtype.kind in "OSU":
        variable = file.createVariable(name, str, dims)
        variable[...] = values.astype(object) if values.ndim else str(values)
    else:
        packed: dict[str, Any] = {"compression": "zlib", "complevel": 4, "shuffle": True} if dims else {}
        fill = np.nan if values.dtype.kind == "f" and not coordinate else None
        variable = file.createVariable(name, values.dtype, dims, fill_value=fill, **packed)
        variable[...] = values
    kept = {key: value for key, value in attrs.items() if value is not None and key != "_FillValue"}
    variable.setncatts({key: _attribute(key, value, values.dtype) for key, value in kept.items()})


def _attribute(key: str, value: Any, dtype: np.dtype) -> Any:
    """Convert an attribute to a netCDF type: flags take the type of their variable, booleans become numbers."""
    if key in ("flag_values", "flag_masks", "valid_range"):
        return np.asarray(value, dtype=dtype)
    if isinstance(value, bool):
        return int(value)
    if isinstance(value, (dict, list)) and not all(isinstance(v, (int, float)) for v in value):
        return json.dumps(value)
    return value
