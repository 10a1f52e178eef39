"""One roller in one situation (`Case`), and how cases of any form become arrays (`to_table`)."""

from __future__ import annotations

import functools
import inspect
import json
import math
from collections.abc import Container, Hashable, Iterable, Mapping, Set
from contextlib import suppress
from dataclasses import dataclass, field, fields, make_dataclass
from typing import Any, ClassVar

import numpy as np

from trackroller.damage.own import check_fields
from trackroller.errors import Collector, InputError, raise_all, unknown_name
from trackroller.materials import Material, MaterialDatabase, load_database
from trackroller.numerics.plain import how_to_write, mapping_of, plain, rows_of
from trackroller.numerics.rows import once_each
from trackroller.numerics.units import in_unit, stated_unit
from trackroller.parameters import (
    FRICTION_LEVELS,
    MAPPING_FIELDS,
    MATERIAL_FIELDS,
    MECHANICAL_MAPPINGS,
    OF_LIMITS,
    OPTIONS,
    PARAMETERS,
)
from trackroller.parameters.example import EXAMPLE, Default, DefaultName
from trackroller.roller.aliases import ALIASES, RADII, radius, renamed, with_axis_distance
from trackroller.roller.case_table import CaseTable, MaterialArrays
from trackroller.roller.fields import FIELDS, mapping_text, number, own_friction, own_frictions
from trackroller.roller.geometry import geometry_problem

STUDY = "study"  # attribute of a design and of results: the study file as YAML
__all__ = ["FIELDS", "Case", "CaseTable", "MaterialArrays", "geometry_problem", "to_table"]


_Numbers: Any = make_dataclass(
    "_Numbers",
    [
        (name, Any, field(default=EXAMPLE.get(name), kw_only=name in OF_LIMITS))
        for name in PARAMETERS
    ]
    + [(name, Any, field(default=EXAMPLE[name])) for name in MATERIAL_FIELDS]
    + [
        (name, Any, field(default=None, kw_only=name not in MECHANICAL_MAPPINGS))
        for name in MAPPING_FIELDS
    ],
    frozen=True,
)


@dataclass(frozen=True, init=False)
class Case(_Numbers):
    """One locating-bearing track roller on its guideway.

    The defaults are the driven example of the publication. A plain mapping with the same keys is
    accepted wherever a `Case` is. Instead of `friction_coefficient` a case also takes `mu`, and
    instead of `axis_distance` both `outer_radius` and `groove_depth` of the roller [mm].

    Parameters
    ----------
    axis_distance : float
        A_T, distance of the roller's axis to the centre of the guide contour, > 0 [mm].
    guide_profile_radius : float
        r_C,G, radius of the convex guide contour, > 0 [mm].
    roller_profile_radius : float
        r_C,TR, radius of the roller's contour [mm]: < 0 for a concave groove, > 0 for a convex
        roller, inf if straight.
    guide_curve_radius : float
        r_Curve, curve of the track [mm]: > 0 convex towards the roller, < 0 concave, inf if
        straight.
    contact_angle : float
        alpha, inclination of the contact normals, between 0 and 90 [deg].
    radial_force : float
        F_rad < 0, which presses the roller on the guide [N].
    axial_force : float
        F_ax along +x_R [N].
    motor_force : float
        F_Motor [N]: < 0 driving, 0 free rolling, > 0 braking.
    friction_coefficient : float, str or None
        Coulomb coefficient of both contacts at rest, 0 to 2 [1]. None or "typical" takes the
        typical value of the pair of materials from the friction database, "upper" and "lower" its
        bounds, "dry" and "lubricated" the values of tables. If it is not given, it is 0.3, or the
        first value of a `friction_law` given as a table.
    layer_flexibility : float
        h/G_3, thickness over shear modulus of a film between the bodies, >= 0 [mm^3/N], for contact
        model 'kalker'.
    velocity : float
        v, mean travel speed, > 0 [m/min]. It matters to friction power, to life in hours and to
        friction laws.
    guide_overrollings_per_hour : float or None
        n_G, overrollings of a point of the guide, > 0 [1/h]. Without it, the guide's life in hours
        is NaN.
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
        Heat transfer of the roller [W/(m2 K)], the surface that loses heat [mm2] and the
        temperature of the air [degC], for the limit `heat`.
    permissible_temperature : float or None
        Permissible temperature of roller and guide [degC], for the limit `heat`; the smaller one of
        it and the `temperature_limit` of a material counts.
    permissible_wear_depth : float or None
        Wear depth that ends the life [mm], for the limit `wear`.
    travel : float
        Travel after which the case is solved with the profiles worn until then, >= 0 [km]; needs
        normal="halfspace".
    required_travel, wear_coefficient_factor : float or None
        Travel that the limit `wear` has to allow [km], and a factor on the wear coefficients [1],
        which replaces the ranges of their placeholders.
    placeholder_position : float or None
        Place of the placeholders of materials in their ranges: -1 the worse end, 0 the value, 1 the
        better end [1]. Without it, lives have the range between the ends.
    bearing, catalogue, wear_table, stud : mapping or None
        Bearing inside the roller, limits of a maker's catalogue, table of the energy law of wear,
        and stud or axle that carries the roller; see "Parameters, options and results".

    Attributes
    ----------
    not_given : tuple of str
        Parameters that were not given, whose values are those of the paper's example.
    radii : dict of str to float
        Outer radius and groove depth [mm] if they gave the axis distance; a copy with other values
        has none.

    Raises
    ------
    InputError
        If a value lies outside its range, or if the surfaces conform or interlock. The message
        names the field, its value, what is allowed and what to do.

    Examples
    --------
    >>> import trackroller as tr
    >>> case = tr.Case(motor_force=0, friction_coefficient=0.1, guide_curve_radius=float("inf"))
    >>> case.contact_angle
    30.0
    >>> tr.Case(contact_angle=95)
    Traceback (most recent call last):
    trackroller.errors.InputError: contact_angle = 95 is not usable. Allowed: a number for \
the contact angle [deg], >= 1e-06 deg, < 90 deg, finite. \
Write a number that is allowed, such as 30.
    """

    not_given: ClassVar[tuple[str, ...]] = ()
    radii: ClassVar[Mapping[str, float]] = {}

    def __init__(self, *values: Any, **named: Any) -> None:
        if values and isinstance(values[0], (Mapping, Case)):
            given = type(values[0]).__name__
            raise InputError(
                "case",
                given,
                "values by name, such as friction_coefficient=0.2",
                "Write Case(**values).",
            )
        super().__init__(*values, **_by_field(named))
        self._check()
        if RADII[0] in named:  # checked with the axis distance, which follows from them
            object.__setattr__(self, "radii", {name: radius(name, named[name]) for name in RADII})

    def _check(self) -> None:
        """Check every field, and keep its value as it is computed with."""
        numbers: dict[str, float] = {}
        wrong = Collector()
        for name, value in vars(self).copy().items():
            if not isinstance(value, (Default, DefaultName)):
                with wrong.part():
                    object.__setattr__(self, name, plain(value, name))
        wrong.check()
        if isinstance(self.friction_coefficient, Default):
            with suppress(InputError):  # a wrong law is refused below
                object.__setattr__(self, "friction_coefficient", own_friction(self.friction_law))
        missing = tuple(
            name for name, value in vars(self).items() if isinstance(value, (Default, DefaultName))
        )
        object.__setattr__(self, "not_given", missing)
        for name in PARAMETERS:
            with wrong.part():
                numbers[name] = self._checked_number(name)
        for name in (*MATERIAL_FIELDS, *MAPPING_FIELDS):
            with wrong.part():
                object.__setattr__(self, name, _checked_word(name, getattr(self, name)))
        wrong.check()
        problem = geometry_problem(numbers)
        if problem is not None:
            raise problem

    def _checked_number(self, name: str) -> float:
        """Return a number of this case, which then stands as a float or None in its field; NaN if
        it is not given.
        """
        value = getattr(self, name)
        parameter = PARAMETERS[name]
        if isinstance(value, list):
            remedy = f"Solve a list of cases: [tr.Case({name}=value) for value in values]."
            raise InputError(name, value, f"one number; {parameter.allowed()}", remedy)
        if name == "friction_coefficient" and isinstance(value, str) and value in FRICTION_LEVELS:
            return math.nan
        if value is not None and isinstance(value, float) and math.isnan(value):
            raise InputError(name, value, parameter.allowed(), parameter.remedy(value))
        given = number(name, value)
        if not parameter.accepts(given):
            raise InputError(name, value, parameter.allowed(), parameter.remedy(given, value))
        if math.isnan(given):
            object.__setattr__(self, name, None)
        else:
            object.__setattr__(self, name, given)
        return given

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> Case:
        """Return the case of a mapping with the same keys.

        Raises
        ------
        InputError
            For an unknown key, with the most similar known key, and for every value that `Case`
            refuses.
        """
        values = mapping_of(values)
        if not isinstance(values, Mapping):
            several = isinstance(values, (list, tuple)) or hasattr(values, "columns")
            remedy = ""
            if several:
                remedy = "Give each of them alone; tr.solve takes several cases."
            raise InputError(
                "case", type(values).__name__, "one case: parameter names and their values", remedy
            )
        return cls(**{str(name): value for name, value in values.items()})

    def as_dict(self) -> dict[str, Any]:
        """Return the case as a plain mapping, one entry for each field."""
        return {field.name: getattr(self, field.name) for field in fields(self)}


Case.__signature__ = inspect.signature(_Numbers)  # type: ignore[attr-defined]


def _by_field(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of one case by the names of its fields; `InputError` names every other
    name.
    """
    wrong = Collector()
    known = {name: value for name, value in values.items() if name not in ALIASES}
    with wrong.part():
        known = renamed(values)
        known = with_axis_distance(known, number)
    with wrong.part():
        check_fields("case field", known, (*FIELDS, *RADII))
    if wrong.errors:  # the errors of the other values belong to the same message
        with wrong.part():
            Case(**{name: value for name, value in known.items() if name in FIELDS})
    wrong.check()
    return known


def _checked_word(name: str, value: Any) -> Any:
    """Return a material, or a mapping with the values that it may leave out."""
    if name in MAPPING_FIELDS:
        text = mapping_text(name, value)
        return json.loads(text) if text else None
    if not isinstance(value, (str, Mapping, Material)) or value == "":
        allowed = "a name of the database or a mapping with its values"
        raise InputError(name, value, allowed, "`trackroller materials list` shows the names.")
    if isinstance(value, DefaultName):
        return str(value)
    return value


def is_single(cases: Any) -> bool:
    """Return whether cases are one case: a `Case`, a mapping, or a row of a data frame."""
    return isinstance(cases, Case) or isinstance(mapping_of(cases), Mapping)


def _listed(cases: Any) -> list[Case]:
    """Return cases of any form but a data set as a list; the first wrong case is refused with its
    number.
    """
    allowed = "a Case, a mapping, a list or data frame of cases, or an xarray.Dataset"
    if is_single(cases):
        return [_case(cases)]
    if hasattr(cases, "columns"):
        cases = rows_of(cases, "cases")
    elif hasattr(cases, "dims"):
        raise InputError(
            "cases",
            type(cases).__name__,
            allowed,
            "Write .to_dataset(), with a parameter as its name.",
        )
    elif isinstance(cases, Set):
        raise InputError("cases", type(cases).__name__, allowed, how_to_write(cases))
    elif (
        not isinstance(cases, Iterable)
        or isinstance(cases, (str, bytes))
        or getattr(cases, "ndim", 1) != 1
    ):
        remedy = "Write a list of mappings, such as [{'axial_force': 30}, {'axial_force': 60}]."
        shown: object = type(cases).__name__
        if np.isscalar(cases):
            shown = cases
        raise InputError("cases", shown, allowed, remedy)
    rows: list[Case] = []
    for case in cases:
        try:
            rows.append(_case(case))
        except InputError as error:
            place = f"(case {len(rows)})"
            raise_all(
                InputError(f"{one.field} {place}", one.value, one.allowed, one.remedy)
                for one in error.errors
            )
    return rows


def _case(values: Case | Mapping[str, Any]) -> Case:
    """Return a case, or that of a mapping."""
    if isinstance(values, Case):
        return values
    return Case.from_dict(values)


def _of_cases(cases: Any) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Return the raw values of cases, object arrays (n,), and their numbers, (n,), which each
    `Case` has checked.
    """
    columns = {}
    numbers = {}
    rows = _listed(cases)
    for name in FIELDS:
        values = [getattr(row, name) for row in rows]
        if name in PARAMETERS:
            column = np.array(values, dtype=object)
            # a word is a friction of the database
            column[[isinstance(value, str) for value in values]] = math.nan
            numbers[name] = column.astype(float)  # None becomes NaN
        if name not in numbers or name == "friction_coefficient":
            columns[name] = np.empty(len(rows), dtype=object)
            columns[name][:] = values
    return columns, numbers


def _of_dataset(design: Any) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Return the raw values of a design, object or float arrays (n,), and its checked numbers,
    (n,).
    """
    n = design.sizes.get("case", 1)
    design = _named(design)
    columns = {}
    default = Case().as_dict()
    for name in FIELDS:
        if name in design.variables:
            values = _in_own_unit(name, design[name])
        else:
            values = np.array(default[name], dtype=object)
            if name == "friction_coefficient" and "friction_law" in design.variables:
                values = own_frictions(design["friction_law"].values)
        if values.dtype != float:
            values = values.astype(object)
        columns[name] = np.broadcast_to(values, (n,))
    numbers = _checked_numbers(columns, n)
    problem = None
    if n:
        problem = geometry_problem(numbers)
    if problem is not None:
        raise problem
    return columns, numbers


def _named(design: Any) -> Any:
    """Return a data set of cases with the names of parameters in place of aliases.

    Every variable, coordinate and attribute that says something about the cases is a parameter
    along `case`, or an option as a coordinate, or it is refused by name. A study's design has
    further coordinates of its own.
    """
    wrong = Collector()
    of_study = STUDY in design.attrs
    short = [name for name in ALIASES if name in design.variables]
    with wrong.part():
        renamed(dict.fromkeys(design.variables, "a variable"))
        design = design.rename({name: ALIASES[name] for name in short})
    # it is refused above
    design = design.drop_vars([name for name in short if name in design.variables])
    known = {*FIELDS, *OPTIONS, "case"}
    known |= {dim for name in FIELDS if name in design.variables for dim in design[name].dims}
    attributes = design.attrs
    if of_study:
        known |= {*design.coords}
        attributes = {}
    for name in map(str, design.variables):
        with wrong.part():
            _check_variable(design, name, known)
    for name, value in attributes.items():
        with wrong.part():
            _check_attribute(str(name), value)
    wrong.check()
    return design


def _check_variable(design: Any, name: str, known: Container[Hashable]) -> None:
    """Refuse a variable that is neither a parameter along `case` nor an option as a coordinate."""
    if name in OPTIONS and name not in design.coords:
        remedy = f"Write ds.set_coords('{name}'), or give {name} to tr.solve."
        allowed = "an option of each case is a coordinate along 'case'"
        raise InputError(name, "a variable", allowed, remedy)
    if name not in known:
        raise _unknown(name, design.coords)
    if name in FIELDS and set(design[name].dims) - {"case"}:
        raise InputError(name, tuple(design[name].dims), *_along_case(design[name].dims))


def _check_attribute(name: str, value: Any) -> None:
    """Refuse an attribute that gives a parameter or an option."""
    if name in (*FIELDS, *ALIASES, *RADII, "material_pair"):
        remedy = f"Write ds.assign({name}={value!r})."
        raise InputError(name, "an attribute", "a parameter is a variable of the data set", remedy)
    if name in OPTIONS:
        remedy = f"Give it to the call: tr.solve(ds, {name}={value!r}), and remove the attribute."
        raise InputError(name, "an attribute", "an argument of tr.solve", remedy)


def _unknown(name: str, coordinates: Container[Hashable]) -> InputError:
    """Return the error for a variable or coordinate of a data set of cases that is no parameter."""
    kind = "variable"
    if name in coordinates:
        kind = "coordinate"
    if name in RADII:
        remedy = "Give axis_distance, or solve ds.to_dataframe(), whose rows may have both radii."
        return InputError(name, f"a {kind}", "the axis distance in a data set", remedy)
    if name == "material_pair":
        return InputError(
            name,
            f"a {kind}",
            "the variables roller_material and guide_material",
            "Give both of them.",
        )
    error = unknown_name(f"design {kind}", name, (*FIELDS, *ALIASES))
    drop = f"Remove a {kind} that is no parameter with ds.drop_vars('{name}')."
    return InputError(error.field, name, error.allowed, f"{error.remedy} {drop}")


def _along_case(dims: tuple[Any, ...]) -> tuple[str, str]:
    """Return what is allowed instead of a variable along other dimensions, and what to do."""
    names = [str(dim) for dim in dims if dim != "case"]
    if "case" in dims:
        remedy = f"Select one place along {names[0]}: ds.isel({names[0]}=0)."
    elif len(names) == 1 and names[0] not in FIELDS:
        remedy = f"Write ds.rename({names[0]}='case')."
    else:
        remedy = f"Write ds.stack(case={names})."
    return "a design has the dimension 'case' only", remedy


def _in_own_unit(name: str, variable: Any) -> np.ndarray:
    """Return the values of a parameter in its unit; the attribute `units` or `unit` may name
    another one.
    """
    values = np.asarray(variable.values)
    unit = stated_unit(variable.attrs)
    own = PARAMETERS.get(name)
    if own is None or unit in ("", own.unit, own.units) or values.dtype.kind not in "fiuO":
        return values
    kind: Any = float
    if values.dtype.kind == "O":
        kind = values.dtype
    converted = np.array(values, dtype=kind)
    for index, value in np.ndenumerate(values):
        if _is_number(value):
            converted[index] = in_unit(float(value), unit, own.unit, name)
    return converted


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float, np.number)) and not isinstance(value, bool)


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
            words: tuple[str, ...] = ()
            if name == "friction_coefficient":
                words = FRICTION_LEVELS
            numbers[name] = np.full(n, math.nan)
            for i, value in enumerate(raw):
                if not isinstance(value, str) or value not in words:
                    numbers[name][i] = number(name, value)
        good = parameter.accepts(numbers[name])
        if not good.all():
            bad = int(np.argmin(good))
            value = raw[bad : bad + 1].tolist()[0]
            remedy = parameter.remedy(float(numbers[name][bad]), value)
            raise InputError(f"{name} (case {bad})", value, parameter.allowed(), remedy)
    return numbers


def to_table(cases: Any, database: MaterialDatabase | None = None) -> CaseTable:
    """Return the checked arrays of cases, with materials and friction taken from the database.

    Parameters
    ----------
    cases : Case, mapping, list or data frame of them, or xarray.Dataset
        A data set has one variable or coordinate for each parameter along the dimension `case`, in
        the unit of its attribute `units` or `unit` if it has one. Parameters that it does not name
        take their default.
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
    if database is None:
        database = load_database()
    if not isinstance(database, MaterialDatabase):
        raise InputError(
            "database", database, "a MaterialDatabase", "`tr.load_database(path)` reads one."
        )
    if hasattr(cases, "data_vars"):
        columns, numbers = _of_dataset(cases)
    else:
        columns, numbers = _of_cases(cases)
    roller, guide = (once_each(database.material, columns[name]) for name in MATERIAL_FIELDS)
    friction = numbers["friction_coefficient"].copy()
    for i in np.flatnonzero(np.isnan(friction)):
        level = columns["friction_coefficient"][i]
        if not isinstance(level, str):
            level = "typical"
        friction[i] = database.friction(roller[i], guide[i], level=level).value
    numbers["friction_coefficient"] = friction
    positions = numbers["placeholder_position"].tolist()
    places = [None if math.isnan(position) else position for position in positions]  # NaN is no key
    # each replaces the range of the wear coefficients
    factors = ~np.isnan(numbers["wear_coefficient_factor"])
    keys = list(zip(map(id, roller), map(id, guide), places, factors.tolist(), strict=True))
    pairs = dict(zip(keys, zip(roller, guide, strict=True), strict=True))  # each combination once
    bodies = {
        key: [
            database.on(*way).moved(key[2] or 0.0, ("wear_coefficient",) * key[3])
            for way in (pair, pair[::-1])
        ]
        for key, pair in pairs.items()
    }
    roller, guide = ([bodies[key][i] for key in keys] for i in (0, 1))
    texts = {name: _texts(name, columns[name]) for name in MAPPING_FIELDS}
    return CaseTable(
        **numbers, **texts, roller=MaterialArrays.of(roller), guide=MaterialArrays.of(guide)
    )


def _texts(name: str, column: np.ndarray) -> np.ndarray:
    """Return the canonical texts of a column of mappings; each distinct mapping is checked once."""
    # most studies have no mapping, and a loop over a million cases takes seconds
    if np.all(column == ""):
        return column
    out = np.empty(column.size, dtype=object)
    out[:] = once_each(functools.partial(mapping_text, name), column)
    return out
