"""Record the public names: Python, study file and command line."""

from __future__ import annotations

import dataclasses
import inspect
import json
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import trackroller as tr
from validation.same_numbers.archive import Archive, text

ROOT = Path(str(tr.__file__)).resolve().parents[1]  # of the checkout that is recorded
SCHEMA = Path("workflow") / "schemas" / "study.schema.json"


def record_signatures() -> Archive:
    """Record names, parameters with kind and default, keys of a study file, commands and their options.

    Returns
    -------
    Archive
    """
    return {
        "signatures/python.json": text(python_names()),
        "signatures/case.json": text(case_fields()),
        "signatures/materials.json": text(materials()),
        "signatures/schema.json": text(schema_keys(json.loads((ROOT / SCHEMA).read_text(encoding="utf-8")))),
        "signatures/commands.json": text(commands()),
    }


def python_names() -> dict[str, Any]:
    """Return every public name with its parameters.

    Returns
    -------
    dict
        Name to parameter to kind and default; annotations may change and are left out.
    """
    found: dict[str, Any] = {}
    for name in tr.__all__:
        value = getattr(tr, name)
        if not callable(value):
            found[name] = type(value).__name__
            continue
        parameters = inspect.signature(value).parameters.values()
        found[name] = {p.name: f"{p.kind.description}, default {_default(p.default)}" for p in parameters}
    return found


def _default(value: Any) -> str:
    return "none" if value is inspect.Parameter.empty else repr(value)


def case_fields() -> dict[str, str]:
    """Return the fields of a `Case` with their defaults.

    Returns
    -------
    dict
        Field name to default, as text.
    """
    default = tr.Case()
    return {entry.name: repr(getattr(default, entry.name)) for entry in dataclasses.fields(tr.Case)}


def materials() -> dict[str, dict[str, str]]:
    """Return the numbers of every material in the built-in database.

    Returns
    -------
    dict
        Material to property to value, as text.
    """
    database = tr.load_database()
    found = {}
    for name in sorted(database):
        entry = database.material(name)
        fields = {each.name: getattr(entry, each.name) for each in dataclasses.fields(entry)}
        found[name] = {key: repr(value) for key, value in fields.items() if isinstance(value, (int, float))}
    return found


def schema_keys(schema: dict[str, Any], where: str = "study") -> dict[str, Any]:
    """Return the keys of a study file with type, default and allowed words; descriptions are left out.

    Parameters
    ----------
    schema : dict
        JSON schema, or the part of it that describes one key.
    where : str
        Path to that key.

    Returns
    -------
    dict
        Path to type, default or `allowed`.
    """
    found: dict[str, Any] = {where: {key: schema[key] for key in ("type", "default") if key in schema}}
    for word in schema.get("enum", ()):
        found[f"{where}={word}"] = "allowed"
    for key in ("properties", "$defs"):
        for name, inner in schema.get(key, {}).items():
            found |= schema_keys(inner, f"{where}/{name}")
    for i, inner in enumerate(schema.get("anyOf", ())):
        found |= schema_keys(inner, f"{where}|{i}")
    if isinstance(schema.get("items"), dict):
        found |= schema_keys(schema["items"], f"{where}[]")
    return found


def entry_point() -> str:
    """Return Python code that runs the command `trackroller` of this checkout.

    Returns
    -------
    str
        For `python -c`.
    """
    scripts = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["scripts"]
    module, _, function = scripts["trackroller"].partition(":")
    return f"import sys; sys.argv[0] = 'trackroller'; from {module} import {function}; {function}()"


def environment() -> dict[str, str]:
    """Return the environment of subprocesses that run this checkout.

    Returns
    -------
    dict
        The environment of this process, with the checkout first on Python's path and plain wide output.
    """
    return os.environ | {"PYTHONPATH": str(ROOT), "COLUMNS": "240", "TERM": "dumb", "NO_COLOR": "1"}


def commands(path: tuple[str, ...] = ()) -> dict[str, str]:
    """Return commands and options of the command line, from its help texts.

    Parameters
    ----------
    path : tuple of str
        A command, for example `("materials", "list")`; the program itself if empty.

    Returns
    -------
    dict
        Command to the word `command`, command and option to the word `option`.
    """
    call = [sys.executable, "-c", entry_point(), *path, "--help"]
    told = subprocess.run(call, env=environment(), capture_output=True, text=True, check=True).stdout
    name = " ".join(("trackroller", *path))
    found = {name: "command"}
    for option in re.findall(r"^\W*(?:\*\s+)?(--[\w-]+(?:\s+-\w)?)", told, flags=re.MULTILINE):
        found[f"{name} {' '.join(option.split())}"] = "option"
    panel = re.search(r"^\W*Commands\b.*?\n(.*)", told, flags=re.MULTILINE | re.DOTALL)
    for inner in re.findall(r"^\W{1,3}([a-z][\w-]*)\s", panel.group(1), flags=re.MULTILINE) if panel else ():
        found |= commands((*path, inner))
    return found
