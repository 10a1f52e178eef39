"""Write a material into the user's file, keep the file's comments, and never leave a half-written file."""

from __future__ import annotations

import io
import os
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap
from ruamel.yaml.scalarstring import DoubleQuotedScalarString

from trackroller.errors import InputError, unknown_name
from trackroller.materials.entries import NUMBERS, TEXTS, VALUE_KEYS
from trackroller.materials.file import build_database, read_database
from trackroller.materials.material import Material
from trackroller.materials.properties import PROPERTIES
from trackroller.materials.yaml_file import needs_quotes, read_text

HEADER = """\
# Your own materials and friction coefficients, laid over the built-in ones.
"""
FIELDS = (*NUMBERS, *TEXTS, "source", "placeholder")


def add_material(path: Path | str, name: str, *, replace: bool = False, **values: Any) -> Material:
    """Write a material into the user's file and return the material as the file now defines it.

    Parameters
    ----------
    path : pathlib.Path or str
        The user's materials file; it is created if it does not exist.
    name : str
        Name of the material. With the name of a built-in material, the entry changes single values of it.
    replace : bool
        Allow to change a material that the file already contains.
    **values
        Fields of `Material`, each a number in the unit of the field, or a mapping with value, unit, source, placeholder
        and note. Also `family`, `description` and `like`, and `source`, `placeholder` and `note` for all values that
        are given as numbers.

    Returns
    -------
    Material
        The new material.

    Raises
    ------
    InputError
        If a value is wrong or the file cannot be written; the file is then unchanged.

    Notes
    -----
    Comments, order and all other entries of the file are kept. The new text is checked and written to a temporary file,
    which then replaces the old file in one step.
    """
    path = Path(os.path.realpath(Path(path).expanduser()))
    if not isinstance(name, str) or not name.strip():
        raise InputError("material name", name, "it must be a text that is not empty")
    for key in values:
        if key not in FIELDS:
            raise unknown_name(f"material '{name}': field", key, FIELDS)
    values = {key: value for key, value in values.items() if value is not None}
    if not values:
        raise InputError(
            f"material '{name}'", None, "it must have at least one value", f"Give one of {', '.join(PROPERTIES)}."
        )
    text = read_text(path, "materials file") if path.exists() else HEADER
    builtin = read_database(None)
    build_database(
        text, str(path), over=builtin
    )  # raises an error, so that a file that was broken before stays unchanged
    text = _with_entry(text, path, name, _entry(values), replace)
    material = build_database(text, str(path), over=builtin).material(name)
    _write_at_once(path, text)
    return material


def _entry(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the entry for the file; every number becomes a mapping with unit, source and placeholder mark."""
    common = {"source": values.get("source", "user's own"), "placeholder": values.get("placeholder", False)}
    note = {"note": values["note"]} if "note" in values else {}
    entry: dict[str, Any] = {key: values[key] for key in ("description", "family", "like") if key in values}
    for key, prop in NUMBERS.items():
        if key not in values:
            continue
        given = values[key] if isinstance(values[key], Mapping) else {"value": _plain(values[key])}
        record = {"unit": prop.unit} | common | note | dict(given)
        known = [part for part in VALUE_KEYS if part in record]
        entry[key] = {part: record[part] for part in (*known, *(set(record) - set(known)))}
    return entry


def _plain(value: Any) -> Any:
    """Return a number in its shortest form; anything else unchanged, because the later check names the field."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        return value
    if isinstance(value, bool):
        return value
    return int(number) if number.is_integer() and abs(number) < 1e15 else number


def _with_entry(text: str, path: Path, name: str, entry: dict[str, Any], replace: bool) -> str:
    """Return the text of the file with the material in it."""
    editor = YAML()
    editor.preserve_quotes = True
    editor.width = 4096
    editor.indent(mapping=2, sequence=4, offset=2)
    block = _block(entry)
    data = editor.load(text)
    if data is None or data.get("materials") is None:
        # ruamel.yaml would drop the comments of a file without entries, so the section is appended to the text.
        head = text if data is None else _without_empty_section(text)
        out = io.StringIO()
        editor.dump(CommentedMap({"materials": CommentedMap({_text(name): block})}), out)
        return head + ("" if head.endswith("\n") or not head else "\n") + out.getvalue()
    materials = data["materials"]
    if name in materials and not replace:
        raise InputError(
            f"{path}: materials.{name}",
            name,
            "a name that the file does not use already",
            "Choose another name, or replace the values (replace=True).",
        )
    if name in materials:
        for key, value in block.items():
            materials[name][key] = value
    else:
        _append(materials, _text(name), block)
    out = io.StringIO()
    editor.dump(data, out)
    return out.getvalue()


def _append(materials: Any, name: Any, block: Any) -> None:
    """Add an entry at the end of the section, in block style even if the section is written as `{}`."""
    if not materials:
        materials.fa.set_block_style()
    materials[name] = block


def _without_empty_section(text: str) -> str:
    """Return the text without an empty `materials:` line, which is then written again with an entry."""
    lines = text.splitlines(keepends=True)
    for i, line in enumerate(lines):
        if line.split("#")[0].rstrip() in ("materials:", "materials: null", "materials: ~"):
            comment = line.partition("#")
            lines[i] = f"#{comment[2]}" if comment[1] else ""
            break
    return "".join(lines)


def _block(entry: Mapping[str, Any]) -> Any:
    """Return the entry as mappings of ruamel.yaml, with each value on one line."""
    block = CommentedMap()
    for key, value in entry.items():
        if isinstance(value, Mapping):
            inner = CommentedMap({part: _text(v) for part, v in value.items()})
            inner.fa.set_flow_style()
            block[key] = inner
        else:
            block[key] = _text(value)
    return block


def _text(value: Any) -> Any:
    """Return a text, in quotes where YAML 1.1 would not read it as text, such as 1.4301, yes or 1:30."""
    if not isinstance(value, str):
        return value
    return DoubleQuotedScalarString(value) if needs_quotes(value) else value


def _write_at_once(path: Path, text: str) -> None:
    """Write a temporary file and rename it, so that a reader sees the whole old file or the whole new one."""
    beside = None
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        mode = path.stat().st_mode & 0o777 if path.exists() else 0o666 & ~_umask()
        handle, beside = tempfile.mkstemp(prefix=f".{path.name}.", suffix=".part", dir=path.parent)
        with os.fdopen(handle, "w", encoding="utf-8", newline="") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        os.chmod(beside, mode)
        os.replace(beside, path)
    except OSError as error:
        allowed = f"a file in a folder that can be written ({error.strerror})"
        remedy = "Give another path, or allow writing to this folder."
        raise InputError("materials file", str(path), allowed, remedy) from None
    finally:
        if beside is not None and os.path.exists(beside):
            os.unlink(beside)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
