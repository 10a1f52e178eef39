"""Reads material files: parses, checks and lays the user's file over the built-in one."""

from __future__ import annotations

import functools
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from trackroller.errors import InputError, unknown_name
from trackroller.materials.database import MaterialDatabase
from trackroller.materials.entries import EntryParser

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
    parser = EntryParser(file, origin, {str(k): " ".join(str(v).split()) for k, v in sections["sources"].items()})
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
                raise InputError(
                    f"{file}, line {key.start_mark.line + 1}",
                    key.value,
                    "the name stands twice at the same place",
                    "Keep one of them.",
                )
            seen.add(key.value)
            _refuse_repeated_keys(value, file)
    elif isinstance(node, yaml.SequenceNode):
        for value in node.value:
            _refuse_repeated_keys(value, file)
