"""Check the key `rank_correlations` of a study file."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from trackroller.errors import InputError, listing
from trackroller.methods import METHODS, those_that_take
from trackroller.methods.correlation import KEY, Entry


def check_entries(value: Any) -> tuple[Entry, ...]:
    """Check the key `rank_correlations` of a study file.

    Parameters
    ----------
    value : list of [factor, factor, rank correlation]

    Returns
    -------
    The entries, each (factor, factor, rank correlation [1]).

    Raises
    ------
    InputError : an entry has another form, or a pair stands twice
    """
    example = "For example [[radial_force, axial_force, 0.6]]."
    if not isinstance(value, (list, tuple)):
        raise InputError(KEY, value, "a list of [factor, factor, rank correlation]", example)
    entries: dict[frozenset[str], Entry] = {}
    for entry in value:
        good = (
            isinstance(entry, (list, tuple))
            and len(entry) == 3
            and all(isinstance(n, str) for n in entry[:2])
        )
        if not good or entry[0] == entry[1]:
            raise InputError(
                KEY, entry, "[factor, factor, rank correlation] with two different factors", example
            )
        rho = entry[2]
        if isinstance(rho, bool) or not isinstance(rho, (int, float)) or not -1 < rho < 1:
            raise InputError(KEY, list(entry), "a rank correlation (Spearman) above -1 and below 1")
        if frozenset(entry[:2]) in entries:
            raise InputError(
                KEY, list(entry), "each pair of factors once", "Remove one of the entries."
            )
        entries[frozenset(entry[:2])] = (entry[0], entry[1], float(rho))
    return tuple(entries.values())


def check_design(entries: Sequence[Entry], method: str) -> None:
    """Refuse rank correlations in a design that cannot have them; the message says what to take
    instead.
    """
    having = those_that_take(KEY)
    if entries and method not in having:
        allowed = f"design {listing(having, 'or')}, not {method}"
        raise InputError(KEY, [list(e) for e in entries], allowed, METHODS[method].uncorrelated)
