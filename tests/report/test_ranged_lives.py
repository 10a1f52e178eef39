"""What a report says of lives that are ranges, against the raw rows of small studies."""

import numpy as np
import pytest

import trackroller as tr
from trackroller.report.numbers import chance

BASE = {
    "motor_force": 0,
    "axial_force": 3,
    "guide_curve_radius": np.inf,
    "guide_overrollings_per_hour": 60,
    "permissible_wear_depth": 0.1,
    "contact_angle": 40,
    "velocity": 40,
    "guide_material": "C45",
}
STUDY = {
    "name": "ranges",
    "base": BASE,
    "factors": {
        "roller_material": {"values": ["42CrMo4+QT-40", "PA6-dry"]},
        "roller_profile_radius": {"values": [-6.3, -6.8]},
        "friction_coefficient": {"values": [0.1, 0.25]},
        "radial_force": {"values": [-20, -45]},
    },
    "contact_model": "sliding",
}


@pytest.fixture(scope="module")
def solved():
    """A study with a target, where steel may or may not meet it, by its wear coefficient."""
    return tr.run(STUDY | {"analysis": {"target": {"min": 400}}}, progress=False)


def test_a_chance_has_no_figures_that_no_sample_shows():
    """Nearer to always or never than one in ten thousand, a bound stands; always and never stay exact."""
    assert chance(0.9999996, 0.86, 1.0) == "over 99.99 % (86 % to 100 %)"
    assert (
        chance(1e-7) == "below 0.01 %"
        and chance(1.0) == "100 %"
        and chance(0.0) == "0 %"
        and chance(0.9994) == "99.94 %"
    )
