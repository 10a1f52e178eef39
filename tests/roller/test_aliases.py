"""Outer radius and depth of the groove give the axis distance, and a parameter may have another name."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from command_line import trackroller

import trackroller as tr
from trackroller.cli.case import case_of
from trackroller.parameters.expressions import evaluate
from trackroller.roller.aliases import AXIS_DISTANCE, renamed
from trackroller.roller.settings import checked_case
from trackroller.study.file.load import parse_study


def bottom_of_groove(axis, groove, guide, degrees):
    """Return the radius where the two arcs of a groove meet, from points on the arc."""
    alpha = math.radians(degrees)
    contact = np.array([guide * math.sin(alpha), axis - guide * math.cos(alpha)])
    normal = np.array([math.sin(alpha), -math.cos(alpha)])  # from the middle of the guide to the contact
    centre = contact - groove * normal
    turned = np.linspace(0, math.pi, 2_000_001)
    x, r = centre[0] + groove * np.cos(turned), centre[1] - groove * np.sin(turned)
    return float(np.interp(0.0, x[::-1], r[::-1]))


@pytest.mark.parametrize(
    ("axis", "groove", "guide", "degrees"), [(21.75, 7.0, 6.0, 30.0), (40.0, 12.5, 9.0, 45.0), (18.0, 5.2, 5.0, 38.0)]
)
def test_the_axis_distance_is_that_of_the_drawn_groove(axis, groove, guide, degrees):
    bottom = bottom_of_groove(axis, groove, guide, degrees)
    case = tr.Case.from_dict(
        {"outer_radius": bottom + 3.5, "groove_depth": "3.5 mm", "roller_profile_radius": -groove}
        | {"guide_profile_radius": guide, "contact_angle": degrees}
    )
    assert case.axis_distance == pytest.approx(axis, abs=1e-8)
    assert "axis_distance" not in case.not_given


def test_a_groove_as_wide_as_the_guide_has_the_guide_in_its_bottom():
    known = {"outer_radius": 25.0, "groove_depth": 4.0, "roller_profile_radius": -6.0, "guide_profile_radius": 6.0}
    assert evaluate(AXIS_DISTANCE, known | {"contact_angle": 33.0}) == pytest.approx(21.0 + 6.0, rel=1e-15)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"outer_radius": 20}, "together with groove_depth"),
        ({"groove_depth": 4}, "together with groove_depth"),
        ({"outer_radius": 20, "groove_depth": 4, "axis_distance": 22}, "one description"),
        ({"outer_radius": 20, "groove_depth": 4, "roller_profile_radius": 30}, "a roller with a groove"),
        ({"outer_radius": 20, "groove_depth": 0.1}, "lies below the outer radius"),
        ({"outer_radius": "20 N", "groove_depth": 4}, "converted to mm"),
        ({"outer_radius": -20, "groove_depth": 4}, "a length > 0"),
        ({"mu": 0.1, "friction_coefficient": 0.1}, "stands beside mu, which is another name"),
    ],
)
def test_ambiguous_radii_and_names_are_refused(values, words):
    with pytest.raises(tr.InputError, match=words):
        tr.Case.from_dict(values)


def test_a_study_derives_the_axis_distance_in_each_case():
    study = tr.load_study(
        {
            "name": "rim",
            "base": {"outer_radius": "2.1 cm", "mu": 0.12},
            "factors": {"groove_depth": {"values": [3.6, 4.1]}, "roller_profile_radius": {"values": [-6.5, -8]}},
            "outputs": ["forces"],
        }
    )
    design = study.design()
    for i in range(4):
        values = {name: float(design[name][i]) for name in ("roller_profile_radius", "groove_depth")}
        case = tr.Case.from_dict({"outer_radius": 21.0, **values})
        assert float(design["axis_distance"][i]) == pytest.approx(case.axis_distance, rel=1e-15)
    assert set(design["friction_coefficient"].values) == {0.12}
    again = tr.load_study(study.as_dict())
    assert again.merged() == study.merged() and again.design().drop_attrs().identical(design.drop_attrs())
    assert "axis_distance" not in study.not_given
    for base in ({"outer_radius": 20, "groove_depth": 4, "axis_distance": 22}, {"groove_depth": 4}):
        with pytest.raises(tr.InputError):
            tr.load_study({"name": "x", "base": base, "outputs": ["forces"]})


def test_files_and_set_take_the_names(tmp_path):
    words = ("--set", "mu=0.07", "--set", "outer_radius=21", "--set", "groove_depth=4 mm", "--json")
    told = trackroller(
        "solve", *words, "--set", "contact_model=sliding", "--set", "outputs=forces", cwd=tmp_path
    ).stdout
    assert '"friction_coefficient": {"value": 0.07' in told and '"default": false' in told
    (tmp_path / "cases.csv").write_text("mu,outer_radius\n0.1,20\n0.2,21\n")
    (tmp_path / "t.yaml").write_text("{name: t, method: table, table: cases.csv, outputs: [forces]}")
    with pytest.raises(tr.InputError, match="outer_radius"):
        tr.load_study(tmp_path / "t.yaml").design()
    (tmp_path / "cases.csv").write_text("mu\n0.1\n0.2\n")
    assert tr.load_study(tmp_path / "t.yaml").design()["friction_coefficient"].values.tolist() == [0.1, 0.2]
    assert renamed({"mu": 1}) == {"friction_coefficient": 1}


FILES = {
    "mu": "mu: 0.3\n",
    "friction": "friction_coefficient: 0.3\n",
    "both": "mu: 0.3\nfriction_coefficient: 0.3\n",
    "radii": "outer_radius: 25\ngroove_depth: 1.5\n",
    "axis": "axis_distance: 30\n",
    "no radius": "outer_radius: wide\ngroove_depth: 1.5\n",
}


@pytest.mark.parametrize(
    ("file", "words", "wanted"),
    [
        ("mu", ["mu=0.12"], {"friction_coefficient": 0.12}),
        ("mu", ["friction_coefficient=0.12"], {"friction_coefficient": 0.12}),
        ("friction", ["mu=0.12"], {"friction_coefficient": 0.12}),
        ("both", ["mu=0.12"], {"friction_coefficient": 0.12}),
        ("radii", ["axis_distance=22"], {"axis_distance": 22}),
        ("radii", ["outer_radius=26"], {"outer_radius": 26, "groove_depth": 1.5}),
        ("axis", ["outer_radius=26", "groove_depth=1.5"], {"outer_radius": 26, "groove_depth": 1.5}),
    ],
)
def test_a_setting_wins_over_the_file_whichever_word_it_uses(file, words, wanted, tmp_path):
    path = tmp_path / "case.yaml"
    path.write_text(FILES[file])
    case, _, _ = case_of(path, words)
    assert case == tr.Case.from_dict(wanted)


@pytest.mark.parametrize(
    ("file", "words", "says"),
    [
        ("friction", ["mu=9"], "^friction_coefficient = 9 "),  # no line of the file
        ("mu", ["friction_coefficient=9"], "^friction_coefficient = 9 "),
        ("axis", ["outer_radius=26"], "^outer_radius = 26 .* together with groove_depth"),
        ("both", ["axial_force=1"], "^line 2: friction_coefficient = 0.3 .* another name"),
        ("no radius", ["axis_distance=22"], "^line 1: outer_radius = 'wide' "),
        ("axis", ["mu="], "^--set = 'mu=' has no value"),
        ("axis", ["mü=0.1"], "'mü' is not known. .*friction_coefficient"),
        ("axis", ["mu=0,1"], "^friction_coefficient = '0,1' .*Write 0.1"),
        ("axis", ["radial_force=-1.200,5 N"], "^radial_force = '-1.200,5 N' .*Write -1200.5 N"),
        ("axis", ["mu=nan"], "^friction_coefficient = 'nan' .*such as 0.3, or leave it out"),
        ("axis", ["mu=0.1", "friction_coefficient=0.2"], "^friction_coefficient = 0.1 .* another name"),
    ],
)
def test_settings_that_contradict_each_other_are_refused(file, words, says, tmp_path):
    path = tmp_path / "case.yaml"
    path.write_text(FILES[file])
    with pytest.raises(tr.InputError, match=says):
        case_of(path, words)


def test_failures_is_another_name_of_the_failure_probability(tmp_path, monkeypatch):
    """In a case, on the command line, which overrides the file, and in a study."""
    monkeypatch.chdir(tmp_path)
    assert checked_case({"failures": "5%"})[1] == {"failure_probability": "5%"}
    Path("case.yaml").write_text("failure_probability: 0.2\n")
    assert case_of(Path("case.yaml"), ["failures=5%"])[1]["failure_probability"] == "5%"
    Path("case.yaml").write_text("failures: 105%\n")
    with pytest.raises(tr.InputError, match=r"line 1: failure_probability .*1\.05"):
        case_of(Path("case.yaml"), None)
    study = {"name": "f", "factors": {"contact_angle": {"values": [30, 32]}}}
    assert parse_study(study | {"failures": "5%"}).options["failure_probability"] == 0.05
    with pytest.raises(tr.InputError, match=r"failures .*stands beside failure_probability"):
        parse_study(study | {"failures": "5%", "failure_probability": 0.1})
    with pytest.raises(tr.InputError, match=r"^failures = 1\.05"):
        parse_study(study | {"failures": "105%"})
