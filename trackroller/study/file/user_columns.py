"""Read the tables of studies, spectra, tests and logs: which columns are known, and in which units
they are read.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from pathlib import Path
from types import MappingProxyType

from trackroller.errors import Collector
from trackroller.files import read_bytes
from trackroller.parameters import MATERIAL_FIELDS, PARAMETERS
from trackroller.roller.aliases import ALIASES
from trackroller.tables.table_kind import TableKind
from trackroller.tables.user_table import UserTable, head_names, read_user_table

# numbers of tables of tests, beside the parameters
OF_TESTS = {
    "amplitude": "MPa",
    "cycles": "-",
    "travel_from": "km",
    "travel_to": "km",
    "wear_depth": "mm",
    "drive_force": "N",
}
UNITS = {name: parameter.unit for name, parameter in PARAMETERS.items()}
UNITS |= {"distance": "m", "guide_overrollings": "-"} | OF_TESTS
WORDS = {*MATERIAL_FIELDS, "material_pair", "name"}


def read_table(
    path: Path,
    field: str,
    row: str,
    wrong: Collector,
    used: Collection[str] = (),
    optional: Collection[str] = (),
    further: Mapping[str, str] = MappingProxyType({}),
    content: bytes | None = None,
) -> UserTable:
    """Read a table of a study, a spectrum, tests or a log; see `read_user_table`.

    Parameters
    ----------
    path : Path
        The file.
    field : str
        Key of the study or spectrum that names the file, for messages.
    row : str
        What a row describes, such as 'case'.
    wrong : Collector
        Receives the errors of single lines and cells.
    used : collection of str
        Names of further columns that expressions use.
    optional : collection of str
        Names of columns whose cells may be empty.
    further : mapping
        Units of further columns of numbers by their names.
    content : bytes, optional
        Content of the file, or its first lines; by default a file of at most `MAX_BYTES` is read.
    """
    kind = TableKind(field, row, {**UNITS, **further}, WORDS, ALIASES, optional)
    return read_user_table(path, kind, wrong, used, content)


def column_names(path: Path, field: str) -> list[str]:
    """Return the names of the columns of a table; [] for an empty one."""
    return line_of_names(path, field)[1]


def line_of_names(path: Path, field: str) -> tuple[int, list[str]]:
    """Return the number of the line of names in a table, and the names; [] for an empty one."""
    kind = TableKind(field, "case", UNITS, WORDS, ALIASES)
    return head_names(read_bytes(path, field, math.inf), path, kind)
