"""Complete an S-N curve (Wöhler line) from any sufficient combination of its values.

The curve runs through (N_Rm, R_m) and (N_k, sigma_D) with the exponent k::

    N_k / N_Rm = (R_m / sigma_D)**k

Data sheets give some of sigma_D or sigma_D/R_m, N_k, N_Rm and k. A material needs sigma_D/R_m, N_Rm
and N_k.

A line by points, and a line by sigma_D in MPa, N_k and k, are free of R_m: they stay where they are
if R_m changes.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from trackroller.damage.sn_curve import SNCurve, curve_exponent, segments
from trackroller.errors import InputError
from trackroller.materials.properties import ALTERNATIVES, PROPERTIES, Value, check_number
from trackroller.numerics.parameter import Parameter

CURVE = (
    "fatigue_strength_ratio",
    "cycles_at_tensile_strength",
    "cycles_at_fatigue_limit",
    "woehler_exponent",
)
POINTS = "sn_points"  # key of an entry and field of a material
# together a line that needs no R_m
FREE = ("fatigue_limit", "cycles_at_fatigue_limit", "woehler_exponent")
Points = tuple[tuple[float, float], ...]
_SMALLEST = 1e-290  # cycles; a power of a line that runs on must neither vanish nor overflow
# largest relative difference between a given value and the value that follows from the others
AGREE = 0.01
_ALL = PROPERTIES | ALTERNATIVES
_OF_POINT = (
    Parameter(
        "stress",
        "sigma_a",
        "MPa",
        math.nan,
        "amplitude",
        0.0,
        2e5,
        open_lower=True,
        open_upper=True,
    ),
    Parameter(
        "cycles",
        "N",
        "-",
        math.nan,
        "cycles to failure",
        0.0,
        math.inf,
        open_lower=True,
        open_upper=True,
    ),
)


def read_points(given: Any, where: str, unit: str = "MPa") -> Points:
    """Return the points of a line from the largest stress to the knee, whose order in a file does
    not matter.

    Parameters
    ----------
    given : sequence of pairs
        At least two points [stress in MPa, cycles]; a number may have a unit of its own.
    where : str
        Place of the material, for messages.
    unit : str
        Unit of the stresses.

    Raises
    ------
    InputError
        If a point is no pair of numbers, two points have the same stress, or the line does not
        fall.
    """
    field = f"{where}.{POINTS}"
    if not isinstance(given, (list, tuple)) or len(given) < 2:
        allowed = "a list of at least two points [stress in MPa, cycles]"
        raise InputError(field, given, allowed, "Write sn_points: [[400, 1e5], [250, 2e6]].")
    points = []
    for i, point in enumerate(given, 1):
        if not isinstance(point, (list, tuple)) or len(point) != 2:
            raise InputError(
                f"{field}, point {i}", point, "a pair [stress in MPa, cycles]", "Give both numbers."
            )
        of = f"{field}, point {i}"
        points.append(
            (
                check_number(_OF_POINT[0], point[0], of, unit),
                check_number(_OF_POINT[1], point[1], of),
            )
        )
    points.sort(key=lambda point: -point[0])
    for (high, early), (low, late) in itertools.pairwise(points):
        if not (high > low and early < late):
            wrong = f"has {early:g} cycles at {high:g} MPa and {late:g} cycles at {low:g} MPa"
            allowed = "a line that falls: less stress with more cycles, each stress once"
            raise InputError(
                field, "the line", allowed, "Correct or remove one of these points.", wrong
            )
    return tuple(points)


def free_line(limit: float, knee: float, exponent: float, strength: float) -> Points:
    """Return two points of the line through (N_k, sigma_D) with an exponent, of which the last one
    is the knee.

    Parameters
    ----------
    limit, knee, exponent : float
        sigma_D [MPa], N_k [1] and k [1].
    strength : float
        R_m [MPa], at which the first point lies if the line reaches it with a number of cycles that
        can be written, and is not so close to sigma_D that the two points would state the exponent
        with few digits.
    """
    ratio = limit / strength
    first = knee * ratio**exponent if ratio < 0.99 else 0.0
    if first > _SMALLEST:
        return (strength, first), (ratio * strength, knee)
    return (2.0 * limit, knee * 2.0**-exponent), (limit, knee)


def numbers_of_line(points: Points, strength: float) -> dict[str, float]:
    """Return sigma_D/R_m, N_Rm and N_k of a line by points; N_Rm is where the line, run on, reaches
    R_m.
    """
    limit, knee = points[-1]
    if points[0][0] == strength:
        first = points[0][1]
    else:
        curve = SNCurve(strength, limit, math.nan, knee, segments=segments(points))
        first = float(np.clip(curve.life_cycles(strength), _SMALLEST, 1.0 / _SMALLEST))
    return dict(zip(CURVE, (limit / strength, first, knee), strict=False))


def line_values(points: Points, strength: Value, sources: Mapping[str, Value]) -> dict[str, Value]:
    """Return the values of a material that follow from a line by points.

    Parameters
    ----------
    points : sequence of pairs
        The line.
    strength : Value
        R_m.
    sources : mapping of str to Value
        Values whose source and mark the three numbers of the line take over, by their names in
        `CURVE`.
    """
    numbers = numbers_of_line(points, strength.value)
    return {
        name: _derived(value, sources[name], sources[name].note) for name, value in numbers.items()
    }


def refuse_other_line(
    points: Points, given: Mapping[str, float], strength: float | None, where: str
) -> None:
    """Refuse numbers of a curve beside points that say otherwise by more than 1 %."""
    (above, early), (limit, knee) = points[-2:]
    follows = {
        "fatigue_limit": limit,
        "woehler_exponent": float(curve_exponent(knee / early, above / limit)),
    }
    if strength is not None:
        follows |= numbers_of_line(points, strength)
    for name in given.keys() & follows.keys():
        _refuse_apart(name, given[name], follows[name], where)


def complete_curve(
    given: Mapping[str, Value], inherited: Mapping[str, Value], where: str
) -> dict[str, Value]:
    """Return the values of the S-N curve that follow from those given.

    Parameters
    ----------
    given : mapping of str to Value
        Values of an entry, `fatigue_limit` and `woehler_exponent` among them.
    inherited : mapping of str to Value
        Values of the material that the entry changes or names by `like`. They are used for values
        that are not given and do not follow from given values.
    where : str
        Place of the entry, for messages.

    Returns
    -------
    dict of str to Value
        `fatigue_strength_ratio`, `cycles_at_tensile_strength` and `cycles_at_fatigue_limit`, as far
        as known.

    Raises
    ------
    InputError
        If values contradict each other by more than 1 %.

    Notes
    -----
    A given value replaces an inherited one. Where three of the four values of the curve are given
    or inherited, the fourth follows; an exponent that is given replaces the inherited
    `cycles_at_tensile_strength` first.

    Examples
    --------
    sigma_D = 30 MPa at 1e7 cycles with k = 8 and R_m = 60 MPa gives N_Rm = 1e7 / 2**8 = 39,062
    cycles.
    """
    known = {name: given[name] for name in CURVE if name in given}
    _take_limit(known, given, inherited, where)
    if len(known) == len(CURVE):
        _check(known, where)
    elif "woehler_exponent" in known:
        for name in (
            "cycles_at_fatigue_limit",
            "fatigue_strength_ratio",
            "cycles_at_tensile_strength",
        ):
            if len(known) < len(CURVE) - 1 and name not in known and name in inherited:
                known[name] = inherited[name]
        if len(known) == len(CURVE) - 1:
            _solve(known, where)
    known.pop("woehler_exponent", None)
    return {name: inherited[name] for name in CURVE if name in inherited} | known


def _take_limit(known: dict[str, Value], given: Mapping, inherited: Mapping, where: str) -> None:
    """Turn a fatigue limit in MPa into its ratio to the tensile strength."""
    limit = given.get("fatigue_limit")
    strength = given.get("tensile_strength", inherited.get("tensile_strength"))
    if limit is None or strength is None:
        return
    ratio = limit.value / strength.value
    if "fatigue_strength_ratio" in known:
        _refuse_apart(
            "fatigue_limit",
            limit.value,
            known["fatigue_strength_ratio"].value * strength.value,
            where,
        )
    elif not ratio < 1.0:
        allowed = f"a fatigue limit below the tensile strength R_m = {strength.value:g} MPa"
        raise InputError(
            f"{where}.fatigue_limit", limit.value, allowed, "Correct one of the two values."
        )
    else:
        known["fatigue_strength_ratio"] = _derived(
            ratio, limit, f"sigma_D = {limit.value:g} MPa over R_m"
        )


def _solve(known: dict[str, Value], where: str) -> None:
    """Add the one value of the curve that is missing."""
    missing = next(name for name in CURVE if name not in known)
    values = dict.fromkeys(CURVE, math.nan) | {name: value.value for name, value in known.items()}
    ratio, low, high, k = (values[name] for name in CURVE)
    try:
        value = {
            "fatigue_strength_ratio": lambda: (high / low) ** (-1.0 / k),
            "cycles_at_tensile_strength": lambda: high * ratio**k,
            "cycles_at_fatigue_limit": lambda: low * ratio**-k,
        }[missing]()
    except OverflowError:
        value = math.inf
    if not _ALL[missing].accepts(value):
        allowed = f"an exponent that gives a possible {missing}, not {value:.3g}"
        raise InputError(
            f"{where}.woehler_exponent", k, allowed, "Correct the exponent or the cycles."
        )
    known[missing] = _derived(value, known["woehler_exponent"], f"from the exponent k = {k:g}")


def _check(known: Mapping[str, Value], where: str) -> None:
    ratio, low, high, k = (known[name].value for name in CURVE)
    if low < high:
        follows = float(curve_exponent(high / low, 1.0 / ratio))
    else:
        follows = math.nan
    _refuse_apart("woehler_exponent", k, follows, where)


def _refuse_apart(name: str, value: float, follows: float, where: str) -> None:
    if not abs(value - follows) <= AGREE * abs(value):
        allowed = f"{follows:.4g}, which follows from the other values given"
        raise InputError(
            f"{where}.{name}", value, allowed, "Leave one of the values out, or correct it."
        )


def _derived(value: float, source: Value, note: str) -> Value:
    return Value(
        value, "-", source.source, source.placeholder, note, source.origin, mark=source.mark
    )
