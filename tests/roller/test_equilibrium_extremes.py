"""Equilibria at the ends of the parameters: each of these once failed, warned or stood on the wrong branch."""

import warnings

import numpy as np
import pytest
from reference_cases import solve_sliding

import trackroller as tr
from trackroller.roller.dataset import validity_bit
from validation.extremes.random_cases import random_extremes
from validation.extremes.scenes import mirrored, scaled

ROLLING, FULL_SLIP, LIFT_OFF, FAILED = range(4)


def solved(*cases, **options):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return tr.solve(list(cases), ("forces", "contact"), **({"contact_model": "sliding"} | options))


def test_a_nearly_flat_wedge_needs_great_normal_forces_and_gets_them():
    case = tr.Case(contact_angle=89.99, guide_profile_radius=6, axis_distance=20, axial_force=0, motor_force=0)
    ds = solved(case)
    assert ds.regime == ROLLING and ds.converged == 1
    expected = 200 / (2 * np.cos(np.deg2rad(89.99)))
    assert ds.normal_force.values == pytest.approx(expected, rel=0.5)  # friction carries a part


def test_drilling_friction_that_nearly_stops_a_small_roller_is_balanced():
    # the patch is as large as the rolling radius: the slip is many patch lengths
    soft = {
        "name": "soft",
        "youngs_modulus": 3,
        "poisson_ratio": 0.5,
        "tensile_strength": 10,
        "fatigue_strength_ratio": 0.3,
        "cycles_at_tensile_strength": 1e4,
        "cycles_at_fatigue_limit": 5e6,
    }
    case = tr.Case(contact_angle=85, axis_distance=1.0, axial_force=0, motor_force=0, roller_material=soft)
    ds = solved(case)
    assert ds.regime == ROLLING and ds.converged == 1
    assert ds.slip.item() > 1.0


def test_the_lateral_load_rests_on_the_contact_that_faces_it():
    # With more friction than self-locking needs, the equations have two solutions. In the wrong one the contact that
    # faces away from the axial force carries more.
    cases = [
        tr.Case(contact_angle=11, friction_coefficient=0.49, radial_force=-200, axial_force=a, motor_force=0)
        for a in (-5.0, 5.0, -0.1, 0.1)
    ]
    ds = solved(*cases)
    for i, sign in enumerate((-1, 1, -1, 1)):
        one, two = ds.normal_force.values[i]
        assert ds.regime.values[i] == LIFT_OFF or sign * (two - one) > 0


def test_braking_up_to_the_slip_limit_ends_in_the_state_of_full_slip():
    limit = 0.3 * 200 / np.cos(np.deg2rad(30))
    ds = solved(*(tr.Case(axial_force=20, motor_force=limit * (1 + e)) for e in (-2e-9, 1e-9)))
    assert ds.regime.values.tolist() == [ROLLING, FULL_SLIP]
    assert ds.normal_force.values[0] == pytest.approx(ds.normal_force.values[1], rel=1e-4)
    assert float(ds.transmitted_force[0]) == pytest.approx(float(ds.transmitted_force[1]), rel=1e-7)


@pytest.mark.parametrize("friction", [0.0, 1e-12, 1e-6])
def test_little_friction_rolls_at_the_slip_of_the_limit(friction):
    near = solved(tr.Case(friction_coefficient=friction, motor_force=0))
    limit = solved(tr.Case(friction_coefficient=0.0, motor_force=0))
    assert near.slip.item() == pytest.approx(limit.slip.item(), rel=1e-5)


def test_friction_at_the_end_of_the_range_of_numbers_is_none():
    case = dict(friction_coefficient=5e-324, contact_angle=5.0, axis_distance=48, radial_force=-16)
    ds = solved(*(tr.Case(**case, axial_force=a, motor_force=0.0) for a in (-0.03, 0.03)))
    assert ds.regime.values.tolist() == [ROLLING, ROLLING]
    assert ds.normal_force.values[0] == pytest.approx(ds.normal_force.values[1, ::-1], rel=1e-12)


def test_self_locking_is_flagged_with_and_without_axial_force():
    """Without axial force the even balance is an unstable one; the slightest axial force sheds a contact: same flag."""
    bit = validity_bit("jamming")
    case = dict(contact_angle=11, radial_force=-200, motor_force=0)
    ds = solved(*(tr.Case(friction_coefficient=mu, axial_force=a, **case) for mu in (0.2, 0.6) for a in (0, 1e-9, 1)))
    assert ds.regime.values.tolist() == [ROLLING] * 4 + [LIFT_OFF] * 2
    assert (ds.validity.values & bit > 0).tolist() == [False] * 3 + [True] * 3


@pytest.mark.slow
@pytest.mark.parametrize("friction", [0.0, 0.2])
def test_a_contact_lifts_at_a_stated_share_of_the_load_and_once(friction):
    """A contact lifts at a normal force of 1e-8 of |F_rad| + |F_ax|, and stays lifted under more axial force."""
    lift, low, high = 200 * np.tan(np.deg2rad(30)), 0.5, 1.1
    for _ in range(10):
        shares = np.linspace(low, high, 41)
        ds = solved(*(tr.Case(axial_force=lift * s, friction_coefficient=friction, motor_force=0) for s in shares))
        up = ds.regime.values == LIFT_OFF
        assert np.all(np.diff(up.astype(int)) >= 0) and set(ds.regime.values) <= {ROLLING, LIFT_OFF}
        first = int(np.argmax(up))
        least = float(ds.normal_force.values[first - 1].min())
        low, high = shares[first - 1], shares[first]
        if high - low < 1e-12:
            break
    assert least == pytest.approx(1e-8 * (200 + lift * low), rel=1e-2)


@pytest.mark.long
def test_converged_says_whether_the_force_of_a_roller_far_smaller_than_its_patch_is_known():
    """The transmitted force in other units differs by no more than the residual says, over what friction can give."""
    cases = random_extremes(1500, 11)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        one, two = (solve_sliding(c, "forces") for c in (cases, [scaled(c, 7.3, 0.37) for c in cases]))
    both = (one.regime.values == ROLLING) & (two.regime.values == ROLLING)
    mu = np.array([c["friction_coefficient"] for c in cases])
    both &= mu > 0
    gap = np.abs(one.transmitted_force.values - two.transmitted_force.values / (7.3**2 * 0.37))
    gap = (gap / np.where(mu > 0, mu * one.normal_force.values.sum(axis=1), 1))[both]
    assert np.all(gap < 30 * np.fmax(one.residual.values, two.residual.values)[both] + 1e-9)
    sure = ((one.converged.values == 1) & (two.converged.values == 1))[both]
    assert sure.mean() > 0.9 and gap[sure].max() < 3e-9


@pytest.mark.parametrize("friction", [5e-324, 1e-300, 1e-99, 1e-50])
@pytest.mark.parametrize("motor", [0.0, 5e-324, -5e-324, 1e-300])
def test_vanishing_friction_and_motor_force_are_quiet(friction, motor):
    ds = solved(tr.Case(friction_coefficient=friction, motor_force=motor))
    assert ds.regime.values in (ROLLING, FULL_SLIP)
    assert np.isfinite(ds.normal_force.values).all()


@pytest.mark.slow
def test_random_extremes_of_kalker_balance_and_mirror():
    """The balances, eqs (7) to (10), hold for the returned forces, and the mirrored roller has mirrored forces."""
    cases = random_extremes(40, 11)
    ds = solved(*cases, contact_model="kalker", accuracy="preview")
    given = {name: np.array([case[name] for case in cases]) for name in ("axial_force", "radial_force", "motor_force")}
    friction, alpha = (np.array([c[name] for c in cases]) for name in ("friction_coefficient", "contact_angle"))
    sine, cosine = np.sin(np.deg2rad(alpha)), np.cos(np.deg2rad(alpha))
    rolls = (ds.regime.values == ROLLING) & (friction > 0) & (ds.converged.values == 1)
    normal, lateral = ds.normal_force.values.T, ds.lateral_force.values.T
    load = np.abs(given["axial_force"]) + np.abs(given["radial_force"])
    across = cosine * lateral.sum(axis=0) + sine * (normal[0] - normal[1]) + given["axial_force"]
    down = sine * (lateral[1] - lateral[0]) + cosine * normal.sum(axis=0) + given["radial_force"]
    radius = np.array(
        [case["axis_distance"] - case["guide_profile_radius"] * c for case, c in zip(cases, cosine, strict=True)]
    )
    drilling = ds.drilling_torque.values / radius
    torque = drilling + ds.transmitted_force.values + given["motor_force"]
    largest = friction * normal.sum(axis=0) + np.abs(drilling) + np.abs(given["motor_force"])
    assert rolls.sum() > 10
    for unbalanced, scale in ((across, load), (down, load), (torque, largest)):
        assert np.max(np.abs(unbalanced / np.where(scale > 0, scale, 1.0))[rolls]) < 1e-5
    other = solved(*[mirrored(case) for case in cases], contact_model="kalker", accuracy="preview")
    assert np.array_equal(other.regime, ds.regime)
    gap = np.max(np.abs(other.normal_force.values[:, ::-1] - normal.T), axis=1) / np.max(normal, axis=0)
    assert np.max(gap[rolls]) < 1e-4
