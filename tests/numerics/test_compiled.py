"""Compiled functions state all options and avoid the functions of numba that take options from their first caller."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

import trackroller
from trackroller.numerics.compiled import forget_stale

PACKAGE = Path(trackroller.__file__).parent
TREES = {path: ast.parse(path.read_text(encoding="utf-8")) for path in PACKAGE.rglob("*.py")}
FAST = {"fast", "inner", "fast_formula"}
SHARED = {"hypot", "pow"}  # numba compiles each once in a process


def functions():
    """Return the compiled functions with FAST arithmetic, with their files."""
    return [
        (path, node)
        for path, tree in TREES.items()
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef) and FAST & {getattr(d, "id", "") for d in node.decorator_list}
    ]


def test_one_module_chooses_the_options_of_the_compiler():
    compilers = {"njit", "jit", "vectorize", "guvectorize", "register_jitable", "overload"}

    def compiles(node: ast.AST) -> bool:
        if isinstance(node, ast.ImportFrom):
            return "numba" in str(node.module) and not compilers.isdisjoint(name.name for name in node.names)
        return isinstance(node, ast.Attribute) and node.attr in compilers and "numba" in ast.unparse(node.value)

    assert {path.name for path, tree in TREES.items() if any(map(compiles, ast.walk(tree)))} == {"compiled.py"}


def test_fast_arithmetic_uses_no_function_that_numba_shares_among_callers():
    found = functions()
    assert len(found) > 20
    for path, function in found:
        for node in ast.walk(function):
            power = isinstance(node, (ast.BinOp, ast.AugAssign)) and isinstance(node.op, ast.Pow)
            shared = isinstance(node, ast.Attribute) and node.attr in SHARED
            assert not power and not shared, f"{path.name}:{node.lineno} in {function.name}"


@pytest.mark.parametrize(("edited", "left"), [("kernel.py", 0), ("words.py", 2), (None, 2)])
def test_callers_of_a_changed_function_are_compiled_again(tmp_path, edited, left):
    """numba itself would keep the callers that stand in other files."""
    (tmp_path / "room" / "__pycache__").mkdir(parents=True)
    (tmp_path / "room" / "kernel.py").write_text("from trackroller.numerics.compiled import fast\n")
    (tmp_path / "room" / "words.py").write_text("WORD = 'a'\n")
    for name in ("kernel.py", "words.py", "__pycache__/caller.f-1.py311.nbi", "__pycache__/caller.f-1.py311.1.nbc"):
        place = tmp_path / "room" / name
        place.touch()
        os.utime(place, (1e9, 1e9 + 10.0 * name.startswith("__") + 20.0 * (name == edited)))
    forget_stale(tmp_path)
    assert len(list(tmp_path.rglob("*.nb[ic]"))) == left


def test_a_switched_off_compiler_is_refused_in_one_line(tmp_path):
    """The kernels read records by attribute, which plain NumPy does not: the first stress would end in a traceback."""
    off = os.environ | {"NUMBA_DISABLE_JIT": "1"}
    command = [sys.executable, "-m", "trackroller.cli", "solve"]
    ended = subprocess.run(command, env=off, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert ended.returncode == 2 and len(ended.stderr.splitlines()) == 1
    assert "NUMBA_DISABLE_JIT = '1'" in ended.stderr and "unset NUMBA_DISABLE_JIT" in ended.stderr
