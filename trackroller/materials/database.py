"""Materials by name, and friction and wear coefficients by pair."""

from __future__ import annotations

import functools
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import product
from typing import Any

from trackroller.errors import InputError, nearest, unknown_name
from trackroller.materials.entries import Hardness, inline_material
from trackroller.materials.material import Material
from trackroller.materials.properties import Value
from trackroller.parameters import FRICTION_LEVELS

# attribute of a result: the coefficients that were taken from the database (JSON)
FRICTION = "friction"


def _letters(text: str) -> str:
    return re.sub(r"[^a-z0-9]", "", text.lower())


@dataclass(frozen=True)
class MaterialDatabase:
    """Materials by name and friction coefficients by pair; `load_database` makes it.

    Parameters
    ----------
    materials : mapping of str to Material
        Materials by name.
    friction_table : mapping of frozenset of str to mapping of str to Value
        Friction coefficients of each pair of names or families, by level.
    files : tuple of str
        Files from which the database was read, the built-in file first.
    wear_table : mapping of tuple of str to mapping of Hardness to Value
        Wear coefficients by the name or family of the body that wears, and by that of its partner;
        then by the range of hardness [HB] of the body that wears. None stands for a body whose
        hardness is not known or lies in no range.
    """

    materials: Mapping[str, Material]
    friction_table: Mapping[frozenset[str], Mapping[str, Value]]
    files: tuple[str, ...] = ()
    wear_table: Mapping[tuple[str, str], Mapping[Hardness | None, Value]] = field(
        default_factory=dict
    )

    def names(self) -> tuple[str, ...]:
        """Return the names of all materials."""
        return tuple(self.materials)

    def __iter__(self) -> Iterator[str]:
        return iter(self.materials)

    def __contains__(self, name: object) -> bool:
        return name in self.materials

    def families(self) -> tuple[str, ...]:
        """Return the families of the materials and of the friction table, sorted."""
        known = {m.family for m in self.materials.values() if m.family}
        return tuple(sorted(known | {part for pair in self.friction_table for part in pair}))

    def material(
        self, material: str | Mapping[str, Any] | Material, field: str = "material"
    ) -> Material:
        """Return the material of a name, or make a material from a mapping.

        Parameters
        ----------
        material : str, mapping or Material
            A name, or a mapping with the fields of `Material`. The entry `like: NAME` in a mapping
            takes missing values from another material. A `Material` is returned as it is.
        field : str
            Name of the field that holds the name, for messages.

        Returns
        -------
        Material
            The material.

        Raises
        ------
        InputError
            For an unknown name, with the materials that it describes; for a missing or an
            impossible value.
        """
        if isinstance(material, Material):
            return material
        if isinstance(material, Mapping):
            return inline_material(material, self.materials)
        if not isinstance(material, str):
            remedy = "Put a name that looks like a number in quotes."
            raise InputError(
                field, material, "a name of the database or a mapping with its values", remedy
            )
        if material in self.materials:
            return self.materials[material]
        akin = self.search(material)
        same = {_letters(name) for name in self.materials}
        if nearest(material, self.materials) is None or (
            len(akin) > 1 and _letters(material) not in same
        ):
            allowed = "the name of a material of the database"
            remedy = f"Write the name of the material that is meant: {' or '.join(akin)}."
            if not akin:
                allowed += ", as `trackroller materials list` shows"
                remedy = "Use one of these names, or enter the material in config/materials.yaml."
            raise InputError(field, material, allowed, remedy)
        raise unknown_name(field, material, self.materials)

    def search(self, text: str) -> tuple[str, ...]:
        """Return the names of the materials whose name, family or description holds every word of a
        text.

        Spaces, signs and upper or lower case do not count, so that '42CrMo4+QT' and 'en aw 7075'
        are found.
        """
        words = [_letters(word) for word in re.split(r"[\s+,]+", str(text)) if _letters(word)]
        texts = {
            name: _letters(f"{name} {m.family} {m.description}")
            for name, m in self.materials.items()
        }
        return tuple(
            name for name, own in texts.items() if words and all(word in own for word in words)
        )

    def friction(
        self, first: str | Material, second: str | Material, level: str = "typical"
    ) -> Value:
        """Return the friction coefficient of two bodies, in either order.

        Parameters
        ----------
        first, second : str or Material
            The two bodies: material, name of a material, or family.
        level : str
            "typical", "upper" or "lower"; "dry" or "lubricated" where tables state these.

        Returns
        -------
        Value
            Friction coefficient [1], its source and its placeholder mark. An entry for a material
            has priority over an entry for the material's family.

        Raises
        ------
        InputError
            For an unknown pair or level; the error says how to give the coefficient.
        """
        if level not in FRICTION_LEVELS:
            raise unknown_name("friction level", level, FRICTION_LEVELS)
        names = [self._names_of(body) for body in (first, second)]
        for pair in product(*names):
            levels = self.friction_table.get(frozenset(pair), {})
            if level in levels:
                return levels[level]
        raise self._unknown_pair(names, level)

    def on(self, body: str | Material, partner: str | Material) -> Material:
        """Return the material of a body with its wear coefficient on the material of its partner.

        A wear coefficient of the material itself has priority over that of the pair, and that of
        the hardness of the body over that of any hardness. Without all of them, the material has
        no wear coefficient.
        """
        own = self.material(body)
        other = self.material(partner)
        if own.wear_coefficient is not None:
            return own
        for pair in product(self._names_of(own), self._names_of(other)):
            known = _of_hardness(self.wear_table.get(pair, {}), own.hardness)
            if known is not None:
                return _worn(own, id(own.records), known, other.name)
        return own

    def friction_record(
        self, roller: str | Material, guide: str | Material, level: str | None
    ) -> dict[str, Any]:
        """Return the friction coefficient of a pair as a result records it: pair, level, value,
        source, mark and note.

        Without a level it is the typical coefficient. Where tests of the dry pair lie above the
        typical coefficient, `dry_tests` holds their range and the levels that say more.
        """
        level = level or "typical"
        friction = self.friction(roller, guide, level)
        pair = " / ".join(self.material(body).name for body in (roller, guide))
        values = {
            "value": friction.value,
            "source": friction.source,
            "placeholder": friction.placeholder,
        }
        note = {"note": friction.note} if friction.note else {}
        tests = {}
        if level == "typical":
            tests = self._dry_tests(roller, guide, friction.value)
        return {"material_pair": pair, "level": level, **values, **note, **tests}

    def _dry_tests(
        self, roller: str | Material, guide: str | Material, typical: float
    ) -> dict[str, Any]:
        """Return the range of the tests of a dry pair as `dry_tests`, if it lies above the typical
        coefficient; otherwise nothing.
        """
        names = [self._names_of(body) for body in (roller, guide)]
        levels: dict[str, Value] = {}
        for pair in product(*names):
            levels = {**self.friction_table.get(frozenset(pair), {}), **levels}
        dry = levels.get("dry")
        if dry is None or dry.range is None or typical >= dry.range[0]:
            return {}
        words = [name for name in ("dry", "lubricated") if name in levels]
        return {"dry_tests": {"range": list(dry.range), "words": words}}

    def _names_of(self, body: str | Material) -> tuple[str, ...]:
        """Return the keys of a body in the friction table: its name first, then its family."""
        if isinstance(body, Mapping):
            body = self.material(body)
        if isinstance(body, str) and body in self.materials:
            body = self.materials[body]
        if isinstance(body, Material):
            if body.family:
                return body.name, body.family
            return (body.name,)
        match = {family.lower(): family for family in self.families()}.get(body.lower())
        if match is None:
            raise unknown_name(
                "material or family", body, dict.fromkeys((*self.materials, *self.families()))
            )
        return (match,)

    def _unknown_pair(self, names: list[tuple[str, ...]], level: str) -> InputError:
        label = tuple(body[-1] for body in names)
        pairs = [sorted(pair) for pair in self.friction_table]  # one name stands for both bodies
        known = ", ".join(f"{pair[0]}-{pair[-1]}" for pair in pairs)
        remedy = (
            "Give friction_coefficient in the case, add the pair under `friction:` in your "
            "materials file, "
            "or give the material a `family` that has a friction coefficient."
        )
        for body in names:
            if body[-1] in self.families():
                continue
            close = nearest(body[-1], self.families())
            if close:
                remedy += f" Did you mean the family '{close}'?"
        allowed = f"the pairs {known}"
        wrong = f"has no {level} value in the friction table"
        return InputError(
            "friction_coefficient of the pair", "-".join(label), allowed, remedy, wrong
        )


def _of_hardness(classes: Mapping[Hardness | None, Value], hardness: float | None) -> Value | None:
    """Return the wear coefficient of a body of a hardness [HB]; None if there is none."""
    for ends, value in classes.items():
        if ends is not None and hardness is not None and ends[0] <= hardness < ends[1]:
            return value
    return classes.get(None)


@functools.lru_cache(maxsize=256)
def _worn(own: Material, records: int, known: Value, partner: str) -> Material:
    """Return a material with its wear coefficient on its partner.

    Equal materials may have different sources. The identity of their `records` tells them apart;
    the cache keeps the material, so that no other one takes this identity.
    """
    note = f"on {partner}"
    if known.note:
        note += f", {known.note}"
    records_of_pair = {**own.records, "wear_coefficient": replace(known, note=note)}
    changed: dict[str, Any] = {"wear_coefficient": known.value, "records": records_of_pair}
    return replace(own, **changed)
