"""Materials, friction coefficients, and the database that holds them.

`load_database()` reads the built-in file and then the user's own file, whose values replace
built-in ones. Every value has a unit and a source. The mark `placeholder` says that a value is a
guess without a source.
"""

from __future__ import annotations

from pathlib import Path

from trackroller.materials.database import MaterialDatabase
from trackroller.materials.edit import add_material
from trackroller.materials.file import find_user_file, read_database
from trackroller.materials.material import Material

__all__ = ["Material", "MaterialDatabase", "add_material", "builtin_database", "load_database"]


def load_database(user_file: Path | str | None = None) -> MaterialDatabase:
    """Return the built-in database, changed and extended by the user's own file.

    Parameters
    ----------
    user_file : pathlib.Path or str, optional
        The user's file. Default: the file that the environment variable TRACKROLLER_MATERIALS
        names, otherwise `config/materials.yaml` in the working directory if this file exists.

    Returns
    -------
    MaterialDatabase
        The database. A file is read again only after it has changed.

    Raises
    ------
    InputError
        If a file is missing or wrong; the error names file, material, field and value.

    Notes
    -----
    The user's file may add materials, change single values of built-in materials, and add friction
    pairs.

    Examples
    --------
    >>> database = load_database()
    >>> float(database.material("1.7225-normalised").tensile_strength)
    720.0
    """
    return read_database(find_user_file(user_file))


def builtin_database() -> MaterialDatabase:
    """Return the built-in database without the user's file."""
    return read_database(None)
