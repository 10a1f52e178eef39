"""Loss of mass of a material over frictional work, the energy law of wear, as a table with a
source.
"""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from trackroller.errors import InputError, check_names
from trackroller.materials.properties import check_number
from trackroller.parameters import Parameter

FIELD = "energy_wear"
LISTS = {
    "work_rate": Parameter(
        "work_rate", "", "N/mm2", math.nan, "frictional work per area and distance", 0.0
    ),
    "loss": Parameter("loss", "", "ug/(m mm2)", math.nan, "loss of mass there", 0.0),
}


@dataclass(frozen=True)
class EnergyWear:
    """Loss of mass of a material over frictional work, linear between the points.

    Parameters
    ----------
    work_rate : tuple of float
        Rising frictional work per area and distance, T gamma/A [N/mm2].
    loss : tuple of float
        Loss of mass there [ug/(m mm2)].
    source, note : str
        Where the table comes from, and what else there is to say.
    placeholder : bool
        Whether the table was measured on another material or is a guess.

    Examples
    --------
    >>> EnergyWear((0.0, 10.4), (0.0, 55.0)).text
    '{"loss": [0.0, 55.0], "work_rate": [0.0, 10.4]}'
    """

    work_rate: tuple[float, ...]
    loss: tuple[float, ...]
    source: str = "not given"
    placeholder: bool = False
    note: str = ""

    @property
    def text(self) -> str:
        """Return the numbers of the table as JSON."""
        numbers = {name: getattr(self, name) for name in LISTS}
        return json.dumps(numbers, sort_keys=True)

    def as_dict(self) -> dict[str, Any]:
        """Return the table as a material file holds it."""
        return {key: value for key, value in asdict(self).items() if value or key == "placeholder"}


def read_energy_wear(given: Any, where: str) -> EnergyWear:
    """Return the checked table of a material.

    Parameters
    ----------
    given : EnergyWear or mapping
        The lists `work_rate` and `loss`, with source, placeholder and note. A number may have a
        unit of its own.
    where : str
        Place of the material, for messages.

    Raises
    ------
    InputError
        If the lists differ in length, the work rates do not rise, or a number is wrong.
    """
    field = f"{where}.{FIELD}"
    if isinstance(given, EnergyWear):
        given = given.as_dict()
    if not isinstance(given, Mapping):
        raise InputError(field, given, f"a mapping with the lists {', '.join(LISTS)}")
    check_names(f"{field}: key", given, (*LISTS, "source", "placeholder", "note"))
    numbers = {name: _numbers(name, given.get(name), field) for name in LISTS}
    if len(numbers["loss"]) != len(numbers["work_rate"]):
        allowed = f"one value for each of the {len(numbers['work_rate'])} work rates"
        raise InputError(f"{field}.loss", given["loss"], allowed)
    rates = numbers["work_rate"]
    if not all(low < high for low, high in itertools.pairwise(rates)):
        raise InputError(
            f"{field}.work_rate", given["work_rate"], "work rates that rise", "Sort the rows."
        )
    placeholder = given.get("placeholder", False)
    if not isinstance(placeholder, bool):
        raise InputError(f"{field}.placeholder", placeholder, "true or false")
    texts = {key: str(given[key]) for key in ("source", "note") if given.get(key)}
    fields: dict[str, Any] = {**numbers, **texts, "placeholder": placeholder}
    return EnergyWear(**fields)


def _numbers(name: str, given: Any, field: str) -> tuple[float, ...]:
    """Return a column of the table."""
    if not isinstance(given, (list, tuple)) or len(given) < 2:
        allowed = f"a list of at least two numbers [{LISTS[name].unit}]"
        raise InputError(f"{field}.{name}", given, allowed)
    return tuple(check_number(LISTS[name], value, field) for value in given)
