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
from workflow_place import lay_workflow

STUDY = """
name: tiny
factors:
  axial_force: {linspace: [0, 60, 100]}
  friction_coefficient: {values: [0.1, 0.2]}
outputs: [forces, peak_stress]
chunk_size: 50
"""
pytestmark = pytest.mark.slurm


@pytest.fixture(scope="module")
def slurm(tmp_path_factory):
    """Environment of a running cluster."""
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
    """A folder with the workflow in it."""
    lay_workflow(tmp_path)
    (tmp_path / "tiny.yaml").write_text(STUDY)
    return tmp_path


def submit(place, env, results):
    words = [
        "snakemake",
        "--profile",
        "profiles/slurm",
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


def finish(process, seconds=240):
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


def numbers(place, results):
    return xr.load_dataset(place / results / "tiny" / "study.nc").drop_attrs()


def test_cluster_gives_the_numbers_of_a_local_run_though_a_worker_is_killed(slurm, place):
    subprocess.run(
        ["snakemake", "--cores", "2", "--config", "results=local", "--", "local/tiny/study.nc"],
        cwd=place,
        env=slurm,
        check=True,
        capture_output=True,
        timeout=240,
    )
    process = submit(place, slurm, "results")
    victim = None
    for _ in range(600):
        jobs = subprocess.run(["squeue", "-h", "-t", "R", "-o", "%i"], env=slurm, capture_output=True, text=True).stdout
        if jobs.split() and list((place / "results" / "tiny" / "store").glob("*.lock")):
            victim = jobs.split()[0]
            subprocess.run(["scancel", "--signal=KILL", "--full", victim], env=slurm, check=True)
            break
        time.sleep(0.1)
    assert victim is not None
    finish(process)
    code, told = finish(submit(place, slurm, "results"))
    assert code == 0, told
    assert "unlock" not in told
    xr.testing.assert_identical(numbers(place, "results"), numbers(place, "local"))
