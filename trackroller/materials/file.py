"""Read material files: the built-in file, and the user's file, whose values replace built-in
ones.
"""

from __future__ import annotations

import functools
import os
import re
from collections.abc import Mapping
from contextlib import nullcontext
from pathlib import Path
from typing import Any

from trackroller.errors import Collector, InputError, check_names
from trackroller.files import MATERIALS, read_text
from trackroller.materials.database import MaterialDatabase
from trackroller.materials.entries import EntryParser
from trackroller.yaml_file import errors_by_line, parse_yaml

BUILTIN_FILE = Path(__file__).with_name("materials.yaml")
DEFAULT_USER_FILE = Path("config") / "materials.yaml"
BUILTIN = "built-in"
FITS = "fits"  # folder beside the user's materials file: posteriors of its fitted materials
SECTIONS: dict[str, type] = {"sources": dict, "materials": dict, "friction": list, "wear": list}


def find_user_file(argument: Path | str | None = None) -> Path | None:
    """Return the path of the user's materials file, or None if there is no such file.

    Parameters
    ----------
    argument : pathlib.Path or str, optional
        Path that the user gave. Default: the value of the environment variable
        TRACKROLLER_MATERIALS, otherwise `config/materials.yaml` in the working directory.

    Returns
    -------
    pathlib.Path or None
        Resolved path.

    Raises
    ------
    InputError
        If the argument or the environment variable names a file that does not exist.
    """
    named: Path | str | None = argument
    if named is None:
        named = os.environ.get(MATERIALS) or None
    if named is None:
        if DEFAULT_USER_FILE.is_file():
            return DEFAULT_USER_FILE.resolve()
        return None
    path = Path(os.path.expanduser(named))
    if not path.is_file():
        field = MATERIALS
        if argument is not None:
            field = "materials file"
        remedy = "Correct the path, or leave it out to use the built-in materials."
        raise InputError(
            field, str(named), "the path of a YAML file", remedy, "does not exist or is no file"
        )
    return path.resolve()


def slug(name: str) -> str:
    """Return the name of a material as a part of names of files: 'rig-steel' of 'Rig steel'."""
    return re.sub(r"[^\w-]+", "-", name.strip().lower()).strip("-") or "material"


def own_file(path: Path | str) -> Path:
    """Return the whole path of a user's materials file; links are followed.

    Raises
    ------
    InputError
        If it is no path, names a folder, or begins with a home that this machine does not know.
    """
    allowed = "the path of a YAML file"
    remedy = "Write a name such as config/materials.yaml."
    if not isinstance(path, (str, os.PathLike)):
        raise InputError("materials file", path, allowed, remedy)
    expanded = os.path.expanduser(path)
    if os.path.isdir(expanded or "."):
        raise InputError("materials file", str(path), allowed, remedy, "is a folder")
    if expanded.startswith("~"):  # a folder of this name would be made
        remedy = "Write the whole path."
        wrong = "names a home that this machine does not know"
        raise InputError("materials file", str(path), allowed, remedy, wrong)
    return Path(os.path.realpath(expanded))


def posterior_path(file: Path | str, name: str) -> Path:
    """Return the file of the posterior of a fitted material, beside the user's materials file."""
    return own_file(file).parent / FITS / f"{slug(name)}.nc"


def read_database(user_file: Path | None) -> MaterialDatabase:
    """Return the built-in database with the values of the user's file, which is parsed again only
    if it has changed.
    """
    if user_file is None:
        return _cached(None, "")
    return _cached(user_file, read_text(user_file, "materials file"))


@functools.lru_cache(maxsize=8)
def _cached(user_file: Path | None, text: str) -> MaterialDatabase:
    if user_file is None:
        return build_database(BUILTIN_FILE.read_text(encoding="utf-8"), BUILTIN)
    return build_database(text, str(user_file), over=_cached(None, ""))


def build_database(
    text: str, file: str, over: MaterialDatabase | None = None, *, by_line: bool = True
) -> MaterialDatabase:
    """Return the database of a file's text, based on another database.

    Parameters
    ----------
    text : str
        YAML with the sections sources, materials, friction and wear, each optional.
    file : str
        Name of the file in messages and as the origin of its values.
    over : MaterialDatabase, optional
        Database whose values are used where the file gives none.
    by_line : bool
        Whether errors name the file and their lines; the text may not be the one that the user
        sees.

    Returns
    -------
    MaterialDatabase
        Materials, friction and wear coefficients of both.

    Raises
    ------
    InputError
        If the text is wrong; the errors of all entries name material, field, value and remedy.
    """
    data = parse_yaml(text, f"materials file {file}")
    with errors_by_line(text, file=file) if by_line else nullcontext():
        return _checked(data, file, over)


def _checked(data: Any, file: str, over: MaterialDatabase | None) -> MaterialDatabase:
    """Return the database of the data of a file, see `build_database`."""
    wrong = Collector()
    sections = _sections(data, file, wrong)
    materials = dict(over.materials) if over else {}
    friction = dict(over.friction_table) if over else {}
    wear = dict(over.wear_table) if over else {}
    origin = file if over is None else Path(file).name
    sources = {str(k): " ".join(str(v).split()) for k, v in sections["sources"].items()}
    parser = EntryParser("materials.", origin, sources)
    for name, entry in sections["materials"].items():
        known = len(wrong.errors)
        with wrong.part("materials", str(name)):
            materials[name] = parser.material(name, entry, materials)
        if len(wrong.errors) > known:
            parser.wrong.add(name)
    for i, entry in enumerate(sections["friction"]):
        with wrong.part("friction", str(i)):
            pair, levels = parser.friction(entry)
            friction[pair] = {**friction.get(pair, {}), **levels}
    for i, entry in enumerate(sections["wear"]):
        with wrong.part("wear", str(i)):
            for bodies, (hardness, value) in parser.wear(entry).items():
                classes = wear.get(bodies, {})
                if hardness is None:  # it holds for every hardness, instead of what was known
                    classes = {}
                wear[bodies] = {hardness: value, **_without(classes, hardness)}
    wrong.check()
    files: tuple[str, ...] = (file,)
    if over:
        files = (*over.files, file)
    return MaterialDatabase(materials, friction, files, wear)


def _without(classes: Mapping[Any, Any], key: Any) -> dict[Any, Any]:
    """Return a mapping without a key."""
    return {other: value for other, value in classes.items() if other != key}


def _sections(data: Any, file: str, wrong: Collector) -> dict[str, Any]:
    """Return the sections of a file; a missing or wrong section is empty."""
    data = {} if data is None else data
    if not isinstance(data, dict):
        allowed = f"a mapping with {', '.join(SECTIONS)}"
        raise InputError("materials file", file, allowed)
    with wrong.part():
        check_names("section", data, SECTIONS)
    result: dict[str, Any] = {}
    for section, kind in SECTIONS.items():
        given = data.get(section)
        if isinstance(given, kind):
            result[section] = given
        else:
            result[section] = kind()
        if given is not None and not isinstance(given, kind):
            form = "a mapping from names"
            if kind is list:
                form = "a list of pairs"
            wrong.errors.append(InputError(section, given, form))
    return result
