"""Read the points of a cross-section from a text file beside the case or study that names the file."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Any

from trackroller.errors import InputError

HEADINGS = 5  # largest number of heading lines before the first point
_COMMA = re.compile(r"[-+]?\d*,\d+(?:[eE][-+]?\d+)?")  # a number with a decimal comma
_beside: ContextVar[Path | None] = ContextVar("beside", default=None)


@contextmanager
def files_beside(path: Path | str | None) -> Iterator[None]:
    """Look for files in the folder of the case or study file `path` first, while that file is read."""
    token = _beside.set(None if path is None else Path(path).parent)
    try:
        yield
    finally:
        _beside.reset(token)


def read_points(name: Any, field: str) -> list[list[float]]:
    """Read rows of two numbers from a text file.

    Columns are separated by commas, semicolons, tabs or blanks; heading lines are allowed. Decimal commas are
    understood where another character separates the columns. The file lies beside the case or study file that names it,
    or below the working directory. Absolute paths and '..' are refused, so that a study file from somebody else cannot
    read private files.

    Parameters
    ----------
    name : str
        Relative path of the file.
    field : str
        `guide_profile.file` or `roller_profile.file`, for error messages.

    Returns
    -------
    list of list of float
        Points [x, z] [mm].

    Raises
    ------
    InputError
        If the path is not allowed, the file does not exist, or a line does not hold two numbers.
    """
    path = find_beside(name, field)
    rows: list[list[float]] = []
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (UnicodeDecodeError, OSError) as error:
        raise InputError(
            field,
            str(name),
            f"a readable text file in UTF-8 ({error})",
            "Save the points as text: two columns, x and z.",
        ) from None
    for number, line in enumerate(text.splitlines(), start=1):
        cells = _cells(line.split("#")[0])
        if not cells:
            continue
        try:
            rows.append([float(cells[0]), float(cells[1])])
        except (ValueError, IndexError):
            if rows or number > HEADINGS:
                raise InputError(
                    f"{field}, line {number}",
                    line,
                    "two numbers x, z [mm]",
                    "Decimal points; decimal commas only between semicolons, tabs or blanks; remarks after '#'.",
                ) from None
    return rows


def find_beside(name: Any, field: str) -> Path:
    """Return the path of a file that a case, study or spectrum file names: the one rule for every such path.

    Parameters
    ----------
    name : str
        Path from the folder of the file that names it, or from the working directory.
    field : str
        The key that names it, for messages.

    Raises
    ------
    InputError
        If the path is absolute, holds '..', leads out of both folders, or names no file.
    """
    folders = [folder for folder in (_beside.get(), Path.cwd()) if folder is not None]
    where = " or ".join(dict.fromkeys(f"below {folder.resolve()}" for folder in folders))
    remedy = f"Put the file {where} and give its path from there."
    path = Path(str(name))
    if not isinstance(name, (str, Path)) or path.is_absolute() or ".." in path.parts or not str(name).strip():
        raise InputError(field, str(name), "a relative path without '..'", remedy)
    for folder in folders:
        here = folder / path
        if here.is_file() and here.resolve().is_relative_to(folder.resolve()):
            return here
    raise InputError(field, str(name), f"a file {where}", "Check its name, or put it there.")


def _cells(line: str) -> list[str]:
    """Return the columns of a line, decimal commas replaced where semicolons, tabs or blanks separate the columns."""
    columns = [cell.strip() for cell in line.split(";")] if ";" in line else line.split()
    if len(columns) > 1 and (";" in line or all(_COMMA.fullmatch(cell) for cell in columns[:2])):
        return [cell.replace(",", ".") if _COMMA.fullmatch(cell) else cell for cell in columns]
    return line.replace(",", " ").split()
