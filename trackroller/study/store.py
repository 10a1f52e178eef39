"""Solved cases in files: blocks of rows with the layout of their variables.

A file holds one 2-D variable `values (case, quantity)`, light to write and to concatenate. The global
attribute `layout` (JSON) says which columns make up which variable; `digest` is the SHA-256 of all content,
so that a file that was cut off or changed is found when it is read.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.parameters import MAPPING_FIELDS, MATERIAL_FIELDS, PARAMETERS
from trackroller.study.files import write_whole
from trackroller.study.identity import chunk_name

if TYPE_CHECKING:
    import xarray as xr

FAILED = 3  # value of `regime`


class CorruptFile(Exception):
    """A file of solved cases that cannot be trusted; says which and why."""

    def __init__(self, path: Path, why: str) -> None:
        super().__init__(f"{path}: {why}")
        self.path = path


@dataclass(frozen=True)
class Layout:
    """A result variable without its case axis."""

    dims: tuple[str, ...]
    shape: tuple[int, ...]
    dtype: str
    attrs: dict[str, Any]

    @property
    def size(self) -> int:
        """Number of columns."""
        return int(np.prod(self.shape, dtype=int))

    @property
    def missing(self) -> float:
        """Value of a case that has none."""
        return np.nan if self.dtype.startswith("f") else 0.0


@dataclass
class Block:
    """Solved cases: `values` (n, columns) in the order of `layout`, `reasons` of rows without a good solution."""

    cases: np.ndarray
    values: np.ndarray
    layout: dict[str, Layout]
    coords: dict[str, dict[str, Any]] = field(default_factory=dict)
    reasons: dict[str, str] = field(default_factory=dict)
    seconds: float = 0.0
    attrs: dict[str, Any] = field(default_factory=dict)

    def columns(self, name: str) -> np.ndarray:
        """The columns of a variable, shape (n, size)."""
        start = 0
        for key, layout in self.layout.items():
            if key == name:
                return self.values[:, start : start + layout.size]
            start += layout.size
        raise KeyError(name)

    @property
    def failed(self) -> np.ndarray:
        """Which rows failed, shape (n,)."""
        return self.columns("regime")[:, 0] == FAILED

    def take(self, index: np.ndarray) -> Block:
        """The rows `index`."""
        cases = self.cases[index]
        kept = {case.decode() for case in cases}
        reasons = {case: why for case, why in self.reasons.items() if case in kept}
        return Block(cases, self.values[index], self.layout, self.coords, reasons, self.seconds, self.attrs)


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.tolist()
    return value.item() if isinstance(value, np.generic) else value


def from_dataset(dataset: xr.Dataset, cases: np.ndarray, seconds: float = 0.0) -> Block:
    """A block from what `solve` returned for `cases` (fingerprints, shape (n,))."""
    layout: dict[str, Layout] = {}
    coords: dict[str, dict[str, Any]] = {}
    columns = []
    skip = {*PARAMETERS, *MATERIAL_FIELDS, *MAPPING_FIELDS, "case", "reason"}
    for name, variable in dataset.variables.items():
        if name in skip:
            continue
        attrs = {k: _plain(v) for k, v in variable.attrs.items()}
        if "case" not in variable.dims:
            coords[str(name)] = {
                "dims": list(variable.dims),
                "values": _plain(variable.values),
                "attrs": attrs,
                "coordinate": name in dataset.coords,
            }
            continue
        values = variable.transpose("case", ...).values
        dims = tuple(str(d) for d in variable.transpose("case", ...).dims[1:])
        dtype = "f8" if values.dtype.kind == "f" else f"i{min(values.dtype.itemsize, 8)}"
        layout[str(name)] = Layout(dims, values.shape[1:], dtype, attrs)
        columns.append(values.reshape(len(cases), -1).astype(float))
    block = Block(
        np.asarray(cases, dtype="S32"),
        np.hstack(columns),
        layout,
        coords,
        {},
        seconds,
        {k: _plain(v) for k, v in dataset.attrs.items()},
    )
    told = np.atleast_1d(dataset["reason"].values) if "reason" in dataset else np.full(len(block.cases), "")
    for i, failed in enumerate(block.failed):
        if told[i] or failed:
            block.reasons[block.cases[i].decode()] = str(told[i]) or "no convergence"
    return block


def failure(cases: np.ndarray, reason: str) -> Block:
    """Rows of cases that raised: regime failed, not converged, everything else missing."""
    layout = {"regime": Layout((), (), "i1", {}), "converged": Layout((), (), "i1", {})}
    values = np.tile([float(FAILED), 0.0], (len(cases), 1))
    return Block(np.asarray(cases, dtype="S32"), values, layout, reasons={c.decode(): reason for c in cases})


def merged_layout(blocks: Iterable[Mapping[str, Layout]]) -> dict[str, Layout]:
    """Every variable of any block; the first block with attributes describes it."""
    layout: dict[str, Layout] = {}
    for block in blocks:
        for name, entry in block.items():
            if name not in layout or (entry.attrs and not layout[name].attrs):
                layout[name] = entry
    return layout


def aligned(block: Block, layout: Mapping[str, Layout]) -> np.ndarray:
    """Values of a block in the columns of another layout, shape (n, columns); missing ones filled."""
    if list(block.layout) == list(layout):
        return block.values
    parts = []
    for name, entry in layout.items():
        if name in block.layout:
            parts.append(block.columns(name))
        else:
            parts.append(np.full((len(block.cases), entry.size), entry.missing))
    return np.hstack(parts)


def concatenate(blocks: list[Block]) -> Block:
    """Blocks one after the other."""
    layout = merged_layout(b.layout for b in sorted(blocks, key=lambda b: -len(b.layout)))
    first = max(blocks, key=lambda b: len(b.layout))
    reasons: dict[str, str] = {}
    for block in blocks:
        reasons |= block.reasons
    values = np.concatenate([aligned(b, layout) for b in blocks])
    return Block(
        np.concatenate([b.cases for b in blocks]),
        values,
        layout,
        first.coords,
        reasons,
        sum(b.seconds for b in blocks),
        first.attrs,
    )


def _header(block: Block) -> str:
    layout = {k: [list(v.dims), list(v.shape), v.dtype, v.attrs] for k, v in block.layout.items()}
    return json.dumps({"layout": layout, "coords": block.coords, "reasons": block.reasons, "attrs": block.attrs})


def _digest(header: str, cases: np.ndarray, values: np.ndarray) -> str:
    digest = hashlib.sha256(header.encode())
    digest.update(np.ascontiguousarray(cases).tobytes())
    digest.update(np.ascontiguousarray(values).tobytes())
    return digest.hexdigest()


def write(path: Path, block: Block) -> None:
    """Write a block; the file appears whole or not at all."""
    header = _header(block)

    def save(beside: Path) -> None:
        import netCDF4

        with netCDF4.Dataset(beside, "w") as file:
            n, width = block.values.shape
            file.createDimension("case", n)
            file.createDimension("quantity", width)
            file.createDimension("hex", 32)
            values = file.createVariable(
                "values", "f8", ("case", "quantity"), compression="zlib", complevel=1, shuffle=n >= 64
            )
            values[:] = block.values
            file.createVariable("cases", "S1", ("case", "hex"))[:] = block.cases.view("S1").reshape(n, 32)
            file.setncatts(
                {
                    "layout": header,
                    "seconds": float(block.seconds),
                    "digest": _digest(header, block.cases, block.values),
                }
            )

    write_whole(path, save)


def read_chunk(path: Path) -> Block:
    """Read a finished chunk, whose name is the hash of its cases; raises `CorruptFile` as `read` does."""
    block = read(path)
    if chunk_name(block.cases) != path.stem:
        raise CorruptFile(path, "it holds the cases of another chunk")
    return block


def read(path: Path) -> Block:
    """Read a block back; raises `CorruptFile` for a file that is not exactly as it was written."""
    import netCDF4

    try:
        with netCDF4.Dataset(path) as file:
            file.set_auto_mask(False)
            header, seconds, told = file.layout, float(file.seconds), file.digest
            values = np.asarray(file["values"][:], dtype=float)
            raw = np.ascontiguousarray(file["cases"][:])
        cases = raw.view("S32").reshape(-1)
        if _digest(header, cases, values) != told:
            raise CorruptFile(path, "its content does not fit its checksum")
        data = json.loads(header)
        layout = {k: Layout(tuple(v[0]), tuple(v[1]), v[2], v[3]) for k, v in data["layout"].items()}
        return Block(cases, values, layout, data["coords"], data["reasons"], seconds, data["attrs"])
    except CorruptFile:
        raise
    except FileNotFoundError:
        raise
    except Exception as exc:  # whatever the library makes of a damaged file
        raise CorruptFile(path, f"damaged ({str(exc).splitlines()[0] if str(exc) else type(exc).__name__})") from exc
