"""The searched limits of a roller are where its regime ends."""

from __future__ import annotations

import functools
import math
from dataclasses import replace

import numpy as np
import pytest
from reference_cases import solve_sliding

import trackroller as tr
from trackroller.parameters import REGIMES
from trackroller.roller import regime_limits as searched

CASE = tr.Case(motor_force=0, axial_force=10, friction_coefficient=0.2)


@functools.cache
def limits(case: tr.Case) -> searched.Limits:
    """Search the limits of a case once for all tests."""
    return searched.limits(case, contact_model="sliding")


def _regime(case: tr.Case) -> str:
    return REGIMES[int(solve_sliding(case, "forces").regime)]


@pytest.mark.parametrize("angle", [20.0, 45.0, 60.0])
def test_without_friction_a_contact_lifts_at_the_radial_force_times_the_tangent(angle):
    case = tr.Case(friction_coefficient=0, motor_force=0, axial_force=0, contact_angle=angle, radial_force=-150)
    low, high = limits(case).axial_force
    assert high == pytest.approx(150 * math.tan(math.radians(angle)), rel=1e-5)
    assert low == pytest.approx(-high, rel=1e-6)


@pytest.mark.parametrize("friction", [0.1, 0.3])
def test_the_largest_motor_force_is_the_complete_friction(friction):
    """In full slip no friction acts laterally, so that both contacts carry |F_rad| / cos(alpha) together."""
    case = tr.Case(friction_coefficient=friction, axial_force=0)
    complete = friction * 200 / math.cos(math.radians(30))
    np.testing.assert_allclose(limits(case).motor_force, (-complete, complete), rtol=1e-4)


@pytest.mark.parametrize("side", [0, 1])
def test_the_regime_ends_at_the_limit_and_not_before(side):
    found = limits(CASE)
    sign = (-1, 1)[side]
    bound = found.axial_force[side]
    assert _regime(replace(CASE, axial_force=bound - 1e-3 * sign)) == "rolling"
    assert _regime(replace(CASE, axial_force=bound + 1e-3 * sign)) == "lift_off"
    bound = found.motor_force[side]
    assert _regime(replace(CASE, motor_force=bound - 1e-2 * sign)) == "rolling"
    assert _regime(replace(CASE, motor_force=bound + 1e-2 * sign)) == "full_slip"


@pytest.mark.slow
def test_more_radial_force_holds_more_axial_force():
    held = [limits(replace(CASE, radial_force=-force)).axial_force[1] for force in (100, 200, 400)]
    assert held == sorted(held) and held[2] == pytest.approx(4 * held[0], rel=0.02)


def test_a_lifted_roller_still_has_the_axial_force_that_would_hold():
    lifted = limits(replace(CASE, axial_force=300))
    assert lifted.axial_force[1] == pytest.approx(limits(replace(CASE, axial_force=0)).axial_force[1], rel=5e-5)
    assert np.isnan(lifted.motor_force).all()


@pytest.mark.slow
def test_a_travel_changes_no_distance_to_lift_off():
    assert searched.limits(tr.Case(travel=10.0), "sliding") == searched.limits(tr.Case(), "sliding")
