"""One roller in one situation (`Case`), and how cases of any form become arrays (`to_table`)."""

from __future__ import annotations

import functools
import json
import math
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, fields, make_dataclass
from typing import Any, ClassVar

import numpy as np

from trackroller.errors import Collector, InputError, check_names
from trackroller.materials import Material, MaterialDatabase, load_database
from trackroller.numerics.rows import once_each
from trackroller.parameters import (
    FRICTION_LEVELS,
    MAPPING_FIELDS,
    MATERIAL_FIELDS,
    MECHANICAL_MAPPINGS,
    OF_LIMITS,
    PARAMETERS,
)
from trackroller.parameters.example import EXAMPLE, Default, DefaultName
from trackroller.roller.aliases import RADII, renamed, with_axis_distance
from trackroller.roller.fields import FIELDS, mapping_text, number, own_friction, own_frictions
from trackroller.roller.geometry import geometry_problem
from trackroller.roller.table import CaseTable, MaterialArrays

__all__ = ["FIELDS", "Case", "CaseTable", "MaterialArrays", "geometry_problem", "to_table"]


_Numbers: Any = make_dataclass(
    "_Numbers",
    [(name, Any, field(default=EXAMPLE.get(name), kw_only=name in OF_LIMITS)) for name in PARAMETERS]
    + [(name, Any, field(default=EXAMPLE[name])) for name in MATERIAL_FIELDS]
    + [(name, Any, field(default=None, kw_only=name not in MECHANICAL_MAPPINGS)) for name in MAPPING_FIELDS],
    frozen=True,
)


@dataclass(frozen=True)
class Case(_Numbers):
    """One locating-bearing track roller on its guideway.

    The defaults are the driven example of the publication. A plain mapping with the same keys is accepted wherever a
    `Case` is.

    Parameters
    ----------
    axis_distance : float
        A_T, distance of the roller's axis to the centre of the guide contour, > 0 [mm].
    guide_profile_radius : float
        r_C,G, radius of the convex guide contour, > 0 [mm].
    roller_profile_radius : float
        r_C,TR, radius of the roller's contour [mm]: < 0 for a concave groove, > 0 for a convex roller, inf if straight.
    guide_curve_radius : float
        r_Curve, curve of the track [mm]: > 0 convex towards the roller, < 0 concave, inf if straight.
    contact_angle : float
        alpha, inclination of the contact normals, between 0 and 90 [deg].
    radial_force : float
        F_rad < 0, which presses the roller on the guide [N].
    axial_force : float
        F_ax along +x_R [N].
    motor_force : float
        F_Motor [N]: < 0 driving, 0 free rolling, > 0 braking.
    friction_coefficient : float, str or None
        Coulomb coefficient of both contacts at rest, 0 to 2 [1]. None or "typical" takes the typical value of the pair
        of materials from the friction database, "upper" and "lower" its bounds. If it is not given, it is 0.3, or the
        first value of a `friction_law` given as a table.
    velocity : float
        v, mean travel speed, > 0 [m/min]. It matters to friction power, to life in hours and to friction laws.
    guide_overrollings_per_hour : float or None
        n_G, overrollings of a point of the guide, > 0 [1/h]. Without it, the guide's life in hours is NaN.
    roller_material, guide_material : str, mapping or Material
        Name in the material database, or the values of a material.
    friction_law : mapping or None
        Friction as a function of the slip speed; see `trackroller.contact.friction_laws.canonical`.
    guide_profile, roller_profile : mapping or None
        Drawn or measured cross-sections, for the option `normal="halfspace"`; see
        `trackroller.contact.profiles.canonical`.
    permissible_radial_force : float or None
        Permissible radial force of ring or stud, > 0 [N], for the limit `bearing`.
    heat_transfer_coefficient, cooled_area, ambient_temperature : float or None
        Heat transfer of the roller [W/(m2 K)], the surface that loses heat [mm2] and the temperature of the air [degC],
        for the limit `heat`.
    permissible_wear_depth : float or None
        Wear depth that ends the life [mm], for the limit `wear`.
    travel : float
        Travel after which the case is solved with the profiles worn until then, >= 0 [km]; needs normal="halfspace".
    required_travel, wear_coefficient_factor : float or None
        Travel that the limit `wear` has to allow [km], and a factor on the wear coefficients [1].
    placeholder_position : float
        Place of the placeholders of materials in their ranges: -1 the worse end, 0 the value, 1 the better end [1].
    bearing, catalogue, wear_table : mapping or None
        Bearing inside the roller, limits of a maker's catalogue, and table of the energy law of wear; see "Parameters,
        options and results".

    Attributes
    ----------
    not_given : tuple of str
        Parameters that were not given, whose values are those of the paper's example.

    Raises
    ------
    InputError
        If a value lies outside its range, or if the surfaces conform or interlock. The message names the field, its
        value, what is allowed and what to do.

    Examples
    --------
    >>> import trackroller as tr
    >>> case = tr.Case(motor_force=0, friction_coefficient=0.1, guide_curve_radius=float("inf"))
    >>> case.contact_angle
    30.0
    >>> tr.Case(contact_angle=95)
    Traceback (most recent call last):
    trackroller.errors.InputError: contact_angle = 95 is not usable: contact angle [deg] must be a number, \
>= 1e-06 deg, < 90 deg, finite
    """

    not_given: ClassVar[tuple[str, ...]] = ()

    def __post_init__(self) -> None:
        columns: dict[str, np.ndarray] = {}
        wrong = Collector()
        if isinstance(self.friction_coefficient, Default):
            with suppress(InputError):  # a wrong law is refused below
                object.__setattr__(self, "friction_coefficient", own_friction(self.friction_law))
        missing = tuple(name for name, value in vars(self).items() if isinstance(value, (Default, DefaultName)))
        object.__setattr__(self, "not_given", missing)
        for name in PARAMETERS:
            with wrong.part():
                columns[name] = np.array([self._checked_number(name)])
        for name in (*MATERIAL_FIELDS, *MAPPING_FIELDS):
            with wrong.part():
                object.__setattr__(self, name, _checked_word(name, getattr(self, name)))
        wrong.check()
        problem = geometry_problem(columns)
        if problem is not None:
            raise problem

    def _checked_number(self, name: str) -> float:
        """Return a number of this case, which then stands as a float or None in its field; NaN if it is not given."""
        value, parameter = getattr(self, name), PARAMETERS[name]
        if name == "friction_coefficient" and isinstance(value, str) and value in FRICTION_LEVELS:
            return math.nan
        if value is not None and isinstance(value, float) and math.isnan(value):
            raise InputError(name, value, parameter.allowed())
        given = number(name, value)
        if not parameter.accepts(given):
            raise InputError(name, value, parameter.allowed(), parameter.remedy(given))
        object.__setattr__(self, name, None if math.isnan(given) else given)
        return given

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> Case:
        """Return the case of a mapping with the same keys.

        Raises
        ------
        InputError
            For an unknown key, with the most similar known key, and for every value that `Case` refuses.
        """
        if not isinstance(values, Mapping):
            raise InputError("case", values, "a case is a mapping of parameter names to values")
        wrong = Collector()
        with wrong.part():
            values = renamed(values)
            values = with_axis_distance(values, number)
        with wrong.part():
            check_names("case field", map(str, values), (*FIELDS, *RADII))
        with wrong.part():
            case = cls(**{str(k): v for k, v in values.items() if str(k) in FIELDS})
        wrong.check()
        return case

    def as_dict(self) -> dict[str, Any]:
        """Return the case as a plain mapping, one entry for each field."""
        return {field.name: getattr(self, field.name) for field in fields(self)}


def _checked_word(name: str, value: Any) -> Any:
    """Return a material, or a mapping with the values that it may leave out."""
    if name in MAPPING_FIELDS:
        text = mapping_text(name, value)
        return json.loads(text) if text else None
    if not isinstance(value, (str, Mapping, Material)) or value == "":
        allowed = "a material is a name of the database or a mapping with its values"
        raise InputError(name, value, allowed, "`trackroller materials list` shows the names.")
    return str(value) if isinstance(value, DefaultName) else value


def _of_cases(cases: Any) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Return the raw values of cases, object arrays (n,), and their numbers, (n,), which each `Case` has checked."""
    if isinstance(cases, (Case, Mapping)):
        cases = [cases]
    if not isinstance(cases, Iterable) or isinstance(cases, (str, bytes)) or getattr(cases, "ndim", 1) == 0:
        raise InputError("cases", cases, "a Case, a mapping, a list of them or an xarray.Dataset")
    rows = [c if isinstance(c, Case) else Case.from_dict(c) for c in cases]
    columns, numbers = {}, {}
    for name in FIELDS:
        values = [getattr(row, name) for row in rows]
        if name in PARAMETERS:
            numbers[name] = np.array([math.nan if isinstance(v, str) else v for v in values], dtype=float)  # or None
        if name not in numbers or name == "friction_coefficient":
            columns[name] = np.empty(len(rows), dtype=object)
            columns[name][:] = values
    return columns, numbers


def _of_dataset(design: Any) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Return the raw values of a design, object or float arrays (n,), and its checked numbers, (n,)."""
    n = design.sizes.get("case", 1)
    columns = {}
    check_names("design variable", design.data_vars, FIELDS)
    default = Case().as_dict()
    for name in FIELDS:
        if name in design.data_vars:
            variable = design[name]
            if set(variable.dims) - {"case"}:
                raise InputError(name, tuple(variable.dims), "a design has the dimension 'case' only")
            values = variable.values
        else:
            values = np.array(default[name], dtype=object)
            if name == "friction_coefficient" and "friction_law" in design.data_vars:
                values = own_frictions(design["friction_law"].values)
        columns[name] = np.broadcast_to(values if values.dtype == float else values.astype(object), (n,))
    numbers = _checked_numbers(columns, n)
    problem = geometry_problem(numbers) if n else None
    if problem is not None:
        raise problem
    return columns, numbers


def _checked_numbers(columns: Mapping[str, np.ndarray], n: int) -> dict[str, np.ndarray]:
    numbers = {}
    for name, parameter in PARAMETERS.items():
        raw = columns[name]
        if raw.dtype.kind in "fiu" or set(map(type, raw)) <= {float, int, Default, type(None)}:
            try:
                numbers[name] = raw.astype(float)  # None becomes NaN
            except OverflowError:  # an integer with hundreds of digits
                numbers[name] = np.array([number(name, v) for v in raw], dtype=float)
        else:
            words = FRICTION_LEVELS if name == "friction_coefficient" else ()
            numbers[name] = np.array(
                [math.nan if isinstance(v, str) and v in words else number(name, v) for v in raw], dtype=float
            ).reshape(n)
        good = parameter.accepts(numbers[name])
        if not good.all():
            bad = int(np.argmin(good))
            remedy = parameter.remedy(float(numbers[name][bad]))
            raise InputError(f"{name} (case {bad})", raw[bad : bad + 1].tolist()[0], parameter.allowed(), remedy)
    return numbers


def to_table(cases: Any, database: MaterialDatabase | None = None) -> CaseTable:
    """Return the checked arrays of cases, with materials and friction taken from the database.

    Parameters
    ----------
    cases : Case, mapping, list of them, or xarray.Dataset
        A data set has one variable for each parameter along the dimension `case`; other parameters take their default.
    database : MaterialDatabase, optional
        The materials; by default the built-in ones with the user's own over them.

    Returns
    -------
    CaseTable
        Arrays of shape (n,).

    Raises
    ------
    InputError
        For the first bad value, unknown name or contradicting geometry.
    """
    database = load_database() if database is None else database
    if not isinstance(database, MaterialDatabase):
        raise InputError("database", database, "a MaterialDatabase", "`tr.load_database(path)` reads one.")
    columns, numbers = (_of_dataset if hasattr(cases, "data_vars") else _of_cases)(cases)
    roller, guide = (once_each(database.material, columns[name]) for name in MATERIAL_FIELDS)
    friction = numbers["friction_coefficient"].copy()
    for i in np.flatnonzero(np.isnan(friction)):
        level = columns["friction_coefficient"][i]
        level = level if isinstance(level, str) else "typical"
        friction[i] = database.friction(roller[i], guide[i], level=level).value
    numbers["friction_coefficient"] = friction
    keys = list(zip(map(id, roller), map(id, guide), numbers["placeholder_position"].tolist(), strict=True))
    pairs = dict(zip(keys, zip(roller, guide, strict=True), strict=True))  # each combination once
    bodies = {key: [database.on(*way).moved(key[2]) for way in (pair, pair[::-1])] for key, pair in pairs.items()}
    roller, guide = ([bodies[key][i] for key in keys] for i in (0, 1))
    texts = {name: _texts(name, columns[name]) for name in MAPPING_FIELDS}
    return CaseTable(**numbers, **texts, roller=MaterialArrays.of(roller), guide=MaterialArrays.of(guide))


def _texts(name: str, column: np.ndarray) -> np.ndarray:
    """Return the canonical texts of a column of mappings; each distinct mapping is checked once."""
    if np.all(column == ""):  # most studies have no mapping, and a loop over a million cases takes seconds
        return column
    out = np.empty(column.size, dtype=object)
    out[:] = once_each(functools.partial(mapping_text, name), column)
    return out
