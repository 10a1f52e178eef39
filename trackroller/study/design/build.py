"""Build the dataset of the cases of a study, which the solver takes."""

from __future__ import annotations

import functools
import itertools
import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from trackroller.errors import InputError, nearest, unknown_name
from trackroller.parameters import FRICTION_LEVELS, MAPPING_FIELDS, MATERIAL_FIELDS, PARAMETERS, expressions
from trackroller.roller.fields import own_frictions
from trackroller.roller.geometry import geometry_problem
from trackroller.study.design.correlation import check_design, copula
from trackroller.study.design.entries import OPTION_FACTORS, check_own_name
from trackroller.study.design.factors import readable
from trackroller.study.design.sampling import SampledDesign, sample
from trackroller.study.file.goals import check_scatter

if TYPE_CHECKING:
    from trackroller.study.file.config import Study

MAX_CASES = 10_000_000  # planned in about a minute; validation/benchmarks/million.py measures it
_GEOMETRY = ("axis_distance", "guide_profile_radius", "roller_profile_radius", "guide_curve_radius", "contact_angle")
_DEFAULT_MATERIAL = "1.7225-normalised"


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


def draw(study: Study) -> SampledDesign:
    """Draw the design of a study.

    Parameters
    ----------
    study : the study

    Returns
    -------
    SampledDesign, see `trackroller.study.design.sampling.sample`

    Raises
    ------
    InputError : as `sample`; an option that the design does not have; too many cases
    """
    config = study.config
    names = ("second_order", "levels", "inner", "grown_from", "rank_correlations")
    options = {name: value for name in names if (value := getattr(config, name)) not in (None, ())}
    if config.design == "table":
        options["table"] = table_path(study)
    if config.exchange == "groups":
        options["groups"] = config.analysis.groups
    base = {k: v for k, v in config.base.items() if isinstance(v, float)}
    design = sample(study.factors, config.design, config.samples, config.seed, base=base, **options)
    if config.design == "table":
        _check_columns(study, design)
    if design.size > MAX_CASES:
        raise InputError("design", f"{design.size} cases", f"at most {MAX_CASES} cases")
    return design


def check_correlations(study: Study) -> None:
    """Refuse rank correlations that the design or the factors cannot have, before anything is drawn."""
    config = study.config
    check_design(config.rank_correlations, config.design)
    random = {n: f for n, f in study.parsed.items() if f.kind != "expression"}
    copula(config.rank_correlations, {n: f for n, f in random.items() if f.scatter or config.design != "inner_outer"})


def _check_columns(study: Study, design: SampledDesign) -> None:
    """Refuse further columns of a table that look like a misspelt name, and a table with further columns only."""
    known = [*PARAMETERS, *MATERIAL_FIELDS, "material_pair", *OPTION_FACTORS]
    used = {name for factor in study.parsed.values() for name in expressions.names(factor.text or "0")}
    own = [name for name in design.columns if name not in known and name not in used]
    for name in own:
        check_own_name(name, f"table column {name}")
        if nearest(name, known) or len(own) == len(design.columns):
            raise unknown_name("table column", name, known)


def table_path(study: Study) -> str:
    """Return the path of the CSV of cases; a relative path starts from the folder of the study file."""
    path = Path(str(study.config.table))
    if not path.is_absolute() and study.path is not None:
        path = study.path.parent / path
    return str(path)


def build(study: Study, design: SampledDesign | None = None) -> xr.Dataset:
    """Build the dataset of cases of a study.

    Parameters
    ----------
    study : the study
    design : its design, if it has been drawn already

    Returns
    -------
    Dataset with dimension `case`: one variable a parameter (friction coefficients as numbers, materials by name).
    Coordinates along `case`: models that vary, and auxiliary factors of expressions. Attributes: study, design,
    seed, the factors and the shape of a grid.
    """
    design = study.drawn if design is None else design
    n = design.size or 1
    columns = _columns(study, design, n)
    data = {}
    for name, parameter in PARAMETERS.items():
        attrs = {"units": parameter.units, "long_name": parameter.long_name, "symbol": parameter.symbol}
        data[name] = ("case", columns.pop(name), attrs)
    for name in case_columns(columns)[len(PARAMETERS) :]:
        attrs = {"long_name": name.replace("_", " ")}
        data[name] = ("case", np.array([str(v) for v in columns.pop(name)], dtype=object), attrs)
    coords: dict[str, Any] = {"case": ("case", np.arange(n), {"long_name": "case number", "units": "1"})}
    for name, values in columns.items():
        coords[name] = ("case", readable(values), {"long_name": name.replace("_", " ")})
    dataset = xr.Dataset(data, coords)
    shape = design.meta.get("shape") if design.method == "grid" else None
    dataset.attrs = {
        "study": study.name,
        "design": design.method,
        "seed": study.config.seed,
        "factors": json.dumps(list(design.factors)),
        "grid_shape": json.dumps(list(shape) if shape is not None else None),
    }
    return dataset


def _columns(study: Study, design: SampledDesign, n: int) -> dict[str, np.ndarray]:
    """Return every case field and every further factor as a column of n values."""
    base = {name: parameter.default for name, parameter in PARAMETERS.items()}
    base |= {name: _DEFAULT_MATERIAL for name in MATERIAL_FIELDS} | study.config.base
    base.pop("material_pair", None)
    if pair := study.config.base.get("material_pair"):
        base |= dict(zip(MATERIAL_FIELDS, pair, strict=True))
    columns: dict[str, np.ndarray] = {}
    for name, value in base.items():
        columns[name] = np.full(n, value, dtype=object if isinstance(value, str) or value is None else float)
    columns |= design.columns
    if "material_pair" in columns:
        pairs = columns.pop("material_pair")
        if any(isinstance(p, str) for p in pairs):  # a table's cell: "roller / guide"
            pairs = np.array([None, *map(_split_pair, pairs)], dtype=object)[1:]
        for i, name in enumerate(MATERIAL_FIELDS):
            columns[name] = np.array([pair[i] for pair in pairs], dtype=object)
    if "friction_coefficient" not in study.config.base and "friction_coefficient" not in design.columns:
        if "friction_law" in columns:
            columns["friction_coefficient"] = own_frictions(columns["friction_law"])
    columns["friction_coefficient"] = _friction(study, columns)
    for name in PARAMETERS:
        columns[name] = columns[name].astype(float)  # None becomes NaN
    return columns


def _split_pair(text: str) -> tuple[str, str]:
    parts = [part.strip() for part in str(text).split("/")]
    if len(parts) != 2 or not all(parts):
        raise InputError("material_pair", text, "a pair written 'roller material / guide material'")
    return parts[0], parts[1]


def _friction(study: Study, columns: dict[str, np.ndarray]) -> np.ndarray:
    """Return friction coefficients as numbers; the pair of materials decides where there is a level or nothing."""
    values = columns["friction_coefficient"]
    if values.dtype != object:
        return values

    @functools.cache
    def known(value: Any, roller: str, guide: str) -> float:
        if isinstance(value, (int, float)) and not math.isnan(value):
            return float(value)
        level = value if isinstance(value, str) and value in FRICTION_LEVELS else "typical"
        return float(study.materials.friction(roller, guide, level=level).value)

    rows = zip(values, *(columns[name].astype(str) for name in MATERIAL_FIELDS), strict=True)
    return np.array([known(*row) for row in rows])


def check_materials(study: Study) -> None:
    """Check that the database has every material of a study, with the scatter that its analysis needs.

    Parameters
    ----------
    study : the study

    Raises
    ------
    InputError : an unknown material, or a material without scatter
    """
    pairs = [*study.factors.get("material_pair", {}).get("values", [])]
    if "material_pair" in study.config.base:
        pairs.append(study.config.base["material_pair"])
    used = {}
    for i, name in enumerate(MATERIAL_FIELDS):
        given = [study.config.base[name]] if name in study.config.base else []
        given += [*study.factors.get(name, {}).get("values", []), *(pair[i] for pair in pairs)]
        materials = dict.fromkeys(given or [_DEFAULT_MATERIAL])
        used[name.removesuffix("_material")] = [study.materials.material(material) for material in materials]
    check_scatter(study.config, used)


def check_geometry(study: Study) -> None:
    """Check that no combination of the geometry's levels or ends of ranges conforms or interlocks.

    Parameters
    ----------
    study : the study

    Raises
    ------
    InputError : a combination for which roller and guide cannot touch in two points

    Notes
    -----
    Relative curvatures are monotonic in each of the quantities, so the ends of a range decide. Expressions and
    tables are checked on the whole design before anything is solved.
    """
    config = study.config
    if config.design == "table" or any(factor.kind == "expression" for factor in study.parsed.values()):
        design = build(study)
        problem = geometry_problem({name: design[name].values for name in _GEOMETRY})
    else:
        levels = [_ends(study, name) for name in _GEOMETRY]
        if math.prod(map(len, levels)) > MAX_CASES:
            raise InputError("design", "grid of the geometry", f"at most {MAX_CASES} cases")
        rows = np.array(list(itertools.product(*levels)), dtype=float)
        problem = geometry_problem({name: rows[:, i] for i, name in enumerate(_GEOMETRY)})
    if problem is not None:
        where = "factors" if problem.field in study.factors else "base"
        raise InputError(f"{where}.{problem.field}", problem.value, problem.allowed, problem.remedy)


def _ends(study: Study, name: str) -> list[float]:
    factor = study.parsed.get(name)
    if factor is None:
        return [study.config.base.get(name, PARAMETERS[name].default)]
    if factor.discrete:
        return [float(level) for level in factor.levels]
    if factor.kind == "normal":
        return [factor.numbers[0]]
    low, high = factor.numbers[-2:] if factor.kind == "truncnormal" else (factor.numbers[0], factor.numbers[-1])
    if low < 0 < high and PARAMETERS[name].nonzero:
        raise InputError(f"factors.{name}", [low, high], f"{PARAMETERS[name].allowed()}: the range holds 0")
    return [low, high]
