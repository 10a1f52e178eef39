"""Convert a quantity that a user wrote with its unit, such as '70 GPa', to the unit of a parameter,
with pint.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Mapping
from typing import Any

from trackroller.environment import take_in
from trackroller.errors import InputError

_NUMBER = r"[-+]?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|\.?inf)"
_FACTOR = r"[A-Za-z°µμ%]{1,20}(?:\^?-?\d|[²³])?"
# no powers of numbers, which could fill the memory
_UNIT = rf"(?:1/)?{_FACTOR}(?:[ *·/()]{{1,3}}{_FACTOR}){{0,5}}\)?"
_QUANTITY = re.compile(rf"\s*({_NUMBER})\s*(?![eE][-+]?\d)({_UNIT})\s*", re.ASCII)

PLAIN = ("-", "1", "")  # ways to write that a number has no unit
_COMPARED = re.compile(
    rf"([A-Za-z_]\w*)(\s*[<>=!]=?\s*)({_NUMBER})\s*(?![eE][-+]?\d)({_UNIT})(?=\s*(?:\)|\bor\b|\band\b|$))",
    re.ASCII,
)


def split_quantity(value: Any) -> tuple[str, str] | None:
    """Return the number and the unit of a text such as '70 GPa', or None for anything else."""
    # 10/min
    value = (
        re.sub(rf"^(\s*{_NUMBER})\s*/", r"\1 1/", value, flags=re.ASCII)
        if isinstance(value, str)
        else ""
    )
    parts = _QUANTITY.fullmatch(value)
    return (parts[1], parts[2]) if parts else None


def stated_unit(attributes: Mapping[Any, Any]) -> str:
    """Return the unit that attributes of an array state as `units` or `unit`, in any case; '' for
    none.
    """
    stated = {str(key).lower(): str(value).strip() for key, value in attributes.items()}
    unit = stated.get("units") or stated.get("unit", "")
    return "" if unit in PLAIN else unit


def without_units(text: str, unit_of: Callable[[str], str | None], field: str) -> str:
    """Return comparisons of names with quantities as comparisons with numbers in the units of the
    names.

    Parameters
    ----------
    text : str
        Such as 'max_pressure < 1.5 GPa or slip > 5 %'; other parts of the text stay as they are.
    unit_of : callable
        Returns the unit of a name, None for an unknown name.
    field : str
        Name of the field, for messages.

    Raises
    ------
    InputError
        If a unit is unknown or measures something else than the name.

    Examples
    --------
    >>> without_units("max_pressure < 1.5 GPa", {"max_pressure": "MPa"}.get, "constraints")
    'max_pressure < 1500'
    """

    def plain(comparison: re.Match[str]) -> str:
        name, sign, number, unit = comparison.groups()
        # the bracket is one of the comparison, not of the unit
        closes = unit.endswith(")") and "(" not in unit
        end = ")" if closes else ""
        unit = unit.removesuffix(end)
        target = unit_of(name)
        if target is None:  # whoever reads the text refuses the name
            return f"{name}{sign}{number}{end}"
        check_hours(f"{number} {unit}", unit, target, field)
        return f"{name}{sign}{in_unit(float(number), unit, target, field):.15g}{end}"

    if isinstance(text, str):
        return _COMPARED.sub(plain, text)
    return text


def check_hours(given: Any, unit: str, target: str, field: str) -> None:
    """Refuse hours of travel that are given in another unit of time: a year of a duty has fewer of
    them than a year.
    """
    if target == "h" and unit.strip() not in ("h", "hour", "hours", ""):
        raise InputError(
            field, given, "hours of travel, h", "Multiply years by the hours of a year of the duty."
        )


def in_unit(number: float, unit: str, target: str, field: str, difference: bool = False) -> float:
    """Return a number in another unit.

    Parameters
    ----------
    number : float
        The number in `unit`.
    unit, wanted : str
        The two units as a user writes them, such as 'N/mm2', 'kN*mm' or 'deg'; '-' and '' for none.
    field : str
        Name of the field, for messages.
    difference : bool
        Whether the number is the difference of two values, such as a standard deviation; it matters
        to temperatures.

    Returns
    -------
    float
        The number in `wanted`, with 15 significant digits, so that 70 GPa equals 70000 MPa.

    Raises
    ------
    InputError
        If the unit is unknown or measures something else.
    """
    if unit == target:
        return number
    factor, offset = _factor_and_offset(unit, target, field)
    if difference:
        offset = 0.0
    return float(f"{number * factor + offset:.15g}")


@functools.cache
def _registry() -> Any:
    take_in("pint")
    import pint  # noqa: PLC0415 - takes half a second, and only a quantity in another unit needs it

    registry: Any = pint.UnitRegistry(cache_folder=None)
    registry.define("HB = [brinell_hardness]")
    registry.define("HBW = HB")  # by a ball of hard metal, as all tests today
    registry.define("Msi = 1e6 * psi")
    registry.define("kp = kgf")
    return registry


@functools.lru_cache(maxsize=256)
def _factor_and_offset(unit: str, target: str, field: str) -> tuple[float, float]:
    if target in PLAIN:
        target = ""
    remedy = "Write a number without unit."
    if target:
        remedy = f"Write a number in {target}, or with a unit such as '5 {target}'."
    try:
        if not re.fullmatch(_UNIT, unit.strip(), re.ASCII):
            raise ValueError(unit)
        spelt = _spelt(unit)
        if (
            spelt == "g"
            and _registry().Unit(_spelt(target)).dimensionality
            == _registry().Unit("m/s^2").dimensionality
        ):
            spelt = "standard_gravity"  # of an acceleration; a mass keeps its gram
        zero, one = (_registry().Quantity(number, spelt) for number in (0.0, 1.0))
        # a column of a user's own may have a unit nobody knows
        unit_of_target = _registry().Unit(_spelt(target))
    except Exception:  # pint's parser raises a dozen kinds, also AssertionError
        raise InputError(field, unit, "a unit that is known", remedy) from None
    # radians are no dimension to pint, but an angle is no friction coefficient and 600 rpm are not
    # 600/min
    if one.to_base_units().units != _registry().Quantity(1.0, unit_of_target).to_base_units().units:
        kind = "no unit, because the value is a plain number"
        if target:
            kind = f"a unit that can be converted to {target}"
        raise InputError(field, unit, kind, remedy)
    offset = zero.to(unit_of_target).magnitude
    return one.to(unit_of_target).magnitude - offset, offset


def _spelt(unit: str) -> str:
    """Return a unit as pint reads it: 'N/mm2' as 'N/mm^2', 'Nmm' as 'N*mm'."""
    if unit in PLAIN:
        return ""
    unit = re.sub(r"(?<=[A-Za-z])(-?\d)", r"^\1", unit.replace("·", "*"))
    return re.sub(r"\b([kM]?)N(mm|cm|m)\b", r"\1N*\2", unit)
