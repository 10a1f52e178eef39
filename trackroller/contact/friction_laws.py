"""Friction coefficient as a function of the local slip speed, for contact models that solve for the slip.

A law is kept as a table that is linear between its knots, so that every contact model reads one form. It scales the
friction coefficient of the case, which holds at rest; a case that gives none takes that of a law that tells its own.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from trackroller.errors import InputError, nearest
from trackroller.numerics.numbers import read_number

KNOTS = 160  # of an exponential law; the table is off by less than 1e-4 of its drop
DEFAULTS: dict[str, dict[str, Any]] = {
    "constant": {},
    "linear": {"speed": None, "lowest": 0.0},
    "exponential": {"speed": None, "lowest": 0.4},
    "table": {"speed": None, "friction": None},
}


class Knots(NamedTuple):
    """A law as compiled code takes it: `factor` (m,) at the slip speeds `speed` (m,); m = 1 is constant friction."""

    speed: np.ndarray
    factor: np.ndarray


@dataclass(frozen=True, eq=False)
class FrictionLaw:
    """Friction over its value at rest: `factor` (m,) at slip speeds `speed` (m,) [mm/s], linear in between.

    `form` is the mapping the law was made from, see `law_of`; two laws are equal if their tables are.
    """

    speed: np.ndarray
    factor: np.ndarray
    form: Mapping[str, Any] = field(default_factory=dict, repr=False)

    def __call__(self, speed) -> np.ndarray:
        """Factor on the friction coefficient at slip speeds [mm/s], any shape; constant beyond the last knot."""
        return np.interp(speed, self.speed, self.factor)

    @property
    def knots(self) -> Knots:
        """The law for compiled code, slip speeds in mm/s."""
        return Knots(self.speed, self.factor)

    @property
    def is_constant(self) -> bool:
        """Whether the factor is 1 at every speed."""
        return bool(np.all(self.factor == 1.0))

    @property
    def at_high_speed(self) -> float:
        """Factor beyond the last knot [-]."""
        return float(self.factor[-1])

    @property
    def steepest_fall(self) -> float:
        """Largest fall of the factor by slip speed [s/mm], 0 if it falls nowhere."""
        falls = -np.diff(self.factor) / np.diff(self.speed)
        return float(max(0.0, falls.max(initial=0.0)))

    def _content(self) -> tuple[bytes, bytes]:
        if self.is_constant:
            return b"", b""
        return self.speed.tobytes(), self.factor.tobytes()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, FrictionLaw) and self._content() == other._content()

    def __hash__(self) -> int:
        return hash(self._content())

    def as_dict(self) -> dict[str, Any]:
        """The mapping that `law_of` makes this law from, all its fields written out."""
        if self.is_constant:
            return {"kind": "constant"}
        return dict(self.form) or {"kind": "table", "speed": self.speed.tolist(), "friction": self.factor.tolist()}

    @property
    def json(self) -> str:
        """Canonical text of `as_dict`: equal laws of one kind give equal text."""
        return json.dumps(self.as_dict(), sort_keys=True, separators=(",", ":"))


def constant() -> FrictionLaw:
    """Coulomb's law, factor 1 at every speed."""
    return FrictionLaw(np.zeros(1), np.ones(1), {"kind": "constant"})


def _refuse(part: str, value: object, allowed: str, remedy: str = "") -> None:
    raise InputError(f"friction_law.{part}" if part else "friction_law", value, allowed, remedy)


def _number(part: str, value: object, allowed: str) -> float:
    try:
        return read_number(value)
    except ValueError:
        _refuse(part, value, allowed)
        raise AssertionError from None


def _checked_share(lowest: object) -> float:
    allowed = "the share of friction left at high speed, in [0, 1]"
    number = _number("lowest", lowest, allowed)
    if not 0.0 <= number <= 1.0:
        _refuse("lowest", lowest, allowed)
    return number


def _checked_speed(speed: object) -> float:
    number = _number("speed", speed, "a slip speed > 0 in mm/s")
    if not (number > 0.0 and np.isfinite(number)):
        _refuse("speed", speed, "a slip speed > 0 in mm/s")
    return number


def linear_falling(speed: float, lowest: float = 0.0) -> FrictionLaw:
    """1 - (1 - lowest) v / speed, then constant.

    Parameters
    ----------
    speed : slip speed at which the lowest friction is reached [mm/s]
    lowest : friction left there over that at rest [-]
    """
    speed, lowest = _checked_speed(speed), _checked_share(lowest)
    form = {"kind": "linear", "speed": speed, "lowest": lowest}
    return FrictionLaw(np.array([0.0, speed]), np.array([1.0, lowest]), form)


def exponential_falling(speed: float, lowest: float = 0.4) -> FrictionLaw:
    """lowest + (1 - lowest) exp(-v / speed) (Polach 2005; Vollebregt & Schuttelaars 2012).

    Parameters
    ----------
    speed : slip speed at which the falling part has dropped to 1/e [mm/s]
    lowest : friction at high speed over that at rest [-]
    """
    speed, lowest = _checked_speed(speed), _checked_share(lowest)
    part = np.linspace(0.0, 1.0, KNOTS) ** 1.5 * 12.0
    form = {"kind": "exponential", "speed": speed, "lowest": lowest}
    return FrictionLaw(part * speed, lowest + (1.0 - lowest) * np.exp(-part), form)


def table(speed, friction) -> FrictionLaw:
    """A measured law: friction coefficients (m,) at slip speeds (m,) [mm/s], taken relative to the first.

    Raises `InputError` unless the speeds rise from 0 and the friction is >= 0, with the first > 0.
    """
    speeds = _list("speed", speed, "slip speeds in mm/s")
    values = _list("friction", friction, "friction coefficients")
    if speeds.size != values.size:
        _refuse(
            "friction",
            values.tolist(),
            f"as many friction coefficients as slip speeds: {values.size} beside the {speeds.size} of speed",
            "Give one friction coefficient for each slip speed.",
        )
    if speeds[0] != 0.0 or np.any(np.diff(speeds) <= 0) or not np.all(np.isfinite(speeds)):
        _refuse("speed", speeds.tolist(), "slip speeds in mm/s that rise from 0")
    if not (values[0] > 0 and np.all(values >= 0) and np.all(np.isfinite(values))):
        _refuse("friction", values.tolist(), "friction coefficients >= 0, the first > 0")
    form = {"kind": "table", "speed": speeds.tolist(), "friction": values.tolist()}
    return FrictionLaw(speeds, values / values[0], form)


def _list(part: str, values: object, words: str) -> np.ndarray:
    told = f"a list of numbers, {words}"
    if not isinstance(values, (list, tuple, np.ndarray)) or len(values) == 0:
        _refuse(part, values, told)
    return np.array([_number(part, value, told) for value in values])  # type: ignore[attr-defined]


def at_rest(law: Any) -> float | None:
    """The friction coefficient at rest that a law itself tells: a table's first one, None for other laws.

    Parameters
    ----------
    law : a mapping, its JSON text, a `FrictionLaw` or None, see `law_of`
    """
    form = law_of(law).form
    return float(form["friction"][0]) if form.get("kind") == "table" else None


def _fields(mapping: Mapping[str, Any]) -> dict[str, Any]:
    """The mapping with its defaults; unknown kinds, unknown and missing fields are refused."""
    kind = mapping.get("kind")
    if not isinstance(kind, str) or kind not in DEFAULTS:
        close = nearest(str(kind), tuple(DEFAULTS))
        _refuse("kind", kind, f"one of {', '.join(DEFAULTS)}", f"Did you mean {close!r}?" if close else "")
    known = DEFAULTS[str(kind)]
    for name in mapping:
        if name != "kind" and name not in known:
            _refuse(str(name), mapping[name], f"a {kind} law has the fields {', '.join(('kind', *known))}")
    values = {**known, **{k: v for k, v in mapping.items() if k != "kind"}}
    for name, value in values.items():
        if value is None:
            _refuse(name, value, f"a {kind} law needs {name}")
    return values


def law_of(mapping: Mapping[str, Any] | FrictionLaw | str | None) -> FrictionLaw:
    """The law of a mapping as it stands in a case or study file.

    Parameters
    ----------
    mapping : `{kind: constant}`; `{kind: linear, speed: v, lowest: f}`; `{kind: exponential, speed: v, lowest: f}`;
        `{kind: table, speed: [0, ...], friction: [...]}` with slip speeds in mm/s; the JSON text of such a mapping;
        or None or an empty mapping for constant

    Raises `InputError` that names `friction_law` and the part that is wrong.
    """
    if mapping is None or (isinstance(mapping, (str, Mapping)) and not mapping):
        return constant()
    if isinstance(mapping, FrictionLaw):
        return mapping
    if isinstance(mapping, str):
        try:
            mapping = json.loads(mapping) if mapping.lstrip().startswith("{") else {"kind": mapping}
        except json.JSONDecodeError:
            _refuse("", mapping, "a mapping with `kind`, or its JSON text")
    if not isinstance(mapping, Mapping):
        _refuse("", mapping, "a mapping such as {kind: exponential, speed: 100, lowest: 0.4}")
        raise AssertionError
    values = _fields(mapping)
    makers = {"constant": constant, "linear": linear_falling, "exponential": exponential_falling, "table": table}
    return makers[str(mapping["kind"])](**values)  # type: ignore[operator]


def canonical(value: Mapping[str, Any], field: str = "friction_law") -> dict[str, Any]:
    """The mapping of a law as in `law_of`, checked, with defaults and numbers as floats; {} for the constant law.

    Raises `InputError` that names the entry of `field`.
    """
    try:
        law = law_of(value)
    except InputError as error:
        name = field + error.field.removeprefix("friction_law")
        raise InputError(name, error.value, error.allowed, error.remedy) from None
    return {} if law.is_constant else law.as_dict()
