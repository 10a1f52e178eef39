"""Arithmetic and comparisons over named columns, evaluated without `eval`.

Study files use these texts for derived factors (``-ratio * guide_profile_radius``), for the constraints of a
Pareto set (``max_pressure[1] < 1500 and regime != full_slip``) and for `stop_if` (``peak_stress > R_m``).
Python parses the text to a syntax tree. Only the nodes listed here are evaluated, on whole columns at once.
An `InputError` names any other node with its position.
"""

from __future__ import annotations

import ast
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache, reduce
from typing import Any

import numpy as np

from trackroller.errors import InputError, unknown_name
from trackroller.parameters.syntax_checks import check_tree

MAX_LENGTH = 500  # characters; a longer calculation belongs in a script

_ONE_ARGUMENT = "abs sqrt exp log log10 sin cos tan radians degrees sign round".split()
FUNCTIONS: dict[str, tuple[Any, int]] = {name: (getattr(np, name), 1) for name in _ONE_ARGUMENT} | {
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
_COMPARE: dict[type, tuple[str, Any]] = {
    ast.Lt: ("<", np.less),
    ast.LtE: ("<=", np.less_equal),
    ast.Gt: (">", np.greater),
    ast.GtE: (">=", np.greater_equal),
    ast.Eq: ("==", lambda a, b: np.asarray(a == b)),
    ast.NotEq: ("!=", lambda a, b: np.asarray(a != b)),
}
_REMEDY = "Use numbers, names, + - * / % **, comparisons, and, or, not and the functions " + ", ".join(FUNCTIONS) + "."


@dataclass(frozen=True)
class Comparison:
    """One comparison of a named quantity with a limit, as written.

    Parameters
    ----------
    name : str
        Quantity on the left side.
    symbol : str
        One of ``< <= > >= == !=``.
    limit : str
        Expression on the right side.
    """

    name: str
    symbol: str
    limit: str

    @property
    def text(self) -> str:
        """Return the comparison as an expression."""
        return f"{self.name} {self.symbol} {self.limit}"


def names(text: str, field: str = "expression") -> set[str]:
    """Return the names that an expression needs.

    Parameters
    ----------
    text : str
        The expression.
    field : str
        Name of the study key, for error messages.

    Returns
    -------
    set of str
        Names; the part of a variable is one name, such as ``peak_stress[1,roller]``.

    Raises
    ------
    InputError
        If the text is not an expression; the message states the position.
    """
    return _names(_parse(text, field))


def evaluate(text: str, values: Mapping[str, Any], field: str = "expression") -> np.ndarray:
    """Evaluate an expression over columns.

    Parameters
    ----------
    text : str
        Arithmetic over the names in `values`.
    values : mapping of str to number or array_like
        Numbers or columns, shape (n,). Texts can only be compared.
    field : str
        Name of the study key, for error messages.

    Returns
    -------
    numpy.ndarray of float, shape (n,) or ()
        Value of the expression; a single number if all values are numbers.

    Raises
    ------
    InputError
        For a node that is not allowed, an unknown name, or a result that is not a number.

    Examples
    --------
    >>> evaluate("-ratio * r", {"ratio": np.array([1.1, 1.2]), "r": 6.0})
    array([-6.6, -7.2])
    """
    result = _Evaluation(text, field, values).value(_parse(text, field))
    try:
        return np.asarray(result, dtype=float)
    except (TypeError, ValueError):
        raise InputError(field, text, "the result is a text, not a number", "Compare texts with == or !=.") from None


def condition(text: str, values: Mapping[str, Any], field: str = "constraints") -> np.ndarray:
    """Evaluate a condition such as ``max_pressure < 1500`` over columns.

    Parameters
    ----------
    text : str
        Comparisons, which `and`, `or` and `not` may join.
    values : mapping of str to number or array_like
        Numbers or columns of any shapes that broadcast. Texts can only be compared.
    field : str
        Name of the study key, for error messages.

    Returns
    -------
    numpy.ndarray of bool
        True where the condition holds; False where a value of the condition is NaN, also for ``!=``.

    Raises
    ------
    InputError
        As in `evaluate`, or if the text is not a comparison.
    """
    tree = _parse(text, field)
    result = np.asarray(_Evaluation(text, field, values).value(tree))
    if result.dtype != bool:
        raise InputError(field, text, "a comparison is wanted, such as 'max_pressure < 1500'")
    for name in _names(tree):
        column = np.asarray(values[name])
        if column.dtype.kind == "f":
            result = result & ~np.isnan(column)
    return result


def comparisons(text: str, field: str) -> tuple[Comparison, ...]:
    """Split a condition into comparisons joined by `or`.

    Parameters
    ----------
    text : str
        Condition such as ``slip > 0.1 or regime == full_slip``; each left side is one name.
    field : str
        Name of the study key, for error messages.

    Returns
    -------
    tuple of Comparison
        The comparisons in the order of the text.

    Raises
    ------
    InputError
        If the text is not such a condition.
    """
    tree = _parse(text, field)
    parts = tree.values if isinstance(tree, ast.BoolOp) and isinstance(tree.op, ast.Or) else [tree]
    compared = []
    for part in parts:
        if not isinstance(part, ast.Compare) or len(part.ops) != 1 or type(part.ops[0]) not in _COMPARE:
            allowed = "comparisons (> >= < <= == !=) joined by 'or'"
            raise InputError(field, text, allowed, "For example: slip > 0.1 or max_pressure > 1500.")
        left = _name(part.left) or ast.unparse(part.left)
        compared.append(Comparison(left, _COMPARE[type(part.ops[0])][0], ast.unparse(part.comparators[0])))
    return tuple(compared)


def _parse(text: str, field: str) -> ast.expr:
    if not isinstance(text, str) or not text.strip():
        raise InputError(field, text, "a text with an expression or a comparison", "For example: 2 * slip > 0.1.")
    return _tree(text, field)


@lru_cache(maxsize=256)
def _tree(text: str, field: str) -> ast.expr:
    if len(text) > MAX_LENGTH:
        raise InputError(field, text[:40] + "...", f"an expression has at most {MAX_LENGTH} characters")
    try:
        tree = ast.parse(text.strip(), mode="eval").body
        check_tree(tree, text, field)
        return tree
    except InputError:
        raise
    except SyntaxError as exc:
        raise InputError(field, text, f"syntax error at character {exc.offset}", _REMEDY) from None
    except (RecursionError, MemoryError, ValueError):
        raise InputError(field, text, "the brackets are too deep, or this is not a text", _REMEDY) from None


def _name(node: ast.AST) -> str | None:
    """Return the name of a node: ``slip``, or ``peak_stress[1,roller]`` for the part of a variable."""
    match node:
        case ast.Name(id=name):
            return name
        case ast.Subscript(value=ast.Name(id=name), slice=part):
            keys = part.elts if isinstance(part, ast.Tuple) else [part]
            return f"{name}[{','.join(ast.unparse(key) for key in keys)}]"
    return None


def _names(node: ast.AST) -> set[str]:
    if name := _name(node):
        return {name} - set(CONSTANTS)
    children = node.args if isinstance(node, ast.Call) else ast.iter_child_nodes(node)
    return set().union(*map(_names, children))


@dataclass(frozen=True)
class _Evaluation:
    """Values of the nodes of one expression."""

    text: str
    field: str
    values: Mapping[str, Any]

    def value(self, node: ast.AST) -> Any:
        match node:
            case ast.Constant(value=bool()):
                raise self.refused(node, "a truth value")
            case ast.Constant(value=int() | float() as number):
                return float(number)  # powers of whole numbers could fill the memory
            case ast.Constant(value=str() as word):
                return word
            case ast.Name() | ast.Subscript():
                return self.named(node)
            case ast.BinOp(left=left, op=op, right=right) if type(op) in _BINARY:
                return self.applied(_BINARY[type(op)], [left, right], node)
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return self.applied(np.negative, [operand], node)
            case ast.UnaryOp(op=ast.UAdd(), operand=operand):
                return self.value(operand)
            case ast.Call(func=ast.Name(id=name), args=args, keywords=[]) if name in FUNCTIONS:
                function, arity = FUNCTIONS[name]
                if len(args) != arity or any(isinstance(arg, ast.Starred) for arg in args):
                    raise self.refused(node, f"{name} with {len(args)} arguments (it takes {arity})")
                return self.applied(function, args, node)
        return self.logic(node)

    def logic(self, node: ast.AST) -> np.ndarray:
        match node:
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                return np.asarray(np.logical_not(self.truth(operand)))
            case ast.BoolOp(op=op, values=parts):
                join = np.logical_and if isinstance(op, ast.And) else np.logical_or
                return reduce(join, [self.truth(part) for part in parts])
            case ast.Compare(left=left, ops=ops, comparators=rest) if all(type(op) in _COMPARE for op in ops):
                sides = [np.asarray(self.value(part)) for part in (left, *rest)]
                held = [self.compared(*part, node) for part in zip(ops, sides, sides[1:], strict=False)]
                return np.asarray(reduce(np.logical_and, held))  # a part of constants has another shape
        raise self.refused(node, type(node).__name__.lower())

    def named(self, node: ast.Name | ast.Subscript) -> Any:
        name = _name(node)
        for known in (self.values, CONSTANTS):
            if name is not None and name in known:
                return known[name]
        if name is None or isinstance(node, ast.Subscript):
            raise self.refused(node, "a subscript that does not name the part of a variable")
        raise unknown_name(f"{self.field} (character {node.col_offset + 1})", name, list(self.values))

    def applied(self, function: Any, parts: list[ast.expr], node: ast.AST) -> Any:
        args = [self.value(part) for part in parts]
        if function is np.where:
            return np.where(np.asarray(args[0], dtype=bool), *args[1:])
        try:
            with np.errstate(all="ignore"):  # the caller reports NaN with its row
                return function(*[np.asarray(arg, dtype=float) for arg in args])
        except (TypeError, ValueError):
            raise self.refused(node, "arithmetic with a text") from None

    def compared(self, op: ast.cmpop, one: np.ndarray, other: np.ndarray, node: ast.AST) -> np.ndarray:
        texts = {side.dtype.kind in "OSU" for side in (one, other)}
        if len(texts) > 1 or (True in texts and not isinstance(op, (ast.Eq, ast.NotEq))):
            raise self.refused(node, "ordering a text, or comparing it with a number,")
        return np.asarray(_COMPARE[type(op)][1](one, other), dtype=bool)

    def truth(self, node: ast.AST) -> np.ndarray:
        value = np.asarray(self.value(node))
        if value.dtype != bool:
            raise self.refused(node, "something other than a comparison beside and, or, not")
        return value

    def refused(self, node: ast.AST, what: str) -> InputError:
        at = getattr(node, "col_offset", 0) + 1
        return InputError(self.field, self.text, f"{what} at character {at} is not allowed", _REMEDY)
