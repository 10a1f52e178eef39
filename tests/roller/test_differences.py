"""Results are compared with physical scales: rounding is no difference, and every real difference is one."""

from __future__ import annotations

import numpy as np
import pytest

import trackroller as tr
from trackroller.roller.dataset import VARIABLES
from trackroller.roller.differences import ROUNDING, Difference, allowed, compare, scale

LOADS = {"radial_force": -200.0, "axial_force": 30.0, "motor_force": -30.0, "axis_distance": 21.75}
CASES = [{}, {"motor_force": 0.0, "axial_force": 0.0, "guide_curve_radius": float("inf")}]


@pytest.fixture(scope="module")
def solved():
    """Return two cases with their loads; the second one is symmetric, so that some of its results are only noise."""
    outputs = ("forces", "contact", "friction_work", "peak_stress", "life", "tractions")
    ds = tr.solve(CASES, outputs, contact_model="sliding", accuracy="preview", spin_model="concentric")
    return ds.assign_coords(
        {name: ("case", [case.get(name, value) for case in CASES]) for name, value in LOADS.items()}
    )


def altered(ds, name, change):
    """Return a copy in which a variable is changed."""
    return ds.assign({name: ds[name] + change})


def test_the_same_results_do_not_differ(solved):
    assert {difference.apart for difference in compare(solved, solved).values()} == {0.0}


@pytest.mark.parametrize("name", ["lateral_force", "transmitted_force", "drive_torque", "tilting_moment", "yaw_moment"])
def test_noise_of_a_vanishing_force_is_no_difference(solved, name):
    """Values that are zero by symmetry are compared with the load, not with themselves."""
    noise = 1e-12 * solved["radial_force"] * (1.0 if "force" in name else solved["axis_distance"])
    found = compare(solved, altered(solved, name, noise))[name]
    assert 0.0 < found.apart < 1e-11 and not found.exceeds_rounding
    assert "load" in found.scale


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        name
        for name, v in VARIABLES.items()
        if v.group in ("forces", "contact", "friction_work") and name != "error_over_tolerance"  # of a tolerance only
    ],
)
def test_a_changed_number_is_found(solved, name):
    """A change of a hundredth per cent of its scale is a difference in each variable."""
    assert np.isfinite(solved[name]).any()
    change = 1e-4 * scale(solved, name) * (20.0 if allowed(name) > ROUNDING else 1.0)
    assert compare(solved, altered(solved, name, change))[name].exceeds_rounding


@pytest.mark.parametrize("name", ["peak_stress", "life_cycles", "life_hours", "peak_x", "error_estimate", "pressure"])
def test_what_a_search_finds_may_differ_as_far_as_the_search_stops_early(solved, name):
    known = scale(solved, name)
    assert not compare(solved, altered(solved, name, 0.5 * allowed(name) * known))[name].exceeds_rounding
    assert compare(solved, altered(solved, name, 2.0 * allowed(name) * known))[name].exceeds_rounding


def test_a_lost_value_a_new_word_and_a_lost_variable_are_found(solved):
    lost = solved.assign(
        slip=solved["slip"].where(solved["case"] > 0) if "case" in solved.coords else solved["slip"] * np.nan
    )
    assert compare(solved, lost)["slip"].apart == np.inf
    other = solved.assign(regime=solved["regime"] + 1)
    assert compare(solved, other)["regime"].exceeds_rounding
    fewer = solved.drop_vars("slip")
    assert compare(solved, fewer)["slip"].exceeds_rounding
    assert np.isnan(compare(fewer, solved)["slip"].apart) and not compare(fewer, solved)["slip"].exceeds_rounding


def test_the_residual_in_a_reason_is_no_difference(solved):
    one, two, three = (
        solved.assign(reason=("case", [f"{words}. Give less friction", ""]))
        for words in ("no convergence, residual 3e-09", "no convergence, residual 8e-10", "no solution, residual 3e-09")
    )
    assert compare(one, two)["reason"] == Difference(0.0, 0.0, "")
    assert compare(one, three)["reason"].exceeds_rounding


def test_scales_need_neither_patches_nor_loads(solved):
    """Data sets of few outputs have a scale for every number, too."""
    for kept in (["slip", "spin_moment", "normal_force"], ["peak_x", "peak_stress"], ["shear_lateral"], ["peak_y"]):
        few = solved[kept]
        assert all(np.isfinite(scale(few, name)[np.isfinite(few[name].values)]).all() for name in kept)
    bare = solved[["slip", "spin_moment"]].drop_vars(list(LOADS))
    changed = altered(bare, "spin_moment", 1e-3 * bare["spin_moment"])
    assert compare(bare, changed)["spin_moment"].exceeds_rounding


def test_every_number_of_the_program_has_a_scale_in_words():
    for name in VARIABLES:
        assert 0.0 < allowed(name) <= 0.01, name
