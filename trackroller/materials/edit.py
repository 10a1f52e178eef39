"""Write a material into the user's file, keep the file's comments, and never leave a half-written
file.
"""

from __future__ import annotations

import io
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap
from ruamel.yaml.scalarstring import DoubleQuotedScalarString

from trackroller.damage.own import check_fields
from trackroller.errors import InputError, WorkError, checked_text
from trackroller.files import read_text, write_whole
from trackroller.materials.energy_wear import FIELD as ENERGY_WEAR
from trackroller.materials.entries import NUMBERS, TEXTS, VALUE_KEYS
from trackroller.materials.file import build_database, own_file, read_database
from trackroller.materials.material import Material
from trackroller.materials.properties import PROPERTIES
from trackroller.materials.sn_curve import POINTS
from trackroller.materials.temperature import FIELD as TEMPERATURE
from trackroller.numerics.numbers import read_number
from trackroller.numerics.units import split_quantity
from trackroller.yaml_file import needs_quotes

HEADER = """\
# Your own materials and friction coefficients; they replace built-in ones of the same name.
"""
TABLES = (TEMPERATURE, ENERGY_WEAR)
FIELDS = (*NUMBERS, *TEXTS, POINTS, *TABLES, "source", "placeholder")


def add_material(
    path: Path | str, name: str, /, *, replace: bool = False, **values: Any
) -> Material:
    """Write a material into the user's file and return the material as the file now defines it.

    Parameters
    ----------
    path : pathlib.Path or str
        The user's materials file; it is created if it does not exist.
    name : str
        Name of the material. With the name of a built-in material, the entry changes single values
        of it.
    replace : bool
        Allow to change a material that the file already contains.
    **values
        Fields of `Material`, each a number in the unit of the field, or a mapping with value, unit,
        source, placeholder and note. Also `family`, `description` and `like`, the points
        `sn_points`, the tables `temperature_dependence` and `energy_wear`, and `source`,
        `placeholder` and `note` for all numbers, for the points and for the tables.

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
    Comments, order and all other entries of the file are kept. The new text is checked and written
    to a temporary file, which then replaces the old file in one step.
    """
    path = own_file(path)
    if not isinstance(name, str) or not name.strip():
        raise InputError("material name", name, "a text that is not empty")
    checked_text(name, "name of a material")
    check_fields(f"material '{name}': field", values, FIELDS)
    values = {
        key: _plain(f"material '{name}': {key}", value)
        for key, value in values.items()
        if value is not None
    }
    if not values:
        remedy = f"Give one of {', '.join(PROPERTIES)}."
        raise InputError(f"material '{name}'", None, "at least one value", remedy)
    text = HEADER
    if path.exists():
        text = read_text(path, "materials file")
    builtin = read_database(None)
    # raises an error if the file is wrong before the change
    build_database(text, str(path), over=builtin)
    text = _with_entry(text, path, name, _entry(values), replace)
    material = build_database(text, str(path), over=builtin, by_line=False).material(name)
    _write(path, text)
    return material


def _entry(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the entry for the file; every number becomes a mapping with unit, source and
    placeholder mark.
    """
    common = {
        "source": values.get("source", "user's own"),
        "placeholder": values.get("placeholder", False),
    }
    note = {}
    if "note" in values:
        note = {"note": values["note"]}
    entry: dict[str, Any] = {
        key: values[key] for key in ("description", "family", "like") if key in values
    }
    for key, prop in NUMBERS.items():
        if key not in values:
            continue
        if isinstance(values[key], Mapping):
            given = values[key]
        else:
            given = {"value": values[key]}
        parts = split_quantity(given.get("value"))
        if parts:
            given = {**given, "value": _plain(key, read_number(parts[0])), "unit": parts[1]}
        record = {"unit": prop.unit} | common | note | dict(given)
        known = [part for part in VALUE_KEYS if part in record]
        entry[key] = {part: record[part] for part in (*known, *(set(record) - set(known)))}
    if POINTS in values:
        if isinstance(values[POINTS], Mapping):
            line = values[POINTS]
        else:
            line = {"value": values[POINTS]}
        entry[POINTS] = {"value": None, **common, **note, **line}
    return entry | _tables(values, {**common, **note})


def _tables(values: Mapping[str, Any], marks: Mapping[str, Any]) -> dict[str, Any]:
    """Return the tables of a material for the file, with the marks that the values share."""
    tables = {name: values[name] for name in TABLES if name in values}
    for name, table in tables.items():
        if isinstance(table, Mapping):
            tables[name] = {**marks, **table}
    return tables


def _plain(field: str, value: Any) -> Any:
    """Return a number in its shortest form, NumPy's values as Python's, texts and mappings of them
    unchanged.
    """
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, Mapping):
        return {key: _plain(f"{field}.{key}", part) for key, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(field, part) for part in value]
    if isinstance(value, (bool, str)):
        return value
    try:
        number = read_number(value)
    except ValueError:
        raise InputError(field, value, "a number, a text or a mapping of them") from None
    if number.is_integer() and abs(number) < 1e15:
        return int(number)
    return number


def _with_entry(text: str, path: Path, name: str, entry: dict[str, Any], replace: bool) -> str:
    """Return the text of the file with the material in it."""
    editor = YAML()
    editor.preserve_quotes = True
    editor.width = 4096
    editor.indent(mapping=2, sequence=4, offset=2)
    data = editor.load(text)
    # ruamel.yaml would drop the comments of a file without entries, so they are put before the new
    # section.
    comments = ""
    if data is None:
        comments = text.rstrip() + "\n"
        data = CommentedMap()
    if data.get("materials") is None:
        data["materials"] = CommentedMap()
    materials = data["materials"]
    if name in materials and not replace:
        allowed = "a name that the file does not use already"
        remedy = "Choose another name, or ask for a change of this material (--replace)."
        raise InputError(f"{path}: materials.{name}", name, allowed, remedy)
    if not materials:
        materials.fa.set_block_style()  # also if the section is written as {}
    materials.setdefault(_text(name), CommentedMap()).update(_block(entry))
    out = io.StringIO()
    editor.dump(data, out)
    return comments + out.getvalue()


def _block(entry: Mapping[str, Any]) -> Any:
    """Return the entry as mappings of ruamel.yaml, with each value on one line."""
    block = CommentedMap()
    for key, value in entry.items():
        if isinstance(value, Mapping):
            block[key] = CommentedMap({part: _text(v) for part, v in value.items()})
            block[key].fa.set_flow_style()
        else:
            block[key] = _text(value)
    return block


def _text(value: Any) -> Any:
    """Return a text, in quotes where YAML 1.1 would not read it as text, such as 1.4301, yes or
    1:30.
    """
    if isinstance(value, str) and needs_quotes(value):
        return DoubleQuotedScalarString(value)
    return value


def _write(path: Path, text: str) -> None:
    """Write the file whole or not at all, with the permissions that it had."""

    def save(beside: Path) -> None:
        beside.write_text(text, encoding="utf-8", newline="")
        if path.exists():
            shutil.copymode(path, beside)

    try:
        write_whole(path, save)
    except WorkError as error:
        remedy = "Give another path, or make it possible to write here."
        wrong = f"cannot be written: {str(error).removeprefix(f'{path}: ').partition('. ')[0]}"
        raise InputError(
            "materials file", str(path), "a file in a folder that can be written", remedy, wrong
        ) from None
