"""Nothing computed is lost: kills, growth, damage, full disks and failed cases, with a quick stand-in solver."""

from __future__ import annotations

import multiprocessing
import re
import shutil
import subprocess
from pathlib import Path

import fake_solver
import netCDF4
import numpy as np
import pytest
import xarray as xr
from reference_cases import solve_sliding

from trackroller.errors import InputError, WorkError
from trackroller.files import write_whole
from trackroller.study.file.load import parse_study
from trackroller.study.run import run_study
from trackroller.study.status import status_of
from trackroller.study.store import chunks
from trackroller.study.store.fingerprint import StudyCases, chunk_name
from trackroller.study.store.ledger import study_folder, working_ledger

HERE = Path(__file__).parents[1]
LOADS = [float(v) for v in range(20, 50)]
DATA = {
    "name": "s",
    "outputs": ["forces"],
    "contact_model": "sliding",
    "chunk_size": 20,
    "factors": {"axial_force": {"values": LOADS}, "friction_coefficient": {"values": [0.1, 0.2]}},
}


def changed(**factors):
    """Return the study with other or further factors."""
    return DATA | {"factors": DATA["factors"] | {k: {"values": v} for k, v in factors.items()}}


def run(data, results, **more):
    lines: list[str] = []
    plan = run_study(parse_study(data), results, solver=fake_solver.solve, tell=lines.append, **more)
    with xr.open_dataset(plan.folder.gathered) as opened:
        return plan, opened.load(), lines


def run_apart(results, kill=None):
    """Run the study in a fork of this process, which may kill itself with SIGKILL; return its exit code."""
    with pytest.MonkeyPatch.context() as patch:
        if kill:
            patch.setenv("FAKE_KILL", str(kill))
        child = multiprocessing.get_context("fork").Process(target=run, args=(DATA, results))
        child.start()
    child.join(120)
    return child.exitcode


def test_gathered_grid_has_its_factors_as_labelled_dimensions(tmp_path):
    _, ds, _ = run(changed(material_pair=[["PA6", "POM"], ["POM", "PA6"]]), tmp_path)
    assert dict(ds.sizes) == {"axial_force": 30, "friction_coefficient": 2, "material_pair": 2, "contact": 2}
    assert list(ds["material_pair"].values) == ["PA6 / POM", "POM / PA6"]
    assert list(ds["roller_material"].values) == ["PA6", "POM"]
    expected = np.sin(ds["axial_force"]) + ds["friction_coefficient"] * xr.DataArray([1.0, 2.0], dims="contact")
    xr.testing.assert_allclose(
        ds["normal_force"].drop_vars(ds.coords),
        expected.broadcast_like(ds["normal_force"])
        .transpose(*ds["normal_force"].dims)
        .drop_vars(ds.coords, errors="ignore"),
    )
    for name in ("study", "versions", "git_commit", "seed", "accuracy", "materials"):
        assert name in ds.attrs
    assert all("units" in ds[name].attrs for name in ("normal_force", "axial_force"))
    assert (ds.attrs["radial_force"], ds.attrs["radial_force_units"]) == (-200.0, "N")


def test_files_carry_their_conventions_and_coordinates_have_no_fill_value(tmp_path):
    plan, _, _ = run(changed(material_pair=[["PA6", "POM"], ["POM", "PA6"]]), tmp_path)
    folder = plan.folder
    for path in (folder.design, folder.gathered, *map(folder.chunk, plan.chunks)):
        with netCDF4.Dataset(path) as file:
            assert file.Conventions == "CF-1.11" and file.title and file.history
            assert not re.search(r"\d\d:\d\d", file.history), "equal studies give equal files"
            coordinates = {*file.dimensions, *getattr(file, "coordinates", "").split()}
            for name in coordinates & {*file.variables}:
                assert "_FillValue" not in file[name].ncattrs(), (path.name, name)
            assert all("long_name" in variable.ncattrs() for variable in file.variables.values()), path.name


def test_two_runs_give_the_same_files(tmp_path, monkeypatch):
    run(DATA, tmp_path / "one")
    monkeypatch.setattr("trackroller.study.store.provenance.now", lambda: "1999-12-31T23:59:59+00:00")
    run(DATA, tmp_path / "two")
    for name in ("study.nc", "design.nc", "inputs/study.yaml"):
        assert (tmp_path / "one" / "s" / name).read_bytes() == (tmp_path / "two" / "s" / name).read_bytes()


@pytest.mark.slow
def test_killed_run_goes_on_and_ends_bit_for_bit_the_same(tmp_path, solved, monkeypatch):
    _, whole, _ = run(DATA, tmp_path / "whole")
    before = sum(solved().values())
    codes = [run_apart(tmp_path / "killed", before + 7 + 16 * i) for i in range(3)]
    assert all(code == -9 for code in codes)
    assert run_apart(tmp_path / "killed") == 0
    killed = xr.open_dataset(tmp_path / "killed" / "s" / "study.nc").load()
    xr.testing.assert_identical(killed.drop_attrs(), whole.drop_attrs())
    lost = sum(solved().values()) - 2 * before
    assert lost <= 3 * 20, "at most the block that was running when the process died"


def test_second_run_solves_nothing(tmp_path, solved):
    run(DATA, tmp_path)
    run(DATA, tmp_path)
    assert max(solved().values()) == 1


@pytest.mark.slow
@pytest.mark.parametrize(
    "more",
    [
        {"axial_force": [*LOADS, 50.0, 51.0]},
        {"friction_coefficient": [0.05, 0.1, 0.15, 0.2]},
        {"motor_force": [-30.0, 0.0]},
        {"axial_force": LOADS[5:]},
    ],
    ids=["level", "levels between", "factor", "fewer"],
)
def test_growing_a_study_solves_new_cases_only(tmp_path, solved, more):
    run(DATA, tmp_path)
    first = sum(solved().values())
    plan, ds, _ = run(changed(**more), tmp_path)
    old = 60 if "axial_force" not in more else 2 * len(set(LOADS) & set(more["axial_force"]))
    assert sum(solved().values()) - first == plan.size - old
    assert np.isfinite(ds["normal_force"]).all()


def test_killed_and_then_grown_study_keeps_finished_blocks(tmp_path, solved):
    assert run_apart(tmp_path, 45) == -9
    plan, _, _ = run(changed(axial_force=[10.0, *LOADS]), tmp_path)
    assert sum(solved().values()) <= plan.size + 20


@pytest.mark.slow
def test_accuracy_and_material_values_change_the_identity(tmp_path, solved):
    run(DATA, tmp_path)
    run(DATA | {"accuracy": "preview"}, tmp_path)
    assert set(solved().values()) == {2}
    run(DATA | {"base": {"roller_material": "PA6"}}, tmp_path)
    assert set(solved().values()) == {3}
    run(DATA | {"description": "other words", "seed": 5}, tmp_path)
    assert set(solved().values()) == {3}


def flip(path):
    data = bytearray(path.read_bytes())
    for place in range(len(data) // 4, len(data)):
        data[place] ^= 0x55
    path.write_bytes(data)  # in place: under both names of a chunk


def cut(path):
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def empty(path):
    path.write_bytes(b"")


def spoil_the_middle(path):
    data = np.frombuffer(path.read_bytes(), dtype=np.uint8).copy()
    used = np.flatnonzero(data)  # a small file is mostly empty space
    data[used[len(used) // 3 : 2 * len(used) // 3]] ^= 0x5A
    path.write_bytes(data.tobytes())


def put_another_in_its_place(path):
    other = next(p for p in sorted(path.parent.glob(f"*{path.suffix}")) if p != path)
    path.write_bytes(other.read_bytes())


@pytest.mark.slow
@pytest.mark.parametrize("damage", [flip, cut, empty, spoil_the_middle, put_another_in_its_place])
@pytest.mark.parametrize("place", ["chunks", "plan"])
def test_a_damaged_file_is_named_and_solved_again_when_it_is_removed(tmp_path, solved, damage, place):
    plan, whole, _ = run(DATA, tmp_path)
    victim = sorted((plan.folder.root / place).glob("*.nc"))[1]
    damage(victim)
    if damage is not put_another_in_its_place or place == "chunks":
        with pytest.raises(InputError, match=f"{victim.name}.*was altered or damaged.*Move or remove it"):
            run(DATA, tmp_path)
        victim.unlink()
    _, again, _ = run(DATA, tmp_path)
    xr.testing.assert_identical(again.drop_attrs(), whole.drop_attrs())
    assert sum(n - 1 for n in solved().values()) == (0 if place == "plan" else 20)


class Stopped(BaseException):
    """Ends a run as a user's Ctrl-C does."""


def test_stopped_run_keeps_its_complete_chunks_and_tells_progress_within_a_chunk(tmp_path, solved):
    data = changed(friction_coefficient=np.linspace(0.05, 0.4, 30).tolist()) | {"chunk_size": 300}
    steps: list[tuple[int, int]] = []

    def solver(design, database=None, **options):
        if sum(solved().values()) >= 500:
            raise Stopped
        block = fake_solver.solve(design)
        block["regime"][:2] = chunks.FAILED
        return block

    with pytest.raises(Stopped):
        run_study(parse_study(data), tmp_path, solver=solver, progress=lambda *counts: steps.append(counts))
    assert steps == [(64, 2), (236, 2), (256, 2)], "the second chunk begins with the block at which the first ended"
    _, ds, _ = run(data, tmp_path)
    assert sum(n - 1 for n in solved().values()) == 256, "the block that was solved in the chunk that was stopped"
    assert np.isfinite(ds["normal_force"]).all()


@pytest.mark.slow
@pytest.mark.parametrize("damage", [flip, cut, empty, spoil_the_middle])
@pytest.mark.parametrize("name", ["design.nc", "study.nc"])
def test_an_altered_design_or_study_stops_the_run_and_is_made_again_when_it_is_removed(tmp_path, solved, damage, name):
    plan, _, _ = run(DATA, tmp_path)
    victim = plan.folder.root / name
    before = victim.read_bytes()
    damage(victim)
    spoilt = victim.read_bytes()
    with pytest.raises(InputError, match=f"{name}' was altered or damaged.*Move or remove it, then start again"):
        run(DATA, tmp_path)
    assert victim.read_bytes() == spoilt
    victim.unlink()
    run(DATA, tmp_path)
    assert victim.read_bytes() == before and max(solved().values()) == 1


def test_design_follows_a_study_that_grows(tmp_path):
    run(DATA, tmp_path)
    plan, _, _ = run(changed(axial_force=[10.0, *LOADS]), tmp_path)
    assert xr.load_dataset(plan.folder.design).sizes["case"] == 62


def test_copied_folder_goes_on_without_solving(tmp_path, solved):
    run(DATA, tmp_path / "here")
    shutil.copytree(tmp_path / "here", tmp_path / "there")
    run(DATA, tmp_path / "there")
    assert max(solved().values()) == 1


def test_workflow_marks_are_made_again_where_the_chunk_is_there_and_nowhere_else(tmp_path, solved):
    plan, _, _ = run(DATA, tmp_path)
    first, second, *_ = plan.chunks
    plan.folder.mark(first).unlink()
    plan.folder.chunk(second).unlink()
    with working_ledger(parse_study(DATA), tmp_path) as plan:
        pass
    assert plan.folder.mark(first).is_file() and not plan.folder.mark(second).is_file()
    run(DATA, tmp_path)
    assert plan.folder.mark(second).is_file()
    assert sum(n - 1 for n in solved().values()) == 20


def test_failed_cases_are_rows_with_a_reason_and_the_rest_goes_on(tmp_path, monkeypatch, solved):
    data = changed(axial_force=[7.0, 13.0, *LOADS])
    _, ds, _ = run(data, tmp_path)
    assert int((ds["regime"] == 3).sum()) == 4
    assert "thirteen" in str(ds["reason"].sel(axial_force=13.0).values[0])
    assert "no convergence" in str(ds["reason"].sel(axial_force=7.0).values[0])
    assert ds["normal_force"].sel(axial_force=13.0).isnull().all()
    assert int(ds["converged"].sum()) == 60
    status = status_of(parse_study(data), study_folder("s", tmp_path))
    assert (status.total, status.done, status.failed) == (64, 64, 4)
    assert status.by_level[("axial_force", "13")] == 2
    before = sum(solved().values())
    mended = lambda design, database=None, **o: fake_solver.solve(design.assign(axial_force=design.axial_force + 100))  # noqa: E731
    plan = run_study(parse_study(data), tmp_path, solver=mended, rerun_failed=True)
    assert sum(solved().values()) - before == 4
    with xr.open_dataset(plan.folder.gathered) as again:
        assert int((again["regime"] == 3).sum()) == 0


def test_two_models_as_a_factor_stand_side_by_side(tmp_path):
    plan, ds, _ = run(DATA | {"spin_model": ["edge", "skewed"]}, tmp_path)
    assert ds.sizes["spin_model"] == 2 and plan.size == 120


def test_sampled_study_has_the_dimension_case(tmp_path):
    _, ds, _ = run(
        {
            "name": "l",
            "method": "lhs",
            "samples": 50,
            "outputs": ["forces"],
            "contact_model": "sliding",
            "factors": {"axial_force": {"uniform": [20, 50]}},
        },
        tmp_path,
    )
    assert ds.sizes["case"] == 50 and ds["axial_force"].dims == ("case",)


def test_table_of_cases(tmp_path):
    (tmp_path / "cases.csv").write_text("axial_force,roller_material\n20,PA6\n30,POM\n")
    study = parse_study(
        {"name": "t", "method": "table", "table": "cases.csv", "outputs": ["forces"], "contact_model": "sliding"},
        tmp_path / "t.yaml",
    )
    plan = run_study(study, tmp_path, solver=fake_solver.solve)
    with xr.open_dataset(plan.folder.gathered) as ds:
        assert list(ds["roller_material"].values) == ["PA6", "POM"]


def test_results_folder_that_cannot_be_written_is_an_input_error(tmp_path):
    (tmp_path / "s").write_text("a file where the folder should be")
    with pytest.raises(InputError, match="cannot be a folder"), working_ledger(parse_study(DATA), tmp_path):
        pass


@pytest.mark.parametrize("name", ["study.nc", "design.nc"])
def test_folder_in_the_place_of_a_file_is_an_input_error(tmp_path, name):
    (tmp_path / "s" / name).mkdir(parents=True)
    with pytest.raises(InputError, match=rf"{name}.*is a folder.*Move or remove it"):
        run(DATA, tmp_path)


def test_full_disk_ends_with_a_clear_message_and_leaves_nothing_behind(tmp_path):
    def write(beside):
        with open("/dev/full", "wb", buffering=0) as stream:
            beside.write_bytes(b"half")
            stream.write(b"x")

    with pytest.raises(WorkError, match=r"disk is full\. Free some space, then start again\.$"):
        write_whole(tmp_path / "out.nc", write)
    assert list(tmp_path.iterdir()) == []
    (tmp_path / "plan.json").write_text("{}")
    with pytest.raises(WorkError, match=r"disk is full.*every finished case is kept"):
        write_whole(tmp_path / "out.nc", write)
    assert [path.name for path in tmp_path.iterdir()] == ["plan.json"]


def test_really_full_disk_and_then_resume(tmp_path, solved):
    mount = tmp_path / "small"
    mount.mkdir()
    done = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=400k", "tmpfs", str(mount)], capture_output=True)
    if done.returncode:
        pytest.skip("no right to mount a small disk here")
    many = changed(friction_coefficient=np.linspace(0.01, 0.9, 60).tolist()) | {"chunk_size": 600}
    try:
        with pytest.raises(WorkError, match="kept"):
            run(many, mount)
        assert not list(mount.rglob("*.tmp"))
        before = solved()
        assert before, "some cases were finished"
        subprocess.run(["mount", "-o", "remount,size=60m", str(mount)], check=True)
        run(many, mount)
        assert sum(n - 1 for n in solved().values()) <= 256, "no more than the block that could not be written"
    finally:
        subprocess.run(["umount", "-l", str(mount)], check=False)


def test_block_survives_the_file_and_damage_never_does(tmp_path):
    cases = np.array([b"a" * 32, b"b" * 32])
    block, sound = chunks.failure(cases, "reason"), tmp_path / f"{chunk_name(cases)}.nc"
    chunks.write(sound, block)
    xr.testing.assert_equal(chunks.read(sound), block)
    whole = sound.read_bytes()
    damaged = tmp_path / "damaged" / sound.name
    damaged.parent.mkdir()
    rng = np.random.default_rng(1)
    for place in rng.integers(0, len(whole), 40):
        data = bytearray(whole)
        data[place] ^= 1 << int(rng.integers(8))
        damaged.write_bytes(data)
        with pytest.raises(chunks.CorruptFile):
            chunks.read(damaged)


def test_numbers_of_a_case_do_not_depend_on_its_neighbours():
    """The real solver: else a resumed run could not end bit for bit like an undisturbed one."""
    import trackroller as tr

    design = tr.load_study(HERE.parent / "config" / "studies" / "default.yaml").design()
    design = design.drop_vars(list(design.coords)).isel(case=np.random.default_rng(3).permutation(5400)[:60])
    whole = solve_sliding(design)
    for size in (1, 4, 23):
        for start in range(0, 60 if size > 1 else 10, size):
            part = solve_sliding(design.isel(case=slice(start, start + size)))
            for name in whole.data_vars:
                np.testing.assert_array_equal(part[name].values, whole[name].values[start : start + size], err_msg=name)


def test_grids_of_different_sizes_are_joined_and_gathered_with_missing_ends(tmp_path):
    """Contact models, and patches that are solved on a grid, bring tractions on grids of their own sizes."""

    def solver(design, database=None, **options):
        size = 3 if options["spin_model"] == "edge" else 5
        grid = np.broadcast_to(np.arange(size, dtype=float), (design.sizes["case"], size))
        return fake_solver.solve(design).assign(pressure=(("case", "x"), grid, {"units": "MPa", "long_name": "p"}))

    study = parse_study(DATA | {"spin_model": ["edge", "skewed"]})
    with xr.open_dataset(run_study(study, tmp_path, solver=solver).folder.gathered) as ds:
        assert ds.sizes["x"] == 5 and not ds["pressure"].sel(spin_model="skewed").isnull().any()
        short = ds["pressure"].sel(spin_model="edge")
        assert (short[..., :3] == [0, 1, 2]).all() and short[..., 3:].isnull().all()
    blocks = [
        solver(xr.Dataset({n: ("case", [float(i)]) for n in DATA["factors"]}), spin_model=model)
        for i, model in enumerate(("edge", "skewed"))
    ]
    cases = np.array([b"a", b"b"])
    joined = chunks.join(chunks.from_results(block, cases[i : i + 1]) for i, block in enumerate(blocks))
    assert joined.sizes == {"case": 2, "contact": 2, "x": 5} and int(joined["pressure"].isnull().sum()) == 2


SAMPLED = {
    "a": {"uniform": [0.01, 0.5]},
    "axial_force": {"expression": "20 + 40 * a"},
    "friction_coefficient": {"uniform": [0.05, 0.3]},
    "radial_force": {"values": [-200.0, -150.0, -100.0]},
    "motor_force": {"values": [0.0, -10.0]},
}


@pytest.mark.long
@pytest.mark.parametrize(
    ("design", "small", "large"),
    [
        ("sobol", 30, 60),
        ("sobol", 30, 47),
        ("saltelli", 8, 16),
        ("morris", 5, 9),
        ("inner_outer", 10, 15),
    ],
)
def test_more_samples_leave_the_cases_of_the_smaller_sample_solved(tmp_path, solved, design, small, large):
    data = {"name": "g", "method": design, "outputs": ["forces"], "contact_model": "sliding"} | {
        "factors": SAMPLED,
        "chunk_size": 20,
    }
    run(data | {"samples": small}, tmp_path)
    before = solved()
    plan, ds, _ = run(data | {"samples": large}, tmp_path)
    cases = len(np.unique(StudyCases(plan.study).fingerprints))
    assert 0 < sum(before.values()) < sum(solved().values()) == cases, "each case of the larger sample once"
    run(data | {"samples": large}, tmp_path)
    assert sum(solved().values()) == cases, "planning again changes nothing"
    assert status_of(parse_study(data | {"samples": large}), study_folder(data["name"], tmp_path)).missing == 0
    assert np.isfinite(ds["normal_force"]).all()


def test_a_larger_latin_hypercube_is_drawn_anew_and_the_plan_says_so(tmp_path, solved):
    data = {"name": "g", "outputs": ["forces"], "contact_model": "sliding", "factors": SAMPLED, "method": "lhs"}
    run(data | {"samples": 10}, tmp_path)
    told = status_of(parse_study(data | {"samples": 20}), study_folder("g", tmp_path)).unused
    assert told.startswith("10 solved cases") and "lhs draws each number of samples anew" in told
    assert "Design sobol keeps its rows" in told
