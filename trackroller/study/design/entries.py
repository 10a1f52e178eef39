"""Check the entries of a study file: values of the base case and of factors."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Collection, Iterable, Mapping
from typing import Any

from trackroller.contact.friction_laws import at_rest
from trackroller.damage.own import unknown_field
from trackroller.errors import Collector, InputError, listing, unknown_name
from trackroller.methods.factor import LISTS, ROWS, Factor, parse
from trackroller.numerics.numbers import number_in, number_or_nan
from trackroller.numerics.parameter import Parameter
from trackroller.parameters import MAPPING_FIELDS, MATERIAL_FIELDS, OPTIONS, PARAMETERS, expressions
from trackroller.parameters.carriage_fields import OF_LOAD_CASE, OF_WHOLE, PREFIX, field_of
from trackroller.roller.aliases import ALIASES, RADII, radius
from trackroller.roller.dataset import FLAGS, VARIABLES
from trackroller.roller.fields import LONGEST_NAME, NAME, mapping_text
from trackroller.roller.output_names import PARTS
from trackroller.roller.settings import LOADS
from trackroller.study.design.levels import short

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
MAX_LEVELS = 1_000_000
FACTOR_NAMES = (*CASE_FIELDS, "material_pair", *OPTION_FACTORS)
SHELVES = ("roller", "bearing", "guide")  # factors whose levels are rows of a table
BEARING_DIAMETER = "bearing_outer_diameter"
SIZES = (*RADII, BEARING_DIAMETER)  # columns of a shelf [mm] that are no parameters
# parameters that no row of a shelf sets
OF_LOAD = (*LOADS, "velocity", "guide_overrollings_per_hour")


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
    part = _PART_OF_RESULT.fullmatch(name)
    if name in RESERVED or name in PARTS or (part and part[1] in VARIABLES):
        allowed = "a name that the results do not use for something else"
        raise InputError(where, name, allowed, f"Rename it, for example {name}_factor.")
    try:
        size = len(name.encode())
    except UnicodeEncodeError:
        size = 0
    if not 0 < size <= MAX_NAME or not _NAME.fullmatch(name):
        allowed = (
            f"a name that results can have: at most {MAX_NAME} bytes, without '/' and line "
            "breaks, and a letter, "
            "a figure or '_' at its beginning"
        )
        shown = name
        if len(name) >= MAX_NAME:
            shown = f"{name[:40]}..."
        raise InputError(where, shown, allowed, "Rename it.")


def choice(value: Any, where: str, options: Collection[str]) -> str:
    """Check that a value is one of the options.

    Parameters
    ----------
    value : the value
    where : name of the study key
    options : allowed words

    Returns
    -------
    The value.

    Raises
    ------
    InputError : with the nearest option
    """
    if not isinstance(value, str) or value not in options:
        raise unknown_name(where, value, options)
    return value


def base_value(key: Any, value: Any, section: str = "base") -> Any:
    """Check a value of the base case.

    Parameters
    ----------
    key : name of the case field
    value : its value
    section : name of the study key that holds the values

    Returns
    -------
    The value in the type of its field.

    Raises
    ------
    InputError : unknown field, or a value outside its bounds
    """
    known = (*CASE_FIELDS, "material_pair")
    if key in (*OPTIONS, "duty"):
        remedy = f"Write {key}: {value} on a line of its own that is not indented."
        raise InputError(
            f"{section}.{key}", value, "parameters of the roller", remedy, "is a key of the study"
        )
    if key not in known:
        raise unknown_field(section, str(key), (*known, *ALIASES, *RADII), OPTIONS)
    return field_value(key, value, f"{section}.{key}")


def field_value(key: str, value: Any, where: str) -> Any:
    """Return the value of a case field or of an option in the type of its field."""
    if key == "material_pair":
        if not isinstance(value, (list, tuple)) or len(value) != 2:
            raise InputError(where, value, "a pair [roller material, guide material]")
        return [_material_name(name, where) for name in value]
    if key in OPTION_FACTORS:
        return choice(value, where, OPTION_FACTORS[key])
    if key in MATERIAL_FIELDS:
        return _material_name(value, where)
    if key in MAPPING_FIELDS:
        return _mapping(key, value, where)
    return _number(PARAMETERS[key], value, where)


def _material_name(value: Any, where: str) -> str:
    if not isinstance(value, str) or not value:
        raise InputError(
            where,
            value,
            "the name of a material in the database",
            "Add your own material with `trackroller materials add`.",
        )
    return value


def _mapping(name: str, value: Any, where: str) -> str:
    """Return a friction law or profile as its canonical text."""
    try:
        text = mapping_text(name, value)
        if name == "friction_law" and not text:
            _refuse_constant_law(value)
        return text
    except InputError as exc:
        if exc.field.startswith(name):
            field = exc.field.replace(name, where, 1)
        else:
            field = f"{where}: {exc.field}"
        raise exc.named(field) from None


def _refuse_constant_law(value: Any) -> None:
    """Refuse a table of friction with one value, which `friction_coefficient` states."""
    friction = at_rest(value)
    if friction is not None:
        allowed = "a table whose friction changes with the slip speed"
        remedy = f"Remove the law and give friction_coefficient: {friction:g}."
        raise InputError("friction_law", "a table of one value", allowed, remedy)


def _number(parameter: Parameter, value: Any, where: str) -> Any:
    """Return a value of a parameter as a float, a friction level or None."""
    if value is None and parameter.allow_missing:
        return None
    if isinstance(value, str) and value in parameter.words:
        return value
    number = number_or_nan(value, parameter.unit, where)
    if math.isnan(number) or not parameter.accepts(number):
        remedy = parameter.remedy(number, value)
        if isinstance(value, list):
            remedy = (
                f"Give several values under factors: {{{parameter.name}: {{values: {value}}}}}."
            )
        raise InputError(where, value, parameter.allowed(), remedy)
    return number


def factor(
    key: Any, spec: Any, factors: Mapping[Any, Any], on_carriage: bool = False
) -> dict[str, Any]:
    """Check the dictionary of a factor.

    Parameters
    ----------
    key : name of the factor
    spec : its dictionary
    factors : all factors of the study, whose expressions may use this factor
    on_carriage : whether the study has a carriage, whose fields may be factors

    Returns
    -------
    The dictionary with its entries in the type of the factor.

    Raises
    ------
    InputError : unknown name, or an entry that is not allowed
    """
    where = f"factors.{key}"
    field = None
    if on_carriage and isinstance(key, str):
        field = field_of(key)
    parameter = PARAMETERS.get(key, field)
    own = key not in (*FACTOR_NAMES, *SHELVES) and field is None
    if own and not (isinstance(key, str) and key.isidentifier() and _used(key, factors)):
        raise _unused(str(key), factors, on_carriage)
    _check_kind(key, spec)
    if isinstance(spec, Mapping):
        spec = {
            kind: _entries(key, kind, value, f"{where}.{kind}", parameter)
            for kind, value in spec.items()
        }
    checked = parse(key, spec)
    if checked.text and not own:
        refuse_results(checked.text, f"{where}.expression", factors)
    if not own and parameter is None and checked.kind not in ("values", ROWS):
        raise InputError(where, checked.kind, "names as {values: [...]}")
    if parameter is not None:
        for level in (*checked.levels, *(checked.numbers if checked.kind == "uniform" else ())):
            _number(parameter, level, f"{where}.{checked.kind}")
    return dict(spec)


def _check_kind(key: Any, spec: Any) -> None:
    """Refuse rows of a factor that is no shelf, and a shelf of rollers or guides that is something
    else.
    """
    where = f"factors.{key}"
    has_rows = isinstance(spec, Mapping) and ROWS in spec
    if has_rows and key not in SHELVES:
        raise InputError(where, ROWS, f"rows of {listing(SHELVES, 'or')}", "Write {values: [...]}.")
    if key in SHELVES and key not in FACTOR_NAMES and not has_rows:
        remedy = f"For example {key}: {{file: {key}s.csv}}."
        raise InputError(where, spec, "rows of a table", remedy)


def field_of_row(shelf: str, name: str) -> str:
    """Return the name of a row of a shelf in messages."""
    return f"factors.{shelf}.{ROWS}.{name}"


def columns_of_shelves(factors: Mapping[str, Factor]) -> dict[str, Factor]:
    """Return the columns of shelves as lists of values, beside the factors themselves.

    Parameters
    ----------
    factors : all factors of a study

    Returns
    -------
    Name -> factor: a column of numbers has numbers as levels, without those that are missing.
    """
    columns = {}
    for factor in factors.values():
        for name, values in factor.beside.items():
            levels = tuple(dict.fromkeys(value for value in values if value is not None))
            columns[name] = Factor(name, "values", levels=levels, scatter=factor.scatter)
    return columns


def _rows(shelf: str, rows: list[Any], where: str) -> list[Any]:
    """Return the rows of a shelf with their values in the types of their columns; raise all errors
    together.
    """
    wrong = Collector()
    checked = []
    for row in rows:
        if not isinstance(row, Mapping):
            return rows  # `parse` refuses them
        with wrong.part():
            name = _row_name(row.get(NAME), where)
            values: dict[str, Any] = {NAME: name}
            for column, value in row.items():
                if column != NAME:
                    with wrong.part():
                        values[column] = _value_in_row(shelf, name, column, value)
            if shelf in MAPPING_FIELDS and not values.get(shelf):
                allowed = f"the values of a {shelf}"
                raise InputError(
                    f"{field_of_row(shelf, name)}.{shelf}", None, allowed, "", "is missing"
                )
            checked.append(values)
    wrong.check()
    return checked


def _row_name(name: Any, where: str) -> str:
    """Return the name of a row of a shelf, which is the level of its factor."""
    if isinstance(name, (int, float)) and not isinstance(name, bool):
        name = str(name)
    if not isinstance(name, str) or not name.strip() or len(name) > LONGEST_NAME:
        remedy = "For example {name: V25, contact_angle: 30}."
        raise InputError(
            f"{where}.{NAME}", name, f"a name of at most {LONGEST_NAME} signs in each row", remedy
        )
    return name.strip()


def _value_in_row(shelf: str, name: str, column: str, value: Any) -> Any:
    """Return the value of a column in a row of a shelf in the type of the column."""
    where = f"{field_of_row(shelf, name)}.{column}"
    if column in OF_LOAD:
        remedy = f"Write it under base. What a catalogue allows is catalogue_{column}."
        if column not in LOADS:
            remedy = "Write it under base."
        raise InputError(where, value, "values of the goods, not of their use", remedy)
    if column in RADII:
        return radius(column, value, where.removesuffix(column))
    if column == BEARING_DIAMETER:
        return number_in(value, where, "a length > 0 in mm", math.nextafter(0.0, 1.0), unit="mm")
    if column == shelf:
        text = field_value(column, value, where)
        return text and mapping_text(column, json.loads(text) | {NAME: name})
    if column in CASE_FIELDS:
        return field_value(column, value, where)
    check_own_name(column, where)
    if not column.isidentifier():
        raise InputError(
            where, value, "columns whose names are letters, digits and '_'", "Rename the column."
        )
    if value is None or isinstance(value, str):
        return value
    number = number_or_nan(value)
    if not math.isfinite(number):
        raise InputError(where, value, "a finite number or a text")
    return number


def _used(name: str, factors: Mapping[Any, Any]) -> bool:
    """Return whether the expression of another factor uses the name."""
    return name in _in_expressions(factors)


def _in_expressions(factors: Mapping[Any, Any]) -> set[str]:
    """Return the names that the expressions of factors use."""
    texts = [
        s["expression"] for s in factors.values() if isinstance(s, Mapping) and "expression" in s
    ]
    return set().union(
        *(expressions.names(text, "factors") for text in texts if isinstance(text, str))
    )


def _unused(name: str, factors: Mapping[Any, Any], on_carriage: bool) -> InputError:
    """Return the error for a factor that is no parameter, no field of the carriage and no name of
    an expression.
    """
    fields: tuple[str, ...] = ()
    if on_carriage:
        fields = (*OF_WHOLE, *OF_LOAD_CASE)
    if on_carriage and field_of(f"{PREFIX}{name}"):
        allowed = (
            f"parameters of a roller, and fields of the carriage, whose names begin with {PREFIX}"
        )
        return InputError("factors", name, allowed, f"Write {PREFIX}{name}.", "is not known")
    error = unknown_field("factors", name, (*FACTOR_NAMES, *fields, *ALIASES, *RADII), OPTIONS)
    used = _in_expressions(factors)
    unknown = sorted(used - {*FACTOR_NAMES, *map(str, factors)})
    results = [name for name in unknown if name in PARTS or name in VARIABLES]
    if results:
        return _of_result("factors", name, results[0])
    if not unknown:
        return error
    allowed = "parameters, and names that an expression of another factor uses"
    remedy = f"The expressions use {listing(unknown)}, which is no factor: give both the same name."
    return InputError("factors", name, allowed, remedy, "is not known")


def _of_result(where: str, value: str, result: str) -> InputError:
    """Return the error for a factor whose expression uses a result."""
    wrong = f"uses the result {result}, but a factor is computed before the solution"
    remedy = "Write the expression under own: as an output of the study's own."
    return InputError(where, value, "expressions of parameters and factors", remedy, wrong)


def refuse_results(text: str, where: str, factors: Mapping[Any, Any]) -> None:
    """Refuse an expression of a factor that uses results, which are known after the solution only.

    A factor that has the name of a result is refused for this name.
    """
    for one in sorted(expressions.names(text, where) - {*map(str, factors)}):
        if one in PARTS or (one in VARIABLES and one not in FACTOR_NAMES):
            raise _of_result(where, text, one)


def _entries(key: str, kind: Any, value: Any, where: str, parameter: Parameter | None) -> Any:
    """Return the entries of a factor's list: numbers as floats, checked pairs, names as texts."""
    if not isinstance(value, list):
        return value
    if kind == ROWS:
        return _rows(key, value, where)
    if kind == "values":
        if parameter is not None:
            return [_number(parameter, entry, where) for entry in value]
        if key not in FACTOR_NAMES:
            return value
        levels = [field_value(key, entry, where) for entry in value]
        _refuse_equal_names(key, levels, where)
        return levels
    unit = None
    if parameter is not None:
        unit = parameter.unit
    numbers = []
    for place, entry in enumerate(value):
        # a number without unit beside the median or scale
        if place == 1 and kind in ("lognormal", "weibull"):
            numbers.append(_to_float(entry, "-", where, False))
        else:
            is_deviation = place == 1 and kind in ("normal", "truncnormal")
            numbers.append(_to_float(entry, unit, where, is_deviation))
    if (
        kind in LISTS
        and len(numbers) == 3
        and isinstance(numbers[2], (int, float))
        and not numbers[2] <= MAX_LEVELS
    ):
        # a mistyped number of levels would fill the memory
        raise InputError(where, numbers[2], f"at most {MAX_LEVELS} levels of a factor")
    return numbers


def _refuse_equal_names(key: str, levels: list[Any], where: str) -> None:
    """Refuse two levels of a factor that are mappings with the same name."""
    if key not in MAPPING_FIELDS:
        return
    given = [text for text in dict.fromkeys(levels) if text and "name" in json.loads(text)]
    names = [short(key, text) for text in given]
    for name in names:
        if names.count(name) > 1:
            raise InputError(
                f"{where}.name", name, "a name of its own for each level", "Rename one of them."
            )


def _to_float(value: Any, unit: str | None, where: str, difference: bool) -> Any:
    if isinstance(value, str):
        number = number_or_nan(value, unit, where, difference)
    else:
        number = math.nan
    return value if math.isnan(number) else number
