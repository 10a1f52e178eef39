"""Read what a user says of a measured log where its lines leave it open: the key `log` of a case
file.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from trackroller.errors import Collector, InputError, check_names
from trackroller.numerics.numbers import number_or_nan

WORDS = {
    "hold": ("last", "middle", "step"),
    "spikes": ("keep", "leave out"),
    "travel": ("distance", "velocity"),
}
KEYS = ("hold", "missing", "spikes", "travel")


@dataclass(frozen=True)
class LogAnswers:
    """What a user says of a log.

    Parameters
    ----------
    hold : str, optional
        How long a line holds: `last`, until the next line; `middle`, for half of the step before
        and half of the step after; `step`, as `middle`, but a longer step is a gap and counts as a
        usual one.
    missing : tuple of str, optional
        Cells that stand for no value, such as '-9999' or 'NaN'; their lines are left out. () says
        that there are none.
    spikes : str, optional
        `keep` or `leave out` the lines with a spike.
    travel : str, optional
        The column that says how far the roller moves, `distance` or `velocity`, where a log has
        both.
    """

    hold: str | None = None
    missing: tuple[str, ...] | None = None
    spikes: str | None = None
    travel: str | None = None

    @property
    def missing_numbers(self) -> tuple[float, ...]:
        """Return the cells of `missing` that are finite numbers."""
        numbers = [number_or_nan(cell) for cell in self.missing or ()]
        return tuple(number for number in numbers if math.isfinite(number))

    @property
    def missing_words(self) -> frozenset[str]:
        """Return the cells of `missing` in lower case."""
        return frozenset(cell.lower() for cell in self.missing or ())


def checked_log(value: Any) -> dict[str, Any]:
    """Return the entries of the key `log` of a case file.

    Raises
    ------
    InputError
        For an unknown key, or a value that is not among its words.

    Examples
    --------
    >>> checked_log({"hold": "last", "missing": [-9999, "NaN"]})
    {'hold': 'last', 'missing': ['-9999', 'NaN']}
    """
    if not isinstance(value, Mapping):
        raise InputError(
            "log", value, f"some of the keys {', '.join(KEYS)}", "Write log: {hold: last}."
        )
    check_names("log: key", value, KEYS)
    given = {key: entry for key, entry in value.items() if entry is not None}
    wrong = Collector()
    for key, words in WORDS.items():
        with wrong.part():
            if given.get(key, words[0]) not in words:
                raise InputError(
                    f"log.{key}", given[key], ", ".join(words), f"Write log: {{{key}: {words[0]}}}."
                )
    with wrong.part():
        if "missing" in given:
            given["missing"] = _cells(given["missing"])
    wrong.check()
    return given


def _cells(value: Any) -> list[str]:
    """Return the cells that stand for no value as texts."""
    if isinstance(value, Sequence) and not isinstance(value, str):
        cells = value
    else:
        cells = [value]
    if any(isinstance(cell, bool) or not isinstance(cell, (str, int, float)) for cell in cells):
        raise InputError(
            "log.missing",
            value,
            "a list of numbers and texts",
            "Write log: {missing: [-9999, NaN]}.",
        )
    return [str(cell).strip() for cell in cells]


def answers_of(given: Mapping[str, Any]) -> LogAnswers:
    """Return the answers of a case file with or without the key `log`."""
    entries = checked_log(given.get("log") or {})
    if "missing" in entries:
        entries["missing"] = tuple(entries["missing"])
    return LogAnswers(**entries)
