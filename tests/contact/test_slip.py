"""Eqs (20)-(25) against the paper's own lines, written out here a second time."""

import math

import numpy as np
import pytest
from numba import njit

from trackroller.contact.quantities import Ellipse
from trackroller.contact.sliding import slip_field
from trackroller.contact.slip import (
    Slip,
    lateral_slip,
    pole_lateral,
    pole_line,
    pole_offset,
    pole_rolling,
    profile_slip,
    rolling_slip,
    slip_zeros,
)
from trackroller.halfspace.rigid_slip import rolling_slip_without_division

R, A, B = 6.0, 0.4, 0.25
ANGLES = [0.35, 0.9, -0.35, -0.9]  # contact 1, contact 2
X = np.linspace(-A, A, 17)


def published_rolling(x, alpha, shift):
    """Return v_y/omega of eq. (21), with the product under the root that the paper prints as a difference."""
    return math.sqrt(R**2 - (x * math.cos(alpha) + R * math.sin(alpha)) ** 2) - R * math.cos(alpha) + shift


def published_delta(x, x_spin, y_spin):
    """Return y_delta of eq. (25)."""
    if x < x_spin:
        return (x + A) / (x_spin + A) * y_spin
    return (x - A) / (x_spin - A) * y_spin


@pytest.mark.parametrize("alpha", ANGLES)
def test_rolling_slip_is_that_of_the_paper(alpha):
    for shift in (-0.1, 0.0, 0.03):
        expected = [published_rolling(x, alpha, shift) for x in X]
        for form in (rolling_slip, rolling_slip_without_division):
            found = form(X, math.sin(alpha), math.cos(alpha), R, shift)
            np.testing.assert_allclose(found, expected, rtol=0, atol=4e-15)
    np.testing.assert_array_equal(
        profile_slip(X, math.sin(alpha), math.cos(alpha), R), rolling_slip(X, math.sin(alpha), math.cos(alpha), R, 0.0)
    )


def test_rolling_slip_does_not_cancel_at_small_x():
    """Near x = 0 eq. (20) is -x sin - x^2/(2 r cos) to the third order: ten digits at x = 1e-6 r."""
    alpha, x = 0.6, 1e-6 * R
    series = -x * math.tan(alpha) * math.cos(alpha) - x * x / (2.0 * R * math.cos(alpha))
    assert profile_slip(x, math.sin(alpha), math.cos(alpha), R) == pytest.approx(series, rel=1e-11)


def test_slip_beyond_the_equator_is_that_of_the_equator():
    alpha = 1.2
    beyond = R * (1.0 - math.sin(alpha)) / math.cos(alpha) + 0.5
    assert profile_slip(beyond, math.sin(alpha), math.cos(alpha), R) == pytest.approx(-R * math.cos(alpha), rel=1e-14)


@pytest.mark.parametrize("alpha", ANGLES)
@pytest.mark.parametrize("share", [-0.7, 0.0, 0.4])
def test_spin_pole_and_its_line_are_those_of_the_paper(alpha, share):
    x_spin = pole_lateral(share * A * math.sin(alpha), math.sin(alpha))
    assert x_spin == pytest.approx(share * A)
    y_spin = pole_rolling(x_spin, A, B)
    assert y_spin == pytest.approx(-B * math.sqrt(1.0 - share**2), rel=1e-14)
    x = X[np.abs(X - x_spin) > 1e-9]
    skewed = [published_delta(v, x_spin, y_spin) for v in x]
    for model, expected in ((0, np.zeros_like(x)), (1, np.full_like(x, y_spin)), (2, skewed)):
        found = pole_offset(x, A, *pole_line(A, x_spin, y_spin, model))
        np.testing.assert_allclose(found, expected, atol=1e-15)


@pytest.mark.parametrize("x_spin", [A, -A, 1.5 * A, -3.0 * A, np.inf])
def test_a_pole_outside_the_patch_has_no_offset(x_spin):
    assert pole_rolling(x_spin, A, B) == 0.0
    for model in (0, 1, 2):
        np.testing.assert_array_equal(pole_offset(X, A, *pole_line(A, x_spin, 0.0, model)), 0.0)


@pytest.mark.parametrize("alpha", ANGLES)
def test_the_slip_vanishes_at_its_zeros(alpha):
    for shift in (-0.2, 0.05, 0.3):
        for zero in slip_zeros(math.sin(alpha), math.cos(alpha), R, shift):
            if not math.isnan(zero):
                assert published_rolling(zero, alpha, shift) == pytest.approx(0.0, abs=1e-13)
    with np.errstate(invalid="ignore"):
        none = slip_zeros(math.sin(alpha), math.cos(alpha), R, -2.0 * R)
    assert np.isnan(none).all()


def test_the_field_is_eq_24_over_the_travel_speed():
    alpha, shift, r_a = 0.6, -0.1, 16.0
    one = np.ones(1)
    slip = Slip(math.sin(alpha) * one, math.cos(alpha) * one, R * one, r_a * one, shift * one)
    x, y = np.array([[0.1, -0.3]]), np.array([[0.05, -0.1]])
    found = slip_field(Ellipse(A * one, B * one, one), slip, x, y)
    x_spin = shift / math.sin(alpha)
    y_spin = -B * math.sqrt(1.0 - (x_spin / A) ** 2)
    for k in range(2):
        v_x = math.sin(alpha) * (y[0, k] - published_delta(x[0, k], x_spin, y_spin))
        assert found[0][0, k] == pytest.approx(v_x / r_a, rel=1e-13)
        assert found[1][0, k] == pytest.approx(published_rolling(x[0, k], alpha, shift) / r_a, rel=1e-12)


def test_compiled_formulas_give_the_digits_of_plain_python():
    @njit
    def compiled(x, sine, cosine, radius, shift, a, b):
        x_spin = pole_lateral(shift, sine)
        k0, k1, k2 = pole_line(a, x_spin, pole_rolling(x_spin, a, b), 2)
        near, far = slip_zeros(sine, cosine, radius, shift)
        v_x = lateral_slip(0.1, pole_offset(x, a, k0, k1, k2), sine)
        return rolling_slip(x, sine, cosine, radius, shift), v_x, near, far

    for alpha in ANGLES:
        given = (0.13, math.sin(alpha), math.cos(alpha), R, 0.05, A, B)
        assert compiled(*given) == pytest.approx(compiled.py_func(*given), rel=1e-15)
