"""Cases as arrays: what the solver works on."""

from __future__ import annotations

import json
from dataclasses import dataclass, fields, make_dataclass
from typing import Any

import numpy as np

from trackroller.damage.wear import table_of_laws
from trackroller.materials import Material
from trackroller.materials.properties import PROPERTIES
from trackroller.numerics.rows import Rows, distinct
from trackroller.parameters import MAPPING_FIELDS, PARAMETERS

OPTIONAL_VALUES = tuple(name for name, value in PROPERTIES.items() if value.allow_missing)
_OptionalValues = make_dataclass(
    "_OptionalValues", [(name, np.ndarray) for name in OPTIONAL_VALUES], bases=(Rows,), frozen=True
)
_Fields: Any = make_dataclass(
    "_Fields",
    [(name, np.ndarray) for name in (*PARAMETERS, *MAPPING_FIELDS)],
    bases=(Rows,),
    frozen=True,
)


# columns of `MaterialArrays` that hold no numbers
TEXTS = ("name", "guesses", "ends", "temperature_dependence", "sn_points", "energy_wear")


@dataclass(frozen=True)
class MaterialArrays(_OptionalValues):  # type: ignore[misc, valid-type]
    """Values of one body's material, arrays of shape (n,): name, E [MPa], nu [1], R_m, sigma_D
    [MPa], N_Rm, N_k [1].

    The base class adds the optional values of a material, NaN where they are not given. `guesses`
    holds the values of limits that are placeholders, a mapping of names to `Value` for each
    material, and `ends` the ends of their ranges over the values. `temperature_dependence` holds
    the tables over temperature as JSON, "" for none, `sn_points` the points of S-N curves and
    `energy_wear` the tables of the energy law likewise.
    """

    name: np.ndarray
    youngs_modulus: np.ndarray
    poisson_ratio: np.ndarray
    tensile_strength: np.ndarray
    fatigue_limit: np.ndarray
    cycles_at_tensile_strength: np.ndarray
    cycles_at_fatigue_limit: np.ndarray
    guesses: np.ndarray
    ends: np.ndarray
    temperature_dependence: np.ndarray
    sn_points: np.ndarray
    energy_wear: np.ndarray

    @classmethod
    def of(cls, materials: list[Material]) -> MaterialArrays:
        """Return the arrays of a list of n materials; the same few objects fill a list of
        millions.
        """
        different, index = distinct(materials)

        def values(attribute: str) -> np.ndarray:
            return np.array([getattr(m, attribute) for m in different], dtype=float)[index]

        lines = [""] * len(different)
        tables = [""] * len(different)
        laws = [""] * len(different)
        for i, material in enumerate(different):
            if material.sn_points:
                lines[i] = json.dumps(material.sn_points)
            if material.temperature_dependence is not None:
                tables[i] = material.temperature_dependence.text
            if material.energy_wear is not None:
                laws[i] = material.energy_wear.text

        return cls(
            name=np.array([m.name for m in different], dtype=object)[index],
            guesses=np.array([m.guesses_of_limits for m in different], dtype=object)[index],
            ends=np.array([m.ends_of_limits for m in different], dtype=object)[index],
            temperature_dependence=np.array(tables, dtype=object)[index],
            sn_points=np.array(lines, dtype=object)[index],
            energy_wear=np.array(laws, dtype=object)[index],
            **{f.name: values(f.name) for f in fields(cls) if f.name not in TEXTS},
        )


@dataclass(frozen=True)
class CaseTable(_Fields):
    """Checked cases as arrays of shape (n,), with the units of `PARAMETERS` and the friction
    coefficient resolved.

    The base class has an array for each of `PARAMETERS` and `MAPPING_FIELDS`. The mappings of a
    case (friction law, drawn profiles) stand as canonical JSON in arrays of str objects, "" for
    none.
    """

    roller: MaterialArrays
    guide: MaterialArrays

    def __len__(self) -> int:
        return len(self.axis_distance)

    @property
    def loss_tables(self) -> np.ndarray:
        """Return the table of the energy law of each case as JSON, (n,): its own `wear_table`, or
        that of its materials if both have one; "" for none.
        """
        rollers = self.roller.energy_wear
        guides = self.guide.energy_wear
        tables = self.wear_table
        open_rows = (tables == "") & (rollers != "") & (guides != "")
        if not open_rows.any():
            return tables
        tables = tables.copy()
        for roller, guide in set(zip(rollers[open_rows], guides[open_rows], strict=True)):
            here = open_rows & (rollers == roller) & (guides == guide)
            tables[here] = table_of_laws(roller, guide)
        return tables
