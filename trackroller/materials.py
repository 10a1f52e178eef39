"""Materials and friction coefficients: what a body is made of, and the database of them.

`load_database()` reads the built-in file and, over it, the user's own (see `load_database` for where it is
looked for). Every value carries its unit, its source and a `placeholder` mark for a guess without a source.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from trackroller.errors import InputError, nearest, unknown_name
from trackroller.material_properties import PROPERTIES, REQUIRED, FrictionValue, Value, check_number
from trackroller.parameters import FRICTION_LEVELS


@dataclass(frozen=True)
class Material:
    """A material with the Woehler line through (N_Rm, R_m) and (N_k, sigma_D).

    Parameters
    ----------
    name : what the user calls it
    youngs_modulus : E [MPa], > 0
    poisson_ratio : nu [-], 0 to 0.5
    tensile_strength : R_m [MPa]
    fatigue_strength_ratio : sigma_D/R_m [-], between 0 and 1
    cycles_at_tensile_strength, cycles_at_fatigue_limit : N_Rm < N_k [-]
    family : group the friction table speaks of ('metal', 'PA6', 'POM' or the user's own; '' unknown)
    scatter_in_cycles : T_N = N_90/N_10 [-], failure probabilities in percent; None: not known
    scatter_in_stress : T_S = S_90/S_10 [-]; None: not known
    description : a few words
    records : unit, source and mark of each value, as far as known

    Raises `InputError` naming material, field, value and what to do.
    """

    name: str
    youngs_modulus: float
    poisson_ratio: float
    tensile_strength: float
    fatigue_strength_ratio: float
    cycles_at_tensile_strength: float
    cycles_at_fatigue_limit: float
    family: str = ""
    scatter_in_cycles: float | None = None
    scatter_in_stress: float | None = None
    description: str = ""
    records: Mapping[str, Value] = field(default_factory=dict, compare=False, repr=False, hash=False)

    def __post_init__(self) -> None:
        where = f"material '{self.name}'"
        for prop in PROPERTIES.values():
            value = getattr(self, prop.name)
            if value is None and prop.optional:
                continue
            object.__setattr__(self, prop.name, check_number(prop, value, where))
        if not self.cycles_at_tensile_strength < self.cycles_at_fatigue_limit:
            raise InputError(f"{where}.cycles_at_tensile_strength", self.cycles_at_tensile_strength,
                             f"N_Rm must lie below N_k = {self.cycles_at_fatigue_limit:g}",
                             "Give the lower number of cycles to the tensile strength.")  # fmt: skip

    @property
    def fatigue_limit(self) -> float:
        """Fatigue limit sigma_D [MPa] at N_k cycles."""
        return self.fatigue_strength_ratio * self.tensile_strength

    @property
    def shear_modulus(self) -> float:
        """G = E / (2 (1 + nu)) [MPa]."""
        return self.youngs_modulus / (2.0 * (1.0 + self.poisson_ratio))

    @property
    def placeholders(self) -> tuple[str, ...]:
        """Names of the values that are guesses without a source."""
        return tuple(name for name, record in self.records.items() if record.placeholder)

    def as_dict(self) -> dict[str, Any]:
        """Plain numbers and texts; usable as an inline material."""
        values = {f.name: getattr(self, f.name) for f in dataclasses.fields(self) if f.name != "records"}
        return {key: value for key, value in values.items() if value not in (None, "")}


@dataclass(frozen=True)
class MaterialDatabase:
    """Materials by name and friction coefficients by pair; made by `load_database`.

    `files` are the files it was read from, built-in first.
    """

    materials: Mapping[str, Material]
    friction_table: Mapping[frozenset[str], Mapping[str, FrictionValue]]
    files: tuple[str, ...] = ()

    def names(self) -> tuple[str, ...]:
        """Names of all materials."""
        return tuple(self.materials)

    def __iter__(self) -> Iterator[str]:
        return iter(self.materials)

    def __contains__(self, name: object) -> bool:
        return name in self.materials

    def families(self) -> tuple[str, ...]:
        """Families of the materials and of the friction table, sorted."""
        known = {m.family for m in self.materials.values() if m.family}
        return tuple(sorted(known | {part for pair in self.friction_table for part in pair}))

    def material(self, material: str | Mapping[str, Any] | Material) -> Material:
        """The material of that name, or the inline material of a mapping.

        A mapping has the fields of `Material`; `like: NAME` takes what is not given from another material.
        Raises `InputError` for an unknown name, a missing or an impossible value.
        """
        if isinstance(material, Material):
            return material
        if isinstance(material, Mapping):
            from trackroller.materials_file import inline_material

            return inline_material(material, self.materials)
        if not isinstance(material, str):
            raise InputError("material", material, "a name of the database or a mapping with its values",
                             "Put a name that looks like a number in quotes.")  # fmt: skip
        if material not in self.materials:
            raise unknown_name("material", material, self.materials)
        return self.materials[material]

    def friction(self, first: str | Material, second: str | Material, level: str = "typical") -> FrictionValue:
        """Friction coefficient of a pair, given by materials, material names or families, in either order.

        A pair that names a material stands over the pair of the families.

        Parameters
        ----------
        first, second : the two bodies
        level : 'typical', 'upper' or 'lower'

        Returns
        -------
        FrictionValue with value [-], source and placeholder mark.

        Raises `InputError` for an unknown pair or level, saying how to give the coefficient.
        """
        if level not in FRICTION_LEVELS:
            raise unknown_name("friction level", level, FRICTION_LEVELS)
        names = [self._names_of(body) for body in (first, second)]
        for a in names[0]:
            for b in names[1]:
                levels = self.friction_table.get(frozenset((a, b)), {})
                if level in levels:
                    return levels[level]
        raise self._unknown_pair(names, level)

    def _names_of(self, body: str | Material) -> tuple[str, ...]:
        """Keys of a body for the friction table: its own name before its family."""
        if isinstance(body, Mapping):
            body = self.material(body)
        if isinstance(body, str) and body in self.materials:
            body = self.materials[body]
        if isinstance(body, Material):
            return (body.name, body.family) if body.family else (body.name,)
        match = {family.lower(): family for family in self.families()}.get(body.lower())
        if match is None:
            raise unknown_name("material or family", body, dict.fromkeys((*self.materials, *self.families())))
        return (match,)

    def _unknown_pair(self, names: list[tuple[str, ...]], level: str) -> InputError:
        label = tuple(body[-1] for body in names)
        known = ", ".join("-".join(sorted(p) if len(p) == 2 else [*p, *p]) for p in self.friction_table)
        remedy = ("Give friction_coefficient in the case, add the pair under `friction:` of your materials"
                  " file, or give the material a `family` that has one.")  # fmt: skip
        for body in names:
            if body[-1] not in self.families() and (close := nearest(body[-1], self.families())):
                remedy += f" Did you mean the family '{close}'?"
        allowed = f"the friction table has no {level} value for it; it has the pairs {known}"
        return InputError("friction_coefficient of the pair", "-".join(label), allowed, remedy)


def load_database(user_file: Path | str | None = None) -> MaterialDatabase:
    """The built-in database with the user's own file over it.

    The user's file is `user_file`, else the file the environment variable TRACKROLLER_MATERIALS names, else
    `config/materials.yaml` of the working directory if it is there. It may add materials, change single
    values of built-in ones and add friction pairs. Files are read again only when they have changed.

    Raises `InputError` naming file, material, field and value.
    """
    from trackroller.materials_file import find_user_file, read_database

    return read_database(find_user_file(user_file))


def builtin_database() -> MaterialDatabase:
    """The built-in database alone, whatever files the user has."""
    from trackroller.materials_file import read_database

    return read_database(None)


def add_material(path: Path | str, name: str, *, replace: bool = False, **values: Any) -> Material:
    """Write a material into the user's file; see `trackroller.materials_edit.add_material`."""
    from trackroller.materials_edit import add_material as add

    return add(path, name, replace=replace, **values)


def material_rows(database: MaterialDatabase) -> list[dict[str, str]]:
    """One row a material for a list: name, family, its values as texts, number of placeholders, origin."""
    rows = []
    for material in database.materials.values():
        row = {"name": material.name, "family": material.family or "-"}
        for name in REQUIRED:
            prop = PROPERTIES[name]
            heading = prop.symbol if prop.unit == "-" else f"{prop.symbol} [{prop.unit}]"
            row[heading] = f"{getattr(material, name):g}"
        row["placeholders"] = str(len(material.placeholders))
        row["origin"] = ", ".join(dict.fromkeys(r.origin for r in material.records.values())) or "inline"
        row["description"] = material.description
        rows.append(row)
    return rows


def material_details(database: MaterialDatabase, name: str) -> list[dict[str, str]]:
    """One row a value of a material: field, symbol, value, unit, source, mark, note, origin."""
    material = database.material(name)
    rows = []
    for prop in PROPERTIES.values():
        value = getattr(material, prop.name)
        if value is None:
            continue
        record = material.records.get(prop.name, Value(value, prop.unit, "not given"))
        rows.append(_row(prop.name, prop.symbol, record))
    derived = Value(material.fatigue_limit, "MPa", "R_m times sigma_D/R_m", origin="derived")
    return [*rows, _row("fatigue_limit", "sigma_D", derived)]


def friction_rows(database: MaterialDatabase) -> list[dict[str, str]]:
    """One row a pair and level of the friction table."""
    rows = []
    for pair, levels in database.friction_table.items():
        names = sorted(pair) if len(pair) == 2 else [*pair, *pair]
        for level, record in levels.items():
            head = {"pair": " - ".join(names), "level": level}
            rows.append(head | _row("friction_coefficient", "mu", record))
    return rows


def _row(name: str, symbol: str, record: Value) -> dict[str, str]:
    return {
        "field": name, "symbol": symbol, "value": f"{record.value:g}", "unit": record.unit,
        "source": record.source, "placeholder": "placeholder" if record.placeholder else "",
        "note": record.note, "origin": record.origin,
    }  # fmt: skip
