"""Edited inputs stop a run, a grown sample keeps its history, and reports at once do not collide."""

from __future__ import annotations

import contextlib
import multiprocessing
import shutil
from pathlib import Path

import fake_solver
import numpy as np
import pytest
import xarray as xr

from trackroller.errors import InputError, WorkError
from trackroller.report.build import build_report
from trackroller.results.stored_study import open_as_reported
from trackroller.study.file.load import load_study
from trackroller.study.run import run_study
from trackroller.study.store import chunks, manifest
from trackroller.study.store.crate import damaged_files, read_crate, write_crate
from trackroller.study.store.fingerprint import StudyCases, chunk_name
from trackroller.study.store.folder import StudyFolder
from trackroller.study.store.ledger import Ledger
from trackroller.study.store.manifest import why_altered
from trackroller.study.store.netcdf import read_result
from trackroller.study.store.put import put_text, replacing

MATERIALS = "materials:\n  own steel: {like: 42CrMo4, tensile_strength: {value: 1500, unit: MPa, source: sheet}}\n"
TABLE = "axial_force,friction_coefficient\n" + "".join(f"{20 + i},0.1\n" for i in range(12))
POINTS = "x,z\n" + "".join(f"{x},{x * x / 13}\n" for x in np.linspace(-4, 4, 41))
STUDY = """
name: sealed
method: table
table: cases.csv
outputs: [forces]
contact_model: sliding
chunk_size: 4
base: {guide_profile: {file: points.csv}}
normal: halfspace
"""


@pytest.fixture
def home(tmp_path, monkeypatch):
    """Return a folder with a study, its table of cases, a measured profile and materials, where the test works."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "config").mkdir()
    materials = MATERIALS.replace("42CrMo4", "1.7225-quenched-tempered")
    for name, text in {
        "study.yaml": STUDY,
        "cases.csv": TABLE,
        "points.csv": POINTS,
        "config/materials.yaml": materials,
    }.items():
        (tmp_path / name).write_text(text)
    return tmp_path


@pytest.mark.parametrize("name", ["study.yaml", "cases.csv", "points.csv", "config/materials.yaml"])
def test_an_input_that_is_edited_during_a_run_stops_it_before_the_next_chunk(home, solved, name):
    victim, used = home / name, (home / name).read_bytes()

    def solver(design, database=None, **options):
        edited = used.replace(b"20,0.1", b"21,0.1").replace(b"chunk_size: 4", b"chunk_size: 5")
        victim.write_bytes(edited + b"\n# edited\n" * (name in ("points.csv", "config/materials.yaml")))
        return fake_solver.solve(design)

    with pytest.raises(WorkError, match=rf"{victim.name} was edited.*SHA-256 was [0-9a-f]{{64}} and is [0-9a-f]{{64}}"):
        run_study(load_study("study.yaml"), solver=solver)
    assert sum(solved().values()) == 4, "the chunk that was begun"
    stored = [path.read_bytes() for path in Path("results/sealed/inputs").rglob("*") if path.is_file()]
    assert used in stored and victim.read_bytes() not in stored, "the bytes that were used"
    victim.write_bytes(used)
    run_study(load_study("study.yaml"), solver=fake_solver.solve)
    assert sum(solved().values()) == 12 and set(solved().values()) == {1}


def test_a_comment_in_the_study_file_may_be_edited_during_a_run(home, solved):
    def solver(design, database=None, **options):
        (home / "study.yaml").write_text("# a thought\n" + STUDY)
        return fake_solver.solve(design)

    run_study(load_study("study.yaml"), solver=solver)
    assert sum(solved().values()) == 12


@pytest.mark.parametrize("name", ["study.yaml", "cases.csv", "config/materials.yaml"])
def test_an_input_that_is_edited_between_load_and_plan_is_refused(home, name):
    study = load_study("study.yaml")
    (home / name).write_text((home / name).read_text() + "\n")
    with pytest.raises(WorkError, match="was edited"):
        run_study(study, solver=fake_solver.solve)


GROWN = """
name: grown
method: sobol
samples: {samples}
outputs: [forces]
contact_model: sliding
chunk_size: 5
factors: {{axial_force: {{uniform: [20, 50]}}, friction_coefficient: {{uniform: [0.1, 0.3]}}}}
"""


def _grow(samples: int) -> xr.Dataset:
    Path("grown.yaml").write_text(GROWN.format(samples=samples))
    return xr.load_dataset(run_study(load_study("grown.yaml"), solver=fake_solver.solve).folder.gathered)


@pytest.fixture(scope="module")
def grown(tmp_path_factory):
    """Return a folder with a sample that grew from 7 to 13 cases, for tests to copy."""
    with contextlib.chdir(tmp_path_factory.mktemp("grown")):
        _grow(7)
        _grow(13)
        return Path.cwd()


@pytest.mark.parametrize("victim", ["inputs/study.yaml", "study.nc", "design.nc"])
@pytest.mark.parametrize("altered", [True, False])
def test_a_grown_sample_keeps_its_cases_when_a_file_of_the_study_is_altered_or_lost(
    tmp_path, monkeypatch, solved, grown, victim, altered
):
    monkeypatch.chdir(shutil.copytree(grown, tmp_path, dirs_exist_ok=True))
    before = xr.load_dataset("results/grown/study.nc")
    path = Path("results/grown") / victim
    if altered:
        path.write_bytes(path.read_bytes()[:-9])
        with pytest.raises(InputError, match=rf"{victim}' was altered.*Move or remove it, then start again"):
            _grow(13)
    path.unlink()
    again = _grow(13)
    np.testing.assert_array_equal(again["axial_force"], before["axial_force"])
    assert _grow(20)["axial_force"].values[:13].tolist() == before["axial_force"].values.tolist()
    assert set(solved().values()) == {1} and sum(solved().values()) == 7, "the 13 cases of before are kept"


def test_solved_cases_that_are_copied_into_another_folder_count_there(tmp_path, monkeypatch, solved, grown):
    """What a damaged `plan.json` leaves to do: the folder is moved away, and its chunks go into a new one."""
    monkeypatch.chdir(shutil.copytree(grown, tmp_path, dirs_exist_ok=True))
    root = Path("results/grown")
    before = (root / "study.nc").read_bytes()
    (root / "plan.json").write_text((root / "plan.json").read_text()[:-9])
    with pytest.raises(InputError, match=r"its plan\.json is damaged.*move the folder away"):
        _grow(13)
    root.rename("results/old")
    shutil.copytree("results/old/chunks", StudyFolder(root).create().root / "chunks", dirs_exist_ok=True)
    _grow(13)
    assert sum(solved().values()) == 0 and (root / "study.nc").read_bytes() == before


def _draw(results, out_dir: Path) -> list[str]:
    for number in range(9):
        (out_dir / f"{number}.svg").write_text("<svg/>")
    return ["one"]


@pytest.mark.parametrize("name", ["sensitivity.nc", "report.html", "figures"])
def test_a_part_of_the_report_may_be_deleted_but_not_altered(tmp_path, monkeypatch, name):
    monkeypatch.setattr("trackroller.report.figures.study.draw_all", _draw)
    monkeypatch.chdir(tmp_path)
    _grow(7)
    folder = StudyFolder(Path("results/grown"))
    build_report(folder)
    part = folder.root / name
    file = part / "0.svg" if part.is_dir() else part
    kept = file.read_bytes()
    file.write_bytes(kept + b" ")
    with pytest.raises(WorkError, match=file.name):
        write_crate(folder.root)
    shutil.rmtree(part) if part.is_dir() else part.unlink()
    write_crate(folder.root)
    listed = read_crate(folder.root)
    assert "study.nc" in listed and not any(entry.startswith(name) for entry in listed)
    assert damaged_files(folder.root) == {}
    build_report(folder)
    assert file.is_file() and damaged_files(folder.root) == {}


@pytest.mark.slow
def test_results_written_just_before_an_interrupt_do_not_look_altered(tmp_path, monkeypatch):
    monkeypatch.setattr("trackroller.report.figures.study.draw_all", _draw)
    monkeypatch.chdir(tmp_path)
    _grow(7)
    folder = StudyFolder(Path("results/grown"))
    build_report(folder)
    with pytest.raises(KeyboardInterrupt), replacing(folder.gathered) as beside:
        data = xr.load_dataset(folder.gathered)
        data.assign_attrs(date="later").to_netcdf(beside)
        raise KeyboardInterrupt
    build_report(folder)
    assert damaged_files(folder.root) == {}


@pytest.mark.slow
def test_three_reports_at_once_lose_nothing(tmp_path, monkeypatch):
    monkeypatch.setattr("trackroller.report.figures.study.draw_all", _draw)
    monkeypatch.chdir(tmp_path)
    _grow(7)
    folder = StudyFolder(Path("results/grown"))
    context = multiprocessing.get_context("fork")
    runs = [context.Process(target=build_report, args=(folder,)) for _ in range(3)]
    for process in runs:
        process.start()
    for process in runs:
        process.join(120)
    assert [process.exitcode for process in runs] == [0, 0, 0]
    assert len(list((folder.root / "figures").iterdir())) == 9
    assert damaged_files(folder.root) == {} and "figures/8.svg" in read_crate(folder.root)


def test_a_ledger_passes_over_a_file_that_another_process_has_just_replaced(tmp_path, monkeypatch):
    folder = StudyFolder(tmp_path).create()
    kept, gone = (np.array([letter * 32]) for letter in (b"a", b"b"))
    for cases in (kept, gone):
        chunks.write(folder.chunk(chunk_name(cases)), chunks.failure(cases, "reason").assign_attrs(seconds=1.0))
    listed = folder.solved_files()
    monkeypatch.setattr(StudyFolder, "solved_files", lambda self: listed)
    folder.chunk(chunk_name(gone)).unlink()
    found = Ledger(StudyCases(load_study({"name": "one", "factors": {"axial_force": {"values": [0]}}})), folder)
    assert found.states["case"].values.tolist() == kept.tolist() and not found.corrupt


def test_a_crate_without_the_plan_still_notices_an_altered_result(tmp_path, monkeypatch):
    monkeypatch.setattr("trackroller.report.figures.study.draw_all", _draw)
    monkeypatch.chdir(tmp_path)
    _grow(7)
    build_report(StudyFolder(Path("results/grown")))
    shutil.copytree("results/grown", "posted", ignore=shutil.ignore_patterns("plan", "plan.json", "chunks"))
    shutil.copy("posted/design.nc", "posted/study.nc")
    with pytest.raises(WorkError, match=r"study\.nc was altered.*ro-crate-metadata"):
        read_result("posted/study.nc")


@pytest.mark.slow
def test_a_report_of_earlier_results_leaves_the_crate_and_stays_in_the_folder(tmp_path, monkeypatch):
    monkeypatch.setattr("trackroller.report.figures.study.draw_all", _draw)
    monkeypatch.chdir(tmp_path)
    _grow(7)
    folder = StudyFolder(Path("results/grown"))
    build_report(folder)
    sealed = folder.gathered.read_bytes()
    _grow(7)
    assert folder.gathered.read_bytes() == sealed, "equal results are equal files"
    write_crate(folder.root)
    assert "report.html" in read_crate(folder.root)
    assert open_as_reported(folder.root).analysis is not None
    _grow(13)
    write_crate(folder.root)
    assert {"study.nc"} == {name for name in read_crate(folder.root) if not name.startswith(("inputs", "design"))}
    assert (folder.root / "report.html").is_file() and not manifest.digests_of(folder.root / "report.html")
    assert open_as_reported(folder.root).analysis is None
    build_report(folder)
    assert "report.html" in read_crate(folder.root) and damaged_files(folder.root) == {}


def test_a_result_that_is_written_while_it_is_checked_does_not_look_altered(tmp_path, monkeypatch):
    folder = StudyFolder(tmp_path / "s").create()
    put_text(folder.gathered, "old")
    read = manifest.digest_of_file

    def slow(path):
        if not written:  # another process replaces the file after the manifest was read
            written.append(folder.gathered)
            put_text(folder.gathered, "new")
        return read(path)

    written: list[Path] = []
    monkeypatch.setattr(manifest, "digest_of_file", slow)
    assert why_altered(folder.gathered) is None and written
