"""Check the syntax tree of an expression before it is evaluated."""

from __future__ import annotations

import ast

from trackroller.errors import InputError
from trackroller.parameters import PARAMETERS

MAX_DEPTH = 60  # of the syntax tree
TRIGONOMETRIC = ("sin", "cos", "tan")
DEGREES = frozenset(name for name, parameter in PARAMETERS.items() if parameter.unit == "deg")


def check_tree(tree: ast.expr, text: str, field: str) -> None:
    """Refuse an expression that nests too deeply, or that takes the sine, cosine or tangent of an angle in degrees.

    Parameters
    ----------
    tree : ast.expr
        Syntax tree of the expression.
    text, field : str
        The expression and the name of its field, for the message.

    Raises
    ------
    InputError
        If the tree has more than `MAX_DEPTH` levels, or `radians` does not convert an angle in degrees.
    """
    level: list[ast.AST] = [tree]
    for _ in range(MAX_DEPTH):
        level = [child for node in level for child in ast.iter_child_nodes(node)]
    if level:
        raise InputError(field, text[:40] + "...", f"an expression of at most {MAX_DEPTH} levels", "Shorten it.")
    for call in ast.walk(tree):
        if isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id in TRIGONOMETRIC:
            degrees = _unconverted(call.args[0]) if call.args else None
            if degrees:
                allowed = f"an angle in radians in {call.func.id}(); {degrees} is in degrees"
                raise InputError(field, text, allowed, f"Write {call.func.id}(radians({degrees})).")


def _unconverted(node: ast.AST) -> str | None:
    """Return the first name of an angle in degrees that `radians` does not convert."""
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "radians":
        return None
    if isinstance(node, ast.Name) and node.id in DEGREES:
        return node.id
    return next((name for child in ast.iter_child_nodes(node) if (name := _unconverted(child))), None)
