"""Friction coefficient as a function of the local slip speed, for contact models that solve for the slip.

Every law is stored as a table that is linear between its knots, so that contact models read one form only. The law
scales the friction coefficient of the case, which holds at rest. If a case gives no friction coefficient, the first
value of a measured law (kind `table`) is used.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache, cached_property
from typing import Any, NamedTuple, NoReturn

import numpy as np

from trackroller.errors import InputError, nearest
from trackroller.numerics.numbers import number_in

KNOTS = 160  # of an exponential law; the error of the table is below 1e-4 of the drop in friction
DEFAULTS: dict[str, dict[str, Any]] = {
    "constant": {},
    "linear": {"speed": None, "lowest": 0.0},
    "exponential": {"speed": None, "lowest": 0.4},
    "table": {"speed": None, "friction": None},
}


class Knots(NamedTuple):
    """A law for compiled code: `factor` (m,) [1] at slip speeds `speed` (m,); m = 1 is constant friction."""

    speed: np.ndarray
    factor: np.ndarray


@dataclass(frozen=True, eq=False)
class FrictionLaw:
    """Describe how the friction coefficient depends on the slip speed, linearly between knots.

    Parameters
    ----------
    speed : numpy.ndarray, shape (m,)
        Slip speeds at the knots [mm/s].
    factor : numpy.ndarray, shape (m,)
        Friction coefficient at each knot over the coefficient at rest [1].
    form : mapping
        Mapping that describes the law, see `law_of`. Two laws are equal if their tables are equal.
    """

    speed: np.ndarray
    factor: np.ndarray
    form: Mapping[str, Any] = field(default_factory=dict, repr=False)

    def __call__(self, speed) -> np.ndarray:
        """Return the factor on the friction coefficient at slip speeds [mm/s] of any shape."""
        return np.interp(speed, self.speed, self.factor)

    @property
    def knots(self) -> Knots:
        """Return the law for compiled code, slip speeds in mm/s."""
        return Knots(self.speed, self.factor)

    @cached_property
    def is_constant(self) -> bool:
        """Return True if the factor is 1 at every speed."""
        return bool(np.all(self.factor == 1.0))

    @property
    def at_high_speed(self) -> float:
        """Return the factor beyond the last knot [1]."""
        return float(self.factor[-1])

    @property
    def steepest_fall(self) -> float:
        """Return the steepest decrease of the factor with the slip speed, >= 0 [s/mm]."""
        falls = -np.diff(self.factor) / np.diff(self.speed)
        return float(max(0.0, falls.max(initial=0.0)))

    def as_dict(self) -> dict[str, Any]:
        """Return the mapping from which `law_of` makes this law, with all its fields."""
        if self.is_constant:
            return {"kind": "constant"}
        return dict(self.form) or {"kind": "table", "speed": self.speed.tolist(), "friction": self.factor.tolist()}


@cache
def constant() -> FrictionLaw:
    """Return Coulomb's law, with the factor 1 at every speed."""
    return FrictionLaw(np.zeros(1), np.ones(1), {"kind": "constant"})


def steepness(law: FrictionLaw, bound, travel_speed, shear_modulus, film, element) -> np.ndarray:
    """Return how fast friction falls with the slip against what the surfaces follow, (n,) [1].

    Parameters
    ----------
    law : FrictionLaw
        Friction as a function of the slip speed.
    bound : ndarray, shape (n,)
        mu p_max [MPa].
    travel_speed : ndarray, shape (n,)
        Travel speed [mm/s].
    shear_modulus, film : ndarray, shape (n,)
        Combined shear modulus G [MPa], and flexibility of a film h/G3 between the bodies [mm^3/N].
    element : ndarray, shape (n,)
        Length of an element in the rolling direction [mm].

    Returns
    -------
    numpy.ndarray
        mu p_max v max(-df/dv) (1/G + h/(G3 l)) with the length l of an element. Above 1 a patch has several states or
        none.

    Notes
    -----
    Under the traction tau an element slips by about tau/G of the distance travelled, and by h tau/(G3 l) through the
    film. If this slip lowers the friction by more than the traction itself, the state of the element is not unique.
    With a film the problem has no solution below the length v (h/G3) mu p_max max(-df/dv), however soft the law: the
    elements must be longer. ASSUME: friction has no memory, which would replace the element as the smallest length.
    """
    return np.asarray(bound * law.steepest_fall * travel_speed * (1.0 / shear_modulus + film / element))


def _refuse(part: str, value: object, allowed: str, remedy: str = "") -> NoReturn:
    raise InputError(f"friction_law.{part}" if part else "friction_law", value, allowed, remedy)


def _fall(speed: object, lowest: object) -> dict[str, float]:
    least, most = np.nextafter(0.0, 1.0), np.finfo(float).max
    share = "the share of friction left at high speed, in [0, 1]"
    return {
        "speed": number_in(speed, "friction_law.speed", "a slip speed > 0 in mm/s", least, most, "mm/s"),
        "lowest": number_in(lowest, "friction_law.lowest", share, 0.0, 1.0, "-"),
    }


def linear_falling(speed: float, lowest: float = 0.0) -> FrictionLaw:
    """Return the law 1 - (1 - lowest) v / speed, constant beyond `speed`.

    Parameters
    ----------
    speed : float
        Slip speed at which the lowest friction is reached, > 0 [mm/s].
    lowest : float
        Lowest friction over friction at rest, from 0 to 1 [1].

    Returns
    -------
    FrictionLaw
        The law.

    Raises
    ------
    InputError
        If a value is out of range.
    """
    form = _fall(speed, lowest)
    return FrictionLaw(np.array([0.0, form["speed"]]), np.array([1.0, form["lowest"]]), {"kind": "linear", **form})


def exponential_falling(speed: float, lowest: float = 0.4) -> FrictionLaw:
    """Return the law lowest + (1 - lowest) exp(-v / speed) (Polach 2005; Vollebregt & Schuttelaars 2012).

    Parameters
    ----------
    speed : float
        Slip speed at which the falling part has decreased to 1/e, > 0 [mm/s].
    lowest : float
        Friction at high speed over friction at rest, from 0 to 1 [1].

    Returns
    -------
    FrictionLaw
        The law.

    Raises
    ------
    InputError
        If a value is out of range.
    """
    form = _fall(speed, lowest)
    part = np.linspace(0.0, 1.0, KNOTS) ** 1.5 * 12.0
    factor = form["lowest"] + (1.0 - form["lowest"]) * np.exp(-part)
    return FrictionLaw(part * form["speed"], factor, {"kind": "exponential", **form})


def table(speed, friction) -> FrictionLaw:
    """Return a measured law from friction coefficients at slip speeds.

    Parameters
    ----------
    speed : sequence of float, length m
        Slip speeds that rise from 0 [mm/s].
    friction : sequence of float, length m
        Friction coefficients >= 0, the first one > 0 [1]. The law takes them relative to the first one.

    Returns
    -------
    FrictionLaw
        The law.

    Raises
    ------
    InputError
        If the lists do not meet these conditions.
    """
    speeds = _list("speed", speed, "slip speeds in mm/s")
    values = _list("friction", friction, "friction coefficients")
    if speeds.size != values.size:
        allowed = f"as many friction coefficients as slip speeds: {values.size} beside the {speeds.size} of speed"
        _refuse("friction", values.tolist(), allowed, "Give one friction coefficient for each slip speed.")
    if speeds[0] != 0.0 or np.any(np.diff(speeds) <= 0) or not np.all(np.isfinite(speeds)):
        _refuse("speed", speeds.tolist(), "slip speeds in mm/s that rise from 0")
    if not (values[0] > 0 and np.all(values >= 0) and np.all(np.isfinite(values))):
        _refuse("friction", values.tolist(), "friction coefficients >= 0, the first > 0")
    form = {"kind": "table", "speed": speeds.tolist(), "friction": values.tolist()}
    return FrictionLaw(speeds, values / values[0], form)


def _list(part: str, values: object, words: str) -> np.ndarray:
    allowed = f"a list of numbers, {words}"
    if not isinstance(values, (list, tuple, np.ndarray)) or len(values) == 0:
        _refuse(part, values, allowed)
    unit = "mm/s" if part == "speed" else "-"
    return np.array([number_in(value, f"friction_law.{part}", allowed, unit=unit) for value in values])  # type: ignore[attr-defined]


def at_rest(law: Any) -> float | None:
    """Return the friction coefficient at rest of a measured law.

    Parameters
    ----------
    law : mapping, str, FrictionLaw or None
        See `law_of`.

    Returns
    -------
    float or None
        First friction coefficient of the table [1]; None for laws of other kinds.
    """
    form = law_of(law).form
    return float(form["friction"][0]) if form.get("kind") == "table" else None


def _fields(mapping: Mapping[str, Any]) -> dict[str, Any]:
    """Return the fields of a mapping with defaults; refuse unknown kinds, and unknown or missing fields."""
    kind = str(mapping.get("kind"))
    if kind not in DEFAULTS:
        close = nearest(kind, tuple(DEFAULTS))
        _refuse(
            "kind", mapping.get("kind"), f"one of {', '.join(DEFAULTS)}", f"Did you mean {close!r}?" if close else ""
        )
    values = DEFAULTS[kind] | {k: v for k, v in mapping.items() if k != "kind"}
    for name, value in values.items():
        if name not in DEFAULTS[kind]:
            _refuse(str(name), value, f"a {kind} law has the fields {', '.join(('kind', *DEFAULTS[kind]))}")
        if value is None:
            _refuse(name, value, f"a {kind} law needs {name}")
    return values


def law_of(mapping: Mapping[str, Any] | FrictionLaw | str | None) -> FrictionLaw:
    """Return the friction law of a mapping from a case or study file.

    Parameters
    ----------
    mapping : mapping, str, FrictionLaw or None
        One of `{kind: constant}`, `{kind: linear, speed: v, lowest: f}`, `{kind: exponential, speed: v, lowest: f}` and
        `{kind: table, speed: [0, ...], friction: [...]}` with slip speeds in mm/s. JSON text of such a mapping is
        accepted. None and an empty mapping stand for constant friction.

    Returns
    -------
    FrictionLaw
        The law.

    Raises
    ------
    InputError
        If a part is wrong; the error names `friction_law` and this part.
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
    values = _fields(mapping)
    makers = {"constant": constant, "linear": linear_falling, "exponential": exponential_falling, "table": table}
    return makers[str(mapping["kind"])](**values)  # type: ignore[operator]


def canonical(value: Mapping[str, Any], field: str = "friction_law") -> dict[str, Any]:
    """Return the checked mapping of a law, with its defaults and with numbers as floats.

    Parameters
    ----------
    value : mapping
        See `law_of`.
    field : str
        Name of the field in error messages.

    Returns
    -------
    dict
        The mapping; {} for constant friction.

    Raises
    ------
    InputError
        If a part is wrong; the error names the entry of `field`.
    """
    try:
        law = law_of(value)
    except InputError as error:
        name = field + error.field.removeprefix("friction_law")
        raise error.named(name) from None
    return {} if law.is_constant else law.as_dict()
