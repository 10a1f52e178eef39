"""The table of the exact rolling theory: against the solver, in its limits, its symmetries and its range."""

from __future__ import annotations

import numpy as np
import pytest

import trackroller as tr
from trackroller.contact import linear, table
from trackroller.contact.common import Elastic, Ellipse
from trackroller.contact.table import build as table_build


def _forces(solution) -> np.ndarray:
    r = solution.resultants
    return np.stack([r.lateral_force, r.driving_force, r.spin_moment])


def test_random_patches_agree_with_the_exact_solver_within_the_stated_error():
    m = table_build.measure(32, seed=2024)
    worst = np.abs(m["error"][:, :3]).max(axis=1)
    like, unlike = worst[m["kappa"] == 0], worst[m["kappa"] != 0]
    stated = table.stored().errors
    assert np.median(like) < 2 * stated["like_force_median"] and like.max() < 2 * stated["like_force_worst"]
    assert np.median(unlike) < 2 * stated["unlike_force_median"] and unlike.max() < 2 * stated["unlike_force_worst"]
    assert stated["like_force_p99"] < 0.03


def test_small_creepages_give_the_linear_theory_exactly():
    g = np.exp(np.linspace(np.log(0.06), np.log(18), 13))
    ellipse, xi, phi, mu, elastic = table_build.problem(g, 0.3, 1e-7, np.linspace(-1.4, 1.4, 13))
    found = _forces(table.solve_patch(ellipse, xi, phi, mu, elastic))
    r = linear.resultants(ellipse, xi, 0.0 * xi, phi, elastic)
    exact = np.stack([r.lateral_force, r.driving_force, r.spin_moment])
    np.testing.assert_allclose(found, exact, rtol=1.5e-2)  # between the nodes of the axis ratio
    nodes = np.exp(table_build._log_ratios(table_build.RATIO))
    at = table_build.problem(nodes, 0.25, 1e-7, 0.5 * np.pi / 13 * 3)
    r = linear.resultants(at[0], at[1], 0.0 * at[1], at[2], at[4])
    exact = np.stack([r.lateral_force, r.driving_force, r.spin_moment])
    np.testing.assert_allclose(_forces(table.solve_patch(*at)), exact, rtol=1e-5)


def test_large_creepages_give_complete_sliding():
    g, angle = np.exp(np.linspace(np.log(0.06), np.log(18), 13)), np.linspace(0.1, 1.45, 13)
    ellipse, xi, phi, mu, elastic = table_build.problem(g, 0.2, 1 - 1e-9, angle)
    found = table.solve_patch(ellipse, xi, phi, mu, elastic)
    np.testing.assert_allclose(_forces(found).T / mu[:, None], table_build.complete_sliding(g, angle), atol=6e-3)
    assert np.all(found.stick_fraction < 1e-6)
    np.testing.assert_allclose(
        found.friction_energy_per_distance,
        -(xi * found.resultants.driving_force + phi * found.resultants.spin_moment),
        rtol=1e-12,
    )


def test_turning_the_creepages_round_turns_the_forces_round_to_the_last_digit():
    s = table_build.sample(50, 3)
    ellipse, xi, phi, mu, elastic = table_build.problem(s["g"], s["nu"], s["rho"], s["angle"], s["kappa"])
    other = Elastic(elastic.shear_modulus, elastic.poisson_ratio, -elastic.coupling)
    plain = _forces(table.solve_patch(ellipse, xi, phi, mu, elastic))
    np.testing.assert_array_equal(_forces(table.solve_patch(ellipse, -xi, -phi, mu, other)), -plain)
    mirrored = _forces(table.solve_patch(ellipse, xi, -phi, mu, elastic))
    np.testing.assert_array_equal(mirrored, plain * np.array([-1.0, 1.0, -1.0])[:, None])


def test_outside_its_range_the_table_says_nothing_and_the_exact_solver_answers():
    g = np.array([0.03, 25.0, 1.0])
    ellipse, xi, phi, mu, elastic = table_build.problem(g, 0.3, 0.6, 0.4, np.array([0.0, 0.0, 5.0]))
    found = table.solve_patch(ellipse, xi, phi, mu, elastic)
    assert not found.known.any() and np.isnan(_forces(found)).all()
    slender = tr.Case(roller_profile_radius=-6.005, motor_force=0)  # b/a far below the table
    ds = tr.solve(slender, contact_model="kalker", accuracy="preview", outputs=("forces", "contact"))
    assert float((ds.semi_axis_rolling / ds.semi_axis_lateral).max()) < table.RATIOS[0]
    exact = tr.solve(slender, contact_model="kalker", outputs="forces")
    np.testing.assert_allclose(ds.normal_force, exact.normal_force, rtol=2e-2)


@pytest.mark.parametrize(
    "change",
    [
        {},
        {"motor_force": 0, "friction_coefficient": 0.05},
        {"roller_material": "PA6", "motor_force": 0, "friction_coefficient": 0.3},
    ],
)
def test_preview_by_the_table_keeps_near_the_exact_theory(change):
    case = tr.Case(**change)
    outputs = ("forces", "contact", "friction_work", "peak_stress")
    ds = tr.solve(case, contact_model="kalker", accuracy="preview", outputs=outputs)
    exact = tr.solve(case, contact_model="kalker", outputs=outputs)
    np.testing.assert_allclose(ds.normal_force, exact.normal_force, rtol=3e-3)
    np.testing.assert_allclose(ds.lateral_force, exact.lateral_force, atol=0.01 * case.friction_coefficient * 150)
    np.testing.assert_allclose(ds.stick_area_fraction, exact.stick_area_fraction, atol=0.02)
    np.testing.assert_allclose(ds.peak_stress, exact.peak_stress, rtol=2e-2)
    # by the table the work is that of its forces; that of unlike materials is summed over elements
    assert float(ds.energy_residual) < (1e-2 if "roller_material" in change or "guide_material" in change else 1e-6)


def test_patches_without_friction_or_force_have_no_traction():
    ellipse = Ellipse(np.array([1.0, np.nan]), np.array([1.0, np.nan]), np.array([100.0, np.nan]))
    elastic = Elastic(np.full(2, 8e4), np.full(2, 0.3), np.zeros(2))
    found = _forces(table.solve_patch(ellipse, np.full(2, 1e-3), np.full(2, 0.01), np.zeros(2), elastic))
    assert np.all(found[:, 0] == 0.0) and np.isnan(found[:, 1]).all()
