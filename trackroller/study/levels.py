"""Values of a factor in a few words: a friction law or a drawn profile is a whole mapping in a result's columns."""

from __future__ import annotations

import json
import zlib
from collections.abc import Mapping
from typing import Any

from trackroller.parameters import MAPPING_FIELDS


def short(name: str, value: Any) -> str:
    """A text level of a factor: that of a mapping in words, 'linear to 0.3 at 50 mm/s'; other texts as they are.

    Parameters
    ----------
    name : of the factor
    value : its value, a text (of a mapping: its canonical JSON, '' for none) or a mapping
    """
    if name not in MAPPING_FIELDS:
        return str(value)
    try:
        told = value if isinstance(value, Mapping) else json.loads(str(value) or "{}")
        return _law(told) if name == "friction_law" else _profile(told, str(value))
    except (ValueError, KeyError, TypeError, AttributeError):
        text = str(value)
        return text if len(text) <= 40 else text[:39] + "…"


def _law(told: Mapping[str, Any]) -> str:
    kind = str(told.get("kind", "constant"))
    if kind in ("linear", "exponential"):
        lowest = told.get("lowest", 0.0 if kind == "linear" else 0.4)
        return f"{kind} to {lowest:g} {'at' if kind == 'linear' else 'over'} {told['speed']:g} mm/s"
    if kind == "table":
        speed, friction = told["speed"], told["friction"]
        return f"table, {friction[-1]:g} from {speed[-1]:g} mm/s"
    return kind


def _profile(told: Mapping[str, Any], text: str) -> str:
    form = next((key for key in ("arc", "parabola", "arcs", "points", "file") if key in told), "")
    if not form:
        return "circle"
    if form in ("arc", "parabola"):
        words = f"{form} {float(told[form]):g} mm".replace("-", "−")
    elif form == "arcs":
        words = f"{len(told['arcs'])} arcs"
    else:  # two drawn shapes may have as many points: the mark tells them apart
        words = f"drawn {zlib.crc32(text.encode()) & 0xFF:02x}"
        words += f", {len(told['points'])} points" if form == "points" else ""
    if "width" in told:
        words += f", {told['width']:g} mm wide"
    return words + (", cut edges" if "edge" in told else "")
