"""Store solved cases in files: blocks of rows, and a description of their columns.

A file holds one variable `values (case, quantity)`, which is quick to write and to concatenate. The global
attribute `layout` (JSON) names the columns of each result variable. The attribute `digest` is the SHA-256 of the
content, so that a truncated or altered file is noticed when it is read.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import xarray as xr

from trackroller.parameters import MAPPING_FIELDS, MATERIAL_FIELDS, PARAMETERS
from trackroller.roller.dataset import file_attributes
from trackroller.study.files import StudyFolder, Tell, write_whole
from trackroller.study.identity import chunk_name

FAILED = 3  # value of `regime`
_ATTRIBUTES = file_attributes("Solved cases of a parameter study, one row a case", "solved")


class CorruptFile(Exception):
    """Report a file of solved cases that is truncated or altered; the message names the file and the reason."""

    def __init__(self, path: Path, why: str) -> None:
        super().__init__(f"{path}: {why}")


@dataclass(frozen=True)
class Layout:
    """Describe a result variable without its case dimension."""

    dims: tuple[str, ...]
    shape: tuple[int, ...]
    dtype: str
    attrs: dict[str, Any]

    @property
    def size(self) -> int:
        """Return the number of columns."""
        return int(np.prod(self.shape, dtype=int))

    @property
    def missing(self) -> float:
        """Return the value that marks a missing result."""
        return np.nan if self.dtype.startswith("f") else 0.0


@dataclass
class Block:
    """Results of some cases.

    Attributes
    ----------
    cases : numpy.ndarray of dtype S32, shape (n,)
        Fingerprints.
    values : numpy.ndarray of float, shape (n, columns)
        Results, in the column order of `layout`.
    layout : dict
        `Layout` of each result variable, by name.
    coords : dict
        Variables without a case dimension: dims, values, attrs, and whether each is a coordinate.
    reasons : dict
        Why a case failed or misses its tolerance, by fingerprint.
    seconds : float
        Time spent on solving [s].
    attrs : dict
        Global attributes of the solver's dataset.
    """

    cases: np.ndarray
    values: np.ndarray
    layout: dict[str, Layout]
    coords: dict[str, dict[str, Any]] = field(default_factory=dict)
    reasons: dict[str, str] = field(default_factory=dict)
    seconds: float = 0.0
    attrs: dict[str, Any] = field(default_factory=dict)

    def columns(self, name: str) -> np.ndarray:
        """Return the columns of a variable, shape (n, size)."""
        start = 0
        for key, layout in self.layout.items():
            if key == name:
                return self.values[:, start : start + layout.size]
            start += layout.size
        raise KeyError(name)

    @property
    def failed(self) -> np.ndarray:
        """Return whether each case failed, shape (n,)."""
        return self.columns("regime")[:, 0] == FAILED

    def take(self, index: np.ndarray) -> Block:
        """Return the rows with the indices `index`."""
        cases = self.cases[index]
        kept = {case.decode() for case in cases} if self.reasons else set()
        reasons = {case: why for case, why in self.reasons.items() if case in kept}
        return Block(cases, self.values[index], self.layout, self.coords, reasons, self.seconds, self.attrs)


def from_dataset(dataset: xr.Dataset, cases: np.ndarray) -> Block:
    """Convert the dataset that `solve` returned for the cases with the fingerprints `cases` (n,) to a block."""
    layout: dict[str, Layout] = {}
    coords: dict[str, dict[str, Any]] = {}
    columns = []
    skip = {*PARAMETERS, *MATERIAL_FIELDS, *MAPPING_FIELDS, "case", "reason"}
    for name, variable in dataset.variables.items():
        if name in skip:
            continue
        if "case" not in variable.dims:
            coords[str(name)] = {
                "dims": list(variable.dims),
                "values": variable.values,
                "attrs": variable.attrs,
                "coordinate": name in dataset.coords,
            }
            continue
        ordered = variable.transpose("case", ...)
        dims, values = tuple(str(d) for d in ordered.dims[1:]), ordered.values
        dtype = "f8" if values.dtype.kind == "f" else f"i{min(values.dtype.itemsize, 8)}"
        layout[str(name)] = Layout(dims, values.shape[1:], dtype, variable.attrs)
        columns.append(values.reshape(len(cases), -1).astype(float))
    block = Block(np.asarray(cases, dtype="S32"), np.hstack(columns), layout, coords, attrs=dataset.attrs)
    why = np.atleast_1d(dataset["reason"].values) if "reason" in dataset else np.full(len(block.cases), "")
    for i, failed in enumerate(block.failed):
        if why[i] or failed:
            block.reasons[block.cases[i].decode()] = str(why[i]) or "no convergence"
    return block


def failure(cases: np.ndarray, reason: str) -> Block:
    """Return rows for cases that raised: regime failed, not converged, every other result missing."""
    layout = {"regime": Layout((), (), "i1", {}), "converged": Layout((), (), "i1", {})}
    values = np.tile([float(FAILED), 0.0], (len(cases), 1))
    return Block(np.asarray(cases, dtype="S32"), values, layout, reasons={c.decode(): reason for c in cases})


def merged_layout(blocks: Iterable[Mapping[str, Layout]]) -> dict[str, Layout]:
    """Combine layouts, the longest first; the first layout with attributes describes a variable."""
    layout: dict[str, Layout] = {}
    for block in sorted(blocks, key=lambda entry: -len(entry)):
        for name, entry in block.items():
            if name not in layout or (entry.attrs and not layout[name].attrs):
                layout[name] = entry
    return layout


def aligned(block: Block, layout: Mapping[str, Layout]) -> np.ndarray:
    """Return the values of a block in the columns of another layout, shape (n, columns)."""
    if list(block.layout) == list(layout):
        return block.values
    absent = {k: np.full((len(block.cases), v.size), v.missing) for k, v in layout.items() if k not in block.layout}
    return np.hstack([absent[name] if name in absent else block.columns(name) for name in layout])


def concatenate(blocks: list[Block]) -> Block:
    """Join blocks of different cases."""
    layout = merged_layout(b.layout for b in blocks)
    first = max(blocks, key=lambda b: len(b.layout))
    reasons = {case: why for block in blocks for case, why in block.reasons.items()}
    cases = np.concatenate([b.cases for b in blocks])
    values = np.concatenate([aligned(b, layout) for b in blocks])
    return Block(cases, values, layout, first.coords, reasons, sum(b.seconds for b in blocks), first.attrs)


def _header(block: Block) -> str:
    layout = {k: [list(v.dims), list(v.shape), v.dtype, v.attrs] for k, v in block.layout.items()}
    told = {"layout": layout, "coords": block.coords, "reasons": block.reasons, "attrs": block.attrs}
    return json.dumps(told, default=lambda value: value.tolist())  # of NumPy arrays and numbers


def _digest(header: str, cases: np.ndarray, values: np.ndarray) -> str:
    digest = hashlib.sha256(header.encode())
    digest.update(np.ascontiguousarray(cases).tobytes())
    digest.update(np.ascontiguousarray(values).tobytes())
    return digest.hexdigest()


def write(path: Path, block: Block) -> None:
    """Write a block, whole or not at all."""
    header = _header(block)

    def save(beside: Path) -> None:
        with netCDF4.Dataset(beside, "w") as file:
            n, width = block.values.shape
            for name, length in (("case", n), ("quantity", width), ("hex", 32)):
                file.createDimension(name, length)
            packed = {"compression": "zlib", "complevel": 1, "shuffle": n >= 64}
            values = file.createVariable("values", "f8", ("case", "quantity"), **packed)
            values[:] = block.values
            values.setncatts({"long_name": "results, in the columns that the attribute layout names"})
            cases = file.createVariable("cases", "S1", ("case", "hex"))
            cases[:] = block.cases.view("S1").reshape(n, 32)
            cases.setncatts({"long_name": "fingerprint of the case"})
            digest = _digest(header, block.cases, block.values)
            file.setncatts(_ATTRIBUTES | {"layout": header, "seconds": float(block.seconds), "digest": digest})

    write_whole(path, save)


def write_part(folder: StudyFolder, chunk: str, block: Block) -> Path:
    """Write a finished block of a chunk that is not complete yet; return its path."""
    path = folder.part(chunk, block.cases[0].decode())
    write(path, block)
    return path


def read(path: Path) -> Block:
    """Read a block; raise `CorruptFile` if the file is not exactly as it was written."""
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
    except (CorruptFile, FileNotFoundError):
        raise
    except Exception as exc:  # the netCDF library raises errors of many types for a damaged file
        raise CorruptFile(path, f"damaged ({str(exc).splitlines()[0] if str(exc) else type(exc).__name__})") from exc


def read_named(path: Path) -> Block:
    """Read a block of a study and verify that it holds the cases which its name announces.

    A complete chunk is named by the hash of its cases; the name of a part ends with its first case.
    """
    block = read(path)
    _, _, first = path.stem.partition("-")
    if first != block.cases[0].decode() if first else chunk_name(block.cases) != path.stem:
        raise CorruptFile(path, "it holds other cases than its name announces")
    return block


def read_sound(paths: Iterable[Path], corrupt: dict[Path, str]) -> Iterator[tuple[Path, Block]]:
    """Read the blocks of a study and note in `corrupt` what is wrong with damaged files."""
    for path in paths:
        try:
            yield path, read_named(path)
        except CorruptFile as exc:
            corrupt[path] = str(exc)
        except FileNotFoundError:  # a running process has just completed the chunk
            continue


def remove_corrupt(corrupt: Mapping[Path, str], tell: Tell) -> None:
    """Name and remove damaged files."""
    for path, why in corrupt.items():
        tell(f"corrupt results, their cases are solved again: {why}")
        path.unlink(missing_ok=True)
