"""A recording: plain arrays and JSON texts under path-like keys, in one `.npz` file without pickles."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

Archive = dict[str, np.ndarray]
LABELS = "labels.json"  # last part of the key under which the attributes of a data set stand


def text(value: Any) -> np.ndarray:
    """Return a JSON text of a value as an array without dimensions.

    Parameters
    ----------
    value : Any
        Mappings, lists, texts, numbers; what JSON cannot hold stands as its `str`.

    Returns
    -------
    ndarray of str, shape ()
    """
    return np.array(json.dumps(value, sort_keys=True, default=_plain))


def _plain(value: Any) -> Any:
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    return str(value)


def decoded(array: xr.DataArray) -> np.ndarray:
    """Return the values of a variable, with the words of its flags in place of their numbers.

    Words stay comparable when a new flag changes the numbering.

    Parameters
    ----------
    array : DataArray
        Any variable, with the CF attributes of flags if it has flags.

    Returns
    -------
    ndarray
        Same shape; numbers, or texts for flags and texts.
    """
    values = np.asarray(array.values)
    words = str(array.attrs.get("flag_meanings", "")).split()
    if "flag_masks" in array.attrs:
        masks = np.atleast_1d(array.attrs["flag_masks"])
        told = [" ".join(sorted(w for w, m in zip(words, masks, strict=True) if int(v) & int(m))) for v in values.flat]
        return np.array(told, dtype=str).reshape(values.shape)
    if "flag_values" in array.attrs:
        names = dict(zip(np.atleast_1d(array.attrs["flag_values"]).tolist(), words, strict=True))
        told = [names.get(v, f"unknown flag {v}") for v in values.ravel().tolist()]
        return np.array(told, dtype=str).reshape(values.shape)
    return values.astype(str) if values.dtype.kind in "OSU" else values


def from_dataset(ds: xr.Dataset, where: str) -> Archive:
    """Return all variables and attributes of a data set under one key.

    Parameters
    ----------
    ds : Dataset
        Results, a design or sensitivity indices.
    where : str
        First part of the keys, for example `cases/sliding`.

    Returns
    -------
    Archive
    """
    archive = {f"{where}/{name}": decoded(ds[name]) for name in ds.variables}
    labels = {str(name): {"dims": list(ds[name].dims), **ds[name].attrs} for name in ds.variables}
    archive[f"{where}/{LABELS}"] = text({"variables": labels, "global": ds.attrs})
    return archive


def save(path: Path, archive: Archive) -> None:
    """Write a recording.

    Parameters
    ----------
    path : Path
        The `.npz` file.
    archive : Archive
        Arrays of numbers and texts.
    """
    with path.open("wb") as file:
        np.savez_compressed(file, **archive)  # type: ignore[arg-type]


def load(path: Path) -> Archive:
    """Read a recording.

    Parameters
    ----------
    path : Path
        The `.npz` file.

    Returns
    -------
    Archive
    """
    with np.load(path, allow_pickle=False) as file:
        return {key: file[key] for key in file.files}
