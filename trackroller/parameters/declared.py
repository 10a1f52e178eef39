"""Read what the limits of the room `damage` declare: groups of outputs, fields of a case, values of a material.

`python docs/generate.py` writes `limits.json` from the declarations. This room must not import that room.
"""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

FILE = Path(__file__).with_name("limits.json")


@cache
def declared() -> dict[str, Any]:
    """Return the declarations: `groups` (meaning by name), `parameters` and `materials` (fields of `Parameter`)."""
    content: dict[str, Any] = json.loads(FILE.read_text(encoding="utf-8"))
    return content
