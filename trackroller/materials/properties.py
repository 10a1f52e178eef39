"""The numbers of a material: symbol, unit, meaning and physical bounds, and a value with its source."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from trackroller.errors import InputError
from trackroller.numerics.numbers import read_number


@dataclass(frozen=True)
class Property:
    """A number of a material: symbol, unit, factors to it from other units, physical bounds."""

    name: str
    symbol: str
    unit: str
    meaning: str
    lower: float
    upper: float
    closed: bool = False
    optional: bool = False

    def allowed(self) -> str:
        """What is accepted, in words."""
        low, high = ("<=", "<=") if self.closed else ("<", "<")
        top = f" {high} {self.upper:g}" if math.isfinite(self.upper) else ""
        unit = "" if self.unit == "-" else f" {self.unit}"
        return f"{self.meaning} must be a finite number with {self.lower:g} {low} {self.symbol}{top}{unit}"

    def accepts(self, value: float) -> bool:
        """Is the value physically possible?"""
        if not math.isfinite(value):
            return False
        if self.closed:
            return self.lower <= value <= self.upper
        return self.lower < value < self.upper


# The upper bounds of E and R_m lie above every solid: they catch a value given in Pa.
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
# Other ways to give the S-N curve; they are turned into the properties above (see `trackroller.materials.sn_curve`).
_ALTERNATIVES = (
    Property("fatigue_limit", "sigma_D", "MPa", "fatigue limit", 0.0, 2e5),
    Property("woehler_exponent", "k", "-", "exponent of the S-N curve", 0.0, 1e3),
)
ALTERNATIVES: dict[str, Property] = {p.name: p for p in _ALTERNATIVES}
REQUIRED = tuple(p.name for p in _PROPERTIES if not p.optional)


@dataclass(frozen=True)
class Value:
    """A number with its unit, source, `placeholder` mark, remark, and the file it comes from."""

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
    """The value as a float inside its bounds; raises `InputError` naming `where` it stands."""
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
