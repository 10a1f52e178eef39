"""A study that an earlier version made: it is read and solved again elsewhere, and its folder stays as it is.

`tests/data/sealed_study.zip` holds `results/sealed`, as `trackroller run` wrote it for the study below. The tests read
it as a version with another solver.
"""

from __future__ import annotations

import shutil
from pathlib import Path

import fake_solver
import numpy as np
import pytest
import xarray as xr
from test_edits import STUDY as EDITED
from test_edits import command

import trackroller as tr
from trackroller.errors import InputError
from trackroller.study.file.load import load_study
from trackroller.study.run import run_study
from trackroller.study.store import sources
from trackroller.study.store.manifest import STORE_FORMAT

STORED = Path(__file__).parents[1] / "data" / "sealed_study.zip"
STUDY = EDITED.replace("name: edited", "name: sealed")


@pytest.fixture
def sealed(tmp_path, monkeypatch):
    """Return the stored study in a working folder, as a version with another solver sees it."""
    monkeypatch.chdir(tmp_path)
    shutil.unpack_archive(STORED, tmp_path)
    Path("study.yaml").write_text(STUDY)
    monkeypatch.setattr(sources, "BY_VALUE", ())  # the materials' file counts too: another digest of the solver
    sources.solver_digest.cache_clear()
    yield Path("results/sealed")
    monkeypatch.undo()
    sources.solver_digest.cache_clear()


def contents(root: Path) -> dict[Path, bytes]:
    return {path: path.read_bytes() for path in root.rglob("*") if path.is_file()}


def forces(root: Path) -> np.ndarray:
    return xr.load_dataset(root / "study.nc")["normal_force"].values


def fake_forces(root: Path) -> np.ndarray:
    return fake_solver.solve(xr.load_dataset(root / "design.nc"))["normal_force"].values


@pytest.mark.parametrize("words", [("run", "study.yaml"), ("report", "sealed"), ("status", "sealed")], ids=" ".join)
def test_the_folder_of_an_earlier_version_is_refused_and_the_remedy_works(sealed, words):
    before = contents(sealed)
    code, _, err = command(words)
    assert code == 2 and "another version of trackroller" in err and "Move the folder away" in err
    assert contents(sealed) == before
    sealed.rename("results/old")  # what the message says
    run_study(load_study("study.yaml"), solver=fake_solver.solve)
    np.testing.assert_array_equal(forces(sealed), fake_forces(sealed))
    assert not np.isclose(forces(sealed), forces(Path("results/old"))).any(), "every case is a new one"


@pytest.mark.slow
def test_a_study_of_another_solver_is_read_whole_and_says_so(sealed):
    before = contents(sealed)
    with pytest.warns(UserWarning, match=r"Another version of the solver .*`trackroller run`"):
        solved = tr.open_study(sealed)
    with pytest.warns(UserWarning, match=r"Ignored: analysis\.measures and analysis\.resamples, because"):
        assert tr.open_study(sealed).study.config.analysis.keep == ("rolling",)
    np.testing.assert_array_equal(solved.data["normal_force"].values, forces(sealed))
    with pytest.warns(UserWarning, match="Another version of the solver"):
        assert command(("explore", "results/sealed/study.nc", "-o", "explorer.html"))[0] == 0
    assert "Another version of the solver" in Path("explorer.html").read_text()
    assert command(("verify", "results/sealed"))[0] == 0 and contents(sealed) == before


@pytest.mark.slow
def test_rerun_solves_every_case_again_and_compares_what_is_stored(sealed):
    """The stored numbers come from the real solver: another version may differ by its accuracy and by its estimate.

    The residual is what rounding leaves of a balance, and may be any number below its limit.
    """
    before = forces(sealed)
    code, out, err = command(("rerun", "results/sealed", "--results", "again"))
    again = forces(Path("again/sealed"))
    np.testing.assert_allclose(again, before, rtol=1e-6)
    lines = [line for line in out.splitlines() if "differs by" in line]
    free = ("error_estimate", "residual:")
    differ = [float(line.split("by ")[1].split()[0]) for line in lines if not any(word in line for word in free)]
    assert xr.load_dataset("again/sealed/study.nc")["residual"].max() < 1e-10
    assert code == (1 if lines else 0) and max(differ, default=0.0) < 1e-6, out + err
    assert ("have the same values as" in out) == (not lines)
    assert "lacks them:" in out and "drive_torque" in out, "an output that this version adds is named"
    np.testing.assert_array_equal(forces(sealed), before)


def test_another_format_is_refused_by_name(sealed):
    data = xr.load_dataset(sealed / "study.nc")
    data.assign_attrs(store_format=STORE_FORMAT + 1).to_netcdf("study.nc")
    with pytest.raises(InputError, match=r"study\.nc of sealed.*format.*another version"):
        tr.open_study("study.nc")


def test_an_altered_result_of_an_earlier_version_is_named(sealed):
    shutil.copy(sealed / "design.nc", sealed / "study.nc")
    code, _, err = command(("best", "results/sealed"))
    assert code == 1 and "study.nc was altered" in err and "ro-crate-metadata.json" in err
