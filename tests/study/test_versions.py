"""A study that an earlier version sealed: each command reads it whole, solves it again, or refuses it by name.

`tests/data/sealed_study.zip` holds `results/sealed`, as `trackroller run` wrote it for the study below. The tests read
it as a version with another solver, and with an unknown or missing format of the store.
"""

from __future__ import annotations

import contextlib
import json
import shutil
import warnings
from pathlib import Path

import fake_solver
import numpy as np
import pytest
import xarray as xr
from test_edits import STUDY as EDITED
from test_edits import command
from trackroller.study.store.digests import METADATA, record_digest
from trackroller.study.store.seal import sealing

import trackroller as tr
from trackroller.errors import InputError
from trackroller.study.file.load import load_study
from trackroller.study.run import run_study
from trackroller.study.store.folder import STORE_FORMAT, StudyFolder

STORED = Path(__file__).parents[1] / "data" / "sealed_study.zip"
STUDY = EDITED.replace("name: edited", "name: sealed")
FORMATS = {"missing": None, "unknown": STORE_FORMAT + 1}


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


@contextlib.contextmanager
def sealed_anew(path: Path):
    """Write a result with its record, and keep the description of the folder, which `sealing` removes."""
    description = path.parent / METADATA
    kept = description.read_bytes()
    with sealing(path) as beside:
        yield beside
    description.write_bytes(kept)


def rewrite(root: Path, number: int | None) -> None:
    """Give plan and results another format, sealed as the version that wrote them would have sealed them."""
    record = json.loads((root / "plan.json").read_text())
    record.pop("digest")
    with sealed_anew(root / "study.nc") as beside:
        data = xr.load_dataset(root / "study.nc")
        data.attrs |= {"store_format": number} if number else {}
        data.attrs = {key: value for key, value in data.attrs.items() if number or key != "store_format"}
        data.to_netcdf(beside)
    record = {k: v for k, v in record.items() if k != "store_format"} | ({"store_format": number} if number else {})
    (root / "plan.json").write_text(json.dumps({**record, "digest": record_digest(record)}))


def forces(root: Path) -> np.ndarray:
    return xr.load_dataset(root / "study.nc")["normal_force"].values


def fake_forces(root: Path) -> np.ndarray:
    return fake_solver.solve(xr.load_dataset(root / "design.nc"))["normal_force"].values


@pytest.mark.slow
@pytest.mark.parametrize("damage", [None, *FORMATS])
def test_a_study_of_an_earlier_version_is_solved_again_whole(sealed, damage):
    before, lines = forces(sealed), []
    if damage is not None:
        rewrite(sealed, FORMATS[damage])
    run_study(load_study("study.yaml"), solver=fake_solver.solve, tell=lines.append)
    np.testing.assert_array_equal(forces(sealed), fake_forces(sealed))
    assert not np.isclose(forces(sealed), before).any(), "every case is a new one"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert "notice" not in tr.open_study(sealed).data.attrs
    assert command(("status", "sealed"))[0] == 0


@pytest.mark.slow
def test_a_study_of_another_solver_is_read_whole_and_says_so(sealed):
    before = forces(sealed)
    with pytest.warns(UserWarning, match=r"Another version of the solver .*`trackroller run`"):
        solved = tr.open_study(sealed)
    with pytest.warns(UserWarning, match=r"Ignored: analysis\.measures and analysis\.resamples, because"):
        assert tr.open_study(sealed).study.config.analysis.keep == ("rolling",)
    np.testing.assert_array_equal(solved.data["normal_force"].values, before)
    for words, page in ((("report", "sealed"), "report.html"), (("explore", "results/sealed"), "explorer.html")):
        with pytest.warns(UserWarning, match="Another version of the solver"):
            assert command(words)[0] == 0
        assert "Another version of the solver" in (sealed / page).read_text()
    np.testing.assert_array_equal(forces(sealed), before)
    assert command(("verify", "results/sealed"))[0] == 0


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


@pytest.mark.slow
def test_rerun_names_each_variable_that_differs(sealed):
    with sealed_anew(sealed / "study.nc") as beside:
        data = xr.load_dataset(sealed / "study.nc")
        data["normal_force"] = data["normal_force"] * 1.01
        data["slip"][:1] = np.nan
        data["former_output"] = data["slip"]
        data.to_netcdf(beside)
    code, out, _ = command(("rerun", "results/sealed", "--results", "again"))
    assert code == 1 and "normal_force: differs by 3.5e-03 of the load" in out
    assert "slip: is missing now, or has other gaps" in out and "former_output: is missing now" in out


def test_what_needs_this_solver_says_what_is_missing(sealed):
    code, out, _ = command(("status", "sealed"))
    assert code == 0 and "0 done, 12 missing" in out and "another version of the solver" in out
    code, _, err = command(("repeat", "sealed", "3"))
    assert code == 1 and "not solved" in err
    code, out, err = command(("plan", "study.yaml"))
    assert code == 0 and "12, 0 of them solved" in out, err


@pytest.mark.parametrize("damage", FORMATS)
@pytest.mark.parametrize("words", ["status", "report", "plot", "repeat", "explore", "rerun", "open"])
def test_another_format_is_refused_by_name(sealed, damage, words):
    rewrite(sealed, FORMATS[damage])
    files = {path: path.read_bytes() for path in sealed.rglob("*") if path.is_file()}
    if words == "open":
        with pytest.raises(InputError, match=r"study\.nc of sealed.*format.*another version"):
            tr.open_study(sealed)
    else:
        study = "results/sealed" if words in ("explore", "rerun") else "sealed"
        code, _, err = command((words, study, *["3"] * (words == "repeat")))
        assert code in (1, 2) and ("plan.json" in err or "study.nc" in err) and "another version" in err, err
        assert "internal error" not in err
    kept = {path: path.read_bytes() for path in sealed.rglob("*") if path.is_file() and path in files}
    assert kept == files


def test_the_stored_study_is_as_it_was_sealed(sealed):
    assert command(("verify", "results/sealed"))[0] == 0
    assert StudyFolder(sealed).record()["size"] == 12, "its record is sound"
