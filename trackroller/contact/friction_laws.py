"""Friction coefficient as a function of the local slip speed, for contact models that solve for the slip.

A law is kept as a table that is linear between its knots, so that every contact model reads one form.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from trackroller.errors import InputError, unknown_name

KNOTS = 160  # of an exponential law; the table is off by less than 1e-4 of its drop


@dataclass(frozen=True)
class FrictionLaw:
    """Friction over its value at rest: `factor` (m,) at slip speeds `speed` (m,) [mm/s], linear in between."""

    speed: np.ndarray
    factor: np.ndarray

    def __call__(self, speed) -> np.ndarray:
        """Factor on the friction coefficient at slip speeds [mm/s], any shape; constant beyond the last knot."""
        return np.interp(speed, self.speed, self.factor)

    @property
    def is_constant(self) -> bool:
        return self.speed.size == 1


def constant() -> FrictionLaw:
    """Coulomb's law, factor 1 at every speed."""
    return FrictionLaw(np.zeros(1), np.ones(1))


def _checked_share(lowest: float) -> None:
    if not 0.0 <= lowest <= 1.0:
        raise InputError("lowest", lowest, "the share of friction left at high speed lies in [0, 1]")


def _checked_speed(speed: float) -> None:
    if not (speed > 0.0 and np.isfinite(speed)):
        raise InputError("speed", speed, "a slip speed > 0 in mm/s")


def linear_falling(speed: float, lowest: float = 0.0) -> FrictionLaw:
    """1 - (1 - lowest) v / speed, then constant.

    Parameters
    ----------
    speed : slip speed at which the lowest friction is reached [mm/s]
    lowest : friction left there over that at rest [-]
    """
    _checked_speed(speed)
    _checked_share(lowest)
    return FrictionLaw(np.array([0.0, speed]), np.array([1.0, lowest]))


def exponential_falling(speed: float, lowest: float = 0.4) -> FrictionLaw:
    """lowest + (1 - lowest) exp(-v / speed) (Polach 2005; Vollebregt & Schuttelaars 2012).

    Parameters
    ----------
    speed : slip speed at which the falling part has dropped to 1/e [mm/s]
    lowest : friction at high speed over that at rest [-]
    """
    _checked_speed(speed)
    _checked_share(lowest)
    part = np.linspace(0.0, 1.0, KNOTS) ** 1.5 * 12.0
    return FrictionLaw(part * speed, lowest + (1.0 - lowest) * np.exp(-part))


def table(speed, friction) -> FrictionLaw:
    """A measured law: friction coefficients (m,) at slip speeds (m,) [mm/s], taken relative to the first.

    Raises `InputError` unless the speeds rise from 0 and the friction is >= 0, with the first > 0.
    """
    speed, friction = np.asarray(speed, float), np.asarray(friction, float)
    if speed.ndim != 1 or speed.shape != friction.shape or speed.size == 0:
        raise InputError("speed", speed.shape, "as many slip speeds as friction coefficients, at least one")
    if speed[0] != 0.0 or np.any(np.diff(speed) <= 0) or not np.all(np.isfinite(speed)):
        raise InputError("speed", speed.tolist(), "slip speeds rise from 0")
    if not (friction[0] > 0 and np.all(friction >= 0) and np.all(np.isfinite(friction))):
        raise InputError("friction", friction.tolist(), "friction coefficients >= 0, the first > 0")
    return FrictionLaw(speed, friction / friction[0])


_KINDS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {  # needed and further entries
    "constant": ((), ()),
    "linear": (("speed",), ("lowest",)),
    "exponential": (("speed",), ("lowest",)),
    "table": (("speed", "friction"), ()),
}


def canonical(value: Mapping[str, Any], field: str = "friction_law") -> dict[str, Any]:
    """The mapping of a law, checked, with numbers as floats; {} for the constant law.

    Parameters
    ----------
    value : {kind: constant}, {kind: linear, speed [mm/s], lowest}, {kind: exponential, speed [mm/s], lowest} or
        {kind: table, speed: [mm/s ...], friction: [...]}; see the functions of the same names

    Raises `InputError` that names the entry of `field`.
    """
    if not isinstance(value, Mapping) or "kind" not in value:
        raise InputError(field, value, "a mapping with the entry kind: " + ", ".join(_KINDS))
    kind = value["kind"]
    if kind not in _KINDS:
        raise unknown_name(f"{field}.kind", str(kind), tuple(_KINDS))
    needed, further = _KINDS[kind]
    for key in value:
        if key not in ("kind", *needed, *further):
            raise unknown_name(f"{field}: entry of {kind}", str(key), ("kind", *needed, *further))
    for key in needed:
        if key not in value:
            raise InputError(f"{field}.{key}", None, f"kind {kind} needs the entries " + ", ".join(needed))
    try:
        numbers = {k: [float(x) for x in v] if isinstance(v, (list, tuple)) else float(v)
                   for k, v in value.items() if k != "kind"}  # fmt: skip
    except (TypeError, ValueError):
        raise InputError(field, dict(value), "numbers for " + ", ".join((*needed, *further))) from None
    told = {"kind": kind, **dict(sorted(numbers.items()))}
    try:
        law = _law(told)
    except InputError as exc:
        raise InputError(f"{field}.{exc.field}", exc.value, exc.allowed, exc.remedy) from None
    return {} if np.all(law.factor == 1.0) else told


def _law(told: Mapping[str, Any]) -> FrictionLaw:
    makers = {"constant": constant, "linear": linear_falling, "exponential": exponential_falling, "table": table}
    return makers[told["kind"]](**{k: v for k, v in told.items() if k != "kind"})  # type: ignore[operator]


def law_of(value: Mapping[str, Any] | None) -> FrictionLaw:
    """The law of a mapping (see `canonical`); the constant law for None or an empty mapping."""
    return _law(canonical(value)) if value and canonical(value) else constant()
