"""A study tells a limit kept by a bound where that decides, and never compares the bound with numbers."""

import numpy as np
import pytest

import trackroller as tr
from trackroller.damage.first_limit import STATES
from trackroller.errors import InputError
from trackroller.study.outputs import outputs

OUTPUTS = ["forces", "contact", "peak_stress", "life", "limits"]
FACTORS = {"roller_profile_radius": {"values": [-6.2, -7.5]}, "radial_force": {"values": [-60, -150, -900]}}
BASE = {"motor_force": 0, "axial_force": 0, "roller_material": "PA6", "guide_material": "1.7225-quenched-tempered"}


def solved(place, **keys):
    study = {"name": "bounds", "base": BASE, "factors": FACTORS, "contact_model": "sliding", "accuracy": "preview"}
    return tr.run({**study, "outputs": OUTPUTS, **keys}, results=place, progress=False)


@pytest.fixture(scope="module")
def bounded(tmp_path_factory):
    return solved(tmp_path_factory.mktemp("bounded"))


def test_a_study_has_bounds_in_place_of_numbers_of_kept_limits(bounded, tmp_path):
    numbers = solved(tmp_path, outputs=[*OUTPUTS, "shakedown"]).data
    data = bounded.data
    most = data.utilisation_at_most.sel(limit="shakedown")
    state = data.limit_state.sel(limit="shakedown")
    known = most.notnull()
    assert known.sel(body="guide").any() and not known.sel(body="roller").all()
    assert (state.where(known, STATES.index("kept")) == STATES.index("kept")).all()
    assert (state == numbers.limit_state.sel(limit="shakedown")).all()
    used = numbers.utilisation.sel(limit="shakedown")
    assert "utilisation_at_most" not in numbers and (most < 1.0).where(known, True).all()
    assert (used < most).where(known, True).all()
    np.testing.assert_array_equal(data.utilisation.sel(limit="shakedown"), used.where(~known))
    assert data.utilisation_at_most.drop_sel(limit="shakedown").isnull().all()


def test_a_bounded_limit_counts_as_checked_and_exceeded_ones_have_numbers(bounded):
    assert not any(word.startswith("shakedown") for words in bounded.answer.not_checked.values() for word in words)
    exceeded = bounded.data.limit_state.sel(limit="shakedown") == STATES.index("exceeded")
    assert exceeded.any() and (bounded.data.utilisation.sel(limit="shakedown") > 1.0).where(exceeded, True).all()


def test_a_bound_is_refused_as_a_number_with_a_remedy_that_works(bounded, tmp_path):
    name = "utilisation_guide_shakedown"
    with pytest.raises(InputError, match=r"known as a bound alone.*Add shakedown to outputs"):
        outputs(bounded.data, FACTORS, [name])
    again = solved(tmp_path, outputs=[*OUTPUTS, "shakedown"])
    assert np.isfinite(outputs(again.data, FACTORS, [name])[0].values).all()


def test_a_utilisation_that_the_study_names_has_its_number(tmp_path):
    results = solved(tmp_path, constraints=["utilisation_guide_shakedown < 0.8"])
    assert "utilisation_at_most" not in results.data
    assert results.data.utilisation.sel(limit="shakedown").notnull().all()
