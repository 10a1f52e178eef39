"""How far a parameter may go: closed forms, the results just inside and outside, and what is refused."""

from __future__ import annotations

import json
import math

import pytest

import trackroller as tr
from trackroller.cli.main import app, run_app

SLIDING = {"contact_model": "sliding"}
FREE = {"friction_coefficient": 0, "motor_force": 0, "axial_force": 10}


def test_lift_off_without_friction_is_the_closed_form():
    """A contact carries load while |F_ax| < |F_rad| tan(alpha)."""
    edge = 200.0 * math.tan(math.radians(30.0))
    found = tr.find(FREE, "axial_force", "regime == rolling", between=(-300, 300), **SLIDING)
    assert found.low == pytest.approx(-edge, rel=1e-5) and found.high == pytest.approx(edge, rel=1e-5)
    assert "lift off" in found.below and "lift off" in found.above


def test_the_pressure_of_a_point_contact_grows_with_the_cube_root_of_the_load():
    case = FREE | {"axial_force": 0}
    now = tr.solve(case, outputs="contact", **SLIDING).max_pressure.values[0]
    found = tr.find(case, "radial_force", f"max_pressure <= {1.2 * now}", **SLIDING)
    assert found.low == pytest.approx(-200.0 * 1.2**3, rel=1e-4)
    assert found.value == found.low and found.above == ""


@pytest.mark.parametrize("limit", ["0.9 GPa", "900"])
def test_results_on_either_side_of_the_end_are_those_of_solve(limit):
    case = {"motor_force": 0, "friction_coefficient": 0.2}
    found = tr.find(case, "radial_force", f"max_pressure < {limit} and regime == rolling", **SLIDING)
    pressures = [
        float(tr.solve(case | {"radial_force": force}, outputs="contact", **SLIDING).max_pressure.max())
        for force in (found.low, found.low * (1 + 1e-4))
    ]
    assert pressures[0] < 900 <= pressures[1]


def test_a_case_that_does_not_meet_the_condition_gets_the_nearest_range():
    found = tr.find(FREE | {"axial_force": 150}, "axial_force", "regime == rolling", **SLIDING)
    assert found.met and not found.low <= found.start <= found.high
    assert found.high == pytest.approx(200.0 * math.tan(math.radians(30.0)), rel=1e-4)
    assert "where it is not met" in found.text


def test_a_condition_that_no_value_meets_has_a_reason():
    found = tr.find(FREE, "axial_force", "max_pressure < 1", **SLIDING)
    assert not found.met and math.isnan(found.value)
    assert found.text.startswith("No axial force between -110 and 130 N meets") and "max_pressure" in found.text


def test_values_that_the_program_refuses_end_the_range():
    """A guide of the groove's radius conforms to it, and has no point contact."""
    found = tr.find(FREE, "guide_profile_radius", "slip < 10", **SLIDING)
    assert found.high == pytest.approx(7.0, rel=1e-4) and "refused" in found.above


@pytest.mark.parametrize(
    ("name", "condition", "why"),
    [
        ("axial", "slip < 1", "axial_force"),
        ("axial_force", "slipp < 1", "slip"),
        ("axial_force", "slip", "a comparison"),
        ("axial_force", "max_pressure < 1 mm", "mm"),
        ("axial_force", "normal_force < 1", "normal_force"),
    ],
)
def test_wrong_questions_are_refused(name, condition, why):
    with pytest.raises(tr.InputError, match=why):
        tr.find(FREE, name, condition, **SLIDING)


def test_the_command_prints_the_range_and_its_exit_code_says_whether_there_is_one(capsys):
    words = [
        "solve",
        "--set",
        "mu=0",
        "--set",
        "motor_force=0",
        "--set",
        "contact_model=sliding",
        "--find",
        "axial_force",
    ]
    assert run_app(lambda: app([*words, "--for", "regime == rolling"])) == 0
    assert "to 115.47 N of axial force" in capsys.readouterr().out
    assert run_app(lambda: app([*words, "--for", "max_pressure < 1", "--json"])) == 1
    told = json.loads(capsys.readouterr().out)
    assert told["low"] is None and told["name"] == "axial_force"
    assert run_app(lambda: app(words)) == 2 and "--for" in capsys.readouterr().err


def test_what_a_condition_does_not_count_is_told():
    """A life is a range by the wear coefficient, and the guide has no hours without its overrollings."""
    case = {"radial_force": -150, "axial_force": 5, "motor_force": 0, "permissible_wear_depth": 0.05}
    options = {"contact_model": "sliding", "accuracy": "preview"}
    wish = "pair_life_to_first_limit_hours > 10"
    alone = tr.find(case, "axial_force", wish, **options)
    assert any("pair_life_to_first_limit_hours_low is surely reached" in note for note in alone.notes)
    assert "give guide_overrollings_per_hour" in alone.text
    whole = tr.find(case | {"guide_overrollings_per_hour": 60}, "axial_force", "pair_life_hours > 10", **options)
    assert whole.notes == ()


@pytest.mark.parametrize(
    ("name", "condition", "said"),
    [("outer_radius", "slip < 0.1", "Find axis_distance"), ("axial_force", "slip < 10,000 h", "without a comma")],
)
def test_what_cannot_be_found_says_what_to_write(name, condition, said):
    with pytest.raises(tr.InputError, match=said):
        tr.find({}, name, condition, contact_model="sliding")


@pytest.mark.parametrize("between", [(-1e13, 0), (-1e300, 1e300), (-1000, -10), ("-1 kN", "-10 N"), None])
def test_a_search_between_any_values_finds_the_same_limit(between):
    """The pressure of both contacts, equally loaded without axial force, grows with the cube root of the load."""
    case = FREE | {"axial_force": 0, "radial_force": -200}
    now = float(tr.solve(case, outputs="contact", **SLIDING).max_pressure[0])
    found = tr.find(case, "radial_force", "max_pressure < 900", between=between, **SLIDING)
    assert found.low == pytest.approx(-200.0 * (900.0 / now) ** 3, rel=1e-4)
    cut = between is not None and isinstance(between[0], float)
    assert ("The search was cut to -1e+12 to 0 N, the bounds of radial force." in found.text) == cut


@pytest.mark.parametrize(
    ("between", "said"),
    [
        ((-math.inf, 0), "two different finite numbers"),
        ((math.nan, 0), "two different finite numbers"),
        (("a", 0), "two different finite numbers"),
        ((-5, -5), "two different finite numbers"),
        ((-3, -2, -1), r"Write between=\(lowest, highest\) in N"),
        (-3, r"Write between=\(lowest, highest\) in N"),
        ((1, 2), "lies outside the bounds"),
    ],
)
def test_a_search_between_no_two_numbers_is_refused(between, said):
    with pytest.raises(tr.InputError, match=said):
        tr.find(FREE, "radial_force", "max_pressure < 900", between=between, **SLIDING)


def test_a_search_that_is_widened_or_ends_at_an_odd_value_says_so():
    found = tr.find(FREE, "radial_force", "max_pressure < 900", between=(-500, -300), **SLIDING)
    assert "The search was widened to the value of the case, -200 N." in found.text
    found = tr.find(FREE, "axis_distance", "max_pressure < 1e6", **SLIDING)
    assert found.low < 6.0 and "the axle lies inside the rail" in found.text
    found = tr.find(FREE, "axis_distance", "max_pressure < 1e6", between=(7, 30), **SLIDING)
    assert "axle" not in found.text
