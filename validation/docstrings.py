"""Check the docstrings of public functions and classes by numpydoc's rules: `python -m validation.docstrings`.

Public are the names of `trackroller.__all__` and those of the reference page (`docs/reference.md`). The command ends
with 1 if a docstring breaks a rule.
"""

from __future__ import annotations

import contextlib
import importlib
import importlib.util
import re
from collections.abc import Iterator
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
REFERENCE = Path(__file__).resolve().parents[1] / "docs" / "reference.md"


def public_names() -> list[str]:
    """Return the dotted names of all public functions, classes and methods, each where it is defined."""
    listed = [("trackroller", name) for name in trackroller.__all__ if not name.startswith("__")]
    listed += [split_name(name) for name in reference_names()]
    return sorted(set(_defined(listed)))


def reference_names() -> list[str]:
    """Return the dotted names that the reference page shows."""
    return re.findall(r"^::: (\S+)$", REFERENCE.read_text(encoding="utf-8"), re.M)


def split_name(dotted: str) -> tuple[str, str]:
    """Return the module and the name inside it of a dotted name, such as `Study.design`."""
    parts = dotted.split(".")
    for end in range(len(parts) - 1, 0, -1):
        module = ".".join(parts[:end])
        with contextlib.suppress(ModuleNotFoundError):  # raised where the parent is a module, not a package
            if importlib.util.find_spec(module) is not None:
                return module, ".".join(parts[end:])
    raise ModuleNotFoundError(dotted)


def _defined(listed: list[tuple[str, str]]) -> Iterator[str]:
    for module, name in listed:
        thing = getattr(importlib.import_module(module), name.partition(".")[0])
        if isinstance(thing, ModuleType):  # `trackroller.report` is a room and a function
            yield f"{thing.__name__}.write"
        elif callable(thing):
            yield f"{thing.__module__}.{name}"


def problems() -> list[str]:
    """Return one line for each rule that a public docstring breaks."""
    return [
        f"{name}: {code} {text}"
        for name in public_names()
        for code, text in validate(name)["errors"]
        if code in RULES and not (code in ("RT01", "RT03") and isinstance(_object(name), type))
    ]


def _object(name: str) -> object:
    module, _, last = name.rpartition(".")
    try:
        return getattr(importlib.import_module(module), last)
    except ModuleNotFoundError:  # a method
        return None


if __name__ == "__main__":
    broken = problems()
    print("\n".join(broken))
    print(f"{len(public_names())} public docstrings: {len(broken)} rules broken")
    raise SystemExit(1 if broken else 0)
