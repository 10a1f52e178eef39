"""The materials of the page: the values of one, and a material of the user's own."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from trackroller.errors import InputError, check_names
from trackroller.materials import add_material, load_database
from trackroller.materials.entries import NUMBERS
from trackroller.materials.file import find_user_file
from trackroller.materials.properties import ALTERNATIVES, PROPERTIES
from trackroller.materials.tables import material_details, material_rows
from trackroller.numerics.numbers import read_number
from trackroller.roller.doubts import doubts

FILE = Path("config/materials.yaml")  # of the page's folder, unless the environment names another file


def material(name: str) -> dict[str, Any]:
    """Return the values of a material, each with its unit, source and mark, and the values that may be added.

    Parameters
    ----------
    name : str
        Name of a material of the database.

    Returns
    -------
    dict
        `description` and `family` of the material; `rows`, each with field, symbol, label, value, unit, source, mark
        and whether it can be changed. A value that the material lacks has the text ''.

    Raises
    ------
    InputError
        If there is no such material.
    """
    database = load_database()
    own = database.material(name)
    known = {row["field"]: row for row in material_details(database, name)}
    rows = []
    for prop in (*PROPERTIES.values(), *ALTERNATIVES.values()):
        row = known.get(prop.name, {})
        if row.get("placeholder"):
            mark = f"placeholder, {row['note']}"
        else:
            mark = row.get("note", "")
        value = {"value": row.get("value", ""), "source": row.get("source", "not given"), "mark": mark}
        rows.append({"field": prop.name, "symbol": prop.symbol, "label": prop.label, "unit": prop.unit, **value})
    return {"description": own.description, "family": own.family, "rows": rows}


def save_material(name: str, like: str, values: dict[str, str], source: str) -> dict[str, Any]:
    """Write a material into the user's file, and return the materials of the database.

    Parameters
    ----------
    name : str
        Name of the material. That of an existing one changes its values.
    like : str
        Material that gives the values that are not in `values`.
    values : dict of str to str
        Number by field, as it was typed; a decimal comma is taken, and a unit behind the number.
    source : str
        Where the values come from.

    Returns
    -------
    dict
        `materials` as `all_fields` gives them, `file`, and `doubts`: what is unusual about the material.

    Raises
    ------
    InputError
        If the name is empty, nothing was changed, a key of `values` is no value of a material, or a value is not
        possible. The file is then unchanged.
    """
    check_names("value of a material", values, NUMBERS)
    if not source.strip():
        raise InputError("source", source, "where the values come from", "Name the data sheet or the test.")
    database = load_database()
    file = find_user_file(None) or FILE
    check_names("material value", values, (*PROPERTIES, *ALTERNATIVES))
    values = {field: str(text) for field, text in values.items()}
    changed = {field: typed(text) for field, text in values.items() if text.strip()}
    if name in database or like == name:
        base = {}
    else:
        base = {"like": database.material(like, "like").name}
    if not changed:
        raise InputError("material", name, "at least one changed value", "Type another number into one of the fields.")
    material = add_material(file, name, replace=True, source=source.strip(), **base, **changed)
    return {"materials": material_rows(load_database()), "file": str(file), "doubts": doubts({}, [material])}


def typed(text: str) -> float | str:
    """Return a typed number, with its decimal comma as a point; a text with a unit stays as it is."""
    plain = text.strip().replace("−", "-").replace(",", ".")
    try:
        return read_number(plain)
    except ValueError:
        return plain
