"""Wear of roller and guide: depth, volume, travel until the groove has changed, life."""

import numpy as np
import pytest
from scipy.integrate import quad

from trackroller.contact.common import Ellipse
from trackroller.damage.wear import wear_depth


def test_depth_agrees_with_an_independent_quadrature_and_its_order():
    """Under Hertz's pressure, with slip that varies over the patch, at a place of its own."""
    a, b, p, k = 0.7, 0.4, 900.0, 3e-5
    errors = []
    for n in (14, 42, 126):  # x = 0.3571 a is the centre of an element of each grid
        x, y, pressure = (part[:, None] for part in Ellipse(*(np.array([v]) for v in (a, b, p))).grid(n))
        slip = np.hypot(0.002 + 0.01 * x[..., None, :], 0.02 * y[..., :, None] - 0.004)
        depth = wear_depth(pressure, slip, y[..., 1] - y[..., 0], np.array([k]))[0, 0]
        place = int(np.argmin(abs(x[0, 0] - 5 / 14 * a)))
        at, end = x[0, 0, place], b * np.sqrt(1 - (x[0, 0, place] / a) ** 2)

        def work(y, at=at):
            root = np.sqrt(1 - (at / a) ** 2 - (y / b) ** 2)
            return p * root * np.hypot(0.002 + 0.01 * at, 0.02 * y - 0.004)

        exact = 1e-3 * k * quad(work, -end, end, points=[0.2])[0]
        errors.append(abs(depth[place] / exact - 1))
    assert errors[0] < 0.02 and errors[2] < 1e-3
    assert errors[0] > 2.5 * errors[1] > 6 * errors[2]


def test_coefficient_by_case_or_by_contact():
    pressure = np.ones((3, 2, 4, 5))
    spacing, k = np.full((3, 2), 0.1), np.array([1e-6, 2e-6, 4e-6])
    by_case = wear_depth(pressure, pressure, spacing, k)
    assert by_case.shape == (3, 2, 5)
    assert by_case[:, 0, 0] == pytest.approx(1e-3 * 0.4 * k)
    assert np.array_equal(by_case, wear_depth(pressure, pressure, spacing, np.stack([k, k], axis=1)))
