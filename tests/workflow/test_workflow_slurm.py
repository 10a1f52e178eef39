"""The Slurm profile against a real Slurm of one node; `make test-slurm` runs it."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import xarray as xr
from workflow_place import ROOT, lay_study

# Python runs a `sitecustomize` at start. Here it lets the first job wait inside the solver, with the chunk locked,
# until somebody removes the file "hold"; so a worker can be killed at work, however fast the machine is.
HOLD = """
import os, sys, time
if os.environ.get("SLURM_JOB_ID") and any(word.endswith("solve.py") for word in sys.argv or sys.orig_argv):
    from pathlib import Path
    from trackroller.roller import solver
    place, real = Path(os.environ["HOLD"]), solver.solve
    def solve(*args, **kwargs):
        if (place / "hold").exists():
            (place / f"working-{os.environ['SLURM_JOB_ID']}").touch()
        while (place / "hold").exists():
            time.sleep(0.1)
        return real(*args, **kwargs)
    solver.solve = solve
"""
pytestmark = pytest.mark.slurm


@pytest.fixture(scope="module")
def slurm(tmp_path_factory):
    """Return the environment of a running cluster."""
    if shutil.which("slurmctld") is None:
        pytest.skip("Slurm is not installed: apt-get install slurmctld slurmd slurm-client munge")
    script = Path(__file__).with_name("cluster.sh")
    env = os.environ | {"SLURM_SANDBOX": str(tmp_path_factory.mktemp("slurm"))}
    subprocess.run([str(script), "up"], env=env, check=True, timeout=120)
    told = subprocess.run([str(script), "env"], env=env, check=True, capture_output=True, text=True).stdout
    conf, path = told.split()
    try:
        tools = Path(sys.executable).parent
        yield env | {"SLURM_CONF": conf, "PATH": f"{path}:{tools}:{env['PATH']}"}
    finally:
        subprocess.run([str(script), "down"], env=env, check=False, timeout=120)


@pytest.fixture
def place(tmp_path):
    """Return a folder with a study, and the solver that waits."""
    (tmp_path / "hook").mkdir()
    (tmp_path / "hook" / "sitecustomize.py").write_text(HOLD)
    return lay_study(tmp_path, levels=20, outputs="forces", size=10)


def submit(place, env, results):
    words = [
        "snakemake",
        "-s",
        str(ROOT / "Snakefile"),
        "--profile",
        str(ROOT / "profiles" / "slurm"),
        "--nocolor",
        "--default-resources",
        "mem_mb=500",
        "runtime=5",
        "--config",
        f"results={results}",
        "--",
        f"{results}/tiny/study.nc",
    ]
    return subprocess.Popen(
        words, cwd=place, env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True
    )


def finish(process, seconds=480):
    try:
        told = process.communicate(timeout=seconds)[0]
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGINT)
        try:
            told = process.communicate(timeout=20)[0]
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            told = process.communicate()[0]
        pytest.fail(f"it hangs:\n{told}")
    return process.returncode, told


def wait_for(place, seconds=120):
    """Wait for a Slurm job that works inside the solver, and return its number."""
    for _ in range(10 * seconds):
        if working := sorted(place.glob("working-*")):
            return working[0].name.removeprefix("working-")
        time.sleep(0.1)
    pytest.fail("no job reached the solver")


def numbers(place, results):
    return xr.load_dataset(place / results / "tiny" / "study.nc").drop_attrs()


def test_cluster_gives_the_numbers_of_a_local_run_though_a_worker_is_killed(slurm, place):
    words = ["snakemake", "-s", str(ROOT / "Snakefile"), "--cores", "2", "--config", "results=local"]
    local = subprocess.run(
        [*words, "--", "local/tiny/study.nc"], cwd=place, env=slurm, capture_output=True, text=True, timeout=480
    )
    assert local.returncode == 0, local.stdout + local.stderr
    hold = place / "hold"
    hold.touch()
    path = os.pathsep.join([str(place / "hook"), str(ROOT)])
    process = submit(place, slurm | {"HOLD": str(place), "PYTHONPATH": path}, "results")
    try:
        victim = wait_for(place)
        subprocess.run(["scancel", "--signal=KILL", "--full", victim], env=slurm, check=True)
    finally:
        hold.unlink()
    _, told = finish(process)
    assert "Error in rule solve" in told, told
    code, told = finish(submit(place, slurm, "results"))
    assert code == 0, told
    assert "unlock" not in told
    xr.testing.assert_identical(numbers(place, "results"), numbers(place, "local"))
