"""The command line: answers, exit codes, and no traceback on bad input."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import time

import pytest
import xarray as xr
from command_line import PROGRAM, trackroller, trackroller_process

STUDY = """
name: tiny
factors:
  axial_force: {values: [0, 20, 40]}
  friction_coefficient: {values: [0.1, 0.2]}
outputs: [forces]
contact_model: sliding
"""


@pytest.mark.slow
def test_solve_prints_json_and_writes_netcdf(tmp_path):
    (tmp_path / "case.yaml").write_text("motor_force: 0\noutputs: [forces]\ncontact_model: sliding\n")
    words = ("solve", "case.yaml", "--set", "contact_model=kalker", "--set", "accuracy=preview", "--json")
    done = trackroller_process(*words, cwd=tmp_path)
    told = json.loads(done.stdout)
    assert done.stderr == ""
    assert told["normal_force"]["units"] == "N" and len(told["normal_force"]["value"]) == 2
    assert told["regime"]["meaning"] == "rolling"
    trackroller("solve", "case.yaml", "-o", "out.nc", cwd=tmp_path)
    with xr.open_dataset(tmp_path / "out.nc") as ds:
        assert ds["normal_force"].attrs["units"] == "N"


def test_json_says_in_words_whether_a_limit_is_kept_and_which_one_is_first(tmp_path):
    told = json.loads(trackroller("solve", "--set", "contact_model=sliding", "--json", cwd=tmp_path).stdout)
    states = dict(zip(told["limit"]["value"], told["limit_state"]["meaning"], strict=True))
    assert states["static"] == ["kept", "kept"] and states["bearing"] == ["unknown", "unknown"]
    assert told["limiting_mechanism"]["meaning"] == ["fatigue", "unknown"]  # the guide's hours are not known


@pytest.mark.slow
def test_study_from_plan_to_repeat(tmp_path):
    (tmp_path / "tiny.yaml").write_text(STUDY)
    assert "cases    6, 0 of them" in trackroller("plan", "tiny.yaml", cwd=tmp_path).stdout
    assert not (tmp_path / "results").exists(), "planning writes nothing"
    trackroller("run", "tiny.yaml", cwd=tmp_path)
    with xr.open_dataset(tmp_path / "results" / "tiny" / "study.nc") as ds:
        assert ds["normal_force"].dims == ("axial_force", "friction_coefficient", "contact")
        assert ds["normal_force"].shape == (3, 2, 2)
    assert "6 done, 0 missing, 0 failed" in trackroller("status", "tiny", cwd=tmp_path).stdout
    again = trackroller("repeat", "tiny", 4, cwd=tmp_path).stdout
    assert "equal to the stored result" in again
    command = again.splitlines()[0].split()
    told = json.loads(trackroller(*command[1:], "--json", cwd=tmp_path).stdout)
    with xr.open_dataset(tmp_path / "results" / "tiny" / "study.nc") as ds:
        stored = ds["normal_force"].sel(axial_force=40, friction_coefficient=0.1).values.tolist()
    assert told["normal_force"]["value"] == stored


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (["solve", "nowhere.yaml"], "nowhere.yaml"),
        (["solve", "--set", "frction=0.1"], "friction_coefficient"),
        (["solve", "--set", "friction_coefficient=-1"], "friction_coefficient"),
        (["solve", "--set", "roller_profile_radius=-5"], "conform"),
        (["solve", "--set", "roller_material=PA7"], "PA6"),
        (["solve", "--set", "accuracy=fine"], "accuracy"),
        (["solve", "--set", "nothing"], "key=value"),
        (["solve", "--set", "mu=typcal"], "Did you mean 'typical'?"),
        (["solve", "--set", "mu=0.1", "--set", "mu=0.2"], "gives mu twice"),
        (["solve", "--set", "mu=0.1", "velocity=20"], "Write --set velocity=20"),
        (["solve", "-o", "no/where.nc"], "--out"),
        (["plan", "bad.yaml"], "not YAML"),
        (["run", "bad.yaml"], "not YAML"),
        (["run", "blocked.yaml"], "cannot be a folder"),
        (["run", "good.yaml", "--scheduler", "nonsense"], "--scheduler"),
        (["status", "../etc"], "../etc"),
        (["repeat", "good.yaml", "99"], "99"),
        (["materials", "show", "PA7"], "PA6"),
        (["plot", "nowhere.yaml"], "nowhere.yaml"),
        (["solv"], "solv"),
    ],
)
def test_bad_input_ends_with_exit_2_and_names_it(tmp_path, words, named):
    (tmp_path / "bad.yaml").write_text("name: x\nfactors: [\n")
    (tmp_path / "good.yaml").write_text(STUDY)
    (tmp_path / "blocked.yaml").write_text(STUDY.replace("tiny", "blocked"))
    (tmp_path / "results").mkdir()
    (tmp_path / "results" / "blocked").write_text("a file")
    assert named in trackroller(*words, cwd=tmp_path, code=2).stderr
    assert not list(tmp_path.rglob("study.nc"))


def test_a_short_study_needs_no_cluster_and_a_finished_one_no_scheduler(tmp_path):
    (tmp_path / "tiny.yaml").write_text(STUDY)
    assert re.search(r"cluster +not needed: \d+ s here", trackroller("plan", "tiny.yaml", cwd=tmp_path).stdout)
    assert "left to solve" not in trackroller("run", "tiny.yaml", "-q", cwd=tmp_path).stderr
    again = trackroller("run", "tiny.yaml", "-q", "--scheduler", "slurm", cwd=tmp_path).stderr
    assert "nothing is left to solve of 'tiny'; --scheduler slurm is not used\n" in again
    assert "cluster" not in trackroller("plan", "tiny.yaml", cwd=tmp_path).stdout
    values, one = "values: [0, 20, 40]", "linspace: [0, 40, 40000]"
    long = STUDY.replace(values, one).replace("sliding", "kalker").replace("[forces]", "[life]")
    (tmp_path / "long.yaml").write_text(long.replace("tiny", "long") + "accuracy: reference\n")
    assert "cluster" not in trackroller("plan", "long.yaml", cwd=tmp_path).stdout


@pytest.mark.slow
def test_words_of_a_designer_are_understood_or_answered(tmp_path):
    """A drawn groove takes the place of the example's radius; each refusal says what to write."""
    points = [f"{0.05 * i:.2f},{-(7 - (49 - (0.05 * i) ** 2) ** 0.5):.6f}" for i in range(-120, 121)]
    (tmp_path / "groove.csv").write_text("x [mm],z [mm]\n" + "\n".join(points))
    fast = ("--set", "contact_model=sliding", "--set", "accuracy=preview")
    drawn = ("--set", "normal=halfspace", "--set", "roller_profile={file: groove.csv}")
    told = trackroller("solve", *fast, *drawn, cwd=tmp_path).stdout
    assert "roller profile  " in told and "roller profile radius" not in told
    assert "roller profile radius" in trackroller("solve", *fast, cwd=tmp_path).stdout
    refused = {
        (
            "solve",
            "--set",
            "roller_profile=groove.csv",
        ): "Write roller_profile: {file: groove.csv} for a file of points.",
        ("solve", "radial_force=-650"): "Write --set radial_force=-650",
    }
    for words, remedy in refused.items():
        assert remedy in trackroller(*words, cwd=tmp_path, code=2).stderr
    depth = ("--set", "permissible_wear_depth=0.1", "--set", "mu=0", "--set", "motor_force=0")
    kept = [line for line in trackroller("solve", *fast, *depth, cwd=tmp_path).stdout.splitlines() if "wear (" in line]
    assert kept and "not given" not in "".join(kept)


def test_materials_are_listed_shown_and_added(tmp_path):
    assert "PA6" in trackroller("materials", "list", cwd=tmp_path).stdout
    assert "placeholder" in trackroller("materials", "show", "PA6", cwd=tmp_path).stdout.lower()
    trackroller(
        "materials",
        "add",
        "mine",
        "--set",
        "like=PA6",
        "--set",
        "tensile_strength=75",
        "--file",
        "config/materials.yaml",
        cwd=tmp_path,
    )
    assert "mine" in trackroller("materials", "list", cwd=tmp_path).stdout
    soft = trackroller("materials", "add", "soft", "--set", "like=POM", "--set", "youngs_modulus=3.6", cwd=tmp_path)
    assert "youngs_modulus = 3.6 MPa is 55.6 times below" in soft.stderr
    twice = trackroller("materials", "add", "soft", "--set", "like=POM", cwd=tmp_path, code=2).stderr
    assert "(--replace)" in twice and "replace=True" not in twice


@pytest.mark.long
def test_dask_workers_give_the_same_numbers(tmp_path):
    (tmp_path / "tiny.yaml").write_text(STUDY)
    trackroller("run", "tiny.yaml", "-q", cwd=tmp_path)
    trackroller_process("run", "tiny.yaml", "-q", "--results", "dask", "--scheduler", "local", cwd=tmp_path)
    sets = [xr.load_dataset(tmp_path / name / "tiny" / "study.nc") for name in ("results", "dask")]
    xr.testing.assert_identical(*(ds.drop_attrs() for ds in sets))


@pytest.mark.long
def test_dask_scheduler_and_workers_apart_with_a_worker_killed(tmp_path):
    """Scheduler and workers are processes of their own; one worker dies in mid-run, every case is there."""
    study = STUDY.replace("[0, 20, 40]", "[" + ", ".join(f"{v / 10}" for v in range(300)) + "]")
    (tmp_path / "tiny.yaml").write_text(study.replace("outputs: [forces]", "outputs: [forces, peak_stress]"))
    dask = [sys.executable, "-m", "dask"]
    quiet = {"cwd": tmp_path, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    helpers = [
        subprocess.Popen(
            [*dask, "scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", "s.json"],
            **quiet,
        )
    ]
    try:
        for _ in range(2):
            helpers.append(
                subprocess.Popen(
                    [
                        *dask,
                        "worker",
                        "--scheduler-file",
                        "s.json",
                        "--nworkers",
                        "1",
                        "--nthreads",
                        "1",
                        "--no-dashboard",
                        "--no-nanny",
                    ],
                    **quiet,
                )
            )
        wait_until(lambda: (tmp_path / "s.json").is_file())
        address = json.loads((tmp_path / "s.json").read_text())["address"]
        run = subprocess.Popen(
            [*PROGRAM, "run", "tiny.yaml", "-q", "--scheduler", address],
            **quiet,
        )
        folder = tmp_path / "results" / "tiny"
        wait_until(lambda: any(folder.glob("chunks/*.nc")))
        helpers[1].kill()
        assert run.wait(timeout=120) == 0
    finally:
        for helper in reversed(helpers):
            helper.kill()
            helper.wait()
    trackroller("run", "tiny.yaml", "-q", "--results", "alone", cwd=tmp_path)
    sets = [xr.load_dataset(tmp_path / name / "tiny" / "study.nc") for name in ("results", "alone")]
    xr.testing.assert_identical(*(ds.drop_attrs() for ds in sets))


def wait_until(there, seconds=60):
    for _ in range(seconds * 10):
        if there():
            return
        time.sleep(0.1)
    raise AssertionError("waited in vain")


LOADED = "import atexit; atexit.register(lambda: print('loaded', *sys.modules))"


@pytest.mark.parametrize(
    ("words", "code", "heavy"),
    [
        (["--version"], 0, {"numba", "scipy"}),
        (["--help"], 0, {"numba", "scipy"}),
        (["solve", "--set", "frction=0.1"], 2, {"numba", "scipy"}),
        (["solve", "--set", "accuracy=fine"], 2, {"dask"}),
    ],
)
def test_an_answer_without_a_solution_loads_no_heavy_package(words, code, heavy, tmp_path):
    program = f"import sys; from trackroller.cli.main import main; sys.argv[1:] = {words}; "
    program += f"{LOADED}; main()"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=tmp_path)
    loaded = set(done.stdout.partition("loaded ")[2].split())
    assert done.returncode == code and "typer" in loaded, done.stderr
    assert not loaded & (heavy | {"xarray", "matplotlib"})


def test_a_plan_needs_no_compiled_solver(tmp_path):
    """What a case serves of the limits is known without the solver."""
    text = "import sys, trackroller.cli.study; print('numba' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, cwd=tmp_path)
    assert done.stdout.split() == ["False"], done.stderr


# with what `trackroller solve` takes 1.5 s of processor time; each of these packages takes 0.03 to 0.3 s more
NOT_FOR_ONE_ROLLER = {
    *("dask.base", "pint.registry", "jinja2", "matplotlib", "SALib", "netCDF4"),
    *("scipy.interpolate", "scipy.optimize", "scipy.sparse", "scipy.spatial", "scipy.stats"),
    *("trackroller.study.file.config", "trackroller.carriage.solve", "trackroller.app.start"),
    *("trackroller.results.carriage_answer", "trackroller.results.spectrum_answer", "trackroller.results.wear_answer"),
}


def loaded_by(words, folder):
    """Return the modules that a command imports, and what it prints."""
    program = f"import sys; from trackroller.cli.__main__ import run; sys.argv[1:] = {words}; {LOADED}; run()"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=folder)
    assert done.returncode == 0, done.stderr
    printed, _, loaded = done.stdout.partition("loaded ")
    return set(loaded.split()), printed


@pytest.mark.parametrize("words", [["solve"], ["solve", "--json"]])
def test_one_roller_loads_only_what_it_needs(words, tmp_path):
    loaded, _ = loaded_by(words, tmp_path)
    assert {"xarray", "trackroller.roller.solver"} <= loaded
    assert not loaded & NOT_FOR_ONE_ROLLER


def test_a_file_of_one_roller_loads_what_writes_it(tmp_path):
    loaded, _ = loaded_by(["solve", "-o", "one.nc"], tmp_path)
    assert not loaded & (NOT_FOR_ONE_ROLLER - {"netCDF4"})


@pytest.mark.slow
def test_a_unit_is_converted_although_it_was_left_out(tmp_path):
    """xarray does without pint in this process, and a quantity takes it in."""
    loaded, printed = loaded_by(["solve", "--json", "--set", "radial_force=-0.25 kN"], tmp_path)
    assert json.loads(printed)["inputs"]["radial_force"]["value"] == -250.0
    assert "pint.registry" in loaded
