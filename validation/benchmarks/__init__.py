"""Programs that measure one thing each and print it as JSON."""

from __future__ import annotations

import ast
from pathlib import Path

# Their results are times, so nothing else may run beside them.
TIMED = (
    "explorer_speed",
    "groove",
    "limits",
    "live_speed",
    "million",
    "scaling",
    "shortcuts",
    "speed",
)


def programs() -> dict[str, str]:
    """Return every program of this folder that has a function `measure`, with the first line of its docstring."""
    found = {}
    for path in sorted(Path(__file__).parent.glob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        if any(isinstance(node, ast.FunctionDef) and node.name == "measure" for node in tree.body):
            found[path.stem] = (ast.get_docstring(tree) or "").partition("\n")[0]
    return found
