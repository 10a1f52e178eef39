"""The errors a user must mend, each saying what to change."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class InputError(ValueError):
    """Bad input: names the field, the value, what is allowed and what to do.

    Parameters
    ----------
    field : str
        Name of the field as the user wrote it, dotted for nested fields.
    value : object
        Value that was refused.
    allowed : str
        Values that are allowed, in words.
    remedy : str
        What the user can do about it.

    Examples
    --------
    >>> print(InputError("slip", -1, "a number >= 0", "Leave slip out."))
    slip = -1 is not usable: a number >= 0. Leave slip out.
    """

    def __init__(self, field: str, value: object, allowed: str, remedy: str = "") -> None:
        self.field = field
        self.value = value
        self.allowed = allowed
        self.remedy = remedy
        text = f"{field} = {value!r} is not usable: {allowed}"
        super().__init__(f"{text}. {remedy}" if remedy else text)

    def __reduce__(self):  # keeps its parts when it crosses a process border
        return type(self), (self.field, self.value, self.allowed, self.remedy)


class ShapeError(InputError):
    """Drawn shapes that are well told but cannot touch as a case says: of many cases, only such a one fails."""


def nearest(name: str, options: Iterable[str]) -> str | None:
    """The option a user most likely meant, or None."""
    options = list(options)
    by_lower = {option.lower(): option for option in options}
    hit = difflib.get_close_matches(str(name).lower(), list(by_lower), n=1, cutoff=0.5)
    return by_lower[hit[0]] if hit else None


def unknown_name(kind: str, name: str, options: Iterable[str]) -> InputError:
    """An `InputError` for a name that is not among `options`, with the nearest right one."""
    options = list(options)
    close = nearest(name, options)
    remedy = f"Did you mean '{close}'?" if close else "Use one of these names."
    return InputError(kind, name, "known names are " + ", ".join(map(str, options)), remedy)
