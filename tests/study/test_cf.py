"""Every netCDF file that the program writes passes the compliance checker for CF 1.11."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from trackroller.cli.main import app

pytest.importorskip("compliance_checker", reason="needs compliance-checker")
STUDIES = {
    "grid": "design: grid\nfactors: {friction_coefficient: {values: [0.1, 0.2]}, axial_force: {values: [0, 15, 30]}}\n",
    "sample": "design: lhs\nsamples: 12\nfactors: {friction_coefficient: {uniform: [0.1, 0.3]}}\n",
}
SPECTRUM = """
base: {motor_force: 0, guide_overrollings_per_hour: 10}
blocks: [{distance: 100, radial_force: -50, axial_force: 0}]
"""


@pytest.fixture(scope="module")
def files(tmp_path_factory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("cf")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        for name, text in STUDIES.items():
            Path(f"{name}.yaml").write_text(f"name: {name}\nbase: {{motor_force: 0}}\naccuracy: preview\n{text}")
            assert CliRunner().invoke(app, ["run", f"{name}.yaml", "-q", "--report"]).exit_code == 0
        Path("shift.yaml").write_text(SPECTRUM)
        assert CliRunner().invoke(app, ["spectrum", "shift.yaml", "-o", "shift.nc"]).exit_code == 0
        assert CliRunner().invoke(app, ["solve", "-o", "case.nc"]).exit_code == 0
    found = {
        f"{s}-{f}": folder / "results" / s / f"{f}.nc" for s in STUDIES for f in ("design", "study", "sensitivity")
    }
    chunk = next((folder / "results" / "grid" / "chunks").glob("*.nc"))
    return found | {"chunk": chunk, "spectrum": folder / "shift.nc", "case": folder / "case.nc"}


@pytest.mark.parametrize(
    "name",
    [*(f"{s}-{f}" for s in STUDIES for f in ("design", "study", "sensitivity")), "chunk", "spectrum", "case"],
)
def test_a_file_has_no_error_of_the_convention(files, name, tmp_path):
    out = tmp_path / "found.json"
    command = [sys.executable, "-m", "compliance_checker.runner"]
    script = Path(sys.executable).parent / "compliance-checker"
    command = [str(script)] if script.exists() else command
    subprocess.run([*command, "-t", "cf:1.11", "-f", "json", "-o", str(out), str(files[name])], capture_output=True)
    report = next(iter(json.loads(out.read_text()).values()))
    found = [
        f"{part['name']}: {message}"
        for level in ("high_priorities", "medium_priorities")
        for part in report[level]
        for message in part["msgs"]
    ]
    assert found == []
