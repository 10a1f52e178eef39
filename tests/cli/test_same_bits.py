"""The same bits, however many threads the linear algebra library might take."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest
import xarray as xr
from command_line import trackroller

STUDY = """
name: bits
method: lhs
samples: 300
factors:
  friction_coefficient: {uniform: [0.05, 0.3]}
  axial_force: {uniform: [10, 60]}
  radial_force: {uniform: [-300, -100]}
  motor_force: {uniform: [-30, 0]}
contact_model: sliding
outputs: [forces, contact]
"""
ANALYSE = "import trackroller.cli.workflow, sys, pathlib; from trackroller.results.stored_study import open_study; "
ANALYSE += "from trackroller.report.build import write_analysis; "
ANALYSE += "write_analysis(open_study('results/bits/study.nc'), pathlib.Path(sys.argv[1]))"


@pytest.mark.slow
def test_command_and_workflow_write_the_same_analysis(tmp_path):
    (tmp_path / "study.yaml").write_text(STUDY)
    trackroller("run", "study.yaml", "-q", cwd=tmp_path)
    for threads in ("1", "2"):
        free = {name: value for name, value in os.environ.items() if name != "OPENBLAS_NUM_THREADS"}
        there = free | {"OMP_NUM_THREADS": threads}
        words = [sys.executable, "-c", ANALYSE, f"{threads}.nc"]
        subprocess.run(words, cwd=tmp_path, env=there, check=True, capture_output=True)
    one, two = (xr.load_dataset(tmp_path / f"{threads}.nc") for threads in ("1", "2"))
    xr.testing.assert_identical(one, two)
