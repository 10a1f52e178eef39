"""Real folders without write access and real full disks: one line, exit code 1, and the next run continues."""

from __future__ import annotations

import contextlib
import os
import resource
import subprocess
import sys

import pytest
import xarray as xr
from command_line import trackroller

STUDY = """
name: disk
factors:
  axial_force: {linspace: [0, 60, 40]}
  friction_coefficient: {linspace: [0.05, 0.4, 10]}
outputs: [forces]
contact_model: sliding
chunk_size: 100
"""


@pytest.fixture
def study(tmp_path):
    """Return a study file."""
    path = tmp_path / "study.yaml"
    path.write_text(STUDY)
    return path


@pytest.fixture
def disk(tmp_path):
    """Return a function `disk(options)` that mounts a separate disk or changes its options."""
    place = tmp_path / "disk"
    place.mkdir()

    def change(options):
        known = place.is_mount()
        words = (
            ["mount", "-o", f"remount,{options}", str(place)]
            if known
            else ["mount", "-t", "tmpfs", "-o", options, "tmpfs", str(place)]
        )
        if subprocess.run(words, capture_output=True, check=False).returncode:
            pytest.skip("no right to mount a disk here")
        return place

    yield change
    subprocess.run(["umount", "-l", str(place)], capture_output=True, check=False)


def run(study, results, code=0):
    """Run the study, require the exit code, and return what was told."""
    return trackroller("run", study, "--results", results, "-q", cwd=study.parent, code=code).stderr


def refused(study, results, path, why):
    line = run(study, results, code=1).strip().splitlines()[-1]
    assert str(path) in line and why in line and "start again" in line


@pytest.mark.slow
def test_read_only_disk_is_named_and_the_run_goes_on_when_it_is_mended(study, disk):
    place = disk("size=20m")
    disk("ro")
    refused(study, place, place / "disk", "cannot be written")
    disk("rw")
    run(study, place)
    study.write_text(STUDY.replace("40]", "79]"))
    disk("ro")
    refused(study, place, place / "disk", "cannot be written")


@pytest.mark.slow
def test_full_disk_is_named_and_finished_cases_are_kept(study, disk):
    place = disk("size=300k")
    refused(study, place, place, "disk is full")
    assert not list(place.rglob("*.tmp"))
    kept = len(list(place.rglob("chunks/*.nc")))
    disk("size=20m")
    told = run(study, place)
    assert told.count("cases solved in") == 4 - kept
    with xr.open_dataset(place / "disk" / "study.nc") as ds:
        assert int(ds["converged"].sum()) == 400


@contextlib.contextmanager
def largest_file(size):
    """Limit the size of files that this process writes [bytes]."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


@pytest.mark.slow
def test_file_size_limit_is_told(study, tmp_path):
    with largest_file(20_000):
        refused(study, tmp_path / "r", tmp_path / "r", "writing failed")
    run(study, tmp_path / "r")


def test_results_that_are_a_file_are_bad_input(study, tmp_path):
    (tmp_path / "r").write_text("precious")
    assert str(tmp_path / "r") in run(study, tmp_path / "r", code=2)
    assert (tmp_path / "r").read_text() == "precious"


def test_a_full_disk_is_not_called_a_lack_of_rights(study, disk):
    """The netCDF library says 'Permission denied' where it cannot create a file on a full disk."""
    place = disk("size=64k")
    case = study.parent / "case.yaml"
    case.write_text("contact_model: sliding\noutputs: [forces]\n")
    with contextlib.suppress(OSError), open(place / "filler", "wb", buffering=0) as filler:
        while True:
            filler.write(bytes(4096))
    for words in (("solve", case, "-o", place / "x.nc"), ("plot", case, "-o", place / "p")):
        line = trackroller(*words, cwd=study.parent, code=1).stderr
        assert "the disk is full" in line and "ermission" not in line
    entry = ("materials", "add", "x", "--set", "like=PA6", "--set", "tensile_strength=70", "--file", place / "m.yaml")
    assert "the disk is full" in trackroller(*entry, cwd=study.parent, code=2).stderr


def test_a_full_device_for_the_output_is_named(tmp_path):
    if not os.path.exists("/dev/full"):
        pytest.skip("this system has no full device")
    words = [sys.executable, "-m", "trackroller.cli", "materials", "list"]
    with open("/dev/full", "w") as full:
        done = subprocess.run(words, cwd=tmp_path, stdout=full, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 1 and "the disk is full" in done.stderr and "Traceback" not in done.stderr
