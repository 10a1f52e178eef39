"""Build the dataset of the cases of a study, which the solver takes."""

from __future__ import annotations

import functools
import json
import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from trackroller.errors import InputError
from trackroller.materials.database import FRICTION
from trackroller.methods import METHODS, Design
from trackroller.methods.factor import ROWS, parse, readable
from trackroller.methods.method import study_keys
from trackroller.parameters import (
    FRICTION_LEVELS,
    MAPPING_FIELDS,
    MATERIAL_FIELDS,
    PARAMETERS,
    expressions,
)
from trackroller.parameters.carriage_fields import field_of, long_name_of
from trackroller.parameters.example import EXAMPLE
from trackroller.roller.fields import own_frictions
from trackroller.study.design.factor_names import SHELVES, SIZES
from trackroller.study.design.roles import scattered
from trackroller.study.design.sampling import sample
from trackroller.study.design.stored import stored

if TYPE_CHECKING:
    from trackroller.materials import MaterialDatabase
    from trackroller.study.file.config import StudyFile

OF_SHELF = "shelf"  # attribute of a column of a shelf
MAX_CASES = 10_000_000  # planned in about a minute; validation/benchmarks/million.py measures it


def case_columns(known: Any) -> tuple[str, ...]:
    """Return the names of the case fields among the columns of a design.

    Parameters
    ----------
    known : names of the columns

    Returns
    -------
    All parameters and materials; mappings only if the study has them.
    """
    return (*PARAMETERS, *MATERIAL_FIELDS, *(name for name in MAPPING_FIELDS if name in known))


def draw(
    config: StudyFile, factors: Mapping[str, Any], table: Path, grown: tuple[int, ...] = ()
) -> Design:
    """Draw the design of a study.

    Parameters
    ----------
    config : what the study file says
    factors : all factors, lists of contact models included
    table : the CSV of cases; without a meaning for other designs
    grown : number of samples (of each design point) to which `until` has grown the sample; by
        default that of the file

    Returns
    -------
    Design, see `trackroller.study.design.sampling.sample`

    Raises
    ------
    InputError : as `sample`; an option that the design does not have; too many cases
    """
    names = (*study_keys(), "rank_correlations")
    options = {name: value for name in names if (value := getattr(config, name)) not in (None, ())}
    if config.until is not None:
        options["replicates"] = config.until.replicates
    if len(set(grown)) > 1:
        options["point_samples"] = grown
    method = METHODS[config.method_name]
    if config.table is not None:
        options["table"] = str(table)
    if "groups" in method.takes and config.analysis.groups:
        options["groups"] = config.analysis.groups
    if method.proposes:
        options["conditions"] = scattered(
            {name: parse(name, spec) for name, spec in factors.items()}, config.roles
        )
        options["population"] = config.budget.generation
    base = {k: v for k, v in config.base.items() if isinstance(v, float)}
    samples = max(grown, default=config.samples)
    used = {name for text in config.constraints for name in expressions.names(text, "constraints")}
    name = config.method_name
    design = sample(factors, name, samples, config.seed, base=base, used=used, **options)
    if design.size > MAX_CASES:
        raise InputError("method", f"{design.size} cases", f"at most {MAX_CASES} cases")
    return design


def build(config: StudyFile, design: Design, materials: MaterialDatabase) -> xr.Dataset:
    """Build the dataset of cases of a study.

    Parameters
    ----------
    config : what the study file says
    design : its design
    materials : the materials, whose pairs decide friction coefficients that are words or missing

    Returns
    -------
    Dataset with dimension `case`: one variable a parameter (friction coefficients as numbers,
    materials by name). Coordinates along `case`: models that vary, and auxiliary factors of
    expressions. The places of the design stand as `trackroller.study.design.stored` says.
    """
    n = design.size or 1
    columns, friction = columns_of(config.base, design.columns, n, materials)
    places, attrs = stored(design)
    pair = design.columns.get("material_pair")
    cases = dataset_of(
        columns, pair, places, {"study_name": config.name, "seed": config.seed, **attrs, **friction}
    )
    return marked(cases, config)


def marked(cases: xr.Dataset, config: StudyFile) -> xr.Dataset:
    """Return cases whose columns of shelves state the shelf as an attribute, and the unit where the
    file has one.
    """
    for shelf in (name for name in SHELVES if ROWS in config.factors.get(name, {})):
        factor = parse(shelf, config.factors[shelf])
        for name in (name for name in factor.beside if name in cases.variables):
            cases[name].attrs |= {OF_SHELF: shelf}
            if name in SIZES:
                cases[name].attrs |= {"units": "mm"}
            elif name in factor.units:
                cases[name].attrs |= {"units": factor.units[name]}
    return cases


def dataset_of(
    columns: dict[str, np.ndarray],
    pair: np.ndarray | None,
    places: Mapping[str, Any],
    attrs: Mapping[str, Any],
) -> xr.Dataset:
    """Return columns (n,) as a data set of cases: fields of a case as variables, other columns as
    coordinates.

    Parameters
    ----------
    columns : as `columns_of` returns them; they are used up
    pair : pairs of materials, if they are a factor
    places : further coordinates
    attrs : attributes
    """
    data = {}
    n = len(columns["radial_force"])
    for name, parameter in PARAMETERS.items():
        meta = {
            "units": parameter.units,
            "long_name": parameter.long_name,
            "symbol": parameter.symbol,
        }
        data[name] = ("case", columns.pop(name), meta)
    for name in case_columns(columns)[len(PARAMETERS) :]:
        data[name] = (
            "case",
            _mapped(str, object, columns.pop(name)),
            {"long_name": name.replace("_", " ")},
        )
    coords: dict[str, Any] = {
        "case": ("case", np.arange(n), {"long_name": "case number", "units": "1"})
    }
    if pair is not None:
        columns["material_pair"] = pair
    for name, values in columns.items():
        field = field_of(name)
        meta = {"long_name": long_name_of(name)} | ({} if field is None else {"units": field.units})
        coords[name] = ("case", readable(values), meta)
    return xr.Dataset(data, coords | dict(places), attrs)


def columns_of(
    given: Mapping[str, Any], varying: Mapping[str, np.ndarray], n: int, materials: MaterialDatabase
) -> tuple[dict[str, np.ndarray], dict[str, str]]:
    """Return every case field and further factor as a column of n values, and the attribute of
    `_friction`.

    Parameters
    ----------
    given : values that all cases share
    varying : columns (n,) of the factors
    n : number of cases
    materials : the materials, whose pairs decide friction coefficients that are words or missing
    """
    base = {name: parameter.default for name, parameter in PARAMETERS.items()}
    base |= EXAMPLE | dict(given)
    base.pop("material_pair", None)
    pair = given.get("material_pair")
    if pair:
        base |= dict(zip(MATERIAL_FIELDS, pair, strict=True))
    columns: dict[str, np.ndarray] = {}
    for name, value in base.items():
        kind: type = float
        if isinstance(value, str) or value is None:
            kind = object
        # a shared value takes no memory
        columns[name] = np.broadcast_to(np.array(value, dtype=kind), n)
    columns |= varying
    if "material_pair" in columns:
        pairs = columns.pop("material_pair")
        for i, name in enumerate(MATERIAL_FIELDS):
            columns[name] = np.array([pair[i] for pair in pairs], dtype=object)
    if "friction_law" in columns and "friction_coefficient" not in {*given, *varying}:
        columns["friction_coefficient"] = own_frictions(columns["friction_law"])
    columns["friction_coefficient"], friction = _friction(materials, columns)
    for name in PARAMETERS:
        if columns[name].dtype != float:
            columns[name] = _mapped(_number, float, columns[name])
    return columns, friction


def _mapped(function: Callable[..., Any], dtype: type, *columns: np.ndarray) -> np.ndarray:
    """Return a function of the rows of columns (n,). It is computed once if no column varies."""
    if all(column.strides == (0,) for column in columns):
        return np.broadcast_to(
            np.array(function(*(column[0] for column in columns)), dtype=dtype), len(columns[0])
        )
    return np.array([function(*row) for row in zip(*columns, strict=True)], dtype=dtype)


def _number(value: Any) -> float:
    return math.nan if value is None else float(value)


def _friction(
    materials: MaterialDatabase, columns: dict[str, np.ndarray]
) -> tuple[np.ndarray, dict[str, str]]:
    """Return friction coefficients as numbers; the pair of materials decides where there is a level
    or nothing.

    The second value is an attribute that records the coefficients taken from the database (JSON),
    empty without one.
    """
    values = columns["friction_coefficient"]
    if values.dtype != object:
        return values, {}
    records = []

    @functools.cache
    def coefficient(value: Any, roller: str, guide: str) -> float:
        """Return the coefficient of a case; one from the database is recorded."""
        if isinstance(value, (int, float)) and not math.isnan(value):
            return float(value)
        level = None
        if isinstance(value, str) and value in FRICTION_LEVELS:
            level = value
        record = materials.friction_record(roller, guide, level)
        records.append(record)
        return float(record["value"])

    names = [_mapped(str, object, columns[name]) for name in MATERIAL_FIELDS]
    coefficients = _mapped(coefficient, float, values, *names)
    if not records:
        return coefficients, {}
    return coefficients, {FRICTION: json.dumps(records)}
