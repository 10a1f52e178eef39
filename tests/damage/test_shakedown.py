"""Elastic shakedown by Melan's theorem."""

import numpy as np
import pytest
from scipy.optimize import minimize

import trackroller as tr
from trackroller.damage.histories import Tractions, planes
from trackroller.damage.paths import GAP, smallest_ball
from trackroller.damage.shakedown import relieved, shakedown_shear
from trackroller.halfspace.stress import stress_on_grid, von_mises


def ellipse(a, b, mu=0.0, nodes=36):
    """Hertzian pressure of p_0 = 1 with full sliding along y."""
    unit = (2 * np.arange(nodes) + 1) / nodes - 1
    p = np.sqrt(np.maximum(1 - unit[None, :] ** 2 - unit[:, None] ** 2, 0))
    fields = [field[None, None] for field in (a * unit, b * unit, p, 0 * p, mu * p, 0 * p, 0 * p)]
    return Tractions(*fields, np.zeros(1, bool))


@pytest.mark.parametrize(
    ("a", "b", "mu", "expected"),
    [
        (1, 1, 0, 4.65),
        (2, 1, 0, 4.22),
        (5, 1, 0, 4.04),
        (10, 1, 0, 4.01),
        (1, 2, 0, 4.23),
        (5, 1, 0.2, 3.23),
        (5, 1, 0.4, 2.5),
    ],
)
def test_limits_of_ellipses(a, b, mu, expected):
    """p_0/k at nu = 0.3, computed independently; at mu = 0.4 the surface governs with 1/mu."""
    stress = planes(ellipse(a, b, mu), 0, 0, np.array([0.3, 0.3]))
    limits = [1 / shakedown_shear(own) for own in stress]
    assert limits[0] == pytest.approx(expected, rel=0.015)
    assert limits[1] == pytest.approx(limits[0], rel=2e-3)  # mirrored along y


def test_the_residual_stress_shifts_u_and_nothing_else():
    rng = np.random.default_rng(1)
    stress, shift = rng.normal(size=(50, 6)), np.array([0.3, -0.8, 0.0, 0.4, 0.0, 0.0])
    (u, h), (moved, same) = relieved(stress.T), relieved((stress + shift).T)
    assert np.einsum("pd,pd->p", u, u) + h == pytest.approx(von_mises(stress) ** 2 / 3, rel=1e-12)
    assert np.array_equal(h, same) and np.ptp(moved - u, axis=0) == pytest.approx(np.zeros(3), abs=1e-14)


def test_smallest_ball_is_the_minimax():
    rng = np.random.default_rng(2)
    points, height = rng.normal(size=(6, 40, 3)), rng.uniform(0, 1, (6, 40))
    for own, lift in zip(points, height, strict=True):
        value, _ = smallest_ball(own, lift, GAP)
        start = np.append(own.mean(0), 30.0)
        inside = {"type": "ineq", "fun": lambda v, own=own, lift=lift: v[3] - np.sum((own - v[:3]) ** 2, axis=1) - lift}
        tried = minimize(lambda v: v[3], start, constraints=[inside], method="SLSQP", options={"ftol": 1e-10})
        assert value == pytest.approx(tried.x[3], rel=1.5e-4)


def test_planes_are_the_stresses_of_the_half_space():
    t = ellipse(1.3, 0.8, 0.2, nodes=12)
    stress = planes(t, 0, 0, np.array([0.3, 0.25]))
    x, y = t.x[0, 0], t.y[0, 0]
    depth = 0.45 * 0.8
    for body, (nu, sign) in enumerate(((0.3, 1), (0.25, -1))):
        direct = stress_on_grid(x, y, t.pressure[0, 0], 0.0, sign * t.shear_rolling[0, 0], [depth], nu)[0]
        assert np.moveaxis(stress[body, 6, :, 3:15], 0, -1) == pytest.approx(direct, abs=2e-6)  # over p_0 = 1


def test_shakedown_allows_more_than_the_elastic_limit():
    steel = {"like": "1.7225-normalised", "yield_strength": 500.0}
    case = tr.Case(motor_force=0, axial_force=0, friction_coefficient=0.0, roller_material=steel, guide_material=steel)
    ds = tr.solve(case, ("shakedown", "peak_stress", "contact", "limits"), contact_model="sliding")
    elastic, shaken = ds.elastic_utilisation.values, ds.shakedown_utilisation.values
    assert elastic == pytest.approx(ds.peak_stress.values / 500, rel=1e-12)
    assert (shaken < elastic).all() and shaken[0] == pytest.approx(shaken[1], rel=1e-9)
    limit = ds.max_pressure.values[:, None] / shaken / (500 / np.sqrt(3))
    assert (limit > 3.99).all() and (limit < 4.72).all()
    assert ds.surface_fatigue_index.values == pytest.approx(-500 / np.sqrt(3) / ds.max_pressure.values, rel=1e-12)
    assert ds.utilisation.sel(limit="shakedown").values == pytest.approx(shaken.max(axis=0))


def test_cases_that_share_their_mechanics_keep_their_own_yield_strength():
    cases = [
        tr.Case(motor_force=0, roller_material={"like": "1.7225-normalised", "yield_strength": y})
        for y in (300.0, 600.0)
    ]
    ds = tr.solve(cases, "shakedown", contact_model="sliding")
    one, two = ds.shakedown_utilisation.sel(body="roller").values
    assert one == pytest.approx(2 * two, rel=1e-12)


def test_full_slip_has_a_shakedown_limit_too():
    ds = tr.solve(tr.Case(motor_force=-60, friction_coefficient=0.1), ("shakedown", "forces"), contact_model="sliding")
    assert int(ds.regime) == 1 and np.isfinite(ds.shakedown_utilisation).all()
