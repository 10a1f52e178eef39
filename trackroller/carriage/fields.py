"""The fields of a carriage that a study varies: which of them a carriage has, and the carriage with other values."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from trackroller.carriage.file import Carriage, LoadCase, PointMass, Preload, check_curves
from trackroller.errors import unknown_name
from trackroller.parameters.carriage_fields import AXES, OF_LOAD_CASE, OF_ROLLER, OF_WHOLE, PREFIX, split_field, word_of


def fields_of(whole: Carriage) -> list[str]:
    """Return the names of the fields that a carriage has.

    A field of all load cases is one of the carriage if at least one load case states it; each load case has all fields
    of its own. A carriage without payload, drive or pairs has no fields of them.
    """
    known = [name for name in OF_WHOLE if _has(whole, name.removeprefix(PREFIX))]
    known += [name for name in OF_LOAD_CASE if any(_states(case, name) for case in whole.cases)]
    known += [f"{name}_in_{word_of(case.name)}" for case in whole.cases for name in OF_LOAD_CASE]
    return known + [f"{name}_of_{word_of(roller.name)}" for roller in whole.rollers for name in OF_ROLLER]


def check_fields(whole: Carriage, names: list[str], where: str = "factors") -> None:
    """Refuse names that are no fields of a carriage; raise `InputError` with the nearest one."""
    known = fields_of(whole)
    for name in names:
        if name not in known:
            raise unknown_name(where, name, known)


def changed(whole: Carriage, values: Mapping[str, float]) -> Carriage:
    """Return a carriage with other values of its fields.

    Parameters
    ----------
    whole : Carriage
        The carriage.
    values : mapping of str to float
        Values by the names of `fields_of`, in the units of `trackroller.parameters.carriage_fields`.

    Raises
    ------
    InputError
        If the carriage has no such field, or if a curve is too narrow for the new rollers.

    Notes
    -----
    `carriage_wheelbase` and `carriage_gauge` move all rollers in proportion to their distance from the middle of the
    outermost ones. `carriage_payload` keeps the proportions of several payloads, and their places are moved together.
    """
    check_fields(whole, list(values))
    new = whole
    for name, value in values.items():
        head, place = split_field(name) or (name, "")
        field = head.removeprefix(PREFIX)
        if head in OF_LOAD_CASE:
            new = _in_cases(new, field, place, value)
        elif head in OF_ROLLER:
            new = _of_roller(new, field, place, value)
        else:
            new = _OF_WHOLE[field](new, value)
    check_curves(new.cases, new.rollers)
    return new


def _states(case: LoadCase, name: str) -> bool:
    """Return whether a load case states a field of all load cases."""
    value = getattr(case, name.removeprefix(PREFIX))
    return value is not None and value != 0 and math.isfinite(value)


def _has(whole: Carriage, field: str) -> bool:
    if field in ("wheelbase", "gauge"):
        return bool(np.ptp([roller.at[int(field == "gauge")] for roller in whole.rollers]) > 0)
    if field in ("preload", "play"):
        return any((pair.play == 0) == (field == "preload") for pair in whole.preloads)
    part = field.partition("_")[0]
    return {"payload": bool(whole.payloads), "drive": whole.drive is not None}.get(part, True)


def _in_cases(whole: Carriage, field: str, place: str, value: float) -> Carriage:
    """Return a carriage with a value of a load case, of each load case that states one if `place` is ''."""
    own: dict[str, Any] = {field: math.radians(value) if field in ("gradient", "cant") else value}

    def new(case: LoadCase) -> LoadCase:
        if place:
            meant = word_of(case.name) == place
        else:
            meant = _states(case, field)
        return replace(case, **own) if meant else case

    return replace(whole, cases=tuple(map(new, whole.cases)))


def _of_roller(whole: Carriage, field: str, place: str, value: float) -> Carriage:
    rollers = []
    for roller in whole.rollers:
        if word_of(roller.name) == place:
            roller = replace(roller, at=_moved(roller.at, field, value))
        rollers.append(roller)
    return replace(whole, rollers=tuple(rollers))


def _moved(at: np.ndarray, axis: str, value: float) -> np.ndarray:
    new = at.copy()
    new[AXES.index(axis)] = value
    return new


def _stretched(axis: int) -> Callable[[Carriage, float], Carriage]:
    def change(whole: Carriage, value: float) -> Carriage:
        places = np.array([roller.at[axis] for roller in whole.rollers])
        middle = (places.max() + places.min()) / 2
        distance = np.ptp(places)
        new = middle + (places - middle) * value / distance
        pairs = zip(whole.rollers, new, strict=True)
        return replace(whole, rollers=tuple(replace(r, at=_moved(r.at, AXES[axis], x)) for r, x in pairs))

    return change


def _payload(whole: Carriage, value: float) -> Carriage:
    total = sum(mass.value for mass in whole.payloads)
    shares = [1 / len(whole.payloads) for _ in whole.payloads]
    if total > 0:
        shares = [mass.value / total for mass in whole.payloads]
    pairs = zip(whole.payloads, shares, strict=True)
    return replace(whole, payloads=tuple(PointMass(value * share, mass.at) for mass, share in pairs))


def _payload_place(axis: int) -> Callable[[Carriage, float], Carriage]:
    def change(whole: Carriage, value: float) -> Carriage:
        weights = np.array([one.value for one in whole.payloads])
        if not weights.sum() > 0:
            weights = np.ones(len(weights))
        step = value - float(np.average([one.at[axis] for one in whole.payloads], weights=weights))
        moved = (PointMass(one.value, _moved(one.at, AXES[axis], one.at[axis] + step)) for one in whole.payloads)
        return replace(whole, payloads=tuple(moved))

    return change


def _pairs(field: str) -> Callable[[Carriage, float], Carriage]:
    def change(whole: Carriage, value: float) -> Carriage:
        def new(pair: Preload) -> Preload:
            if (pair.play == 0) != (field == "preload"):
                return pair
            if field == "preload":
                return Preload(pair.pair, force=value)
            return Preload(pair.pair, play=value)

        return replace(whole, preloads=tuple(map(new, whole.preloads)))

    return change


def _at(part: str, axis: str) -> Callable[[Carriage, float], Carriage]:
    def change(whole: Carriage, value: float) -> Carriage:
        if part == "mass":
            return replace(whole, mass=replace(whole.mass, at=_moved(whole.mass.at, axis, value)))
        assert whole.drive is not None  # `check_fields` asked
        return replace(whole, drive=_moved(whole.drive, axis, value))

    return change


_OF_WHOLE: dict[str, Callable[[Carriage, float], Carriage]] = {
    "wheelbase": _stretched(0),
    "gauge": _stretched(1),
    "mass": lambda whole, value: replace(whole, mass=replace(whole.mass, value=value)),
    "payload": _payload,
    "preload": _pairs("preload"),
    "play": _pairs("play"),
    **{f"{part}_{axis}": _at(part, axis) for part in ("mass", "drive") for axis in AXES},
    **{f"payload_{axis}": _payload_place(i) for i, axis in enumerate(AXES)},
}
