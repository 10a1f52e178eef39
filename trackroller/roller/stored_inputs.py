"""Record the inputs of one solved case in its data set, from which the sheet and the JSON text are made."""

from __future__ import annotations

import functools
import json
import math
import shlex
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.errors import InputError
from trackroller.materials import Material, load_database
from trackroller.materials.database import FRICTION
from trackroller.parameters import FRICTION_LEVELS, MAPPING_FIELDS, MATERIAL_FIELDS, PARAMETERS
from trackroller.parameters.example import used_of
from trackroller.roller.case import STUDY, Case
from trackroller.roller.doubts import doubts_of_case

if TYPE_CHECKING:
    import xarray as xr

    from trackroller.materials import MaterialDatabase
    from trackroller.roller.case_table import CaseTable

CASE = "case"  # names of attributes, JSON both
MATERIALS = "materials"
NOT_GIVEN = "not_given"  # attribute: JSON list of the parameters that were not given
DOUBTS = "doubts"  # attribute: JSON list of sentences on unusual values
RADII = "radii"  # attribute: JSON of the outer radius and groove depth that gave the axis distance


def with_inputs(ds: xr.Dataset, case: Case, database: MaterialDatabase) -> xr.Dataset:
    """Return the result of one case with its inputs and materials as JSON attributes.

    Parameters
    ----------
    ds : xarray.Dataset
        The result, without a case dimension.
    case : Case
        Inputs of this result.
    database : MaterialDatabase
        Materials with which the case was solved.

    Returns
    -------
    xarray.Dataset
        The same result with four more attributes, five with an outer radius.
    """
    values = plain_inputs(case)
    if not isinstance(values["friction_coefficient"], float):  # from the friction of the pair
        record = database.friction_record(case.roller_material, case.guide_material, values["friction_coefficient"])
        values["friction_coefficient"] = record["value"]
        ds.attrs[FRICTION] = json.dumps([record])
    ds.attrs |= {CASE: json.dumps(values), MATERIALS: json.dumps(material_values(case, database))}
    ds.attrs |= {NOT_GIVEN: json.dumps(case.not_given), DOUBTS: json.dumps(doubts_of_case(case, database))}
    if case.radii:
        ds.attrs |= {RADII: json.dumps(case.radii)}
    return ds


def with_coordinates(ds: xr.Dataset, table: CaseTable) -> xr.Dataset:
    """Return the result of cases with their inputs as coordinates: numbers with units, and names of materials.

    Parameters
    ----------
    ds : xarray.Dataset
        The result; the coordinates of a single case have no dimension.
    table : CaseTable
        The cases of this result. A number that no case gives is left out.
    """
    columns = {name: np.asarray(getattr(table, name), dtype=float) for name in PARAMETERS}
    columns = {name: values for name, values in columns.items() if not np.isnan(values).all()}
    if (table.roller_profile != "").all():  # the profile stands in the place of the radius
        columns.pop("roller_profile_radius", None)
    labels = {name: _labels(name) for name in columns}
    for name, body in zip(MATERIAL_FIELDS, (table.roller, table.guide), strict=True):
        columns[name] = np.array([str(material) for material in body.name])
        labels[name] = {"long_name": name.replace("_", " ")}
    if "case" in ds.dims:
        return ds.assign_coords({name: ("case", values, labels[name]) for name, values in columns.items()})
    return ds.assign_coords({name: ((), values[0], labels[name]) for name, values in columns.items()})


def _labels(name: str) -> dict[str, str]:
    """Return unit, words and symbol of a parameter as attributes of a variable."""
    parameter = PARAMETERS[name]
    return {"units": parameter.units, "long_name": parameter.long_name, "symbol": parameter.symbol}


def with_design(ds: xr.Dataset, design: xr.Dataset, database: MaterialDatabase | None) -> xr.Dataset:
    """Return the results of a study's design with the design: its variables as coordinates, and its attributes.

    The attribute `materials` (JSON) holds the values of the materials. Results of other cases come back as they are.
    """
    if STUDY not in design.attrs:
        return ds
    if database is None:
        database = load_database()
    materials = {MATERIALS: materials_of_design(design, database)}
    return ds.assign_coords(dict(design.variables)).assign_attrs(design.attrs | materials)


def materials_of_design(design: xr.Dataset, database: MaterialDatabase) -> str:
    """Return the values of all materials of a design with their sources, as JSON by name."""
    names = sorted({str(name) for field in MATERIAL_FIELDS for name in np.unique(design[field].values.astype(str))})
    return json.dumps({name: database.material(name).with_sources() for name in names}, default=str)


def plain_inputs(case: Case) -> dict[str, Any]:
    """Return the inputs of a case as values that JSON can hold."""
    return {key: _plain(value) for key, value in case.as_dict().items()}


def given_inputs(case: Case) -> dict[str, Any]:
    """Return the inputs of a case that differ from the example, as values that JSON can hold."""
    return {name: value for name, value in plain_inputs(case).items() if not is_default(name, value)}


def material_values(case: Case, database: MaterialDatabase) -> dict[str, dict[str, Any]]:
    """Return the values of both materials of a case with their sources, by `roller_material` and `guide_material`."""
    roller, guide = case.roller_material, case.guide_material
    pair = database.on(roller, guide), database.on(guide, roller)
    return {name: body.with_sources() for name, body in zip(MATERIAL_FIELDS, pair, strict=True)}


def _plain(value: Any) -> Any:
    if isinstance(value, Material):
        return value.as_dict()
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return float(value)
    return value


def inputs_of(ds: xr.Dataset) -> dict[str, Any]:
    """Return the inputs of a solved case by name, numbers as floats.

    Raises
    ------
    InputError
        If the data set is not the result of one case.
    """
    if CASE not in ds.attrs or "case" in ds.dims:
        remedy = "Solve one case: tr.solve(tr.Case(...)), or select one with solve(case) anew."
        raise InputError("dataset", sorted(map(str, ds.dims)), "the result of one case with its inputs", remedy)
    values = json.loads(ds.attrs[CASE])
    for name in PARAMETERS:
        if isinstance(values.get(name), str) and values[name] not in FRICTION_LEVELS:
            values[name] = float(values[name])
    return values


def case_of_result(ds: xr.Dataset) -> Case:
    """Return the case that a result was solved for."""
    return Case.from_dict({key: value for key, value in inputs_of(ds).items() if value is not None})


def not_given_of(ds: xr.Dataset) -> dict[str, Any]:
    """Return the values of a solved case that were not given but taken from the paper's example, by name."""
    return used_of(inputs_of(ds), names_not_given(ds.attrs))


def names_not_given(attrs: Mapping[str, Any]) -> list[str]:
    """Return the parameters that were not given, from the attributes of a solved case or study."""
    names: list[str] = json.loads(str(attrs.get(NOT_GIVEN, "[]")))
    return names


def radii_of(ds: xr.Dataset) -> dict[str, float]:
    """Return outer radius and groove depth [mm] of a solved case; {} if its axis distance was given instead."""
    return json.loads(ds.attrs.get(RADII, "{}"))


def doubts_of(ds: xr.Dataset) -> list[str]:
    """Return the sentences on unusual values of the result of one case or of a spectrum."""
    return json.loads(ds.attrs.get(DOUBTS, "[]"))


def materials_of(ds: xr.Dataset) -> dict[str, dict[str, Any]]:
    """Return the values of both materials of a solved case, by `roller_material` and `guide_material`."""
    return json.loads(ds.attrs[MATERIALS])


def as_material(values: Mapping[str, Any]) -> Material:
    """Return the material that a result stores with its sources."""
    return Material(**{key: value for key, value in values.items() if key not in ("sources", "notes", "guesses")})


def friction_records(attrs: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the friction coefficients that a result took from the database: pair, level, value, source, placeholder.

    Parameters
    ----------
    attrs : attributes of a solved case or study; without such a coefficient the list is empty
    """
    return json.loads(str(attrs.get(FRICTION, "[]")))


def is_default(name: str, value: Any) -> bool:
    """Return whether an input has the value that it takes when it is not given."""
    if name in MAPPING_FIELDS:
        return value is None
    default = getattr(_example(), name)
    if isinstance(default, float) and isinstance(value, (int, float)):
        return float(value) == float(default)
    return value == default


@functools.cache
def _example() -> Case:
    return Case()


def setting_text(value: Any) -> str | None:
    """Write a value as `--set` reads it; None for a value that is not given."""
    if isinstance(value, (list, tuple)):
        return ",".join(map(str, value)) or None
    if isinstance(value, Mapping):
        return json.dumps(value)
    if value is None or value == "" or (isinstance(value, float) and math.isnan(value)):
        return None
    if isinstance(value, float):
        return repr(value)
    return str(value)


def solve_command(settings: Mapping[str, Any], words: tuple[str, ...] = ("solve",)) -> str:
    """Return the command that solves a case with these parameters and options, or that `words` name."""
    texts = {key: text for key, value in settings.items() if (text := setting_text(value)) is not None}
    own = [word for key, text in texts.items() for word in ("--set", f"{key}={text}")]
    return shlex.join(["trackroller", *words, *own])
