"""Error against cost: what is measured, what is chosen from it, and that a tolerance holds."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from reference_cases import solve_sliding

import trackroller as tr
from trackroller.contact.slip import pole_split, rolling_slip
from trackroller.parameters.accuracy import PRESETS, RUNGS
from trackroller.roller.expected_errors import expected_errors
from trackroller.roller.options import Options
from validation import adopt as adopted
from validation.benchmarks.command import plain
from validation.paper.table_2 import paper_table
from validation.tradeoff import page
from validation.tradeoff.errors import observed_order, percentiles, relative_errors, tolerance_bound
from validation.tradeoff.figures import draw_all
from validation.tradeoff.measure import measure
from validation.tradeoff.sample import sample

OUTPUTS = ("forces", "contact", "peak_stress", "life")


def test_sample_is_fixed_wide_and_solvable():
    """The same designs every time, a longer sample begins with the shorter, and they span the space."""
    cases = sample(64)
    assert cases[:16] == sample(16)
    mu, alpha = (np.array([getattr(c, n) for c in cases]) for n in ("friction_coefficient", "contact_angle"))
    load = np.array([-c.radial_force for c in cases])
    assert mu.min() < 0.1 and mu.max() > 0.9 and alpha.min() < 20 and alpha.max() > 75
    assert load.max() > 100 * load.min()
    assert {np.sign(c.motor_force) for c in cases} == {-1, 0, 1}
    ds = solve_sliding(cases, outputs=("forces", "contact"), accuracy="preview")
    assert (ds.regime <= 1).all()


def test_order_of_a_known_power_is_found_and_the_floor_left_out():
    points = np.array([10, 20, 40, 80, 160.0])
    order, fit = observed_order(points, 3.0 * points**-1.5)
    assert order == pytest.approx(1.5, abs=1e-9) and fit > 0.999
    order, _ = observed_order(points, np.maximum(points**-4.0, 1e-16))
    assert order == pytest.approx(4.0, abs=1e-6)
    assert np.isnan(observed_order(points[:2], points[:2])[0])


def test_tolerance_bound_is_an_order_statistic():
    """With 299 designs the largest bounds 99 % at 95 % confidence, with more an inner one, with fewer 1.5 P95."""
    rng = np.random.default_rng(1)
    errors = rng.random(299)
    assert tolerance_bound(errors) == errors.max()
    assert tolerance_bound(errors[:100]) == 1.5 * percentiles(errors[:100], (95,))[0]
    covered = [np.quantile(rng.random(1000), 0.99) for _ in range(200)]
    bounds = [tolerance_bound(rng.random(1000)) for _ in range(200)]
    assert np.mean(np.array(bounds) >= 0.99) > 0.9 and np.mean(bounds) > np.mean(covered)
    assert percentiles(np.array([1.0, 2.0, np.inf, np.nan]))[0] == 2.0


def test_errors_are_relative_to_their_scales_and_another_regime_is_infinite():
    cases = [tr.Case(), tr.Case(motor_force=0)]
    ds = solve_sliding(cases, outputs=OUTPUTS, accuracy="preview")
    ds["friction"] = ("case", [0.3, 0.3])
    other = ds.copy(deep=True)
    assert all(np.nanmax(e) == 0 for e in relative_errors(other, ds).values())
    other["lateral_force"] = other.lateral_force + 0.01 * 0.3 * ds.normal_force
    other["peak_stress"] = other.peak_stress * 1.02
    found = relative_errors(other, ds)
    assert found["friction_force"] == pytest.approx(0.01) and found["peak_stress"] == pytest.approx(0.02)
    other["regime"] = ("case", np.array([0, 1]))
    assert np.isinf(relative_errors(other, ds)["normal_force"]).tolist() == [False, True]


def test_rungs_are_in_order():
    for finer, coarser in zip(RUNGS[1:], RUNGS, strict=False):
        one, other = PRESETS[finer], PRESETS[coarser]
        assert one.force_nodes >= other.force_nodes and one.elements >= 2 * other.elements
        options = [Options(contact_model="sliding", accuracy=name) for name in (finer, coarser)]
        bounds = [expected_errors(own, "sliding", True)["peak_stress"].bound for own in options]
        assert bounds[0] < bounds[1]


def test_results_carry_their_expected_error():
    """Attributes state the measured error of the setting; that of life is k times that of the peak (S-N curve)."""
    ds = solve_sliding(tr.Case())
    assert (
        0 < ds.peak_stress.attrs["expected_relative_error"] <= ds.peak_stress.attrs["relative_error_99_percent"] < 0.02
    )
    assert ds.lateral_force.attrs["relative_error_refers_to"] == "mu F_N"
    exponent = np.log(5e6 / 1e4) / np.log(2.0)
    np.testing.assert_allclose(1.0 + ds.life_error_estimate, (1.0 + ds.error_estimate) ** exponent)
    assert ds.life_cycles.attrs["expected_relative_error"] > ds.peak_stress.attrs["expected_relative_error"]


def test_split_pole_is_where_the_slip_of_the_circle_vanishes():
    """The distance to the pole follows from a root of eq. (21); a second zero in the patch is infinitely bad."""
    radius, sine, cosine, a, shift = 4.0, 0.5, np.sqrt(0.75), 1.5, -0.4
    grid = np.linspace(-a, a, 200001)
    slip = np.array([rolling_slip(x, sine, cosine, radius, shift) for x in grid])
    zero = grid[np.argmin(np.abs(slip))]
    args = [np.array([v]) for v in (a, sine, cosine, radius, shift)]
    assert pole_split(*args)[0] == pytest.approx(abs(zero - shift / sine) / a, abs=1e-4)
    assert pole_split(*(np.array([v]) for v in (5.0, sine, cosine, radius, shift)))[0] == np.inf


@pytest.mark.long
def test_the_measurement_gives_what_the_page_and_the_package_need(tmp_path):
    found = json.loads(json.dumps(plain(measure(few=1, repeats=1))))
    draw_all(found, tmp_path)
    assert (tmp_path / "tradeoff.png").is_file() and (tmp_path / "index.json").is_file()
    kept = json.loads((adopted.DATA / "tradeoff.json").read_text(encoding="utf-8"))
    assert found.keys() == kept.keys() and found["designs"] == {"ordinary": 1, "wide": 1, "sliding": 1}
    shown = page.facts({"tradeoff": found})
    assert shown.keys() == page.facts({"tradeoff": kept}).keys() and len(shown["rung_rows"]) == 18
    assert found["shares"]["kalker"]["forces"]["0.01"][:2] == [0.0, 1.0]  # the table cannot keep 0.01


@pytest.mark.slow
def test_the_table_of_the_paper_is_computed_anew():
    rows = {row["what"]: row for row in paper_table()}
    assert rows["converged"]["inner"] == pytest.approx(389.8, rel=3e-3)
    assert rows["converged"]["peak"] == pytest.approx(412.3, rel=2e-3)


def test_forces_of_patches_that_reach_the_equator_converge():
    """Beyond the equator of the guide the slip is constant: the integrals are cut there, and converge as elsewhere."""
    case = tr.Case(
        axis_distance=20,
        guide_profile_radius=2.1,
        roller_profile_radius=-2.14,
        contact_angle=75,
        radial_force=-25,
        axial_force=2,
        motor_force=0,
        friction_coefficient=0.85,
        roller_material="PA6",
        guide_material="PA6",
    )
    rough, fine = (
        solve_sliding(case, outputs=("forces", "contact"), accuracy=replace(PRESETS["standard"], force_nodes=n))
        for n in (12, 40)
    )
    equator = 2.1 * np.tan(np.radians(90 - 75) / 2)
    assert (fine.semi_axis_lateral > equator).all()
    np.testing.assert_allclose(rough.normal_force, fine.normal_force, rtol=1e-6)


def test_the_errors_of_the_package_are_those_of_the_kept_data():
    assert adopted.ERRORS.read_text(encoding="utf-8") == adopted.errors(), "run: python -m validation.adopt tradeoff"


def test_the_costs_of_the_package_are_those_of_the_kept_data():
    assert adopted.COSTS.read_text(encoding="utf-8") == adopted.costs(), "run: python -m validation.adopt tradeoff"
