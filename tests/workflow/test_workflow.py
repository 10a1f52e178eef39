"""The workflow as users start it: runs what is missing and nothing else, and survives being killed."""

from __future__ import annotations

import os
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
description: a small study
factors:
  axial_force: {{linspace: [0, 60, {levels}]}}
  friction_coefficient: {{values: [0.1, 0.2]}}
outputs: [{outputs}]
chunk_size: {size}
"""


@pytest.fixture
def place(tmp_path):
    """A folder with the workflow in it, as a clone has it."""
    lay_workflow(tmp_path)
    return tmp_path


def write_study(place, levels=6, outputs="forces", size=4):
    (place / "tiny.yaml").write_text(STUDY.format(levels=levels, outputs=outputs, size=size))


def command(*words):
    return [str(Path(sys.executable).parent / "snakemake"), "--cores", "2", "--nocolor", *words]


def snakemake(place, *words, code=0):
    done = subprocess.run(command(*words), cwd=place, capture_output=True, text=True, timeout=240)
    told = done.stdout + done.stderr
    assert done.returncode == code, told
    return told


def started(told):
    """Names of the rules that were run."""
    return sorted(
        line.split("rule ")[1].rstrip(":") for line in told.splitlines() if line.startswith(("rule ", "localrule "))
    )


def test_study_to_report_then_nothing_and_a_changed_study_only_what_depends_on_it(place):
    write_study(place)
    assert started(snakemake(place)).count("solve") == 3
    out = place / "results" / "tiny"
    for name in ("design.nc", "study.nc", "sensitivity.nc", "report.html"):
        assert (out / name).is_file()
    assert list((out / "figures").glob("*.svg")) and list((out / "figures").glob("*.png"))
    assert "Nothing to be done" in snakemake(place)
    time.sleep(1.1)
    (place / "tiny.yaml").write_text((place / "tiny.yaml").read_text().replace("a small study", "other words"))
    again = started(snakemake(place, "-n"))
    assert "solve" not in again and "gather" in again and "report" in again
    write_study(place, levels=11)  # keeps 0, 12, ... 60 and adds the levels between
    assert started(snakemake(place, "results/tiny/study.nc")).count("solve") == 3, "10 new cases, 3 chunks"
    with xr.open_dataset(out / "study.nc") as ds:
        assert ds.sizes["axial_force"] == 11 and int(ds["converged"].sum()) == 22


@pytest.mark.parametrize(
    ("words", "named"),
    [
        (["--config", "stduy=x.yaml"], "study"),
        (["--config", "study=nowhere.yaml"], "nowhere.yaml"),
    ],
)
def test_wrong_configuration_is_told_without_a_traceback(place, words, named):
    write_study(place)
    told = snakemake(place, "-n", *words, code=1)
    assert named in told and "Traceback" not in told


def test_killed_workflow_goes_on_without_unlocking_and_solves_no_finished_chunk_again(place):
    write_study(place, levels=200, outputs="forces, peak_stress", size=60)
    target = "results/tiny/study.nc"
    process = subprocess.Popen(
        command(target), cwd=place, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
    )
    chunks = place / "results" / "tiny" / "chunks"
    for _ in range(900):
        if len(list(chunks.glob("*.nc"))) >= 2 or process.poll() is not None:
            break
        time.sleep(0.1)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    before = {path.name: path.stat().st_ino for path in chunks.glob("*.nc")}
    assert len(before) >= 2
    told = snakemake(place, target)
    assert "unlock" not in told
    assert all((chunks / name).stat().st_ino == inode for name, inode in before.items())
    with xr.open_dataset(place / target) as ds:
        assert ds.sizes["axial_force"] == 200 and int(ds["regime"].max()) < 3


@pytest.mark.parametrize("target", [(), ("contact_models",)])
def test_the_comparison_of_contact_models_is_a_study_like_any_other(place, target):
    told = snakemake(place, "-n", *target, "--config", "study=validation/config/contact_models.yaml")
    assert started(told) == ["contact_models"] if target else {"figures", "report"} <= set(started(told))
