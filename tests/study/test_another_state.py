"""Results that another state of the program made are solved again whole, or refused in a sentence that says so."""

from __future__ import annotations

import warnings
from pathlib import Path

import fake_solver
import numpy as np
import pytest
import xarray as xr
import yaml
from test_edits import STUDY, command

import trackroller as tr
from trackroller.study.file.load import load_study
from trackroller.study.run import run_study
from trackroller.study.store import program_digest

ROOT = Path("results/edited")


@pytest.fixture
def stored(tmp_path, monkeypatch):
    """Solve a study in a working folder, and let the solver have another digest afterwards."""
    monkeypatch.chdir(tmp_path)
    Path("study.yaml").write_text(STUDY)
    run_study(load_study("study.yaml"), solver=fake_solver.solve)
    data = xr.load_dataset(ROOT / "study.nc")
    monkeypatch.setattr(program_digest, "BY_VALUE", ())  # the materials' file counts too: another digest of the solver
    program_digest.solver_digest.cache_clear()
    yield data
    monkeypatch.undo()
    program_digest.solver_digest.cache_clear()


def test_results_of_another_solver_say_so_and_are_solved_again_whole(stored):
    with pytest.warns(UserWarning, match=r"Another version of the solver .*`trackroller run`"):
        opened = tr.open_study(ROOT)
    np.testing.assert_array_equal(opened.data["normal_force"], stored["normal_force"])
    code, out, _ = command(("status", "edited"))
    assert code == 0 and "0 done, 12 missing" in out and "another version of the solver" in out
    code, _, err = command(("repeat", "edited", "3"))
    assert code == 1 and "not solved" in err
    run_study(load_study("study.yaml"), solver=lambda design, **options: fake_solver.solve(design) + 1.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        again = tr.open_study(ROOT).data
    np.testing.assert_allclose(again["normal_force"], stored["normal_force"] + 1.0, rtol=1e-12)


@pytest.mark.parametrize("number", [None, 999])
def test_another_format_is_refused(stored, number):
    attrs = {key: value for key, value in stored.attrs.items() if key != "store_format"}
    if number is not None:
        attrs["store_format"] = number
    stored.attrs = attrs
    with pytest.raises(tr.InputError, match=r"study\.nc of edited.*format.*another version.*Run the study again"):
        tr.open_study(stored)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"grown_from": [4]}, "does not read.*grown_from"),
        ({"samples": None}, "has another samples|does not read.*samples"),
    ],
)
@pytest.mark.filterwarnings("ignore:Another version of the solver")
def test_a_stored_study_file_with_other_keys_is_refused(stored, change, words):
    """A key that is not there, and a key that lacks."""
    written = yaml.safe_load(stored.attrs["study"]) | change
    text = yaml.safe_dump({key: value for key, value in written.items() if value is not None}, sort_keys=False)
    with pytest.raises(tr.InputError, match=f"(?s)study = 'edited'.*({words}).*Run the study again"):
        tr.open_study(stored.assign_attrs(study=text))
