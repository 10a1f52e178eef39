"""The simplified theory against the linear theory, full sliding and the exact theory."""

import numpy as np
import pytest

from trackroller.contact import fastsim, kalker, linear
from trackroller.contact.common import Elastic, Ellipse
from trackroller.contact.fastsim import FastsimSettings
from trackroller.contact.friction_laws import exponential_falling
from trackroller.contact.slip import Creepage, Slip

STEEL = Elastic.of_pair(210e3, 0.33, 210e3, 0.33)


def patch(a=0.3, b=0.18, p=700.0):
    return Ellipse(*(np.atleast_1d(np.asarray(v, float)) for v in (a, b, p)))


def values(r):
    return np.stack([r.lateral_force, r.driving_force, r.spin_moment], axis=-1)


@pytest.mark.parametrize("b", [0.02, 0.18, 1.5])
def test_small_creepages_give_the_forces_of_the_linear_theory(b):
    ellipse = patch(b=b)
    for creep in ((1e-7, 0, 0), (0, 1e-7, 0), (0, 0, 1e-7)):
        f = values(fastsim.solve_patch(ellipse, Creepage(*creep), 0.3, STEEL).resultants)[0]
        coefficients = linear.creepage_coefficients(b / 0.3, STEEL.poisson_ratio)
        exact = values(linear.linear_resultants(0.3, b, Creepage(*creep), STEEL.shear_modulus, coefficients))
        np.testing.assert_allclose(f[:2], exact[:2], rtol=3e-3, atol=1e-9)


def test_full_sliding_and_pure_drilling():
    ellipse = patch(0.2, 0.2)
    full = 0.1 * ellipse.normal_force[0]
    f = values(fastsim.solve_patch(ellipse, Creepage(-0.5, 0.0, 0.0), 0.1, STEEL).resultants)[0]
    assert f[1] == pytest.approx(full, rel=2e-3)
    f = values(fastsim.solve_patch(ellipse, Creepage(0.0, 0.0, 50.0), 0.1, STEEL).resultants)[0]
    assert f[2] == pytest.approx(-3 * np.pi / 16 * full * 0.2, rel=5e-3)


@pytest.mark.parametrize(
    ("creep", "tolerance"),
    [((1e-3, 0.0, 0.0), 0.05), ((3e-4, 3e-4, 0.0), 0.06), ((-0.0035, 0.0, 0.03), 0.08), ((0.0, 0.0, 0.03), 0.08)],
)
def test_forces_near_the_exact_theory(creep, tolerance):
    fast = values(fastsim.solve_patch(patch(), Creepage(*creep), 0.3, STEEL).resultants)[0]
    rigid = Creepage(*(np.array([c]) for c in creep))
    exact = values(kalker.solve_patch(patch(), rigid, 0.3, STEEL).resultants)[0]
    limit = 0.3 * patch().normal_force[0]
    np.testing.assert_allclose(fast[:2], exact[:2], rtol=tolerance, atol=2e-3 * limit)


def test_mirror_and_bound():
    slip = Slip(np.array([0.5, -0.5]), np.full(2, 0.866), np.full(2, 6.0), np.full(2, 16.5), np.full(2, -0.06))
    ellipse = patch([0.3, 0.3], [0.18, 0.18], [700.0, 700.0])
    f = values(fastsim.solve_patch(ellipse, Creepage.of_slip(slip), 0.3, STEEL).resultants)
    np.testing.assert_allclose(f[1], f[0] * [-1, 1, -1], rtol=1e-9)
    t = fastsim.tractions(ellipse, slip, 0.3, STEEL)
    size = np.hypot(t.shear_lateral, t.shear_rolling)
    assert np.all(size <= 0.3 * t.pressure * (1 + 1e-12))
    assert t.shear_lateral.shape == (2, 40, 40)
    cell = 4 * 0.3 * 0.18 / 1600
    np.testing.assert_allclose(t.shear_rolling.sum(axis=(1, 2)) * cell, f[:, 1], rtol=0.02)


def test_steps_and_strips_are_fine_enough():
    fine = FastsimSettings(strips=96, steps=384)
    for creep in ((-0.0035, 0.0, 0.03), (1e-4, 0.0, 0.03)):
        f, g = (
            values(fastsim.solve_patch(patch(), Creepage(*creep), 0.3, STEEL, s).resultants)[0] for s in (None, fine)
        )
        np.testing.assert_allclose(f, g, rtol=1e-2)


def test_forces_over_creepages_and_shapes():
    """Against the exact theory from stick to sliding with the pole in and outside the patch: few per cent of mu F_N."""
    rng = np.random.default_rng(5)
    n, c, p, mu = 60, 0.2, 800.0, 0.2
    root = np.exp(rng.uniform(np.log(0.2), np.log(5), n) / 2)
    elastic = Elastic(np.full(n, 8e4), rng.uniform(0.2, 0.45, n), np.zeros(n))
    size, angle = 10 ** rng.uniform(-0.5, 1.5, n) * mu * p / 8e4, rng.uniform(-0.5, 0.5, n) * np.pi
    xi, phi = size * np.sin(angle), size * np.cos(angle) / c
    ellipse = Ellipse(c / root, c * root, np.full(n, p))
    exact = kalker.solve_patch(ellipse, Creepage(xi, 0 * xi, phi), mu, elastic, kalker.KalkerSettings(elements=24))
    fast = fastsim.solve_patch(ellipse, Creepage(xi, 0.0, phi), mu, elastic)
    scale = (mu * ellipse.normal_force)[:, None] * [1, 1, c]
    error = (values(fast.resultants) - values(exact.resultants)) / scale
    assert np.all(np.sqrt(np.mean(error**2, axis=0)) < [0.027, 0.017, 0.015])
    assert np.all(np.max(np.abs(error), axis=0) < [0.09, 0.06, 0.07])


def test_lateral_force_of_far_sliding_is_exact():
    """Slip along y with some spin: both theories have the same lateral force, which is of the order of spin/slip^2."""
    ellipse = patch([0.3, 0.3, 0.1], [0.3, 0.1, 0.4], [700.0] * 3)
    fast, exact = (
        values(s.resultants)[:, 0]
        for s in (
            fastsim.solve_patch(ellipse, Creepage(0.05, 0.0, 0.02), 0.1, STEEL),
            kalker.solve_patch(ellipse, Creepage(*(np.full(3, v) for v in (0.05, 0.0, 0.02))), 0.1, STEEL),
        )
    )
    np.testing.assert_allclose(fast, exact, rtol=0.025)


def test_work_of_the_slip_is_that_of_the_creepages():
    xi, phi = np.array([-0.0035, 1e-4, 0.01]), np.array([0.03, 0.003, -0.1])
    s = fastsim.solve_patch(patch([0.3] * 3, [0.18] * 3, [700.0] * 3), Creepage(xi, 0.0, phi), 0.3, STEEL)
    f = values(s.resultants)
    np.testing.assert_allclose(s.friction_energy_per_distance, -(xi * f[:, 1] + phi * f[:, 2]), rtol=1e-9)


def test_friction_at_sliding_points_follows_the_law():
    law, one = exponential_falling(30.0, 0.4), np.ones(1)
    slip = Slip(-0.5 * one, np.sqrt(0.75) * one, 6 * one, 16.7 * one, -0.06 * one)
    t = fastsim.tractions(patch(), slip, 0.3, STEEL, FastsimSettings(law=law), 2000.0)
    slides = (t.pressure > 0) & ~t.stick
    friction = np.hypot(t.shear_lateral, t.shear_rolling)[slides] / (0.3 * t.pressure[slides])
    expected = law(2000.0 * np.hypot(t.slip_lateral, t.slip_rolling)[slides])
    assert expected.min() < 0.7 and expected.max() > 0.95  # slip speeds of the patch span most of the fall
    assert np.average(np.abs(friction - expected), weights=t.pressure[slides]) < 0.02


def test_falling_friction_lowers_the_forces():
    settings = FastsimSettings(law=exponential_falling(30.0, 0.4))
    s = fastsim.solve_patch(patch(), Creepage(-0.0035, 0.0, 0.03), 0.3, STEEL, settings, 2000.0)
    constant = fastsim.solve_patch(patch(), Creepage(-0.0035, 0.0, 0.03), 0.3, STEEL)
    assert abs(s.resultants.spin_moment[0]) < abs(constant.resultants.spin_moment[0])


def test_vanishing_friction_or_creepage():
    f = values(fastsim.solve_patch(patch(), Creepage(-0.0035, 0.0, 0.03), 0.0, STEEL).resultants)
    np.testing.assert_allclose(f, 0.0, atol=1e-15)
    f = values(fastsim.solve_patch(patch(), Creepage(0.0, 0.0, 0.0), 0.3, STEEL).resultants)
    np.testing.assert_allclose(f, 0.0, atol=1e-15)
