"""Check the syntax tree of an expression before it is evaluated."""

from __future__ import annotations

import ast
import keyword
import re
from collections.abc import Collection

from trackroller.errors import InputError, unknown_name
from trackroller.parameters import PARAMETERS

MAX_DEPTH = 60  # of the syntax tree
TRIGONOMETRIC = ("sin", "cos", "tan")
DEGREES = frozenset(name for name, parameter in PARAMETERS.items() if parameter.unit == "deg")

_COMMA = "Write decimals with a point, such as 0.5, and thousands without a comma."
_MULTIPLY = "Write * for a product."
_POWER = "Write ** for a power, such as x ** 2."
_SYNTAX = {  # what a person writes who expects another language -> what to write
    r"\b(?:AND|And|OR|Or|NOT|Not)\b": "Write and, or, not in small letters.",
    r"\d,\d{3}(?!\d)": _COMMA,
    r"[²³]": _POWER,
    r"[×·⋅]|\d\s*[^\W\d]|\)\s*[\w(]": _MULTIPLY,
    "[\u2010-\u2013\u2212]": "Write - for a minus; the text has another dash.",
    r"√": "Write sqrt(x) for a root.",
    r"<>|≠": "Write != for 'not equal'.",
    r"=[<>]|[≤≥]": "Write <= or >=.",
    r"&&|\|\|": "Write and, or.",
    r";": "Separate the arguments of a function by commas, and write decimals with a point.",
    r"(?<![<>=!])=(?!=)": "Write == for 'equal'.",
    r"%": "Write a share of 5 % as 0.05; % is the remainder of a division.",
}
_NODES: dict[type[ast.AST], tuple[str, str]] = {
    ast.BitXor: ("the sign ^", _POWER),
    ast.FloorDiv: ("the sign //", "Write / for a quotient."),
    ast.MatMult: ("the sign @", _MULTIPLY),
    ast.BitAnd: ("the sign &", "Write and."),
    ast.BitOr: ("the sign |", "Write or."),
    ast.Invert: ("the sign ~", "Write not."),
    ast.Tuple: ("a comma outside a function", _COMMA),
    ast.IfExp: ("if and else", "Write where(condition, one, other)."),
    ast.Attribute: (
        "names joined by a point",
        "Write sqrt(x) and pi without np. or math. before them.",
    ),
    ast.Call: ("named arguments", "Write the arguments of a function without names."),
    ast.Is: ("the word is", "Write ==."),
    ast.IsNot: ("the words is not", "Write !=."),
    ast.In: ("the word in", "Compare with each value, as in x == 1 or x == 2."),
    ast.NotIn: ("the words not in", "Compare with each value, as in x != 1 and x != 2."),
}
_OTHER_NAMES = {"ln": "log", "pow": "**", "lg": "log10", "sqr": "** 2", "if": "where"}


NAMES = "names of letters, digits and _"


def name_with_blank(text: str) -> str:
    """Return words with blanks between them that stand where one name can stand, '' if there are
    none.

    Examples
    --------
    >>> name_with_blank("slip < 0.1 and load case == 'first run'")
    'load case'
    >>> name_with_blank("slip < 0.1 and not drawn")
    ''
    """
    without_texts = re.sub(r"'[^']*'|\"[^\"]*\"", "''", text)
    for words in re.finditer(r"[^\W\d]\w*(?:[ \t]+[^\W\d]\w*)+", without_texts):
        name: list[str] = []
        for word in [*words[0].split(), "and"]:
            if word.lower() not in keyword.kwlist:
                name.append(word)
            elif len(name) > 1:
                return " ".join(name)
            else:
                name = []
    return ""


def rename_remedy(name: str) -> str:
    """Return what to write for words that are no name of an expression; a column of a table is
    known by it, too.
    """
    new = re.sub(r"\W+", "_", name).strip("_")
    return f"Write {new}: a column is known by this name, too."


def syntax_remedy(text: str) -> str:
    """Return what to write in a text that is no expression; '' if nothing is known."""
    if text.count("(") != text.count(")"):
        return "Close each bracket once."
    remedies = (remedy for pattern, remedy in _SYNTAX.items() if re.search(pattern, text))
    return next(remedies, "")


def not_allowed(node: ast.AST) -> tuple[str, str]:
    """Return in words what is not allowed at a node, and what to write instead, '' if nothing is
    known.
    """
    if isinstance(node, ast.Call) and not isinstance(node.func, ast.Name):
        return "no function before a bracket", _MULTIPLY
    parts = [node, getattr(node, "op", None), *getattr(node, "ops", ())]
    known = next((_NODES[type(part)] for part in parts if type(part) in _NODES), None)
    return known or ("a part that is neither arithmetic nor a comparison", "")


def unknown_function(node: ast.Call, functions: Collection[str], field: str) -> InputError | None:
    """Return the error for a function that is not known, None for another call."""
    name = ast.unparse(node.func).rpartition(".")[2]
    if (name in functions and isinstance(node.func, ast.Name)) or not isinstance(
        node.func, (ast.Name, ast.Attribute)
    ):
        return None
    error = unknown_name(f"{field} (character {node.col_offset + 1})", name, functions)
    instead = ""
    if name in functions:
        instead = f"Write {name}(...) without a name before it."
    if _OTHER_NAMES.get(name):
        instead = f"Write {_OTHER_NAMES[name]}."
    return InputError(
        error.field,
        ast.unparse(node.func),
        "the functions " + ", ".join(functions),
        instead or error.remedy,
        error.wrong,
    )


def check_tree(tree: ast.expr, text: str, field: str) -> None:
    """Refuse an expression that nests too deeply, or that takes the sine, cosine or tangent of an
    angle in degrees.

    Parameters
    ----------
    tree : ast.expr
        Syntax tree of the expression.
    text, field : str
        The expression and the name of its field, for the message.

    Raises
    ------
    InputError
        If the tree has more than `MAX_DEPTH` levels, or `radians` does not convert an angle in
        degrees.
    """
    level: list[ast.AST] = [tree]
    for _ in range(MAX_DEPTH):
        level = [child for node in level for child in ast.iter_child_nodes(node)]
    if level:
        raise InputError(
            field, text[:40] + "...", f"an expression of at most {MAX_DEPTH} levels", "Shorten it."
        )
    for call in ast.walk(tree):
        if (
            isinstance(call, ast.Call)
            and isinstance(call.func, ast.Name)
            and call.func.id in TRIGONOMETRIC
        ):
            degrees = None
            if call.args:
                degrees = _unconverted(call.args[0])
            if degrees:
                allowed = f"an angle in radians in {call.func.id}(); {degrees} is in degrees"
                raise InputError(field, text, allowed, f"Write {call.func.id}(radians({degrees})).")


def _unconverted(node: ast.AST) -> str | None:
    """Return the first name of an angle in degrees that `radians` does not convert."""
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "radians":
        return None
    if isinstance(node, ast.Name) and node.id in DEGREES:
        return node.id
    return next(
        (name for child in ast.iter_child_nodes(node) if (name := _unconverted(child))), None
    )
