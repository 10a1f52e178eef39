"""Check the entries of a file or of a case and turn them into materials and friction
coefficients.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from trackroller.damage.own import check_fields
from trackroller.errors import Collector, InputError, check_names, checked_text, unknown_name
from trackroller.materials.energy_wear import FIELD as ENERGY_WEAR
from trackroller.materials.material import UNNAMED, Material, contradictions
from trackroller.materials.properties import ALTERNATIVES, PROPERTIES, REQUIRED, Value, check_number
from trackroller.materials.sn_curve import (
    CURVE,
    FREE,
    POINTS,
    Points,
    complete_curve,
    free_line,
    line_values,
    read_points,
    refuse_other_line,
)
from trackroller.materials.temperature import FIELD, TemperatureTable
from trackroller.numerics.numbers import number_or_nan
from trackroller.numerics.units import split_quantity
from trackroller.parameters import FRICTION_LEVELS, PARAMETERS, Parameter

SOURCE_OF = {  # by each number of a line, the value of `FREE` that it rests on
    "fatigue_strength_ratio": "fatigue_limit",
    "cycles_at_fatigue_limit": "cycles_at_fatigue_limit",
    "cycles_at_tensile_strength": "woehler_exponent",
}
STRENGTH = "tensile_strength"
TEXTS = ("family", "description", "like", "note")
VALUE_KEYS = ("value", "unit", "source", "placeholder", "note", "range")
NUMBERS = PROPERTIES | ALTERNATIVES
HARDNESS = "hardness"  # key of an entry of the wear list: the hardness for which it holds
_HARDNESS = replace(PROPERTIES[HARDNESS], open_lower=False, open_upper=False)
Hardness = tuple[float, float]  # lowest and highest hardness [HB], the highest one left out
WearClass = tuple[Hardness | None, Value]
BODIES_OF_PAIR = ("first", "second")  # keys of a wear coefficient: the body of the pair that wears


class EntryParser:
    """Turn the entries of one file into values, materials and friction coefficients.

    Parameters
    ----------
    prefix : str
        What stands before the name of a material in error messages, such as 'materials.'.
    origin : str
        Name of the file that each value keeps as its origin.
    sources : mapping of str to str
        Full references by their short names.
    """

    def __init__(self, prefix: str, origin: str, sources: Mapping[str, str]) -> None:
        self.prefix = prefix
        self.origin = origin
        self.sources = sources
        self.wrong: set[str] = set()  # names of materials that could not be read

    def source(self, text: str) -> str:
        """Return the full reference of a source, or of several separated by ', '; otherwise the
        text itself.
        """
        parts = text.split(", ")
        if all(p in self.sources for p in parts):
            return "; ".join(self.sources[p] for p in parts)
        return text

    def value(self, prop: Parameter, entry: Any, where: str) -> Value:
        """Return a checked value with its unit and source.

        Parameters
        ----------
        prop : Parameter
            Unit and bounds of the value.
        entry : number or mapping
            The number, or a mapping with value, unit, source, placeholder and note.
        where : str
            Place of the entry, for messages.

        Returns
        -------
        Value
            The value in the unit of the property.

        Raises
        ------
        InputError
            If a key is unknown, the unit does not fit, or the number lies outside its bounds.
        """
        field = f"{where}.{prop.name}"
        if not isinstance(entry, Mapping):
            entry = {"value": entry}
        for key in entry:
            # YAML reads {source: a, b} as a key b without a value.
            if key not in VALUE_KEYS and entry[key] is None:
                raise InputError(
                    field,
                    str(key),
                    "a key with a value",
                    "Put texts that contain a comma in quotes.",
                )
        check_names(f"{field}: key", entry, VALUE_KEYS)
        if "value" not in entry:
            remedy = f"Write {{value: ..., unit: {prop.unit}}}."
            raise InputError(field, dict(entry), "a mapping with a `value`", remedy)
        unit = str(entry.get("unit", prop.unit))
        if "unit" in entry and split_quantity(entry["value"]):
            raise InputError(
                f"{field}.unit",
                unit,
                f"one unit; the value {entry['value']} has its own",
                "Remove one.",
            )
        placeholder = entry.get("placeholder", False)
        if not isinstance(placeholder, bool):
            raise InputError(f"{field}.placeholder", placeholder, "true or false")
        number = check_number(prop, entry["value"], where, unit)
        source = "not given"
        if entry.get("source"):
            source = self.source(str(entry["source"]))
        note = str(entry.get("note") or "")
        span = self.range(prop, entry.get("range"), where, number, unit)
        return Value(number, prop.unit, source, placeholder, note, self.origin, span)

    def range(
        self, prop: Parameter, given: Any, where: str, number: float, unit: str
    ) -> tuple[float, float] | None:
        """Return the checked range of a value in the unit of its property; None if it is not
        given.
        """
        if given is None:
            return None
        if not isinstance(given, (list, tuple)) or len(given) != 2:
            raise InputError(
                f"{where}.{prop.name}.range", given, "[lowest, highest] in the unit of the value"
            )
        low, high = (check_number(prop, end, where, unit) for end in given)
        if not low <= number <= high:
            allowed = f"a range that holds the value {number:g}"
            raise InputError(
                f"{where}.{prop.name}.range", given, allowed, "Correct the range or the value."
            )
        return low, high

    def material(self, name: Any, entry: Any, known: Mapping[str, Material]) -> Material:
        """Return the material of an entry.

        Parameters
        ----------
        name : str
            Name of the material.
        entry : mapping
            Fields of the material. Missing values come from the known material that `like` names,
            otherwise from the known material of the same name.
        known : mapping of str to Material
            Materials by name.

        Returns
        -------
        Material
            The checked material.

        Raises
        ------
        InputError
            If a field is unknown, missing or wrong.
        """
        if not isinstance(name, str) or not name.strip():
            remedy = f'Put it in quotes: "{name}".'
            raise InputError("name of a material", name, "a text", remedy)
        checked_text(name, "name of a material")
        where = f"{self.prefix}{name}"
        if not isinstance(entry, Mapping):
            raise InputError(where, entry, f"a mapping with {', '.join(REQUIRED)}")
        given = self._given(where, entry, known)
        like = entry.get("like")
        if like is None:
            like = name
        base = known.get(like)
        records, points = self._with_curve(where, entry, given, base)
        missing = [key for key in REQUIRED if key not in records]
        if missing:
            remedy = "Give these values, or write `like: NAME` to take them from another material."
            given_names = ", ".join(map(str, entry)) or "nothing"
            wrong = f"lacks {', '.join(missing)}"
            raise InputError(where, given_names, "", remedy, wrong)
        numbers = {key: value.value for key, value in records.items()}
        numbers["fatigue_limit"] = numbers["fatigue_strength_ratio"] * numbers["tensile_strength"]
        # inherited, but a given value excludes it
        for key in contradictions(numbers).keys() - given.keys():
            del records[key]
        table = self._with_source(entry.get(FIELD))
        if (
            FIELD not in entry
            and base
            and isinstance(base.temperature_dependence, TemperatureTable)
        ):
            # a value that is given replaces its inherited column
            table = base.temperature_dependence.without(given)
        fields: dict[str, Any] = {key: value.value for key, value in records.items()}
        if points:
            fields[POINTS] = points
        law = self._with_source(entry.get(ENERGY_WEAR))
        if ENERGY_WEAR not in entry and base:
            law = base.energy_wear
        fields |= {"name": name, FIELD: table, ENERGY_WEAR: law}
        fields |= {"records": records, **_words(entry, base)}
        try:
            return Material(**fields)
        except InputError as error:
            field = error.field.removeprefix(f"material '{name}'")
            raise error.named(f"{where}{field}") from None

    def _with_source(self, table: Any) -> Any:
        """Return a table of an entry with the full reference of its source."""
        if isinstance(table, Mapping) and isinstance(table.get("source"), str):
            return {**table, "source": self.source(table["source"])}
        return table

    def _with_curve(
        self,
        where: str,
        entry: Mapping[Any, Any],
        given: Mapping[str, Value],
        base: Material | None,
    ) -> tuple[dict[str, Value], Points]:
        """Return the numbers of an entry, completed by its base and its S-N curve, and the points
        of a free curve.
        """
        inherited = dict(base.records) if base else {}
        records = inherited | {key: value for key, value in given.items() if key in PROPERTIES}
        points, line = self._line(where, entry, given, base)
        if line is not None and "second_exponent" not in given:
            records.pop("second_exponent", None)  # it belongs to the line that the entry replaces
        if points and STRENGTH in records:
            records |= line_values(points, records[STRENGTH], line or records)
        elif ALTERNATIVES.keys() & given.keys():
            records |= complete_curve(given, inherited, where)
        return records, points

    def _line(
        self,
        where: str,
        entry: Mapping[Any, Any],
        given: Mapping[str, Value],
        base: Material | None,
    ) -> tuple[Points, dict[str, Value] | None]:
        """Return the points of a curve that is free of R_m, or none, and the sources of a new one
        by names of `CURVE`.

        A curve by points, or by the three values `FREE` in one entry, is free. An entry inherits
        the free curve of its base as it is. It may change single ones of `FREE` of a curve without
        corners.
        """
        if entry.get(POINTS) is not None:
            return self._line_by_points(where, entry, given)
        of_curve = given.keys() & {*CURVE, *FREE}
        inherited: Points = ()
        if base:
            inherited = base.sn_points
        if not of_curve:
            return inherited, None
        is_complete = of_curve == set(FREE)
        changes_inherited = bool(inherited) and of_curve <= set(FREE)
        if not is_complete and not changes_inherited:
            return (), None
        if len(inherited) > 2 and not is_complete:
            wrong = f"would change a part of the {POINTS} of the material that it changes"
            name = min(of_curve)
            allowed = f"{', '.join(FREE)} together"
            raise InputError(
                f"{where}.{name}", given[name].value, allowed, f"Or give {POINTS}.", wrong
            )
        values: dict[str, Any] = {name: getattr(base, name, None) for name in (*FREE, STRENGTH)}
        values |= {name: given[name].value for name in (*FREE, STRENGTH) if name in given}
        limit, knee, exponent, strength = values.values()
        if strength is None:
            return (), None
        sources = {}
        for key, name in SOURCE_OF.items():
            if name in given:
                sources[key] = given[name]
            elif base:
                sources[key] = base.records[key]
        return free_line(limit, knee, exponent, strength), sources

    def _line_by_points(
        self, where: str, entry: Mapping[Any, Any], given: Mapping[str, Value]
    ) -> tuple[Points, dict[str, Value]]:
        """Return the points that an entry gives, and a value that holds their source and mark by
        names of `CURVE`.
        """
        if isinstance(entry[POINTS], Mapping):
            record = entry[POINTS]
        else:
            record = {"value": entry[POINTS]}
        check_names(
            f"{where}.{POINTS}: key", record, ("value", "unit", "source", "placeholder", "note")
        )
        points = read_points(record.get("value"), where, str(record.get("unit", "MPa")))
        mark = {key: record[key] for key in ("source", "placeholder", "note") if key in record}
        line = self.value(ALTERNATIVES["fatigue_limit"], {"value": points[-1][0], **mark}, where)
        # R_m may lie below the line, so that the bounds of these numbers do not hold beside points
        numbers = {}
        for name in CURVE:
            value = entry.get(name)
            if isinstance(value, Mapping):
                value = value["value"]
            if value is not None:
                numbers[name] = number_or_nan(value)
        numbers |= {name: given[name].value for name in FREE if name in given}
        strength = None
        if STRENGTH in given:
            strength = given[STRENGTH].value
        refuse_other_line(points, numbers, strength, where)
        return points, dict.fromkeys(CURVE, line)

    def _given(
        self, where: str, entry: Mapping[Any, Any], known: Mapping[str, Material]
    ) -> dict[str, Value]:
        """Return the numbers that an entry gives; raise the errors of all its fields together."""
        wrong = Collector()
        given = {}
        with wrong.part():
            check_fields(f"{where}: field", entry, (*NUMBERS, *TEXTS, POINTS, FIELD, ENERGY_WEAR))
        for key in TEXTS:
            if entry.get(key) is not None and not isinstance(entry[key], str):
                wrong.errors.append(
                    InputError(f"{where}.{key}", entry[key], "a text", "Put it in quotes.")
                )
        with wrong.part():
            like = entry.get("like")
            if isinstance(like, str) and like not in known:
                if like in self.wrong:
                    raise InputError(
                        f"{where}.like", like, "a material without errors", f"Mend '{like}' first."
                    )
                raise unknown_name(f"{where}.like", like, known)
        for key, prop in NUMBERS.items():
            if key in CURVE and entry.get(POINTS) is not None:
                continue  # `_line` compares these numbers with the points
            if key in entry and not (entry[key] is None and prop.allow_missing):
                with wrong.part():
                    given[key] = self.value(prop, entry[key], where)
        wrong.check()
        return given

    def friction(self, entry: Any) -> tuple[frozenset[str], dict[str, Value]]:
        """Return the pair of names and the friction coefficients by level of one entry of the
        friction list.
        """
        prop = PARAMETERS["friction_coefficient"]
        pair, levels = self._of_pair(entry, "friction", "level", FRICTION_LEVELS, prop)
        return frozenset(pair), levels

    def wear(self, entry: Any) -> dict[tuple[str, str], WearClass]:
        """Return the wear coefficients of one entry of the wear list, by the body that wears and
        its partner, each with the hardness of the body for which it holds.
        """
        hardness = None
        if isinstance(entry, Mapping) and HARDNESS in entry:
            hardness = self._hardness(entry)
            entry = {key: value for key, value in entry.items() if key != HARDNESS}
        pair, given = self._of_pair(
            entry, "wear", "body", BODIES_OF_PAIR, PROPERTIES["wear_coefficient"]
        )
        first, second = pair
        by_bodies = {"first": (first, second), "second": (second, first)}
        return {by_bodies[body]: (hardness, value) for body, value in given.items()}

    def _hardness(self, entry: Mapping[Any, Any]) -> Hardness:
        """Return the checked range of hardness [HB] of an entry of the wear list."""
        given = entry[HARDNESS]
        pair = entry.get("pair")
        field = "wear"
        if isinstance(pair, list):
            field = f"wear.{'-'.join(map(str, pair))}"
        if not isinstance(given, (list, tuple)) or len(given) != 2:
            allowed = "[lowest, highest] hardness [HB] of the body that wears"
            raise InputError(f"{field}.{HARDNESS}", given, allowed, "Write hardness: [0, 400].")
        low, high = (check_number(_HARDNESS, end, field) for end in given)
        if not low < high:
            raise InputError(f"{field}.{HARDNESS}", given, "a range that rises", "Swap its ends.")
        return low, high

    def _of_pair(
        self, entry: Any, section: str, kind: str, keys: tuple[str, ...], prop: Parameter
    ) -> tuple[tuple[str, str], dict[str, Value]]:
        """Return the pair of names of an entry, and its values by `keys`, of which at least one
        must be given.
        """
        where = section
        if not isinstance(entry, Mapping):
            raise InputError(
                where, entry, f"an entry such as {{pair: [metal, PA6], {keys[0]}: NUMBER}}"
            )
        pair = entry.get("pair")
        if (
            not isinstance(pair, list)
            or len(pair) != 2
            or not all(isinstance(p, str) and p for p in pair)
        ):
            allowed = "a list of two families or material names"
            raise InputError(f"{where}.pair", pair, allowed, "Write pair: [metal, PA6].")
        where = f"{where}.{'-'.join(pair)}"
        given = {key: value for key, value in entry.items() if key != "pair"}
        levels = {}
        wrong = Collector()
        with wrong.part():
            check_names(f"{where}: {kind}", given, keys)
        for key in filter(given.__contains__, keys):
            with wrong.part(key):
                levels[key] = self.value(prop, given[key], f"{where}.{key}")
        wrong.check()
        if not levels:
            raise InputError(where, dict(entry), f"one of {', '.join(keys)}")
        return (pair[0], pair[1]), levels


def _words(entry: Mapping[Any, Any], base: Material | None) -> dict[str, str]:
    """Return family and description of an entry; a material with the same name or under `like`
    lends them.
    """
    words = {"family": entry.get("family") or "", "description": entry.get("description") or ""}
    if base and not words["family"]:
        words["family"] = base.family
    if base and not words["description"] and "like" not in entry:
        words["description"] = base.description
    return words


def inline_material(entry: Mapping[str, Any], known: Mapping[str, Material]) -> Material:
    """Return the material that a mapping in a case describes; see `MaterialDatabase.material`."""
    entry = dict(entry)
    name = entry.pop("name", None) or UNNAMED
    entry = {key: value for key, value in entry.items() if value is not None}
    parser = EntryParser("material ", "case", {})
    # A mapping inherits from a known material only if it asks for it by `like`, not because both
    # have the same name.
    lenders = {key: known[key] for key in known if key != name or entry.get("like") == name}
    return parser.material(name, entry, lenders)
