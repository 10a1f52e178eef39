"""A study that is edited, or started again, while it runs: no case is solved twice and no file disappears."""

from __future__ import annotations

import multiprocessing
import os
import subprocess
import sys
import time
from pathlib import Path

import fake_solver
import pytest
import xarray as xr
import yaml

from trackroller.errors import WorkError
from trackroller.study.file.load import load_study, parse_study
from trackroller.study.run import run_study
from trackroller.study.solve_chunk import solve_chunk
from trackroller.study.store.ledger import working_ledger

LOADS = [float(v) for v in range(20, 40)]
DATA = {
    "name": "s",
    "outputs": ["forces"],
    "contact_model": "sliding",
    "chunk_size": 10,
    "factors": {"axial_force": {"values": LOADS}, "friction_coefficient": {"values": [0.1, 0.2]}},
}
EDITED = DATA | {"factors": DATA["factors"] | {"axial_force": {"values": [*LOADS, 50.0]}}}


def snapshot(folder: Path) -> dict[Path, int]:
    """Return the files that a worker may need, with their inodes."""
    return {path: path.stat().st_ino for place in ("plan", "chunks") for path in (folder / place).glob("*.n*")}


@pytest.mark.slow
def test_edited_study_is_refused_while_the_first_runs_and_solves_only_new_cases_afterwards(tmp_path, solved):
    refused: list[bool] = []
    path = tmp_path / "s.yaml"
    path.write_text(yaml.safe_dump(DATA))

    def solver(design, database=None, **options):
        if not refused:  # in the midst of the first run, the user edits the study and starts it again
            path.write_text(yaml.safe_dump(EDITED))
            files = snapshot(tmp_path / "s")
            with pytest.raises(WorkError, match=r"another process.*another version.*Wait.*start again"):
                run_study(load_study(path), tmp_path, solver=fake_solver.solve)
            assert snapshot(tmp_path / "s") == files, "the second run changes no file"
            refused.append(True)
        return fake_solver.solve(design)

    with pytest.raises(
        WorkError, match=r"s\.yaml was edited .*SHA-256 was [0-9a-f]{64} and is [0-9a-f]{64}.*Start again"
    ):
        run_study(load_study(path), tmp_path, solver=solver)
    assert refused and set(solved().values()) == {1} and sum(solved().values()) == 10, "the chunk that was begun"
    plan = run_study(load_study(path), tmp_path, solver=fake_solver.solve)
    assert set(solved().values()) == {1} and sum(solved().values()) == 42
    assert xr.load_dataset(plan.folder.gathered).sizes["axial_force"] == 21


@pytest.mark.slow
def test_failed_cases_are_not_removed_under_a_run(tmp_path, solved):
    refused = []

    def solver(design, database=None, **options):
        with pytest.raises(WorkError, match="another process"):
            run_study(parse_study(DATA), tmp_path, solver=fake_solver.solve, rerun_failed=True)
        refused.append(True)
        return fake_solver.solve(design)

    run_study(parse_study(DATA), tmp_path, solver=solver)
    assert refused and set(solved().values()) == {1}


def test_chunk_whose_plan_is_gone_ends_with_a_sentence(tmp_path):
    with working_ledger(parse_study(DATA), tmp_path) as plan:
        pass
    first = next(iter(plan.chunks))
    plan.folder.case_list(first).unlink()
    with pytest.raises(WorkError, match=rf"{first}.*planned anew.*Start again"):
        solve_chunk(plan.folder, first)


def _slow(design, database=None, **options):
    time.sleep(0.05)
    return fake_solver.solve(design)


def _run(results: str) -> None:
    run_study(parse_study(DATA), results, solver=_slow)


@pytest.mark.slow
def test_two_runs_of_one_study_at_once_solve_each_case_once(tmp_path, solved):
    context = multiprocessing.get_context("fork")
    runs = [context.Process(target=_run, args=(str(tmp_path),)) for _ in range(3)]
    for process in runs:
        process.start()
    for process in runs:
        process.join(60)
    assert [process.exitcode for process in runs] == [0, 0, 0]
    assert set(solved().values()) == {1} and sum(solved().values()) == 40


@pytest.mark.slow
def test_command_line_refuses_the_edited_study_in_one_line(tmp_path):
    """A process holds the plan of one version; the command for another version exits with 1 and changes nothing."""
    path = tmp_path / "s.yaml"
    path.write_text(yaml.safe_dump(EDITED))
    words = [sys.executable, "-c", "from trackroller.cli.main import main; main()", "run", str(path), "-q"]
    told = []

    def solver(design, database=None, **options):
        if not told:
            done = subprocess.run(
                [*words, "--results", str(tmp_path)], capture_output=True, text=True, timeout=120, env=os.environ.copy()
            )
            told.append((done.returncode, done.stderr))
        return fake_solver.solve(design)

    run_study(parse_study(DATA), tmp_path, solver=solver)
    code, line = told[0]
    assert code == 1 and "another process" in line and "Traceback" not in line
