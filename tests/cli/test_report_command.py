"""`trackroller run --report` and `trackroller report` make the same page without a workflow."""

from __future__ import annotations

import html
from pathlib import Path

import pytest
from typer.testing import CliRunner

from trackroller.cli.main import app
from trackroller.errors import InputError
from trackroller.materials import load_database
from trackroller.study.store.crate import damaged_files

STUDY = """
name: reported
base: {motor_force: 0}
factors:
  friction_coefficient: {values: [0.1, 0.2, 0.3]}
  axial_force: {values: [0, 15, 30]}
outputs: [forces, contact, peak_stress, life]
contact_model: sliding
accuracy: preview
"""


@pytest.fixture(scope="module")
def place(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("reported")
    (folder / "study.yaml").write_text(STUDY)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        done = CliRunner().invoke(app, ["run", "study.yaml", "-q", "--report"])
    assert done.exit_code == 0, done.output
    assert "results/reported/report.html" in done.output
    return folder


@pytest.mark.slow
def test_a_run_with_report_writes_analysis_figures_and_page(place):
    folder = place / "results" / "reported"
    assert {"study.nc", "sensitivity.nc", "figures", "report.html"} <= {p.name for p in folder.iterdir()}
    assert damaged_files(folder) == {}


def test_materials_stand_in_the_report_with_their_sources(place):
    page = (place / "results" / "reported" / "report.html").read_text(encoding="utf-8")
    steel = load_database().material("1.7225-normalised")
    source = steel.records["tensile_strength"].source
    table = page[page.index("<h3>Materials") :]
    assert source and source in html.unescape(table[: table.index("</table>")])


@pytest.mark.slow
def test_the_report_of_a_study_can_be_made_again(place, monkeypatch):
    monkeypatch.chdir(place)
    page = place / "results" / "reported" / "report.html"
    page.unlink()
    done = CliRunner().invoke(app, ["report", "reported"])
    assert done.exit_code == 0 and "<html" in page.read_text(encoding="utf-8")


def test_a_report_needs_a_study_that_was_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "study.yaml").write_text(STUDY)
    done = CliRunner().invoke(app, ["report", "study.yaml"])
    assert isinstance(done.exception, InputError) and "Run the study" in str(done.exception)
