"""Names of modules, functions and files in comments, docstrings and pages lead to something that is there."""

from __future__ import annotations

import ast
import re
import subprocess
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
ENDS = (".py", ".md", ".smk", ".yaml", ".yml", ".toml", ".sh", "Snakefile", "Makefile", "Dockerfile", "run")
_DOTTED = re.compile(r"(?<![\w./-])(?:trackroller|validation)(?:\.[A-Za-z_]\w*)+")
_PATHS = re.compile(
    r"(?<![\w./*{}-])(?:trackroller|validation|tests|docs|workflow|config|web)/[\w/.-]*\w\.(?:py|md|smk|js)\b"
)
ELSEWHERE = ("CHANGELOG.md",)  # speaks of earlier versions
MADE_UP = re.compile(r"trackroller\.(?:py|mplstyle|__file__)\b|NAME|damage/lining|config/limits/")


def texts() -> list[Path]:
    """Return the tracked files that hold text of the project."""
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    return [ROOT / name for name in listed.splitlines() if name.endswith(ENDS) and name not in ELSEWHERE]


@cache
def names_of(path: Path) -> dict[str, set[str]]:
    """Return the names that a module defines or imports, and below each class those of the class."""
    found: dict[str, set[str]] = {"": set()}

    def collect(body: list[ast.stmt], within: str) -> None:
        for node in body:
            if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
                found.setdefault(within, set()).add(node.name)
                if isinstance(node, ast.ClassDef):
                    found.setdefault(node.name, set())
                    collect(node.body, node.name)
            elif isinstance(node, (ast.Import, ast.ImportFrom)):
                found.setdefault(within, set()).update((a.asname or a.name).split(".")[0] for a in node.names)
            else:
                targets = [t for t in ast.walk(node) if isinstance(t, ast.Name) and isinstance(t.ctx, ast.Store)]
                found.setdefault(within, set()).update(t.id for t in targets)
                for inner in ("body", "orelse"):
                    collect(getattr(node, inner, []) if isinstance(node, (ast.If, ast.Try, ast.With)) else [], within)

    collect(ast.parse(path.read_text(encoding="utf-8")).body, "")
    return found


def leads_somewhere(name: str) -> bool:
    """Return whether a dotted name is a folder, a module, or something that a module defines."""
    parts = name.split(".")
    for count in range(len(parts), 0, -1):
        place, rest = ROOT.joinpath(*parts[:count]), parts[count:]
        module = place.with_suffix(".py") if place.with_suffix(".py").is_file() else place / "__init__.py"
        if not module.is_file():
            if place.is_dir():
                return not rest
            continue
        if not rest:
            return True
        known, (first, *inner) = names_of(module), rest
        public = name.startswith("trackroller.") and count == 1 and f'"{first}"' in module.read_text(encoding="utf-8")
        return (first in known[""] or public) and (not inner or first not in known or inner[0] in known[first])
    return False


@pytest.mark.parametrize("path", texts(), ids=lambda path: path.relative_to(ROOT).as_posix())
def test_names_lead_to_code_and_files_that_are_there(path):
    text = path.read_text(encoding="utf-8")
    names = set() if "page.run(" in text or "evaluate(" in text else set(_DOTTED.findall(text))  # of a page's script
    dead = [name for name in sorted(names) if not MADE_UP.search(name) and not leads_somewhere(name)]
    places = (ROOT, ROOT / "docs")  # a page names others from the folder of the site
    files = sorted(set(_PATHS.findall(text)))
    dead += [p for p in files if not MADE_UP.search(p) and not any((place / p).exists() for place in places)]
    assert not dead


def test_a_dead_name_is_found():
    assert not leads_somewhere("validation.benchmarks.force_errors")
    assert not leads_somewhere("trackroller.roller.solver.no_such_function")
    assert leads_somewhere("trackroller.roller.solver.solve") and leads_somewhere("trackroller.solve")
