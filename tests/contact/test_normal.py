"""The normal problem on a grid against closed forms: Hertz, a blunter indenter, a flat punch, and edges."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import gamma

from trackroller.contact.cross_sections import Gap, arcs, parabola, with_edges
from trackroller.contact.hertz import exact_shape
from trackroller.contact.kalker.cells import unit_cells
from trackroller.contact.normal import TOLERANCE, displacement, solve_normal
from trackroller.contact.normal.family import LATTICE, Family
from trackroller.contact.normal.measure import largest_pressure, patch_area, roughness

LOAD = 1e-3  # over the contact modulus [mm^2]


def hertz(k_x, k_y, load=LOAD):
    e = exact_shape(np.array([k_x]), np.array([k_y]), np.ones(1)).at(np.array([load]))
    return float(e.semi_axis_lateral[0]), float(e.semi_axis_rolling[0]), float(e.max_pressure[0])


def on_ellipse(k_x, k_y, n):
    """Solve on the box of Hertz's ellipse with n x n elements."""
    a, b, _ = hertz(k_x, k_y)
    unit = (2 * np.arange(n) + 1) / n - 1
    gap = 0.5 * k_x * (a * unit[None, :]) ** 2 + 0.5 * k_y * (b * unit[:, None]) ** 2
    return solve_normal(gap, 2 * a / n, 2 * b / n, LOAD)


def straight_gap(guide, roller):
    return Gap(guide, roller, math.radians(30), 16.55, 220.0)


@pytest.mark.parametrize("ratio", [1.0, 0.1, 0.02])
def test_hertz_comes_out_with_second_order(ratio):
    """Largest pressure, mean pressures and approach converge to Hertz's; the load is kept to rounding."""
    _, _, p_max = hertz(ratio, 1.0)
    errors = []
    for n in (20, 40, 80):
        solution = on_ellipse(ratio, 1.0, n)
        assert solution.residual <= TOLERANCE and solution.iterations < 100
        errors.append(abs(largest_pressure(solution.pressure) / p_max - 1))
        mean = np.abs(solution.pressure / p_max - unit_cells(n, n)[0]).sum() / unit_cells(n, n)[0].sum()
        assert mean < 1.5 * n**-1.5
    assert errors[1] < 5e-4
    assert math.log2(errors[0] / errors[2]) / 2 > 1.4
    assert on_ellipse(1.0, 1.0, 40).approach == pytest.approx((0.75 * LOAD) ** (2 / 3), rel=3e-4)  # a^2/R, R = 1


def test_load_is_kept_and_pressure_ends_smoothly():
    a, b, _ = hertz(0.2, 1.0)
    solution = on_ellipse(0.2, 1.0, 40)
    assert solution.pressure.sum() * (a / 20) * (b / 20) == pytest.approx(LOAD, rel=1e-13)
    assert solution.pressure.min() == 0.0
    assert patch_area(solution.pressure, a / 20, b / 20) == pytest.approx(np.pi * a * b, rel=6e-3)


def test_fourth_power_indenter_matches_its_closed_form():
    """Axisymmetric gap A r^4 (Steuermann 1939; Popov & Hess 2015, method of dimensionality reduction)."""
    n, radius, power = 80, 1.0, 4
    kappa = math.sqrt(math.pi) / 2 * power * gamma(power / 2) / gamma(power / 2 + 0.5)
    load = 2 * kappa * radius**5 * power / (power + 1)
    half = 1.02 * radius
    x = half * ((2 * np.arange(n) + 1) / n - 1)
    r = np.hypot(x[None, :], x[:, None])
    solution = solve_normal(r**4, 2 * half / n, 2 * half / n, load)
    inside = np.maximum(radius**2 - r**2, 0.0)
    expected = 4 * kappa / np.pi * (np.sqrt(inside) * r**2 + inside**1.5 / 3)
    # its largest pressure is not in the middle
    assert solution.approach == pytest.approx(kappa, rel=1e-3)
    middle = r < 0.9 * radius
    np.testing.assert_allclose(solution.pressure[middle], expected[middle], rtol=0.01)
    assert abs(r.flat[np.argmax(solution.pressure)] / radius - math.sqrt(0.5)) < 0.06
    assert largest_pressure(solution.pressure) == pytest.approx(expected.max(), rel=3e-3)


def test_flat_round_punch_matches_boussinesq():
    """Where the material ends, the pressure rises towards the edge: p = F/(2 pi a sqrt(a^2 - r^2)), d = F/(2 a)."""
    n, a = 96, 1.0
    x = a * ((2 * np.arange(n) + 1) / n - 1)
    r = np.hypot(x[None, :], x[:, None])
    solution = solve_normal(np.where(r < a, 0.0, 10.0), 2 * a / n, 2 * a / n, 1.0)
    assert solution.approach == pytest.approx(0.5 / a, rel=0.01)
    middle = r < 0.7 * a
    np.testing.assert_allclose(solution.pressure[middle], 0.5 / np.pi / np.sqrt(a * a - r[middle] ** 2), rtol=0.015)
    assert np.all(solution.pressure[r >= a] == 0.0)


def test_surfaces_touch_inside_and_are_apart_outside():
    """The conditions of contact, checked with a displacement that is summed anew."""
    family = Family(straight_gap(with_edges(arcs([6.0], []), -3, 5), arcs([-7.0], [])), 30)
    node = family.at(1e-3)
    x, y, hx, hy = node.box.grid(30, 30)
    pressure = node.shares * 1e-3 / (hx * hy)
    distance = displacement(pressure, hx, hy) + family.gap.field(x, y) - node.approach
    depth = node.approach - family.gap.field(x, y).min()
    assert np.abs(distance[pressure > 0]).max() < 2 * TOLERANCE * depth
    assert distance[pressure == 0].min() > -2 * TOLERANCE * depth


@pytest.mark.slow
@pytest.mark.parametrize(("guide", "roller"), [(6.0, -7.0), (6.0, -6.2), (6.0, 10.0), (4.0, math.inf)])
def test_family_of_parabolas_is_hertz_for_every_load(guide, roller):
    gap = Gap(with_edges(parabola(guide), -9, 9), parabola(roller), math.radians(30), 16.55, math.inf)
    family = Family(gap, 40)
    k_y = math.cos(math.radians(30)) / 16.55
    for load in (2e-5, 7e-4):
        a, b, p = hertz(1 / guide + 1 / roller, k_y, load)
        node = family.at(load)
        assert 0.5 * (node.box.high - node.box.low) == pytest.approx(a, rel=4e-3)
        assert node.box.half == pytest.approx(b, rel=4e-3)
        assert node.largest == pytest.approx(p, rel=1e-3)
        assert node.area == pytest.approx(np.pi * a * b, rel=8e-3)
        assert not node.reaches


def test_result_at_a_load_does_not_depend_on_what_was_asked_before():
    """Bit for bit: starts come from the lattice of loads only."""
    gap = straight_gap(with_edges(arcs([6.0], []), -0.35, 0.3, 0.2), arcs([-7.0], []))
    fresh, used = Family(gap, 24), Family(gap, 24)
    for load in (3e-4, 2e-3, 1.1e-3, LATTICE**-14):
        used.at(load)
    assert np.array_equal(fresh.at(1e-3).shares, used.at(1e-3).shares)


def test_patch_stops_at_the_grooves_edge_and_presses_there():
    """A sharp edge cuts the patch, pressure rises at it; a rounded one lets it end smoothly and presses less."""
    wide = Family(straight_gap(with_edges(arcs([6.0], []), -3, 5), arcs([-7.0], [])), 40).at(1e-3)
    cut = with_edges(arcs([-7.0], []), -3, 0.25)
    sharp = Family(straight_gap(with_edges(arcs([6.0], []), -3, 5), cut), 40).at(1e-3)
    soft = with_edges(arcs([-7.0], []), -3, 0.25, chamfer=0.8)
    rounded = Family(straight_gap(with_edges(arcs([6.0], []), -3, 5), soft), 40, 4).at(1e-3)
    assert wide.box.high > 0.3 and not wide.reaches
    assert sharp.box.high == 0.25 and sharp.reaches
    across = sharp.shares.sum(axis=0)
    assert np.argmax(across) == 39 and across[39] > 1.3 * across[30]
    assert wide.largest < rounded.largest < sharp.largest
    assert 0.25 < rounded.box.high < wide.box.high and not rounded.reaches
    for node in (wide, sharp, rounded):
        assert node.shares.sum() == pytest.approx(1.0, abs=1e-12)


def test_two_bumps_give_two_patches():
    """Contact outside the first guess is found: a guide with two crests."""
    crests = arcs([1.0, -1.0, 1.0, -1.0, 1.0], [-0.45, -0.3, 0.3, 0.45])
    gap = Gap(with_edges(parabola(50.0), -1.5, 1.5), with_edges(crests, -1.5, 1.5), math.radians(30), 16.55, math.inf)
    family = Family(gap, 40)
    node = family.at(2e-3)
    lateral = gap.lateral(np.linspace(-1.4, 1.4, 2001))
    lowest = np.linspace(-1.4, 1.4, 2001)[np.argmin(lateral)]
    assert node.box.low - 0.05 <= lowest <= node.box.high + 0.05
    assert node.residual <= TOLERANCE


def test_the_rim_of_one_end_does_not_come_out_at_the_other():
    """A patch that ends at an edge on one side, at the largest pressure, and runs out at the end of its box."""
    from trackroller.contact.grid_patch import rim_means

    along, across = np.linspace(-1.0, 1.0, 24)[:, None], np.linspace(0.03, 0.95, 20)
    pressure = np.sqrt(np.maximum(across - along**2, 0.0))
    for field in (pressure, pressure[:, ::-1], pressure.T, pressure.T[::-1]):
        means = rim_means(np.ascontiguousarray(field))
        assert means.sum() == pytest.approx(field.sum())
        np.testing.assert_allclose(means, field, atol=0.12)


def rounded_punch(line_load, flat, radius):
    """Return the largest pressure over E* of a flat punch with rounded corners (Ciavarella, Hills and Monno 1998).

    `line_load` is over E* [mm], `flat` half the width of the flat and `radius` of the corners [mm].
    """

    def excess(s):
        return 0.5 * ((0.5 * np.pi - s) / math.sin(s) ** 2 - 1.0 / math.tan(s)) * flat**2 / radius - line_load

    s = brentq(excess, 1e-6, 0.5 * np.pi - 1e-9)  # sin(s) is the flat's share of the contact
    t = np.concatenate([np.linspace(1e-6, s - 1e-6, 2000), np.linspace(s + 1e-6, 0.5 * np.pi - 1e-6, 2000)])
    bent = np.sin(t) * np.log(np.abs(np.sin(t + s) / np.sin(t - s)))
    bent += math.sin(s) * np.log(np.abs(np.tan(0.5 * (t + s)) * np.tan(0.5 * (t - s))))
    shape = ((np.pi - 2.0 * s) * np.cos(t) + bent) / (np.pi - 2.0 * s - math.sin(2.0 * s))
    return 2.0 / np.pi * shape.max() * line_load * math.sin(s) / flat


@pytest.mark.long
@pytest.mark.parametrize(("radius", "load"), [(0.5, 1e-2), (2.0, 1e-2), (0.2, 2e-2)])
def test_ridges_beside_a_flat_get_the_elements_that_they_need(radius, load):
    """A contact much longer than wide is a punch line by line; square elements miss its pressure by up to 40 %."""
    blended = arcs([radius, math.inf, radius], [-0.2, 0.2])
    gap = Gap(blended, arcs([math.inf], []), math.radians(30), 1e4, math.inf)
    factor = Family(gap, 24).finer_across(load)
    off = []
    for across in (1, factor):
        node = Family(gap, 24, across).at(load)
        *_, hx, hy = node.box.grid(*node.shares.shape)
        middle = node.shares[11:13].mean(axis=0) * load / (hx * hy)
        off.append(abs(middle.max() / rounded_punch(middle.sum() * hx, 0.2, radius) - 1.0))
    assert factor > 1 and off[1] < 5e-3 < 0.04 < off[0]


@pytest.mark.slow
@pytest.mark.parametrize("load", [4e-4, 7e-4, 1e-3, 2e-3])
def test_rounding_does_not_choose_the_elements_of_a_flat(load, monkeypatch):
    """All places of a flat are the lowest one; noise of 1e-15 in the gap must not move the box or change the factor."""
    gap = Gap(arcs([0.5, math.inf, 0.5], [-0.2, 0.2]), arcs([math.inf], []), math.radians(30), 25.0, 220.0)
    lateral, found = gap.lateral, []
    for seed in range(4):
        noise = np.random.default_rng(seed)
        monkeypatch.setattr(
            Gap, "lateral", lambda self, x, n=noise: lateral(x) + 1e-15 * n.standard_normal(np.shape(x))
        )
        family = Family(gap, 24)
        factor = family.finer_across(load)
        node = Family(gap, 24, factor).at(load)
        found.append((factor, node.box.low, node.box.high, node.largest))
    np.testing.assert_allclose(found, np.tile(found[0], (4, 1)), rtol=1e-6)


def test_roughness_tells_an_ellipse_from_a_ridge():
    """8/n^2 for p^2 = 1 - u^2 on n elements; a step between loaded elements counts fully."""
    u = (2.0 * np.arange(40) + 1.0) / 40 - 1.0
    smooth = np.sqrt(1.0 - u[None, :] ** 2) * np.ones((3, 1))
    assert roughness(smooth) == pytest.approx(8.0 / 40**2, rel=2e-3)
    smooth[1, 20] *= 2.0
    assert roughness(smooth) == pytest.approx(1.5, rel=0.01)


def test_smooth_pressures_and_sharp_edges_keep_their_elements():
    """Finer elements are for ridges only: no ridge without a blend in the patch, and none to resolve at an edge."""
    blended = arcs([0.5, math.inf, 0.5], [-0.2, 0.2])
    gap = straight_gap(blended, arcs([20.0], []))
    assert Family(gap, 40).finer_across(2e-5) == 1
    assert Family(gap, 40).finer_across(2e-3) > 1
    cut = straight_gap(with_edges(arcs([6.0], []), -3, 3), with_edges(arcs([-7.0], []), -3, 0.15))
    assert [Family(cut, 40).finer_across(LATTICE**k) for k in (-16, -15, -14)] == [1, 1, 1]
