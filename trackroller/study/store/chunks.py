"""Store blocks of cases in netCDF files that are noticed if they are damaged.

A block is a data set along `case`, whose coordinate `case` holds the fingerprints: results of solved cases with the
`reason` of each failure, or the inputs of cases that a chunk has to solve. The last 32 bytes of a file are the SHA-256
of the bytes before them; netCDF readers ignore these bytes.
"""

from __future__ import annotations

import contextlib
import hashlib
import stat
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

import netCDF4
import numpy as np
import xarray as xr

from trackroller.files import memory
from trackroller.parameters import REGIMES
from trackroller.roller.dataset import file_attributes, joined
from trackroller.study.store.digests import sums_up
from trackroller.study.store.fingerprint import chunk_name
from trackroller.study.store.netcdf import too_large
from trackroller.study.store.put import put_unlisted

FAILED = REGIMES.index("failed")
_ATTRIBUTES = file_attributes("Cases of a parameter study of track rollers, named by their fingerprints", "solved")
_LABELS = {"case": "fingerprint of the case", "reason": "why a case failed or misses its tolerance"}
_SMALL = 64  # cases; smaller files gain nothing from compression
_PACKED = {"zlib": True, "complevel": 1, "shuffle": True}


class CorruptFile(Exception):
    """Report a file of cases that is truncated or altered; the message names the file and the reason."""

    def __init__(self, path: Path, why: str) -> None:
        super().__init__(f"{path}: {why}")


def from_results(results: xr.Dataset, cases: np.ndarray) -> xr.Dataset:
    """Return what `solve` returned for the cases with the fingerprints `cases`, shape (n,), as a block."""
    reasons = np.full(len(cases), "", dtype=object)
    if "reason" in results:
        reasons[:] = results["reason"].values
    reasons[(results["regime"].values == FAILED) & (reasons == "")] = "no convergence"
    return results.transpose("case", ...).assign_coords(case=cases).assign(reason=("case", reasons))


def failure(cases: np.ndarray, reason: str) -> xr.Dataset:
    """Return the block of cases that raised: regime failed, not converged, without other results."""
    count = len(cases)
    rows = {"regime": np.full(count, FAILED, np.int8), "converged": np.zeros(count, np.int8)}
    rows["reason"] = np.full(count, reason, object)
    return xr.Dataset({name: ("case", values) for name, values in rows.items()}, {"case": cases})


def counts(block: xr.Dataset) -> tuple[int, int]:
    """Return the number of cases of a block, and how many of them failed."""
    return block.sizes["case"], int((block["regime"] == FAILED).sum())


def join(blocks: Iterable[xr.Dataset]) -> xr.Dataset:
    """Join blocks of different cases, see `trackroller.roller.dataset.joined`; their `seconds` add up."""
    blocks = list(blocks)
    seconds = sum(block.attrs.get("seconds", 0.0) for block in blocks)
    return joined(blocks).assign_attrs({"seconds": seconds})


def write(path: Path, block: xr.Dataset, packed: bool = False) -> None:
    """Write a block, whole or not at all; compression (`packed`) saves space and takes longer."""
    labelled = block.assign_attrs(_ATTRIBUTES)
    for name in _LABELS.keys() & labelled.variables.keys():
        labelled[name].attrs = {"long_name": _LABELS[name]}
    encoding = {}
    if packed and block.sizes["case"] >= _SMALL:
        for column, values in block.variables.items():
            if "case" in values.dims and values.dtype.kind in "fi":
                encoding[column] = _PACKED

    def save(beside: Path) -> None:
        labelled.to_netcdf(beside, engine="netcdf4", encoding=encoding)
        digest = hashlib.sha256(beside.read_bytes()).digest()
        with open(beside, "ab") as stream:
            stream.write(digest)

    put_unlisted(path, save)


@contextlib.contextmanager
def _opened(path: Path) -> Iterator[tuple[netCDF4.Dataset, np.ndarray]]:
    """Open a file, and yield it with its fingerprints, shape (n,).

    Raise `CorruptFile` if the file was altered or holds other cases than its name says: the name of a chunk and of its
    list is the hash of their cases.
    """
    if not stat.S_ISREG(path.stat().st_mode):
        raise CorruptFile(path, "it is no file")
    if path.stat().st_size > memory():
        raise CorruptFile(path, "it is larger than the memory")
    content = path.read_bytes()
    if not sums_up(content):
        raise CorruptFile(path, "its content does not fit its checksum")
    with netCDF4.Dataset(path.name, memory=content[:-32]) as file:
        excess = too_large(file, len(content))
        if excess:
            raise CorruptFile(path, f"it {excess}")
        file.set_auto_mask(False)
        cases: np.ndarray = np.ascontiguousarray(file["case"][:]).view("S32").reshape(-1)
        if chunk_name(cases) != path.stem:
            raise CorruptFile(path, "it holds other cases than its name announces")
        yield file, cases


def check(path: Path) -> np.ndarray:
    """Return the fingerprints in a file, shape (n,); raise `CorruptFile` if it is damaged."""
    with _opened(path) as (_, cases):
        return cases


def read(path: Path) -> xr.Dataset:
    """Read a block; raise `CorruptFile` if the file is damaged."""
    with _opened(path) as (file, _):
        return xr.open_dataset(xr.backends.NetCDF4DataStore(file)).load()  # type: ignore[no-untyped-call]


def read_state(path: Path) -> xr.Dataset:
    """Read regime and reason of solved cases alone, which is much faster than `read`."""
    with _opened(path) as (file, cases):
        state = {name: ("case", file[name][:]) for name in ("regime", "reason")}
        return xr.Dataset(state, {"case": cases}, {"seconds": float(file.seconds)})


def read_sound(
    paths: Iterable[Path], corrupt: dict[Path, str], how: Callable[[Path], xr.Dataset] = read
) -> Iterator[tuple[Path, xr.Dataset]]:
    """Read files of solved cases and note in `corrupt` what is wrong with damaged files."""
    for path in paths:
        try:
            yield path, how(path)
        except CorruptFile as exc:
            corrupt[path] = str(exc)
        except FileNotFoundError:  # a running process has just removed this file, to solve its failed cases again
            continue
