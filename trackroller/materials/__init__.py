"""Materials and friction coefficients: what a body is made of, and the database of them.

`load_database()` reads the built-in file and, over it, the user's own (see `load_database` for where it is
looked for). Every value carries its unit, its source and a `placeholder` mark for a guess without a source.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from trackroller.materials.database import MaterialDatabase
from trackroller.materials.material import Material

__all__ = ["Material", "MaterialDatabase", "add_material", "builtin_database", "load_database"]


def load_database(user_file: Path | str | None = None) -> MaterialDatabase:
    """The built-in database with the user's own file over it.

    The user's file is `user_file`, else the file the environment variable TRACKROLLER_MATERIALS names, else
    `config/materials.yaml` of the working directory if it is there. It may add materials, change single
    values of built-in ones and add friction pairs. Files are read again only when they have changed.

    Raises `InputError` naming file, material, field and value.
    """
    from trackroller.materials.file import find_user_file, read_database

    return read_database(find_user_file(user_file))


def builtin_database() -> MaterialDatabase:
    """The built-in database alone, whatever files the user has."""
    from trackroller.materials.file import read_database

    return read_database(None)


def add_material(path: Path | str, name: str, *, replace: bool = False, **values: Any) -> Material:
    """Write a material into the user's file; see `trackroller.materials.edit.add_material`."""
    from trackroller.materials.edit import add_material as add

    return add(path, name, replace=replace, **values)
