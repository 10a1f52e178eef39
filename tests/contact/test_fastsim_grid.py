"""The simplified theory on solved patches: the ellipse as its special case, the exact theory on other shapes."""

import math

import numpy as np
import pytest

import trackroller as tr
from trackroller.contact import fastsim
from trackroller.contact.common import Elastic
from trackroller.contact.fastsim import grid as fastsim_grid
from trackroller.contact.friction_laws import constant, exponential_falling
from trackroller.contact.grid_patch import GridPatch
from trackroller.contact.hertz import exact_shape
from trackroller.contact.kalker.cells import unit_cells
from trackroller.contact.slip import Creepage, Slip

STEEL = Elastic(np.array([79e3]), np.array([0.33]), np.zeros(1))
MU = np.array([0.3])


def hertz_patch(n, k_x, k_y, load=115.0):
    one = np.ones(1)
    e = exact_shape(k_x * one, k_y * one, 117e3 * one).at(load * one)
    height = unit_cells(n, n)[0] * e.max_pressure[0]
    return e, GridPatch(
        e.semi_axis_lateral,
        e.semi_axis_rolling,
        e.max_pressure,
        load * one,
        0 * one,
        height[None],
        0 * one,
        0 * one,
        np.zeros(1, bool),
        0 * one,
    )


def drawn_patch(pressure, half_width=0.3, half_length=0.2, centre=0.0):
    """Return a patch whose elements (N, M) carry the given pressures."""
    one = np.ones(1)
    cell = 4 * half_width * half_length / pressure.size
    return GridPatch(
        half_width * one,
        half_length * one,
        pressure.max() * one,
        pressure.sum() * cell * one,
        centre * one,
        pressure[None],
        0 * one,
        0 * one,
        np.zeros(1, bool),
        0 * one,
    )


def slip_of(shift):
    one, alpha = np.ones(1), math.radians(30)
    return Slip(math.sin(alpha) * one, math.cos(alpha) * one, 6 * one, 16.55 * one, shift * one)


def numbers(solution):
    r = solution.resultants
    return np.array([r.lateral_force[0], r.driving_force[0], r.spin_moment[0]])


@pytest.mark.long
@pytest.mark.parametrize("curvatures", [(0.0238, 0.0587), (0.2, 0.02), (0.005, 0.1)])
@pytest.mark.parametrize("shift", [-0.05, 0.001, 0.3])
def test_the_pressure_of_an_ellipse_gives_the_ellipse_the_better_the_more_elements(curvatures, shift):
    errors, slip = [], slip_of(shift)
    for n in (10, 20, 40):
        e, grid = hertz_patch(n, *curvatures)
        fine = fastsim.FastsimSettings(strips=96, steps=300)
        exact = fastsim.solve_patch(e, Creepage.of_slip(slip), MU, STEEL, fine)
        found = fastsim_grid.solve_grid(grid, slip, MU, STEEL, fastsim.FastsimSettings(steps=6 * n // 5))
        scale = 0.3 * 115 * np.array([1, 1, math.sqrt(e.semi_axis_lateral[0] * e.semi_axis_rolling[0])])
        errors.append(np.abs((numbers(found) - numbers(exact)) / scale).max())
        assert found.friction_energy_per_distance == pytest.approx(
            exact.friction_energy_per_distance, rel=2 / n**2 + 1e-3
        )
    assert errors[2] < 1.2e-3 and errors[2] < 0.4 * errors[0]
    parts = fastsim_grid.equivalent_ellipses(grid)
    np.testing.assert_allclose([parts.a[0], parts.b[0]], [e.semi_axis_lateral[0], e.semi_axis_rolling[0]], rtol=1e-3)


def test_tractions_add_up_to_the_resultants_and_keep_the_bound():
    _, grid = hertz_patch(40, 0.0238, 0.0587)
    for law in (constant(), exponential_falling(30.0, 0.4)):
        settings = fastsim.FastsimSettings(law=law)
        t = fastsim_grid.tractions(grid, slip_of(-0.05), MU, STEEL, settings, 1000.0)
        f = numbers(fastsim_grid.solve_grid(grid, slip_of(-0.05), MU, STEEL, settings, 1000.0))
        cell = (t.x[0, 1] - t.x[0, 0]) * (t.y[0, 1] - t.y[0, 0])
        sums = np.array([t.shear_lateral.sum(), t.shear_rolling.sum()]) * cell
        np.testing.assert_allclose(sums, f[:2], atol=4e-3 * 0.3 * 115)
        assert np.all(np.hypot(t.shear_lateral, t.shear_rolling) <= 0.3 * t.pressure * (1 + 1e-9))


def test_the_work_of_the_slip_is_that_of_the_creepages():
    _, grid = hertz_patch(30, 0.2, 0.02)
    slip = slip_of(-0.04)
    s = fastsim_grid.solve_grid(grid, slip, MU, STEEL)
    f = numbers(s)
    work = -(slip.longitudinal[0] * f[1] + slip.spin[0] * f[2])
    assert s.friction_energy_per_distance[0] == pytest.approx(work, rel=1e-9)


def test_separate_parts_have_ellipses_of_their_own():
    """Two ellipses side by side in one patch carry what each carries alone; so do two behind one another on a strip."""
    height = unit_cells(20, 20)[0] * 700.0
    slip = slip_of(-0.05)
    both = np.zeros((20, 44))
    both[:, :20], both[:, 24:] = height, 0.5 * height
    together = numbers(fastsim_grid.solve_grid(drawn_patch(both, 0.44), slip, MU, STEEL))
    alone = [drawn_patch(height, 0.2, centre=-0.24), drawn_patch(0.5 * height, 0.2, centre=0.24)]
    np.testing.assert_allclose(together, sum(numbers(fastsim_grid.solve_grid(p, slip, MU, STEEL)) for p in alone))
    behind = np.zeros((44, 20))
    behind[:20], behind[24:] = height, height
    s = slip_of(0.8)  # sliding: the forces of both, whatever the flexibilities
    one = fastsim_grid.solve_grid(drawn_patch(height, 0.2, 0.2), s, MU, STEEL).resultants.driving_force
    two = fastsim_grid.solve_grid(drawn_patch(behind, 0.2, 0.44), s, MU, STEEL).resultants.driving_force
    assert two[0] == pytest.approx(2 * one[0], rel=0.02)


def test_slivers_and_nothing_at_all():
    """One loaded column, one loaded element, no friction, no patch: numbers, 0, or NaN, never an exception."""
    for loaded in (np.s_[:, 3], np.s_[4, :], np.s_[2, 2]):
        pressure = np.zeros((12, 12))
        pressure[loaded] = 300.0
        patch = drawn_patch(pressure)
        s = fastsim_grid.solve_grid(patch, slip_of(-0.05), MU, STEEL)
        assert np.all(np.isfinite(numbers(s))) and np.hypot(*numbers(s)[:2]) <= 0.3 * patch.normal_force[0] * (1 + 1e-9)
        assert not np.any(numbers(fastsim_grid.solve_grid(patch, slip_of(-0.05), 0 * MU, STEEL)))
    nothing = drawn_patch(np.full((12, 12), np.nan))
    assert np.all(np.isnan(numbers(fastsim_grid.solve_grid(nothing, slip_of(-0.05), MU, STEEL))))


def worn_points():
    """Return the points of a worn groove. It is hollow at the nominal contact, so that it touches in two patches."""
    x = np.linspace(-2, 2, 201)
    return [[float(u), float(-u * u / 14 + 0.002 * math.exp(-((u / 0.12) ** 2)))] for u in x]


@pytest.mark.parametrize(
    ("profile", "forces", "peak"),
    [
        ({"parabola": -7.0}, 0.035, 0.02),
        ({"arcs": [{"radius": -7, "to": 0.1}, {"radius": -6.4}]}, 0.035, 0.02),
        ({"arc": -7, "edge": {"outer": 0.15}}, 0.035, 0.03),
        ({"points": worn_points(), "frame": "contact"}, 0.06, 0.05),
    ],
)
@pytest.mark.long
def test_beside_the_exact_theory_on_drawn_profiles(profile, forces, peak):
    """Forces within 3.5 to 6 % of mu F_N and peaks within 2 to 5 % of the exact theory."""
    case = tr.Case(roller_profile=profile, friction_coefficient=0.2, motor_force=-10.0)
    outputs = ("forces", "contact", "peak_stress", "friction_work")
    fast, exact = (tr.solve(case, outputs, contact_model=m, normal="halfspace") for m in ("fastsim", "kalker"))
    assert int(fast.regime) == 0 and int(fast.converged) == 1 and float(fast.energy_residual) < 1e-6
    limit = 0.2 * exact.normal_force
    for name in ("lateral_force", "driving_force"):
        assert float((np.abs(fast[name] - exact[name]) / limit).max()) < forces
    arm = np.sqrt(exact.patch_area / math.pi)
    assert float((np.abs(fast.spin_moment - exact.spin_moment) / (limit * arm)).max()) < forces
    np.testing.assert_allclose(fast.peak_stress, exact.peak_stress, rtol=peak)


def test_hertz_is_the_special_case_of_the_chain():
    outputs = ("forces", "contact", "peak_stress", "life", "friction_work")
    loads = {"motor_force": -20.0, "friction_coefficient": 0.25}
    flat = {"guide_profile": {"parabola": 6.0}, "roller_profile": {"parabola": -7.0}}
    hertz = tr.solve(tr.Case(**loads), outputs, contact_model="fastsim")
    grid = tr.solve(tr.Case(**loads, **flat), outputs, contact_model="fastsim", normal="halfspace")
    assert int(grid.converged) == 1 and float(grid.energy_residual) < 1e-7  # of the balance
    for name in ("normal_force", "lateral_force", "driving_force"):
        np.testing.assert_allclose(grid[name], hertz[name], atol=1e-3 * float(hertz.normal_force.max()), err_msg=name)
    np.testing.assert_allclose(grid.spin_moment, hertz.spin_moment, rtol=3e-3)
    np.testing.assert_allclose(grid.peak_stress, hertz.peak_stress, rtol=5e-3)
    np.testing.assert_allclose(grid.friction_energy_per_distance, hertz.friction_energy_per_distance, rtol=3e-3)
    np.testing.assert_allclose(grid.stick_area_fraction, hertz.stick_area_fraction, atol=0.02)


def test_batches_give_the_same_bits_however_they_are_cut():
    profiles = [None, {"arc": -7, "edge": {"outer": 0.3}}]
    cases = [tr.Case(roller_profile=p, axial_force=a, motor_force=0.0) for p in profiles for a in (0.0, 25.0)]
    options = {
        "outputs": ("forces", "contact"),
        "contact_model": "fastsim",
        "normal": "halfspace",
        "accuracy": "preview",
    }
    together = tr.solve(cases, **options)
    for i in (3, 1):
        alone = tr.solve([cases[i]], **options)
        for name in ("lateral_force", "spin_moment", "rolling_radius_shift"):
            np.testing.assert_array_equal(alone[name][0], together[name][i], err_msg=name)
