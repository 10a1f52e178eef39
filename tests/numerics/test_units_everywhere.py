"""Units are read wherever a number has one: heads of point files, targets, constraints, stop_if, options and duty."""

from __future__ import annotations

import math

import pytest

import trackroller as tr
from trackroller.numerics.units import without_units
from trackroller.roller.duty import checked_duty
from trackroller.roller.options import Options
from trackroller.roller.output_names import unit_of
from trackroller.roller.point_files import read_points
from trackroller.roller.stop import parse_condition

HEAD = {"name": "t", "factors": {"axial_force": {"values": [0, 10]}}, "outputs": ["contact", "peak_stress", "life"]}


@pytest.mark.parametrize(
    ("head", "rows"),
    [
        ("x [µm], z [mm]", "-1500, 5.8\n0, 6\n"),
        ("# measured\n# Probe 7\nx [um];z [cm]", "-1500;0,58\n0;0,6\n"),
        ("x[mm] z[mm]", "-1.5 5.8\n0 6\n"),
        ("x, z", "-1.5, 5.8\n0, 6\n"),
        ("x [in]\tz [μm]", f"{-1.5 / 25.4!r}\t5800\n0\t6000\n"),
    ],
)
def test_the_head_of_a_point_file_states_the_units(head, rows, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "p.csv").write_text(f"{head}\n{rows}", encoding="utf-8")
    assert read_points("p.csv", "guide_profile.file").rows == [pytest.approx([-1.5, 5.8]), [0.0, 6.0]]


@pytest.mark.parametrize(
    ("head", "named"), [("x [kg], z [mm]", "kg"), ("x, z [mm]", "each of the two"), ("[a] [b]", "a")]
)
def test_a_wrong_unit_in_the_head_of_a_point_file_is_refused_with_its_line(head, named, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "p.csv").write_text(f"# Probe\n{head}\n1, 2\n", encoding="utf-8")
    with pytest.raises(tr.InputError, match=f"p.csv, line 2: .*{named}"):
        read_points("p.csv", "guide_profile.file")


def test_all_wrong_lines_of_a_point_file_are_named(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "p.csv").write_text("1 2\nx\n3 4\n5\n", encoding="utf-8")
    with pytest.raises(tr.InputError) as error:
        read_points("p.csv", "guide_profile.file")
    assert [one.line for one in error.value.errors] == [2, 4]


def test_points_of_a_case_may_have_units():
    rows = [[f"{x * 100} um", f"{math.sqrt(36 - (0.1 * x) ** 2)!r} mm"] for x in range(-30, 31)]
    case = tr.Case(guide_profile={"points": rows})
    assert case.guide_profile["points"][0] == [-3.0, pytest.approx(math.sqrt(27))]


def test_targets_take_units_of_their_outputs():
    target = {
        "peak_stress_roller": {"max": "0.4 GPa"},
        "roller_life_hours": {"min": "500 h"},
        "max_pressure": {"max": 900},
    }
    study = tr.load_study({**HEAD, "analysis": {"target": target}})
    assert {name: own.ends for name, own in study.config.requirement.items()} == {
        "peak_stress_roller": {"max": 400.0},
        "roller_life_hours": {"min": 500.0},
        "max_pressure": {"max": 900.0},
    }


@pytest.mark.parametrize(
    ("target", "named"),
    [
        ({"max_pressure": {"max": "3 mm"}}, r"target.max_pressure.max = 'mm'.*MPa"),
        ({"roller_life_hours": {"min": "2 years"}}, "Write duty: {hours_per_day: 16, days_per_year: 250}"),
        ({"roller_life_hours": {"min": True}}, "a number"),
        ({"roller_life_hours": {"min": "many"}}, "converted to h"),
    ],
)
def test_a_wrong_unit_of_a_target_is_refused(target, named):
    with pytest.raises(tr.InputError, match=named):
        tr.load_study({**HEAD, "analysis": {"target": target}})


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("max_pressure < 1.5 GPa", "max_pressure < 1500"),
        ("peak_stress_roller_1 < 0.3 GPa", "peak_stress_roller_1 < 300"),
        ("slip < 5 % or axial_force < -0.01 kN", "slip < 0.05 or axial_force < -10"),
        ("(axial_force <= 2 daN) and max_pressure != 2 Pa", "(axial_force <= 20) and max_pressure != 2e-06"),
        ("axial_force < 3 % 2", "axial_force < 3 % 2"),
        ("axial_force < 3 or slip < 1", "axial_force < 3 or slip < 1"),
        ("axial_force < 2 * motor_force", "axial_force < 2 * motor_force"),
    ],
)
def test_quantities_in_constraints_become_numbers(text, plain):
    constraint = tr.load_study({**HEAD, "outputs": ["forces", "contact", "peak_stress"], "constraints": []})
    assert constraint.config.constraints == ()
    assert without_units(text, unit_of, "constraints") == plain


def test_constraints_and_stop_if_take_units():
    study = tr.load_study({**HEAD, "constraints": ["max_pressure < 1.5 GPa"]})
    assert study.config.constraints == ("max_pressure < 1500",)
    assert parse_condition("peak_stress > 0.5 GPa or slip > 5 %")[0] == parse_condition("peak_stress > 500")[0]
    for key in ("constraints", "stop_if"):
        text = "max_pressure < 3 mm"
        with pytest.raises(tr.InputError, match=rf"{key} = 'mm'.*converted to MPa"):
            tr.load_study({**HEAD, key: text if key == "stop_if" else [text]})


def test_options_and_duty_take_units():
    assert Options(failure_probability="10 %").failure_probability == 0.1
    assert Options(accuracy="1 %", outputs=("forces",)).accuracy == 0.01
    study = tr.load_study({**HEAD, "accuracy": "1 %", "failure_probability": "1 %"})
    assert (study.config.accuracy, study.config.failure_probability) == (0.01, 0.01)
    assert checked_duty({"hours_per_day": "960 min", "days_per_year": "25 weeks"}) == {
        "hours_per_day": 16.0,
        "days_per_year": 175.0,
    }
    with pytest.raises(tr.InputError, match="failure_probability"):
        Options(failure_probability="10 mm")
