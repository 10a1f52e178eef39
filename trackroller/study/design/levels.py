"""Short texts for the values of a factor, such as a friction law or a drawn profile.

In the columns of a result such a value is a whole mapping. Its short text states everything the
mapping holds, or carries a mark computed from it, so that two levels of a factor never have the
same text.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Mapping
from typing import Any

from trackroller.methods.factor import label
from trackroller.parameters import MAPPING_FIELDS, MECHANICAL_MAPPINGS

OF_MATERIALS = ("material_pair", "roller_material", "guide_material")
NAMED = ("motor_force", "guide_curve_radius", *OF_MATERIALS)  # factors whose levels have names
LONGEST = 40  # signs of a text that states a whole mapping
MOST_ARCS = 3  # of a profile whose arcs are named one by one
EDGES = {"inner": "in", "outer": "out", "chamfer": "rounded"}


def short(name: str, value: Any) -> str:
    """Return a short text for a level of a factor whose values are mappings.

    Parameters
    ----------
    name : name of the factor, one of `MAPPING_FIELDS`
    value : a mapping, or its canonical JSON, or ''

    Returns
    -------
    A description of the mapping, such as 'linear to 0.3 at 50 mm/s'.
    """
    try:
        if isinstance(value, Mapping):
            mapping = value
        else:
            mapping = json.loads(str(value) or "{}")
        if name == "friction_law":
            return _law(mapping)
        if name in MECHANICAL_MAPPINGS:
            return _profile(mapping)
        if mapping.get("name"):
            return str(mapping["name"])
        text = entries(mapping)
        if len(text) > LONGEST:
            return f"{_first_entries(mapping)}, {_mark(text)}"
    except (ValueError, KeyError, TypeError, AttributeError, IndexError):
        text = str(value)
    if len(text) <= LONGEST:
        return text
    return f"{text[:34]}… {_mark(text)}"


def _first_entries(mapping: Mapping[str, Any]) -> str:
    """Return the first word and the first number of a mapping, such as 'ball, dynamic rating
    600'.
    """
    words = [str(value) for value in mapping.values() if isinstance(value, str)]
    numbers = {key: value for key, value in mapping.items() if isinstance(value, (int, float))}
    first = sorted(numbers, key=lambda key: (key[:1].isupper(), key))[:1]
    return ", ".join([*words[:1], *(entries({key: numbers[key]}) for key in first)])


def entries(mapping: Mapping[str, Any]) -> str:
    """Return the entries of a mapping as text, such as 'kind ball, rows 2'; keys in capitals come
    last.
    """
    keys = sorted(mapping, key=lambda key: (key[:1].isupper(), key))
    return ", ".join(f"{key} {_entry(mapping[key])}".replace("_", " ") for key in keys)


def _entry(value: Any) -> Any:
    """Return an entry of a mapping as it is shown."""
    if isinstance(value, (str, list)):
        return value
    return _number(value)


def in_words(name: str, value: Any) -> str:
    """Return a level of a factor, number or not, as text for tables and messages."""
    if name in MAPPING_FIELDS:
        return short(name, value)
    return label(value)


def _mark(value: Any) -> str:
    """Return four characters computed from a value that is too long for a description."""
    if isinstance(value, str):
        text = value
    else:
        text = json.dumps(value, sort_keys=True, default=float)
    return f"{zlib.crc32(text.encode()) & 0xFFFF:04x}"


def _number(value: Any) -> str:
    """Return a number with six digits, or with twelve if six would change it."""
    text = f"{float(value):g}"
    return (text if float(text) == float(value) else f"{float(value):.12g}").replace("-", "−")


def _law(law: Mapping[str, Any]) -> str:
    kind = str(law.get("kind", "constant"))
    if kind == "linear":
        return f"linear to {_number(law.get('lowest', 0.0))} at {_number(law['speed'])} mm/s"
    if kind == "exponential":
        return f"exponential to {_number(law.get('lowest', 0.4))} over {_number(law['speed'])} mm/s"
    if kind == "table":
        speed = law["speed"]
        friction = law["friction"]
        last = f"{_number(friction[0])} to {_number(friction[-1])} from {_number(speed[-1])} mm/s"
        if len(speed) <= 2:
            return f"table {last}"
        return f"table {_mark(law)}, {last}"
    return kind


def _profile(profile: Mapping[str, Any]) -> str:
    form = next(
        (key for key in ("arc", "parabola", "arcs", "points", "file") if key in profile), ""
    )
    if form in ("arc", "parabola", "arcs") and "name" in profile:
        return str(profile["name"])
    if not form:
        words = "circle"
    elif form in ("arc", "parabola"):
        words = f"{form} {_number(profile[form])} mm"
    elif form == "arcs":
        words = _arcs(profile["arcs"])
    elif form == "file":
        words = f"drawn {profile['file']}"
    else:  # the mark distinguishes drawn shapes, and smoothed or worn ones from others
        plain = (
            "name" in profile
            and profile.get("frame") == "section"
            and not {"smooth", "worn"} & set(profile)
        )
        if plain:
            words = profile["name"]
        else:
            words = f"{profile.get('name', 'drawn')} {_mark(profile)}"
        words += f", {len(profile['points'])} points"
    if "width" in profile:
        words += f", {_number(profile['width'])} mm wide"
    edge = profile.get("edge", {})
    parts = [f"{words_of} {_number(edge[key])}" for key, words_of in EDGES.items() if key in edge]
    return words + (f", edge {' '.join(parts)} mm" if parts else "")


def _arcs(rows: list[Mapping[str, Any]]) -> str:
    radii = [_number(row["radius"]) for row in rows]
    if len(rows) == 1:
        return f"arc {radii[0]} mm"
    if len(rows) > MOST_ARCS:
        return f"{len(rows)} arcs {radii[0]}/…/{radii[-1]} mm {_mark(rows)}"
    ends = [f" to {_number(row['to'])}" for row in rows[:-1]]
    return f"arcs {', '.join(map(''.join, zip(radii, [*ends, ''], strict=True)))} mm"
