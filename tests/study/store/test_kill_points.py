"""A run that is killed before any flush, rename or removal of a file ends, started again, with the same results.

A flush follows each line of the manifest and each file, so that a process is killed before a digest is written down,
between the digest and its file, and after the file.
"""

from __future__ import annotations

import functools
import os
import re
import shutil
import signal
from collections.abc import Callable
from pathlib import Path

import fake_solver
import pytest
import xarray as xr

from trackroller.report.build import build_report
from trackroller.results.results import Results
from trackroller.study.file.load import parse_study
from trackroller.study.run import run_study
from trackroller.study.store.crate import damaged_files, read_crate
from trackroller.study.store.ledger import study_folder

SMALL = {
    "name": "s",
    "outputs": ["forces"],
    "contact_model": "sliding",
    "chunk_size": 4,
    "method": "lhs",
    "samples": 4,
    "factors": {"axial_force": {"uniform": [20, 50]}, "friction_coefficient": {"values": [0.1, 0.2]}},
}
GROWN = SMALL | {"samples": 12}


def run(data, results, **more):
    run_study(parse_study(data), results, solver=fake_solver.solve, **more)


def run_and_report(data, results: Path) -> None:
    """Do what `trackroller run STUDY --report` does."""
    run(data, results)
    build_report(study_folder(data["name"], results))


def kill_at(point: int, action: Callable[[], None]) -> bool:
    """Act in a forked process, which kills itself before the flush, rename or removal number `point`; was it killed?"""
    child = os.fork()
    if child == 0:
        calls = iter(range(10_000))

        def counted(action):
            def act(*words, **named):
                if next(calls) == point:
                    os.kill(os.getpid(), signal.SIGKILL)
                return action(*words, **named)

            return act

        try:
            for name in ("fsync", "replace", "rename", "unlink", "rmdir"):
                setattr(os, name, counted(getattr(os, name)))
            action()
        finally:
            os._exit(0)
    return os.WIFSIGNALED(os.waitpid(child, 0)[1])


def same(one: Path, other: Path) -> None:
    """Check that variables, coordinates and attributes agree, and then every byte."""
    xr.testing.assert_identical(*map(xr.load_dataset, (one, other)))
    assert one.read_bytes() == other.read_bytes()


@pytest.mark.long
def test_killed_before_each_flush_rename_or_removal_and_started_again(tmp_path, solved):
    data = GROWN | {"samples": 8}
    run(data, tmp_path / "calm")
    before = solved()
    point = 0
    while kill_at(point, functools.partial(run, data, tmp_path / f"{point}")):
        killed = tmp_path / f"{point}"
        run(data, killed)
        for name in ("design.nc", "study.nc"):
            same(killed / "s" / name, tmp_path / "calm" / "s" / name)
        twice = sum(n - 1 for n in (solved() - before).values())
        assert twice <= 4, f"only the chunk in work is lost, at kill point {point}"
        assert not list(killed.rglob("*.tmp"))
        before = solved()
        point += 1
    assert point >= 40, "lists, plan, inputs, chunks, design, study and their checksums"


@pytest.mark.long
def test_growing_study_with_failed_cases_killed_before_each_flush_rename_or_removal(tmp_path, solved):
    def failing(design, database=None, **options):
        ds = fake_solver.solve(design)
        return ds.assign(regime=ds["regime"].copy(data=(design["axial_force"] > 35).astype("i1") * 3))

    small = SMALL | {"method": "sobol"}
    grown = small | {"samples": 8}
    run_study(parse_study(small), tmp_path / "start", solver=failing)
    failed = int((xr.load_dataset(tmp_path / "start" / "s" / "study.nc")["regime"] == 3).sum())
    assert 0 < failed < 4
    shutil.copytree(tmp_path / "start", tmp_path / "calm")
    run(grown, tmp_path / "calm", rerun_failed=True)
    assert not (xr.load_dataset(tmp_path / "calm" / "s" / "study.nc")["regime"] == 3).any()
    point = 0
    while True:
        place = tmp_path / f"{point}"
        shutil.copytree(tmp_path / "start", place)
        before = solved()
        killed = kill_at(point, functools.partial(run, grown, place, rerun_failed=True))
        run(grown, place, rerun_failed=True)
        same(place / "s" / "study.nc", tmp_path / "calm" / "s" / "study.nc")
        again = solved() - before
        assert sum(n - 1 for n in again.values()) <= 4, f"only the chunk in work is lost, at kill point {point}"
        assert len(again) == 4 + failed, "4 new cases and those that failed"
        if not killed:
            break
        point += 1
    assert point >= 50


def _draw(results: Results, out_dir: Path) -> None:
    """Write two files in place of figures, which would take seconds."""
    for name in ("one.svg", "two.svg"):
        (out_dir / name).write_text(f"<svg>{len(results.table)}</svg>")


@pytest.mark.long
def test_report_killed_before_each_flush_rename_or_removal(tmp_path, monkeypatch):
    """The study has grown, so that every file of its report and its crate is replaced; each run is killed later."""
    monkeypatch.setattr("trackroller.report.figures.study.draw_all", _draw)
    run_and_report(SMALL, tmp_path / "start")
    run(GROWN, tmp_path / "start")
    for place in ("calm", "rough"):
        shutil.copytree(tmp_path / "start", tmp_path / place)
    run_and_report(GROWN, tmp_path / "calm")
    calm, rough = tmp_path / "calm" / "s", tmp_path / "rough" / "s"
    point = 0
    while kill_at(point, functools.partial(run_and_report, GROWN, tmp_path / "rough")):
        same(rough / "study.nc", calm / "study.nc")
        point += 1
    assert point >= 30, "analysis, figures, report, tables, inputs and metadata"
    assert damaged_files(rough) == {} and set(read_crate(rough)) == set(read_crate(calm))
    same(rough / "sensitivity.nc", calm / "sensitivity.nc")
    for name in ("figures/one.svg", "inputs/study.yaml", "tables/tables.xlsx"):
        assert (rough / name).read_bytes() == (calm / name).read_bytes(), name
    pages = [re.sub(r"\dT\d\d:\d\d:\d\d", "", (place / "report.html").read_text()) for place in (rough, calm)]
    assert pages[0] == pages[1]
    assert not list(rough.rglob(".*.tmp"))
