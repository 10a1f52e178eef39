"""All errors of a file stand together, in the order of its lines, each with what is meant most likely."""

from __future__ import annotations

import pickle

import pytest
from command_line import trackroller

import trackroller as tr
from trackroller.errors import Collector, InputErrors, likeliest, nearest
from trackroller.roller.fields import FIELDS
from trackroller.yaml_file import lines_of

CASE = """\
radial_force: 130

outer_diameter: 31
axial_force: 4 mm
reliability: 0.99
friction_law: {kind: linear, speed: -1, lowest: 0.5}
"""
STUDY = """\
nmae: x
base:
  radial_force: -140

  groove_width: 3
factors:
  friction_coefficient: {values: [0.1, 3.5]}
  velocity:
    uniform: [5 N, 6 N]
design: lsh
outputs: [forces, lief]
"""


def lines(text: str) -> list[str]:
    """Return the start of each message after the name of the program."""
    return [line.removeprefix("trackroller: ") for line in text.splitlines()]


def test_a_case_file_names_all_its_errors_in_order(tmp_path):
    (tmp_path / "case.yaml").write_text(CASE)
    told = lines(trackroller("solve", "case.yaml", "--set", "velocity=-8", cwd=tmp_path, code=2).stderr)
    starts = ["velocity = -8", "line 1: radial_force = 130", "line 3: case field = 'outer_diameter'"]
    starts += ["line 4: axial_force = 'mm'", "line 5: case field = 'reliability'", "line 6: friction_law.speed = -1"]
    assert [line[: len(start)] for line, start in zip(told, starts, strict=True)] == starts
    assert "Write -130. The sign means: < 0 presses the roller" in told[1]
    assert told[0].endswith("Write 8.")


def test_a_study_file_names_all_its_errors_in_order(tmp_path):
    (tmp_path / "s.yaml").write_text(STUDY)
    told = lines(trackroller("plan", "s.yaml", cwd=tmp_path, code=2).stderr)
    starts = ["line 1: study key = 'nmae'", "line 5: base = 'groove_width'", "line 7: factors.friction_coefficient"]
    starts += ["line 9: factors.velocity.uniform", "line 10: design = 'lsh'", "line 11: outputs = 'lief'"]
    assert [line[: len(start)] for line, start in zip(told, starts, strict=True)] == starts


def test_keys_that_do_not_fit_together_are_named_together(tmp_path):
    text = "name: x\nbase: {roller_material: POM7}\noutputs: [forces]\npareto: {slip: min, slop: max}\n"
    (tmp_path / "s.yaml").write_text(text)
    with pytest.raises(InputErrors) as error:
        tr.load_study(tmp_path / "s.yaml")
    assert sorted(one.value for one in error.value.errors) == ["POM7", "slop"]


def test_a_mapping_and_another_process_keep_the_errors():
    with pytest.raises(InputErrors) as error:
        tr.Case.from_dict({"contact_angle": 91, "axis_distanze": 3})
    again = pickle.loads(pickle.dumps(error.value))
    assert str(again) == str(error.value) and len(again.errors) == 2
    again.errors[0].line = 7
    assert str(pickle.loads(pickle.dumps(again))).startswith("line 7: ")


def test_a_single_error_stays_what_it_is():
    wrong = Collector()
    with wrong.part():
        tr.Case(contact_angle=92)
    with pytest.raises(tr.InputError) as error:
        wrong.check()
    assert type(error.value) is tr.InputError
    Collector().check()


def test_lines_are_those_of_the_keys():
    found = lines_of("a: 1\nb:\n  - {c: 2}\n  - d:\n      e: 3\n")
    assert found["a",] == 1 and found["b", "0", "c"] == 3 and found["b", "1", "d", "e"] == 5


@pytest.mark.parametrize(
    ("name", "close", "meant"),
    [
        ("outer_radius", None, "axis_distance"),
        ("reliability", None, None),
        ("axle_distance", "axis_distance", "axis_distance"),
        ("contact_agnle", "contact_angle", "contact_angle"),
        ("groove_radius", None, "roller_profile_radius"),
        ("drive_torque", None, "motor_force"),
        ("speed", None, "velocity"),
        ("frition", None, "friction_coefficient"),
        ("rail_radius", None, "guide_profile_radius"),
        ("xyz", None, None),
    ],
)
def test_a_name_is_suggested_only_where_it_is_close(name, close, meant):
    assert nearest(name, FIELDS) == close
    assert ([*likeliest(name, FIELDS), None])[0] == meant
    assert len(likeliest(name, FIELDS)) <= 3


def test_reliability_means_the_failure_probability(tmp_path):
    told = trackroller("solve", "--set", "reliability=0.9", cwd=tmp_path, code=2).stderr
    assert told.endswith("Names with a similar meaning: failure_probability.\n")
