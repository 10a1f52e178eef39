"""Check the docstrings of public functions and classes by numpydoc's rules: `python -m validation.docstrings`.

Public are the names of `trackroller.__all__` and those of the reference page (`docs/reference.md`). The command ends
with 1 if a docstring breaks a rule.
"""

from __future__ import annotations

import re
from pathlib import Path
from types import ModuleType

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
CALLED = {"report": "report.write", "app": "app.frame"}  # rooms that are functions, too
REFERENCE = Path(__file__).resolve().parents[1] / "docs" / "reference.md"


def public_names() -> list[str]:
    """Return the dotted names of all public functions, classes and methods."""
    listed = re.findall(r"^::: (\S+)$", REFERENCE.read_text(encoding="utf-8"), re.M)
    exported = {name: getattr(trackroller, name) for name in trackroller.__all__ if not name.startswith("__")}
    for name, thing in exported.items():
        listed.append(f"trackroller.{CALLED[name]}" if isinstance(thing, ModuleType) else f"trackroller.{name}")
    return sorted(set(listed))


def problems() -> list[str]:
    """Return one line for each rule that a public docstring breaks; a class returns nothing."""
    checked = {name: validate(name) for name in public_names()}
    return [
        f"{name}: {code} {text}"
        for name, result in checked.items()
        for code, text in result["errors"]
        if code in RULES and not (code in ("RT01", "RT03") and result["type"] == "type")
    ]


if __name__ == "__main__":
    broken = problems()
    print("\n".join(broken))
    print(f"{len(public_names())} public docstrings: {len(broken)} rules broken")
    raise SystemExit(1 if broken else 0)
