"""contact_model="auto" keeps its tolerance on fresh designs; the comparison of the models is told and drawn right."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import trackroller as tr
from trackroller.roller.case import to_table
from trackroller.roller.choice import choose as choice
from trackroller.roller.options import Options
from validation.benchmarks import contact_choice


def _chosen(cases, tolerance: float, **options) -> np.ndarray:
    return choice.choose(to_table(cases, None), Options(contact_model="auto", contact_tolerance=tolerance, **options))


@pytest.mark.long
def test_fresh_designs_keep_the_tolerance():
    """Designs that the map has not seen, solved by all models."""
    cases = contact_choice.sample(40, seed=77)
    error = contact_choice.errors(contact_choice.solve_all(cases))
    rolls = ~np.isnan(error).any(axis=0)
    for tolerance in (0.05, 0.2):
        model = _chosen(cases, tolerance)[rolls]
        own = np.select([model == m for m in choice.CHEAPER], error[:, rolls], 0.0)
        assert np.mean(own <= tolerance) > 0.96, tolerance  # one miss of so few may happen
        assert len(set(model)) > 1


def test_the_stored_check_met_the_promise():
    m = choice.stored()
    assert np.all(m["met"] >= 0.99) and m["checked"] >= 300
    np.testing.assert_allclose(m["shares"].sum(axis=1), 1.0)


def test_a_wider_tolerance_never_asks_for_a_dearer_model():
    cases = contact_choice.sample(60, seed=5)
    rank = {name: i for i, name in enumerate(contact_choice.MODELS)}
    before = np.full(60, 3)
    for tolerance in (1e-4, 0.01, 0.05, 0.3, 0.9):
        now = np.array([rank[n] for n in _chosen(cases, tolerance)])
        assert np.all(now <= before)
        before = now


def test_the_choice_depends_on_the_case_alone():
    cases = contact_choice.sample(30, seed=6)
    assert [_chosen([c], 0.05)[0] for c in cases] == list(_chosen(cases, 0.05))


def test_little_friction_slides_and_unmeasured_ground_is_solved_exactly():
    gentle = tr.Case(friction_coefficient=0.02, motor_force=0, axial_force=0)
    assert _chosen([gentle], 0.05)[0] == "sliding"
    assert _chosen([dataclasses.replace(gentle, friction_coefficient=0.5)], 0.02)[0] == "kalker"
    for options in ({"spin_model": "edge"}, {"hertz": "published"}):
        assert _chosen([gentle], 0.05, **options)[0] != "sliding"
    falling = dataclasses.replace(gentle, friction_law={"kind": "linear", "speed": 1000.0, "lowest": 0.5})
    assert _chosen([falling], 0.9)[0] == "kalker"


def test_where_all_models_are_one_the_cheapest_is_taken():
    """Without friction, and where the roller slips altogether."""
    slips = tr.Case(friction_coefficient=0.1, motor_force=-80)
    assert int(tr.solve(slips, outputs="forces").regime) == 1
    assert list(_chosen([tr.Case(friction_coefficient=0, motor_force=0), slips], 1e-3)) == ["sliding", "sliding"]


def test_the_probe_measures_the_force_error_against_the_exact_theory():
    """Unseen designs within the table: its difference of forces is the error against the grid solver."""
    cases = [
        tr.Case(friction_coefficient=mu, motor_force=0, contact_angle=angle)
        for mu, angle in ((0.05, 30), (0.2, 45), (0.5, 60))
    ]
    options = Options(contact_model="auto")
    table = to_table(cases, None)
    found = choice.force_error(table, options, "sliding", choice.probe(table, options))
    own, exact = (tr.solve(cases, outputs=("forces", "contact"), contact_model=m) for m in ("sliding", "kalker"))
    arm = np.sqrt(exact.semi_axis_lateral * exact.semi_axis_rolling)
    parts = [abs(own.normal_force / exact.normal_force - 1)]
    parts += [
        abs(own[n] - exact[n]) / exact.normal_force / (arm if n == "spin_moment" else 1)
        for n in ("lateral_force", "driving_force", "spin_moment")
    ]
    worst = np.max([p.values for p in parts], axis=(0, 2))
    np.testing.assert_allclose(found, worst, rtol=0.05, atol=2e-3)


def test_auto_says_which_model_it_took():
    cases = [tr.Case(friction_coefficient=mu, motor_force=0, axial_force=0) for mu in (0.02, 0.15, 0.5)]
    ds = tr.solve(cases, outputs="forces", contact_model="auto", contact_tolerance=0.03)
    names = ds.contact_model_used.attrs["flag_meanings"].split()
    assert [names[int(i)] for i in ds.contact_model_used] == list(_chosen(cases, 0.03))
    exact = tr.solve(cases, outputs="forces", contact_model="kalker")
    np.testing.assert_allclose(ds.normal_force, exact.normal_force, rtol=0.03)


def test_auto_does_not_keep_what_says_itself_that_it_is_in_doubt():
    """The sliding model's forces are within the tolerance here, but its stress is infinite where the slip turns."""
    inf = float("inf")
    doubtful = tr.Case(
        axis_distance=20.161324,
        guide_profile_radius=10.071315,
        roller_profile_radius=inf,
        guide_curve_radius=1708.16,
        contact_angle=37.24502,
        radial_force=-540.4773,
        axial_force=18.69199,
        motor_force=-190.34137,
        friction_coefficient=0.41400733,
        roller_material="EN AW-7075",
        guide_material="EN AW-7075",
    )
    cases = [tr.Case(friction_coefficient=0.02, motor_force=0, axial_force=0), doubtful]
    assert list(_chosen(cases, 0.05)) == ["sliding", "sliding"]
    found, exact = (tr.solve(cases, outputs=("forces", "peak_stress"), contact_model=m) for m in ("auto", "kalker"))
    assert found.contact_model_used.values.tolist() == [0, 2]
    assert float(found.error_estimate.max()) < 0.05
    np.testing.assert_allclose(found.peak_stress, exact.peak_stress, rtol=0.05)


def test_where_the_table_gives_all_that_is_asked_for_fastsim_is_not_tried():
    cases = [tr.Case(friction_coefficient=mu, motor_force=0) for mu in (0.05, 0.1, 0.2, 0.3)]
    quick = tr.solve(cases, outputs="forces", contact_model="auto", accuracy="preview")
    assert set(quick.contact_model_used.values.tolist()) <= {0, 3}


def test_every_case_tells_its_contact_model():
    for number, name in enumerate(("sliding", "fastsim", "kalker", "kalker_table")):
        ds = tr.solve(tr.Case(), outputs="forces", contact_model=name, accuracy="preview" if name != "kalker" else 0.1)
        assert int(ds.contact_model_used) == number
