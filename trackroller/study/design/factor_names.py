"""Names of factors and of columns of tables: those of the program, and a study's own."""

from __future__ import annotations

import re
from collections.abc import Iterable

from trackroller.errors import InputError
from trackroller.parameters import MAPPING_FIELDS, MATERIAL_FIELDS, OPTIONS, PARAMETERS
from trackroller.roller.aliases import RADII
from trackroller.roller.dataset import FLAGS, VARIABLES
from trackroller.roller.output_names import PARTS

CASE_FIELDS = (*PARAMETERS, *MATERIAL_FIELDS, *MAPPING_FIELDS)
GEOMETRY = (
    "axis_distance",
    "guide_profile_radius",
    "roller_profile_radius",
    "guide_curve_radius",
    "contact_angle",
)
OPTION_FACTORS = {option.name: option.values for option in OPTIONS.values() if option.factor}
RESERVED = frozenset(  # names of the data set of a study that a factor of its own cannot have
    (
        *VARIABLES,
        *FLAGS,
        *(dim for v in VARIABLES.values() for dim in v.dims),
        "component",
        *CASE_FIELDS,
        "case",
        "validity",
        "reason",
        "study",
        "design",
        "chunk",
        "level",
    )
)
# of a contact or a body
_PART_OF_RESULT = re.compile(r"(?:(?:roller|guide)_)?(\w+?)(?:_roller|_guide|_[12])*")
_NAME = re.compile(r"[^\x00-/:-@\[-^`{-\x7f][^\x00-\x1f/\x7f\x85\u2028\u2029]*")
MAX_NAME = 200  # bytes; netCDF allows 255
FACTOR_NAMES = (*CASE_FIELDS, "material_pair", *OPTION_FACTORS)
SHELVES = ("roller", "bearing", "guide")  # factors whose levels are rows of a table
BEARING_DIAMETER = "bearing_outer_diameter"
SIZES = (*RADII, BEARING_DIAMETER)  # columns of a shelf [mm] that are no parameters


def without_blanks(head: str) -> str:
    """Return the name of a column as results have it: xarray marks no coordinate with a blank."""
    return "_".join(head.split())


def names_without_blanks(heads: Iterable[str], where: str) -> dict[str, str]:
    """Return the names of columns as results have them, by the names at their heads.

    Raises
    ------
    InputError
        If two heads differ by their blanks alone.
    """
    names: dict[str, str] = {}
    for head in heads:
        name = without_blanks(head)
        if name in names.values():
            remedy = f"Rename it, for example {name}_2."
            raise InputError(where, head, f"one column for {name}", remedy)
        names[head] = name
    return names


def check_own_name(name: str, where: str) -> None:
    """Refuse a name of a study's own factor that the data set of results cannot have, or uses for
    something else.

    Raises
    ------
    InputError
        If `name` is no factor of the program, and is the name of a result or none that netCDF files
        allow.
    """
    if name in FACTOR_NAMES:
        return
    if is_of_result(name):
        allowed = "a name that the results do not use for something else"
        raise InputError(where, name, allowed, f"Rename it, for example {name}_factor.")
    if not _fits_netcdf(name):
        allowed = (
            f"a name that results can have: at most {MAX_NAME} bytes, without '/' and line "
            "breaks, and a letter, a figure or '_' at its beginning"
        )
        shown = name
        if len(name) >= MAX_NAME:
            shown = f"{name[:40]}..."
        raise InputError(where, shown, allowed, "Rename it.")


def is_of_result(name: str) -> bool:
    """Return whether the data set of results uses a name, for a value of a contact or body too."""
    part = _PART_OF_RESULT.fullmatch(name)
    return name in RESERVED or name in PARTS or (part is not None and part[1] in VARIABLES)


def _fits_netcdf(name: str) -> bool:
    """Return whether a variable of a netCDF file can have a name."""
    try:
        size = len(name.encode())
    except UnicodeEncodeError:
        return False
    return 0 < size <= MAX_NAME and _NAME.fullmatch(name) is not None
