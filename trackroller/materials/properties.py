"""Declare the numbers of a material: symbol, unit, meaning and physical bounds."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from trackroller.errors import InputError
from trackroller.numerics.numbers import read_number


@dataclass(frozen=True)
class Property:
    """One number of a material.

    Parameters
    ----------
    name, symbol, unit, meaning : str
        Name of the field, its symbol, its unit ("-" for 1), and its meaning in words.
    lower, upper : float
        Physical bounds in this unit.
    closed : bool
        True if the bounds themselves are allowed.
    optional : bool
        True if a material may leave the number out.
    """

    name: str
    symbol: str
    unit: str
    meaning: str
    lower: float
    upper: float
    closed: bool = False
    optional: bool = False

    def allowed(self) -> str:
        """Return a sentence that says which values are allowed."""
        low, high = ("<=", "<=") if self.closed else ("<", "<")
        top = f" {high} {self.upper:g}" if math.isfinite(self.upper) else ""
        unit = "" if self.unit == "-" else f" {self.unit}"
        return f"{self.meaning} must be a finite number with {self.lower:g} {low} {self.symbol}{top}{unit}"

    def accepts(self, value: float) -> bool:
        """Return True if a value is physically possible."""
        if not math.isfinite(value):
            return False
        if self.closed:
            return self.lower <= value <= self.upper
        return self.lower < value < self.upper


# No solid reaches the upper bounds of E and R_m. They detect a value that was given in Pa.
_PROPERTIES = (
    Property("youngs_modulus", "E", "MPa", "Young's modulus", 0.0, 2e6),
    Property("poisson_ratio", "nu", "-", "Poisson's ratio", 0.0, 0.5, closed=True),
    Property("tensile_strength", "R_m", "MPa", "tensile strength", 0.0, 2e5),
    Property("fatigue_strength_ratio", "sigma_D/R_m", "-", "fatigue limit over tensile strength", 0.0, 1.0),
    Property("cycles_at_tensile_strength", "N_Rm", "-", "cycles at the tensile strength", 0.0, math.inf),
    Property("cycles_at_fatigue_limit", "N_k", "-", "cycles at the fatigue limit", 0.0, math.inf),
    Property("scatter_in_cycles", "T_N", "-", "scatter of life N_90/N_10", 1.0, 1e6, True, True),
    Property("scatter_in_stress", "T_S", "-", "scatter of strength S_90/S_10", 1.0, 1e3, True, True),
)
PROPERTIES: dict[str, Property] = {p.name: p for p in _PROPERTIES}
# Other ways to give the S-N curve; `trackroller.materials.sn_curve` turns them into the properties above.
_ALTERNATIVES = (
    Property("fatigue_limit", "sigma_D", "MPa", "fatigue limit", 0.0, 2e5),
    Property("woehler_exponent", "k", "-", "exponent of the S-N curve", 0.0, 1e3),
)
ALTERNATIVES: dict[str, Property] = {p.name: p for p in _ALTERNATIVES}
REQUIRED = tuple(p.name for p in _PROPERTIES if not p.optional)


@dataclass(frozen=True)
class Value:
    """A number with its unit, source, `placeholder` mark, note, and the file that defines it."""

    value: float
    unit: str
    source: str
    placeholder: bool = False
    note: str = ""
    origin: str = ""


@dataclass(frozen=True)
class FrictionValue(Value):
    """A Coulomb friction coefficient [-] with its source; `placeholder` marks a guess without a source."""


def check_number(prop: Property, value: Any, where: str) -> float:
    """Return a value as a float if it lies within its bounds.

    Parameters
    ----------
    prop : Property
        The bounds.
    value : Any
        The value as given.
    where : str
        Place of the value, for messages.

    Returns
    -------
    float
        The number.

    Raises
    ------
    InputError
        If the value is not a number or lies outside its bounds.
    """
    remedy = f"Give {prop.name} in {prop.unit}." if prop.unit != "-" else "Correct the value."
    if prop.name.startswith("scatter"):
        remedy = "Give the larger over the smaller value; 1 means no scatter."
    try:
        number = read_number(value)
    except ValueError:
        raise InputError(f"{where}.{prop.name}", value, prop.allowed(), remedy) from None
    if not prop.accepts(number):
        raise InputError(f"{where}.{prop.name}", value, prop.allowed(), remedy)
    return number
