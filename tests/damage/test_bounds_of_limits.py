"""A bound of shakedown tells no limit kept that is exceeded, and takes the place of no other number."""

import dataclasses

import numpy as np
import pytest

import trackroller as tr
from trackroller.damage.first_limit import STATES
from validation.benchmarks.samples import random_designs

OUTPUTS = ("forces", "peak_stress", "life", "limits")
KEPT = STATES.index("kept")
YIELD = {"1.7225-normalised": 450, "1.7225-quenched-tempered": 1000, "EN AW-7075": 480, "PA6": 50, "POM": 65}


def with_strengths(cases, seed):
    """Return the cases, each with a roller of another strength as well, which has the same mechanics."""
    rng = np.random.default_rng(seed)
    out = []
    for case in cases:
        strength = float(rng.uniform(0.2, 1.1)) * YIELD[case.roller_material]
        material = {"like": case.roller_material, "yield_strength": strength}
        out += [case, dataclasses.replace(case, roller_material=material)]
    return out


def check_bounds(cases, model):
    """Compare states and numbers with and without bounds; return bounds and numbers of bounded bodies."""
    numbers = tr.solve(cases, (*OUTPUTS, "shakedown"), contact_model=model).sel(limit="shakedown")
    bounds = tr.solve(cases, OUTPUTS, contact_model=model, at_most="shakedown").sel(limit="shakedown")
    most, used = bounds.utilisation_at_most.values, numbers.utilisation.values
    bounded = np.isfinite(most)
    np.testing.assert_array_equal(bounds.limit_state.values, numbers.limit_state.values)
    assert (bounds.limit_state.values[bounded] == KEPT).all()
    assert (most[bounded] < 1.0).all() and (used[bounded] < most[bounded]).all()
    np.testing.assert_array_equal(bounds.utilisation.values, np.where(bounded, np.nan, used))
    elastic = numbers.elastic_utilisation.max("contact").values
    assert (most[bounded] >= elastic[bounded]).all()
    assert np.quantile(most[bounded] / elastic[bounded], 0.95) < 1.2, "the bound of most designs is close"
    return most[bounded], used[bounded]


@pytest.mark.parametrize("model", ["sliding", pytest.param("kalker", marks=pytest.mark.slow)])
def test_a_bound_tells_no_exceeded_limit_kept(model):
    most, used = check_bounds(with_strengths(random_designs(25, 3), 4), model)
    assert 15 < most.size < 80 and (used < 0.95 * most).all()


@pytest.mark.slow
def test_bounds_of_500_random_designs():
    most, used = check_bounds(with_strengths(random_designs(500, 8), 9), "sliding")
    assert most.size > 400 and (used < 0.95 * most).all()


def test_a_row_with_bounds_is_the_same_alone_and_in_any_block():
    cases = with_strengths(random_designs(4, 5), 6)
    given = {"outputs": OUTPUTS, "contact_model": "sliding", "at_most": ("shakedown",)}
    together, turned = tr.solve(cases, **given), tr.solve(cases[::-1], **given)
    for i, case in enumerate(cases):
        alone = tr.solve([case], **given)
        for name in ("utilisation", "utilisation_at_most", "limit_state"):
            own = together[name].sel(limit="shakedown").values[i]
            np.testing.assert_array_equal(alone[name].sel(limit="shakedown").values[0], own)
            np.testing.assert_array_equal(turned[name].sel(limit="shakedown").values[len(cases) - 1 - i], own)


def test_one_roller_a_named_group_and_a_stopped_search_have_numbers():
    case = tr.Case(motor_force=0, roller_material="1.7225-quenched-tempered")
    one = tr.solve(case, OUTPUTS, contact_model="sliding", at_most="shakedown")
    named = tr.solve([case], (*OUTPUTS, "shakedown"), contact_model="sliding", at_most="shakedown")
    assert "utilisation_at_most" not in one and np.isnan(named.utilisation_at_most).all()
    stop = {"contact_model": "sliding", "stop_if": "peak_stress > 1", "at_most": "shakedown"}
    stopped = tr.solve([case], OUTPUTS, **stop)
    for ds in (one, named, stopped):
        assert np.isfinite(ds.utilisation.sel(limit="shakedown")).all()
