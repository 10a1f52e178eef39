"""Cubic splines through fields are those of SciPy."""

import numpy as np
import pytest
from scipy.interpolate import BSpline, make_interp_spline

from trackroller.numerics.splines import _derivatives, interpolated


@pytest.mark.parametrize(
    ("ny", "nx", "along", "across"), [(20, 28, 3, 3), (5, 90, 6, 2), (80, 7, 1, 1.6), (4, 112, 3, 3)]
)
def test_fields_between_their_points_are_those_of_scipy(ny, nx, along, across):
    """They are those of SciPy along one axis after the other."""
    fields = np.random.default_rng(ny).normal(size=(2, 3, ny, nx))
    expected = fields
    for axis, (count, parts) in enumerate(((ny, along), (nx, across)), start=2):
        points = np.clip((np.arange(parts * count) + 0.5) / parts - 0.5, 0.0, count - 1.0)
        expected = make_interp_spline(np.arange(count), expected, axis=axis)(points)
    np.testing.assert_allclose(interpolated(fields, across, along), expected, atol=1e-13)


@pytest.mark.parametrize("count", [4, 5, 6, 20, 112])
def test_splines_between_knots_have_the_bits_of_scipy(count):
    knots = make_interp_spline(np.arange(count), np.zeros(count), k=3).t
    four = np.arange(count - 3)[:, None] + np.arange(4)
    for order in range(4):
        every = BSpline(knots, np.eye(count), 3)(knots[3:count], order)
        own = _derivatives(knots, np.arange(3, count), order)
        np.testing.assert_array_equal(own, np.take_along_axis(every, four, axis=1))
