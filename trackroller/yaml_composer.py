"""Compose plain data from the events of a YAML parser: YAML 1.2, nothing ambiguous, every value counted."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator
from typing import Any

from ruamel.yaml.events import (
    AliasEvent,
    DocumentStartEvent,
    MappingEndEvent,
    MappingStartEvent,
    ScalarEvent,
    SequenceEndEvent,
    SequenceStartEvent,
)

from trackroller.errors import InputError

MAX_VALUES = 200_000  # with aliases counted in full
MAX_DEPTH = 60
MAX_DIGITS = 40

_INTEGER = re.compile(r"[-+]?(?:0|[1-9][0-9]*)")
_NUMBER = re.compile(r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?")
_INFINITE = re.compile(r"([-+]?)\.(?:inf|Inf|INF)")
_WORDS = {
    word: value
    for value, words in (
        (None, "null Null NULL ~"),
        (True, "true True TRUE"),
        (False, "false False FALSE"),
        (math.nan, ".nan .NaN .NAN"),
    )
    for word in words.split()
}
_AMBIGUOUS = (  # pattern, what is ambiguous
    (re.compile(r"[-+]?0[0-9]+"), "a leading zero means an octal number in YAML 1.1 and a decimal one in YAML 1.2"),
    (re.compile(r"[-+]?0[xob][0-9a-fA-F_]+"), "numbers are read in decimal only"),
    (re.compile(r"[-+]?[0-9][0-9_]*(?::[0-5]?[0-9])+(?:\.[0-9_]*)?"), "YAML 1.1 reads this as a number to base 60"),
    (
        re.compile(r"[-+]?[0-9][0-9_]*_[0-9_.]*(?:[eE][-+]?[0-9]+)?"),
        "YAML 1.1 reads this as a number, YAML 1.2 as text",
    ),
    (
        re.compile(r"yes|Yes|YES|no|No|NO|on|On|ON|off|Off|OFF"),
        "YAML 1.1 reads this as true or false, YAML 1.2 as text",
    ),
)
TAG = "tag:yaml.org,2002:"
_TAGGED: dict[str, Callable[[str], Any]] = {f"{TAG}str": str, f"{TAG}int": int, f"{TAG}float": float, "!": str}


def plain_scalar(text: str) -> Any:
    """Return what a scalar without quotes means in YAML 1.2.

    Parameters
    ----------
    text : str
        The scalar, as it stands in the file.

    Returns
    -------
    None, bool, int, float or str

    Raises
    ------
    ValueError
        Saying why, if the scalar is ambiguous or a number that cannot be held.
    """
    if text in _WORDS or not text:
        return _WORDS.get(text)
    if _INTEGER.fullmatch(text):
        if len(text) > MAX_DIGITS:
            raise ValueError(f"a number has at most {MAX_DIGITS} digits")
        return int(text)
    for pattern, why in _AMBIGUOUS:
        if pattern.fullmatch(text):
            raise ValueError(why)
    if _NUMBER.fullmatch(text):
        number = float(text)
        if math.isinf(number) or len(text) > 10 * MAX_DIGITS:
            raise ValueError("the number is too large")
        return number
    if sign := _INFINITE.fullmatch(text):
        return -math.inf if sign[1] == "-" else math.inf
    if any(ch.isdigit() and not ch.isascii() for ch in text) and _is_number(text):
        raise ValueError("numbers are written with the digits 0 to 9")
    return text


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


class Composer:
    """Builds plain data from parser events and counts every value while it does so."""

    def __init__(self, events: Iterator[Any], what: str) -> None:
        self.events, self.what = iter(events), what
        self.anchors: dict[str, tuple[Any, int]] = {}
        self.open: set[str] = set()
        self.count = 0

    def document(self) -> Any:
        """Return the only document; None if the text is empty."""
        value, found = None, False
        for event in self.events:
            if isinstance(event, DocumentStartEvent):
                if found:
                    raise self._refused(event, "a second document", "one document", "Remove the line '---'.")
                value, found = self._value(next(self.events), 0), True
        return value

    def _refused(self, event: Any, value: Any, allowed: str, remedy: str) -> InputError:
        return InputError(f"{self.what}, line {event.start_mark.line + 1}", value, allowed, remedy)

    def _add(self, event: Any, values: int) -> None:
        self.count += values
        if self.count > MAX_VALUES:
            allowed = f"at most {MAX_VALUES} values, aliases counted in full"
            raise self._refused(event, "too many values", allowed, "Put many cases into a CSV file.")

    def _value(self, event: Any, depth: int) -> Any:
        if isinstance(event, AliasEvent):
            return self._alias(event)
        if depth > MAX_DEPTH:
            raise self._refused(
                event, "nesting", f"YAML of at most {MAX_DEPTH} levels", "Nest lists and mappings less deeply."
            )
        before = self.count
        self._add(event, 1)
        if event.anchor:
            self.open.add(event.anchor)
        if isinstance(event, ScalarEvent):
            value = self._scalar(event)
        elif isinstance(event, SequenceStartEvent):
            value = self._sequence(event, depth)
        else:
            value = self._mapping(event, depth)
        if event.anchor:
            self.open.discard(event.anchor)
            self.anchors[event.anchor] = value, self.count - before
        return value

    def _alias(self, event: AliasEvent) -> Any:
        if event.anchor in self.open:
            raise self._refused(event, f"*{event.anchor}", "a value that does not contain itself", "Remove the alias.")
        if event.anchor not in self.anchors:
            raise self._refused(
                event, f"*{event.anchor}", "the alias of an anchor above it", "Check the anchor's name."
            )
        value, size = self.anchors[event.anchor]
        self._add(event, size)
        return value

    def _scalar(self, event: ScalarEvent) -> Any:
        if event.tag and not event.implicit[0]:
            return self._tagged(event)
        if not event.implicit[0]:  # in quotes
            return event.value
        try:
            return plain_scalar(event.value)
        except ValueError as why:
            shown = event.value if len(event.value) <= 60 else f"{event.value[:57]}..."
            remedy = "Write a plain decimal number, true or false; or put a text in quotes."
            raise self._refused(event, shown, f"an unambiguous value: {why}", remedy) from None

    def _tagged(self, event: ScalarEvent) -> Any:
        if str(event.tag) not in _TAGGED:
            raise self._refused(event, str(event.tag), "plain YAML data without tags", "Remove the tag.")
        try:
            return _TAGGED[str(event.tag)](event.value)
        except ValueError:
            raise self._refused(event, event.value, f"a value of {event.tag}", "Remove the tag.") from None

    def _sequence(self, start: Any, depth: int) -> list[Any]:
        self._check_tag(start, f"{TAG}seq")
        out = []
        while not isinstance(event := next(self.events), SequenceEndEvent):
            out.append(self._value(event, depth + 1))
        return out

    def _mapping(self, start: MappingStartEvent, depth: int) -> dict[Any, Any]:
        self._check_tag(start, f"{TAG}map")
        out: dict[Any, Any] = {}
        merged: dict[Any, Any] = {}
        while not isinstance(event := next(self.events), MappingEndEvent):
            key = self._key(event, depth)
            value = self._value(next(self.events), depth + 1)
            if key == "<<" and isinstance(event, ScalarEvent) and event.implicit[0]:
                merged = self._merge(event, value) | merged
            elif key in out:
                raise self._refused(event, key, "each key once; it stands twice", "Remove one of the two lines.")
            else:
                out[key] = value
        return merged | out

    def _key(self, event: Any, depth: int) -> Any:
        plain = isinstance(event, ScalarEvent) and event.implicit[0] and not event.anchor
        if plain and any(pattern.fullmatch(event.value) for pattern, _ in _AMBIGUOUS[4:]):
            self._add(event, 1)
            return event.value  # a key is a text, whatever YAML 1.1 made of it
        key = self._value(event, depth + 1)
        if isinstance(key, (dict, list)):
            raise self._refused(event, "a list or a mapping", "keys that are texts", "Write the key as a text.")
        return key

    def _merge(self, event: Any, value: Any) -> dict[Any, Any]:
        several = value if isinstance(value, list) else [value]
        if not all(isinstance(one, dict) for one in several):
            raise self._refused(event, "<<", "mappings to merge", "Give an alias of a mapping, or a list of them.")
        out: dict[Any, Any] = {}
        for one in several:
            out = one | out
        return out

    def _check_tag(self, event: Any, allowed: str) -> None:
        if event.tag and str(event.tag) not in (allowed, "!"):
            raise self._refused(event, str(event.tag), "plain YAML data without tags", "Remove the tag.")
