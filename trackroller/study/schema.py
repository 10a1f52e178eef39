"""JSON schema of a study file, for editors and documentation; `python -m trackroller.study.schema` writes it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from trackroller.parameters import (
    ACCURACIES,
    HERTZ,
    LIFE_RULES,
    MAPPING_FIELDS,
    MATERIAL_FIELDS,
    OUTPUT_GROUPS,
    PARAMETERS,
    SLIP_TERMS,
    STRESS_BODIES,
)
from trackroller.study.config import NAME, StudyFile
from trackroller.study.design.entries import OPTION_FACTORS
from trackroller.study.design.factors import DISTRIBUTIONS
from trackroller.study.design.sampling import METHODS, OLD_NAMES

FILE = Path(__file__).resolve().parents[2] / "workflow" / "schemas" / "study.schema.json"


def _factor() -> dict[str, Any]:
    kinds: dict[str, Any] = {"values": {"type": "array", "minItems": 1}, "expression": {"type": "string"}}
    numbers = {**DISTRIBUTIONS, "linspace": 3, "logspace": 3}
    kinds |= {kind: {"type": "array", "minItems": n, "maxItems": n} for kind, n in numbers.items()}
    return {
        "type": "object",
        "properties": {**kinds, "scatter": {"type": "boolean"}},
        "additionalProperties": False,
        "oneOf": [{"required": [kind]} for kind in kinds],
    }


def schema() -> dict[str, Any]:
    """The schema: pydantic's, with the names and bounds of the parameters and options filled in."""
    found = StudyFile.model_json_schema()
    properties = found["properties"]
    properties["name"]["pattern"] = f"^{NAME.pattern}$"
    base: dict[str, Any] = {}
    for name, parameter in PARAMETERS.items():
        base[name] = {"description": f"{parameter.allowed()}; {parameter.meaning}"}
    pair = {"type": "array", "items": {"type": "string"}, "minItems": 2, "maxItems": 2}
    base |= {name: {"type": "string"} for name in MATERIAL_FIELDS} | {"material_pair": pair}
    base |= {name: {"type": ["object", "string", "null"], "description": told} for name, told in MAPPING_FIELDS.items()}
    properties["base"] |= {"properties": base, "additionalProperties": False}
    named = {
        name: _factor() | ({"description": PARAMETERS[name].allowed()} if name in PARAMETERS else {})
        for name in (*base, *OPTION_FACTORS)
    }
    properties["factors"] |= {"properties": named, "additionalProperties": _factor()}
    properties["design"]["enum"] = [*METHODS, *OLD_NAMES]
    properties["outputs"]["items"] = {"enum": list(OUTPUT_GROUPS)}
    properties["slip_terms"] |= {"items": {"enum": list(SLIP_TERMS)}, "uniqueItems": True}
    options = {"hertz": HERTZ, "stress_bodies": STRESS_BODIES, "life_rule": LIFE_RULES}
    for name, words in options.items():
        properties[name]["enum"] = list(words)
    properties["accuracy"]["anyOf"] = [
        {"enum": list(ACCURACIES)},
        {"type": "number", "exclusiveMinimum": 0, "exclusiveMaximum": 1},
    ]
    for name, words in OPTION_FACTORS.items():
        several = {"type": "array", "items": {"enum": list(words)}, "minItems": 1, "uniqueItems": True}
        properties[name]["anyOf"] = [{"enum": list(words)}, several]
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **found}


def text() -> str:
    """The schema as it stands in the repository."""
    return json.dumps(schema(), indent=2) + "\n"


if __name__ == "__main__":
    FILE.write_text(text(), encoding="utf-8")
