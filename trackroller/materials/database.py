"""Materials by name and friction coefficients by pair."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from trackroller.errors import InputError, nearest, unknown_name
from trackroller.materials.entries import inline_material
from trackroller.materials.material import Material
from trackroller.materials.properties import FrictionValue
from trackroller.parameters import FRICTION_LEVELS


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
            return inline_material(material, self.materials)
        if not isinstance(material, str):
            raise InputError(
                "material",
                material,
                "a name of the database or a mapping with its values",
                "Put a name that looks like a number in quotes.",
            )
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
        remedy = (
            "Give friction_coefficient in the case, add the pair under `friction:` of your materials"
            " file, or give the material a `family` that has one."
        )
        for body in names:
            if body[-1] not in self.families() and (close := nearest(body[-1], self.families())):
                remedy += f" Did you mean the family '{close}'?"
        allowed = f"the friction table has no {level} value for it; it has the pairs {known}"
        return InputError("friction_coefficient of the pair", "-".join(label), allowed, remedy)
