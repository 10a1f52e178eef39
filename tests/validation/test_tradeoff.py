"""Error against cost: what is measured, what is chosen from it, and that a tolerance holds."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest
from reference_cases import solve_sliding

import trackroller as tr
from trackroller.contact.slip import pole_split, rolling_slip
from trackroller.errors import InputError
from trackroller.roller import accuracy as ac
from trackroller.roller.expected_errors import expected_errors
from validation import adopt as adopted
from validation.tradeoff import __main__ as tradeoff_program
from validation.tradeoff import parts as tradeoff
from validation.tradeoff import settings as tradeoff_settings
from validation.tradeoff import summary as tradeoff_summary
from validation.tradeoff.errors import observed_order, percentiles, relative_errors, tolerance_bound
from validation.tradeoff.measure import reference_solution
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


def finest_tolerance(model, *outputs):
    """Return the finest tolerance of a model, as the refusal of a finer one tells it."""
    with pytest.raises(InputError, match=f"the finest tolerance that {model} reaches here is") as refusal:
        ac.accuracy_settings(1e-12, model, *outputs)
    hit = re.search(r"reaches here is ([\d.e-]+)", str(refusal.value))
    assert hit is not None
    return float(hit[1])


@pytest.mark.parametrize("model", ["sliding"])
def test_a_tolerance_takes_the_cheapest_rung_that_keeps_it_and_refuses_what_is_out_of_reach(model):
    reached = finest_tolerance(model)
    before: ac.Accuracy | None = None
    for tolerance in np.geomspace(0.9, 1.001 * reached, 12):
        chosen = ac.accuracy_settings(float(tolerance), model)
        errors = expected_errors(chosen, model)
        assert errors["peak_stress"].bound <= tolerance * (1 + 1e-6)
        assert max(errors[q].bound for q in ac.FORCE_QUANTITIES) <= tolerance
        if model != "sliding" and before is not None:
            assert chosen.elements >= before.elements
        before = chosen


def test_presets_are_rungs_in_order():
    promised = [ac.PRESETS[name] for name in ("preview", "standard", "reference")]
    for finer, coarser in zip(promised[1:], promised, strict=False):
        assert finer.force_nodes >= coarser.force_nodes and finer.elements >= coarser.elements
        bounds = [expected_errors(p, "sliding")["peak_stress"].bound for p in (finer, coarser)]
        assert bounds[0] < bounds[1]


def test_results_carry_their_expected_error():
    """Attributes state the measured error of the setting; that of life is k times that of the peak (S-N curve)."""
    ds = solve_sliding(tr.Case(), accuracy=1e-2)
    assert (
        0 < ds.peak_stress.attrs["expected_relative_error"] <= ds.peak_stress.attrs["relative_error_99_percent"] < 0.02
    )
    assert ds.lateral_force.attrs["relative_error_refers_to"] == "mu F_N"
    exponent = np.log(5e6 / 1e4) / np.log(2.0)
    np.testing.assert_allclose(ds.life_error_estimate, exponent * ds.error_estimate)
    assert ds.life_cycles.attrs["expected_relative_error"] > ds.peak_stress.attrs["expected_relative_error"]


@pytest.mark.slow
def test_tolerances_hold_on_a_fresh_sample():
    """At most one case in fifty exceeds its tolerance, for forces and peaks; benchmarks/tolerance.py has more."""
    cases = sample(40, seed=4711)
    reference, _ = reference_solution(cases, "sliding", OUTPUTS)
    for tolerance in (2e-2, 3e-3):
        errors = relative_errors(solve_sliding(cases, outputs=OUTPUTS, accuracy=tolerance), reference)
        worst = np.max([errors[q] for q in (*ac.FORCE_QUANTITIES, "peak_stress")], axis=0)
        assert np.sum(worst > tolerance) <= 1


def test_split_pole_is_where_the_slip_of_the_circle_vanishes():
    """The distance to the pole follows from a root of eq. (21); a second zero in the patch is infinitely bad."""
    radius, sine, cosine, a, shift = 4.0, 0.5, np.sqrt(0.75), 1.5, -0.4
    grid = np.linspace(-a, a, 200001)
    slip = np.array([rolling_slip(x, sine, cosine, radius, shift) for x in grid])
    zero = grid[np.argmin(np.abs(slip))]
    args = [np.array([v]) for v in (a, sine, cosine, radius, shift)]
    assert pole_split(*args)[0] == pytest.approx(abs(zero - shift / sine) / a, abs=1e-4)
    assert pole_split(*(np.array([v]) for v in (5.0, sine, cosine, radius, shift)))[0] == np.inf


@pytest.mark.slow
def test_measurement_runs_from_parts_to_page(tmp_path, monkeypatch):
    """Two designs through all parts, files, summary, figures and report; orders come out as they must."""
    monkeypatch.setattr(tradeoff_settings, "ELEMENTS", {"kalker": (8, 12)})
    monkeypatch.setattr(tradeoff_settings, "SEARCHES", tradeoff_settings.SEARCHES[:5:2])
    monkeypatch.setattr(tradeoff_settings, "FORCE_NODES", (6, 12, 20))
    for place in (tradeoff_settings, tradeoff_summary):
        monkeypatch.setattr(place, "REFERENCE_ELEMENTS", {"kalker": 16})
    text = "tradeoff: {sliding: {designs: 3, parts: 2}, kalker: {designs: 1, parts: 1}, stages: 4}\n"
    sizes = tmp_path / "tradeoff.yaml"
    sizes.write_text(text, encoding="utf-8")
    names = tradeoff.load_sizes(sizes).names()
    assert names == ["kalker-0", "sliding-0", "sliding-1", "stages-0"]
    for name in names:
        tradeoff.write_part(name, str(sizes), str(tmp_path / f"{name}.nc"))
    out = tmp_path / "out"
    out.mkdir()
    tradeoff.write_gathered([str(tmp_path / f"{n}.nc") for n in names], str(sizes), str(out / "tradeoff.nc"))
    tradeoff_program.show(out / "tradeoff.nc")
    found = json.loads((out / "tradeoff.json").read_text(encoding="utf-8"))
    orders = {(o["stage"], o["method"], o["quantity"]): o["order"] for o in found["orders"]}
    assert 1.0 < orders["tractions", "grid", "friction_force"] < 3.0
    assert orders["stress", "bilinear elements", "stress"] > 0.4
    published = next(r for r in found["settings"] if r["stage"] == "ellipse" and r["label"] == "published")
    assert published["errors"]["semi_axes"][0] > 1e-4, "linear interpolation in the printed table"
    paper = {r["what"]: r for r in found["paper_table"]}
    assert paper["converged"]["inner"] == pytest.approx(389.8, rel=3e-3)
    assert paper["converged"]["peak"] == pytest.approx(412.3, rel=2e-3)
    figures = {p.stem for p in (out / "figures").glob("*.svg")}
    assert {"tradeoff_peak_stress", "tradeoff_normal_force", "tradeoff_convergence"} <= figures


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
        solve_sliding(case, outputs=("forces", "contact"), accuracy=tradeoff_settings.accuracy_of(n)) for n in (12, 40)
    )
    equator = 2.1 * np.tan(np.radians(90 - 75) / 2)
    assert (fine.semi_axis_lateral > equator).all()
    np.testing.assert_allclose(rough.normal_force, fine.normal_force, rtol=1e-6)


@pytest.mark.parametrize(
    "text", ["sliding: 3", "tradeoff: 3", "tradeoff: {sliding: 3}", "tradeoff: {slidin: {designs: 3, parts: 1}}"]
)
def test_wrong_sizes_are_refused(tmp_path, text):
    path = tmp_path / "t.yaml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError):
        tradeoff.load_sizes(path)


def test_the_ladders_of_the_package_are_those_of_the_kept_data():
    assert adopted.LADDERS.read_text(encoding="utf-8") == adopted.ladders(), "run: python -m validation.adopt tradeoff"


def test_the_costs_of_the_package_are_those_of_the_kept_data():
    assert adopted.COSTS.read_text(encoding="utf-8") == adopted.costs(), "run: python -m validation.adopt benchmarks"
