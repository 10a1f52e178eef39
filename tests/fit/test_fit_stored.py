"""Fits beside the materials file: the life of a case and the targets of a study carry the band of the tests."""

from __future__ import annotations

import numpy as np
import pytest

import trackroller as tr
from trackroller.fit.stored import stored_fit
from trackroller.materials import load_database
from trackroller.report.words.by_tests import by_tests

RIG = {"motor_force": 0, "friction_coefficient": 0.1, "axial_force": 20}
LOADS = (-200, -200, -180, -160, -160, -130)
KM = (12.0, 15.0, 30.0, 38.0, 50.0, 90.0)


@pytest.fixture
def rig(tmp_path, monkeypatch):
    """Return a fit of rollers whose material `rig steel` stands in the user's file."""
    file = tmp_path / "materials.yaml"
    columns = {"radial_force": LOADS, "travel_from": KM, "travel_to": KM, "end": ["fatigue roller"] * len(KM)}
    fit = tr.fit_bench(columns, base=RIG | {"contact_model": "sliding"}, name="rig steel")
    fit.write(file)
    monkeypatch.setenv("TRACKROLLER_MATERIALS", str(file))
    return fit


def test_the_stored_fit_gives_the_intervals_of_the_fit(rig):
    found = stored_fit("rig steel", vars(load_database().material("rig steel")))
    assert tuple(found.cycles(430.0, 0.1)) == pytest.approx(
        tuple(rig.interval("cycles", amplitude=430.0, failure_probability=0.1)), rel=1e-6
    )


def test_a_material_that_was_changed_by_hand_has_no_fit(rig):
    values = load_database().material("rig steel").as_dict()
    assert stored_fit("rig steel", values | {"fatigue_strength_ratio": 0.3}) is None


def test_the_sheet_states_the_band_and_the_extrapolation(rig):
    case = RIG | {"roller_material": "rig steel"}
    near, far = (by_tests(tr.solve(case | {"radial_force": force}, contact_model="sliding")) for force in (-160, -60))
    assert "by the 6 tests of rig steel: B50" in near[0]
    assert len(near) == 1
    assert "extrapolation" in far[1]


def test_the_sheet_refuses_values_of_another_contact_model(rig):
    said = by_tests(tr.solve(RIG | {"roller_material": "rig steel"}, contact_model="kalker_table"))
    assert said == [
        "The values of rig steel hold for contact_model sliding alone: solve with it, or fit the tests anew."
    ]


def study(**more):
    return {
        "name": "meets",
        "base": {"motor_force": 0, "axial_force": 20, "roller_material": "rig steel"},
        "factors": {"radial_force": {"uniform": [-180, -120]}, "friction_coefficient": {"uniform": [0.05, 0.2]}},
        "design": "sobol",
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
    columns = {"radial_force": LOADS * 4, "travel_from": KM * 4, "travel_to": KM * 4}
    columns |= {"end": ["fatigue roller"] * 24, "test": [str(i) for i in range(24)]}
    many = tr.fit_bench(columns, base=RIG | {"contact_model": "sliding"})
    wide, narrow = (np.diff(np.log(fit.interval("fatigue_strength")))[0] for fit in (rig, many))
    assert narrow < 0.6 * wide
