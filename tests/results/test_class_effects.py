"""Effects of thirds of a sample: told where the factor makes them, left out where other factors do by chance."""

import numpy as np
import pytest

import trackroller as tr
from trackroller.results.effects import class_effect

STUDY = {
    "name": "thirds", "design": "lhs", "samples": 120, "contact_model": "sliding", "accuracy": "preview",
    "outputs": ["forces", "peak_stress", "life"], "base": {"axial_force": 5, "guide_curve_radius": "inf"},
    "factors": {
        "radial_force": {"uniform": [-260, -80]}, "motor_force": {"uniform": [-3, 3]},
        "roller_profile_radius": {"uniform": [-7, -6.9]},
    },
}  # fmt: skip
LIFE = "roller_life_hours"


@pytest.mark.parametrize("seed", range(4))
def test_what_another_factor_makes_is_no_effect(seed):
    """Rows are picked so that motor forces go with radial forces: the classes differ, and motor force makes nothing."""
    results = tr.run(STUDY | {"seed": seed}, progress=False)
    x, y = (results.column(name) for name in ("motor_force", "radial_force"))
    lives = results.column(LIFE)
    picked = results.valid & ((x * (y - np.median(y)) > 0) | (np.arange(len(x)) % 2 == 0))
    low, high = np.quantile(x[picked], [1 / 3, 2 / 3])
    apart = np.median(lives[picked & (x >= high)]) / np.median(lives[picked & (x <= low)])
    assert apart > 1.5  # pooled classes differ by the radial forces
    none = class_effect(results, LIFE, "motor_force", picked)
    assert (
        none is None or none.interval[0] < 1 < none.interval[1]
    )  # the interval holds 1: no sentence tells such an effect
    own = class_effect(results, LIFE, "radial_force", picked)
    low, high = np.quantile(y[picked], [1 / 3, 2 / 3])
    between = np.median(lives[picked & (y >= high)]) / np.median(lives[picked & (y <= low)])
    assert own is not None and own.ratio == pytest.approx(between, rel=0.1) and own.ratio > 2
