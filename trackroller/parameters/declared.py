"""Read what the limits of the room `damage` declare: groups of outputs, fields of a case, values of a material.

`python docs/generate.py` writes `limits.json` from the declarations. This room must not import that room.
Limits of a user's own add theirs, where they are allowed.
"""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

from trackroller.errors import InputError
from trackroller.parameters.own_limits import declarations

FILE = Path(__file__).with_name("limits.json")


@cache
def declared() -> dict[str, Any]:
    """Return the declarations: `groups` (meaning by name), `parameters` and `materials` (fields of `Parameter`)."""
    content: dict[str, Any] = json.loads(FILE.read_text(encoding="utf-8"))
    for kind, own in declarations().items():
        clash = {str(row) for row in _names(content[kind]) & _names(own)}
        if clash:
            raise InputError("limits", ", ".join(sorted(clash)), f"new {kind}: these exist", "Choose another name.")
        content[kind] = content[kind] | own if isinstance(own, dict) else content[kind] + own
    return content


def _names(rows: Any) -> set[str]:
    return set(rows) if isinstance(rows, dict) else {row["name"] for row in rows}
