"""Fields of a case that are mappings of numbers and words, such as the ratings of a bearing."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from trackroller.errors import InputError, check_names
from trackroller.numerics.numbers import number_in
from trackroller.numerics.rows import once_each
from trackroller.parameters import Parameter


@dataclass(frozen=True)
class MappingField:
    """A field of a case whose value is a mapping.

    Parameters
    ----------
    name, meaning : str
        Name of the field, and its explanation for the documentation.
    numbers : tuple of Parameter
        Keys that are numbers.
    words : mapping of str to tuple of str
        Keys that are words, with the words that each allows.
    may_miss : tuple of str
        Keys that may be left out.
    check : callable, optional
        Function of the checked mapping that raises `InputError` where keys contradict each other.
    """

    name: str
    meaning: str
    numbers: tuple[Parameter, ...]
    words: Mapping[str, tuple[str, ...]]
    may_miss: tuple[str, ...] = ()
    check: Callable[[dict[str, Any]], None] | None = None

    def canonical(self, value: Mapping[str, Any]) -> dict[str, Any]:
        """Return the checked mapping; raise `InputError` for an unknown, missing or impossible entry."""
        keys = [*self.words, *(number.name for number in self.numbers)]
        check_names(f"{self.name}: key", value, keys)
        missing = [key for key in keys if value.get(key) is None and key not in self.may_miss]
        if missing:
            raise InputError(self.name, dict(value), f"it lacks {', '.join(missing)}", "Add these values.")
        given: dict[str, Any] = {}
        for key, allowed in self.words.items():
            check_names(f"{self.name}.{key}", [value[key]], allowed)
            given[key] = str(value[key])
        for number in self.numbers:
            if value.get(number.name) is None:
                continue
            where = f"{self.name}.{number.name}"
            given[number.name] = number_in(value[number.name], where, number.allowed(), unit=number.unit)
            if not math.isfinite(given[number.name]) or not number.accepts(given[number.name]):
                raise InputError(where, value[number.name], number.allowed())
        if self.check is not None:
            self.check(given)
        return given

    def columns(self, texts: np.ndarray) -> dict[str, np.ndarray]:
        """Return the entries of n cases by key, (n,), from their canonical JSON: NaN and "" where not given."""
        parsed = once_each(lambda text: json.loads(text) if text else {}, texts)
        out = {n.name: np.array([own.get(n.name, np.nan) for own in parsed], dtype=float) for n in self.numbers}
        return out | {key: np.array([own.get(key, "") for own in parsed], dtype=object) for key in self.words}
