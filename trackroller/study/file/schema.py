"""JSON schema of a study file, for editors and documentation; `python -m
trackroller.study.file.schema` writes it.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from trackroller.methods import METHODS
from trackroller.methods.factor import DISTRIBUTIONS, ROWS
from trackroller.parameters import MAPPING_FIELDS, MATERIAL_FIELDS, PARAMETERS, Option
from trackroller.parameters.accuracy import QUANTITIES
from trackroller.roller.aliases import OTHER_OPTIONS
from trackroller.study.design.factor_names import OPTION_FACTORS, SHELVES
from trackroller.study.file.config import IN_STUDY, NAME, StudyFile
from trackroller.study.file.questions import QUESTIONS

FILE = Path(__file__).resolve().parents[3] / "workflow" / "schemas" / "study.schema.json"


def _factor() -> dict[str, Any]:
    kinds: dict[str, Any] = {
        "values": {"type": "array", "minItems": 1},
        "expression": {"type": "string"},
    }
    numbers = {**DISTRIBUTIONS, "linspace": 3, "logspace": 3}
    kinds |= {kind: {"type": "array", "minItems": n, "maxItems": n} for kind, n in numbers.items()}
    weights = {"type": "array", "items": {"type": "number", "exclusiveMinimum": 0}, "minItems": 1}
    return {
        "type": "object",
        "properties": {**kinds, "scatter": {"type": "boolean"}, "weights": weights},
        "additionalProperties": False,
        "oneOf": [{"required": [kind]} for kind in kinds],
    }


def _shelf() -> dict[str, Any]:
    """Return what the schema says about a factor whose levels are rows of a table."""
    whole = _factor()
    row = {"type": "object", "properties": {"name": {"type": "string"}}, "required": ["name"]}
    kinds = {"file": {"type": "string"}, ROWS: {"type": "array", "items": row, "minItems": 1}}
    units = {"type": "object", "additionalProperties": {"type": "string"}}
    properties = {**whole["properties"], **kinds, "units": units}
    one_of = [*whole["oneOf"], *({"required": [kind]} for kind in kinds)]
    return {
        **whole,
        "description": "levels that are rows of a table",
        "properties": properties,
        "oneOf": one_of,
    }


def _option(option: Option) -> dict[str, Any]:
    """Return what the schema says about an option beyond its type."""
    words: dict[str, Any] = {"enum": list(option.values)}
    several = {"type": "array", "items": words, "uniqueItems": True}
    low, high = option.bounds
    number: dict[str, Any] = {"type": "number", "exclusiveMinimum": low, "exclusiveMaximum": high}
    if option.factor:
        return {"anyOf": [words, several | {"minItems": 1}]}
    if option.kind == "words":
        return several | ({"minItems": 1} if option.required else {})
    by_quantity = {
        "type": "object",
        "properties": dict.fromkeys(QUANTITIES, number),
        "additionalProperties": False,
    }
    accuracy: dict[str, Any] = {"anyOf": [words, number, by_quantity | {"minProperties": 1}]}
    single: dict[str, dict[str, Any]] = {"word": words, "accuracy": accuracy, "number": number}
    return single.get(option.kind, {})


def schema() -> dict[str, Any]:
    """Return the schema: pydantic's, with the names and bounds of the parameters and options filled
    in.
    """
    whole = StudyFile.model_json_schema()
    properties = whole["properties"]
    properties["name"]["pattern"] = f"^{NAME.pattern}$"
    base: dict[str, Any] = {}
    for name, parameter in PARAMETERS.items():
        base[name] = {"description": f"{parameter.allowed()}; {parameter.meaning}"}
    pair = {"type": "array", "items": {"type": "string"}, "minItems": 2, "maxItems": 2}
    base |= {name: {"type": "string"} for name in MATERIAL_FIELDS} | {"material_pair": pair}
    base |= {
        name: {"type": ["object", "string", "null"], "description": text}
        for name, text in MAPPING_FIELDS.items()
    }
    properties["base"] |= {"properties": base, "additionalProperties": False}
    named = {name: _factor() for name in (*base, *OPTION_FACTORS)}
    for name in named.keys() & PARAMETERS.keys():
        named[name] = named[name] | {"description": PARAMETERS[name].allowed()}
    named |= {name: _shelf() for name in SHELVES}
    properties["factors"] |= {"properties": named, "additionalProperties": _factor()}
    properties["method"]["enum"] = list(METHODS)
    properties["question"]["enum"] = list(QUESTIONS)
    for other, name in OTHER_OPTIONS.items():
        properties[other] = {
            "description": f"another name of `{name}`, such as 5%",
            "type": ["number", "string"],
        }
    properties["design"] = {"description": "another name of `method`", "enum": list(METHODS)}
    target = {"description": "another name of `requirement`"} | properties["requirement"]
    whole["$defs"]["Analysis"]["properties"]["target"] = target
    for option in IN_STUDY:
        properties[option.name] |= _option(option)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **whole}


def text() -> str:
    """Return the schema as it stands in the repository."""
    return json.dumps(schema(), indent=2) + "\n"


if __name__ == "__main__":
    FILE.write_text(text(), encoding="utf-8")
