"""One labelled file from the chunks: a grid gets its factors as dimensions, a sample the dimension `case`."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.parameters import FRICTION_LEVELS, MATERIAL_FIELDS, PARAMETERS
from trackroller.study import provenance, store
from trackroller.study.caselists import load_list
from trackroller.study.design.build import build, case_columns, draw
from trackroller.study.design.factors import Factor, label
from trackroller.study.files import WorkError, write_whole
from trackroller.study.mend import Tell
from trackroller.study.plan import Plan, identify

if TYPE_CHECKING:
    import xarray as xr

    from trackroller.study.config import Study

BATCH_BYTES = 300_000_000  # of values in memory at once


@dataclass(frozen=True)
class Axes:
    """How rows become dimensions: `dims` and `shape` of the cases, `factors` of a grid by dimension."""

    dims: tuple[str, ...]
    shape: tuple[int, ...]
    factors: dict[str, Factor]


def write_design(study: Study, path: Path, design: xr.Dataset | None = None) -> None:
    """Write `design.nc`, the cases of a study."""
    design = build(study) if design is None else design

    def save(beside: Path) -> None:
        design.to_netcdf(beside, engine="netcdf4")

    write_whole(path, save)


def gather(plan: Plan, out: Path | None = None, tell: Tell | None = None) -> Path:
    """Gather the solved chunks of a plan into one data set.

    Raises `WorkError` when cases are missing; a corrupt chunk is named and removed, so that the next run
    solves its cases again.
    """
    out = plan.folder.gathered if out is None else out
    sampled = draw(plan.study)
    design = build(plan.study, sampled)
    cases = identify(plan.study, design)
    if not plan.folder.design.is_file():
        write_design(plan.study, plan.folder.design, design)
    listed = np.concatenate([load_list(plan.folder, name).cases for name in plan.chunks])
    order = np.argsort(listed, kind="stable")
    place = np.searchsorted(listed[order], cases).clip(max=len(listed) - 1)
    source = order[place]
    if missing := int((listed[source] != cases).sum()):
        raise WorkError(f"{missing} of {len(cases)} cases are in no chunk: start the run again.")
    grid = sampled.method == "grid" and bool(sampled.factors)
    axes = (
        Axes(tuple(sampled.factors), tuple(sampled.meta["shape"]), sampled.factors)
        if grid
        else Axes(("case",), (len(cases),), {})
    )

    def save(beside: Path) -> None:
        import netCDF4

        with netCDF4.Dataset(beside, "w") as file:
            _write(file, plan, design, cases, source, axes, sampled.columns)

    write_whole(out, save)
    if tell is not None:
        tell(f"gathered {len(cases)} cases into {out}")
    return out


def _read_chunk(plan: Plan, name: str) -> store.Block:
    try:
        return store.read_chunk(plan.folder.kept(name))
    except FileNotFoundError:
        raise WorkError(f"chunk {name} is not solved yet: start the run again.") from None
    except store.CorruptFile as exc:
        plan.folder.kept(name).unlink(missing_ok=True)
        plan.folder.chunk(name).unlink(missing_ok=True)
        raise WorkError(f"corrupt chunk, removed: {exc}. Start the run again: only its cases are solved.") from None


def _layout(plan: Plan) -> tuple[dict[str, store.Layout], dict[str, Any], dict[str, Any], dict[str, str]]:
    layouts: list[dict[str, store.Layout]] = []
    coords: dict[str, Any] = {}
    attrs: dict[str, Any] = {}
    reasons: dict[str, str] = {}
    for name in plan.chunks:
        block = _read_chunk(plan, name)
        layouts.append(block.layout)
        coords = block.coords | coords
        attrs = block.attrs | attrs
        reasons |= block.reasons
    return store.merged_layout(sorted(layouts, key=lambda entry: -len(entry))), coords, attrs, reasons


def _batches(layout: dict[str, store.Layout], rows: int) -> Iterator[dict[str, store.Layout]]:
    batch: dict[str, store.Layout] = {}
    for name, entry in layout.items():
        if batch and 8 * rows * (sum(e.size for e in batch.values()) + entry.size) > BATCH_BYTES:
            yield batch
            batch = {}
        batch[name] = entry
    yield batch


def _write(
    file: Any,
    plan: Plan,
    design: Any,
    cases: np.ndarray,
    source: np.ndarray,
    axes: Axes,
    drawn: dict[str, np.ndarray],
) -> None:
    layout, coords, attrs, reasons = _layout(plan)
    study = plan.study
    materials = sorted({str(m) for name in MATERIAL_FIELDS for m in np.unique(design[name].values.astype(str))})
    kept = {k: v for k, v in attrs.items() if isinstance(v, (str, int, float)) and k != "solver_digest"}
    for name in study.factors:
        kept.pop(name, None)
    file.setncatts(kept | provenance.attributes(study, materials))
    for dim, length in zip(axes.dims, axes.shape, strict=True):
        file.createDimension(dim, length)
    labels = _write_axes(file, design, axes, drawn)
    for name, entry in coords.items():
        values = np.asarray(entry["values"])
        for dim, length in zip(entry["dims"], values.shape, strict=True):
            if dim not in file.dimensions:
                file.createDimension(dim, length)
        _put(file, name, tuple(entry["dims"]), values, entry["attrs"])
        if entry["coordinate"] and name not in file.dimensions:
            labels.append(name)
    for batch in _batches(layout, len(cases)):
        blocks = (_read_chunk(plan, name) for name in plan.chunks)
        values = np.concatenate([store.aligned(block, batch) for block in blocks])[source]
        start = 0
        for name, entry in batch.items():
            for dim, length in zip(entry.dims, entry.shape, strict=True):
                if dim not in file.dimensions:
                    file.createDimension(dim, length)
            part = values[:, start : start + entry.size].reshape(*axes.shape, *entry.shape)
            _put(file, name, (*axes.dims, *entry.dims), part.astype(entry.dtype), entry.attrs)
            start += entry.size
    told = np.array([reasons.get(case, "") for case in np.char.decode(cases)], dtype=object) if reasons else None
    told = np.full(len(cases), "", dtype=object) if told is None else told
    _put(
        file, "reason", axes.dims, told.reshape(axes.shape), {"long_name": "why a case failed or misses its tolerance"}
    )
    if labels:
        file.setncattr("coordinates", " ".join(labels))


def _write_axes(file: Any, design: Any, axes: Axes, drawn: dict[str, np.ndarray]) -> list[str]:
    """Labels of the dimensions and every parameter as a coordinate; returns the names of the latter."""
    labels: list[str] = []
    for dim, factor in axes.factors.items():
        values = (
            np.array(factor.levels, dtype=float)
            if factor.numeric
            else np.array([label(v) for v in factor.levels], dtype=object)
        )
        _put(file, dim, (dim,), values, _parameter_attrs(dim))
        if dim == "material_pair":
            for i, name in enumerate(MATERIAL_FIELDS):
                _put(
                    file,
                    name,
                    (dim,),
                    np.array([pair[i] for pair in factor.levels], dtype=object),
                    {"long_name": name.replace("_", " ")},
                )
                labels.append(name)
    if "case" not in axes.dims:
        _put(
            file,
            "case",
            axes.dims,
            np.arange(design.sizes["case"]).reshape(axes.shape),
            {"long_name": "case number, for `trackroller repeat`", "units": "1"},
        )
        labels.append("case")
    else:
        _put(file, "case", ("case",), np.arange(design.sizes["case"]), {"long_name": "case number", "units": "1"})
    extra = {name: design[name].values for name in design.coords if name != "case"}
    if "material_pair" in drawn and "material_pair" not in axes.factors:
        extra["material_pair"] = np.array([label(v) for v in drawn["material_pair"]], dtype=object)
    columns = {name: design[name].values for name in case_columns(design)} | extra
    for name, values in columns.items():
        if name in axes.factors and set(axes.factors[name].levels) & {*FRICTION_LEVELS, None}:
            name = f"{name}_value"
        if name in file.variables:
            continue
        labels.append(name)
        used = _varying(values, axes)
        if used is None:
            _put(file, name, (), values[0], _parameter_attrs(name))
        else:
            dims, part = used
            _put(file, name, dims, part, _parameter_attrs(name))
    return labels


def _varying(values: np.ndarray, axes: Axes) -> tuple[tuple[str, ...], np.ndarray] | None:
    """The dimensions a column really depends on, and its values over these; None for a constant."""
    full = values.reshape(axes.shape)
    same = full == full.reshape(-1)[0]
    if values.dtype.kind == "f":
        same |= np.isnan(full) & np.isnan(full.reshape(-1)[0])
    if np.all(same):
        return None
    dims, part = list(axes.dims), full
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


def _put(file: Any, name: str, dims: tuple[str, ...], values: Any, attrs: dict[str, Any]) -> None:
    values = np.asarray(values)
    if values.dtype.kind in "OSU":
        variable = file.createVariable(name, str, dims)
        variable[...] = values.astype(object) if values.ndim else str(values)
    else:
        packed = {"compression": "zlib", "complevel": 4, "shuffle": True} if dims else {}
        fill = np.nan if values.dtype.kind == "f" else None
        variable = file.createVariable(name, values.dtype, dims, fill_value=fill, **packed)
        variable[...] = values
    variable.setncatts(
        {
            key: _attribute(key, value, values.dtype)
            for key, value in attrs.items()
            if value is not None and key != "_FillValue"
        }
    )


def _attribute(key: str, value: Any, dtype: np.dtype) -> Any:
    """An attribute as netCDF can hold it: flags in the type of their variable, no truth values."""
    if key in ("flag_values", "flag_masks", "valid_range"):
        return np.asarray(value, dtype=dtype)
    if isinstance(value, bool):
        return int(value)
    if isinstance(value, (dict, list)) and not all(isinstance(v, (int, float)) for v in value):
        return json.dumps(value)
    return value
