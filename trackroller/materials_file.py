"""Reads material files: parses, checks and lays the user's file over the built-in one."""

from __future__ import annotations

import functools
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from trackroller.errors import InputError, unknown_name
from trackroller.material_properties import (
    PROPERTIES,
    REQUIRED,
    FrictionValue,
    Property,
    Value,
    check_number,
)
from trackroller.materials import Material, MaterialDatabase
from trackroller.parameters import FRICTION_LEVELS

BUILTIN_FILE = Path(__file__).parent / "data" / "materials.yaml"
DEFAULT_USER_FILE = Path("config") / "materials.yaml"
ENVIRONMENT = "TRACKROLLER_MATERIALS"
BUILTIN = "built-in"
SECTIONS = ("sources", "materials", "friction")
TEXTS = ("family", "description", "like", "note")
VALUE_KEYS = ("value", "unit", "source", "placeholder", "note")
UNITS = {
    "MPa": {"MPa": 1.0, "N/mm2": 1.0, "N/mm^2": 1.0, "N/mm²": 1.0, "GPa": 1e3, "kN/mm2": 1e3, "Pa": 1e-6},
    "-": {"-": 1.0, "1": 1.0, "": 1.0},
}
FRICTION = Property("friction_coefficient", "mu", "-", "friction coefficient", 0.0, 2.0, closed=True)


def find_user_file(argument: Path | str | None = None) -> Path | None:
    """The user's file: the argument, else what TRACKROLLER_MATERIALS names, else config/materials.yaml.

    Raises `InputError` if the argument or the variable names a file that is not there.
    """
    named = argument if argument is not None else os.environ.get(ENVIRONMENT) or None
    if named is None:
        return DEFAULT_USER_FILE.resolve() if DEFAULT_USER_FILE.is_file() else None
    path = Path(named).expanduser()
    if not path.is_file():
        field = "materials file" if argument is not None else ENVIRONMENT
        raise InputError(field, str(named), "it must name a YAML file that is there",
                         "Correct the path, or leave it out to use the built-in materials.")  # fmt: skip
    return path.resolve()


def read_database(user_file: Path | None) -> MaterialDatabase:
    """Database of the built-in file with the user's over it; kept until a file changes."""
    if user_file is None:
        return _cached(None, 0, 0)
    stat = os.stat(user_file)
    return _cached(str(user_file), stat.st_mtime_ns, stat.st_size)


@functools.lru_cache(maxsize=8)
def _cached(user_file: str | None, modified: int, size: int) -> MaterialDatabase:
    database = build_database(_builtin_text(), BUILTIN)
    if user_file is None:
        return database
    try:
        text = Path(user_file).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError("materials file", user_file, f"it must be a readable text ({error})") from error
    return build_database(text, user_file, over=database)


def _builtin_text() -> str:
    return BUILTIN_FILE.read_text(encoding="utf-8")


def build_database(text: str, file: str, over: MaterialDatabase | None = None) -> MaterialDatabase:
    """Database from the text of a file, laid over another one.

    Parameters
    ----------
    text : YAML with the sections sources, materials and friction, each optional
    file : what to call the file in messages and as origin of its values
    over : the database that gives what the file leaves out

    Raises `InputError` naming file, material, field, value and what to do.
    """
    sections = _sections(text, file)
    materials = dict(over.materials) if over else {}
    friction = dict(over.friction_table) if over else {}
    origin = file if over is None else Path(file).name
    parser = _Parser(file, origin, {str(k): " ".join(str(v).split()) for k, v in sections["sources"].items()})
    for name, entry in sections["materials"].items():
        materials[name] = parser.material(name, entry, materials)
    for entry in sections["friction"]:
        pair, levels = parser.friction(entry)
        friction[pair] = {**friction.get(pair, {}), **levels}
    return MaterialDatabase(materials, friction, (*(over.files if over else ()), file))


def _parsed(text: str, file: str) -> Any:
    """Plain data of a YAML text, or an `InputError` that tells the line."""
    try:
        data = yaml.safe_load(text)
        if file != BUILTIN:
            _refuse_repeated_keys(yaml.compose(text, Loader=yaml.SafeLoader), file)
    except InputError:
        raise
    except RecursionError:
        allowed = "it must be YAML that is not nested deeply and does not hold itself"
        raise InputError("materials file", file, allowed) from None
    except (yaml.YAMLError, ValueError) as error:
        reason = " ".join(str(error).split())
        remedy = "Mend the line; texts with ': ' or ' #' in them need quotes."
        raise InputError("materials file", file, f"it must be YAML: {reason}", remedy) from None
    return data


def _sections(text: str, file: str) -> dict[str, Any]:
    """The checked sections of a file, empty where it has none."""
    data = _parsed(text, file)
    data = {} if data is None else data
    if not isinstance(data, Mapping):
        allowed = f"its top level must be a mapping with {', '.join(SECTIONS)}"
        raise InputError("materials file", file, allowed)
    for key in data:
        if key not in SECTIONS:
            raise unknown_name(f"{file}: section", str(key), SECTIONS)
    result: dict[str, Any] = {}
    for section, kind in (("sources", Mapping), ("materials", Mapping), ("friction", list)):
        value = data.get(section)
        value = kind() if value is None and kind is list else {} if value is None else value
        if not isinstance(value, kind):
            form = "a list of pairs" if kind is list else "a mapping from names"
            raise InputError(f"{file}: {section}", value, f"it must be {form}")
        result[section] = value
    return result


def _refuse_repeated_keys(node: Any, file: str) -> None:
    """YAML lets the last of two equal keys win silently: here it is an error."""
    if isinstance(node, yaml.MappingNode):
        seen: set[str] = set()
        for key, value in node.value:
            if key.value in seen:
                raise InputError(f"{file}, line {key.start_mark.line + 1}", key.value,
                                 "the name stands twice at the same place", "Keep one of them.")  # fmt: skip
            seen.add(key.value)
            _refuse_repeated_keys(value, file)
    elif isinstance(node, yaml.SequenceNode):
        for value in node.value:
            _refuse_repeated_keys(value, file)


def _scaled(number: Any, factor: float) -> Any:
    """The number in the unit of the property; anything else as it is, to be refused by name later."""
    try:
        return number if isinstance(number, bool) else float(number) * factor
    except (TypeError, ValueError):
        return number


class _Parser:
    """Turns entries of one file into values; knows the file for messages and its table of sources."""

    def __init__(self, file: str, origin: str, sources: Mapping[str, str]) -> None:
        self.file = file
        self.origin = origin
        self.sources = sources

    def source(self, text: str) -> str:
        """The full reference of a source, or of several with ', ' between, else the text itself."""
        parts = text.split(", ")
        return "; ".join(self.sources[p] for p in parts) if all(p in self.sources for p in parts) else text

    def value(self, prop: Property, entry: Any, where: str) -> Value:
        """A value from a number or from a mapping of value, unit, source, placeholder, note."""
        field = f"{where}.{prop.name}"
        if not isinstance(entry, Mapping):
            entry = {"value": entry}
        for key in entry:
            if key not in VALUE_KEYS:
                if entry[key] is None:  # {source: a, b} is read as a key b without a value
                    raise InputError(field, str(key), "it stands alone in the mapping", "Quote texts with a comma.")
                raise unknown_name(f"{field}: key", str(key), VALUE_KEYS)
        if "value" not in entry:
            remedy = f"Write {{value: ..., unit: {prop.unit}}}."
            raise InputError(field, dict(entry), "it must hold a `value`", remedy)
        unit = str(entry.get("unit", prop.unit))
        if unit not in UNITS[prop.unit]:
            known = ", ".join(filter(None, UNITS[prop.unit]))
            raise InputError(f"{field}.unit", unit, f"the unit must be one of {known}")
        placeholder = entry.get("placeholder", False)
        if not isinstance(placeholder, bool):
            raise InputError(f"{field}.placeholder", placeholder, "it must be true or false")
        number = entry["value"]
        if UNITS[prop.unit][unit] != 1.0:
            number = _scaled(number, UNITS[prop.unit][unit])
        source = self.source(str(entry["source"])) if entry.get("source") else "not given"
        return Value(check_number(prop, number, where), prop.unit, source, placeholder,
                     str(entry.get("note") or ""), self.origin)  # fmt: skip

    def material(self, name: Any, entry: Any, known: Mapping[str, Material]) -> Material:
        """A material from its entry, over the known one of the same name or the one that `like` names."""
        if not isinstance(name, str) or not name.strip():
            raise InputError(f"{self.file}: materials", name, "a material's name must be a text",
                             f'Put it in quotes: "{name}".')  # fmt: skip
        where = f"{self.file}: materials.{name}"
        if not isinstance(entry, Mapping):
            raise InputError(where, entry, f"it must be a mapping with {', '.join(REQUIRED)}")
        for key in entry:
            if key not in PROPERTIES and key not in TEXTS:
                raise unknown_name(f"{where}: field", str(key), (*PROPERTIES, *TEXTS))
        for key in TEXTS:
            if entry.get(key) is not None and not isinstance(entry[key], str):
                raise InputError(f"{where}.{key}", entry[key], "it must be a text", "Put it in quotes.")
        base = self._base(entry, known.get(name), known, where)
        records = dict(base.records) if base else {}
        for key, prop in PROPERTIES.items():
            if key in entry and not (entry[key] is None and prop.optional):
                records[key] = self.value(prop, entry[key], where)
        missing = [key for key in REQUIRED if key not in records]
        if missing:
            given = ", ".join(map(str, entry)) or "nothing"
            raise InputError(where, given, f"it lacks {', '.join(missing)}",
                             "Give them, or write `like: NAME` to take them from another.")  # fmt: skip
        return self._made(name, entry, base, records, where)

    def _base(self, entry: Mapping[str, Any], same: Material | None, known: Mapping[str, Material],
              where: str) -> Material | None:  # fmt: skip
        like = entry.get("like")
        if like is None:
            return same
        if like not in known:
            raise unknown_name(f"{where}.like", like, known)
        return known[like]

    def _made(self, name: str, entry: Mapping[str, Any], base: Material | None, records: dict[str, Value],
              where: str) -> Material:  # fmt: skip
        family = entry.get("family") or (base.family if base else "")
        description = entry.get("description") or (base.description if base and "like" not in entry else "")
        try:
            return Material(name=name, family=family, description=description, records=records,
                            **{key: record.value for key, record in records.items()})  # fmt: skip
        except InputError as error:
            field = error.field.rpartition(".")[2]
            raise InputError(f"{where}.{field}", error.value, error.allowed, error.remedy) from None

    def friction(self, entry: Any) -> tuple[frozenset[str], dict[str, FrictionValue]]:
        """Pair and levels of one entry of the friction list."""
        where = f"{self.file}: friction"
        if not isinstance(entry, Mapping):
            raise InputError(where, entry, "an entry must look like {pair: [metal, PA6], typical: 0.2}")
        pair = entry.get("pair")
        if not isinstance(pair, list) or len(pair) != 2 or not all(isinstance(p, str) and p for p in pair):
            raise InputError(f"{where}.pair", pair, "it must be a list of two families or material names",
                             "Write pair: [metal, PA6].")  # fmt: skip
        where = f"{where}.{'-'.join(pair)}"
        levels = {}
        for key, value in entry.items():
            if key == "pair":
                continue
            if key not in FRICTION_LEVELS:
                raise unknown_name(f"{where}: level", str(key), FRICTION_LEVELS)
            record = self.value(FRICTION, value, f"{where}.{key}")
            levels[key] = FrictionValue(record.value, record.unit, record.source, record.placeholder,
                                        record.note, record.origin)  # fmt: skip
        if not levels:
            raise InputError(where, dict(entry), f"it must give one of {', '.join(FRICTION_LEVELS)}")
        return frozenset(pair), levels


def inline_material(entry: Mapping[str, Any], known: Mapping[str, Material]) -> Material:
    """Material from the mapping of a case, see `MaterialDatabase.material`."""
    entry = dict(entry)
    name = entry.pop("name", None) or "inline"
    entry = {key: value for key, value in entry.items() if value is not None}
    parser = _Parser("case", "case", {})
    # a name that is in the database as well shall not lend its values unasked
    lenders = {key: known[key] for key in known if key != name or entry.get("like") == name}
    return parser.material(name, entry, lenders)
