"""Rolling radius, curvatures and lever arms of the publication's example; geometries without point contact."""

import math

import numpy as np
import pytest

from trackroller.roller.geometry import contact_geometry, geometry_problem, lever_arms

EXAMPLE = {
    "axis_distance": 21.75,
    "guide_profile_radius": 6.0,
    "roller_profile_radius": -7.0,
    "guide_curve_radius": 220.0,
    "contact_angle": 30.0,
}
COSINE = math.cos(math.radians(30.0))


def test_geometry_of_the_example():
    """r_A = A_T - r_C,G cos(alpha); k_x = 1/r_C,TR + 1/r_C,G; k_y = cos(alpha) (1/r_A + 1/r_Curve)."""
    found = contact_geometry(EXAMPLE)
    assert found.rolling_radius == pytest.approx(16.553847577293366, rel=1e-14)
    assert found.curvature_lateral == pytest.approx(1 / 6 - 1 / 7, rel=1e-14)
    assert found.curvature_rolling == pytest.approx(COSINE * (1 / 16.553847577293366 + 1 / 220), rel=1e-14)
    arms = lever_arms(21.75, 6.0, math.radians(30.0))
    assert arms == pytest.approx((10.875, 21.75 * COSINE - 6.0), rel=1e-14)


@pytest.mark.parametrize(
    ("change", "field", "limit"),
    [
        ({"axis_distance": 5.0}, "axis_distance", "above 5.19615 mm"),
        ({"roller_profile_radius": -5.9}, "roller_profile_radius", "below -6 mm"),
        ({"guide_curve_radius": -16.0}, "guide_curve_radius", "below -16.5538 mm"),
    ],
)
def test_a_contradiction_names_the_field_and_its_limit(change, field, limit):
    columns = {name: np.array([value, change.get(name, value)]) for name, value in EXAMPLE.items()}
    problem = geometry_problem(columns)
    assert problem is not None and problem.field == field and problem.value == change[field]
    assert limit in problem.remedy
    assert geometry_problem(EXAMPLE) is None
