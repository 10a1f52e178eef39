"""Fits beside the materials file: the life of a case and the targets of a study carry the band of the tests."""

from __future__ import annotations

import shutil

import numpy as np
import pytest
import xarray as xr
from limit_rows import limit_row, part_of

import trackroller as tr
from trackroller.errors import InputError
from trackroller.fit.stored import stored_fit
from trackroller.materials import load_database
from trackroller.materials.file import find_user_file, posterior_path
from trackroller.results.roller_answer import answer_of_roller, beyond_tests
from trackroller.study.file.load import parse_study
from trackroller.study.run import run_study
from trackroller.study.store.folder import StudyFolder
from trackroller.study.store.input_files import study_of_folder

RIG = {"motor_force": 0, "friction_coefficient": 0.1, "axial_force": 20}


def test_the_stored_fit_gives_the_intervals_of_the_fit(rig):
    found = stored_fit("rig steel", vars(load_database().material("rig steel")))
    assert tuple(found.cycles(430.0, 0.1)) == pytest.approx(
        tuple(rig.interval("cycles", amplitude=430.0, failure_probability=0.1)), rel=1e-6
    )


def test_a_fit_of_another_version_is_refused_in_one_sentence(rig):
    values = vars(load_database().material("rig steel"))
    path = posterior_path(find_user_file(), "rig steel")
    with xr.open_dataset(path) as opened:
        stored = opened.load()
    del stored.attrs["fatigue_knee"]
    path.unlink()
    stored.to_netcdf(path)
    with pytest.raises(InputError, match=r"is that of another version.*Fit the tests again\.$"):
        stored_fit("rig steel", values)


def test_a_material_that_was_changed_by_hand_has_no_fit(rig):
    values = load_database().material("rig steel").as_dict()
    assert stored_fit("rig steel", values | {"fatigue_strength_ratio": 0.3}) is None


def test_the_sheet_states_the_band_beside_the_life_and_the_extrapolation(rig):
    """Margins and lives carry the intervals of the fit; live page and sheet show these rows."""
    case = RIG | {"roller_material": "rig steel"}
    near, far = (
        tr.solve(case | {"radial_force": force}, contact_model="sliding", outputs=("forces", "life", "limits"))
        for force in (-160, -60)
    )
    assert beyond_tests(near) == []
    (said,) = beyond_tests(far)
    assert said.startswith("life of the roller: ") and "tests from" in said
    for ds, force, beyond in ((near, -160, False), (far, -60, True)):
        answer = answer_of_roller(ds)
        lives = part_of(answer, "lives")
        rows = lives[lives["basis"] == "90 % by the 6 tests of rig steel"]
        assert rows["probability"].tolist() == [0.1, 0.5]
        stress = float(tr.solve(case | {"radial_force": force}, contact_model="sliding").peak_stress[:, 0].max())
        per_hour = float((ds["life_cycles"] / ds["life_hours"]).sel(body="roller").max())
        for row in rows.itertuples():
            ends = rig.interval("cycles", amplitude=stress, failure_probability=row.probability)
            low, high = (end / per_hour for end in ends)
            assert (row.low, row.high) == pytest.approx((low, high))
            assert (row.extrapolated == "yes") == beyond
        fatigue = limit_row(answer, "fatigue", "roller")
        assert (fatigue["low"], fatigue["high"]) == pytest.approx((low, high))  # of the median
        assert (answer.headline["low"], answer.headline["high"]) == pytest.approx((low, high))
        assert answer.headline["extrapolated"] == beyond


def test_the_sheet_refuses_values_of_another_contact_model(rig):
    said = beyond_tests(tr.solve(RIG | {"roller_material": "rig steel"}, contact_model="kalker_table"))
    assert said == [
        "The values of rig steel hold for contact_model sliding alone: solve with it, or fit the tests anew."
    ]


def study(**more):
    return {
        "name": "meets",
        "base": {"motor_force": 0, "axial_force": 20, "roller_material": "rig steel"},
        "factors": {"radial_force": {"uniform": [-180, -120]}, "friction_coefficient": {"uniform": [0.05, 0.2]}},
        "method": "sobol",
        "samples": 64,
        "contact_model": "sliding",
        "analysis": {"material_scatter": "fitted", "target": {"roller_life_hours": {"min": 15}}},
    } | more


@pytest.mark.slow
def test_a_target_carries_the_band_of_the_tests(rig):
    found = tr.run(study(), progress=False).indices()
    low, middle, high = (float(found[n].squeeze()) for n in ("tests_low", "target_probability", "tests_high"))
    assert 0.0 <= low < middle < high <= 1.0
    assert found["tests_low"].attrs["tests"] == "6"
    assert high - low > 0.1


@pytest.mark.slow
def test_a_study_without_a_fitted_material_is_refused(rig):
    base = {"motor_force": 0, "axial_force": 20}
    with pytest.raises(tr.InputError, match=r"material_scatter = 'fitted'.*a material that `trackroller fit` wrote"):
        tr.run(study(base=base), progress=False).indices()


@pytest.mark.slow
def test_a_study_with_another_contact_model_is_refused(rig):
    with pytest.raises(tr.InputError, match="contact_model = 'kalker_table' differs from the sliding"):
        tr.run(study(contact_model="kalker_table"), progress=False).indices()


def test_bands_widen_with_fewer_tests(rig):
    rows = [row | {"test": str(i)} for i, row in enumerate(rig.tests.rows * 4)]
    many = tr.fit_bench(rows, base=RIG | {"contact_model": "sliding"})
    wide, narrow = (np.diff(np.log(fit.interval("fatigue_strength")))[0] for fit in (rig, many))
    assert narrow < 0.6 * wide


def test_a_study_keeps_the_fits_of_its_materials(rig, tmp_path, monkeypatch):
    """The folder of a study, copied to where nothing was fitted, has the same range of lives by tests."""
    first = tr.run(study(factors={"radial_force": {"values": [-180, -120]}}), progress=False, results=tmp_path / "here")
    assert (tmp_path / "here" / "meets" / "inputs" / "fits" / "rig-steel.nc").is_file()
    monkeypatch.delenv("TRACKROLLER_MATERIALS")
    there = shutil.copytree(tmp_path / "here" / "meets", tmp_path / "there")
    moved = tr.open_study(there)
    assert moved.by_tests.fits["rig steel"].rows == len(rig.tests)
    low, high = (moved.by_tests.ends("roller", 0.5)[end] for end in (0, 1))
    assert np.all(low < high)
    np.testing.assert_array_equal(low, first.by_tests.ends("roller", 0.5)[0])
    again = run_study(study_of_folder(StudyFolder(there)), tmp_path / "again")
    assert tr.open_study(again.folder.root).by_tests.fits.keys() == {"rig steel"}
    assert tr.open_study(moved.data).by_tests is None, "a data set alone has no fits"


@pytest.mark.parametrize("design", [{"method": "grid"}, {"method": "morris"}])
def test_a_design_without_random_rows_takes_no_scatter_of_a_fit(rig, design):
    given = {"values": [-180, -120]} if design["method"] == "grid" else {"uniform": [-180, -120]}
    with pytest.raises(tr.InputError, match=r"analysis\.material_scatter = 'fitted'.*a random sample"):
        parse_study(study(factors={"radial_force": given}, **design))


def test_a_stored_fit_with_other_values_is_refused(rig):
    """A file of a fit that lacks what this version reads is refused, and the tests are to be fitted again."""
    values = vars(load_database().material("rig steel"))
    path = posterior_path(find_user_file(), "rig steel")
    with xr.open_dataset(path) as opened:
        data = opened.load()
    del data.attrs["tested_cycles"]
    data.to_netcdf(path)
    with pytest.raises(tr.InputError, match=r"it has no tested_cycles.*Fit the tests again"):
        stored_fit("rig steel", values)
