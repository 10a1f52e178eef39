"""One roller in one situation (`Case`), and many of them as arrays (`CaseTable`)."""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from trackroller.contact import friction_laws, profiles
from trackroller.errors import InputError, unknown_name
from trackroller.parameters import FRICTION_LEVELS, MAPPING_FIELDS, MATERIAL_FIELDS, PARAMETERS
from trackroller.roller.geometry import curvatures, rolling_radius
from trackroller.roller.point_files import read_points

if TYPE_CHECKING:
    from trackroller.materials import Material, MaterialDatabase

FIELDS = (*PARAMETERS, *MATERIAL_FIELDS, *MAPPING_FIELDS)


def mapping_text(name: str, value: Any) -> str:
    """Canonical JSON of an entry that is a mapping (or its JSON), '' for none; raises `InputError`."""
    if value is None or (isinstance(value, str) and not value.strip()):
        return ""
    if isinstance(value, str):
        try:
            value = json.loads(value)
        except ValueError:
            raise InputError(name, value, "a mapping, or one written as JSON") from None
    if not isinstance(value, Mapping):
        raise InputError(name, value, "a mapping, or not given")
    told = (
        friction_laws.canonical(value, name) if name == "friction_law" else profiles.canonical(value, name, read_points)
    )
    return json.dumps(told, sort_keys=True) if told else ""


def _number(name: str, value: Any) -> float:
    parameter = PARAMETERS[name]
    if value is None and parameter.allow_missing:
        return math.nan
    if isinstance(value, bool):
        raise InputError(name, value, parameter.allowed())
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise InputError(name, value, parameter.allowed()) from None


class Default(float):
    """The value of a number that was not given."""


def _own_friction(law: Any) -> float:
    """Friction at rest of a case that gives none: that of a table, else the default."""
    if not law:
        return PARAMETERS["friction_coefficient"].default
    from trackroller.contact.friction_laws import at_rest

    own = at_rest(law)
    return PARAMETERS["friction_coefficient"].default if own is None else own


@dataclass(frozen=True)
class Case:
    """One locating-bearing track roller on its guideway; the defaults are the paper's driven example.

    Units and signs are those of `trackroller.parameters.PARAMETERS`. A material is a name of the database
    or a mapping with its values. `friction_coefficient=None` takes the typical value of the material
    pair ('upper' or 'lower' take the bounds); not given, it is 0.3, or that at rest of a `friction_law` given as a
    table. `friction_law` lets friction depend on the slip speed (see
    `trackroller.contact.friction_laws.canonical`), `guide_profile` and `roller_profile` are drawn or measured
    cross-sections for `normal="halfspace"` (see `trackroller.contact.profiles.canonical`).

    Raises `InputError` for a value outside its range and for
    surfaces that conform or interlock.
    """

    axis_distance: float = PARAMETERS["axis_distance"].default
    guide_profile_radius: float = PARAMETERS["guide_profile_radius"].default
    roller_profile_radius: float = PARAMETERS["roller_profile_radius"].default
    guide_curve_radius: float = PARAMETERS["guide_curve_radius"].default
    contact_angle: float = PARAMETERS["contact_angle"].default
    radial_force: float = PARAMETERS["radial_force"].default
    axial_force: float = PARAMETERS["axial_force"].default
    motor_force: float = PARAMETERS["motor_force"].default
    friction_coefficient: float | str | None = Default(PARAMETERS["friction_coefficient"].default)
    velocity: float = PARAMETERS["velocity"].default
    guide_overrollings_per_hour: float | None = None
    roller_material: Any = "1.7225-normalised"
    guide_material: Any = "1.7225-normalised"
    friction_law: Any = None
    guide_profile: Any = None
    roller_profile: Any = None

    def __post_init__(self) -> None:
        columns: dict[str, np.ndarray] = {}
        if isinstance(self.friction_coefficient, Default):
            object.__setattr__(self, "friction_coefficient", _own_friction(self.friction_law))
        for name, parameter in PARAMETERS.items():
            value = getattr(self, name)
            if name == "friction_coefficient" and isinstance(value, str) and value in FRICTION_LEVELS:
                columns[name] = np.array([math.nan])
                continue
            if value is not None and isinstance(value, float) and math.isnan(value):
                raise InputError(name, value, parameter.allowed())
            number = _number(name, value)
            if not parameter.accepts(number):
                raise InputError(name, value, parameter.allowed())
            object.__setattr__(self, name, None if math.isnan(number) else number)
            columns[name] = np.array([number])
        for name in MATERIAL_FIELDS:
            _check_material_kind(name, getattr(self, name))
        for name in MAPPING_FIELDS:
            text = mapping_text(name, getattr(self, name))
            object.__setattr__(self, name, json.loads(text) if text else None)
        problem = geometry_problem(columns)
        if problem is not None:
            raise problem

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> Case:
        """Case from a mapping with the same keys; unknown keys are refused with the nearest right one."""
        if not isinstance(values, Mapping):
            raise InputError("case", values, "a case is a mapping of parameter names to values")
        for key in values:
            if key not in FIELDS:
                raise unknown_name("case field", str(key), FIELDS)
        return cls(**{str(k): v for k, v in values.items()})

    def as_dict(self) -> dict[str, Any]:
        """The case as a plain mapping, one entry a field."""
        return {field.name: getattr(self, field.name) for field in dataclasses.fields(self)}


def _check_material_kind(name: str, value: Any) -> None:
    from trackroller.materials import Material

    if not isinstance(value, (str, Mapping, Material)) or value == "":
        raise InputError(
            name,
            value,
            "a material is a name of the database or a mapping with its values",
            "`trackroller materials list` shows the names.",
        )


def geometry_problem(columns: Mapping[str, np.ndarray]) -> InputError | None:
    """The first physical contradiction among the geometry of cases, or None.

    Checks that the rolling radius is positive and that both relative curvatures are positive: else the
    surfaces conform or interlock and there is no point contact.
    """
    get = {
        name: np.atleast_1d(np.asarray(columns[name], dtype=float))
        for name in (
            "axis_distance",
            "guide_profile_radius",
            "roller_profile_radius",
            "guide_curve_radius",
            "contact_angle",
        )
    }
    get = dict(zip(get, np.broadcast_arrays(*get.values()), strict=True))
    alpha = np.deg2rad(get["contact_angle"])
    radius = rolling_radius(get["axis_distance"], get["guide_profile_radius"], alpha)
    bad = np.flatnonzero(~(radius > 0))
    if bad.size:
        i = bad[0]
        limit = get["guide_profile_radius"][i] * np.cos(alpha[i])
        return InputError(
            "axis_distance",
            float(get["axis_distance"][i]),
            f"the rolling radius A_T - r_C,G cos(alpha) = {radius[i]:.6g} mm must be > 0",
            f"Use an axis_distance above {limit:.6g} mm.",
        )
    k_x, k_y = curvatures(
        get["roller_profile_radius"], get["guide_profile_radius"], get["guide_curve_radius"], radius, alpha
    )
    bad = np.flatnonzero(~(k_x > 0))
    if bad.size:
        i = bad[0]
        groove = get["guide_profile_radius"][i]
        return InputError(
            "roller_profile_radius",
            float(get["roller_profile_radius"][i]),
            f"the surfaces conform or interlock: 1/r_C,TR + 1/r_C,G = {k_x[i]:.6g} 1/mm must be > 0",
            f"Use a groove wider than the guide (roller_profile_radius below {-groove:.6g} mm)"
            " or a convex roller (> 0).",
        )
    bad = np.flatnonzero(~(k_y > 0))
    if bad.size:
        i = bad[0]
        return InputError(
            "guide_curve_radius",
            float(get["guide_curve_radius"][i]),
            f"the surfaces conform or interlock: cos(alpha)/r_A + cos(alpha)/r_Curve = {k_y[i]:.6g} 1/mm must be > 0",
            f"Use an inner curve wider than the roller (guide_curve_radius below {-radius[i]:.6g} mm),"
            " a straight (inf) or an outer curve (> 0).",
        )
    return None


@dataclass(frozen=True)
class MaterialArrays:
    """Material values of one body along the case axis, each of shape (n,)."""

    name: np.ndarray
    youngs_modulus: np.ndarray
    poisson_ratio: np.ndarray
    tensile_strength: np.ndarray
    fatigue_limit: np.ndarray
    cycles_at_tensile_strength: np.ndarray
    cycles_at_fatigue_limit: np.ndarray

    def take(self, index: np.ndarray) -> MaterialArrays:
        """The rows `index`."""
        return MaterialArrays(*(getattr(self, f.name)[index] for f in dataclasses.fields(self)))


@dataclass(frozen=True)
class CaseTable:
    """Cases as arrays of shape (n,), units as in `PARAMETERS`; the friction coefficient is resolved.

    Mappings (friction law, drawn profiles) stand as canonical JSON in arrays of str objects, '' for none.
    """

    axis_distance: np.ndarray
    guide_profile_radius: np.ndarray
    roller_profile_radius: np.ndarray
    guide_curve_radius: np.ndarray
    contact_angle: np.ndarray
    radial_force: np.ndarray
    axial_force: np.ndarray
    motor_force: np.ndarray
    friction_coefficient: np.ndarray
    velocity: np.ndarray
    guide_overrollings_per_hour: np.ndarray
    roller: MaterialArrays
    guide: MaterialArrays
    friction_law: np.ndarray
    guide_profile: np.ndarray
    roller_profile: np.ndarray

    def __len__(self) -> int:
        return len(self.axis_distance)

    def take(self, index: np.ndarray) -> CaseTable:
        """The rows `index`."""
        numbers = {name: getattr(self, name)[index] for name in (*PARAMETERS, *MAPPING_FIELDS)}
        return CaseTable(**numbers, roller=self.roller.take(index), guide=self.guide.take(index))


def _as_columns(cases: Any) -> tuple[dict[str, np.ndarray], int]:
    """Columns of raw values (object arrays for materials) from anything `solve` accepts."""
    if hasattr(cases, "data_vars"):
        return _columns_of_dataset(cases)
    if isinstance(cases, (Case, Mapping)):
        cases = [cases]
    if not isinstance(cases, Iterable) or isinstance(cases, (str, bytes)):
        raise InputError("cases", cases, "a Case, a mapping, a list of them or an xarray.Dataset")
    rows = [c if isinstance(c, Case) else Case.from_dict(c) for c in cases]
    columns = {}
    for name in FIELDS:
        column = np.empty(len(rows), dtype=object)
        column[:] = [getattr(row, name) for row in rows]
        columns[name] = column
    return columns, len(rows)


def own_frictions(laws: np.ndarray) -> np.ndarray:
    """Friction coefficients (n,) of cases that give none, from their friction laws (n,)."""
    known = {repr(law): _own_friction(law) for law in np.ravel(laws)}
    return np.array([known[repr(law)] for law in np.ravel(laws)]).reshape(np.shape(laws))


def _columns_of_dataset(design: Any) -> tuple[dict[str, np.ndarray], int]:
    n = design.sizes.get("case", 1)
    columns = {}
    for name in design.data_vars:
        if name not in FIELDS:
            raise unknown_name("design variable", str(name), FIELDS)
    default = Case().as_dict()
    for name in FIELDS:
        if name in design.data_vars:
            variable = design[name]
            if set(variable.dims) - {"case"}:
                raise InputError(name, tuple(variable.dims), "a design has the dimension 'case' only")
            values = variable.values.astype(object)
        else:
            values = np.array(default[name], dtype=object)
            if name == "friction_coefficient" and "friction_law" in design.data_vars:
                values = own_frictions(design["friction_law"].values)
        column = np.empty(n, dtype=object)
        column[:] = np.broadcast_to(values, (n,))
        columns[name] = column
    return columns, n


def _checked_numbers(columns: Mapping[str, np.ndarray], n: int) -> dict[str, np.ndarray]:
    numbers = {}
    for name, parameter in PARAMETERS.items():
        raw = columns[name]
        try:
            numbers[name] = raw.astype(float)  # None becomes NaN
        except (TypeError, ValueError):
            words = FRICTION_LEVELS if name == "friction_coefficient" else ()
            numbers[name] = np.array(
                [math.nan if isinstance(v, str) and v in words else _number(name, v) for v in raw], dtype=float
            ).reshape(n)
        bad = np.flatnonzero(~parameter.accepts(numbers[name]))
        if bad.size:
            raise InputError(f"{name} (case {bad[0]})", raw[bad[0]], parameter.allowed())
    return numbers


def _material_arrays(column: np.ndarray, database: MaterialDatabase) -> tuple[MaterialArrays, list[Material]]:
    cache: dict[str, Material] = {}
    materials = []
    for value in column:
        key = value if isinstance(value, str) else repr(value)
        if key not in cache:
            cache[key] = database.material(value)
        materials.append(cache[key])

    def values(attribute: str) -> np.ndarray:
        return np.array([getattr(m, attribute) for m in materials], dtype=float)

    return MaterialArrays(
        name=np.array([m.name for m in materials], dtype=object),
        youngs_modulus=values("youngs_modulus"),
        poisson_ratio=values("poisson_ratio"),
        tensile_strength=values("tensile_strength"),
        fatigue_limit=values("fatigue_strength_ratio") * values("tensile_strength"),
        cycles_at_tensile_strength=values("cycles_at_tensile_strength"),
        cycles_at_fatigue_limit=values("cycles_at_fatigue_limit"),
    ), materials


def to_table(cases: Any, database: MaterialDatabase | None = None) -> CaseTable:
    """Validated arrays of the cases, with materials and friction taken from the database.

    Parameters
    ----------
    cases : `Case`, mapping, list of them, or xarray.Dataset with dimension `case`
    database : the materials; the built-in and the user's own if not given

    Raises `InputError` for the first bad value, unknown name or contradicting geometry.
    """
    from trackroller.materials import load_database

    database = load_database() if database is None else database
    columns, n = _as_columns(cases)
    numbers = _checked_numbers(columns, n)
    problem = geometry_problem(numbers) if n else None
    if problem is not None:
        raise problem
    roller, roller_materials = _material_arrays(columns["roller_material"], database)
    guide, guide_materials = _material_arrays(columns["guide_material"], database)
    friction = numbers["friction_coefficient"].copy()
    for i in np.flatnonzero(np.isnan(friction)):
        level = columns["friction_coefficient"][i]
        level = level if isinstance(level, str) else "typical"
        friction[i] = database.friction(roller_materials[i], guide_materials[i], level=level).value
    numbers["friction_coefficient"] = friction
    texts = {name: _texts(name, columns[name]) for name in MAPPING_FIELDS}
    return CaseTable(**numbers, **texts, roller=roller, guide=guide)


def _texts(name: str, column: np.ndarray) -> np.ndarray:
    """Canonical texts of a column of mappings, each distinct one checked once."""
    known: dict[str, str] = {}
    out = np.empty(column.size, dtype=object)
    for i, value in enumerate(column):
        key = value if isinstance(value, str) else "" if value is None else repr(value)
        if key not in known:
            known[key] = mapping_text(name, value)
        out[i] = known[key]
    return out
