"""Docstrings of public functions and classes keep numpydoc's rules.

Public are the names of `trackroller.__all__` and those of the reference page (`docs/reference.md`).
"""

from __future__ import annotations

import re
from pathlib import Path
from types import ModuleType

import pytest
from numpydoc.validate import validate

import trackroller

# numpydoc's codes: a summary, in the imperative, one line; every parameter and the result described
RULES = {
    "GL08": "no docstring",
    "SS01": "no summary",
    "SS05": "summary does not start with an infinitive verb",
    "PR01": "a parameter is missing",
    "PR02": "an unknown parameter",
    "PR03": "parameters in another order than the signature",
    "PR07": "a parameter without description",
    "RT01": "no section Returns",
    "RT03": "the result without description",
}
CALLED = {
    "report": "report.write",
    "app": "app.frame",
    "carriage": "carriage.solve.solve_carriage",
}  # rooms that are functions, too
REFERENCE = Path(__file__).resolve().parents[2] / "docs" / "reference.md"


def exported_names() -> list[str]:
    """Return the dotted names that the package exports."""
    exported = {name: getattr(trackroller, name) for name in trackroller.__all__ if not name.startswith("__")}
    return [
        f"trackroller.{CALLED[name]}" if isinstance(thing, ModuleType) else f"trackroller.{name}"
        for name, thing in exported.items()
    ]


def public_names() -> list[str]:
    """Return the dotted names of all public functions, classes and methods."""
    shown = re.findall(r"^::: (\S+)$", REFERENCE.read_text(encoding="utf-8"), re.M)
    return sorted({*shown, *exported_names()})


def problems(name: str) -> list[str]:
    """Return one line for each rule that a public docstring breaks; a class returns nothing."""
    result = validate(name)
    counts = {*RULES} - ({"RT01", "RT03"} if result["type"] == "type" else set())
    return [f"{code} {text}" for code, text in result["errors"] if code in counts]


@pytest.mark.parametrize("name", public_names())
def test_a_public_docstring_keeps_the_rules(name):
    assert problems(name) == []


def test_a_docstring_that_breaks_a_rule_is_found():
    assert any(problem.startswith("RT01") for problem in problems(f"{__name__}.public_names"))
