"""What a result depends on is read from the import graph, and only a change of code changes the digest."""

from __future__ import annotations

import ast
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import test_resume

from trackroller.study.store import sources

HERE = Path(__file__).parents[1]
ROOT = sources.PACKAGE.parent
FILES = sorted(sources.PACKAGE.rglob("*.py")) + sorted((ROOT / "validation").rglob("*.py"))
DOCUMENTED = ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef


def tree(text: str, drop_docstrings: bool) -> str:
    """Return the syntax tree as text, with raw and plain line breaks within strings made equal."""
    parsed = ast.parse(text)
    for node in ast.walk(parsed):
        has_docstring = isinstance(node, DOCUMENTED) and ast.get_docstring(node)
        if has_docstring and drop_docstrings:
            node.body[0] = ast.Expr(ast.Constant(...))
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            node.value = node.value.replace("\n", "\\n")
    return ast.dump(parsed)


def imports(path: Path) -> set[str]:
    """Return the absolute names that a module may import when it runs, by its syntax tree."""
    found: set[str] = set()
    pending: list[ast.AST] = [ast.parse(path.read_text(encoding="utf-8"))]
    while pending:
        node = pending.pop()
        if isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING":
            continue
        pending += ast.iter_child_nodes(node)
        if isinstance(node, ast.Import):
            found |= {name.name for name in node.names}
        if isinstance(node, ast.ImportFrom):
            found |= {str(node.module)} | {f"{node.module}.{name.name}" for name in node.names}
    return found


def test_quick_reading_agrees_with_the_syntax_tree():
    assert len(FILES) > 100
    for path in FILES:
        text, told = path.read_text(encoding="utf-8"), path.relative_to(ROOT)
        assert tree(sources._split(text, "...")[0], False) == tree(text, True), told
        read, strings = set(sources._names(path, "package.module")), set(sources._read(path)[1])
        imported = imports(path)
        assert imported <= read, told
        assert read - imported <= strings, told


def test_solver_depends_on_late_imports_and_data():
    names = {path.relative_to(sources.PACKAGE).as_posix() for path in sources.source_files(sources.SOLVER)}
    wanted = """roller/geometry.py roller/case.py roller/options.py roller/requirements.py roller/stop.py
    parameters/__init__.py parameters/numbers.py parameters/options.py
    roller/expected_errors.json contact/table/kalker_table.npz contact/kalker_linear.csv
    contact/profiles.py contact/drawn_profiles.py damage/fatigue.py numerics/quadrature.py"""
    assert set(wanted.split()) <= names
    assert not any(name.startswith(("study/", "report/", "cli/", "analysis/")) for name in names)
    assert "materials/materials.yaml" in names  # its values stand in the fingerprint instead
    assert "report/templates/report.html.j2" in {
        p.relative_to(sources.PACKAGE).as_posix() for p in sources.source_files("trackroller.report.pages.study")
    }


def test_every_shipped_data_file_belongs_to_a_module():
    """The digest would leave out a data file that no module names."""
    found = {path for path in sources.source_files(["trackroller.cli.main", "trackroller.report.pages.study"])}
    shipped = {path for paths in sources._data_files(sources.PACKAGE).values() for path in paths}
    assert {path for path in shipped if path.name != "py.typed"} <= found


def test_unknown_module_is_refused():
    with pytest.raises(ModuleNotFoundError, match=re.escape("trackroller.roler")):
        sources.source_files("trackroller.roler")


def test_digest_file_keeps_its_date(tmp_path):
    path = Path(sources.digest_file(tmp_path / "code", "trackroller.roller.geometry"))
    os.utime(path, (1, 1))
    assert sources.digest_file(tmp_path / "code", "trackroller.roller.geometry") == str(path)
    assert path.stat().st_mtime == 1
    path.write_text("another\n")
    sources.digest_file(tmp_path / "code", "trackroller.roller.geometry")
    assert path.read_text().strip() == sources.code_digest("trackroller.roller.geometry")


GEOMETRY = Path("roller") / "geometry.py"
CHANGES = {
    "constant": (
        GEOMETRY,
        "1.0 / np.asarray(roller_profile_radius)",
        "1.001 / np.asarray(roller_profile_radius)",
        True,
    ),
    "data": (Path("roller") / "expected_errors.json", '"standard"', '"standards"', True),
    "docstring": (GEOMETRY, '"""', '"""Other words. ', False),
    "comment": (GEOMETRY, "    return np.asarray(", "    # why\n\n    return np.asarray(", False),
    "another room": (Path("study") / "status.py", "import numpy as np", "import numpy", False),
}


def edit(package: Path, change: str) -> None:
    """Make one of `CHANGES` in a copy of the package."""
    path, old, new, _ = CHANGES[change]
    before = (package / path).read_text(encoding="utf-8")
    assert old in before
    (package / path).write_text(before.replace(old, new, 1), encoding="utf-8")


@pytest.fixture
def copied(tmp_path):
    """Copy the package and return the folder of the copy."""
    return shutil.copytree(sources.PACKAGE, tmp_path / "trackroller", ignore=shutil.ignore_patterns("__pycache__"))


@pytest.mark.parametrize("change", CHANGES)
def test_only_a_change_of_code_or_data_changes_the_digest(copied, change, monkeypatch):
    monkeypatch.setattr(sources, "PACKAGE", copied)

    def digest():
        for cached in (sources._closure, sources._file_of, sources._data_files, sources._read):
            cached.cache_clear()
        return sources.code_digest(sources.SOLVER, sources.BY_VALUE)

    try:
        assert digest() == sources.solver_digest(), "the place of a package does not count"
        edit(copied, change)
        assert (digest() != sources.solver_digest()) == CHANGES[change][3]
    finally:
        monkeypatch.undo()
        digest()


def test_next_run_solves_again_only_where_code_has_changed(copied, solved):
    place = copied.parent
    test_resume.run(test_resume.DATA, place / "results")
    assert sum(solved().values()) == 60
    code = (
        "import test_resume as t, trackroller\n"
        f"assert trackroller.__file__.startswith({str(place)!r})\n"
        f"print(*t.run(t.DATA, {str(place / 'results')!r})[2], sep='\\n')\n"
    )

    def run() -> tuple[int, bool]:
        (place / "solved.txt").write_text("")
        env = os.environ | {"PYTHONPATH": f"{place}:{HERE}:{HERE / 'study'}"}
        done = subprocess.run([sys.executable, "-c", code], cwd=place, env=env, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return sum(solved().values()), "solver's code has changed" in done.stdout

    edit(copied, "docstring")
    edit(copied, "comment")
    assert run() == (0, False)
    edit(copied, "constant")
    assert run() == (60, True)
