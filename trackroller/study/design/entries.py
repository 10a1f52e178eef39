"""Check the entries of the factors of a study file."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

from trackroller.damage.own import unknown_field
from trackroller.errors import InputError, listing
from trackroller.methods.factor import LISTS, ROWS, Factor, parse
from trackroller.numerics.numbers import number_or_nan
from trackroller.numerics.parameter import Parameter
from trackroller.parameters import MAPPING_FIELDS, OPTIONS, PARAMETERS, expressions
from trackroller.parameters.carriage_fields import OF_LOAD_CASE, OF_WHOLE, PREFIX, field_of
from trackroller.roller.aliases import ALIASES, RADII
from trackroller.roller.dataset import VARIABLES
from trackroller.roller.output_names import PARTS
from trackroller.study.design.factor_names import FACTOR_NAMES, SHELVES
from trackroller.study.design.field_values import field_value, parameter_value
from trackroller.study.design.levels import short
from trackroller.study.design.shelf_rows import checked_rows

MAX_LEVELS = 1_000_000


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
    parameter = _parameter_of(key, on_carriage)
    own = parameter is None and key not in (*FACTOR_NAMES, *SHELVES)
    if own and not _used(key, factors):
        raise _unused(str(key), factors, on_carriage)
    _check_kind(key, spec)
    if isinstance(spec, Mapping):
        spec = {
            kind: _entries(key, kind, value, f"{where}.{kind}", parameter)
            for kind, value in spec.items()
        }
    checked = parse(key, spec)
    if not own:
        _check_factor_of_program(checked, parameter, factors)
    return dict(spec)


def _parameter_of(key: Any, on_carriage: bool) -> Parameter | None:
    """Return the parameter of a roller or the field of the carriage that a factor varies."""
    if key in PARAMETERS or not on_carriage or not isinstance(key, str):
        return PARAMETERS.get(key)
    return field_of(key)


def _check_factor_of_program(
    checked: Factor, parameter: Parameter | None, factors: Mapping[Any, Any]
) -> None:
    """Refuse a kind or a value that the parameter or the option of a factor cannot have."""
    where = f"factors.{checked.name}"
    if checked.text:
        refuse_results(checked.text, f"{where}.expression", factors)
    if parameter is None:
        if checked.kind not in ("values", ROWS):
            raise InputError(where, checked.kind, "names as {values: [...]}")
        return
    values = list(checked.levels)
    if checked.kind == "uniform":
        values += checked.numbers
    for value in values:
        parameter_value(parameter, value, f"{where}.{checked.kind}")


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


def _used(name: Any, factors: Mapping[Any, Any]) -> bool:
    """Return whether a name can stand in an expression, and that of another factor uses it."""
    return isinstance(name, str) and name.isidentifier() and name in _in_expressions(factors)


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
        return checked_rows(key, value, where)
    if kind == "values":
        return _levels(key, value, where, parameter)
    unit = None
    if parameter is not None:
        unit = parameter.unit
    numbers = [_number(kind, place, entry, unit, where) for place, entry in enumerate(value)]
    _check_count(kind, numbers, where)
    return numbers


def _levels(key: str, values: list[Any], where: str, parameter: Parameter | None) -> list[Any]:
    """Return listed values in the type of the factor; those of a factor of the study's own stay."""
    if parameter is not None:
        return [parameter_value(parameter, value, where) for value in values]
    if key not in FACTOR_NAMES:
        return values
    levels = [field_value(key, value, where) for value in values]
    _refuse_equal_names(key, levels, where)
    return levels


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


def _number(kind: str, place: int, entry: Any, unit: str | None, where: str) -> Any:
    """Return the number at a place of a distribution or a spacing as a float.

    The spread stands at the second place: a difference in the unit of the mean, or a number without
    unit beside the median or the scale. What is no number stays as it is; `parse` refuses it.
    """
    is_spread = place == 1
    if is_spread and kind in ("lognormal", "weibull"):
        unit = "-"
    is_difference = is_spread and kind in ("normal", "truncnormal")
    number = math.nan
    if isinstance(entry, str):
        number = number_or_nan(entry, unit, where, is_difference)
    if math.isnan(number):
        return entry
    return number


def _check_count(kind: str, numbers: list[Any], where: str) -> None:
    """Refuse a mistyped number of levels, which would fill the memory."""
    if kind not in LISTS or len(numbers) != 3 or not isinstance(numbers[2], (int, float)):
        return
    if not numbers[2] <= MAX_LEVELS:
        raise InputError(where, numbers[2], f"at most {MAX_LEVELS} levels of a factor")
