"""Read netCDF files that somebody else may have written."""

from __future__ import annotations

import contextlib
import json
import math
from collections.abc import Iterator
from pathlib import Path

import netCDF4
import xarray as xr

from trackroller.errors import InputError
from trackroller.files import memory
from trackroller.study.store.manifest import check_unaltered

ANY_BYTES = 1_000_000_000  # any file may declare so many bytes
# bytes declared for each byte of a larger file; results of a study pack 2 to 20 times
MOST_PACKED = 200
TEXT_BYTES = 100  # of a text in memory
# a table has 1,000 columns at most, and each variable takes xarray longer than the one before
MOST_VARIABLES = 5_000
# bytes of each variable that the library keeps unpacked while a file is open, 64 MB by itself
CACHE_BYTES = 1_000_000


@contextlib.contextmanager
def small_cache() -> Iterator[None]:
    """Let netCDF keep few values of the files that are opened meanwhile.

    A variable is read or written once and as a whole, so that its values in the cache of the
    library are a second copy: 1.5 GB beside the 1.6 GB of a million cases.
    """
    before = netCDF4.get_chunk_cache()
    netCDF4.set_chunk_cache(CACHE_BYTES)
    try:
        yield
    finally:
        netCDF4.set_chunk_cache(*before)


def read_netcdf(path: Path, what: str, remedy: str) -> xr.Dataset:
    """Return a netCDF file in memory; the one way to read a netCDF file that somebody else may have
    written.

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
            with small_cache():
                ds = xr.load_dataset(path, engine="netcdf4")
            _check_attributes(ds)
            return ds
    except (
        OSError,
        ValueError,
        RuntimeError,
        AttributeError,
        IndexError,
        KeyError,
        TypeError,
        OverflowError,
        RecursionError,
    ) as exc:
        reason = " ".join(str(exc).split())[:200]
        raise InputError(
            what, str(path), "a netCDF file", remedy, f"cannot be read as netCDF ({reason})"
        ) from None
    raise InputError(what, str(path), "a netCDF file that fits the memory", remedy, excess)


def read_result(path: Path | str) -> xr.Dataset:
    """Return a netCDF result in memory, after its content was compared with its digest.

    Raises
    ------
    InputError
        If the file is missing, is not a netCDF file, or declares more values than it can hold.
    WorkError
        If the file was altered or damaged after it was written.
    """
    path = Path(path)
    if not path.is_file():
        raise InputError(
            "results",
            str(path),
            "the path of a netCDF file",
            "Run the study first.",
            "does not exist",
        )
    return read_netcdf(check_unaltered(path), "results", "Run the study again.")


def _check_attributes(ds: xr.Dataset) -> None:
    """Raise RecursionError for a text of nested lists or mappings that nobody could read."""
    for text in ds.attrs.values():
        if isinstance(text, str) and text[:1] in ("[", "{"):
            with contextlib.suppress(json.JSONDecodeError):
                json.loads(text)


def too_large(file: netCDF4.Dataset, size: int) -> str | None:
    """Return why a file must not be read into memory: a file of a few kB can declare thousands of
    millions of values.

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
    if len(variables) > MOST_VARIABLES:
        return f"declares {len(variables):,} variables, and {MOST_VARIABLES:,} are the most"
    values = sum(math.prod(variable.shape) for variable in variables)
    declared = sum(math.prod(v.shape) * getattr(v.dtype, "itemsize", TEXT_BYTES) for v in variables)
    if declared <= min(memory(), max(ANY_BYTES, MOST_PACKED * size)):
        return None
    return (
        f"declares {values:,} values, which take {declared / 1e9:,.0f} GB, in a file of "
        f"{size:,} bytes"
    )
