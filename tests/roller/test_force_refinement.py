"""Friction forces with a large estimated error come from twice the elements, others do not."""

import dataclasses

import numpy as np
import pytest

import trackroller as tr
from trackroller.contact.kalker import batch, correction, extrapolation
from trackroller.contact.sliding_model import SlidingModel
from trackroller.parameters.accuracy import PRESETS
from trackroller.roller.case import to_table
from trackroller.roller.equilibrium import solve_equilibrium
from trackroller.roller.options import Options
from trackroller.roller.stages import mechanics
from validation.benchmarks.samples import random_designs

# Normal forces [N] of designs with a light contact beside a heavy one, on 128 elements
LIGHT = {361: (246.26660, 10.058869), 368: (47.06337, 0.1393192), 408: (0.280758, 176.69390)}
ELEMENTS = PRESETS["standard"].elements


@pytest.fixture(scope="module")
def designs():
    designs = random_designs(max(LIGHT) + 1, 17)
    return [designs[i] for i in LIGHT]


def solved(monkeypatch, cases, outputs=("forces",), **options):
    """Return the results, and the elements along an axis of each group of patches that was solved."""
    grids, plain = [], batch.solve_batch
    monkeypatch.setattr(batch, "solve_batch", lambda *given: (grids.append(given[3].traction.shape[-1]), plain(*given)))
    found = tr.solve(cases, outputs, **({"contact_model": "kalker", "accuracy": "standard"} | options))
    monkeypatch.setattr(batch, "solve_batch", plain)
    return found, grids


def test_a_light_contact_has_its_own_load(monkeypatch, designs):
    """An error of F_T in the heavy contact is a large share of the light one's load."""
    exact = np.array(list(LIGHT.values()))
    found, grids = solved(monkeypatch, designs)
    monkeypatch.setattr(correction, "REFINED_ERROR", np.inf)
    rough, coarse = solved(monkeypatch, designs)
    assert max(grids) == correction.LIGHT_FACTOR * ELEMENTS and max(coarse) == ELEMENTS
    after, before = (np.abs(ds.normal_force.values / exact - 1.0) for ds in (found, rough))
    assert after.max() < 0.02 < 0.1 < before.max()
    assert np.all(after.max(axis=1) < 0.5 * before.max(axis=1))
    assert found.converged.all()


def test_refined_forces_are_those_of_twice_the_elements(monkeypatch, designs):
    """Independent of the way there: a balance on twice the elements gives the same forces."""
    finer = dataclasses.replace(PRESETS["standard"], elements=2 * ELEMENTS)
    monkeypatch.setattr(correction, "LIGHT_ERROR", np.inf)
    monkeypatch.setattr(correction, "REFINED_ERROR", 0.0)
    found, _ = solved(monkeypatch, designs)
    monkeypatch.setattr(correction, "REFINED_ERROR", np.inf)
    best, _ = solved(monkeypatch, designs, accuracy=finer)
    capacity = best.normal_force.values * np.array([case.friction_coefficient for case in designs])[:, None]
    for name in ("lateral_force", "driving_force"):
        assert np.max(np.abs(found[name] - best[name]).values / capacity) < 3e-3, name
    np.testing.assert_allclose(found.force_error_estimate, best.force_error_estimate, rtol=0.1)


def test_accurate_forces_and_tables_are_not_refined(monkeypatch, designs):
    _, grids = solved(monkeypatch, tr.Case(friction_coefficient=0.1, motor_force=0.0))
    assert max(grids) == ELEMENTS
    monkeypatch.setattr(correction, "TABLE_SERVES", (np.inf, np.inf))
    _, grids = solved(monkeypatch, designs, ("forces", "contact"), contact_model="kalker_table")
    assert max(grids, default=0) <= ELEMENTS


def test_peaks_take_the_finer_tractions_of_the_forces(designs):
    """At the slip of the first correction nothing is left to iterate: no step of Newton's method follows."""
    scene = mechanics.prepare(to_table(designs[:1]), Options(contact_model="kalker", accuracy="standard"))
    own, (patch, slip) = scene.model.correction, scene.contacts(solve_equilibrium(scene.loads, scene.model.law))
    rows, friction = np.zeros(2, int), scene.loads.friction[[0, 0]]
    own.solve(patch, slip, friction, rows)
    refined = own.finer.known.copy()
    assert refined.any()
    again = own.on_finer(patch, slip, friction, rows, own.solution(patch, slip, friction, rows))
    assert again.converged.all() and (again.steps[refined] == 0).all()


def test_weights_are_those_of_the_known_orders():
    """Second order in full sliding, first order in full adhesion of like bodies."""
    used, ratio, like = np.array([1.0, 0.0]), np.array([3.0, 0.5]), np.zeros(2)
    np.testing.assert_allclose(extrapolation.weight(used, ratio, like), [1.0 / 3.0, 1.0])
    sticks = extrapolation.weight(np.array([0.7]), np.ones(1), np.array([0.5]))
    assert 1.0 / 3.0 < sticks < extrapolation.weight(np.array([0.7]), np.ones(1), np.zeros(1)) <= 1.0


def test_an_error_of_one_contact_loads_both(monkeypatch, estimates):
    """Only contact 1 errs: both normal forces change as the balance of forces does when its ratio F_T/F_N changes."""
    own = 1e-4
    monkeypatch.setattr(SlidingModel, "force_error", lambda self, n: np.tile([own, 0.0], (n, 1)))
    case = tr.Case(axial_force=60.0, contact_angle=35.0)
    ds = tr.solve(case, "forces", contact_model="sliding")
    normal, friction = ds.normal_force.values, case.friction_coefficient
    ratio, alpha = ds.lateral_force.values / normal, np.radians(case.contact_angle)

    def balanced(change):
        one, two = ratio[0] + change, ratio[1]
        rows = [
            [np.sin(alpha) + np.cos(alpha) * one, -np.sin(alpha) + np.cos(alpha) * two],
            [np.cos(alpha) - np.sin(alpha) * one, np.cos(alpha) + np.sin(alpha) * two],
        ]
        return np.linalg.solve(rows, [-case.axial_force, -case.radial_force])

    np.testing.assert_allclose(balanced(0.0), normal, rtol=1e-9)
    change = np.abs(balanced(own * friction) - balanced(-own * friction)) / 2.0 / normal
    assert change[0] > 0.2 * change[1] and abs(normal[1] / normal[0] - 1.0) > 0.3, "unequal contacts, not at 45 degrees"
    np.testing.assert_allclose(ds.normal_force_error_estimate, change, rtol=1e-6)
    used = np.hypot(ds.lateral_force, ds.driving_force).values / (friction * normal)
    np.testing.assert_allclose(ds.force_error_estimate, np.array([own, 0.0]) + np.sqrt(used) * change, rtol=1e-6)
