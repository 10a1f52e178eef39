"""A result depends on the files of the rooms in which it is made, and on nothing else."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import test_resume

from trackroller.study.store import program_digest

HERE = Path(__file__).parents[1]
ROOT = program_digest.PACKAGE.parent


def names(room: str) -> set[str]:
    return {path.relative_to(program_digest.PACKAGE).as_posix() for path in program_digest.room_files(room)}


def test_the_solver_depends_on_its_rooms_and_their_data():
    found = names(program_digest.SOLVER)
    wanted = """roller/geometry.py roller/case.py roller/solver.py parameters/__init__.py parameters/options.py
    roller/expected_errors.json contact/table/kalker_table.npz contact/kalker_linear.csv damage/fatigue.py errors.py
    contact/profiles.py numerics/quadrature.py materials/materials.yaml"""
    assert set(wanted.split()) <= found
    assert not any(name.startswith(("study/", "report/", "cli/", "results/", "methods/")) for name in found)
    assert "report/templates/report.html.j2" in names("report") and found < names("report")


def test_every_shipped_file_belongs_to_a_room():
    """The digest would leave out a file of another kind, or of another room."""
    shipped = {
        path.relative_to(program_digest.PACKAGE).as_posix()
        for path in program_digest.PACKAGE.rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    assert shipped - {"py.typed", "__init__.py"} == names(program_digest.ROOMS[-1])


def test_digest_file_keeps_its_date(tmp_path):
    path = Path(program_digest.digest_file(tmp_path / "code", "roller"))
    os.utime(path, (1, 1))
    assert program_digest.digest_file(tmp_path / "code", "roller") == str(path)
    assert path.stat().st_mtime == 1
    path.write_text("another\n")
    program_digest.digest_file(tmp_path / "code", "roller")
    assert path.read_text().strip() == program_digest.code_digest("roller")


GEOMETRY = Path("roller") / "geometry.py"
CHANGES = {
    "constant": (
        GEOMETRY,
        "1.0 / np.asarray(roller_profile_radius)",
        "1.001 / np.asarray(roller_profile_radius)",
        True,
    ),
    "data": (Path("roller") / "expected_errors.json", '"standard"', '"standards"', True),
    "ends of lines": (GEOMETRY, "\n", "\r\n", False),
    "another room": (Path("study") / "status.py", "import numpy as np", "import numpy", False),
}


def edit(package: Path, change: str) -> None:
    """Make one of `CHANGES` in a copy of the package."""
    path, old, new, _ = CHANGES[change]
    before = (package / path).read_text(encoding="utf-8")
    assert old in before
    (package / path).write_text(before.replace(old, new), encoding="utf-8", newline="")


@pytest.fixture
def copied(tmp_path):
    """Copy the package and return the folder of the copy."""
    return shutil.copytree(
        program_digest.PACKAGE, tmp_path / "trackroller", ignore=shutil.ignore_patterns("__pycache__")
    )


@pytest.mark.parametrize("change", CHANGES)
def test_only_a_change_in_a_room_changes_its_digest(copied, change, monkeypatch):
    before = program_digest.code_digest(program_digest.SOLVER)
    monkeypatch.setattr(program_digest, "PACKAGE", copied)
    assert program_digest.code_digest(program_digest.SOLVER) == before, "the place of a package does not count"
    (copied / "roller" / "__pycache__").mkdir()
    (copied / "roller" / "__pycache__" / "geometry.pyc").touch()
    (copied / "roller" / "geometry.py~").touch()
    (copied / "roller" / ".geometry.py").touch()
    assert program_digest.code_digest(program_digest.SOLVER) == before, "what Python or an editor leaves does not count"
    edit(copied, change)
    assert (program_digest.code_digest(program_digest.SOLVER) != before) == CHANGES[change][3]


@pytest.mark.long
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

    edit(copied, "ends of lines")
    edit(copied, "another room")
    assert run() == (0, False)
    edit(copied, "constant")
    assert run() == (60, True)
