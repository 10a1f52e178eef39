"""A study that keeps bounds of utilisations: killed, repeated, searched, with a requirement, and in all its files."""

from __future__ import annotations

import multiprocessing
import os
import signal
from pathlib import Path
from typing import Any

import numpy as np
import openpyxl
import pytest
import xarray as xr
import yaml
from typer.testing import CliRunner

import trackroller as tr
from trackroller.cli.main import app
from trackroller.damage.first_limit import AT_MOST, STATES
from trackroller.report.workbook import write_results
from trackroller.study.file.load import parse_study
from trackroller.study.run import run_study

STUDY: dict[str, Any] = {
    "name": "bounds",
    "base": {"motor_force": 0, "roller_material": "PA6", "guide_material": "1.7225-quenched-tempered"},
    "factors": {
        "roller_profile_radius": {"values": [-6.2, -7.5]},
        "radial_force": {"values": [-60, -150, -900]},
        "axial_force": {"values": [0, 10]},
    },
    "contact_model": "sliding",
    "accuracy": "preview",
    "outputs": ["forces", "contact", "peak_stress", "life", "limits"],
    "requirement": {"max_pressure": {"max": 600}},
    "chunk_size": 4,
}


def counted_solver(kill: int):
    """Return a solver that kills its process at the call of this number; 0 never."""
    calls = []

    def solve(*given: Any, **options: Any) -> xr.Dataset:
        calls.append(1)
        if len(calls) == kill:
            os.kill(os.getpid(), signal.SIGKILL)
        return tr.solve(*given, **options)

    return solve


def run_apart(place: Path, kill: int) -> int:
    """Run the study in a fork of this process, and return its exit code."""

    def run() -> None:
        run_study(parse_study(STUDY), place, solver=counted_solver(kill))

    child = multiprocessing.get_context("fork").Process(target=run)
    child.start()
    child.join(240)
    return int(child.exitcode or 0)


@pytest.fixture(scope="module")
def home(tmp_path_factory) -> Path:
    """Return a folder with the study file and its results."""
    folder = tmp_path_factory.mktemp("home")
    (folder / "study.yaml").write_text(yaml.safe_dump(STUDY, sort_keys=False), encoding="utf-8")
    command(folder, "run", "study.yaml", "-q")
    return folder


def command(folder: Path, *words: str) -> str:
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        done = CliRunner().invoke(app, list(words))
    assert done.exit_code == 0, done.output
    return done.output


def bounds_of(data: xr.Dataset) -> xr.DataArray:
    return data[AT_MOST].sel(limit="shakedown")


def test_a_killed_study_goes_on_with_the_same_bits(home, tmp_path):
    assert run_apart(tmp_path, 2) == -signal.SIGKILL
    assert not (tmp_path / "bounds" / "study.nc").exists()
    assert run_apart(tmp_path, 0) == 0
    whole, killed = (xr.load_dataset(place / "bounds" / "study.nc") for place in (home / "results", tmp_path))
    assert bounds_of(whole).notnull().any() and not bounds_of(whole).notnull().all()
    for name in whole.data_vars:
        np.testing.assert_array_equal(killed[name].values, whole[name].values, err_msg=name)


def test_a_study_with_bounds_is_verified_and_repeated(home):
    assert "files are as they were written" in command(home, "verify", "bounds")
    assert "variables have the same values" in command(home, "rerun", "results/bounds", "--results", "again")
    first, again = (xr.load_dataset(home / place / "bounds" / "study.nc") for place in ("results", "again"))
    np.testing.assert_array_equal(bounds_of(first).values, bounds_of(again).values)


def test_one_case_of_the_study_has_the_number(home):
    """A single roller is told the number where its row has the bound, with the same state."""
    data = tr.open_study(home / "results" / "bounds").data
    row = {"roller_profile_radius": -7.5, "radial_force": -60.0, "axial_force": 10.0}
    own = data.sel(row)
    alone = tr.solve({**STUDY["base"], **row}, STUDY["outputs"], contact_model="sliding", accuracy="preview")
    most, used = bounds_of(own).sel(body="guide"), alone.utilisation.sel(limit="shakedown", body="guide")
    assert np.isnan(own.utilisation.sel(limit="shakedown", body="guide")) and float(used) < float(most) < 1.0
    states = [float(ds.limit_state.sel(limit="shakedown", body="guide")) for ds in (own, alone)]
    assert states == [STATES.index("kept")] * 2


def test_page_workbook_and_table_of_a_study_with_bounds(home):
    command(home, "report", "bounds")
    page = (home / "results" / "bounds" / "report.html").read_text(encoding="utf-8")
    assert "shakedown" in page
    results = tr.open_study(home / "results" / "bounds")
    write_results(results, home / "cases.xlsx")
    book = openpyxl.load_workbook(home / "cases.xlsx")
    cells = [str(cell.value) for sheet in book for row in sheet.iter_rows() for cell in row]
    assert any("shakedown" in cell for cell in cells)


@pytest.mark.slow
@pytest.mark.parametrize(
    "more", [{"method": "optimise"}, {"until": {"half_width": 0.3, "of": ["max_pressure"], "at_most": 64}}]
)
def test_a_search_and_a_growing_sample_keep_their_bounds(more, tmp_path):
    """Each row is told as in a list of cases; no limit is told kept that is exceeded."""
    fit = {"roller_profile_radius": {"uniform": [-9.0, -6.2]}, "radial_force": {"values": [-60, -400, -900]}}
    study = {name: value for name, value in STUDY.items() if name not in ("requirement", "chunk_size")}
    study |= {"factors": fit, "name": "search"} | more
    if "method" in more:
        study |= {"goals": {"pair_life_hours": "max"}, "budget": {"designs": 32}}
        study["base"] = study["base"] | {"guide_overrollings_per_hour": 600}
    else:
        fit["radial_force"] = {"uniform": [-900.0, -60.0]}
        study |= {"method": "sobol", "samples": 32}
    data = tr.run(study, results=tmp_path, progress=False).data
    rows = [
        {**study["base"], "roller_profile_radius": float(radius), "radial_force": float(force)}
        for radius, force in zip(data.roller_profile_radius.values, data.radial_force.values, strict=True)
    ]
    numbers = tr.solve(rows, [*STUDY["outputs"], "shakedown"], contact_model="sliding", accuracy="preview")
    used = numbers.utilisation.sel(limit="shakedown").values
    most = bounds_of(data).transpose("case", "body").values
    known = np.isfinite(most)
    assert known.any() and not known.all() and (used[known] < most[known]).all() and (most[known] < 1.0).all()
    own = data.utilisation.sel(limit="shakedown").transpose("case", "body").values
    np.testing.assert_array_equal(own, np.where(known, np.nan, used))
