"""Complete an S-N curve (Wöhler line) from any sufficient combination of its values.

The curve runs through (N_Rm, R_m) and (N_k, sigma_D) with the exponent k::

    N_k / N_Rm = (R_m / sigma_D)**k

Data sheets give some of sigma_D or sigma_D/R_m, N_k, N_Rm and k. A material needs sigma_D/R_m, N_Rm and N_k.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from trackroller.damage.sn_curve import curve_exponent
from trackroller.errors import InputError
from trackroller.materials.properties import ALTERNATIVES, PROPERTIES, Value

CURVE = ("fatigue_strength_ratio", "cycles_at_tensile_strength", "cycles_at_fatigue_limit", "woehler_exponent")
AGREE = 0.01  # largest relative difference between a given value and the value that follows from the others
_ALL = PROPERTIES | ALTERNATIVES


def complete_curve(given: Mapping[str, Value], inherited: Mapping[str, Value], where: str) -> dict[str, Value]:
    """Return the values of the S-N curve that follow from those given.

    Parameters
    ----------
    given : mapping of str to Value
        Values of an entry, `fatigue_limit` and `woehler_exponent` among them.
    inherited : mapping of str to Value
        Values of the material that the entry changes or names by `like`. They are used for values that are not given
        and do not follow from given values.
    where : str
        Place of the entry, for messages.

    Returns
    -------
    dict of str to Value
        `fatigue_strength_ratio`, `cycles_at_tensile_strength` and `cycles_at_fatigue_limit`, as far as known.

    Raises
    ------
    InputError
        If values contradict each other by more than 1 %.

    Notes
    -----
    A given value replaces an inherited one. Where three of the four values of the curve are given or
    inherited, the fourth follows; an exponent that is given replaces the inherited `cycles_at_tensile_strength` first.

    Examples
    --------
    sigma_D = 30 MPa at 1e7 cycles with k = 8 and R_m = 60 MPa gives N_Rm = 1e7 / 2**8 = 39,062 cycles.
    """
    known = {name: given[name] for name in CURVE if name in given}
    _take_limit(known, given, inherited, where)
    if len(known) == len(CURVE):
        _check(known, where)
    elif "woehler_exponent" in known:
        for name in ("cycles_at_fatigue_limit", "fatigue_strength_ratio", "cycles_at_tensile_strength"):
            if len(known) < len(CURVE) - 1 and name not in known and name in inherited:
                known[name] = inherited[name]
        if len(known) == len(CURVE) - 1:
            _solve(known, where)
    known.pop("woehler_exponent", None)
    return {name: inherited[name] for name in CURVE if name in inherited} | known


def _take_limit(known: dict[str, Value], given: Mapping, inherited: Mapping, where: str) -> None:
    """Turn a fatigue limit in MPa into its ratio to the tensile strength."""
    limit, strength = given.get("fatigue_limit"), given.get("tensile_strength", inherited.get("tensile_strength"))
    if limit is None or strength is None:
        return
    ratio = limit.value / strength.value
    if "fatigue_strength_ratio" in known:
        _refuse_apart("fatigue_limit", limit.value, known["fatigue_strength_ratio"].value * strength.value, where)
    elif not ratio < 1.0:
        allowed = f"a fatigue limit below the tensile strength R_m = {strength.value:g} MPa"
        raise InputError(f"{where}.fatigue_limit", limit.value, allowed, "Correct one of the two values.")
    else:
        known["fatigue_strength_ratio"] = _derived(ratio, limit, f"sigma_D = {limit.value:g} MPa over R_m")


def _solve(known: dict[str, Value], where: str) -> None:
    """Add the one value of the curve that is missing."""
    missing = next(name for name in CURVE if name not in known)
    ratio, low, high, k = (known[name].value if name in known else math.nan for name in CURVE)
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
        raise InputError(f"{where}.woehler_exponent", k, allowed, "Correct the exponent or the cycles.")
    known[missing] = _derived(value, known["woehler_exponent"], f"from the exponent k = {k:g}")


def _check(known: Mapping[str, Value], where: str) -> None:
    ratio, low, high, k = (known[name].value for name in CURVE)
    follows = float(curve_exponent(high / low, 1.0 / ratio)) if low < high else math.nan
    _refuse_apart("woehler_exponent", k, follows, where)


def _refuse_apart(name: str, value: float, follows: float, where: str) -> None:
    if not abs(value - follows) <= AGREE * abs(value):
        allowed = f"{follows:.4g}, which follows from the other values given"
        raise InputError(f"{where}.{name}", value, allowed, "Leave one of the values out, or correct it.")


def _derived(value: float, source: Value, note: str) -> Value:
    return Value(value, "-", source.source, source.placeholder, note, source.origin)
