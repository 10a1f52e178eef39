"""Errors for bad input; each message says what is wrong, what is allowed and what to do."""

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

    def __reduce__(self):  # another process rebuilds the error from its four parts
        return type(self), (self.field, self.value, self.allowed, self.remedy)


class ShapeError(InputError):
    """A valid profile whose shape cannot make contact in this case.

    `solve` marks such a case as failed and goes on with the other cases.
    """


class WorkError(RuntimeError):
    """Report that the work failed for a reason outside the input, and what to do about it."""


CLOSE, CLOSE_SHORT = 0.7, 0.6  # similarity from which on a name, or one of at most four letters, counts as misspelt


def nearest(name: str, options: Iterable[str]) -> str | None:
    """Return the option that a name misspells or abbreviates by whole words, or None if there is no such option."""
    options = list(options)
    longer = [option for option in options if _words(name) <= _words(option)]
    if longer:  # of several abbreviated names none is meant for sure
        return longer[0] if len(longer) == 1 else None
    by_lower = {option.lower(): option for option in options}
    hit = difflib.get_close_matches(
        str(name).lower(), list(by_lower), n=1, cutoff=CLOSE if len(str(name)) > 4 else CLOSE_SHORT
    )
    return by_lower[hit[0]] if hit else None


def _words(name: object) -> set[str]:
    return set(str(name).lower().split("_"))


def unknown_name(kind: str, name: str, options: Iterable[str]) -> InputError:
    """Return the error for a name that is not among `options`; it proposes the names that are meant most likely."""
    options = list(options)
    close = nearest(name, options)
    akin = [option for option in options if _words(name) & _words(option)][:3]
    remedy = f"Names with a similar meaning: {', '.join(akin)}." if akin else "Use one of these names."
    remedy = f"Did you mean '{close}'?" if close else remedy
    return InputError(kind, name, "known names are " + ", ".join(map(str, options)), remedy)


def check_names(kind: str, names: Iterable[object], options: Iterable[str]) -> None:
    """Raise the error `unknown_name` for the first of `names` that is not among `options`.

    Parameters
    ----------
    kind : str
        What the names stand for, such as "case field".
    names : iterable
        Names as the user wrote them.
    options : iterable of str
        Known names.

    Raises
    ------
    InputError
        If a name is unknown.
    """
    known = tuple(options)
    for name in names:
        if name not in known:
            raise unknown_name(kind, str(name), known)
