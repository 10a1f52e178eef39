"""Reads material files: parses, checks and lays the user's file over the built-in one."""

from __future__ import annotations

import functools
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from trackroller.errors import InputError, unknown_name
from trackroller.materials.database import MaterialDatabase
from trackroller.materials.entries import EntryParser
from trackroller.materials.yaml_file import parse_yaml, read_text

BUILTIN_FILE = Path(__file__).with_name("materials.yaml")
DEFAULT_USER_FILE = Path("config") / "materials.yaml"
ENVIRONMENT = "TRACKROLLER_MATERIALS"
BUILTIN = "built-in"
SECTIONS = ("sources", "materials", "friction")


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
        raise InputError(
            field,
            str(named),
            "it must name a YAML file that is there",
            "Correct the path, or leave it out to use the built-in materials.",
        )
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
    return build_database(read_text(user_file, "materials file"), user_file, over=database)


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
    parser = EntryParser(file, origin, {str(k): " ".join(str(v).split()) for k, v in sections["sources"].items()})
    for name, entry in sections["materials"].items():
        materials[name] = parser.material(name, entry, materials)
    for entry in sections["friction"]:
        pair, levels = parser.friction(entry)
        friction[pair] = {**friction.get(pair, {}), **levels}
    return MaterialDatabase(materials, friction, (*(over.files if over else ()), file))


def _sections(text: str, file: str) -> dict[str, Any]:
    """The checked sections of a file, empty where it has none."""
    data = parse_yaml(text, f"materials file {file}")
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
