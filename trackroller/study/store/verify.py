"""Compare results with the digests in their manifest, or in the crate beside them, before they are read."""

from __future__ import annotations

from pathlib import Path

import xarray as xr

from trackroller.errors import InputError, WorkError
from trackroller.study.store.manifest import CRATE, Digests, digest_of_file, digests_of_crate, manifest_of
from trackroller.study.store.netcdf import read_netcdf

_REMEDY = "Move or remove it; `trackroller run STUDY --report` then makes it again from the chunks, which are kept"


def _listed(path: Path) -> tuple[Path, Digests, Path]:
    """Return the folder of a result, the digests that are listed of its files, and the file that lists them."""
    manifest = manifest_of(path)
    if manifest is not None and (digests := manifest.below(path)):
        return manifest.root, digests, manifest.path
    of_crate = digests_of_crate(path.parent).items()
    below = {name: [digest] for name, digest in of_crate if Path(name).parts[:1] == (path.name,)}
    return path.parent, below, path.parent / CRATE


def why_altered(path: Path) -> str | None:
    """Return what is wrong with a result that is listed, None if it is as it was written.

    Parameters
    ----------
    path : pathlib.Path
        A file or folder in a study's folder. A folder may hold further files.
    """
    root, listed, source = _listed(path)
    for name, digests in listed.items():
        file = root / name
        now = digest_of_file(file)
        if now in digests:
            continue
        if listed != _listed(path)[1]:  # another process has just written the result
            return why_altered(path)
        if not now:
            return f"{file} is missing, but its SHA-256 stands in {source}"
        stands = f"its SHA-256 is {now}, but {' or '.join(digests)} stands in {source}"
        return f"{file} was altered or damaged after it was written: {stands}"
    return None


def check_unaltered(path: Path) -> Path:
    """Return the path of a result after its content was compared with its digest.

    Raises
    ------
    WorkError
        If the result was altered or damaged after it was written.
    """
    why = why_altered(path)
    if why is not None:
        raise WorkError(f"{why}. {_REMEDY}.")
    return path


def digests_of(path: Path) -> dict[str, str]:
    """Return the listed digest of each file of a result; {} if it is not listed, or was not replaced whole."""
    listed = _listed(path)[1]
    if any(len(digests) > 1 for digests in listed.values()):
        return {}
    return {name: digests[0] for name, digests in listed.items()}


def is_whole(path: Path) -> bool:
    """Return whether a result is listed, was replaced whole, and is as it was written."""
    return bool(digests_of(path)) and why_altered(path) is None


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
        raise InputError("results", str(path), "the path of a netCDF file", "Run the study first.", "does not exist")
    return read_netcdf(check_unaltered(path), "results", "Run the study again.")
