"""Young's modulus and tensile strength of a material over temperature, as a table that its user gives."""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from trackroller.errors import InputError, check_names
from trackroller.materials.properties import PROPERTIES, check_number
from trackroller.parameters import Parameter

FIELD = "temperature_dependence"
TABLED = ("youngs_modulus", "tensile_strength")
FOLLOW_STRENGTH = ("fatigue_limit_torsion", "yield_strength", "hardness")  # keep their ratio to R_m
_TEMPERATURE = Parameter("temperature", "theta", "degC", 20.0, "temperature", -273.15, 4e3)


@dataclass(frozen=True)
class TemperatureTable:
    """Values of a material over its temperature, linear between the rows and constant beyond the ends.

    Parameters
    ----------
    temperature : tuple of float
        Rising temperatures [degC].
    youngs_modulus, tensile_strength : tuple of float
        E and R_m [MPa] at these temperatures; empty for a value that does not depend on temperature.
    source, note : str
        Where the table comes from, and what else there is to say.
    placeholder : bool
        Whether the table is a guess without a source.

    Examples
    --------
    >>> table = TemperatureTable((20.0, 60.0), youngs_modulus=(3000.0, 2000.0))
    >>> table.at("youngs_modulus", np.array([0.0, 30.0, 80.0])).tolist()
    [3000.0, 2750.0, 2000.0]
    """

    temperature: tuple[float, ...]
    youngs_modulus: tuple[float, ...] = ()
    tensile_strength: tuple[float, ...] = ()
    source: str = "not given"
    placeholder: bool = False
    note: str = ""

    @property
    def columns(self) -> dict[str, tuple[float, ...]]:
        """Return the values that the table holds, by name."""
        return {name: getattr(self, name) for name in TABLED if getattr(self, name)}

    @property
    def text(self) -> str:
        """Return the numbers of the table as JSON, which `json.loads` turns into arguments of this class."""
        return json.dumps({"temperature": self.temperature} | self.columns)

    def at(self, name: str, temperature: np.ndarray) -> np.ndarray:
        """Return the value `name` [MPa] at temperatures [degC] of any shape."""
        return np.interp(temperature, self.temperature, getattr(self, name))

    def without(self, names: Collection[str]) -> TemperatureTable | None:
        """Return the table without the columns `names`; None if no column is left."""
        dropped: dict[str, Any] = {name: () for name in self.columns if name in names}
        table = replace(self, **dropped)
        if not table.columns:
            return None
        return table

    def as_dict(self) -> dict[str, Any]:
        """Return the table as a material file holds it."""
        return {key: value for key, value in asdict(self).items() if value or key == "placeholder"}


def read_table(given: Any, values: Mapping[str, float], where: str) -> TemperatureTable:
    """Return the checked table of a material.

    Parameters
    ----------
    given : TemperatureTable or mapping
        The lists `temperature` and `youngs_modulus`, `tensile_strength` or both, with source, placeholder and note.
        A number may have a unit of its own, such as '3 GPa'.
    values : mapping of str to float
        E and R_m of the material [MPa], which hold without a known temperature and must lie within the table.
    where : str
        Place of the material, for messages.

    Raises
    ------
    InputError
        If the lists differ in length, the temperatures do not rise, or a number is wrong.
    """
    field = f"{where}.{FIELD}"
    if isinstance(given, TemperatureTable):
        given = given.as_dict()
    lists = ("temperature", *TABLED)
    if not isinstance(given, Mapping):
        raise InputError(field, given, f"a mapping with the lists {', '.join(lists)}")
    check_names(f"{field}: key", given, (*lists, "source", "placeholder", "note"))
    if "temperature" not in given or not any(name in given for name in TABLED):
        raise InputError(field, ", ".join(given) or "nothing", f"temperature and {' or '.join(TABLED)}")
    numbers = {name: _numbers(name, given[name], field, given["temperature"]) for name in lists if name in given}
    if not all(low < high for low, high in zip(numbers["temperature"], numbers["temperature"][1:], strict=False)):
        raise InputError(f"{field}.temperature", given["temperature"], "rising temperatures", "Sort the rows.")
    for name in TABLED:
        if name in numbers and not min(numbers[name]) <= values[name] <= max(numbers[name]):
            allowed = f"a table that holds the material's own value, {values[name]:g} MPa"
            raise InputError(f"{field}.{name}", given[name], allowed, f"Correct the table, or give {name} as well.")
    if not isinstance(given.get("placeholder", False), bool):
        raise InputError(f"{field}.placeholder", given["placeholder"], "true or false")
    texts = {key: str(given[key]) for key in ("source", "note") if given.get(key)}
    fields: dict[str, Any] = {**numbers, **texts, "placeholder": given.get("placeholder", False)}
    return TemperatureTable(**fields)


def _numbers(name: str, given: Any, field: str, temperatures: Any) -> tuple[float, ...]:
    """Return a column of a table, as long as the column of temperatures."""
    if not isinstance(given, (list, tuple)) or len(given) < 2:
        raise InputError(f"{field}.{name}", given, "a list of at least two numbers")
    if len(given) != len(temperatures):
        raise InputError(f"{field}.{name}", given, f"one value for each of the {len(temperatures)} temperatures")
    return tuple(check_number(PROPERTIES.get(name, _TEMPERATURE), value, field) for value in given)
