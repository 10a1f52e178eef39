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
    "grid": "method: grid\nfactors: {friction_coefficient: {values: [0.1, 0.2]}, axial_force: {values: [0, 15, 30]}}\n",
    "sample": "method: lhs\nsamples: 12\nfactors: {friction_coefficient: {uniform: [0.1, 0.3]}}\n",
}
SPECTRUM = """
contact_model: sliding
base: {motor_force: 0, guide_overrollings_per_hour: 10}
blocks: [{distance: 100, radial_force: -50, axial_force: 0}]
"""


@pytest.fixture(scope="module")
def files(tmp_path_factory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("cf")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setattr("trackroller.report.figures.study.draw_all", lambda *_: [])  # figures are no netCDF files
        for name, text in STUDIES.items():
            Path(f"{name}.yaml").write_text(
                f"name: {name}\nbase: {{motor_force: 0}}\ncontact_model: sliding\naccuracy: preview\n{text}"
            )
            assert CliRunner().invoke(app, ["run", f"{name}.yaml", "-q", "--report"]).exit_code == 0
        Path("shift.yaml").write_text(SPECTRUM)
        assert CliRunner().invoke(app, ["spectrum", "shift.yaml", "-o", "shift.nc"]).exit_code == 0
        assert CliRunner().invoke(app, ["solve", "--set", "contact_model=sliding", "-o", "case.nc"]).exit_code == 0
    found = {
        f"{s}-{f}": folder / "results" / s / f"{f}.nc" for s in STUDIES for f in ("design", "study", "sensitivity")
    }
    chunk = next((folder / "results" / "grid" / "chunks").glob("*.nc"))
    return found | {"chunk": chunk, "spectrum": folder / "shift.nc", "case": folder / "case.nc"}


@pytest.fixture(scope="module")
def reports(files, tmp_path_factory) -> dict[str, dict]:
    """Return the checker's report on each file; one process checks all files, because its start takes the most time."""
    folder = tmp_path_factory.mktemp("checked")
    command = [sys.executable, "-m", "compliance_checker.runner"]
    script = Path(sys.executable).parent / "compliance-checker"
    command = [str(script)] if script.exists() else command
    out = {name: folder / f"{name}.json" for name in files}
    for path in out.values():
        command += ["-o", str(path)]
    subprocess.run([*command, "-t", "cf:1.11", "-f", "json", *map(str, files.values())], capture_output=True)
    told = {name: next(iter(json.loads(path.read_text()).values())) for name, path in out.items()}
    assert {name: report["source_name"] for name, report in told.items()} == {n: str(p) for n, p in files.items()}
    return told


@pytest.mark.long
@pytest.mark.parametrize(
    "name",
    [*(f"{s}-{f}" for s in STUDIES for f in ("design", "study", "sensitivity")), "chunk", "spectrum", "case"],
)
def test_a_file_has_no_error_of_the_convention(reports, name):
    report = reports[name]
    found = [
        f"{part['name']}: {message}"
        for level in ("high_priorities", "medium_priorities")
        for part in report[level]
        for message in part["msgs"]
    ]
    assert found == []
