"""All errors of a file stand together, in the order of its lines, each with what is meant most likely."""

from __future__ import annotations

import pickle
import re

import pytest
from command_line import trackroller

import trackroller as tr
from trackroller.errors import MOST_SHOWN, Collector, InputErrors, likeliest, nearest
from trackroller.roller.fields import FIELDS
from trackroller.study.file.load import KEYS
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
method: lsh
outputs: [forces, lief]
"""

MATERIALS = """\
materials:
  "1.7225-mine":
    youngs_modulus: 70 kN
    poison_ratio: 0.3
    family: 3
  softer: {like: 1.7225-mine, tensile_strength: -3}
  lacking: {youngs_modulus: 100 GPa}
friction:
  - {pair: [metal, PA6], typicl: 0.2, upper: 20}
sorces: {}
"""
TABLE = """\
radial_force [kN];roller_materal;mu;roller_material
-0,2;a;0,1;PA6

0,3;b;5;PA7
-0,2;c;typical
-0,2;d;high;PA7
"""
SPECTRUM = """\
nme: sorter
base: {axis_distance: -3}
blocks:
  - {name: loaded, distance: 4000 kg, radial_force: 300}
  - {name: empty, distnce: 4000, guide_overrollings: -900}
  - {name: third, distance: 1 km, roller_material: POM}
life_rule: haibch
failure_probabilities: [0.1, 2]
"""


def lines(text: str) -> list[str]:
    """Return each message after the name of the program."""
    return [line.removeprefix("trackroller: ") for line in text.splitlines()]


def planned(folder, study: str, table: str = "") -> list[str]:
    """Return the messages of `trackroller plan` for a study file with this text and its table of cases `t.csv`."""
    (folder / "s.yaml").write_text(study)
    (folder / "t.csv").write_text(table)
    return lines(trackroller("plan", "s.yaml", cwd=folder, code=2).stderr)


OF_TABLE = "name: x\ndesign: table\ntable: t.csv\noutputs: [forces]\n"  # a study whose cases stand in a table


def test_a_case_file_names_all_its_errors_in_order(tmp_path):
    (tmp_path / "case.yaml").write_text(CASE)
    told = lines(trackroller("solve", "case.yaml", "--set", "velocity=-8", cwd=tmp_path, code=2).stderr)
    starts = ["velocity = -8", "line 1: radial_force = 130", "line 3: case field = 'outer_diameter'"]
    starts += ["line 4: axial_force = 'mm'", "line 5: case field = 'reliability'", "line 6: friction_law.speed = -1"]
    assert [line[: len(start)] for line, start in zip(told, starts, strict=True)] == starts
    assert "Write -130. The sign means: < 0 presses the roller" in told[1]
    assert told[0].endswith("Write 8.")


def test_a_study_file_names_all_its_errors_in_order(tmp_path):
    told = planned(tmp_path, STUDY)
    starts = ["line 1: study key = 'nmae'", "line 5: base = 'groove_width'", "line 7: factors.friction_coefficient"]
    starts += ["line 9: factors.velocity.uniform", "line 10: method = 'lsh'", "line 11: outputs = 'lief'"]
    assert [line[: len(start)] for line, start in zip(told, starts, strict=True)] == starts


def test_a_key_that_stands_in_the_wrong_mapping_has_its_line(tmp_path):
    factors = "name: a\nfactors: {friction_coefficient: {values: [0.1, 7]}}\n"
    told = starts_of(planned(tmp_path, f"{factors}analysis:\n  keep: [valid]\n  pareto: {{max_pressure: min}}\n"))
    assert told[0] == "line 2: factors.friction_coefficient.values = 7"
    assert "line 5: analysis = 'pareto'" in told


def starts_of(told: list[str]) -> list[str]:
    """Return each message up to the value that it refuses."""
    return [re.split(r" is not usable| is not known| stands among| lacks ", line)[0] for line in told]


def test_a_materials_file_names_all_its_errors_in_order(tmp_path, monkeypatch):
    (tmp_path / "own.yaml").write_text(MATERIALS)
    monkeypatch.setenv("TRACKROLLER_MATERIALS", "own.yaml")
    told = lines(trackroller("materials", "list", cwd=tmp_path, code=2).stderr)
    assert starts_of([line.removeprefix(f"{tmp_path / 'own.yaml'}, ") for line in told]) == [
        "line 3: materials.1.7225-mine.youngs_modulus = 'kN'",
        "line 4: materials.1.7225-mine: field = 'poison_ratio'",
        "line 5: materials.1.7225-mine.family = 3",
        "line 6: materials.softer.like = '1.7225-mine'",
        "line 6: materials.softer.tensile_strength = -3",
        "line 7: materials.lacking = 'youngs_modulus'",
        "line 9: friction.metal-PA6: level = 'typicl'",
        "line 9: friction.metal-PA6.upper.friction_coefficient = 20",
        "line 10: section = 'sorces'",
    ]


def test_an_added_material_names_all_its_errors_and_no_line_of_a_file_that_does_not_hold_it(tmp_path):
    words = ["--set", "like=PA6", "--set", "youngs_modulus=-3", "--set", "poisson_ratio=3", "--file", "own.yaml"]
    told = trackroller("materials", "add", "mine", *words, cwd=tmp_path, code=2).stderr
    assert starts_of(lines(told)) == ["materials.mine.youngs_modulus = -3", "materials.mine.poisson_ratio = 3"]


def test_a_table_of_cases_names_all_its_errors_in_order(tmp_path):
    assert starts_of(planned(tmp_path, OF_TABLE + "pareto: {slip: min, slop: max}\n", TABLE)) == [
        "line 5: pareto = 'slop'",
        "t.csv, line 1: table column = 'roller_materal'",
        "t.csv, line 4: radial_force = '0.3 kN'",
        "t.csv, line 4: friction_coefficient = '5'",
        "t.csv, line 4: roller_material = 'PA7'",
        "t.csv, line 5: table = '-0,2, c, typical'",
        "t.csv, line 6: friction_coefficient = 'high'",
    ]


def test_a_table_of_cases_names_the_lines_of_unknown_materials_and_of_impossible_geometry(tmp_path):
    pairs = "material_pair,mu\nPA6 / PA7,0.1\nPOM/PA6,0.2\nPA8 / PA7,0.1\n"
    assert starts_of(planned(tmp_path, OF_TABLE, pairs)) == [
        "t.csv, line 2: material_pair = 'PA7'",
        "t.csv, line 4: material_pair = 'PA8'",
        "t.csv, line 4: material_pair = 'PA7'",
    ]
    told = planned(tmp_path, OF_TABLE, "roller_profile_radius [cm]\n-0.7\n-0.5\n-1\n-0.4\n")
    assert starts_of(told) == [
        "t.csv, line 3: roller_profile_radius = -5.0",
        "t.csv, line 5: roller_profile_radius = -4.0",
    ]


def test_words_and_units_of_a_table_are_those_of_a_case(tmp_path):
    (tmp_path / "s.yaml").write_text(OF_TABLE)
    (tmp_path / "t.csv").write_text("axial_force,mu,material_pair\n10 N,0.25,PA6 / POM\n0.02 kN,typical,POM / PA6\n")
    design = tr.load_study(tmp_path / "s.yaml").design()
    typical = tr.load_database().friction("PA6", "POM").value
    assert design.axial_force.values.tolist() == [10.0, 20.0]
    assert design.friction_coefficient.values.tolist() == [0.25, typical]
    assert design.material_pair.values.tolist() == ["PA6 / POM", "POM / PA6"]


def test_a_spectrum_names_all_its_errors_in_order(tmp_path):
    (tmp_path / "s.yaml").write_text(SPECTRUM)
    assert starts_of(lines(trackroller("spectrum", "s.yaml", cwd=tmp_path, code=2).stderr)) == [
        "line 1: spectrum: key = 'nme'",
        "line 2: base.axis_distance = -3",
        "line 4: block 'loaded'.distance = 'kg'",
        "line 4: block 'loaded'.radial_force = 300",
        "line 5: block 'empty': field = 'distnce'",
        "line 5: block 'empty'.guide_overrollings = -900",
        "line 6: block 'third'.roller_material = 'POM'",
        "line 7: life_rule = 'haibch'",
        "line 8: failure_probabilities = 2.0",
    ]


def test_a_table_of_blocks_names_all_its_errors_in_order(tmp_path):
    (tmp_path / "s.yaml").write_text("blocks: b.csv\ncritical_damage: 0\n")
    (tmp_path / "b.csv").write_text("name,distance [km],radial_force [kN]\na,1,0.2\n\nb,x,-0.2\nc,1\n")
    assert starts_of(lines(trackroller("spectrum", "s.yaml", cwd=tmp_path, code=2).stderr)) == [
        "line 2: critical_damage = 0",
        "b.csv, line 2: block 'a'.radial_force = '0.2 kN'",
        "b.csv, line 4: block 'b'.distance = 'x'",
        "b.csv, line 5: blocks = 'c, 1'",
    ]


def test_options_and_duty_stand_among_the_errors_of_a_case(tmp_path):
    (tmp_path / "c.yaml").write_text(
        "radial_force: 130\naccuracy: fine\nduty: {hours_per_day: 40, days_per_year: 400}\nhertz: exct\n"
    )
    told = starts_of(lines(trackroller("solve", "c.yaml", cwd=tmp_path, code=2).stderr))
    assert [line.replace(" is missing", " =").split(" =")[0] for line in told] == [
        "line 1: radial_force",
        "line 2: accuracy",
        "line 3: duty.hours_per_day",
        "line 3: duty.days_per_year",
        "line 4: hertz",
    ]


def test_a_file_with_very_many_errors_shows_the_first_and_counts_the_others(tmp_path):
    told = planned(tmp_path, OF_TABLE, "axial_force\n" + "".join(f"x{i}\n" for i in range(100)))
    assert len(told) == MOST_SHOWN + 1 and told[-1] == f"{100 - MOST_SHOWN} further errors are not shown."


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
        ("pressure", None, None),
        ("speeds", None, "velocity"),
        ("F_rad", None, "radial_force"),
        ("alpha", None, "contact_angle"),
        ("e_modulus", None, "roller_material"),
        ("lubrication", None, "friction_law"),
        ("roller_mat", "roller_material", "roller_profile_radius"),
    ],
)
def test_a_name_is_suggested_only_where_it_is_close(name, close, meant):
    assert nearest(name, FIELDS) == close
    assert ([*likeliest(name, FIELDS), None])[0] == meant
    assert len(likeliest(name, FIELDS)) <= 3


@pytest.mark.parametrize(
    ("name", "close", "meant"),
    [
        ("factor", "factors", "factors"),
        ("objectives", None, "pareto"),
        ("limits", None, "constraints"),
        ("parameters", None, "factors"),
        ("tolerance", None, "accuracy"),
        ("desgin", "design", "design"),
        ("methd", "method", "method"),
    ],
)
def test_a_key_of_a_study_is_suggested_by_its_meaning(name, close, meant):
    assert nearest(name, KEYS) == close
    assert likeliest(name, KEYS)[0] == meant


def test_reliability_means_the_failure_probability(tmp_path):
    told = trackroller("solve", "--set", "reliability=0.9", cwd=tmp_path, code=2).stderr
    assert told.endswith("Names with a similar meaning: failure_probability.\n")


WRONG_WORDS = """\
name: hall
base:
  guide_material: 42CrMo4
  outer_radius: 31
  survival: 0.95
factors:
  mu: {linspace: [0.1, 0.25]}
  grove_depth: {values: [2.5, 3.5]}
  roller_material: {values: [Delrin, PA6]}
samples: -7
duty: {hours: 12}
"""


def test_errors_of_names_stand_with_the_others_and_no_error_causes_another(tmp_path):
    told = planned(tmp_path, WRONG_WORDS)
    assert [int(line.split("line ")[1].split(":")[0]) for line in told] == [3, 4, 5, 7, 8, 9, 10, 11]
    for line, part in zip(
        told,
        [
            "base.guide_material = '42CrMo4' is not usable. Allowed: the name of a material of the database. Write",
            "outer_radius together with groove_depth",
            "Names with a similar meaning: failure_probability.",
            "Write [first, last, number of values].",
            "Did you mean 'groove_depth'?",
            "Use one of these names, or enter the material in config/materials.yaml.",
            "Allowed: greater than or equal to 1",
            "Names with a similar meaning: hours_per_day.",
        ],
        strict=True,
    ):
        assert part in line and len(line) < 300


def test_an_option_among_the_values_of_the_roller_is_told_where_it_belongs(tmp_path):
    told = " ".join(planned(tmp_path, "base: {contact_model: sliding, colour: red}"))
    assert "Write contact_model: sliding on a line of its own that is not indented." in told
    assert "'colour' is not known. The page 'Parameters, options and results'" in told


def test_a_case_names_its_unknown_materials_with_all_other_errors(tmp_path):
    (tmp_path / "c.yaml").write_text("mu: 7\nguide_material: 42CrMo4\nouter_radius: 30 s\ngroove_depth: -2\n")
    told = trackroller("solve", "c.yaml", cwd=tmp_path, code=2).stderr.splitlines()
    starts = ("line 1: friction_coefficient", "line 2: guide_material", "line 3: outer_radius", "line 4: groove_depth")
    assert all(start in line for start, line in zip(starts, told, strict=True))


def test_unknown_results_stand_with_the_errors_of_other_keys(tmp_path):
    text = (
        "name: x\nbase: {radial_force: 3}\noutputs: [forces]\nanalysis:\n  target: {slop: {min: 3}, lift: {max: 2}}\n"
    )
    assert starts_of(planned(tmp_path, text)) == [
        "line 2: base.radial_force = 3",
        "line 5: analysis.target = 'slop'",
        "line 5: analysis.target = 'lift'",
    ]
