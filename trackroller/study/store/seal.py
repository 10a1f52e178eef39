"""Record the digests of results, and compare a result with its digest before it is read.

The SHA-256 of each result stands in `plan/NAME.sha256`, in the format of `sha256sum`; a folder such as `figures/` has a
line for each file. A result without such a record is compared with the RO-Crate beside it, if there is one. A lone
netCDF file has neither and is read as it is.
"""

from __future__ import annotations

import contextlib
import json
import math
from collections.abc import Iterator
from pathlib import Path

import netCDF4
import xarray as xr

from trackroller.errors import InputError, WorkError
from trackroller.files import memory, sha256, write_text

METADATA = "ro-crate-metadata.json"
ANY_BYTES = 1_000_000_000  # any file may declare so many bytes
MOST_PACKED = 200  # bytes declared for each byte of a larger file; results of a study pack 2 to 20 times
TEXT_BYTES = 100  # of a text in memory
REPORT = ("sensitivity.nc", "report.html", "figures", "tables")  # what is made from study.nc


def _record(path: Path) -> Path:
    """Return the file with the digests of a result."""
    return path.parent / "plan" / f"{path.name}.sha256"


def files_of(path: Path) -> list[Path]:
    """Return the files of a result, which is a file or a folder; hidden files do not count."""
    files = sorted(path.rglob("*")) if path.is_dir() else [path]
    return [file for file in files if file.is_file() and not file.name.startswith(".")]


@contextlib.contextmanager
def sealing(path: Path) -> Iterator[None]:
    """Record the digests of a result that is written within this context.

    The earlier record is removed first, so that a process stopped in between leaves a result without a record, not one
    that looks altered. The description of the folder goes with data that it describes: it is written last of all.
    """
    _record(path).unlink(missing_ok=True)
    if path.suffix == ".nc":
        for of_crate in (path.parent / METADATA, _record(path.parent / METADATA)):
            of_crate.unlink(missing_ok=True)
    yield
    lines = [f"{sha256(file)}  ../{file.relative_to(path.parent).as_posix()}\n" for file in files_of(path)]
    write_text(_record(path), "".join(lines))


def forget_report(root: Path) -> None:
    """Remove the records of analysis, figures and report, which were made from earlier results of the study."""
    for name in REPORT:
        _record(root / name).unlink(missing_ok=True)


def discard(path: Path) -> None:
    """Remove a result and its record, if there is one; it does not look lost."""
    _record(path).unlink(missing_ok=True)
    path.unlink(missing_ok=True)


def recorded(path: Path) -> dict[str, str] | None:
    """Return the recorded SHA-256 of a result by file, relative to the study's folder; None without a record."""
    try:
        lines = _record(path).read_text(encoding="utf-8").splitlines()
    except FileNotFoundError:
        return None
    except (OSError, UnicodeDecodeError):
        return {}
    return {name.removeprefix("../"): digest for digest, _, name in (line.partition("  ") for line in lines)}


def altered(path: Path) -> str | None:
    """Return what is wrong with a result that was recorded, None if it is as it was written.

    Parameters
    ----------
    path : pathlib.Path
        A file or folder in a study's folder.
    """
    known = recorded(path)
    if known is None:
        return None
    now = {file.relative_to(path.parent).as_posix(): sha256(file) for file in files_of(path)}
    if known != now and known != recorded(path):  # another process has just written the result
        return altered(path)
    for name in sorted({*known, *now}):
        if known.get(name) != now.get(name):
            return _altered(path.parent / name, now.get(name), known.get(name), _record(path))
    return None


def _altered(path: Path, now: str | None, before: str | None, record: Path) -> str:
    if now is None:
        return f"{path} is missing, but its SHA-256 stands in {record}"
    stands = f"{before} stands" if before else "no digest stands"
    return f"{path} was altered or damaged after it was written: its SHA-256 is {now}, but {stands} in {record}"


def is_sealed(path: Path) -> bool:
    """Return whether a result has a record and is as it was written."""
    return recorded(path) is not None and altered(path) is None


def check_sealed(path: Path) -> Path:
    """Return the path of a result after its content was compared with the recorded digest.

    Raises
    ------
    WorkError
        If the result was altered or damaged after it was written.
    """
    why = altered(path)
    if why is None and recorded(path) is None and (known := digest_of(path)) is not None:
        if (now := sha256(path)) != known:
            why = _altered(path, now, known, path.parent / METADATA)
    if why is not None:
        raise WorkError(f"{why}. `trackroller run STUDY --report` makes it again from the chunks, which are kept.")
    return path


def digest_of(path: Path) -> str | None:
    """Return the digest of a file in its record, otherwise in the RO-Crate beside it; None if it has neither.

    A file without a digest may describe earlier results.
    """
    if known := recorded(path):
        return known.get(path.name, "")
    try:
        graph = json.loads((path.parent / METADATA).read_text(encoding="utf-8"))["@graph"]
        return next((str(entry["sha256"]) for entry in graph if entry.get("@id") == path.name), None)
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return None


def read_result(path: Path | str) -> xr.Dataset:
    """Return a netCDF result in memory, after its content was compared with the recorded digest.

    Raises
    ------
    InputError
        If the file is missing, is not a netCDF file, or declares more values than it can hold.
    WorkError
        If the file was altered or damaged after it was written.
    """
    path = Path(path)
    if not path.is_file():
        raise InputError("results", str(path), "the path of a netCDF file", "Run the study first.", "does not exist")
    return read_netcdf(check_sealed(path), "results", "Run the study again.")


def read_netcdf(path: Path, what: str, remedy: str) -> xr.Dataset:
    """Return a netCDF file in memory; the one way to read a netCDF file that somebody else may have written.

    Parameters
    ----------
    path : pathlib.Path
        The file.
    what, remedy : str
        Kind of file and what the user can do, for messages.

    Raises
    ------
    InputError
        If it is not a netCDF file, or declares more values than it can hold.
    """
    try:
        with netCDF4.Dataset(path) as file:
            excess = too_large(file, path.stat().st_size)
        if excess is None:
            return xr.load_dataset(path, engine="netcdf4")
    except (OSError, ValueError, RuntimeError, AttributeError, IndexError, KeyError, TypeError, OverflowError) as exc:
        reason = " ".join(str(exc).split())[:200]
        raise InputError(what, str(path), "a netCDF file", remedy, f"cannot be read as netCDF ({reason})") from None
    raise InputError(what, str(path), "a netCDF file that fits the memory", remedy, excess)


def too_large(file: netCDF4.Dataset, size: int) -> str | None:
    """Return why a file must not be read into memory: a file of a few kB can declare thousands of millions of values.

    Parameters
    ----------
    file : netCDF4.Dataset
        The open file, of which no value was read.
    size : int
        Its size on the disk [bytes].

    Returns
    -------
    str or None
        None if the values fit the memory, and are as many as a file of this size can hold.
    """
    variables = file.variables.values()
    values = sum(math.prod(variable.shape) for variable in variables)
    declared = sum(math.prod(v.shape) * getattr(v.dtype, "itemsize", TEXT_BYTES) for v in variables)
    if declared <= min(memory(), max(ANY_BYTES, MOST_PACKED * size)):
        return None
    return f"declares {values:,} values, which take {declared / 1e9:,.0f} GB, in a file of {size:,} bytes"
