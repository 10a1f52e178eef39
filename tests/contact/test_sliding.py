"""Full sliding: resultants against independent quadrature, symmetry, convergence."""

import numpy as np
import pytest
from scipy.integrate import quad

from trackroller.contact.quantities import Ellipse
from trackroller.contact.sliding import integrals, slip_field, tractions
from trackroller.contact.slip import Slip


def patch(a, b, alpha, shift, radius=6.0, p=1.0):
    one = np.ones(1)
    s, c = np.sin(alpha), np.cos(alpha)
    return Ellipse(a * one, b * one, p * one), Slip(s * one, c * one, radius * one, 16.5 * one, shift * one)


def brute_force(ellipse, slip, spin_model):
    """Return F_T, F_A, M_R and power by nested adaptive quadrature of the slip field, mu = 1."""
    a, b = ellipse.semi_axis_lateral[0], ellipse.semi_axis_rolling[0]

    def column(theta, kind):
        x = a * np.sin(theta)
        h = b * np.cos(theta)

        def f(phi):
            y = h * np.sin(phi)
            v = slip_field(ellipse, slip, np.array([[x]]), np.array([[y]]), spin_model)
            vx, vy = v[0][0, 0], v[1][0, 0]
            speed = np.hypot(vx, vy)
            p = np.cos(theta) * np.cos(phi)
            tx, ty = -p * vx / speed, -p * vy / speed
            return (tx, ty, x * ty - y * tx, p * speed * 16.5)[kind] * h * np.cos(phi)

        return quad(f, -np.pi / 2, np.pi / 2, epsabs=1e-10, epsrel=1e-7, limit=200)[0] * a * np.cos(theta)

    pole = np.clip(slip.pole_lateral[0] / a, -1, 1)
    points = [np.arcsin(pole)]
    return [
        quad(column, -np.pi / 2, np.pi / 2, args=(k,), points=points, epsabs=1e-8, epsrel=1e-5, limit=60)[0]
        for k in range(4)
    ]


@pytest.mark.parametrize(
    ("a", "b", "alpha", "shift", "spin_model"),
    [
        pytest.param(0.35, 0.2, 0.52, 0.05, "concentric", marks=pytest.mark.long),
        (0.35, 0.2, 0.52, 0.05, "edge"),
        pytest.param(0.35, 0.2, 0.52, 0.05, "skewed", marks=pytest.mark.long),
        (0.2, 0.5, -0.9, -0.08, "edge"),
        pytest.param(0.2, 0.5, -0.9, -0.08, "concentric", marks=pytest.mark.long),
        pytest.param(0.2, 0.5, -0.9, -0.08, "skewed", marks=pytest.mark.long),
    ],
)
def test_resultants_and_power_match_adaptive_quadrature(a, b, alpha, shift, spin_model):
    """Column integration agrees with a nested adaptive quadrature of the same slip field to 1e-5."""
    ellipse, slip = patch(a, b, alpha, shift)
    exact = brute_force(ellipse, slip, spin_model)
    r = integrals(ellipse, slip, np.ones(1), spin_model=spin_model, nodes=16).resultants
    found = [
        r.lateral_force[0],
        r.driving_force[0],
        r.spin_moment[0],
        integrals(ellipse, slip, np.ones(1), spin_model=spin_model).power[0],
    ]
    scale = np.array([1, 1, max(a, b), max(a, b)]) * ellipse.normal_force[0]
    np.testing.assert_allclose(np.array(found) / scale, np.array(exact) / scale, atol=1e-5)


def test_quadrature_converges_geometrically():
    """Doubling the points gains orders, not a factor: 6 -> 12 -> 24 points."""
    ellipse, slip = patch(0.35, 0.2, 0.52, 0.05)
    fine = integrals(ellipse, slip, np.ones(1), nodes=64).resultants
    error = []
    for n in (6, 12, 24):
        r = integrals(ellipse, slip, np.ones(1), nodes=n).resultants
        error.append(abs(r.driving_force[0] - fine.driving_force[0]) + abs(r.spin_moment[0] - fine.spin_moment[0]))
    assert error[0] > 30 * error[1] > 30 * 30 * error[2]


def test_mirrored_contacts_mirror_their_forces():
    """Contact 2 (-alpha) is contact 1 mirrored at x = 0: F_T and M_R change sign, F_A does not."""
    one = integrals(*patch(0.3, 0.2, 0.5, -0.07), np.ones(1)).resultants
    two = integrals(*patch(0.3, 0.2, -0.5, -0.07), np.ones(1)).resultants
    assert one.lateral_force == pytest.approx(-two.lateral_force, rel=1e-10)
    assert one.driving_force == pytest.approx(two.driving_force, rel=1e-10)
    assert one.spin_moment == pytest.approx(-two.spin_moment, rel=1e-10)


def test_far_pole_gives_full_slip():
    """With the pole far outside all traction points along the track: F_A = -mu F_N, F_T = 0."""
    ellipse, slip = patch(0.3, 0.2, 0.5, 1e5)
    r = integrals(ellipse, slip, 0.4 * np.ones(1)).resultants
    assert r.driving_force == pytest.approx(-0.4 * ellipse.normal_force, rel=1e-9)
    assert abs(r.lateral_force[0]) < 1e-6 * ellipse.normal_force[0]


def test_tractions_obey_coulomb_and_sum_to_the_resultants():
    """|tau| = mu p in the patch, 0 outside; the grid sum tends to the resultants."""
    ellipse, slip = patch(0.3, 0.2, 0.5, 0.02)
    t = tractions(ellipse, slip, 0.3 * np.ones(1), points=401)
    size = np.hypot(t.shear_lateral, t.shear_rolling)
    np.testing.assert_allclose(size, 0.3 * t.pressure, atol=1e-12)
    area = (t.x[0, 1] - t.x[0, 0]) * (t.y[0, 1] - t.y[0, 0])
    r = integrals(ellipse, slip, 0.3 * np.ones(1)).resultants
    assert t.shear_rolling.sum() * area == pytest.approx(r.driving_force[0], rel=2e-3)
    assert t.shear_lateral.sum() * area == pytest.approx(r.lateral_force[0], rel=2e-3)
