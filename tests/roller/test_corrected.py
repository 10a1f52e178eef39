"""Equilibrium by the table of the exact theory, corrected by elements."""

import dataclasses
import itertools

import numpy as np
import pytest

import trackroller as tr
from trackroller.contact.kalker import batch, correction
from trackroller.contact.kalker.correction import Correction
from trackroller.parameters.accuracy import PRESETS
from trackroller.roller.case import to_table
from trackroller.roller.equilibrium import corrected, solve_equilibrium
from trackroller.roller.options import Options
from trackroller.roller.stages import mechanics
from trackroller.roller.stages.balance import balance
from validation.extremes.scenes import mirrored, some

QUICK = dataclasses.replace(PRESETS["standard"], elements=16)
CASES = [
    tr.Case(),
    tr.Case(motor_force=0, friction_coefficient=0.1),
    tr.Case(axial_force=0, motor_force=-10),
    tr.Case(roller_material="PA6", motor_force=0, friction_coefficient=0.3),
    tr.Case(roller_profile_radius=-6.3, contact_angle=45),
    tr.Case(roller_material="PA6", friction_coefficient=0.1, motor_force=0),  # beyond the table's |K|/mu
]


def scene_of(cases):
    return mechanics.prepare(to_table(cases), Options(contact_model="kalker", accuracy=QUICK))


@pytest.fixture(scope="module")
def both():
    """Solve the equilibrium with and without the correction of the table."""
    scene = scene_of(CASES)
    return scene, balance(scene), solve_equilibrium(scene.loads, scene.mirror.law(scene.law))


def test_the_corrected_law_ends_where_the_elements_do(both):
    scene, found, exact = both
    assert np.array_equal(found.regime, exact.regime) and found.converged.all()
    limit = scene.loads.friction[:, None] * exact.normal_force
    for name in ("lateral_force", "driving_force"):
        off = (getattr(found.forces, name) - getattr(exact.forces, name)) / limit
        assert np.max(np.abs(off[:-1])) < 3e-4, (name, off)
        assert np.max(np.abs(off[-1])) < 2e-3, (name, off)  # the table is far from the answer
    np.testing.assert_allclose(found.normal_force, exact.normal_force, rtol=1e-3)


def test_few_patches_are_solved(both):
    scene, *_ = both
    assert scene.model.correction.count <= 4.5 * len(CASES)


def test_a_corrected_law_is_exact_at_the_solved_slip():
    """The corrected forces are those of the elements there, and the next correction changes nothing."""
    scene = scene_of(CASES)
    found = balance(scene)
    own = Correction(scene.model.correction.elastic, scene.model.correction.settings)
    patch, slip = scene.contacts(found)
    rows = np.tile(np.arange(scene.n), 2)
    friction = scene.loads.friction[rows]
    first, second = (own.solve(patch, slip, friction, rows) for _ in range(2))
    assert first.max() > 1e-4 and second.max() < 2e-4
    law, solution = own.law(patch, slip, friction, rows), own.solution(patch, slip, friction, rows)
    at_first = solution.resultants.lateral_force / (friction * patch.normal_force)
    assert np.max(np.abs(law.lateral_force / (friction * patch.normal_force) - at_first)) < 5e-3


def test_rollers_that_do_not_settle_are_solved_by_the_elements_alone(monkeypatch):
    monkeypatch.setattr(corrected, "ROUNDS", 1)
    monkeypatch.setattr(corrected, "SETTLED", 0.0)
    scene = scene_of(CASES[:1])
    found, exact = balance(scene), solve_equilibrium(scene.loads, scene.mirror.law(scene.law))
    assert found.shift == pytest.approx(exact.shift, rel=1e-12)
    assert not scene.model.correction.store.known.any()


def test_the_second_solution_of_a_patch_takes_one_grid(monkeypatch):
    """It starts from the first, and the extrapolation of the first serves it."""
    grids = []
    plain = batch.solve_batch
    monkeypatch.setattr(batch, "solve_batch", lambda *given: (grids.append(given[3].traction.shape), plain(*given)))
    monkeypatch.setattr(correction, "NEAR", 0.3)
    balance(scene_of(CASES[:2]))
    assert [shape[-1] for shape in grids[:3]] == [8, 16, 16]


def test_the_estimated_error_of_forces_bounds_their_change_on_finer_elements():
    cases = CASES[:5]
    found, best = (
        tr.solve(cases, ("forces",), contact_model="kalker", accuracy=dataclasses.replace(QUICK, elements=n))
        for n in (16, 40)
    )
    capacity = best.normal_force.values * np.array([case.friction_coefficient for case in cases])[:, None]
    told = found.force_error_estimate.values
    for name in ("lateral_force", "driving_force"):
        assert np.all(np.abs(found[name] - best[name]).values / capacity < told), name
    assert np.median(best.force_error_estimate.values) < 0.6 * np.median(told) and told.max() < 0.05
    assert found.force_error_estimate.attrs["units"] == "1"


def test_errors_are_told_only_where_they_were_measured():
    """A bound of ellipses says nothing about solved pressures, and one of constant friction nothing about laws."""
    case = tr.Case(motor_force=0.0)
    told = tr.solve(case, ("forces",), contact_model="sliding").lateral_force.attrs
    assert told["relative_error_99_percent"] > 0
    falling = dict(friction_law={"kind": "exponential", "speed": 20})
    others = (
        tr.solve(case, ("forces",), contact_model="sliding", normal="halfspace"),
        tr.solve(tr.Case(motor_force=0.0, **falling), ("forces",), contact_model="sliding"),
    )
    for ds in others:
        assert "relative_error_99_percent" not in ds.lateral_force.attrs
        assert np.isnan(ds.force_error_estimate).all()
    slides = tr.solve(tr.Case(motor_force=-1000.0), ("forces",), contact_model="kalker")
    assert slides.regime == 1 and np.all(slides.force_error_estimate == 0)


def test_results_converge_with_the_observed_orders():
    """On 16, 32 and 64 elements: forces and moments over mu F_N, work and peak over themselves."""
    cases = [*CASES[:2], tr.Case(motor_force=-15, friction_coefficient=0.4, roller_profile_radius=-9)]
    friction = np.array([case.friction_coefficient for case in cases])[:, None]
    names = ("lateral_force", "driving_force", "spin_moment", "friction_energy_per_distance", "peak_stress")
    grids = []
    for n in (16, 32, 64):
        accuracy = dataclasses.replace(PRESETS["reference"], elements=n)
        ds = tr.solve(cases, ("forces", "friction_work", "peak_stress"), contact_model="kalker", accuracy=accuracy)
        forces = [ds[name].values / (friction * ds.normal_force.values) for name in names[:3]]
        grids.append([*forces, *(np.log(ds[name].values) for name in names[3:])])
    for k, name in enumerate(names):
        steps = [np.sqrt(np.mean((b[k] - a[k]) ** 2)) for a, b in itertools.pairwise(grids)]
        order = np.log2(steps[0] / steps[1])
        assert 1.7 < order < 4.0, (name, order)


STEEL = dict(radial_force=-200.0, friction_coefficient=0.2, roller_profile_radius=-7.0, guide_curve_radius=220.0)


def test_a_roller_outside_the_table_settles_as_its_mirror_image():
    """In a close groove the table's derivatives are inaccurate, so that a small correction does not prove balance."""
    (groove,) = some(("close groove",))
    case = groove.cases[groove.values.index(1e-4)]
    one, two = (tr.solve(c, ("forces",), contact_model="kalker", accuracy="preview") for c in (case, mirrored(case)))
    assert one.regime == 0 and one.converged == 1
    np.testing.assert_allclose(one.normal_force.values, two.normal_force.values[::-1], rtol=2e-4)


def test_a_correction_that_loses_the_balance_is_followed_by_the_elements():
    """At 89.99 degrees the slip is ten times that of the table, and the first correction leaves no balance."""
    steep = tr.Case(contact_angle=89.99, axial_force=343774.67, motor_force=0.0, friction_coefficient=3.49e-5)
    found = tr.solve(steep, ("forces",), contact_model="kalker", accuracy="preview")
    assert found.regime == 0 and found.converged == 1 and found.residual < 1e-7


def test_braking_ends_at_the_complete_friction_of_the_law():
    """Table and elements reach the complete friction within their error; beyond it the roller slips."""
    complete = 0.2 * 200.0 / np.cos(np.deg2rad(30.0))
    shares = 1.0 - np.array([1e-5, 1e-6, 1e-9, -1e-9])
    cases = [tr.Case(**STEEL, axial_force=30.0, motor_force=share * complete) for share in shares]
    for accuracy in ("preview", QUICK):
        found = tr.solve(cases, ("forces",), contact_model="kalker", accuracy=accuracy)
        assert found.regime.values.tolist()[::3] == [0, 1] and found.regime.max() == 1
        np.testing.assert_allclose(found.transmitted_force, -complete, rtol=3e-5)
    assert tr.solve(cases, ("forces",), contact_model="sliding").regime.values.tolist() == [0, 0, 0, 1]


@pytest.mark.parametrize("model, accuracy", [("sliding", "standard"), ("kalker", "preview"), ("kalker", QUICK)])
def test_converged_rows_keep_the_stated_residual(model, accuracy):
    cases = [tr.Case(**STEEL, axial_force=a, motor_force=m) for a in (0.0, 30.0) for m in (0.0, -10.0, 30.0)]
    found = tr.solve([*cases, *CASES], ("forces",), contact_model=model, accuracy=accuracy)
    limit = found.residual.attrs["converged_up_to"]
    assert found.converged.all() and found.residual.max() <= limit
    assert limit == (1e-10 if model == "sliding" else 1e-4)
    if accuracy is QUICK:  # the elements stop early on purpose
        assert found.residual.max() > 1e-7
