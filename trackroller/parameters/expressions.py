"""Arithmetic and comparisons over named columns, evaluated without `eval`.

Study files use these texts for derived factors (``-ratio * guide_profile_radius``), for the
constraints of a Pareto set (``max_pressure[1] < 1500 and regime != full_slip``) and for `stop_if`
(``peak_stress > R_m``). Python parses the text to a syntax tree. Only the nodes listed here are
evaluated, on whole columns at once. An `InputError` names any other node with its position.

NaN stands for a value that is not known, and whatever needs it is not known either: a function or
an operation on NaN gives NaN, a comparison with NaN is undecided, and so are `and`, `or` and `not`
of something undecided. As a number an undecided comparison is NaN; ``where`` of it is NaN; as a
condition it does not hold.
"""

from __future__ import annotations

import ast
import math
import re
import warnings
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache, reduce
from typing import Any

import numpy as np

from trackroller.errors import InputError, unknown_name
from trackroller.numerics.units import split_quantity
from trackroller.parameters.syntax_checks import (
    NAMES,
    check_tree,
    name_with_blank,
    not_allowed,
    rename_remedy,
    syntax_remedy,
    unknown_function,
)

MAX_LENGTH = 500  # characters; a longer calculation belongs in a script

_ONE_ARGUMENT = "abs sqrt exp log log10 sin cos tan radians degrees sign round".split()
FUNCTIONS: dict[str, tuple[Any, int]] = {name: (getattr(np, name), 1) for name in _ONE_ARGUMENT} | {
    "min": (np.minimum, 2),
    "max": (np.maximum, 2),
    "where": (None, 3),  # `_Evaluation.chosen`
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
    ast.Eq: ("==", np.equal),
    ast.NotEq: ("!=", np.not_equal),
}
_REMEDY = (
    "Use numbers, names, + - * / % **, comparisons, and, or, not and the functions "
    + ", ".join(FUNCTIONS)
    + "."
)


@dataclass(frozen=True)
class _Truth:
    """Where a comparison holds, and where it is decided, two arrays of bool that broadcast."""

    holds: np.ndarray
    known: np.ndarray

    @property
    def number(self) -> np.ndarray:
        """Return 1 where the comparison holds, 0 where it does not, and NaN where it is
        undecided.
        """
        return np.where(self.known, self.holds, np.nan)


@dataclass(frozen=True)
class Relation:
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
        Names.

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
        Value of the expression; a single number if all values are numbers. NaN where a value that
        it needs is NaN.

    Raises
    ------
    InputError
        For a node that is not allowed, an unknown name, or a result that is not a number.

    Examples
    --------
    >>> evaluate("-ratio * r", {"ratio": np.array([1.1, 1.2]), "r": 6.0})
    array([-6.6, -7.2])
    >>> evaluate("where(n > 1, 1, 0)", {"n": np.array([2.0, 1.0, np.nan])})
    array([ 1.,  0., nan])
    """
    number = _number(_Evaluation(text, field, values).value(_parse(text, field)))
    if number is None:
        raise InputError(field, text, "a number", "Compare texts with == or !=.", "gives a text")
    return number


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
        True where the condition holds; False where a value that it compares is NaN, also for ``!=``
        and `not`.

    Raises
    ------
    InputError
        As in `evaluate`, or if the text is not a comparison.
    """
    result = _truth(_Evaluation(text, field, values).value(_parse(text, field)))
    if result is None:
        raise InputError(field, text, "a comparison such as 'max_pressure < 1500'")
    return np.asarray(result.holds & result.known)


def comparisons(text: str, field: str) -> tuple[Relation, ...]:
    """Split a condition into comparisons joined by `or`.

    Parameters
    ----------
    text : str
        Condition such as ``slip > 0.1 or regime == full_slip``; each left side is one name.
    field : str
        Name of the study key, for error messages.

    Returns
    -------
    tuple of Relation
        The comparisons in the order of the text.

    Raises
    ------
    InputError
        If the text is not such a condition.
    """
    tree = _parse(text, field)
    if isinstance(tree, ast.BoolOp) and isinstance(tree.op, ast.Or):
        parts = tree.values
    else:
        parts = [tree]
    compared = []
    for part in parts:
        if (
            not isinstance(part, ast.Compare)
            or len(part.ops) != 1
            or type(part.ops[0]) not in _COMPARE
        ):
            allowed = "comparisons (> >= < <= == !=) joined by 'or'"
            raise InputError(
                field, text, allowed, "For example: slip > 0.1 or max_pressure > 1500."
            )
        value = ast.unparse(part.left)
        compared.append(
            Relation(value, _COMPARE[type(part.ops[0])][0], ast.unparse(part.comparators[0]))
        )
    return tuple(compared)


def _parse(text: str, field: str) -> ast.expr:
    if not isinstance(text, str) or not text.strip():
        raise InputError(
            field, text, "a text with an expression or a comparison", "For example: 2 * slip > 0.1."
        )
    return _tree(text, field)


@lru_cache(maxsize=256)
def _tree(text: str, field: str) -> ast.expr:
    if len(text) > MAX_LENGTH:
        raise InputError(
            field, text[:40] + "...", f"an expression of at most {MAX_LENGTH} characters"
        )
    try:
        with warnings.catch_warnings():
            # about nodes that are refused anyway, such as 2(x)
            warnings.simplefilter("ignore", SyntaxWarning)
            tree = ast.parse(text.strip(), mode="eval").body
        check_tree(tree, text, field)
        return tree
    except InputError:
        raise
    except SyntaxError as exc:
        name = name_with_blank(text)
        if name:
            wrong = f"has a blank between the words '{name}'"
            raise InputError(field, text, NAMES, rename_remedy(name), wrong) from None
        wrong = f"has a syntax error at character {max(exc.offset or 1, 1)}"
        raise InputError(field, text, "", syntax_remedy(text) or _REMEDY, wrong) from None
    except (RecursionError, MemoryError, ValueError):
        raise InputError(
            field, text, "", _REMEDY, "has too deep brackets, or is not a text"
        ) from None


def _names(node: ast.AST) -> set[str]:
    """Return the names below a node; those of functions and constants do not count."""
    if isinstance(node, ast.Name):
        return {node.id} - set(CONSTANTS)
    parts: Iterable[ast.AST] = ast.iter_child_nodes(node)
    if isinstance(node, ast.Call):
        parts = node.args
    return set().union(*map(_names, parts))


def _number(value: Any) -> np.ndarray | None:
    """Return a value of an expression as floats, None for a text or a column that holds texts."""
    if isinstance(value, _Truth):
        return value.number
    array = np.asarray(value)
    if array.dtype.kind in "SU" or (
        array.dtype.kind == "O" and any(isinstance(one, str) for one in array.flat)
    ):
        return None
    try:
        return array.astype(float)  # None in a column stands for a value that is not given
    except (TypeError, ValueError):  # a pair of materials
        return None


def _parted(values: list[Any]) -> tuple[list[np.ndarray], list[Any]]:
    """Return those of some values that are numbers, as floats, and the others, which are texts."""
    numbers = [_number(value) for value in values]
    texts = [value for value, number in zip(values, numbers, strict=True) if number is None]
    return [number for number in numbers if number is not None], texts


def _truth(value: Any) -> _Truth | None:
    """Return a comparison, also one that a column of bool holds; None for any other value."""
    if isinstance(value, _Truth):
        return value
    array = np.asarray(value)
    if array.dtype == bool:
        return _Truth(array, np.ones(array.shape, dtype=bool))
    return None


@dataclass(frozen=True)
class _Evaluation:
    """Values of the nodes of one expression: numbers, texts, columns of them, and comparisons as
    `_Truth`.
    """

    text: str
    field: str
    values: Mapping[str, Any]

    def value(self, node: ast.AST) -> Any:
        match node:
            case ast.Constant(value=bool()):
                raise self.refused(node, "a truth value")
            case ast.Constant(value=int() | float()):
                return self.constant(node)
            case ast.Constant(value=str() as word):
                return word
            case ast.Name():
                return self.named(node)
            case ast.BinOp(left=left, op=op, right=right) if type(op) in _BINARY:
                return self.applied(_BINARY[type(op)], [left, right], node)
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return self.applied(np.negative, [operand], node)
            case ast.UnaryOp(op=ast.UAdd(), operand=operand):
                return self.applied(np.positive, [operand], node)
            case ast.Call(func=ast.Name(id=name), args=args, keywords=[]) if name in FUNCTIONS:
                return self.called(name, args, node)
        return self.logic(node)

    def called(self, name: str, args: list[ast.expr], node: ast.AST) -> Any:
        """Return the value of a function of `FUNCTIONS`."""
        function, arity = FUNCTIONS[name]
        if len(args) != arity or any(isinstance(arg, ast.Starred) for arg in args):
            raise self.refused(node, f"{name} with {len(args)} arguments (it takes {arity})")
        if function:
            return self.applied(function, args, node)
        return self.chosen(args, node)

    def constant(self, node: ast.Constant) -> float:
        """Return a number of the text as a float: powers of whole numbers could fill the memory."""
        try:
            number = float(node.value)  # type: ignore[arg-type]  # `value` passes numbers only
        except OverflowError:  # a whole number of hundreds of digits
            number = math.inf
        written = ast.get_source_segment(self.text.strip(), node) or ""
        if math.isinf(number) or (number == 0 and re.search("[1-9]", re.split("[eE]", written)[0])):
            if number:
                raise self.refused(
                    node, "a number too large for the computer", "Write inf for infinity."
                )
            raise self.refused(node, "a number too small for the computer", "")
        return number

    def logic(self, node: ast.AST) -> _Truth:
        match node:
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                truth = self.truth(operand)
                return _Truth(~truth.holds, truth.known)
            case ast.BoolOp(op=op, values=parts):
                join: Callable[..., Any] = np.logical_or
                if isinstance(op, ast.And):
                    join = np.logical_and
                return self.joined(join, [self.truth(part) for part in parts])
            case ast.Compare(left=left, ops=ops, comparators=further) if all(
                type(op) in _COMPARE for op in ops
            ):
                sides = [self.value(part) for part in (left, *further)]
                truths = [
                    self.compared(*part, node) for part in zip(ops, sides, sides[1:], strict=False)
                ]
                return self.joined(np.logical_and, truths)  # a part of constants has another shape
            case ast.Call():
                error = unknown_function(node, FUNCTIONS, self.field)
                if error:
                    raise error
        raise self.refused(node, *not_allowed(node))

    def joined(self, join: Any, parts: list[_Truth]) -> _Truth:
        """Return several comparisons joined; they are decided where each of them is."""
        known = reduce(np.logical_and, [part.known for part in parts])
        return _Truth(np.asarray(reduce(join, [part.holds for part in parts])), np.asarray(known))

    def named(self, node: ast.Name) -> Any:
        for known in (self.values, CONSTANTS):
            if node.id in known:
                return known[node.id]
        raise unknown_name(
            f"{self.field} (character {node.col_offset + 1})", node.id, list(self.values)
        )

    def applied(self, function: Any, parts: list[ast.expr], node: ast.AST) -> np.ndarray:
        """Return a function of numbers, NaN wherever an argument is NaN, as in nan ** 0."""
        values = [self.value(part) for part in parts]
        numbers, texts = _parted(values)
        if texts:
            raise self.with_text(node, texts[0])
        with np.errstate(all="ignore"):  # the caller reports NaN with its row
            result = function(*numbers)
        return np.where(reduce(np.logical_or, [np.isnan(one) for one in numbers]), np.nan, result)

    def chosen(self, parts: list[ast.expr], node: ast.AST) -> np.ndarray:
        """Return ``where(condition, one, other)``: numbers, NaN where the condition is undecided,
        or texts.
        """
        decider, *both = (self.value(part) for part in parts)
        truth = _truth(decider)
        numbers, texts = _parted(both)
        if truth is None:
            number = _number(decider)
            if number is None:
                raise self.refused(node, "where with a text as its condition")
            truth = _Truth(np.asarray(number != 0), ~np.isnan(number))
        if numbers and texts:
            raise self.refused(node, "where with a text beside a number")
        one, other = numbers or [np.asarray(text, dtype=object) for text in texts]
        chosen = np.where(truth.holds, one, other)
        if numbers:
            chosen[~np.broadcast_to(truth.known, chosen.shape)] = np.nan
        else:
            chosen[~np.broadcast_to(truth.known, chosen.shape)] = None
        return chosen

    def compared(self, op: ast.cmpop, one: Any, other: Any, node: ast.AST) -> _Truth:
        compare = _COMPARE[type(op)][1]
        numbers, texts = _parted([one, other])
        if texts and (numbers or not isinstance(op, (ast.Eq, ast.NotEq))):
            name = next((one for one in texts if isinstance(one, str) and " " in one.strip()), "")
            remedy = rename_remedy(name) if name else ""
            raise self.refused(node, "ordering a text, or comparing it with a number,", remedy)
        if numbers:
            one, other = numbers
            known = ~np.isnan(one) & ~np.isnan(other)
        else:
            one, other = (np.asarray(text, dtype=object) for text in texts)
            known = np.asarray(one != np.array(None), dtype=bool) & np.asarray(
                other != np.array(None), dtype=bool
            )
        return _Truth(np.asarray(compare(one, other), dtype=bool), np.asarray(known))

    def truth(self, node: ast.AST) -> _Truth:
        truth = _truth(self.value(node))
        if truth is None:
            raise self.refused(node, "something other than a comparison beside and, or, not")
        return truth

    def with_text(self, node: ast.AST, value: Any) -> InputError:
        """Return the error for arithmetic with a text; it names the text."""
        word = next(
            (one for one in np.asarray(value, dtype=object).flat if isinstance(one, str)), None
        )
        if word is None:
            return self.refused(node, "arithmetic with a text")
        remedy = ""
        if split_quantity(word):
            remedy = (
                "Only parameters take units: write the numbers of a factor of your own "
                "without them."
            )
        return self.refused(node, f"arithmetic with a text ('{word}')", remedy)

    def refused(self, node: ast.AST, element: str, remedy: str = "") -> InputError:
        at = getattr(node, "col_offset", 0) + 1
        wrong = f"holds {element} at character {at}, which is not allowed"
        return InputError(self.field, self.text, "", remedy or _REMEDY, wrong)
