"""Select rows of data classes whose fields are arrays, and treat equal values of a column once."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np


class Rows:
    """Row selection for data classes whose fields are arrays along one axis."""

    def take(self, index) -> Any:
        """Return the entries `index` (integer or boolean array) of every field; a field that is None stays None."""
        names = _names(type(self))  # type: ignore[arg-type]
        return type(self)(*[_part(getattr(self, name), index) for name in names])


@functools.cache
def _names(kind: type) -> tuple[str, ...]:
    return tuple(field.name for field in dataclasses.fields(kind))


def _part(value: Any, index: Any) -> Any:
    if value is None:
        return None
    if isinstance(value, Rows):
        return value.take(index)
    return value[index]


def distinct(objects: Iterable[Any]) -> tuple[list[Any], np.ndarray]:
    """Return the different objects of a column of n, and the place of each row's object among them, (n,).

    Objects differ by identity: the same few fill a column of millions.
    """
    column = list(objects)
    keys = list(map(id, column))
    by_id = dict(zip(keys, column, strict=True))
    places = {key: place for place, key in enumerate(by_id)}
    return list(by_id.values()), np.fromiter(map(places.__getitem__, keys), int, len(keys))


def once_each(make: Callable[[Any], Any], values: Iterable[Any]) -> list[Any]:
    """Return `make(value)` for each value; values with the same text share one call."""
    values = list(values)
    if len(set(map(id, values))) == 1:  # a column of millions of cases mostly holds one object
        return [make(values[0])] * len(values)
    keys = []
    for value in values:
        if isinstance(value, str):
            keys.append(value)
        else:
            keys.append(repr(value))
    results = {key: make(value) for key, value in dict(zip(keys, values, strict=True)).items()}
    return [results[key] for key in keys]
