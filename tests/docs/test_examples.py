"""Every example of a docstring runs and prints what the docstring shows."""

from __future__ import annotations

import doctest
import importlib
import inspect
from pathlib import Path

import pytest

import trackroller as tr
from trackroller.app import frame
from trackroller.carriage.solve import solve_carriage
from trackroller.report import write

PACKAGE = Path(tr.__file__).parent
MODULES = sorted(
    ".".join(("trackroller", *path.relative_to(PACKAGE).with_suffix("").parts)).removesuffix(".__init__")
    for path in PACKAGE.rglob("*.py")
    if ">>> " in path.read_text(encoding="utf-8")
)


@pytest.mark.slow
@pytest.mark.parametrize("module", MODULES)
def test_examples_print_what_they_show(module, tmp_path, monkeypatch):
    """The examples of a module run in an empty folder and print the shown text."""
    monkeypatch.chdir(tmp_path)
    failed, attempted = doctest.testmod(importlib.import_module(module))
    assert attempted and not failed


def test_every_public_function_has_an_example():
    """A name of the package has a docstring with an example."""
    called = {"report": write, "app": frame, "carriage": solve_carriage}  # rooms that are functions, too
    public = [called.get(name) or getattr(tr, name) for name in tr.__all__ if not name.startswith("__")]
    assert [thing.__name__ for thing in public if ">>> " not in (inspect.getdoc(thing) or "")] == []
