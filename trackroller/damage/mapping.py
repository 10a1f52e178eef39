"""Fields of a case that are mappings of numbers, words and lists, such as the ratings of a
bearing.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from trackroller.errors import Collector, InputError, check_names, checked_text
from trackroller.numerics.numbers import number_in
from trackroller.numerics.parameter import Parameter
from trackroller.numerics.rows import once_each


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
    lists : tuple of Parameter
        Keys that are lists of numbers.
    texts : tuple of str
        Keys that are names of the user's, such as that of a material.
    may_miss : tuple of str
        Keys that may be left out.
    renamed : mapping of str to str
        Former spellings of keys with the one to write now.
    check : callable, optional
        Function of the checked mapping that raises `InputError` where keys contradict each other.
    """

    name: str
    meaning: str
    numbers: tuple[Parameter, ...] = ()
    words: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    lists: tuple[Parameter, ...] = ()
    texts: tuple[str, ...] = ()
    may_miss: tuple[str, ...] = ()
    renamed: Mapping[str, str] = field(default_factory=dict)
    check: Callable[[dict[str, Any]], None] | None = None

    def canonical(self, value: Mapping[str, Any]) -> dict[str, Any]:
        """Return the checked mapping; raise the errors of unknown, missing or impossible entries
        together.
        """
        keys = [*self.words, *self.texts, *(number.name for number in (*self.numbers, *self.lists))]
        for old, new in self.renamed.items():
            if old in value:
                known = ", ".join(keys)
                raise InputError(
                    f"{self.name}.{old}", value[old], known, f"Write {new}.", "has another name now"
                )
        check_names(f"{self.name}: key", value, keys)
        missing = [key for key in keys if value.get(key) is None and key not in self.may_miss]
        if missing:
            lacks = f"is missing: the mapping lacks {', '.join(missing)}"
            raise InputError(f"{self.name}.{missing[0]}", None, "", "Add these values.", lacks)
        given: dict[str, Any] = {}
        wrong = Collector()
        for key in (key for key in keys if value.get(key) is not None):
            with wrong.part():
                given[key] = self._checked(key, value[key])
        wrong.check()
        if self.check is not None:
            self.check(given)
        return given

    def _checked(self, key: str, value: Any) -> Any:
        """Return the checked value of a key."""
        if key in self.words:
            check_names(f"{self.name}.{key}", [value], self.words[key])
            return str(value)
        if key in self.texts:
            return self._text(key, value)
        numbers = {number.name: number for number in (*self.numbers, *self.lists)}
        return self._entry(numbers[key], value)

    def _text(self, key: str, value: Any) -> str:
        """Return a checked name."""
        where = f"{self.name}.{key}"
        if not isinstance(value, str) or not value.strip():
            raise InputError(
                where, value, "a name", "Put a name that looks like a number in quotes."
            )
        return checked_text(value.strip(), where)

    def _entry(self, number: Parameter, value: Any) -> Any:
        """Return a checked number, or the checked numbers of a list."""
        if number not in self.lists:
            return self._number(number, value)
        if not isinstance(value, (list, tuple)):
            raise InputError(
                f"{self.name}.{number.name}", value, f"a list of numbers [{number.unit}]"
            )
        return [self._number(number, one) for one in value]

    def _number(self, number: Parameter, value: Any) -> float:
        """Return a number that is finite and lies within its bounds."""
        where = f"{self.name}.{number.name}"
        given = number_in(value, where, number.allowed(), unit=number.unit)
        if not math.isfinite(given) or not number.accepts(given):
            raise InputError(where, value, number.allowed())
        return given

    def parsed(self, text: str) -> dict[str, Any]:
        """Return the mapping of a canonical JSON text; {} where it is not given."""
        return json.loads(text) if text else {}

    def columns(self, texts: np.ndarray) -> dict[str, np.ndarray]:
        """Return the entries of n cases by key, (n,), from their canonical JSON: NaN and "" where
        not given.
        """
        parsed = once_each(self.parsed, texts)
        out = {
            n.name: np.array([own.get(n.name, np.nan) for own in parsed], dtype=float)
            for n in self.numbers
        }
        return out | {
            key: np.array([own.get(key, "") for own in parsed], dtype=object)
            for key in (*self.words, *self.texts)
        }
