"""Turn values of notebooks, such as arrays, columns and data frames, into numbers, texts, lists and
mappings.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, KeysView, Mapping, Sequence, Set, ValuesView
from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np

from trackroller.errors import InputError, checked_text
from trackroller.numerics.units import stated_unit

_PLAIN = (float, int, bool, type(None))
MOST_LEVELS = 40  # of lists in lists


def _mapping(value: Mapping[Any, Any], field: str, level: int) -> dict[Any, Any]:
    """Return a mapping as `plain` does; the coordinates of a data set are values as well."""
    names = value
    if hasattr(value, "data_vars"):
        names = getattr(value, "variables", value)
    entries = {}
    for name in names:
        inside = str(name)
        if field:
            inside = f"{field}.{name}"
        entries[plain(name, field)] = plain(value[name], inside, level)
    return entries


def plain(value: Any, field: str = "value", level: int = 0) -> Any:
    """Return a value as a file could say it.

    Parameters
    ----------
    value : object
        Scalars and arrays of NumPy, columns and data frames, `xarray.DataArray`, quantities of
        pint, `Decimal`, `Fraction`, paths, ranges, lists and mappings. A column of a data frame is
        a list, and a row is a mapping.
    field : str
        Name of the field, for messages.
    level : int
        Number of lists and mappings around the value.

    Returns
    -------
    object
        Numbers, texts, lists and dicts. A data frame is a list of its rows, each a dict. A number
        with a unit, of pint or in the attribute `units` or `unit`, is a text such as '0.2 kN'.
        Other objects, such as sets, are returned as they are: whoever reads the field refuses them.

    Raises
    ------
    InputError
        For an iterator, a text with control characters, masked values, a data frame with two
        columns of one name, and lists that contain themselves.

    Examples
    --------
    >>> plain({"uniform": [np.int64(0), np.float32(0.1)], "values": np.arange(3)})
    {'uniform': [0, 0.1], 'values': [0, 1, 2]}
    """
    if type(value) is str:
        return checked_text(value, field, lines=True)
    if type(value) in _PLAIN:
        return value
    if level > MOST_LEVELS:
        raise InputError(
            field, type(value).__name__, f"at most {MOST_LEVELS} lists or mappings in each other"
        )
    value = _row(value)
    if isinstance(value, Mapping):
        return _mapping(value, field, level + 1)
    if hasattr(value, "columns") and hasattr(value, "to_dict"):
        return [plain(row, field, level + 1) for row in rows_of(value, field)]
    if isinstance(value, np.ma.MaskedArray) and np.ma.is_masked(value):
        remedy = "Give the values that count, such as values.compressed()."
        raise InputError(field, str(value), "values that are not masked", remedy)
    if isinstance(value, Iterator):
        raise InputError(
            field,
            type(value).__name__,
            "a list, which can be read twice",
            "Write list(...) around it.",
        )
    if isinstance(value, (Sequence, KeysView, ValuesView)) and not isinstance(
        value, (str, bytes, bytearray)
    ):
        return [plain(one, field, level + 1) for one in value]
    of_arrays = (hasattr(value, "tolist") or hasattr(value, "dims")) and not hasattr(
        value, "magnitude"
    )
    other = _array(value) if of_arrays else _scalar(value)
    if type(other) is type(value) or other is value:
        return value
    return plain(other, field, level + 1)


def _array(value: Any) -> Any:
    """Return an array, a column or a scalar of NumPy as a list or a number; what cannot be one as
    it is.
    """
    unit = ""
    if hasattr(value, "attrs"):
        unit = stated_unit(value.attrs)
    if hasattr(value, "dims") or unit:  # xarray, or a column of pandas
        own = np.asarray(value.values)
        if unit and own.dtype.kind in "fiu":
            return _with_unit(own, unit)
        return own
    if isinstance(value, np.ma.MaskedArray):
        return value.filled()
    if isinstance(value, np.ndarray) and value.dtype.names:
        return value
    if getattr(value, "dtype", None) in (np.float16, np.float32):  # 0.1 stays 0.1
        return np.asarray(value).astype(str).astype(float).tolist()
    return value.tolist()


def _with_unit(numbers: np.ndarray, unit: str) -> Any:
    if numbers.ndim:
        return [_with_unit(one, unit) for one in numbers]
    return f"{numbers.item()!r} {unit}"


def _scalar(value: Any) -> Any:
    """Return a number of another library, a path or a text as Python's own; any other object as it
    is.
    """
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if hasattr(value, "magnitude") and hasattr(value, "units"):  # pint
        unit = f"{value.units:~C}".replace("**", "^")
        if unit:
            return _with_unit(np.asarray(value.magnitude), unit)
        return value.magnitude
    if isinstance(value, (Decimal, Fraction)):
        try:
            return int(value) if value % 1 == 0 else float(value)
        except (ArithmeticError, ValueError):  # infinite, or no number
            return value
    return str(value) if isinstance(value, str) else value


def rows_of(frame: Any, field: str) -> list[dict[Any, Any]]:
    """Return the rows of a data frame, each as a mapping from the heads of its columns and of an
    index with a name.

    Raises
    ------
    InputError
        If two columns have one name, so that a mapping would lose one of them.
    """
    if any(name is not None for name in getattr(getattr(frame, "index", None), "names", ())):
        frame = frame.reset_index()  # an index with a name holds values as columns do
    heads = list(frame.columns)
    several = next((head for head in heads if isinstance(head, tuple)), None)
    if several:
        allowed = "heads of columns that are texts"
        raise InputError(
            field, str(several), allowed, "Write frame.columns = [...] with one text a column."
        )
    doubled = next((head for head in heads if heads.count(head) > 1), None)
    if doubled:
        raise InputError(
            field,
            str(doubled),
            "each column once; it stands twice",
            "Rename or drop one of the two.",
        )
    if hasattr(frame, "to_dicts"):
        return frame.to_dicts()
    return frame.to_dict("records")


def _row(value: Any) -> Any:
    """Return a column of pandas whose labels are texts, such as a row of a data frame, as a
    dict.
    """
    column = hasattr(value, "to_dict") and hasattr(value, "index") and not hasattr(value, "columns")
    named = column and len(value) and all(isinstance(label, str) for label in value.index)
    return value.to_dict() if named else value


def mapping_of(value: Any) -> Any:
    """Return a mapping of plain values; a row of a data frame is one, too. Any other object is
    returned as it is.
    """
    value = _row(value)
    if isinstance(value, Mapping):
        return plain(value, "")
    return value


def how_to_write(value: Any) -> str:
    """Return the call with which a value becomes one that is taken; an empty text if none is
    known.
    """
    if isinstance(value, Set) and not isinstance(value, (KeysView, ValuesView)):
        return "Write sorted(...) around it: a set has no order."
    if isinstance(value, Mapping):
        return "Write .tolist() behind a column of a data frame whose rows have names."
    return ""
