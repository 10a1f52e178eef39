"""Break formulas and decisions one at a time in a copy of the tree and say which test catches each.

    python -m validation.mutations [NAME ...]

Each mutation changes a sign, a factor or an index of one formula, or a border outside formulas (`mutants.py`). The
tests beside it must then fail, those marked slow included. Prints formula, change and the test that caught it; ends
with 1 if a mutation survives.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from trackroller.study.store.program_digest import ROOMS
from validation.mutants import DECISIONS, FORMULAS

ROOT = Path(__file__).resolve().parents[1]
PARTS = ("trackroller", "tests", "validation", "workflow", "config", "docs", "pyproject.toml", "README.md", "Makefile")
HANGS = 1200  # [s]


@dataclass(frozen=True)
class Mutation:
    """A formula or a decision, the file of the package that holds it, the text before and after, and its tests."""

    what: str
    path: str
    before: str
    after: str
    tests: tuple[str, ...]


MUTATIONS = {name: Mutation(name, *entry) for name, entry in (FORMULAS | DECISIONS).items()}


def copied(place: Path) -> Path:
    """Copy what the tests need, with the compiled kernels, into a folder."""
    for name in PARTS:
        source = ROOT / name
        (shutil.copytree if source.is_dir() else shutil.copy2)(source, place / name)
    return place


def forget_kernels(place: Path, path: str) -> None:
    """Remove the compiled kernels of every room that may import a file: numba looks at a kernel's own file only."""
    first = Path(path).parts[0].removesuffix(".py")
    for room in ROOMS[ROOMS.index(first) :]:
        for kernel in (place / "trackroller" / room).glob("**/__pycache__/*.nb[ic]"):
            kernel.unlink()


def catching_test(place: Path, mutation: Mutation) -> str:
    """Return the first test that fails with a mutation, "" if none does."""
    file = place / "trackroller" / mutation.path
    text = file.read_text(encoding="utf-8")
    if text.count(mutation.before) != 1:
        raise ValueError(f"{mutation.path} holds {mutation.before!r} {text.count(mutation.before)} times, not once")
    file.write_text(text.replace(mutation.before, mutation.after), encoding="utf-8")
    forget_kernels(place, mutation.path)
    tests = [str(Path("tests") / name) for name in mutation.tests]
    words = [
        sys.executable,
        "-m",
        "pytest",
        "-q",
        "-x",
        "-m",
        "not long",
        "-p",
        "no:cacheprovider",
        *tests,
    ]
    env = os.environ | {"PYTHONPATH": str(place)}
    try:
        done = subprocess.run(words, cwd=place, env=env, capture_output=True, text=True, timeout=HANGS)
    finally:
        forget_kernels(place, mutation.path)
        file.write_text(text, encoding="utf-8")
    if done.returncode == 0:
        return ""
    failed = re.search(r"^(?:FAILED|ERROR) (\S+)", done.stdout, re.M)
    if failed is None:
        raise RuntimeError(done.stdout + done.stderr)
    return failed[1].removeprefix("tests/")


def main(names: list[str]) -> int:
    """Try mutations by name, or all of them, and return 1 if one survives."""
    survived = 0
    with tempfile.TemporaryDirectory() as folder:
        place = copied(Path(folder))
        for name in names or MUTATIONS:
            mutation = MUTATIONS[name]
            caught = catching_test(place, mutation)
            survived += not caught
            before, after = (" ".join(text.split()) for text in (mutation.before, mutation.after))
            print(f"| {mutation.what} | `{before}` → `{after}` | {caught or 'SURVIVED'} |", flush=True)
    return int(survived > 0)


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
