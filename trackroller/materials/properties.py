"""Declare the numbers of a material: symbol, unit, meaning and physical bounds."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from trackroller.damage import with_limits
from trackroller.errors import InputError
from trackroller.numerics.numbers import number_or_nan
from trackroller.numerics.parameter import Parameter
from trackroller.numerics.units import in_unit
from trackroller.parameters import LIMITS  # with the limits of a user's own


def _number(
    name: str,
    symbol: str,
    unit: str,
    label: str,
    lower: float,
    upper: float,
    closed: bool = False,
    optional: bool = False,
) -> Parameter:
    """Return a number of a material; `closed` allows its bounds, `optional` lets a material leave
    it out.
    """
    return Parameter(
        name,
        symbol,
        unit,
        math.nan,
        label,
        lower,
        upper,
        open_lower=not closed,
        open_upper=not closed,
        allow_missing=optional,
        label=label,
    )


# No solid reaches the bounds of E and R_m. The upper ones detect a value that was given in Pa.
_PROPERTIES = (
    _number("youngs_modulus", "E", "MPa", "Young's modulus", 1e-6, 2e6),
    _number("poisson_ratio", "nu", "-", "Poisson's ratio", 0.0, 0.5, closed=True),
    _number("tensile_strength", "R_m", "MPa", "tensile strength", 1e-6, 2e5),
    _number(
        "fatigue_strength_ratio",
        "sigma_D/R_m",
        "-",
        "fatigue limit over tensile strength",
        0.0,
        1.0,
    ),
    _number(
        "cycles_at_tensile_strength", "N_Rm", "-", "cycles at the tensile strength", 0.0, math.inf
    ),
    _number("cycles_at_fatigue_limit", "N_k", "-", "cycles at the fatigue limit", 0.0, math.inf),
    _number(
        "second_exponent",
        "k_2",
        "-",
        "exponent of the S-N curve below sigma_D",
        0.0,
        1e3,
        optional=True,
    ),
    _number(
        "scatter_in_cycles", "T_N", "-", "scatter of the life T_N = N_90/N_10", 1.0, 1e6, True, True
    ),
    _number(
        "scatter_in_stress",
        "T_S",
        "-",
        "scatter of the strength T_S = S_90/S_10",
        1.0,
        1e3,
        True,
        True,
    ),
    _number(
        "sn_in_rolling",
        "-",
        "-",
        "1 if the S-N curve is of tests in rolling contact, 0 if it is of bending",
        0.0,
        1.0,
        True,
        True,
    ),
)
OF_LIMITS: dict[str, Parameter] = {
    own.name: own for limit in LIMITS.values() for own in limit.materials
}
PROPERTIES: dict[str, Parameter] = with_limits(
    {p.name: p for p in _PROPERTIES}, OF_LIMITS.values(), "a value of a material"
)
# Other ways to give the S-N curve; `trackroller.materials.sn_curve` turns them into the properties
# above.
_ALTERNATIVES = (
    _number("fatigue_limit", "sigma_D", "MPa", "fatigue limit", 0.0, 2e5),
    _number("woehler_exponent", "k", "-", "exponent of the S-N curve", 0.0, 1e3),
)
ALTERNATIVES: dict[str, Parameter] = {p.name: p for p in _ALTERNATIVES}
REQUIRED = tuple(p.name for p in _PROPERTIES if not p.allow_missing)


MARKS = {  # how a number was taken from its source, the best one first
    "table": "printed in the source",
    "formula": "computed by a formula of the source",
    "derived": "computed from other values, as the source says",
    "second hand": "from an abstract, a digest, or the table of another author",
    "guess": "no source",
}


@dataclass(frozen=True)
class Value:
    """A property or a friction coefficient: number, unit, source, note, and the file that defines
    it (`origin`).

    `placeholder` is True if the number is a guess without a source. `range` then holds the bounds
    between which the true number is expected, if they are given. `mark` is one of `MARKS` and says
    how the number was taken from its source; it is empty where a user's file does not say it.
    """

    value: float
    unit: str
    source: str
    placeholder: bool = False
    note: str = ""
    origin: str = ""
    range: tuple[float, float] | None = None
    mark: str = ""


def check_number(prop: Parameter, value: Any, where: str, unit: str = "") -> float:
    """Return a value in the unit of its property if it lies within the bounds.

    Parameters
    ----------
    prop : Parameter
        The bounds.
    value : Any
        The value as given.
    where : str
        Place of the value, for messages.
    unit : str
        Unit of the value, if it is not that of the property.

    Returns
    -------
    float
        The number.

    Raises
    ------
    InputError
        If the value is not a number or lies outside its bounds.
    """
    remedy = "Correct the value."
    if prop.unit != "-":
        remedy = f"Give {prop.name} in {prop.unit}."
    if (
        prop.name in ("woehler_exponent", "second_exponent")
        and isinstance(value, (int, float))
        and -1.0 < value < 0.0
    ):
        remedy = f"If Basquin's b is meant, the exponent is k = -1/b: write {-1.0 / value:.3g}."
    if prop.name in ("scatter_in_cycles", "scatter_in_stress"):
        remedy = "Give the larger over the smaller value; 1 means no scatter."
    field = f"{where}.{prop.name}"
    number = number_or_nan(value, prop.unit, field)
    number = in_unit(number, unit or prop.unit, prop.unit, f"{field}.unit")
    if math.isnan(number) or not prop.accepts(number):
        raise InputError(field, value, prop.allowed(), remedy)
    return number
