"""Expressions over factors, evaluated without `eval`.

A derived factor is written as arithmetic over other factors, e.g. ``-ratio * guide_profile_radius`` or
``where(drive == 'free', 0, -30)``. The text is parsed to a syntax tree and only the nodes listed here are
computed, on whole columns at once; everything else is refused with its position.
"""

from __future__ import annotations

import ast
import functools
from collections.abc import Mapping
from typing import Any

import numpy as np

from trackroller.errors import InputError, unknown_name

MAX_LENGTH = 500  # an expression longer than this is a program and belongs into a script

FUNCTIONS: dict[str, tuple[Any, int]] = {
    "abs": (np.abs, 1),
    "sqrt": (np.sqrt, 1),
    "exp": (np.exp, 1),
    "log": (np.log, 1),
    "log10": (np.log10, 1),
    "sin": (np.sin, 1),
    "cos": (np.cos, 1),
    "tan": (np.tan, 1),
    "radians": (np.radians, 1),
    "degrees": (np.degrees, 1),
    "sign": (np.sign, 1),
    "round": (np.round, 1),
    "min": (np.minimum, 2),
    "max": (np.maximum, 2),
    "where": (np.where, 3),
}
CONSTANTS = {"pi": np.pi, "inf": np.inf}
_BINARY: dict[type, Any] = {
    ast.Add: np.add,
    ast.Sub: np.subtract,
    ast.Mult: np.multiply,
    ast.Div: np.divide,
    ast.Pow: np.power,
    ast.Mod: np.mod,
}
_COMPARE: dict[type, Any] = {
    ast.Lt: np.less,
    ast.LtE: np.less_equal,
    ast.Gt: np.greater,
    ast.GtE: np.greater_equal,
    ast.Eq: lambda a, b: np.asarray(a == b),
    ast.NotEq: lambda a, b: np.asarray(a != b),
}
_ALLOWED = "numbers, factor names, + - * / % **, comparisons, and, or, not and the functions " + ", ".join(FUNCTIONS)


def _parse(text: str, field: str) -> ast.expr:
    if not isinstance(text, str) or not text.strip():
        raise InputError(field, text, "an expression is a text such as '-1.2 * guide_profile_radius'")
    if len(text) > MAX_LENGTH:
        raise InputError(field, text[:40] + "...", f"an expression has at most {MAX_LENGTH} characters")
    try:
        return ast.parse(text.strip(), mode="eval").body
    except SyntaxError as exc:
        raise InputError(field, text, f"syntax error at character {exc.offset}", f"Use {_ALLOWED}.") from None
    except (RecursionError, MemoryError, ValueError):
        raise InputError(field, text, "too deeply nested or not a text", f"Use {_ALLOWED}.") from None


def names(text: str, field: str = "expression") -> set[str]:
    """Names of the factors an expression needs.

    Raises `InputError` with the position for a text that is no expression.
    """
    tree = _parse(text, field)
    called = {node.func.id for node in ast.walk(tree) if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)}
    return {n.id for n in ast.walk(tree) if isinstance(n, ast.Name)} - called - set(CONSTANTS)


def evaluate(text: str, values: Mapping[str, Any], field: str = "expression") -> np.ndarray:
    """Value of an expression over columns.

    Parameters
    ----------
    text : arithmetic over the names in `values`
    values : numbers or columns, shape (n,); texts may be compared only
    field : name for error messages

    Returns
    -------
    numpy.ndarray of float, shape (n,) (or () for plain numbers)

    Raises
    ------
    InputError : a part that is not allowed, an unknown name, or a value that is not a number; the message
        names the character where it stands

    Examples
    --------
    >>> evaluate("-ratio * r", {"ratio": np.array([1.1, 1.2]), "r": 6.0})
    array([-6.6, -7.2])
    """
    tree = _parse(text, field)

    def refuse(node: ast.AST, what: str) -> InputError:
        at = getattr(node, "col_offset", 0) + 1
        return InputError(field, text, f"{what} at character {at} is not allowed", f"Use {_ALLOWED}.")

    with np.errstate(all="ignore"):  # a value that is no number is reported below, with its row
        result = _value(tree, values, field, refuse)
    try:
        return np.asarray(result, dtype=float)
    except (TypeError, ValueError):
        raise InputError(field, text, "the result is a text, not a number") from None


def condition(text: str, values: Mapping[str, Any], field: str = "constraints") -> np.ndarray:
    """Truth of a comparison such as "max_pressure < 1500" or "regime != full_slip and slip < 0.1".

    Parameters as for `evaluate`; a value that is not a number compares as false, `!=` included.

    Returns
    -------
    numpy.ndarray of bool, shape (n,) (or () for plain numbers)

    Raises
    ------
    InputError : as `evaluate`, and for a text that is no comparison
    """
    tree = _parse(text, field)

    def refuse(node: ast.AST, what: str) -> InputError:
        at = getattr(node, "col_offset", 0) + 1
        return InputError(field, text, f"{what} at character {at} is not allowed", f"Use {_ALLOWED}.")

    with np.errstate(all="ignore"):
        result = np.asarray(_value(tree, values, field, refuse))
    if result.dtype != bool:
        raise InputError(field, text, "a comparison is wanted, such as 'max_pressure < 1500'")
    for name in names(text, field):
        column = np.asarray(values[name])
        if column.dtype.kind == "f":
            result = result & ~np.isnan(column)
    return result


def _value(node: ast.AST, values: Mapping[str, Any], field: str, refuse: Any) -> Any:
    def sub(child: ast.AST) -> Any:
        return _value(child, values, field, refuse)

    match node:
        case ast.Constant(value=bool()):
            raise refuse(node, "a truth value")
        case ast.Constant(value=int() | float() as number):
            return float(number)  # floats only: integer powers could fill the memory
        case ast.Constant(value=str() as word):
            return word
        case ast.Name(id=name) if name in CONSTANTS and name not in values:
            return CONSTANTS[name]
        case ast.Name(id=name):
            if name not in values:
                raise unknown_name(f"{field} (character {node.col_offset + 1})", name, list(values))
            return values[name]
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _BINARY:
            return _apply(_BINARY[type(op)], [sub(left), sub(right)], node, refuse)
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return _apply(np.negative, [sub(operand)], node, refuse)
        case ast.UnaryOp(op=ast.UAdd(), operand=operand):
            return sub(operand)
        case ast.Compare(left=left, ops=ops, comparators=rest) if all(type(op) in _COMPARE for op in ops):
            sides = [sub(part) for part in (left, *rest)]
            pairs = zip(ops, sides, sides[1:], strict=False)
            return np.logical_and.reduce([_compare(op, one, other, node, refuse) for op, one, other in pairs])
        case ast.BoolOp(op=op, values=parts):
            join = np.logical_and if isinstance(op, ast.And) else np.logical_or
            return functools.reduce(join, [_truth(sub(part), part, refuse) for part in parts])
        case ast.UnaryOp(op=ast.Not(), operand=operand):
            return np.logical_not(_truth(sub(operand), operand, refuse))
        case ast.Call(func=ast.Name(id=name), args=args, keywords=[]) if name in FUNCTIONS:
            function, arity = FUNCTIONS[name]
            if len(args) != arity or any(isinstance(arg, ast.Starred) for arg in args):
                raise refuse(node, f"{name} with {len(args)} arguments (it takes {arity})")
            return _apply(function, [sub(arg) for arg in args], node, refuse)
    raise refuse(node, type(node).__name__.lower())


def _compare(op: ast.cmpop, one: Any, other: Any, node: ast.AST, refuse: Any) -> np.ndarray:
    one, other = np.asarray(one), np.asarray(other)
    if (one.dtype.kind in "OSU") != (other.dtype.kind in "OSU") or (
        one.dtype.kind in "OSU" and not isinstance(op, (ast.Eq, ast.NotEq))
    ):
        raise refuse(node, "ordering a text, or comparing it with a number,")
    return np.asarray(_COMPARE[type(op)](one, other), dtype=bool)


def _truth(value: Any, node: ast.AST, refuse: Any) -> np.ndarray:
    found = np.asarray(value)
    if found.dtype != bool:
        raise refuse(node, "something other than a comparison beside and, or, not")
    return found


def _apply(function: Any, args: list[Any], node: ast.AST, refuse: Any) -> Any:
    if function is np.where:
        return np.where(np.asarray(args[0], dtype=bool), *args[1:])
    try:
        return function(*[np.asarray(arg, dtype=float) for arg in args])
    except (TypeError, ValueError):
        raise refuse(node, "arithmetic with a text") from None
