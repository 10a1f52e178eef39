"""Limits of roller and guide, one file each behind the protocol of `limit`, and the damage sum of a
spectrum.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import Any

from trackroller.damage import (
    bearing,
    catalogue,
    fatigue,
    first_limit,
    heat,
    multiaxial,
    own,
    pressure_line,
    rating,
    shakedown,
    static,
    stud,
    wear,
)
from trackroller.damage.limit import Limit
from trackroller.errors import InputError, check_names

_FILES = (
    static,
    fatigue,
    pressure_line,
    rating,
    bearing,
    catalogue,
    shakedown,
    heat,
    wear,
    multiaxial,
    stud,
)
LIMITS: dict[str, Limit] = {file.LIMIT.name: file.LIMIT for file in _FILES}


_KINDS = {  # what a limit declares by a name, in words
    "name": "the name of a limit",
    "group": "a group of outputs",
    "parameters": "a parameter",
    "materials": "a value of a material",
    "mappings": "a mapping",
}


def add_own() -> None:
    """Add the limits of the files in config/limits to `LIMITS`, where the user allows code.

    Raises
    ------
    InputError
        If a file declares no limit, or a name that another limit has taken.
    """
    for name, limit in own.own_limits().items():
        for kind, noun in _KINDS.items():
            names_in_use = {one for known in LIMITS.values() for one in _names(known, kind)}
            _refuse_taken(_names(limit, kind), names_in_use, noun)
        LIMITS[name] = limit


def _refuse_taken(names: Collection[str], names_in_use: Collection[str], noun: str) -> None:
    """Refuse names that a limit declares and that are in use; `noun` is what they name."""
    clash = sorted({*names} & {*names_in_use})
    if clash:
        wrong = f"is {noun} already, so that no limit may declare it"
        raise InputError("limits", ", ".join(clash), "", "Choose another name.", wrong)


def with_limits(own: Mapping[str, Any], declared: Iterable[Any], kind: str) -> dict[str, Any]:
    """Return what the program declares by its name, and what limits declare besides.

    Raises
    ------
    InputError
        If a limit declares a name that the program has; `kind` is what it names.
    """
    added = {one.name: one for one in declared}
    _refuse_taken(added, own, kind)
    return {**own, **added}


def _names(limit: Limit, kind: str) -> set[str]:
    declared = getattr(limit, kind)
    if isinstance(declared, str):
        return {declared}
    return {one.name for one in declared}


def limits_of(outputs: Collection[str], not_checked: Collection[str] = ()) -> tuple[Limit, ...]:
    """Return the limits that groups of outputs ask for: those of single limits, and with `limits`
    all that are checked.

    `not_checked` names limits that are left out.
    """
    checked = checked_limits(outputs, not_checked)
    return tuple(limit for limit in LIMITS.values() if limit in checked or limit.group in outputs)


def groups_of(field: str, names: Collection[str]) -> tuple[str, ...]:
    """Return the groups of outputs of limits and of the first one; `field` stands in the error of
    an unknown name.

    `all` stands for all limits that can be checked.
    """
    known = [limit.name for limit in checked_limits()]
    for name in names:
        if name in known:
            continue
        remedy = own.hint(name)
        if remedy:
            raise InputError(field, name, "limits that are loaded", remedy)
    check_names(field, names, (*known, "all"))
    if "all" in names:
        names = known
    return (*dict.fromkeys(LIMITS[name].group for name in names), first_limit.GROUP)


def check_used(
    given: Mapping[str, Any],
    outputs: Collection[str],
    not_checked: Collection[str],
    where: str = "",
) -> None:
    """Refuse a field of a case that only limits use which the outputs do not ask for, and a duty
    without lives.

    A field of a limit that `not_checked` leaves out is left out on purpose. `travel` also changes
    the profiles.

    Parameters
    ----------
    given : mapping
        Fields that were given with a value other than the default; and the `duty`, if there is one.
    outputs, not_checked : collection of str
        Values of these options.
    where : str
        What stands before a field in the message.

    Raises
    ------
    InputError
        For the first such field.
    """
    asked_for = limits_of(outputs, not_checked)
    if given.get("duty") and not asked_for:
        wrong = "is used by no output: it turns lives into years"
        raise InputError("duty", given["duty"], "", "Add limits to outputs, or remove duty.", wrong)
    for name in (name for name in given if name != "travel"):
        users = [limit for limit in checked_limits() if name in fields_of(limit)]
        if users and not any(limit in asked_for or limit.name in not_checked for limit in users):
            wrong = (
                f"is used by no output: it belongs to {', '.join(limit.name for limit in users)}"
            )
            remedy = f"Add limits to outputs, or remove {name}."
            raise InputError(f"{where}{name}", given[name], "", remedy, wrong)


def fields_of(limit: Limit) -> set[str]:
    """Return the fields of a case that a limit has or requires."""
    lists = [names for by_value in limit.requires_by.values() for names in by_value.values()]
    by_option = [name for names in lists for name in names]
    of_materials = {one.name for other in LIMITS.values() for one in other.materials}
    own = {*(one.name for one in limit.parameters), *(one.name for one in limit.mappings)}
    return own | ({*limit.requires, *by_option} - of_materials)


def others(names: Collection[str]) -> tuple[str, ...]:
    """Return the checked limits that a choice of limits leaves out; `all` leaves none
    out.
    """
    if "all" in names:
        return ()
    return tuple(limit.name for limit in checked_limits() if limit.name not in names)


def limit_word(name: str) -> str:
    """Return the word for a limit by its name, and any other text as it is."""
    return LIMITS[name].word if name in LIMITS else name


def checked_limits(
    outputs: Collection[str] = (first_limit.GROUP,), not_checked: Collection[str] = ()
) -> tuple[Limit, ...]:
    """Return the checked limits: all that have a use, without those of `not_checked`; none
    without `limits`.
    """
    if first_limit.GROUP not in outputs:
        return ()
    return tuple(
        own for own in LIMITS.values() if own.use is not None and own.name not in not_checked
    )


def computed(
    outputs: Collection[str], not_checked: Collection[str], life_criterion: str
) -> tuple[Limit, ...]:
    """Return the limits asked for, after the one whose stress the life needs by its criterion."""
    limits = limits_of(outputs, not_checked)
    paths = fatigue.LIMIT in limits and life_criterion in fatigue.STRESS_OF
    if paths and multiaxial.LIMIT not in limits:
        return (multiaxial.LIMIT, *limits)
    return limits
