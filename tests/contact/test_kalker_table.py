"""The table of the exact rolling theory: against the solver, in its limits, its symmetries and its range."""

from __future__ import annotations

from importlib import resources

import numpy as np
import pytest

import trackroller as tr
from trackroller.contact import linear, table
from trackroller.contact.quantities import Elastic, Ellipse
from trackroller.contact.slip import Creepage
from validation.benchmarks.samples import random_designs
from validation.exact.full_sliding import complete_sliding
from validation.kalker_table import build, measure
from validation.kalker_table.nodes import FORCES, POISSON, problem, radius, solve_exact

RATIOS = np.exp(np.linspace(np.log(0.06), np.log(18), 13))


def _forces(solution) -> np.ndarray:
    r = solution.resultants
    return np.stack([r.lateral_force, r.driving_force, r.spin_moment])


@pytest.fixture(scope="module")
def designs():
    """Return random rolling designs and their solution by the table."""
    rollers = random_designs(120, 2026)
    return rollers, measure.rolling(rollers)


def test_random_rolling_designs_lie_in_the_range(designs):
    """At most 2 % of the designs are solved by elements; the size of the table stays below 2 MB."""
    told = measure.outside(*designs)
    assert told["outside"] <= 0.02 and told["axis_ratio_too_small"] <= 0.02 and told["axis_ratio_too_large"] <= 0.02
    file = resources.files("trackroller.contact.table").joinpath("kalker_table.npz")
    with resources.as_file(file) as path:
        assert path.stat().st_size < 2e6


def test_patches_of_random_designs_agree_with_elements(designs):
    """Like and unlike bodies agree with fresh solutions by elements within 1 % of mu F_N in 95 %."""
    rollers, found = designs
    p = measure.design_patches(rollers[:24], found.isel(case=slice(0, 24)))
    off = measure.errors(p, elements=32)
    told = measure.summary(p, off)
    for kind in ("like", "unlike"):
        assert told[f"{kind}_force_median"] < 2e-3 and told[f"{kind}_force_p95"] < 0.01
        assert told[f"{kind}_stick_median"] < 5e-3


def test_random_patches_of_the_range_agree_with_elements_within_the_stated_error():
    """The errors over the whole range, every Poisson's ratio and every coupling, are those that the table states."""
    p = measure.patches(40, seed=2024)
    told, stated = measure.summary(p, measure.errors(p, elements=32)), table.stored().errors
    for kind in ("like", "unlike"):
        assert told[f"{kind}_force_median"] < 2 * stated[f"{kind}_force_median"]
        assert told[f"{kind}_force_worst"] < 2 * stated[f"{kind}_force_worst"]


def test_the_rule_of_the_validation_builds_the_stored_table():
    """A few nodes solved again have the values of the table, up to the error of elements where adhesion is large."""
    rng = np.random.default_rng(5)
    chi, theta, g = FORCES.mesh()
    level = np.array(FORCES.levels)[rng.integers(0, len(FORCES.levels) - 1, 12)]
    level[:] = level[0]  # levels differ in the number of their elements
    pick = rng.integers(0, chi.size, level.size)
    elements = build.ELEMENTS[int(level[0] >= build.MOSTLY_SLIDING)]
    exact = solve_exact(g[pick], 0.3, radius(level / 16), chi[pick], theta[pick], elements)
    ellipse, xi, phi, mu, elastic = problem(g[pick], 0.3, radius(level / 16), chi[pick], theta[pick])
    found = table.solve_patch(ellipse, xi, phi, mu, elastic)
    off = np.abs(_forces(found).T / mu[:, None] - exact[:, :3])
    assert np.median(off) < 2e-3 and off.max() < 0.03


def test_levels_that_are_joined_give_back_their_nodes():
    """Smooth fields that are known at the nodes come back at the nodes, and no spline reaches beyond its ends."""
    chi, theta, g = POISSON.mesh()
    shape = (*POISSON.shape, 4)
    fields = np.stack(
        [np.cos(theta) * np.cos(chi), np.sin(theta) * np.cos(chi), np.cos(theta) * g, 1 / (1 + g)], axis=1
    )
    values = np.stack([(1 + rho) * fields.reshape(shape) for rho in POISSON.rho])
    values[..., 0] /= np.broadcast_to(np.cos(POISSON.chis)[:, None, None], POISSON.shape)
    one = build.spline(POISSON, values)
    k = 2
    points = np.stack([np.full(chi.size, POISSON.rho[k]), chi, theta, np.log(g)], axis=1)
    found, basis, line = np.empty((len(points), 4)), np.empty((4, 4)), np.empty(16)
    for point, out in zip(points, found, strict=True):
        table.spline.evaluate(one, point, basis, line, out)
    np.testing.assert_allclose(found, values[k].reshape(-1, 4), atol=1e-12)
    assert all(knots[3] <= low and knots[-4] >= high for knots, (low, high) in zip(one.knots, build.ENDS, strict=True))


def linear_forces(ellipse, xi, phi, _, elastic):
    a, b = ellipse.semi_axis_lateral, ellipse.semi_axis_rolling
    c = linear.creepage_coefficients(b / a, elastic.poisson_ratio)
    r = linear.linear_resultants(a, b, Creepage(xi, 0.0, phi), elastic.shear_modulus, c)
    return np.stack([r.lateral_force, r.driving_force, r.spin_moment])


def test_small_creepages_give_the_linear_theory():
    at = problem(RATIOS, 0.3, 1e-7, 0.0, np.linspace(-1.4, 1.4, 13))
    np.testing.assert_allclose(
        _forces(table.solve_patch(*at)), linear_forces(*at), rtol=1.5e-2, atol=1e-15
    )  # between nodes
    nodes = np.exp(FORCES.log_g)
    at = problem(nodes, 0.3, 1e-7, 0.0, FORCES.theta[-5])
    np.testing.assert_allclose(_forces(table.solve_patch(*at)), linear_forces(*at), rtol=1e-5, atol=1e-15)


def test_large_creepages_give_complete_sliding():
    ellipse, xi, phi, mu, elastic = problem(RATIOS, 0.2, 1e9, 0.0, np.linspace(0.1, 1.45, 13))
    found = table.solve_patch(ellipse, xi, phi, mu, elastic)
    np.testing.assert_allclose(_forces(found).T / mu[:, None], complete_sliding(RATIOS, xi / phi), atol=6e-3)
    assert np.all(found.stick_fraction < 1e-3)
    work = -(xi * found.resultants.driving_force + phi * found.resultants.spin_moment)
    np.testing.assert_allclose(found.friction_energy_per_distance, work, rtol=1e-12)


def test_turning_the_creepages_round_turns_the_forces_round_to_the_last_digit():
    ellipse, xi, phi, mu, elastic = measure.patches(50, 3)
    other = Elastic(elastic.shear_modulus, elastic.poisson_ratio, -elastic.coupling)
    plain = _forces(table.solve_patch(ellipse, xi, phi, mu, elastic))
    np.testing.assert_array_equal(_forces(table.solve_patch(ellipse, -xi, -phi, mu, other)), -plain)
    mirrored = _forces(table.solve_patch(ellipse, xi, -phi, mu, elastic))
    np.testing.assert_array_equal(mirrored, plain * np.array([-1.0, 1.0, -1.0])[:, None])


def test_forces_go_on_evenly_through_equal_materials():
    """A very small coupling of either sign changes the forces of like bodies by very little."""
    ellipse, xi, phi, mu, elastic = measure.patches(20, 4)
    like = _forces(
        table.solve_patch(ellipse, xi, phi, mu, Elastic(elastic.shear_modulus, elastic.poisson_ratio, 0 * mu))
    )
    for sign in (-1.0, 1.0):
        near = Elastic(elastic.shear_modulus, elastic.poisson_ratio, sign * 1e-9 * mu)
        np.testing.assert_allclose(_forces(table.solve_patch(ellipse, xi, phi, mu, near)), like, atol=1e-7)


def test_outside_its_range_the_table_says_nothing_and_the_exact_solver_answers():
    ellipse, xi, phi, mu, elastic = problem(np.array([0.03, 25.0]), 0.3, 2.0, 0.4, 0.4)
    found = table.solve_patch(ellipse, xi, phi, mu, elastic)
    assert not found.known.any() and np.isnan(_forces(found)).all()
    slender = tr.Case(roller_profile_radius=-6.005, motor_force=0)  # b/a far below the table
    ds = tr.solve([slender], contact_model="kalker", accuracy="preview", outputs=("forces", "contact"))
    assert float((ds.semi_axis_rolling / ds.semi_axis_lateral).max()) < table.RATIOS[0]
    assert measure.outside([slender], ds)["outside"] == 1.0
    exact = tr.solve([slender], contact_model="kalker", outputs="forces")
    np.testing.assert_allclose(ds.normal_force, exact.normal_force, rtol=2e-2)


def test_a_soft_roller_with_little_friction_is_in_the_range():
    """Unlike bodies with |K|/mu of 19 are looked up; the row says so."""
    case = tr.Case(roller_material="POM", friction_coefficient=0.01, motor_force=0)
    ds = tr.solve([case], contact_model="kalker", accuracy="preview", outputs=("forces", "contact"))
    assert measure.outside([case], ds)["outside"] == 0.0
    exact = tr.solve([case], contact_model="kalker", accuracy="standard", outputs="forces")
    np.testing.assert_allclose(ds.lateral_force, exact.lateral_force, atol=0.01 * 0.01 * 150)


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


def test_beside_a_nearly_lifted_contact_the_elements_serve():
    """Where the table's error would change F_N of the light contact by 4.7 %, the row names kalker and is as exact."""
    forces = np.linspace(30.0, 56.0, 14)
    cases = [tr.Case(axial_force=f, friction_coefficient=0.5, motor_force=0.0) for f in forces]
    outputs = ("forces", "contact", "friction_work")
    ds = tr.solve(cases, contact_model="kalker_table", outputs=outputs)
    exact = tr.solve(cases, contact_model="kalker", outputs=outputs)
    normal, angle = exact.normal_force.values, 2 * np.deg2rad(cases[0].contact_angle)
    one, two = (exact.lateral_force.values / normal).T
    determinant = np.sin(angle) * (1 + one * two) + np.cos(angle) * (one - two)  # of eqs (7), (9)
    error = table.stored().force_error("p99") * 0.5
    by_table = (error * normal[:, ::-1] / normal / determinant[:, None]).max(axis=1)
    used = np.array(ds.contact_model_used.flag_meanings.split())[ds.contact_model_used.values]
    assert set(used[by_table > 0.048]) == {"kalker"} and set(used[by_table < 0.036]) == {"kalker_table"}
    told = ds.normal_force_error_estimate.values.max(axis=1)
    assert by_table.max() > 0.2 and told[used == "kalker_table"].max() < 0.05 and told.max() < 0.08
    assert float(ds.force_error_estimate.max()) < 0.06
    off = abs(ds.normal_force / exact.normal_force - 1).values[by_table > 0.048]
    assert off.max() < 0.05  # 0.4 by the table alone
    np.testing.assert_allclose(
        ds.friction_energy_per_distance[:, 1], exact.friction_energy_per_distance[:, 1], rtol=0.02
    )
    assert float(ds.energy_residual.max()) < 1e-6


def test_the_elements_take_over_without_a_step():
    """Along a line of axial forces no step of F_N stands out by half a per cent where the elements begin to serve."""
    forces = np.linspace(29.0, 42.0, 161)
    cases = [tr.Case(axial_force=f, friction_coefficient=0.5, motor_force=0.0) for f in forces]
    ds = tr.solve(cases, contact_model="kalker_table", outputs=("forces", "contact"))
    used = ds.contact_model_used.values
    assert used[0] != used[-1] and np.count_nonzero(np.diff(used)) == 1
    change = np.diff(np.log(ds.normal_force.min("contact").values))
    assert np.abs(np.diff(change)).max() < 5e-3


def test_patches_without_friction_or_force_have_no_traction():
    ellipse = Ellipse(np.array([1.0, np.nan]), np.array([1.0, np.nan]), np.array([100.0, np.nan]))
    elastic = Elastic(np.full(2, 8e4), np.full(2, 0.3), np.zeros(2))
    found = _forces(table.solve_patch(ellipse, np.full(2, 1e-3), np.full(2, 0.01), np.zeros(2), elastic))
    assert np.all(found[:, 0] == 0.0) and np.isnan(found[:, 1]).all()
