"""Parameters that a case or a study does not name are listed with the values of the paper's example."""

from __future__ import annotations

import numpy as np
import pytest
from command_line import trackroller

import trackroller as tr
from trackroller.parameters.example import EXAMPLE, drive_question, not_given, not_given_text
from trackroller.roller.stored_inputs import not_given_of
from trackroller.study.store.fingerprint import StudyCases

STUDY = """
name: hall
base: {radial_force: -155, axial_force: 22, roller_material: POM}
factors:
  friction_coefficient: {uniform: [0.08, 0.21]}
  ratio: {uniform: [1.1, 1.3]}
  roller_profile_radius: {expression: "-ratio * guide_profile_radius"}
method: lhs
samples: 7
outputs: [forces]
"""


@pytest.fixture
def study(tmp_path):
    (tmp_path / "hall.yaml").write_text(STUDY)
    return tr.load_study(tmp_path / "hall.yaml")


def test_the_written_study_holds_every_value_and_gives_the_same_cases(study, tmp_path, monkeypatch):
    named = {"radial_force", "axial_force", "roller_material", "friction_coefficient", "roller_profile_radius"}
    assert {*study.not_given} == {*EXAMPLE} - named
    assert {name: study.config.base[name] for name in study.not_given} == not_given(named)
    written = tmp_path / "written.yaml"
    written.write_text(study.merged())
    monkeypatch.setattr("trackroller.study.file.load.not_given", lambda named: {})  # nothing else fills a value in
    again = tr.load_study(written)
    assert again.merged() == study.merged() and again.not_given == (), "the file names every parameter"
    np.testing.assert_array_equal(StudyCases(again).fingerprints, StudyCases(study).fingerprints)
    assert again.design().drop_attrs().identical(study.design().drop_attrs())


def test_results_remember_the_defaults_of_their_time(study, monkeypatch):
    solved = tr.run(study, progress=False)
    monkeypatch.setattr("trackroller.study.file.load.not_given", lambda named: {"motor_force": -99.0})
    again = tr.open_study(solved.data)
    assert again.data.attrs["motor_force"] == -30.0 and again.base["motor_force"] == -30.0
    assert again.study.not_given == study.not_given and "motor_force" in study.not_given


def test_columns_of_a_table_count_as_named(tmp_path):
    (tmp_path / "cases.csv").write_text("\nmotor_force,friction_coefficient\n-5,0.1\n-6,0.2\n")
    text = "{name: t, method: table, table: cases.csv, outputs: [forces]}"
    (tmp_path / "t.yaml").write_text(text)
    found = tr.load_study(tmp_path / "t.yaml").not_given
    assert set(found) == set(EXAMPLE) - {"motor_force", "friction_coefficient"}


def test_a_pair_of_materials_and_a_measured_friction_law_are_named():
    law = {"kind": "table", "speed": [0, 50], "friction": [0.22, 0.12]}
    study = tr.load_study(
        {"name": "p", "base": {"material_pair": ["PA6", "POM"], "friction_law": law}, "outputs": ["forces"]}
    )
    assert not {"roller_material", "guide_material", "friction_coefficient"} & set(study.not_given)
    assert study.design()["friction_coefficient"].item() == 0.22
    assert "friction_coefficient" in tr.Case(friction_law={"kind": "exponential", "lowest": 0.5, "speed": 9}).not_given
    assert "friction_coefficient" not in tr.Case(friction_law=law).not_given


def test_a_case_knows_what_was_not_given():
    case = tr.Case(motor_force=EXAMPLE["motor_force"] * 1.0, guide_material="PA6")
    assert set(case.not_given) == set(EXAMPLE) - {"motor_force", "guide_material"}
    assert set(tr.Case.from_dict(case.as_dict()).not_given) <= set(EXAMPLE)
    solved = tr.solve(case, outputs="forces", contact_model="sliding")
    assert not_given_of(solved)["radial_force"] == -200.0
    assert "motor_force" not in not_given_of(solved)


def test_plan_and_run_list_what_is_not_given_and_ask_about_the_drive(study, tmp_path):
    plan = trackroller("plan", "hall.yaml", cwd=tmp_path).stdout
    assert "not given, taken from the paper's example: axis_distance 21.75 mm, " in plan
    assert "Is the roller driven?" in plan and "-30 N" in plan
    (tmp_path / "hall.yaml").write_text(STUDY.replace("POM", "POM, motor_force: 0"))
    assert "driven?" not in trackroller("plan", "hall.yaml", cwd=tmp_path).stdout
    assert "velocity 60 m/min" in trackroller("run", "hall.yaml", "-q", cwd=tmp_path).stderr
    assert "driven?" in trackroller("plan", "--set", "axial_force=9", cwd=tmp_path).stdout


def test_nothing_is_listed_where_everything_is_given():
    assert not_given_text(not_given(EXAMPLE)) == "" == drive_question(not_given(EXAMPLE), EXAMPLE)
    assert "-30 N is used" in drive_question(not_given(["friction_coefficient"]), ["friction_coefficient"])
